/* Medians, and rows as tables for people, as CSV and as JSON. */
#include "bench.h"
#include "json.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define REFERENCE "embree/medium/packet"

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double kdr_bench_median(double *values, uint32_t count) {
    qsort(values, count, sizeof *values, compare);
    uint32_t half = count / 2;
    return count % 2 ? values[half] : (values[half - 1] + values[half]) / 2;
}

/* ---- for people */

/* A number in a column, or a dash where there is none. */
static void print_cell(FILE *out, int width, int digits, const char *unit, double value) {
    if (value > 0 && isfinite(value))
        fprintf(out, "  %*.*f%s", width - (int)strlen(unit), digits, value, unit);
    else
        fprintf(out, "  %*s", width, "-");
}

static void print_figures(FILE *out, const kdr_bench_row *rows, uint32_t row_count) {
    fprintf(out, "%-20s  %8s  %8s  %8s  %8s  %8s  %8s  %8s  %8s\n", "", "build", "cold", "primary", "shadow", "ao",
            "diffuse", "image", "bytes");
    fprintf(out, "%-20s  %8s  %8s  %8s  %8s  %8s  %8s  %8s  %8s\n", "tracer", "ms", "ms", "Mray/s", "Mray/s", "Mray/s",
            "Mray/s", "ms", "/triangle");
    for (uint32_t i = 0; i < row_count; i++) {
        fprintf(out, "%-20s", rows[i].tracer);
        print_cell(out, 8, 2, "", rows[i].build_ms);
        print_cell(out, 8, 2, "", rows[i].build_cold_ms);
        for (int kind = 0; kind < KDR_BENCH_KINDS; kind++)
            print_cell(out, 8, 2, "", rows[i].speed[kind]);
        print_cell(out, 8, 2, "", rows[i].image_ms);
        print_cell(out, 9, 1, "", rows[i].bytes_per_triangle);
        fputc('\n', out);
    }
}

static const kdr_bench_row *reference_of(const kdr_bench_row *rows, uint32_t row_count) {
    for (uint32_t i = 0; i < row_count; i++)
        if (strcmp(rows[i].tracer, REFERENCE) == 0)
            return &rows[i];
    return rows;
}

static void print_ratios(FILE *out, const kdr_bench_row *rows, uint32_t row_count) {
    const kdr_bench_row *reference = reference_of(rows, row_count);
    fprintf(out, "\ntimes as fast as %s\n", reference->tracer);
    for (uint32_t i = 0; i < row_count; i++) {
        fprintf(out, "%-20s", rows[i].tracer);
        print_cell(out, 8, 2, "x", reference->build_ms / rows[i].build_ms);
        print_cell(out, 8, 2, "x", reference->build_cold_ms / rows[i].build_cold_ms);
        for (int kind = 0; kind < KDR_BENCH_KINDS; kind++)
            print_cell(out, 8, 2, "x", rows[i].speed[kind] / reference->speed[kind]);
        print_cell(out, 8, 2, "x", reference->image_ms / rows[i].image_ms);
        fputc('\n', out);
    }
}

static void print_differences(FILE *out, const kdr_bench_row *rows, uint32_t row_count) {
    bool first = true;
    for (uint32_t i = 1; i < row_count; i++) {
        for (int kind = 0; kind < KDR_BENCH_KINDS; kind++) {
            if (rows[i].hits[kind] == rows[0].hits[kind])
                continue;
            fprintf(out, "%s%s: %+" PRId64 " of %" PRIu64 " %s rays that hit, against %s\n", first ? "\n" : "",
                    rows[i].tracer, (int64_t)(rows[i].hits[kind] - rows[0].hits[kind]), rows[0].hits[kind],
                    kdr_bench_kind_name((kdr_bench_kind)kind), rows[0].tracer);
            first = false;
        }
    }
}

void kdr_bench_print(FILE *out, const kdr_bench_row *rows, uint32_t row_count) {
    print_figures(out, rows, row_count);
    if (row_count > 1)
        print_ratios(out, rows, row_count);
    print_differences(out, rows, row_count);
    fputc('\n', out);
}

/* ---- for programs */

/* In quotes where commas, quotes or ends of lines ask for it. */
static void write_csv_text(FILE *out, const char *text) {
    if (!strpbrk(text, ",\"\r\n#")) {
        fputs(text, out);
        return;
    }
    fputc('"', out);
    for (; *text; text++) {
        if (*text == '"')
            fputc('"', out);
        fputc(*text, out);
    }
    fputc('"', out);
}

typedef struct figure {
    const char *name;
    double value; /* not a number: there is none */
    bool whole;
} figure;

#define FIGURES 14

static double speed_of(const kdr_bench_row *row, kdr_bench_kind kind) {
    return row->speed[kind] > 0 ? row->speed[kind] : NAN;
}

