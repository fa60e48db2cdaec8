/* What was published about building kd-trees, measured again: memory from pools, the order of nodes, the form of
 * events, growth with the size of the scene, and regions. One run writes one table, as CSV, to stdout.
 * docs/experiments.md has the questions and what came out. */
#include "base/cpu.h"
#include "build_timing.h"
#include "kdray/kdray.h"

#include <glob.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Leaves of one triangle wherever that pays at all, as builders made them that knew no blocks. */
#define FINE "traversal-cost=1 leaf-limit=1"

#define BYTES_PER_TRIANGLE 1024 /* of machine memory: larger scenes are left out of the growth */

static const char *const scenes[] = {"knot", "city"};
#define SMALL 64 /* how many times fewer triangles a small scene has */
#define GROWTH_SCENE "knot"

typedef struct request {
    size_t triangles; /* of the scenes that do not grow */
    size_t largest;   /* of the one that does */
    const char *only; /* experiment; NULL: all */
    build_effort effort;
} request;

/* ---- variants */

static void add(build_group *group, const char *plan, const char *more, bool per_node, uint32_t threads) {
    build_variant *v = &group->variants[group->count++];
    snprintf(v->plan, sizeof v->plan, "%s%s%s", plan, *more ? " " : "", more);
    v->per_node = per_node;
    v->threads = threads;
}

static const char *const pool_plans[] = {"split=sweep", ("split=sweep " FINE), "split=binned"};
#define POOL_PLANS (sizeof pool_plans / sizeof pool_plans[0])

static void list_pools(build_group *group) {
    for (size_t i = 0; i < POOL_PLANS; i++) {
        for (int per_node = 0; per_node <= 1; per_node++) {
            add(group, pool_plans[i], "", per_node, 1);
            add(group, pool_plans[i], "share=grid/16", per_node, 2);
        }
    }
}

static void list_orders(build_group *group) {
    for (size_t i = 0; i < POOL_PLANS; i++) {
        add(group, pool_plans[i], "order=dfs", false, 1);
        add(group, pool_plans[i], "order=bfs", false, 1);
    }
}

static void list_events(build_group *group) {
    static const char *const plans[] = {"split=sweep straddle=general", "split=sweep straddle=clip",
                                        ("split=sweep " FINE)};
    for (size_t i = 0; i < sizeof plans / sizeof plans[0]; i++) {
        add(group, plans[i], "events=2", false, 1);
        add(group, plans[i], "events=3", false, 1);
    }
}

static void list_shares(build_group *group) {
    static const char *const shares[] = {"serial", "line", "grid", "cluster"};
    for (uint32_t threads = 1; threads <= 2; threads++) {
        add(group, "split=binned", "", false, threads);
        for (int i = 0; i < 4; i++) {
            for (uint32_t regions = 1; regions <= 1024; regions *= 4) {
                char share[32];
                snprintf(share, sizeof share, "share=%s/%" PRIu32, shares[i], regions);
                add(group, "split=binned", share, false, threads);
            }
        }
    }
}

static void list_growth(build_group *group, bool slow_ones) {
    add(group, "split=binned", "", false, 1);
    if (!slow_ones)
        return;
    add(group, "split=sweep straddle=general", "", false, 1);
    add(group, "split=sweep straddle=clip", "", false, 1);
    add(group, "split=object", "", false, 1);
}

/* ---- scenes */

static void warn(kdr_log_level level, const char *text, void *user) {
    (void)level;
    (void)user;
    fprintf(stderr, "%s\n", text);
}

static const kdr_logger logger = {.log = warn};

static const struct experiment {
    const char *name;
    void (*list)(build_group *group);
    bool small; /* also on a small scene, which fits in caches */
} experiments[] = {{"pools", list_pools, true},
                   {"order", list_orders, true},
                   {"events", list_events, false},
                   {"shares", list_shares, false}};

static bool is_wanted(const request *r, const char *experiment) { return !r->only || strcmp(r->only, experiment) == 0; }

