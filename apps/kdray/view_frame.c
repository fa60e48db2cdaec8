#include "view_frame.h"

#include "frame_names.h"
#include "memory.h"
#include "view_plans.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

#define FIGURES_PERIOD 0.4 /* seconds that the speed is taken over */
#define SHOT_PATTERN "kdray-####.png"
#define SHOT_LIMIT 100000

/* Samples a pixel of a picture that rests. */
static uint32_t enough(const kdr_viewing *view) { return kdr_view_show_is_value(view->show) ? 1 : KDR_VIEW_SAMPLES; }

static void fit_canvas(kdr_viewing *view) {
    uint32_t width, height;
    kdr_window_size(view->window, &width, &height);
    if (view->canvas.width == (int)width && view->canvas.height == (int)height)
        return;
    size_t count = (size_t)width * height;
    if (count > view->canvas_capacity) {
        kdr_memory_release(view->canvas.pixels);
        view->canvas.pixels = kdr_memory_get(count, sizeof *view->canvas.pixels);
        view->canvas_capacity = count;
    }
    view->canvas.width = (int)width;
    view->canvas.height = (int)height;
    view->moved = true;
}

static void trace(kdr_viewing *view, const kdr_camera_frame *frame, kdr_view_pass pass) {
    const kdr_view_look look = {view->stage.scene, view->stage.mesh, &view->look, view->show, view->shadows};
    const kdr_view_raster raster = {.window_width = (uint32_t)view->canvas.width,
                                    .window_height = (uint32_t)view->canvas.height,
                                    .scale = pass.scale,
                                    .sample = pass.sample};
    kdr_view_picture_trace(&view->picture, view->stage.device, &look, frame, raster);
    const kdr_view_raster *traced = &view->picture.raster;
    kdr_view_pace_learn(&view->pace, (double)traced->width * traced->height, view->picture.seconds);
    view->passes++;
    view->rays += view->picture.rays;
    view->trace_seconds += view->picture.seconds;
}

static kdr_view_figures figures_of(const kdr_viewing *view, bool rests) {
    const kdr_view_picture *picture = &view->picture;
    return (kdr_view_figures){
        .file = view->stage.file,
        .plan = kdr_view_plan_name(view->stage.plan),
        .trace = kdr_view_trace_name(view->stage.trace),
        .note = view->note[0] ? view->note : NULL,
        .triangles = view->stage.mesh->triangle_count,
        .show = view->show,
        .sample_ms = 1e3 * view->stage.sample_seconds,
        .build_ms = 1e3 * view->stage.build_seconds,
        .trace_ms = 1e3 * picture->seconds,
        .frames_a_second = rests ? 0 : view->frames_a_second,
        .mega_rays = picture->seconds > 0 ? (double)picture->rays / picture->seconds * 1e-6 : 0,
        .width = (uint32_t)view->canvas.width,
        .height = (uint32_t)view->canvas.height,
        .scale = picture->raster.scale,
        .samples = picture->raster.sample + 1,
        .cells = view->cells_shown,
        .cells_cut = view->cells.cut,
        .cell_depth = view->cell_depth,
        .cell_count = view->cells.count,
        .low = (double)picture->low,
        .high = (double)picture->high,
    };
}

/* Puts the picture on the canvas, and over it cells and text. */
static void compose(kdr_viewing *view, const kdr_camera_frame *frame, bool with_text, bool rests) {
    kdr_view_picture_copy(&view->picture, &view->canvas);
    if (view->cells_shown) {
        if (!view->cells_taken)
            kdr_view_cells_take(&view->cells, view->stage.scene, view->cell_depth);
        view->cells_taken = true;
        kdr_view_cells_draw(&view->cells, frame, &view->picture, &view->canvas);
    }
    if (!with_text)
        return;
    if (view->panel) {
        kdr_view_figures figures = figures_of(view, rests);
        kdr_view_panel_draw(&view->canvas, &figures);
        kdr_view_panel_draw_scale(&view->canvas, &figures);
        if (view->clock.duration > 0)
            kdr_view_panel_draw_bar(&view->canvas, &view->clock);
    }
    if (view->help)
        kdr_view_panel_draw_help(&view->canvas);
}

