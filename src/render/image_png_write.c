/* Images to PNG files, whole or not at all.
 *
 * The bytes go to a new file in the same directory, which is flushed to the disk and takes the name at the very end. A
 * name that stands for a device or a pipe is written to directly: there is nothing to replace. Compression level 1 with
 * the SUB filter costs a tenth of the time of libpng's defaults, for files 1.4 times as large. */
#include "kdray/render.h"

#include "mesh/report.h"
#include "render/memory.h"
#include "render/png_memory.h"
#include "render/srgb.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define COMPRESSION_LEVEL 1
#define NAME_TRIES 100

typedef struct png_output {
    kdr_png_fault fault; /* first: libpng's error and memory pointer */
    png_structp png;
    png_infop info;
    const kdr_image *image;
    const kdr_srgb_tables *srgb;
    uint8_t *row; /* 3 * width bytes */
    int file;
    int error_number; /* of the system call that failed; 0: none */
    size_t used;      /* bytes in buffer */
    uint8_t buffer[1 << 16];
} png_output;

/* ---- bytes to the file */

static bool flush_buffer(png_output *output) {
    size_t done = 0;
    while (done < output->used) {
        ssize_t count = write(output->file, output->buffer + done, output->used - done);
        if (count < 0 && errno == EINTR)
            continue;
        if (count <= 0) {
            output->error_number = count < 0 ? errno : ENOSPC;
            return false;
        }
        done += (size_t)count;
    }
    output->used = 0;
    return true;
}

static void put_bytes(png_structp png, png_bytep bytes, size_t size) {
    png_output *output = png_get_io_ptr(png);
    while (size > 0) {
        size_t room = sizeof(output->buffer) - output->used;
        size_t part = size < room ? size : room;
        memcpy(output->buffer + output->used, bytes, part);
        output->used += part;
        bytes += part;
        size -= part;
        if (output->used == sizeof(output->buffer) && !flush_buffer(output))
            png_error(png, "write failed");
    }
}

static void put_nothing(png_structp png) { (void)png; }

/* ---- pixels to bytes */

static void put_rows(png_output *output) {
    const kdr_image *image = output->image;
    size_t length = (size_t)image->width * 3;
    for (uint32_t y = 0; y < image->height; y++) {
        const float *rgb = image->rgb + y * length;
        for (size_t i = 0; i < length; i++)
            output->row[i] = kdr_srgb_from_linear(output->srgb, rgb[i]);
        png_write_row(output->png, output->row);
    }
}

