/* A file as bytes in memory: mapped where that is possible, read where it is not (pipes), unpacked if it is gzip. */
#ifndef KDR_MESH_FILE_BYTES_H
#define KDR_MESH_FILE_BYTES_H

#include "kdray/render.h"

typedef struct kdr_file_bytes {
    const unsigned char *bytes; /* NULL when length is 0 */
    size_t length;
    size_t capacity; /* of allocated memory; 0: mapped from the file */
} kdr_file_bytes;

/* Opens a regular file or a pipe. Errors, each with a sentence: IO (missing, unreadable, directory, device),
 * OUT_OF_MEMORY. A mapped file must not be cut short by others until it is released. */
kdr_status kdr_file_bytes_open(const char *path, const kdr_logger *logger, kdr_file_bytes *out);
void kdr_file_bytes_release(kdr_file_bytes *file);

/* The gzip mark at the beginning. */
bool kdr_bytes_are_gzip(const unsigned char *bytes, size_t length);

/* Unpacks all members of gzip data. Memory follows what has really been unpacked: it grows geometrically, and the size
 * that the data claims is believed only as far as deflate can reach (1,032 to 1).
 * Errors, each with a sentence that begins with `name`: INVALID_DATA (with the byte in the packed data),
 * OUT_OF_MEMORY. */
kdr_status kdr_bytes_unpack(const char *name, const unsigned char *bytes, size_t length, const kdr_logger *logger,
                            kdr_file_bytes *out);

#endif
