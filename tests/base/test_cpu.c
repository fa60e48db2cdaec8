#include "base/cpu.h"
#include "base/task.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const kdr_isa all_isas[] = {KDR_ISA_SCALAR, KDR_ISA_SSE42, KDR_ISA_AVX2, KDR_ISA_AVX512, KDR_ISA_NEON};
#define ISA_COUNT (sizeof(all_isas) / sizeof(*all_isas))

static int forget_choice(void **state) {
    (void)state;
    return unsetenv("KDR_ISA");
}

static void a_machine_has_its_widest_set_and_all_narrower_ones(void **state) {
    (void)state;
    kdr_isa widest = kdr_cpu_isa();
    assert_true(kdr_cpu_has_isa(KDR_ISA_SCALAR));
    assert_true(kdr_cpu_has_isa(widest));
    if (widest == KDR_ISA_NEON) {
        assert_false(kdr_cpu_has_isa(KDR_ISA_SSE42));
        assert_false(kdr_cpu_has_isa(KDR_ISA_AVX512));
    } else {
        for (kdr_isa isa = KDR_ISA_SCALAR; isa <= KDR_ISA_NEON; isa++)
            assert_int_equal(kdr_cpu_has_isa(isa), isa <= widest);
    }
    assert_false(kdr_cpu_has_isa((kdr_isa)77));
}

static void without_limits_the_widest_is_chosen(void **state) {
    (void)state;
    kdr_isa isa;
    assert_true(kdr_cpu_choose_isa(KDR_ISA_NEON, &isa));
    assert_int_equal(isa, kdr_cpu_isa());
    setenv("KDR_ISA", "", 1);
    assert_true(kdr_cpu_choose_isa(KDR_ISA_NEON, &isa));
    assert_int_equal(isa, kdr_cpu_isa());
}

static void a_limit_lowers_the_choice(void **state) {
    (void)state;
    for (size_t i = 0; i < ISA_COUNT; i++) {
        kdr_isa isa;
        assert_true(kdr_cpu_choose_isa(all_isas[i], &isa));
        assert_int_equal(isa, kdr_cpu_has_isa(all_isas[i]) ? all_isas[i] : kdr_cpu_isa());
    }
}

static void the_environment_lowers_the_choice_or_fails_when_the_machine_lacks_it(void **state) {
    (void)state;
    for (size_t i = 0; i < ISA_COUNT; i++) {
        setenv("KDR_ISA", kdr_isa_name(all_isas[i]), 1);
        kdr_isa isa = (kdr_isa)42;
        bool chosen = kdr_cpu_choose_isa(KDR_ISA_NEON, &isa);
        assert_int_equal(chosen, kdr_cpu_has_isa(all_isas[i]));
        assert_int_equal(isa, chosen ? all_isas[i] : (kdr_isa)42);
    }
}

static void of_limit_and_environment_the_lower_one_holds(void **state) {
    (void)state;
    kdr_isa isa;
    setenv("KDR_ISA", "scalar", 1);
    assert_true(kdr_cpu_choose_isa(kdr_cpu_isa(), &isa));
    assert_int_equal(isa, KDR_ISA_SCALAR);
    setenv("KDR_ISA", kdr_isa_name(kdr_cpu_isa()), 1);
    assert_true(kdr_cpu_choose_isa(KDR_ISA_SCALAR, &isa));
    assert_int_equal(isa, KDR_ISA_SCALAR);
}

static void a_name_that_is_none_is_refused(void **state) {
    (void)state;
    static const char *const names[] = {"sse", "AVX2", "avx2 ", "unknown", "7"};
    for (size_t i = 0; i < sizeof(names) / sizeof(*names); i++) {
        kdr_isa isa = KDR_ISA_AVX2;
        setenv("KDR_ISA", names[i], 1);
        assert_false(kdr_cpu_choose_isa(KDR_ISA_NEON, &isa));
        assert_int_equal(isa, KDR_ISA_AVX2);
    }
}

static void seconds_never_go_back(void **state) {
    (void)state;
    double start = kdr_cpu_seconds(), before = start;
    while (before < start + 0.001) {
        double now = kdr_cpu_seconds();
        assert_true(now >= before);
        before = now;
    }
}

static void processors_are_those_this_thread_may_run_on(void **state) {
    (void)state;
    cpu_set_t before, one;
    assert_int_equal(sched_getaffinity(0, sizeof(before), &before), 0);
    assert_int_equal(kdr_cpu_count(), CPU_COUNT(&before) < KDR_MAX_WORKERS ? CPU_COUNT(&before) : KDR_MAX_WORKERS);

    CPU_ZERO(&one);
    for (int cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&one) == 0; cpu++)
        if (CPU_ISSET(cpu, &before))
            CPU_SET(cpu, &one);
    assert_int_equal(sched_setaffinity(0, sizeof(one), &one), 0);
    assert_int_equal(kdr_cpu_count(), 1);
    assert_int_equal(sched_setaffinity(0, sizeof(before), &before), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(a_machine_has_its_widest_set_and_all_narrower_ones, forget_choice),
        cmocka_unit_test_setup(without_limits_the_widest_is_chosen, forget_choice),
        cmocka_unit_test_setup(a_limit_lowers_the_choice, forget_choice),
        cmocka_unit_test_setup(the_environment_lowers_the_choice_or_fails_when_the_machine_lacks_it, forget_choice),
        cmocka_unit_test_setup(of_limit_and_environment_the_lower_one_holds, forget_choice),
        cmocka_unit_test_setup(a_name_that_is_none_is_refused, forget_choice),
        cmocka_unit_test(seconds_never_go_back),
        cmocka_unit_test(processors_are_those_this_thread_may_run_on),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
