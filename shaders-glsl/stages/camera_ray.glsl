// Rays of the camera: included by eye.comp, whose push constants it uses. Twin of backend-cpu's camera_ray.rs.
#ifndef CAMERA_RAY_GLSL
#define CAMERA_RAY_GLSL

// The ray through a point of the image; both coordinates are in [-1, 1].
Ray ray_through_pinhole(float x, float y) {
    Camera camera = push.camera.at;
    precise vec3 offset = camera.right * x + camera.up * y;
    if (camera.kind == CAMERA_ORTHOGRAPHIC) {
        precise vec3 origin = camera.origin + offset;
        return Ray(origin, camera.forward, NO_LIMIT);
    }
    precise vec3 towards = camera.forward + offset;
    return Ray(camera.origin, normalize_or(towards, camera.forward), NO_LIMIT);
}

// The ray through a point of the image and a uniformly distributed point of the lens: all rays through a point of the
// image meet in the plane that is in focus.
Ray ray_through_lens(float x, float y, uvec2 random) {
    Camera camera = push.camera.at;
    vec2 point = sampling_disc(unit_f32(random.x), unit_f32(random.y));
    vec3 right = normalize_or(camera.right, vec3(0.0));
    vec3 up = normalize_or(camera.up, vec3(0.0));
    precise vec3 lens = (right * point.x + up * point.y) * camera.lens_radius;
    precise vec3 towards = camera.forward + (camera.right * x + camera.up * y) - lens / camera.focus_distance;
    precise vec3 origin = camera.origin + lens;
    return Ray(origin, normalize_or(towards, camera.forward), NO_LIMIT);
}

#endif
