#include "mesh/samples.h"
#include "support/failing_alloc.h"
#include "support/random.h"
#include "support/test_size.h"

#ifdef KDR_WITH_ASSIMP

static void a_glb_is_read_with_its_material_and_without_the_default_one(void **state) {
    (void)state;
    byte_list file = {.length = 0};
    sample_glb(&file, "");
    kdr_mesh *mesh = read_bytes("t.glb", file.bytes, file.length);
    assert_positions(mesh, 4, tetrahedron_positions);
    assert_indices(mesh, 4, tetrahedron_indices);
    assert_int_equal(mesh->material_count, 1);
    assert_string_equal(mesh->materials[0].name, "green");
    static const float green[3] = {0.25f, 0.5f, 0.125f};
    assert_memory_equal(mesh->materials[0].diffuse, green, sizeof green);
    assert_string_equal(mesh->format, "GLB");
    close_mesh(mesh);
}

static void content_tells_a_glb_under_any_name(void **state) {
    (void)state;
    byte_list file = {.length = 0};
    sample_glb(&file, "");
    static const char *const names[] = {"t", "t.obj", "t.blend", "some.folder/t", "t.glb.gz", ".", "t."};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        kdr_mesh *mesh = read_bytes(names[i], file.bytes, file.length);
        assert_indices(mesh, 4, tetrahedron_indices);
        close_mesh(mesh);
    }
}

static void transforms_of_nodes_are_applied(void **state) {
    (void)state;
    byte_list file = {.length = 0};
    sample_glb(&file, "\"translation\":[5,0,-1],\"scale\":[2,3,4],");
    kdr_mesh *mesh = read_bytes("t.glb", file.bytes, file.length);
    static const float wanted[4][3] = {{5, 0, -1}, {7, 0, -1}, {5, 3, -1}, {5, 0, 3}};
    assert_positions(mesh, 4, wanted);
    assert_indices(mesh, 4, tetrahedron_indices);
    close_mesh(mesh);
}

static void a_mirroring_transform_keeps_the_outside_outside(void **state) {
    (void)state;
    byte_list file = {.length = 0};
    sample_glb(&file, "\"scale\":[-1,1,1],");
    kdr_mesh *mesh = read_bytes("t.glb", file.bytes, file.length);
    assert_int_equal(mesh->triangle_count, 4);
    for (size_t i = 0; i < 4; i++) {
        const float *a = mesh->positions + 3 * (size_t)mesh->indices[3 * i];
        const float *b = mesh->positions + 3 * (size_t)mesh->indices[3 * i + 1];
        const float *c = mesh->positions + 3 * (size_t)mesh->indices[3 * i + 2];
        float e[3], f[3], to[3], inside[3] = {-0.2f, 0.2f, 0.2f};
        for (int axis = 0; axis < 3; axis++) {
            e[axis] = b[axis] - a[axis];
            f[axis] = c[axis] - a[axis];
            to[axis] = inside[axis] - a[axis];
        }
        float volume = to[0] * (e[1] * f[2] - e[2] * f[1]) + to[1] * (e[2] * f[0] - e[0] * f[2]) +
                       to[2] * (e[0] * f[1] - e[1] * f[0]);
        assert_true(volume < 0);
    }
    close_mesh(mesh);
}

static void infinite_vertices_of_a_glb_are_dropped(void **state) {
    (void)state;
    byte_list file = {.length = 0};
    sample_glb(&file, "");
    float bad = NAN;
    memcpy(file.bytes + file.length - 72 + 36, &bad, sizeof bad); // the vertex that three triangles share
    kdr_mesh *mesh = read_bytes("t.glb", file.bytes, file.length);
    assert_int_equal(mesh->triangle_count, 1);
    assert_int_equal(mesh->dropped_count, 3);
    assert_int_equal(mesh->dropped_vertex_count, 1);
    close_mesh(mesh);
}

static void an_off_file_has_no_materials(void **state) {
    (void)state;
    kdr_mesh *mesh = read_text("t.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n");
    assert_int_equal(mesh->triangle_count, 2);
    assert_string_equal(mesh->format, "OFF");
    close_mesh(mesh);
}

