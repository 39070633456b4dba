// A number that all invocations count up together.
#ifndef COUNTER_GLSL
#define COUNTER_GLSL

#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Counter { uint next; };

// A number for this invocation that no other gets. Those that are here together count once for all.
uint counter_take(Counter counter) {
    uvec4 here = subgroupBallot(true);
    uint first = 0u;
    if (subgroupElect()) first = atomicAdd(counter.next, subgroupBallotBitCount(here));
    return subgroupBroadcastFirst(first) + subgroupBallotExclusiveBitCount(here);
}

#endif
