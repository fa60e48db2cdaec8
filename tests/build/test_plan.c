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
#define USUAL                                                                                                          \
    "split=binned axis=best order=dfs share=none events=2 straddle=general retract=no empty-bonus=1 "                   \
    "traversal-cost=16 intersection-cost=1 leaf-limit=64 depth-limit=0 reference-limit=4"

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
    assert_true(a->size == b->size && a->split == b->split && a->axis == b->axis && a->order == b->order);
    assert_true(a->share == b->share && a->share_count == b->share_count);
    assert_true(a->events == b->events && a->straddle == b->straddle && a->retract == b->retract);
    assert_true(a->empty_bonus == b->empty_bonus);
    assert_true(a->cost_traversal == b->cost_traversal && a->cost_intersection == b->cost_intersection);
    assert_true(a->leaf_limit == b->leaf_limit && a->depth_limit == b->depth_limit);
    assert_true(a->reference_limit == b->reference_limit);
}

static void no_words_are_the_default_plan(void **state) {
    (void)state;
    kdr_build_def def = kdr_default_build_def();
    assert_string_equal(printed(&def), USUAL);
    assert_reads_as("", USUAL);
    assert_reads_as(" \t\n ", USUAL);
    assert_reads_as(USUAL, USUAL);
}

static void keys_are_read_in_any_order_and_what_is_left_out_has_its_default(void **state) {
    (void)state;
    assert_reads_as("  reference-limit=2.5  split=binned\taxis=robin ",
                    "split=binned axis=robin order=dfs share=none events=2 straddle=general retract=no empty-bonus=1 "
                    "traversal-cost=16 intersection-cost=1 leaf-limit=64 depth-limit=0 reference-limit=2.5");
    assert_reads_as("depth-limit=60 leaf-limit=4294967295 intersection-cost=1e-3 traversal-cost=1e6",
                    "split=binned axis=best order=dfs share=none events=2 straddle=general retract=no empty-bonus=1 "
                    "traversal-cost=1e+06 intersection-cost=0.001 leaf-limit=4294967295 depth-limit=60 "
                    "reference-limit=4");
    assert_reads_as("retract=yes empty-bonus=0.25 share=grid/1024 order=bfs",
                    "split=binned axis=best order=bfs share=grid/1024 events=2 straddle=general retract=yes "
                    "empty-bonus=0.25 traversal-cost=16 intersection-cost=1 leaf-limit=64 depth-limit=0 "
                    "reference-limit=4");
}

static void medians_and_the_sweep_have_defaults_of_their_own(void **state) {
    (void)state;
    static const struct {
        const char *split, *axis, *bonus;
        int leaf_limit;
    } rows[] = {{"space", "longest", "1", 8}, {"object", "longest", "1", 8}, {"sweep", "best", "0.8", 64}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        char text[100], expected[KDR_PLAN_TEXT_SIZE];
        snprintf(text, sizeof text, "split=%s", rows[i].split);
        snprintf(expected, sizeof expected,
                 "split=%s axis=%s order=dfs share=none events=2 straddle=general retract=no empty-bonus=%s "
                 "traversal-cost=16 intersection-cost=1 leaf-limit=%d depth-limit=0 reference-limit=4",
                 rows[i].split, rows[i].axis, rows[i].bonus, rows[i].leaf_limit);
        assert_reads_as(text, expected);
    }
}

static void every_word_of_every_key_is_read(void **state) {
    (void)state;
    static const char *const words[] = {
        "split=binned",     "split=space",
        "split=object",     "split=sweep",
        "axis=best",        "axis=longest",
        "axis=robin",       "order=dfs",
        "order=bfs",        "share=none",
        "share=serial/1",   "share=line/2",
        "share=grid/64",    "share=cluster/1024",
        "events=2",         "split=sweep events=3",
        "straddle=general", "split=sweep straddle=clip",
        "retract=no",       "retract=yes",
        "empty-bonus=0.5",  "split=sweep events=3 straddle=clip empty-bonus=1",
    };
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        char found[KDR_PLAN_TEXT_SIZE + 2], word[80];
        kdr_build_def def = parsed(words[i]);
        snprintf(found, sizeof found, " %s ", printed(&def));
        for (const char *at = words[i]; *at; at += strcspn(at, " "), at += *at == ' ') {
            snprintf(word, sizeof word, " %.*s ", (int)strcspn(at, " "), at);
            assert_non_null(strstr(found, word));
        }
    }
}

