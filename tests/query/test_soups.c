/* Every query on every kind of triangle soup, on every instruction set, equals the exact oracle. */
#include "support/everywhere.h"
#include "support/soup.h"
#include "support/test_size.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

#define RAYS TEST_SIZE(1100)   /* more than the longest run of one call */
#define FEW_RAYS TEST_SIZE(60) /* where the same scene is built many times */
#define LONG_ROUNDS 200

/* Soups at their own size, and smaller ones around the size of a block and of a small node. */
static void hold_kind(size_t kind, uint64_t round, size_t case_count, size_t ray_count) {
    static const size_t small_counts[] = {0, 3, 7, 16, 33, 64};
    const soup_kind *drawn = &soup_kinds[kind];
    for (int part = 0; part < 2; part++) {
        size_t count = part == 0 ? drawn->count : small_counts[(kind + round) % 6];
        uint64_t sequence = (round * soup_kind_count + kind) * 4 + (uint64_t)part * 2;
        test_random random = test_random_start(test_random_seed(), sequence);
        soup_scene scene = soup_scene_create_kind(&random, drawn, count);
        size_t asked = drawn->is_exact ? ray_count / 6 + 1 : ray_count;
        char label[100];
        snprintf(label, sizeof(label), "%s, %zu triangles, sequence %llu", drawn->name, count,
                 (unsigned long long)sequence);
        hold_awkward_rays_everywhere(scene.geometries, SOUP_GEOMETRIES, sequence + 1, asked, case_count, label);
        soup_scene_destroy(&scene);
    }
}

static void every_kind_of_soup_is_answered_as_by_the_oracle(void **state) {
    (void)state;
    assert_true(soup_kind_count > 20);
    for (size_t kind = 0; kind < soup_kind_count; kind++)
        hold_kind(kind, 0, 1, RAYS);
}

static void every_build_def_gives_a_tree_that_answers_as_the_oracle(void **state) {
    (void)state;
    for (size_t kind = 0; kind < soup_kind_count; kind++)
        hold_kind(kind, 1, BUILD_CASE_COUNT, FEW_RAYS);
}

static void a_long_run_finds_nothing_that_a_short_one_missed(void **state) {
    (void)state;
    uint64_t rounds = test_is_long() ? LONG_ROUNDS : 1;
    for (uint64_t round = 2; round < 2 + rounds; round++)
        for (size_t kind = 0; kind < soup_kind_count; kind++)
            hold_kind(kind, round, round % 2 ? BUILD_CASE_COUNT : 2, FEW_RAYS);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_of_soup_is_answered_as_by_the_oracle),
        cmocka_unit_test(every_build_def_gives_a_tree_that_answers_as_the_oracle),
        cmocka_unit_test(a_long_run_finds_nothing_that_a_short_one_missed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
