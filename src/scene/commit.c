/* Commit: new trees are made beside the old ones and take their places only when they are whole. */
#include "base/cpu.h"
#include "build/plan.h"
#include "scene/scene.h"
#include "tree/node_arrays.h"
#include "tree/node_links.h"
#include "tree/projections.h"

#include <string.h>

static bool same_build(const kdr_plan *a, const kdr_plan *b) {
    return a->split == b->split && a->axis == b->axis && a->order == b->order && a->share == b->share &&
           a->share_count == b->share_count && a->events == b->events && a->straddle == b->straddle &&
           a->retract == b->retract && a->empty_bonus == b->empty_bonus && a->box_weight == b->box_weight &&
           a->cost_traversal == b->cost_traversal && a->cost_intersection == b->cost_intersection &&
           a->leaf_limit == b->leaf_limit && a->depth_limit == b->depth_limit &&
           a->reference_limit == b->reference_limit && a->trace == b->trace && a->nodes == b->nodes &&
           a->mailbox == b->mailbox && a->test == b->test;
}

/* Numbers the triangles of all geometries; NULL when there is no memory or the total is over the limit. */
static kdr_status number_triangles(kdr_scene *scene, uint32_t **out) {
    kdr_device *device = scene->device;
    size_t bytes = ((size_t)scene->geometry_count + 1) * sizeof(uint32_t);
    uint32_t *first = kdr_bulk_get(&device->bulk, &bytes);
    if (!first)
        return kdr_device_fail(device, KDR_ERROR_OUT_OF_MEMORY, "out of memory for %u geometries",
                               scene->geometry_count);
    uint64_t total = 0;
    for (uint32_t g = 0; g < scene->geometry_count && total <= KDR_NODE_MAX_INDEX; g++) {
        first[g] = (uint32_t)total;
        total += scene->geometries[g].triangle_count;
    }
    if (total > KDR_NODE_MAX_INDEX) {
        kdr_bulk_put(&device->bulk, first, ((size_t)scene->geometry_count + 1) * sizeof *first);
        return kdr_device_fail(device, KDR_ERROR_LIMIT, "a scene has at most 2^30 - 1 triangles");
    }
    first[scene->geometry_count] = (uint32_t)total;
    *out = first;
    return KDR_OK;
}

/* Says which triangle has a vertex number that is out of range. */
static kdr_status fail_invalid(const kdr_scene *scene, uint64_t invalid) {
    for (uint32_t g = 0; g < scene->geometry_count; g++) {
        const kdr_triangles_def *def = &scene->geometries[g];
        for (uint32_t i = 0; i < def->triangle_count; i++) {
            for (uint32_t j = 0; j < 3; j++) {
                uint64_t vertex = 3 * (uint64_t)i + j;
                if (def->indices)
                    vertex = ((const uint32_t *)((const char *)def->indices + (size_t)i * def->index_stride))[j];
                if (vertex >= def->vertex_count)
                    return kdr_device_fail(scene->device, KDR_ERROR_INVALID_DATA,
                                           "triangle %u of geometry %u has vertex %llu, but there are %zu (%llu such "
                                           "triangles in all)",
                                           i, g, (unsigned long long)vertex, def->vertex_count,
                                           (unsigned long long)invalid);
            }
        }
    }
    return kdr_device_fail(scene->device, KDR_ERROR_INVALID_DATA, "vertex numbers changed while the commit ran");
}

/* Makes what the plan's traversal wants beside the nodes. On failure what was made is the tree's. */
static kdr_status add_annexes(kdr_device *device, const kdr_plan *plan, kdr_tree *tree) {
    tree->mailbox_size = plan->mailbox == KDR_MAILBOX_NONE ? 0 : 4u << plan->mailbox;
    tree->test = plan->test;
    bool made = (plan->trace != KDR_TRACE_BACKTRACK || kdr_tree_add_links(tree, &device->bulk)) &&
                (plan->nodes != KDR_NODES_ARRAYS || kdr_tree_add_arrays(tree, &device->bulk)) &&
                (plan->test != KDR_TEST_PROJECTION || kdr_tree_add_projections(tree, &device->bulk));
    return made ? KDR_OK : KDR_ERROR_OUT_OF_MEMORY;
}

