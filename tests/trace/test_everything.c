/* Every traversal, layout of nodes and mailbox, on every instruction set, in every query for rays, over trees of every
 * splitter, share, axis and order: what other tests prove of one table with the rest left at its default, for all of
 * them together. Rays are awkward for the triangles and for the planes of the very tree (cell_rays.h), and half of
 * them come in bundles, so that packets meet awkward rays too.
 *
 * A release build asks all of it with one mailbox a tree and traversal; under sanitizers it is a random part, by seed.
 * KDR_TEST_LONG=1 (`./run check`): all mailboxes, widths and coherences, all axes, more triangles and many more rays.
 */
#include "scene/scene.h"
#include "support/plan_rows.h"
#include "support/test_size.h"
#include "support/trace_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

/* Builder number i of split_row_count * share_row_count * axis_row_count. The seed shifts what goes together. */
static void hold_builder(size_t i, trace_report *report) {
    const size_t builders = split_row_count * share_row_count, shift = (size_t)(test_random_seed() % 1000);
    const soup_kind *kind = &soup_kinds[(i * 5 + i / soup_kind_count + shift) % soup_kind_count];
    /* So few triangles are one leaf by the default costs. */
    static const char *const costs[] = {"traversal-cost=0.01 leaf-limit=1 depth-limit=60",
                                        "traversal-cost=0.5 leaf-limit=4",
                                        "traversal-cost=0.1 leaf-limit=2 reference-limit=20", ""};
    trace_case asked = {.kind = kind,
                        .triangles = kind->is_exact ? 12 + i % 20 : 20 + i * 13 % 44,
                        .rays = 32,
                        .sequence = 1000 + i,
                        .split = split_rows[i / share_row_count % split_row_count],
                        .axis = axis_rows[(i / builders + i) % axis_row_count],
                        .share = share_rows[i % share_row_count],
                        .order = order_rows[(i / 3 + shift) % order_row_count],
                        .costs = costs[(i + i / 25 + shift) % 4],
                        .is_whole = test_is_long()};
    if (test_is_long()) {
        asked.triangles = kind->count;
        asked.rays = kind->is_exact ? 32 : 96;
    }
    trace_check(&asked, NULL, report);
    if (report->wrong_scenes > 0)
        fail_msg("%s", report->first);
}

static void every_traversal_answers_as_the_oracle_over_trees_of_every_builder(void **state) {
    (void)state;
    trace_report report = {0};
    test_random random = test_random_start(test_random_seed(), 999);
    const size_t builders = split_row_count * share_row_count * (test_is_long() ? axis_row_count : 1);
    for (size_t i = 0; i < builders; i++) {
        if (test_is_long() && i % 25 == 0)
            print_message("%zu of %zu builders, %zu scenes\n", i, builders, report.scenes);
        if (test_is_long() || test_random_below(&random, (uint32_t)builders) < TEST_SIZE(builders))
            hold_builder(i, &report);
    }
    print_message("%zu scenes, %zu rays, %zu hits\n", report.scenes, report.rays, report.hits);
    assert_true(report.scenes >= 2 * trace_row_count);
    assert_true(report.hits > report.rays / 10);
}

/* Whoever adds a traversal to the tables adds its row. */
static void every_traversal_of_the_tables_has_a_row(void **state) {
    (void)state;
    const kdr_named_traversals *table = kdr_named_traversals_for(KDR_ISA_SCALAR);
    size_t named = 0;
    for (size_t row = 1; row < trace_row_count; row++) {
        for (size_t i = 0; i < mailbox_row_count; i++) {
            char text[100], problem[200];
            kdr_build_def def;
            snprintf(text, sizeof text, "%s %s", trace_rows[row], mailbox_rows[i]);
            if (kdr_build_def_parse(text, &def, problem, sizeof problem) != KDR_OK)
                fail_msg("%s: %s", text, problem);
            assert_non_null(table->of[def.trace][def.nodes][def.mailbox != KDR_MAILBOX_NONE].closest);
        }
        named++;
    }
    assert_int_equal(mailbox_row_count, KDR_MAILBOX_64 + 1);
    size_t there = 0;
    const kdr_lone *lones = &table->of[0][0][0];
    for (size_t i = 0; i < sizeof *table / sizeof *lones; i++)
        there += lones[i].closest != NULL;
    assert_int_equal(there, 2 * named);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_traversal_of_the_tables_has_a_row),
        cmocka_unit_test(every_traversal_answers_as_the_oracle_over_trees_of_every_builder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
