/* Bad input to every function: a status with words, and never a crash. The argument is the denoiser of the tests. */
#define _POSIX_C_SOURCE 200112L
#include <float.h>
#include <math.h>
#include <photonmap.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures;

/* Expects a status, and that the words contain `part`. */
#define EXPECT(call, expected, part) expect(call, expected, part, #call, __LINE__)
static void expect(PmStatus found, PmStatus expected, const char *part, const char *call, int line)
{
    char text[2000];
    pm_last_error(text, sizeof text);
    if (found != expected || (found != PM_STATUS_OK && !strstr(text, part))) {
        printf("line %d: %s\n  gave %d (%s), not %d with '%s'\n", line, call, (int)found, text, (int)expected, part);
        failures++;
    }
}
#define OK(call) EXPECT(call, PM_STATUS_OK, "")
#define BAD(call, part) EXPECT(call, PM_STATUS_INVALID_ARGUMENT, part)
#define TRUE(fact) ((fact) ? (void)0 : (void)(printf("line %d: not %s\n", __LINE__, #fact), failures++))

static int32_t stop(void *user, const PmProgress *progress)
{
    (void)progress;
    return *(int32_t *)user;
}

/* A ray caster that returns the same for every ray. */
typedef struct {
    PmHit hit;
    int32_t code;
} Same;

static int32_t same(void *user, const PmRay *rays, PmHit *hits, size_t count)
{
    const Same *result = user;
    (void)rays;
    for (size_t i = 0; i < count; i++)
        hits[i] = result->hit;
    return result->code;
}

static int32_t refuse(void *user, const float *positions, size_t vertices, const uint32_t *triangles, size_t count)
{
    (void)user, (void)positions, (void)vertices, (void)triangles, (void)count;
    return 5;
}

/* Limits on memory; `scene` is NULL. */
static void loading(PmScene *scene) {
    PmLoadOptions options = {sizeof options, NULL, 0};
    PmBuilder *builder = NULL;
    const char *path = "faults-loading.obj";
    FILE *file = fopen(path, "w");
    TRUE(file != NULL);
    if (file == NULL) return;
    fputs("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", file);
    fclose(file);
    OK(pm_builder_load_with(path, NULL, &builder));
    pm_builder_free(builder);
    OK(pm_builder_load_with(path, &options, &builder));
    pm_builder_free(builder);
    options.memory = 1 << 20;
    OK(pm_builder_load_with(path, &options, &builder));
    pm_builder_free(builder);
    options.memory = 20;
    EXPECT(pm_builder_load_with(path, &options, &builder), PM_STATUS_OUT_OF_MEMORY, "20 bytes");
    TRUE(builder == NULL);
    EXPECT(pm_scene_load_with(path, &options, &scene), PM_STATUS_OUT_OF_MEMORY, "allow more memory");
    options.overrides = "no-such-file.toml";
    EXPECT(pm_scene_load_with(path, &options, &scene), PM_STATUS_FILE, "no-such-file.toml");
    options.size = 1;
    BAD(pm_scene_load_with(path, &options, &scene), "PmLoadOptions");
    BAD(pm_scene_load_with(NULL, NULL, &scene), "file is NULL");
    remove(path);
}

