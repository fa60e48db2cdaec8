/* Instances: what a ray meets in them is what it meets in the scene they show, taken there; by every way to build. */
#include "support/customs.h"
#include "support/everywhere.h"
#include "support/failing_alloc.h"
#include "support/soup.h"
#include "support/test_size.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define RAYS TEST_SIZE(2000)
#define INSTANCES 60

static kdr_device *device_of(uint32_t workers, const kdr_allocator *functions) {
    kdr_device_def def = kdr_default_device_def();
    def.worker_count = workers;
    def.allocator = functions ? *functions : def.allocator;
    kdr_device *device;
    assert_int_equal(kdr_device_create(&def, &device), KDR_OK);
    return device;
}

/* Turned, stretched by different factors, sometimes mirrored, and moved. */
static void random_transform(test_random *random, float m[12]) {
    double q[4], length = 0;
    for (int i = 0; i < 4; i++) {
        q[i] = test_random_between(random, -1, 1);
        length += q[i] * q[i];
    }
    length = sqrt(length) + 1e-9;
    double w = q[0] / length, x = q[1] / length, y = q[2] / length, z = q[3] / length;
    const double turn[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                               {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                               {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
    for (int j = 0; j < 3; j++) {
        double size = test_random_between(random, 0.05f, 0.6f) * (test_random_below(random, 4) ? 1 : -1);
        for (int i = 0; i < 3; i++)
            m[4 * i + j] = (float)(turn[i][j] * size);
    }
    for (int i = 0; i < 3; i++)
        m[4 * i + 3] = test_random_between(random, -1.5f, 1.5f);
}

static kdr_ray random_ray(test_random *random) {
    float o[3], d[3], scale = test_random_between(random, 0.1f, 4);
    for (int k = 0; k < 3; k++) {
        o[k] = test_random_between(random, -3, 3);
        d[k] = scale * (test_random_between(random, -1.5f, 1.5f) - o[k]);
    }
    kdr_ray ray = {o[0], o[1], o[2], 0, d[0], d[1], d[2], 0, INFINITY, 0, 0, 0};
    uint32_t kind = test_random_below(random, 6);
    if (kind < 3)
        (&ray.direction_x)[kind] = 0;
    if (kind == 3)
        ray.tmax = test_random_between(random, 0, 1.2f) / scale;
    return ray;
}

/* The inverse of a transform by elimination, as an oracle of its own. */
static void invert(const float m[12], double inverse[3][4]) {
    double a[3][7];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 7; j++)
            a[i][j] = j < 3 ? m[4 * i + j] : j < 6 ? i == j - 3 : -m[4 * i + 3];
    for (int c = 0; c < 3; c++) {
        int pivot = c;
        for (int i = c; i < 3; i++)
            pivot = fabs(a[i][c]) > fabs(a[pivot][c]) ? i : pivot;
        for (int j = 0; j < 7; j++) {
            double other = a[pivot][j];
            a[pivot][j] = a[c][j];
            a[c][j] = other;
        }
        for (int i = 0; i < 3; i++) {
            double factor = a[i][c] / a[c][c];
            for (int j = 0; j < 7 && i != c; j++)
                a[i][j] -= factor * a[c][j];
        }
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            inverse[i][j] = a[i][3 + j] / a[i][i];
}

/* A ray as an instance sees it. The sums may differ in their last bit in double, and hardly ever in float. */
static kdr_ray taken_in(const kdr_ray *ray, const float m[12]) {
    double inverse[3][4];
    invert(m, inverse);
    kdr_ray inside = *ray;
    for (int i = 0; i < 3; i++) {
        const float *o = &ray->origin_x, *d = &ray->direction_x;
        (&inside.origin_x)[i] =
            (float)(inverse[i][0] * o[0] + inverse[i][1] * o[1] + inverse[i][2] * o[2] + inverse[i][3]);
        (&inside.direction_x)[i] = (float)(inverse[i][0] * d[0] + inverse[i][1] * d[1] + inverse[i][2] * d[2]);
    }
    return inside;
}

/* A scene with two shown scenes and triangles of its own, and the rays that ask it. */
typedef struct world {
    soup_scene soups[3];
    kdr_scene *shown[2], *outer;
    float transforms[2][INSTANCES][16]; /* with room between */
    uint32_t triangle_geometry, instance_geometry[2];
} world;

static kdr_instance_def instances_of(const world *w, int i) {
    kdr_instance_def def = kdr_default_instance_def();
    def.scene = w->shown[i];
    def.transforms = w->transforms[i][0];
    def.transform_stride = sizeof w->transforms[i][0];
    def.count = INSTANCES;
    return def;
}

static void world_open(world *w, kdr_device *device, test_random *random, const kdr_build_def *plan) {
    for (int i = 0; i < 3; i++)
        w->soups[i] = soup_scene_create_kind(random, soup_kind_find("large"), i == 2 ? 12 : 40);
    for (int i = 0; i < 2; i++) {
        w->shown[i] = committed_scene(device, w->soups[i].geometries, SOUP_GEOMETRIES, plan);
        for (int k = 0; k < INSTANCES; k++)
            random_transform(random, w->transforms[i][k]);
    }
    assert_int_equal(kdr_scene_create(device, &w->outer), KDR_OK);
    kdr_instance_def first = instances_of(w, 0), second = instances_of(w, 1);
    assert_int_equal(kdr_scene_add_instance(w->outer, &first, &w->instance_geometry[0]), KDR_OK);
    for (int g = 0; g < SOUP_GEOMETRIES; g++)
        assert_int_equal(kdr_scene_add_triangles(w->outer, &w->soups[2].geometries[g], NULL), KDR_OK);
    assert_int_equal(kdr_scene_add_instance(w->outer, &second, &w->instance_geometry[1]), KDR_OK);
    assert_int_equal(kdr_scene_commit(w->outer, plan), KDR_OK);
    assert_int_equal(kdr_scene_verify(w->outer), KDR_OK);
}

static void world_close(world *w) {
    kdr_scene_destroy(w->outer);
    for (int i = 0; i < 2; i++)
        kdr_scene_destroy(w->shown[i]);
    for (int i = 0; i < 3; i++)
        soup_scene_destroy(&w->soups[i]);
}

/* Every instance is asked, one by one; flat: the outer scene's own triangles. */
static kdr_ray_hit by_brute_force(const world *w, const kdr_scene *flat, const kdr_ray *ray) {
    kdr_ray_hit best = {.ray = *ray};
    kdr_intersect1(flat, &best);
    uint32_t geometry = best.hit.geometry == KDR_INVALID_ID ? UINT32_MAX : best.hit.geometry + 1;
    best.hit.instance = KDR_INVALID_ID;
    for (uint32_t i = 0; i < 2; i++)
        for (uint32_t k = 0; k < INSTANCES; k++) {
            kdr_ray_hit inside = {.ray = taken_in(ray, w->transforms[i][k])};
            kdr_intersect1(w->shown[i], &inside);
            if (inside.hit.geometry == KDR_INVALID_ID || inside.ray.tmax > best.ray.tmax)
                continue;
            if (inside.ray.tmax == best.ray.tmax && geometry <= w->instance_geometry[i])
                continue;
            best.ray.tmax = inside.ray.tmax;
            best.hit = inside.hit;
            best.hit.instance = i * INSTANCES + k;
            geometry = w->instance_geometry[i];
        }
    return best;
}

static bool same_hit(const kdr_ray_hit *a, const kdr_ray_hit *b) {
    return a->hit.geometry == b->hit.geometry &&
           (a->hit.geometry == KDR_INVALID_ID ||
            (a->ray.tmax == b->ray.tmax && a->hit.primitive == b->hit.primitive && a->hit.instance == b->hit.instance &&
             a->hit.u == b->hit.u && a->hit.v == b->hit.v));
}

static void a_ray_meets_in_instances_what_it_meets_in_the_scene_they_show(void **state) {
    (void)state;
    custom_plan plans[CUSTOM_PLANS];
    size_t plan_count = custom_plans(plans), hits = 0, in_instances = 0, wrong = 0;
    kdr_device *device = device_of(1, NULL);
    for (size_t p = 0; p < plan_count; p += p < 8 ? 1 : TEST_SIZE(70) / 3 + 1) {
        test_random random = test_random_start(test_random_seed(), 100 + p);
        world w;
        world_open(&w, device, &random, &plans[p].def);
        kdr_scene *flat;
        assert_int_equal(kdr_scene_create(device, &flat), KDR_OK);
        for (int g = 0; g < SOUP_GEOMETRIES; g++)
            assert_int_equal(kdr_scene_add_triangles(flat, &w.soups[2].geometries[g], NULL), KDR_OK);
        assert_int_equal(kdr_scene_commit(flat, NULL), KDR_OK);
        kdr_ray *rays = test_allocate(RAYS, sizeof *rays);
        kdr_ray_hit *many = test_allocate(RAYS, sizeof *many);
        uint8_t *occluded = test_allocate(RAYS, 1);
        for (size_t i = 0; i < RAYS; i++) {
            rays[i] = random_ray(&random);
            many[i].ray = rays[i];
        }
        kdr_intersect_n(w.outer, NULL, many, RAYS);
        kdr_occluded_n(w.outer, NULL, rays, occluded, RAYS);
        for (size_t i = 0; i < RAYS; i++) {
            kdr_ray_hit expected = by_brute_force(&w, flat, &rays[i]), given = {.ray = rays[i]};
            kdr_intersect1(w.outer, &given);
            bool hit = expected.hit.geometry != KDR_INVALID_ID;
            if (hit && expected.hit.instance == KDR_INVALID_ID)
                expected.hit.geometry += 1; /* the first geometry is of instances */
            hits += hit;
            in_instances += hit && expected.hit.instance != KDR_INVALID_ID;
            wrong += !same_hit(&given, &expected) || !same_hit(&many[i], &given) ||
                     kdr_occluded1(w.outer, &rays[i]) != hit || occluded[i] != hit;
        }
        kdr_scene_destroy(flat);
        world_close(&w);
        free(rays);
        free(many);
        free(occluded);
    }
    kdr_device_destroy(device);
    assert_int_equal(wrong, 0);
    assert_true(in_instances > hits / 4 && hits > in_instances);
}

/* What the transforms mean, held against triangles that were moved: nearly the same hits, and the same normals. */
static void an_instance_is_where_its_triangles_would_be_if_they_were_moved(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 7);
    kdr_device *device = device_of(1, NULL);
    size_t hits = 0, apart = 0;
    for (int round = 0; round < 20; round++) {
        float corners[3][3], there[3][3], m[12];
        for (int i = 0; i < 9; i++)
            corners[i / 3][i % 3] = test_random_between(&random, -1, 1);
        random_transform(&random, m);
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++)
                there[i][k] = m[4 * k] * corners[i][0] + m[4 * k + 1] * corners[i][1] + m[4 * k + 2] * corners[i][2] +
                              m[4 * k + 3];
        kdr_triangles_def one = kdr_default_triangles_def();
        one.vertices = corners[0];
        one.vertex_count = 3;
        one.triangle_count = 1;
        kdr_scene *shown = committed_scene(device, &one, 1, NULL), *outer;
        one.vertices = there[0];
        kdr_scene *moved = committed_scene(device, &one, 1, NULL);
        assert_int_equal(kdr_scene_create(device, &outer), KDR_OK);
        kdr_instance_def def = kdr_default_instance_def();
        def.scene = shown;
        def.transforms = m;
        assert_int_equal(kdr_scene_add_instance(outer, &def, NULL), KDR_OK);
        assert_int_equal(kdr_scene_commit(outer, NULL), KDR_OK);
        for (int i = 0; i < 100; i++) {
            kdr_ray ray = random_ray(&random);
            for (int k = 0; k < 3; k++) /* at the middle, or a little beside it */
                (&ray.direction_x)[k] = (there[0][k] + there[1][k] + there[2][k]) / 3 +
                                        test_random_between(&random, -0.1f, 0.1f) - (&ray.origin_x)[k];
            ray.tmax = INFINITY;
            kdr_ray_hit a = {.ray = ray}, b = {.ray = ray};
            kdr_intersect1(outer, &a);
            kdr_intersect1(moved, &b);
            if (a.hit.geometry != b.hit.geometry) {
                apart++;
                continue;
            }
            if (a.hit.geometry == KDR_INVALID_ID)
                continue;
            hits++;
            const float *n = &a.hit.normal_x, *o = &b.hit.normal_x;
            float size = fabsf(o[0]) + fabsf(o[1]) + fabsf(o[2]);
            assert_true(fabsf(a.ray.tmax - b.ray.tmax) < 1e-3f && a.hit.instance == 0);
            assert_true(fabsf(a.hit.u - b.hit.u) < 1e-2f && fabsf(a.hit.v - b.hit.v) < 1e-2f);
            for (int k = 0; k < 3; k++)
                assert_true(fabsf(n[k] - o[k]) < 1e-3f * size);
        }
        kdr_scene_destroy(outer);
        kdr_scene_destroy(moved);
        kdr_scene_destroy(shown);
    }
    kdr_device_destroy(device);
    assert_true(hits > 300 && apart * 50 < hits);
}

/* A triangle that is shown a level deeper each time, and moved by one in x. */
static void instances_lie_in_one_another_as_deep_as_is_said(void **state) {
    (void)state;
    const float corners[9] = {0, -1, -1, 0, 1, -1, 0, 0, 1}, step[12] = {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0};
    kdr_device *device = device_of(1, NULL);
    kdr_triangles_def one = kdr_default_triangles_def();
    one.vertices = corners;
    one.vertex_count = 3;
    one.triangle_count = 1;
    kdr_scene *scenes[KDR_MAX_INSTANCE_DEPTH + 2] = {committed_scene(device, &one, 1, NULL)};
    for (int i = 1; i <= KDR_MAX_INSTANCE_DEPTH + 1; i++) {
        assert_int_equal(kdr_scene_create(device, &scenes[i]), KDR_OK);
        kdr_instance_def def = kdr_default_instance_def();
        def.scene = scenes[i - 1];
        def.transforms = step;
        assert_int_equal(kdr_scene_add_instance(scenes[i], &def, NULL), KDR_OK);
        assert_int_equal(kdr_scene_commit(scenes[i], NULL), i <= KDR_MAX_INSTANCE_DEPTH ? KDR_OK : KDR_ERROR_LIMIT);
        kdr_ray_hit hit = {.ray = {.origin_x = -1, .direction_x = 1, .tmax = INFINITY}};
        kdr_intersect1(scenes[i], &hit);
        assert_int_equal(hit.hit.geometry, i <= KDR_MAX_INSTANCE_DEPTH ? 0 : KDR_INVALID_ID);
        assert_true(i > KDR_MAX_INSTANCE_DEPTH || hit.ray.tmax == (float)(i + 1));
    }
    for (int i = KDR_MAX_INSTANCE_DEPTH + 1; i >= 0; i--)
        kdr_scene_destroy(scenes[i]);
    kdr_device_destroy(device);
}

static void what_is_wrong_with_instances_is_refused(void **state) {
    (void)state;
    const float corners[9] = {0, -1, -1, 0, 1, -1, 0, 0, 1};
    float m[4][12] = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0},
                      {1, 0, 0, NAN, 0, 1, 0, 0, 0, 0, 1, 0},
                      {1, 0, 0, 5, 0, 1, 0, 0, 0, 0, 1, 0},
                      {1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0}};
    kdr_device *device = device_of(1, NULL), *other = device_of(1, NULL);
    kdr_triangles_def one = kdr_default_triangles_def();
    one.vertices = corners;
    one.vertex_count = 3;
    one.triangle_count = 1;
    kdr_scene *shown = committed_scene(device, &one, 1, NULL), *empty, *outer, *foreign;
    assert_int_equal(kdr_scene_create(device, &empty), KDR_OK);
    assert_int_equal(kdr_scene_create(device, &outer), KDR_OK);
    assert_int_equal(kdr_scene_create(other, &foreign), KDR_OK);
    const kdr_instance_def good = {
        .size = sizeof good, .scene = shown, .transforms = m[0], .transform_stride = 48, .count = 3};
    kdr_instance_def bad[7];
    for (int i = 0; i < 7; i++)
        bad[i] = good;
    bad[0].size = 0;
    bad[1].scene = NULL;
    bad[2].scene = foreign;
    bad[3].scene = outer;
    bad[4].transforms = NULL;
    bad[5].transform_stride = 44;
    bad[6].transform_stride = 50;
    uint32_t geometry;
    assert_int_equal(kdr_scene_add_instance(outer, &good, &geometry), KDR_OK);
    for (int i = 0; i < 7; i++) {
        assert_int_equal(kdr_scene_add_instance(outer, &bad[i], NULL), KDR_ERROR_INVALID_ARGUMENT);
        assert_int_equal(kdr_scene_set_instance(outer, geometry, &bad[i]), KDR_ERROR_INVALID_ARGUMENT);
    }
    assert_int_equal(kdr_scene_add_instance(outer, NULL, NULL), KDR_ERROR_INVALID_ARGUMENT);
    assert_int_equal(kdr_scene_add_instance(NULL, &good, NULL), KDR_ERROR_INVALID_ARGUMENT);
    assert_int_equal(kdr_scene_set_instance(outer, 1, &good), KDR_ERROR_INVALID_ARGUMENT);
    assert_int_equal(kdr_scene_set_triangles(outer, geometry, &one), KDR_ERROR_INVALID_ARGUMENT);
    kdr_custom_def custom = kdr_default_custom_def();
    custom.bounds = (void (*)(uint32_t, float *, float *, void *))abort;
    custom.intersect = (bool (*)(const kdr_ray *, uint32_t, kdr_custom_hit *, void *))abort;
    assert_int_equal(kdr_scene_set_custom(outer, geometry, &custom), KDR_ERROR_INVALID_ARGUMENT);
    assert_int_equal(kdr_scene_set_instance(shown, 0, &good), KDR_ERROR_INVALID_ARGUMENT);

    /* What is not finite is left out; the others keep their numbers. */
    assert_int_equal(kdr_scene_commit(outer, NULL), KDR_OK);
    kdr_tree_stats stats;
    kdr_scene_stats(outer, &stats);
    assert_true(stats.custom_count == 2 && stats.dropped_count == 1);
    kdr_ray_hit hit = {.ray = {.origin_x = 9, .direction_x = -1, .tmax = INFINITY}};
    kdr_intersect1(outer, &hit);
    assert_int_equal(hit.hit.instance, 2);
    assert_true(hit.ray.tmax == 4);

    /* A transform that cannot be undone fails the commit, and the old tree stays. */
    kdr_instance_def flat = good;
    flat.count = 4;
    assert_int_equal(kdr_scene_set_instance(outer, geometry, &flat), KDR_OK);
    assert_int_equal(kdr_scene_commit(outer, NULL), KDR_ERROR_INVALID_DATA);
    kdr_intersect1(outer, &hit);
    assert_int_equal(hit.hit.instance, 2);

    /* A scene of nothing, and no instances at all. */
    kdr_instance_def none = good;
    none.scene = empty;
    assert_int_equal(kdr_scene_set_instance(outer, geometry, &none), KDR_OK);
    assert_int_equal(kdr_scene_commit(outer, NULL), KDR_OK);
    hit.ray.tmax = INFINITY;
    kdr_intersect1(outer, &hit);
    assert_int_equal(hit.hit.geometry, KDR_INVALID_ID);
    none.count = 0;
    none.transforms = NULL;
    assert_int_equal(kdr_scene_set_instance(outer, geometry, &none), KDR_OK);
    assert_int_equal(kdr_scene_commit(outer, NULL), KDR_OK);
    kdr_intersect1(outer, &hit);
    assert_int_equal(hit.hit.geometry, KDR_INVALID_ID);
    kdr_scene *const all[] = {outer, empty, shown, foreign};
    for (int i = 0; i < 4; i++)
        kdr_scene_destroy(all[i]);
    kdr_device_destroy(device);
    kdr_device_destroy(other);
}

