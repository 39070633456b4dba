// Selects a light among many. Twin of photon-core's light_tree.rs: the same thresholds except for the rounding of
// divisions and square roots; probabilities are multiplied in f32.
#ifndef LIGHT_TREE_GLSL
#define LIGHT_TREE_GLSL

#include "shading/constants.glsl"
#include "shading/layout.glsl"
#include "shading/math.glsl"
#include "shading/octahedral.glsl"
#include "shading/scene.glsl"

const bool LIGHT_TREE = (FEATURES & FEATURE_LIGHT_TREE) != 0u;

// Angles between 0 and pi are vectors (cosine, sine) of any length.
vec2 angle_between(vec3 a, vec3 b) {
    vec3 normal = cross3(a, b);
    return vec2(dot3(a, b), sqrt(dot3(normal, normal)));
}

// The square of the sine that belongs to the cosine `steps`, both in steps of 1 / LIGHT_TREE_COSINE_STEPS.
float angle_square(float steps) {
    precise float square = (LIGHT_TREE_COSINE_STEPS - steps) * (LIGHT_TREE_COSINE_STEPS + steps);
    return square;
}

vec2 angle_with_cosine(float steps) {
    return vec2(steps, sqrt(angle_square(steps)));
}

// The difference, 0 if `b` is larger. `b` is below pi.
vec2 angle_minus(vec2 a, vec2 b) {
    precise float sine = a.y * b.x - a.x * b.y;
    if (sine < 0.0) return vec2(1.0, 0.0);
    precise float cosine = a.x * b.x + a.y * b.y;
    return vec2(cosine, sine);
}

float angle_cosine(vec2 a) {
    precise float square = a.x * a.x + a.y * a.y;
    precise float cosine = a.x / sqrt(square);
    return cosine;
}

// For an angle below pi / 2.
bool angle_is_within(vec2 a, float steps) {
    precise float ours = a.y * a.y * (steps * steps);
    precise float most = a.x * a.x * angle_square(steps);
    return steps <= 0.0 || ours <= most;
}

// Estimated irradiance from all lights of a node.
float light_node_importance(LightNode node, vec3 position, vec3 normal) {
    float spread = float(bitfieldExtract(int(node.cone), 0, 16));
    float emission = float(bitfieldExtract(int(node.cone), 16, 16));
    // Normals in all directions, as of point lights, need no axis.
    bool everywhere = spread <= -LIGHT_TREE_COSINE_STEPS;
    vec3 axis = octahedral_unpack_unnormalized(node.axis);
    if (node.radius < 0.0) {
        if (everywhere) return node.intensity;
        vec2 off_axis = angle_minus(angle_between(axis, normal), angle_with_cosine(spread));
        return node.intensity * max(angle_cosine(off_axis), 0.0);
    }
    precise vec3 gap = node.center - position;
    float square = dot3(gap, gap);
    precise float reach = node.radius * node.radius;
    float divisor = max(max(square, reach * LIGHT_TREE_MIN_DISTANCE_SHARE), LIGHT_TREE_MIN_SQUARED);
    if (square <= max(reach, LIGHT_TREE_MIN_SQUARED)) return node.intensity / divisor;
    // Half angle under which the bounding sphere is seen.
    precise float beyond = square - reach;
    vec2 seen = vec2(sqrt(beyond), node.radius);
    float cosine = angle_cosine(angle_minus(angle_between(normal, gap), seen));
    vec2 emitted = vec2(1.0, 0.0);
    if (!everywhere) {
        emitted = angle_minus(angle_minus(angle_between(axis, -gap), angle_with_cosine(spread)), seen);
    }
    if (!(cosine > 0.0 && emitted.x > 0.0 && angle_is_within(emitted, emission))) return 0.0;
    precise float importance = node.intensity * cosine * angle_cosine(emitted) / divisor;
    return importance;
}

bool light_tree_usable(float sum) {
    return sum >= 1.17549435e-38 && sum <= 3.4028235e38;
}

