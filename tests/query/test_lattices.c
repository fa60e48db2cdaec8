/* Scenes on lattices, where split planes, vertices, edges and ray origins coincide: rays that run in split planes,
 * along edges and through vertices by the thousand. */
#include "support/everywhere.h"
#include "support/soup.h"
#include "support/test_size.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define CELLS 8 /* of a lattice along each axis: bin borders of 32 bins fall on every quarter */

static void hold_rays(const float *triangles, size_t count, const kdr_ray *rays, size_t ray_count, size_t least_hits,
                      const char *label) {
    test_random random = test_random_start(test_random_seed(), 900);
    soup_scene geometry = soup_scene_create(&random, triangles, count);
    oracle_scene scene = oracle_scene_create(geometry.geometries, SOUP_GEOMETRIES);
    oracle_tree tree = oracle_tree_create(&scene);
    query_sheet sheet = query_sheet_create(&tree, rays, ray_count);
    assert_true(sheet.hit_count >= least_hits);
    hold_everywhere(geometry.geometries, SOUP_GEOMETRIES, &sheet, 3, label);
    query_sheet_destroy(&sheet);
    oracle_tree_destroy(&tree);
    oracle_scene_destroy(&scene);
    soup_scene_destroy(&geometry);
}

static void put_vertex(float *out, int axis, float plane, float j, float k) {
    out[axis] = plane;
    out[(axis + 1) % 3] = j;
    out[(axis + 2) % 3] = k;
}

/* Two triangles for each face between the cells of a lattice. Returns their number; free(*out). */
static size_t make_lattice(float **out) {
    size_t count = 0;
    float *triangles = test_allocate((size_t)3 * (CELLS + 1) * CELLS * CELLS * 2 * 9, sizeof(float));
    for (int axis = 0; axis < 3; axis++) {
        for (int plane = 0; plane <= CELLS; plane++) {
            for (int cell = 0; cell < CELLS * CELLS; cell++) {
                float j = (float)(cell % CELLS), k = (float)(cell / CELLS), *t = triangles + 9 * count;
                put_vertex(t, axis, (float)plane, j, k);
                put_vertex(t + 3, axis, (float)plane, j + 1, k);
                put_vertex(t + 6, axis, (float)plane, j, k + 1);
                put_vertex(t + 9, axis, (float)plane, j + 1, k);
                put_vertex(t + 12, axis, (float)plane, j + 1, k + 1);
                put_vertex(t + 15, axis, (float)plane, j, k + 1);
                count += 2;
            }
        }
    }
    *out = triangles;
    return count;
}

static kdr_ray half_step_ray(test_random *random, int steps) {
    float v[6];
    for (int k = 0; k < 3; k++)
        v[k] = (float)((int)test_random_below(random, 2 * CELLS + 5) - 2) / 2;
    do {
        for (int k = 3; k < 6; k++) {
            int step = (int)test_random_below(random, 2 * (uint32_t)steps + 1) - steps;
            v[k] = step == 0 && test_random_below(random, 2) ? -0.0f : (float)step;
        }
    } while (v[3] == 0 && v[4] == 0 && v[5] == 0);
    float tmin = test_random_below(random, 4) ? 0 : -1;
    return (kdr_ray){.origin_x = v[0],
                     .origin_y = v[1],
                     .origin_z = v[2],
                     .tmin = tmin,
                     .direction_x = v[3],
                     .direction_y = v[4],
                     .direction_z = v[5],
                     .tmax = INFINITY};
}

static void rays_in_the_faces_of_a_lattice_hit_what_the_oracle_says(void **state) {
    (void)state;
    enum { RAYS = TEST_SIZE(6000) };
    float *triangles;
    size_t count = make_lattice(&triangles);
    kdr_ray *rays = test_allocate(RAYS, sizeof(kdr_ray));
    test_random random = test_random_start(test_random_seed(), 901);
    for (int i = 0; i < RAYS; i++)
        rays[i] = half_step_ray(&random, i % 2 ? 1 : 3);
    hold_rays(triangles, count, rays, RAYS, RAYS / 2, "lattice");
    free(rays);
    free(triangles);
}

