/* A plan as text: what is read, what is refused and how, and that what is printed is read back. */
#include "support/everywhere.h"
#include "support/random.h"
#include "support/soup.h"
#include "support/test_size.h"

#include <locale.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define ROUNDS TEST_SIZE(20000)
#define TRACED " lazy-limit=0 trace=auto nodes=structures mailbox=0 test=watertight"

/* What stands between the axis and the costs where nothing is said of it. */
#define BETWEEN "order=dfs share=none events=2 straddle=auto retract=no box-weight=0 empty-bonus=1 "
#define USUAL                                                                                                          \
    "split=binned axis=best " BETWEEN                                                                                  \
    "traversal-cost=16 intersection-cost=1 leaf-limit=64 depth-limit=0 reference-limit=0" TRACED

static kdr_build_def parsed(const char *text) {
    kdr_build_def def;
    char problem[300] = "";
    if (kdr_build_def_parse(text, &def, problem, sizeof problem) != KDR_OK)
        fail_msg("\"%s\" is refused: %s", text, problem);
    assert_string_equal(problem, "");
    return def;
}

/* The text of a def, in storage that the next call reuses. */
static const char *printed(const kdr_build_def *def) {
    static char text[KDR_PLAN_TEXT_SIZE];
    assert_int_equal(kdr_build_def_print(def, text, sizeof text), KDR_OK);
    return text;
}

static void assert_reads_as(const char *text, const char *expected) {
    kdr_build_def def = parsed(text);
    assert_string_equal(printed(&def), expected);
}

static void assert_same_def(const kdr_build_def *a, const kdr_build_def *b) {
    assert_true(a->size == b->size && a->split == b->split && a->axis == b->axis);
    assert_true(a->cost_traversal == b->cost_traversal && a->cost_intersection == b->cost_intersection);
    assert_true(a->leaf_limit == b->leaf_limit && a->depth_limit == b->depth_limit);
    assert_true(a->reference_limit == b->reference_limit && a->lazy_limit == b->lazy_limit &&
                a->box_weight == b->box_weight);
    assert_true(a->order == b->order && a->share == b->share && a->share_count == b->share_count);
    assert_true(a->events == b->events && a->straddle == b->straddle && a->retract == b->retract);
    assert_true(a->empty_bonus == b->empty_bonus);
    assert_true(a->trace == b->trace && a->nodes == b->nodes && a->mailbox == b->mailbox && a->test == b->test);
}

static void no_words_are_the_default_plan(void **state) {
    (void)state;
    kdr_build_def def = kdr_default_build_def();
    assert_string_equal(printed(&def), USUAL);
    assert_reads_as("", USUAL);
    assert_reads_as(" \t\n ", USUAL);
    assert_reads_as(USUAL, USUAL);
    assert_reads_as("nodes=structures mailbox=0 trace=auto", USUAL);
}

static void keys_are_read_in_any_order_and_what_is_left_out_has_its_default(void **state) {
    (void)state;
    assert_reads_as("  reference-limit=2.5  split=binned\taxis=robin ",
                    "split=binned axis=robin " BETWEEN
                    "traversal-cost=16 intersection-cost=1 leaf-limit=64 depth-limit=0 "
                    "reference-limit=2.5" TRACED);
    assert_reads_as("depth-limit=60 leaf-limit=4294967295 intersection-cost=1e-3 traversal-cost=1e6",
                    "split=binned axis=best " BETWEEN
                    "traversal-cost=1e+06 intersection-cost=0.001 leaf-limit=4294967295 "
                    "depth-limit=60 reference-limit=0" TRACED);
    assert_reads_as("mailbox=16 nodes=arrays trace=restart",
                    "split=binned axis=best " BETWEEN
                    "traversal-cost=16 intersection-cost=1 leaf-limit=64 depth-limit=0 "
                    "reference-limit=0 lazy-limit=0 trace=restart nodes=arrays mailbox=16 test=watertight");
    assert_reads_as("test=projection trace=backtrack",
                    "split=binned axis=best " BETWEEN
                    "traversal-cost=16 intersection-cost=1 leaf-limit=64 depth-limit=0 reference-limit=0 "
                    "lazy-limit=0 trace=backtrack nodes=structures mailbox=0 test=projection");
}

