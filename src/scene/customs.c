/* Custom primitives as the input of a builder, and as what queries ask.
 *
 * A box is asked for once, when references are gathered, and kept until the leaves are filled: so the tree is one of
 * the same boxes throughout, whatever a callback does. */
#include "scene/customs.h"

#include "scene/triangles.h"
#include "trace/custom.h"

typedef struct custom_input {
    const kdr_customs *customs;
    kdr_box *boxes; /* a primitive */
} custom_input;

static bool is_finite(const kdr_box *box) {
    float sum = 0; /* of zeros, unless a number is not finite */
    for (int k = 0; k < 3; k++)
        sum += (box->lo[k] - box->lo[k]) + (box->hi[k] - box->hi[k]);
    return sum == 0;
}

static uint32_t boxes(const void *context, uint32_t begin, uint32_t end, const kdr_references *to, uint32_t at,
                      kdr_box *bounds, kdr_input_counts *counts) {
    const custom_input *input = context;
    const kdr_customs *c = input->customs;
    const uint32_t first_place = at;
    uint32_t g = kdr_geometry_of(c->first, c->count, begin);
    for (uint32_t i = begin; i < end; i++) {
        while (i >= c->first[g + 1])
            g++;
        kdr_box box = {{NAN, NAN, NAN}, {NAN, NAN, NAN}};
        c->defs[g].bounds(i - c->first[g], box.lo, box.hi, c->defs[g].user);
        input->boxes[i] = box;
        if (!is_finite(&box)) {
            counts->dropped++;
            continue;
        }
        if (kdr_box_is_empty(&box)) {
            counts->invalid++;
            continue;
        }
        for (int k = 0; k < 3; k++) {
            to->lo[k][at] = box.lo[k];
            to->hi[k][at] = box.hi[k];
        }
        to->primitive[at++] = i;
        kdr_box_add(bounds, &box);
    }
    return at - first_place;
}

static void fill(const void *context, float *blocks, kdr_node leaf, const uint32_t *primitives) {
    const custom_input *input = context;
    kdr_boxed_group *groups = kdr_boxed_start(blocks, leaf);
    const kdr_box none = kdr_box_empty();
    uint32_t count = kdr_node_count(leaf), places = kdr_block_groups(count) * KDR_BLOCK_GROUP;
    for (uint32_t i = 0; i < places; i++)
        kdr_boxed_set(groups, i, i < count ? &input->boxes[primitives[i]] : &none,
                      i < count ? primitives[i] : UINT32_MAX);
}

static bool is_instances(const kdr_custom_def *def) { return def->bounds == kdr_instances_bounds; }

/* Says which primitive has a box that is upside down. */
static kdr_status fail_invalid(const kdr_device *device, const custom_input *input, uint64_t invalid) {
    const kdr_customs *c = input->customs;
    uint32_t i = 0, axis = 0;
    while (!is_finite(&input->boxes[i]) || !kdr_box_is_empty(&input->boxes[i]))
        i++;
    const kdr_box *box = &input->boxes[i];
    while (box->lo[axis] <= box->hi[axis])
        axis++;
    uint32_t g = kdr_geometry_of(c->first, c->count, i);
    if (is_instances(&c->defs[g]))
        return kdr_device_fail(device, KDR_ERROR_INVALID_DATA,
                               "instance %u of geometry %u has a transform that cannot be undone (%llu such in all)",
                               i - c->first[g], g, (unsigned long long)invalid);
    return kdr_device_fail(
        device, KDR_ERROR_INVALID_DATA,
        "custom primitive %u of geometry %u has a box from %g to %g on axis %c (%llu such boxes in all)",
        i - c->first[g], g, (double)box->lo[axis], (double)box->hi[axis], "xyz"[axis], (unsigned long long)invalid);
}

