/* Closed meshes seen from inside: rays at vertices, at the middles of edges and at points of edges never slip through,
 * by the default plan, by any traversal that a plan names, and in packets.
 *
 * Half of the meshes have their vertices on a lattice of 2^-11 and are seen from points of a lattice, so that the rays
 * go through vertices and edges exactly. KDR_TEST_LONG=1 shoots ten million rays, else it is a part of that. */
#include "support/closed_mesh.h"
#include "support/everywhere.h"
#include "support/soup.h"
#include "support/test_size.h"
#include "support/trace_check.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define RAYS_LONG 10000000
#define RAYS_SHORT TEST_SIZE(1000000)
#define RUN 1000    /* rays asked at once */
#define PLAN_RUNS 2 /* by each plan */
#define PLAN_RUNS_LONG 40
#define ORACLE_SHARE 100 /* two runs in so many are held against the oracle as well */
#define SNAP 0x1p-11f

typedef void origin_fn(test_random *random, float out[3]);

/* Near the middle, on a lattice. */
static void origin_in_ball(test_random *random, float out[3]) {
    for (int axis = 0; axis < 3; axis++)
        out[axis] = (float)((int)test_random_below(random, 65) - 32) * 0x1p-10f;
}

/* Near one of four points of the tube's middle. */
static void origin_in_torus(test_random *random, float out[3]) {
    origin_in_ball(random, out);
    uint32_t side = test_random_below(random, 4);
    out[side % 2] += side < 2 ? 1 : -1;
}

/* The target of a ray, on a triangle: 0 a vertex, 1 the middle of an edge, 2 a point of an edge. */
static void choose_target(test_random *random, const closed_mesh *mesh, uint32_t triangle, uint32_t kind,
                          float out[3]) {
    const uint32_t *corners = mesh->indices + 3 * (size_t)triangle;
    uint32_t turn = test_random_below(random, 3);
    const float *a = mesh->vertices + 3 * (size_t)corners[turn];
    const float *b = mesh->vertices + 3 * (size_t)corners[(turn + 1) % 3];
    float s = kind == 0 ? 0 : kind == 1 ? 0.5f : test_random_float(random);
    for (int axis = 0; axis < 3; axis++)
        out[axis] = a[axis] * (1 - s) + b[axis] * s;
}

/* Ways to ask RUN rays for closest and any hits. together: the rays go the same way. */
typedef void ask_fn(const kdr_scene *scene, bool together, const kdr_ray *rays, kdr_ray_hit *hits, uint8_t *occluded);

static void ask_by_calls(const kdr_scene *scene, bool together, const kdr_ray *rays, kdr_ray_hit *hits,
                         uint8_t *occluded) {
    kdr_trace_def def = kdr_default_trace_def();
    def.coherence = together ? KDR_COHERENCE_COHERENT : KDR_COHERENCE_UNKNOWN;
    kdr_intersect_n(scene, &def, hits, RUN);
    kdr_occluded_n(scene, &def, rays, occluded, RUN);
}

static void ask_alone(const kdr_scene *scene, bool together, const kdr_ray *rays, kdr_ray_hit *hits,
                      uint8_t *occluded) {
    (void)together;
    for (uint32_t i = 0; i < RUN; i++) {
        kdr_intersect1(scene, &hits[i]);
        occluded[i] = kdr_occluded1(scene, &rays[i]);
    }
}

/* Packets; of the last one only some rays are active. */
#define ASK_BY_PACKETS(N)                                                                                              \
    static void ask_by_packets_of_##N(const kdr_scene *scene, bool together, const kdr_ray *rays, kdr_ray_hit *hits,   \
                                      uint8_t *occluded) {                                                             \
        (void)together;                                                                                                \
        for (uint32_t first = 0; first < RUN; first += (N)) {                                                          \
            int32_t valid[N] = {0};                                                                                    \
            uint32_t fields[12 * (N)] = {0};                                                                           \
            kdr_ray_hit##N packet = {0};                                                                               \
            for (uint32_t i = 0; i < (N) && first + i < RUN; i++) {                                                    \
                valid[i] = -1;                                                                                         \
                for (uint32_t k = 0; k < 12; k++)                                                                      \
                    memcpy(&fields[k * (N) + i], (const uint32_t *)&rays[first + i] + k, 4);                           \
            }                                                                                                          \
            memcpy(&packet.ray, fields, sizeof packet.ray);                                                            \
            kdr_ray##N shadow = packet.ray;                                                                            \
            kdr_intersect##N(scene, valid, &packet);                                                                   \
            kdr_occluded##N(scene, valid, &shadow);                                                                    \
            for (uint32_t i = 0; i < (N) && first + i < RUN; i++) {                                                    \
                hits[first + i].hit.geometry = packet.hit.geometry[i];                                                 \
                occluded[first + i] = shadow.tmax[i] == -INFINITY;                                                     \
            }                                                                                                          \
        }                                                                                                              \
    }