static void the_sweep_has_a_bonus_and_best_quality_is_a_sweep_with_all_its_arts(void **state) {
    (void)state;
    assert_reads_as("split=sweep events=3 straddle=clip order=bfs",
                    "split=sweep axis=best order=bfs share=none events=3 straddle=clip retract=no box-weight=0 "
                    "empty-bonus=0.8 traversal-cost=16 intersection-cost=1 leaf-limit=64 depth-limit=0 "
                    "reference-limit=0" TRACED);
    static const char best[] = "split=sweep axis=best order=dfs share=none events=2 straddle=clip retract=yes "
                               "box-weight=0.8 empty-bonus=1 traversal-cost=16 intersection-cost=1 leaf-limit=32 "
                               "depth-limit=0 reference-limit=0" TRACED;
    assert_reads_as("quality=best", best);
    assert_reads_as("quality=balanced", USUAL);
    assert_reads_as("quality=fast", "split=binned axis=best " BETWEEN
                                    "traversal-cost=96 intersection-cost=1 leaf-limit=384 depth-limit=0 "
                                    "reference-limit=0" TRACED);
    assert_reads_as("quality=lazy", "split=binned axis=best " BETWEEN
                                    "traversal-cost=96 intersection-cost=1 leaf-limit=384 depth-limit=0 "
                                    "reference-limit=0 lazy-limit=4096 trace=auto nodes=structures mailbox=0 "
                                    "test=watertight");
    kdr_build_def def = kdr_quality_build_def(KDR_QUALITY_BEST);
    assert_string_equal(printed(&def), best);
    def = kdr_quality_build_def((kdr_quality)77);
    assert_string_equal(printed(&def), USUAL);
    // Other keys change it, wherever they stand.
    kdr_build_def first = parsed("leaf-limit=8 retract=no quality=best"),
                  last = parsed("quality=best leaf-limit=8 retract=no");
    assert_string_equal(printed(&first), printed(&last));
    assert_true(first.leaf_limit == 8 && !first.retract && first.split == KDR_SPLIT_SWEEP);
}

static void a_share_has_a_number_of_regions(void **state) {
    (void)state;
    static const struct {
        const char *text;
        kdr_share_rule share;
        uint32_t count;
    } shares[] = {{"none", KDR_SHARE_NONE, 0},         {"serial/1", KDR_SHARE_SERIAL, 1},
                  {"line/1024", KDR_SHARE_LINE, 1024}, {"grid/7", KDR_SHARE_GRID, 7},
                  {"cluster/3", KDR_SHARE_CLUSTER, 3}, {"cluster", KDR_SHARE_CLUSTER, 8}};
    for (size_t i = 0; i < sizeof shares / sizeof shares[0]; i++) {
        char text[40];
        snprintf(text, sizeof text, "share=%s", shares[i].text);
        kdr_build_def def = parsed(text), back = parsed(printed(&def));
        assert_true(def.share == shares[i].share && def.share_count == shares[i].count);
        assert_true(back.share == def.share && back.share_count == def.share_count);
    }
}

static void medians_have_defaults_of_their_own(void **state) {
    (void)state;
    static const char *const splits[] = {"space", "object"};
    for (int i = 0; i < 2; i++) {
        char text[100], expected[KDR_PLAN_TEXT_SIZE];
        snprintf(text, sizeof text, "split=%s", splits[i]);
        snprintf(expected, sizeof expected,
                 "split=%s axis=longest " BETWEEN "traversal-cost=16 intersection-cost=1 leaf-limit=8 depth-limit=0 "
                 "reference-limit=0" TRACED,
                 splits[i]);
        assert_reads_as(text, expected);
    }
}

static void a_plan_is_printed_whole_or_not_at_all(void **state) {
    (void)state;
    kdr_build_def def = kdr_default_build_def();
    char text[sizeof USUAL];
    assert_int_equal(kdr_build_def_print(&def, text, sizeof text), KDR_OK);
    assert_string_equal(text, USUAL);
    text[0] = 'x';
    assert_int_equal(kdr_build_def_print(&def, text, sizeof text - 1), KDR_ERROR_LIMIT);
    assert_int_equal(kdr_build_def_print(&def, text, 0), KDR_ERROR_LIMIT);
    assert_int_equal(text[0], 'x');
    assert_int_equal(kdr_build_def_print(&def, NULL, 100), KDR_ERROR_INVALID_ARGUMENT);
    assert_int_equal(kdr_build_def_print(NULL, text, sizeof text), KDR_ERROR_INVALID_ARGUMENT);
    def.size--;
    assert_int_equal(kdr_build_def_print(&def, text, sizeof text), KDR_ERROR_INVALID_ARGUMENT);
}

static float any_between(test_random *random, float low, float high) {
    float value = low * expf(test_random_float(random) * logf(high / low));
    return fminf(fmaxf(value, low), high);
}

