// Flat indices of workgroups and invocations: large dispatches are laid out in two dimensions.
#ifndef GRID_GLSL
#define GRID_GLSL

// Macros, since the workgroup size may be declared after this file is included.
#define workgroup() (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x)
#define thread() (workgroup() * gl_WorkGroupSize.x + gl_LocalInvocationID.x)

#endif
