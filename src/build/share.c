/* The table of shares, and the two plain ones. */
#include "build/share.h"

#include "base/check.h"
#include "build/regions.h"

/* Serial: one worker cuts the scene at medians of begins and ends of boxes, one region after the other, each on its
 * longest axis; then each region is built by one worker. Source: thesis, 2009, sections 5.2 to 5.4. */
static uint32_t divide_serial(kdr_build_state *state, kdr_build_task *root, uint32_t count, kdr_build_task *tasks) {
    uint32_t wanted[KDR_MAX_REGIONS];
    tasks[0] = *root;
    wanted[0] = count;
    return kdr_regions_cut(state, false, tasks, 1, wanted);
}

/* No regions: large nodes are opened by all workers together, the others are handed around. */
const kdr_share kdr_share_none = {.together = true, .hands_over = true};
const kdr_share kdr_share_serial = {.divide = divide_serial};

const kdr_share *kdr_share_for(kdr_share_rule rule) {
    static const kdr_share *const rows[] = {
        [KDR_SHARE_NONE] = &kdr_share_none,       [KDR_SHARE_SERIAL] = &kdr_share_serial,
        [KDR_SHARE_LINE] = &kdr_share_line,       [KDR_SHARE_GRID] = &kdr_share_grid,
        [KDR_SHARE_CLUSTER] = &kdr_share_cluster,
    };
    KDR_CHECK((size_t)rule < sizeof rows / sizeof rows[0]);
    return rows[rule];
}
