/* A view's picture: coarse while it moves, fine when it rests, its text readable, its scales in order. */
#include "apps/kdray/overlay_text.h"
#include "apps/kdray/view_cells.h"
#include "apps/kdray/view_pace.h"
#include "apps/kdray/view_panel.h"
#include "apps/kdray/view_picture.h"
#include "apps/kdray/view_plans.h"
#include "apps/kdray/view_keys.h"
#include "apps/kdray/view_window.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* ---- pace */

/* Passes of so many frames, on a machine that takes that long a pixel; returns the scale of the last one. */
static uint32_t run_frames(kdr_view_pace *pace, int frames, double pixel_seconds, double pixels, double spent) {
    uint32_t scale = 0;
    for (int i = 0; i < frames; i++) {
        kdr_view_pass pass = kdr_view_pace_next(pace, true, pixels, spent, 8);
        assert_in_range(pass.scale, 1, KDR_PACE_COARSEST);
        assert_int_equal(pass.sample, 0);
        scale = pass.scale;
        double traced = pixels / (scale * scale);
        kdr_view_pace_learn(pace, traced, traced * pixel_seconds);
    }
    return scale;
}

static void what_moves_is_as_coarse_as_it_must_be(void **state) {
    (void)state;
    const double pixels = 640 * 480;
    kdr_view_pace fast = {0}, slow = {0}, slowest = {0}, busy = {0};
    assert_int_equal(run_frames(&fast, 20, 1e-9, pixels, 0), 1);
    uint32_t scale = run_frames(&slow, 20, 1e-6, pixels, 0);
    assert_true(scale > 1 && scale < KDR_PACE_COARSEST);
    assert_true(pixels / (scale * scale) * 1e-6 < 0.034);
    assert_int_equal(run_frames(&slowest, 20, 1e-3, pixels, 0), KDR_PACE_COARSEST);
    // A build takes time from tracing.
    assert_true(run_frames(&busy, 20, 1e-6, pixels, 0.02) > scale);
}

static void a_scale_does_not_flicker(void **state) {
    (void)state;
    kdr_view_pace pace = {0};
    const double pixels = 640 * 480;
    uint32_t first = run_frames(&pace, 20, 0.42e-6, pixels, 0);
    for (int i = 0; i < 40; i++)
        assert_int_equal(run_frames(&pace, 1, i % 2 ? 0.40e-6 : 0.44e-6, pixels, 0), first);
}

static void what_rests_becomes_fine_and_then_nothing_is_done(void **state) {
    (void)state;
    kdr_view_pace pace = {0};
    uint32_t scale = run_frames(&pace, 5, 1e-3, 640 * 480, 0), samples = 0;
    for (int i = 0; i < 40; i++) {
        kdr_view_pass pass = kdr_view_pace_next(&pace, false, 640 * 480, 0, 8);
        if (pass.scale == 0)
            continue;
        assert_true(pass.scale < scale || (pass.scale == 1 && pass.sample == samples));
        assert_true(pass.scale == 1 || pass.sample == 0);
        scale = pass.scale;
        samples += scale == 1;
    }
    assert_int_equal(scale, 1);
    assert_int_equal(samples, 8);
    assert_true(kdr_view_pace_next(&pace, true, 640 * 480, 0, 8).scale > 0);
}

/* ---- text */

static uint32_t ink_of(char letter, uint64_t *shape) {
    uint32_t ink = 0;
    *shape = 0;
    for (int row = 0; row < KDR_FONT_HEIGHT; row++)
        for (int column = 0; column < KDR_FONT_WIDTH; column++) {
            ink += kdr_font_has(letter, column, row);
            *shape = *shape << 1 | kdr_font_has(letter, column, row);
        }
    return ink;
}

static void every_letter_has_a_shape_of_its_own(void **state) {
    (void)state;
    uint64_t shapes[128];
    for (int letter = ' '; letter <= '~'; letter++) {
        uint32_t ink = ink_of((char)letter, &shapes[letter]);
        assert_true(letter == ' ' ? ink == 0 : ink >= 3);
        for (int other = ' '; other < letter; other++)
            assert_true(shapes[other] != shapes[letter]);
    }
    assert_false(kdr_font_has('A', -1, 0) || kdr_font_has('A', 5, 0) || kdr_font_has('A', 2, 8));
    assert_false(kdr_font_has('\n', 2, 2) || kdr_font_has((char)0xc3, 2, 2));
}

