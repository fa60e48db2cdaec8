/* A tree of triangles: of all static geometries of a scene, or of all others. Whatever queries need to name a hit in it
 * stands beside it. Commits that leave it as it is share it. */
#ifndef KDR_SCENE_PART_H
#define KDR_SCENE_PART_H

#include "build/listener.h"
#include "scene/device.h"
#include "scene/triangles.h"

typedef struct kdr_part {
    kdr_tree tree;
    kdr_lone lone;         /* how a lone ray is asked, by the plan */
    const uint32_t *first; /* first[g]: number of geometry g's first triangle in this tree; count + 1 entries */
    uint32_t count;        /* geometries; those that belong to the other part have no triangles here */
    uint32_t users;        /* commits that show it; changed by who commits or destroys */
    kdr_plan plan;
} kdr_part;

/* Builds the tree of those `count` geometries that are static, or of those that are not. listener may be NULL.
 * Whatever fails, the log is told, and nothing is held. Errors: OUT_OF_MEMORY, LIMIT, INVALID_DATA (a vertex number out
 * of range), CANCELLED. */
kdr_status kdr_part_create(kdr_device *device, const kdr_triangles_def *geometries, uint32_t count, bool is_static,
                           const kdr_plan *plan, kdr_listener *listener, kdr_part **out);

/* A part without triangles, which answers "miss". NULL: no memory. */
kdr_part *kdr_part_create_empty(kdr_device *device);

/* Takes one user away, and the part with the last one. NULL is allowed. */
void kdr_part_leave(kdr_part *part, kdr_device *device);

/* Triangles of the geometries that are static, or of those that are not. */
uint64_t kdr_part_triangles(const kdr_triangles_def *geometries, uint32_t count, bool is_static);

#endif