static void a_number_of_regions_is_asked_for_by_a_slash_and_clusters_are_eight(void **state) {
    (void)state;
    kdr_build_def def = parsed("share=cluster");
    assert_true(def.share == KDR_SHARE_CLUSTER && def.share_count == 8);
    def = parsed("share=line/7");
    assert_true(def.share == KDR_SHARE_LINE && def.share_count == 7);
    def = parsed("share=none");
    assert_true(def.share == KDR_SHARE_NONE && def.share_count == 0);
}

static void pairs_that_do_not_go_together_are_refused_with_a_sentence(void **state) {
    (void)state;
    static const char events[] =
        "three events are for the sweep only: split=binned, space and object have no events";
    static const char clip[] = "only the sweep clips triangles: straddle=clip goes with split=sweep";
    static const char bonus[] =
        "empty-bonus is a constant of the heuristic, which split=space and object do not ask";
    static const char *const wrong[][2] = {
        {"events=3", events},
        {"split=space events=3", events},
        {"events=3 split=object", events},
        {"straddle=clip", clip},
        {"split=object straddle=clip", clip},
        {"straddle=clip split=space order=bfs", clip},
        {"split=space empty-bonus=0.8", bonus},
        {"split=object empty-bonus=0.999", bonus},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        kdr_build_def def = {.size = 7}, before = def;
        char problem[200] = "";
        if (kdr_build_def_parse(wrong[i][0], &def, problem, sizeof problem) != KDR_ERROR_INVALID_ARGUMENT)
            fail_msg("\"%s\" is not refused", wrong[i][0]);
        assert_string_equal(problem, wrong[i][1]);
        assert_same_def(&def, &before);
    }
    parsed("split=space empty-bonus=1");
}

