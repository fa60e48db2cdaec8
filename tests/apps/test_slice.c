/* A slice shows every point of the box once, stays small whatever the scene, and its colours change in even steps. */
#include "apps/kdray/depth_scale.h"
#include "apps/kdray/slice.h"
#include "support/test_size.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* A built-in scene and its tree. */
typedef struct cut_scene {
    kdr_device *device;
    kdr_mesh *mesh;
    kdr_scene *scene;
} cut_scene;

static cut_scene make_scene(const char *name, size_t triangles, kdr_split_rule split) {
    cut_scene made;
    kdr_build_def def = kdr_default_build_def();
    def.split = split;
    def.leaf_limit = 1;
    kdr_triangles_def triangles_def = kdr_default_triangles_def();
    assert_int_equal(kdr_mesh_make(name, triangles, 0, NULL, &made.mesh), KDR_OK);
    triangles_def.vertices = made.mesh->positions;
    triangles_def.vertex_count = made.mesh->vertex_count;
    triangles_def.indices = made.mesh->indices;
    triangles_def.triangle_count = made.mesh->triangle_count;
    assert_int_equal(kdr_device_create(NULL, &made.device), KDR_OK);
    assert_int_equal(kdr_scene_create(made.device, &made.scene), KDR_OK);
    assert_int_equal(kdr_scene_add_triangles(made.scene, &triangles_def, NULL), KDR_OK);
    assert_int_equal(kdr_scene_commit(made.scene, &def), KDR_OK);
    return made;
}

static void destroy_scene(cut_scene *scene) {
    kdr_scene_destroy(scene->scene);
    kdr_device_destroy(scene->device);
    kdr_mesh_destroy(scene->mesh);
}

static kdr_slice_sheet cut(const cut_scene *scene, const kdr_slice *slice) {
    kdr_slice_sheet sheet;
    char problem[256];
    assert_null(kdr_slice_cut(slice, scene->scene, scene->mesh, &sheet, problem, sizeof problem));
    return sheet;
}

/* Rectangles lie on the sheet and have its area together; those of a tree do not overlap, so they fill it. */
static void assert_sheet_is_filled(const kdr_slice_sheet *sheet) {
    double area = 0, slack = 1e-3;
    for (size_t i = 0; i < sheet->rectangle_count; i++) {
        const kdr_slice_rectangle *r = &sheet->rectangles[i];
        assert_true((double)r->left >= -slack && r->left <= r->right && (double)r->right <= sheet->width + slack);
        assert_true((double)r->top >= -slack && r->top <= r->bottom && (double)r->bottom <= sheet->height + slack);
        assert_true(r->depth >= sheet->least_depth && r->depth <= sheet->largest_depth);
        area += ((double)r->right - (double)r->left) * ((double)r->bottom - (double)r->top);
    }
    double expected = sheet->width * sheet->height;
    assert_float_equal(area, expected, expected * 1e-4);
    for (size_t i = 0; i < sheet->segment_count; i++) {
        const kdr_slice_segment *s = &sheet->segments[i];
        const float *const ends[2] = {s->from, s->to};
        for (int k = 0; k < 2; k++)
            assert_true((double)ends[k][0] >= -slack && (double)ends[k][0] <= sheet->width + slack &&
                        (double)ends[k][1] >= -slack && (double)ends[k][1] <= sheet->height + slack);
    }
}

static void every_slice_is_filled_by_its_rectangles(void **state) {
    (void)state;
    static const char *const names[] = {"flake", "city", "stadium", "needles", "heap"};
    static const kdr_split_rule splits[] = {KDR_SPLIT_BINNED, KDR_SPLIT_SPACE, KDR_SPLIT_OBJECT};
    for (int n = 0; n < 5; n++) {
        for (int s = 0; s < 3; s++) {
            cut_scene scene = make_scene(names[n], 2000, splits[s]);
            for (uint32_t axis = 0; axis < 3; axis++) {
                // Both ends, and halves, where the spatial median puts its planes
                for (double percent = 0; percent <= 100; percent += 12.5) {
                    kdr_slice_sheet sheet = cut(&scene, &(kdr_slice){axis, percent, true});
                    assert_int_equal(sheet.axis, axis);
                    assert_float_equal(sheet.part, percent / 100, 1e-6);
                    assert_sheet_is_filled(&sheet);
                    assert_true(sheet.together_count > 0 || sheet.leaf_count == sheet.rectangle_count);
                    kdr_slice_release(&sheet);
                }
            }
            destroy_scene(&scene);
        }
    }
}

