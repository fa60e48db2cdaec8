/* Triangles of a scene as the input of a builder: numbered through all geometries, in order. */
#ifndef KDR_SCENE_TRIANGLES_H
#define KDR_SCENE_TRIANGLES_H

#include "build/input.h"
#include "kdray/kdray.h"

typedef struct kdr_triangles {
    const kdr_triangles_def *geometries;
    const uint32_t *first; /* first[g] is the number of geometry g's first triangle; first[count] the total */
    uint32_t count;
} kdr_triangles;

kdr_input kdr_triangles_input(const kdr_triangles *triangles);

/* The geometry that a primitive belongs to. first as above. Cost: O(log geometries). */
static inline uint32_t kdr_geometry_of(const uint32_t *first, uint32_t count, uint32_t primitive) {
    uint32_t lo = 0, hi = count;
    while (hi - lo > 1) {
        uint32_t middle = lo + (hi - lo) / 2;
        if (first[middle] <= primitive)
            lo = middle;
        else
            hi = middle;
    }
    return lo;
}

#endif
