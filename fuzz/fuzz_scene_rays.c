/* Bytes to a scene and rays: build constants, a few dozen triangles and rays, as raw floats and snapped to small grids.
 * Every query must answer as the exact oracle does and every tree must be sound; aborts on the first difference. */
#include "support/failing_alloc.h"
#include "support/query_sheet.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MOST_TRIANGLES 48
#define MOST_RAYS 24
#define GEOMETRIES 2

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Bytes from the front; zeros when there are no more. */
typedef struct source {
    const uint8_t *data;
    size_t size;
} source;

static void take(source *from, void *out, size_t size) {
    size_t there = size < from->size ? size : from->size;
    memset(out, 0, size);
    if (there > 0)
        memcpy(out, from->data, there);
    from->data += there;
    from->size -= there;
}

static uint8_t take_byte(source *from) {
    uint8_t byte;
    take(from, &byte, 1);
    return byte;
}

static float take_raw(source *from) {
    float value;
    take(from, &value, sizeof(value));
    return value;
}

/* A number of a small grid: -8 to 7.9375 in steps of 1/16, or whole numbers only. */
static float take_snapped(source *from, bool whole) {
    int8_t value = (int8_t)take_byte(from);
    return whole ? (float)(value / 16) : (float)value / 16;
}

/* How the numbers of one triangle or ray are written. */
enum { FORM_RAW, FORM_GRID, FORM_WHOLE, FORM_SCALED };

static void take_floats(source *from, float *out, int count) {
    uint8_t form = take_byte(from);
    int exponent = form % 4 == FORM_SCALED ? (int8_t)take_byte(from) : 0;
    for (int i = 0; i < count; i++)
        out[i] = form % 4 == FORM_RAW ? take_raw(from) : ldexpf(take_snapped(from, form % 4 == FORM_WHOLE), exponent);
}

static kdr_build_def take_build_def(source *from) {
    kdr_build_def def = kdr_default_build_def();
    uint8_t flags = take_byte(from);
    if (flags & 1)
        def.cost_traversal = 1 + take_byte(from);
    if (flags & 2)
        def.cost_intersection = 1 + take_byte(from);
    if (flags & 4)
        def.leaf_limit = 1 + take_byte(from) % 40;
    if (flags & 8)
        def.depth_limit = take_byte(from) % (KDR_MAX_DEPTH + 1);
    if (flags & 16)
        def.reference_limit = 1 + (float)take_byte(from) / 16;
    if (flags & 32) {
        uint8_t rules = take_byte(from);
        def.split = (kdr_split_rule)(rules % 3);
        def.axis = (kdr_axis_rule)(rules / 3 % 4);
        def.straddle = (kdr_straddle_rule)(rules / 12 % 3);
    }
    if (flags & 64) {
        uint8_t rules = take_byte(from);
        def.order = (kdr_order_rule)(rules % 2);
        def.share = (kdr_share_rule)(rules / 2 % 5);
        def.share_count = def.share == KDR_SHARE_NONE ? 0 : 1 + take_byte(from) % 20;
        def.retract = rules / 10 % 2 > 0;
        if (def.order == KDR_ORDER_DEPTH_FIRST && !def.retract && !(flags & 128) && rules / 20 % 2)
            def.lazy_limit = KDR_MIN_LAZY_LIMIT;
    }
    if (flags & 128) {
        uint8_t rules = take_byte(from);
        def.split = KDR_SPLIT_SWEEP;
        def.events = (kdr_event_form)(2 + rules % 2);
        def.straddle = (kdr_straddle_rule)(rules / 2 % 3);
        def.box_weight = (float)(rules / 6 % 3) / 2;
    }
    return def;
}

static kdr_ray take_ray(source *from) {
    float v[6];
    take_floats(from, v, 6);
    kdr_ray ray = {.origin_x = v[0],
                   .origin_y = v[1],
                   .origin_z = v[2],
                   .direction_x = v[3],
                   .direction_y = v[4],
                   .direction_z = v[5],
                   .tmax = INFINITY};
    switch (take_byte(from) % 4) {
    case 1: ray.tmin = take_raw(from), ray.tmax = take_raw(from); break;
    case 2: ray.tmin = take_snapped(from, false), ray.tmax = take_snapped(from, false); break;
    case 3: ray.tmin = -INFINITY; break;
    default: break;
    }
    return ray;
}

