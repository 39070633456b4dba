// Lines through portals: twin of photon-core's portals.rs. The including kernel declares FEATURES.
#ifndef PORTALS_GLSL
#define PORTALS_GLSL

#include "shading/constants.glsl"
#include "shading/sampling.glsl"

const bool PORTALS = (FEATURES & FEATURE_PORTALS) != 0u;

const float PORTAL_DISC_SHARE = 0.5;
const uint PORTAL_DISC_WORDS = 1u << 31;
const float PORTAL_NO_AREA = 1e-25;

struct Portal {
    vec3 corner;
    // The other corners, relative to it.
    vec3 edges[2];
    // A normal as long as the triangle's area.
    vec3 area;
};

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer PortalTable { Portal at; };

struct PortalLine {
    vec3 across;
    float factor;
};

float portal_projected_area(vec3 area, vec3 direction) {
    return abs(dot3(area, direction));
}

float portal_sum(float a, float b) {
    precise float sum = a + b;
    return sum;
}

float portal_total_area(PortalTable portals, uint count, vec3 direction) {
    float total = 0.0;
    for (uint i = 0u; i < count; i++) {
        Portal portal = portals[i].at;
        total = portal_sum(total, portal_projected_area(portal.area, direction));
    }
    return total;
}

// In functions of their own, since the compiler does not support `precise` on values just loaded.
bool portal_triangle_crosses(vec3 corner, vec3 first, vec3 second, vec3 area, vec3 across, vec3 direction) {
    precise vec3 from_corner = across - corner;
    precise float twice = 2.0 * dot3(area, direction);
    float side = twice < 0.0 ? -1.0 : 1.0;
    precise float u = side * dot3(from_corner, cross3(second, direction));
    precise float v = side * dot3(from_corner, cross3(direction, first));
    precise float sum = u + v;
    return u >= 0.0 && v >= 0.0 && sum <= side * twice;
}

bool portal_crosses(PortalTable portals, uint index, vec3 across, vec3 direction) {
    Portal portal = portals[index].at;
    return portal_triangle_crosses(portal.corner, portal.edges[0], portal.edges[1], portal.area, across, direction);
}

uint portal_choose(PortalTable portals, uint count, vec3 direction, float target) {
    float sum = 0.0;
    uint chosen = 0u;
    for (uint i = 0u; i < count; i++) {
        Portal portal = portals[i].at;
        float area = portal_projected_area(portal.area, direction);
        if (area > 0.0 && sum <= target) chosen = i;
        sum = portal_sum(sum, area);
    }
    return chosen;
}

vec3 portal_triangle_through(vec3 corner, vec3 one, vec3 two, vec3 direction, vec2 weights) {
    precise vec3 point = corner + one * weights.x + two * weights.y;
    precise vec3 across = point - direction * dot3(point, direction);
    return across;
}

vec3 portal_through(PortalTable portals, uint index, vec3 direction, vec2 at) {
    Portal portal = portals[index].at;
    vec2 weights = sampling_triangle(at.x, at.y);
    return portal_triangle_through(portal.corner, portal.edges[0], portal.edges[1], direction, weights);
}

vec3 portal_disc(vec3 direction, vec2 at, float radius) {
    vec2 point = sampling_disc(at.x, at.y);
    vec3 tangent, bitangent;
    sampling_basis(direction, tangent, bitangent);
    precise vec3 across = (tangent * point.x + bitangent * point.y) * radius;
    return across;
}

float portal_factor(float total, float crossed, float radius) {
    precise float disc = 3.14159265 * radius * radius;
    precise float factor = total / (PORTAL_DISC_SHARE * total + (1.0 - PORTAL_DISC_SHARE) * crossed * disc);
    return factor;
}

float portal_target(uint choice, float total) {
    precise float target = float((choice - PORTAL_DISC_WORDS) >> 8) * (1.0 / 8388608.0) * total;
    return target;
}

// A line along `direction`; `choice` is a random word, `at` are two uniform numbers, `radius` is that of the disc.
PortalLine portals_sample(PortalTable portals, uint count, vec3 direction, uint choice, vec2 at, float radius) {
    float total = portal_total_area(portals, count, direction);
    bool seen = total > PORTAL_NO_AREA;
    uint chosen = count;
    PortalLine line;
    if (seen && choice >= PORTAL_DISC_WORDS) {
        chosen = portal_choose(portals, count, direction, portal_target(choice, total));
        line.across = portal_through(portals, chosen, direction, at);
    } else {
        line.across = portal_disc(direction, at, radius);
    }
    line.factor = 1.0;
    if (seen) {
        uint crossed = 0u;
        for (uint i = 0u; i < count; i++) {
            if (i == chosen || portal_crosses(portals, i, line.across, direction)) crossed++;
        }
        line.factor = portal_factor(total, float(crossed), radius);
    }
    return line;
}

// The origin of a photon, `away` from the plane across its direction.
vec3 portal_origin(vec3 across, vec3 direction, float away) {
    precise vec3 origin = across - direction * away;
    return origin;
}

vec3 portal_power(vec3 carried, float factor) {
    precise vec3 power = carried * factor;
    return power;
}

// The same for the disc of a sun, whose points are uniform across `along`, not across the photon's direction.
vec3 portal_sun_power(vec3 carried, float factor, vec3 direction, vec3 along) {
    precise vec3 power = carried * (factor / dot3(direction, along));
    return power;
}

#endif