static kdr_status build(kdr_device *device, const kdr_plan *plan, kdr_listener *listener, kdr_customs *c) {
    uint32_t total = c->first[c->count];
    size_t box_bytes = total * sizeof(kdr_box), box_size = box_bytes;
    custom_input context = {.customs = c, .boxes = kdr_bulk_get(&device->bulk, &box_size)};
    if (!context.boxes)
        return kdr_device_fail(device, KDR_ERROR_OUT_OF_MEMORY, "out of memory for the boxes of %u custom primitives",
                               total);
    kdr_input input = {
        .context = &context, .count = total, .listener = listener, .boxed = true, .boxes = boxes, .fill = fill};
    kdr_plan narrow = *plan; /* the wide tree is one of triangles */
    narrow.wide = false;
    kdr_input_counts counts;
    kdr_status status = kdr_build(device->workshop, &device->crew, device->isa, &input, &narrow, &c->tree, &counts);
    if (status == KDR_ERROR_INVALID_DATA)
        fail_invalid(device, &context, counts.invalid);
    else if (status != KDR_OK && status != KDR_ERROR_CANCELLED)
        kdr_device_fail(device, status, "the tree of %u custom primitives was not built: %s", total,
                        kdr_status_text(status));
    kdr_bulk_put(&device->bulk, context.boxes, box_bytes);
    return status;
}

/* Puts instances as they are now in the place of their defs, numbered through. False: no memory; those that were made
 * are there, and NULL is for the others. */
static bool take_instances(kdr_device *device, kdr_customs *c) {
    uint32_t number = 0;
    bool made = true;
    for (uint32_t g = 0; g < c->count; g++) {
        if (!is_instances(&c->defs[g])) {
            c->has_others |= c->defs[g].primitive_count > 0;
            continue;
        }
        kdr_instances *instances = made ? kdr_instances_create(device, c->defs[g].user) : NULL;
        made = instances != NULL;
        c->defs[g].user = instances;
        if (made)
            instances->first = number;
        number += c->defs[g].primitive_count;
    }
    return made;
}

uint64_t kdr_customs_total(const kdr_custom_def *defs, uint32_t count) {
    uint64_t total = 0;
    for (uint32_t g = 0; defs && g < count; g++)
        total += defs[g].primitive_count;
    return total;
}

kdr_status kdr_customs_create(kdr_device *device, const kdr_custom_def *defs, uint32_t count, const kdr_plan *plan,
                              kdr_listener *listener, kdr_customs **out) {
    *out = NULL;
    const uint64_t total = kdr_customs_total(defs, count);
    if (total == 0)
        return KDR_OK;
    if (total > KDR_NODE_MAX_INDEX)
        return kdr_device_fail(device, KDR_ERROR_LIMIT, "a scene has at most 2^30 - 1 custom primitives");

    /* Keep the defs as they are now. */
    size_t self = sizeof(kdr_customs), defs_bytes = count * sizeof *defs;
    size_t first_bytes = ((size_t)count + 1) * sizeof(uint32_t);
    kdr_customs *c = kdr_bulk_get(&device->bulk, &self);
    if (!c)
        return kdr_device_fail(device, KDR_ERROR_OUT_OF_MEMORY, "out of memory for custom primitives");
    *c = (kdr_customs){.count = count};
    c->defs = kdr_bulk_get(&device->bulk, &defs_bytes);
    c->first = kdr_bulk_get(&device->bulk, &first_bytes);
    if (!c->defs || !c->first) {
        kdr_customs_destroy(c, device);
        return kdr_device_fail(device, KDR_ERROR_OUT_OF_MEMORY, "out of memory for %u geometries", count);
    }
    c->first[0] = 0;
    for (uint32_t g = 0; g < count; g++) {
        c->defs[g] = defs[g];
        c->first[g + 1] = c->first[g] + defs[g].primitive_count;
    }

    c->is_taken = true;
    kdr_status status = take_instances(device, c) ? KDR_OK : KDR_ERROR_OUT_OF_MEMORY;
    if (status == KDR_OK)
        status = build(device, plan, listener, c);
    else
        kdr_device_fail(device, status, "out of memory for instances");
    if (status == KDR_OK)
        *out = c;
    else
        kdr_customs_destroy(c, device);
    return status;
}

