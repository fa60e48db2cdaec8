/* Regions of a scene, found before its nodes are opened: planes above them, and one pass that hands every reference to
 * each region it reaches into. See regions.c. */
#ifndef KDR_BUILD_REGIONS_H
#define KDR_BUILD_REGIONS_H

#include "build/share.h"

#define KDR_REGION 0x80000000u

/* The planes above the regions. A child is the number of a plane below, or KDR_REGION | number of a region. */
typedef struct kdr_region_plane {
    uint32_t axis, child[2];
    float plane;
} kdr_region_plane;

typedef struct kdr_regions {
    kdr_region_plane planes[KDR_MAX_REGIONS];
    uint32_t plane_count, region_count;
    uint32_t wanted[KDR_MAX_REGIONS]; /* regions that a region was to be; more than 1: there was no plane */
} kdr_regions;

/* Finds planes for so many regions; serves one share. */
typedef void kdr_regions_fn(const void *context, uint32_t count, kdr_regions *regions);

/* The whole of kdr_share.divide for planes that are found without touching the references: finds planes, fewer of them
 * where the references would not fit the budget, assigns all references in two passes, and cuts regions that were to be
 * more than one at medians. */
uint32_t kdr_regions_divide(kdr_build_state *state, kdr_build_task *root, uint32_t count, kdr_build_task *tasks,
                            kdr_regions_fn *find, const void *context);

/* Cuts the tasks, task i into wanted[i], at the medians of the begins and ends of boxes on the longest axis, by all
 * workers or by one. A task that no plane separates stays whole. Returns how many tasks there are then. */
uint32_t kdr_regions_cut(kdr_build_state *state, bool parallel, kdr_build_task *tasks, uint32_t count,
                         uint32_t *wanted);

/* Adds a plane below a place (NULL: the first), or a region. Return the number in planes, or KDR_REGION | region. */
uint32_t kdr_regions_add_region(kdr_regions *regions, uint32_t wanted);

#endif
