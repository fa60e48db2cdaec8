/* glTF files that move: where every vertex is at a time, against positions worked out by hand. */
#include "mesh/gltf_file.h"
#include "mesh/samples.h"
#include "support/failing_alloc.h"
#include "support/random.h"
#include "support/test_size.h"

#define MOVE(shape, path)                                                                                              \
    "\"nodes\":[{\"mesh\":0}]," TRIANGLE_MESH ",\"animations\":[{\"samplers\":[{\"input\":1,\"output\":2,"             \
    "\"interpolation\":\"" shape "\"}],\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"" path "\"}}]}]"

static gltf_file make_move(size_t width, size_t key_count, const float *times, size_t value_count,
                           const float *values) {
    gltf_file file = {0};
    add_floats(&file, 3, 3, triangle_positions);
    add_floats(&file, 1, key_count, times);
    add_floats(&file, width, value_count, values);
    return file;
}

static const float three_times[3] = {1, 2, 4}, three_places[9] = {0, 0, 0, 10, 0, 0, 20, 2, 0};

static void a_step_keeps_a_value_up_to_the_next_key(void **state) {
    (void)state;
    gltf_file file = make_move(3, 3, three_times, 3, three_places);
    kdr_animation_source source = open_file(&file, MOVE("STEP", "translation"));
    kdr_mesh *mesh = NULL;
    assert_true(source.duration == 4);
    assert_vertex(&source, 0, 1, 1, 0, 0, &mesh);
    assert_vertex(&source, 1.99, 1, 1, 0, 0, &mesh);
    assert_vertex(&source, 2, 1, 11, 0, 0, &mesh);
    assert_vertex(&source, 3.99, 1, 11, 0, 0, &mesh);
    assert_vertex(&source, 4, 2, 20, 3, 0, &mesh);
    close_animation(&source, mesh);
}

static void a_line_goes_evenly_from_key_to_key_and_stands_still_outside(void **state) {
    (void)state;
    gltf_file file = make_move(3, 3, three_times, 3, three_places);
    kdr_animation_source source = open_file(&file, MOVE("LINEAR", "translation"));
    kdr_mesh *mesh = NULL;
    assert_vertex(&source, -5, 0, 0, 0, 0, &mesh);
    assert_vertex(&source, 0.5, 0, 0, 0, 0, &mesh);
    assert_vertex(&source, 1.25, 0, 2.5f, 0, 0, &mesh);
    assert_vertex(&source, 2, 0, 10, 0, 0, &mesh);
    assert_vertex(&source, 3.5, 0, 17.5f, 1.5f, 0, &mesh);
    assert_vertex(&source, 100, 0, 20, 2, 0, &mesh);
    assert_vertex(&source, (double)INFINITY, 0, 20, 2, 0, &mesh);
    assert_int_equal(source.sample(source.state, (double)NAN, &hearing, &mesh), KDR_ERROR_INVALID_ARGUMENT);
    assert_non_null(strstr(heard.error, "expected a time, found NaN"));
    close_animation(&source, mesh);
}

static void a_cubic_follows_the_slopes_of_the_file(void **state) {
    (void)state;
    // Two keys, two seconds apart: from 0 with slope 1 to 4 with slope 3. The other slopes are of no effect.
    static const float times[2] = {1, 3}, values[18] = {9, 9, 9, 0, 0, 0, 1, 0, 0, 3, 0, 0, 4, 0, 0, 9, 9, 9};
    gltf_file file = make_move(3, 2, times, 6, values);
    kdr_animation_source source = open_file(&file, MOVE("CUBICSPLINE", "translation"));
    kdr_mesh *mesh = NULL;
    assert_vertex(&source, 0, 0, 0, 0, 0, &mesh);
    assert_vertex(&source, 1.5, 0, 0.625f + 0.28125f - 0.28125f, 0, 0, &mesh);
    assert_vertex(&source, 2, 0, 2 + 0.25f - 0.75f, 0, 0, &mesh);
    assert_vertex(&source, 3, 0, 4, 0, 0, &mesh);
    assert_vertex(&source, 7, 0, 4, 0, 0, &mesh);
    close_animation(&source, mesh);
}

