/* kdray bench: its options, the scenes one after the other, and where the results go. */
#include "bench.h"
#include "memory.h"
#include "whole_file.h"

#include <argp.h>
#include <errno.h>
#include <glob.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define ROUND_LIMIT 1000u
#define SIDE_LIMIT 16384u
#define THREAD_LIMIT 256u

/* What is measured where neither files nor a folder are named: a small scene and one of medium size. */
static const char *const default_scenes[] = {"builtin:knot:70000", "builtin:city:500000"};
#define DEFAULT_SCENES (sizeof default_scenes / sizeof default_scenes[0])

typedef struct bench_request {
    kdr_bench_options options;
    uint32_t width, height;
    uint32_t threads; /* 0: all processors */
    kdr_isa isa;
    const char *json, *csv;
    bool quiet;
    char **files; /* none: those of a folder, or the default scenes */
    size_t file_count;
} bench_request;

/* ---- options */

enum {
    OPTION_ROUNDS = 256,
    OPTION_ONLY,
    OPTION_ISA,
    OPTION_JSON,
    OPTION_CSV,
    OPTION_TRAVERSAL_COST,
    OPTION_INTERSECTION_COST,
    OPTION_LEAF_LIMIT,
    OPTION_DEPTH_LIMIT,
    OPTION_REFERENCE_LIMIT,
};

static const struct argp_option option_list[] = {
    {"resolution", 'r', "WxH", 0, "Pixels of the picture whose rays are traced (1024x1024)", 0},
    {"threads", 't', "N", 0, "Threads that build and trace (all processors)", 0},
    {"rounds", OPTION_ROUNDS, "N", 0, "Times that everything is measured; medians count (5)", 0},
    {"only", OPTION_ONLY, "TRACER", 0,
     "Leave out tracers whose names begin otherwise, as in kdray, embree/medium, embree/low/packet; repeatable", 0},
    {"isa", OPTION_ISA, "NAME", 0, "Use no wider instructions than scalar, sse42, avx2, avx512 or neon", 0},
    {"json", OPTION_JSON, "FILE", 0, "Write the results as a JSON list of rows", 0},
    {"csv", OPTION_CSV, "FILE", 0, "Write the results as comma separated values", 0},
    {"quiet", 'q', NULL, 0, "Print no tables and no progress", 0},
    {NULL, 0, NULL, 0, "How kdray builds:", 1},
    {"traversal-cost", OPTION_TRAVERSAL_COST, "COST", 0, "Of one step through an interior node", 1},
    {"intersection-cost", OPTION_INTERSECTION_COST, "COST", 0, "Of one triangle test", 1},
    {"leaf-limit", OPTION_LEAF_LIMIT, "N", 0, "Leaves with more triangles are split in any case", 1},
    {"depth-limit", OPTION_DEPTH_LIMIT, "N", 0, "Depth of the deepest leaf; 0: by the number of triangles", 1},
    {"reference-limit", OPTION_REFERENCE_LIMIT, "RATIO", 0, "References a triangle that splitting may use", 1},
    {0},
};

/* A whole number from least to most; a sentence and the end of the program otherwise. */
static uint32_t whole_number(const char *text, uint32_t least, uint32_t most, const struct argp_state *state) {
    char *end;
    errno = 0;
    unsigned long value = strtoul(text, &end, 10);
    if (errno || end == text || *end || *text == '-' || value < least || value > most)
        argp_error(state, "expected a whole number from %u to %u, found \"%s\"", least, most, text);
    return (uint32_t)value;
}

static float number_from(const char *text, float least, bool open, const struct argp_state *state) {
    char *end;
    float value = strtof(text, &end);
    if (end == text || *end || !isfinite(value) || value < least || (open && value == least))
        argp_error(state, "expected a number %s %g, found \"%s\"", open ? "above" : "of at least", (double)least, text);
    return value;
}

