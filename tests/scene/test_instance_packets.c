/* Rays that go together through instances: each is answered as if it had come alone, to the bit. */
#include "kdray/kdray.h"
#include "support/everywhere.h"
#include "support/soup.h"
#include "support/test_size.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { RAYS = 64 * 12, MOST = 150 };

/* Objects within one another, some of them instances of a scene of instances, among triangles that stand and move. */
typedef struct crowd {
    kdr_device *device;
    kdr_scene *object, *group, *scene;
    soup_scene soup, others;
    float inner[5][12], outer[MOST][12];
} crowd;

static void random_transform(test_random *random, float spread, float m[12]) {
    float angle = test_random_between(random, 0, 6), size = test_random_between(random, 0.3f, 1);
    const float turned[12] = {size * cosf(angle),  0, size * sinf(angle), 0, 0, size, 0, 0,
                              -size * sinf(angle), 0, size * cosf(angle), 0};
    memcpy(m, turned, sizeof turned);
    for (int i = 0; i < 3; i++)
        m[4 * i + 3] = test_random_between(random, -spread, spread);
}

static uint32_t add_instances(kdr_scene *scene, const kdr_scene *shown, const float *transforms, uint32_t count) {
    uint32_t geometry;
    kdr_instance_def def = kdr_default_instance_def();
    def.scene = shown;
    def.transforms = transforms;
    def.count = count;
    assert_int_equal(kdr_scene_add_instance(scene, &def, &geometry), KDR_OK);
    return geometry;
}

/* with_triangles: triangles of the scene itself, static ones too, before and after the instances. Equal transforms
 * come twice, so that there are hits at one distance. */
static void open_crowd(crowd *c, test_random *random, kdr_isa isa, uint32_t count, float spread, bool with_triangles) {
    c->device = device_of_isa(isa, 1, NULL);
    assert_non_null(c->device);
    c->soup = soup_scene_create_kind(random, soup_kind_find("small"), 200);
    c->others = soup_scene_create_kind(random, soup_kind_find("large"), 40);
    c->object = committed_scene(c->device, c->soup.geometries, SOUP_GEOMETRIES, NULL);
    for (int i = 0; i < 5; i++)
        random_transform(random, 1, c->inner[i]);
    assert_int_equal(kdr_scene_create(c->device, &c->group), KDR_OK);
    add_instances(c->group, c->object, c->inner[0], 5);
    assert_int_equal(kdr_scene_commit(c->group, NULL), KDR_OK);

    for (uint32_t i = 0; i < count; i++)
        random_transform(random, spread, c->outer[i]);
    for (uint32_t i = 3; i < count; i += 3)
        memcpy(c->outer[i], c->outer[i - 1], sizeof c->outer[i]);
    assert_int_equal(kdr_scene_create(c->device, &c->scene), KDR_OK);
    if (with_triangles)
        for (uint32_t g = 0; g < 2; g++)
            assert_int_equal(kdr_scene_add_triangles(c->scene, &c->others.geometries[g], NULL), KDR_OK);
    uint32_t half = count / 2;
    add_instances(c->scene, c->object, c->outer[0], half);
    if (with_triangles)
        for (uint32_t g = 2; g < SOUP_GEOMETRIES; g++) {
            kdr_triangles_def def = c->others.geometries[g];
            def.is_static = true;
            assert_int_equal(kdr_scene_add_triangles(c->scene, &def, NULL), KDR_OK);
        }
    add_instances(c->scene, c->group, c->outer[half], count - half);
    assert_int_equal(kdr_scene_commit(c->scene, NULL), KDR_OK);
}

static void close_crowd(crowd *c) {
    kdr_scene_destroy(c->scene);
    kdr_scene_destroy(c->group);
    kdr_scene_destroy(c->object);
    kdr_device_destroy(c->device);
    soup_scene_destroy(&c->soup);
    soup_scene_destroy(&c->others);
}

/* Rays in bundles: each bundle from one place into nearly one direction. Some rays are short, some begin late, and some
 * are none at all. */
static void make_rays(test_random *random, kdr_ray *rays) {
    float o[3] = {0}, d[3] = {0};
    for (int i = 0; i < RAYS; i++) {
        if (i % 64 == 0)
            for (int k = 0; k < 3; k++) {
                o[k] = test_random_between(random, -4, 4);
                d[k] = test_random_between(random, -0.5f, 0.5f) - o[k];
            }
        rays[i] = (kdr_ray){.origin_x = o[0], .origin_y = o[1], .origin_z = o[2], .tmax = INFINITY};
        for (int k = 0; k < 3; k++)
            (&rays[i].direction_x)[k] = d[k] + test_random_between(random, -0.2f, 0.2f);
        uint32_t kind = test_random_below(random, 20);
        if (kind == 0)
            rays[i].tmax = test_random_between(random, 0, 1.5f);
        if (kind == 1)
            rays[i].tmin = test_random_between(random, 0, 1.5f);
        if (kind == 2)
            rays[i].tmax = -1;
        if (kind == 3)
            rays[i].direction_y = NAN;
    }
}

/* Returns how many rays hit. */
static size_t hold_together(const kdr_scene *scene, const kdr_ray *rays, kdr_coherence coherence) {
    kdr_ray_hit *together = test_allocate(RAYS, sizeof *together);
    uint8_t occluded[RAYS];
    size_t hits = 0;
    kdr_trace_def def = kdr_default_trace_def();
    def.coherence = coherence;
    for (int i = 0; i < RAYS; i++)
        together[i].ray = rays[i];
    kdr_intersect_n(scene, &def, together, RAYS);
    kdr_occluded_n(scene, &def, rays, occluded, RAYS);
    for (int i = 0; i < RAYS; i++) {
        kdr_ray_hit alone;
        memset(&alone, 0, sizeof alone);
        alone.ray = rays[i];
        kdr_intersect1(scene, &alone);
        assert_memory_equal(&together[i], &alone, sizeof alone);
        assert_int_equal(occluded[i], kdr_occluded1(scene, &rays[i]));
        hits += alone.hit.geometry != KDR_INVALID_ID;
    }
    free(together);
    return hits;
}

static void rays_together_are_answered_as_alone(void **state) {
    (void)state;
    static const uint32_t counts[] = {2, 7, 30, MOST};
    for (int isa = KDR_ISA_SCALAR; isa <= KDR_ISA_NEON; isa++) {
        kdr_device *device = device_of_isa((kdr_isa)isa, 1, NULL);
        if (!device)
            continue;
        kdr_device_destroy(device);
        test_random random = test_random_start(test_random_seed(), 500 + (uint64_t)isa);
        size_t hits = 0;
        for (size_t i = 0; i < 2 * sizeof counts / sizeof *counts; i++) {
            crowd c;
            kdr_ray rays[RAYS];
            /* The most of them in one place are more than a packet keeps apart. */
            open_crowd(&c, &random, (kdr_isa)isa, counts[i / 2], i < 6 ? 2.0f : 0.1f, i % 2);
            make_rays(&random, rays);
            hits += hold_together(c.scene, rays, KDR_COHERENCE_COHERENT);
            hold_together(c.scene, rays, KDR_COHERENCE_UNKNOWN);
            hold_together(c.scene, rays, KDR_COHERENCE_INCOHERENT);
            close_crowd(&c);
        }
        assert_true(hits > RAYS);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(rays_together_are_answered_as_alone)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
