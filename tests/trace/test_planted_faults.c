/* The walk over every way to trace (trace_check.h) can fail: a fault is planted in the kernels of one traversal, or in
 * one query, and it must be found, and in no other traversal.
 *
 * A faulty kernel stands between the library's query and the true kernel, whose answer it changes; a faulty query does
 * so between the walk and the library. */
#include "scene/scene.h"
#include "support/trace_check.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static kdr_lone truth;                   /* of the spoiled scene */
static const kdr_traversals *true_table; /* and of its device */
static kdr_traversals false_table;

/* ---- kernels for a lone ray; the scene has more triangles than this */

#define LOST 7

static bool closest_without_a_triangle(const kdr_tree *tree, const kdr_ray *ray, kdr_found *found) {
    kdr_ray rest = *ray;
    bool hit = truth.closest(tree, &rest, found);
    while (hit && found->primitive == LOST) { // looks behind it
        rest.tmin = found->t;
        hit = truth.closest(tree, &rest, found);
    }
    return hit;
}

static bool any_without_a_triangle(const kdr_tree *tree, const kdr_ray *ray) {
    kdr_found found;
    return closest_without_a_triangle(tree, ray, &found);
}

/* The end no longer belongs to the interval. */
static kdr_ray with_an_open_end(const kdr_ray *ray) {
    kdr_ray shrunk = *ray;
    shrunk.tmax = nextafterf(ray->tmax, -INFINITY);
    return shrunk;
}

static bool closest_with_an_open_end(const kdr_tree *tree, const kdr_ray *ray, kdr_found *found) {
    kdr_ray shrunk = with_an_open_end(ray);
    return truth.closest(tree, &shrunk, found);
}

static bool any_with_an_open_end(const kdr_tree *tree, const kdr_ray *ray) {
    kdr_ray shrunk = with_an_open_end(ray);
    return truth.any(tree, &shrunk);
}

/* And the beginning does. */
static kdr_ray with_a_closed_beginning(const kdr_ray *ray) {
    kdr_ray wider = *ray;
    wider.tmin = ray->tmin < ray->tmax ? nextafterf(ray->tmin, -INFINITY) : ray->tmin;
    return wider;
}

static bool closest_with_a_closed_beginning(const kdr_tree *tree, const kdr_ray *ray, kdr_found *found) {
    kdr_ray wider = with_a_closed_beginning(ray);
    return truth.closest(tree, &wider, found);
}

static bool any_with_a_closed_beginning(const kdr_tree *tree, const kdr_ray *ray) {
    kdr_ray wider = with_a_closed_beginning(ray);
    return truth.any(tree, &wider);
}

static bool any_without_an_end(const kdr_tree *tree, const kdr_ray *ray) {
    kdr_ray endless = *ray;
    endless.tmax = ray->tmin < ray->tmax ? INFINITY : ray->tmax;
    return truth.any(tree, &endless);
}

static bool closest_a_step_off(const kdr_tree *tree, const kdr_ray *ray, kdr_found *found) {
    bool hit = truth.closest(tree, ray, found);
    if (hit && found->primitive % 8 == 3)
        found->t = nextafterf(found->t, INFINITY);
    return hit;
}

static bool closest_with_turned_weights(const kdr_tree *tree, const kdr_ray *ray, kdr_found *found) {
    bool hit = truth.closest(tree, ray, found);
    if (hit) {
        float u = found->u;
        found->u = found->v;
        found->v = u;
    }
    return hit;
}

static bool closest_with_the_other_side(const kdr_tree *tree, const kdr_ray *ray, kdr_found *found) {
    bool hit = truth.closest(tree, ray, found);
    for (int k = 0; k < 3 && hit; k++)
        found->normal[k] = -found->normal[k];
    return hit;
}

/* What is planted where; NULL: the true kernel. */
typedef struct lone_fault {
    const char *name;
    bool (*closest)(const kdr_tree *tree, const kdr_ray *ray, kdr_found *found);
    bool (*any)(const kdr_tree *tree, const kdr_ray *ray);
} lone_fault;

