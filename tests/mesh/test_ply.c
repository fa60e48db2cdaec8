#include "mesh/samples.h"

static void a_tetrahedron_reads_the_same_in_all_three_formats(void **state) {
    (void)state;
    for (int form = 0; form < 3; form++) {
        byte_list file = {.length = 0};
        if (form == 0)
            sample_ply_ascii(&file);
        else
            sample_ply_binary(&file, form == 2);
        kdr_mesh *mesh = read_bytes("t.ply", file.bytes, file.length);
        assert_positions(mesh, 4, tetrahedron_positions);
        assert_indices(mesh, 4, tetrahedron_indices);
        assert_null(mesh->normals);
        assert_null(mesh->triangle_materials);
        assert_int_equal(heard.warnings, 0);
        static const char *const formats[] = {"PLY ascii", "PLY binary little endian", "PLY binary big endian"};
        assert_string_equal(mesh->format, formats[form]);
        close_mesh(mesh);
    }
}

static const char *const type_names[][2] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
                                            {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                                            {"float", "float32"}, {"double", "float64"}};

/* A whole number as any scalar type. */
static void put_scalar(byte_list *file, int type, int value, bool big) {
    if (type < 2)
        put_u8(file, (uint8_t)value);
    else if (type < 4)
        put_u16(file, (uint16_t)value, big);
    else if (type < 6)
        put_u32(file, (uint32_t)value, big);
    else if (type == 6)
        put_f32(file, (float)value, big);
    else
        put_f64(file, value, big);
}

static void every_scalar_type_and_order_of_properties_is_read(void **state) {
    (void)state;
    static const float wanted[3][3] = {{1, 2, 3}, {4, 5, 6}, {7, 8, 100}};
    static const uint32_t triangle[1][3] = {{2, 1, 0}};
    for (int type = 0; type < 8; type++) {
        for (int count_type = 0; count_type < 6; count_type++) {
            for (int index_type = 0; index_type < 8; index_type++) {
                bool big = (type + count_type + index_type) % 2;
                byte_list file = {.length = 0};
                char header[600];
                snprintf(header, sizeof header,
                         "ply\nformat binary_%s_endian 1.0\nelement vertex 3\nproperty short red\nproperty %s z\n"
                         "property double quality\nproperty %s x\nproperty %s y\nelement face 1\nproperty float area\n"
                         "property list %s %s vertex_index\nproperty uchar flags\nend_header\n",
                         big ? "big" : "little", type_names[type][0], type_names[type][1], type_names[type][0],
                         type_names[count_type][1], type_names[index_type][0]);
                put_text(&file, header);
                for (int i = 0; i < 3; i++) {
                    put_u16(&file, 77, big);
                    put_scalar(&file, type, (int)wanted[i][2], big);
                    put_f64(&file, 0.5, big);
                    put_scalar(&file, type, (int)wanted[i][0], big);
                    put_scalar(&file, type, (int)wanted[i][1], big);
                }
                put_f32(&file, 9, big);
                put_scalar(&file, count_type, 3, big);
                for (int i = 0; i < 3; i++)
                    put_scalar(&file, index_type, (int)triangle[0][i], big);
                put_u8(&file, 1);
                kdr_mesh *mesh = read_bytes("t.ply", file.bytes, file.length);
                assert_positions(mesh, 3, wanted);
                assert_indices(mesh, 1, triangle);
                close_mesh(mesh);
            }
        }
    }
}

static void other_elements_and_lists_are_passed_over(void **state) {
    (void)state;
    static const float wanted[3][3] = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
    static const uint32_t triangle[1][3] = {{0, 1, 2}};
    kdr_mesh *mesh = read_text(
        "t.ply", "ply\r\nformat ascii 1.0\r\nobj_info by hand\r\nelement camera 2\r\nproperty list int float matrix\r\n"
                 "element vertex 3\r\nproperty list uchar int seen_by\r\nproperty float x\r\nproperty float y\r\n"
                 "property float z\r\nelement edge 1\r\nproperty int a\r\nproperty int b\r\nelement face 1\r\n"
                 "property list uchar float texcoord\r\nproperty list uchar int vertex_indices\r\n"
                 "element nothing 5000000000\r\nend_header\r\n"
                 "2 0.5 0.5\r\n0\r\n\r\n2 8 9 1 2 3\r\n0 4 5 6\r\n1 7 7 8 9\r\n0 1\r\n6 0 0 0 0 0 0 3 0 1 2\r\n");
    assert_positions(mesh, 3, wanted);
    assert_indices(mesh, 1, triangle);
    assert_int_equal(heard.warnings, 0);
    close_mesh(mesh);
}

