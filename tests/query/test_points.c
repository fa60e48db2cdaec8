/* The closest point and all primitives within a radius, on every kind of soup, plan and instruction set: what asking
 * all triangles one by one gives, to the bit. */
#include "geometry/exact.h"
#include "geometry/triangle_point.h"
#include "support/everywhere.h"
#include "support/soup.h"
#include "support/test_size.h"

#include <math.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define QUERIES TEST_SIZE(100)
#define THREADS 8

static const char *const plans[] = {"split=binned",
                                    "split=binned axis=robin leaf-limit=1 depth-limit=60",
                                    "split=binned depth-limit=1",
                                    "split=space",
                                    "split=space axis=best leaf-limit=1",
                                    "split=object",
                                    "split=object axis=robin leaf-limit=2",
                                    "split=sweep straddle=clip leaf-limit=1 traversal-cost=1",
                                    "share=grid/9 retract=yes",
                                    "quality=best"};

#define PLAN_COUNT (sizeof(plans) / sizeof(plans[0]))

/* A query and its answers: every triangle's closest point, and the first of the closest triangles within the radius. */
typedef struct question {
    kdr_point_query query;
    kdr_surface_point *points; /* one a primitive of the oracle's scene */
    size_t closest;            /* SIZE_MAX: none */
    size_t within;
} question;

typedef struct question_sheet {
    oracle_scene oracle; /* without triangles of zero area */
    question *questions;
    size_t count;
} question_sheet;

static const float (*corners_of(const oracle_primitive *p))[3] {
    _Static_assert(offsetof(oracle_primitive, c) == 6 * sizeof(float), "corners lie one after the other");
    return (const float(*)[3])(const void *)p;
}

static void answer(const oracle_scene *oracle, question *q) {
    const float at[3] = {q->query.x, q->query.y, q->query.z};
    double most = (double)q->query.radius * q->query.radius, least = INFINITY;
    q->points = test_allocate(oracle->count, sizeof(kdr_surface_point));
    q->closest = SIZE_MAX;
    q->within = 0;
    for (size_t i = 0; i < oracle->count; i++) {
        q->points[i] = kdr_triangle_point(at, corners_of(&oracle->primitives[i]));
        if (q->points[i].square > most)
            continue;
        q->within++;
        if (q->points[i].square < least) {
            least = q->points[i].square;
            q->closest = i;
        }
    }
}

/* A point at a corner, on an edge, in a face, near one, far away or anywhere. */
static void draw_point(test_random *random, const oracle_scene *oracle, float at[3]) {
    uint32_t kind = oracle->count ? test_random_below(random, 8) : 7;
    float u = test_random_float(random), v = test_random_float(random) * (1 - u);
    u = kind == 0 ? 0 : u;
    v = kind <= 1 ? 0 : v;
    for (int k = 0; k < 3; k++) {
        if (kind == 7) {
            at[k] = soup_any_float(random);
            continue;
        }
        const oracle_primitive *p = &oracle->primitives[test_random_below(random, (uint32_t)oracle->count)];
        if (kind != 5) /* corners of boxes of several triangles */
            p = &oracle->primitives[random->state % oracle->count];
        at[k] = p->a[k] * (1 - u - v) + p->b[k] * u + p->c[k] * v;
        at[k] += kind == 4 ? test_random_between(random, -0.3f, 0.3f) * (fabsf(p->a[k]) + 0x1p-140f) : 0;
        at[k] = kind == 6 ? at[k] + test_random_between(random, -0x1p60f, 0x1p60f) : at[k];
        at[k] = isfinite(at[k]) ? at[k] : 0;
    }
}

static float draw_radius(test_random *random, const oracle_scene *oracle, const float at[3]) {
    static const float fixed[] = {INFINITY, 0, 0.1f, 1e30f};
    uint32_t kind = test_random_below(random, 8);
    if (kind < 4 || oracle->count == 0)
        return fixed[kind % 4];
    /* One that ends at a triangle, or a little beyond. */
    const oracle_primitive *p = &oracle->primitives[test_random_below(random, (uint32_t)oracle->count)];
    float radius = (float)sqrt(kdr_triangle_point(at, corners_of(p)).square);
    return kind == 4 ? nextafterf(radius, INFINITY) : radius * (kind == 5 ? 1.2f : kind == 6 ? 0.5f : 1);
}

