/* The builder's inner loops as a table of functions, one table for each instruction set. All give the same results. */
#ifndef KDR_BUILD_KERNELS_H
#define KDR_BUILD_KERNELS_H

#include "build/bins.h"
#include "kdray/kdray.h"

#define KDR_MASK_LIMIT 32                    /* primitives that fit one mask */
#define KDR_SNAP_LIMIT 256                   /* begins or ends that are looked at around a plane */
#define KDR_MASK_PLANES (2 * KDR_MASK_LIMIT) /* candidate planes on each axis */

/* For a node of at most 32 primitives: every candidate plane with the sets of primitives on its two sides. */
typedef struct kdr_mask_table {
    uint32_t count; /* planes on each axis: 2 x primitives; rounded up to 16 with planes that are never chosen */
    float plane[3][KDR_MASK_PLANES];
    uint32_t left[3][KDR_MASK_PLANES], right[3][KDR_MASK_PLANES];
} kdr_mask_table;

typedef struct kdr_build_kernels {
    /* The cheapest bin boundary, on the axes of a set (bit k for axis k), of a cell with `count` primitives whose
     * bounds are `box`; the faces of the box are candidates too. Equal costs: the lower axis, then the faces, then the
     * lower plane. */
    kdr_split (*choose_binned)(const kdr_bins *bins, const kdr_bin_grid *grid, uint32_t count, const kdr_box *box,
                               const kdr_box *cell, const kdr_plan *plan, uint32_t axes);

    /* The cheapest plane through a begin or an end of a box that is less than `reach` away from a plane, with its exact
     * cost; the plane itself if there is none, or if there are more than KDR_SNAP_LIMIT begins or ends. */
    kdr_split (*snap)(const kdr_references *from, const kdr_split *split, float reach, const kdr_box *cell,
                      const kdr_plan *plan);

    /* How many references of [begin, end) go left and right of a split. */
    void (*count)(const kdr_references *from, uint32_t begin, uint32_t end, const kdr_split *split, uint32_t *left,
                  uint32_t *right);

    /* Appends them to `left` and `right` from the given places on, clipped to the plane and in order, and widens the
     * two boxes to hold them. Nothing is written beyond what count says. Where there are corners, nine floats for each
     * primitive, those on both sides get the bounds of their triangle's parts. */
    void (*divide)(const kdr_references *from, uint32_t begin, uint32_t end, const kdr_split *split,
                   const float *corners, const kdr_references *left, uint32_t left_at, const kdr_references *right,
                   uint32_t right_at, kdr_box *left_box, kdr_box *right_box);

    /* Fills the table for references->count <= KDR_MASK_LIMIT. */
    void (*masks)(const kdr_references *references, kdr_mask_table *table);

    /* The cheapest plane strictly inside a cell, on the axes of a set, for the primitives in `set`; its masks in *left
     * and *right. */
    kdr_split (*choose_masked)(const kdr_mask_table *table, uint32_t set, const kdr_box *cell, const kdr_plan *plan,
                               uint32_t axes, uint32_t *left, uint32_t *right);
} kdr_build_kernels;

const kdr_build_kernels *kdr_build_kernels_for(kdr_isa isa);

#endif