static void a_rotation_turns_evenly_by_the_shorter_way(void **state) {
    (void)state;
    // A quarter turn around z; its end is also written with the other sign, which is the same rotation.
    static const float times[2] = {0, 3};
    for (int side = -1; side <= 1; side += 2) {
        const float turns[8] = {0, 0, 0, 1, 0, 0, (float)side * 0.70710678f, (float)side * 0.70710678f};
        gltf_file file = make_move(4, 2, times, 2, turns);
        kdr_animation_source source = open_file(&file, MOVE("LINEAR", "rotation"));
        kdr_mesh *mesh = NULL;
        assert_vertex(&source, 0, 1, 1, 0, 0, &mesh);
        assert_vertex(&source, 1, 1, 0.8660254f, 0.5f, 0, &mesh);
        assert_vertex(&source, 2, 1, 0.5f, 0.8660254f, 0, &mesh);
        assert_vertex(&source, 3, 2, -1, 0, 0, &mesh);
        close_animation(&source, mesh);
    }
}

static void children_move_with_their_parents(void **state) {
    (void)state;
    // The child lies at 1, 0, 0 of a parent that is turned by a quarter, twice as large, and grows to four times.
    static const float times[2] = {0, 1}, scales[6] = {2, 2, 2, 4, 4, 4};
    gltf_file file = make_move(3, 2, times, 2, scales);
    kdr_animation_source source = open_file(
        &file, "\"nodes\":[{\"mesh\":0,\"translation\":[1,0,0]},{\"children\":[0],\"rotation\":[0,0,0.70710678,"
               "0.70710678]}]," TRIANGLE_MESH ",\"animations\":[{\"samplers\":[{\"input\":1,\"output\":2}],"
               "\"channels\":[{\"sampler\":0,\"target\":{\"node\":1,\"path\":\"scale\"}}]}]");
    kdr_mesh *mesh = NULL;
    assert_vertex(&source, 0, 0, 0, 2, 0, &mesh);
    assert_vertex(&source, 0, 2, -2, 2, 0, &mesh);
    assert_vertex(&source, 0.5, 1, 0, 6, 0, &mesh);
    close_animation(&source, mesh);
}

static void joints_morphs_and_all_shapes_work_together(void **state) {
    (void)state;
    byte_list bytes;
    sample_animation(&bytes);
    kdr_animation_source source = open_animation(&bytes);
    kdr_mesh *mesh = NULL;
    // At rest: the node of a skinned mesh is without effect.
    assert_vertex(&source, 0, 0, 0, 0, 0, &mesh);
    assert_vertex(&source, 0, 1, 1, 0, 0, &mesh);
    assert_vertex(&source, 0, 2, 0, 1, 0, &mesh);
    // Half the way: joint 0 at 1.5 (as in the cubic above), joint 1 at 2.5 and turned by an eighth around itself.
    assert_vertex(&source, 1, 0, 1.5f, 0, 0, &mesh);
    assert_vertex(&source, 1, 1, 2.5f, 0, 0, &mesh);
    // Vertex 2 follows both by halves: 1.5, 1 and 2.5 + (-1, 1) turned by an eighth.
    assert_vertex(&source, 1, 2, (1.5f + 2.5f - 1.41421356f) / 2, 0.5f, 0, &mesh);
    // At the end both targets are in force, 1 and a half; deltas are added before the joints turn.
    assert_vertex(&source, 2, 0, 4, 0, 1.5f, &mesh);
    assert_vertex(&source, 2, 1, 5, 0, 3, &mesh);
    assert_vertex(&source, 2, 2, (4 + 5 - 1) / 2.0f, (1 - 1) / 2.0f, 4.5f, &mesh);
    close_animation(&source, mesh);
}

static void weights_of_a_node_take_the_place_of_its_meshs(void **state) {
    (void)state;
    static const float deltas[9] = {0, 0, 8, 0, 0, 8, 0, 0, 8};
    gltf_file file = {0};
    add_floats(&file, 3, 3, triangle_positions);
    add_floats(&file, 3, 3, deltas);
    kdr_animation_source source =
        open_file(&file, "\"nodes\":[{\"mesh\":0},{\"mesh\":0,\"weights\":[0.5]}],\"meshes\":[{\"weights\":[0.25],"
                         "\"primitives\":[{\"attributes\":{\"POSITION\":0},\"targets\":[{\"POSITION\":1}]}]}]");
    kdr_mesh *mesh = NULL;
    assert_true(source.duration == 0);
    assert_vertex(&source, 0, 0, 0, 0, 2, &mesh);
    assert_vertex(&source, 0, 3, 0, 0, 4, &mesh);
    close_animation(&source, mesh);
}

