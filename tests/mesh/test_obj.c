#include "mesh/samples.h"

static void a_tetrahedron_with_normals_splits_vertices_only_where_they_differ(void **state) {
    (void)state;
    byte_list file = {.length = 0};
    sample_obj(&file);
    kdr_mesh *mesh = read_bytes("t.obj", file.bytes, file.length);
    assert_int_equal(mesh->triangle_count, 4);
    assert_int_equal(mesh->vertex_count, 12); // three faces with three normals meet in every vertex
    static const float face_normals[4][3] = {
        {0, 0, -1}, {0, -1, 0}, {-1, 0, 0}, {0.57735027f, 0.57735027f, 0.57735027f}};
    for (size_t i = 0; i < 12; i++) {
        size_t vertex = mesh->indices[i];
        for (size_t axis = 0; axis < 3; axis++) {
            assert_true(mesh->positions[3 * vertex + axis] ==
                        tetrahedron_positions[tetrahedron_indices[i / 3][i % 3]][axis]);
            assert_true(fabsf(mesh->normals[3 * vertex + axis] - face_normals[i / 3][axis]) < 1e-6f);
        }
    }
    assert_int_equal(mesh->material_count, 2);
    assert_string_equal(mesh->materials[0].name, "red");
    assert_string_equal(mesh->materials[1].name, "blue");
    assert_true(mesh->materials[0].diffuse[1] == 0.8f);
    static const uint32_t materials[4] = {0, 0, 1, 1};
    assert_memory_equal(mesh->triangle_materials, materials, sizeof materials);
    assert_string_equal(mesh->format, "OBJ");
    close_mesh(mesh);
}

static void equal_normals_do_not_split_a_vertex(void **state) {
    (void)state;
    static const uint32_t wanted[2][3] = {{0, 1, 2}, {0, 2, 3}};
    kdr_mesh *mesh = read_text("t.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvn 0 0 1\nvn 0 0 1\n"
                                        "f 1//1 2//1 3//2\nf 1//3 3//-1 4//2\n");
    assert_indices(mesh, 2, wanted);
    assert_int_equal(mesh->vertex_count, 4);
    close_mesh(mesh);
}

static void corners_without_a_normal_get_that_of_the_triangles(void **state) {
    (void)state;
    kdr_mesh *mesh = read_text("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1 0 0\nf 1 2 3\nf 1//1 2//1 3\n");
    assert_int_equal(mesh->vertex_count, 5);
    static const float wanted[5][3] = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {1, 0, 0}, {1, 0, 0}};
    for (int i = 0; i < 15; i++)
        assert_true(mesh->normals[i] == wanted[i / 3][i % 3]);
    close_mesh(mesh);
}

static void all_forms_of_corners_and_numbers_are_read(void **state) {
    (void)state;
    static const float positions[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    static const uint32_t wanted[10][3] = {{0, 1, 2}, {0, 1, 2}, {0, 1, 2}, {0, 1, 2}, {0, 1, 2},
                                           {0, 1, 2}, {1, 2, 3}, {0, 1, 2}, {0, 2, 3}, {3, 0, 2}};
    kdr_mesh *mesh =
        read_text("t.obj", "\xef\xbb\xbfv 0 0 0 1.0\r\nv 1 0 0 0.5 0.5 0.5\r\nv\t1  1 0\r\nv 0 \\\r\n 1 0 # last\r\n"
                           "vt 0 0\r\nvt 1 1\r\nvn 0 0 1\r\ng one\r\ns off\r\n"
                           "f 1 2 3\r\nf 1/1 2/2 3/1\r\nf 1/1/1 2/2/1 3/1/1\r\nf 1//1 2//1 3//1\r\n"
                           "f 1/ 2/ 3/\r\nf 1// 2// 3//\r\nf -3 -2 -1\r\nf 1 2 \\\n3 4 # square\r\n"
                           "f 4 1/-1 3/-2/-1");
    assert_int_equal(mesh->triangle_count, 10);
    for (size_t i = 0; i < 30; i++) // corners with and without a normal lie on vertices of their own
        assert_memory_equal(mesh->positions + 3 * (size_t)mesh->indices[i], positions[wanted[i / 3][i % 3]], 12);
    assert_int_equal(mesh->vertex_count, 4 + 3);
    close_mesh(mesh);
}

static void a_face_may_name_vertices_that_come_later(void **state) {
    (void)state;
    static const uint32_t wanted[2][3] = {{0, 1, 2}, {0, 2, 3}};
    kdr_mesh *mesh = read_text("t.obj", "f 1 2 3 4\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n");
    assert_indices(mesh, 2, wanted);
    close_mesh(mesh);
}

static void concave_polygons_are_cut_inside_and_keep_their_normals(void **state) {
    (void)state;
    static const uint32_t wanted[2][3] = {{3, 0, 1}, {1, 2, 3}};
    kdr_mesh *mesh = read_text("t.obj", "v -2 -2 0\nv 2 0 0\nv -2 2 0\nv -1 0 0\nvn 0 0 1\nvn 0 1 0\nvn 1 0 0\n"
                                        "vn 0 0 -1\nf 1//1 2//2 3//3 4//4\n");
    assert_indices(mesh, 2, wanted);
    static const float normals[4][3] = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}, {0, 0, -1}};
    assert_memory_equal(mesh->normals, normals, sizeof normals);
    close_mesh(mesh);
}

