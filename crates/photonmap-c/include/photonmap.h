/*
 * photonmap: photon mapping on the CPU and on GPUs. Generated; see docs/c.md.
 *
 * Handles are opaque. Functions that make one say what frees it; NULL may be freed, and a handle must not be freed
 * twice. Arrays and texts are the caller's, and are not kept after a call. Texts are UTF-8 and end with a zero.
 *
 * Functions that can fail return a status, and pm_last_error() has words for it, for each thread. NULL, sizes that do
 * not fit, and numbers that are not finite or out of range are errors. What a pointer points to cannot be checked.
 *
 * Structs begin with their size, which the caller sets to sizeof: `PmView view = {sizeof view};` sets all else to 0.
 * Fields may be added at the end in later versions, where 0 has the effect of this version.
 *
 * Any thread may call any function, but not two at once with the same handle, unless both arguments are const.
 *
 * Lengths are in user space, whose unit is called m. Colours are linear RGB; light is in radiometric units.
 */

#ifndef PHOTONMAP_H
#define PHOTONMAP_H

#include <stddef.h>
#include <stdint.h>

/**
 * Version of this interface. It is raised by changes that break compiled programs; functions, constants and fields at the
 * end of structs may be added without.
 */
#define PM_ABI 1

/**
 * A diffuse surface (Lambert), on both sides.
 */
#define PM_MATERIAL_LAMBERT 0

/**
 * A perfect mirror, on both sides.
 */
#define PM_MATERIAL_MIRROR 1

/**
 * The boundary of a solid of glass or another medium, smooth or rough: a closed mesh whose fronts face outwards.
 */
#define PM_MATERIAL_DIELECTRIC 2

/**
 * A sheet without thickness, which light passes without a change of direction if it is smooth.
 */
#define PM_MATERIAL_THIN 3

/**
 * Rough reflection (GGX): the metallic-roughness model of glTF 2.0.
 */
#define PM_MATERIAL_GLOSSY 4

/**
 * The boundary of mist, smoke or ink, which light passes without reflection, refraction or any other event: a closed mesh whose
 * fronts face outwards.
 */
#define PM_MATERIAL_BOUNDARY 5

/**
 * One refractive index for all light.
 */
#define PM_DISPERSION_NONE 0

/**
 * By the Abbe number, finite and above 0: the first of the numbers.
 */
#define PM_DISPERSION_ABBE 1

/**
 * A, B of n = A + B/λ², λ in micrometres. They replace the refractive index.
 */
#define PM_DISPERSION_CAUCHY 2

/**
 * B1, B2, B3, C1, C2, C3 of n² = 1 + Σ Bλ²/(λ² - C), λ in micrometres. They replace the refractive index.
 */
#define PM_DISPERSION_SELLMEIER 3

/**
 * Scattering by the phase function of Henyey and Greenstein, of a mean cosine.
 */
#define PM_PHASE_HENYEY_GREENSTEIN 0

/**
 * By particles much smaller than the wavelength: air.
 */
#define PM_PHASE_RAYLEIGH 1

/**
 * By droplets of water of a diameter: fog and cloud.
 */
#define PM_PHASE_MIE 2

/**
 * Emits equally in all directions.
 */
#define PM_LIGHT_POINT 0

/**
 * Emits within a cone.
 */
#define PM_LIGHT_SPOT 1

/**
 * Parallel light from infinitely far away.
 */
#define PM_LIGHT_DIRECTIONAL 2

/**
 * PmHit.primitive of a ray that hits nothing.
 */
#define PM_NO_HIT UINT32_MAX

/**
 * The picture: radiance, W/(m² sr), linear RGB. The sum of the four layers below. 3 numbers a pixel.
 */
#define PM_LAYER_PICTURE 0

/**
 * Lights that are seen directly, or by way of mirrors and glass alone. 3 numbers a pixel.
 */
#define PM_LAYER_EMISSION 1

/**
 * Light that comes straight from a light to the visible surface. 3 numbers a pixel.
 */
#define PM_LAYER_DIRECT 2

/**
 * Light that comes there by way of mirrors and glass alone. 3 numbers a pixel.
 */
#define PM_LAYER_CAUSTIC 3

/**
 * Light that was scattered diffusely before. 3 numbers a pixel.
 */
#define PM_LAYER_INDIRECT 4

/**
 * Mean normal of the first surface, or 0. 3 numbers a pixel.
 */
#define PM_LAYER_NORMAL 5

/**
 * Mean albedo of the first surface, or 0. 3 numbers a pixel.
 */
#define PM_LAYER_ALBEDO 6

/**
 * Mean distance to the first surface, user space; infinite where there is none. 1 number a pixel.
 */
#define PM_LAYER_DEPTH 7

