#include "frame_log.h"

#include "memory.h"
#include "output.h"

#include <inttypes.h>
#include <string.h>

void kdr_frame_log_add(kdr_frame_log *log, const kdr_frame_figures *frame) {
    if (log->count == log->capacity) {
        size_t capacity = 2 * log->capacity + 64;
        kdr_frame_figures *frames = kdr_memory_get(capacity, sizeof *frames);
        if (log->count)
            memcpy(frames, log->frames, log->count * sizeof *frames);
        kdr_memory_release(log->frames);
        log->frames = frames;
        log->capacity = capacity;
    }
    log->frames[log->count++] = *frame;
}

void kdr_frame_log_release(kdr_frame_log *log) {
    kdr_memory_release(log->frames);
    *log = (kdr_frame_log){0};
}

static double frame_seconds(const kdr_frame_figures *frame) {
    return frame->sample_seconds + frame->build_seconds + frame->trace_seconds;
}

static double frames_a_second(const kdr_frame_figures *frame) {
    double seconds = frame_seconds(frame);
    return seconds > 0 ? 1 / seconds : 0;
}

static double million_rays_a_second(const kdr_frame_figures *frame) {
    double rays = (double)frame->primary_rays + (double)frame->shadow_rays;
    return frame->trace_seconds > 0 ? 1e-6 * rays / frame->trace_seconds : 0;
}

bool kdr_frame_log_write_csv(const kdr_frame_log *log, const char *path, kdr_messages *messages) {
    kdr_output output;
    if (!kdr_output_open(&output, path, messages))
        return false;
    fputs("frame,time_s,triangles,sample_ms,build_ms,trace_ms,frame_ms,write_ms,fps,primary_rays,shadow_rays,mray_s\n",
          output.file);
    for (size_t i = 0; i < log->count; i++) {
        const kdr_frame_figures *frame = &log->frames[i];
        fprintf(output.file, "%" PRIu64 ",%.6f,%zu,%.3f,%.3f,%.3f,%.3f,%.3f,%.2f,%" PRIu64 ",%" PRIu64 ",%.3f\n",
                frame->number, frame->time, frame->triangles, 1e3 * frame->sample_seconds, 1e3 * frame->build_seconds,
                1e3 * frame->trace_seconds, 1e3 * frame_seconds(frame), 1e3 * frame->write_seconds,
                frames_a_second(frame), frame->primary_rays, frame->shadow_rays, million_rays_a_second(frame));
    }
    return kdr_output_close(&output, messages);
}

/* All frames as one: mean times, the most triangles, rays in all. */
static kdr_frame_figures means(const kdr_frame_log *log, double *mray_s) {
    kdr_frame_figures sum = {0};
    for (size_t i = 0; i < log->count; i++) {
        const kdr_frame_figures *frame = &log->frames[i];
        sum.triangles = frame->triangles > sum.triangles ? frame->triangles : sum.triangles;
        sum.sample_seconds += frame->sample_seconds;
        sum.build_seconds += frame->build_seconds;
        sum.trace_seconds += frame->trace_seconds;
        sum.write_seconds += frame->write_seconds;
        sum.primary_rays += frame->primary_rays;
        sum.shadow_rays += frame->shadow_rays;
    }
    *mray_s = million_rays_a_second(&sum);
    double count = log->count ? (double)log->count : 1;
    sum.sample_seconds /= count;
    sum.build_seconds /= count;
    sum.trace_seconds /= count;
    sum.write_seconds /= count;
    return sum;
}

void kdr_frame_log_json(const kdr_frame_log *log, kdr_json *json) {
    double mray_s;
    kdr_frame_figures mean = means(log, &mray_s);
    kdr_json_whole(json, "frames", log->count);
    kdr_json_whole(json, "skipped", log->skipped);
    kdr_json_whole(json, "most_triangles", mean.triangles);
    kdr_json_real(json, "sample_ms", 1e3 * mean.sample_seconds);
    kdr_json_real(json, "build_ms", 1e3 * mean.build_seconds);
    kdr_json_real(json, "trace_ms", 1e3 * mean.trace_seconds);
    kdr_json_real(json, "write_ms", 1e3 * mean.write_seconds);
    kdr_json_real(json, "fps", log->count ? frames_a_second(&mean) : 0);
    kdr_json_whole(json, "primary_rays", mean.primary_rays);
    kdr_json_whole(json, "shadow_rays", mean.shadow_rays);
    kdr_json_real(json, "mray_s", mray_s);
}

void kdr_frame_log_print(const kdr_frame_log *log, uint32_t width, uint32_t height) {
    double mray_s;
    kdr_frame_figures mean = means(log, &mray_s);
    fprintf(stderr, "%zu frame%s of %" PRIu32 "x%" PRIu32 " pixels", log->count, log->count == 1 ? "" : "s", width,
            height);
    if (log->skipped)
        fprintf(stderr, ", %zu left out", log->skipped);
    if (log->count)
        fprintf(stderr, ": sample %.1f ms, build %.1f ms, trace %.1f ms a frame, %.1f frames/s, %.2f Mray/s",
                1e3 * mean.sample_seconds, 1e3 * mean.build_seconds, 1e3 * mean.trace_seconds, frames_a_second(&mean),
                mray_s);
    fputc('\n', stderr);
}