// The part of 2^32 random words that takes the first of two children; neither gets none.
uint light_tree_threshold(LightNode a, LightNode b, vec3 position, vec3 normal) {
    float first = light_node_importance(a, position, normal);
    float second = light_node_importance(b, position, normal);
    if (!light_tree_usable(first + second)) {
        first = a.intensity;
        second = b.intensity;
    }
    if (!light_tree_usable(first + second)) {
        first = 1.0;
        second = 1.0;
    }
    // The smaller part is divided: 1 minus a rounded quotient near 1 would have few correct digits.
    precise float share = min(first, second) / (first + second) * 4294967296.0;
    uint words = uint(max(share, 1.0));
    return first <= second ? words : 0u - words;
}

// (high * 2^32 + low) / divisor, rounded down, for high < divisor: in two digits of 16 bits (Knuth 1997, 4.3.1,
// algorithm D).
uint extend_word(uint high, uint low, uint divisor) {
    int shift = 31 - findMSB(divisor);
    if (shift > 0) {
        divisor <<= shift;
        high = high << shift | low >> (32 - shift);
        low <<= shift;
    }
    uvec2 digits = uvec2(divisor >> 16, divisor & 0xFFFFu);
    uvec2 lows = uvec2(low >> 16, low & 0xFFFFu);
    uint quotient = 0u;
    for (int i = 0; i < 2; i++) {
        uint digit = high / digits.x;
        uint rest = high - digit * digits.x;
        // At most two corrections.
        while (rest < 65536u && (digit >= 65536u || digit * digits.y > (rest << 16 | lows[i]))) {
            digit--;
            rest += digits.x;
        }
        high = (high << 16 | lows[i]) - digit * divisor;
        quotient = quotient << 16 | digit;
    }
    return quotient;
}

// Descends from the root to a leaf, whose light is returned, and multiplies the probabilities of the children. The words
// are those of a random choice, or a trail if `by_trail`.
uint light_tree_descend(SceneRef scene, vec3 position, vec3 normal, bool by_trail, uvec2 words, out float probability) {
    probability = 1.0;
    uint at = 0u;
    uint next = scene.light_tree.nodes[0].at.next;
    // One exit: of a return from inside the loop, llvmpipe of Mesa 22.3 returns 0.
    while ((next & LIGHT_TREE_LEAF) == 0u) {
        uint threshold = light_tree_threshold(
            scene.light_tree.nodes[at + 1u].at, scene.light_tree.nodes[next].at, position, normal);
        bool second;
        if (by_trail) {
            second = (words.x & 1u) != 0u;
            words = uvec2(words.x >> 1 | words.y << 31, words.y >> 1);
        } else {
            second = words.x >= threshold;
            words.y = words.y * LIGHT_TREE_MULTIPLIER + LIGHT_TREE_INCREMENT;
            uint word = second ? words.x - threshold : words.x;
            words.x = extend_word(word, words.y, second ? 0u - threshold : threshold);
        }
        probability *= float(second ? 0u - threshold : threshold) * (1.0 / 4294967296.0);
        at = second ? next : at + 1u;
        next = scene.light_tree.nodes[at].at.next;
    }
    return next & ~LIGHT_TREE_LEAF;
}

float light_tree_mixed(SceneRef scene, uint index, float by_tree) {
    const float share = float(LIGHT_TREE_WORDS) * (1.0 / 4294967296.0);
    return share * by_tree + (1.0 - share) * scene.emissions[index].at.probability;
}

// Picks a light by two random words, and returns its probability in `share`.
uint light_tree_pick(SceneRef scene, vec3 position, vec3 normal, uvec2 random, out float share) {
    bool by_power = random.x >= LIGHT_TREE_WORDS;
    uint word = extend_word(by_power ? random.x - LIGHT_TREE_WORDS : random.x, random.y,
        by_power ? 0u - LIGHT_TREE_WORDS : LIGHT_TREE_WORDS);
    uvec2 words = uvec2(word, random.y);
    if (by_power) words = scene.light_tree.trails[pick_light(scene, word)].at;
    float by_tree;
    uint index = light_tree_descend(scene, position, normal, by_power, words, by_tree);
    share = light_tree_mixed(scene, index, by_tree);
    return index;
}

// The probability with which light_tree_pick returns light `index`.
float light_tree_probability(SceneRef scene, vec3 position, vec3 normal, uint index) {
    float by_tree;
    light_tree_descend(scene, position, normal, true, scene.light_tree.trails[index].at, by_tree);
    return light_tree_mixed(scene, index, by_tree);
}

#endif
