// Sums over the invocations of a workgroup, for any size of its subgroups.
//
// Invocations are numbered subgroup by subgroup, which is how every kernel that includes this
// assigns its elements: the numbering that Vulkan leaves open does not matter.
#ifndef GROUP_SCAN_GLSL
#define GROUP_SCAN_GLSL

#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require

// 1024 invocations in subgroups of at least 4.
shared uint group_scan_sums[256];

// Number of the invocation, subgroup by subgroup.
uint group_rank() {
    return gl_SubgroupID * gl_SubgroupSize + gl_SubgroupInvocationID;
}

// Sum of `value` over the subgroups before this one, `value` being the same in all of a subgroup;
// `total` is that of all. Called by the whole workgroup.
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

// Sum of `value` over the invocations of lower rank.
uint group_exclusive(uint value, out uint total) {
    // Invocations come from loops of different lengths; the subgroup is to be whole again.
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