static void a_coordinate_cuts_where_the_percentage_of_the_same_place_does(void **state) {
    (void)state;
    cut_scene scene = make_scene("stadium", 2000, KDR_SPLIT_BINNED);
    float bounds[6];
    kdr_scene_bounds(scene.scene, bounds);
    for (uint32_t axis = 0; axis < 3; axis++) {
        double middle = ((double)bounds[axis] + (double)bounds[axis + 3]) / 2;
        kdr_slice_sheet a = cut(&scene, &(kdr_slice){axis, 50, true});
        kdr_slice_sheet b = cut(&scene, &(kdr_slice){axis, middle, false});
        assert_int_equal(a.rectangle_count, b.rectangle_count);
        assert_int_equal(a.segment_count, b.segment_count);
        for (size_t i = 0; i < a.rectangle_count; i++)
            assert_int_equal(a.rectangles[i].depth, b.rectangles[i].depth);
        kdr_slice_release(&a);
        kdr_slice_release(&b);
    }
    destroy_scene(&scene);
}

static void a_plane_outside_the_box_is_refused_with_a_sentence(void **state) {
    (void)state;
    cut_scene scene = make_scene("sphere", 500, KDR_SPLIT_BINNED);
    char problem[256] = "";
    kdr_slice_sheet sheet;
    float bounds[6];
    kdr_scene_bounds(scene.scene, bounds);
    for (uint32_t axis = 0; axis < 3; axis++) {
        double outside[2] = {nextafter((double)bounds[axis], -INFINITY), nextafter((double)bounds[axis + 3], INFINITY)};
        for (int side = 0; side < 2; side++) {
            kdr_slice slice = {axis, outside[side], false};
            assert_ptr_equal(kdr_slice_cut(&slice, scene.scene, scene.mesh, &sheet, problem, sizeof problem), problem);
            assert_non_null(strstr(problem, "lies outside"));
            kdr_slice_release(&sheet);
        }
    }
    destroy_scene(&scene);
}

static void a_slice_of_many_cells_is_drawn_with_few_rectangles(void **state) {
    (void)state;
    cut_scene scene = make_scene("terrain", TEST_SIZE(300000), KDR_SPLIT_SPACE);
    kdr_slice_sheet sheet = cut(&scene, &(kdr_slice){1, 50, true});
    assert_true(sheet.together_count > 0);
    assert_true(sheet.leaf_count > sheet.rectangle_count);
    assert_true(sheet.rectangle_count <= KDR_SLICE_RECTANGLES && sheet.segment_count <= KDR_SLICE_SEGMENTS);
    assert_true(sheet.empty_count < sheet.leaf_count);
    assert_sheet_is_filled(&sheet);

    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    assert_non_null(file);
    kdr_tree_stats stats;
    assert_int_equal(kdr_scene_stats(scene.scene, &stats), KDR_OK);
    kdr_slice_draw(file, &sheet, &(kdr_slice_legend){"terrain", "split=space", &stats});
    assert_int_equal(fclose(file), 0);
    assert_true(size < 400000);
    assert_non_null(strstr(text, "drawn together"));
    free(text);
    kdr_slice_release(&sheet);
    destroy_scene(&scene);
}

/* ---- colours */

/* OKLab of a colour. */
static void to_lab(uint32_t colour, double lab[3]) {
    double rgb[3];
    for (int k = 0; k < 3; k++) {
        double v = (colour >> (16 - 8 * k) & 255) / 255.0;
        rgb[k] = v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
    }
    double l = cbrt(0.4122214708 * rgb[0] + 0.5363325363 * rgb[1] + 0.0514459929 * rgb[2]);
    double m = cbrt(0.2119034982 * rgb[0] + 0.6806995451 * rgb[1] + 0.1073969566 * rgb[2]);
    double s = cbrt(0.0883024619 * rgb[0] + 0.2817188376 * rgb[1] + 0.6299787005 * rgb[2]);
    lab[0] = 0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s;
    lab[1] = 1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s;
    lab[2] = 0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s;
}

static void equal_steps_of_depth_look_equally_large(void **state) {
    (void)state;
    enum { STEPS = 16 };
    double least = INFINITY, largest = 0, before[3];
    to_lab(kdr_depth_colour(0), before);
    for (int i = 1; i <= STEPS; i++) {
        double lab[3];
        to_lab(kdr_depth_colour((double)i / STEPS), lab);
        // Deeper is darker, by the same amount each time.
        assert_float_equal(before[0] - lab[0], 0.61 / STEPS, 0.005);
        double step = sqrt(pow(lab[0] - before[0], 2) + pow(lab[1] - before[1], 2) + pow(lab[2] - before[2], 2));
        least = fmin(least, step);
        largest = fmax(largest, step);
        memcpy(before, lab, sizeof before);
    }
    assert_true(largest < 2 * least);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_slice_is_filled_by_its_rectangles),
        cmocka_unit_test(a_coordinate_cuts_where_the_percentage_of_the_same_place_does),
        cmocka_unit_test(a_plane_outside_the_box_is_refused_with_a_sentence),
        cmocka_unit_test(a_slice_of_many_cells_is_drawn_with_few_rectangles),
        cmocka_unit_test(equal_steps_of_depth_look_equally_large),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
