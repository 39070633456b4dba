// Anisotropic GGX reflection: twin of photon-core's anisotropy.rs. Kernels call it if ANISOTROPY of shade.glsl is true.
// `widths` are those along and across the tangent; directions are in the frame of tangent, bitangent and normal.
#ifndef ANISOTROPY_GLSL
#define ANISOTROPY_GLSL

#include "shading/constants.glsl"
#include "shading/layers.glsl"
#include "shading/math.glsl"
#include "shading/sampling.glsl"

vec2 anisotropy_widths(float roughness, float strength) {
    precise float across = roughness * roughness;
    precise float along = across + (1.0 - across) * (strength * strength);
    return max(vec2(along, across), vec2(GGX_MIN_ALPHA));
}

float anisotropy_equivalent_roughness(vec2 widths) {
    precise float square = 0.5 * (widths.x * widths.x + widths.y * widths.y);
    return sqrt(sqrt(square));
}

float anisotropy_distribution(vec2 widths, vec3 h) {
    precise float x = h.x / widths.x;
    precise float y = h.y / widths.y;
    precise float root = x * x + y * y + h.z * h.z;
    precise float density = 1.0 / (3.14159265 * (widths.x * widths.y) * (root * root));
    return density;
}

float anisotropy_spread(vec2 widths, vec3 w) {
    precise float x = widths.x * w.x;
    precise float y = widths.y * w.y;
    precise float square = x * x + y * y + w.z * w.z;
    return sqrt(square);
}

float anisotropy_visibility(vec2 widths, vec3 o, vec3 i) {
    precise float visibility = 0.5 / (o.z * anisotropy_spread(widths, i) + i.z * anisotropy_spread(widths, o));
    return visibility;
}

float anisotropy_bound(vec2 widths, vec3 o) {
    float least = min(widths.x, widths.y);
    precise float squared = least * least;
    precise float sine = o.x * o.x + o.y * o.y;
    precise float s = 1.0 + sqrt(sine);
    precise float stretched = s * s;
    precise float bound = (1.0 - squared) * stretched / (stretched + squared * (o.z * o.z));
    return bound;
}

// The reflection of `o` at a visible normal.
vec3 anisotropy_sample(vec2 widths, vec3 o, float u, float v) {
    precise float x = widths.x * o.x;
    precise float y = widths.y * o.y;
    precise float square = x * x + y * y + o.z * o.z;
    precise float inverse = 1.0 / sqrt(square);
    precise float top = o.z * inverse;
    precise float b = anisotropy_bound(widths, o) * top;
    precise float versine = u * (1.0 + b);
    precise float square_of_sine = versine * (2.0 - versine);
    float sine = sqrt(max(square_of_sine, 0.0));
    precise float z = 1.0 - versine;
    vec2 sin_cos = sin_cos_turns(v);
    precise vec3 h =
        vec3(widths.x * (sine * sin_cos.y + x * inverse), widths.y * (sine * sin_cos.x + y * inverse), z + top);
    h = normalize_or(h, vec3(0.0, 0.0, 1.0));
    precise vec3 reflected = h * (2.0 * dot3(o, h)) - o;
    return reflected;
}

float anisotropy_pdf(vec2 widths, vec3 o, vec3 h) {
    precise float pdf = anisotropy_distribution(widths, h)
        / (2.0 * (anisotropy_bound(widths, o) * o.z + anisotropy_spread(widths, o)));
    return pdf;
}

void anisotropy_frame(vec3 given, vec3 normal, out vec3 tangent, out vec3 bitangent) {
    precise vec3 across = given - normal * dot3(normal, given);
    vec3 once = normalize_or(across, vec3(0.0));
    // Of a tangent that is nearly parallel, the first difference consists of rounding errors.
    precise vec3 rest = once - normal * dot3(normal, once);
    if (!(dot3(rest, rest) > 0.25)) {
        sampling_basis(normal, tangent, bitangent);
        return;
    }
    tangent = normalize_or(rest, vec3(1.0, 0.0, 0.0));
    bitangent = cross3(normal, tangent);
}

// The anisotropy in a word of a query whose shading normal is `normal`; 0 without any.
uint anisotropy_pack(Layers layers, vec3 normal) {
    if (!(layers.anisotropy > 0.0)) return 0u;
    vec3 x, y;
    sampling_basis(normal, x, y);
    float across = dot3(layers.tangent, y), along = dot3(layers.tangent, x);
    precise float turns =
        turns_of(abs(across), across < 0.0 ? -along : along) * (2.0 * ANISOTROPY_DIRECTIONS) + 0.5;
    precise float strength = min(layers.anisotropy, 1.0) * ANISOTROPY_STRENGTHS + 0.5;
    return 1u << 31 | uint(strength) << 16 | uint(turns) & 0xFFFFu;
}

bool anisotropy_is_packed(uint word) { return word >> 31 != 0u; }

uint anisotropy_path_word(uint path, uint word) { return anisotropy_is_packed(word) ? word : path & 0x7FFFFFFFu; }

// Strength and tangent of a word; 0 of a word without them.
float anisotropy_unpack(uint word, vec3 normal, out vec3 tangent) {
    precise float turns = float(word & 0xFFFFu) / (2.0 * ANISOTROPY_DIRECTIONS);
    vec2 sin_cos = sin_cos_turns(turns);
    vec3 x, y;
    sampling_basis(normal, x, y);
    precise vec3 along = x * sin_cos.y + y * sin_cos.x;
    precise float strength = float(word >> 16 & 0x7FFFu) / ANISOTROPY_STRENGTHS;
    tangent = along;
    return anisotropy_is_packed(word) ? strength : 0.0;
}

#endif