static const lone_fault lone_faults[] = {
    {"closest hit without a triangle", closest_without_a_triangle, NULL},
    {"closest hit with an open end", closest_with_an_open_end, NULL},
    {"closest hit with a closed beginning", closest_with_a_closed_beginning, NULL},
    {"closest hit a step off", closest_a_step_off, NULL},
    {"closest hit with turned weights", closest_with_turned_weights, NULL},
    {"closest hit on the other side", closest_with_the_other_side, NULL},
    {"any hit without a triangle", NULL, any_without_a_triangle},
    {"any hit with an open end", NULL, any_with_an_open_end},
    {"any hit with a closed beginning", NULL, any_with_a_closed_beginning},
    {"any hit without an end", NULL, any_without_an_end},
};
#define LONE_FAULTS (sizeof lone_faults / sizeof lone_faults[0])

/* ---- kernels for packets */

#define LANE 3 /* there is one in packets of every width */

static void packet_without_a_lane(const kdr_tree *tree, const kdr_packet_rays *rays, kdr_packet_found *found) {
    true_table->packet_closest(tree, rays, found);
    found->primitive[LANE] = UINT32_MAX;
}

/* Packets are of 64 rays in calls for many, and of 16 at most else. */
static void packet_without_late_lanes(const kdr_tree *tree, const kdr_packet_rays *rays, kdr_packet_found *found) {
    true_table->packet_closest(tree, rays, found);
    for (uint32_t i = 40; i < rays->count; i++)
        found->primitive[i] = UINT32_MAX;
}

static void packet_with_mixed_lanes(const kdr_tree *tree, const kdr_packet_rays *rays, kdr_packet_found *found) {
    true_table->packet_closest(tree, rays, found);
    if ((rays->valid >> LANE & 3) == 3) {
        uint32_t primitive = found->primitive[LANE];
        found->primitive[LANE] = found->primitive[LANE + 1];
        found->primitive[LANE + 1] = primitive;
    }
}

static void packet_with_one_end(const kdr_tree *tree, const kdr_packet_rays *rays, kdr_packet_found *found) {
    kdr_packet_rays alike = *rays;
    for (uint32_t i = 1; i < rays->count; i++)
        alike.tmax[i] = alike.tmax[0];
    true_table->packet_closest(tree, &alike, found);
}

static uint64_t any_without_a_lane(const kdr_tree *tree, const kdr_packet_rays *rays) {
    return true_table->packet_any(tree, rays) & ~(UINT64_C(1) << LANE);
}

static uint64_t any_with_a_lane_more(const kdr_tree *tree, const kdr_packet_rays *rays) {
    return true_table->packet_any(tree, rays) | (rays->valid & UINT64_C(1) << LANE);
}

/* Kernels say nothing of rays that are not valid: the query must not believe them. */
static uint64_t any_with_a_lane_that_is_not_valid(const kdr_tree *tree, const kdr_packet_rays *rays) {
    return true_table->packet_any(tree, rays) | (~rays->valid & UINT64_C(1) << LANE);
}

typedef struct packet_fault {
    const char *name;
    void (*closest)(const kdr_tree *tree, const kdr_packet_rays *rays, kdr_packet_found *found);
    uint64_t (*any)(const kdr_tree *tree, const kdr_packet_rays *rays);
} packet_fault;

static const packet_fault packet_faults[] = {
    {"packet without a lane", packet_without_a_lane, NULL},
    {"packet without late lanes", packet_without_late_lanes, NULL},
    {"packet with mixed lanes", packet_with_mixed_lanes, NULL},
    {"packet with one end", packet_with_one_end, NULL},
    {"any hit without a lane", NULL, any_without_a_lane},
    {"any hit with a lane more", NULL, any_with_a_lane_more},
    {"any hit in a lane that is not valid", NULL, any_with_a_lane_that_is_not_valid},
};
#define PACKET_FAULTS (sizeof packet_faults / sizeof packet_faults[0])

/* ---- queries */

static void intersect1_with_another_id(const kdr_scene *scene, kdr_ray_hit *ray_hit) {
    kdr_intersect1(scene, ray_hit);
    ray_hit->ray.id ^= 1;
}

static void intersect_n_behind_the_last(const kdr_scene *scene, const kdr_trace_def *def, kdr_ray_hit *ray_hits,
                                        size_t count) {
    kdr_intersect_n(scene, def, ray_hits, count);
    ray_hits[count].hit.u = 0;
}

static void intersect_n_without_the_last(const kdr_scene *scene, const kdr_trace_def *def, kdr_ray_hit *ray_hits,
                                         size_t count) {
    kdr_intersect_n(scene, def, ray_hits, count % 16 == 1 ? count - 1 : count);
}

