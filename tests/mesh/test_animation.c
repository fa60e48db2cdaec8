/* Animations of every kind behind one handle: sequences of files, built-in scenes, files that stand still, glTF. */
#include "gltf_file.h"

#include "support/failing_alloc.h"

#include <sys/stat.h>

static char folder[40];

static void path_of(const char *name, char path[160]) { snprintf(path, 160, "%s/%s", folder, name); }

/* A triangle whose second corner is at x = size. */
static void write_triangle(const char *name, int size) {
    char path[160];
    path_of(name, path);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "v 0 0 0\nv %d 0 0\nv 0 1 0\nf 1 2 3\n", size);
    assert_int_equal(fclose(file), 0);
}

static void remove_file(const char *name) {
    char path[160];
    path_of(name, path);
    assert_int_equal(unlink(path), 0);
}

static int make_room(void **state) {
    (void)state;
    snprintf(folder, sizeof folder, "/tmp/kdr-animation-test-XXXXXX");
    return mkdtemp(folder) == NULL;
}

static int remove_room(void **state) {
    (void)state;
    return rmdir(folder) != 0 || kdr_render_bytes() != 0;
}

static kdr_status try_open(const char *name, double rate, kdr_animation **out) {
    char path[160];
    path_of(name, path);
    heard = (told){0};
    return kdr_animation_open(strncmp(name, "builtin:", 8) == 0 ? name : path, rate, &hearing, out);
}

static kdr_animation *opened(const char *name, double rate) {
    kdr_animation *animation;
    if (try_open(name, rate, &animation) != KDR_OK)
        fail_msg("%s: %s", name, heard.error);
    return animation;
}

static void assert_not_opened(const char *name, double rate, kdr_status wanted, const char *part) {
    kdr_animation *animation;
    kdr_status status = try_open(name, rate, &animation);
    assert_null(animation);
    if (status != wanted || heard.errors != 1 || !strstr(heard.error, part))
        fail_msg("%s: expected %s and '%s', got %s and %d, '%s'", name, kdr_status_text(wanted), part,
                 kdr_status_text(status), heard.errors, heard.error);
}

static void a_sequence_shows_each_file_for_its_time(void **state) {
    (void)state;
    const char *const names[] = {"walk08.obj", "walk09.obj", "walk10.obj", "walk11.obj"};
    for (int i = 0; i < 4; i++)
        write_triangle(names[i], 8 + i);
    /* None of these is of the sequence. */
    const char *const others[] = {"walk7.obj", "walk012.obj", "walk1x.obj", "walk12.obj.old", "xwalk12.obj"};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        write_triangle(others[i], 99);
    kdr_animation *animation = opened("walk##.obj", 10);
    assert_true(kdr_animation_duration(animation) == 0.4);
    kdr_mesh *mesh = NULL;
    const double times[] = {0, 0.05, 0.0999, 0.1, 0.15, 0.2, 0.3, 0.3 + 1e-12, 0.39, 0.4, 7, -3, 1e300};
    const int sizes[] = {8, 8, 8, 9, 9, 10, 11, 11, 11, 11, 11, 8, 11};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        assert_int_equal(kdr_animation_sample(animation, times[i], &hearing, &mesh), KDR_OK);
        assert_int_equal(mesh->triangle_count, 1);
        assert_true(mesh->positions[3] == (float)sizes[i]);
    }
    /* Whatever the rate, frame i is file i. */
    const double rates[] = {24, 25, 29.97, 30, 60, 1.0 / 3, 7777};
    for (size_t r = 0; r < sizeof rates / sizeof rates[0]; r++) {
        kdr_animation *fast = opened("walk##.obj", rates[r]);
        kdr_mesh *frame = NULL;
        for (int i = 0; i < 4; i++) {
            assert_int_equal(kdr_animation_sample(fast, i / rates[r], &hearing, &frame), KDR_OK);
            assert_true(frame->positions[3] == (float)(8 + i));
        }
        kdr_animation_destroy(fast);
        kdr_mesh_destroy(frame);
    }
    /* A file that goes away leaves the mesh that is there. */
    assert_int_equal(kdr_animation_sample(animation, 0, &hearing, &mesh), KDR_OK);
    remove_file("walk09.obj");
    assert_int_equal(kdr_animation_sample(animation, 0.1, &hearing, &mesh), KDR_ERROR_IO);
    assert_true(mesh->positions[3] == 8);
    assert_not_opened("walk##.obj", 10, KDR_ERROR_INVALID_DATA, "expected the numbers 8 to 11, found none of 9");
    kdr_animation_destroy(animation);
    kdr_mesh_destroy(mesh);
    for (int i = 0; i < 4; i++)
        if (i != 1)
            remove_file(names[i]);
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        remove_file(others[i]);
}

