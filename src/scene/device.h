/* The device: workers, memory, log, and the tables of functions for its instruction set. */
#ifndef KDR_SCENE_DEVICE_H
#define KDR_SCENE_DEVICE_H

#include "base/alloc.h"
#include "base/task.h"
#include "build/builder.h"
#include "trace/trace.h"

struct kdr_device {
    kdr_alloc alloc;
    kdr_isa isa;
    kdr_crew crew;
    kdr_thread_pool *threads; /* NULL: the host's */
    kdr_bulk bulk;            /* large memory that is used again */
    kdr_workshop *workshop;
    const kdr_traversals *traversals;
    _Atomic uint64_t scene_count; /* ever created */
    kdr_log_fn *log;
    void *log_user;
};

/* Tells the log and returns the status, so that a failure is one line: return kdr_device_fail(...). device may be NULL.
 */
__attribute__((format(printf, 3, 4))) kdr_status kdr_device_fail(const kdr_device *device, kdr_status status,
                                                                 const char *format, ...);

#endif