static void assert_normal(const kdr_mesh *mesh, size_t vertex, float x, float y, float z) {
    const float *found = mesh->normals + 3 * vertex;
    if (!(fabsf(found[0] - x) + fabsf(found[1] - y) + fabsf(found[2] - z) < 1e-5f))
        fail_msg("normal %zu: expected %g %g %g, found %g %g %g", vertex, (double)x, (double)y, (double)z,
                 (double)found[0], (double)found[1], (double)found[2]);
}

static void normals_follow_and_are_made_where_there_are_none(void **state) {
    (void)state;
    static const float normals[9] = {0.6f, 0, 0.8f, 0, 0, 1, 0, 0, 5};
    static const float times[2] = {0, 1}, scales[6] = {1, 1, 1, 3, 1, -1};
    gltf_file file = {0};
    add_floats(&file, 3, 3, triangle_positions);
    add_floats(&file, 1, 2, times);
    add_floats(&file, 3, 2, scales);
    add_floats(&file, 3, 3, normals);
    kdr_animation_source source = open_file(
        &file, "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":3}},"
               "{\"attributes\":{\"POSITION\":0}}]}],\"animations\":[{\"samplers\":[{\"input\":1,\"output\":2}],"
               "\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"scale\"}}]}]");
    kdr_mesh *mesh = NULL;
    sample_at(&source, 0, &mesh);
    assert_normal(mesh, 0, 0.6f, 0, 0.8f);
    assert_normal(mesh, 2, 0, 0, 1);
    assert_normal(mesh, 3, 0, 0, 1);
    sample_at(&source, 1, &mesh);
    float length = sqrtf(0.04f + 0.64f); // 0.6 / 3 and 0.8 / -1
    assert_normal(mesh, 0, 0.2f / length, 0, -0.8f / length);
    assert_normal(mesh, 1, 0, 0, -1);
    close_animation(&source, mesh);
}

static void strips_and_fans_become_triangles(void **state) {
    (void)state;
    static const float square[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
    static const uint32_t wanted[4][3] = {{0, 1, 2}, {1, 3, 2}, {5, 6, 4}, {6, 7, 4}};
    gltf_file file = {0};
    add_floats(&file, 3, 4, square);
    kdr_animation_source source = open_file(
        &file, "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"mode\":5},"
               "{\"attributes\":{\"POSITION\":0},\"mode\":6},{\"attributes\":{\"POSITION\":0},\"mode\":1}]}]");
    kdr_mesh *mesh = NULL;
    sample_at(&source, 0, &mesh);
    assert_indices(mesh, 4, wanted);
    assert_null(mesh->materials);
    close_animation(&source, mesh);
}

/* JSON around one buffer of a triangle's positions. */
static void text_of_buffer(const char *uri, const char *accessor, char *out, size_t size) {
    int length = snprintf(out, size,
                          "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"mesh\":0}]," TRIANGLE_MESH ",\"accessors\":["
                          "{\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",%s}],\"bufferViews\":[{\"buffer\":0,"
                          "\"byteLength\":36}],\"buffers\":[{\"byteLength\":36,\"uri\":\"%s\"}]}",
                          accessor, uri);
    assert_in_range(length, 1, size - 1);
}

#define BASE64_TRIANGLE "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"

static void buffers_may_be_text_or_lie_in_files(void **state) {
    (void)state;
    char text[1000], folder[64], path[128], binary_path[128];
    text_of_buffer(BASE64_TRIANGLE, "\"bufferView\":0", text, sizeof text);
    kdr_animation_source source;
    assert_int_equal(try_animation("t.gltf", text, strlen(text), &source), KDR_OK);
    kdr_mesh *mesh = NULL;
    assert_vertex(&source, 0, 1, 1, 0, 0, &mesh);
    assert_vertex(&source, 0, 2, 0, 1, 0, &mesh);
    close_animation(&source, mesh);

    make_folder(folder);
    text_of_buffer("the%20numbers.bin", "\"bufferView\":0", text, sizeof text);
    write_file(folder, "the numbers.bin", triangle_positions, sizeof triangle_positions, binary_path);
    write_file(folder, "t.gltf", text, strlen(text), path);
    heard = (told){0};
    assert_int_equal(kdr_gltf_animation_open(path, &hearing, &source), KDR_OK);
    unlink(binary_path);
    mesh = NULL;
    assert_vertex(&source, 0, 2, 0, 1, 0, &mesh);
    close_animation(&source, mesh);
    assert_int_equal(kdr_gltf_animation_open(path, &hearing, &source), KDR_ERROR_IO);
    assert_non_null(strstr(heard.error, "expected the file"));
    write_file(folder, "the numbers.bin", triangle_positions, 35, binary_path);
    assert_int_equal(kdr_gltf_animation_open(path, &hearing, &source), KDR_ERROR_INVALID_DATA);
    assert_non_null(strstr(heard.error, "expected a file of at least 36 bytes"));
    text_of_buffer("../the%20numbers.bin", "\"bufferView\":0", text, sizeof text);
    write_file(folder, "t.gltf", text, strlen(text), path);
    assert_int_equal(kdr_gltf_animation_open(path, &hearing, &source), KDR_ERROR_INVALID_DATA);
    assert_non_null(strstr(heard.error, "expected a buffer in a file beside this one"));
    unlink(binary_path);
    unlink(path);
    rmdir(folder);
    assert_int_equal(kdr_render_bytes(), 0);
}