/**
 * Share of the camera rays that hit a surface. 1 number a pixel.
 */
#define PM_LAYER_ALPHA 8

/**
 * Standard error of the mean of RGB, W/(m² sr); infinite before the second pass. 1 number a pixel.
 */
#define PM_LAYER_STANDARD_ERROR 9

/**
 * Estimated bias of the mean of RGB, W/(m² sr); only with the setting `errors`. 1 number a pixel.
 */
#define PM_LAYER_BIAS 10

/**
 * Error map: half the width of the 95 % confidence interval of the mean of RGB, W/(m² sr), infinite where there is no
 * estimate; only with the setting `errors`. 1 number a pixel.
 */
#define PM_LAYER_HALF_WIDTH 11

/**
 * PmPhotonArrays.kinds: a photon straight from a light.
 */
#define PM_PHOTON_DIRECT 0

/**
 * A photon that came by way of mirrors and glass alone.
 */
#define PM_PHOTON_CAUSTIC 1

/**
 * A photon that was scattered diffusely before.
 */
#define PM_PHOTON_GLOBAL 2

/**
 * What a call returns. Except for PM_STATUS_OK, pm_last_error() has words, a handle that should have been made is NULL,
 * and arrays and structs of the caller are as they were.
 */
enum PmStatus
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /**
   * Success.
   */
  PM_STATUS_OK = 0,
  /**
   * An argument is NULL, of the wrong size, not finite or out of range.
   */
  PM_STATUS_INVALID_ARGUMENT = 1,
  /**
   * A scene has an invalid value, or no triangles, or no camera of that name.
   */
  PM_STATUS_INVALID_SCENE = 2,
  /**
   * The settings are no valid JSON, or a setting is unknown or out of range.
   */
  PM_STATUS_INVALID_SETTINGS = 3,
  /**
   * A file cannot be read or written, or its content is invalid.
   */
  PM_STATUS_FILE = 4,
  /**
   * Not enough memory, or more than the settings allow.
   */
  PM_STATUS_OUT_OF_MEMORY = 5,
  /**
   * There is no suitable GPU, no driver, or no denoiser.
   */
  PM_STATUS_NO_DEVICE = 6,
  /**
   * The progress function stopped the render. The film contains the passes that were finished.
   */
  PM_STATUS_CANCELLED = 7,
  /**
   * The ray caster reported an error, or returned something invalid. The film contains the passes before.
   */
  PM_STATUS_CASTER = 8,
  /**
   * Films do not fit together: another scene, view or settings, a pass in both, or a pass that was cut short.
   */
  PM_STATUS_FILM = 9,
  /**
   * The device or its driver failed.
   */
  PM_STATUS_DEVICE = 10,
  /**
   * A defect of the library. Free the handles of the call, and do not use them otherwise.
   */
  PM_STATUS_INTERNAL = 11,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum PmStatus PmStatus;
#else
typedef int32_t PmStatus;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * A scene under construction. Values are checked by pm_builder_build().
 */
typedef struct PmBuilder PmBuilder;

/**
 * Sums over passes. Several threads may read it at once.
 */
typedef struct PmFilm PmFilm;

/**
 * Photons for searching. Several threads may read it at once. Searches use all cores.
 */
typedef struct PmMap PmMap;

/**
 * Photons that were traced. Several threads may read them at once.
 */
typedef struct PmPhotons PmPhotons;

/**
 * A renderer of one scene, with the sums of its passes. One thread at a time may use it.
 */
typedef struct PmRenderer PmRenderer;

/**
 * A scene. It does not change, and may be used by several threads at once.
 */
typedef struct PmScene PmScene;

/**
 * How scene files are read. All zero, except for the size: no overrides, no limit.
 */
typedef struct PmLoadOptions {
  /**
   * sizeof(PmLoadOptions).
   */
  size_t size;
  /**
   * Path of a TOML file that changes or adds materials, lights, cameras and an environment, UTF-8; NULL: none.
   */
  const char *overrides;
  /**
   * Limit in bytes on what reading holds at any time: files, meshes, textures and images; 0: none but the fixed ones.
   * Textures that do not fit are reduced, which the scene's report says; if that is not enough, the call fails with
   * PM_STATUS_OUT_OF_MEMORY before anything too large is decoded. Tables that are made of the scene do not count.
   */
  uint64_t memory;
} PmLoadOptions;

/**
 * Facts about a scene. Normalised space, which ray casters see, is `(user - center) / scale`.
 */