static void text_stays_on_its_canvas(void **state) {
    (void)state;
    enum { WIDTH = 40, HEIGHT = 12, GUARD = 64 };
    uint32_t pixels[GUARD + WIDTH * HEIGHT + GUARD];
    memset(pixels, 0x11, sizeof pixels);
    kdr_canvas canvas = {pixels + GUARD, WIDTH, HEIGHT};
    for (int x = -30; x < 60; x += 7)
        for (int y = -20; y < 30; y += 3) {
            kdr_text_draw(&canvas, x, y, 2, 0xffffff, "kdray");
            kdr_canvas_fill(&canvas, x, y, 100, 100, 0x808080, 100);
        }
    for (int i = 0; i < GUARD; i++)
        assert_true(pixels[i] == 0x11111111 && pixels[GUARD + WIDTH * HEIGHT + i] == 0x11111111);
}

static void a_letter_of_many_bytes_is_one_letter(void **state) {
    (void)state;
    uint32_t pixels[100 * 20] = {0};
    kdr_canvas canvas = {pixels, 100, 20};
    assert_int_equal(kdr_text_length("tür"), 3);
    assert_int_equal(kdr_text_draw(&canvas, 0, 0, 1, 0xffffff, "tür"), 3);
}

static void a_cover_mixes_colours(void **state) {
    (void)state;
    uint32_t pixel = 0x204060;
    kdr_canvas canvas = {&pixel, 1, 1};
    kdr_canvas_blend(&canvas, 0, 0, 0xffffff, 0);
    assert_int_equal(pixel, 0x204060);
    kdr_canvas_blend(&canvas, 0, 0, 0x6080a0, 128);
    assert_int_equal(pixel, 0x406080);
    kdr_canvas_blend(&canvas, 0, 0, 0x010203, 256);
    assert_int_equal(pixel, 0x010203);
}

static void figures_are_written_out(void **state) {
    (void)state;
    char lines[KDR_PANEL_LINES][KDR_PANEL_LINE_SIZE];
    kdr_view_figures figures = {.file = "builtin:wave",
                                .plan = "sweep",
                                .trace = "restart",
                                .triangles = 1234567,
                                .build_ms = 12.25,
                                .trace_ms = 3.5,
                                .mega_rays = 45.6,
                                .frames_a_second = 30,
                                .width = 640,
                                .height = 480,
                                .scale = 2};
    assert_int_equal(kdr_view_panel_lines(&figures, lines), 5);
    assert_string_equal(lines[0], "builtin:wave, picture");
    assert_non_null(strstr(lines[1], "1,234,567 triangles"));
    assert_non_null(strstr(lines[2], "12.25 ms  plan sweep"));
    assert_non_null(strstr(lines[3], "3.50 ms  45.6 Mray/s, restart"));
    assert_non_null(strstr(lines[4], "30.0 fps 640x480, coarse 1/2"));
    figures.frames_a_second = 0;
    figures.scale = 1;
    figures.samples = 8;
    figures.cells = true;
    figures.cell_count = 99;
    figures.note = "kdray-0001.png written";
    assert_int_equal(kdr_view_panel_lines(&figures, lines), 7);
    assert_non_null(strstr(lines[4], "at rest"));
    assert_non_null(strstr(lines[4], "8 samples"));
    assert_non_null(strstr(lines[5], "99"));
    assert_string_equal(lines[6], figures.note);
}

static void the_bar_is_found_where_it_is_drawn(void **state) {
    (void)state;
    enum { WIDTH = 320, HEIGHT = 200 };
    uint32_t *pixels = calloc(WIDTH * HEIGHT, sizeof *pixels);
    assert_non_null(pixels);
    kdr_canvas canvas = {pixels, WIDTH, HEIGHT};
    kdr_view_clock clock = {.duration = 4, .rate = 25, .time = 3};
    kdr_view_panel_draw_bar(&canvas, &clock);
    // The mark is the brightest there is on the bar.
    int found = 0, parts = 0;
    double part = 0;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH / 2; x++)
            if (pixels[y * WIDTH + x] == 0xf2f2f2) {
                found++;
                double here = kdr_view_panel_on_bar(WIDTH, HEIGHT, x, y);
                assert_true(here >= 0);
                part += here;
                parts++;
            }
    assert_true(found > 0);
    assert_float_equal(part / parts, 0.75, 0.02);
    assert_true(kdr_view_panel_on_bar(WIDTH, HEIGHT, WIDTH / 2, HEIGHT / 2) < 0);
    free(pixels);
}

