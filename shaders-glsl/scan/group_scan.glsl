// Sums over the invocations of a workgroup, for any subgroup size.
//
// Invocations are numbered subgroup by subgroup, and every kernel that includes this file assigns its elements
// by that number: the assignment of invocations to subgroups, which Vulkan leaves open, does not matter.
#ifndef GROUP_SCAN_GLSL
#define GROUP_SCAN_GLSL

#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require

// 1024 invocations in subgroups of at least 4.
shared uint group_scan_sums[256];

// Index of the invocation, subgroup by subgroup.
uint group_rank() {
    return gl_SubgroupID * gl_SubgroupSize + gl_SubgroupInvocationID;
}

// Sum of `value` over the subgroups before this one; `value` must be uniform in a subgroup. `total` is the sum
// over all subgroups. Must be called by the whole workgroup.
uint group_before(uint value, out uint total) {
    barrier();
    if (subgroupElect()) group_scan_sums[gl_SubgroupID] = value;
    barrier();
    uint before = 0;
    total = 0;
    for (uint first = 0; first < gl_NumSubgroups; first += gl_SubgroupSize) {
        uint at = first + gl_SubgroupInvocationID;
        uint sum = at < gl_NumSubgroups ? group_scan_sums[at] : 0;
        before += subgroupAdd(at < gl_SubgroupID ? sum : 0);
        total += subgroupAdd(sum);
    }
    return before;
}

// Exclusive sum: `value` summed over the invocations of lower rank.
uint group_exclusive(uint value, out uint total) {
    // Invocations may come from loops of different lengths; this makes the subgroup converge again.
    subgroupBarrier();
    uint within = subgroupExclusiveAdd(value);
    return within + group_before(subgroupAdd(value), total);
}

// Sum of `value` over all invocations.
uint group_sum(uint value) {
    uint total;
    subgroupBarrier();
    group_before(subgroupAdd(value), total);
    return total;
}

#endif
