/* kdray view: a window on a mesh, still or moving.
 *
 * A frame hears what hands did, goes to the moment that is wanted, builds the tree anew if the mesh or the plan is
 * another one, and traces as finely as there is time for. What rests becomes finer until it is fine enough; then
 * nothing is done until something happens. */
#include "command.h"
#include "json.h"
#include "memory.h"
#include "output.h"
#include "report.h"
#include "signals.h"
#include "view_camera.h"
#include "view_frame.h"
#include "view_input.h"
#include "view_options.h"
#include "view_plans.h"

#include <math.h>
#include <string.h>

#define SHORTEST_FRAME 0.008 /* seconds: faster than any screen */
#define LONGEST_STEP 0.25    /* seconds that what plays goes on by in one frame */
#define REST 0.2             /* seconds between two looks for a signal */

/* ---- before the work */

static bool check_output(const kdr_view_options *options, const char *path, const char *what, kdr_messages *messages) {
    if (!path || strcmp(path, "-") == 0)
        return true;
    if (kdr_output_same(path, options->file)) {
        kdr_messages_fail(messages, "%s would replace the mesh file %s", what, path);
        return false;
    }
    return kdr_output_check(path, messages);
}

static bool open_view(kdr_viewing *view, const kdr_view_options *options, kdr_messages *messages) {
    if (!check_output(options, options->screenshot, "the screenshot", messages) ||
        !check_output(options, options->tree.json, "the JSON", messages) ||
        !kdr_picture_options_prepare(&options->picture, messages, &view->look) || !kdr_window_prepare(messages))
        return false;
    kdr_progress_step(messages->progress, "loading");
    float bounds[6];
    if (!kdr_view_stage_open(&view->stage, options, messages))
        return false;
    double duration = view->stage.duration;
    const char *slash = strrchr(options->file, '/');
    view->clock = (kdr_view_clock){.duration = duration,
                                   .rate = options->rate,
                                   .by_frames = strchr(slash ? slash : options->file, '#') != NULL,
                                   .playing = duration > 0 && !options->paused};
    if (!kdr_view_stage_bounds(&view->stage, isfinite(duration) ? duration : KDR_CLOCK_PAGE, bounds))
        return false;
    kdr_picture_options_look(&options->picture, bounds, &view->look);
    kdr_camera_frame frame;
    view->home = view->look.camera;
    if (!kdr_camera_frame_make(&view->home, &frame)) {
        kdr_messages_fail(messages, "the camera looks nowhere: eye, target and up are in one line");
        return false;
    }
    kdr_progress_clear(messages->progress);
    kdr_signals_defer();
    char title[256];
    snprintf(title, sizeof title, "kdray %.200s", options->file);
    view->window = kdr_window_open(title, options->picture.width, options->picture.height, messages);
    return view->window != NULL;
}

/* ---- the work */

/* Hears all that has happened; waits for it as long. */
static void hear(kdr_viewing *view, double wait) {
    kdr_window_event event = kdr_window_next(view->window, wait);
    while (event.news != KDR_NEWS_NONE && !view->quit) {
        kdr_view_input_take(view, &event);
        if (view->shot || view->shot_all) {
            // What comes behind the key is not in the picture.
            kdr_view_frame_shoot(view, view->shot_all);
            view->shot = view->shot_all = false;
        }
        event = kdr_window_next(view->window, 0);
    }
}

static bool run(kdr_viewing *view, const kdr_view_options *options) {
    double last = kdr_seconds();
    bool rests = false, done = true;
    while (done && !view->quit && !kdr_signals_cancelled()) {
        double left = SHORTEST_FRAME - (kdr_seconds() - last);
        bool waits = rests && !view->clock.playing && options->frames == 0;
        hear(view, waits ? REST : fmax(left, 0));
        double now = kdr_seconds(), step = fmin(now - last, LONGEST_STEP);
        last = now;
        kdr_view_input_fly(view, step);
        kdr_view_clock_advance(&view->clock, step);
        view->redraw = view->redraw || options->frames > 0;
        done = !view->stage.messages->failed && kdr_view_frame_show(view, &rests);
        view->quit = view->quit || (options->frames > 0 && view->frames >= options->frames);
    }
    if (done && kdr_signals_cancelled())
        kdr_messages_fail(view->stage.messages, "cancelled");
    if (done && !kdr_signals_cancelled() && options->screenshot) {
        done = kdr_view_frame_write(view, options->screenshot, false, &view->stage.logger);
        if (!done)
            kdr_messages_fail_status(view->stage.messages, options->screenshot, KDR_ERROR_IO);
    }
    return done && !kdr_signals_cancelled();
}

