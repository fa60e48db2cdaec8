/* Source: Khronos Group, "glTF 2.0 Specification", chapter 4, "GLB File Format Specification". Version 2: magic,
 * version and length of all, 4 bytes each, then chunks of length, type and contents. Version 1: after the same 12 bytes
 * the length of its one scene of JSON and a format. */
#include "mesh/glb_frame.h"

#include <string.h>

#define HEADER_BYTES       12
#define CHUNK_HEADER_BYTES 8

static uint32_t word_at(const kdr_source *source, size_t byte) {
    const unsigned char *p = source->bytes + byte;
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

bool kdr_source_is_glb(const kdr_source *source) {
    return source->length >= 4 && memcmp(source->bytes, "glTF", 4) == 0;
}

static kdr_status check_length(const kdr_source *source, size_t byte, size_t most, const char *what) {
    uint32_t length = word_at(source, byte);
    if (length <= most)
        return KDR_OK;
    return kdr_source_fail_byte(source, byte, "expected the length of %s to be at most %zu, found %u", what, most,
                                length);
}

kdr_status kdr_glb_check_frame(const kdr_source *source) {
    if (source->length < HEADER_BYTES + CHUNK_HEADER_BYTES)
        return kdr_source_fail_byte(source, source->length, "expected the %d bytes that begin a GLB, the file ends",
                                    HEADER_BYTES + CHUNK_HEADER_BYTES);
    uint32_t version = word_at(source, 4);
    if (version != 1 && version != 2)
        return kdr_source_fail(source, KDR_ERROR_UNSUPPORTED, "byte 4: expected GLB version 1 or 2, found %u", version);
    kdr_status status = check_length(source, 8, source->length, "the file");
    size_t byte = HEADER_BYTES;
    while (status == KDR_OK && source->length - byte >= CHUNK_HEADER_BYTES) {
        size_t room = source->length - byte - CHUNK_HEADER_BYTES;
        status = check_length(source, byte, room, version == 1 ? "the scene" : "a chunk");
        if (version == 1)
            break;
        byte += status == KDR_OK ? CHUNK_HEADER_BYTES + (size_t)word_at(source, byte) : 0;
    }
    return status;
}
