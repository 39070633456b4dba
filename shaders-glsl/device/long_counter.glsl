// A counter of 64 bits that all invocations add to.
#ifndef LONG_COUNTER_GLSL
#define LONG_COUNTER_GLSL

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer LongCounter { uint low; uint high; };

void count_one(LongCounter counter) {
    if (atomicAdd(counter.low, 1u) == 0xFFFFFFFFu) atomicAdd(counter.high, 1u);
}

#endif
