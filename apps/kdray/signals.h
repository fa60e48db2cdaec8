/* Ctrl-C and its relatives SIGTERM and SIGHUP cancel, at any time, with a sentence and exit status 1. */
#ifndef KDR_APPS_KDRAY_SIGNALS_H
#define KDR_APPS_KDRAY_SIGNALS_H

#include <stdbool.h>

/* Makes a closed pipe, and a file beyond the allowed size, errors of the write that finds them. */
void kdr_signals_prepare(void);

/* From here on a signal ends the program at once, after the line "COMMAND: cancelled". Right while there is nothing to
 * undo. command: static storage. */
void kdr_signals_watch(const char *command);

/* From here on a signal is only remembered: whoever works asks kdr_signals_cancelled and undoes what it did. */
void kdr_signals_defer(void);

/* True once a signal has come. */
bool kdr_signals_cancelled(void);

#endif
