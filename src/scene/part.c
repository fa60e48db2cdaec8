#include "scene/part.h"

#include "tree/node_arrays.h"
#include "tree/node_links.h"
#include "tree/projections.h"

static size_t first_bytes(uint32_t count) { return ((size_t)count + 1) * sizeof(uint32_t); }

uint64_t kdr_part_triangles(const kdr_triangles_def *geometries, uint32_t count, bool is_static) {
    uint64_t total = 0;
    for (uint32_t g = 0; g < count; g++)
        total += geometries[g].is_static == is_static ? geometries[g].triangle_count : 0;
    return total;
}

/* Numbers the triangles of the part through all geometries. */
static void number_triangles(const kdr_triangles_def *geometries, uint32_t count, bool is_static, uint32_t *first) {
    first[0] = 0;
    for (uint32_t g = 0; g < count; g++)
        first[g + 1] = first[g] + (geometries[g].is_static == is_static ? (uint32_t)geometries[g].triangle_count : 0);
}

/* Says which triangle has a vertex number that is out of range. */
static kdr_status fail_invalid(const kdr_device *device, const kdr_triangles *triangles, uint64_t invalid) {
    for (uint32_t g = 0; g < triangles->count; g++) {
        const kdr_triangles_def *def = &triangles->geometries[g];
        for (uint32_t i = 0; i < triangles->first[g + 1] - triangles->first[g]; i++) {
            for (uint32_t j = 0; j < 3; j++) {
                uint64_t vertex = 3 * (uint64_t)i + j;
                if (def->indices)
                    vertex = ((const uint32_t *)((const char *)def->indices + (size_t)i * def->index_stride))[j];
                if (vertex >= def->vertex_count)
                    return kdr_device_fail(device, KDR_ERROR_INVALID_DATA,
                                           "triangle %u of geometry %u has vertex %llu, but there are %zu (%llu such "
                                           "triangles in all)",
                                           i, g, (unsigned long long)vertex, def->vertex_count,
                                           (unsigned long long)invalid);
            }
        }
    }
    return kdr_device_fail(device, KDR_ERROR_INVALID_DATA, "vertex numbers changed while the commit ran");
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

/* A part without a tree, with room for the numbers of `count` geometries; one user. NULL: no memory. */
static kdr_part *reserve(kdr_device *device, uint32_t count, uint32_t **first) {
    size_t bytes = sizeof(kdr_part), numbers = first_bytes(count);
    kdr_part *part = kdr_bulk_get(&device->bulk, &bytes);
    *first = kdr_bulk_get(&device->bulk, &numbers);
    if (!part || !*first) {
        kdr_bulk_put(&device->bulk, part, sizeof *part);
        kdr_bulk_put(&device->bulk, *first, first_bytes(count));
        return NULL;
    }
    *part = (kdr_part){.first = *first, .count = count, .users = 1};
    return part;
}

static void release(kdr_part *part, kdr_device *device) {
    kdr_bulk_put(&device->bulk, (uint32_t *)part->first, first_bytes(part->count));
    kdr_bulk_put(&device->bulk, part, sizeof *part);
}

kdr_status kdr_part_create(kdr_device *device, const kdr_triangles_def *geometries, uint32_t count, bool is_static,
                           const kdr_plan *plan, kdr_listener *listener, kdr_part **out) {
    *out = NULL;
    if (kdr_part_triangles(geometries, count, is_static) > KDR_NODE_MAX_INDEX)
        return kdr_device_fail(device, KDR_ERROR_LIMIT, "a scene has at most 2^30 - 1 triangles");
    uint32_t *first;
    kdr_part *part = reserve(device, count, &first);
    if (!part)
        return kdr_device_fail(device, KDR_ERROR_OUT_OF_MEMORY, "out of memory for %u geometries", count);
    number_triangles(geometries, count, is_static, first);

    /* Build. */
    kdr_triangles triangles = {geometries, first, count};
    kdr_input input = kdr_triangles_input(&triangles);
    input.listener = listener;
    kdr_tree tree;
    kdr_input_counts counts;
    kdr_status status = kdr_build(device->workshop, &device->crew, device->isa, &input, plan, &tree, &counts);
    if (status == KDR_OK) {
        status = add_annexes(device, plan, &tree);
        if (status != KDR_OK)
            kdr_tree_release(&tree, &device->bulk);
    }
    if (status == KDR_ERROR_INVALID_DATA)
        fail_invalid(device, &triangles, counts.invalid);
    else if (status != KDR_OK && status != KDR_ERROR_CANCELLED)
        kdr_device_fail(device, status, "the tree of %u triangles was not built: %s", input.count,
                        kdr_status_text(status));
    if (status != KDR_OK) {
        release(part, device);
        return status;
    }
    part->tree = tree;
    part->lone = kdr_lone_for(device->isa, plan->trace, plan->nodes, plan->mailbox);
    part->plan = *plan;
    *out = part;
    return KDR_OK;
}

kdr_part *kdr_part_create_empty(kdr_device *device) {
    uint32_t *first;
    kdr_part *part = reserve(device, 0, &first);
    if (!part)
        return NULL;
    first[0] = 0;
    if (!kdr_tree_init_empty(&part->tree, &device->bulk)) {
        release(part, device);
        return NULL;
    }
    part->lone = kdr_lone_for(device->isa, KDR_TRACE_AUTO, KDR_NODES_STRUCTURES, KDR_MAILBOX_NONE);
    return part;
}

void kdr_part_leave(kdr_part *part, kdr_device *device) {
    if (!part || --part->users > 0)
        return;
    kdr_tree_release(&part->tree, &device->bulk);
    release(part, device);
}