/* ---- scales, keys, plans */

static void the_end_of_a_scale_is_round_and_holds_nearly_all(void **state) {
    (void)state;
    float values[10000];
    for (int i = 0; i < 10000; i++)
        values[i] = (float)(i % 43);
    assert_float_equal(kdr_view_show_end(values, 10000), 50, 0);
    values[17] = 1000; // one that is far off does not count
    assert_float_equal(kdr_view_show_end(values, 10000), 50, 0);
    for (int i = 0; i < 10000; i++)
        values[i] = -1;
    assert_float_equal(kdr_view_show_end(values, 10000), 1, 0);
    assert_float_equal(kdr_view_show_end(values, 0), 1, 0);
}

static void costs_are_brighter_the_higher_they_are(void **state) {
    (void)state;
    uint32_t before = 0;
    for (int i = 0; i <= 100; i++) {
        uint32_t colour = kdr_view_show_colour(KDR_SHOW_NODES, i / 100.0);
        uint32_t sum = (colour >> 16) + (colour >> 8 & 255) + (colour & 255);
        assert_true(i == 0 || sum > before);
        before = sum;
    }
    assert_int_equal(before, 3 * 255);
}

/* True if some line of the help names a key that is one letter. */
static bool is_told(char letter) {
    for (size_t line = 0; kdr_view_help_keys(line); line++) {
        const char *keys = kdr_view_help_keys(line);
        for (const char *at = keys; *at; at++) {
            bool begins = at == keys || at[-1] == ' ', ends = !at[1] || at[1] == ' ' || at[1] == ',';
            if (*at == letter && begins && ends)
                return true;
        }
    }
    return false;
}

static void keys_are_found_by_name_and_all_are_told(void **state) {
    (void)state;
    int found = 0;
    for (char letter = '!'; letter <= 'Z'; letter++) {
        const char name[2] = {letter, 0};
        if (kdr_view_key_find(name).action == KDR_ACTION_NONE)
            continue;
        found++;
        assert_true(is_told(letter));
    }
    assert_true(found > 20);
    assert_int_equal(kdr_view_key_find("Escape").action, KDR_ACTION_QUIT);
    assert_int_equal(kdr_view_key_find("5").number, 5);
    assert_int_equal(kdr_view_key_find("W").action, KDR_ACTION_NONE);
    size_t lines = 0;
    while (kdr_view_help_keys(lines)) {
        assert_non_null(kdr_view_help_text(lines));
        lines++;
    }
    assert_true(lines > 10);
    assert_null(kdr_view_help_text(lines));
}

static void every_plan_goes_with_every_traversal(void **state) {
    (void)state;
    kdr_build_def given = kdr_default_build_def();
    assert_int_equal(
        kdr_build_def_parse("split=object trace=stack nodes=arrays mailbox=8 test=projection", &given, NULL, 0),
        KDR_OK);
    char text[KDR_PLAN_TEXT_SIZE];
    uint32_t plans = 0, traces = 0;
    for (; kdr_view_plan_name(plans); plans++)
        for (traces = 0; kdr_view_trace_name(traces); traces++) {
            kdr_build_def def = kdr_view_plan(&given, plans, (kdr_trace_rule)traces), back;
            assert_int_equal(kdr_build_def_print(&def, text, sizeof text), KDR_OK);
            assert_int_equal(kdr_build_def_parse(text, &back, NULL, 0), KDR_OK);
            assert_int_equal(back.trace, traces);
            assert_non_null(strstr(text, kdr_view_trace_name(traces)));
        }
    assert_true(plans > 6 && traces == KDR_TRACE_BACKTRACK + 1);
    kdr_build_def same = kdr_view_plan(&given, 0, given.trace);
    assert_memory_equal(&same, &given, sizeof same);
}

/* ---- the picture */

typedef struct shown_scene {
    kdr_device *device;
    kdr_mesh *mesh;
    kdr_scene *scene;
    kdr_picture_def look;
    kdr_camera_frame frame;
} shown_scene;

