#include "support/everywhere.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static void pairs_that_cannot_be_are_refused_with_a_sentence(void **state) {
    (void)state;
    static const char *const pairs[][2] = {
        {"events=3", "three events are for the sweep only: split=binned, space and object have no events"},
        {"box-weight=0.5", "only the sweep weighs boxes: box-weight goes with split=sweep"},
        {"quality=best split=binned straddle=general box-weight=1",
         "only the sweep weighs boxes: box-weight goes with split=sweep"},
        {"split=object empty-bonus=0.5",
         "empty-bonus is a constant of the heuristic, which split=space and object do not ask"},
        {"split=sweep lazy-limit=64",
         "the sweep sorts the whole scene first: lazy-limit goes with split=binned, space or object"},
        {"quality=lazy order=bfs", "lazy-limit goes with order=dfs and retract=no: rays open one node after the other"},
        {"quality=lazy retract=yes",
         "lazy-limit goes with order=dfs and retract=no: rays open one node after the other"},
        {"lazy-limit=8192 trace=stack nodes=arrays",
         "nodes=arrays, trace=backtrack and test=projection need the whole tree: they do not go with lazy-limit"},
        {"lazy-limit=100 trace=backtrack",
         "nodes=arrays, trace=backtrack and test=projection need the whole tree: they do not go with lazy-limit"},
        {"lazy-limit=100 trace=stack test=projection",
         "nodes=arrays, trace=backtrack and test=projection need the whole tree: they do not go with lazy-limit"},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        char problem[200] = "";
        kdr_build_def def;
        assert_int_equal(kdr_build_def_parse(pairs[i][0], &def, problem, sizeof problem), KDR_ERROR_INVALID_ARGUMENT);
        assert_string_equal(problem, pairs[i][1]);
    }
}

static void wrong_words_are_refused_with_a_sentence_that_names_them(void **state) {
    (void)state;
    static const char any_key[] =
        "expected KEY=VALUE with one of the keys quality, split, axis, order, share, events, "
        "straddle, retract, box-weight, empty-bonus, traversal-cost, intersection-cost, "
        "leaf-limit, depth-limit, reference-limit, lazy-limit, trace, nodes, mailbox or test, found ";
    static const char traces[] = "auto, stack, restart, push-down, short-stack or backtrack";
    static const char shares[] = "none, serial/N, line/N, grid/N or cluster/N with N from 1 to 1024";
    static const char real[] = "a number above 0 and at most 1e+06", whole[] = "a whole number from 1 to 4294967295";
    static const struct {
        const char *text, *key, *allowed, *found;
    } wrong[] = {
        {"split=middle", "split", "binned, space, object or sweep", "middle"},
        {"split=", "split", "binned, space, object or sweep", ""},
        {"split=Binned", "split", "binned, space, object or sweep", "Binned"},
        {"split=binned=", "split", "binned, space, object or sweep", "binned="},
        {"order=xyz", "order", "dfs or bfs", "xyz"},
        {"share=none/3", "share", shares, "none/3"},
        {"share=line/0", "share", shares, "line/0"},
        {"share=line/1025", "share", shares, "line/1025"},
        {"share=grid/", "share", shares, "grid/"},
        {"share=/4", "share", shares, "/4"},
        {"share=cluster/x", "share", shares, "cluster/x"},
        {"share=line/", "share", shares, "line/"},
        {"share=line", "share", shares, "line"},
        {"share=line/2/2", "share", shares, "line/2/2"},
        {"share=line/-2", "share", shares, "line/-2"},
        {"share=none/0", "share", shares, "none/0"},
        {"share=", "share", shares, ""},
        {"order=", "order", "dfs or bfs", ""},
        {"retract=1", "retract", "no or yes", "1"},
        {"empty-bonus=1.01", "empty-bonus", "a number above 0 and at most 1", "1.01"},
        {"events=4", "events", "2 or 3", "4"},
        {"events=", "events", "2 or 3", ""},
        {"retract=maybe", "retract", "no or yes", "maybe"},
        {"straddle=cut", "straddle", "auto, general or clip", "cut"},
        {"quality=good", "quality", "fast, balanced, best or lazy", "good"},
        {"box-weight=-0.1", "box-weight", "a number from 0 to 1", "-0.1"},
        {"empty-bonus=0", "empty-bonus", "a number above 0 and at most 1", "0"},
        {"axis=x", "axis", "best, longest or robin", "x"},
        {"axis=", "axis", "best, longest or robin", ""},
        {"axis=bes", "axis", "best, longest or robin", "bes"},
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
        {"reference-limit=0.99", "reference-limit", "0 or a number from 1 to 1e+06", "0.99"},
        {"lazy-limit=63", "lazy-limit", "0, or a whole number from 64 to 8192", "63"},
        {"lazy-limit=8193", "lazy-limit", "0, or a whole number from 64 to 8192", "8193"},
        {"lazy-limit=100.5", "lazy-limit", "0, or a whole number from 64 to 8192", "100.5"},
        {"trace=best", "trace", traces, "best"},
        {"trace=", "trace", traces, ""},
        {"trace=push", "trace", traces, "push"},
        {"nodes=array", "nodes", "structures or arrays", "array"},
        {"test=exact", "test", "watertight, moller-trumbore or projection", "exact"},
        {"mailbox=4", "mailbox", "0, 8, 16, 32 or 64", "4"},
        {"mailbox=128", "mailbox", "0, 8, 16, 32 or 64", "128"},
        {"mailbox=08", "mailbox", "0, 8, 16, 32 or 64", "08"},
        {"split=space depth-limit=x", "depth-limit", "a whole number from 0 to 60", "x"},
        {"splt=binned", NULL, any_key, "splt=binned"},
        {"split", NULL, any_key, "split"},
        {"=space", NULL, any_key, "=space"},
        {"split =space", NULL, any_key, "split"},
        {"split=space,axis=best", "split", "binned, space, object or sweep", "space,axis=best"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        char expected[400], problem[400] = "";
        if (wrong[i].key)
            snprintf(expected, sizeof expected, "%s: expected %s, found \"%s\"", wrong[i].key, wrong[i].allowed,
                     wrong[i].found);
        else
            snprintf(expected, sizeof expected, "%s\"%s\"", wrong[i].allowed, wrong[i].found);
        kdr_build_def def, before;
        memset(&def, 7, sizeof def);
        before = def;
        if (kdr_build_def_parse(wrong[i].text, &def, problem, sizeof problem) != KDR_ERROR_INVALID_ARGUMENT)
            fail_msg("\"%s\" is not refused", wrong[i].text);
        assert_string_equal(problem, expected);
        assert_memory_equal(&def, &before, sizeof def);
    }
}

/* The first word or number that a key's explanation allows. */
static const char *a_value_of(const char *key) {
    static const char *const values[][2] = {
        {"quality", "best"}, {"split", "space"},      {"axis", "robin"},  {"order", "bfs"},     {"share", "line/9"},
        {"events", "2"},     {"straddle", "general"}, {"retract", "yes"}, {"box-weight", "0"},  {"empty-bonus", "1"},
        {"trace", "stack"},  {"nodes", "structures"}, {"mailbox", "8"},   {"lazy-limit", "99"}, {"test", "projection"}};
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++)
        if (strcmp(key, values[i][0]) == 0)
            return values[i][1];
    return "5";
}