static void occluded_n_of_the_ray_before_if_coherent(const kdr_scene *scene, const kdr_trace_def *def,
                                                     const kdr_ray *rays, uint8_t *occluded, size_t count) {
    kdr_occluded_n(scene, def, rays, occluded, count);
    for (size_t i = 1; i < count && def && def->coherence == KDR_COHERENCE_COHERENT; i += 2)
        occluded[i] = occluded[i - 1];
}

static void occluded_n_behind_the_last(const kdr_scene *scene, const kdr_trace_def *def, const kdr_ray *rays,
                                       uint8_t *occluded, size_t count) {
    kdr_occluded_n(scene, def, rays, occluded, count);
    occluded[count] = 0;
}

static void occluded_n_that_says_two(const kdr_scene *scene, const kdr_trace_def *def, const kdr_ray *rays,
                                     uint8_t *occluded, size_t count) {
    kdr_occluded_n(scene, def, rays, occluded, count);
    for (size_t i = 0; i < count; i++)
        occluded[i] *= 2;
}

/* Field `field` of lane 1, in packets of this width. */
static void write(uint32_t width, uint32_t only, void *packet, uint32_t field, uint32_t value) {
    if (width == only)
        memcpy((uint32_t *)packet + (size_t)field * width + 1, &value, sizeof value);
}

#define GEOMETRY 18
#define MASK 9
#define FAR 8

static void intersect8_in_a_lane_that_is_not_active(const kdr_scene *scene, uint32_t width, const int32_t *valid,
                                                    void *ray_hits) {
    trace_library.intersect_packet(scene, width, valid, ray_hits);
    if (valid && !valid[1])
        write(width, 8, ray_hits, GEOMETRY, KDR_INVALID_ID);
}

static void intersect4_behind_its_end(const kdr_scene *scene, uint32_t width, const int32_t *valid, void *ray_hits) {
    trace_library.intersect_packet(scene, width, valid, ray_hits);
    write(width, 4, ray_hits, 20, 0);
}

static void occluded16_in_a_lane_that_is_not_active(const kdr_scene *scene, uint32_t width, const int32_t *valid,
                                                    void *rays) {
    trace_library.occluded_packet(scene, width, valid, rays);
    if (valid && !valid[1])
        write(width, 16, rays, FAR, 0xff800000u /* -infinity */);
}

static void occluded4_with_another_mask(const kdr_scene *scene, uint32_t width, const int32_t *valid, void *rays) {
    trace_library.occluded_packet(scene, width, valid, rays);
    write(width, 4, rays, MASK, 1);
}

/* ---- planting */

static const char *planted_row; /* words of a plan */
static const lone_fault *planted_lone;
static const packet_fault *planted_packet;

static void spoil(kdr_scene *scene) {
    kdr_build_def def;
    assert_int_equal(kdr_build_def_parse(planted_row, &def, NULL, 0), KDR_OK);
    true_table = kdr_traversals_for(scene->device->isa);
    scene->device->traversals = true_table;
    if (scene->shown->dynamic_part->plan.trace != def.trace || scene->shown->dynamic_part->plan.nodes != def.nodes)
        return;
    truth = scene->shown->dynamic_part->lone;
    if (planted_lone && planted_lone->closest)
        scene->shown->dynamic_part->lone.closest = planted_lone->closest;
    if (planted_lone && planted_lone->any)
        scene->shown->dynamic_part->lone.any = planted_lone->any;
    false_table = *true_table;
    if (planted_packet && planted_packet->closest)
        false_table.packet_closest = planted_packet->closest;
    if (planted_packet && planted_packet->any)
        false_table.packet_any = planted_packet->any;
    scene->device->traversals = &false_table;
}

static trace_report walk(const trace_fault *fault) {
    trace_report report = {0};
    // Few triangles that hide little of one another, so that every one of them is the only hit of some ray.
    trace_case asked = {.kind = soup_kind_find("small"),
                        .triangles = 10,
                        .rays = 512,
                        .sequence = 800,
                        .split = "split=binned",
                        .axis = "",
                        .share = "",
                        .order = "",
                        .costs = "traversal-cost=0.1 leaf-limit=1"};
    trace_check(&asked, fault, &report);
    return report;
}

