/* kdray info: what a mesh and its tree are made of. */
#include "command.h"
#include "option_numbers.h"
#include "output.h"
#include "report.h"
#include "scene_view.h"
#include "signals.h"
#include "slice.h"
#include "trace_counts.h"
#include "tree_options.h"

#include <inttypes.h>
#include <string.h>
#include <unistd.h>

enum { SCENES = 0x100, PLANS, SLICE, TRACE };

typedef struct info_options {
    const char *file;
    bool scenes, plans, trace, quiet;
    const char *output; /* of the slice; NULL: there is none */
    bool sliced;
    kdr_slice slice;
    kdr_tree_options tree;
} info_options;

static const struct argp_option option_list[] = {
    {"scenes", SCENES, NULL, 0, "List the built-in scenes", 1},
    {"plans", PLANS, NULL, 0, "List the keys of a plan with their values and defaults", 1},
    {"slice", SLICE, "AXIS=POSITION", 0,
     "Draw the cells of the tree that a plane cuts: x, y or z, and a coordinate or a percentage of the box, such as "
     "z=50%",
     2},
    {"output", 'o', "FILE", 0, "Write that drawing to this SVG file; - is stdout", 2},
    {"trace", TRACE, NULL, 0,
     "Count what the rays of a picture of 256x256 pixels cost in every traversal, or in that of the plan; only in a "
     "build that counts",
     3},
    {"quiet", 'q', NULL, 0, "No warnings and no progress", 10},
    {0},
};

static const char description[] =
    "Print what a mesh and its tree are made of.\v"
    "FILE is a mesh file (PLY, OBJ, STL and others, also gzipped) or "
    "builtin:NAME[:TRIANGLES[:TIME]], a built-in scene.\n\n"
    "A slice is 800 pixels wide or high. Leaves are coloured by depth, empty ones are "
    "outlined, and the triangles that the plane cuts are drawn in red. Cells narrower "
    "than half a pixel or smaller than a pixel, and where there are more than 6000 "
    "rectangles the smallest ones, are drawn together, in the colour of their mean depth; "
    "of more than 6000 triangles the longest cuts are drawn.\n\n"
    "Exit status: 0 done, 1 failed, 2 wrong usage.";

static bool is_stdout(const char *path) { return path && strcmp(path, "-") == 0; }

