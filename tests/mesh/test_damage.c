/* Files cut short and bytes changed, and memory that runs out: a mesh that keeps its promise, or one sentence. */
#include "mesh/samples.h"
#include "support/failing_alloc.h"
#include "support/random.h"
#include "support/test_size.h"

#include <zlib.h>

#define SAMPLES 8

static const char *make_sample(int number, byte_list *out) {
    out->length = 0;
    switch (number) {
    case 0: sample_ply_ascii(out); return "t.ply";
    case 1: sample_ply_binary(out, false); return "t.ply";
    case 2: sample_ply_binary(out, true); return "t.ply";
    case 3: sample_obj(out); return "t.obj";
    case 4: sample_stl_ascii(out); return "t.stl";
    case 5: sample_stl_binary(out); return "t.stl";
    case 6:
        put_text(out,
                 "ply\nformat ascii 1.0\nelement face 2\nproperty uchar red\nproperty list uchar int vertex_index\n"
                 "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\n"
                 "property float ny\nproperty float nz\nelement tristrips 1\n"
                 "property list int int vertex_indices\nend_header\n7 4 0 1 2 3\n9 3 0 1 2\n-2 -2 0 0 0 0\n"
                 "2 0 0 0 0 1\nnan 2 0 1 0 0\n-1 0 0 0 2 0\n8 0 1 2 3 -1 0 1 2\n");
        return "t.ply";
    default: {
        byte_list plain = {.length = 0};
        sample_obj(&plain);
        uLongf length = sizeof out->bytes;
        z_stream stream = {0};
        assert_int_equal(deflateInit2(&stream, 9, Z_DEFLATED, MAX_WBITS + 16, 8, Z_DEFAULT_STRATEGY), Z_OK);
        stream.next_in = plain.bytes;
        stream.avail_in = (uInt)plain.length;
        stream.next_out = out->bytes;
        stream.avail_out = (uInt)length;
        assert_int_equal(deflate(&stream, Z_FINISH), Z_STREAM_END);
        out->length = length - stream.avail_out;
        deflateEnd(&stream);
        return "t.obj.gz";
    }
    }
}

/* Whatever the bytes: a sound mesh, or no mesh and one sentence. */
static void assert_mesh_or_sentence(const char *name, const byte_list *file) {
    kdr_mesh *mesh;
    kdr_status status = try_bytes(name, file->bytes, file->length, &mesh);
    if (status == KDR_OK) {
        assert_int_equal(heard.errors, 0);
        check_promise(mesh);
    } else {
        assert_null(mesh);
        assert_int_equal(heard.errors, 1);
        assert_memory_equal(heard.error, name, strlen(name));
        assert_non_null(strstr(heard.error, "expected"));
    }
    kdr_mesh_destroy(mesh);
    assert_int_equal(kdr_render_bytes(), 0);
}

static void a_file_cut_short_anywhere_is_refused_or_read_soundly(void **state) {
    (void)state;
    for (int sample = 0; sample < SAMPLES; sample++) {
        byte_list file;
        const char *name = make_sample(sample, &file);
        for (size_t length = file.length; length-- > 0;) {
            file.length = length;
            assert_mesh_or_sentence(name, &file);
        }
    }
}

static void a_binary_file_cut_short_is_always_refused(void **state) {
    (void)state;
    for (int sample = 1; sample < 6; sample++) {
        if (sample == 3 || sample == 4)
            continue;
        byte_list file;
        const char *name = make_sample(sample, &file);
        for (size_t length = file.length; length-- > 0;) {
            kdr_mesh *mesh;
            assert_int_not_equal(try_bytes(name, file.bytes, length, &mesh), KDR_OK);
            assert_null(mesh);
        }
    }
}

static void a_file_with_changed_bytes_is_refused_or_read_soundly(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 5);
    for (int sample = 0; sample < SAMPLES; sample++) {
        byte_list file;
        const char *name = make_sample(sample, &file);
        for (int run = 0; run < TEST_SIZE(10000); run++) {
            byte_list changed = file;
            for (uint32_t i = 1 + test_random_below(&random, 4); i > 0; i--) {
                unsigned char *byte = &changed.bytes[test_random_below(&random, (uint32_t)file.length)];
                *byte = test_random_below(&random, 2) ? (unsigned char)test_random_u32(&random)
                                                      : (unsigned char)(*byte ^ 1u << test_random_below(&random, 8));
            }
            assert_mesh_or_sentence(name, &changed);
        }
    }
}

/* Numbers that are likely to be written into headers by mistake or malice. */
static void a_file_with_other_numbers_is_refused_or_read_soundly(void **state) {
    (void)state;
    static const char *const numbers[] = {
        "0",   "-1",  "5", "255", "65536", "2147483648", "4294967295", "4294967296", "18446744073709551615",
        "1e9", "nan", "x"};
    for (int sample = 0; sample < SAMPLES; sample++) {
        byte_list file;
        const char *name = make_sample(sample, &file);
        for (size_t at = 0; at < file.length; at++) {
            if (file.bytes[at] < '0' || file.bytes[at] > '9')
                continue;
            for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
                byte_list changed = {.length = 0};
                put(&changed, file.bytes, at);
                put_text(&changed, numbers[i]);
                put(&changed, file.bytes + at + 1, file.length - at - 1);
                assert_mesh_or_sentence(name, &changed);
            }
        }
    }
}

static void every_allocation_that_fails_is_told_and_leaves_nothing(void **state) {
    (void)state;
    failing_alloc failing;
    failing_alloc_init(&failing);
    kdr_allocator functions = failing_alloc_functions(&failing);
    kdr_mesh_memory_replace(&functions);
    for (int sample = 0; sample < SAMPLES; sample++) {
        byte_list file;
        const char *name = make_sample(sample, &file);
        failing_alloc_fail_nth(&failing, 0);
        kdr_mesh *mesh;
        assert_int_equal(try_bytes(name, file.bytes, file.length, &mesh), KDR_OK);
        uint64_t calls = atomic_load(&failing.calls);
        assert_true(calls >= 2);
        kdr_mesh_destroy(mesh);
        int refused = 0;
        for (uint64_t n = 1; n <= calls; n++) {
            for (int from_there_on = 0; from_there_on < 2; from_there_on++) {
                if (from_there_on)
                    failing_alloc_fail_from(&failing, n);
                else
                    failing_alloc_fail_nth(&failing, n);
                kdr_status status = try_bytes(name, file.bytes, file.length, &mesh);
                if (status == KDR_OK) { // giving back spare room may fail: the mesh then keeps it
                    check_promise(mesh);
                    kdr_mesh_destroy(mesh);
                } else {
                    assert_int_equal(status, KDR_ERROR_OUT_OF_MEMORY);
                    assert_null(mesh);
                    assert_int_equal(heard.errors, 1);
                    assert_non_null(strstr(heard.error, "out of memory"));
                    refused++;
                }
                assert_int_equal(kdr_render_bytes(), 0);
                assert_true(failing_alloc_is_clean(&failing));
            }
        }
        assert_true(refused >= 2);
    }
    kdr_mesh_memory_replace(NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_file_cut_short_anywhere_is_refused_or_read_soundly),
        cmocka_unit_test(a_binary_file_cut_short_is_always_refused),
        cmocka_unit_test(a_file_with_changed_bytes_is_refused_or_read_soundly),
        cmocka_unit_test(a_file_with_other_numbers_is_refused_or_read_soundly),
        cmocka_unit_test(every_allocation_that_fails_is_told_and_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
