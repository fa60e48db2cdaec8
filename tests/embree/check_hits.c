/* Counts wrong hits among the benchmark's rays: kdray by its default plan and Embree by its watertight and its fast
 * test trace the same floats, and exact arithmetic settles every ray of which any two of them say different things.
 * Of the rays on which all agree one in so many is settled as well.
 *
 *   wrong     hit or miss against the exact answer
 *   elsewhere the closest hit is farther than 1e-4 of its distance from the exact one: another surface
 *   inexact   kdray only: another triangle, or a distance that is not the exact one rounded to a float
 *
 * Fails if kdray is wrong anywhere. */
#include "hit_tracers.h"
#include "support/oracle_tree.h"
#include "support/soup.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define DISTANCE_SLACK 1e-4f

/* The scenes of the run, files of the folder KDRAY_SCENES. */
static const char *const scene_names[] = {"bunny",  "dragon", "kitchen", "sponza-crytek", "city-axis-aligned-2M",
                                          "sibenik"};
#define SCENES (sizeof scene_names / sizeof scene_names[0])

typedef struct request {
    uint32_t side;    /* of the picture */
    uint32_t every;   /* of the rays on which all agree, one in so many is settled */
    uint32_t threads; /* 0: as many as the machine allows */
    FILE *csv;        /* NULL: none */
} request;

typedef struct tally {
    atomic_size_t settled, differing, wrong[HIT_TRACERS], elsewhere[HIT_TRACERS], inexact[HIT_TRACERS];
} tally;

/* ---- rays */

typedef struct comparison {
    const request *asked;
    const hit_tracers *tracers;
    const oracle_tree *tree;
    const kdr_bench_rays *rays;
    tally *counts;
} comparison;

static bool is_elsewhere(const hit_answer *answer, float t) { return fabsf(answer->t - t) > DISTANCE_SLACK * t; }

static bool answers_differ(const hit_answer *const *answers, size_t i, bool any) {
    const hit_answer *first = &answers[0][i];
    for (int tracer = 1; tracer < HIT_TRACERS; tracer++) {
        const hit_answer *other = &answers[tracer][i];
        if (first->hit != other->hit)
            return true;
        if (any || !first->hit)
            continue;
        if (tracer < HIT_TRACERS_OF_KDRAY ? first->t != other->t || first->triangle != other->triangle
                                          : is_elsewhere(other, first->t))
            return true;
    }
    return false;
}

static void settle(const comparison *c, const kdr_ray *ray, const hit_answer *const *answers, size_t i) {
    oracle_hit exact = {0};
    bool any = c->rays->any, hit;
    if (any) {
        hit = oracle_tree_any(c->tree, ray);
    } else {
        exact = oracle_tree_closest(c->tree, ray);
        hit = exact.primitive != NULL;
    }
    atomic_fetch_add(&c->counts->settled, 1);
    for (int tracer = 0; tracer < HIT_TRACERS; tracer++) {
        const hit_answer *given = &answers[tracer][i];
        if (given->hit != hit)
            atomic_fetch_add(&c->counts->wrong[tracer], 1);
        else if (!any && hit) {
            atomic_fetch_add(&c->counts->elsewhere[tracer], is_elsewhere(given, exact.t));
            atomic_fetch_add(&c->counts->inexact[tracer],
                             given->t != exact.t || given->triangle != exact.primitive->primitive);
        }
    }
}

static void compare_block(void *context, size_t begin, size_t end) {
    const comparison *c = context;
    hit_answer *memory = test_allocate(HIT_TRACERS * (end - begin), sizeof *memory);
    const hit_answer *answers[HIT_TRACERS];
    for (int tracer = 0; tracer < HIT_TRACERS; tracer++) {
        answers[tracer] = memory + (size_t)tracer * (end - begin);
        hit_tracers_ask(c->tracers, tracer, c->rays, begin, end, memory + (size_t)tracer * (end - begin));
    }
    for (size_t i = begin; i < end; i++) {
        bool differ = answers_differ(answers, i - begin, c->rays->any);
        atomic_fetch_add(&c->counts->differing, differ);
        if (differ || i % c->asked->every == 0)
            settle(c, &c->rays->rays[i], answers, i - begin);
    }
    free(memory);
}

/* ---- scenes */

static void print_sentence(kdr_log_level level, const char *message, void *user) {
    (void)level;
    (void)user;
    fprintf(stderr, "%s\n", message);
}

static const kdr_logger logger = {print_sentence, NULL};