static void a_built_in_scene_moves_on_for_ever_or_stands_still(void **state) {
    (void)state;
    for (size_t i = 0; kdr_mesh_builtin_name(i); i++) {
        char name[100];
        snprintf(name, sizeof name, "builtin:%s:1000:2", kdr_mesh_builtin_name(i));
        kdr_animation *animation = opened(name, 25);
        double duration = kdr_animation_duration(animation);
        assert_true(duration == (kdr_mesh_builtin_moves(i) ? INFINITY : 0));
        kdr_mesh *mesh = NULL, *expected;
        assert_int_equal(kdr_animation_sample(animation, 9, &hearing, &mesh), KDR_OK);
        assert_int_equal(kdr_animation_sample(animation, 1.5, &hearing, &mesh), KDR_OK);
        assert_int_equal(kdr_mesh_make(kdr_mesh_builtin_name(i), 1000, 3.5, NULL, &expected), KDR_OK);
        assert_int_equal(mesh->vertex_count, expected->vertex_count);
        assert_memory_equal(mesh->positions, expected->positions, 12 * expected->vertex_count);
        kdr_mesh_destroy(expected);
        assert_int_equal(kdr_mesh_make(kdr_mesh_builtin_name(i), 1000, 2, NULL, &expected), KDR_OK);
        bool same = memcmp(mesh->positions, expected->positions, 12 * expected->vertex_count) == 0;
        assert_true(same == !kdr_mesh_builtin_moves(i));
        kdr_mesh_destroy(expected);
        kdr_mesh_destroy(mesh);
        kdr_animation_destroy(animation);
    }
    assert_false(kdr_mesh_builtin_moves(SIZE_MAX));
}

static void a_file_that_stands_still_is_read_once(void **state) {
    (void)state;
    write_triangle("still.obj", 3);
    kdr_animation *animation = opened("still.obj", 25);
    assert_true(kdr_animation_duration(animation) == 0);
    kdr_mesh *mesh = NULL;
    assert_int_equal(kdr_animation_sample(animation, 5, &hearing, &mesh), KDR_OK);
    remove_file("still.obj");
    const kdr_mesh *first = mesh;
    assert_int_equal(kdr_animation_sample(animation, 6, &hearing, &mesh), KDR_OK);
    assert_ptr_equal(mesh, first);
    assert_true(mesh->positions[3] == 3);
    kdr_animation_destroy(animation);
    kdr_mesh_destroy(mesh);
}

static void a_gltf_file_is_what_it_is_at_that_moment(void **state) {
    (void)state;
    gltf_file file = {0};
    const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, times[2] = {0, 2}, places[6] = {0, 0, 0, 4, 0, 0};
    add_floats(&file, 3, 3, corners);
    add_floats(&file, 1, 2, times);
    add_floats(&file, 3, 2, places);
    byte_list bytes = {0};
    assemble(&file,
             "\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
             "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
             "\"animations\":[{\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"translation\"}}],"
             "\"samplers\":[{\"input\":1,\"output\":2}]}]",
             &bytes);
    char path[160];
    path_of("moves.glb", path);
    FILE *out = fopen(path, "wb");
    assert_non_null(out);
    assert_int_equal(fwrite(bytes.bytes, 1, bytes.length, out), bytes.length);
    assert_int_equal(fclose(out), 0);
    kdr_animation *animation = opened("moves.glb", 25);
    assert_true(kdr_animation_duration(animation) == 2);
    kdr_mesh *mesh = NULL;
    assert_int_equal(kdr_animation_sample(animation, 0.5, &hearing, &mesh), KDR_OK);
    assert_true(mesh->positions[3] == 2);
    assert_int_equal(kdr_animation_sample(animation, 9, &hearing, &mesh), KDR_OK);
    assert_true(mesh->positions[3] == 5);
    kdr_animation_destroy(animation);
    kdr_mesh_destroy(mesh);
    remove_file("moves.glb");
}

