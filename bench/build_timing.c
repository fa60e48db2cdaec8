/* Every variant is built once before anything is measured, so that the memory that kdray keeps is there, and then in
 * rounds, every other round backwards: whatever slows the machine for a while slows all of them. The figure is the
 * median of the seconds of processor time that the process takes for a build, with the kd-tree's final layout, without
 * the wide tree, which no plan changes. */
#include "build_timing.h"

#include "base/cpu.h"
#include "build/plan.h"
#include "per_node_order.h"
#include "scene/device.h"
#include "scene/triangles.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define MOST_THREADS 2
#define LONG_SECONDS 2.0 /* a first build of more is a figure itself: it is hardly slower for its cold memory */

typedef struct measured {
    double processor[ROUND_LIMIT + 1], wall[ROUND_LIMIT + 1];
    uint32_t count;
    double cost;
    uint64_t hash;
} measured;

typedef struct timing {
    const build_group *group;
    kdr_device *devices[MOST_THREADS + 1]; /* a number of threads */
    kdr_triangles_def def;
    uint32_t first[2]; /* numbers of the only geometry's triangles */
    measured *figures; /* a variant */
} timing;

static double processor_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static bool plan_of(const build_variant *variant, kdr_plan *plan) {
    kdr_build_def def = kdr_default_build_def();
    char problem[400];
    if (kdr_build_def_parse(variant->plan, &def, problem, sizeof problem) != KDR_OK) {
        fprintf(stderr, "%s: %s\n", variant->plan, problem);
        return false;
    }
    *plan = kdr_plan_of(&def);
    plan->own_order = variant->per_node ? kdr_per_node_order() : NULL;
    return true;
}

static kdr_device *device_of(timing *t, uint32_t threads) {
    if (threads < 1 || threads > MOST_THREADS)
        return NULL;
    kdr_device_def def = kdr_default_device_def();
    def.worker_count = threads;
    if (!t->devices[threads] && kdr_device_create(&def, &t->devices[threads]) != KDR_OK)
        return NULL;
    return t->devices[threads];
}

/* Builds once; `keep`: the time counts. */
static bool build(timing *t, uint32_t number, bool keep) {
    const build_variant *variant = &t->group->variants[number];
    measured *m = &t->figures[number];
    kdr_device *device = device_of(t, variant->threads);
    kdr_plan plan;
    if (!device || !plan_of(variant, &plan))
        return false;
    kdr_triangles triangles = {&t->def, t->first, 1};
    kdr_input input = kdr_triangles_input(&triangles);
    kdr_tree tree;
    kdr_input_counts counts;
    double processor = processor_seconds(), wall = kdr_cpu_seconds();
    kdr_status status = kdr_build(device->workshop, &device->crew, device->isa, &input, &plan, &tree, &counts);
    processor = processor_seconds() - processor;
    wall = kdr_cpu_seconds() - wall;
    if (status != KDR_OK) {
        fprintf(stderr, "%s: %s\n", variant->plan, kdr_status_text(status));
        return false;
    }
    if (m->hash == 0) {
        kdr_tree_stats stats;
        kdr_tree_count(&tree, &stats);
        m->cost = stats.cost;
        m->hash = kdr_tree_hash(&tree);
    }
    kdr_tree_release(&tree, &device->bulk);
    if (keep || processor > LONG_SECONDS) {
        m->processor[m->count] = processor;
        m->wall[m->count++] = wall;
    }
    return true;
}

/* ---- figures of many rounds */

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The value below which a fraction of the sorted values lies. */
static double quantile(const double *sorted, uint32_t count, double fraction) {
    double at = fraction * (count - 1);
    uint32_t below = (uint32_t)at, above = below + 1 < count ? below + 1 : below;
    return sorted[below] + (at - below) * (sorted[above] - sorted[below]);
}

void build_timing_head(FILE *out) {
    fputs("experiment,plan,memory,scene,triangles,threads,rounds,seconds,spread,wall_seconds,n_log_n,cost,tree\n", out);
}