/* Scattering of solids and around them; `material` is valid. */
static void media(PmMaterial material)
{
    PmScene *scene = NULL;
    PmBuilder *builder = NULL;
    PmMedium fog = {sizeof fog, {1, 2, 3}, {0, 0, 0}, 0.5, 0, PM_PHASE_HENYEY_GREENSTEIN, {{0}}};
    OK(pm_builder_new(&builder));
    BAD(pm_builder_medium(NULL, &fog), "builder is NULL");
    BAD(pm_builder_medium(builder, NULL), "PmMedium is NULL");
    OK(pm_builder_medium(builder, &fog));
    fog.anisotropy = 1;
    OK(pm_builder_medium(builder, &fog));
    EXPECT(pm_builder_build(builder, &scene), PM_STATUS_INVALID_SCENE, "anisotropy");
    /* Only Henyey and Greenstein's has it. */
    fog.phase = PM_PHASE_RAYLEIGH;
    OK(pm_builder_medium(builder, &fog));
    OK(pm_builder_build(builder, &scene));
    pm_scene_free(scene);
    fog.phase = PM_PHASE_MIE;
    fog.droplet_micrometres = 4;
    OK(pm_builder_medium(builder, &fog));
    EXPECT(pm_builder_build(builder, &scene), PM_STATUS_INVALID_SCENE, "droplet_micrometres");
    fog.phase = 3;
    BAD(pm_builder_medium(builder, &fog), "PmMedium.phase");
    fog.phase = PM_PHASE_HENYEY_GREENSTEIN;
    fog.anisotropy = 0;
    fog.scattering[1] = NAN;
    OK(pm_builder_medium(builder, &fog));
    EXPECT(pm_builder_build(builder, &scene), PM_STATUS_INVALID_SCENE, "scattering");
    fog.size = 1;
    BAD(pm_builder_medium(builder, &fog), "sizeof(PmMedium)");
    fog = (PmMedium){sizeof fog, {0, 0, 0}, {0, 0, 0}, 0, 0, 0, {{0}}};
    float densities[2] = {0, 1};
    PmGrid grid = {sizeof grid, NULL, densities, {2, 1, 1}, 0, {{0}}, 0};
    BAD(pm_builder_grid(builder, &grid), "PmGrid.material is 0");
    PmMaterial smoke = material;
    smoke.kind = PM_MATERIAL_DIELECTRIC;
    smoke.ior = 1;
    OK(pm_builder_material(builder, &smoke, &grid.material));
    BAD(pm_builder_grid(NULL, &grid), "builder is NULL");
    OK(pm_builder_grid(builder, &grid));
    grid.densities = NULL;
    BAD(pm_builder_grid(builder, &grid), "densities is NULL");
    grid.file = "absent.vol";
    EXPECT(pm_builder_grid(builder, &grid), PM_STATUS_FILE, "absent.vol");
    OK(pm_builder_medium(builder, &fog));
    /* Kinds that have no inside ignore it. */
    material.scattering[0] = -1;
    OK(pm_builder_material(builder, &material, NULL));
    OK(pm_builder_build(builder, &scene));
    pm_scene_free(scene);
    material.kind = PM_MATERIAL_DIELECTRIC;
    material.ior = 1;
    material.phase = 3;
    BAD(pm_builder_material(builder, &material, NULL), "PmMaterial.phase");
    material.phase = PM_PHASE_RAYLEIGH;
    OK(pm_builder_material(builder, &material, NULL));
    EXPECT(pm_builder_build(builder, &scene), PM_STATUS_INVALID_SCENE, "scattering");
    pm_builder_free(builder);
}

