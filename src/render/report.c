#include "render/report.h"

#include <stdarg.h>
#include <stdio.h>

kdr_status kdr_report(const kdr_logger *logger, kdr_status status, const char *format, ...) {
    if (!logger || !logger->log)
        return status;
    char sentence[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(sentence, sizeof(sentence), format, arguments);
    va_end(arguments);
    logger->log(KDR_LOG_ERROR, sentence, logger->user);
    return status;
}
