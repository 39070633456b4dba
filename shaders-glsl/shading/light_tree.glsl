// Selects a light among many. Twin of photon-core's light_tree.rs: the same words for each child except for the rounding of
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

// The factor of cosine and sine.
float angle_length(vec2 a) {
    precise float square = a.x * a.x + a.y * a.y;
    return sqrt(square);
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
        precise float importance = node.intensity * max(off_axis.x / angle_length(off_axis), 0.0);
        return importance;
    }
    precise vec3 gap = node.center - position;
    float square = dot3(gap, gap);
    precise float reach = node.radius * node.radius;
    float divisor = max(max(square, reach * LIGHT_TREE_MIN_DISTANCE_SHARE), LIGHT_TREE_MIN_SQUARED);
    if (square <= max(reach, LIGHT_TREE_MIN_SQUARED)) return node.intensity / divisor;
    // Half angle under which the bounding sphere is seen.
    precise float beyond = square - reach;
    vec2 seen = vec2(sqrt(beyond), node.radius);
    vec2 received = angle_minus(angle_between(normal, gap), seen);
    if (!(received.x > 0.0)) return 0.0;
    precise float cosines = received.x / angle_length(received);
    if (!everywhere) {
        vec2 emitted = angle_minus(angle_minus(angle_between(axis, -gap), angle_with_cosine(spread)), seen);
        if (!(emitted.x > 0.0 && angle_is_within(emitted, emission))) return 0.0;
        precise float both = received.x * emitted.x / (angle_length(received) * angle_length(emitted));
        cosines = both;
    }
    precise float importance = node.intensity * cosines / divisor;
    return importance;
}

bool light_tree_usable(float sum) {
    return sum >= 1.17549435e-38 && sum <= 3.4028235e38;
}

float light_tree_sum(float of[LIGHT_TREE_WIDTH]) {
    precise float sum = ((of[0] + of[4]) + (of[2] + of[6])) + ((of[1] + of[5]) + (of[3] + of[7]));
    return sum;
}

float light_tree_part(float weight, float total) {
    precise float part = weight / total * 4294967296.0;
    return part;
}

// Numbers of the 2^32 random words that select each of the children from index `first` on: 0 where there is none.
uint[LIGHT_TREE_WIDTH] light_tree_words(SceneRef scene, uint first, vec3 position, vec3 normal) {
    float weights[LIGHT_TREE_WIDTH];
    uint children = 0u;
    for (uint i = 0u; i < LIGHT_TREE_WIDTH; i++) {
        LightNode node = scene.light_tree.nodes[first + i].at;
        bool exists = node.next != LIGHT_TREE_NO_CHILD;
        weights[i] = exists ? light_node_importance(node, position, normal) : 0.0;
        children += exists ? 1u : 0u;
    }
    float total = light_tree_sum(weights);
    if (!light_tree_usable(total)) {
        for (uint i = 0u; i < LIGHT_TREE_WIDTH; i++) weights[i] = scene.light_tree.nodes[first + i].at.intensity;
        total = light_tree_sum(weights);
    }
    if (!light_tree_usable(total)) {
        for (uint i = 0u; i < LIGHT_TREE_WIDTH; i++) weights[i] = i < children ? 1.0 : 0.0;
        total = float(children);
    }
    // The largest part takes what the others leave: 1 minus a rounded quotient near 1 would have few correct digits.
    uint words[LIGHT_TREE_WIDTH];
    uint rest = 0u;
    uint largest = 0u;
    float most = weights[0];
    for (uint i = 0u; i < LIGHT_TREE_WIDTH; i++) {
        float part = light_tree_part(weights[i], total);
        words[i] = i < children ? uint(clamp(part, 1.0, LIGHT_TREE_MAX_WORDS)) : 0u;
        rest -= words[i];
        if (weights[i] > most) {
            most = weights[i];
            largest = i;
        }
    }
    // Arrays are read by constants where loops are unrolled: they stay in registers.
    for (uint i = 0u; i < LIGHT_TREE_WIDTH; i++) words[i] += i == largest ? rest : 0u;
    return words;
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
    uint next = 0u;
    // One exit: of a return from inside the loop, llvmpipe of Mesa 22.3 returns 0.
    while ((next & LIGHT_TREE_LEAF) == 0u) {
        uint first = next * LIGHT_TREE_WIDTH;
        uint parts[LIGHT_TREE_WIDTH] = light_tree_words(scene, first, position, normal);
        uint child = 0u, start = 0u, end = 0u, part = 0u;
        for (uint i = 0u; i < LIGHT_TREE_WIDTH; i++) {
            // Words below `end` are those of the children before; their sum is below 2^32 where there is a child.
            if (by_trail ? i == words.x % LIGHT_TREE_WIDTH : parts[i] != 0u && words.x >= end) {
                child = i;
                start = end;
                part = parts[i];
            }
            end += parts[i];
        }
        if (by_trail) {
            words = uvec2(words.x >> LIGHT_TREE_TRAIL_BITS | words.y << (32u - LIGHT_TREE_TRAIL_BITS),
                words.y >> LIGHT_TREE_TRAIL_BITS);
        } else {
            words.y = words.y * LIGHT_TREE_MULTIPLIER + LIGHT_TREE_INCREMENT;
            words.x = extend_word(words.x - start, words.y, part);
        }
        probability *= float(part) * (1.0 / 4294967296.0);
        next = scene.light_tree.nodes[first + child].at.next;
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
