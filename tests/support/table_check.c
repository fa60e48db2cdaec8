#include "support/table_check.h"

#include "scene/scene.h"
#include "support/random.h"
#include "tree/node_arrays.h"
#include "tree/node_links.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static kdr_ray plain_ray(const float at[6]) {
    return (kdr_ray){.origin_x = at[0],
                     .origin_y = at[1],
                     .origin_z = at[2],
                     .direction_x = at[3] - at[0],
                     .direction_y = at[4] - at[1],
                     .direction_z = at[5] - at[2],
                     .tmax = INFINITY};
}

/* Every other ray is of a kind that traversals treat apart: along an axis or nearly so, from far away, with an
 * interval, behind the origin, short, long. */
static kdr_ray random_ray(test_random *random, uint32_t kind) {
    float at[6];
    for (int k = 0; k < 6; k++)
        at[k] = test_random_between(random, -1.5f, 1.5f);
    kdr_ray ray = plain_ray(at);
    float *direction = &ray.direction_x;
    switch (kind % 16) {
    case 1: direction[kind / 16 % 3] = 0; break;
    case 3: direction[kind / 16 % 3] = direction[(kind / 16 + 1) % 3] = -0.0f; break;
    case 5: direction[kind / 16 % 3] *= 0x1p-70f; break;
    case 7:
        at[kind / 16 % 3] *= 0x1p30f;
        ray = plain_ray(at);
        break;
    case 9:
        ray.tmin = 0.4f;
        ray.tmax = 0.8f;
        break;
    case 11: ray.tmin = -1; break;
    case 13:
    case 15:
        for (int k = 0; k < 3; k++)
            direction[k] *= kind % 16 == 13 ? 0x1p-50f : 0x1p70f;
        break;
    default: break;
    }
    return ray;
}

static bool same(bool hit, const kdr_found *found, bool expected_hit, const kdr_found *expected) {
    return hit == expected_hit && (!hit || memcmp(found, expected, sizeof *found) == 0);
}

/* The same for the traversals by name: many, so they are asked of some rays of each kind. */
static bool named_differ(const kdr_tree *tree, kdr_isa isa, const kdr_ray *ray, bool expected_hit,
                         const kdr_found *expected) {
    const kdr_lone *lones = &kdr_named_traversals_for(isa)->of[0][0][0];
    size_t asked = 0;
    for (size_t i = 0; i < sizeof(kdr_named_traversals) / sizeof *lones; i++) {
        if (!lones[i].closest)
            continue;
        kdr_found found = {0};
        if (!same(lones[i].closest(tree, ray, &found), &found, expected_hit, expected) ||
            lones[i].any(tree, ray) != expected_hit)
            return true;
        asked++;
    }
    return asked < 14;
}

/* Answers of a table for one ray, against those of the scalar stack. */
static bool differs(const kdr_tree *tree, kdr_isa isa, const kdr_ray *ray, bool by_name, bool *hit) {
    const kdr_traversals *table = kdr_traversals_for(isa);
    const kdr_traversals *scalar = kdr_traversals_for(KDR_ISA_SCALAR);
    kdr_entry root = kdr_entry_root(tree);
    kdr_found expected = {0}, stack = {0}, single = {0};
    *hit = scalar->stack_closest(tree, &root, ray, &expected);
    return !same(table->stack_closest(tree, &root, ray, &stack), &stack, *hit, &expected) ||
           !same(table->single_closest(tree, ray, &single), &single, *hit, &expected) ||
           table->stack_any(tree, &root, ray) != *hit || table->single_any(tree, ray) != *hit ||
           (by_name && named_differ(tree, isa, ray, *hit, &expected));
}

