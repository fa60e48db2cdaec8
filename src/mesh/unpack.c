/* gzip data unpacked into memory. */
#include "mesh/file_bytes.h"
#include "mesh/mesh_memory.h"
#include "mesh/report.h"

#include <limits.h>
#include <string.h>
#include <zlib.h>

/* Deflate packs at best 1,032 bytes into one. */
#define MOST_PER_BYTE 1032
#define LEAST_CAPACITY ((size_t)4 << 10)

bool kdr_bytes_are_gzip(const unsigned char *bytes, size_t length) {
    return length >= 2 && bytes[0] == 0x1f && bytes[1] == 0x8b;
}

/* zlib's own memory is counted too; it names no size when it gives back, so each block begins with its size. */
#define BLOCK_HEAD KDR_MESH_ALIGNMENT

static voidpf take_block(voidpf unused, uInt count, uInt size) {
    (void)unused;
    size_t bytes = (size_t)count * size + BLOCK_HEAD;
    unsigned char *block = kdr_alloc_get(kdr_mesh_memory(), bytes, KDR_MESH_ALIGNMENT);
    if (!block)
        return Z_NULL;
    memcpy(block, &bytes, sizeof bytes);
    return block + BLOCK_HEAD;
}

static void give_block(voidpf unused, voidpf address) {
    (void)unused;
    unsigned char *block = (unsigned char *)address - BLOCK_HEAD;
    size_t bytes;
    memcpy(&bytes, block, sizeof bytes);
    kdr_alloc_release(kdr_mesh_memory(), block, bytes);
}

/* The last four bytes claim the unpacked size, modulo 2^32: a first guess, no more. */
static size_t first_capacity(const unsigned char *bytes, size_t length) {
    size_t claimed = 0;
    if (length >= 18) {
        const unsigned char *tail = bytes + length - 4;
        claimed = (size_t)tail[0] | (size_t)tail[1] << 8 | (size_t)tail[2] << 16 | (size_t)tail[3] << 24;
    }
    if (claimed / MOST_PER_BYTE > length)
        claimed = 0;
    return claimed + LEAST_CAPACITY;
}

static bool set_capacity(kdr_file_bytes *out, size_t capacity) {
    unsigned char *fresh = kdr_alloc_get(kdr_mesh_memory(), capacity, KDR_MESH_ALIGNMENT);
    if (!fresh)
        return false;
    if (out->length)
        memcpy(fresh, out->bytes, out->length);
    kdr_alloc_release(kdr_mesh_memory(), (void *)(uintptr_t)out->bytes, out->capacity);
    out->bytes = fresh;
    out->capacity = capacity;
    return true;
}

static uInt clamp_to_uint(size_t size) { return size > UINT_MAX ? UINT_MAX : (uInt)size; }

typedef struct unpacking {
    const char *name;
    const unsigned char *bytes;
    size_t length;
    size_t used; /* packed bytes done with */
    const kdr_logger *logger;
} unpacking;

static kdr_status unpack_all(unpacking *in, z_stream *stream, kdr_file_bytes *out) {
    if (!set_capacity(out, first_capacity(in->bytes, in->length)))
        return kdr_report(in->logger, KDR_ERROR_OUT_OF_MEMORY, "%s: out of memory while unpacking", in->name);
    for (;;) {
        if (out->length == out->capacity && (out->capacity > SIZE_MAX / 2 || !set_capacity(out, 2 * out->capacity)))
            return kdr_report(in->logger, KDR_ERROR_OUT_OF_MEMORY, "%s: out of memory after unpacking %zu bytes",
                              in->name, out->length);

        // Feed and drain at most 4 GiB at a time: zlib counts in unsigned int.
        uInt fed = clamp_to_uint(in->length - in->used), room = clamp_to_uint(out->capacity - out->length);
        stream->next_in = (z_const Bytef *)(uintptr_t)(in->bytes + in->used);
        stream->avail_in = fed;
        stream->next_out = (Bytef *)(uintptr_t)out->bytes + out->length;
        stream->avail_out = room;
        int result = inflate(stream, Z_NO_FLUSH);
        in->used += fed - stream->avail_in;
        out->length += room - stream->avail_out;

        if (result == Z_STREAM_END) {
            // Another member may follow; anything else after the end is padding.
            if (!kdr_bytes_are_gzip(in->bytes + in->used, in->length - in->used))
                return KDR_OK;
            inflateReset(stream);
        } else if (result == Z_MEM_ERROR) {
            return kdr_report(in->logger, KDR_ERROR_OUT_OF_MEMORY, "%s: out of memory while unpacking", in->name);
        } else if (result != Z_OK && result != Z_BUF_ERROR) {
            return kdr_report(in->logger, KDR_ERROR_INVALID_DATA, "%s: byte %zu: expected sound gzip data: %s",
                              in->name, in->used, stream->msg ? stream->msg : "damaged");
        } else if (in->used == in->length && out->length < out->capacity) {
            return kdr_report(in->logger, KDR_ERROR_INVALID_DATA,
                              "%s: byte %zu: expected more gzip data, the file ends", in->name, in->length);
        }
    }
}

kdr_status kdr_bytes_unpack(const char *name, const unsigned char *bytes, size_t length, const kdr_logger *logger,
                            kdr_file_bytes *out) {
    *out = (kdr_file_bytes){0};
    z_stream stream = {.zalloc = take_block, .zfree = give_block};
    if (inflateInit2(&stream, MAX_WBITS + 16) != Z_OK)
        return kdr_report(logger, KDR_ERROR_OUT_OF_MEMORY, "%s: out of memory while unpacking", name);
    unpacking in = {name, bytes, length, 0, logger};
    kdr_status status = unpack_all(&in, &stream, out);
    inflateEnd(&stream);
    if (status != KDR_OK)
        kdr_file_bytes_release(out);
    return status;
}