static void a_key_given_twice_is_refused(void **state) {
    (void)state;
    for (size_t i = 0; kdr_build_def_key_name(i); i++) {
        const char *key = kdr_build_def_key_name(i), *value = a_value_of(key);
        char text[100], expected[200], problem[200];
        snprintf(text, sizeof text, "%s=%s %s=%s", key, value, key, value);
        snprintf(expected, sizeof expected, "%s: expected it once, found \"%s=%s\" as well", key, key, value);
        kdr_build_def def;
        assert_int_equal(kdr_build_def_parse(text, &def, problem, sizeof problem), KDR_ERROR_INVALID_ARGUMENT);
        assert_string_equal(problem, expected);
    }
}

static void values_that_do_not_go_together_are_refused(void **state) {
    (void)state;
    static const char arrays[] = "nodes=arrays goes with trace=stack or trace=restart";
    static const char mailbox[] = "a mailbox goes with a traversal by name, not with trace=auto";
    static const char test[] = "another triangle test goes with a traversal by name, not with trace=auto";
    static const char *const wrong[][2] = {
        {"nodes=arrays", arrays},
        {"trace=push-down nodes=arrays", arrays},
        {"nodes=arrays trace=short-stack", arrays},
        {"trace=backtrack mailbox=8 nodes=arrays", arrays},
        {"mailbox=8", mailbox},
        {"trace=auto mailbox=64", mailbox},
        {"test=projection", test},
        {"trace=auto test=moller-trumbore", test},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        char problem[200] = "";
        kdr_build_def def, before;
        memset(&def, 7, sizeof def);
        before = def;
        assert_int_equal(kdr_build_def_parse(wrong[i][0], &def, problem, sizeof problem), KDR_ERROR_INVALID_ARGUMENT);
        assert_string_equal(problem, wrong[i][1]);
        assert_memory_equal(&def, &before, sizeof def);
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
int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pairs_that_cannot_be_are_refused_with_a_sentence),
        cmocka_unit_test(wrong_words_are_refused_with_a_sentence_that_names_them),
        cmocka_unit_test(a_key_given_twice_is_refused),
        cmocka_unit_test(values_that_do_not_go_together_are_refused),
        cmocka_unit_test(a_sentence_is_cut_to_the_room_there_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