/* Every experiment but the growth on one scene, or those for small ones; gives the mesh back. */
static bool measure_scene(const request *r, const char *name, bool small, kdr_mesh *mesh) {
    bool done = true;
    for (size_t i = 0; i < sizeof experiments / sizeof experiments[0] && done; i++) {
        build_group group = {.experiment = experiments[i].name};
        experiments[i].list(&group);
        if (is_wanted(r, group.experiment) && (!small || experiments[i].small))
            done = build_timing_group(stdout, &group, &r->effort, name, mesh);
    }
    kdr_mesh_destroy(mesh);
    return done;
}

/* A built-in scene; below the size asked for it is a small one. */
static bool make_and_measure(const request *r, const char *name, size_t triangles) {
    bool small = triangles < r->triangles;
    kdr_mesh *mesh;
    return kdr_mesh_make(name, triangles, 0, &logger, &mesh) == KDR_OK && measure_scene(r, name, small, mesh);
}

static bool measure_built_in(const request *r) {
    size_t small = r->triangles / SMALL < 100 ? 100 : r->triangles / SMALL;
    for (size_t i = 0; i < sizeof scenes / sizeof scenes[0]; i++)
        if (!make_and_measure(r, scenes[i], r->triangles) ||
            (small < r->triangles && !make_and_measure(r, scenes[i], small)))
            return false;
    return true;
}

/* The name of a file without its folder, its ending, and what a line of CSV or its reader would stumble over. */
static void name_of(const char *path, char *out, size_t size) {
    const char *slash = strrchr(path, '/');
    snprintf(out, size, "%s", slash ? slash + 1 : path);
    out[strcspn(out, ".")] = 0;
    for (char *c = out; *c; c++)
        if (strchr(",\"#\r\n", *c))
            *c = '_';
}

/* The .ply files of the folder KDRAY_SCENES, if it is set. */
static bool measure_files(const request *r) {
    const char *folder = getenv("KDRAY_SCENES");
    if (!folder || !*folder)
        return true;
    char pattern[4096], name[128];
    glob_t found;
    if (snprintf(pattern, sizeof pattern, "%s/*.ply", folder) >= (int)sizeof pattern ||
        glob(pattern, 0, NULL, &found) != 0) {
        fprintf(stderr, "KDRAY_SCENES: there is no .ply file in %s\n", folder);
        return false;
    }
    bool done = true;
    for (size_t i = 0; i < found.gl_pathc && done; i++) {
        kdr_mesh *mesh;
        name_of(found.gl_pathv[i], name, sizeof name);
        done = kdr_mesh_read(found.gl_pathv[i], &logger, &mesh) == KDR_OK && measure_scene(r, name, false, mesh);
    }
    globfree(&found);
    return done;
}

/* Three decades of one scene, two sizes in each; the last size only by bins. */
static bool measure_growth(const request *r) {
    static const double fractions[] = {0.001, 0.00316, 0.01, 0.0316, 0.1, 0.316, 1};
    build_effort effort = r->effort;
    effort.least = 3;
    double memory = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
    for (size_t i = 0; i < sizeof fractions / sizeof fractions[0]; i++) {
        size_t triangles = (size_t)(fractions[i] * (double)r->largest + 0.5);
        if (triangles < 100)
            continue;
        if ((double)triangles * BYTES_PER_TRIANGLE > memory) {
            fprintf(stderr, "growth: %zu triangles are too many for the memory of this machine\n", triangles);
            return true;
        }
        build_group group = {.experiment = "growth"};
        list_growth(&group, fractions[i] < 1);
        kdr_mesh *mesh;
        if (kdr_mesh_make(GROWTH_SCENE, triangles, 0, &logger, &mesh) != KDR_OK)
            return false;
        bool done = build_timing_group(stdout, &group, &effort, GROWTH_SCENE, mesh);
        kdr_mesh_destroy(mesh);
        if (!done)
            return false;
    }
    return true;
}

/* ---- the run */