static question_sheet sheet_create(const kdr_triangles_def *geometries, uint32_t geometry_count, uint64_t sequence,
                                   size_t count) {
    question_sheet sheet = {.oracle = oracle_scene_create(geometries, geometry_count), .count = count};
    size_t kept = 0;
    for (size_t i = 0; i < sheet.oracle.count; i++) {
        const oracle_primitive *p = &sheet.oracle.primitives[i];
        if (!kdr_triangle_is_flat(p->a, p->b, p->c))
            sheet.oracle.primitives[kept++] = *p;
    }
    sheet.oracle.count = kept;
    sheet.questions = test_allocate(count, sizeof(question));
    test_random random = test_random_start(test_random_seed(), sequence);
    for (size_t i = 0; i < count; i++) {
        float at[3];
        draw_point(&random, &sheet.oracle, at);
        sheet.questions[i].query =
            (kdr_point_query){.x = at[0], .y = at[1], .z = at[2], .radius = draw_radius(&random, &sheet.oracle, at)};
        answer(&sheet.oracle, &sheet.questions[i]);
    }
    return sheet;
}

static void sheet_destroy(question_sheet *sheet) {
    for (size_t i = 0; i < sheet->count; i++)
        free(sheet->questions[i].points);
    free(sheet->questions);
    oracle_scene_destroy(&sheet->oracle);
}

static bool hit_is(const kdr_point_hit *hit, const oracle_primitive *primitive, const kdr_surface_point *point) {
    return hit->x == (float)point->at[0] && hit->y == (float)point->at[1] && hit->z == (float)point->at[2] &&
           hit->distance == (float)sqrt(point->square) && hit->u == (float)point->u && hit->v == (float)point->v &&
           hit->geometry == primitive->geometry && hit->primitive == primitive->primitive &&
           hit->instance == KDR_INVALID_ID;
}

/* What a search within a radius reports. */
typedef struct tally {
    const oracle_scene *oracle;
    const question *question;
    uint8_t *seen; /* one a primitive */
    size_t count, wrong;
} tally;

/* Primitives are in order. */
static size_t place_of(const oracle_scene *oracle, uint32_t geometry, uint32_t primitive) {
    size_t lo = 0, hi = oracle->count;
    while (lo < hi) {
        size_t middle = lo + (hi - lo) / 2;
        const oracle_primitive *p = &oracle->primitives[middle];
        if (p->geometry < geometry || (p->geometry == geometry && p->primitive < primitive))
            lo = middle + 1;
        else
            hi = middle;
    }
    return lo;
}

static bool count_one(const kdr_point_hit *hit, void *user) {
    tally *t = user;
    size_t i = place_of(t->oracle, hit->geometry, hit->primitive);
    t->count++;
    t->wrong +=
        i == t->oracle->count || t->seen[i]++ || !hit_is(hit, &t->oracle->primitives[i], &t->question->points[i]);
    return true;
}

/* Returns how many questions get a wrong answer. */
static size_t differences(const question_sheet *sheet, const kdr_scene *scene, const char *label) {
    size_t wrong = 0;
    uint8_t *seen = test_allocate(sheet->oracle.count, 1);
    for (size_t i = 0; i < sheet->count; i++) {
        const question *q = &sheet->questions[i];
        kdr_point_hit hit, before;
        memset(&hit, 0x55, sizeof(hit));
        before = hit;
        bool found = kdr_closest_point(scene, &q->query, &hit);
        bool right = found == (q->closest != SIZE_MAX);
        if (right && found)
            right = hit_is(&hit, &sheet->oracle.primitives[q->closest], &q->points[q->closest]);
        else if (right)
            right = memcmp(&hit, &before, sizeof(hit)) == 0;

        /* As many as there are, none of them twice, and each within the radius by its distance: so all of them. */
        memset(seen, 0, sheet->oracle.count);
        tally t = {&sheet->oracle, q, seen, 0, 0};
        size_t told = kdr_primitives_within(scene, &q->query, count_one, &t);
        bool all = told == q->within && t.count == q->within && t.wrong == 0;
        for (size_t k = 0; k < sheet->oracle.count && all; k++)
            all = seen[k] == (q->points[k].square <= (double)q->query.radius * q->query.radius);
        if (!right || !all)
            printf("%s: %s wrong at %a %a %a, radius %a: %zu told, %zu twice or wrong, %zu expected\n", label,
                   right ? "within" : "closest", q->query.x, q->query.y, q->query.z, q->query.radius, t.count, t.wrong,
                   q->within);
        wrong += !right || !all;
    }
    free(seen);
    return wrong;
}