static void faces_before_the_vertices_are_cut_by_their_shape(void **state) {
    (void)state;
    // An arrow head: the last corner looks inward, and a fan from the first one would reach outside.
    static const uint32_t wanted[2][3] = {{3, 0, 1}, {1, 2, 3}};
    kdr_mesh *mesh =
        read_text("t.ply", "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\n"
                           "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                           "end_header\n4 0 1 2 3\n-2 -2 0\n2 0 0\n-2 2 0\n-1 0 0\n");
    assert_indices(mesh, 2, wanted);
    close_mesh(mesh);
}

static void polygons_become_triangles_and_shorter_faces_are_told(void **state) {
    (void)state;
    static const uint32_t wanted[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {4, 3, 2}};
    byte_list file = {.length = 0};
    put_text(&file, "ply\nformat binary_little_endian 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
                    "property float z\nelement face 4\nproperty list uchar uint vertex_indices\nend_header\n");
    static const float pentagon[5][3] = {{0, 0, 0}, {2, 0, 0}, {3, 2, 0}, {1, 3, 0}, {-1, 2, 0}};
    for (int i = 0; i < 15; i++)
        put_f32(&file, pentagon[i / 3][i % 3], false);
    put_u8(&file, 5);
    for (uint32_t i = 0; i < 5; i++)
        put_u32(&file, i, false);
    put_u8(&file, 2);
    put_u32(&file, 0, false);
    put_u32(&file, 1, false);
    put_u8(&file, 0);
    put_u8(&file, 3);
    for (uint32_t i = 0; i < 3; i++)
        put_u32(&file, 4 - i, false);
    kdr_mesh *mesh = read_bytes("t.ply", file.bytes, file.length);
    assert_indices(mesh, 4, wanted);
    assert_int_equal(heard.warnings, 1);
    assert_string_equal(heard.warning, "t.ply: 2 faces of fewer than three corners were passed over");
    close_mesh(mesh);
}

static void strips_face_one_side_and_begin_again_after_minus_one(void **state) {
    (void)state;
    static const uint32_t wanted[4][3] = {{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {0, 2, 4}};
    kdr_mesh *mesh = read_text("t.ply", "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
                                        "property float z\nelement tristrips 1\nproperty list int int vertex_indices\n"
                                        "end_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n9 0 1 2 3 4 -1 0 2 4\n");
    assert_indices(mesh, 4, wanted);
    close_mesh(mesh);
}

static void normals_are_made_unit_length_and_filled_in_where_they_are_zero(void **state) {
    (void)state;
    static const float wanted[4][3] = {{0, 0, 1}, {0, 1, 0}, {0, 0, 1}, {0.6f, 0, 0.8f}};
    kdr_mesh *mesh = read_text("t.ply", "ply\nformat ascii 1.0\nelement vertex 4\nproperty float nx\nproperty float x\n"
                                        "property float ny\nproperty float y\nproperty float nz\nproperty float z\n"
                                        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                                        "0 0 0 0 0 0\n0 1 7 0 0 0\nnan 0 0 1 0 0\n3 5 0 5 4 5\n3 0 1 2\n");
    for (int i = 0; i < 12; i++)
        assert_true(fabsf(mesh->normals[i] - wanted[i / 3][i % 3]) < 1e-6f);
    close_mesh(mesh);
}

static void triangles_of_infinite_vertices_are_dropped_counted_and_told(void **state) {
    (void)state;
    static const uint32_t wanted[1][3] = {{0, 1, 2}};
    kdr_mesh *mesh =
        read_text("t.ply", "ply\nformat ascii 1.0\nelement vertex 7\nproperty double x\nproperty double y\n"
                           "property double z\nelement face 4\nproperty list uchar int vertex_indices\n"
                           "end_header\n0 0 0\n1 0 0\n0 1 0\nnan 0 0\n0 -inf 0\n0 0 1e39\n-NaN 1 1\n"
                           "3 0 1 3\n3 0 1 2\n3 3 4 1\n3 5 0 1\n");
    assert_indices(mesh, 1, wanted);
    assert_int_equal(mesh->dropped_count, 3);
    assert_int_equal(mesh->dropped_vertex_count, 3); // the last vertex harms no triangle
    assert_int_equal(mesh->vertex_count, 7);
    assert_int_equal(heard.warnings, 1);
    assert_string_equal(heard.warning, "t.ply: 3 of 4 triangles were dropped: 3 of their vertices are not finite");
    float bounds[6];
    kdr_mesh_bounds(mesh, bounds);
    assert_true(bounds[0] == 0 && bounds[3] == 1 && bounds[4] == 1 && bounds[5] == 0);
    close_mesh(mesh);
}

static void a_mesh_without_triangles_or_vertices_is_read(void **state) {
    (void)state;
    kdr_mesh *mesh = read_text("t.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                                        "property float z\nend_header\n1 2 3");
    assert_int_equal(mesh->vertex_count, 1);
    assert_int_equal(mesh->triangle_count, 0);
    float bounds[6];
    kdr_mesh_bounds(mesh, bounds);
    assert_true(bounds[0] > bounds[3]);
    close_mesh(mesh);
    mesh = read_text("t.ply", "ply\nformat binary_little_endian 1.0\nend_header\n");
    assert_int_equal(mesh->vertex_count + mesh->triangle_count, 0);
    close_mesh(mesh);
}

static void bytes_after_the_last_element_are_told(void **state) {
    (void)state;
    byte_list file = {.length = 0};
    sample_ply_binary(&file, false);
    put_text(&file, "more");
    kdr_mesh *mesh = read_bytes("t.ply", file.bytes, file.length);
    assert_string_equal(heard.warning, "t.ply: 4 bytes after the last element are passed over");
    close_mesh(mesh);
}

#define VERTICES                                                                                                       \
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
#define HEAD VERTICES "property list uchar int vertex_indices\nend_header\n"

static void a_wrong_header_names_its_line_and_what_was_expected(void **state) {
    (void)state;
    assert_text_refused("t.ply", "play\n", "line 1: expected 'ply'");
    assert_text_refused("t.ply", "ply\nformat ascii 1.0\n", "line 3: expected 'end_header', the file ends");
    assert_text_refused("t.ply", "ply\nelement vertex 1\nend_header\n", "line 3: expected a line 'format'");
    assert_text_refused("t.ply", "ply\nformat text 1.0\n", "line 2: expected ascii, binary_little_endian or");
    assert_text_refused("t.ply", "ply\nformat ascii 1.0\nelement vertex -2\n", "line 3: expected an element's name");
    assert_text_refused("t.ply", "ply\nformat ascii 1.0\nelement vertex x\n", "found 'x'");
    assert_text_refused("t.ply", "ply\nformat ascii 1.0\nelement a 1\nelement a 1\n",
                        "line 4: expected another element");
    assert_text_refused("t.ply", "ply\nformat ascii 1.0\nproperty int a\n", "line 3: expected an element before");
    assert_text_refused("t.ply", "ply\nformat ascii 1.0\nelement a 1\nproperty integer b\n", "found 'integer'");
    assert_text_refused("t.ply", "ply\nformat ascii 1.0\nelement a 1\nproperty list float int b\n", "a whole type");
    assert_text_refused("t.ply", "ply\nformat ascii 1.0\nelement a 1\nproperty int\n", "line 4: expected a property's");
    assert_text_refused("t.ply", "ply\nformat ascii 1.0\nvertices 3\n", "line 3: expected comment, format, element");
    assert_text_refused("t.ply", "ply\nformat ascii 1.0 again\n",
                        "line 2: expected the end of the line, found 'again'");
    assert_text_refused("t.ply", VERTICES "property int v\nend_header\n0 0 0\n1 0 0\n0 1 0\n3\n",
                        "line 7: expected 'face' to have a list");
    assert_text_refused("t.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n",
                        "line 3: expected vertices to have a number 'y'");
    const char *version = "ply\nformat ascii 2.0\n";
    assert_refused("t.ply", version, strlen(version), KDR_ERROR_UNSUPPORTED, "expected PLY version 1.0, found '2.0'");
}

static void a_wrong_text_body_names_its_line_and_what_was_expected(void **state) {
    (void)state;
    assert_text_refused("t.ply", HEAD "0 0 0\n1 0\n0 1 0\n3 0 1 2\n", "line 11: expected a number, found the end");
    assert_text_refused("t.ply", HEAD "0 0 0\n1 0 0 4\n0 1 0\n3 0 1 2\n", "line 11: expected the end of the line");
    assert_text_refused("t.ply", HEAD "0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n", "line 11: expected a number, found 'x'");
    assert_text_refused("t.ply", HEAD "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
                        "line 13: expected a vertex number below 3, found 3");
    assert_text_refused("t.ply", HEAD "0 0 0\n1 0 0\n0 1 0\n3 0 -1 2\n", "found -1");
    assert_text_refused("t.ply", HEAD "0 0 0\n1 0 0\n0 1 0\n3 0 0.5 2\n", "found 0.5");
    assert_text_refused("t.ply", HEAD "0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n",
                        "line 13: expected the count of a list, found -3");
    assert_text_refused("t.ply", HEAD "0 0 0\n1 0 0\n0 1 0\nnan 0 1 2\n", "expected the count of a list, found nan");
    assert_text_refused("t.ply", HEAD "0 0 0\n1 0 0\n0 1 0\n900 0 1 2\n", "line 13: expected a list of 900 values");
    assert_text_refused("t.ply", HEAD "0 0 0\n1 0 0\n0 1 0\n\n\n", "row 1 of 1 of 'face'");
}

static void a_wrong_binary_body_names_its_byte_and_what_was_expected(void **state) {
    (void)state;
    byte_list file = {.length = 0};
    sample_ply_binary(&file, false);
    char part[120];
    size_t faces = file.length - 4 * 13;

    snprintf(part, sizeof part, "byte %zu: expected a vertex number below 4, found 4", faces + 13 + 5);
    byte_list wrong = file;
    wrong.bytes[faces + 13 + 5] = 4;
    assert_refused("t.ply", wrong.bytes, wrong.length, KDR_ERROR_INVALID_DATA, part);
    wrong.bytes[faces + 13 + 8] = 0xff;
    assert_refused("t.ply", wrong.bytes, wrong.length, KDR_ERROR_INVALID_DATA, "found -16777212");

    wrong = file;
    wrong.bytes[faces + 26] = 200;
    snprintf(part, sizeof part, "byte %zu: expected a list of 200 values, 25 bytes are left of the file", faces + 26);
    assert_refused("t.ply", wrong.bytes, wrong.length, KDR_ERROR_INVALID_DATA, part);

    snprintf(part, sizeof part, "byte %zu: expected 4 rows of 'vertex', 12 bytes or more each; 47 bytes are left",
             faces - 48);
    assert_refused("t.ply", file.bytes, faces - 1, KDR_ERROR_INVALID_DATA, part);
}

static void a_huge_count_in_a_small_file_takes_no_memory(void **state) {
    (void)state;
    static const char *const counts[] = {"4000000000", "1000000000000000000", "9223372036854775807",
                                         "99999999999999999999"};
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        for (int binary = 0; binary < 2; binary++) {
            char text[400];
            const char *format = binary ? "binary_little_endian" : "ascii";
            snprintf(text, sizeof text,
                     "ply\nformat %s 1.0\nelement vertex %s\nproperty float x\nproperty float y\nproperty float z\n"
                     "end_header\n0 0 0\n",
                     format, counts[i]);
            atomic_store(&kdr_mesh_memory()->peak_bytes, 0);
            assert_text_refused("t.ply", text, "expected");
            snprintf(
                text, sizeof text,
                "ply\nformat %s 1.0\nelement face %s\nproperty list uchar int vertex_indices\nend_header\n3 0 0 0\n",
                format, counts[i]);
            assert_text_refused("t.ply", text, "expected");
            assert_true(kdr_mesh_memory()->peak_bytes < 4096);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tetrahedron_reads_the_same_in_all_three_formats),
        cmocka_unit_test(every_scalar_type_and_order_of_properties_is_read),
        cmocka_unit_test(other_elements_and_lists_are_passed_over),
        cmocka_unit_test(faces_before_the_vertices_are_cut_by_their_shape),
        cmocka_unit_test(polygons_become_triangles_and_shorter_faces_are_told),
        cmocka_unit_test(strips_face_one_side_and_begin_again_after_minus_one),
        cmocka_unit_test(normals_are_made_unit_length_and_filled_in_where_they_are_zero),
        cmocka_unit_test(triangles_of_infinite_vertices_are_dropped_counted_and_told),
        cmocka_unit_test(a_mesh_without_triangles_or_vertices_is_read),
        cmocka_unit_test(bytes_after_the_last_element_are_told),
        cmocka_unit_test(a_wrong_header_names_its_line_and_what_was_expected),
        cmocka_unit_test(a_wrong_text_body_names_its_line_and_what_was_expected),
        cmocka_unit_test(a_wrong_binary_body_names_its_byte_and_what_was_expected),
        cmocka_unit_test(a_huge_count_in_a_small_file_takes_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