static void write_machine(const request *r) {
    char line[256] = "";
    FILE *file = fopen("/proc/cpuinfo", "r");
    while (file && fgets(line, sizeof line, file) && strncmp(line, "model name", 10) != 0)
        line[0] = 0;
    if (file)
        fclose(file);
    const char *name = strchr(line, ':');
    line[strcspn(line, "\n")] = 0;
    kdr_isa isa = kdr_cpu_isa();
    kdr_cpu_choose_isa(isa, &isa);
    printf("# kdray build experiments: medians of at most %" PRIu32 " rounds\n"
           "# machine: %s, %ld processors\n# instruction set: %s\n# kdray: %s\n"
           "# seconds: processor time; spread: of the middle half of the rounds, as a part of the median\n"
           "# wall_seconds: least, since whatever else runs can only add to it\n"
           "# n_log_n: nanoseconds over N log2 N\n",
           r->effort.rounds, name ? name + 2 : "unknown", sysconf(_SC_NPROCESSORS_ONLN), kdr_isa_name(isa),
           kdr_version());
}

static const char help[] =
    "usage: build_experiments [OPTION]... > TABLE.csv\n\n"
    "Builds kd-trees by many plans and writes a table of what it took. Files of the folder KDRAY_SCENES are measured\n"
    "beside the built-in scenes.\n\n"
    "  --triangles N   size of the built-in scenes, 100 to 10000000, default 200000\n"
    "  --largest N     largest scene of the growth, 100 to 10000000, default 10000000\n"
    "  --rounds N      builds of each plan, 1 to 99, default 9; fewer, but at least 5 (growth: 3), where they take "
    "long\n"
    "  --seconds N     how long is long: processor time for each scene of an experiment, 0 to 10000, default 12\n"
    "  --only NAME     one of pools, order, events, shares and growth\n";

static bool read_number(const char *text, double least, double most, double *out) {
    char *end;
    *out = strtod(text, &end);
    return end != text && !*end && *out >= least && *out <= most;
}

static bool read_name(const char *text, const char **out) {
    *out = text;
    bool known = strcmp(text, "growth") == 0;
    for (size_t i = 0; i < sizeof experiments / sizeof experiments[0]; i++)
        known = known || strcmp(text, experiments[i].name) == 0;
    return known;
}

static bool read_option(request *r, const char *option, const char *value) {
    double number;
    if (strcmp(option, "--only") == 0)
        return read_name(value, &r->only);
    if (strcmp(option, "--triangles") == 0 && read_number(value, 100, 1e7, &number))
        r->triangles = (size_t)number;
    else if (strcmp(option, "--largest") == 0 && read_number(value, 100, 1e7, &number))
        r->largest = (size_t)number;
    else if (strcmp(option, "--rounds") == 0 && read_number(value, 1, ROUND_LIMIT, &number))
        r->effort.rounds = (uint32_t)number;
    else if (strcmp(option, "--seconds") == 0 && read_number(value, 0, 1e4, &number))
        r->effort.group_seconds = number;
    else
        return false;
    return true;
}

int main(int argc, char **argv) {
    request r = {.triangles = 200000, .largest = 10000000, .effort = {.rounds = 9, .least = 5, .group_seconds = 12}};
    if (argc == 2 && strcmp(argv[1], "--help") == 0) {
        fputs(help, stdout);
        return 0;
    }
    for (int i = 1; i < argc; i += 2) {
        if (i + 1 == argc || !read_option(&r, argv[i], argv[i + 1])) {
            fprintf(stderr, "build_experiments: %s %s is no option; --help lists them\n", argv[i],
                    i + 1 < argc ? argv[i + 1] : "");
            return 2;
        }
    }
    write_machine(&r);
    build_timing_head(stdout);
    bool done = measure_built_in(&r) && measure_files(&r) && (!is_wanted(&r, "growth") || measure_growth(&r));
    if (fflush(stdout) != 0 || ferror(stdout)) {
        fputs("build_experiments: the table was not written\n", stderr);
        return 1;
    }
    return done ? 0 : 1;
}