static void hold_sheet(const kdr_triangles_def *geometries, uint32_t geometry_count, const question_sheet *sheet,
                       const char *label) {
    for (int isa = KDR_ISA_SCALAR; isa <= KDR_ISA_NEON; isa++) {
        kdr_device *device = device_of_isa((kdr_isa)isa, 1, NULL);
        for (size_t i = 0; device && i < PLAN_COUNT; i++) {
            char name[200];
            snprintf(name, sizeof(name), "%s, %s, %s", label, plans[i], kdr_isa_name((kdr_isa)isa));
            kdr_build_def def;
            assert_int_equal(kdr_build_def_parse(plans[i], &def, NULL, 0), KDR_OK);
            kdr_scene *scene = committed_scene(device, geometries, geometry_count, &def);
            if (differences(sheet, scene, name) > 0)
                fail_msg("%s: wrong answers", name);
            kdr_scene_destroy(scene);
        }
        kdr_device_destroy(device);
    }
}

static void every_plan_and_instruction_set_answers_as_asking_all_triangles_does(void **state) {
    (void)state;
    static const size_t small_counts[] = {3, 7, 16, 33, 64};
    for (size_t kind = 0; kind < soup_kind_count; kind++) {
        for (int part = 0; part < 2; part++) {
            const soup_kind *drawn = &soup_kinds[kind];
            size_t count = part == 0 ? drawn->count : small_counts[kind % 5];
            test_random random = test_random_start(test_random_seed(), 4 * kind + (uint64_t)part);
            soup_scene soup = soup_scene_create_kind(&random, drawn, count);
            question_sheet sheet =
                sheet_create(soup.geometries, SOUP_GEOMETRIES, 4 * kind + 2 + (uint64_t)part, QUERIES / (1 + part));
            hold_sheet(soup.geometries, SOUP_GEOMETRIES, &sheet, drawn->name);
            sheet_destroy(&sheet);
            soup_scene_destroy(&soup);
        }
    }
}

/* -------------------------------------------------------------------------------------------------------- rules */

static const float square_vertices[] = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
static const uint32_t square_indices[] = {0, 1, 2, 0, 2, 3, 0, 0, 1}; /* the last has no area */

static kdr_triangles_def square_def(void) {
    kdr_triangles_def def = kdr_default_triangles_def();
    def.vertices = square_vertices;
    def.vertex_count = 4;
    def.indices = square_indices;
    def.triangle_count = 3;
    return def;
}

typedef struct fixture {
    kdr_device *device;
    kdr_scene *scene; /* the square, twice */
} fixture;

static int setup(void **state) {
    fixture *f = test_allocate(1, sizeof(fixture));
    assert_int_equal(kdr_device_create(NULL, &f->device), KDR_OK);
    kdr_triangles_def both[2] = {square_def(), square_def()};
    f->scene = committed_scene(f->device, both, 2, NULL);
    *state = f;
    return 0;
}

static int teardown(void **state) {
    fixture *f = *state;
    kdr_scene_destroy(f->scene);
    kdr_device_destroy(f->device);
    free(f);
    return 0;
}

static bool go_on(const kdr_point_hit *hit, void *user) {
    (void)hit, (void)user;
    return true;
}

static bool stop_after(const kdr_point_hit *hit, void *user) {
    (void)hit;
    return --*(int *)user > 0;
}

static void a_hit_says_where_and_how_far(void **state) {
    fixture *f = *state;
    kdr_point_hit hit;
    assert_true(kdr_closest_point(f->scene, &(kdr_point_query){0.5f, -0.5f, 3, NAN, INFINITY}, &hit));
    assert_true(hit.x == 0.5f && hit.y == -0.5f && hit.z == 0 && hit.distance == 3);
    assert_true(hit.u == 0.5f && hit.v == 0.25f);
    assert_true(hit.geometry == 0 && hit.primitive == 0 && hit.instance == KDR_INVALID_ID);
    assert_true(kdr_closest_point(f->scene, &(kdr_point_query){-2, 1, 0, 0, INFINITY}, &hit));
    assert_true(hit.x == -1 && hit.y == 1 && hit.z == 0 && hit.distance == 1 && hit.u == 0 && hit.v == 1);
    assert_true(hit.geometry == 0 && hit.primitive == 1);
}

static void of_equal_distances_the_lowest_geometry_then_primitive_wins(void **state) {
    fixture *f = *state;
    kdr_point_hit hit;
    assert_true(kdr_closest_point(f->scene, &(kdr_point_query){0.25f, 0.25f, 1, 0, INFINITY}, &hit));
    assert_true(hit.geometry == 0 && hit.primitive == 0 && hit.distance == 1);
}