static void sparse_values_lie_over_zeros(void **state) {
    (void)state;
    char text[1000];
    // Index 0 is read from the first bytes of the view, which are zeros; the value is the second vertex.
    text_of_buffer(BASE64_TRIANGLE,
                   "\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":0,\"componentType\":5121},"
                   "\"values\":{\"bufferView\":0,\"byteOffset\":12}}",
                   text, sizeof text);
    kdr_animation_source source;
    if (try_animation("t.gltf", text, strlen(text), &source) != KDR_OK)
        fail_msg("%s", heard.error);
    kdr_mesh *mesh = NULL;
    assert_vertex(&source, 0, 0, 1, 0, 0, &mesh);
    assert_vertex(&source, 0, 1, 0, 0, 0, &mesh);
    close_animation(&source, mesh);
}

static void a_later_sample_writes_over_the_mesh_without_memory(void **state) {
    (void)state;
    failing_alloc failing;
    failing_alloc_init(&failing);
    kdr_allocator functions = failing_alloc_functions(&failing);
    kdr_mesh_memory_replace(&functions);
    byte_list bytes;
    sample_animation(&bytes);
    kdr_animation_source source = open_animation(&bytes);
    kdr_mesh *mesh = NULL;
    sample_at(&source, 0, &mesh);
    const kdr_mesh before = *mesh;
    failing_alloc_fail_from(&failing, 1);
    for (int i = 0; i <= 20; i++)
        sample_at(&source, 0.1 * i, &mesh);
    assert_int_equal(atomic_load(&failing.calls), 0);
    assert_memory_equal(&before, mesh, sizeof before);
    close_animation(&source, mesh);
    kdr_mesh_memory_replace(NULL);
}

static void wrong_numbers_are_refused(void **state) {
    (void)state;
    static const float falling[3] = {1, 1, 4}, early[3] = {-1, 2, 4}, not_finite[9] = {0, 0, 0, NAN, 0, 0, 0, 0, 0};
    gltf_file file = make_move(3, 3, falling, 3, three_places);
    assert_animation_refused(&file, MOVE("LINEAR", "translation"), "expected times from 0 on that ascend, found 1");
    file = make_move(3, 3, early, 3, three_places);
    assert_animation_refused(&file, MOVE("LINEAR", "translation"), "expected times from 0 on that ascend, found -1");
    file = make_move(3, 3, three_times, 3, not_finite);
    assert_animation_refused(&file, MOVE("LINEAR", "translation"), "expected an accessor of finite numbers");
    file = make_move(3, 2, three_times, 3, three_places);
    assert_animation_refused(&file, MOVE("LINEAR", "translation"), "expected 6 numbers for 2 times, found 9");
    file = make_move(3, 3, three_times, 3, three_places);
    assert_animation_refused(&file, MOVE("CUBICSPLINE", "translation"),
                             "expected a sampler with a value for each time");
    assert_animation_refused(&file, MOVE("BEZIER", "translation"), "expected STEP, LINEAR or CUBICSPLINE");
    assert_animation_refused(&file, MOVE("LINEAR", "rotation"), "expected values that suit the target's path");
    assert_animation_refused(&file, "\"nodes\":[{\"mesh\":0,\"scale\":[1,2]}]," TRIANGLE_MESH,
                             "expected 'scale' to be 3 numbers");
    assert_animation_refused(&file, "\"nodes\":[{\"mesh\":0,\"scale\":[1,2,1e39]}]," TRIANGLE_MESH,
                             "expected a finite number in 'scale'");
    assert_animation_refused(&file, "\"nodes\":[{\"mesh\":0,\"children\":[1]},{\"children\":[0]}]," TRIANGLE_MESH,
                             "lies in itself");
    assert_animation_refused(&file,
                             "\"nodes\":[{\"mesh\":0,\"skin\":0}]," TRIANGLE_MESH ",\"skins\":[{\"joints\":[3]}]",
                             "expected a number into 'nodes', of which there are 1");
}

