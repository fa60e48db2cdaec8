#include "support/query_sheet.h"

#include "support/random.h"
#include "support/soup.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PRINT_LIMIT 5
#define GUARD 0x5a

void query_print_ray(const kdr_ray *ray) {
    printf("  ray    origin {%a, %a, %a} direction {%a, %a, %a} tmin %a tmax %a\n", ray->origin_x, ray->origin_y,
           ray->origin_z, ray->direction_x, ray->direction_y, ray->direction_z, ray->tmin, ray->tmax);
}

void query_print_primitive(const char *name, const oracle_primitive *primitive) {
    if (!primitive) {
        printf("  %s nothing\n", name);
        return;
    }
    const float *a = primitive->a, *b = primitive->b, *c = primitive->c;
    printf("  %s geometry %u primitive %u {%a, %a, %a} {%a, %a, %a} {%a, %a, %a}\n", name, primitive->geometry,
           primitive->primitive, a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]);
}

/* A product or difference of floats may round, and a component beyond the floats is infinite. */
static bool normal_is_right(const oracle_primitive *primitive, const float normal[3]) {
    double x[3], y[3];
    for (int axis = 0; axis < 3; axis++) {
        x[axis] = (double)primitive->b[axis] - primitive->a[axis];
        y[axis] = (double)primitive->c[axis] - primitive->a[axis];
    }
    for (int axis = 0; axis < 3; axis++) {
        int j = (axis + 1) % 3, k = (axis + 2) % 3;
        double exact = x[j] * y[k] - x[k] * y[j];
        double slack = (fabs(x[j] * y[k]) + fabs(x[k] * y[j])) * 0x1p-21 + 0x1p-148;
        if (isnan(normal[axis]))
            return false;
        if (isinf(normal[axis]) ? fabs(exact) + slack < FLT_MAX || (normal[axis] > 0) != (exact > 0)
                                : fabs(normal[axis] - exact) > slack)
            return false;
    }
    return true;
}

bool query_answer_is_right(const kdr_ray *ray, const oracle_hit *answer, const kdr_ray_hit *given, const char *label) {
    const kdr_hit *hit = &given->hit;
    kdr_ray expected = *ray;
    const char *wrong = NULL;
    double weight_slack = QUERY_WEIGHT_SLACK + answer->weight_doubt;
    if (!answer->primitive) {
        wrong = hit->geometry != KDR_INVALID_ID ? "a hit where there is none" : NULL;
    } else {
        expected.tmax = answer->t;
        const float normal[3] = {hit->normal_x, hit->normal_y, hit->normal_z};
        if (hit->geometry == KDR_INVALID_ID)
            wrong = "no hit";
        else if (hit->geometry != answer->primitive->geometry || hit->primitive != answer->primitive->primitive)
            wrong = "another triangle";
        else if (given->ray.tmax != answer->t)
            wrong = "another distance";
        else if (!(fabs(hit->u - answer->u) <= weight_slack && fabs(hit->v - answer->v) <= weight_slack))
            wrong = "other weights";
        else if (!normal_is_right(answer->primitive, normal))
            wrong = "another normal";
        else if (hit->instance != KDR_INVALID_ID)
            wrong = "an instance";
        else if (answer->t == 0)
            expected.tmax = given->ray.tmax; // either zero
    }
    if (!wrong && memcmp(&expected, &given->ray, sizeof(expected)) != 0)
        wrong = "a ray that was changed";
    if (!wrong)
        return true;
    printf("%s: %s\n", label, wrong);
    query_print_ray(ray);
    query_print_primitive("oracle", answer->primitive);
    printf("         t %a u %a v %a\n", answer->t, answer->u, answer->v);
    printf("  given  geometry %u primitive %u t %a u %a v %a normal {%a, %a, %a}\n", hit->geometry, hit->primitive,
           given->ray.tmax, hit->u, hit->v, hit->normal_x, hit->normal_y, hit->normal_z);
    return false;
}

query_sheet query_sheet_create(const oracle_tree *tree, const kdr_ray *rays, size_t count) {
    query_sheet sheet = {rays, test_allocate(count, sizeof(oracle_hit)), count, 0};
    for (size_t i = 0; i < count; i++) {
        sheet.answers[i] = oracle_tree_closest(tree, &rays[i]);
        sheet.hit_count += sheet.answers[i].primitive != NULL;
    }
    return sheet;
}