typedef struct PmSceneInfo {
  /**
   * sizeof(PmSceneInfo); set before the call.
   */
  size_t size;
  /**
   * Triangles that are rendered. Those without area are dropped.
   */
  size_t triangles;
  /**
   * Vertices that triangles use.
   */
  size_t vertices;
  /**
   * Meshes of the description.
   */
  size_t meshes;
  /**
   * Materials of the description.
   */
  size_t materials;
  /**
   * Records of lights: one for each triangle that emits, and others.
   */
  size_t lights;
  /**
   * Cameras.
   */
  size_t cameras;
  /**
   * Triangles without area, which were dropped.
   */
  size_t dropped;
  /**
   * Centre of the bounding box, user space.
   */
  double center[3];
  /**
   * User-space length of a normalised unit.
   */
  double scale;
  /**
   * Total flux of the lights, mean of RGB, W.
   */
  double power;
} PmSceneInfo;

/**
 * A material. Colours are linear RGB. Fields that its kind does not use are ignored.
 */
typedef struct PmMaterial {
  /**
   * sizeof(PmMaterial).
   */
  size_t size;
  /**
   * Name in messages and override files; NULL: none.
   */
  const char *name;
  /**
   * One of PM_MATERIAL_….
   */
  uint32_t kind;
  /**
   * Not 0: the back emits too, not only the front.
   */
  uint32_t emits_both_sides;
  /**
   * Albedo (Lambert), reflectance (mirror), base colour (glossy), in [0, 1]; the factor on transmitted light
   * (dielectric, thin).
   */
  double color[3];
  /**
   * Emitted radiance, the same in all directions, W/(m² sr), finite and at least 0.
   */
  double emission[3];
  /**
   * Refractive index, relative to vacuum (dielectric, thin; coat of glossy), finite and above 0.
   */
  double ior;
  /**
   * Absorption inside of a dielectric or boundary (Beer-Lambert), 1/m, finite and at least 0.
   */
  double absorption[3];
  /**
   * Roughness in [0, 1] (dielectric, thin, glossy); 0 is smooth.
   */
  double roughness;
  /**
   * Share of metal in [0, 1] (glossy).
   */
  double metallic;
  /**
   * Factor on the reflection of the coat in [0, 1], usually 1 (glossy).
   */
  double specular;
  /**
   * Where solids and boundaries overlap, the one with the highest priority counts (dielectric, boundary).
   */
  uint32_t priority;
  /**
   * Formula of the refractive index by the wavelength, one of PM_DISPERSION_… (dielectric; an error for thin).
   */
  uint32_t dispersion;
  /**
   * Its numbers.
   */
  double dispersion_terms[6];
  /**
   * Scattering inside of a dielectric or boundary, 1/m, finite and at least 0: milk, wax, mist.
   */
  double scattering[3];
  /**
   * Mean cosine of that scattering, in (-1, 1): 0 is even (PM_PHASE_HENYEY_GREENSTEIN).
   */
  double anisotropy;
  /**
   * Diameter of droplets in micrometres, 5 to 50 (PM_PHASE_MIE).
   */
  double droplet_micrometres;
  /**
   * Phase function of that scattering, one of PM_PHASE_….
   */
  uint32_t phase;
} PmMaterial;

/**
 * Triangles of one material. Arrays are copied.
 */
typedef struct PmMesh {
  /**
   * sizeof(PmMesh).
   */
  size_t size;
  /**
   * Name in messages; NULL: none.
   */
  const char *name;
  /**
   * 3 coordinates for each vertex, user space, finite.
   */
  const double *positions;
  /**
   * 3 components of the normal at each vertex, towards the front, for smooth shading; NULL: flat triangles.
   */
  const double *normals;
  /**
   * Number of vertices.
   */
  size_t vertex_count;
  /**
   * 3 indices of vertices for each triangle, counter-clockwise as seen from the front.
   */
  const uint32_t *triangles;
  /**
   * Number of triangles.
   */
  size_t triangle_count;
  /**
   * Of pm_builder_material().
   */
  uint32_t material;
} PmMesh;

/**
 * A light without extent. Area lights are meshes of a material that emits.
 */
typedef struct PmLight {
  /**
   * sizeof(PmLight).
   */
  size_t size;
  /**
   * Name in messages; NULL: none.
   */
  const char *name;
  /**
   * One of PM_LIGHT_….
   */
  uint32_t kind;
  /**
   * User space (point, spot).
   */
  double position[3];
  /**
   * In which light travels, of any length but 0 (spot, directional).
   */
  double direction[3];
  /**
   * Linear RGB, finite and at least 0: radiant intensity, W/sr (point, spot), or irradiance on a plane perpendicular to
   * the direction, W/m² (directional).
   */
  double color[3];
  /**
   * Angle from the axis up to which the intensity is full, radians (spot).
   */
  double inner_angle;
  /**
   * Angle from the axis at which the intensity reaches 0, radians, in (0, pi/2] (spot).
   */
  double outer_angle;
} PmLight;

