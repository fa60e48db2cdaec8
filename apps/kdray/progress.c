#include "progress.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

#define SECONDS_BETWEEN_DRAWS 0.1
#define BAR_LIMIT 40  /* columns */
#define LINE_SIZE 256 /* bytes of a line without escape sequences */
#define COLUMN_LIMIT (LINE_SIZE - 1)

double kdr_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + (double)now.tv_nsec * 1e-9;
}

int kdr_terminal_columns(int file) {
    struct winsize size;
    if (ioctl(file, TIOCGWINSZ, &size) == 0 && size.ws_col > 0)
        return size.ws_col;
    const char *text = getenv("COLUMNS");
    if (text) {
        char *end;
        long columns = strtol(text, &end, 10);
        if (end != text && *end == 0 && columns > 0 && columns <= 10000)
            return (int)columns;
    }
    return 80;
}

kdr_progress kdr_progress_make(bool quiet) {
    kdr_progress progress = {.shown = !quiet && isatty(STDERR_FILENO)};
    const char *terminal = getenv("TERM");
    const char *no_colour = getenv("NO_COLOR");
    progress.escapes = terminal && *terminal && strcmp(terminal, "dumb") != 0;
    progress.colour = progress.escapes && !(no_colour && *no_colour);
    return progress;
}

/* "7 s", "3:05", "2:10:00". */
static void format_time(double seconds, char *text, size_t size) {
    unsigned long whole = seconds < 1e9 ? (unsigned long)(seconds + 0.5) : 1000000000ul;
    if (whole < 60)
        snprintf(text, size, "%lu s", whole);
    else if (whole < 3600)
        snprintf(text, size, "%lu:%02lu", whole / 60, whole % 60);
    else
        snprintf(text, size, "%lu:%02lu:%02lu", whole / 3600, whole / 60 % 60, whole % 60);
}

/* Draws over the line that is there. `bar` columns of the line, after the first `before`, are coloured. */
static void draw(kdr_progress *progress, const char *line, int before, int bar) {
    int columns = (int)strlen(line);
    int room = kdr_terminal_columns(STDERR_FILENO) - 1;
    columns = columns < room ? columns : room;
    before = before < columns ? before : columns;
    bar = before + bar < columns ? bar : columns - before;

    fputc('\r', stderr);
    if (progress->colour)
        fprintf(stderr, "%.*s\033[32m%.*s\033[0m%.*s", before, line, bar, line + before, columns - before - bar,
                line + before + bar);
    else
        fprintf(stderr, "%.*s", columns, line);
    if (progress->escapes)
        fputs("\033[K", stderr);
    else if (progress->columns > columns)
        fprintf(stderr, "%*s", progress->columns - columns, "");
    fflush(stderr);
    progress->columns = columns > progress->columns || progress->escapes ? columns : progress->columns;
}

void kdr_progress_step(kdr_progress *progress, const char *what) {
    if (!progress || !progress->shown)
        return;
    char line[LINE_SIZE];
    snprintf(line, sizeof(line), "%s ...", what);
    draw(progress, line, 0, 0);
}

void kdr_progress_update(kdr_progress *progress, const char *what, uint64_t finished, uint64_t total) {
    if (!progress || !progress->shown || total == 0)
        return;

    // The first word of a step starts its clock: what came before it took its own time.
    double now = kdr_seconds();
    if (progress->what != what) {
        progress->what = what;
        progress->begin = now;
        progress->done_at_begin = finished;
        progress->drawn = 0;
    }
    if (finished < total && progress->drawn > 0 && now - progress->drawn < SECONDS_BETWEEN_DRAWS)
        return;
    progress->drawn = now;

    char elapsed[32], left[32] = "?";
    double seconds = now - progress->begin;
    format_time(seconds, elapsed, sizeof(elapsed));
    if (finished > progress->done_at_begin)
        format_time(seconds * (double)(total - finished) / (double)(finished - progress->done_at_begin), left,
                    sizeof(left));
    double share = (double)finished / (double)total;

    char tail[96];
    int tail_length = snprintf(tail, sizeof(tail), "] %3d%%  %s, ETA %s", (int)(100 * share), elapsed, left);
    char line[LINE_SIZE];
    int before = snprintf(line, sizeof(line), "%.40s [", what);
    int columns = kdr_terminal_columns(STDERR_FILENO) - 1;
    int room = (columns < COLUMN_LIMIT ? columns : COLUMN_LIMIT) - before - tail_length;
    int bar = room < BAR_LIMIT ? room : BAR_LIMIT;
    bar = bar > 0 ? bar : 0;
    int full = (int)(share * bar);
    memset(line + before, '#', (size_t)full);
    memset(line + before + full, '.', (size_t)(bar - full));
    snprintf(line + before + bar, sizeof(line) - (size_t)(before + bar), "%s", tail);
    draw(progress, line, before, bar);
}

void kdr_progress_clear(kdr_progress *progress) {
    if (!progress || !progress->shown || progress->columns == 0)
        return;
    if (progress->escapes)
        fputs("\r\033[K", stderr);
    else
        fprintf(stderr, "\r%*s\r", progress->columns, "");
    fflush(stderr);
    progress->columns = 0;
}
