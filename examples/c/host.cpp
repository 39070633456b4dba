// Example: a program with a scene, a ray caster and photons of its own.
//
// The scene is a white floor with a triangular prism of glass under a point light, made of arrays. The ray caster tests
// every triangle; that of another renderer can take its place. Its picture is compared with that of the library's ray
// caster, and the irradiance from photons with the closed form.
//
//     c++ -std=c++17 host.cpp $(pkg-config --cflags --libs photonmap) -o host && ./host
#include <photonmap.h>

#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

void check(PmStatus status) {
    if (status == PM_STATUS_OK) return;
    std::string text(pm_last_error(nullptr, 0) + 1, '\0');
    pm_last_error(text.data(), text.size());
    throw std::runtime_error(text);
}

// A handle that is freed at the end of its life: `Handle<PmScene, pm_scene_free>`.
template <auto Free> struct Freed {
    template <class T> void operator()(T *handle) const { Free(handle); }
};
template <class T, auto Free> using Handle = std::unique_ptr<T, Freed<Free>>;
using Scene = Handle<PmScene, pm_scene_free>;
using Renderer = Handle<PmRenderer, pm_renderer_free>;
using Film = Handle<PmFilm, pm_film_free>;

// Calls `make` with a pointer to a handle, which becomes the result.
template <class H, class Make> H made(Make make) {
    typename H::pointer handle = nullptr;
    check(make(&handle));
    return H(handle);
}