static void wrong_words_are_refused_with_a_sentence_that_names_them(void **state) {
    (void)state;
    static const char any_key[] = "expected KEY=VALUE with one of the keys split, axis, order, share, events, "
                                  "straddle, retract, empty-bonus, traversal-cost, intersection-cost, "
                                  "leaf-limit, depth-limit or reference-limit, found ";
    static const char real[] = "a number above 0 and at most 1e+06", whole[] = "a whole number from 1 to 4294967295";
    static const char split[] = "binned, space, object or sweep", bonus[] = "a number above 0 and at most 1";
    static const char share[] = "none, serial/N, line/N, grid/N or cluster/N with N from 1 to 1024";
    static const struct {
        const char *text, *key, *allowed, *found;
    } wrong[] = {
        {"split=middle", "split", split, "middle"},
        {"split=", "split", split, ""},
        {"split=Binned", "split", split, "Binned"},
        {"split=binned=", "split", split, "binned="},
        {"axis=x", "axis", "best, longest or robin", "x"},
        {"axis=", "axis", "best, longest or robin", ""},
        {"axis=bes", "axis", "best, longest or robin", "bes"},
        {"order=xyz", "order", "dfs or bfs", "xyz"},
        {"order=", "order", "dfs or bfs", ""},
        {"share=line", "share", share, "line"},
        {"share=line/", "share", share, "line/"},
        {"share=line/0", "share", share, "line/0"},
        {"share=line/1025", "share", share, "line/1025"},
        {"share=line/2/2", "share", share, "line/2/2"},
        {"share=line/-2", "share", share, "line/-2"},
        {"share=/2", "share", share, "/2"},
        {"share=serial", "share", share, "serial"},
        {"share=grid", "share", share, "grid"},
        {"share=cluster/0", "share", share, "cluster/0"},
        {"share=cluster/", "share", share, "cluster/"},
        {"share=none/3", "share", share, "none/3"},
        {"share=none/0", "share", share, "none/0"},
        {"share=", "share", share, ""},
        {"share=slices/3", "share", share, "slices/3"},
        {"events=1", "events", "2 or 3", "1"},
        {"events=", "events", "2 or 3", ""},
        {"events=two", "events", "2 or 3", "two"},
        {"straddle=both", "straddle", "general or clip", "both"},
        {"retract=maybe", "retract", "no or yes", "maybe"},
        {"retract=1", "retract", "no or yes", "1"},
        {"empty-bonus=0", "empty-bonus", bonus, "0"},
        {"empty-bonus=1.01", "empty-bonus", bonus, "1.01"},
        {"empty-bonus=-0.5", "empty-bonus", bonus, "-0.5"},
        {"traversal-cost=0", "traversal-cost", real, "0"},
        {"traversal-cost=-1", "traversal-cost", real, "-1"},
        {"traversal-cost=nan", "traversal-cost", real, "nan"},
        {"traversal-cost=inf", "traversal-cost", real, "inf"},
        {"traversal-cost=1e-60", "traversal-cost", real, "1e-60"},
        {"traversal-cost=1,5", "traversal-cost", real, "1,5"},
        {"traversal-cost=0x10", "traversal-cost", real, "0x10"},
        {"intersection-cost=1000001", "intersection-cost", real, "1000001"},
        {"intersection-cost=1e999", "intersection-cost", real, "1e999"},
        {"intersection-cost=1e", "intersection-cost", real, "1e"},
        {"leaf-limit=0", "leaf-limit", whole, "0"},
        {"leaf-limit=4294967296", "leaf-limit", whole, "4294967296"},
        {"leaf-limit=1.5", "leaf-limit", whole, "1.5"},
        {"leaf-limit=-1", "leaf-limit", whole, "-1"},
        {"leaf-limit=", "leaf-limit", whole, ""},
        {"depth-limit=61", "depth-limit", "a whole number from 0 to 60", "61"},
        {"reference-limit=0.99", "reference-limit", "a number from 1 to 1e+06", "0.99"},
        {"split=space depth-limit=x", "depth-limit", "a whole number from 0 to 60", "x"},
        {"splt=binned", NULL, any_key, "splt=binned"},
        {"split", NULL, any_key, "split"},
        {"=space", NULL, any_key, "=space"},
        {"split =space", NULL, any_key, "split"},
        {"split=space,axis=best", "split", split, "space,axis=best"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        char expected[400], problem[400] = "";
        if (wrong[i].key)
            snprintf(expected, sizeof expected, "%s: expected %s, found \"%s\"", wrong[i].key, wrong[i].allowed,
                     wrong[i].found);
        else
            snprintf(expected, sizeof expected, "%s\"%s\"", wrong[i].allowed, wrong[i].found);
        kdr_build_def def = {.size = 7}, before = def;
        if (kdr_build_def_parse(wrong[i].text, &def, problem, sizeof problem) != KDR_ERROR_INVALID_ARGUMENT)
            fail_msg("\"%s\" is not refused", wrong[i].text);
        assert_string_equal(problem, expected);
        assert_same_def(&def, &before);
    }
}

static void a_key_given_twice_is_refused(void **state) {
    (void)state;
    for (const char *at = USUAL; *at; at += strcspn(at, " "), at += *at == ' ') {
        int key = (int)strcspn(at, "="), word = (int)strcspn(at, " ");
        char text[100], expected[200], problem[200];
        snprintf(text, sizeof text, "%.*s %.*s", word, at, word, at);
        snprintf(expected, sizeof expected, "%.*s: expected it once, found \"%.*s\" as well", key, at, word, at);
        kdr_build_def def;
        assert_int_equal(kdr_build_def_parse(text, &def, problem, sizeof problem), KDR_ERROR_INVALID_ARGUMENT);
        assert_string_equal(problem, expected);
    }
}

static void a_sentence_is_cut_to_the_room_there_is(void **state) {
    (void)state;
    kdr_build_def def;
    char problem[12] = "untouched..";
    assert_int_equal(kdr_build_def_parse("axis=x", &def, problem, 0), KDR_ERROR_INVALID_ARGUMENT);
    assert_string_equal(problem, "untouched..");
    assert_int_equal(kdr_build_def_parse("axis=x", &def, problem, 8), KDR_ERROR_INVALID_ARGUMENT);
    assert_string_equal(problem, "axis: e");
    assert_int_equal(kdr_build_def_parse("axis=x", &def, NULL, 100), KDR_ERROR_INVALID_ARGUMENT);
    assert_int_equal(kdr_build_def_parse(NULL, &def, problem, sizeof problem), KDR_ERROR_INVALID_ARGUMENT);
    assert_int_equal(kdr_build_def_parse("", NULL, problem, sizeof problem), KDR_ERROR_INVALID_ARGUMENT);
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
        def.axis = (kdr_axis_rule)(1 + test_random_below(&random, 3));
        def.order = (kdr_order_rule)test_random_below(&random, 2);
        def.share = (kdr_share_rule)test_random_below(&random, 5);
        if (def.share != KDR_SHARE_NONE)
            def.share_count = 1 + test_random_below(&random, KDR_MAX_SHARE_COUNT);
        if (def.split == KDR_SPLIT_SWEEP) {
            def.events = (kdr_event_form)(2 + test_random_below(&random, 2));
            def.straddle = (kdr_straddle_rule)test_random_below(&random, 2);
        }
        bool weighs = def.split == KDR_SPLIT_BINNED || def.split == KDR_SPLIT_SWEEP;
        def.empty_bonus = weighs ? any_between(&random, 1e-45f, 1) : 1;
        def.retract = test_random_below(&random, 2);
        def.cost_traversal = any_between(&random, 1e-45f, 1e6f);
        def.cost_intersection = any_between(&random, 1e-3f, 1e6f);
        def.reference_limit = any_between(&random, 1, 1e6f);
        def.leaf_limit = 1 + (test_random_u32(&random) >> test_random_below(&random, 32)) / 2;
        def.depth_limit = test_random_below(&random, KDR_MAX_DEPTH + 1);
        kdr_build_def back = parsed(printed(&def));
        assert_same_def(&back, &def);
    }
}

