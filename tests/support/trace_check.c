#include "support/trace_check.h"

#include "scene/scene.h"
#include "support/awkward_rays.h"
#include "support/cell_rays.h"
#include "support/everywhere.h"
#include "support/plan_rows.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define COUNT(rows) (sizeof(rows) / sizeof(rows)[0])
#define BUNDLE 16
#define GUARD 0x5a

const char *const trace_rows[] = {
    "trace=auto",      "trace=stack",       "trace=stack nodes=arrays", "trace=restart", "trace=restart nodes=arrays",
    "trace=push-down", "trace=short-stack", "trace=backtrack"};
const size_t trace_row_count = COUNT(trace_rows);

const char *const mailbox_rows[] = {"mailbox=0", "mailbox=8", "mailbox=16", "mailbox=32", "mailbox=64"};
const size_t mailbox_row_count = COUNT(mailbox_rows);

static void intersect_packet(const kdr_scene *scene, uint32_t width, const int32_t *valid, void *ray_hits) {
    if (width == 4)
        kdr_intersect4(scene, valid, ray_hits);
    else if (width == 8)
        kdr_intersect8(scene, valid, ray_hits);
    else
        kdr_intersect16(scene, valid, ray_hits);
}

static void occluded_packet(const kdr_scene *scene, uint32_t width, const int32_t *valid, void *rays) {
    if (width == 4)
        kdr_occluded4(scene, valid, rays);
    else if (width == 8)
        kdr_occluded8(scene, valid, rays);
    else
        kdr_occluded16(scene, valid, rays);
}

const trace_queries trace_library = {kdr_intersect1, kdr_occluded1,    kdr_intersect_n,
                                     kdr_occluded_n, intersect_packet, occluded_packet};

/* ---- asking one scene */

typedef struct interview {
    const trace_queries *queries;
    const kdr_scene *scene;
    const kdr_ray *rays;
    const kdr_ray_hit *expected;
    size_t count;
    kdr_ray_hit *given; /* count + 1 */
    uint8_t *occluded;  /* count + 1 */
    test_random random;
    size_t wrong;
    char first[256]; /* the first wrong answer's query and ray */
} interview;

static void note(interview *asking, size_t number, const char *what) {
    const kdr_ray *ray = &asking->rays[number];
    if (asking->wrong++ == 0)
        snprintf(asking->first, sizeof asking->first, "%s, ray %zu {%a, %a, %a} {%a, %a, %a} %a to %a", what, number,
                 ray->origin_x, ray->origin_y, ray->origin_z, ray->direction_x, ray->direction_y, ray->direction_z,
                 ray->tmin, ray->tmax);
}

/* Hits are equal to the bit; of a miss only the geometry counts, and the ray. */
static bool is_same(const kdr_ray_hit *a, const kdr_ray_hit *b) {
    return memcmp(&a->ray, &b->ray, sizeof a->ray) == 0 && a->hit.geometry == b->hit.geometry &&
           (a->hit.geometry == KDR_INVALID_ID || memcmp(&a->hit, &b->hit, sizeof a->hit) == 0);
}

static bool is_hit(const interview *asking, size_t number) {
    return asking->expected[number].hit.geometry != KDR_INVALID_ID;
}

static void ask_alone(interview *asking) {
    for (size_t i = 0; i < asking->count; i++) {
        kdr_ray_hit given;
        memset(&given, GUARD, sizeof given);
        given.ray = asking->rays[i];
        asking->queries->intersect1(asking->scene, &given);
        if (!is_same(&given, &asking->expected[i]))
            note(asking, i, "intersect1");
        if (asking->queries->occluded1(asking->scene, &asking->rays[i]) != is_hit(asking, i))
            note(asking, i, "occluded1");
    }
}

