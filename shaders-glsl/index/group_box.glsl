// Bounding box over the invocations of a workgroup, as ordered integers.
#ifndef GROUP_BOX_GLSL
#define GROUP_BOX_GLSL

#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require

shared uint group_box_low[3];
shared uint group_box_high[3];

// Must be called by the whole workgroup.
void group_box(inout uvec3 low, inout uvec3 high) {
    barrier();
    if (gl_LocalInvocationIndex < 3) {
        group_box_low[gl_LocalInvocationIndex] = 0xffffffffu;
        group_box_high[gl_LocalInvocationIndex] = 0;
    }
    barrier();
    low = subgroupMin(low);
    high = subgroupMax(high);
    if (subgroupElect()) {
        for (uint axis = 0; axis < 3; axis++) {
            atomicMin(group_box_low[axis], low[axis]);
            atomicMax(group_box_high[axis], high[axis]);
        }
    }
    barrier();
    low = uvec3(group_box_low[0], group_box_low[1], group_box_low[2]);
    high = uvec3(group_box_high[0], group_box_high[1], group_box_high[2]);
}

#endif