static void wrong_requests_are_refused_with_a_sentence(void **state) {
    (void)state;
    assert_not_opened("gone.glb", 25, KDR_ERROR_IO, "gone.glb");
    assert_not_opened("gone##.ply", 25, KDR_ERROR_IO, "there is no file with a number");
    assert_not_opened("nowhere/gone##.ply", 25, KDR_ERROR_IO, "nowhere/gone##.ply");
    assert_not_opened("a#b#.ply", 25, KDR_ERROR_INVALID_ARGUMENT, "# in one place");
    assert_not_opened("a################.ply", 25, KDR_ERROR_LIMIT, "too long");
    assert_not_opened("builtin:nothing", 25, KDR_ERROR_INVALID_ARGUMENT, "no built-in scene");
    assert_not_opened("builtin:wave:7", 25, KDR_ERROR_INVALID_ARGUMENT, "sizes from");
    assert_not_opened("builtin:wave:10000001", 25, KDR_ERROR_INVALID_ARGUMENT, "sizes from");
    assert_not_opened("builtin:wave:x", 25, KDR_ERROR_INVALID_ARGUMENT, "expected builtin:NAME");
    const double rates[] = {0, -1, INFINITY, (double)NAN};
    for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++)
        assert_not_opened("still.obj", rates[i], KDR_ERROR_INVALID_ARGUMENT, "a rate above 0");
    kdr_animation *animation;
    assert_int_equal(kdr_animation_open(NULL, 25, NULL, &animation), KDR_ERROR_INVALID_ARGUMENT);
    assert_int_equal(kdr_animation_open("x", 25, NULL, NULL), KDR_ERROR_INVALID_ARGUMENT);
    animation = opened("gone.ply", 25);
    kdr_mesh *mesh = NULL;
    assert_int_equal(kdr_animation_sample(animation, 0, &hearing, &mesh), KDR_ERROR_IO);
    assert_null(mesh);
    assert_int_equal(kdr_animation_sample(animation, (double)NAN, &hearing, &mesh), KDR_ERROR_INVALID_ARGUMENT);
    assert_int_equal(kdr_animation_sample(animation, 0, &hearing, NULL), KDR_ERROR_INVALID_ARGUMENT);
    assert_int_equal(kdr_animation_sample(NULL, 0, &hearing, &mesh), KDR_ERROR_INVALID_ARGUMENT);
    kdr_animation_destroy(animation);
    kdr_animation_destroy(NULL);
}

/* Every request for memory fails in turn: nothing is lost, and what is there stays whole. */
static void running_out_of_memory_leaves_nothing_behind(void **state) {
    (void)state;
    write_triangle("a1.obj", 1);
    write_triangle("a2.obj", 2);
    write_triangle("still.obj", 3);
    static const char *const names[] = {"a#.obj", "still.obj", "builtin:wave:100"};
    failing_alloc failing;
    failing_alloc_init(&failing);
    kdr_allocator functions = failing_alloc_functions(&failing);
    kdr_mesh_memory_replace(&functions);
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        bool done = false;
        uint64_t n = 0;
        while (!done) {
            assert_true(++n < 1000);
            failing_alloc_fail_nth(&failing, n);
            kdr_animation *animation;
            kdr_mesh *mesh = NULL;
            kdr_status status = try_open(names[i], 1, &animation);
            for (int frame = 0; frame < 2 && status == KDR_OK; frame++)
                status = kdr_animation_sample(animation, frame, &hearing, &mesh);
            done = status == KDR_OK;
            assert_true(done || (status == KDR_ERROR_OUT_OF_MEMORY && heard.errors == 1));
            assert_true(done == (failing.failures == 0));
            kdr_mesh_destroy(mesh);
            kdr_animation_destroy(animation);
            assert_true(failing_alloc_is_clean(&failing));
        }
        assert_true(n > 2);
    }
    kdr_mesh_memory_replace(NULL);
    remove_file("a1.obj");
    remove_file("a2.obj");
    remove_file("still.obj");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sequence_shows_each_file_for_its_time),
        cmocka_unit_test(a_built_in_scene_moves_on_for_ever_or_stands_still),
        cmocka_unit_test(a_file_that_stands_still_is_read_once),
        cmocka_unit_test(a_gltf_file_is_what_it_is_at_that_moment),
        cmocka_unit_test(wrong_requests_are_refused_with_a_sentence),
        cmocka_unit_test(running_out_of_memory_leaves_nothing_behind),
    };
    return cmocka_run_group_tests(tests, make_room, remove_room);
}
