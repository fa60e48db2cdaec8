/* kdray bench: its options, the scenes one after the other, and where the results go. */
#include "command.h"

#include "bench.h"
#include "memory.h"
#include "option_numbers.h"
#include "output.h"
#include "scene_view.h"
#include "signals.h"
#include "tree_options.h"

#include <glob.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define ROUND_LIMIT 1000u
#define SIDE_LIMIT 16384u
#define FRAME_LIMIT 10000u

/* What is measured where neither files nor a folder are named: a small scene and one of medium size. */
static const char *const default_scenes[] = {"builtin:knot:70000", "builtin:city:500000"};
static const char *const default_moving_scenes[] = {"builtin:explode:202000", "builtin:twist:202000",
                                                    "builtin:wave:202000"};
#define SCENES(list) (sizeof(list) / sizeof(list[0]))

typedef struct bench_request {
    kdr_bench_options bench; /* but for the constants of the build, which tree has */
    kdr_tree_options tree;
    uint32_t width, height;
    const char *csv;
    bool quiet;
    char **files; /* none: those of a folder, or the default scenes */
    size_t file_count;
} bench_request;

/* ---- options */

enum { ROUNDS = 0x100, FRAMES, ONLY, CSV, QUIET };

static const struct argp_option option_list[] = {
    {"resolution", 'r', "WxH", 0, "Pixels whose rays are traced (default: 1024x1024)", 1},
    {"rounds", ROUNDS, "N", 0, "How often everything is measured; medians count (default: 5)", 1},
    {"frames", FRAMES, "N", 0,
     "Measure N frames of what moves, each built and traced anew, primary and shadow rays: the first second of a "
     "built-in scene, the whole of an animation or a sequence such as walk_####.ply",
     1},
    {"only", ONLY, "TRACER", 0,
     "Measure tracers whose names begin so: kdray, embree, embree/medium, embree/low/packet, ...; repeatable", 1},
    {"csv", CSV, "FILE", 0, "Write every figure as comma separated values; - is stdout", 10},
    {"quiet", QUIET, NULL, 0, "No table, no warnings and no progress", 10},
    {0},
};

static const char description[] =
    "Measure kdray, and Embree where it is installed, on the same rays in the same run.\v"
    "FILE is a mesh file, with a view of it in a .cam file beside it where there is one, or "
    "builtin:NAME[:TRIANGLES[:TIME]], a built-in scene. Without FILE: every .ply file of the folder KDRAY_SCENES, or "
    "two built-in scenes; with --frames three that move. Speeds are in million rays a second; an image takes build, "
    "primary and shadow rays.\n\n"
    "Environment: KDRAY_SCENES, a folder of meshes; KDRAY_EMBREE, the Embree library to load.\n\n"
    "Exit status: 0 done, 1 failed, 2 wrong usage.";

