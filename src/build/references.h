/* References: a primitive's number and its box, clipped to the node it is in, as structure of arrays.
 *
 * Boxes travel with their numbers, so every pass of the builder reads and writes memory in order (section 5 of the 2007
 * paper). 28 bytes a reference. */
#ifndef KDR_BUILD_REFERENCES_H
#define KDR_BUILD_REFERENCES_H

#include "geometry/box.h"

#include <stddef.h>
#include <stdint.h>

typedef struct kdr_references {
    float *lo[3], *hi[3];
    uint32_t *primitive; /* ascending */
    uint32_t count;
} kdr_references;

#define KDR_REFERENCE_ARRAYS 7

/* Bytes for `count` references; each array starts on a cache line. */
static inline size_t kdr_references_bytes(size_t count) {
    return KDR_REFERENCE_ARRAYS * (((count * 4) + 63) / 64 * 64);
}

/* Lays the arrays into 64-byte aligned memory of that many bytes. */
static inline kdr_references kdr_references_in(void *memory, uint32_t count) {
    size_t stride = kdr_references_bytes(count) / KDR_REFERENCE_ARRAYS;
    char *at = memory;
    kdr_references r = {.count = count};
    for (int k = 0; k < 3; k++, at += stride)
        r.lo[k] = (float *)at;
    for (int k = 0; k < 3; k++, at += stride)
        r.hi[k] = (float *)at;
    r.primitive = (uint32_t *)at;
    return r;
}

#endif