/* How many scenes lie below one another in it, counted through instances. */
static uint32_t nesting_of(const kdr_scene *scene) {
    uint32_t deepest = 0;
    for (uint32_t g = 0; scene->custom_defs && g < scene->geometry_count; g++) {
        if (!kdr_scene_is_instance(scene, g))
            continue;
        const kdr_instance_def *def = scene->custom_defs[g].user;
        deepest = def->scene->nesting + 1 > deepest ? def->scene->nesting + 1 : deepest;
    }
    return deepest;
}

kdr_status kdr_scene_commit(kdr_scene *scene, const kdr_build_def *given) {
    if (!scene)
        return KDR_ERROR_INVALID_ARGUMENT;
    kdr_device *device = scene->device;
    kdr_build_def def = given ? *given : kdr_default_build_def();
    const char *problem = kdr_build_def_problem(&def);
    if (problem)
        return kdr_device_fail(device, KDR_ERROR_INVALID_ARGUMENT, "%s", problem);
    kdr_plan plan = kdr_plan_of(&def);
    plan.wide = device->traversals->wants_wide && plan.trace == KDR_TRACE_AUTO;
    if (scene->committed && !scene->changed && same_build(&plan, &scene->plan))
        return KDR_OK;

    double start = kdr_cpu_seconds();
    uint32_t *first = NULL, nesting = nesting_of(scene);
    if (nesting > KDR_MAX_INSTANCE_DEPTH)
        return kdr_device_fail(device, KDR_ERROR_LIMIT, "instances lie at most %d deep in one another",
                               KDR_MAX_INSTANCE_DEPTH);
    kdr_status status = number_triangles(scene, &first);
    if (status != KDR_OK)
        return status;
    kdr_triangles triangles = {scene->geometries, first, scene->geometry_count};
    kdr_input input = kdr_triangles_input(&triangles);
    kdr_tree tree;
    kdr_input_counts counts;
    status = kdr_build(device->workshop, &device->crew, device->isa, &input, &plan, &tree, &counts);
    if (status == KDR_OK) {
        status = add_annexes(device, &plan, &tree);
        if (status != KDR_OK)
            kdr_tree_release(&tree, &device->bulk);
    }
    if (status != KDR_OK) {
        kdr_bulk_put(&device->bulk, first, ((size_t)scene->geometry_count + 1) * sizeof *first);
        if (status == KDR_ERROR_INVALID_DATA)
            return fail_invalid(scene, counts.invalid);
        return kdr_device_fail(device, status, "the tree of %u triangles was not built: %s", input.count,
                               kdr_status_text(status));
    }
    kdr_customs *customs;
    status = kdr_customs_create(device, scene->custom_defs, scene->geometry_count, &plan, &customs);
    if (status != KDR_OK) {
        kdr_tree_release(&tree, &device->bulk);
        kdr_bulk_put(&device->bulk, first, ((size_t)scene->geometry_count + 1) * sizeof *first);
        return status;
    }

    /* Put the new trees in the place of the old ones. */
    kdr_tree_release(&scene->tree, &device->bulk);
    kdr_customs_destroy(scene->customs, device);
    kdr_bulk_put(&device->bulk, scene->first, ((size_t)scene->committed_count + 1) * sizeof *first);
    scene->tree = tree;
    scene->customs = customs;
    scene->lone = kdr_lone_for(device->isa, plan.trace, plan.nodes, plan.mailbox);
    scene->first = first;
    scene->nesting = nesting;
    scene->committed_count = scene->geometry_count;
    scene->committed = true;
    scene->changed = false;
    scene->plan = plan;
    scene->build_seconds = kdr_cpu_seconds() - start;
    return KDR_OK;
}
