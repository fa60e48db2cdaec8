/* Embree's point queries as a second opinion on the closest point. Embree finds the triangles, and their distances are
 * worked out in numbers of 113 bits, so nothing is shared with the library. Embree compares in floats: of triangles
 * that are nearly as close it may take another, but none that is closer than the library's. */
#include "geometry/exact.h"
#include "support/closed_mesh.h"
#include "support/everywhere.h"
#include "support/exact_point.h"
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

#define QUERIES TEST_SIZE(2000)
#define SLACK 1e-5 /* of the distance and of the scene's size: what floats may be wrong by */

typedef struct other_closest {
    const oracle_scene *oracle;
    double distance;
} other_closest;

static bool other_look(struct RTCPointQueryFunctionArguments *at) {
    other_closest *closest = at->userPtr;
    const float query[3] = {at->query->x, at->query->y, at->query->z};
    const oracle_primitive *p = &closest->oracle->primitives[at->primID];
    const float corner[3][3] = {{p->a[0], p->a[1], p->a[2]}, {p->b[0], p->b[1], p->b[2]}, {p->c[0], p->c[1], p->c[2]}};
    double distance = exact_point_distance(query, corner);
    if (distance >= closest->distance)
        return false;
    closest->distance = distance;
    at->query->radius = nextafterf((float)distance, INFINITY);
    return true;
}

/* Vertices copied tight, as Embree reads 16 bytes at each. */
static RTCScene other_scene(RTCDevice device, const oracle_scene *oracle) {
    RTCScene scene = rtcNewScene(device);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float *vertices =
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, 3 * oracle->count);
    uint32_t *indices =
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, oracle->count);
    for (size_t i = 0; i < oracle->count; i++) {
        const oracle_primitive *p = &oracle->primitives[i];
        memcpy(vertices + 9 * i, p->a, 12);
        memcpy(vertices + 9 * i + 3, p->b, 12);
        memcpy(vertices + 9 * i + 6, p->c, 12);
        for (uint32_t k = 0; k < 3; k++)
            indices[3 * i + k] = 3 * (uint32_t)i + k;
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    return scene;
}

static void compare(const kdr_triangles_def *geometries, uint32_t geometry_count, uint64_t sequence) {
    oracle_scene oracle = oracle_scene_create(geometries, geometry_count);
    size_t kept = 0; /* without triangles of zero area, which the commit leaves out */
    for (size_t i = 0; i < oracle.count; i++)
        if (!kdr_triangle_is_flat(oracle.primitives[i].a, oracle.primitives[i].b, oracle.primitives[i].c))
            oracle.primitives[kept++] = oracle.primitives[i];
    oracle.count = kept;
    kdr_device *device;
    assert_int_equal(kdr_device_create(NULL, &device), KDR_OK);
    kdr_scene *scene = committed_scene(device, geometries, geometry_count, NULL);
    RTCDevice other_device = rtcNewDevice("threads=1");
    assert_non_null(other_device);
    RTCScene other = other_scene(other_device, &oracle);
    float bounds[6];
    kdr_scene_bounds(scene, bounds);

    test_random random = test_random_start(test_random_seed(), sequence);
    for (int i = 0; i < QUERIES; i++) {
        float at[3], stretch = test_random_below(&random, 4) ? 0.1f : 4;
        for (int k = 0; k < 3; k++) {
            float size = bounds[3 + k] - bounds[k];
            at[k] = test_random_between(&random, bounds[k] - stretch * size, bounds[3 + k] + stretch * size);
        }
        kdr_point_query query = {.x = at[0], .y = at[1], .z = at[2], .radius = INFINITY};
        kdr_point_hit hit;
        assert_true(kdr_closest_point(scene, &query, &hit));

        struct RTCPointQueryContext context;
        rtcInitPointQueryContext(&context);
        struct RTCPointQuery same = {.x = at[0], .y = at[1], .z = at[2], .radius = INFINITY};
        other_closest closest = {&oracle, INFINITY};
        rtcPointQuery(other, &same, &context, other_look, &closest);
        double difference = closest.distance - (double)hit.distance;
        if (difference < -0x1p-23 * closest.distance - 0x1p-40 || difference > SLACK * (closest.distance + 1))
            fail_msg("at %a %a %a: %a, but Embree finds %a", at[0], at[1], at[2], hit.distance, closest.distance);
    }

    rtcReleaseScene(other);
    rtcReleaseDevice(other_device);
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
    oracle_scene_destroy(&oracle);
}

static void embree_finds_no_closer_point_on_soups(void **state) {
    (void)state;
    static const char *const kinds[] = {"small", "large", "needles", "boxes", "fan"};
    for (size_t i = 0; i < sizeof(kinds) / sizeof(kinds[0]); i++) {
        test_random random = test_random_start(test_random_seed(), i);
        const soup_kind *kind = soup_kind_find(kinds[i]);
        soup_scene soup = soup_scene_create_kind(&random, kind, kind->count);
        compare(soup.geometries, SOUP_GEOMETRIES, 10 + i);
        soup_scene_destroy(&soup);
    }
}

static void embree_finds_no_closer_point_on_closed_meshes(void **state) {
    (void)state;
    closed_mesh meshes[] = {closed_mesh_sphere(20), closed_mesh_torus(60, 30), closed_mesh_blob(20)};
    for (size_t i = 0; i < sizeof(meshes) / sizeof(meshes[0]); i++) {
        kdr_triangles_def def = closed_mesh_def(&meshes[i]);
        compare(&def, 1, 20 + i);
        closed_mesh_destroy(&meshes[i]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(embree_finds_no_closer_point_on_soups),
        cmocka_unit_test(embree_finds_no_closer_point_on_closed_meshes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