static void scenes(void)
{
    PmScene *scene = (PmScene *)&failures;
    PmBuilder *builder = NULL;
    PmSceneInfo info = {sizeof info, 0, 0, 0, 0, 0, 0, 0, {0, 0, 0}, 0, 0};
    uint32_t material;

    BAD(pm_scene_builtin("no-such-scene", &scene), "cornell-glass");
    TRUE(scene == NULL);
    BAD(pm_scene_builtin(NULL, &scene), "NULL");
    BAD(pm_scene_builtin("cornell", NULL), "NULL");
    BAD(pm_scene_builtin("\xff", &scene), "UTF-8");
    EXPECT(pm_scene_load("no-such-file.glb", NULL, &scene), PM_STATUS_FILE, "no-such-file");
    EXPECT(pm_scene_load("scene.xyz", NULL, &scene), PM_STATUS_FILE, ".gltf");
    BAD(pm_scene_load(NULL, NULL, &scene), "file is NULL");
    loading(scene);
    BAD(pm_scene_info(NULL, &info), "scene is NULL");
    TRUE(pm_scene_report(NULL, NULL, 0) == 0);
    BAD(pm_scene_triangle_sources(NULL, NULL, NULL, 0), "scene is NULL");

    BAD(pm_builder_new(NULL), "NULL");
    OK(pm_builder_new(&builder));
    PmMaterial white = {sizeof white, "white", PM_MATERIAL_LAMBERT, 0, {.5, .5, .5}, {0, 0, 0}, 0, {0, 0, 0}, 0, 0, 0, 0, 0, {0}, {0, 0, 0}, 0, 0, 0};
    PmMaterial wrong = white;
    BAD(pm_builder_material(builder, NULL, NULL), "PmMaterial is NULL");
    BAD(pm_builder_material(NULL, &white, NULL), "builder is NULL");
    wrong.kind = 99;
    BAD(pm_builder_material(builder, &wrong, NULL), "kind is 99");
    wrong.size = 0;
    BAD(pm_builder_material(builder, &wrong, NULL), "sizeof(PmMaterial)");
    OK(pm_builder_material(builder, &white, &material));
    media(white);

    double corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    uint32_t indices[3] = {0, 1, 2};
    PmMesh mesh = {sizeof mesh, "mesh", corners, NULL, 3, indices, 1, 7};
    BAD(pm_builder_mesh(builder, &mesh), "material is 7");
    mesh.material = material;
    mesh.vertex_count = SIZE_MAX / 2;
    BAD(pm_builder_mesh(builder, &mesh), "memory");
    mesh.vertex_count = SIZE_MAX / 16;
    BAD(pm_builder_mesh(builder, &mesh), "memory");
    mesh.vertex_count = 3, mesh.triangles = NULL;
    BAD(pm_builder_mesh(builder, &mesh), "triangles is NULL");
    mesh.triangles = indices;
    PmLight light = {sizeof light, "bulb", 9, {0, 0, 2}, {0, 0, 0}, {1, 1, 1}, 0, 0};
    BAD(pm_builder_light(builder, &light), "kind is 9");
    light.kind = PM_LIGHT_POINT;
    OK(pm_builder_light(builder, &light));
    BAD(pm_builder_camera(builder, NULL), "PmCamera is NULL");
    OK(pm_builder_mesh(builder, &mesh));
    BAD(pm_builder_overrides(builder, NULL), "toml is NULL");
    EXPECT(pm_builder_overrides(builder, "[[["), PM_STATUS_FILE, "overrides");
    EXPECT(pm_builder_overrides(builder, "[materials.gold]\nalbedo = [1, 1, 0]\n"), PM_STATUS_FILE, "gold");
    OK(pm_builder_overrides(builder, "[materials.white]\nalbedo = [0.1, 0.2, 0.3]\n"));
    OK(pm_builder_build(builder, &scene));
    pm_scene_free(scene);
    /* What only building finds. */
    corners[4] = NAN;
    OK(pm_builder_mesh(builder, &mesh));
    EXPECT(pm_builder_build(builder, &scene), PM_STATUS_INVALID_SCENE, "mesh 'mesh': vertex 1");
    TRUE(scene == NULL);
    pm_builder_free(builder);
    OK(pm_builder_new(&builder));
    wrong = white, wrong.color[0] = -1;
    OK(pm_builder_material(builder, &wrong, NULL));
    EXPECT(pm_builder_build(builder, &scene), PM_STATUS_INVALID_SCENE, "material 'white'");
    pm_builder_free(builder);
    BAD(pm_builder_build(NULL, &scene), "builder is NULL");

    /* A scene without a light gets one, and says so; an environment that is set is the light. */
    char text[1000];
    corners[4] = 0;
    mesh.material = 0;
    OK(pm_builder_new(&builder));
    OK(pm_builder_material(builder, &white, NULL));
    OK(pm_builder_mesh(builder, &mesh));
    OK(pm_builder_build(builder, &scene));
    TRUE(pm_scene_report(scene, text, sizeof text) > 0 && strstr(text, "\"gradient\"") && strstr(text, "pm_builder_environment()"));
    pm_scene_free(scene);
    BAD(pm_builder_environment(NULL, "constant", 0, 1), "builder is NULL");
    BAD(pm_builder_environment(builder, NULL, 0, 1), "light is NULL");
    BAD(pm_builder_environment(builder, "constant:1,2", 0, 1), "three numbers");
    EXPECT(pm_builder_environment(builder, "no-such-file.exr", 0, 1), PM_STATUS_FILE, "no-such-file");
    EXPECT(pm_builder_environment(builder, "sky:91,3", 0, 1), PM_STATUS_INVALID_SCENE, "91");
    EXPECT(pm_builder_environment(builder, "constant", NAN, 1), PM_STATUS_INVALID_SCENE, "NaN");
    OK(pm_builder_environment(builder, "gradient", 90, 2));
    OK(pm_builder_environment(builder, "constant:1,0.5,2", 90, 2));
    OK(pm_builder_build(builder, &scene));
    TRUE(pm_scene_report(scene, text, sizeof text) == 0);
    pm_scene_free(scene);
    OK(pm_builder_environment(builder, "sky:30,3", 0, 1));
    OK(pm_builder_build(builder, &scene));
    pm_scene_free(scene);
    pm_builder_free(builder);
}