/* False when libpng left by longjmp. */
static bool encode(png_output *output) {
    if (setjmp(png_jmpbuf(output->png)))
        return false;
    png_set_write_fn(output->png, output, put_bytes, put_nothing);
    png_set_IHDR(output->png, output->info, output->image->width, output->image->height, 8, PNG_COLOR_TYPE_RGB,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(output->png, output->info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_set_compression_level(output->png, COMPRESSION_LEVEL);
    png_set_filter(output->png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
    png_write_info(output->png, output->info);
    put_rows(output);
    png_write_end(output->png, output->info);
    return true;
}

static kdr_status write_image(png_output *output) {
    size_t row_size = (size_t)output->image->width * 3;
    output->row = kdr_render_get(row_size, 1);
    output->png = png_create_write_struct_2(PNG_LIBPNG_VER_STRING, output, kdr_png_fail, kdr_png_ignore, output,
                                            kdr_png_get, kdr_png_release);
    output->info = output->png ? png_create_info_struct(output->png) : NULL;

    kdr_status status = KDR_ERROR_OUT_OF_MEMORY;
    if (output->row && output->info) {
        if (encode(output) && flush_buffer(output))
            status = KDR_OK;
        else
            status = output->error_number || !output->fault.out_of_memory ? KDR_ERROR_IO : KDR_ERROR_OUT_OF_MEMORY;
    }
    png_destroy_write_struct(&output->png, &output->info);
    kdr_render_release(output->row, row_size);
    return status;
}

/* ---- the file and its name */

typedef struct png_target {
    char name[PATH_MAX];      /* the file's own name, symbolic links followed */
    char temporary[PATH_MAX]; /* written to first; empty: the name is written to directly */
    int file;                 /* -1: closed */
} png_target;

/* A name beside the target's that nothing else has. 0, or an error number. */
static int open_temporary(png_target *target) {
    static _Atomic unsigned counter;
    const char *slash = strrchr(target->name, '/');
    int directory = slash ? (int)(slash - target->name) + 1 : 0;
    for (int i = 0; i < NAME_TRIES; i++) {
        int length = snprintf(target->temporary, sizeof(target->temporary), "%.*s.kdray-%ld-%u.png", directory,
                              target->name, (long)getpid(), atomic_fetch_add(&counter, 1));
        if (length < 0 || (size_t)length >= sizeof(target->temporary)) {
            target->temporary[0] = 0;
            return ENAMETOOLONG;
        }
        target->file = open(target->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (target->file >= 0)
            return 0;
        if (errno != EEXIST)
            break;
    }
    target->temporary[0] = 0;
    return errno;
}

/* 0, or an error number. */
static int open_target(const char *path, png_target *target) {
    target->file = -1;
    target->temporary[0] = 0;
    if (strlen(path) >= sizeof(target->name))
        return ENAMETOOLONG;
    memcpy(target->name, path, strlen(path) + 1);

    struct stat info;
    if (stat(path, &info) == 0) {
        if (S_ISDIR(info.st_mode))
            return EISDIR;
        if (!S_ISREG(info.st_mode)) {
            target->file = open(path, O_WRONLY | O_CLOEXEC | O_NOCTTY);
            return target->file >= 0 ? 0 : errno;
        }
        if (!realpath(path, target->name))
            return errno;
    }
    return open_temporary(target);
}

/* Gives a file written in full its name. 0, or an error number. */
static int keep_target(png_target *target) {
    // Pipes and devices have nothing to flush and say so.
    if (fsync(target->file) != 0 && (target->temporary[0] || (errno != EINVAL && errno != EROFS)))
        return errno;
    int closed = close(target->file);
    target->file = -1;
    if (closed != 0)
        return errno;
    return target->temporary[0] && rename(target->temporary, target->name) != 0 ? errno : 0;
}

static void drop_target(png_target *target) {
    if (target->file >= 0)
        close(target->file);
    if (target->temporary[0])
        unlink(target->temporary);
}

static kdr_status report_error_number(const kdr_logger *logger, const char *path, int number) {
    char text[128];
    return kdr_report(logger, KDR_ERROR_IO, "%s: %s", path, strerror_r(number, text, sizeof(text)));
}

kdr_status kdr_image_write_png(const kdr_image *image, const char *path, const kdr_logger *logger) {
    if (!image || !path)
        return kdr_report(logger, KDR_ERROR_INVALID_ARGUMENT, "writing a PNG file needs an image and a file name");
    png_output *output = kdr_render_get(1, sizeof(png_output));
    png_target *target = kdr_render_get(1, sizeof(png_target));
    kdr_status status = KDR_ERROR_OUT_OF_MEMORY;
    if (output && target) {
        int number = open_target(path, target);
        if (number == 0) {
            *output = (png_output){.image = image, .srgb = kdr_srgb_get_tables(), .file = target->file};
            status = write_image(output);
            number = status == KDR_OK ? keep_target(target) : output->error_number;
        }
        if (number != 0)
            status = report_error_number(logger, path, number);
        else if (status == KDR_ERROR_IO)
            kdr_report(logger, status, "%s: %s", path, output->fault.message);
        if (status != KDR_OK)
            drop_target(target);
    }
    if (status == KDR_ERROR_OUT_OF_MEMORY)
        kdr_report(logger, status, "%s: out of memory while writing", path);
    kdr_render_release(target, sizeof(png_target));
    kdr_render_release(output, sizeof(png_output));
    return status;
}