/* The speed is that of frames that follow one another; who waits for a hand is not slow. */
static void count_frame(kdr_viewing *view, double now, bool rests) {
    view->frames++;
    if (view->last > 0) {
        view->busy++;
        view->busy_seconds += now - view->last;
        view->counted++;
    } else {
        view->counted_since = now;
        view->counted = 0;
    }
    view->last = rests ? 0 : now;
    double period = now - view->counted_since;
    if (period < FIGURES_PERIOD && view->frames_a_second > 0)
        return;
    view->frames_a_second = period > 0 ? view->counted / period : 0;
    if (period < FIGURES_PERIOD)
        return;
    view->counted_since = now;
    view->counted = 0;
}

/* The moment and the plan that are wanted; the camera's frame. False after a sentence. */
static bool prepare(kdr_viewing *view, kdr_camera_frame *frame) {
    bool changed;
    if (!kdr_view_stage_update(&view->stage, kdr_view_clock_moment(&view->clock), &changed))
        return false;
    if (changed) {
        view->builds++;
        view->sample_seconds += view->stage.sample_seconds;
        view->build_seconds += view->stage.build_seconds;
        view->cells_taken = false;
        view->moved = true;
    }
    if (!kdr_camera_frame_make(&view->look.camera, frame)) {
        view->look.camera = view->home;
        view->moved = true;
        kdr_camera_frame_make(&view->look.camera, frame);
    }
    return true;
}

bool kdr_view_frame_show(kdr_viewing *view, bool *rests) {
    kdr_camera_frame frame;
    double begin = kdr_seconds();
    fit_canvas(view);
    if (!prepare(view, &frame))
        return false;
    double pixels = (double)view->canvas.width * view->canvas.height;
    kdr_view_pass pass = kdr_view_pace_next(&view->pace, view->moved, pixels, kdr_seconds() - begin, enough(view));
    view->moved = false;
    *rests = pass.scale == 0;
    if (!*rests)
        trace(view, &frame, pass);
    if (*rests && !view->redraw) {
        view->last = 0;
        return true;
    }
    view->redraw = !*rests; // that it rests is to be written too
    compose(view, &frame, true, *rests);
    bool shown = kdr_window_show(view->window, view->canvas.pixels, (uint32_t)view->canvas.width,
                                 (uint32_t)view->canvas.height, view->stage.messages);
    count_frame(view, kdr_seconds(), *rests);
    return shown;
}

/* Makes the picture as fine as it becomes. */
static bool finish(kdr_viewing *view, kdr_camera_frame *frame) {
    fit_canvas(view);
    if (!prepare(view, frame))
        return false;
    if (view->moved || view->pace.scale > 1)
        view->pace.scale = 0;
    view->moved = false;
    double pixels = (double)view->canvas.width * view->canvas.height;
    for (;;) {
        kdr_view_pass pass = kdr_view_pace_next(&view->pace, false, pixels, 0, enough(view));
        if (pass.scale == 0)
            return true;
        trace(view, frame, pass);
    }
}

static float linear_of(uint32_t code) {
    double part = code / 255.0;
    return (float)(part <= 0.04045 ? part / 12.92 : pow((part + 0.055) / 1.055, 2.4));
}

bool kdr_view_frame_write(kdr_viewing *view, const char *path, bool with_text, const kdr_logger *logger) {
    kdr_camera_frame frame;
    if (!finish(view, &frame))
        return false;
    compose(view, &frame, with_text, true);
    view->redraw = true;

    kdr_image *image;
    float linear[256];
    for (uint32_t i = 0; i < 256; i++)
        linear[i] = linear_of(i);
    kdr_status status = kdr_image_create((uint32_t)view->canvas.width, (uint32_t)view->canvas.height, &image);
    if (status == KDR_OK) {
        for (size_t i = 0; i < (size_t)image->width * image->height; i++)
            for (int k = 0; k < 3; k++)
                image->rgb[3 * i + (size_t)k] = linear[view->canvas.pixels[i] >> (16 - 8 * k) & 255];
        status = kdr_image_write_png(image, path, logger);
        kdr_image_destroy(image);
    }
    return status == KDR_OK;
}

void kdr_view_frame_shoot(kdr_viewing *view, bool with_text) {
    char name[PATH_MAX] = "";
    const kdr_logger silent = {0};
    uint64_t number = 1;
    while (number < SHOT_LIMIT && kdr_frame_name(SHOT_PATTERN, number, name) && access(name, F_OK) == 0)
        number++;
    bool written = number < SHOT_LIMIT && kdr_view_frame_write(view, name, with_text, &silent);
    snprintf(view->note, sizeof view->note, "%.40s %s", name, written ? "written" : "cannot be written");
}
