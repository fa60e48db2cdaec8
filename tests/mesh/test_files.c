#include "mesh/samples.h"

#include <fcntl.h>
#include <pthread.h>
#include <sys/stat.h>
#include <zlib.h>

static char folder[64];

static int open_folder(void **state) {
    (void)state;
    make_folder(folder);
    return 0;
}

static int close_folder(void **state) {
    (void)state;
    return rmdir(folder);
}

/* Reads a file of the folder and removes it. */
static kdr_status read_path(const char *path, kdr_mesh **out) {
    heard = (told){0};
    kdr_status status = kdr_mesh_read(path, &hearing, out);
    unlink(path);
    return status;
}

/* One gzip member. */
static void put_packed(byte_list *out, const void *bytes, size_t length) {
    z_stream stream = {0};
    assert_int_equal(deflateInit2(&stream, 6, Z_DEFLATED, MAX_WBITS + 16, 8, Z_DEFAULT_STRATEGY), Z_OK);
    stream.next_in = (z_const Bytef *)(uintptr_t)bytes;
    stream.avail_in = (uInt)length;
    stream.next_out = out->bytes + out->length;
    stream.avail_out = (uInt)(sizeof out->bytes - out->length);
    assert_int_equal(deflate(&stream, Z_FINISH), Z_STREAM_END);
    out->length = sizeof out->bytes - stream.avail_out;
    deflateEnd(&stream);
}

static void every_format_is_read_from_disk_plain_and_packed(void **state) {
    (void)state;
    static const char *const names[] = {"a.ply", "b.ply", "c.obj", "d.stl", "e.stl"};
    for (int form = 0; form < 5; form++) {
        byte_list plain = {.length = 0}, packed = {.length = 0};
        if (form == 0)
            sample_ply_ascii(&plain);
        else if (form == 1)
            sample_ply_binary(&plain, true);
        else if (form == 2)
            sample_obj(&plain);
        else if (form == 3)
            sample_stl_ascii(&plain);
        else
            sample_stl_binary(&plain);
        put_packed(&packed, plain.bytes, plain.length);
        char path[128], packed_name[32];
        snprintf(packed_name, sizeof packed_name, "%s.gz", names[form]);
        for (int is_packed = 0; is_packed < 2; is_packed++) {
            const byte_list *file = is_packed ? &packed : &plain;
            write_file(folder, is_packed ? packed_name : names[form], file->bytes, file->length, path);
            kdr_mesh *mesh;
            if (read_path(path, &mesh) != KDR_OK)
                fail_msg("%s", heard.error);
            assert_int_equal(mesh->triangle_count, 4);
            assert_int_equal(mesh->vertex_count, form == 2 ? 12 : 4);
            close_mesh(mesh);
        }
    }
}

static void packed_data_in_several_members_is_one_file(void **state) {
    (void)state;
    byte_list plain = {.length = 0}, packed = {.length = 0};
    sample_ply_ascii(&plain);
    put_packed(&packed, plain.bytes, 100);
    put_packed(&packed, plain.bytes + 100, plain.length - 100);
    put_text(&packed, "padding");
    kdr_mesh *mesh = read_bytes("t.ply.gz", packed.bytes, packed.length);
    assert_indices(mesh, 4, tetrahedron_indices);
    close_mesh(mesh);
}

static void damaged_packed_data_names_its_byte(void **state) {
    (void)state;
    byte_list plain = {.length = 0}, packed = {.length = 0};
    sample_ply_ascii(&plain);
    put_packed(&packed, plain.bytes, plain.length);
    for (size_t length = 2; length < packed.length; length++)
        assert_refused("t.ply.gz", packed.bytes, length, KDR_ERROR_INVALID_DATA,
                       "expected more gzip data, the file ends");
    byte_list wrong = packed;
    wrong.bytes[2] = 99;
    assert_refused("t.ply.gz", wrong.bytes, wrong.length, KDR_ERROR_INVALID_DATA, "byte 4: expected sound gzip data");
    wrong = packed;
    wrong.bytes[wrong.length - 6] ^= 1;
    assert_refused("t.ply.gz", wrong.bytes, wrong.length, KDR_ERROR_INVALID_DATA, "expected sound gzip data");
}

static void a_claim_of_gigabytes_in_packed_data_takes_no_memory(void **state) {
    (void)state;
    byte_list packed = {.length = 0};
    put_packed(&packed, "nothing", 7);
    memset(packed.bytes + packed.length - 4, 0xff, 4);
    atomic_store(&kdr_mesh_memory()->peak_bytes, 0);
    assert_refused("t.ply.gz", packed.bytes, packed.length, KDR_ERROR_INVALID_DATA, "expected sound gzip data");
    assert_true(kdr_mesh_memory()->peak_bytes < (size_t)1 << 20);
}