static void what_is_printed_is_read_back_to_the_bit(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 1);
    for (int i = 0; i < ROUNDS; i++) {
        kdr_build_def def = kdr_default_build_def();
        def.split = (kdr_split_rule)test_random_below(&random, 4);
        def.order = (kdr_order_rule)test_random_below(&random, 2);
        def.share = (kdr_share_rule)test_random_below(&random, 5);
        def.share_count = def.share == KDR_SHARE_NONE ? 0 : 1 + test_random_below(&random, KDR_MAX_SHARE_COUNT);
        def.retract = test_random_below(&random, 2) > 0;
        def.empty_bonus = 1;
        def.straddle = (kdr_straddle_rule)test_random_below(&random, 3);
        if (def.split == KDR_SPLIT_SWEEP) {
            def.events = (kdr_event_form)(2 + test_random_below(&random, 2));
            def.box_weight = test_random_float(&random);
            def.empty_bonus = any_between(&random, 1e-3f, 1);
        }
        def.axis = (kdr_axis_rule)(1 + test_random_below(&random, 3));
        def.cost_traversal = any_between(&random, 1e-45f, 1e6f);
        def.cost_intersection = any_between(&random, 1e-3f, 1e6f);
        def.reference_limit = any_between(&random, 1, 1e6f);
        def.leaf_limit = 1 + (test_random_u32(&random) >> test_random_below(&random, 32)) / 2;
        def.depth_limit = test_random_below(&random, KDR_MAX_DEPTH + 1);
        def.trace = (kdr_trace_rule)test_random_below(&random, KDR_TRACE_BACKTRACK + 1);
        if (def.trace != KDR_TRACE_AUTO)
            def.mailbox = (kdr_mailbox_rule)test_random_below(&random, KDR_MAILBOX_64 + 1);
        if (def.trace != KDR_TRACE_AUTO)
            def.test = (kdr_triangle_test)test_random_below(&random, 3);
        if (def.trace == KDR_TRACE_STACK || def.trace == KDR_TRACE_RESTART)
            def.nodes = (kdr_nodes_rule)test_random_below(&random, 2);
        bool whole = def.split == KDR_SPLIT_SWEEP || def.order == KDR_ORDER_BREADTH_FIRST || def.retract ||
                     def.nodes == KDR_NODES_ARRAYS || def.trace == KDR_TRACE_BACKTRACK ||
                     def.test == KDR_TEST_PROJECTION;
        if (!whole && test_random_below(&random, 2))
            def.lazy_limit =
                KDR_MIN_LAZY_LIMIT + test_random_below(&random, KDR_MAX_LAZY_LIMIT - KDR_MIN_LAZY_LIMIT + 1);
        kdr_build_def back = parsed(printed(&def));
        assert_same_def(&back, &def);
    }
}

static void the_longest_plan_fits(void **state) {
    (void)state;
    kdr_build_def def = kdr_default_build_def();
    def.split = KDR_SPLIT_SWEEP;
    def.axis = KDR_AXIS_LONGEST;
    def.share = KDR_SHARE_CLUSTER;
    def.share_count = KDR_MAX_SHARE_COUNT;
    def.box_weight = def.empty_bonus = 1.17549435e-38f;
    def.cost_traversal = def.cost_intersection = 1.17549435e-38f;
    def.leaf_limit = UINT32_MAX;
    def.depth_limit = KDR_MAX_DEPTH;
    def.reference_limit = 123456.789f;
    def.trace = KDR_TRACE_SHORT_STACK;
    def.mailbox = KDR_MAILBOX_64;
    def.test = KDR_TEST_MOLLER_TRUMBORE;
    assert_true(strlen(printed(&def)) < KDR_PLAN_TEXT_SIZE - 16);
}

static void every_key_is_explained_and_printed(void **state) {
    (void)state;
    size_t count = 0;
    for (; kdr_build_def_key_name(count); count++) {
        char word[100];
        snprintf(word, sizeof word, " %s=", kdr_build_def_key_name(count));
        // The quality stands for all other keys.
        if (count > 0)
            assert_non_null(strstr(" " USUAL, word));
        assert_true(strlen(kdr_build_def_key_text(count)) > 20);
        assert_non_null(strstr(kdr_build_def_key_text(count), "default "));
    }
    assert_int_equal(count, 20);
    assert_null(kdr_build_def_key_text(count));
    assert_null(kdr_build_def_key_name(SIZE_MAX));
}