/* Answers of a table for a packet: rays of one kind from nearly one point to nearly another. */
static size_t packet_differences(const kdr_tree *tree, const kdr_traversals *table, test_random *random,
                                 uint32_t kind) {
    const kdr_traversals *scalar = kdr_traversals_for(KDR_ISA_SCALAR);
    kdr_entry root = kdr_entry_root(tree);
    kdr_packet_rays rays = {.valid = UINT64_MAX, .count = KDR_PACKET_RAYS, .go_together = kind % 3 != 0};
    kdr_packet_found found;
    const kdr_ray middle = random_ray(random, kind);
    for (uint32_t i = 0; i < KDR_PACKET_RAYS; i++) {
        const float *origin = &middle.origin_x, *direction = &middle.direction_x;
        for (int k = 0; k < 3; k++) {
            rays.origin[k][i] = origin[k] + (kind % 2 ? test_random_between(random, -0.02f, 0.02f) : 0);
            rays.direction[k][i] = direction[k] * test_random_between(random, 0.9f, 1.1f);
        }
        rays.tmin[i] = middle.tmin;
        rays.tmax[i] = middle.tmax;
    }
    table->packet_closest(tree, &rays, &found);
    uint64_t any = table->packet_any(tree, &rays);
    size_t differences = 0;
    for (uint32_t i = 0; i < KDR_PACKET_RAYS; i++) {
        kdr_ray ray = kdr_packet_ray(&rays, i);
        kdr_found expected = {.primitive = UINT32_MAX};
        bool hit = scalar->stack_closest(tree, &root, &ray, &expected);
        kdr_found given = {.primitive = found.primitive[i]};
        if (given.primitive != UINT32_MAX)
            given = (kdr_found){.t = found.t[i],
                                .u = found.u[i],
                                .v = found.v[i],
                                .normal = {found.normal[0][i], found.normal[1][i], found.normal[2][i]},
                                .primitive = found.primitive[i]};
        differences += !same(given.primitive != UINT32_MAX, &given, hit, &expected) || (any >> i & 1) != hit;
    }
    return differences;
}

static void check_build(kdr_device *device, const kdr_triangles_def *triangles, const kdr_build_def *build,
                        uint32_t rays, uint32_t longest_leaf, table_check *out) {
    test_random random = test_random_start(test_random_seed(), 78);
    kdr_isa isa = kdr_device_isa(device);
    bool wants_wide = kdr_traversals_for(isa)->wants_wide;
    kdr_scene *scene = NULL;
    kdr_tree_stats stats = {0};
    bool made = kdr_scene_create(device, &scene) == KDR_OK &&
                kdr_scene_add_triangles(scene, triangles, NULL) == KDR_OK && kdr_scene_commit(scene, build) == KDR_OK &&
                kdr_scene_stats(scene, &stats) == KDR_OK;
    out->builds++;

    /* One tree for all: with the annexes of every traversal by name. */
    made = made && kdr_tree_add_arrays(&scene->shown->dynamic_part->tree, &device->bulk) &&
           kdr_tree_add_links(&scene->shown->dynamic_part->tree, &device->bulk);
    if (!made || (scene->shown->dynamic_part->tree.wide != NULL) != wants_wide || stats.largest_leaf < longest_leaf) {
        out->unsound++;
        kdr_scene_destroy(scene);
        return;
    }
    scene->shown->dynamic_part->tree.mailbox_size = 16;
    for (uint32_t i = 0; i < rays; i++) {
        kdr_ray ray = random_ray(&random, i);
        bool hit;
        out->differences += differs(&scene->shown->dynamic_part->tree, isa, &ray, i % 13 == 0, &hit);
        out->hits += hit;
        out->rays++;
    }
    for (uint32_t i = 0; i < rays / KDR_PACKET_RAYS; i++)
        out->differences += packet_differences(&scene->shown->dynamic_part->tree, kdr_traversals_for(isa), &random, i);
    kdr_scene_destroy(scene);
}

table_check table_check_run(kdr_isa isa, size_t triangles, uint32_t rays) {
    table_check out = {0};
    kdr_device_def device_def = kdr_default_device_def();
    device_def.isa_limit = isa;
    device_def.worker_count = 1;
    kdr_device *device = NULL;
    float *corners = malloc(triangles * 9 * sizeof *corners);
    if (!corners || kdr_device_create(&device_def, &device) != KDR_OK || kdr_device_isa(device) != isa) {
        kdr_device_destroy(device);
        free(corners);
        return out;
    }
    test_random random = test_random_start(test_random_seed(), 77);
    for (size_t i = 0; i < triangles; i++) {
        float centre[3];
        for (int k = 0; k < 3; k++)
            centre[k] = test_random_between(&random, -1, 1);
        for (int k = 0; k < 9; k++)
            corners[9 * i + k] = centre[k % 3] + test_random_between(&random, -0.2f, 0.2f);
    }
    kdr_triangles_def def = kdr_default_triangles_def();
    def.vertices = corners;
    def.vertex_count = 3 * triangles;
    def.triangle_count = (uint32_t)triangles;

    /* Leaves as the default has them, small ones, and leaves too long for the word of a wide node's child. */
    kdr_build_def build = kdr_default_build_def();
    check_build(device, &def, &build, rays, 1, &out);
    build.cost_traversal = 0.1f;
    check_build(device, &def, &build, rays, 1, &out);
    build.cost_traversal = 60;
    build.leaf_limit = 200;
    check_build(device, &def, &build, rays, 61, &out);
    kdr_device_destroy(device);
    free(corners);
    return out;
}
