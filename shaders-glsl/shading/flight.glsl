// Flights of photons through a medium, and the photons that they leave. Twin of photon-core's flight.rs.
#ifndef FLIGHT_GLSL
#define FLIGHT_GLSL

#include "shading/constants.glsl"
#include "shading/layout.glsl"
#include "shading/math.glsl"

// The length of a flight that meets nothing.
const float FLIGHT_ENDLESS = 3.402823466e38;

vec3 flight_sum(vec3 a, vec3 b) {
    precise vec3 sum = a + b;
    return sum;
}

float flight_total(vec3 v) {
    precise float sum = v.x + v.y + v.z;
    return sum;
}

// In functions, since `precise` variables computed from members of a record make the compiler hang.
vec3 medium_extinction(Medium medium) { return flight_sum(medium.absorption, medium.scattering); }

bool medium_scatters(Medium medium) { return medium.scattering != vec3(0.0); }

// Shares of the channels in a power; even for a power of 0.
vec3 flight_shares(vec3 power) {
    float sum = flight_total(power);
    precise vec3 shares = power / sum;
    return sum > 0.0 ? shares : vec3(0.33333333);
}

// The channel that `u` in [0, 1) chooses.
uint flight_channel(vec3 shares, float u) {
    bool green = u >= shares.x;
    precise float both = shares.x + shares.y;
    // The last channel may have a share of 0, and sums are rounded.
    if (u >= both && shares.z > 0.0) return 2u;
    if (green && shares.y > 0.0) return 1u;
    if (shares.x > 0.0) return 0u;
    return shares.y > 0.0 ? 1u : 2u;
}

float flight_of(vec3 channels, uint channel) {
    return channel == 0u ? channels.x : channel == 1u ? channels.y : channels.z;
}

vec3 exp_neg3(vec3 depth) { return vec3(exp_neg(depth.x), exp_neg(depth.y), exp_neg(depth.z)); }

vec3 flight_depth(vec3 extinction, float far) {
    precise vec3 depth = extinction * far;
    return depth;
}

// exp(-depth) of each channel over that of the clearest.
vec3 flight_relative(vec3 depth) {
    precise vec3 rest = depth - min(min(depth.x, depth.y), depth.z);
    return exp_neg3(rest);
}

// A collision, or none: then `power` reaches the end of the stretch.
struct Flight {
    bool collides;
    // Distance from the start of the flight.
    float distance;
    // Power that is scattered there, times the inverse of the probability that it is not absorbed.
    vec3 power;
    // That probability.
    float albedo;
};

// The length of a flight of `power` through a medium up to a collision, > 0.
float flight_length(Medium medium, vec3 power, float u, float v) {
    float coefficient = flight_of(medium_extinction(medium), flight_channel(flight_shares(power), u));
    precise float far = minus_ln_one_minus(v) / coefficient;
    // A coefficient of 0 would give infinity, or NaN.
    return coefficient > 0.0 ? max(far, 1.17549435e-38) : FLIGHT_ENDLESS;
}

// The end of a flight at the distance `far`: a collision, or the end of its stretch.
Flight flight_ended(Medium medium, vec3 power, bool collides, float far) {
    vec3 extinction = medium_extinction(medium), scattering = medium.scattering;
    vec3 shares = flight_shares(power);
    if (!collides) {
        vec3 left = flight_relative(flight_depth(extinction, far));
        precise vec3 passed = power * left / dot3(shares, left);
        return Flight(false, far, passed, 1.0);
    }
    vec3 left = flight_relative(flight_depth(extinction, far));
    precise vec3 density = extinction * left;
    precise vec3 scattered = power * scattering * left / dot3(shares, density);
    float all = flight_total(power);
    precise float share = flight_total(scattered) / all;
    float albedo = all > 0.0 ? clamp(share, 0.0, 1.0) : 0.0;
    precise vec3 survivors = scattered / albedo;
    return Flight(true, far, albedo > 0.0 ? survivors : vec3(0.0), albedo);
}

// A flight of `power` through a medium, whose stretch ends at distance `end`.
Flight flight_sample(Medium medium, vec3 power, float end, float u, float v) {
    float far = flight_length(medium, power, u, v);
    return flight_ended(medium, power, far < end, min(far, end));
}

// Probability of a collision of one channel, and the density of places at the start.
vec2 flight_share(float coefficient, float end) {
    precise float depth = coefficient * end;
    float collides = one_minus_exp(depth);
    precise float density = coefficient / collides;
    precise float even = 1.0 / end;
    // In the limit of no extinction, places are even.
    return depth > 1e-20 ? vec2(collides, density) : vec2(depth, even);
}

// Distance of one of `count` photons left on a stretch of length `end`, and its power in `left`.
float flight_deposit(Medium medium, vec3 power, float end, uint count, float u, float v, out vec3 left) {
    vec3 extinction = medium_extinction(medium), scattering = medium.scattering;
    vec3 shares = flight_shares(power);
    vec2 x = flight_share(extinction.x, end), y = flight_share(extinction.y, end), z = flight_share(extinction.z, end);
    uint chosen = flight_channel(shares, u);
    float collides = flight_of(vec3(x.x, y.x, z.x), chosen);
    precise float even = v * end;
    precise float within = v * collides;
    precise float drawn = minus_ln_one_minus(within) / flight_of(extinction, chosen);
    float far = min(collides > 1e-20 ? drawn : even, end);
    vec3 passing = flight_relative(flight_depth(extinction, far));
    precise vec3 density = vec3(x.y, y.y, z.y) * passing;
    precise vec3 scattered = scattering * passing;
    precise vec3 stored = power * scattered / (dot3(shares, density) * float(count));
    left = stored;
    return far;
}

// Roulette at a collision at `position`, in a medium without bounds; `start` is the power that the path started with. Whether
// it goes on, then with the power `left`.
bool flight_thinned(vec3 power, vec3 start, vec3 position, float u, out vec3 left) {
    precise float far = sqrt(dot3(position, position));
    precise float chance = flight_total(power) / (flight_total(start) * (far * sqrt(far)));
    precise vec3 survivor = power / chance;
    bool thins = far > 1.0 && chance < 1.0;
    left = thins ? survivor : power;
    return !thins || u < chance;
}

// Transmittance of each channel over a distance: Beer and Lambert's law.
vec3 medium_transmittance(Medium medium, float far) {
    return exp_neg3(flight_depth(medium_extinction(medium), far));
}

#endif
