#include "bench_packets.h"

#include <string.h>

#define RAY_WORDS 12u /* 32-bit fields of a ray, in the order of kdr_ray */
#define HIT_WORDS 8u
#define FAR_WORD 8u /* tmax; minus infinity where a ray was found occluded */
#define GEOMETRY_WORD (RAY_WORDS + 6)
#define INSTANCE_WORD (RAY_WORDS + 7)

_Static_assert(sizeof(kdr_ray) == RAY_WORDS * 4 && sizeof(kdr_ray_hit) == (RAY_WORDS + HIT_WORDS) * 4, "words");
_Static_assert(sizeof(kdr_ray16) == 16 * sizeof(kdr_ray), "packets are as long as their rays");

static uint32_t packet_words(const kdr_bench_rays *rays, uint32_t width) {
    return (rays->any ? RAY_WORDS : RAY_WORDS + HIT_WORDS) * width;
}

void *kdr_bench_packet_at(const kdr_bench_rays *rays, uint32_t width, const kdr_bench_sheet *sheet, size_t ray) {
    return (uint32_t *)sheet->rays + ray / width * packet_words(rays, width);
}

void kdr_bench_packets_fill(const kdr_bench_rays *rays, uint32_t width, size_t begin, size_t end,
                            kdr_bench_sheet *sheet) {
    uint32_t count = packet_words(rays, width);
    for (size_t first = begin; first < end; first += width) {
        uint32_t *packet = kdr_bench_packet_at(rays, width, sheet, first);
        memset(packet, 0, count * sizeof *packet);
        for (uint32_t lane = 0; lane < width && first + lane < end; lane++) {
            uint32_t words[RAY_WORDS];
            memcpy(words, &rays->rays[first + lane], sizeof words);
            for (uint32_t word = 0; word < RAY_WORDS; word++)
                packet[word * width + lane] = words[word];
            if (!rays->any)
                packet[GEOMETRY_WORD * width + lane] = packet[INSTANCE_WORD * width + lane] = KDR_INVALID_ID;
        }
    }
}

uint64_t kdr_bench_packets_count(const kdr_bench_rays *rays, uint32_t width, size_t begin, size_t end,
                                 const kdr_bench_sheet *sheet) {
    uint64_t hits = 0;
    for (size_t i = begin; i < end; i++) {
        const uint32_t *packet = kdr_bench_packet_at(rays, width, sheet, i);
        uint32_t lane = (uint32_t)(i % width);
        float far;
        memcpy(&far, &packet[FAR_WORD * width + lane], sizeof far);
        hits += rays->any ? far < 0 : packet[GEOMETRY_WORD * width + lane] != KDR_INVALID_ID;
    }
    return hits;
}