static void a_locale_with_another_point_changes_nothing(void **state) {
    (void)state;
    // Where no such locale is installed the test proves what it can: the one there is.
    if (!setlocale(LC_NUMERIC, "de_DE.UTF-8") && !setlocale(LC_NUMERIC, "fr_FR.UTF-8"))
        print_message("no locale with a comma is installed\n");
    kdr_build_def def = parsed("traversal-cost=2.5");
    assert_true(def.cost_traversal == 2.5f);
    assert_non_null(strstr(printed(&def), "traversal-cost=2.5 "));
    setlocale(LC_NUMERIC, "C");
}

static void a_commit_refuses_rules_that_there_are_not(void **state) {
    (void)state;
    kdr_device *device;
    assert_int_equal(kdr_device_create(NULL, &device), KDR_OK);
    kdr_scene *scene = committed_scene(device, NULL, 0, NULL);
    for (int i = 0; i < 18; i++) {
        kdr_build_def def = kdr_default_build_def();
        def.trace = KDR_TRACE_STACK;
        switch (i % 9) {
        case 0: def.split = (kdr_split_rule)(i == 0 ? 4 : -1); break;
        case 1: def.axis = (kdr_axis_rule)(i == 1 ? 4 : -1); break;
        case 2: def.trace = (kdr_trace_rule)(i == 2 ? 6 : -1); break;
        case 3: def.nodes = (kdr_nodes_rule)(i == 3 ? 2 : -1); break;
        case 4: def.order = (kdr_order_rule)(i == 4 ? 2 : -1); break;
        case 5: def.share = (kdr_share_rule)(i == 5 ? 5 : -1), def.share_count = 2; break;
        case 6: def.share_count = i == 6 ? 1 : KDR_MAX_SHARE_COUNT + 1, def.share = i == 6 ? 0 : KDR_SHARE_LINE; break;
        case 7: def.mailbox = (kdr_mailbox_rule)(i == 7 ? 5 : -1); break;
        default: def.test = (kdr_triangle_test)(i == 8 ? 3 : -1);
        }
        char text[KDR_PLAN_TEXT_SIZE];
        assert_int_equal(kdr_scene_commit(scene, &def), KDR_ERROR_INVALID_ARGUMENT);
        assert_int_equal(kdr_build_def_print(&def, text, sizeof text), KDR_ERROR_INVALID_ARGUMENT);
    }
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
}

static void a_commit_with_another_rule_builds_again_and_with_the_same_one_does_not(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 2);
    soup_scene soup = soup_scene_create_kind(&random, soup_kind_find("small"), 800);
    kdr_device *device;
    assert_int_equal(kdr_device_create(NULL, &device), KDR_OK);
    kdr_scene *scene = committed_scene(device, soup.geometries, SOUP_GEOMETRIES, NULL);
    static const char *const plans[] = {"split=space",
                                        "split=space axis=robin",
                                        "split=object axis=robin",
                                        "split=sweep",
                                        "split=sweep straddle=clip",
                                        "share=line/5",
                                        ""};
    for (size_t i = 0; i < sizeof plans / sizeof plans[0]; i++) {
        uint64_t before = kdr_scene_hash(scene);
        kdr_build_def def = parsed(plans[i]);
        assert_int_equal(kdr_scene_commit(scene, &def), KDR_OK);
        assert_true(kdr_scene_hash(scene) != before);

        // A default and what it stands for are one plan.
        kdr_tree_stats first, second;
        assert_int_equal(kdr_scene_stats(scene, &first), KDR_OK);
        kdr_build_def resolved = parsed(printed(&def));
        assert_int_equal(kdr_scene_commit(scene, &resolved), KDR_OK);
        assert_int_equal(kdr_scene_stats(scene, &second), KDR_OK);
        assert_memory_equal(&first, &second, sizeof first);
    }
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
    soup_scene_destroy(&soup);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_words_are_the_default_plan),
        cmocka_unit_test(keys_are_read_in_any_order_and_what_is_left_out_has_its_default),
        cmocka_unit_test(medians_have_defaults_of_their_own),
        cmocka_unit_test(the_sweep_has_a_bonus_and_best_quality_is_a_sweep_with_all_its_arts),
        cmocka_unit_test(a_share_has_a_number_of_regions),
        cmocka_unit_test(a_plan_is_printed_whole_or_not_at_all),
        cmocka_unit_test(what_is_printed_is_read_back_to_the_bit),
        cmocka_unit_test(the_longest_plan_fits),
        cmocka_unit_test(every_key_is_explained_and_printed),
        cmocka_unit_test(a_locale_with_another_point_changes_nothing),
        cmocka_unit_test(a_commit_refuses_rules_that_there_are_not),
        cmocka_unit_test(a_commit_with_another_rule_builds_again_and_with_the_same_one_does_not),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
