/* What a committed scene tells about itself. */
#include "scene/scene.h"
#include "tree/counts.h"
#include "tree/verify.h"
#include "tree/walk.h"

#include <string.h>

void kdr_scene_bounds(const kdr_scene *scene, float bounds[6]) {
    kdr_box box = scene->tree.bounds;
    if (scene->customs)
        kdr_box_add(&box, &scene->customs->tree.bounds);
    memcpy(bounds, box.lo, sizeof box.lo);
    memcpy(bounds + 3, box.hi, sizeof box.hi);
}

/* Adds the numbers of the tree of custom primitives to those of the triangles'. */
static void add_customs(kdr_tree_stats *sum, const kdr_tree *tree) {
    kdr_tree_stats more;
    kdr_tree_count(tree, &more);
    double depths = sum->mean_leaf_depth * (double)sum->leaf_count + more.mean_leaf_depth * (double)more.leaf_count;
    sum->custom_count = more.triangle_count;
    sum->dropped_count += more.dropped_count;
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
    kdr_tree_count(&scene->tree, out);
    if (scene->customs)
        add_customs(out, &scene->customs->tree);
    out->build_seconds = scene->build_seconds;
    return KDR_OK;
}

typedef struct showing {
    kdr_cell_fn *visit;
    void *user;
    bool is_custom;
} showing;

static kdr_cell_step show_cell(const kdr_tree *tree, const kdr_walk *at, void *context) {
    const showing *s = context;
    kdr_node node = tree->nodes[at->node];
    kdr_cell cell = {.depth = at->depth, .is_leaf = kdr_node_is_leaf(node), .is_custom = s->is_custom};
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

kdr_status kdr_scene_cells(const kdr_scene *scene, kdr_cell_fn *visit, void *user) {
    if (!scene || !visit)
        return KDR_ERROR_INVALID_ARGUMENT;
    showing s = {visit, user, false};
    bool whole = kdr_tree_walk_steps(&scene->tree, show_cell, &s);
    s.is_custom = true;
    if (whole && scene->customs)
        kdr_tree_walk_steps(&scene->customs->tree, show_cell, &s);
    return KDR_OK;
}

uint64_t kdr_scene_hash(const kdr_scene *scene) {
    if (!scene->committed)
        return 0;
    uint64_t hash = kdr_tree_hash(&scene->tree);
    if (scene->customs) /* shifted: never 0, and the two trees do not change places unnoticed */
        hash ^= kdr_tree_hash(&scene->customs->tree) << 1;
    return hash;
}

kdr_status kdr_scene_verify(const kdr_scene *scene) {
    if (!scene)
        return KDR_ERROR_INVALID_ARGUMENT;
    const char *wrong = kdr_tree_verify(&scene->tree);
    if (!wrong && scene->customs)
        wrong = kdr_tree_verify(&scene->customs->tree);
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