static void the_longest_plan_fits(void **state) {
    (void)state;
    kdr_build_def def = kdr_default_build_def();
    def.split = KDR_SPLIT_BINNED;
    def.axis = KDR_AXIS_LONGEST;
    def.share = KDR_SHARE_CLUSTER;
    def.share_count = KDR_MAX_SHARE_COUNT;
    def.retract = true;
    def.empty_bonus = def.cost_traversal = def.cost_intersection = 1.17549435e-38f;
    def.leaf_limit = UINT32_MAX;
    def.depth_limit = KDR_MAX_DEPTH;
    def.reference_limit = 123456.789f;
    assert_true(strlen(printed(&def)) < KDR_PLAN_TEXT_SIZE - 16);
}

static void every_key_is_explained_and_printed(void **state) {
    (void)state;
    size_t count = 0;
    for (; kdr_build_def_key_name(count); count++) {
        char word[100];
        snprintf(word, sizeof word, " %s=", kdr_build_def_key_name(count));
        assert_non_null(strstr(" " USUAL, word));
        assert_true(strlen(kdr_build_def_key_text(count)) > 20);
        assert_non_null(strstr(kdr_build_def_key_text(count), "default "));
    }
    assert_int_equal(count, 13);
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
    for (int i = 0; i < 16; i++) {
        kdr_build_def def = kdr_default_build_def();
        switch (i) {
        case 0: def.split = (kdr_split_rule)4; break;
        case 1: def.split = (kdr_split_rule)-1; break;
        case 2: def.axis = (kdr_axis_rule)4; break;
        case 3: def.axis = (kdr_axis_rule)-1; break;
        case 4: def.order = (kdr_order_rule)2; break;
        case 5: def.order = (kdr_order_rule)-1; break;
        case 6: def.share = (kdr_share_rule)5, def.share_count = 2; break;
        case 7: def.share = (kdr_share_rule)-1, def.share_count = 2; break;
        case 8: def.share = KDR_SHARE_LINE; break;
        case 9: def.share = KDR_SHARE_LINE, def.share_count = KDR_MAX_SHARE_COUNT + 1; break;
        case 10: def.share_count = 1; break;
        case 11: def.split = KDR_SPLIT_SWEEP, def.events = (kdr_event_form)4; break;
        case 12: def.split = KDR_SPLIT_SWEEP, def.straddle = (kdr_straddle_rule)2; break;
        case 13: def.empty_bonus = NAN; break;
        case 14: def.empty_bonus = -0.5f; break;
        default: def.events = KDR_EVENTS_THREE; break;
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
    static const char *const plans[] = {"split=space", "split=space axis=robin", "split=object axis=robin", ""};
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
        cmocka_unit_test(medians_and_the_sweep_have_defaults_of_their_own),
        cmocka_unit_test(every_word_of_every_key_is_read),
        cmocka_unit_test(a_number_of_regions_is_asked_for_by_a_slash_and_clusters_are_eight),
        cmocka_unit_test(pairs_that_do_not_go_together_are_refused_with_a_sentence),
        cmocka_unit_test(wrong_words_are_refused_with_a_sentence_that_names_them),
        cmocka_unit_test(a_key_given_twice_is_refused),
        cmocka_unit_test(a_sentence_is_cut_to_the_room_there_is),
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
