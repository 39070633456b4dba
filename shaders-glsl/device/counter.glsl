// A counter shared by all invocations.
#ifndef COUNTER_GLSL
#define COUNTER_GLSL

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Counter { uint next; };

// Returns a number that no other invocation gets. Drivers combine the atomics of a subgroup into one; doing so
// by hand would require subgroups to stay converged in divergent code, which some drivers do not guarantee.
uint counter_take(Counter counter) {
    return atomicAdd(counter.next, 1u);
}

#endif
