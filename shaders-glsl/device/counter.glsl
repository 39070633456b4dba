// A number that all invocations count up together.
#ifndef COUNTER_GLSL
#define COUNTER_GLSL

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Counter { uint next; };

// A number for this invocation that no other gets. Drivers make one operation of those of a subgroup;
// to do so by hand would take subgroups that stay whole in diverging code, and some fall apart.
uint counter_take(Counter counter) {
    return atomicAdd(counter.next, 1u);
}

#endif
