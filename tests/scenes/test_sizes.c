#include "kdray/render.h"
#include "scenes/scenes.h"
#include "support/random.h"
#include "support/test_size.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static kdr_mesh *make(const char *name, size_t triangle_count, double time) {
    kdr_mesh *mesh = NULL;
    assert_int_equal(kdr_mesh_make(name, triangle_count, time, NULL, &mesh), KDR_OK);
    assert_non_null(mesh);
    return mesh;
}

static bool count_is_near(const kdr_mesh *mesh, size_t asked) {
    return mesh->triangle_count * 10 >= asked * 9 && mesh->triangle_count * 10 <= asked * 11;
}

static void check_arrays(const kdr_mesh *mesh) {
    size_t wrong_index = 0, wrong_material = 0, wrong_number = 0, wrong_normal = 0;
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++)
        wrong_index += mesh->indices[i] >= mesh->vertex_count;
    for (size_t i = 0; i < mesh->triangle_count; i++)
        wrong_material += mesh->triangle_materials[i] >= mesh->material_count;
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        wrong_number += !isfinite(mesh->positions[i]);
    for (size_t i = 0; mesh->normals && i < mesh->vertex_count; i++) {
        const float *n = mesh->normals + 3 * i;
        wrong_normal += !(fabsf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-5f);
    }
    assert_int_equal(wrong_index, 0);
    assert_int_equal(wrong_material, 0);
    assert_int_equal(wrong_number, 0);
    assert_int_equal(wrong_normal, 0);
    assert_int_equal(mesh->dropped_count, 0);
    assert_int_equal(mesh->dropped_vertex_count, 0);
}

static void every_scene_comes_near_the_size_asked_for(void **state) {
    (void)state;
    static const size_t sizes[] = {100, 1000, 10000, 100000, TEST_SIZE(1000000)};
    for (size_t i = 0; kdr_mesh_builtin_name(i); i++)
        for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
            kdr_mesh *mesh = make(kdr_mesh_builtin_name(i), sizes[k], 0.5);
            if (!count_is_near(mesh, sizes[k]))
                fail_msg("%s: %zu triangles instead of %zu", kdr_mesh_builtin_name(i), mesh->triangle_count, sizes[k]);
            check_arrays(mesh);
            kdr_mesh_destroy(mesh);
        }
    assert_int_equal(kdr_render_bytes(), 0);
}

/* Counting is drawing without arrays, so all small sizes are affordable, and large ones picked at random. */
static void no_size_in_between_is_missed(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 1);
    for (size_t i = 0; kdr_recipe_at(i); i++) {
        const kdr_recipe *recipe = kdr_recipe_at(i);
        size_t asked = KDR_SCENE_LEAST;
        for (int step = 0; step < TEST_SIZE(600) && asked <= 1000000; step++) {
            kdr_shape shape = {0};
            recipe->draw(&shape, asked, 0.25);
            if (shape.triangle_count * 10 < asked * 9 || shape.triangle_count * 10 > asked * 11)
                fail_msg("%s: %zu triangles instead of %zu", recipe->name, shape.triangle_count, asked);
            assert_true(shape.vertex_count > 0 && shape.vertex_count <= 3 * shape.triangle_count + 1);
            asked += asked < 400 ? 1 : 1 + test_random_below(&random, (uint32_t)asked / 15);
        }
    }
}

static void the_largest_size_is_counted_without_overflow(void **state) {
    (void)state;
    for (size_t i = 0; kdr_recipe_at(i); i++) {
        kdr_shape shape = {0};
        kdr_recipe_at(i)->draw(&shape, KDR_SCENE_MOST, 0.25);
        assert_in_range(shape.triangle_count, KDR_SCENE_MOST / 10 * 9, KDR_SCENE_MOST / 10 * 11);
        assert_in_range(shape.vertex_count, KDR_SCENE_MOST / 3, KDR_SCENE_MOST * (size_t)3 + 1);
    }
}

static void a_size_of_zero_means_the_default(void **state) {
    (void)state;
    for (size_t i = 0; kdr_recipe_at(i); i++) {
        const kdr_recipe *recipe = kdr_recipe_at(i);
        kdr_mesh *mesh = make(recipe->name, 0, 0);
        assert_true(count_is_near(mesh, recipe->default_count));
        kdr_mesh_destroy(mesh);
    }
}

static void a_mesh_says_which_scene_it_is_and_names_its_materials(void **state) {
    (void)state;
    for (size_t i = 0; kdr_recipe_at(i); i++) {
        const kdr_recipe *recipe = kdr_recipe_at(i);
        kdr_mesh *mesh = make(recipe->name, 1000, 0);
        char format[32];
        snprintf(format, sizeof format, "built-in %s", recipe->name);
        assert_string_equal(mesh->format, format);
        assert_int_equal(mesh->normals != NULL, (recipe->traits & KDR_SCENE_SMOOTH) != 0);
        assert_int_equal(mesh->material_count, recipe->material_count);
        for (size_t k = 0; k < mesh->material_count; k++) {
            assert_string_equal(mesh->materials[k].name, recipe->materials[k].name);
            for (int c = 0; c < 3; c++)
                assert_true(mesh->materials[k].diffuse[c] >= 0 && mesh->materials[k].diffuse[c] <= 1);
        }
        kdr_mesh_destroy(mesh);
    }
}

/* A scene lies on the ground under the default camera, and has an extent along every axis. */
static void every_scene_has_an_extent_along_every_axis(void **state) {
    (void)state;
    for (size_t i = 0; kdr_mesh_builtin_name(i); i++) {
        kdr_mesh *mesh = make(kdr_mesh_builtin_name(i), 10000, 0.5);
        float bounds[6];
        kdr_mesh_bounds(mesh, bounds);
        float wide = bounds[3] - bounds[0], high = bounds[4] - bounds[1], deep = bounds[5] - bounds[2];
        assert_true(high > 0.05f * wide && deep > 0.3f * wide && wide > 0.3f * deep);
        kdr_mesh_destroy(mesh);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_scene_comes_near_the_size_asked_for),
        cmocka_unit_test(no_size_in_between_is_missed),
        cmocka_unit_test(the_largest_size_is_counted_without_overflow),
        cmocka_unit_test(a_size_of_zero_means_the_default),
        cmocka_unit_test(a_mesh_says_which_scene_it_is_and_names_its_materials),
        cmocka_unit_test(every_scene_has_an_extent_along_every_axis),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
