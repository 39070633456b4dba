// Searches that stop before a device ends their loops, and continue in the next dispatch.
//
// Mesa's llvmpipe silently ends every loop of an invocation whose loops have made 65 535 iterations in total.
// On such a device iterations are counted: a traversal that has made TURNS of them saves its state, and the
// host dispatches again until no traversal is paused. Elsewhere TURNS is 0, and none of this is compiled.
#ifndef SEARCH_PAUSE_GLSL
#define SEARCH_PAUSE_GLSL

#include "device/constants.glsl"

layout(constant_id = 8) const uint TURNS = 0;

// Of the PAUSE_WORDS words of saved state per invocation, the first that belongs to the kernel; those before it
// are the traversal's.
const uint PAUSE_KERNEL = 64;
// The first word of `push.pauses` counts traversals that paused in this dispatch; it is followed by one word
// for each subgroup with one of these values. Initially all are 0.
const uint PAUSE_NEW = 0, PAUSE_PAUSED = 1, PAUSE_DONE = 2;

// Iterations so far, uniform in a subgroup; whether this traversal continues from saved state, and whether it
// has paused.
uint turns = 0;
bool resumed = false, paused = false;
uint pause_next;

// Sets the save position to this invocation's words, from `part` on.
void pause_begin(uint part) {
    pause_next = 1 + PAUSE_SUBGROUPS + part + (tile_number() * gl_SubgroupSize + gl_SubgroupInvocationID) * PAUSE_WORDS;
}

// Saves a word, or restores it; must be called in the same order for both.
void keep(inout uint word) {
    if (resumed) word = push.pauses[pause_next].at;
    else push.pauses[pause_next].at = word;
    pause_next++;
}

void keep(inout float number) {
    uint word = floatBitsToUint(number);
    keep(word);
    number = uintBitsToFloat(word);
}

void keep(inout uvec2 words) {
    keep(words.x);
    keep(words.y);
}

void keep(inout vec3 numbers) {
    keep(numbers.x);
    keep(numbers.y);
    keep(numbers.z);
}

// Whether this subgroup has work in this dispatch.
bool pause_open() {
    uint state = push.pauses[1 + tile_number()].at;
    resumed = state == PAUSE_PAUSED;
    return state != PAUSE_DONE;
}

// Must be the last call of a subgroup.
void pause_close() {
    if (gl_SubgroupInvocationID == 0) {
        push.pauses[1 + tile_number()].at = paused ? PAUSE_PAUSED : PAUSE_DONE;
        if (paused) atomicAdd(push.pauses[0].at, 1);
    }
}

#endif