/* The denoiser of the tests makes twice the colour plus the albedo plus the normal. */
static void denoising(const PmFilm *film, const char *library)
{
    float colour[8 * 6 * 3], albedo[8 * 6 * 3], normal[8 * 6 * 3], found[8 * 6 * 3];

    BAD(pm_film_denoise(NULL, found, 8 * 6 * 3), "film is NULL");
    BAD(pm_film_denoise(film, NULL, 8 * 6 * 3), "values is NULL");
    BAD(pm_film_denoise(film, found, 8 * 6), "144 numbers");
    setenv("PHOTON_OIDN", "/no/such/library.so", 1);
    EXPECT(pm_film_denoise(film, found, 8 * 6 * 3), PM_STATUS_NO_DEVICE, "pip install pyoidn");
    setenv("PHOTON_OIDN", library, 1);
    OK(pm_film_layer(film, PM_LAYER_PICTURE, colour, 8 * 6 * 3));
    OK(pm_film_layer(film, PM_LAYER_ALBEDO, albedo, 8 * 6 * 3));
    OK(pm_film_layer(film, PM_LAYER_NORMAL, normal, 8 * 6 * 3));
    OK(pm_film_denoise(film, found, 8 * 6 * 3));
    for (int i = 0; i < 8 * 6 * 3; i++)
        TRUE(found[i] == 2.0f * colour[i] + albedo[i] + normal[i]);
}

