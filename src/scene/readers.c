#include "scene/readers.h"

#include "base/spin.h"

#include <sched.h>

uint32_t kdr_reader_stripe(void) {
    static _Thread_local char own; /* its address tells threads apart */
    return (uint32_t)(((uint64_t)(uintptr_t)&own * 0x9e3779b97f4a7c15u) >> 60);
}

_Static_assert(KDR_READER_STRIPES == 16, "a stripe is four bits of a hash");

void kdr_readers_wait(kdr_readers *readers, uint32_t place) {
    for (uint32_t stripe = 0; stripe < KDR_READER_STRIPES; stripe++) {
        uint32_t rounds = 0;
        while (atomic_load(&readers->of[place][stripe].in) > 0) {
            if (rounds++ < KDR_SPIN_ROUNDS)
                kdr_spin_pause();
            else
                sched_yield();
        }
    }
}
