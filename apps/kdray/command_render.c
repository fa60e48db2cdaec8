/* kdray render: a mesh file to a picture.
 *
 * Everything that can be found wrong before the work is: options, the view, the reference picture, names that cannot be
 * written. Then load, build and trace, and the results go out in the order picture, JSON, text. */
#include "command.h"
#include "render_options.h"
#include "report.h"
#include "signals.h"

#include <inttypes.h>
#include <string.h>

/* All that a render makes; what is not there is NULL. */
typedef struct rendering {
    const kdr_render_options *options;
    kdr_messages *messages;
    kdr_logger logger;
    kdr_progress *progress;
    kdr_image *reference;
    kdr_device *device;
    kdr_mesh *mesh;
    kdr_image *image;
    kdr_picture_def picture;
    kdr_picture_stats stats;
    double load_seconds;
    double difference; /* from the reference */
} rendering;

/* ---- before the work */

static bool read_reference(rendering *work) {
    const kdr_render_options *options = work->options;
    kdr_status status = kdr_image_read_png(options->compare, &work->logger, &work->reference);
    if (status != KDR_OK) {
        kdr_messages_fail_status(work->messages, options->compare, status);
        return false;
    }
    if (!options->picture.size_given) {
        work->picture.width = work->reference->width;
        work->picture.height = work->reference->height;
    }
    if (work->picture.width == work->reference->width && work->picture.height == work->reference->height)
        return true;
    kdr_messages_fail(work->messages, "%s has %" PRIu32 "x%" PRIu32 " pixels, the picture %" PRIu32 "x%" PRIu32,
                      options->compare, work->reference->width, work->reference->height, work->picture.width,
                      work->picture.height);
    return false;
}

static bool check_output(rendering *work, const char *path, const char *what) {
    if (!path)
        return true;
    if (kdr_output_same(path, work->options->file)) {
        kdr_messages_fail(work->messages, "%s would replace the mesh file %s", what, path);
        return false;
    }
    return kdr_output_check(path, work->messages);
}

static bool prepare(rendering *work) {
    const kdr_render_options *options = work->options;
    const char *json = options->tree.json;
    if (!check_output(work, options->output, "the picture"))
        return false;
    if (json && strcmp(json, "-") != 0 && !check_output(work, json, "the JSON"))
        return false;
    if (!kdr_picture_options_prepare(&options->picture, work->messages, &work->picture))
        return false;
    return !options->compare || read_reference(work);
}

/* ---- the work */

static bool load(rendering *work) {
    kdr_progress_step(work->progress, "loading");
    double begin = kdr_seconds();
    const kdr_render_options *options = work->options;
    kdr_status status = options->time_given ? kdr_mesh_read_at(options->file, options->time, &work->logger, &work->mesh)
                                            : kdr_mesh_read(options->file, &work->logger, &work->mesh);
    work->load_seconds = kdr_seconds() - begin;
    if (status != KDR_OK)
        kdr_messages_fail_status(work->messages, work->options->file, status);
    return status == KDR_OK;
}

static bool follow(uint64_t finished, uint64_t total, void *user) {
    rendering *work = user;
    kdr_signals_defer();
    kdr_progress_update(work->progress, "tracing", finished, total);
    return !kdr_signals_cancelled();
}

static bool render(rendering *work) {
    float bounds[6];
    kdr_mesh_bounds(work->mesh, bounds);
    kdr_picture_options_look(&work->options->picture, bounds, &work->picture);
    work->picture.progress = follow;
    work->picture.progress_user = work;
    kdr_progress_step(work->progress, "building");
    kdr_status status = kdr_picture_render(work->device, work->mesh, &work->picture, &work->options->tree.build,
                                           &work->logger, &work->image, &work->stats);
    kdr_progress_clear(work->progress);
    kdr_signals_defer();
    if (status != KDR_OK)
        kdr_messages_fail_status(work->messages, "the picture was not rendered", status);
    else if (kdr_signals_cancelled())
        kdr_messages_fail(work->messages, "the picture was cancelled");
    return !work->messages->failed;
}

/* ---- results */

