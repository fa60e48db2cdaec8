/* kdray bench as a user runs it: rows, files, filters, scenes and mistakes. Each run is a process of its own. */
#include <fcntl.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#define TEXT_SIZE 65536
#define PATH_SIZE 256
#define ARGUMENTS 24

/* ---- a folder for each test, and runs in it */

static char folder[PATH_SIZE];
static char printed[TEXT_SIZE], complained[TEXT_SIZE];

static int make_folder(void **state) {
    (void)state;
    /* The thread sanitizer sees neither Embree's threads nor what keeps them in order */
    setenv("TSAN_OPTIONS", "ignore_noninstrumented_modules=1:allocator_may_return_null=1", 1);
    strcpy(folder, "/tmp/kdray-bench-XXXXXX");
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state) {
    (void)state;
    char command[PATH_SIZE + 16];
    snprintf(command, sizeof command, "rm -r %s", folder);
    return system(command);
}

static const char *path_of(const char *name) {
    static char paths[4][2 * PATH_SIZE];
    static unsigned next;
    char *path = paths[next++ % 4];
    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

static bool exists(const char *name) { return access(path_of(name), F_OK) == 0; }

static void read_text(const char *name, char text[TEXT_SIZE]) {
    FILE *file = fopen(path_of(name), "r");
    assert_non_null(file);
    size_t size = fread(text, 1, TEXT_SIZE - 1, file);
    assert_true(feof(file));
    fclose(file);
    text[size] = 0;
}

static void write_text(const char *name, const char *text) {
    FILE *file = fopen(path_of(name), "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static void write_tetrahedron(const char *name) {
    write_text(name, "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                     "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
                     "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
}

static void redirect(int stream, const char *name) {
    int file = open(path_of(name), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (file < 0 || dup2(file, stream) < 0)
        _exit(99);
    close(file);
}

/* Runs `bench` with small pictures and the arguments, up to a NULL; returns the exit status. */
static int bench(const char *first, ...) {
    static const char *const before[] = {"kdray", "bench", "-r", "64x64", "--rounds", "1", "-t", "2"};
    char *arguments[ARGUMENTS] = {NULL};
    int count = 0;
    while (count < (int)(sizeof before / sizeof before[0])) {
        arguments[count] = (char *)before[count];
        count++;
    }
    va_list list;
    va_start(list, first);
    for (const char *argument = first; argument; argument = va_arg(list, const char *)) {
        assert_true(count < ARGUMENTS - 1);
        arguments[count++] = (char *)argument;
    }
    va_end(list);

    fflush(NULL);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        redirect(STDOUT_FILENO, "out");
        redirect(STDERR_FILENO, "err");
        execv(KDRAY_PROGRAM_PATH, arguments);
        _exit(99);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    read_text("out", printed);
    read_text("err", complained);
    if (!WIFEXITED(status))
        print_error("%s", complained);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

/* ---- what was written */

#define COLUMNS 16
#define ROW_LIMIT 32

typedef struct sheet {
    char text[TEXT_SIZE];
    char *names[COLUMNS];
    char *cells[ROW_LIMIT][COLUMNS];
    size_t rows;
} sheet;

static void split(char *line, char *cells[COLUMNS]) {
    for (size_t i = 0; i < COLUMNS; i++) {
        assert_non_null(line);
        cells[i] = strsep(&line, ",");
    }
    assert_null(line);
}

static void read_csv(const char *name, sheet *out) {
    read_text(name, out->text);
    out->rows = 0;
    bool named = false;
    char *rest = out->text, *line;
    while ((line = strsep(&rest, "\n")) && rest) {
        if (line[0] == '#')
            continue;
        assert_true(out->rows < ROW_LIMIT);
        split(line, named ? out->cells[out->rows++] : out->names);
        named = true;
    }
    assert_true(named);
}

static const char *cell(const sheet *csv, size_t row, const char *name) {
    for (size_t i = 0; i < COLUMNS; i++)
        if (strcmp(csv->names[i], name) == 0)
            return csv->cells[row][i];
    fail_msg("no column %s", name);
    return NULL;
}

static double number(const sheet *csv, size_t row, const char *name) {
    const char *text = cell(csv, row, name);
    char *end;
    double value = strtod(text, &end);
    assert_true(end > text && *end == 0);
    return value;
}

static sheet csv;

/* ---- tests */

static const char *const tracers[] = {"kdray/stream",         "kdray/packet",       "kdray/single",
                                      "embree/low/packet",    "embree/low/single",  "embree/medium/packet",
                                      "embree/medium/single", "embree/high/packet", "embree/high/single"};
#define TRACERS (sizeof tracers / sizeof tracers[0])

static void every_tracer_has_a_row_and_every_figure_is_there(void **state) {
    (void)state;
    assert_int_equal(bench("builtin:flake:1000", "--csv", path_of("a.csv"), NULL), 0);
    read_csv("a.csv", &csv);
    assert_int_equal(csv.rows, TRACERS);
    for (size_t row = 0; row < TRACERS; row++) {
        assert_string_equal(cell(&csv, row, "scene"), "builtin:flake:1000");
        assert_string_equal(cell(&csv, row, "tracer"), tracers[row]);
        assert_int_equal((int)number(&csv, row, "threads"), 2);
        for (size_t i = 2; i < COLUMNS; i++)
            assert_true(number(&csv, row, csv.names[i]) > 0);
        assert_non_null(strstr(printed, tracers[row]));
    }
    assert_non_null(strstr(printed, "times as fast as embree/medium/packet"));
}

static void image_time_is_build_and_primary_and_shadow_rays(void **state) {
    (void)state;
    assert_int_equal(bench("builtin:flake:1000", "--only", "kdray", "--csv", path_of("a.csv"), NULL), 0);
    read_csv("a.csv", &csv);
    for (size_t row = 0; row < csv.rows; row++) {
        double primary = 64 * 64 / number(&csv, row, "primary") * 1e-3;
        double shadow = number(&csv, row, "hits") / number(&csv, row, "shadow") * 1e-3;
        double image = number(&csv, row, "build_ms") + primary + shadow;
        assert_true(fabs(number(&csv, row, "image_ms") / image - 1) < 1e-4);
    }
}

static void tracers_agree_on_what_is_hit(void **state) {
    (void)state;
    static const char *const counts[] = {"hits", "occluded", "ao_occluded", "diffuse_hits"};
    assert_int_equal(bench("builtin:city:3000", "builtin:hair:3000", "--csv", path_of("a.csv"), NULL), 0);
    read_csv("a.csv", &csv);
    assert_int_equal(csv.rows, 2 * TRACERS);
    for (size_t row = 0; row < csv.rows; row++) {
        size_t first = row / TRACERS * TRACERS;
        for (size_t i = 0; i < 4; i++) {
            double off = fabs(number(&csv, row, counts[i]) - number(&csv, first, counts[i]));
            if (row < first + 3)
                assert_true(off == 0); /* kdray, in packets or ray after ray */
            assert_true(off <= 1 + 1e-4 * number(&csv, first, counts[i]));
        }
    }
}

/* Goes past the member `name` and returns its value, up to the comma, bracket or end of line. */
static const char *next_value(const char **json, const char *name) {
    static char value[256];
    char key[64];
    snprintf(key, sizeof key, "\"%s\": ", name);
    const char *at = strstr(*json, key);
    assert_non_null(at);
    at += strlen(key);
    size_t length = strcspn(at, ",}\n");
    assert_true(length < sizeof value);
    memcpy(value, at, length);
    value[length] = 0;
    *json = at + length;
    return value;
}

static void json_and_csv_say_the_same(void **state) {
    (void)state;
    static char json[TEXT_SIZE];
    assert_int_equal(bench("builtin:flake:500", "--json", path_of("a.json"), "--csv", path_of("a.csv"), NULL), 0);
    read_csv("a.csv", &csv);
    read_text("a.json", json);
    const char *at = json;
    for (size_t row = 0; row < csv.rows; row++) {
        for (size_t i = 0; i < COLUMNS; i++) {
            const char *value = next_value(&at, csv.names[i]);
            if (i < 2) {
                char quoted[128];
                snprintf(quoted, sizeof quoted, "\"%s\"", csv.cells[row][i]);
                assert_string_equal(value, quoted);
            } else {
                assert_true(fabs(atof(value) / number(&csv, row, csv.names[i]) - 1) < 1e-5);
            }
        }
    }
    assert_null(strchr(at, '{'));
}

static void a_file_named_minus_is_stdout_and_nothing_else_is_there(void **state) {
    (void)state;
    assert_int_equal(bench("builtin:flake:500", "--only", "kdray/single", "--json", "-", NULL), 0);
    assert_true(strncmp(printed, "[\n", 2) == 0 && strcmp(printed + strlen(printed) - 3, "\n]\n") == 0);
    assert_int_equal(bench("builtin:flake:500", "--only", "kdray/single", "--csv", "-", NULL), 0);
    assert_true(strncmp(printed, "# kdray bench: ", 15) == 0);
    assert_null(strstr(printed, "image     bytes"));
}

static void only_leaves_out_what_begins_otherwise(void **state) {
    (void)state;
    assert_int_equal(bench("builtin:flake:500", "--only", "kdray/single", "--only", "embree/medium", "--csv",
                           path_of("a.csv"), NULL),
                     0);
    read_csv("a.csv", &csv);
    assert_int_equal(csv.rows, 3);
    assert_string_equal(cell(&csv, 0, "tracer"), "kdray/single");
    assert_string_equal(cell(&csv, 1, "tracer"), "embree/medium/packet");
    assert_string_equal(cell(&csv, 2, "tracer"), "embree/medium/single");
    assert_int_equal(bench("builtin:flake:500", "--only", "embree/low/packet", "--csv", path_of("b.csv"), NULL), 0);
    read_csv("b.csv", &csv);
    assert_int_equal(csv.rows, 1);
    assert_string_equal(cell(&csv, 0, "tracer"), "embree/low/packet");
}

static void instruction_sets_and_threads_change_no_hit(void **state) {
    (void)state;
    const char *isas[3] = {"scalar"};
    size_t count = 1;
#if defined(__x86_64__)
    if (__builtin_cpu_supports("sse4.2"))
        isas[count++] = "sse42";
    if (__builtin_cpu_supports("avx2"))
        isas[count++] = "avx2";
#endif
    double hits = 0;
    for (size_t i = 0; i < count; i++) {
        const char *threads = i ? "3" : "1";
        assert_int_equal(bench("builtin:flake:500", "--isa", isas[i], "-t", threads, "--csv", path_of("a.csv"), NULL),
                         0);
        char line[64];
        snprintf(line, sizeof line, "# instruction set: %s\n", isas[i]);
        static char text[TEXT_SIZE];
        read_text("a.csv", text);
        assert_non_null(strstr(text, line));
        read_csv("a.csv", &csv);
        assert_int_equal(csv.rows, TRACERS);
        if (i == 0)
            hits = number(&csv, 0, "hits");
        assert_true(number(&csv, 0, "hits") == hits);
        assert_true(number(&csv, 0, "threads") == (i ? 3 : 1));
    }
}

static void without_embree_a_sentence_and_the_rows_of_kdray(void **state) {
    (void)state;
    setenv("KDRAY_EMBREE", "/nowhere/libembree3.so", 1);
    int status = bench("builtin:flake:500", "--csv", path_of("a.csv"), NULL);
    assert_int_equal(status, 0);
    assert_non_null(strstr(complained, "kdray is measured alone\n"));
    read_csv("a.csv", &csv);
    assert_int_equal(csv.rows, 3);
    assert_int_equal(bench("builtin:flake:500", "--only", "kdray", NULL), 0);
    assert_string_equal(complained, "");
    assert_int_equal(bench("builtin:flake:500", "--only", "embree", NULL), 1);
    assert_non_null(strstr(complained, "nothing is left to measure\n"));
    setenv("KDRAY_EMBREE", "libm.so.6", 1);
    assert_int_equal(bench("builtin:flake:500", NULL), 0);
    assert_non_null(strstr(complained, "no Embree 3"));
    unsetenv("KDRAY_EMBREE");
}

static void without_files_a_folder_is_measured_in_order(void **state) {
    (void)state;
    write_tetrahedron("b.ply");
    write_tetrahedron("a.x.ply");
    write_text("c.obj", "v 0 0 0\n");
    setenv("KDRAY_SCENES", folder, 1);
    assert_int_equal(bench("--only", "kdray/stream", "--csv", path_of("a.csv"), NULL), 0);
    read_csv("a.csv", &csv);
    assert_int_equal(csv.rows, 2);
    assert_string_equal(cell(&csv, 0, "scene"), "a.x");
    assert_string_equal(cell(&csv, 1, "scene"), "b");
    setenv("KDRAY_SCENES", path_of("empty"), 1);
    assert_int_equal(mkdir(path_of("empty"), 0700), 0);
    assert_int_equal(bench("--only", "kdray", NULL), 1);
    assert_non_null(strstr(complained, "no .ply file in "));
    unsetenv("KDRAY_SCENES");
}

static void a_camera_beside_the_mesh_is_used(void **state) {
    (void)state;
    write_tetrahedron("a.ply");
    assert_int_equal(bench(path_of("a.ply"), "--only", "kdray/single", "--csv", path_of("far.csv"), NULL), 0);
    write_text("a.cam", "0.2 0.2 0.9  0.2 0.2 0  0 1 0  45  3 3 3\n");
    assert_int_equal(bench(path_of("a.ply"), "--only", "kdray/single", "--csv", path_of("near.csv"), NULL), 0);
    read_csv("far.csv", &csv);
    double far_hits = number(&csv, 0, "hits");
    read_csv("near.csv", &csv);
    assert_true(number(&csv, 0, "hits") > far_hits);
    write_text("a.cam", "0.2 0.2 0.9 0.2\n");
    assert_int_equal(bench(path_of("a.ply"), "--only", "kdray/single", NULL), 1);
    assert_non_null(strstr(complained, "a.cam"));
}

static void a_scene_that_fails_does_not_stop_the_others(void **state) {
    (void)state;
    const char *missing = path_of("missing.ply");
    assert_int_equal(bench(missing, "builtin:flake:500", "--only", "kdray", "--csv", path_of("a.csv"), NULL), 1);
    assert_non_null(strstr(complained, "missing.ply"));
    read_csv("a.csv", &csv);
    assert_int_equal(csv.rows, 3);
    assert_int_equal(bench(missing, "--json", path_of("a.json"), NULL), 1);
    assert_false(exists("a.json"));
}

static void a_place_that_cannot_be_written_is_found_before_measuring(void **state) {
    (void)state;
    assert_int_equal(bench("builtin:flake:500", "--json", path_of("no/folder.json"), NULL), 1);
    assert_non_null(strstr(complained, "folder.json cannot be written: No such file or directory"));
    assert_string_equal(printed, "");
    assert_int_equal(bench("builtin:flake:500", "--csv", folder, NULL), 1);
    assert_non_null(strstr(complained, "Is a directory"));
    assert_string_equal(printed, "");
}

static void a_full_disk_is_a_failure_with_a_sentence(void **state) {
    (void)state;
    assert_int_equal(bench("builtin:flake:500", "--only", "kdray/single", "--csv", "/dev/full", NULL), 1);
    assert_non_null(strstr(complained, "/dev/full cannot be written: No space left on device"));
}

static void results_replace_older_ones_and_nothing_else_is_left(void **state) {
    (void)state;
    write_text("a.json", "old");
    assert_int_equal(bench("builtin:flake:500", "--only", "kdray", "--json", path_of("a.json"), NULL), 0);
    static char text[TEXT_SIZE];
    read_text("a.json", text);
    assert_int_equal(text[0], '[');
    char command[PATH_SIZE + 64];
    snprintf(command, sizeof command, "test \"$(ls %s | tr '\\n' ' ')\" = \"a.json err out \"", folder);
    assert_int_equal(system(command), 0);
}

static void quiet_prints_nothing(void **state) {
    (void)state;
    assert_int_equal(bench("builtin:flake:500", "--only", "kdray", "--quiet", NULL), 0);
    assert_string_equal(printed, "");
    assert_string_equal(complained, "");
}

static void build_constants_reach_the_builder(void **state) {
    (void)state;
    assert_int_equal(bench("builtin:flake:2000", "--only", "kdray/single", "--csv", path_of("a.csv"), NULL), 0);
    int status = bench("builtin:flake:2000", "--only", "kdray/single", "--csv", path_of("b.csv"), "--traversal-cost",
                       "2.5", "--intersection-cost", "1.5", "--leaf-limit", "2000", "--depth-limit", "1",
                       "--reference-limit", "1.25", NULL);
    assert_int_equal(status, 0);
    read_csv("a.csv", &csv);
    double usual = number(&csv, 0, "bytes_per_triangle"), hits = number(&csv, 0, "hits");
    static char text[TEXT_SIZE];
    read_text("b.csv", text);
    assert_non_null(strstr(
        text, "# plan: split=binned axis=best order=dfs share=none events=2 straddle=auto retract=no "
              "box-weight=0 empty-bonus=1 traversal-cost=2.5 intersection-cost=1.5 "
              "leaf-limit=2000 depth-limit=1 reference-limit=1.25 lazy-limit=0 trace=auto nodes=structures mailbox=0 "
              "test=watertight\n"));
    read_csv("b.csv", &csv);
    assert_true(number(&csv, 0, "bytes_per_triangle") != usual);
    assert_true(number(&csv, 0, "hits") == hits);
}

static void wrong_usage_is_a_sentence_and_status_2(void **state) {
    (void)state;
    static const char *const wrong[][2] = {
        {"-r", "64"},
        {"-r", "0x64"},
        {"-r", "64x-1"},
        {"-r", "64x64x64"},
        {"-r", "99999x1"},
        {"-t", "0"},
        {"-t", "two"},
        {"-t", "1000"},
        {"--rounds", "0"},
        {"--rounds", "1.5"},
        {"--only", "embre/low"},
        {"--only", "kdray/packets"},
        {"--isa", "mmx"},
        {"--leaf-limit", "0"},
        {"--depth-limit", "61"},
        {"--traversal-cost", "0"},
        {"--traversal-cost", "nan"},
        {"--intersection-cost", "-1"},
        {"--reference-limit", "0.5"},
        {"--reference-limit", "inf"},
        {"--leaf-limit", "99999999999"},
        {"--no-such-option", "1"},
        {"-r", ""},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        int status = bench("builtin:flake:500", wrong[i][0], wrong[i][1], NULL);
        if (status != 2)
            print_error("%s %s\n", wrong[i][0], wrong[i][1]);
        assert_int_equal(status, 2);
        assert_string_not_equal(complained, "");
        assert_string_equal(printed, "");
    }
}

#define test(name) cmocka_unit_test_setup_teardown(name, make_folder, remove_folder)

int main(void) {
    const struct CMUnitTest tests[] = {
        test(every_tracer_has_a_row_and_every_figure_is_there),
        test(image_time_is_build_and_primary_and_shadow_rays),
        test(tracers_agree_on_what_is_hit),
        test(json_and_csv_say_the_same),
        test(a_file_named_minus_is_stdout_and_nothing_else_is_there),
        test(only_leaves_out_what_begins_otherwise),
        test(instruction_sets_and_threads_change_no_hit),
        test(without_embree_a_sentence_and_the_rows_of_kdray),
        test(without_files_a_folder_is_measured_in_order),
        test(a_camera_beside_the_mesh_is_used),
        test(a_scene_that_fails_does_not_stop_the_others),
        test(a_place_that_cannot_be_written_is_found_before_measuring),
        test(a_full_disk_is_a_failure_with_a_sentence),
        test(results_replace_older_ones_and_nothing_else_is_left),
        test(quiet_prints_nothing),
        test(build_constants_reach_the_builder),
        test(wrong_usage_is_a_sentence_and_status_2),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