static void joints_and_vertices_outside_their_lists_are_refused(void **state) {
    (void)state;
    static const float joints[12] = {0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0}, corners[3] = {0, 1, 3};
    static const float weights[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, -1, 0, 0};
    gltf_file file = {0};
    add_floats(&file, 3, 3, triangle_positions);
    add_array(&file, KDR_GLTF_USHORT, 4, 3, joints);
    add_floats(&file, 4, 3, weights);
    add_array(&file, KDR_GLTF_UBYTE, 1, 3, corners);
    const char *rest = "\"nodes\":[{\"mesh\":0,\"skin\":0},{},{}],\"meshes\":[{\"primitives\":[{\"attributes\":{"
                       "\"POSITION\":0,\"JOINTS_0\":1,\"WEIGHTS_0\":2}}]}],\"skins\":[{\"joints\":[1,2]}]";
    assert_animation_refused(&file, rest, "vertex 2: expected a joint below 2, found 2");
    rest = "\"nodes\":[{\"mesh\":0,\"skin\":0},{},{}],\"meshes\":[{\"primitives\":[{\"attributes\":{"
           "\"POSITION\":0,\"JOINTS_0\":1,\"WEIGHTS_0\":2}}]}],\"skins\":[{\"joints\":[1,2,0]}]";
    assert_animation_refused(&file, rest, "vertex 2: expected a weight of at least 0, found -1");
    rest = "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":3}]}]";
    assert_animation_refused(&file, rest, "expected a vertex number below 3, found 3");
}

static void vertices_that_leave_the_range_of_floats_fail_the_sample(void **state) {
    (void)state;
    static const float times[2] = {0, 1}, scales[6] = {1, 1, 1, 3e38f, 1, 1};
    gltf_file file = make_move(3, 2, times, 2, scales);
    kdr_animation_source source =
        open_file(&file, "\"nodes\":[{\"scale\":[2,2,2],\"children\":[1]},{\"mesh\":0}]," TRIANGLE_MESH
                         ",\"animations\":[{\"samplers\":[{\"input\":1,\"output\":2}],"
                         "\"channels\":[{\"sampler\":0,\"target\":{\"node\":1,\"path\":\"scale\"}}]}]");
    kdr_mesh *mesh = NULL;
    assert_vertex(&source, 0, 1, 2, 0, 0, &mesh);
    assert_int_equal(source.sample(source.state, 1, &hearing, &mesh), KDR_ERROR_INVALID_DATA);
    assert_non_null(strstr(heard.error, "t.glb: expected vertices that stay finite, found one that does not at 1 s"));
    close_animation(&source, mesh);
}

static void a_still_file_is_what_the_reader_of_meshes_gives(void **state) {
    (void)state;
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        byte_list bytes = {.length = 0};
        sample_glb(&bytes, mirrored ? "\"scale\":[-2,2,2]," : "\"translation\":[1,2,3],");
        kdr_animation_source source = open_animation(&bytes);
        kdr_mesh *mesh = NULL;
        sample_at(&source, 0, &mesh);
#ifdef KDR_WITH_ASSIMP
        kdr_mesh *wanted = read_bytes("t.glb", bytes.bytes, bytes.length);
        assert_int_equal(mesh->triangle_count, wanted->triangle_count);
        assert_memory_equal(mesh->indices, wanted->indices, 3 * mesh->triangle_count * sizeof(uint32_t));
        assert_memory_equal(mesh->positions, wanted->positions, 3 * mesh->vertex_count * sizeof(float));
        assert_memory_equal(mesh->materials[0].diffuse, wanted->materials[0].diffuse, 3 * sizeof(float));
        assert_string_equal(mesh->materials[0].name, wanted->materials[0].name);
        kdr_mesh_destroy(wanted);
#endif
        assert_int_equal(mesh->triangle_count, 4);
        assert_string_equal(mesh->materials[0].name, "green");
        close_animation(&source, mesh);
    }
}