/**
 * A camera. The width of its view follows from the shape of the picture.
 */
typedef struct PmCamera {
  /**
   * sizeof(PmCamera).
   */
  size_t size;
  /**
   * Name; NULL: none.
   */
  const char *name;
  /**
   * User space; may lie outside of the scene.
   */
  double position[3];
  /**
   * Point in the middle of the picture, other than the position.
   */
  double target[3];
  /**
   * Upwards in the picture; not parallel to the view.
   */
  double up[3];
  /**
   * Angle between the lower and the upper edge of the picture, radians, in (0, pi); 0: orthographic.
   */
  double vertical_fov;
  /**
   * Half the height of what an orthographic camera sees, m.
   */
  double half_height;
  /**
   * Diameter of the lens, m; 0: everything is in focus.
   */
  double lens_diameter;
  /**
   * Distance of the plane in focus, m, if there is a lens.
   */
  double focus_distance;
} PmCamera;

/**
 * Densities by which the scattering and absorption inside of a dielectric are multiplied: smoke, clouds. They are trilinear
 * between the centres of cells, and 0 outside of the box that cells fill. The array is copied.
 */
typedef struct PmGrid {
  /**
   * sizeof(PmGrid).
   */
  size_t size;
  /**
   * A .vol or .nvdb file of densities, UTF-8, in place of the array; NULL: the array.
   */
  const char *file;
  /**
   * One density for each cell, x fastest, finite and at least 0.
   */
  const float *densities;
  /**
   * Number of cells along x, y and z, at least 1.
   */
  uint32_t cells[3];
  /**
   * Of pm_builder_material().
   */
  uint32_t material;
  /**
   * Rows of an affine transform from the unit cube, which the cells fill, to user space; all 0: the box of the file, or the
   * unit cube.
   */
  double transform[4][4];
  /**
   * Factor on the densities, finite and at least 0; 0: 1.
   */
  double density_scale;
} PmGrid;

/**
 * The medium around all solids. Light from infinitely far away does not pass one without bounds.
 */
typedef struct PmMedium {
  /**
   * sizeof(PmMedium).
   */
  size_t size;
  /**
   * Scattering coefficient, 1/m, linear RGB, finite and at least 0.
   */
  double scattering[3];
  /**
   * Absorption coefficient, 1/m, linear RGB, finite and at least 0.
   */
  double absorption[3];
  /**
   * Mean cosine of scattering, in (-1, 1): 0 is even (PM_PHASE_HENYEY_GREENSTEIN).
   */
  double anisotropy;
  /**
   * Diameter of droplets in micrometres, 5 to 50 (PM_PHASE_MIE).
   */
  double droplet_micrometres;
  /**
   * Phase function, one of PM_PHASE_….
   */
  uint32_t phase;
  /**
   * Lower and upper corner of the box that it fills, in m; all 0: without bounds.
   */
  double bounds[2][3];
} PmMedium;

/**
 * The picture: its size and camera.
 */
typedef struct PmView {
  /**
   * sizeof(PmView).
   */
  size_t size;
  /**
   * Name of a camera of the scene; NULL: the first one.
   */
  const char *camera;
  /**
   * Width in pixels, at least 1.
   */
  uint32_t width;
  /**
   * Height in pixels, at least 1. At most 2^31 pixels in all.
   */
  uint32_t height;
} PmView;

/**
 * A ray in normalised space: see PmSceneInfo.
 */
typedef struct PmRay {
  /**
   * Already moved off the surface that the ray leaves.
   */
  float origin[3];
  /**
   * Unit vector.
   */
  float direction[3];
  /**
   * Hits farther away do not count; may be infinite.
   */
  float t_max;
} PmRay;

/**
 * The nearest hit along a ray, on either side of a triangle; of several, the one with the lowest index.
 */
typedef struct PmHit {
  /**
   * Distance, at least 0 and finite. Hits beyond t_max do not count.
   */
  float t;
  /**
   * Index of the triangle, as prepare() got it, or PM_NO_HIT, which it is before the call.
   */
  uint32_t primitive;
  /**
   * Weight of the second vertex, in [0, 1]. The point is (1 - u - v) a + u b + v c.
   */
  float u;
  /**
   * Weight of the third vertex, in [0, 1].
   */
  float v;
} PmHit;

/**
 * A ray caster of the caller. The struct is copied; what `user` points to has to exist as long as the renderer.
 *
 * A function that returns anything but 0 ends the pass with PM_STATUS_CASTER, and so do a hit with a `t` that is
 * negative or not finite, with a triangle that does not exist, or with `u` or `v` outside of [0, 1]. Functions must not
 * throw exceptions.
 */