static void renderers(const PmScene *scene, const char *library)
{
    PmRenderer *renderer = NULL;
    PmFilm *film = NULL, *other = NULL;
    PmFilmInfo info = {sizeof info, 0, 0, 0, 0, 0, 0, 0, 0};
    PmView view = {sizeof view, NULL, 8, 6}, odd = {sizeof odd, NULL, 0, 6};
    const char *few = "{\"photons\": 500}";
    uint32_t done = 99;
    int32_t yes = 1, no = 0;
    float stops = 99, values[8 * 6 * 3];

    BAD(pm_renderer_new(scene, &odd, few, NULL, &renderer), "0x6");
    odd.width = UINT32_MAX, odd.height = UINT32_MAX;
    BAD(pm_renderer_new(scene, &odd, few, NULL, &renderer), "4294967295");
    odd = view, odd.camera = "elsewhere";
    EXPECT(pm_renderer_new(scene, &odd, few, NULL, &renderer), PM_STATUS_INVALID_SCENE, "elsewhere");
    BAD(pm_renderer_new(NULL, &view, few, NULL, &renderer), "scene is NULL");
    BAD(pm_renderer_new(scene, NULL, few, NULL, &renderer), "PmView is NULL");
    const char *settings[][2] = {
        {"", "settings"}, {"{", "settings"}, {"[1]", "object"}, {"{\"photon\": 3}", "photon"},
        {"{\"photons\": 0}", "photons is 0"}, {"{\"photons\": -1}", "-1"}, {"{\"photons\": 1e400}", "settings"},
        {"{\"alpha\": 2}", "alpha is 2"}, {"{\"index\": \"grid\"}", "grid"},
    };
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) {
        EXPECT(pm_renderer_new(scene, &view, settings[i][0], NULL, &renderer), PM_STATUS_INVALID_SETTINGS, settings[i][1]);
        TRUE(renderer == NULL);
    }
    PmDevice device = {sizeof device, "abacus", NULL, 0};
    BAD(pm_renderer_new(scene, &view, few, &device, &renderer), "abacus");
    device.backend = NULL, device.threads = UINT32_MAX;
    EXPECT(pm_renderer_new(scene, &view, few, &device, &renderer), PM_STATUS_INVALID_SETTINGS, "threads");
    device.size = 3;
    BAD(pm_renderer_new(scene, &view, few, &device, &renderer), "sizeof(PmDevice)");

    BAD(pm_renderer_for_time(scene, &view, 0, few, NULL, &renderer), "seconds is 0");
    BAD(pm_renderer_for_time(scene, &view, INFINITY, few, NULL, &renderer), "seconds is inf");
    OK(pm_renderer_for_time(scene, &view, 9, few, NULL, &renderer));
    OK(pm_renderer_passes(renderer, 0, 1, NULL, NULL, NULL));
    pm_renderer_free(renderer), renderer = NULL;

    OK(pm_renderer_new(scene, &view, few, NULL, &renderer));
    BAD(pm_renderer_passes(NULL, 0, 1, NULL, NULL, NULL), "renderer is NULL");
    BAD(pm_renderer_passes(renderer, UINT32_MAX, 1, NULL, NULL, &done), "passes");
    BAD(pm_renderer_passes(renderer, 1, UINT32_MAX, NULL, NULL, &done), "passes");
    OK(pm_renderer_passes(renderer, 0, 2, stop, &no, &done));
    TRUE(done == 2);
    EXPECT(pm_renderer_passes(renderer, 1, 1, NULL, NULL, &done), PM_STATUS_FILM, "twice");
    EXPECT(pm_renderer_passes(renderer, 2, 9, stop, &yes, &done), PM_STATUS_CANCELLED, "stopped");
    OK(pm_renderer_take(renderer, &film));
    BAD(pm_renderer_film(renderer, NULL), "NULL");
    OK(pm_renderer_film(renderer, &other));
    pm_renderer_free(renderer);

    BAD(pm_film_layer(film, PM_LAYER_PICTURE, values, 8 * 6), "144 numbers");
    BAD(pm_film_layer(film, 77, values, 8 * 6), "layer is 77");
    BAD(pm_film_layer(film, PM_LAYER_HALF_WIDTH, values, 8 * 6), "errors");
    BAD(pm_film_layer(film, PM_LAYER_PICTURE, NULL, 8 * 6 * 3), "values is NULL");
    BAD(pm_film_layer(NULL, PM_LAYER_PICTURE, values, 8 * 6 * 3), "film is NULL");
    OK(pm_film_layer(film, PM_LAYER_PICTURE, values, 8 * 6 * 3));
    denoising(film, library);
    EXPECT(pm_film_merge(film, film), PM_STATUS_FILM, "itself");
    BAD(pm_film_merge(film, NULL), "other is NULL");
    BAD(pm_film_merge(NULL, NULL), "film is NULL");
    OK(pm_film_merge(film, other));
    OK(pm_film_info(film, &info));
    TRUE(info.passes == 3 && info.width == 8 && !info.cut && !info.errors);
    info.size = 1;
    BAD(pm_film_info(film, &info), "sizeof(PmFilmInfo)");
    BAD(pm_film_write(film, "picture.bmp", 0), ".exr");
    BAD(pm_film_write(film, "picture.png", NAN), "exposure");
    BAD(pm_film_exposure(NULL, &stops), "film is NULL");
    BAD(pm_film_exposure(film, NULL), "stops is NULL");
    OK(pm_film_exposure(film, &stops));
    TRUE(stops > -20 && stops < 20);
    EXPECT(pm_film_write(film, "no/such/folder/a.exr", 0), PM_STATUS_FILE, "folder");
    pm_film_free(other);
    EXPECT(pm_film_load("no-such.film", &other), PM_STATUS_FILE, "no-such.film");
    pm_film_free(film);
}