static void read_resolution(bench_request *request, const char *text, const struct argp_state *state) {
    char *end;
    unsigned long width = strtoul(text, &end, 10), height = 0;
    const char *second = end + 1;
    if (*end == 'x')
        height = strtoul(second, &end, 10);
    if (strspn(text, "0123456789x") != strlen(text) || *end || width < 1 || width > SIDE_LIMIT || height < 1 ||
        height > SIDE_LIMIT)
        argp_error(state, "expected WxH of 1 to %u pixels a side, found \"%s\"", SIDE_LIMIT, text);
    request->width = (uint32_t)width;
    request->height = (uint32_t)height;
}

static kdr_isa read_isa(const char *text, const struct argp_state *state) {
    for (kdr_isa isa = KDR_ISA_SCALAR; isa <= KDR_ISA_NEON; isa++)
        if (strcmp(text, kdr_isa_name(isa)) == 0)
            return isa;
    argp_error(state, "expected an instruction set (scalar, sse42, avx2, avx512, neon), found \"%s\"", text);
    return KDR_ISA_SCALAR;
}

static void add_only(kdr_bench_options *options, const char *text, const struct argp_state *state) {
    if (options->only_count == KDR_BENCH_ONLY_LIMIT)
        argp_error(state, "--only more than %u times", KDR_BENCH_ONLY_LIMIT);
    options->only[options->only_count++] = text;
    if (!kdr_bench_known(text))
        argp_error(state,
                   "no tracer begins with \"%s\": there are kdray/stream, kdray/single, and "
                   "embree/low, medium, high, each /packet and /single",
                   text);
}

static error_t read_option(int key, char *text, struct argp_state *state) {
    bench_request *request = state->input;
    kdr_build_def *build = &request->options.build;
    switch (key) {
    case 'r': read_resolution(request, text, state); return 0;
    case 't': request->threads = whole_number(text, 1, THREAD_LIMIT, state); return 0;
    case 'q': request->quiet = true; return 0;
    case OPTION_ROUNDS: request->options.rounds = whole_number(text, 1, ROUND_LIMIT, state); return 0;
    case OPTION_ONLY: add_only(&request->options, text, state); return 0;
    case OPTION_ISA: request->isa = read_isa(text, state); return 0;
    case OPTION_JSON: request->json = text; return 0;
    case OPTION_CSV: request->csv = text; return 0;
    case OPTION_TRAVERSAL_COST: build->cost_traversal = number_from(text, 0, true, state); return 0;
    case OPTION_INTERSECTION_COST: build->cost_intersection = number_from(text, 0, true, state); return 0;
    case OPTION_LEAF_LIMIT: build->leaf_limit = whole_number(text, 1, UINT32_MAX, state); return 0;
    case OPTION_DEPTH_LIMIT: build->depth_limit = whole_number(text, 0, KDR_MAX_DEPTH, state); return 0;
    case OPTION_REFERENCE_LIMIT: build->reference_limit = number_from(text, 1, false, state); return 0;
    case ARGP_KEY_ARGS:
        request->files = state->argv + state->next;
        request->file_count = (size_t)(state->argc - state->next);
        return 0;
    default: return ARGP_ERR_UNKNOWN;
    }
}

/* ---- sentences and progress */

static void say(kdr_log_level level, const char *message, void *user) {
    (void)level;
    (void)user;
    fprintf(stderr, "kdray: %s\n", message);
}

static const kdr_logger logger = {say, NULL};

/* One line on a terminal, written over itself. */
static void show_progress(const char *what, uint64_t finished, uint64_t total, void *user) {
    const char *scene = user;
    if (finished < total || total == 0)
        fprintf(stderr, "\r\033[K%s: %s, step %llu", scene, what, (unsigned long long)finished);
    else
        fputs("\r\033[K", stderr);
    fflush(stderr);
}

/* ---- one scene */

/* Rows of all scenes so far, and what they have in common. */
typedef struct result_list {
    kdr_bench_row *rows;
    size_t count, room;
    kdr_bench_run_info info;
} result_list;