static void write_row(FILE *out, const build_group *group, uint32_t number, const char *scene, uint32_t triangles,
                      measured *m) {
    const build_variant *variant = &group->variants[number];
    qsort(m->processor, m->count, sizeof *m->processor, compare);
    qsort(m->wall, m->count, sizeof *m->wall, compare);
    double seconds = quantile(m->processor, m->count, 0.5);
    double spread = (quantile(m->processor, m->count, 0.75) - quantile(m->processor, m->count, 0.25)) / seconds;
    double n_log_n = triangles > 1 ? 1e9 * seconds / (triangles * log2(triangles)) : 0;
    fprintf(out, "%s,%s,%s,%s,%" PRIu32 ",%" PRIu32 ",%" PRIu32 ",%.6g,%.3f,%.6g,%.4g,%.6g,%016" PRIx64 "\n",
            group->experiment, variant->plan, variant->per_node ? "node" : "pool", scene, triangles, variant->threads,
            m->count, seconds, spread, m->wall[0], n_log_n, m->cost, m->hash);
}

/* ---- the same tree, whatever the order */

/* A plan without its order. */
static void copy_without_order(const char *plan, char *out) {
    const char *order = strstr(plan, " order=");
    size_t before = order ? (size_t)(order - plan) : strlen(plan);
    memcpy(out, plan, before);
    strcpy(out + before, order ? order + 1 + strcspn(order + 1, " ") : "");
}

static bool trees_agree(const timing *t) {
    for (uint32_t i = 0; i < t->group->count; i++) {
        for (uint32_t k = 0; k < i; k++) {
            char a[sizeof t->group->variants[i].plan], b[sizeof a];
            copy_without_order(t->group->variants[i].plan, a);
            copy_without_order(t->group->variants[k].plan, b);
            if (strcmp(a, b) == 0 && t->figures[i].hash != t->figures[k].hash) {
                fprintf(stderr, "%s: the tree is not that of %s\n", t->group->variants[i].plan,
                        t->group->variants[k].plan);
                return false;
            }
        }
    }
    return true;
}

static bool measure(timing *t, const build_effort *effort) {
    uint32_t count = t->group->count, rounds = effort->rounds;
    double begin = processor_seconds();
    for (uint32_t i = 0; i < count; i++)
        if (!build(t, i, false))
            return false;
    if (!trees_agree(t))
        return false;
    double affordable = effort->group_seconds / (processor_seconds() - begin);
    uint32_t least = effort->least < rounds ? effort->least : rounds;
    if (affordable < rounds)
        rounds = affordable > least ? (uint32_t)affordable : least;
    for (uint32_t round = 0; round < rounds; round++) {
        for (uint32_t i = 0; i < count; i++) {
            uint32_t number = round % 2 ? count - 1 - i : i;
            if (t->figures[number].count < rounds && !build(t, number, true))
                return false;
        }
    }
    return true;
}

bool build_timing_group(FILE *out, const build_group *group, const build_effort *effort, const char *scene,
                        const kdr_mesh *mesh) {
    timing t = {.group = group, .def = kdr_default_triangles_def()};
    t.def.vertices = mesh->positions;
    t.def.vertex_count = mesh->vertex_count;
    t.def.indices = mesh->indices;
    t.def.triangle_count = mesh->triangle_count;
    t.first[1] = (uint32_t)mesh->triangle_count;
    t.figures = calloc(group->count, sizeof *t.figures);
    fprintf(stderr, "%s: %s, %" PRIu32 " triangles\n", group->experiment, scene, t.first[1]);
    bool done = t.figures && measure(&t, effort);
    for (uint32_t i = 0; i < group->count && done; i++)
        write_row(out, group, i, scene, t.first[1], &t.figures[i]);
    free(t.figures);
    for (uint32_t i = 0; i <= MOST_THREADS; i++)
        kdr_device_destroy(t.devices[i]);
    return done;
}
