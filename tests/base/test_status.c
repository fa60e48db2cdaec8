#include "kdray/kdray.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const kdr_status all_statuses[] = {
#define STATUS_OF(name, text) name,
    KDR_STATUS_LIST(STATUS_OF)
#undef STATUS_OF
};

#define STATUS_COUNT (sizeof(all_statuses) / sizeof(*all_statuses))

static void ok_is_zero_and_statuses_count_up(void **state) {
    (void)state;
    assert_int_equal(KDR_OK, 0);
    for (size_t i = 0; i < STATUS_COUNT; i++)
        assert_int_equal(all_statuses[i], i);
}

static void every_status_has_the_phrase_of_its_list(void **state) {
    (void)state;
#define ASSERT_TEXT(name, text) assert_string_equal(kdr_status_text(name), text);
    KDR_STATUS_LIST(ASSERT_TEXT)
#undef ASSERT_TEXT
}

static void no_two_statuses_share_a_phrase(void **state) {
    (void)state;
    for (size_t i = 0; i < STATUS_COUNT; i++)
        for (size_t j = 0; j < i; j++)
            assert_string_not_equal(kdr_status_text(all_statuses[i]), kdr_status_text(all_statuses[j]));
}

static void any_number_is_accepted_as_a_status(void **state) {
    (void)state;
    assert_string_equal(kdr_status_text((kdr_status)STATUS_COUNT), "unknown status");
    assert_string_equal(kdr_status_text((kdr_status)1000000), "unknown status");
}

static void version_is_that_of_the_header(void **state) {
    (void)state;
    char expected[64];
    snprintf(expected, sizeof(expected), "%d.%d.%d", KDR_VERSION_MAJOR, KDR_VERSION_MINOR, KDR_VERSION_PATCH);
    assert_string_equal(kdr_version(), expected);
}

static void every_instruction_set_has_its_name(void **state) {
    (void)state;
    assert_string_equal(kdr_isa_name(KDR_ISA_SCALAR), "scalar");
    assert_string_equal(kdr_isa_name(KDR_ISA_SSE42), "sse42");
    assert_string_equal(kdr_isa_name(KDR_ISA_AVX2), "avx2");
    assert_string_equal(kdr_isa_name(KDR_ISA_AVX512), "avx512");
    assert_string_equal(kdr_isa_name(KDR_ISA_NEON), "neon");
    assert_string_equal(kdr_isa_name((kdr_isa)77), "unknown");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ok_is_zero_and_statuses_count_up), cmocka_unit_test(every_status_has_the_phrase_of_its_list),
        cmocka_unit_test(no_two_statuses_share_a_phrase),   cmocka_unit_test(any_number_is_accepted_as_a_status),
        cmocka_unit_test(version_is_that_of_the_header),    cmocka_unit_test(every_instruction_set_has_its_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
