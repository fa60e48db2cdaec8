/* MD2 models: keyframes ten a second, straight lines between them, and files that are broken. */
#include "reading.h"

#include "support/failing_alloc.h"

#ifdef KDR_WITH_ASSIMP

enum { HEADER = 68, VERTICES = 4, TRIANGLES = 2, CORNERS = 4, FRAMES = 3, FRAME_SIZE = 40 + 4 * VERTICES };

/* Where the parts of the file begin. */
enum {
    ST_BEGIN = HEADER,
    TRIANGLES_BEGIN = ST_BEGIN + 4 * CORNERS,
    FRAMES_BEGIN = TRIANGLES_BEGIN + 12 * TRIANGLES,
    COMMANDS_BEGIN = FRAMES_BEGIN + FRAMES * FRAME_SIZE,
    FILE_END = COMMANDS_BEGIN + 4
};

static char path[64];

static void put32(unsigned char *to, uint32_t number) {
    for (int i = 0; i < 4; i++)
        to[i] = (unsigned char)(number >> 8 * i);
}

static void put16(unsigned char *to, uint32_t number) {
    to[0] = (unsigned char)number;
    to[1] = (unsigned char)(number >> 8);
}

static void put_float(unsigned char *to, float number) {
    uint32_t bits;
    memcpy(&bits, &number, sizeof bits);
    put32(to, bits);
}

/* Corner v of a square lies at (v & 1, v >> 1, 0), and frame f is moved by 2 f along x and twice as large in it. */
static void make_file(unsigned char file[FILE_END]) {
    const uint32_t header[17] = {0x32504449,   8,
                                 64,           64,
                                 FRAME_SIZE,   0,
                                 VERTICES,     CORNERS,
                                 TRIANGLES,    0,
                                 FRAMES,       ST_BEGIN,
                                 ST_BEGIN,     TRIANGLES_BEGIN,
                                 FRAMES_BEGIN, COMMANDS_BEGIN,
                                 FILE_END};
    memset(file, 0, FILE_END);
    for (int i = 0; i < 17; i++)
        put32(file + 4 * i, header[i]);
    static const uint32_t corners[TRIANGLES][3] = {{0, 1, 2}, {1, 3, 2}};
    for (int t = 0; t < TRIANGLES; t++)
        for (int k = 0; k < 3; k++) {
            put16(file + TRIANGLES_BEGIN + 12 * t + 2 * k, corners[t][k]);
            put16(file + TRIANGLES_BEGIN + 12 * t + 6 + 2 * k, corners[t][k]);
        }
    for (int f = 0; f < FRAMES; f++) {
        unsigned char *frame = file + FRAMES_BEGIN + f * FRAME_SIZE;
        for (int k = 0; k < 3; k++)
            put_float(frame + 4 * k, k == 0 ? (float)(f + 1) : 1);
        put_float(frame + 12, 2 * (float)f);
        const char name[] = {'s', 't', 'a', 'n', 'd', (char)('1' + f), 0};
        memcpy(frame + 24, name, sizeof name);
        for (int v = 0; v < VERTICES; v++) {
            unsigned char *vertex = frame + 40 + 4 * v;
            vertex[0] = v & 1;
            vertex[1] = (unsigned char)(v >> 1);
        }
    }
}

static void write_bytes(const unsigned char *bytes, size_t length) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, length, file), length);
    assert_int_equal(fclose(file), 0);
}

static int make_room(void **state) {
    (void)state;
    snprintf(path, sizeof path, "/tmp/kdr-md2-test-%ld.md2", (long)getpid());
    return 0;
}

static int remove_room(void **state) {
    (void)state;
    unlink(path);
    return kdr_render_bytes() != 0;
}

static kdr_animation *opened(void) {
    kdr_animation *animation;
    heard = (told){0};
    if (kdr_animation_open(path, 25, &hearing, &animation) != KDR_OK)
        fail_msg("%s", heard.error);
    return animation;
}

