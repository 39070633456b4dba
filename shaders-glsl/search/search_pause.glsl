// Searches that stop before a device ends their loops, and go on in the next dispatch.
//
// Mesa's llvmpipe ends every loop of an invocation, in silence, that has made 65 535 turns in all of
// its loops together. On such a device turns are counted: a walk that has made TURNS of them writes
// down where it stands, and the host dispatches again until no walk is left. Elsewhere TURNS is 0, and
// none of this is compiled.
#ifndef SEARCH_PAUSE_GLSL
#define SEARCH_PAUSE_GLSL

layout(constant_id = 8) const uint TURNS = 0;

// Subgroups of a dispatch, and words that each invocation writes down, at most (estimate/pause.rs):
// the walk's first, then the kernel's.
const uint PAUSE_SUBGROUPS = 4096;
const uint PAUSE_WORDS = 160, PAUSE_KERNEL = 64;
// The first word of `push.pauses` counts walks that paused in this dispatch; one word for each subgroup
// follows, of which these are the values. A new search finds zeros.
const uint PAUSE_NEW = 0, PAUSE_PAUSED = 1, PAUSE_DONE = 2;

// Turns made so far, the same in a subgroup; whether this walk goes on with what was written down,
// and whether it has paused.
uint turns = 0;
bool resumed = false, paused = false;
uint pause_next;

// Puts the pen before this invocation's words, from `part` on.
void pause_begin(uint part) {
    pause_next = 1 + PAUSE_SUBGROUPS + part + (tile_number() * gl_SubgroupSize + gl_SubgroupInvocationID) * PAUSE_WORDS;
}

// Writes a word down, or reads it again: in the same order.
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

// Whether this subgroup has anything to do in this dispatch.
bool pause_open() {
    uint state = push.pauses[1 + tile_number()].at;
    resumed = state == PAUSE_PAUSED;
    return state != PAUSE_DONE;
}

// The last that a subgroup does.
void pause_close() {
    if (gl_SubgroupInvocationID == 0) {
        push.pauses[1 + tile_number()].at = paused ? PAUSE_PAUSED : PAUSE_DONE;
        if (paused) atomicAdd(push.pauses[0].at, 1);
    }
}

#endif