typedef struct PmCaster {
  /**
   * sizeof(PmCaster).
   */
  size_t size;
  /**
   * Passed to the functions. Several threads use it at once.
   */
  void *user;
  /**
   * Called once, by pm_renderer_new(), with the triangles in normalised space: 3 coordinates for each vertex, 3 indices
   * for each triangle. Triangles without area have been dropped; pm_scene_triangle_sources() says which remain. The
   * arrays exist only during the call. May be NULL.
   */
  int32_t (*prepare)(void *user,
                     const float *positions,
                     size_t vertex_count,
                     const uint32_t *triangles,
                     size_t triangle_count);
  /**
   * Finds what `count` rays hit, at least 1. Called by several threads at once. Not NULL.
   */
  int32_t (*nearest)(void *user, const struct PmRay *rays, struct PmHit *hits, size_t count);
  /**
   * Not 0: photon and camera paths are traced surface by surface, and shadow rays of diffuse surfaces together, so that
   * `count` is up to some thousands; final-gather rays, shadow rays of other surfaces and all rays of scenes with alpha
   * still come one by one. 0: all do. The picture is the same.
   */
  uint32_t batches;
} PmCaster;

/**
 * What a renderer runs on. All zero, except for the size: all cores, with the library's own ray caster.
 */
typedef struct PmDevice {
  /**
   * sizeof(PmDevice).
   */
  size_t size;
  /**
   * "cpu"; "gpu"; "auto": a GPU if there is one, and no caster, else the CPU; a device of pm_devices() by index or a part of
   * its name, "gpu:1"; or "vulkan": the device that Vulkan prefers, even a software driver, which "auto" and "gpu" never take.
   * NULL: "cpu". For "gpu" and "vulkan", the environment variable PHOTON_VK_DEVICE selects a device.
   */
  const char *backend;
  /**
   * The caller's ray caster; NULL: that of the library. Only on the CPU.
   */
  const struct PmCaster *caster;
  /**
   * Number of threads on the CPU, at most 4096; 0: one for each core. Pictures do not depend on it.
   */
  uint32_t threads;
} PmDevice;

/**
 * What a progress function is called with.
 */
typedef struct PmProgress {
  /**
   * Size of this struct in the library.
   */
  size_t size;
  /**
   * Index of the pass.
   */
  uint32_t pass;
  /**
   * Passes that this call of pm_renderer_passes() has finished.
   */
  uint32_t done;
  /**
   * Passes that it was asked for.
   */
  uint32_t count;
  /**
   * Photon paths of the present pass that have been traced, and their number. Equal at the end of a pass.
   */
  uint32_t traced;
  /**
   * Photon paths of the present pass.
   */
  uint32_t total;
} PmProgress;

/**
 * A progress function: called several times while the photons of each pass are traced, on the thread that renders.
 * Returns 0 to go on; anything else stops the render within the pass. It must not use the renderer, nor throw exceptions.
 */
typedef int32_t (*PmProgressFunction)(void *user, const struct PmProgress *progress);

/**
 * Facts about a film.
 */
typedef struct PmFilmInfo {
  /**
   * sizeof(PmFilmInfo); set before the call.
   */
  size_t size;
  /**
   * Width in pixels.
   */
  uint32_t width;
  /**
   * Height in pixels.
   */
  uint32_t height;
  /**
   * Number of passes.
   */
  uint32_t passes;
  /**
   * Not 0: its only pass was cut short.
   */
  uint32_t cut;
  /**
   * Not 0: there is an error map.
   */
  uint32_t errors;
  /**
   * Passes whose photons were counted: fewer than `passes` if some are from a file without counts.
   */
  uint32_t counted;
  /**
   * Paths that were emitted in these passes, aimed ones included.
   */
  uint64_t paths;
  /**
   * Photons that they stored.
   */
  uint64_t photons;
} PmFilmInfo;

/**
 * Arrays for the photons. Each may be NULL.
 */
typedef struct PmPhotonArrays {
  /**
   * sizeof(PmPhotonArrays).
   */
  size_t size;
  /**
   * 3 coordinates for each photon, user space.
   */
  double *positions;
  /**
   * Normal of the surface on the side where the photon arrived, 3 for each.
   */
  float *normals;
  /**
   * Direction towards where the photon came from, 3 for each.
   */
  float *directions;
  /**
   * Flux in RGB, W, 3 for each.
   */
  float *powers;
  /**
   * One of PM_PHOTON_… for each.
   */
  uint8_t *kinds;
} PmPhotonArrays;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * The version of the interface that the library has: the same as PM_ABI of the header that a program was compiled with,
 * or the program does not fit the library.
 */
uint32_t pm_abi(void);

/**
 * The version of the library, such as "0.1.0". Static; not to be freed.
 */
const char *pm_version(void);

