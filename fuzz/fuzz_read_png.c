/* Any bytes as a PNG file: an image or one sentence, and no memory left behind. Mutated files get right check sums, so
 * that what they change is read at all. */
#include "kdray/render.h"
#include "render/image_png.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#define SIGNATURE_BYTES 8
#define CHUNK_FRAME_BYTES 12 /* length, name and check sum */

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);
size_t LLVMFuzzerMutate(uint8_t *bytes, size_t size, size_t room);
size_t LLVMFuzzerCustomMutator(uint8_t *bytes, size_t size, size_t room, unsigned seed);

static uint32_t number_at(const uint8_t *bytes) {
    return (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 | bytes[3];
}

size_t LLVMFuzzerCustomMutator(uint8_t *bytes, size_t size, size_t room, unsigned seed) {
    size = LLVMFuzzerMutate(bytes, size, room);
    size_t at = SIGNATURE_BYTES;
    // Every 16th stays broken.
    while (seed % 16 != 0 && size >= CHUNK_FRAME_BYTES && at <= size - CHUNK_FRAME_BYTES) {
        size_t length = number_at(bytes + at);
        if (length > size - CHUNK_FRAME_BYTES - at)
            break;
        uLong sum = crc32(0, bytes + at + 4, (uInt)length + 4);
        for (int i = 0; i < 4; i++)
            bytes[at + 8 + length + (size_t)i] = (uint8_t)(sum >> (24 - 8 * i));
        at += length + CHUNK_FRAME_BYTES;
    }
    return size;
}

static void count_sentences(kdr_log_level level, const char *message, void *user) {
    (void)level;
    if (message[0] == '\0' || strchr(message, '\n'))
        abort();
    ++*(int *)user;
}

/* A few bytes may rightly hold many millions of pixels: nothing new, and slow. */
static bool is_slow(const uint8_t *bytes, size_t size) {
    if (size < 24)
        return false;
    uint64_t pixels = (uint64_t)number_at(bytes + 16) * number_at(bytes + 20);
    return pixels > 1 << 18 && pixels <= 1 << 28;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    if (is_slow(bytes, size))
        return 0;
    int sentences = 0;
    const kdr_logger logger = {count_sentences, &sentences};
    kdr_image *image;
    kdr_status status = kdr_image_decode_png(bytes, size, "fuzz.png", &logger, &image);
    if ((status == KDR_OK) != (image != NULL) || sentences != (status != KDR_OK))
        abort();
    kdr_image_destroy(image);
    if (kdr_render_bytes() != 0)
        abort();
    return 0;
}