void query_sheet_destroy(query_sheet *sheet) {
    free(sheet->answers);
    *sheet = (query_sheet){0};
}

/* ------------------------------------------------------------------------------------------------------ asking */

typedef struct interview {
    const query_sheet *sheet;
    const kdr_scene *scene;
    const char *label;
    size_t differences;
} interview;

static void count_closest(interview *asking, size_t number, const kdr_ray_hit *given, const char *query) {
    if (asking->differences >= PRINT_LIMIT)
        return; // enough is printed
    char label[256];
    snprintf(label, sizeof(label), "%s, ray %zu, %s", asking->label, number, query);
    if (!query_answer_is_right(&asking->sheet->rays[number], &asking->sheet->answers[number], given, label))
        asking->differences++;
}

static void count_any(interview *asking, size_t number, int given, const char *query) {
    const oracle_hit *answer = &asking->sheet->answers[number];
    if (given == (answer->primitive != NULL))
        return;
    if (asking->differences++ < PRINT_LIMIT) {
        printf("%s, ray %zu, %s: %d\n", asking->label, number, query, given);
        query_print_ray(&asking->sheet->rays[number]);
        query_print_primitive("oracle", answer->primitive);
        printf("         t %a\n", answer->t);
    }
}

static void ask_one_by_one(interview *asking) {
    for (size_t i = 0; i < asking->sheet->count; i++) {
        kdr_ray_hit given;
        memset(&given, GUARD, sizeof(given));
        given.ray = asking->sheet->rays[i];
        kdr_intersect1(asking->scene, &given);
        count_closest(asking, i, &given, "intersect1");
        kdr_ray ray = asking->sheet->rays[i];
        count_any(asking, i, kdr_occluded1(asking->scene, &ray), "occluded1");
        if (memcmp(&ray, &asking->sheet->rays[i], sizeof(ray)) != 0)
            count_any(asking, i, -1, "occluded1 (the ray was changed)");
    }
}

/* Both queries for `count` rays from `first` on, with one element more in the arrays that must not be touched. */
static void ask_run(interview *asking, const kdr_trace_def *def, size_t first, size_t count, kdr_ray_hit *given,
                    uint8_t *occluded) {
    memset(given, GUARD, (count + 1) * sizeof(*given));
    memset(occluded, GUARD, count + 1);
    for (size_t i = 0; i < count; i++)
        given[i].ray = asking->sheet->rays[first + i];
    kdr_ray_hit guard = given[count];
    kdr_intersect_n(asking->scene, def, given, count);
    kdr_occluded_n(asking->scene, def, asking->sheet->rays + first, occluded, count);
    for (size_t i = 0; i < count; i++) {
        count_closest(asking, first + i, &given[i], "intersect_n");
        count_any(asking, first + i, occluded[i], "occluded_n");
    }
    if (memcmp(&guard, &given[count], sizeof(guard)) != 0 || occluded[count] != GUARD) {
        printf("%s: a query of %zu rays wrote behind the last\n", asking->label, count);
        asking->differences++;
    }
}

static void ask_in_runs(interview *asking) {
    static const size_t runs[] = {15, 0, 1, 16, 17, 1000};
    kdr_ray_hit *given = test_allocate(1001, sizeof(*given));
    uint8_t *occluded = test_allocate(1001, 1);
    size_t first = 0;
    for (size_t i = 0; first < asking->sheet->count; i++) {
        size_t count = runs[i % 6];
        count = count > asking->sheet->count - first ? asking->sheet->count - first : count;
        kdr_trace_def def = kdr_default_trace_def();
        def.coherence = (kdr_coherence)(i % 3);
        ask_run(asking, i % 4 == 3 ? NULL : &def, first, count, given, occluded);
        first += count;
    }
    free(given);
    free(occluded);
}

/* ---- packets: one body for the three widths, which differ in how far the numbers of a field lie apart */

#define RAY_FIELDS 12
#define HIT_FIELDS 8
#define FIELDS (RAY_FIELDS + HIT_FIELDS)
#define WIDEST 16

