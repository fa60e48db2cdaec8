#include "mesh/finish.h"
#include "mesh/mesh.h"
#include "mesh/merge.h"
#include "mesh/reading.h"
#include "support/failing_alloc.h"
#include "support/random.h"
#include "support/test_size.h"

static void growing_keeps_all_arrays(void **state) {
    (void)state;
    kdr_mesh *mesh;
    assert_int_equal(
        kdr_mesh_create(0, 0, KDR_MESH_NORMALS | KDR_MESH_MATERIALS, "a name too long for its array, surely", &mesh),
        KDR_OK);
    assert_string_equal(mesh->format, "a name too long for its array, ");
    for (uint32_t i = 0; i < 1000; i++) {
        assert_int_equal(kdr_mesh_resize_vertices(mesh, i + 1), KDR_OK);
        assert_int_equal(kdr_mesh_resize_triangles(mesh, i + 1), KDR_OK);
        mesh->positions[3 * i + 2] = (float)i;
        mesh->normals[3 * i] = (float)i + 0.5f;
        mesh->indices[3 * i + 1] = i + 7;
        mesh->triangle_materials[i] = i + 9;
    }
    size_t before = kdr_render_bytes();
    assert_int_equal(kdr_mesh_resize_vertices(mesh, 500), KDR_OK);
    assert_int_equal(kdr_mesh_resize_triangles(mesh, 500), KDR_OK);
    kdr_mesh_trim(mesh);
    assert_true(kdr_render_bytes() < before);
    for (uint32_t i = 0; i < 500; i++) {
        assert_true(mesh->positions[3 * i + 2] == (float)i);
        assert_true(mesh->normals[3 * i] == (float)i + 0.5f);
        assert_int_equal(mesh->indices[3 * i + 1], i + 7);
        assert_int_equal(mesh->triangle_materials[i], i + 9);
    }
    kdr_mesh_destroy(mesh);
    assert_int_equal(kdr_render_bytes(), 0);
}

static void more_than_32_bits_can_number_is_a_limit(void **state) {
    (void)state;
    kdr_mesh *mesh;
    assert_int_equal(kdr_mesh_create(KDR_MESH_LIMIT + 1, 0, 0, "", &mesh), KDR_ERROR_LIMIT);
    assert_null(mesh);
    assert_int_equal(kdr_mesh_create(0, SIZE_MAX, 0, "", &mesh), KDR_ERROR_LIMIT);
    assert_null(mesh);
    assert_int_equal(kdr_render_bytes(), 0);
}

static void materials_are_copied_and_can_be_dropped(void **state) {
    (void)state;
    kdr_mesh *mesh;
    assert_int_equal(kdr_mesh_create(3, 1, KDR_MESH_MATERIALS, "", &mesh), KDR_OK);
    static const float colour[3] = {0.25f, 0.5f, 1};
    for (uint32_t i = 0; i < 100; i++) {
        char name[16];
        snprintf(name, sizeof name, "material %u", i);
        uint32_t index;
        assert_int_equal(kdr_mesh_add_material(mesh, name, 9 + i % 4, colour, &index), KDR_OK);
        assert_int_equal(index, i);
    }
    assert_string_equal(mesh->materials[0].name, "material ");
    assert_string_equal(mesh->materials[42].name, "material 42");
    assert_memory_equal(mesh->materials[42].diffuse, colour, sizeof colour);
    kdr_mesh_drop_materials(mesh);
    assert_null(mesh->materials);
    assert_null(mesh->triangle_materials);
    assert_int_equal(mesh->material_count, 0);
    kdr_mesh_destroy(mesh);
    kdr_mesh_destroy(NULL);
    assert_int_equal(kdr_render_bytes(), 0);
}

