/* Who asks which of a scene's two commits, so that the next commit knows when it may have the older one's memory.
 *
 * A scene shows one of two places and fills the other. Who asks counts himself in at the place that is shown, looks
 * again whether it still is, and counts himself out when he is done; a commit empties the other place once nobody is
 * counted there. Source: P. Ramalhete, A. Correia, "Brief Announcement: Left-Right - A Concurrency Control Technique
 * with Wait-Free Population Oblivious Reads", 2015, with one array of data in place of two: a place that is left is
 * filled from scratch.
 * Invariant: additions, looks and showing are sequentially consistent, so either the commit sees who has come, or he
 * sees that the place is no longer shown and goes to the other. Nobody who asks waits; he tries again only if a commit
 * ended between his two looks. Cost: two atomic additions a call; counters are strewn over cache lines by thread. */
#ifndef KDR_SCENE_READERS_H
#define KDR_SCENE_READERS_H

#include <stdatomic.h>
#include <stdint.h>

#define KDR_READER_STRIPES 16

typedef struct kdr_reader_count {
    _Alignas(64) _Atomic uint32_t in;
} kdr_reader_count;

typedef struct kdr_readers {
    kdr_reader_count of[2][KDR_READER_STRIPES]; /* of each place */
} kdr_readers;

/* The calling thread's stripe. */
uint32_t kdr_reader_stripe(void);

/* Returns when nobody is counted at a place any more. Nobody new may be sent there. */
void kdr_readers_wait(kdr_readers *readers, uint32_t place);

#endif