/**
 * Copies what the last call on this thread that failed had to say: what is wrong, and what would be valid. UTF-8, ended
 * by a zero, cut to `room` bytes. Calls that succeed do not change it.
 *
 * `text` may be NULL if `room` is 0. Returns the length of the whole text without the zero; 0 if no call has failed.
 */
size_t pm_last_error(char *text, size_t room);

/**
 * Reads a scene file: .gltf, .glb, .obj, .ply or .stl.
 *
 * `overrides`: a TOML file that changes or adds materials, lights, cameras and an environment; NULL for none. A scene
 * without a camera gets one that shows all of it, and one without a light the environment "gradient", of which pm_scene_report()
 * has a line. Paths are UTF-8. `*scene` is to be freed with pm_scene_free().
 */
PmStatus pm_scene_load(const char *file,
                       const char *overrides,
                       struct PmScene **scene);

/**
 * As pm_scene_load(), with options, which may be NULL.
 */
PmStatus pm_scene_load_with(const char *file, const struct PmLoadOptions *options, struct PmScene **scene);

/**
 * Makes one of the built-in scenes, such as "cornell-glass"; the error of another name lists them. `*scene` is to be
 * freed with pm_scene_free().
 */
PmStatus pm_scene_builtin(const char *name, struct PmScene **scene);

/**
 * Frees a scene; NULL is ignored. Renderers that were made with it go on.
 */
void pm_scene_free(struct PmScene *scene);

/**
 * Fills in `*info`, whose size has to be set.
 */
PmStatus pm_scene_info(const struct PmScene *scene, struct PmSceneInfo *info);

/**
 * Copies what the loader approximated or left out, and warnings, one to a line: as pm_last_error().
 */
size_t pm_scene_report(const struct PmScene *scene, char *text, size_t room);

/**
 * What each of the `count` triangles was in the description: index of the mesh, in the order in which meshes were added
 * or are in the file, and index of the triangle within the mesh. Ray casters see triangles in this order.
 *
 * `count` has to be PmSceneInfo.triangles; each array may be NULL.
 */
PmStatus pm_scene_triangle_sources(const struct PmScene *scene, uint32_t *meshes, uint32_t *triangles, size_t count);

/**
 * Copies the name of a mesh: as pm_last_error(). Returns 0 for one that does not exist.
 */
size_t pm_scene_mesh_name(const struct PmScene *scene, uint32_t mesh, char *text, size_t room);

/**
 * Makes an empty scene. `*builder` is to be freed with pm_builder_free().
 */
PmStatus pm_builder_new(struct PmBuilder **builder);

/**
 * Reads a scene file, as pm_scene_load(), to add to it. `*builder` is to be freed with pm_builder_free().
 */
PmStatus pm_builder_load(const char *file, const char *overrides, struct PmBuilder **builder);

/**
 * As pm_builder_load(), with options, which may be NULL.
 */
PmStatus pm_builder_load_with(const char *file, const struct PmLoadOptions *options, struct PmBuilder **builder);

/**
 * Adds a material. `*id`, which may be NULL, is what meshes refer to it by.
 */
PmStatus pm_builder_material(struct PmBuilder *builder, const struct PmMaterial *material, uint32_t *id);

/**
 * Adds triangles.
 */
PmStatus pm_builder_mesh(struct PmBuilder *builder, const struct PmMesh *mesh);

/**
 * Adds a light.
 */
PmStatus pm_builder_light(struct PmBuilder *builder, const struct PmLight *light);

/**
 * Adds a camera; the first one is the default.
 */
PmStatus pm_builder_camera(struct PmBuilder *builder, const struct PmCamera *camera);

/**
 * Sets the light from all around, and replaces that of before.
 *
 * `light`: an .exr or .hdr image in latitude and longitude, of radiance in W/(m² sr), whose centre is seen along -z;
 * "gradient", of radiance 1 + 0.9 d.w from direction w, with the unit vector d along (-2, 4, 3); "constant", of radiance 1, or
 * "constant:R,G,B"; or a clear sky with its sun, "sky:ELEVATION,TURBIDITY", in degrees and from 1 to 10.
 * `rotate`: degrees, counter-clockwise as seen from +y. `scale`: factor on the light, such as 1.
 */
PmStatus pm_builder_environment(struct PmBuilder *builder,
                                const char *light,
                                double rotate,
                                double scale);

/**
 * Gives a dielectric densities, and replaces those of before.
 */
PmStatus pm_builder_grid(struct PmBuilder *builder, const struct PmGrid *grid);

/**
 * Sets the medium around all solids, and replaces that of before; without scattering and absorption there is none.
 */
PmStatus pm_builder_medium(struct PmBuilder *builder, const struct PmMedium *medium);

