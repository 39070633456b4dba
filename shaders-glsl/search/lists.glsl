// Photon lists for kd-tree construction: photon indices sorted by x, by y and by z, and for some trees by
// index, one list after another. A segment of the tree is the same range in all lists. Splitting it partitions
// each list stably: so the ends of a segment give its bounding box, and its median is found without a search.
#ifndef LISTS_GLSL
#define LISTS_GLSL

#include "device/constants.glsl"
#include "search/map_records.glsl"
#include "device/words.glsl"

// Flag in the index of a photon that goes right.
const uint GOES_RIGHT = 0x80000000u;

// The bounding box of the segment of `length` photons from `first` on, from the ends of its lists.
void list_box(PhotonRows photons, Words lists, uint count, uint first, uint length, out uvec3 low, out uvec3 high) {
    for (uint axis = 0; axis < 3; axis++) {
        Words list = lists + axis * count;
        low[axis] = photon_position(photons, list[first].word)[axis];
        high[axis] = photon_position(photons, list[first + length - 1].word)[axis];
    }
}

#endif