static void add_rows(result_list *results, const kdr_bench_row *rows, uint32_t count) {
    if (results->count + count > results->room) {
        results->room = 2 * results->room + KDR_BENCH_ROW_LIMIT;
        kdr_bench_row *larger = kdr_memory_get(results->room, sizeof *larger);
        if (results->count)
            memcpy(larger, results->rows, results->count * sizeof *larger);
        kdr_memory_release(results->rows);
        results->rows = larger;
    }
    memcpy(results->rows + results->count, rows, count * sizeof *rows);
    results->count += count;
}

/* A file's name without folder and ending; a built-in scene's as it is. */
static void name_scene(const char *path, char name[KDR_BENCH_SCENE_SIZE]) {
    if (strncmp(path, "builtin:", 8) == 0) {
        snprintf(name, KDR_BENCH_SCENE_SIZE, "%s", path);
        return;
    }
    const char *slash = strrchr(path, '/');
    snprintf(name, KDR_BENCH_SCENE_SIZE, "%s", slash ? slash + 1 : path);
    char *dot = strrchr(name, '.');
    if (dot && dot > name)
        *dot = 0;
}

/* The view in a .cam file beside the mesh, or three quarters from above. */
static bool choose_view(const char *path, kdr_bench_scene *scene) {
    float bounds[6];
    kdr_mesh_bounds(scene->mesh, bounds);
    scene->camera = kdr_camera_for_bounds(bounds);
    kdr_light_for_bounds(bounds, scene->light);
    if (strncmp(path, "builtin:", 8) == 0)
        return true;
    const char *slash = strrchr(path, '/'), *dot = strrchr(path, '.');
    size_t stem = dot && (!slash || dot > slash + 1) ? (size_t)(dot - path) : strlen(path);
    char *beside = kdr_memory_get(stem + sizeof ".cam", 1);
    memcpy(beside, path, stem);
    memcpy(beside + stem, ".cam", sizeof ".cam");
    bool good = access(beside, F_OK) != 0 || kdr_camera_read(beside, &logger, &scene->camera, scene->light) == KDR_OK;
    kdr_memory_release(beside);
    return good;
}

static bool measure_mesh(const char *path, const kdr_mesh *mesh, const bench_request *request, result_list *results) {
    kdr_bench_scene scene = {.mesh = mesh, .width = request->width, .height = request->height};
    name_scene(path, scene.name);
    if (mesh->triangle_count == 0) {
        fprintf(stderr, "kdray: %s: there are no triangles to measure\n", path);
        return false;
    }
    if (!choose_view(path, &scene))
        return false;

    kdr_device_def def = kdr_default_device_def();
    def.worker_count = request->threads;
    def.isa_limit = request->isa;
    def.log = say;
    if (kdr_device_create(&def, &scene.device) != KDR_OK)
        return false;
    results->info.threads = kdr_device_worker_count(scene.device);
    results->info.isa = kdr_device_isa(scene.device);
    bool show = !request->quiet && isatty(STDERR_FILENO);
    kdr_bench_row rows[KDR_BENCH_ROW_LIMIT];
    uint32_t count = 0;
    bool good = kdr_bench_measure(&scene, &request->options, results->info.embree, &logger, show ? show_progress : NULL,
                                  scene.name, rows, &count);
    if (good && !request->quiet) {
        printf("%s: %zu triangles, %ux%u pixels, %u threads, %s, medians of %u rounds\n\n", scene.name,
               mesh->triangle_count, scene.width, scene.height, results->info.threads, kdr_isa_name(results->info.isa),
               request->options.rounds);
        kdr_bench_print(stdout, rows, count);
        fflush(stdout);
    }
    kdr_device_destroy(scene.device);
    add_rows(results, rows, count);
    return good;
}

static bool measure_file(const char *path, const bench_request *request, result_list *results) {
    kdr_mesh *mesh;
    if (kdr_mesh_read(path, &logger, &mesh) != KDR_OK)
        return false;
    bool good = measure_mesh(path, mesh, request, results);
    kdr_mesh_destroy(mesh);
    return good;
}

/* ---- all scenes */

static bool measure_list(const char *const *paths, size_t count, const bench_request *request, result_list *results) {
    bool good = true;
    for (size_t i = 0; i < count; i++)
        good = measure_file(paths[i], request, results) && good;
    return good;
}

