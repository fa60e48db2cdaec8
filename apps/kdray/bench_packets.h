/* A benchmark's rays as packets of `width` rays: structures of arrays, in the order of fields that kdray and Embree
 * share. A width of 1 gives lone rays. Ranges begin at a multiple of KDR_BENCH_BLOCK. */
#ifndef KDR_APPS_KDRAY_BENCH_PACKETS_H
#define KDR_APPS_KDRAY_BENCH_PACKETS_H

#include "bench.h"

/* The packet that ray `ray` is in. */
void *kdr_bench_packet_at(const kdr_bench_rays *rays, uint32_t width, const kdr_bench_sheet *sheet, size_t ray);

/* Lays out rays that have hit nothing. Lanes behind the last ray are all zero. */
void kdr_bench_packets_fill(const kdr_bench_rays *rays, uint32_t width, size_t begin, size_t end,
                            kdr_bench_sheet *sheet);

/* Rays that hit something: any hit is told by a distance of minus infinity, the closest by its geometry. */
uint64_t kdr_bench_packets_count(const kdr_bench_rays *rays, uint32_t width, size_t begin, size_t end,
                                 const kdr_bench_sheet *sheet);

#endif
