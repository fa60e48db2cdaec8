#include "mesh/number.h"
#include "mesh/reading.h"
#include "support/random.h"
#include "support/test_size.h"

#include <float.h>
#include <locale.h>

static float parse(const char *text, size_t taken) {
    const char *p = text;
    double value;
    if (!kdr_number_read_double(&p, text + strlen(text), &value))
        fail_msg("'%s' was not read", text);
    if ((size_t)(p - text) != taken)
        fail_msg("'%s': expected %zu characters to be taken, got %td", text, taken, p - text);
    return (float)value;
}

/* The place of a float among all floats. */
static int64_t rank(float value) {
    int32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits < 0 ? (int64_t)INT32_MIN - bits : bits;
}

static void assert_near(const char *text) {
    float wanted = strtof(text, NULL), got = parse(text, strlen(text));
    if (llabs(rank(wanted) - rank(got)) > 1)
        fail_msg("'%s': expected %.9g, got %.9g", text, (double)wanted, (double)got);
}

static void random_numbers_are_within_one_unit_of_the_nearest_float(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 1);
    for (int i = 0; i < TEST_SIZE(300000); i++) {
        char text[400];
        uint32_t bits = test_random_u32(&random);
        float value;
        memcpy(&value, &bits, sizeof value);
        if (!isfinite(value))
            continue;
        snprintf(text, sizeof text, "%.*g", 1 + (int)test_random_below(&random, 30), (double)value);
        assert_near(text);
        snprintf(text, sizeof text, "%.*f", (int)test_random_below(&random, 60), (double)value);
        assert_near(text);
    }
}

static void long_and_extreme_strings_are_within_one_unit_of_the_nearest_float(void **state) {
    (void)state;
    static const char *const texts[] = {
        "0",
        "-0",
        "1",
        "+1",
        "1.",
        ".5",
        "-.5e1",
        "1e0",
        "1E+5",
        "1e-5",
        "3.4028235e38",
        "3.4028236e38",
        "1e39",
        "-1e39",
        "1e400",
        "1e-400",
        "1e99999999999999999999",
        "1e-99999999999999999999",
        "0e99999999999999999999",
        "1.17549435e-38",
        "1e-45",
        "1.4e-45",
        "7e-46",
        "16777217",
        "16777216.999999999999999999999999999999",
        "0.000000000000000000000000000000000000000000000000000000000001e60",
        "123456789012345678901234567890123456789e-38",
        "0.1000000000000000055511151231257827021181583404541015625",
        "100000000000000000000000000000000000000000000000000000000000000000000e-68",
        "8388608.4999999999999999999999999999",
        "8388609.50000000000000000000000000000001",
    };
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
        assert_near(texts[i]);
    char *many = malloc(100001);
    assert_non_null(many);
    memset(many, '3', 100000);
    many[1] = '.';
    many[100000] = '\0';
    assert_near(many);
    memset(many, '0', 99999);
    many[0] = '.';
    assert_near(many);
    free(many);
}

static void names_for_no_number_are_read_in_every_case_and_spelling(void **state) {
    (void)state;
    static const char *const nans[] = {"nan", "NaN", "-nan", "NAN(ind)", "-nan(ind)", "1.#QNAN", "-1.#IND", "1.#IND00"};
    for (size_t i = 0; i < sizeof nans / sizeof nans[0]; i++)
        assert_true(isnan(parse(nans[i], strlen(nans[i]))));
    assert_true(parse("inf", 3) == INFINITY);
    assert_true(parse("-Infinity", 9) == -INFINITY);
    assert_true(parse("1.#INF", 6) == INFINITY);
    assert_true(isnan(parse("nan(", 3)));
}

static void what_is_no_number_is_left_alone(void **state) {
    (void)state;
    static const char *const texts[] = {"", "-", "+", ".", "e5", "-e", "x", "--1", "in", "na", "1.#", "#"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0] - 2; i++) {
        const char *p = texts[i];
        double value;
        assert_false(kdr_number_read_double(&p, p + strlen(p), &value));
        assert_ptr_equal(p, texts[i]);
    }
    assert_true(parse("1e", 1) == 1);
    assert_true(parse("1e+", 1) == 1);
    assert_true(parse("2x", 1) == 2);
    assert_true(parse("0x10", 1) == 0);
}

static void nothing_is_read_past_the_end(void **state) {
    (void)state;
    static const char *const texts[] = {"-12.5e+10", "infinity", "nan(abc)", "1.#QNAN", "123456"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        for (size_t length = 0; length <= strlen(texts[i]); length++) {
            char *copy = malloc(length + 1), *p = copy;
            assert_non_null(copy);
            memcpy(copy, texts[i], length);
            copy[length] = '7'; // would change the number if it were read
            double value;
            if (kdr_number_read_double((const char **)&p, copy + length, &value))
                assert_true(p <= copy + length);
            free(copy);
        }
    }
}

static void whole_numbers_are_read_or_refused_when_they_do_not_fit(void **state) {
    (void)state;
    const char *text = "9223372036854775799", *p = text;
    int64_t value;
    assert_true(kdr_number_read_int(&p, text + strlen(text), &value) && value == 9223372036854775799);
    text = p = "-17/";
    assert_true(kdr_number_read_int(&p, text + strlen(text), &value) && value == -17 && *p == '/');
    text = p = "99999999999999999999";
    assert_false(kdr_number_read_int(&p, text + strlen(text), &value));
    text = p = "-";
    assert_false(kdr_number_read_int(&p, text + strlen(text), &value));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_numbers_are_within_one_unit_of_the_nearest_float),
        cmocka_unit_test(long_and_extreme_strings_are_within_one_unit_of_the_nearest_float),
        cmocka_unit_test(names_for_no_number_are_read_in_every_case_and_spelling),
        cmocka_unit_test(what_is_no_number_is_left_alone),
        cmocka_unit_test(nothing_is_read_past_the_end),
        cmocka_unit_test(whole_numbers_are_read_or_refused_when_they_do_not_fit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