/* The pattern of all .ply files in a folder, whose name may hold characters that mean something in patterns. */
static char *pattern_of(const char *folder) {
    static const char ending[] = "/*.ply";
    char *pattern = kdr_memory_get(2 * strlen(folder) + sizeof ending, 1);
    char *end = pattern;
    for (const char *c = folder; *c; c++) {
        if (strchr("*?[\\", *c))
            *end++ = '\\';
        *end++ = *c;
    }
    memcpy(end, ending, sizeof ending);
    return pattern;
}

/* The files named, those of the folder KDRAY_SCENES, or the default scenes. One that fails does not stop the others. */
static bool measure_all(const bench_request *request, result_list *results) {
    if (request->file_count)
        return measure_list((const char *const *)request->files, request->file_count, request, results);
    const char *folder = getenv("KDRAY_SCENES");
    if (!folder || !*folder)
        return measure_list(default_scenes, DEFAULT_SCENES, request, results);

    glob_t found;
    char *pattern = pattern_of(folder);
    int failed = glob(pattern, 0, NULL, &found);
    kdr_memory_release(pattern);
    if (failed) {
        fprintf(stderr, "kdray: KDRAY_SCENES: there is no .ply file in %s\n", folder);
        return false;
    }
    bool good = measure_list((const char *const *)found.gl_pathv, found.gl_pathc, request, results);
    globfree(&found);
    return good;
}

static void write_csv(FILE *out, const void *context) {
    const result_list *results = context;
    kdr_bench_write_csv(out, &results->info, results->rows, results->count);
}

static void write_json(FILE *out, const void *context) {
    const result_list *results = context;
    kdr_bench_write_json(out, results->rows, results->count);
}

/* Embree's version if it is wanted and there; where it is only missing, that is said. */
static const char *find_embree(const bench_request *request) {
    if (!kdr_bench_wanted(&request->options, "embree"))
        return NULL;
    const char *why = NULL;
    const char *version = kdr_bench_embree_version(&why);
    if (!version)
        fprintf(stderr, "kdray: %s; kdray is measured alone\n", why);
    return version;
}

int kdr_command_bench(int argc, char **argv) {
    static const struct argp parser = {
        .options = option_list,
        .parser = read_option,
        .args_doc = "[FILE...]",
        .doc = "Measure kdray, and Embree where it is installed, on the same rays in the same run."
               "\vFILE is a mesh file, with a view of it in a .cam file beside it where there is one, or a built-in "
               "scene, builtin:NAME[:TRIANGLES]. Without FILE: every .ply file of the folder that the environment "
               "variable KDRAY_SCENES names, or two built-in scenes. Speeds are in million rays a second; the image "
               "takes build, primary and shadow rays together. KDRAY_EMBREE names the Embree library to load."};
    bench_request request = {.options = {.rounds = 5, .build = kdr_default_build_def()},
                             .width = 1024,
                             .height = 1024,
                             .isa = kdr_default_device_def().isa_limit};
    argp_err_exit_status = 2;
    if (argp_parse(&parser, argc, argv, 0, NULL, &request) != 0)
        return 2;
    if ((request.json && !kdr_whole_file_possible(request.json, &logger)) ||
        (request.csv && !kdr_whole_file_possible(request.csv, &logger)))
        return 1;

    result_list results = {.info = {.width = request.width,
                                    .height = request.height,
                                    .rounds = request.options.rounds,
                                    .build = request.options.build,
                                    .embree = find_embree(&request)}};
    bool good = true;
    if (!results.info.embree && !kdr_bench_wanted(&request.options, "kdray")) {
        say(KDR_LOG_ERROR, "without Embree nothing is left to measure", NULL);
        good = false;
    } else {
        good = measure_all(&request, &results);
    }
    if (results.count > 0) {
        good = (!request.json || kdr_whole_file_write(request.json, write_json, &results, &logger)) && good;
        good = (!request.csv || kdr_whole_file_write(request.csv, write_csv, &results, &logger)) && good;
    }
    kdr_memory_release(results.rows);
    return good ? 0 : 1;
}
