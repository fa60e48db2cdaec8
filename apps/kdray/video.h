/* Frames to a video file, through the program ffmpeg. The file appears whole under its name or not at all. */
#ifndef KDR_APPS_KDRAY_VIDEO_H
#define KDR_APPS_KDRAY_VIDEO_H

#include "messages.h"

#include <limits.h>
#include <sys/types.h>

typedef struct kdr_video {
    const char *path;
    char temporary[PATH_MAX]; /* written to first */
    pid_t encoder;            /* 0: none */
    int pipe;                 /* to the encoder's standard input */
    uint8_t *bytes;           /* of a frame */
    uint32_t width, height;
} kdr_video;

/* True if there is an ffmpeg to run and the file can be written. False after a sentence. */
bool kdr_video_check(const char *path, kdr_messages *messages);

/* Starts ffmpeg; path must outlive the video. False after a sentence. */
bool kdr_video_open(kdr_video *video, const char *path, uint32_t width, uint32_t height, double rate,
                    kdr_messages *messages);

/* The next frame, of that size. False after a sentence. */
bool kdr_video_add(kdr_video *video, const kdr_image *image, kdr_messages *messages);

/* keep: waits for ffmpeg and gives the file its name, false after a sentence. Otherwise ends it and leaves nothing. */
bool kdr_video_close(kdr_video *video, bool keep, kdr_messages *messages);

#endif