static void casters(const PmScene *scene)
{
    PmRenderer *renderer = NULL;
    PmView view = {sizeof view, NULL, 8, 6};
    Same result = {{.1f, 0, .2f, .2f}, 0};
    PmCaster caster = {sizeof caster, &result, NULL, NULL, 0};
    PmDevice device = {sizeof device, "vulkan", &caster, 0};
    const char *few = "{\"photons\": 500}";

    BAD(pm_renderer_new(scene, &view, few, &device, &renderer), "cpu");
    device.backend = "cpu";
    BAD(pm_renderer_new(scene, &view, few, &device, &renderer), "nearest is NULL");
    caster.nearest = same, caster.prepare = refuse;
    EXPECT(pm_renderer_new(scene, &view, few, &device, &renderer), PM_STATUS_CASTER, "returned 5");
    caster.prepare = NULL;
    const struct {
        Same result;
        const char *part;
    } wrong[] = {
        {{{NAN, 0, 0, 0}, 0}, "t = NaN"},         {{{-1, 0, 0, 0}, 0}, "t = -1"},
        {{{INFINITY, 0, 0, 0}, 0}, "t = inf"},    {{{.1f, 1000000, 0, 0}, 0}, "triangle 1000000"},
        {{{.1f, 0, NAN, 0}, 0}, "u = NaN"},       {{{.1f, 0, 0, 7}, 0}, "v = 7"},
        {{{.1f, 0, .2f, .2f}, 3}, "returned 3"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        for (caster.batches = 0; caster.batches < 2; caster.batches++) {
            /* In the pilot pass. */
            result = wrong[i].result;
            EXPECT(pm_renderer_new(scene, &view, few, &device, &renderer), PM_STATUS_CASTER, wrong[i].part);
        }
    }
    /* Later, and again: the film has the passes before. */
    Same good = {{.1f, 0, .2f, .2f}, 0};
    PmFilm *film = NULL;
    PmFilmInfo info = {sizeof info, 0, 0, 0, 0, 0, 0, 0, 0};
    uint32_t done = 0;
    result = good;
    OK(pm_renderer_new(scene, &view, few, &device, &renderer));
    OK(pm_renderer_passes(renderer, 0, 1, NULL, NULL, &done));
    result.hit.primitive = 4000000000u;
    EXPECT(pm_renderer_passes(renderer, 1, 3, NULL, NULL, &done), PM_STATUS_CASTER, "triangle 4000000000");
    TRUE(done == 0);
    result = good;
    OK(pm_renderer_passes(renderer, 1, 1, NULL, NULL, &done));
    OK(pm_renderer_take(renderer, &film));
    OK(pm_film_info(film, &info));
    /* A pass that failed is not counted. */
    TRUE(info.passes == 2 && info.counted == 2 && info.paths >= 2 * 500 && info.photons > 0);
    /* A program that was compiled before there were counts. */
    info.size = offsetof(PmFilmInfo, paths), info.paths = 77, info.photons = 77;
    OK(pm_film_info(film, &info));
    TRUE(info.passes == 2 && info.paths == 77 && info.photons == 77);
    pm_film_free(film);
    pm_renderer_free(renderer);
}

static void maps(const PmScene *scene)
{
    PmMap *map = NULL;
    PmPhotons *photons = NULL;
    float points[9] = {0, 0, 0, 1, 0, 0, 3, 0, 0}, bad[3] = {0, NAN, 0}, up[3] = {0, 1, 0}, rgb[3], d2[4];
    uint32_t ids[4];

    BAD(pm_map_new(bad, NULL, NULL, 1, &map), "not finite");
    BAD(pm_map_new(points, bad, NULL, 1, &map), "normals");
    BAD(pm_map_new(NULL, NULL, NULL, 1, &map), "positions is NULL");
    BAD(pm_map_new(points, NULL, NULL, SIZE_MAX, &map), "memory");
    TRUE(map == NULL);
    OK(pm_map_new(NULL, NULL, NULL, 0, &map));
    OK(pm_map_nearest(map, points, 1, 4, INFINITY, ids, d2));
    TRUE(ids[0] == UINT32_MAX && isinf(d2[0]));
    pm_map_free(map);
    OK(pm_map_new(points, NULL, NULL, 3, &map));
    OK(pm_map_nearest(map, points, 1, 4, 1, ids, d2));
    TRUE(ids[0] == 0 && ids[1] == 1 && d2[1] == 1 && ids[2] == UINT32_MAX && ids[3] == UINT32_MAX && isinf(d2[3]));
    BAD(pm_map_nearest(map, bad, 1, 4, 1, ids, d2), "not finite");
    BAD(pm_map_nearest(map, points, 1, 4, NAN, ids, d2), "max_radius");
    BAD(pm_map_nearest(map, points, 1, 0, 1, ids, d2), "k is 0");
    BAD(pm_map_nearest(map, points, 1, 4, 1, NULL, NULL), "are NULL");
    BAD(pm_map_nearest(map, points, 3, SIZE_MAX, 1, ids, d2), "memory");
    BAD(pm_map_nearest(map, points, 1, SIZE_MAX / 2, 1, ids, d2), "memory");
    BAD(pm_map_nearest(NULL, points, 1, 4, 1, ids, d2), "map is NULL");
    BAD(pm_map_irradiance(map, points, up, 1, 1, 1, rgb), "k is 1");
    BAD(pm_map_irradiance(map, points, up, 1, 2, 0, rgb), "max_radius");
    BAD(pm_map_irradiance(map, points, NULL, 1, 2, 1, rgb), "normals is NULL");
    OK(pm_map_irradiance(map, points, up, 1, 2, INFINITY, rgb));
    TRUE(fabsf(rgb[0] - 0.31831f) < 1e-4f);
    pm_map_free(map);

    BAD(pm_photons_trace(NULL, NULL, 0, &photons), "scene is NULL");
    EXPECT(pm_photons_trace(scene, "{\"photons\": 0}", 0, &photons), PM_STATUS_INVALID_SETTINGS, "photons is 0");
    TRUE(pm_photons_count(NULL) == 0);
    OK(pm_photons_trace(scene, "{\"photons\": 100}", 0, &photons));
    PmPhotonArrays none = {sizeof none, NULL, NULL, NULL, NULL, NULL};
    BAD(pm_photons_copy(photons, &none, 1), "count is 1");
    OK(pm_photons_copy(photons, &none, pm_photons_count(photons)));
    pm_photons_free(photons);
}

int main(int argc, char **argv)
{
    PmScene *scene = NULL;
    char small[4];

    TRUE(pm_last_error(NULL, 0) == 0);
    scenes();
    OK(pm_scene_builtin("cornell", &scene));
    TRUE(pm_scene_mesh_name(scene, 999, small, sizeof small) == 0);
    TRUE(pm_scene_mesh_name(scene, 0, small, sizeof small) > 0 && strlen(small) == 3);
    TRUE(argc == 2);
    renderers(scene, argc == 2 ? argv[1] : "");
    casters(scene);
    maps(scene);
    pm_scene_free(scene);
    pm_scene_free(NULL), pm_builder_free(NULL), pm_renderer_free(NULL), pm_film_free(NULL), pm_map_free(NULL);
    pm_photons_free(NULL);
    printf("%d failures\n", failures);
    return failures != 0;
}