/**
 * Applies the text of an override file: an environment, a medium, lights and cameras, and changes of materials that were
 * added before, by name. Images are sought from the working directory. If it fails, the builder may have part of it.
 */
PmStatus pm_builder_overrides(struct PmBuilder *builder,
                              const char *toml);

/**
 * Checks everything and makes the scene. A scene without a camera gets one that shows all of it, and one without a light the
 * environment "gradient", of which pm_scene_report() has a line. The builder may be changed and built again. `*scene`
 * is to be freed with pm_scene_free().
 */
PmStatus pm_builder_build(const struct PmBuilder *builder,
                          struct PmScene **scene);

/**
 * Frees a builder; NULL is ignored.
 */
void pm_builder_free(struct PmBuilder *builder);

/**
 * Copies the list of the Vulkan devices, one to a line: as pm_last_error(). A line has the index, name and kind of a device,
 * its Vulkan version, and whether it is suitable or what it lacks. After "gpu:", the index or a part of the name is a
 * PmDevice.backend. Returns 0 if there is no driver.
 */
size_t pm_devices(char *text,
                  size_t room);

/**
 * Makes a renderer: opens the device, uploads the scene, and traces a pilot pass if radii are derived.
 *
 * `settings`: a JSON object of settings, such as `{"photons": 100000, "errors": true}`; fields that are left out have
 * their defaults, and unknown ones are an error. NULL: all defaults. `device` may be NULL: the CPU. The scene may be
 * freed before the renderer. `*renderer` is to be freed with pm_renderer_free().
 */
PmStatus pm_renderer_new(const struct PmScene *scene,
                         const struct PmView *view,
                         const char *settings,
                         const struct PmDevice *device,
                         struct PmRenderer **renderer);

/**
 * Makes a renderer as pm_renderer_new() does, for about `seconds` of rendering, above 0 and finite, which begin now: settings that
 * `settings` leaves out are decided by the facts of a first pass, which is in no film, and passes that would take more than half
 * of the time have fewer paths and rays than are asked for: pm_renderer_report(). Passes are then rendered by
 * pm_renderer_passes() as long as there is time. Which settings were decided may depend on the speed of the machine.
 */
PmStatus pm_renderer_for_time(const struct PmScene *scene,
                              const struct PmView *view,
                              double seconds,
                              const char *settings,
                              const struct PmDevice *device,
                              struct PmRenderer **renderer);

/**
 * Renders the passes `first` to `first + count - 1` and adds them to the film. A pass depends on its index alone, so that
 * passes may be distributed over renderers and machines.
 *
 * `progress` may be NULL, and `user` is passed to it. `*done`, which may be NULL, is the number of passes that were
 * finished, even after an error. If the first pass of a film is stopped, the film has what was traced of it: such a film
 * can be shown, but neither merged nor written to a film file, and is to be taken before further passes if these have several
 * camera samples.
 */
PmStatus pm_renderer_passes(struct PmRenderer *renderer,
                            uint32_t first,
                            uint32_t count,
                            PmProgressFunction progress,
                            void *user,
                            uint32_t *done);

/**
 * Copies the film: the sums of all passes since the last pm_renderer_take(). `*film` is to be freed with pm_film_free().
 */
PmStatus pm_renderer_film(struct PmRenderer *renderer,
                          struct PmFilm **film);

/**
 * As pm_renderer_film(), and the renderer begins an empty film.
 */
PmStatus pm_renderer_take(struct PmRenderer *renderer, struct PmFilm **film);

/**
 * Copies a description of the device: as pm_last_error().
 */
size_t pm_renderer_device(const struct PmRenderer *renderer, char *text, size_t room);

/**
 * Copies what pm_renderer_for_time() has lowered, or nothing: as pm_last_error().
 */
size_t pm_renderer_report(const struct PmRenderer *renderer, char *text, size_t room);

/**
 * Frees a renderer; NULL is ignored. Films that it returned stay valid.
 */
void pm_renderer_free(struct PmRenderer *renderer);

/**
 * Numbers a pixel of a layer: 3 or 1; 0 if there is no such layer.
 */
uint32_t pm_layer_channels(uint32_t layer);

/**
 * Fills in `*info`, whose size has to be set.
 */
PmStatus pm_film_info(const struct PmFilm *film, struct PmFilmInfo *info);

/**
 * Adds the passes of `other`, which stays as it is. Scene, view, settings and device have to be the same, apart from the
 * seed, and no pass may be in both.
 */
PmStatus pm_film_merge(struct PmFilm *film,
                       const struct PmFilm *other);

/**
 * Copies one of PM_LAYER_…: rows from the top, the numbers of a pixel beside each other.
 *
 * `count` is the length of `values`, and has to be width times height times pm_layer_channels().
 */
