/* What a committed scene tells about itself. */
#include "scene/scene.h"
#include "tree/verify.h"
#include "tree/walk.h"

#include <string.h>

void kdr_scene_bounds(const kdr_scene *scene, float bounds[6]) {
    memcpy(bounds, scene->tree.bounds.lo, 3 * sizeof *bounds);
    memcpy(bounds + 3, scene->tree.bounds.hi, 3 * sizeof *bounds);
}

kdr_status kdr_scene_stats(const kdr_scene *scene, kdr_tree_stats *out) {
    if (!scene || !out)
        return KDR_ERROR_INVALID_ARGUMENT;
    kdr_tree_count(&scene->tree, out);
    out->build_seconds = scene->build_seconds;
    return KDR_OK;
}

typedef struct showing {
    kdr_cell_fn *visit;
    void *user;
} showing;

static kdr_cell_step show_cell(const kdr_tree *tree, const kdr_walk *at, void *context) {
    const showing *s = context;
    kdr_node node = tree->nodes[at->node];
    kdr_cell cell = {.depth = at->depth, .is_leaf = kdr_node_is_leaf(node)};
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
    showing s = {visit, user};
    kdr_tree_walk_steps(&scene->tree, show_cell, &s);
    return KDR_OK;
}

uint64_t kdr_scene_hash(const kdr_scene *scene) { return scene->committed ? kdr_tree_hash(&scene->tree) : 0; }

kdr_status kdr_scene_verify(const kdr_scene *scene) {
    if (!scene)
        return KDR_ERROR_INVALID_ARGUMENT;
    const char *wrong = kdr_tree_verify(&scene->tree);
    if (wrong)
        return kdr_device_fail(scene->device, KDR_ERROR_INVALID_DATA, "%s", wrong);
    return KDR_OK;
}