static shown_scene make_scene(void) {
    shown_scene made = {.look = kdr_default_picture_def()};
    kdr_triangles_def def = kdr_default_triangles_def();
    assert_int_equal(kdr_mesh_make("knot", 2000, 0, NULL, &made.mesh), KDR_OK);
    def.vertices = made.mesh->positions;
    def.vertex_count = made.mesh->vertex_count;
    def.indices = made.mesh->indices;
    def.triangle_count = made.mesh->triangle_count;
    assert_int_equal(kdr_device_create(NULL, &made.device), KDR_OK);
    assert_int_equal(kdr_scene_create(made.device, &made.scene), KDR_OK);
    assert_int_equal(kdr_scene_add_triangles(made.scene, &def, NULL), KDR_OK);
    assert_int_equal(kdr_scene_commit(made.scene, NULL), KDR_OK);
    float bounds[6];
    kdr_mesh_bounds(made.mesh, bounds);
    made.look.camera = kdr_camera_for_bounds(bounds);
    kdr_light_for_bounds(bounds, made.look.lights[0]);
    assert_true(kdr_camera_frame_make(&made.look.camera, &made.frame));
    return made;
}

static void destroy_scene(shown_scene *scene) {
    kdr_scene_destroy(scene->scene);
    kdr_mesh_destroy(scene->mesh);
    kdr_device_destroy(scene->device);
}

static void trace(kdr_view_picture *picture, const shown_scene *scene, kdr_view_show show, uint32_t scale,
                  uint32_t sample) {
    const kdr_view_look look = {scene->scene, scene->mesh, &scene->look, show, true};
    const kdr_view_raster raster = {.window_width = 99, .window_height = 75, .scale = scale, .sample = sample};
    kdr_view_picture_trace(picture, scene->device, &look, &scene->frame, raster);
}

static void a_coarse_pixel_sees_what_a_fine_one_in_its_middle_does(void **state) {
    (void)state;
    shown_scene scene = make_scene();
    kdr_view_picture fine = {0}, coarse = {0};
    trace(&fine, &scene, KDR_SHOW_DEPTH, 1, 0);
    trace(&coarse, &scene, KDR_SHOW_DEPTH, 3, 0);
    assert_int_equal(coarse.raster.width, 33);
    assert_int_equal(coarse.raster.height, 25);
    uint32_t hits = 0;
    for (uint32_t y = 0; y < 25; y++)
        for (uint32_t x = 0; x < 33; x++) {
            float a = coarse.depth[y * 33 + x], b = fine.depth[(3 * y + 1) * 99 + 3 * x + 1];
            hits += isfinite(a) ? 1 : 0;
            assert_true(isfinite(a) ? fabsf(a - b) <= 1e-5f * a : !isfinite(b));
        }
    assert_in_range(hits, 50, 33 * 25 - 50);
    kdr_view_picture_release(&coarse);
    kdr_view_picture_release(&fine);
    destroy_scene(&scene);
}

static void more_samples_change_edges_alone(void **state) {
    (void)state;
    shown_scene scene = make_scene();
    kdr_view_picture one = {0}, many = {0};
    trace(&one, &scene, KDR_SHOW_SHADED, 1, 0);
    for (uint32_t sample = 0; sample < 8; sample++)
        trace(&many, &scene, KDR_SHOW_SHADED, 1, sample);
    assert_true(many.rays >= 99 * 75);
    int changed = 0, background = 0;
    for (int i = 0; i < 99 * 75; i++) {
        changed += one.colours[i] != many.colours[i];
        background += one.colours[i] == one.colours[0] && many.colours[i] == many.colours[0];
    }
    assert_in_range(changed, 100, 99 * 75 - background);
    assert_int_equal(one.colours[0], many.colours[0]);
    assert_in_range(background, 1000, 99 * 75 - 1000);
    kdr_view_picture_release(&many);
    kdr_view_picture_release(&one);
    destroy_scene(&scene);
}