static bool write_json(rendering *work) {
    const kdr_render_options *options = work->options;
    const kdr_picture_stats *stats = &work->stats;
    kdr_output output;
    if (!kdr_output_open(&output, options->tree.json, work->messages))
        return false;
    kdr_json json = kdr_json_begin(output.file);
    kdr_json_text(&json, "file", options->file);
    kdr_json_text(&json, "format", work->mesh->format);
    kdr_json_text(&json, "image", options->output);
    kdr_json_whole(&json, "width", work->picture.width);
    kdr_json_whole(&json, "height", work->picture.height);
    kdr_json_whole(&json, "samples", work->picture.samples);
    kdr_json_whole(&json, "triangles", work->mesh->triangle_count);
    kdr_json_whole(&json, "dropped", work->mesh->dropped_count);
    kdr_json_whole(&json, "threads", kdr_device_worker_count(work->device));
    kdr_json_text(&json, "isa", kdr_isa_name(kdr_device_isa(work->device)));
    kdr_report_plan_json(&json, &options->tree.build);
    kdr_json_real(&json, "load_ms", 1e3 * work->load_seconds);
    kdr_json_real(&json, "build_ms", 1e3 * stats->build_seconds);
    kdr_json_real(&json, "trace_ms", 1e3 * stats->trace_seconds);
    kdr_json_whole(&json, "primary_rays", stats->primary_rays);
    kdr_json_whole(&json, "hits", stats->hits);
    kdr_json_whole(&json, "shadow_rays", stats->shadow_rays);
    kdr_json_whole(&json, "occluded", stats->occluded);
    if (options->compare) {
        kdr_json_real(&json, "difference", work->difference);
        kdr_json_real(&json, "threshold", options->threshold);
    }
    kdr_report_tree_json(&json, &stats->tree);
    kdr_json_end(&json);
    return kdr_output_close(&output, work->messages);
}

static void print_summary(const rendering *work) {
    const kdr_picture_stats *stats = &work->stats;
    double rays = (double)stats->primary_rays + (double)stats->shadow_rays;
    double speed = stats->trace_seconds > 0 ? rays / stats->trace_seconds * 1e-6 : 0;
    fprintf(stderr,
            "%zu triangle%s, %" PRIu32 "x%" PRIu32 " pixels: load %.1f ms, build %.1f ms, trace %.1f ms, %.2f Mray/s\n",
            work->mesh->triangle_count, work->mesh->triangle_count == 1 ? "" : "s", work->picture.width,
            work->picture.height, 1e3 * work->load_seconds, 1e3 * stats->build_seconds, 1e3 * stats->trace_seconds,
            speed);
}

static void print_stats(FILE *file, const rendering *work) {
    const kdr_picture_stats *stats = &work->stats;
    fprintf(file, "rays\n");
    fprintf(file, "  primary       %" PRIu64 "\n", stats->primary_rays);
    fprintf(file, "  hits          %" PRIu64 "\n", stats->hits);
    fprintf(file, "  shadow        %" PRIu64 "\n", stats->shadow_rays);
    fprintf(file, "  occluded      %" PRIu64 "\n", stats->occluded);
    fprintf(file, "time\n");
    fprintf(file, "  load          %.1f ms\n", 1e3 * work->load_seconds);
    fprintf(file, "  build         %.1f ms\n", 1e3 * stats->build_seconds);
    fprintf(file, "  trace         %.1f ms\n", 1e3 * stats->trace_seconds);
    kdr_report_tree(file, &stats->tree);
}

static bool deliver(rendering *work) {
    const kdr_render_options *options = work->options;
    // Where stdout carries the JSON, what is for people goes to stderr.
    FILE *text = options->tree.json && strcmp(options->tree.json, "-") == 0 ? stderr : stdout;

    kdr_status status = KDR_OK;
    if (options->compare)
        status = kdr_image_compare(work->image, work->reference, &work->difference);
    if (status == KDR_OK && options->output)
        status = kdr_image_write_png(work->image, options->output, &work->logger);
    if (status != KDR_OK) {
        kdr_messages_fail_status(work->messages, "the picture was not written", status);
        return false;
    }
    if (options->tree.json && !write_json(work))
        return false;
    if (!options->quiet)
        print_summary(work);
    if (options->stats)
        print_stats(text, work);
    if (options->compare) {
        fprintf(text, "difference %.6f\n", work->difference);
        if (!(work->difference <= options->threshold)) {
            kdr_messages_fail(work->messages, "the picture differs from %s by %.6f, more than the threshold %g",
                              options->compare, work->difference, options->threshold);
            return false;
        }
    }
    return true;
}

int kdr_command_render(int argc, char **argv) {
    kdr_render_options options;
    kdr_render_options_parse(argc, argv, &options);
    kdr_signals_watch("kdray render");

    kdr_progress progress = kdr_progress_make(options.quiet);
    kdr_messages messages = {.command = "kdray render", .quiet = options.quiet, .progress = &progress};
    rendering work = {
        .options = &options, .messages = &messages, .logger = kdr_messages_logger(&messages), .progress = &progress};

    bool done = prepare(&work);
    if (done)
        work.device = kdr_tree_options_device(&options.tree, &messages);
    done = done && work.device && load(&work) && render(&work) && deliver(&work);
    kdr_progress_clear(&progress);

    kdr_image_destroy(work.image);
    kdr_mesh_destroy(work.mesh);
    kdr_device_destroy(work.device);
    kdr_image_destroy(work.reference);
    return done ? KDR_EXIT_DONE : KDR_EXIT_FAILED;
}
