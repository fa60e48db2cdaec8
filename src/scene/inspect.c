/* What a committed scene tells about itself. */
#include "scene/scene.h"
#include "tree/counts.h"
#include "tree/verify.h"
#include "tree/walk.h"

#include <string.h>

/* The trees of a commit, in the order in which they are shown; returns how many. */
static uint32_t trees_of(const kdr_committed *seen, const kdr_tree *trees[3]) {
    uint32_t count = 0;
    trees[count++] = &seen->dynamic_part->tree;
    if (seen->static_part)
        trees[count++] = &seen->static_part->tree;
    if (seen->customs)
        trees[count++] = &seen->customs->tree;
    return count;
}

void kdr_scene_bounds(const kdr_scene *scene, float bounds[6]) {
    kdr_visit visit = kdr_scene_enter(scene);
    const kdr_tree *trees[3];
    uint32_t count = trees_of(visit.seen, trees);
    kdr_box box = kdr_box_empty();
    for (uint32_t i = 0; i < count; i++)
        kdr_box_add(&box, &trees[i]->bounds);
    kdr_scene_leave(visit);
    memcpy(bounds, box.lo, sizeof box.lo);
    memcpy(bounds + 3, box.hi, sizeof box.hi);
}

/* Adds the numbers of another tree, of triangles. */
static void add_tree(kdr_tree_stats *sum, const kdr_tree *tree) {
    kdr_tree_stats more;
    kdr_tree_count(tree, &more);
    double depths = sum->mean_leaf_depth * (double)sum->leaf_count + more.mean_leaf_depth * (double)more.leaf_count;
    sum->triangle_count += more.triangle_count;
    sum->dropped_count += more.dropped_count;
    sum->degenerate_count += more.degenerate_count;
    sum->closed_count += more.closed_count;
    sum->opened_count += more.opened_count;
    sum->interior_count += more.interior_count;
    sum->leaf_count += more.leaf_count;
    sum->empty_leaf_count += more.empty_leaf_count;
    sum->reference_count += more.reference_count;
    sum->depth = more.depth > sum->depth ? more.depth : sum->depth;
    sum->largest_leaf = more.largest_leaf > sum->largest_leaf ? more.largest_leaf : sum->largest_leaf;
    sum->mean_leaf_depth = depths / (double)sum->leaf_count;
    sum->cost += more.cost;
    sum->node_bytes += more.node_bytes;
    sum->leaf_bytes += more.leaf_bytes;
    for (int i = 0; i < KDR_HISTOGRAM_SIZE; i++) {
        sum->depth_histogram[i] += more.depth_histogram[i];
        sum->leaf_histogram[i] += more.leaf_histogram[i];
    }
}

kdr_status kdr_scene_stats(const kdr_scene *scene, kdr_tree_stats *out) {
    if (!scene || !out)
        return KDR_ERROR_INVALID_ARGUMENT;
    kdr_visit visit = kdr_scene_enter(scene);
    const kdr_committed *seen = visit.seen;
    kdr_tree_count(&seen->dynamic_part->tree, out);
    if (seen->static_part) {
        uint64_t dynamics = out->triangle_count;
        add_tree(out, &seen->static_part->tree);
        out->static_count = out->triangle_count - dynamics;
    }
    if (seen->customs) {
        uint64_t triangles = out->triangle_count;
        add_tree(out, &seen->customs->tree);
        out->custom_count = out->triangle_count - triangles;
        out->triangle_count = triangles;
    }
    out->build_seconds = seen->build_seconds;
    kdr_scene_leave(visit);
    return KDR_OK;
}

typedef struct showing {
    kdr_cell_fn *visit;
    void *user;
    bool is_static, is_custom;
} showing;

static kdr_cell_step show_cell(const kdr_tree *tree, const kdr_walk *at, void *context) {
    const showing *s = context;
    kdr_node node = tree->nodes[at->node];
    kdr_cell cell = {
        .depth = at->depth, .is_leaf = kdr_node_is_leaf(node), .is_static = s->is_static, .is_custom = s->is_custom};
    memcpy(cell.bounds, at->cell.lo, 3 * sizeof *cell.bounds);
    memcpy(cell.bounds + 3, at->cell.hi, 3 * sizeof *cell.bounds);
    if (cell.is_leaf) {
        cell.primitive_count = kdr_node_count(node);
    } else {
        cell.axis = kdr_node_axis(node);
        cell.plane = kdr_node_plane(node);
    }
    return s->visit(&cell, s->user);
}

kdr_status kdr_scene_cells(const kdr_scene *scene, kdr_cell_fn *visit_cell, void *user) {
    if (!scene || !visit_cell)
        return KDR_ERROR_INVALID_ARGUMENT;
    kdr_visit visit = kdr_scene_enter(scene);
    const kdr_committed *seen = visit.seen;
    showing s = {.visit = visit_cell, .user = user};
    bool whole = kdr_tree_walk_steps(&seen->dynamic_part->tree, show_cell, &s);
    s.is_static = true;
    if (whole && seen->static_part)
        whole = kdr_tree_walk_steps(&seen->static_part->tree, show_cell, &s);
    s.is_static = false;
    s.is_custom = true;
    if (whole && seen->customs)
        kdr_tree_walk_steps(&seen->customs->tree, show_cell, &s);
    kdr_scene_leave(visit);
    return KDR_OK;
}

uint64_t kdr_scene_hash(const kdr_scene *scene) {
    kdr_visit visit = kdr_scene_enter(scene);
    const kdr_committed *seen = visit.seen;
    uint64_t hash = 0;
    if (seen->is_commit) {
        hash = kdr_tree_hash(&seen->dynamic_part->tree);
        if (seen->customs) /* shifted, so that trees do not change places unnoticed */
            hash ^= kdr_tree_hash(&seen->customs->tree) << 1;
        if (seen->static_part)
            hash ^= kdr_tree_hash(&seen->static_part->tree) << 2;
    }
    kdr_scene_leave(visit);
    return hash;
}

kdr_status kdr_scene_verify(const kdr_scene *scene) {
    if (!scene)
        return KDR_ERROR_INVALID_ARGUMENT;
    kdr_visit visit = kdr_scene_enter(scene);
    const kdr_tree *trees[3];
    uint32_t count = trees_of(visit.seen, trees);
    const char *wrong = NULL;
    for (uint32_t i = 0; i < count && !wrong; i++)
        wrong = kdr_tree_verify(trees[i]);
    kdr_scene_leave(visit);
    if (wrong)
        return kdr_device_fail(scene->device, KDR_ERROR_INVALID_DATA, "%s", wrong);
    return KDR_OK;
}

kdr_status kdr_trace_counts_take(kdr_trace_counts *out) {
    if (!out)
        return KDR_ERROR_INVALID_ARGUMENT;
    *out = (kdr_trace_counts){0};
#ifdef KDR_COUNTING
    *out = kdr_thread_counts;
    kdr_thread_counts = (kdr_trace_counts){0};
    return KDR_OK;
#else
    return KDR_ERROR_UNSUPPORTED;
#endif
}