ASK_BY_PACKETS(4)
ASK_BY_PACKETS(8)
ASK_BY_PACKETS(16)

typedef struct shooting {
    const closed_mesh *mesh;
    const kdr_scene *scene;
    ask_fn *ask;
    const oracle_tree *tree; /* NULL: the oracle is not asked */
    origin_fn *origin;
    uint64_t sequence;
    bool is_silent; /* rays that slip through are counted only */
    _Atomic uint64_t misses;
} shooting;

static void shoot_run(void *context, uint32_t index) {
    shooting *shot = context;
    test_random random = test_random_start(test_random_seed(), shot->sequence + index);
    kdr_ray rays[RUN];
    kdr_ray_hit hits[RUN];
    uint8_t occluded[RUN];
    /* Every other run is of rays that go together: 64 from one point to triangles that are neighbours or nearly so. */
    bool together = index % 2 == 1;
    const uint32_t triangles = (uint32_t)shot->mesh->triangle_count;
    uint32_t triangle = 0;
    float o[3];
    for (uint32_t i = 0; i < RUN; i++) {
        float target[3];
        if (!together || i % 64 == 0) {
            shot->origin(&random, o);
            triangle = test_random_below(&random, triangles);
        }
        uint32_t aim = together ? (triangle + test_random_below(&random, 8)) % triangles : triangle;
        choose_target(&random, shot->mesh, aim, i % 3, target);
        rays[i] = (kdr_ray){.origin_x = o[0],
                            .origin_y = o[1],
                            .origin_z = o[2],
                            .direction_x = target[0] - o[0],
                            .direction_y = target[1] - o[1],
                            .direction_z = target[2] - o[2],
                            .tmax = INFINITY};
        hits[i].ray = rays[i];
    }
    shot->ask(shot->scene, together, rays, hits, occluded);
    for (uint32_t i = 0; i < RUN; i++) {
        if (hits[i].hit.geometry != KDR_INVALID_ID && occluded[i] == 1)
            continue;
        if (atomic_fetch_add(&shot->misses, 1) < 5 && !shot->is_silent) {
            printf("a ray slipped through: closest %u, any %u\n", hits[i].hit.geometry, occluded[i]);
            query_print_ray(&rays[i]);
        }
    }
    if (shot->tree && index % ORACLE_SHARE < 2) {
        query_sheet sheet = query_sheet_create(shot->tree, rays, RUN);
        if (sheet.hit_count != RUN || query_sheet_differences(&sheet, shot->scene, "closed mesh") > 0)
            atomic_fetch_add(&shot->misses, 1);
        query_sheet_destroy(&sheet);
    }
}

/* Shoots on every instruction set, most of the rays on the widest. */
static void assert_no_miss(closed_mesh mesh, origin_fn *origin, uint64_t sequence) {
    uint32_t runs = (uint32_t)(test_is_long() ? RAYS_LONG : RAYS_SHORT) / RUN / 6;
    kdr_triangles_def def = closed_mesh_def(&mesh);
    oracle_scene oracle = oracle_scene_create(&def, 1);
    oracle_tree tree = oracle_tree_create(&oracle);
    kdr_device *widest;
    assert_int_equal(kdr_device_create(NULL, &widest), KDR_OK);
    kdr_isa last = kdr_device_isa(widest);
    kdr_device_destroy(widest);
    for (int isa = KDR_ISA_SCALAR; isa <= (int)last; isa++) {
        kdr_device *device = device_of_isa((kdr_isa)isa, 0, NULL);
        if (!device)
            continue;
        kdr_scene *scene = committed_scene(device, &def, 1, NULL);
        shooting shot = {&mesh, scene, ask_by_calls, &tree, origin, sequence << 32, false, 0};
        kdr_device_run(device, shoot_run, &shot, isa == (int)last ? runs : runs / 10 + 1);
        assert_int_equal(shot.misses, 0);
        kdr_scene_destroy(scene);
        kdr_device_destroy(device);
    }
    oracle_tree_destroy(&tree);
    oracle_scene_destroy(&oracle);
    closed_mesh_destroy(&mesh);
}

static void no_ray_leaves_a_geodesic_sphere(void **state) {
    (void)state;
    assert_no_miss(closed_mesh_sphere(30), origin_in_ball, 1);
}