static void add_only(kdr_bench_options *bench, const char *text, struct argp_state *state) {
    if (bench->only_count == KDR_BENCH_ONLY_LIMIT)
        argp_error(state, "--only: expected at most %u", KDR_BENCH_ONLY_LIMIT);
    if (!kdr_bench_known(text))
        argp_error(state,
                   "--only: expected the beginning of kdray/stream, kdray/packet, kdray/single, embree/low/packet, "
                   "embree/low/single, or those of embree/medium and embree/high, found \"%.40s\"",
                   text);
    bench->only[bench->only_count++] = text;
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
    bench_request *request = state->input;
    switch (key) {
    case ARGP_KEY_INIT: state->child_inputs[0] = &request->tree; break;
    case 'r': kdr_option_size(state, "--resolution", text, SIDE_LIMIT, &request->width, &request->height); break;
    case ROUNDS: request->bench.rounds = (uint32_t)kdr_option_whole(state, "--rounds", text, 1, ROUND_LIMIT); break;
    case FRAMES: request->bench.frames = (uint32_t)kdr_option_whole(state, "--frames", text, 1, FRAME_LIMIT); break;
    case ONLY: add_only(&request->bench, text, state); break;
    case CSV: request->csv = text; break;
    case QUIET: request->quiet = true; break;
    case ARGP_KEY_ARGS:
        request->files = state->argv + state->next;
        request->file_count = (size_t)(state->argc - state->next);
        break;
    case ARGP_KEY_END:
        if (request->csv && request->tree.json && kdr_output_same(request->csv, request->tree.json))
            argp_error(state, "--csv and --json: expected two files, found \"%.40s\" twice", request->csv);
        break;
    default: return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

/* ---- one scene */

/* A run over all scenes: the rows so far, and what they have in common. */
typedef struct bench_run {
    const bench_request *request;
    kdr_messages *messages;
    kdr_logger logger;
    kdr_progress *progress;
    kdr_bench_row *rows;
    size_t count, room;
    kdr_bench_run_info info;
    bool silent; /* no table: quiet, or stdout carries a file */
} bench_run;

static void add_rows(bench_run *run, const kdr_bench_row *rows, uint32_t count) {
    if (run->count + count > run->room) {
        run->room = 2 * run->room + KDR_BENCH_ROW_LIMIT;
        kdr_bench_row *larger = kdr_memory_get(run->room, sizeof(*larger));
        if (run->count)
            memcpy(larger, run->rows, run->count * sizeof(*larger));
        kdr_memory_release(run->rows);
        run->rows = larger;
    }
    memcpy(run->rows + run->count, rows, count * sizeof(*rows));
    run->count += count;
}

static bool measure_scene(bench_run *run, const char *path, kdr_bench_scene *of) {
    const bench_request *request = run->request;
    kdr_bench_scene scene = *of;
    kdr_scene_name(path, scene.name);
    if (scene.mesh->triangle_count == 0) {
        kdr_messages_fail(run->messages, "%s: there are no triangles to measure", path);
        return false;
    }
    if (!kdr_scene_view(path, &scene, run->messages, &run->logger))
        return false;
    scene.device = kdr_tree_options_device(&request->tree, run->messages);
    if (!scene.device)
        return false;
    run->info.threads = kdr_device_worker_count(scene.device);
    run->info.isa = kdr_device_isa(scene.device);

    kdr_bench_row rows[KDR_BENCH_ROW_LIMIT];
    uint32_t count = 0;
    bool done = kdr_bench_measure(&scene, &request->bench, run->info.embree, &run->logger, run->progress, rows, &count);
    kdr_progress_clear(run->progress);
    kdr_device_destroy(scene.device);
    of->mesh = scene.mesh;
    if (!done) {
        kdr_messages_fail(run->messages, "%s: the measurement failed", path);
        return false;
    }
    if (!run->silent) {
        size_t triangles = scene.mesh->triangle_count;
        uint32_t frames = request->bench.frames;
        printf("%s: %zu triangle%s, ", scene.name, triangles, triangles == 1 ? "" : "s");
        if (frames > 0)
            printf("%u frame%s, ", frames, frames == 1 ? "" : "s");
        printf("%ux%u pixels, %u thread%s, %s, medians of %u round%s\n\n", scene.width, scene.height, run->info.threads,
               run->info.threads == 1 ? "" : "s", kdr_isa_name(run->info.isa), request->bench.rounds,
               request->bench.rounds == 1 ? "" : "s");
        kdr_bench_print(stdout, rows, count);
        fflush(stdout);
    }
    add_rows(run, rows, count);
    return true;
}

#define SEQUENCE_RATE 25.0  /* files a second; only how far frames lie apart, not what they are, depends on it */
#define ENDLESS_SECONDS 1.0 /* of what never ends */

/* The mesh, or the first frame of what moves. */
static kdr_status load(bench_run *run, const char *path, kdr_bench_scene *scene) {
    uint32_t frames = run->request->bench.frames;
    if (frames == 0) {
        kdr_status read = kdr_mesh_read(path, &run->logger, &scene->mesh);
        if (read == KDR_OK)
            kdr_mesh_bounds(scene->mesh, scene->bounds);
        return read;
    }
    kdr_status status = kdr_animation_open(path, SEQUENCE_RATE, &run->logger, &scene->animation);
    if (status != KDR_OK)
        return status;
    double duration = kdr_animation_duration(scene->animation);
    scene->frame_seconds = (isfinite(duration) ? duration : ENDLESS_SECONDS) / frames;

    /* All frames are looked at from one place. */
    for (uint32_t i = frames; i > 0 && status == KDR_OK; i--) {
        float bounds[6];
        status = kdr_animation_sample(scene->animation, (i - 1) * scene->frame_seconds, &run->logger, &scene->mesh);
        if (status != KDR_OK)
            break;
        kdr_mesh_bounds(scene->mesh, bounds);
        for (int k = 0; k < 3; k++) {
            scene->bounds[k] = i == frames ? bounds[k] : fminf(scene->bounds[k], bounds[k]);
            scene->bounds[k + 3] = i == frames ? bounds[k + 3] : fmaxf(scene->bounds[k + 3], bounds[k + 3]);
        }
    }
    return status;
}

static bool measure_file(bench_run *run, const char *path) {
    run->messages->failed = false; /* each scene may tell what is wrong with it */
    *run->progress = kdr_progress_make(run->request->quiet);
    kdr_progress_step(run->progress, "loading");
    kdr_bench_scene scene = {.width = run->request->width, .height = run->request->height};
    kdr_status status = load(run, path, &scene);
    bool done = status == KDR_OK && measure_scene(run, path, &scene);
    if (status != KDR_OK)
        kdr_messages_fail_status(run->messages, path, status);
    kdr_mesh_destroy(scene.mesh);
    kdr_animation_destroy(scene.animation);
    return done;
}

/* ---- all scenes */

/* One that fails does not stop the others. */
static bool measure_list(bench_run *run, const char *const *paths, size_t count) {
    bool done = true;
    for (size_t i = 0; i < count; i++)
        done = measure_file(run, paths[i]) && done;
    return done;
}

/* The pattern of all .ply files in a folder, whose name may hold characters that mean something in patterns. */
static char *pattern_of(const char *folder) {
    static const char ending[] = "/*.ply";
    char *pattern = kdr_memory_get(2 * strlen(folder) + sizeof(ending), 1);
    char *end = pattern;
    for (const char *c = folder; *c; c++) {
        if (strchr("*?[\\", *c))
            *end++ = '\\';
        *end++ = *c;
    }
    memcpy(end, ending, sizeof(ending));
    return pattern;
}

/* The files named, those of the folder KDRAY_SCENES, or the default scenes. */
static bool measure_all(bench_run *run) {
    const bench_request *request = run->request;
    if (request->file_count)
        return measure_list(run, (const char *const *)request->files, request->file_count);
    const char *folder = getenv("KDRAY_SCENES");
    if (request->bench.frames > 0)
        return measure_list(run, default_moving_scenes, SCENES(default_moving_scenes));
    if (!folder || !*folder)
        return measure_list(run, default_scenes, SCENES(default_scenes));

    glob_t found;
    char *pattern = pattern_of(folder);
    int failed = glob(pattern, 0, NULL, &found);
    kdr_memory_release(pattern);
    if (failed) {
        kdr_messages_fail(run->messages, "KDRAY_SCENES: there is no .ply file in %s", folder);
        return false;
    }
    bool done = measure_list(run, (const char *const *)found.gl_pathv, found.gl_pathc);
    globfree(&found);
    return done;
}

/* ---- results */

static bool is_stdout(const char *path) { return path && strcmp(path, "-") == 0; }

/* Before the work: files can be written, and there is something to measure. */
static bool prepare(bench_run *run) {
    const bench_request *request = run->request;
    const char *const outputs[] = {request->tree.json, request->csv};
    for (int i = 0; i < 2; i++) {
        if (!outputs[i] || is_stdout(outputs[i]))
            continue;
        for (size_t k = 0; k < request->file_count; k++) {
            if (kdr_output_same(outputs[i], request->files[k])) {
                kdr_messages_fail(run->messages, "the results would replace the mesh file %s", outputs[i]);
                return false;
            }
        }
        if (!kdr_output_check(outputs[i], run->messages))
            return false;
    }

    if (!kdr_bench_wanted(&request->bench, "embree"))
        return true;
    const char *why = NULL;
    run->info.embree = kdr_bench_embree_version(&why);
    if (run->info.embree)
        return true;
    if (!kdr_bench_wanted(&request->bench, "kdray")) {
        kdr_messages_fail(run->messages, "%s, so nothing is left to measure", why);
        return false;
    }
    char sentence[256];
    snprintf(sentence, sizeof(sentence), "%s: kdray is measured alone", why);
    run->logger.log(KDR_LOG_WARNING, sentence, run->logger.user);
    return true;
}

static bool write_results(bench_run *run, const char *path) {
    kdr_output output;
    if (!path)
        return true;
    if (!kdr_output_open(&output, path, run->messages))
        return false;
    if (path == run->request->csv)
        kdr_bench_write_csv(output.file, &run->info, run->rows, run->count);
    else
        kdr_bench_write_json(output.file, &run->info, run->rows, run->count);
    return kdr_output_close(&output, run->messages);
}

int kdr_command_bench(int argc, char **argv) {
    bench_request request = {.bench = {.rounds = 5}, .tree = kdr_default_tree_options(), .width = 1024, .height = 1024};
    const struct argp_child children[] = {{&kdr_tree_argp, 0, NULL, 0}, {0}};
    const struct argp parser = {.options = option_list,
                                .parser = parse_option,
                                .args_doc = "[FILE...]",
                                .doc = description,
                                .children = children};
    argp_parse(&parser, argc, argv, 0, NULL, &request);
    request.bench.build = request.tree.build;
    kdr_signals_watch("kdray bench");

    kdr_progress progress = kdr_progress_make(request.quiet);
    kdr_messages messages = {.command = "kdray bench", .quiet = request.quiet, .progress = &progress};
    bench_run run = {.request = &request,
                     .messages = &messages,
                     .logger = kdr_messages_logger(&messages),
                     .progress = &progress,
                     .info = {.width = request.width,
                              .height = request.height,
                              .rounds = request.bench.rounds,
                              .frames = request.bench.frames,
                              .build = request.bench.build},
                     .silent = request.quiet || is_stdout(request.tree.json) || is_stdout(request.csv)};
    bool done = prepare(&run) && measure_all(&run);
    if (run.count > 0) {
        kdr_signals_defer();
        messages.failed = false;
        done = write_results(&run, request.tree.json) && done;
        done = write_results(&run, request.csv) && done;
    }
    kdr_memory_release(run.rows);
    return done ? KDR_EXIT_DONE : KDR_EXIT_FAILED;
}
