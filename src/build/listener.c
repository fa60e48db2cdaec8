#include "build/listener.h"

#define UNITS 1000 /* a whole commit */

bool kdr_listener_tell(kdr_listener *listener, double part) {
    if (!listener)
        return true;
    double done = listener->begin + listener->share * (part < 1 ? part : 1);
    if (atomic_flag_test_and_set_explicit(&listener->busy, memory_order_acquire))
        return !atomic_load(&listener->cancelled);
    uint64_t units = done < 1 ? (uint64_t)(UNITS * done) : UNITS;
    if (units > listener->told)
        listener->told = units;
    if (!atomic_load(&listener->cancelled) && !listener->tell(listener->told, UNITS, listener->user))
        atomic_store(&listener->cancelled, true);
    atomic_flag_clear_explicit(&listener->busy, memory_order_release);
    return !atomic_load(&listener->cancelled);
}

bool kdr_listener_end(kdr_listener *listener) {
    if (!listener)
        return true;
    listener->begin = 1;
    listener->share = 0;
    return kdr_listener_tell(listener, 1);
}