static void a_vertex_number_beyond_the_vertices_names_its_byte(void **state) {
    (void)state;
    byte_list file = {.length = 0};
    sample_glb(&file, "");
    file.bytes[file.length - 1] = 0xff;
    char part[80];
    snprintf(part, sizeof part, "byte %zu: expected a vertex number below 4, found 65283", file.length - 2);
    assert_refused("t.glb", file.bytes, file.length, KDR_ERROR_INVALID_DATA, part);
}

/* Most damage makes assimp refuse the file; what it lets through must still be a sound mesh. */
static void a_damaged_glb_is_refused_or_read_soundly(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 6);
    byte_list file = {.length = 0};
    sample_glb(&file, "");
    for (int run = 0; run < TEST_SIZE(3000); run++) {
        byte_list changed = file;
        if (run % 4 == 0)
            changed.length = test_random_below(&random, (uint32_t)file.length);
        else
            changed.bytes[test_random_below(&random, (uint32_t)file.length)] ^= (unsigned char)(1u << run % 8);
        kdr_mesh *mesh;
        kdr_status status = try_bytes("t.glb", changed.bytes, changed.length, &mesh);
        assert_int_equal(heard.errors, status != KDR_OK);
        if (status == KDR_OK)
            check_promise(mesh);
        kdr_mesh_destroy(mesh);
        assert_int_equal(kdr_render_bytes(), 0);
    }
}

/* assimp's own memory cannot be made to fail; the mesh's and the files' can. */
static void every_allocation_that_fails_leaves_nothing(void **state) {
    (void)state;
    failing_alloc failing;
    failing_alloc_init(&failing);
    kdr_allocator functions = failing_alloc_functions(&failing);
    kdr_mesh_memory_replace(&functions);
    byte_list file = {.length = 0};
    sample_glb(&file, "");
    kdr_mesh *mesh = read_bytes("t.glb", file.bytes, file.length);
    uint64_t calls = atomic_load(&failing.calls);
    kdr_mesh_destroy(mesh);
    assert_true(calls >= 5);
    for (uint64_t n = 1; n <= calls; n++) {
        failing_alloc_fail_nth(&failing, n);
        if (try_bytes("t.glb", file.bytes, file.length, &mesh) == KDR_OK)
            check_promise(mesh);
        else
            assert_int_equal(heard.errors, 1);
        kdr_mesh_destroy(mesh);
        assert_int_equal(kdr_render_bytes(), 0);
        assert_true(failing_alloc_is_clean(&failing));
    }
    kdr_mesh_memory_replace(NULL);
}

static void what_assimp_refuses_is_told_in_one_sentence(void **state) {
    (void)state;
    assert_text_refused("t.off", "OFF nonsense\n", "expected a file that assimp reads");
    assert_text_refused("t.off", "", "byte 0: expected a mesh file, found an empty one");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_glb_is_read_with_its_material_and_without_the_default_one),
        cmocka_unit_test(content_tells_a_glb_under_any_name),
        cmocka_unit_test(transforms_of_nodes_are_applied),
        cmocka_unit_test(a_mirroring_transform_keeps_the_outside_outside),
        cmocka_unit_test(infinite_vertices_of_a_glb_are_dropped),
        cmocka_unit_test(an_off_file_has_no_materials),
        cmocka_unit_test(a_vertex_number_beyond_the_vertices_names_its_byte),
        cmocka_unit_test(a_damaged_glb_is_refused_or_read_soundly),
        cmocka_unit_test(every_allocation_that_fails_leaves_nothing),
        cmocka_unit_test(what_assimp_refuses_is_told_in_one_sentence),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#else

static void without_assimp_a_glb_is_refused_in_one_sentence(void **state) {
    (void)state;
    byte_list file = {.length = 0};
    sample_glb(&file, "");
    assert_refused("t.glb", file.bytes, file.length, KDR_ERROR_UNSUPPORTED, "is glTF");
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(without_assimp_a_glb_is_refused_in_one_sentence)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#endif
