#include "messages.h"

#include "command.h"

#include <stdarg.h>
#include <stdio.h>

static void tell(kdr_log_level level, const char *message, void *user) {
    kdr_messages *messages = user;
    if (level == KDR_LOG_INFO || (level == KDR_LOG_WARNING && messages->quiet))
        return;
    // The first error says what is wrong; those after it only that it mattered.
    if (level == KDR_LOG_ERROR && messages->failed)
        return;
    if (level == KDR_LOG_ERROR)
        messages->failed = true;
    kdr_progress_clear(messages->progress);
    fprintf(stderr, "%s: %s%s\n", messages->command, level == KDR_LOG_WARNING ? "warning: " : "", message);
}

kdr_logger kdr_messages_logger(kdr_messages *messages) { return (kdr_logger){.log = tell, .user = messages}; }

int kdr_messages_fail(kdr_messages *messages, const char *format, ...) {
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof(text), format, arguments);
    va_end(arguments);
    tell(KDR_LOG_ERROR, text, messages);
    return KDR_EXIT_FAILED;
}

int kdr_messages_fail_status(kdr_messages *messages, const char *what, kdr_status status) {
    if (messages->failed)
        return KDR_EXIT_FAILED;
    return kdr_messages_fail(messages, "%s: %s", what, kdr_status_text(status));
}
