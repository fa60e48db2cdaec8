#include "video.h"

#include "memory.h"
#include "output.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

/* Looks where execvp would look. */
static bool is_there(const char *program) {
    const char *path = getenv("PATH");
    for (const char *part = path ? path : "/bin:/usr/bin"; *part;) {
        size_t length = strcspn(part, ":");
        char name[PATH_MAX];
        int written = snprintf(name, sizeof name, "%.*s%s%s", (int)length, part, length ? "/" : "", program);
        if (written > 0 && (size_t)written < sizeof name && access(name, X_OK) == 0)
            return true;
        part += length + (part[length] == ':');
    }
    return false;
}

bool kdr_video_check(const char *path, kdr_messages *messages) {
    if (is_there("ffmpeg"))
        return kdr_output_check(path, messages);
    kdr_messages_fail(messages, "%s: a video takes the program ffmpeg, which was not found", path);
    return false;
}

/* A new name beside the target, with its ending, which tells ffmpeg the format. */
static bool name_temporary(kdr_video *video) {
    const char *slash = strrchr(video->path, '/'), *name = slash ? slash + 1 : video->path;
    int length = snprintf(video->temporary, sizeof video->temporary, "%.*s.kdray-%ld.%s", (int)(name - video->path),
                          video->path, (long)getpid(), name);
    return length > 0 && (size_t)length < sizeof video->temporary;
}

/* What is read from is the pipe's end; what ffmpeg has to say beyond errors nobody asked for. Signals keep to the
 * parent, which ends the encoder itself. */
static int start(kdr_video *video, double rate, int reading_end) {
    char size[32], speed[32];
    snprintf(size, sizeof size, "%ux%u", video->width, video->height);
    snprintf(speed, sizeof speed, "%.10g", rate);
    char *arguments[] = {"ffmpeg",   "-loglevel", "error", "-f",
                         "rawvideo", "-pix_fmt",  "rgb24", "-s",
                         size,       "-r",        speed,   "-i",
                         "-",        "-an",       "-vf",   "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                         "-pix_fmt", "yuv420p",   "-y",    video->temporary,
                         NULL};
    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;
    sigset_t defaults;
    sigemptyset(&defaults);
    sigaddset(&defaults, SIGPIPE);
    sigaddset(&defaults, SIGXFSZ);
    int number = posix_spawn_file_actions_init(&files);
    if (number != 0)
        return number;
    number = posix_spawnattr_init(&attributes);
    if (number == 0) {
        number = posix_spawn_file_actions_adddup2(&files, reading_end, STDIN_FILENO);
        posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
        posix_spawnattr_setpgroup(&attributes, 0);
        posix_spawnattr_setsigdefault(&attributes, &defaults);
        if (number == 0)
            number = posix_spawnp(&video->encoder, "ffmpeg", &files, &attributes, arguments, environ);
        posix_spawnattr_destroy(&attributes);
    }
    posix_spawn_file_actions_destroy(&files);
    return number;
}

bool kdr_video_open(kdr_video *video, const char *path, uint32_t width, uint32_t height, double rate,
                    kdr_messages *messages) {
    *video = (kdr_video){.path = path, .pipe = -1, .width = width, .height = height};
    int ends[2], number = ENAMETOOLONG;
    if (name_temporary(video)) {
        number = pipe2(ends, O_CLOEXEC) == 0 ? 0 : errno;
        if (number == 0) {
            video->pipe = ends[1];
            number = start(video, rate, ends[0]);
            close(ends[0]);
        }
    }
    if (number == 0) {
        video->bytes = kdr_memory_get((size_t)width * height, 3);
        return true;
    }
    kdr_messages_fail(messages, "%s: ffmpeg does not start: %s", path, strerror(number));
    if (video->pipe >= 0)
        close(video->pipe);
    *video = (kdr_video){.pipe = -1};
    return false;
}

bool kdr_video_add(kdr_video *video, const kdr_image *image, kdr_messages *messages) {
    kdr_image_bytes(image, video->bytes);
    size_t size = (size_t)video->width * video->height * 3;
    for (size_t done = 0; done < size;) {
        ssize_t written = write(video->pipe, video->bytes + done, size - done);
        if (written < 0 && errno == EINTR)
            continue;
        if (written < 0) {
            kdr_messages_fail(messages, "%s: ffmpeg takes no more frames: %m", video->path);
            return false;
        }
        done += (size_t)written;
    }
    return true;
}

bool kdr_video_close(kdr_video *video, bool keep, kdr_messages *messages) {
    if (video->encoder == 0)
        return true;
    close(video->pipe);
    if (!keep)
        kill(video->encoder, SIGKILL);
    int state = 0;
    while (waitpid(video->encoder, &state, 0) < 0 && errno == EINTR)
        continue;
    video->encoder = 0;
    kdr_memory_release(video->bytes);
    bool done = WIFEXITED(state) && WEXITSTATUS(state) == 0;
    if (keep && !done)
        kdr_messages_fail(messages, "%s: ffmpeg failed", video->path);
    if (keep && done && rename(video->temporary, video->path) != 0) {
        kdr_messages_fail(messages, "%s: %m", video->path);
        done = false;
    }
    if (!keep || !done)
        unlink(video->temporary);
    return !keep || done;
}