static void instances_move_with_their_transforms_and_with_what_they_show(void **state) {
    (void)state;
    float corners[9] = {0, -1, -1, 0, 1, -1, 0, 0, 1}, m[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    kdr_device *device = device_of(1, NULL);
    kdr_triangles_def one = kdr_default_triangles_def();
    one.vertices = corners;
    one.vertex_count = 3;
    one.triangle_count = 1;
    kdr_scene *shown = committed_scene(device, &one, 1, NULL), *outer;
    assert_int_equal(kdr_scene_create(device, &outer), KDR_OK);
    kdr_instance_def def = kdr_default_instance_def();
    def.scene = shown;
    def.transforms = m;
    assert_int_equal(kdr_scene_add_instance(outer, &def, NULL), KDR_OK);
    const float at[][2] = {{0, 0}, {3, 0}, {3, 2}, {-0.5f, 7}};
    for (int i = 0; i < 4; i++) {
        m[3] = at[i][0];
        for (int k = 0; k < 3; k++)
            corners[3 * k] = at[i][1];
        assert_int_equal(kdr_scene_touch(shown, 0), KDR_OK);
        assert_int_equal(kdr_scene_commit(shown, NULL), KDR_OK);
        assert_int_equal(kdr_scene_touch(outer, 0), KDR_OK);
        assert_int_equal(kdr_scene_commit(outer, NULL), KDR_OK);
        kdr_ray_hit hit = {.ray = {.origin_x = -1, .direction_x = 1, .tmax = INFINITY}};
        kdr_intersect1(outer, &hit);
        assert_int_equal(hit.hit.geometry, 0);
        assert_true(hit.ray.tmax == 1 + at[i][0] + at[i][1]);
    }
    kdr_scene_destroy(outer);
    kdr_scene_destroy(shown);
    kdr_device_destroy(device);
}

#define CROWD TEST_SIZE(100000)

static void an_instance_takes_less_than_300_bytes(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 3);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), 100);
    kdr_device *device = device_of(2, NULL);
    kdr_scene *shown = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, NULL), *outer;
    kdr_device_trim(device);
    size_t before = kdr_device_bytes(device);
    float(*m)[12] = test_allocate(CROWD, sizeof *m);
    for (size_t i = 0; i < CROWD; i++) {
        random_transform(&random, m[i]);
        for (int k = 0; k < 12; k++)
            m[i][k] *= k % 4 == 3 ? 1 : 0.02f;
    }
    assert_int_equal(kdr_scene_create(device, &outer), KDR_OK);
    kdr_instance_def def = kdr_default_instance_def();
    def.scene = shown;
    def.transforms = m[0];
    def.count = (uint32_t)CROWD;
    assert_int_equal(kdr_scene_add_instance(outer, &def, NULL), KDR_OK);
    assert_int_equal(kdr_scene_commit(outer, NULL), KDR_OK);
    kdr_device_trim(device);
    size_t each = (kdr_device_bytes(device) - before) / CROWD;
    assert_true(each < 300);
    kdr_scene_destroy(outer);
    kdr_scene_destroy(shown);
    kdr_device_destroy(device);
    free(m);
    soup_scene_destroy(&soup);
}