static void no_ray_leaves_a_geodesic_sphere_through_exact_vertices_and_edges(void **state) {
    (void)state;
    closed_mesh mesh = closed_mesh_sphere(20);
    closed_mesh_snap(&mesh, SNAP);
    assert_no_miss(mesh, origin_in_ball, 2);
}

static void no_ray_leaves_a_torus(void **state) {
    (void)state;
    assert_no_miss(closed_mesh_torus(150, 70), origin_in_torus, 3);
}

static void no_ray_leaves_a_torus_through_exact_vertices_and_edges(void **state) {
    (void)state;
    closed_mesh mesh = closed_mesh_torus(100, 50);
    closed_mesh_snap(&mesh, SNAP);
    assert_no_miss(mesh, origin_in_torus, 4);
}

static void no_ray_leaves_a_blob(void **state) {
    (void)state;
    assert_no_miss(closed_mesh_blob(40), origin_in_ball, 5);
}

static void no_ray_leaves_a_blob_through_exact_vertices_and_edges(void **state) {
    (void)state;
    closed_mesh mesh = closed_mesh_blob(25);
    closed_mesh_snap(&mesh, SNAP);
    assert_no_miss(mesh, origin_in_ball, 6);
}

/* The same by one plan and one way to ask. Runs of rays that go together follow runs of others. */
static void assert_no_miss_by(const closed_mesh *mesh, const kdr_scene *scene, kdr_device *device, ask_fn *ask,
                              origin_fn *origin, uint64_t sequence, const char *label) {
    shooting shot = {mesh, scene, ask, NULL, origin, sequence << 32, false, 0};
    kdr_device_run(device, shoot_run, &shot, test_is_long() ? PLAN_RUNS_LONG : PLAN_RUNS);
    if (shot.misses > 0)
        fail_msg("%s: %u misses", label, (unsigned)shot.misses);
}

static ask_fn *const asks[] = {ask_alone, ask_by_calls, ask_by_packets_of_4, ask_by_packets_of_8, ask_by_packets_of_16};
#define ASKS (sizeof asks / sizeof asks[0])

/* These tests can fail. */
static void a_mesh_without_its_last_triangle_lets_rays_out_however_they_are_asked(void **state) {
    (void)state;
    closed_mesh mesh = closed_mesh_sphere(3);
    kdr_triangles_def def = closed_mesh_def(&mesh);
    def.triangle_count--;
    kdr_device *device;
    assert_int_equal(kdr_device_create(NULL, &device), KDR_OK);
    kdr_scene *scene = committed_scene(device, &def, 1, NULL);
    for (size_t ask = 0; ask < ASKS; ask++) {
        shooting shot = {&mesh, scene, asks[ask], NULL, origin_in_ball, UINT64_C(99) << 32, true, 0};
        kdr_device_run(device, shoot_run, &shot, 4);
        assert_true(shot.misses > 0 && shot.misses < 2 * RUN);
    }
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
    closed_mesh_destroy(&mesh);
}

static void no_ray_leaves_by_any_traversal_or_in_any_packet(void **state) {
    (void)state;
    closed_mesh meshes[] = {closed_mesh_sphere(20), closed_mesh_torus(100, 50), closed_mesh_blob(25)};
    origin_fn *const origins[] = {origin_in_ball, origin_in_torus, origin_in_ball};
    size_t scenes = 0;
    for (size_t m = 0; m < sizeof meshes / sizeof meshes[0]; m++) {
        closed_mesh_snap(&meshes[m], SNAP);
        kdr_triangles_def triangles = closed_mesh_def(&meshes[m]);
        for (int isa = KDR_ISA_SCALAR; isa <= KDR_ISA_NEON; isa++) {
            kdr_device *device = device_of_isa((kdr_isa)isa, 0, NULL);
            for (size_t row = 0; device && row < trace_row_count; row++) {
                // Where every step costs many times more, each traversal has one mesh of three on an instruction set.
                if (TEST_SIZE(10) == 1 && (m + row + (size_t)isa) % 3 != 0)
                    continue;
                char plan[100], label[160];
                kdr_build_def def;
                // Leaves of few triangles: more cells, and more planes to slip through between them.
                snprintf(plan, sizeof plan, "%s %s traversal-cost=1 leaf-limit=4", trace_rows[row],
                         row == 0 ? "" : mailbox_rows[(row + m) % mailbox_row_count]);
                snprintf(label, sizeof label, "mesh %zu, %s, %s", m, kdr_isa_name((kdr_isa)isa), plan);
                assert_int_equal(kdr_build_def_parse(plan, &def, NULL, 0), KDR_OK);
                kdr_scene *scene = committed_scene(device, &triangles, 1, &def);
                for (size_t ask = 0; ask < (row == 0 ? ASKS : 1); ask++)
                    assert_no_miss_by(&meshes[m], scene, device, asks[ask], origins[m], 100 + row + 20 * m, label);
                kdr_scene_destroy(scene);
                scenes++;
            }
            kdr_device_destroy(device);
        }
        closed_mesh_destroy(&meshes[m]);
    }
    assert_true(scenes >= trace_row_count);
}