static void a_radius_is_inclusive(void **state) {
    fixture *f = *state;
    kdr_point_hit hit;
    kdr_point_query query = {.x = 0.25f, .z = 2, .radius = 2};
    assert_true(kdr_closest_point(f->scene, &query, &hit));
    assert_int_equal(kdr_primitives_within(f->scene, &query, go_on, NULL), 2);
    query.radius = nextafterf(2, 0);
    assert_false(kdr_closest_point(f->scene, &query, &hit));
    assert_int_equal(kdr_primitives_within(f->scene, &query, go_on, NULL), 0);
    query = (kdr_point_query){.x = 0.25f, .radius = 0};
    assert_true(kdr_closest_point(f->scene, &query, &hit));
    assert_true(hit.distance == 0);
    assert_int_equal(kdr_primitives_within(f->scene, &query, go_on, NULL), 2);
}

static void queries_that_mean_nothing_find_nothing(void **state) {
    fixture *f = *state;
    static const kdr_point_query queries[] = {
        {NAN, 0, 0, 0, INFINITY}, {0, NAN, 0, 0, INFINITY},      {0, 0, NAN, 0, INFINITY},
        {0, 0, 0, 0, NAN},        {INFINITY, 0, 0, 0, INFINITY}, {0, 0, 0, 0, -1},
        {0, 0, 0, 0, -INFINITY},  {0, 0, 0, 0, -0x1p-149f},      {0, -INFINITY, 0, 0, INFINITY},
    };
    for (size_t i = 0; i < sizeof(queries) / sizeof(queries[0]); i++) {
        kdr_point_hit hit;
        assert_false(kdr_closest_point(f->scene, &queries[i], &hit));
        assert_int_equal(kdr_primitives_within(f->scene, &queries[i], go_on, NULL), 0);
    }
}

static void a_scene_without_a_commit_or_triangles_has_no_closest_point(void **state) {
    fixture *f = *state;
    kdr_scene *scene;
    kdr_point_hit hit;
    kdr_point_query query = {.radius = INFINITY};
    assert_int_equal(kdr_scene_create(f->device, &scene), KDR_OK);
    for (int i = 0; i < 2; i++) {
        assert_false(kdr_closest_point(scene, &query, &hit));
        assert_int_equal(kdr_primitives_within(scene, &query, go_on, NULL), 0);
        assert_int_equal(kdr_scene_commit(scene, NULL), KDR_OK);
    }
    kdr_scene_destroy(scene);
}

static void a_caller_ends_a_search_by_returning_false(void **state) {
    fixture *f = *state;
    kdr_point_query query = {.radius = INFINITY};
    assert_int_equal(kdr_primitives_within(f->scene, &query, go_on, NULL), 4);
    for (int stop = 1; stop <= 4; stop++) {
        int left = stop;
        assert_int_equal(kdr_primitives_within(f->scene, &query, stop_after, &left), stop);
        assert_int_equal(left, 0);
    }
}

typedef struct asker {
    const question_sheet *sheet;
    const kdr_scene *scene;
    size_t differences;
    pthread_t thread;
} asker;

static void *ask(void *argument) {
    asker *one = argument;
    one->differences = differences(one->sheet, one->scene, "one of many threads");
    return NULL;
}

static void many_threads_ask_about_points_at_once(void **state) {
    fixture *f = *state;
    test_random random = test_random_start(test_random_seed(), 200);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), TEST_SIZE(3000));
    question_sheet sheet = sheet_create(soup.geometries, SOUP_GEOMETRIES, 201, QUERIES);
    kdr_scene *scene = committed_scene(f->device, soup.geometries, SOUP_GEOMETRIES, NULL);
    asker askers[THREADS];
    for (int i = 0; i < THREADS; i++) {
        askers[i] = (asker){.sheet = &sheet, .scene = scene};
        assert_int_equal(pthread_create(&askers[i].thread, NULL, ask, &askers[i]), 0);
    }
    for (int i = 0; i < THREADS; i++) {
        pthread_join(askers[i].thread, NULL);
        assert_int_equal(askers[i].differences, 0);
    }
    kdr_scene_destroy(scene);
    sheet_destroy(&sheet);
    soup_scene_destroy(&soup);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_hit_says_where_and_how_far),
        cmocka_unit_test(of_equal_distances_the_lowest_geometry_then_primitive_wins),
        cmocka_unit_test(a_radius_is_inclusive),
        cmocka_unit_test(queries_that_mean_nothing_find_nothing),
        cmocka_unit_test(a_scene_without_a_commit_or_triangles_has_no_closest_point),
        cmocka_unit_test(a_caller_ends_a_search_by_returning_false),
        cmocka_unit_test(many_threads_ask_about_points_at_once),
        cmocka_unit_test(every_plan_and_instruction_set_answers_as_asking_all_triangles_does),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