/* ---- results */

static double mean(double sum, uint64_t count) { return count > 0 ? sum / (double)count : 0; }

/* Frames a second, of those that followed another one without rest. */
static double speed(const kdr_viewing *view) {
    return view->busy_seconds > 0 ? (double)view->busy / view->busy_seconds : 0;
}

static bool write_json(const kdr_viewing *view, const kdr_view_options *options) {
    kdr_output output;
    if (!kdr_output_open(&output, options->tree.json, view->stage.messages))
        return false;
    kdr_json json = kdr_json_begin(output.file);
    kdr_json_text(&json, "file", options->file);
    kdr_json_whole(&json, "width", (uint64_t)view->canvas.width);
    kdr_json_whole(&json, "height", (uint64_t)view->canvas.height);
    kdr_json_whole(&json, "triangles", view->stage.mesh->triangle_count);
    kdr_json_whole(&json, "threads", kdr_device_worker_count(view->stage.device));
    kdr_json_text(&json, "isa", kdr_isa_name(kdr_device_isa(view->stage.device)));
    const kdr_build_def plan = kdr_view_plan(&view->stage.given, view->stage.plan, view->stage.trace);
    kdr_report_plan_json(&json, &plan);
    kdr_json_whole(&json, "frames", view->frames);
    kdr_json_real(&json, "fps", speed(view));
    kdr_json_whole(&json, "builds", view->builds);
    kdr_json_real(&json, "sample_ms", 1e3 * mean(view->sample_seconds, view->builds));
    kdr_json_real(&json, "build_ms", 1e3 * mean(view->build_seconds, view->builds));
    kdr_json_whole(&json, "passes", view->passes);
    kdr_json_real(&json, "trace_ms", 1e3 * mean(view->trace_seconds, view->passes));
    kdr_json_whole(&json, "scale", view->pace.scale);
    kdr_json_real(&json, "mray_s", view->trace_seconds > 0 ? 1e-6 * (double)view->rays / view->trace_seconds : 0);
    kdr_json_end(&json);
    return kdr_output_close(&output, view->stage.messages);
}

static void print_summary(const kdr_viewing *view) {
    fprintf(stderr, "%llu frame%s: %.1f fps, mesh %.1f ms, build %.1f ms, trace %.1f ms, %.2f Mray/s\n",
            (unsigned long long)view->frames, view->frames == 1 ? "" : "s", speed(view),
            1e3 * mean(view->sample_seconds, view->builds), 1e3 * mean(view->build_seconds, view->builds),
            1e3 * mean(view->trace_seconds, view->passes),
            view->trace_seconds > 0 ? 1e-6 * (double)view->rays / view->trace_seconds : 0);
}

int kdr_command_view(int argc, char **argv) {
    kdr_view_options options;
    kdr_view_options_parse(argc, argv, &options);
    kdr_signals_watch("kdray view");

    kdr_progress progress = kdr_progress_make(options.quiet);
    kdr_messages messages = {.command = "kdray view", .quiet = options.quiet, .progress = &progress};
    kdr_viewing *view = kdr_memory_get(1, sizeof *view);
    *view = (kdr_viewing){
        .show = options.show, .shadows = true, .panel = true, .cell_depth = KDR_VIEW_CELL_DEPTH, .moved = true};
    bool done = open_view(view, &options, &messages);
    kdr_progress_clear(&progress);
    done = done && run(view, &options);
    if (done && options.tree.json)
        done = write_json(view, &options);
    if (done && !options.quiet)
        print_summary(view);

    kdr_window_close(view->window);
    kdr_view_picture_release(&view->picture);
    kdr_view_cells_release(&view->cells);
    kdr_memory_release(view->canvas.pixels);
    kdr_view_stage_close(&view->stage);
    kdr_memory_release(view);
    return done ? KDR_EXIT_DONE : KDR_EXIT_FAILED;
}