static void triangles_before_the_first_material_have_one_without_a_name(void **state) {
    (void)state;
    kdr_mesh *mesh =
        read_text("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl  old brick \nf 3 2 1\nusemtl glass\n"
                           "usemtl old brick\nf 2 1 3\nf 1 2\nf\n");
    static const uint32_t materials[3] = {0, 1, 1};
    assert_int_equal(mesh->triangle_count, 3);
    assert_memory_equal(mesh->triangle_materials, materials, sizeof materials);
    assert_int_equal(mesh->material_count, 3);
    assert_string_equal(mesh->materials[0].name, "");
    assert_string_equal(mesh->materials[1].name, "old brick");
    assert_string_equal(heard.warning, "t.obj: 2 faces of fewer than three corners were passed over");
    close_mesh(mesh);
}

static void a_thousand_materials_are_told_apart(void **state) {
    (void)state;
    size_t length = 0, room = 64000;
    char *text = malloc(room);
    assert_non_null(text);
    length += (size_t)snprintf(text, room, "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    for (int i = 0; i < 2000; i++)
        length += (size_t)snprintf(text + length, room - length, "usemtl m%d\nf 1 2 3\n", i % 1000);
    kdr_mesh *mesh = read_bytes("t.obj", text, length);
    free(text);
    assert_int_equal(mesh->material_count, 1000);
    for (uint32_t i = 0; i < 2000; i++) {
        char name[16];
        snprintf(name, sizeof name, "m%u", i % 1000);
        assert_string_equal(mesh->materials[mesh->triangle_materials[i]].name, name);
    }
    close_mesh(mesh);
}

#define OBJ "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red paint\nf 1 2 3\nusemtl blue\nf 1 3 2\n"

static kdr_mesh *read_with_library(const char *folder, const char *line) {
    char path[128], text[400];
    snprintf(text, sizeof text, "%s\n" OBJ, line);
    write_file(folder, "m.obj", text, strlen(text), path);
    heard = (told){0};
    kdr_mesh *mesh;
    assert_int_equal(kdr_mesh_read(path, &hearing, &mesh), KDR_OK);
    unlink(path);
    return mesh;
}

static void material_files_beside_the_mesh_give_colours(void **state) {
    (void)state;
    char folder[64], colours[128], more[128];
    make_folder(folder);
    const char *text = "# colours\nnewmtl red paint\nNs 10\nKd 1 0.25 2\nnewmtl unused\nKd 0 0 0\n";
    write_file(folder, "two words.mtl", text, strlen(text), colours);
    text = "newmtl blue\r\nKd 0 0 \\\r\n -1\r\nKd one two\r\n";
    write_file(folder, "more.mtl", text, strlen(text), more);

    static const float red[3] = {1, 0.25f, 1}, blue[3] = {0, 0, 0}, grey[3] = {0.8f, 0.8f, 0.8f};
    kdr_mesh *mesh = read_with_library(folder, "mtllib two words.mtl\nmtllib more.mtl none.mtl");
    assert_memory_equal(mesh->materials[0].diffuse, red, sizeof red);
    assert_memory_equal(mesh->materials[1].diffuse, blue, sizeof blue);
    assert_int_equal(heard.warnings, 2);
    assert_non_null(strstr(heard.warning, "line 2: material file 'none.mtl' cannot be read"));
    close_mesh(mesh);

    mesh = read_with_library(folder, "mtllib .\\two words.mtl");
    assert_memory_equal(mesh->materials[0].diffuse, red, sizeof red);
    assert_memory_equal(mesh->materials[1].diffuse, grey, sizeof grey);
    assert_int_equal(heard.warnings, 0);
    close_mesh(mesh);

    // What is no file is not opened: a device or a directory must not make the reader wait.
    mesh = read_with_library(folder, "mtllib /dev/zero");
    assert_int_equal(heard.warnings, 1);
    close_mesh(mesh);
    mesh = read_with_library(folder, "mtllib .");
    assert_int_equal(heard.warnings, 1);
    close_mesh(mesh);
    unlink(colours);
    unlink(more);
    assert_int_equal(rmdir(folder), 0);
}

static void a_file_that_names_itself_as_its_materials_is_read_a_few_times_only(void **state) {
    (void)state;
    char folder[64], lines[100 * 14 + 1] = "";
    make_folder(folder);
    for (int i = 0; i < 100; i++)
        strcat(lines, "mtllib m.obj\n");
    char path[128], text[2000];
    snprintf(text, sizeof text, "%s" OBJ, lines);
    write_file(folder, "m.obj", text, strlen(text), path);
    heard = (told){0};
    kdr_mesh *mesh;
    assert_int_equal(kdr_mesh_read(path, &hearing, &mesh), KDR_OK);
    assert_int_equal(heard.warnings, 1);
    assert_non_null(strstr(heard.warning, "line 65: more than 64 material files"));
    close_mesh(mesh);
    unlink(path);
    assert_int_equal(rmdir(folder), 0);
}

static void a_wrong_line_is_named_with_what_was_expected(void **state) {
    (void)state;
    assert_text_refused("t.obj", "v 0 0 0\nv 1 2\n",
                        "line 2: expected three numbers of a vertex, found the end of the");
    assert_text_refused("t.obj", "v 0 0 z\n", "line 1: expected three numbers of a vertex, found 'z'");
    assert_text_refused("t.obj", "vn 0 0\n", "line 1: expected three numbers of a normal");
    assert_text_refused("t.obj", "v 0 0 0\n\n# c\nf 1 0 1\n",
                        "line 4: expected the number of a vertex (1 and up, or -1");
    assert_text_refused("t.obj", "v 0 0 0\nf 1 1 -2\n",
                        "line 2: expected the number of a vertex (1 and up, or -1 and "
                        "down), 1 came before, found -2");
    assert_text_refused("t.obj", "v 0 0 0\nf 1 1 1\nf 1 3 1\nf 1 2 1\n",
                        "line 3: expected the number of a vertex, the file has 1, found 3");
    assert_text_refused("t.obj", "v 0 0 0\nvt 0 0\nf 1/1 1/2 1/1\n", "the number of a texture vertex, the file has 1");
    assert_text_refused("t.obj", "v 0 0 0\nf 1//1 1//1 1//1\n", "the number of a normal, the file has 0, found 1");
    assert_text_refused("t.obj", "v 0 0 0\nf 1//-1 1 1\n", "the number of a normal (1 and up, or -1 and down), 0 came");
    assert_text_refused("t.obj", "v 0 0 0\nf 1 a 1\n",
                        "line 2: expected a corner (v, v/vt, v//vn or v/vt/vn), found 'a'");
    assert_text_refused("t.obj", "v 0 0 0\nf 1/1/1/1 1 1\n", "expected");
    assert_text_refused("t.obj", "v 0 0 0\nf 1 1 99999999999999999999\n", "expected a corner");
    assert_text_refused("t.obj", "v 0 0 0\nf 1 1 4294967296\n", "found 4294967296");
    assert_text_refused("t.obj", "v 0 0 0\nf 1 \\\n 1 \\\n 7x\n", "line 4: expected a corner");
    assert_text_refused("t.obj", "\nnot a mesh at all\n", "line 2: expected a keyword of an OBJ file");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tetrahedron_with_normals_splits_vertices_only_where_they_differ),
        cmocka_unit_test(equal_normals_do_not_split_a_vertex),
        cmocka_unit_test(corners_without_a_normal_get_that_of_the_triangles),
        cmocka_unit_test(all_forms_of_corners_and_numbers_are_read),
        cmocka_unit_test(a_face_may_name_vertices_that_come_later),
        cmocka_unit_test(concave_polygons_are_cut_inside_and_keep_their_normals),
        cmocka_unit_test(triangles_before_the_first_material_have_one_without_a_name),
        cmocka_unit_test(a_thousand_materials_are_told_apart),
        cmocka_unit_test(material_files_beside_the_mesh_give_colours),
        cmocka_unit_test(a_file_that_names_itself_as_its_materials_is_read_a_few_times_only),
        cmocka_unit_test(a_wrong_line_is_named_with_what_was_expected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
