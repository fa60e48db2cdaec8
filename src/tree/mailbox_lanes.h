/* A ray's mailbox: which triangles it has been tested against, so that a triangle in several leaves is not tested in
 * each of them. A hashed table of few places, where a newer triangle takes the place of an older one: a triangle that
 * was lost is tested again, which costs time and changes nothing.
 *
 * Source: J. Amanatides, A. Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", 1987, for the mailbox; C. Benthin,
 * "Realtime Ray Tracing on Current CPU Architectures", 2006, for the hashed one beside the ray. A vector of
 * triangles is looked up at once, and skipped only when all its lanes are known. */
#ifndef KDR_TREE_MAILBOX_LANES_H
#define KDR_TREE_MAILBOX_LANES_H

#include "geometry/lanes.h"
#include "tree/tree.h"

typedef struct kdr_mailbox {
    uint32_t mask; /* size - 1 */
    uint32_t kept[KDR_MAILBOX_LARGEST];
} kdr_mailbox;

/* Empty: no stored primitive is 0. size: a power of two. */
KDR_LANES_INLINE void kdr_mailbox_begin(kdr_mailbox *mailbox, uint32_t size) {
    mailbox->mask = size - 1;
    memset(mailbox->kept, 0, size * sizeof mailbox->kept[0]);
}

/* Which of the lanes from `first` on have not been tested; from here on they have. NULL: all lanes. Primitives are
 * compared as they are stored. */
KDR_LANES_INLINE kdr_lane_bits kdr_mailbox_new(kdr_mailbox *mailbox, kdr_block block, size_t first) {
    if (!mailbox)
        return KDR_LANE_BITS_ALL;
    const uint32_t *row = (const uint32_t *)(const void *)(block.rows + 9 * block.length + first);
    uint32_t count = (uint32_t)(block.shown - first);
#if defined(__AVX512F__) && KDR_LANES == 16
    kdr_lanes_u primitive = kdr_lanes_load_u(row), place = primitive & mailbox->mask;
    kdr_lane_bits lanes = kdr_lanes_first(count);
    kdr_lanes_u kept = (kdr_lanes_u)kdr_lanes_gather(lanes, (const float *)(const void *)mailbox->kept, place);
    lanes &= kdr_lanes_differ(kept, primitive);
    kdr_lanes_scatter(lanes, mailbox->kept, place, primitive);
    return lanes;
#else
    kdr_lane_bits lanes = 0;
    for (uint32_t i = 0; i < KDR_LANES && i < count; i++) {
        uint32_t primitive;
        memcpy(&primitive, row + i, sizeof primitive);
        uint32_t *place = &mailbox->kept[primitive & mailbox->mask];
        lanes |= (kdr_lane_bits)(*place != primitive) << i;
        *place = primitive;
    }
    return lanes;
#endif
}

#endif
