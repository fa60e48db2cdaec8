/* Ways to ask one scene for the same rays: kdray by its default plan, and Embree by its watertight and its fast test.
 */
#ifndef KDR_TESTS_EMBREE_HIT_TRACERS_H
#define KDR_TESTS_EMBREE_HIT_TRACERS_H

#include "apps/kdray/bench.h"

#define HIT_TRACERS 7
#define HIT_TRACERS_OF_KDRAY 3 /* the first ones: what they say is exact, to the bit */

/* "kdray/single", "kdray/packet" (of 16), "kdray/stream", "embree/robust/packet", ... */
const char *hit_tracer_name(int tracer);

/* What a tracer says of a ray. Of any hit only `hit` counts. */
typedef struct hit_answer {
    bool hit;
    float t;
    uint32_t triangle;
} hit_answer;

typedef struct hit_tracers hit_tracers;

/* Builds kdray's tree on the device by its default plan, and Embree's two at medium quality. NULL, after a sentence to
 * stderr, if anything fails. The mesh outlives them. */
hit_tracers *hit_tracers_open(kdr_device *device, const kdr_mesh *mesh);
void hit_tracers_close(hit_tracers *tracers);

const kdr_scene *hit_tracers_scene(const hit_tracers *tracers);

/* Fills in an answer for each of rays [begin, end), at most KDR_BENCH_BLOCK. Any number of threads at once. */
void hit_tracers_ask(const hit_tracers *tracers, int tracer, const kdr_bench_rays *rays, size_t begin, size_t end,
                     hit_answer *answers);

#endif
