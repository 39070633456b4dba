// Flat numbers of workgroups and invocations: long dispatches are laid out in two dimensions.
#ifndef GRID_GLSL
#define GRID_GLSL

uint workgroup() { return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x; }

uint thread() { return workgroup() * gl_WorkGroupSize.x + gl_LocalInvocationID.x; }

#endif
