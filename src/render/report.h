/* Sentences for the user, given to the logger that came with the call. */
#ifndef KDR_RENDER_REPORT_H
#define KDR_RENDER_REPORT_H

#include "kdray/render.h"

/* Formats one sentence, at most 1,023 bytes of it, and gives it to the log as an error. logger NULL: silence.
 * Returns `status`, so that a failure is reported and returned in one line. */
__attribute__((format(printf, 3, 4))) kdr_status kdr_report(const kdr_logger *logger, kdr_status status,
                                                            const char *format, ...);

#endif