static void every_allocation_that_fails_is_told_and_leaves_nothing(void **state) {
    (void)state;
    failing_alloc failing;
    failing_alloc_init(&failing);
    kdr_allocator functions = failing_alloc_functions(&failing);
    kdr_mesh_memory_replace(&functions);
    byte_list bytes;
    sample_animation(&bytes);
    int refused = 0;
    for (uint64_t n = 1; refused == (int)n - 1; n++) {
        kdr_animation_source source;
        kdr_mesh *mesh = NULL;
        failing_alloc_fail_nth(&failing, n);
        kdr_status status = try_animation("t.glb", bytes.bytes, bytes.length, &source);
        if (status == KDR_OK)
            status = source.sample(source.state, 1, &hearing, &mesh);
        if (status != KDR_OK) {
            assert_int_equal(status, KDR_ERROR_OUT_OF_MEMORY);
            assert_null(mesh);
            assert_int_equal(heard.errors, 1);
            assert_non_null(strstr(heard.error, "out of memory"));
            refused++;
        }
        kdr_mesh_destroy(mesh);
        if (source.state)
            source.destroy(source.state);
        assert_int_equal(kdr_render_bytes(), 0);
        assert_true(failing_alloc_is_clean(&failing));
    }
    assert_true(refused > 20);
    kdr_mesh_memory_replace(NULL);
}

/* Whatever the bytes: samples that keep the promise of a mesh, or one sentence. */
static void assert_samples_or_sentence(const byte_list *file) {
    kdr_animation_source source;
    kdr_mesh *mesh = NULL;
    if (try_animation("t.glb", file->bytes, file->length, &source) != KDR_OK) {
        assert_null(source.state);
        assert_int_equal(heard.errors, 1);
        assert_non_null(strstr(heard.error, "expected"));
    } else {
        assert_int_equal(heard.errors, 0);
        for (int i = 0; i < 3; i++) {
            (void)source.sample(source.state, source.duration * i / 2, &hearing, &mesh);
            check_promise(mesh);
        }
        source.destroy(source.state);
    }
    kdr_mesh_destroy(mesh);
    assert_int_equal(kdr_render_bytes(), 0);
}

static void a_file_cut_short_or_changed_is_refused_or_plays_soundly(void **state) {
    (void)state;
    byte_list file;
    sample_animation(&file);
    for (size_t length = 0; length < file.length; length++) {
        byte_list cut = file;
        cut.length = length;
        assert_samples_or_sentence(&cut);
    }
    test_random random = test_random_start(test_random_seed(), 7);
    for (int run = 0; run < TEST_SIZE(20000); run++) {
        byte_list changed = file;
        for (uint32_t i = 1 + test_random_below(&random, 4); i > 0; i--) {
            unsigned char *byte = &changed.bytes[test_random_below(&random, (uint32_t)file.length)];
            bool is_digit = *byte >= '0' && *byte <= '9';
            *byte = is_digit ? (unsigned char)('0' + test_random_below(&random, 10))
                             : (unsigned char)(*byte ^ 1u << test_random_below(&random, 8));
        }
        assert_samples_or_sentence(&changed);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_step_keeps_a_value_up_to_the_next_key),
        cmocka_unit_test(a_line_goes_evenly_from_key_to_key_and_stands_still_outside),
        cmocka_unit_test(a_cubic_follows_the_slopes_of_the_file),
        cmocka_unit_test(a_rotation_turns_evenly_by_the_shorter_way),
        cmocka_unit_test(children_move_with_their_parents),
        cmocka_unit_test(joints_morphs_and_all_shapes_work_together),
        cmocka_unit_test(weights_of_a_node_take_the_place_of_its_meshs),
        cmocka_unit_test(normals_follow_and_are_made_where_there_are_none),
        cmocka_unit_test(strips_and_fans_become_triangles),
        cmocka_unit_test(buffers_may_be_text_or_lie_in_files),
        cmocka_unit_test(sparse_values_lie_over_zeros),
        cmocka_unit_test(a_later_sample_writes_over_the_mesh_without_memory),
        cmocka_unit_test(wrong_numbers_are_refused),
        cmocka_unit_test(joints_and_vertices_outside_their_lists_are_refused),
        cmocka_unit_test(vertices_that_leave_the_range_of_floats_fail_the_sample),
        cmocka_unit_test(a_still_file_is_what_the_reader_of_meshes_gives),
        cmocka_unit_test(every_allocation_that_fails_is_told_and_leaves_nothing),
        cmocka_unit_test(a_file_cut_short_or_changed_is_refused_or_plays_soundly),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