static void report(const request *asked, const char *name, const char *kind, size_t rays, const tally *counts) {
    printf("%-20s %-8s %9zu %7zu %8zu", name, kind, rays, counts->differing, counts->settled);
    for (int tracer = 0; tracer < HIT_TRACERS; tracer++)
        printf(" %*zu %5zu", (int)strlen(hit_tracer_name(tracer)) - 6, counts->wrong[tracer],
               counts->elsewhere[tracer]);
    printf("\n");
    fflush(stdout);
    for (int tracer = 0; asked->csv && tracer < HIT_TRACERS; tracer++) {
        fprintf(asked->csv, "%s,%s,%s,%zu,%zu,%zu,%zu,%zu,", name, kind, hit_tracer_name(tracer), rays,
                counts->differing, counts->settled, counts->wrong[tracer], counts->elsewhere[tracer]);
        if (tracer < HIT_TRACERS_OF_KDRAY)
            fprintf(asked->csv, "%zu", counts->inexact[tracer]);
        fputc('\n', asked->csv);
    }
}

static void add(tally *to, const tally *from) {
    to->settled += from->settled;
    to->differing += from->differing;
    for (int tracer = 0; tracer < HIT_TRACERS; tracer++) {
        to->wrong[tracer] += from->wrong[tracer];
        to->elsewhere[tracer] += from->elsewhere[tracer];
        to->inexact[tracer] += from->inexact[tracer];
    }
}

static bool compare_rays(const request *asked, const kdr_bench_scene *scene, const hit_tracers *tracers,
                         const oracle_tree *tree, tally *total, size_t *total_rays) {
    kdr_bench_workload workload;
    if (!kdr_bench_workload_make(scene, hit_tracers_scene(tracers), &logger, &workload))
        return false;
    for (int kind = 0; kind < KDR_BENCH_KINDS; kind++) {
        const kdr_bench_rays *rays = &workload.kinds[kind];
        tally counts = {0};
        kdr_bench_run(scene, rays->count, compare_block, &(comparison){asked, tracers, tree, rays, &counts});
        report(asked, scene->name, kdr_bench_kind_name((kdr_bench_kind)kind), rays->count, &counts);
        add(total, &counts);
        *total_rays += rays->count;
    }
    kdr_bench_workload_release(&workload);
    return true;
}

/* The view in a .cam file beside the mesh, or three quarters from above. */
static bool choose_view(kdr_bench_scene *scene, const char *stem) {
    float bounds[6];
    char beside[4096];
    kdr_mesh_bounds(scene->mesh, bounds);
    scene->camera = kdr_camera_for_bounds(bounds);
    kdr_light_for_bounds(bounds, scene->light);
    if (snprintf(beside, sizeof beside, "%s.cam", stem) >= (int)sizeof beside || access(beside, F_OK) != 0)
        return true;
    return kdr_camera_read(beside, &logger, &scene->camera, scene->light) == KDR_OK;
}

/* stem: the file's path without its ending, or a built-in scene. */
static bool compare_scene(const request *asked, const char *stem, tally *total, size_t *total_rays) {
    bool builtin = strncmp(stem, "builtin:", 8) == 0;
    const char *slash = builtin ? NULL : strrchr(stem, '/');
    char path[4096];
    kdr_mesh *mesh = NULL;
    kdr_bench_scene scene = {.width = asked->side, .height = asked->side};
    snprintf(scene.name, sizeof scene.name, "%s", slash ? slash + 1 : stem);
    snprintf(path, sizeof path, "%s%s", stem, builtin ? "" : ".ply");
    kdr_device_def def = kdr_default_device_def();
    def.worker_count = asked->threads;
    if (kdr_mesh_read(path, &logger, &mesh) != KDR_OK || kdr_device_create(&def, &scene.device) != KDR_OK) {
        kdr_mesh_destroy(mesh);
        return false;
    }
    scene.mesh = mesh;
    hit_tracers *tracers = choose_view(&scene, stem) ? hit_tracers_open(scene.device, mesh) : NULL;
    bool done = tracers != NULL;
    if (done) {
        kdr_triangles_def triangles = kdr_default_triangles_def();
        triangles.vertices = mesh->positions;
        triangles.vertex_count = mesh->vertex_count;
        triangles.indices = mesh->indices;
        triangles.triangle_count = mesh->triangle_count;
        oracle_scene oracle = oracle_scene_create(&triangles, 1);
        oracle_tree tree = oracle_tree_create(&oracle);
        done = compare_rays(asked, &scene, tracers, &tree, total, total_rays);
        oracle_tree_destroy(&tree);
        oracle_scene_destroy(&oracle);
        hit_tracers_close(tracers);
    }
    kdr_device_destroy(scene.device);
    kdr_mesh_destroy(mesh);
    return done;
}

/* ---- the run */

