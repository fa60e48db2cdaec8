/* What queries cost, in a build that counts: part of kdray/kdray.h, which includes it. */
#ifndef KDR_COUNTS_H
#define KDR_COUNTS_H

#include <stdint.h>

/* Work of the queries of one thread. A node or a block that several rays of a packet are tested against together counts
 * once. Padding of blocks counts as triangles. */
typedef struct kdr_trace_counts {
    uint64_t nodes;     /* visited: nodes of the kd-tree, leaves included, or nodes of the wide tree */
    uint64_t node_rays; /* rays that visited them: as many as nodes for lone rays */
    uint64_t blocks;    /* of triangles, a leaf's, that were asked */
    uint64_t steps;     /* vectors of triangles against one ray, or of rays against one triangle */
    uint64_t tests;     /* of one ray and one triangle: lanes in use in these steps */
    uint64_t exact;     /* tests that floats left in doubt */
    uint32_t width;     /* lanes of a vector; 0 before the first query */
} kdr_trace_counts;

#endif
