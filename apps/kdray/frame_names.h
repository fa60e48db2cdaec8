/* Names of numbered frames: "frame####.png" is frame0007.png for number 7. */
#ifndef KDR_APPS_KDRAY_FRAME_NAMES_H
#define KDR_APPS_KDRAY_FRAME_NAMES_H

#include <limits.h>
#include <stdbool.h>
#include <stdint.h>

/* NULL, or what is wrong with a pattern for several frames: the end of a sentence that begins with "expected". */
const char *kdr_frame_pattern_fault(const char *pattern, bool several);

/* The name of a frame: the one run of # becomes the number, with as many digits at least; a pattern without # stays as
 * it is. False: the name is too long. */
bool kdr_frame_name(const char *pattern, uint64_t number, char name[PATH_MAX]);

#endif
