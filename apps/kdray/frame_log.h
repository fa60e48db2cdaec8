/* What each frame took, kept until the end: as CSV, as JSON, and in one line. */
#ifndef KDR_APPS_KDRAY_FRAME_LOG_H
#define KDR_APPS_KDRAY_FRAME_LOG_H

#include "json.h"
#include "messages.h"

typedef struct kdr_frame_figures {
    uint64_t number;
    double time; /* seconds into the animation */
    size_t triangles;
    double sample_seconds, build_seconds, trace_seconds, write_seconds;
    uint64_t primary_rays, shadow_rays;
} kdr_frame_figures;

typedef struct kdr_frame_log {
    kdr_frame_figures *frames;
    size_t count, capacity;
    size_t skipped; /* frames that were there already */
} kdr_frame_log;

void kdr_frame_log_add(kdr_frame_log *log, const kdr_frame_figures *frame);
void kdr_frame_log_release(kdr_frame_log *log);

/* A header and a line a frame. fps and Mray/s are those of sampling, building and tracing together, and of tracing.
 * False after a sentence. */
bool kdr_frame_log_write_csv(const kdr_frame_log *log, const char *path, kdr_messages *messages);

/* Members of the innermost object: counts, and means over the frames. */
void kdr_frame_log_json(const kdr_frame_log *log, kdr_json *json);

/* "12 frames of 640x480: sample 0.1 ms, build 3.0 ms, ..." on stderr. */
void kdr_frame_log_print(const kdr_frame_log *log, uint32_t width, uint32_t height);

#endif