PmStatus pm_film_layer(const struct PmFilm *film, uint32_t layer, float *values, size_t count);

/**
 * Copies the picture, denoised by Open Image Denoise 2 with PM_LAYER_ALBEDO and PM_LAYER_NORMAL, as the program does by --denoise:
 * rows from the top, 3 numbers a pixel. Where there is an error map, the mean of RGB stays within it.
 *
 * `count` is the length of `values`, and has to be 3 times width times height. The library is looked for in the packages of
 * Python, where `pip install pyoidn` puts it, and by the system; or the environment variable PHOTON_OIDN has its path. Without
 * it, the status is PM_STATUS_NO_DEVICE. Films with a transparent background cannot be denoised.
 */
PmStatus pm_film_denoise(const struct PmFilm *film,
                         float *values,
                         size_t count);

/**
 * Copies the automatic exposure of the picture, in stops: the one that the program uses, for pm_film_write(). It brings the
 * log-average luminance of surfaces, without the darkest and the brightest tenth, to 0.18.
 */
PmStatus pm_film_exposure(const struct PmFilm *film,
                          float *stops);

/**
 * Writes a picture or a film file; the ending decides. The file is replaced when it is complete. The path is UTF-8.
 *
 * .exr: all layers, linear. .png: the picture, tone-mapped, 8 bits; `exposure` in stops, finite:
 * that of pm_film_exposure(), for example. .film: the sums, to be
 * merged or continued by the program photonmap.
 */
PmStatus pm_film_write(const struct PmFilm *film, const char *path, float exposure);

/**
 * Reads a film file. `*film` is to be freed with pm_film_free().
 */
PmStatus pm_film_load(const char *path, struct PmFilm **film);

/**
 * Frees a film; NULL is ignored.
 */
void pm_film_free(struct PmFilm *film);

/**
 * Traces the photons of a pass of a scene on the CPU: as many paths as the setting `photons` says, each of which leaves a
 * photon at every surface that scatters diffusely.
 *
 * `settings` as for pm_renderer_new(). `*photons` is to be freed with pm_photons_free().
 */
PmStatus pm_photons_trace(const struct PmScene *scene,
                          const char *settings,
                          uint32_t pass,
                          struct PmPhotons **photons);

/**
 * Number of photons; 0 for NULL.
 */
size_t pm_photons_count(const struct PmPhotons *photons);

/**
 * Copies photons into arrays of `count` elements or triples, which has to be pm_photons_count().
 */
PmStatus pm_photons_copy(const struct PmPhotons *photons, const struct PmPhotonArrays *arrays, size_t count);

/**
 * Frees photons; NULL is ignored.
 */
void pm_photons_free(struct PmPhotons *photons);

/**
 * Makes a photon map of `count` photons; the arrays are copied.
 *
 * `positions`: 3 coordinates for each photon, finite. `normals`: those of the surfaces, 3 for each, of any length; NULL:
 * photons of all surfaces count. `powers`: flux in RGB, W, 3 for each; NULL: 1 W each. `*map` is to be freed with
 * pm_map_free().
 */
PmStatus pm_map_new(const float *positions,
                    const float *normals,
                    const float *powers,
                    size_t count,
                    struct PmMap **map);

/**
 * Finds the `k` nearest photons, above 0, of each of `count` points.
 *
 * `positions`: 3 coordinates for each point, finite. `max_radius`: photons farther away do not count; may be infinite.
 * `ids` and `squared_distances`, each of `count` times `k` elements, of which one may be NULL: rows of `k`, nearest
 * first, of equal distances the lowest index first; where there are fewer, UINT32_MAX and infinity.
 */
PmStatus pm_map_nearest(const struct PmMap *map,
                        const float *positions,
                        size_t count,
                        size_t k,
                        float max_radius,
                        uint32_t *ids,
                        float *squared_distances);

/**
 * Estimates irradiance, W/m² in RGB, at each of `count` points (Jensen 1996): the flux of the `k` nearest photons over the
 * area of their disc, whose radius is the distance of the farthest, which does not count itself.
 *
 * `positions` and `normals`: 3 for each point; photons count whose normal differs by at most 45 degrees, and all of them if
 * the map has no normals. `k`: at least 2. `max_radius`: largest radius, may be infinite; it is the radius where there are
 * fewer than `k` photons within. `irradiance`: 3 for each point.
 */
PmStatus pm_map_irradiance(const struct PmMap *map,
                           const float *positions,
                           const float *normals,
                           size_t count,
                           size_t k,
                           float max_radius,
                           float *irradiance);

/**
 * Frees a map; NULL is ignored.
 */
void pm_map_free(struct PmMap *map);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* PHOTONMAP_H */
