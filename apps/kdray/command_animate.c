/* kdray animate: what moves to numbered pictures, and to a video.
 *
 * One scene serves all frames: its arrays are replaced and its tree is built anew for each, in the memory of the last.
 * A frame's file appears whole or not at all, so whatever stops a run, --resume goes on from there. The figures of the
 * frames that were made are written in any case. */
#include "animate_options.h"
#include "command.h"
#include "frame_log.h"
#include "frame_names.h"
#include "output.h"
#include "report.h"
#include "signals.h"
#include "video.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

#define ENDLESS_FRAMES 100 /* of what never ends, unless more are asked for */
#define VIEW_SAMPLES 32    /* frames that the view is fitted to */

/* All that a run makes; what is not there is NULL. */
typedef struct animating {
    const kdr_animate_options *options;
    kdr_messages *messages;
    kdr_logger logger;
    kdr_progress *progress;
    kdr_animation *animation;
    kdr_device *device;
    kdr_renderer *renderer;
    kdr_mesh *mesh;
    kdr_image *image;
    kdr_picture_def picture;
    kdr_video video;
    kdr_frame_log log;
    uint64_t first, last;
} animating;

static double time_of(const animating *work, uint64_t frame) { return (double)frame / work->options->rate; }

/* ---- before the work */

static bool check_output(animating *work, const char *path, const char *what) {
    if (kdr_output_same(path, work->options->file)) {
        kdr_messages_fail(work->messages, "%s would replace the mesh file %s", what, path);
        return false;
    }
    return kdr_output_check(path, work->messages);
}

/* The name of a frame's picture. False after a sentence. */
static bool name_of(animating *work, uint64_t frame, char name[PATH_MAX]) {
    if (!kdr_frame_name(work->options->output, frame, name)) {
        kdr_messages_fail(work->messages, "%.60s: the name is too long", work->options->output);
        return false;
    }
    return true;
}

/* Frames that are asked for, or all there are. */
static void count_frames(animating *work) {
    const kdr_animate_options *options = work->options;
    work->first = options->first;
    work->last = options->last;
    if (options->frames_given)
        return;
    double duration = kdr_animation_duration(work->animation);
    /* The end is the beginning of the next turn, or nothing. */
    double frames = isfinite(duration) ? ceil(duration * options->rate - 1e-6) : ENDLESS_FRAMES;
    work->first = 0;
    work->last = frames < 1 ? 0 : frames > 1e9 ? 1000000000 : (uint64_t)frames - 1;
}

static bool prepare(animating *work) {
    const kdr_animate_options *options = work->options;
    const char *json = options->tree.json;
    char name[PATH_MAX];
    if (options->video && !kdr_video_check(options->video, work->messages))
        return false;
    if (options->csv && strcmp(options->csv, "-") != 0 && !check_output(work, options->csv, "the CSV"))
        return false;
    if (json && strcmp(json, "-") != 0 && !check_output(work, json, "the JSON"))
        return false;
    if (!kdr_picture_options_prepare(&options->picture, work->messages, &work->picture))
        return false;
    kdr_progress_step(work->progress, "loading");
    kdr_status status = kdr_animation_open(options->file, options->rate, &work->logger, &work->animation);
    if (status != KDR_OK) {
        kdr_messages_fail_status(work->messages, options->file, status);
        return false;
    }
    count_frames(work);
    if (!options->output)
        return true;
    return name_of(work, work->last, name) && check_output(work, name, "a picture") &&
           name_of(work, work->first, name) && check_output(work, name, "a picture");
}

/* ---- the work */

static bool take_sample(animating *work, uint64_t frame) {
    kdr_status status = kdr_animation_sample(work->animation, time_of(work, frame), &work->logger, &work->mesh);
    if (status != KDR_OK)
        kdr_messages_fail_status(work->messages, work->options->file, status);
    return status == KDR_OK;
}

/* One view for all frames: it holds whatever is seen in some of them, spread over all. */
static bool set_view(animating *work) {
    float all[6] = {INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY};
    uint64_t steps = work->last - work->first < VIEW_SAMPLES ? work->last - work->first : VIEW_SAMPLES - 1;
    bool moves = kdr_animation_duration(work->animation) > 0;
    for (uint64_t i = 0; i <= (moves && !work->options->picture.view ? steps : 0); i++) {
        uint64_t frame =
            work->first +
            (steps ? (work->last - work->first) / steps * i + (work->last - work->first) % steps * i / steps : 0);
        if (!take_sample(work, frame))
            return false;
        float bounds[6];
        kdr_mesh_bounds(work->mesh, bounds);
        for (int k = 0; k < 3; k++) {
            all[k] = fminf(all[k], bounds[k]);
            all[k + 3] = fmaxf(all[k + 3], bounds[k + 3]);
        }
    }
    kdr_picture_options_look(&work->options->picture, all, &work->picture);
    return true;
}

/* That a picture was cancelled is told once, with the number of frames. */
static void hear(kdr_log_level level, const char *message, void *user) {
    const kdr_logger *logger = user;
    if (!kdr_signals_cancelled())
        logger->log(level, message, logger->user);
}

static bool follow(uint64_t finished, uint64_t total, void *user) {
    (void)finished;
    (void)total;
    (void)user;
    return !kdr_signals_cancelled();
}

/* True if the picture is there, whole and of the right size; it is then in work->image. */
static bool is_there(animating *work, const char *name) {
    if (!work->options->resume || access(name, F_OK) != 0)
        return false;
    kdr_image *image;
    const kdr_logger silent = {0};
    if (kdr_image_read_png(name, &silent, &image) != KDR_OK)
        return false;
    if (image->width != work->picture.width || image->height != work->picture.height) {
        kdr_image_destroy(image);
        return false;
    }
    kdr_image_destroy(work->image);
    work->image = image;
    return true;
}