/* One call for rays [first, first + count). Behind the last there is one more that must stay as it is. */
static void ask_call(interview *asking, const kdr_trace_def *def, size_t first, size_t count) {
    static const char *const closest[] = {"intersect_n, unknown", "intersect_n, coherent", "intersect_n, incoherent"};
    static const char *const any[] = {"occluded_n, unknown", "occluded_n, coherent", "occluded_n, incoherent"};
    const int coherence = def ? (int)def->coherence : 0;
    memset(asking->given, GUARD, (count + 1) * sizeof *asking->given);
    memset(asking->occluded, GUARD, count + 1);
    for (size_t i = 0; i < count; i++)
        asking->given[i].ray = asking->rays[first + i];
    const kdr_ray_hit behind = asking->given[count];
    asking->queries->intersect_n(asking->scene, def, asking->given, count);
    asking->queries->occluded_n(asking->scene, def, asking->rays + first, asking->occluded, count);
    for (size_t i = 0; i < count; i++) {
        if (!is_same(&asking->given[i], &asking->expected[first + i]))
            note(asking, first + i, closest[coherence]);
        if (asking->occluded[i] != is_hit(asking, first + i))
            note(asking, first + i, any[coherence]);
    }
    if (memcmp(&behind, &asking->given[count], sizeof behind) != 0)
        note(asking, first, "intersect_n, behind the last");
    if (asking->occluded[count] != GUARD)
        note(asking, first, "occluded_n, behind the last");
}

/* All at once, of one coherence. */
static void ask_one_call(interview *asking, uint32_t coherence) {
    kdr_trace_def def = kdr_default_trace_def();
    def.coherence = (kdr_coherence)coherence;
    ask_call(asking, &def, 0, asking->count);
}

/* In runs, among them single bundles. */
static void ask_runs(interview *asking) {
    static const size_t runs[] = {16, 1, 15, 16, 17, 0, 31, 64};
    kdr_trace_def def = kdr_default_trace_def();
    for (size_t i = 0, first = 0; first < asking->count; i++) {
        size_t left = asking->count - first, count = runs[i % COUNT(runs)] < left ? runs[i % COUNT(runs)] : left;
        def.coherence = (kdr_coherence)(i / 2 % 3);
        ask_call(asking, i % 2 ? NULL : &def, first, count);
        first += count;
    }
}

/* ---- packets: fields of `width` numbers each, one body for all widths */

#define RAY_FIELDS 12
#define FIELDS 20
#define FAR 8
#define WIDEST 16

typedef struct packet {
    uint32_t of[FIELDS * WIDEST + WIDEST]; /* what follows the packet is guarded */
} packet;

static void compare_lanes(interview *asking, uint32_t width, const int32_t *valid, size_t first, const packet *before,
                          const packet *closest, packet *any) {
    static const char *const words[3][4] = {
        {"intersect4", "occluded4", "intersect4, a lane that is not active", "occluded4, what is not its own"},
        {"intersect8", "occluded8", "intersect8, a lane that is not active", "occluded8, what is not its own"},
        {"intersect16", "occluded16", "intersect16, a lane that is not active", "occluded16, what is not its own"}};
    const char *const *say = words[width / 8];
    const float none = -INFINITY;
    for (uint32_t i = 0; i < width; i++) {
        size_t number = first + i;
        uint32_t fields[FIELDS];
        bool untouched = true;
        for (uint32_t k = 0; k < FIELDS; k++) {
            fields[k] = closest->of[k * width + i];
            untouched = untouched && fields[k] == before->of[k * width + i];
        }
        if (valid && !valid[i]) {
            if (!untouched)
                note(asking, number, say[2]);
            continue;
        }
        kdr_ray_hit given;
        memcpy(&given, fields, sizeof given);
        if (!is_same(&given, &asking->expected[number]))
            note(asking, number, say[0]);

        // An occluded ray's end is minus infinity, and nothing else of the packet has changed: put it back to see.
        uint32_t *end = &any->of[FAR * width + i];
        if (is_hit(asking, number)) {
            if (memcmp(end, &none, sizeof none) != 0)
                note(asking, number, say[1]);
            *end = before->of[FAR * width + i];
        } else if (*end != before->of[FAR * width + i]) {
            note(asking, number, say[1]);
            *end = before->of[FAR * width + i];
        }
    }
    if (memcmp(any, before, sizeof *any) != 0)
        note(asking, first, say[3]);
    if (memcmp(&closest->of[FIELDS * width], &before->of[FIELDS * width], WIDEST * sizeof(uint32_t)) != 0)
        note(asking, first, "a packet, behind its end");
}

