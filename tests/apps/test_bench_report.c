/* Medians, tables, CSV and JSON say what was measured, whatever the names of scenes hold. */
#include "apps/kdray/bench.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const kdr_bench_row rows[] = {
    {.scene = "plain",
     .tracer = "kdray/stream",
     .threads = 2,
     .triangles = 69451,
     .build_ms = 5,
     .build_cold_ms = 7.25,
     .speed = {100, 50, 25, 12.5},
     .image_ms = 30,
     .bytes_per_triangle = 91.5,
     .hits = {1000, 400, 2000, 2000}},
    {.scene = "plain",
     .tracer = "embree/medium/packet",
     .threads = 2,
     .triangles = 69451,
     .build_ms = 10,
     .build_cold_ms = 14.5,
     .speed = {50, 100, 50, 12.5},
     .image_ms = 45,
     .bytes_per_triangle = 66.875,
     .hits = {1000, 399, 2000, 2003}},
    {.scene = "with \"quotes\", a comma and a \\",
     .tracer = "kdray/stream",
     .threads = 1,
     .triangles = 3,
     .build_ms = 0.5,
     .build_cold_ms = 1,
     .speed = {20, 0, 0, 0},
     .image_ms = 2,
     .bytes_per_triangle = 800,
     .hits = {0, 0, 0, 0}},
};
#define ROWS (sizeof rows / sizeof rows[0])

static char text[16384];

static void write_text(void (*write)(FILE *out)) {
    FILE *out = fmemopen(text, sizeof text, "w");
    assert_non_null(out);
    write(out);
    assert_true(ftell(out) < (long)sizeof text - 1);
    fclose(out);
}

static kdr_bench_run_info make_info(void) {
    kdr_build_def build = kdr_default_build_def();
    build.split = KDR_SPLIT_OBJECT;
    build.leaf_limit = 9;
    return (kdr_bench_run_info){
        .width = 640, .height = 480, .rounds = 3, .threads = 2, .isa = KDR_ISA_AVX2, .build = build};
}

static void write_csv(FILE *out) {
    kdr_bench_run_info info = make_info();
    kdr_bench_write_csv(out, &info, rows, ROWS);
}

static void write_json(FILE *out) {
    kdr_bench_run_info info = make_info();
    kdr_bench_write_json(out, &info, rows, ROWS);
}

/* The JSON without its ends of lines and indentation. */
static void write_plain_json(void) {
    write_text(write_json);
    char *to = text;
    for (const char *from = text; *from; from++) {
        *to = *from;
        if (*from == '\n')
            from += strspn(from + 1, " ");
        else
            to++;
    }
    *to = 0;
}

static void print_plain(FILE *out) { kdr_bench_print(out, rows, 2); }

static void print_last(FILE *out) { kdr_bench_print(out, rows + 2, 1); }

static void the_median_is_the_middle_or_the_mean_of_the_middle_two(void **state) {
    (void)state;
    assert_true(kdr_bench_median((double[]){7}, 1) == 7);
    assert_true(kdr_bench_median((double[]){9, 1}, 2) == 5);
    assert_true(kdr_bench_median((double[]){9, 1, 2}, 3) == 2);
    assert_true(kdr_bench_median((double[]){100, 3, 1, 2}, 4) == 2.5);
    assert_true(kdr_bench_median((double[]){5, 5, 5, 1, 9}, 5) == 5);
}

static void csv_opens_with_comments_and_has_a_line_of_names_and_a_line_a_row(void **state) {
    (void)state;
    write_text(write_csv);
    assert_non_null(strstr(text, "# kdray bench: 640x480 pixels, 2 threads, medians of 3 rounds\n"));
    assert_non_null(strstr(text, "# instruction set: avx2\n"));
    assert_non_null(strstr(text, "# Embree: none\n"));
    assert_non_null(strstr(text, "\nscene,tracer,threads,triangles,build_ms,build_cold_ms,primary,shadow,ao,diffuse,"
                                 "image_ms,bytes_per_triangle,hits,occluded,ao_occluded,diffuse_hits\n"));
    assert_non_null(strstr(text, "\nplain,kdray/stream,2,69451,5,7.25,100,50,25,12.5,30,91.5,1000,400,2000,2000\n"));
    assert_non_null(strstr(text, "\nplain,embree/medium/packet,2,69451,10,14.5,50,100,50,12.5,45,66.875,"
                                 "1000,399,2000,2003\n"));
}

static void a_kind_without_rays_has_no_speed_in_csv_and_null_in_json(void **state) {
    (void)state;
    write_text(write_csv);
    assert_non_null(strstr(text, "kdray/stream,1,3,0.5,1,20,,,,2,800,0,0,0,0\n"));
    write_plain_json();
    assert_non_null(strstr(text, "\"primary\": 20,\"shadow\": null,\"ao\": null,\"diffuse\": null,\"image_ms\": 2,"));
}

static void names_with_quotes_and_commas_stay_one_field(void **state) {
    (void)state;
    write_text(write_csv);
    assert_non_null(strstr(text, "\n\"with \"\"quotes\"\", a comma and a \\\",kdray/stream,1,"));
    write_plain_json();
    assert_non_null(
        strstr(text, "{\"scene\": \"with \\\"quotes\\\", a comma and a \\\\\",\"tracer\": \"kdray/stream\","));
}