static bool is_same_output(const char *a, const char *b) {
    return is_stdout(a) || is_stdout(b) ? is_stdout(a) && is_stdout(b) : kdr_output_same(a, b);
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
    info_options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT: state->child_inputs[0] = &options->tree; break;
    case SCENES: options->scenes = true; break;
    case PLANS: options->plans = true; break;
    case TRACE: options->trace = true; break;
    case SLICE:
        kdr_option_position(state, "--slice", text, &options->slice.axis, &options->slice.position,
                            &options->slice.percent);
        options->sliced = true;
        break;
    case 'o': options->output = text; break;
    case 'q': options->quiet = true; break;
    case ARGP_KEY_ARG:
        if (options->file)
            argp_error(state, "expected one mesh file, found \"%.40s\" as well", text);
        options->file = text;
        break;
    case ARGP_KEY_END:
        if (options->sliced && !options->output)
            argp_error(state, "--slice: expected -o FILE as well, for the drawing");
        if (options->output && !options->sliced)
            argp_error(state, "-o: expected --slice AXIS=POSITION as well, the drawing that it names a file for");
        if (options->output && options->tree.json && is_same_output(options->output, options->tree.json))
            argp_error(state, "-o and --json: expected two files, found \"%.40s\" twice", options->output);
        if (!options->file && !options->scenes && !options->plans)
            argp_error(state, "expected a mesh file or builtin:NAME");
        if (options->trace && (options->scenes || options->plans))
            argp_error(state, "--trace: expected a mesh file, found %s", options->scenes ? "--scenes" : "--plans");
        if (options->scenes && options->plans)
            argp_error(state, "expected --scenes or --plans, found both");
        if (options->file && (options->scenes || options->plans))
            argp_error(state, "%s: expected no mesh file, found \"%.40s\"", options->scenes ? "--scenes" : "--plans",
                       options->file);
        break;
    default: return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

static void list_scenes(void) {
    const char *name;
    for (size_t i = 0; (name = kdr_mesh_builtin_name(i)) != NULL; i++)
        printf("%-12s %s\n", name, kdr_mesh_builtin_text(i));
}

static void list_plans(void) {
    const char *name;
    for (size_t i = 0; (name = kdr_build_def_key_name(i)) != NULL; i++)
        printf("%-18s %s\n", name, kdr_build_def_key_text(i));
}

/* All that is made on the way; what is not there is NULL. */
typedef struct inspection {
    const info_options *options;
    kdr_messages *messages;
    kdr_logger logger;
    kdr_progress *progress;
    kdr_device *device;
    kdr_mesh *mesh;
    kdr_scene *scene;
    kdr_tree_stats stats;
    kdr_trace_sheet trace;
    double load_seconds;
    float bounds[6];
} inspection;

static bool check_output(inspection *work, const char *what, const char *path) {
    if (!path || is_stdout(path))
        return true;
    if (kdr_output_same(path, work->options->file)) {
        kdr_messages_fail(work->messages, "the %s would replace the mesh file %s", what, path);
        return false;
    }
    return kdr_output_check(path, work->messages);
}

static bool prepare(inspection *work) {
    if (!check_output(work, "JSON", work->options->tree.json) || !check_output(work, "drawing", work->options->output))
        return false;
    if (work->options->trace && !kdr_trace_can_count()) {
        kdr_messages_fail(work->messages, "--trace: expected a build that counts (cmake -DKDRAY_COUNTING=ON, or ./run "
                                          "counts FILE), found one that does not");
        return false;
    }
    work->device = kdr_tree_options_device(&work->options->tree, work->messages);
    return work->device;
}

static bool load(inspection *work) {
    kdr_progress_step(work->progress, "loading");
    double begin = kdr_seconds();
    kdr_status status = kdr_mesh_read(work->options->file, &work->logger, &work->mesh);
    work->load_seconds = kdr_seconds() - begin;
    if (status != KDR_OK) {
        kdr_messages_fail_status(work->messages, work->options->file, status);
        return false;
    }
    kdr_mesh_bounds(work->mesh, work->bounds);
    return true;
}

static bool build(inspection *work) {
    kdr_progress_step(work->progress, "building");
    kdr_triangles_def def = kdr_default_triangles_def();
    def.vertices = work->mesh->positions;
    def.vertex_count = work->mesh->vertex_count;
    def.indices = work->mesh->indices;
    def.triangle_count = work->mesh->triangle_count;
    kdr_status status = kdr_scene_create(work->device, &work->scene);
    if (status == KDR_OK)
        status = kdr_scene_add_triangles(work->scene, &def, NULL);
    if (status == KDR_OK)
        status = kdr_scene_commit(work->scene, &work->options->tree.build);
    if (status == KDR_OK)
        status = kdr_scene_stats(work->scene, &work->stats);
    if (status != KDR_OK)
        kdr_messages_fail_status(work->messages, "the tree was not built", status);
    return status == KDR_OK;
}

static bool count(inspection *work) {
    if (!work->options->trace)
        return true;
    kdr_progress_step(work->progress, "counting");
    kdr_bench_scene scene = {.mesh = work->mesh, .width = KDR_TRACE_SIDE, .height = KDR_TRACE_SIDE};
    scene.device = work->device;
    return kdr_scene_view(work->options->file, &scene, work->messages, &work->logger) &&
           kdr_trace_sheet_make(&scene, &work->options->tree.build, &work->logger, &work->trace);
}

/* ---- results */

static void print_mesh(const inspection *work) {
    const kdr_mesh *mesh = work->mesh;
    const float *bounds = work->bounds;
    printf("mesh\n");
    printf("  format        %s\n", mesh->format);
    printf("  vertices      %zu\n", mesh->vertex_count);
    printf("  triangles     %zu\n", mesh->triangle_count);
    printf("  materials     %zu\n", mesh->material_count);
    printf("  normals       %s\n", mesh->normals ? "one a vertex" : "none");
    if (bounds[0] <= bounds[3])
        printf("  bounds        %g %g %g to %g %g %g\n", (double)bounds[0], (double)bounds[1], (double)bounds[2],
               (double)bounds[3], (double)bounds[4], (double)bounds[5]);
    else
        printf("  bounds        none\n");
    printf("  dropped       %zu (%zu vertices are not finite)\n", mesh->dropped_count, mesh->dropped_vertex_count);
    printf("  degenerate    %" PRIu64 "\n", work->stats.degenerate_count);
    printf("  load          %.1f ms\n", 1e3 * work->load_seconds);
}

static void put_materials(kdr_json *json, const kdr_mesh *mesh) {
    kdr_json_array(json, "materials");
    for (size_t i = 0; i < mesh->material_count; i++) {
        kdr_json_object(json, NULL);
        kdr_json_text(json, "name", mesh->materials[i].name);
        kdr_json_floats(json, "diffuse", mesh->materials[i].diffuse, 3);
        kdr_json_close(json, '}');
    }
    kdr_json_close(json, ']');
}

static bool write_json(inspection *work) {
    const kdr_mesh *mesh = work->mesh;
    kdr_output output;
    if (!kdr_output_open(&output, work->options->tree.json, work->messages))
        return false;
    kdr_json json = kdr_json_begin(output.file);
    kdr_json_text(&json, "file", work->options->file);
    kdr_json_text(&json, "format", mesh->format);
    kdr_json_whole(&json, "vertices", mesh->vertex_count);
    kdr_json_whole(&json, "triangles", mesh->triangle_count);
    kdr_json_whole(&json, "dropped", mesh->dropped_count);
    kdr_json_whole(&json, "dropped_vertices", mesh->dropped_vertex_count);
    kdr_json_whole(&json, "degenerate", work->stats.degenerate_count);
    kdr_json_floats(&json, "bounds", work->bounds, 6);
    put_materials(&json, mesh);
    kdr_json_whole(&json, "threads", kdr_device_worker_count(work->device));
    kdr_json_text(&json, "isa", kdr_isa_name(kdr_device_isa(work->device)));
    kdr_report_plan_json(&json, &work->options->tree.build);
    kdr_json_real(&json, "load_ms", 1e3 * work->load_seconds);
    kdr_json_real(&json, "build_ms", 1e3 * work->stats.build_seconds);
    kdr_report_tree_json(&json, &work->stats);
    if (work->options->trace)
        kdr_trace_sheet_json(&work->trace, &json);
    kdr_json_end(&json);
    return kdr_output_close(&output, work->messages);
}

static bool write_slice(inspection *work) {
    char text[256], plan[KDR_PLAN_TEXT_SIZE] = "";
    const info_options *options = work->options;
    kdr_slice_sheet sheet;
    const char *problem = kdr_slice_cut(&options->slice, work->scene, work->mesh, &sheet, text, sizeof text);
    if (problem) {
        kdr_messages_fail(work->messages, "%s", problem);
        return false;
    }
    kdr_build_def_print(&options->tree.build, plan, sizeof plan);
    kdr_slice_legend legend = {options->file, plan, &work->stats};
    kdr_output output;
    bool done = kdr_output_open(&output, options->output, work->messages);
    if (done) {
        kdr_slice_draw(output.file, &sheet, &legend);
        done = kdr_output_close(&output, work->messages);
    }
    kdr_slice_release(&sheet);
    return done;
}

static bool deliver(inspection *work) {
    kdr_signals_defer();
    const char *json = work->options->tree.json, *drawing = work->options->output;
    if (drawing && !write_slice(work))
        return false;
    if (json && !write_json(work))
        return false;
    // Where stdout carries a file, it carries nothing else.
    if (is_stdout(json) || is_stdout(drawing))
        return true;
    print_mesh(work);
    kdr_report_tree(stdout, &work->stats);
    if (work->options->trace)
        kdr_trace_sheet_print(&work->trace, stdout);
    else
        kdr_report_histograms(stdout, &work->stats, kdr_terminal_columns(STDOUT_FILENO));
    return true;
}

int kdr_command_info(int argc, char **argv) {
    info_options options = {.tree = kdr_default_tree_options()};
    const struct argp_child children[] = {{&kdr_tree_argp, 0, NULL, 0}, {0}};
    const struct argp parser = {.options = option_list,
                                .parser = parse_option,
                                .args_doc = "FILE\n--scenes\n--plans",
                                .doc = description,
                                .children = children};
    argp_parse(&parser, argc, argv, 0, NULL, &options);
    if (options.scenes) {
        list_scenes();
        return KDR_EXIT_DONE;
    }
    if (options.plans) {
        list_plans();
        return KDR_EXIT_DONE;
    }
    kdr_signals_watch("kdray info");

    kdr_progress progress = kdr_progress_make(options.quiet);
    kdr_messages messages = {.command = "kdray info", .quiet = options.quiet, .progress = &progress};
    inspection work = {
        .options = &options, .messages = &messages, .logger = kdr_messages_logger(&messages), .progress = &progress};
    bool done = prepare(&work) && load(&work) && build(&work) && count(&work);
    kdr_progress_clear(&progress);
    done = done && deliver(&work);

    kdr_scene_destroy(work.scene);
    kdr_mesh_destroy(work.mesh);
    kdr_device_destroy(work.device);
    return done ? KDR_EXIT_DONE : KDR_EXIT_FAILED;
}