static void bounds_are_those_of_used_vertices_only(void **state) {
    (void)state;
    kdr_mesh *mesh;
    assert_int_equal(kdr_mesh_create(4, 1, 0, "", &mesh), KDR_OK);
    static const float positions[12] = {9, 9, 9, -1, 2, 3, 4, -5, 6, 0, 1, -2};
    static const uint32_t indices[3] = {1, 2, 3};
    memcpy(mesh->positions, positions, sizeof positions);
    memcpy(mesh->indices, indices, sizeof indices);
    float bounds[6];
    static const float wanted[6] = {-1, -5, -2, 4, 2, 6};
    kdr_mesh_bounds(mesh, bounds);
    assert_memory_equal(bounds, wanted, sizeof wanted);
    kdr_mesh_destroy(mesh);
}

static void equal_keys_get_equal_numbers_in_the_order_of_appearance(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 4);
    enum { COUNT = TEST_SIZE(20000) };
    uint32_t *keys = malloc(COUNT * 3 * sizeof *keys), *numbers = malloc(COUNT * sizeof *numbers);
    assert_non_null(keys);
    assert_non_null(numbers);
    uint32_t seen[8][8][8];
    memset(seen, 0xff, sizeof seen);
    for (size_t i = 0; i < 3 * COUNT; i++)
        keys[i] = test_random_below(&random, 8);
    size_t unique, wanted = 0;
    assert_int_equal(kdr_merge_keys(keys, 3, COUNT, numbers, &unique), KDR_OK);
    for (size_t i = 0; i < COUNT; i++) {
        uint32_t *number = &seen[keys[3 * i]][keys[3 * i + 1]][keys[3 * i + 2]];
        if (*number == UINT32_MAX)
            *number = (uint32_t)wanted++;
        assert_int_equal(numbers[i], *number);
    }
    assert_int_equal(unique, wanted);
    free(keys);
    free(numbers);
    assert_int_equal(kdr_render_bytes(), 0);
}

static void a_failed_growth_leaves_the_mesh_as_it_was(void **state) {
    (void)state;
    failing_alloc failing;
    failing_alloc_init(&failing);
    kdr_allocator functions = failing_alloc_functions(&failing);
    kdr_mesh_memory_replace(&functions);
    kdr_mesh *mesh;
    assert_int_equal(kdr_mesh_create(3, 1, KDR_MESH_NORMALS | KDR_MESH_MATERIALS, "", &mesh), KDR_OK);
    mesh->positions[8] = 5;
    mesh->triangle_materials[0] = 6;
    for (uint64_t n = 1; n <= 2; n++) {
        failing_alloc_fail_nth(&failing, n);
        assert_int_equal(kdr_mesh_resize_vertices(mesh, 100), KDR_ERROR_OUT_OF_MEMORY);
        failing_alloc_fail_nth(&failing, n);
        assert_int_equal(kdr_mesh_resize_triangles(mesh, 100), KDR_ERROR_OUT_OF_MEMORY);
        failing_alloc_fail_nth(&failing, n);
        static const float colour[3] = {0, 0, 0};
        assert_int_equal(kdr_mesh_add_material(mesh, "", 0, colour, NULL), KDR_ERROR_OUT_OF_MEMORY);
    }
    assert_int_equal(mesh->vertex_count, 3);
    assert_int_equal(mesh->triangle_count, 1);
    assert_int_equal(mesh->material_count, 0);
    assert_true(mesh->positions[8] == 5 && mesh->triangle_materials[0] == 6);
    kdr_mesh_destroy(mesh);
    assert_true(failing_alloc_is_clean(&failing));
    kdr_mesh_memory_replace(NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(growing_keeps_all_arrays),
        cmocka_unit_test(more_than_32_bits_can_number_is_a_limit),
        cmocka_unit_test(materials_are_copied_and_can_be_dropped),
        cmocka_unit_test(bounds_are_those_of_used_vertices_only),
        cmocka_unit_test(equal_keys_get_equal_numbers_in_the_order_of_appearance),
        cmocka_unit_test(a_failed_growth_leaves_the_mesh_as_it_was),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
