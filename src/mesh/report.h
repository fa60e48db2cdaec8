/* Sentences to the user: one line each, through the logger that the caller gave. */
#ifndef KDR_MESH_REPORT_H
#define KDR_MESH_REPORT_H

#include "kdray/render.h"

/* Longer sentences are cut. Bytes that are no printable text (of names in a file) appear as '?'. */
#define KDR_REPORT_BYTES 1024

/* Tells why something failed and returns `status`, so that a failing function ends in one line.
 * logger NULL, or with log NULL: silence. */
kdr_status kdr_report(const kdr_logger *logger, kdr_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Tells something that does not make the call fail. */
void kdr_report_warning(const kdr_logger *logger, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