static void demand(bool condition, const char *what) {
    if (condition)
        return;
    printf("broken: %s\n", what);
    fflush(stdout);
    abort();
}

/* One device for each instruction set, made once and kept: its working memory is what a host's frames go through.
 * Memory comes from the heap, where a leak detector finds its way. */
static kdr_device *device_of(uint8_t choice) {
    static kdr_device *devices[KDR_ISA_NEON + 1];
    static failing_alloc memory;
    kdr_isa isa = (kdr_isa)(choice % (KDR_ISA_NEON + 1));
    if (!devices[isa]) {
        kdr_device_def def = kdr_default_device_def();
        def.worker_count = 1;
        def.isa_limit = isa;
        def.allocator = failing_alloc_functions(&memory);
        demand(kdr_device_create(&def, &devices[isa]) == KDR_OK, "a device is made");
    }
    return devices[isa];
}

static void check_scene(kdr_device *device, const kdr_triangles_def *defs, const kdr_build_def *build,
                        const kdr_ray *rays, size_t ray_count) {
    kdr_scene *scene;
    demand(kdr_scene_create(device, &scene) == KDR_OK, "a scene is made");
    for (int i = 0; i < GEOMETRIES; i++)
        demand(kdr_scene_add_triangles(scene, &defs[i], NULL) == KDR_OK, "triangles are added");
    demand(kdr_scene_commit(scene, build) == KDR_OK, "the scene is committed");
    demand(kdr_scene_verify(scene) == KDR_OK, "the tree is sound");

    oracle_scene oracle = oracle_scene_create(defs, GEOMETRIES);
    oracle_tree tree = oracle_tree_create(&oracle);
    query_sheet sheet = query_sheet_create(&tree, rays, ray_count);
    for (size_t i = 0; i < ray_count; i++) {
        oracle_hit brute = oracle_closest(&oracle, &rays[i]);
        demand(brute.primitive == sheet.answers[i].primitive && brute.t == sheet.answers[i].t,
               "the oracle agrees with itself");
    }
    demand(query_sheet_differences(&sheet, scene, kdr_isa_name(kdr_device_isa(device))) == 0, "the answers are right");
    query_sheet_destroy(&sheet);
    oracle_tree_destroy(&tree);
    oracle_scene_destroy(&oracle);
    kdr_scene_destroy(scene);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    source from = {data, size};
    kdr_device *device = device_of(take_byte(&from));
    kdr_build_def build = take_build_def(&from);

    float triangles[MOST_TRIANGLES][9];
    size_t count = take_byte(&from) % (MOST_TRIANGLES + 1);
    for (size_t i = 0; i < count; i++) {
        // Some are copies of the one before, whole or but for one vertex.
        uint8_t copy = i > 0 ? take_byte(&from) % 4 : 0;
        if (copy > 1)
            memcpy(triangles[i], triangles[i - 1], sizeof(triangles[i]));
        if (copy == 2)
            take_floats(&from, triangles[i] + 3 * (i % 3), 3);
        if (copy < 2)
            take_floats(&from, triangles[i], 9);
    }
    kdr_triangles_def defs[GEOMETRIES] = {kdr_default_triangles_def(), kdr_default_triangles_def()};
    size_t first = count / 2;
    for (int i = 0; i < GEOMETRIES; i++) {
        defs[i].vertices = triangles[i == 0 ? 0 : first];
        defs[i].triangle_count = i == 0 ? first : count - first;
        defs[i].vertex_count = 3 * defs[i].triangle_count;
    }

    kdr_ray rays[MOST_RAYS];
    size_t ray_count = 0;
    while (ray_count < MOST_RAYS && from.size > 0)
        rays[ray_count++] = take_ray(&from);
    check_scene(device, defs, &build, rays, ray_count);
    return 0;
}