/* The plane z = 0 cuts the torus along edges, and trees along that plane: such rays run between two cells all the way,
 * and meet four triangles at a vertex. Directions of two lengths, since short ones take another path. */
static void rays_between_two_halves_of_a_torus_see_both(void **state) {
    (void)state;
    enum { COUNT = TEST_SIZE(4000) };
    closed_mesh mesh = closed_mesh_torus(100, 50);
    closed_mesh_snap(&mesh, SNAP);
    kdr_triangles_def def = closed_mesh_def(&mesh);
    oracle_scene oracle = oracle_scene_create(&def, 1);
    oracle_tree tree = oracle_tree_create(&oracle);
    test_random random = test_random_start(test_random_seed(), 7);
    kdr_ray *rays = test_allocate(COUNT, sizeof(kdr_ray));
    for (int i = 0; i < COUNT; i++) {
        float o[3], target[3];
        origin_in_torus(&random, o);
        choose_target(&random, &mesh, test_random_below(&random, (uint32_t)mesh.triangle_count), 0, target);
        float length = i % 2 ? 1 : 0x1p-110f;
        rays[i] = (kdr_ray){.origin_x = o[0],
                            .origin_y = o[1],
                            .direction_x = (target[0] - o[0]) * length,
                            .direction_y = (target[1] - o[1]) * length,
                            .tmax = INFINITY};
    }
    query_sheet sheet = query_sheet_create(&tree, rays, COUNT);
    assert_true(sheet.hit_count == COUNT);
    hold_everywhere(&def, 1, &sheet, 2, "torus cut in halves");
    query_sheet_destroy(&sheet);
    free(rays);
    oracle_tree_destroy(&tree);
    oracle_scene_destroy(&oracle);
    closed_mesh_destroy(&mesh);
}

/* Every edge belongs to two triangles that run along it in opposite directions. */
static void the_meshes_of_this_test_are_closed(void **state) {
    (void)state;
    closed_mesh meshes[] = {closed_mesh_sphere(7), closed_mesh_torus(11, 9), closed_mesh_blob(7)};
    for (size_t m = 0; m < sizeof(meshes) / sizeof(meshes[0]); m++) {
        const closed_mesh *mesh = &meshes[m];
        size_t edge_count = 3 * mesh->triangle_count;
        for (size_t i = 0; i < edge_count; i++) {
            const float *from = mesh->vertices + 3 * (size_t)mesh->indices[i];
            const float *to = mesh->vertices + 3 * (size_t)mesh->indices[i / 3 * 3 + (i + 1) % 3];
            int back = 0;
            for (size_t k = 0; k < edge_count; k++) {
                const float *other_from = mesh->vertices + 3 * (size_t)mesh->indices[k];
                const float *other_to = mesh->vertices + 3 * (size_t)mesh->indices[k / 3 * 3 + (k + 1) % 3];
                back += memcmp(from, other_to, 12) == 0 && memcmp(to, other_from, 12) == 0;
            }
            assert_int_equal(back, 1);
        }
        closed_mesh_destroy(&meshes[m]);
    }
}

int main(void) {
    test_random_seed();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_meshes_of_this_test_are_closed),
        cmocka_unit_test(a_mesh_without_its_last_triangle_lets_rays_out_however_they_are_asked),
        cmocka_unit_test(no_ray_leaves_a_geodesic_sphere),
        cmocka_unit_test(no_ray_leaves_a_geodesic_sphere_through_exact_vertices_and_edges),
        cmocka_unit_test(no_ray_leaves_a_torus),
        cmocka_unit_test(no_ray_leaves_a_torus_through_exact_vertices_and_edges),
        cmocka_unit_test(rays_between_two_halves_of_a_torus_see_both),
        cmocka_unit_test(no_ray_leaves_by_any_traversal_or_in_any_packet),
        cmocka_unit_test(no_ray_leaves_a_blob),
        cmocka_unit_test(no_ray_leaves_a_blob_through_exact_vertices_and_edges),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