/* The figures of a row in the order of the columns. */
static void list_figures(const kdr_bench_row *row, figure figures[FIGURES]) {
    figure list[FIGURES] = {
        {"threads", row->threads, true},
        {"triangles", (double)row->triangles, true},
        {"build_ms", row->build_ms, false},
        {"build_cold_ms", row->build_cold_ms, false},
        {"primary", speed_of(row, KDR_BENCH_PRIMARY), false},
        {"shadow", speed_of(row, KDR_BENCH_SHADOW), false},
        {"ao", speed_of(row, KDR_BENCH_AO), false},
        {"diffuse", speed_of(row, KDR_BENCH_DIFFUSE), false},
        {"image_ms", row->image_ms, false},
        {"bytes_per_triangle", row->bytes_per_triangle, false},
        {"hits", (double)row->hits[KDR_BENCH_PRIMARY], true},
        {"occluded", (double)row->hits[KDR_BENCH_SHADOW], true},
        {"ao_occluded", (double)row->hits[KDR_BENCH_AO], true},
        {"diffuse_hits", (double)row->hits[KDR_BENCH_DIFFUSE], true},
    };
    memcpy(figures, list, sizeof list);
}

/* The processor's name as the system gives it. */
static void write_machine(FILE *out) {
    char line[256] = "";
    FILE *file = fopen("/proc/cpuinfo", "r");
    while (file && fgets(line, sizeof line, file))
        if (strncmp(line, "model name", 10) == 0)
            break;
        else
            line[0] = 0;
    if (file)
        fclose(file);
    const char *name = strchr(line, ':');
    line[strcspn(line, "\n")] = 0;
    fprintf(out, "# machine: %s, %ld processors\n", name ? name + 2 : "unknown", sysconf(_SC_NPROCESSORS_ONLN));
}

void kdr_bench_write_csv(FILE *out, const kdr_bench_run_info *info, const kdr_bench_row *rows, size_t row_count) {
    char date[32] = "";
    time_t now = time(NULL);
    struct tm parts;
    if (gmtime_r(&now, &parts))
        strftime(date, sizeof date, "%Y-%m-%d", &parts);
    fprintf(out, "# kdray bench: %" PRIu32 "x%" PRIu32 " pixels, %" PRIu32 " threads, medians of %" PRIu32 " rounds\n",
            info->width, info->height, info->threads, info->rounds);
    if (info->frames > 0)
        fprintf(out, "# frames: %" PRIu32 "; times are of a frame in the mean, counts of all\n", info->frames);
    write_machine(out);
    fprintf(out, "# instruction set: %s\n# kdray: %s\n# Embree: %s\n", kdr_isa_name(info->isa), kdr_version(),
            info->embree ? info->embree : "none");
    char plan[KDR_PLAN_TEXT_SIZE] = "";
    kdr_build_def_print(&info->build, plan, sizeof plan);
    fprintf(out, "# plan: %s\n", plan);
    fprintf(out, "# date: %s\n# primary, shadow, ao, diffuse: million rays a second\n", date);

    figure figures[FIGURES];
    list_figures(&(kdr_bench_row){0}, figures);
    fputs("scene,tracer", out);
    for (int i = 0; i < FIGURES; i++)
        fprintf(out, ",%s", figures[i].name);
    fputc('\n', out);

    for (size_t i = 0; i < row_count; i++) {
        list_figures(&rows[i], figures);
        write_csv_text(out, rows[i].scene);
        fprintf(out, ",%s", rows[i].tracer);
        for (int k = 0; k < FIGURES; k++) {
            fputc(',', out);
            if (!isnan(figures[k].value))
                fprintf(out, "%.*g", figures[k].whole ? 15 : 6, figures[k].value);
        }
        fputc('\n', out);
    }
}

void kdr_bench_write_json(FILE *out, const kdr_bench_run_info *info, const kdr_bench_row *rows, size_t row_count) {
    char plan[KDR_PLAN_TEXT_SIZE] = "";
    kdr_build_def_print(&info->build, plan, sizeof plan);
    kdr_json json = kdr_json_begin_list(out);
    for (size_t i = 0; i < row_count; i++) {
        figure figures[FIGURES];
        list_figures(&rows[i], figures);
        kdr_json_object(&json, NULL);
        kdr_json_text(&json, "scene", rows[i].scene);
        kdr_json_text(&json, "tracer", rows[i].tracer);
        kdr_json_text(&json, "plan", strncmp(rows[i].tracer, "kdray/", 6) == 0 ? plan : NULL);
        for (int k = 0; k < FIGURES; k++) {
            if (figures[k].whole)
                kdr_json_whole(&json, figures[k].name, (uint64_t)figures[k].value);
            else
                kdr_json_real(&json, figures[k].name, figures[k].value);
        }
        kdr_json_close(&json, '}');
    }
    kdr_json_end_list(&json);
}