static void running_out_of_memory_keeps_the_old_tree(void **state) {
    (void)state;
    failing_alloc failing;
    failing_alloc_init(&failing);
    kdr_allocator functions = failing_alloc_functions(&failing);
    test_random random = test_random_start(test_random_seed(), 9);
    kdr_device *device = device_of(1, &functions);
    world w;
    world_open(&w, device, &random, NULL);
    const uint64_t hash = kdr_scene_hash(w.outer);
    kdr_instance_def def = instances_of(&w, 1);
    kdr_status status = KDR_ERROR_OUT_OF_MEMORY;
    for (uint64_t n = 1; status != KDR_OK; n++) {
        assert_true(n < 100);
        failing_alloc_fail_nth(&failing, n);
        status = kdr_scene_add_instance(w.outer, &def, NULL);
        assert_int_equal(status, failing.failures ? KDR_ERROR_OUT_OF_MEMORY : KDR_OK);
    }
    status = KDR_ERROR_OUT_OF_MEMORY;
    for (uint64_t n = 1; status != KDR_OK; n++) {
        assert_true(n < 1000);
        kdr_device_trim(device);
        failing_alloc_fail_nth(&failing, n);
        status = kdr_scene_commit(w.outer, NULL);
        assert_int_equal(status, failing.failures ? KDR_ERROR_OUT_OF_MEMORY : KDR_OK);
        assert_true((status == KDR_OK) == (kdr_scene_hash(w.outer) != hash));
    }
    world_close(&w);
    kdr_device_destroy(device);
    assert_true(failing_alloc_is_clean(&failing));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ray_meets_in_instances_what_it_meets_in_the_scene_they_show),
        cmocka_unit_test(an_instance_is_where_its_triangles_would_be_if_they_were_moved),
        cmocka_unit_test(instances_lie_in_one_another_as_deep_as_is_said),
        cmocka_unit_test(what_is_wrong_with_instances_is_refused),
        cmocka_unit_test(instances_move_with_their_transforms_and_with_what_they_show),
        cmocka_unit_test(an_instance_takes_less_than_300_bytes),
        cmocka_unit_test(running_out_of_memory_keeps_the_old_tree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
