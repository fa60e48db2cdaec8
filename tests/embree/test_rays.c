/* Embree as a second opinion: random closest-hit and any-hit rays on several scenes. Embree works in floats and its
 * robust mode guards against gaps, not against rounding, so it may differ from the exact rule near edges and between
 * surfaces that almost touch. Wherever the two differ, the exact oracle decides, and it must side with kdray. */
#include "support/closed_mesh.h"
#include "support/everywhere.h"
#include "support/soup.h"
#include "support/test_size.h"

#include <embree3/rtcore.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define RAYS TEST_SIZE(100000)
#define DISTANCE_SLACK 1e-4f /* relative; a distance farther off counts as a difference */

/* Vertices copied tight, as Embree reads 16 bytes at each. */
static void embree_add(RTCDevice device, RTCScene scene, const oracle_scene *oracle) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    size_t count = oracle->count;
    float *vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, 3 * count);
    uint32_t *indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, count);
    for (size_t i = 0; i < count; i++) {
        memcpy(vertices + 9 * i, oracle->primitives[i].a, 12);
        memcpy(vertices + 9 * i + 3, oracle->primitives[i].b, 12);
        memcpy(vertices + 9 * i + 6, oracle->primitives[i].c, 12);
        for (uint32_t k = 0; k < 3; k++)
            indices[3 * i + k] = 3 * (uint32_t)i + k;
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
}

typedef struct tally {
    size_t hits, other_hits, other_occlusions;
} tally;

/* Rays from around the scene to random points of it; a quarter is cut short. */
static kdr_ray random_ray(test_random *random, const oracle_scene *oracle) {
    const oracle_primitive *from = &oracle->primitives[test_random_below(random, (uint32_t)oracle->count)];
    const oracle_primitive *to = &oracle->primitives[test_random_below(random, (uint32_t)oracle->count)];
    float u = test_random_float(random), v = (1 - u) * test_random_float(random), o[3], d[3];
    for (int axis = 0; axis < 3; axis++) {
        o[axis] = from->a[axis] + test_random_between(random, -1, 1);
        d[axis] = to->a[axis] * (1 - u - v) + to->b[axis] * u + to->c[axis] * v - o[axis];
    }
    float tmax = test_random_below(random, 4) ? INFINITY : test_random_between(random, 0, 1.5f);
    return (kdr_ray){.origin_x = o[0],
                     .origin_y = o[1],
                     .origin_z = o[2],
                     .direction_x = d[0],
                     .direction_y = d[1],
                     .direction_z = d[2],
                     .tmax = tmax};
}

static void compare_ray(const kdr_scene *scene, RTCScene other, const oracle_tree *tree, const kdr_ray *ray,
                        tally *counts) {
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    struct RTCRayHit closest = {0};
    closest.ray = (struct RTCRay){ray->origin_x,
                                  ray->origin_y,
                                  ray->origin_z,
                                  ray->tmin,
                                  ray->direction_x,
                                  ray->direction_y,
                                  ray->direction_z,
                                  0,
                                  ray->tmax,
                                  UINT32_MAX,
                                  0,
                                  0};
    closest.hit.geomID = closest.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    struct RTCRay any = closest.ray;
    rtcIntersect1(other, &context, &closest);
    rtcOccluded1(other, &context, &any);

    kdr_ray_hit given = {.ray = *ray};
    kdr_intersect1(scene, &given);
    bool occluded = kdr_occluded1(scene, ray), hit = given.hit.geometry != KDR_INVALID_ID;
    bool other_hit = closest.hit.geomID != RTC_INVALID_GEOMETRY_ID, other_occluded = any.tfar < 0;
    const oracle_primitive *other_primitive = other_hit ? &tree->scene->primitives[closest.hit.primID] : NULL;
    bool same = hit == other_hit;
    if (same && hit)
        same = given.hit.geometry == other_primitive->geometry && given.hit.primitive == other_primitive->primitive &&
               fabsf(given.ray.tmax - closest.ray.tfar) <= DISTANCE_SLACK * given.ray.tmax;
    counts->hits += hit;
    counts->other_hits += !same;
    counts->other_occlusions += occluded != other_occluded;

    // Whose answer is right where they differ is not a matter of opinion.
    if (!same || occluded != other_occluded) {
        oracle_hit answer = oracle_tree_closest(tree, ray);
        if (!query_answer_is_right(ray, &answer, &given, "differs from Embree") ||
            occluded != (answer.primitive != NULL))
            fail_msg("Embree and the oracle disagree with kdray");
    }
}