static void json_is_one_list_with_an_object_a_row(void **state) {
    (void)state;
    write_plain_json();
    assert_true(text[0] == '[' && text[strlen(text) - 1] == ']');
    size_t objects = 0;
    for (const char *at = text; (at = strstr(at, "{\"scene\": ")); at++)
        objects++;
    assert_int_equal(objects, ROWS);
    assert_non_null(strstr(text,
                           "\"tracer\": \"embree/medium/packet\",\"plan\": null,\"threads\": 2,\"triangles\": 69451,"
                           "\"build_ms\": 10,\"build_cold_ms\": 14.5,\"primary\": 50,\"shadow\": 100,"
                           "\"ao\": 50,\"diffuse\": 12.5,\"image_ms\": 45,\"bytes_per_triangle\": 66.875,"
                           "\"hits\": 1000,\"occluded\": 399,\"ao_occluded\": 2000,\"diffuse_hits\": 2003}"));
}

static void the_plan_is_in_the_csv_and_in_every_row_of_kdray_in_json(void **state) {
    (void)state;
    kdr_bench_run_info info = make_info();
    char plan[KDR_PLAN_TEXT_SIZE], expected[KDR_PLAN_TEXT_SIZE + 64];
    assert_int_equal(kdr_build_def_print(&info.build, plan, sizeof plan), KDR_OK);
    assert_non_null(strstr(plan, "split=object "));
    write_text(write_csv);
    snprintf(expected, sizeof expected, "\n# plan: %s\n", plan);
    assert_non_null(strstr(text, expected));

    write_plain_json();
    snprintf(expected, sizeof expected, "\"tracer\": \"kdray/stream\",\"plan\": \"%s\",", plan);
    const char *first = strstr(text, expected);
    assert_non_null(first);
    assert_non_null(strstr(first + 1, expected));
    size_t plans = 0;
    for (const char *at = text; (at = strstr(at, "\"plan\": ")); at++)
        plans++;
    assert_int_equal(plans, ROWS);
}

static void no_rows_are_an_empty_list(void **state) {
    (void)state;
    FILE *out = fmemopen(text, sizeof text, "w");
    assert_non_null(out);
    kdr_bench_run_info info = make_info();
    kdr_bench_write_json(out, &info, rows, 0);
    fclose(out);
    assert_string_equal(text, "[]\n");
}

/* The line of `text` that begins with `beginning`, from `from` on. */
static const char *line_of(const char *from, const char *beginning) {
    const char *line = strstr(from, beginning);
    while (line && line > text && line[-1] != '\n')
        line = strstr(line + 1, beginning);
    assert_non_null(line);
    return line;
}

static void the_table_compares_with_embree_medium_packets(void **state) {
    (void)state;
    write_text(print_plain);
    const char *ratios = strstr(text, "times as fast as embree/medium/packet");
    assert_non_null(ratios);
    double build, cold, primary, shadow, ao, diffuse, image;
    assert_int_equal(sscanf(line_of(ratios, "kdray/stream"), "kdray/stream %lfx %lfx %lfx %lfx %lfx %lfx %lfx", &build,
                            &cold, &primary, &shadow, &ao, &diffuse, &image),
                     7);
    assert_true(build == 2 && cold == 2 && primary == 2 && shadow == 0.5 && ao == 0.5 && diffuse == 1 && image == 1.5);
}

static void counts_that_differ_from_the_first_row_are_printed(void **state) {
    (void)state;
    write_text(print_plain);
    assert_non_null(strstr(text, "embree/medium/packet: -1 of 400 shadow rays that hit, against kdray/stream\n"));
    assert_non_null(strstr(text, "embree/medium/packet: +3 of 2000 diffuse rays that hit, against kdray/stream\n"));
    assert_null(strstr(text, "primary rays that hit"));
}

static void one_row_alone_is_not_compared(void **state) {
    (void)state;
    write_text(print_last);
    assert_null(strstr(text, "times as fast"));
    const char *row = line_of(text, "kdray/stream");
    double build, cold, primary, image;
    assert_int_equal(sscanf(row, "kdray/stream %lf %lf %lf - - - %lf", &build, &cold, &primary, &image), 4);
    assert_true(build == 0.5 && primary == 20 && image == 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_median_is_the_middle_or_the_mean_of_the_middle_two),
        cmocka_unit_test(csv_opens_with_comments_and_has_a_line_of_names_and_a_line_a_row),
        cmocka_unit_test(a_kind_without_rays_has_no_speed_in_csv_and_null_in_json),
        cmocka_unit_test(names_with_quotes_and_commas_stay_one_field),
        cmocka_unit_test(json_is_one_list_with_an_object_a_row),
        cmocka_unit_test(the_plan_is_in_the_csv_and_in_every_row_of_kdray_in_json),
        cmocka_unit_test(no_rows_are_an_empty_list),
        cmocka_unit_test(the_table_compares_with_embree_medium_packets),
        cmocka_unit_test(counts_that_differ_from_the_first_row_are_printed),
        cmocka_unit_test(one_row_alone_is_not_compared),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