static bool render_frame(animating *work, uint64_t frame, const char *name) {
    kdr_frame_figures figures = {.number = frame, .time = time_of(work, frame)};
    kdr_picture_stats stats;
    const kdr_logger logger = {hear, &work->logger};
    double begin = kdr_seconds();
    if (!take_sample(work, frame))
        return false;
    figures.sample_seconds = kdr_seconds() - begin;
    figures.triangles = work->mesh->triangle_count;
    kdr_status status = kdr_renderer_render(work->renderer, work->mesh, &work->picture, &work->options->tree.build,
                                            &logger, &work->image, &stats);
    if (status != KDR_OK) {
        if (!kdr_signals_cancelled())
            kdr_messages_fail_status(work->messages, "the picture was not rendered", status);
        return false;
    }
    figures.build_seconds = stats.build_seconds;
    figures.trace_seconds = stats.trace_seconds;
    figures.primary_rays = stats.primary_rays;
    figures.shadow_rays = stats.shadow_rays;
    begin = kdr_seconds();
    status = work->options->output ? kdr_image_write_png(work->image, name, &work->logger) : KDR_OK;
    figures.write_seconds = kdr_seconds() - begin;
    if (status != KDR_OK) {
        kdr_messages_fail_status(work->messages, name, status);
        return false;
    }
    kdr_frame_log_add(&work->log, &figures);
    return true;
}

static bool run_frames(animating *work) {
    const kdr_animate_options *options = work->options;
    kdr_status status = kdr_renderer_create(work->device, &work->renderer);
    if (status != KDR_OK) {
        kdr_messages_fail_status(work->messages, "no picture was rendered", status);
        return false;
    }
    kdr_signals_defer();
    if (options->video && !kdr_video_open(&work->video, options->video, work->picture.width, work->picture.height,
                                          options->rate, work->messages))
        return false;
    work->picture.progress = follow;
    const uint64_t total = work->last - work->first + 1;
    for (uint64_t frame = work->first; frame <= work->last && !kdr_signals_cancelled(); frame++) {
        kdr_progress_update(work->progress, "frames", frame - work->first, total);
        char name[PATH_MAX] = "";
        if (options->output && !name_of(work, frame, name))
            return false;
        if (is_there(work, name))
            work->log.skipped++;
        else if (!render_frame(work, frame, name))
            break;
        if (options->video && !kdr_video_add(&work->video, work->image, work->messages))
            break;
    }
    kdr_progress_clear(work->progress);
    if (kdr_signals_cancelled() && !work->messages->failed)
        kdr_messages_fail(work->messages, "cancelled after %zu of %" PRIu64 " frames",
                          work->log.count + work->log.skipped, total);
    bool done = !work->messages->failed;
    return kdr_video_close(&work->video, done, work->messages) && done;
}

/* ---- results */

static bool write_json(animating *work) {
    const kdr_animate_options *options = work->options;
    kdr_output output;
    if (!kdr_output_open(&output, options->tree.json, work->messages))
        return false;
    kdr_json json = kdr_json_begin(output.file);
    kdr_json_text(&json, "file", options->file);
    kdr_json_text(&json, "images", options->output);
    kdr_json_text(&json, "video", options->video);
    kdr_json_whole(&json, "first_frame", work->first);
    kdr_json_whole(&json, "last_frame", work->last);
    kdr_json_real(&json, "rate", options->rate);
    kdr_json_whole(&json, "width", work->picture.width);
    kdr_json_whole(&json, "height", work->picture.height);
    kdr_json_whole(&json, "samples", work->picture.samples);
    kdr_json_whole(&json, "threads", kdr_device_worker_count(work->device));
    kdr_json_text(&json, "isa", kdr_isa_name(kdr_device_isa(work->device)));
    kdr_report_plan_json(&json, &options->tree.build);
    kdr_frame_log_json(&work->log, &json);
    kdr_json_end(&json);
    return kdr_output_close(&output, work->messages);
}

/* Also of a run that was stopped: what it made is there, and so are its figures. */
static bool deliver(animating *work) {
    const kdr_animate_options *options = work->options;
    bool done = true;
    if (options->csv)
        done = kdr_frame_log_write_csv(&work->log, options->csv, work->messages);
    if (options->tree.json)
        done = write_json(work) && done;
    if (!options->quiet)
        kdr_frame_log_print(&work->log, work->picture.width, work->picture.height);
    return done;
}

int kdr_command_animate(int argc, char **argv) {
    kdr_animate_options options;
    kdr_animate_options_parse(argc, argv, &options);
    kdr_signals_watch("kdray animate");

    kdr_progress progress = kdr_progress_make(options.quiet);
    kdr_messages messages = {.command = "kdray animate", .quiet = options.quiet, .progress = &progress};
    animating work = {
        .options = &options, .messages = &messages, .logger = kdr_messages_logger(&messages), .progress = &progress};

    bool done = prepare(&work);
    if (done)
        work.device = kdr_tree_options_device(&options.tree, &messages);
    if (done && work.device && set_view(&work)) {
        done = run_frames(&work);
        done = deliver(&work) && done;
    } else {
        done = false;
    }
    kdr_progress_clear(&progress);

    kdr_frame_log_release(&work.log);
    kdr_image_destroy(work.image);
    kdr_renderer_destroy(work.renderer);
    kdr_mesh_destroy(work.mesh);
    kdr_animation_destroy(work.animation);
    kdr_device_destroy(work.device);
    return done ? KDR_EXIT_DONE : KDR_EXIT_FAILED;
}