using Vec = std::array<float, 3>;
Vec operator-(Vec a, Vec b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
float dot(Vec a, Vec b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec cross(Vec a, Vec b) { return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}; }

// Tests every triangle (Moeller and Trumbore 1997).
class Caster {
    struct Triangle { Vec corner, first, second; };
    std::vector<Triangle> triangles;

public:
    std::atomic<size_t> calls{0}, rays{0}, longest{0};

    static int32_t prepare(void *user, const float *positions, size_t, const uint32_t *indices, size_t count) {
        auto at = [&](uint32_t vertex) { return Vec{positions[3 * vertex], positions[3 * vertex + 1], positions[3 * vertex + 2]}; };
        for (size_t i = 0; i < count; i++) {
            Vec a = at(indices[3 * i]);
            static_cast<Caster *>(user)->triangles.push_back({a, at(indices[3 * i + 1]) - a, at(indices[3 * i + 2]) - a});
        }
        return 0;
    }

    // Many threads call this at once.
    static int32_t nearest(void *user, const PmRay *rays, PmHit *hits, size_t count) {
        auto &self = *static_cast<Caster *>(user);
        self.calls++, self.rays += count;
        for (size_t longest = self.longest; longest < count && !self.longest.compare_exchange_weak(longest, count);) {}
        for (size_t r = 0; r < count; r++) {
            Vec origin{rays[r].origin[0], rays[r].origin[1], rays[r].origin[2]};
            Vec direction{rays[r].direction[0], rays[r].direction[1], rays[r].direction[2]};
            float nearest = rays[r].t_max;
            for (size_t i = 0; i < self.triangles.size(); i++) {
                const Triangle &t = self.triangles[i];
                Vec p = cross(direction, t.second), from = origin - t.corner, q = cross(from, t.first);
                float determinant = dot(t.first, p), u = dot(from, p) / determinant, v = dot(direction, q) / determinant;
                float distance = dot(t.second, q) / determinant;
                if (u >= 0 && v >= 0 && u + v <= 1 && distance >= 0 && distance < nearest) {
                    nearest = distance;
                    hits[r] = PmHit{distance, static_cast<uint32_t>(i), u, v};
                }
            }
        }
        return 0;
    }
};

constexpr double HEIGHT = 2.0, INTENSITY = 10.0;

Scene make_scene() {
    auto builder = made<Handle<PmBuilder, pm_builder_free>>(pm_builder_new);
    auto mesh = [&](const char *name, PmMaterial material, std::vector<double> positions, std::vector<uint32_t> triangles) {
        PmMesh mesh{};
        material.size = sizeof material, mesh.size = sizeof mesh;
        mesh.name = material.name = name;
        check(pm_builder_material(builder.get(), &material, &mesh.material));
        mesh.positions = positions.data(), mesh.vertex_count = positions.size() / 3;
        mesh.triangles = triangles.data(), mesh.triangle_count = triangles.size() / 3;
        check(pm_builder_mesh(builder.get(), &mesh));
    };
    PmMaterial white{}, glass{};
    for (double &part : white.color) part = 0.5;
    glass.kind = PM_MATERIAL_DIELECTRIC, glass.ior = 1.5;
    for (double &part : glass.color) part = 1.0;
    // The second triangle of the floor has no area and is dropped.
    mesh("floor", white, {-2, 0, 2, 2, 0, 2, 2, 0, -2, -2, 0, -2}, {0, 1, 2, 0, 0, 1, 0, 2, 3});
    mesh("prism", glass, {.6, .2, .5, 1.4, .2, .5, 1, .9, .5, .6, .2, -.5, 1.4, .2, -.5, 1, .9, -.5},
         {0, 1, 2, 3, 5, 4, 0, 4, 1, 0, 3, 4, 1, 5, 2, 1, 4, 5, 2, 3, 0, 2, 5, 3});
    PmLight light{};
    light.size = sizeof light, light.name = "bulb", light.kind = PM_LIGHT_POINT, light.position[1] = HEIGHT;
    for (double &part : light.color) part = INTENSITY;
    check(pm_builder_light(builder.get(), &light));
    PmCamera camera{sizeof camera, "front", {0, 2.5, 4}, {0, 0.2, 0}, {0, 1, 0}, 0.8, 0, 0, 0};
    check(pm_builder_camera(builder.get(), &camera));
    return made<Scene>([&](PmScene **scene) { return pm_builder_build(builder.get(), scene); });
}

// Which triangle of the arrays each triangle is that a ray caster sees.
void show_sources(const PmScene *scene) {
    PmSceneInfo info{};
    info.size = sizeof info;
    check(pm_scene_info(scene, &info));
    std::vector<uint32_t> meshes(info.triangles), triangles(info.triangles);
    check(pm_scene_triangle_sources(scene, meshes.data(), triangles.data(), info.triangles));
    // Meshes are in an order of their own.
    size_t second = 1;
    while (meshes[second - 1] != 0) ++second;
    std::printf("%zu triangles; number %zu is triangle %u of mesh %u\n", info.triangles, second, triangles[second],
                meshes[second]);
    if (info.dropped != 1 || meshes[second] != 0 || triangles[second] != 2) throw std::runtime_error("wrong triangle");
}

constexpr uint32_t WIDTH = 48, HEIGHT_PIXELS = 32;

// Renders `passes` passes, or until `progress` stops it; the status goes to `status`.
Film render(const PmScene *scene, const PmCaster *caster, uint32_t passes, PmProgressFunction progress, PmStatus &status) {
    PmView view{sizeof view, "front", WIDTH, HEIGHT_PIXELS};
    PmDevice device{sizeof device, "cpu", caster, 0};
    auto renderer = made<Renderer>([&](PmRenderer **renderer) {
        return pm_renderer_new(scene, &view, R"({"photons": 20000})", &device, renderer);
    });
    status = pm_renderer_passes(renderer.get(), 0, passes, progress, nullptr, nullptr);
    return made<Film>([&](PmFilm **film) { return pm_renderer_take(renderer.get(), film); });
}

std::vector<float> picture(const PmFilm *film) {
    std::vector<float> values(WIDTH * HEIGHT_PIXELS * 3);
    check(pm_film_layer(film, PM_LAYER_PICTURE, values.data(), values.size()));
    return values;
}

void compare_casters(const PmScene *scene) {
    Caster own;
    PmCaster caster{sizeof caster, &own, Caster::prepare, Caster::nearest, 1};
    PmStatus status;
    auto ours = picture(render(scene, nullptr, 4, nullptr, status).get());
    check(status);
    auto theirs = picture(render(scene, &caster, 4, nullptr, status).get());
    check(status);
    double sum = 0, difference = 0;
    for (size_t i = 0; i < ours.size(); i++) sum += ours[i], difference += std::abs(ours[i] - theirs[i]);
    std::printf("casters differ by %.1e of the mean; %zu rays in %zu calls, %zu in the longest\n", difference / sum,
                own.rays.load(), own.calls.load(), own.longest.load());
    if (!(difference < 0.01 * sum)) throw std::runtime_error("the pictures differ by more than rounding explains");
}

void cancel(const PmScene *scene) {
    PmStatus status;
    auto stop = [](void *, const PmProgress *progress) -> int32_t { return progress->done == 2; };
    auto film = render(scene, nullptr, 100, stop, status);
    PmFilmInfo info{};
    info.size = sizeof info;
    check(pm_film_info(film.get(), &info));
    if (status != PM_STATUS_CANCELLED || info.passes > 3) throw std::runtime_error("it was not stopped");
    std::printf("stopped after %u passes\n", info.passes);
}

// Photons from the library, as they could come from another program, and irradiance from them.
void estimate(const PmScene *scene) {
    auto photons = made<Handle<PmPhotons, pm_photons_free>>([&](PmPhotons **photons) {
        return pm_photons_trace(scene, R"({"photons": 200000})", 0, photons);
    });
    size_t count = pm_photons_count(photons.get());
    std::vector<double> wide(3 * count);
    std::vector<float> normals(3 * count), powers(3 * count);
    PmPhotonArrays arrays{sizeof arrays, wide.data(), normals.data(), nullptr, powers.data(), nullptr};
    check(pm_photons_copy(photons.get(), &arrays, count));
    std::vector<float> positions(wide.begin(), wide.end());
    auto map = made<Handle<PmMap, pm_map_free>>([&](PmMap **map) {
        return pm_map_new(positions.data(), normals.data(), powers.data(), count, map);
    });
    float at[6] = {0, 0, 0, -1, 0, 0}, up[6] = {0, 1, 0, 0, 1, 0}, found[6];
    check(pm_map_irradiance(map.get(), at, up, 2, 500, INFINITY, found));
    for (int i = 0; i < 2; i++) {
        double squared = HEIGHT * HEIGHT + at[3 * i] * at[3 * i];
        double expected = INTENSITY * HEIGHT / (squared * std::sqrt(squared));
        std::printf("irradiance at x = %g: %.3f, expected %.3f W/m2\n", at[3 * i], found[3 * i], expected);
        // 500 photons: a standard error of 4.5 %.
        if (!(std::abs(found[3 * i] / expected - 1) < 0.2)) throw std::runtime_error("the irradiance is wrong");
    }
}

} // namespace

int main() {
    try {
        Scene scene = make_scene();
        show_sources(scene.get());
        compare_casters(scene.get());
        cancel(scene.get());
        estimate(scene.get());
    } catch (const std::exception &error) {
        std::fprintf(stderr, "error: %s\n", error.what());
        return 1;
    }
}