static void axis_parallel_rays_in_split_planes_hit_the_faces_across(void **state) {
    (void)state;
    float *triangles;
    size_t count = make_lattice(&triangles);
    // From every lattice point of the lower sides along the axis, with either zero across.
    enum { SIDE = CELLS + 1 };
    kdr_ray rays[3 * SIDE * SIDE * 2];
    size_t ray_count = 0;
    for (int axis = 0; axis < 3; axis++) {
        for (int point = 0; point < SIDE * SIDE; point++) {
            for (int sign = 0; sign < 2; sign++) {
                float o[3], d[3];
                float zero = sign ? -0.0f : 0.0f;
                put_vertex(o, axis, sign ? CELLS + 0.5f : -0.5f, (float)(point % SIDE), (float)(point / SIDE));
                put_vertex(d, axis, sign ? -1.0f : 1.0f, zero, zero);
                rays[ray_count++] = (kdr_ray){.origin_x = o[0],
                                              .origin_y = o[1],
                                              .origin_z = o[2],
                                              .direction_x = d[0],
                                              .direction_y = d[1],
                                              .direction_z = d[2],
                                              .tmax = INFINITY};
            }
        }
    }
    hold_rays(triangles, count, rays, ray_count, ray_count, "lattice along axes");
    free(triangles);
}

/* A terrain over a square lattice. */
static size_t make_terrain(float **out, int side, float (*height)(int, int)) {
    float *triangles = test_allocate((size_t)side * (size_t)side * 18, sizeof(float));
    for (int y = 0; y < side; y++) {
        for (int x = 0; x < side; x++) {
            static const int corners[6][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
            for (int k = 0; k < 6; k++) {
                float *v = triangles + 18 * (y * side + x) + 3 * k;
                int i = x + corners[k][0], j = y + corners[k][1];
                v[0] = (float)i, v[1] = (float)j, v[2] = height(i, j);
            }
        }
    }
    *out = triangles;
    return (size_t)side * (size_t)side * 2;
}

static float rough(int x, int y) { return (float)((x * 7919 + y * 104729 + x * y * 31) % 17) / 8; }
static float flat(int x, int y) { return (void)x, (void)y, 0.25f; }

static void hold_terrain(float (*height)(int, int), const char *label) {
    enum { SIDE = 32 };
    float *triangles;
    size_t count = make_terrain(&triangles, SIDE, height), ray_count = 0;
    kdr_ray *rays = test_allocate((2 * SIDE + 1) * (2 * SIDE + 1), sizeof(kdr_ray));
    // Straight down on every vertex, edge middle and cell centre.
    for (int y = 0; y <= 2 * SIDE; y++)
        for (int x = 0; x <= 2 * SIDE; x++)
            rays[ray_count++] = (kdr_ray){.origin_x = (float)x / 2,
                                          .origin_y = (float)y / 2,
                                          .origin_z = 10,
                                          .direction_x = -0.0f,
                                          .direction_z = -1,
                                          .tmax = INFINITY};
    hold_rays(triangles, count, rays, ray_count, ray_count, label);
    free(rays);
    free(triangles);
}

static void a_rough_terrain_has_no_gap_at_its_vertices_and_edges(void **state) {
    (void)state;
    hold_terrain(rough, "rough terrain");
}

static void a_flat_terrain_has_no_gap_at_its_vertices_and_edges(void **state) {
    (void)state;
    hold_terrain(flat, "flat terrain");
}

static void thousands_of_triangles_at_one_place_are_built_and_answered(void **state) {
    (void)state;
    enum { COPIES = TEST_SIZE(3000), RAYS = 40 };
    float *triangles = test_allocate(9 * COPIES, sizeof(float));
    static const float one[9] = {-1, -1, 0.5f, 1, -1, 0.25f, 0, 1, -0.5f};
    for (int i = 0; i < COPIES; i++)
        memcpy(triangles + 9 * i, one, sizeof(one));
    kdr_ray rays[RAYS];
    for (int i = 0; i < RAYS; i++)
        rays[i] = (kdr_ray){.origin_x = (float)(i % 7) / 8 - 0.375f,
                            .origin_y = (float)(i % 5) / 8 - 0.25f,
                            .origin_z = 4,
                            .direction_z = -1,
                            .tmax = INFINITY};
    hold_rays(triangles, COPIES, rays, RAYS, RAYS, "copies");
    free(triangles);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_in_the_faces_of_a_lattice_hit_what_the_oracle_says),
        cmocka_unit_test(axis_parallel_rays_in_split_planes_hit_the_faces_across),
        cmocka_unit_test(a_rough_terrain_has_no_gap_at_its_vertices_and_edges),
        cmocka_unit_test(a_flat_terrain_has_no_gap_at_its_vertices_and_edges),
        cmocka_unit_test(thousands_of_triangles_at_one_place_are_built_and_answered),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
