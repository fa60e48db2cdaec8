/* A line on the terminal that shows how far a command is: percent, time gone, time left. Shown on stderr, only if that
 * is a terminal. NO_COLOR takes the colour out; TERM=dumb gets no escape sequences. Functions may be called from any
 * thread, never two at once. NULL is a progress that shows nothing. */
#ifndef KDR_APPS_KDRAY_PROGRESS_H
#define KDR_APPS_KDRAY_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

typedef struct kdr_progress {
    bool shown;   /* stderr is a terminal, and nobody asked for quiet */
    bool escapes; /* the terminal knows escape sequences */
    bool colour;
    const char *what; /* the step that the times below belong to */
    double begin;     /* of the step, seconds */
    uint64_t done_at_begin;
    double drawn; /* when the line was last drawn, seconds; 0: never */
    int columns;  /* of the line on the terminal now; 0: none */
} kdr_progress;

kdr_progress kdr_progress_make(bool quiet);

/* Names a step of unknown length: "loading". */
void kdr_progress_step(kdr_progress *progress, const char *what);

/* finished of total parts of `what` (static storage) are done. Draws ten times a second at most. */
void kdr_progress_update(kdr_progress *progress, const char *what, uint64_t finished, uint64_t total);

/* Takes the line off the terminal. */
void kdr_progress_clear(kdr_progress *progress);

/* Seconds of a clock that never goes back. */
double kdr_seconds(void);

/* Columns of the terminal that `file` is, or of COLUMNS, or 80. */
int kdr_terminal_columns(int file);

#endif