static void ask_packet(interview *asking, uint32_t width, size_t first) {
    packet before, closest, any;
    int32_t valid[WIDEST];
    memset(&before, GUARD, sizeof before);
    const uint32_t sparse = test_random_below(&asking->random, 4);
    for (uint32_t i = 0; i < width; i++) {
        valid[i] = test_random_below(&asking->random, 4) >= sparse ? -1 - 6 * (int32_t)(i % 2) : 0;
        uint32_t fields[RAY_FIELDS];
        memcpy(fields, &asking->rays[first + i], sizeof fields);
        for (uint32_t k = 0; k < RAY_FIELDS; k++)
            before.of[k * width + i] = fields[k];
    }
    closest = any = before;
    asking->queries->intersect_packet(asking->scene, width, sparse ? valid : NULL, &closest);
    asking->queries->occluded_packet(asking->scene, width, sparse ? valid : NULL, &any);
    compare_lanes(asking, width, sparse ? valid : NULL, first, &before, &closest, &any);
}

static void ask_packets(interview *asking, uint32_t width) {
    for (size_t first = 0; first + width <= asking->count; first += width)
        ask_packet(asking, width, first);
}

/* Of calls and packets one each, by the turn, or all of them. */
static void ask_scene(interview *asking, bool all, uint32_t turn) {
    ask_alone(asking);
    for (uint32_t i = 0; i < 3; i++) {
        if (!all && i != turn % 3)
            continue;
        ask_one_call(asking, i);
        ask_packets(asking, 4u << i);
    }
    if (all)
        ask_runs(asking);
}

/* ---- every way to trace */

/* Awkward rays and rays for the cells, then bundles of 16. */
static kdr_ray *make_rays(const trace_case *asked, const kdr_scene *scene, const oracle_tree *tree,
                          test_random *random) {
    kdr_ray *rays = test_allocate(asked->rays, sizeof *rays);
    cell_sample sample = cell_sample_of(scene, random);
    size_t alone = asked->rays / BUNDLE / 2 * BUNDLE;
    for (size_t i = 0; i < asked->rays; i++) {
        if (i >= alone && i % BUNDLE)
            continue;
        rays[i] = i / (i < alone ? 1 : BUNDLE) % 2 ? cell_ray(random, tree, &sample) : awkward_ray(random, tree);
        if (i >= alone)
            cell_ray_bundle(random, tree, &rays[i], BUNDLE);
    }
    return rays;
}

/* The scalar stack traversal's answers, each of which must be the oracle's. */
static kdr_ray_hit *make_answers(const kdr_scene *scene, const oracle_tree *tree, const kdr_ray *rays, size_t count,
                                 trace_report *report) {
    kdr_ray_hit *answers = test_allocate(count, sizeof *answers);
    for (size_t i = 0; i < count; i++) {
        oracle_hit exact = oracle_tree_closest(tree, &rays[i]);
        answers[i] = (kdr_ray_hit){.ray = rays[i]};
        kdr_intersect1(scene, &answers[i]);
        if (!query_answer_is_right(&rays[i], &exact, &answers[i], "scalar stack"))
            fail_msg("the scalar stack traversal does not answer as the oracle");
        report->hits += exact.primitive != NULL;
    }
    report->rays += count;
    return answers;
}

typedef struct walk {
    const trace_case *asked;
    const trace_fault *fault;
    interview asking;
    uint64_t hash;
    trace_report *report;
} walk;

static kdr_build_def plan_of_row(const trace_case *asked, const char *trace, const char *mailbox, char *text,
                                 size_t size) {
    kdr_build_def def;
    char problem[200];
    snprintf(text, size, "%s %s %s %s %s %s %s", asked->split, asked->axis, asked->share, asked->order, asked->costs,
             trace, mailbox);
    if (kdr_build_def_parse(text, &def, problem, sizeof problem) != KDR_OK)
        fail_msg("%s: %s", text, problem);
    return def;
}

