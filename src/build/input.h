/* What a builder builds over: numbered primitives that have boxes and know how to fill a leaf. Builders know no more.
 */
#ifndef KDR_BUILD_INPUT_H
#define KDR_BUILD_INPUT_H

#include "build/listener.h"
#include "build/references.h"
#include "tree/boxed.h"

/* Primitives that are left out of the tree, and why. */
typedef struct kdr_input_counts {
    uint64_t dropped;    /* not finite */
    uint64_t degenerate; /* cannot be hit */
    uint64_t invalid;    /* an error of the caller's: the build fails */
} kdr_input_counts;

/* Functions are called from several workers at once. */
typedef struct kdr_input {
    const void *context;
    uint32_t count;
    kdr_listener *listener; /* who is told how far the build is; NULL: nobody */
    bool boxed;             /* leaves hold the groups of boxed.h; otherwise blocks of triangles */

    /* Writes the boxes of those of [begin, end) that belong into the tree to places at, at + 1 ... and widens *bounds
     * by them. Returns how many; adds the others to *counts. */
    uint32_t (*boxes)(const void *context, uint32_t begin, uint32_t end, const kdr_references *to, uint32_t at,
                      kdr_box *bounds, kdr_input_counts *counts);

    /* The corners of a primitive that is a triangle; NULL where they are not. */
    void (*corners)(const void *context, uint32_t primitive, float corners[3][3]);

    /* Fills the block of a leaf. */
    void (*fill)(const void *context, float *blocks, kdr_node leaf, const uint32_t *primitives);
} kdr_input;

#endif
