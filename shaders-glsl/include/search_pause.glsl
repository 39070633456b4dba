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
const uint KEPT_SUBGROUPS = 4096;
const uint KEPT_WORDS = 160, KEPT_KERNEL = 64;
// The first word of `push.kept` counts walks that paused in this dispatch; one word for each subgroup
// follows, of which these are the values. A new search finds zeros.
const uint KEPT_NEW = 0, KEPT_PAUSED = 1, KEPT_DONE = 2;

// Turns made so far, the same in a subgroup; whether this walk goes on with what was written down,
// and whether it has paused.
uint turns = 0;
bool resumed = false, paused = false;
uint kept_next;

// Puts the pen before this invocation's words, from `part` on.
void kept_begin(uint part) {
    kept_next = 1 + KEPT_SUBGROUPS + part + (tile_number() * gl_SubgroupSize + gl_SubgroupInvocationID) * KEPT_WORDS;
}

// Writes a word down, or reads it again: in the same order.
void keep(inout uint word) {
    if (resumed) word = push.kept[kept_next].at;
    else push.kept[kept_next].at = word;
    kept_next++;
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
bool kept_open() {
    uint state = push.kept[1 + tile_number()].at;
    resumed = state == KEPT_PAUSED;
    return state != KEPT_DONE;
}

// The last that a subgroup does.
void kept_close() {
    if (gl_SubgroupInvocationID == 0) {
        push.kept[1 + tile_number()].at = paused ? KEPT_PAUSED : KEPT_DONE;
        if (paused) atomicAdd(push.kept[0].at, 1);
    }
}

#endif