/* The same scene goes from one plan to the next, as a host's would. */
static void ask_row(walk *w, kdr_scene *scene, kdr_isa isa, size_t row, const char *mailbox) {
    char text[300];
    kdr_build_def def = plan_of_row(w->asked, trace_rows[row], mailbox, text, sizeof text);
    if (kdr_scene_commit(scene, &def) != KDR_OK || kdr_scene_hash(scene) != w->hash)
        fail_msg("%s, %s, %s: another tree", w->asked->kind->name, kdr_isa_name(isa), text);
    if (w->fault && w->fault->spoil)
        w->fault->spoil(scene);
    w->asking.scene = scene;
    w->asking.wrong = 0;
    ask_scene(&w->asking, row == 0 || w->asked->is_whole, (uint32_t)(w->asked->sequence + row + (size_t)isa));
    w->report->scenes++;
    if (w->asking.wrong == 0)
        return;
    if (w->report->wrong_scenes++ == 0)
        snprintf(w->report->first, sizeof w->report->first, "%s, sequence %llu, %s, %s: %s", w->asked->kind->name,
                 (unsigned long long)w->asked->sequence, kdr_isa_name(isa), text, w->asking.first);
    w->report->wrong_rows |= 1u << row;
    w->report->wrong_isas |= 1u << isa;
}

static void ask_everything(walk *w, const soup_scene *soup) {
    for (int isa = KDR_ISA_SCALAR; isa <= KDR_ISA_NEON; isa++) {
        kdr_device *device = device_of_isa((kdr_isa)isa, 1, NULL);
        if (!device)
            continue;
        w->report->isas |= 1u << isa;
        kdr_build_def def = kdr_default_build_def();
        kdr_scene *scene = committed_scene(device, soup->geometries, SOUP_GEOMETRIES, &def);
        for (size_t row = 0; row < trace_row_count; row++) {
            size_t mailboxes = row == 0 ? 1 : mailbox_row_count;
            for (size_t i = 0; i < mailboxes; i++)
                if (w->asked->is_whole || i == (w->asked->sequence + row) % mailboxes)
                    ask_row(w, scene, (kdr_isa)isa, row, mailbox_rows[i]);
        }
        kdr_scene_destroy(scene);
        kdr_device_destroy(device);
    }
}

void trace_check(const trace_case *asked, const trace_fault *fault, trace_report *report) {
    test_random random = test_random_start(test_random_seed(), asked->sequence);
    soup_scene soup = soup_scene_create_kind(&random, asked->kind, asked->triangles);
    oracle_scene oracle = oracle_scene_create(soup.geometries, SOUP_GEOMETRIES);
    oracle_tree tree = oracle_tree_create(&oracle);
    kdr_device *plain = device_of_isa(KDR_ISA_SCALAR, 1, NULL);
    char text[300];
    kdr_build_def def = plan_of_row(asked, "trace=stack", "", text, sizeof text);
    kdr_scene *reference = committed_scene(plain, soup.geometries, SOUP_GEOMETRIES, &def);
    if (kdr_scene_verify(reference) != KDR_OK)
        fail_msg("%s, %s: the tree is not sound", asked->kind->name, text);
    kdr_ray *rays = make_rays(asked, reference, &tree, &random);
    kdr_ray_hit *answers = make_answers(reference, &tree, rays, asked->rays, report);
    walk w = {.asked = asked,
              .fault = fault,
              .asking = {.queries = fault ? &fault->queries : &trace_library,
                         .rays = rays,
                         .expected = answers,
                         .count = asked->rays,
                         .given = test_allocate(asked->rays + 1, sizeof(kdr_ray_hit)),
                         .occluded = test_allocate(asked->rays + 1, 1),
                         .random = random},
              .hash = kdr_scene_hash(reference),
              .report = report};
    ask_everything(&w, &soup);

    free(w.asking.given);
    free(w.asking.occluded);
    free(answers);
    free(rays);
    kdr_scene_destroy(reference);
    kdr_device_destroy(plain);
    oracle_tree_destroy(&tree);
    oracle_scene_destroy(&oracle);
    soup_scene_destroy(&soup);
}
