// Media along rays: all that attenuates light is found here. Twin of backend-cpu's stretches.rs.
#ifndef STRETCHES_GLSL
#define STRETCHES_GLSL

#include "shading/media.glsl"

// Whether rays that start in a stack of media may cross one that absorbs or scatters light.
bool may_attenuate(uint stack) { return (FEATURES & FEATURE_ABSORPTION) != 0u && (AMBIENT || stack != VACUUM); }

// Transmittance per channel of the part of a ray between two distances, in the medium with this index.
vec3 stretch_transmittance(SceneRef scene, uint medium, Ray ray, float from, float to) {
    if (SCATTERING) return medium_transmittance(scene.media[medium].at, to - from);
    vec3 depth = scene.media[medium].at.absorption * (to - from);
    return vec3(exp_neg(depth.x), exp_neg(depth.y), exp_neg(depth.z));
}

// Transmittance per channel of a ray that starts in a stack of media and meets no surface before the distance `end`.
vec3 transmittance(SceneRef scene, Ray ray, float end, uint stack) {
    return stretch_transmittance(scene, media_current(scene, stack), ray, 0.0, end);
}

#endif
