#include "mesh/samples.h"

static void assert_tetrahedron(kdr_mesh *mesh, const char *format) {
    assert_int_equal(mesh->vertex_count, 4); // equal vertices are one
    assert_int_equal(mesh->triangle_count, 4);
    for (size_t i = 0; i < 12; i++)
        for (size_t axis = 0; axis < 3; axis++)
            assert_true(mesh->positions[3 * (size_t)mesh->indices[i] + axis] ==
                        tetrahedron_positions[tetrahedron_indices[i / 3][i % 3]][axis]);
    assert_string_equal(mesh->format, format);
    assert_null(mesh->normals);
    close_mesh(mesh);
}

static void a_binary_file_that_begins_with_solid_is_read_by_its_length(void **state) {
    (void)state;
    byte_list file = {.length = 0};
    sample_stl_binary(&file);
    assert_tetrahedron(read_bytes("t.stl", file.bytes, file.length), "STL binary");
    assert_tetrahedron(read_bytes("no ending", file.bytes, file.length), "STL binary");
    assert_int_equal(heard.warnings, 0);
}

static void a_text_file_is_read(void **state) {
    (void)state;
    byte_list file = {.length = 0};
    sample_stl_ascii(&file);
    assert_tetrahedron(read_bytes("t.stl", file.bytes, file.length), "STL ascii");
    assert_tetrahedron(read_bytes("t.obj", file.bytes, file.length), "STL ascii");
}

static void several_solids_in_any_case_are_one_mesh(void **state) {
    (void)state;
    kdr_mesh *mesh = read_text("t.stl", "\r\n SOLID\r\nFacet Normal nan nan nan\r\nOUTER LOOP\r\nvertex 0 0 0\r\n"
                                        "VERTEX 1 0 0\r\nvertex 0 1e0 0 \r\nendloop endfacet\r\nENDSOLID\r\n"
                                        "solid facet\nendsolid facet\nsolid b\nfacet\nouter loop\nvertex 0 0 1\n"
                                        "vertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid");
    static const uint32_t wanted[2][3] = {{0, 1, 2}, {3, 1, 2}};
    assert_indices(mesh, 2, wanted);
    close_mesh(mesh);
}

static void bytes_after_the_last_triangle_are_told(void **state) {
    (void)state;
    byte_list file = {.length = 0};
    sample_stl_binary(&file);
    put_text(&file, "tail");
    assert_tetrahedron(read_bytes("t.stl", file.bytes, file.length), "STL binary");
    assert_string_equal(heard.warning, "t.stl: 4 bytes after the last triangle are passed over");
}

static void triangles_of_infinite_vertices_are_dropped(void **state) {
    (void)state;
    byte_list file = {.length = 0};
    sample_stl_binary(&file);
    float bad = NAN;
    memcpy(file.bytes + 84 + 50 + 12, &bad, sizeof bad);
    bad = INFINITY;
    memcpy(file.bytes + 84 + 150 + 12 + 32, &bad, sizeof bad);
    kdr_mesh *mesh = read_bytes("t.stl", file.bytes, file.length);
    assert_int_equal(mesh->triangle_count, 2);
    assert_int_equal(mesh->dropped_count, 2);
    assert_int_equal(mesh->dropped_vertex_count, 2);
    assert_int_equal(heard.warnings, 1);
    close_mesh(mesh);
}

static void an_empty_mesh_is_read(void **state) {
    (void)state;
    kdr_mesh *mesh = read_text("t.stl", "solid nothing\nendsolid nothing\n");
    assert_int_equal(mesh->triangle_count, 0);
    close_mesh(mesh);
    unsigned char zeros[84] = {0};
    mesh = read_bytes("t.stl", zeros, sizeof zeros);
    assert_int_equal(mesh->triangle_count, 0);
    close_mesh(mesh);
}

static void a_wrong_file_names_its_place_and_what_was_expected(void **state) {
    (void)state;
    byte_list file = {.length = 0};
    sample_stl_binary(&file);
    assert_refused("t.stl", file.bytes, file.length - 1, KDR_ERROR_INVALID_DATA,
                   "byte 80: expected at most 3 triangles of 50 bytes in a file of 283 bytes, found 4");
    memset(file.bytes + 80, 0xff, 4);
    assert_refused("t.stl", file.bytes, file.length, KDR_ERROR_INVALID_DATA, "found 4294967295");
    assert_refused("t.stl", file.bytes, 70, KDR_ERROR_INVALID_DATA, "byte 70: expected the 84 bytes that begin");

    assert_text_refused("t.stl", "solid a\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n",
                        "line 6: expected 'vertex', found 'endloop'");
    assert_text_refused("t.stl", "solid a\nfacet\nloop\n", "line 3: expected 'outer', found 'loop'");
    assert_text_refused("t.stl", "solid a\nfacet\nouter loop\nvertex 0 y 0\n", "line 4: expected three numbers of a");
    assert_text_refused("t.stl", "solid a\n", "line 2: expected 'endsolid', found the end of the file");
    assert_text_refused("t.stl", "solid a\nendsolid a\nvertex\n", "line 3: expected 'solid', found 'vertex'");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_binary_file_that_begins_with_solid_is_read_by_its_length),
        cmocka_unit_test(a_text_file_is_read),
        cmocka_unit_test(several_solids_in_any_case_are_one_mesh),
        cmocka_unit_test(bytes_after_the_last_triangle_are_told),
        cmocka_unit_test(triangles_of_infinite_vertices_are_dropped),
        cmocka_unit_test(an_empty_mesh_is_read),
        cmocka_unit_test(a_wrong_file_names_its_place_and_what_was_expected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
