#include "frame_names.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#define DIGIT_LIMIT 15

/* Where the run of # begins, in the last part of a name; NULL: there is none. */
static const char *run_of(const char *pattern) {
    const char *slash = strrchr(pattern, '/');
    return strchr(slash ? slash : pattern, '#');
}

const char *kdr_frame_pattern_fault(const char *pattern, bool several) {
    const char *run = run_of(pattern);
    if (!run)
        return several ? "a name with # for the number, such as frame####.png" : NULL;
    size_t digits = strspn(run, "#");
    if (strchr(run + digits, '#'))
        return "# in one place of the name only";
    return digits > DIGIT_LIMIT ? "fewer # in the name" : NULL;
}

bool kdr_frame_name(const char *pattern, uint64_t number, char name[PATH_MAX]) {
    const char *run = run_of(pattern);
    int length;
    if (run) {
        int digits = (int)strspn(run, "#");
        length = snprintf(name, PATH_MAX, "%.*s%0*" PRIu64 "%s", (int)(run - pattern), pattern, digits, number,
                          run + digits);
    } else {
        length = snprintf(name, PATH_MAX, "%s", pattern);
    }
    return length >= 0 && length < PATH_MAX;
}
