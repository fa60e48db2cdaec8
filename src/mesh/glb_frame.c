/* Source: Khronos Group, "glTF 2.0 Specification", chapter 4, "GLB File Format Specification": magic, version and
 * length of all, 4 bytes each, then chunks of length, type and contents; the first holds JSON, the second may hold a
 * buffer. */
#include "mesh/glb_frame.h"

#include <string.h>

#define HEADER_BYTES 12
#define CHUNK_HEADER_BYTES 8
#define JSON_TYPE 0x4e4f534au   /* "JSON" */
#define BINARY_TYPE 0x004e4942u /* "BIN" and a zero */

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

kdr_status kdr_glb_read_frame(const kdr_source *source, kdr_glb_frame *out) {
    if (source->length < HEADER_BYTES + CHUNK_HEADER_BYTES)
        return kdr_source_fail_byte(source, source->length, "expected the %d bytes that begin a GLB, the file ends",
                                    HEADER_BYTES + CHUNK_HEADER_BYTES);
    uint32_t version = word_at(source, 4);
    if (version != 2)
        return kdr_source_fail(source, KDR_ERROR_UNSUPPORTED, "byte 4: expected GLB version 2, found %u", version);
    kdr_status status = check_length(source, 8, source->length, "the file");
    size_t byte = HEADER_BYTES, end = status == KDR_OK ? word_at(source, 8) : 0;
    *out = (kdr_glb_frame){0};
    for (int chunk = 0; status == KDR_OK && end > byte && end - byte >= CHUNK_HEADER_BYTES; chunk++) {
        status = check_length(source, byte, end - byte - CHUNK_HEADER_BYTES, "a chunk");
        if (status != KDR_OK)
            return status;
        size_t length = word_at(source, byte), begin = byte + CHUNK_HEADER_BYTES;
        if (chunk == 0 && word_at(source, byte + 4) == JSON_TYPE)
            *out = (kdr_glb_frame){.json_begin = begin, .json_end = begin + length};
        if (chunk == 1 && word_at(source, byte + 4) == BINARY_TYPE) {
            out->binary_begin = begin;
            out->binary_length = length;
        }
        byte = begin + length;
    }
    if (status == KDR_OK && out->json_begin == 0)
        return kdr_source_fail_byte(source, HEADER_BYTES, "expected a first chunk of the type JSON");
    return status;
}