/* The least and the greatest x of what is shown. */
static void hold_extent(const kdr_mesh *mesh, float lo, float hi) {
    float bounds[6];
    kdr_mesh_bounds(mesh, bounds);
    if (bounds[0] != lo || bounds[3] != hi)
        fail_msg("expected %g to %g, found %g to %g", (double)lo, (double)hi, (double)bounds[0], (double)bounds[3]);
}

static void keyframes_are_a_tenth_of_a_second_apart_and_joined_by_straight_lines(void **state) {
    (void)state;
    unsigned char file[FILE_END];
    make_file(file);
    write_bytes(file, sizeof file);
    kdr_animation *animation = opened();
    assert_true(kdr_animation_duration(animation) == 0.2);
    kdr_mesh *mesh = NULL;
    static const struct {
        double seconds;
        float lo, hi;
    } shown[] = {{0, 0, 1},  {0.05, 1, 2.5f}, {0.1, 2, 4}, {0.15, 3, 5.5f}, {0.2, 4, 7},
                 {99, 4, 7}, {0.05, 1, 2.5f}, {-5, 0, 1},  {1e300, 4, 7}};
    for (size_t i = 0; i < sizeof shown / sizeof *shown; i++) {
        if (kdr_animation_sample(animation, shown[i].seconds, &hearing, &mesh) != KDR_OK)
            fail_msg("%s", heard.error);
        assert_int_equal(mesh->triangle_count, TRIANGLES);
        hold_extent(mesh, shown[i].lo, shown[i].hi);
        for (size_t v = 0; v < mesh->vertex_count; v++) {
            const float *n = &mesh->normals[3 * v];
            assert_true(fabsf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-5f);
        }
    }
    kdr_mesh_destroy(mesh);
    kdr_animation_destroy(animation);
}

static void the_first_keyframe_is_what_the_file_shows_as_a_still_mesh(void **state) {
    (void)state;
    unsigned char file[FILE_END];
    make_file(file);
    write_bytes(file, sizeof file);
    kdr_animation *animation = opened();
    kdr_mesh *still, *mesh = NULL;
    assert_int_equal(kdr_mesh_read(path, &hearing, &still), KDR_OK);
    assert_int_equal(kdr_animation_sample(animation, 0, &hearing, &mesh), KDR_OK);
    assert_int_equal(mesh->vertex_count, still->vertex_count);
    assert_memory_equal(mesh->positions, still->positions, 3 * still->vertex_count * sizeof(float));
    assert_memory_equal(mesh->normals, still->normals, 3 * still->vertex_count * sizeof(float));
    assert_memory_equal(mesh->indices, still->indices, 3 * still->triangle_count * sizeof(uint32_t));
    kdr_mesh_destroy(still);
    kdr_mesh_destroy(mesh);
    kdr_animation_destroy(animation);
}

static void a_file_of_one_keyframe_stands_still(void **state) {
    (void)state;
    unsigned char file[FILE_END];
    make_file(file);
    put32(file + 40, 1);
    write_bytes(file, sizeof file);
    kdr_animation *animation = opened();
    assert_true(kdr_animation_duration(animation) == 0);
    kdr_mesh *mesh = NULL;
    assert_int_equal(kdr_animation_sample(animation, 3, &hearing, &mesh), KDR_OK);
    hold_extent(mesh, 0, 1);
    kdr_mesh_destroy(mesh);
    kdr_animation_destroy(animation);
}

static void assert_not_opened(const unsigned char *bytes, size_t length, const char *part) {
    kdr_animation *animation;
    write_bytes(bytes, length);
    heard = (told){0};
    assert_int_equal(kdr_animation_open(path, 25, &hearing, &animation), KDR_ERROR_INVALID_DATA);
    assert_null(animation);
    assert_int_equal(heard.errors, 1);
    if (!strstr(heard.error, part) || !strstr(heard.error, path))
        fail_msg("expected '%s', found '%s'", part, heard.error);
}

