// Photons on their way into a kd-tree: their numbers in order of x, of y and of z, and for some trees
// of the numbers themselves, in one list after the other. A segment of the tree is the same stretch of
// all lists. Splitting it parts every list in two, each of which keeps its order: so the ends of a
// segment are its box, and its median is where it ought to be, without a search.
#ifndef LISTS_GLSL
#define LISTS_GLSL

#include "search/map_records.glsl"
#include "device/words.glsl"

// Photons to a tile of a list.
const uint LIST_TILE = 2048;
// Set in the number of a photon that goes right.
const uint GOES_RIGHT = 0x80000000u;
// Segments of up to so many are split by one workgroup to the end.
const uint LIST_SHORT = 1024;

// The box of the segment of `length` photons from `first` on, by the ends of its lists.
void list_box(PhotonRows photons, Words lists, uint count, uint first, uint length, out uvec3 low, out uvec3 high) {
    for (uint axis = 0; axis < 3; axis++) {
        Words list = lists + axis * count;
        low[axis] = photon_position(photons, list[first].word)[axis];
        high[axis] = photon_position(photons, list[first + length - 1].word)[axis];
    }
}

#endif