/* The scene has been committed with these geometries. */
static void compare_scene(const kdr_scene *scene, const kdr_triangles_def *geometries, uint32_t geometry_count,
                          uint64_t sequence, const char *label) {
    oracle_scene oracle = oracle_scene_create(geometries, geometry_count);
    oracle_tree tree = oracle_tree_create(&oracle);
    RTCDevice other_device = rtcNewDevice("threads=1");
    assert_non_null(other_device);
    RTCScene other = rtcNewScene(other_device);
    rtcSetSceneFlags(other, RTC_SCENE_FLAG_ROBUST);
    embree_add(other_device, other, &oracle);
    rtcCommitScene(other);

    test_random random = test_random_start(test_random_seed(), sequence);
    tally counts = {0};
    for (int i = 0; i < RAYS; i++) {
        kdr_ray ray = random_ray(&random, &oracle);
        compare_ray(scene, other, &tree, &ray, &counts);
    }
    printf("%s: %d rays, %zu hits; Embree differs in %zu closest hits and %zu occlusions, the oracle in none\n", label,
           RAYS, counts.hits, counts.other_hits, counts.other_occlusions);
    // A test in which everything differs would prove nothing.
    assert_true(counts.hits > RAYS / 5 && counts.other_hits < RAYS / 10 && counts.other_occlusions < RAYS / 10);

    rtcReleaseScene(other);
    rtcReleaseDevice(other_device);
    oracle_tree_destroy(&tree);
    oracle_scene_destroy(&oracle);
}

static void compare(const kdr_triangles_def *geometries, uint32_t geometry_count, uint64_t sequence,
                    const char *label) {
    kdr_device *device;
    assert_int_equal(kdr_device_create(NULL, &device), KDR_OK);
    kdr_scene *scene = committed_scene(device, geometries, geometry_count, NULL);
    compare_scene(scene, geometries, geometry_count, sequence, label);
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
}

static void compare_kind(const char *kind, size_t count, uint64_t sequence) {
    test_random random = test_random_start(test_random_seed(), sequence);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find(kind), count);
    compare(soup.geometries, SOUP_GEOMETRIES, sequence, kind);
    soup_scene_destroy(&soup);
}

static void compare_mesh(closed_mesh mesh, uint64_t sequence, const char *label) {
    kdr_triangles_def def = closed_mesh_def(&mesh);
    compare(&def, 1, sequence, label);
    closed_mesh_destroy(&mesh);
}

static void where_embree_differs_on_soups_kdray_is_right(void **state) {
    (void)state;
    compare_kind("small", 20000, 1);
    compare_kind("large", 500, 2);
    compare_kind("needles", 3000, 3);
}

static void where_embree_differs_on_closed_meshes_kdray_is_right(void **state) {
    (void)state;
    compare_mesh(closed_mesh_sphere(40), 4, "sphere");
    compare_mesh(closed_mesh_torus(200, 100), 5, "torus");
    compare_mesh(closed_mesh_blob(40), 6, "blob");
}

/* One scene, committed again for every frame: all triangles elsewhere, and sometimes other numbers of them. */
static void where_embree_differs_on_frames_of_what_moves_kdray_is_right(void **state) {
    (void)state;
    kdr_device *device;
    kdr_scene *scene;
    assert_int_equal(kdr_device_create(NULL, &device), KDR_OK);
    assert_int_equal(kdr_scene_create(device, &scene), KDR_OK);
    kdr_triangles_def none = kdr_default_triangles_def();
    for (uint32_t g = 0; g < SOUP_GEOMETRIES; g++)
        assert_int_equal(kdr_scene_add_triangles(scene, &none, NULL), KDR_OK);
    for (uint64_t frame = 0; frame < 6; frame++) {
        test_random random = test_random_start(test_random_seed(), 10 + frame);
        soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), 2000 + 700 * (frame / 2));
        for (uint32_t g = 0; g < SOUP_GEOMETRIES; g++)
            assert_int_equal(kdr_scene_set_triangles(scene, g, &soup.geometries[g]), KDR_OK);
        assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
        compare_scene(scene, soup.geometries, SOUP_GEOMETRIES, 10 + frame, "frame");
        soup_scene_destroy(&soup);
    }
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(where_embree_differs_on_soups_kdray_is_right),
        cmocka_unit_test(where_embree_differs_on_closed_meshes_kdray_is_right),
        cmocka_unit_test(where_embree_differs_on_frames_of_what_moves_kdray_is_right),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