void kdr_customs_destroy(kdr_customs *customs, kdr_device *device) {
    if (!customs)
        return;
    kdr_tree_release(&customs->tree, &device->bulk);
    for (uint32_t g = 0; customs->is_taken && g < customs->count; g++)
        if (is_instances(&customs->defs[g]))
            kdr_instances_destroy(customs->defs[g].user, device);
    kdr_bulk_put(&device->bulk, customs->defs, customs->count * sizeof *customs->defs);
    kdr_bulk_put(&device->bulk, customs->first, ((size_t)customs->count + 1) * sizeof *customs->first);
    kdr_bulk_put(&device->bulk, customs, sizeof *customs);
}

/* ---- queries */

/* A ray on its way, and what the primitive that it met last, and the one that it met first of all, is called. */
typedef struct custom_query {
    const kdr_customs *customs;
    kdr_hit met, closest; /* primitive, geometry and instance alone */
} custom_query;

static bool intersect(void *context, const kdr_ray *ray, uint32_t primitive, kdr_custom_hit *hit) {
    custom_query *query = context;
    const kdr_customs *c = query->customs;
    uint32_t g = kdr_geometry_of(c->first, c->count, primitive), i = primitive - c->first[g];
    const kdr_custom_def *def = &c->defs[g];
    if (is_instances(def)) {
        const kdr_instances *instances = def->user;
        query->met.instance = instances->first + i;
        return kdr_instances_closest(instances, i, ray, hit, &query->met);
    }
    query->met.primitive = i;
    query->met.geometry = g;
    query->met.instance = KDR_INVALID_ID;
    return def->intersect(ray, i, hit, def->user);
}

static void take(void *context) {
    custom_query *query = context;
    query->closest = query->met;
}

static bool occluded(void *context, const kdr_ray *ray, uint32_t primitive) {
    const kdr_customs *c = ((custom_query *)context)->customs;
    uint32_t g = kdr_geometry_of(c->first, c->count, primitive), i = primitive - c->first[g];
    const kdr_custom_def *def = &c->defs[g];
    if (is_instances(def))
        return kdr_instances_any(def->user, i, ray);
    if (def->occluded)
        return def->occluded(ray, i, def->user);
    kdr_custom_hit hit = {0};
    return def->intersect(ray, i, &hit, def->user) && hit.t > ray->tmin && hit.t <= ray->tmax;
}

void kdr_customs_closest(const kdr_customs *customs, kdr_ray_hit *ray_hit) {
    custom_query query = {.customs = customs};
    kdr_custom_answers answers = {&query, intersect, take, occluded};
    uint32_t triangle = ray_hit->hit.geometry, primitive;
    /* At the distance of a triangle only primitives of lower geometries count. */
    uint32_t limit = triangle == KDR_INVALID_ID ? UINT32_MAX : customs->first[triangle];
    kdr_custom_hit hit;
    if (!kdr_custom_closest(&customs->tree, &answers, &ray_hit->ray, limit, &hit, &primitive))
        return;
    ray_hit->ray.tmax = hit.t;
    ray_hit->hit = (kdr_hit){.normal_x = hit.normal_x,
                             .normal_y = hit.normal_y,
                             .normal_z = hit.normal_z,
                             .u = hit.u,
                             .v = hit.v,
                             .primitive = query.closest.primitive,
                             .geometry = query.closest.geometry,
                             .instance = query.closest.instance};
}

bool kdr_customs_any(const kdr_customs *customs, const kdr_ray *ray) {
    custom_query query = {.customs = customs};
    kdr_custom_answers answers = {&query, intersect, take, occluded};
    return kdr_custom_any(&customs->tree, &answers, ray);
}