static void a_header_that_cannot_be_true_is_one_sentence(void **state) {
    (void)state;
    unsigned char file[FILE_END];
    static const struct {
        int number;
        uint32_t value;
        const char *part;
    } wrong[] = {{0, 1, "IDP2"},
                 {1, 7, "version 8, found 7"},
                 {4, 0, "frames of at least 56 bytes, found 0"},
                 {4, 55, "frames of at least 56 bytes"},
                 {6, 0xffffffff, "frames of at least"},
                 {10, 0, "at least 1 frame"},
                 {10, 4, "found 4"},
                 {10, 0xffffffff, "found 4294967295"},
                 {14, FILE_END + 1, "at least 1 frame"},
                 {14, 0xffffffff, "at least 1 frame"}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        make_file(file);
        put32(file + 4 * wrong[i].number, wrong[i].value);
        assert_not_opened(file, sizeof file, wrong[i].part);
    }
    make_file(file);
    for (size_t length = 1; length < HEADER; length++)
        assert_not_opened(file, length, "68 bytes");
}

static void damage_is_refused_or_still_a_sound_mesh(void **state) {
    (void)state;
    unsigned char file[FILE_END];
    for (size_t at = 0; at < sizeof file; at++) {
        make_file(file);
        file[at] ^= 0xff;
        write_bytes(file, sizeof file);
        kdr_animation *animation;
        heard = (told){0};
        kdr_status status = kdr_animation_open(path, 25, &hearing, &animation);
        kdr_mesh *mesh = NULL;
        for (int i = 0; status == KDR_OK && i < 3; i++)
            status = kdr_animation_sample(animation, 0.07 * i, &hearing, &mesh);
        assert_int_equal(status != KDR_OK, heard.errors);
        if (status == KDR_OK)
            for (size_t i = 0; i < 3 * mesh->triangle_count; i++)
                assert_true(mesh->indices[i] < mesh->vertex_count);
        kdr_mesh_destroy(mesh);
        kdr_animation_destroy(animation);
    }
}

static void running_out_of_memory_is_a_sentence_and_leaves_nothing_behind(void **state) {
    (void)state;
    unsigned char file[FILE_END];
    make_file(file);
    write_bytes(file, sizeof file);
    failing_alloc memory;
    failing_alloc_init(&memory);
    kdr_allocator functions = failing_alloc_functions(&memory);
    kdr_mesh_memory_replace(&functions);
    uint64_t failures = 0;
    for (uint64_t n = 1; failures == n - 1; n++) {
        kdr_animation *animation;
        kdr_mesh *mesh = NULL;
        heard = (told){0};
        failing_alloc_fail_nth(&memory, n);
        kdr_status status = kdr_animation_open(path, 25, &hearing, &animation);
        for (int i = 0; status == KDR_OK && i < 3; i++)
            status = kdr_animation_sample(animation, 0.07 * i, &hearing, &mesh);
        failures += memory.failures > 0;
        failing_alloc_fail_nth(&memory, 0);
        assert_int_equal(status != KDR_OK, heard.errors); /* in a file that assimp opens, it says what failed */
        kdr_mesh_destroy(mesh);
        kdr_animation_destroy(animation);
    }
    kdr_mesh_memory_replace(NULL);
    assert_true(failures > 5);
    assert_true(failing_alloc_is_clean(&memory));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keyframes_are_a_tenth_of_a_second_apart_and_joined_by_straight_lines),
        cmocka_unit_test(the_first_keyframe_is_what_the_file_shows_as_a_still_mesh),
        cmocka_unit_test(a_file_of_one_keyframe_stands_still),
        cmocka_unit_test(a_header_that_cannot_be_true_is_one_sentence),
        cmocka_unit_test(damage_is_refused_or_still_a_sound_mesh),
        cmocka_unit_test(running_out_of_memory_is_a_sentence_and_leaves_nothing_behind),
    };
    return cmocka_run_group_tests(tests, make_room, remove_room);
}

#else

static void without_assimp_an_md2_file_is_refused_in_one_sentence(void **state) {
    (void)state;
    kdr_mesh *mesh;
    assert_int_equal(try_bytes("t.md2", "IDP2", 4, &mesh), KDR_ERROR_UNSUPPORTED);
    assert_int_equal(heard.errors, 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(without_assimp_an_md2_file_is_refused_in_one_sentence)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#endif
