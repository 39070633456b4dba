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

// cos max(a - b, 0), from the cosines of two angles between 0 and pi.
float cosine_of_difference(float a, float b) {
    if (a >= b) return 1.0;
    precise float product = a * b;
    precise float sines = sqrt(max(1.0 - a * a, 0.0)) * sqrt(max(1.0 - b * b, 0.0));
    precise float sum = product + sines;
    return sum;
}

// Estimated irradiance from all lights of a node.
float light_node_importance(LightNode node, vec3 position, vec3 normal) {
    float spread = float(bitfieldExtract(int(node.cone), 0, 16)) / LIGHT_TREE_COSINE_STEPS;
    float emission = float(bitfieldExtract(int(node.cone), 16, 16)) / LIGHT_TREE_COSINE_STEPS;
    if (node.radius < 0.0) {
        return node.intensity * max(cosine_of_difference(dot3(normal, octahedral_unpack(node.axis)), spread), 0.0);
    }
    precise vec3 gap = node.center - position;
    float square = dot3(gap, gap);
    precise float reach = node.radius * node.radius;
    float divisor = max(max(square, reach * LIGHT_TREE_MIN_DISTANCE_SHARE), LIGHT_TREE_MIN_SQUARED);
    if (square <= max(reach, LIGHT_TREE_MIN_SQUARED)) return node.intensity / divisor;
    precise vec3 direction = gap / sqrt(square);
    // Half angle under which the bounding sphere is seen.
    precise float seen = sqrt(max(1.0 - reach / square, 0.0));
    float cosine = cosine_of_difference(dot3(normal, direction), seen);
    // Normals in all directions, as of point lights, need no axis.
    float emitted = 1.0;
    if (spread > -1.0) {
        float off = cosine_of_difference(-dot3(octahedral_unpack(node.axis), direction), spread);
        emitted = cosine_of_difference(off, seen);
    }
    if (!(cosine > 0.0 && emitted > 0.0 && emitted >= emission)) return 0.0;
    precise float importance = node.intensity * cosine * emitted / divisor;
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
    precise float share = first / (first + second) * 4294967296.0;
    return uint(clamp(share, 1.0, 4294967040.0));
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
