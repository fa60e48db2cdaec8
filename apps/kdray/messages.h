/* Sentences to the user, on stderr, each opened by the command's name. */
#ifndef KDR_APPS_KDRAY_MESSAGES_H
#define KDR_APPS_KDRAY_MESSAGES_H

#include "progress.h"

#include <kdray/render.h>
#include <stdbool.h>

typedef struct kdr_messages {
    const char *command;    /* "kdray render" */
    bool quiet;             /* errors only */
    bool failed;            /* an error has been told */
    kdr_progress *progress; /* taken off the terminal before a sentence; NULL: none */
} kdr_messages;

/* The sentences of the libraries; messages must outlive it. */
kdr_logger kdr_messages_logger(kdr_messages *messages);

/* Tells an error. Returns KDR_EXIT_FAILED. */
int kdr_messages_fail(kdr_messages *messages, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* For a call that failed: tells the status, unless the library has already told more. Returns KDR_EXIT_FAILED. */
int kdr_messages_fail_status(kdr_messages *messages, const char *what, kdr_status status);

#endif