static void what_is_no_readable_file_is_told(void **state) {
    (void)state;
    char path[128];
    kdr_mesh *mesh;
    snprintf(path, sizeof path, "%s/none.ply", folder);
    assert_int_equal(read_path(path, &mesh), KDR_ERROR_IO);
    assert_non_null(strstr(heard.error, "none.ply: cannot be opened: No such file"));
    assert_null(mesh);

    heard = (told){0};
    assert_int_equal(kdr_mesh_read(folder, &hearing, &mesh), KDR_ERROR_IO);
    assert_non_null(strstr(heard.error, "is a directory, expected a mesh file"));
    heard = (told){0};
    assert_int_equal(kdr_mesh_read("/dev/zero", &hearing, &mesh), KDR_ERROR_IO);
    assert_string_equal(heard.error, "/dev/zero: is a device, expected a mesh file");

    write_file(folder, "empty.ply", "", 0, path);
    assert_int_equal(read_path(path, &mesh), KDR_ERROR_INVALID_DATA);
    assert_non_null(strstr(heard.error, "byte 0: expected a mesh file, found an empty one"));

    // The superuser may read everything, so only others can be refused.
    write_file(folder, "locked.ply", "ply\n", 4, path);
    assert_int_equal(chmod(path, 0), 0);
    kdr_status status = read_path(path, &mesh);
    assert_int_equal(status, geteuid() == 0 ? KDR_ERROR_INVALID_DATA : KDR_ERROR_IO);
    assert_int_equal(heard.errors, 1);

    assert_int_equal(kdr_mesh_read(NULL, &hearing, &mesh), KDR_ERROR_INVALID_ARGUMENT);
    assert_int_equal(kdr_mesh_read("x.ply", &hearing, NULL), KDR_ERROR_INVALID_ARGUMENT);
    assert_int_equal(kdr_mesh_read("/nowhere/x.ply", NULL, &mesh), KDR_ERROR_IO);
    assert_int_equal(kdr_render_bytes(), 0);
}

static void an_unknown_format_is_told(void **state) {
    (void)state;
    static const unsigned char noise[300] = {0x89, 'n', 'o', 'i', 's', 'e', 1, 2, 3};
    assert_refused("noise", noise, sizeof noise, KDR_ERROR_UNSUPPORTED, "expected a mesh (PLY, OBJ, STL");
    assert_refused("noise.txt", "Dear reader,\n", 13, KDR_ERROR_UNSUPPORTED, "expected a mesh (PLY, OBJ, STL");
    assert_refused("noise.ply", noise, sizeof noise, KDR_ERROR_INVALID_DATA, "line 1: expected 'ply'");
}

static void content_goes_before_the_name(void **state) {
    (void)state;
    byte_list file = {.length = 0};
    sample_ply_binary(&file, false);
    kdr_mesh *mesh = read_bytes("t.stl", file.bytes, file.length);
    assert_string_equal(mesh->format, "PLY binary little endian");
    close_mesh(mesh);
    file.length = 0;
    sample_obj(&file);
    mesh = read_bytes("no ending at all", file.bytes, file.length);
    assert_string_equal(mesh->format, "OBJ");
    close_mesh(mesh);
}

static void names_with_odd_bytes_make_one_line(void **state) {
    (void)state;
    kdr_mesh *mesh;
    assert_int_equal(try_bytes("a\nb\033c.ply", "plx", 3, &mesh), KDR_ERROR_INVALID_DATA);
    assert_memory_equal(heard.error, "a?b?c.ply: line 1: ", 19);
}

static void *write_pipe(void *path) {
    byte_list file = {.length = 0};
    sample_ply_ascii(&file);
    int descriptor = open(path, O_WRONLY);
    for (size_t i = 0; i < file.length;) {
        ssize_t count = write(descriptor, file.bytes + i, file.length - i < 50 ? file.length - i : 50);
        if (count <= 0)
            break;
        i += (size_t)count;
    }
    close(descriptor);
    return NULL;
}

static void a_pipe_is_read_to_its_end(void **state) {
    (void)state;
    char path[128];
    snprintf(path, sizeof path, "%s/pipe.ply", folder);
    assert_int_equal(mkfifo(path, 0600), 0);
    pthread_t thread;
    assert_int_equal(pthread_create(&thread, NULL, write_pipe, path), 0);
    kdr_mesh *mesh;
    heard = (told){0};
    kdr_status status = kdr_mesh_read(path, &hearing, &mesh);
    pthread_join(thread, NULL);
    unlink(path);
    assert_int_equal(status, KDR_OK);
    assert_indices(mesh, 4, tetrahedron_indices);
    close_mesh(mesh);
}

static void a_name_of_a_builtin_scene_is_taken_apart(void **state) {
    (void)state;
    static const char *const wrong[] = {"builtin:city:",        "builtin:city:many",     "builtin:city:-5",
                                        "builtin:city:100:",    "builtin:city:100:soon", "builtin:city:100:nan",
                                        "builtin:city:100:1:2", "builtin:city:100x"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        kdr_mesh *mesh;
        heard = (told){0};
        assert_int_equal(kdr_mesh_read(wrong[i], &hearing, &mesh), KDR_ERROR_INVALID_ARGUMENT);
        assert_null(mesh);
        if (!strstr(heard.error, "expected builtin:NAME, NAME:TRIANGLES or NAME:TRIANGLES:SECONDS"))
            fail_msg("'%s'", heard.error);
    }
    kdr_mesh *mesh;
    assert_int_equal(kdr_mesh_read("builtin:no such scene:100:0.5", &hearing, &mesh), KDR_ERROR_INVALID_ARGUMENT);
    assert_null(mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_format_is_read_from_disk_plain_and_packed),
        cmocka_unit_test(packed_data_in_several_members_is_one_file),
        cmocka_unit_test(damaged_packed_data_names_its_byte),
        cmocka_unit_test(a_claim_of_gigabytes_in_packed_data_takes_no_memory),
        cmocka_unit_test(what_is_no_readable_file_is_told),
        cmocka_unit_test(an_unknown_format_is_told),
        cmocka_unit_test(content_goes_before_the_name),
        cmocka_unit_test(names_with_odd_bytes_make_one_line),
        cmocka_unit_test(a_pipe_is_read_to_its_end),
        cmocka_unit_test(a_name_of_a_builtin_scene_is_taken_apart),
    };
    return cmocka_run_group_tests(tests, open_folder, close_folder);
}