static void without_a_fault_nothing_is_found(void **state) {
    (void)state;
    trace_report report = walk(NULL);
    assert_int_equal(report.wrong_scenes, 0);
    assert_int_equal(report.wrong_rows, 0);
    assert_string_equal(report.first, "");
    assert_true(report.scenes >= trace_row_count && report.hits > 50);
}

/* The fault is in that row on all these instruction sets, and in no other. */
static void hold_found(const trace_report *report, size_t row, uint32_t isas, const char *name) {
    if (report->wrong_rows != 1u << row || report->wrong_isas != isas || !strstr(report->first, trace_rows[row]))
        fail_msg("%s, %s: found in rows %x, instruction sets %x of %x; %s", name, trace_rows[row], report->wrong_rows,
                 report->wrong_isas, report->isas, report->first);
}

static void a_fault_in_a_lone_ray_is_found_in_every_traversal(void **state) {
    (void)state;
    trace_fault fault = {trace_library, spoil};
    planted_packet = NULL;
    for (size_t row = 0; row < trace_row_count; row++) {
        for (size_t i = 0; i < LONE_FAULTS; i++) {
            planted_row = trace_rows[row];
            planted_lone = &lone_faults[i];
            trace_report report = walk(&fault);
            hold_found(&report, row, report.isas, lone_faults[i].name);
            assert_non_null(strstr(report.first, lone_faults[i].closest ? "intersect1" : "occluded1"));
        }
    }
}

static void a_fault_in_a_packet_is_found(void **state) {
    (void)state;
    trace_fault fault = {trace_library, spoil};
    planted_row = trace_rows[0];
    planted_lone = NULL;
    for (size_t i = 0; i < PACKET_FAULTS; i++) {
        planted_packet = &packet_faults[i];
        trace_report report = walk(&fault);
        uint32_t isas = report.isas;
        if (packet_faults[i].closest == packet_without_late_lanes)
            isas &= ~(1u << KDR_ISA_SCALAR); // which has no wide tree, and asks rays of a call one by one
        hold_found(&report, 0, isas, packet_faults[i].name);
    }
}

static void a_fault_in_a_query_is_found(void **state) {
    (void)state;
    const struct {
        trace_queries queries;
        const char *found;
    } faults[] = {
        {{.intersect1 = intersect1_with_another_id}, "intersect1"},
        {{.intersect_n = intersect_n_behind_the_last}, "intersect_n, behind the last"},
        {{.intersect_n = intersect_n_without_the_last}, "intersect_n"},
        {{.occluded_n = occluded_n_of_the_ray_before_if_coherent}, "occluded_n, coherent"},
        {{.occluded_n = occluded_n_behind_the_last}, "occluded_n, behind the last"},
        {{.occluded_n = occluded_n_that_says_two}, "occluded_n"},
        {{.intersect_packet = intersect8_in_a_lane_that_is_not_active}, "intersect8, a lane that is not active"},
        {{.intersect_packet = intersect4_behind_its_end}, "a packet, behind its end"},
        {{.occluded_packet = occluded16_in_a_lane_that_is_not_active}, "occluded16, what is not its own"},
        {{.occluded_packet = occluded4_with_another_mask}, "occluded4, what is not its own"},
    };
    for (size_t i = 0; i < sizeof faults / sizeof faults[0]; i++) {
        trace_fault fault = {faults[i].queries, NULL};
        fault.queries.occluded1 = kdr_occluded1;
        if (!fault.queries.intersect1)
            fault.queries.intersect1 = kdr_intersect1;
        if (!fault.queries.intersect_n)
            fault.queries.intersect_n = kdr_intersect_n;
        if (!fault.queries.occluded_n)
            fault.queries.occluded_n = kdr_occluded_n;
        if (!fault.queries.intersect_packet)
            fault.queries.intersect_packet = trace_library.intersect_packet;
        if (!fault.queries.occluded_packet)
            fault.queries.occluded_packet = trace_library.occluded_packet;
        trace_report report = walk(&fault);
        if (!strstr(report.first, faults[i].found))
            fail_msg("\"%s\" is not found, but: %s", faults[i].found, report.first);
        assert_int_equal(report.wrong_isas, report.isas);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_a_fault_nothing_is_found),
        cmocka_unit_test(a_fault_in_a_lone_ray_is_found_in_every_traversal),
        cmocka_unit_test(a_fault_in_a_packet_is_found),
        cmocka_unit_test(a_fault_in_a_query_is_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