static void ask_packet(const kdr_scene *scene, uint32_t width, const int32_t *valid, void *closest, void *any) {
    switch (width) {
    case 4:
        kdr_intersect4(scene, valid, closest);
        kdr_occluded4(scene, valid, any);
        break;
    case 8:
        kdr_intersect8(scene, valid, closest);
        kdr_occluded8(scene, valid, any);
        break;
    default: kdr_intersect16(scene, valid, closest); kdr_occluded16(scene, valid, any);
    }
}

/* Rays number[0], number[1] ... of the sheet, those that are not active left alone to the bit. */
static void ask_one_packet(interview *asking, uint32_t width, const int32_t *valid, const size_t number[WIDEST]) {
    uint32_t closest[FIELDS * WIDEST + 1], any[RAY_FIELDS * WIDEST + 1], closest_before[FIELDS * WIDEST + 1],
        any_before[RAY_FIELDS * WIDEST + 1];
    memset(closest, GUARD, sizeof(closest));
    memset(any, GUARD, sizeof(any));
    for (uint32_t i = 0; i < width; i++) {
        uint32_t fields[RAY_FIELDS];
        memcpy(fields, &asking->sheet->rays[number[i]], sizeof(fields));
        for (uint32_t k = 0; k < RAY_FIELDS; k++)
            closest[k * width + i] = any[k * width + i] = fields[k];
    }
    memcpy(closest_before, closest, sizeof(closest));
    memcpy(any_before, any, sizeof(any));
    ask_packet(asking->scene, width, valid, closest, any);

    char query[32];
    snprintf(query, sizeof(query), "packet of %u", width);
    for (uint32_t i = 0; i < width; i++) {
        if (!valid || valid[i] != 0) {
            kdr_ray_hit given;
            uint32_t fields[FIELDS];
            for (uint32_t k = 0; k < FIELDS; k++)
                fields[k] = closest[k * width + i];
            memcpy(&given, fields, sizeof(given));
            count_closest(asking, number[i], &given, query);
            float tmax;
            memcpy(&tmax, &any[8 * width + i], sizeof(tmax));
            bool occluded = tmax == -INFINITY && asking->sheet->rays[number[i]].tmax != -INFINITY;
            count_any(asking, number[i], occluded, query);
            if (occluded)
                any[8 * width + i] = any_before[8 * width + i];
        }
        for (uint32_t k = 0; k < FIELDS && valid && valid[i] == 0; k++)
            if (closest[k * width + i] != closest_before[k * width + i])
                count_any(asking, number[i], -1, "packet (a ray that is not active was changed)");
    }
    if (memcmp(any, any_before, sizeof(any)) != 0)
        count_any(asking, number[0], -1, "occluded packet (more than tmax was changed)");
    if (closest[FIELDS * width] != closest_before[FIELDS * width])
        count_any(asking, number[0], -1, "packet (written behind its end)");
}

/* Every ray takes part in a packet of each width; some lanes are not active, some packets have one ray in all lanes. */
static void ask_in_packets(interview *asking) {
    test_random random = test_random_start(test_random_seed(), 4816);
    for (uint32_t width = 4; width <= WIDEST; width *= 2) {
        for (size_t first = 0; first < asking->sheet->count; first += width) {
            size_t number[WIDEST];
            int32_t valid[WIDEST];
            bool alike = test_random_below(&random, 8) == 0;
            uint32_t sparse = test_random_below(&random, 4);
            for (uint32_t i = 0; i < width; i++) {
                number[i] = alike ? first : first + i < asking->sheet->count ? first + i : 0;
                valid[i] =
                    test_random_below(&random, 4) >= sparse ? -1 - (int32_t)test_random_below(&random, 2) * 6 : 0;
            }
            ask_one_packet(asking, width, sparse == 0 ? NULL : valid, number);
        }
    }
}

size_t query_sheet_differences(const query_sheet *sheet, const kdr_scene *scene, const char *label) {
    interview asking = {sheet, scene, label, 0};
    ask_one_by_one(&asking);
    ask_in_runs(&asking);
    ask_in_packets(&asking);
    if (asking.differences > 0)
        printf("%s: wrong answers (%zu counted) to %zu rays\n", label, asking.differences, sheet->count);
    return asking.differences;
}
