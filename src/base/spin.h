/* Waiting a moment without giving up the processor: work that follows at once is then picked up at once. */
#ifndef KDR_BASE_SPIN_H
#define KDR_BASE_SPIN_H

#include "base/task.h"

#include <stdint.h>

/* About 70 microseconds at 18 ns a pause: what it costs to put a thread to sleep and wake it again. */
#define KDR_SPIN_ROUNDS 4000

/* Turns worth waiting for `worker_count` workers: none when there are not processors for all of them. */
static inline uint32_t kdr_spin_rounds(uint32_t worker_count) {
    return worker_count <= kdr_cpu_count() ? KDR_SPIN_ROUNDS : 0;
}

static inline void kdr_spin_pause(void) {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    __asm__ __volatile__("yield");
#endif
}

#endif