static bool write_head(const request *asked) {
    char line[256] = "", plan[KDR_PLAN_TEXT_SIZE];
    FILE *file = fopen("/proc/cpuinfo", "r");
    while (file && fgets(line, sizeof line, file) && strncmp(line, "model name", 10) != 0)
        line[0] = 0;
    if (file)
        fclose(file);
    const char *machine = strchr(line, ':'), *why;
    line[strcspn(line, "\n")] = 0;
    kdr_build_def def = kdr_default_build_def();
    kdr_device *device;
    if (kdr_build_def_print(&def, plan, sizeof plan) != KDR_OK || kdr_device_create(NULL, &device) != KDR_OK)
        return false;
    const char *isa = kdr_isa_name(kdr_device_isa(device)), *embree = kdr_bench_embree_version(&why);
    kdr_device_destroy(device);
    fprintf(asked->csv,
            "# wrong hits: %ux%u pixels; settled: rays of which tracers differ, and one in %u of the others\n"
            "# machine: %s\n# instruction set: %s\n# kdray: %s\n# Embree: %s, medium\n# plan: %s\n"
            "scene,kind,tracer,rays,differing,settled,wrong,elsewhere,inexact\n",
            asked->side, asked->side, asked->every, machine ? machine + 2 : "unknown", isa, kdr_version(),
            embree ? embree : "unknown", plan);
    return true;
}

static const char help[] =
    "usage: check_hits [--side N] [--every N] [--threads N] [--csv FILE] [SCENE...]\n\n"
    "Counts wrong hits of kdray and Embree on the rays of kdray bench, settled by exact arithmetic. A SCENE is a .ply\n"
    "file without its ending, or builtin:NAME[:TRIANGLES]. Without one: six scenes of the folder KDRAY_SCENES.\n"
    "Exit status: 0 kdray is right everywhere, 1 it is not or something failed, 2 wrong usage.\n\n"
    "  --side N     picture of N x N pixels, 8 to 4096, default 1024\n"
    "  --every N    settle one in N of the rays on which all agree, default 100; 1: every ray\n"
    "  --threads N  as many threads, 1 to 256; default: as many as the machine allows\n"
    "  --csv FILE   write the counts as comma separated values\n";

static bool read_number(const char *text, long least, long most, uint32_t *out) {
    char *end;
    long value = strtol(text, &end, 10);
    *out = (uint32_t)value;
    return end != text && !*end && value >= least && value <= most;
}

static bool compare_list(const request *asked, char **scenes, tally *total, size_t *rays) {
    bool done = true;
    for (; *scenes && done; scenes++)
        done = compare_scene(asked, *scenes, total, rays);
    return done;
}

static bool compare_folder(const request *asked, const char *folder, tally *total, size_t *rays) {
    bool done = true;
    for (size_t i = 0; i < SCENES && done; i++) {
        char stem[4000];
        snprintf(stem, sizeof stem, "%s/%s", folder, scene_names[i]);
        done = compare_scene(asked, stem, total, rays);
    }
    return done;
}

static void print_names(void) {
    printf("%-20s %-8s %9s %7s %8s", "", "", "rays", "differ", "settled");
    for (int tracer = 0; tracer < HIT_TRACERS; tracer++)
        printf(" %s", hit_tracer_name(tracer));
    printf(" (of each: wrong, elsewhere)\n");
}

/* The whole run. A file of counts is there when all is done, or not at all. */
static bool run(request *asked, char **scenes, const char *folder, const char *csv) {
    char part[4096];
    snprintf(part, sizeof part, "%s.part", csv ? csv : "");
    asked->csv = csv ? fopen(part, "w") : NULL;
    if (csv && (!asked->csv || !write_head(asked))) {
        fprintf(stderr, "%s: cannot be written\n", part);
        return false;
    }
    print_names();
    tally total = {0};
    size_t rays = 0, faults = 0;
    bool done = *scenes ? compare_list(asked, scenes, &total, &rays) : compare_folder(asked, folder, &total, &rays);
    if (done)
        report(asked, "all", "all", rays, &total);
    if (asked->csv && (fclose(asked->csv) != 0 || !done || rename(part, csv) != 0)) {
        fprintf(stderr, "%s: not written\n", csv);
        remove(part);
        done = false;
    }
    for (int tracer = 0; tracer < HIT_TRACERS_OF_KDRAY; tracer++)
        faults += total.wrong[tracer] + total.inexact[tracer];
    printf("kdray: %zu answers that are not exact\n", faults);
    return done && faults == 0;
}

int main(int count, char **words) {
    request asked = {.side = 1024, .every = 100};
    const char *csv = NULL, *folder = getenv("KDRAY_SCENES");
    bool fits = true;
    for (words++, count--; count >= 2 && strncmp(*words, "--", 2) == 0 && fits; words += 2, count -= 2) {
        if (strcmp(words[0], "--side") == 0)
            fits = read_number(words[1], 8, 4096, &asked.side);
        else if (strcmp(words[0], "--every") == 0)
            fits = read_number(words[1], 1, 1000000000, &asked.every);
        else if (strcmp(words[0], "--threads") == 0)
            fits = read_number(words[1], 1, 256, &asked.threads);
        else if (strcmp(words[0], "--csv") == 0)
            csv = words[1];
        else
            fits = false;
    }
    if (*words && strcmp(*words, "--help") == 0) {
        fputs(help, stdout);
        return 0;
    }
    if (!fits || (*words && **words == '-') || (!*words && (!folder || !*folder))) {
        fputs(help, stderr);
        return 2;
    }
    return run(&asked, words, folder, csv) ? 0 : 1;
}