static void a_window_of_any_size_is_filled(void **state) {
    (void)state;
    shown_scene scene = make_scene();
    for (uint32_t scale = 1; scale <= KDR_PACE_COARSEST; scale++) {
        uint32_t pixels[99 * 75 + 1];
        memset(pixels, 0xff, sizeof pixels);
        kdr_canvas canvas = {pixels, 99, 75};
        kdr_view_picture picture = {0};
        trace(&picture, &scene, KDR_SHOW_NORMALS, scale, 0);
        kdr_view_picture_copy(&picture, &canvas);
        for (uint32_t i = 0; i < 99 * 75; i++)
            assert_true(pixels[i] == picture.colours[i / 99 / scale * picture.raster.width + i % 99 / scale]);
        assert_true(pixels[99 * 75] == UINT32_MAX);
        kdr_view_picture_release(&picture);
    }
    destroy_scene(&scene);
}

static void cells_lie_around_what_they_hold(void **state) {
    (void)state;
    shown_scene scene = make_scene();
    kdr_view_cells cells = {0};
    kdr_view_cells_take(&cells, scene.scene, 0);
    assert_int_equal(cells.count, 1);
    float bounds[6];
    kdr_scene_bounds(scene.scene, bounds);
    assert_memory_equal(cells.boxes[0], bounds, sizeof bounds);
    assert_false(cells.leaves[0] || cells.cut);
    uint32_t before = 1;
    for (uint32_t depth = 1; depth < 6; depth++) {
        kdr_view_cells_take(&cells, scene.scene, depth);
        assert_in_range(cells.count, before, 1u << depth);
        before = cells.count;
    }
    kdr_view_cells_take(&cells, scene.scene, 60);
    kdr_tree_stats stats;
    assert_int_equal(kdr_scene_stats(scene.scene, &stats), KDR_OK);
    assert_int_equal(cells.count, stats.leaf_count - stats.empty_leaf_count);
    for (uint32_t i = 0; i < cells.count; i++)
        assert_true(cells.leaves[i]);

    // Drawn from outside and from inside of them
    kdr_view_picture picture = {0};
    static uint32_t drawn[99 * 75], plain[99 * 75];
    for (int side = 0; side < 2; side++) {
        if (side == 1)
            for (int k = 0; k < 3; k++)
                scene.look.camera.eye[k] += 0.97f * (scene.look.camera.target[k] - scene.look.camera.eye[k]);
        assert_true(kdr_camera_frame_make(&scene.look.camera, &scene.frame));
        trace(&picture, &scene, KDR_SHOW_SHADED, 1, 0);
        kdr_canvas canvas = {plain, 99, 75};
        kdr_view_picture_copy(&picture, &canvas);
        memcpy(drawn, plain, sizeof drawn);
        canvas.pixels = drawn;
        kdr_view_cells_draw(&cells, &scene.frame, &picture, &canvas);
        int changed = 0;
        for (int i = 0; i < 99 * 75; i++)
            changed += drawn[i] != plain[i];
        assert_in_range(changed, 200, 99 * 75);
    }
    kdr_view_picture_release(&picture);
    kdr_view_cells_release(&cells);
    destroy_scene(&scene);
}

static void a_program_without_windows_says_so(void **state) {
    (void)state;
    // The parts that tests are made of know no SDL.
    kdr_messages messages = {.command = "test"};
    assert_false(kdr_window_prepare(&messages));
    assert_true(messages.failed);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_moves_is_as_coarse_as_it_must_be),
        cmocka_unit_test(a_scale_does_not_flicker),
        cmocka_unit_test(what_rests_becomes_fine_and_then_nothing_is_done),
        cmocka_unit_test(every_letter_has_a_shape_of_its_own),
        cmocka_unit_test(text_stays_on_its_canvas),
        cmocka_unit_test(a_letter_of_many_bytes_is_one_letter),
        cmocka_unit_test(a_cover_mixes_colours),
        cmocka_unit_test(figures_are_written_out),
        cmocka_unit_test(the_bar_is_found_where_it_is_drawn),
        cmocka_unit_test(the_end_of_a_scale_is_round_and_holds_nearly_all),
        cmocka_unit_test(costs_are_brighter_the_higher_they_are),
        cmocka_unit_test(keys_are_found_by_name_and_all_are_told),
        cmocka_unit_test(every_plan_goes_with_every_traversal),
        cmocka_unit_test(a_coarse_pixel_sees_what_a_fine_one_in_its_middle_does),
        cmocka_unit_test(more_samples_change_edges_alone),
        cmocka_unit_test(a_window_of_any_size_is_filled),
        cmocka_unit_test(cells_lie_around_what_they_hold),
        cmocka_unit_test(a_program_without_windows_says_so),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
