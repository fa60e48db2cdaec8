#include "mesh/report.h"

#include <stdarg.h>
#include <stdio.h>

static void tell(const kdr_logger *logger, kdr_log_level level, const char *format, va_list arguments) {
    if (!logger || !logger->log)
        return;
    char message[KDR_REPORT_BYTES];
    vsnprintf(message, sizeof message, format, arguments);

    // A sentence is one line whatever names the file holds.
    for (char *c = message; *c; c++)
        if ((unsigned char)*c < 0x20 || *c == 0x7f)
            *c = '?';
    logger->log(level, message, logger->user);
}

kdr_status kdr_report(const kdr_logger *logger, kdr_status status, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    tell(logger, KDR_LOG_ERROR, format, arguments);
    va_end(arguments);
    return status;
}

void kdr_report_warning(const kdr_logger *logger, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    tell(logger, KDR_LOG_WARNING, format, arguments);
    va_end(arguments);
}
