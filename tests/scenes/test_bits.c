/* The same arguments make the same mesh everywhere. The numbers below were written down once: whoever gets others has
 * another mesh, be it by a change of a scene or by a compiler that does not keep to IEEE 754. After a change that is
 * meant, run the test with KDR_TEST_PRINT=1 and copy the table that it prints. */
#include "kdray/render.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const struct known {
    const char *name;
    uint64_t hash; /* of 10,000 triangles at 0.5 s */
} known[] = {
    {"demo", 0x585a635ee8bc44ca},    {"flake", 0xfe37a041a7bac3fd},   {"forest", 0xa6a70f7c8358f6fc},
    {"city", 0xd2a3336c4d75a7ce},    {"stadium", 0x827adc90ef171d48}, {"grass", 0xf4b601a1e4b8baa2},
    {"hair", 0xb5413c7f2845630a},    {"terrain", 0xc87fbfc556059ab7}, {"sphere", 0x464f9aded394215b},
    {"knot", 0x1cde4e9029b3c37a},    {"shell", 0x8b4eda9e385a174a},   {"needles", 0x25a55e7067fb5422},
    {"soup", 0xabe4acb23c244594},    {"heap", 0xa656e7a30ee8fef6},    {"duplicates", 0x9eced50f9fac0dc5},
    {"explode", 0x9dce4946984cd894}, {"twist", 0x857cfe5c21753fd7},   {"wave", 0xc0a81c0f7a61f0c6},
    {"crowd", 0xc963e54730623dec},
};
#define KNOWN_COUNT (sizeof known / sizeof known[0])

/* By the values of the words, so that byte order does not count. */
static uint64_t hash_words(uint64_t hash, const void *words, size_t count) {
    for (size_t i = 0; words && i < count; i++) {
        uint32_t word;
        memcpy(&word, (const char *)words + i * sizeof word, sizeof word);
        hash = (hash ^ word) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 29;
    }
    return hash;
}

static uint64_t hash_of(const char *name, size_t triangle_count, double time) {
    kdr_mesh *mesh = NULL;
    assert_int_equal(kdr_mesh_make(name, triangle_count, time, NULL, &mesh), KDR_OK);
    uint64_t hash = hash_words((uint64_t)mesh->vertex_count, mesh->positions, 3 * mesh->vertex_count);
    hash = hash_words(hash, mesh->normals, 3 * mesh->vertex_count);
    hash = hash_words(hash, mesh->indices, 3 * mesh->triangle_count);
    hash = hash_words(hash, mesh->triangle_materials, mesh->triangle_count);
    kdr_mesh_destroy(mesh);
    return hash;
}

static void the_bits_are_those_written_down(void **state) {
    (void)state;
    if (getenv("KDR_TEST_PRINT"))
        for (size_t i = 0; kdr_mesh_builtin_name(i); i++)
            printf("    {\"%s\", 0x%016llx},\n", kdr_mesh_builtin_name(i),
                   (unsigned long long)hash_of(kdr_mesh_builtin_name(i), 10000, 0.5));
    for (size_t i = 0; i < KNOWN_COUNT; i++) {
        uint64_t hash = hash_of(known[i].name, 10000, 0.5);
        if (hash != known[i].hash)
            fail_msg("%s: 0x%016llx instead of 0x%016llx", known[i].name, (unsigned long long)hash,
                     (unsigned long long)known[i].hash);
    }
}

static void every_scene_is_written_down(void **state) {
    (void)state;
    size_t count = 0;
    for (; kdr_mesh_builtin_name(count); count++) {
        assert_in_range(count, 0, KNOWN_COUNT - 1);
        assert_string_equal(known[count].name, kdr_mesh_builtin_name(count));
    }
    assert_int_equal(count, KNOWN_COUNT);
}

static void the_same_arguments_make_the_same_mesh_again(void **state) {
    (void)state;
    static const size_t sizes[] = {100, 1000, 30000};
    for (size_t i = 0; kdr_mesh_builtin_name(i); i++)
        for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
            const char *name = kdr_mesh_builtin_name(i);
            assert_int_equal(hash_of(name, sizes[k], 1.25), hash_of(name, sizes[k], 1.25));
        }
}

static void another_size_makes_another_mesh(void **state) {
    (void)state;
    for (size_t i = 0; kdr_mesh_builtin_name(i); i++)
        assert_int_not_equal(hash_of(kdr_mesh_builtin_name(i), 1000, 0), hash_of(kdr_mesh_builtin_name(i), 2000, 0));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_bits_are_those_written_down),
        cmocka_unit_test(every_scene_is_written_down),
        cmocka_unit_test(the_same_arguments_make_the_same_mesh_again),
        cmocka_unit_test(another_size_makes_another_mesh),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
