#include "scene/device.h"

#include "base/cpu.h"

#include <stdarg.h>
#include <stdio.h>

kdr_device_def kdr_default_device_def(void) {
    return (kdr_device_def){.size = sizeof(kdr_device_def),
                            .isa_limit = sizeof(void *) == 8 ? KDR_ISA_NEON : KDR_ISA_SCALAR};
}

kdr_status kdr_device_fail(const kdr_device *device, kdr_status status, const char *format, ...) {
    if (!device || !device->log)
        return status;
    char message[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    device->log(KDR_LOG_ERROR, message, device->log_user);
    return status;
}

/* A sentence about what is wrong with a def, or NULL. */
static const char *def_problem(const kdr_device_def *def) {
    if (def->size != sizeof(kdr_device_def))
        return "the device def was not made by kdr_default_device_def";
    if (!def->tasks.start != !def->tasks.wait)
        return "a task backend needs both start and wait";
    if (!def->allocator.allocate != !def->allocator.release)
        return "an allocator needs both allocate and release";
    if (def->worker_count > KDR_MAX_WORKERS)
        return "worker_count is over 256";
    return NULL;
}

kdr_status kdr_device_create(const kdr_device_def *given, kdr_device **out) {
    if (!out)
        return KDR_ERROR_INVALID_ARGUMENT;
    *out = NULL;
    kdr_device_def def = given ? *given : kdr_default_device_def();

    /* A device to complain through, before there is one. */
    kdr_device early = {0};
    if (def.size == sizeof def) {
        early.log = def.log;
        early.log_user = def.log_user;
    }
    const char *problem = def_problem(&def);
    if (problem)
        return kdr_device_fail(&early, KDR_ERROR_INVALID_ARGUMENT, "%s", problem);
    kdr_isa isa;
    if (!kdr_cpu_choose_isa(def.isa_limit, &isa))
        return kdr_device_fail(&early, KDR_ERROR_UNSUPPORTED,
                               "the environment variable KDR_ISA names no instruction set of this machine");

    kdr_alloc alloc;
    kdr_alloc_init(&alloc, &def.allocator);
    kdr_device *device = kdr_alloc_get(&alloc, sizeof *device, 64);
    if (!device)
        return kdr_device_fail(&early, KDR_ERROR_OUT_OF_MEMORY, "out of memory for a device");
    *device = (kdr_device){.isa = isa, .traversals = kdr_traversals_for(isa), .log = def.log, .log_user = def.log_user};
    kdr_alloc_init(&device->alloc, &def.allocator);
    device->alloc.bytes = device->alloc.peak_bytes = sizeof *device;
    kdr_bulk_init(&device->bulk, &device->alloc);
    device->crew.worker_count = def.worker_count > 0 ? def.worker_count : kdr_cpu_count();
    device->crew.backend = def.tasks;
    if (!def.tasks.start && device->crew.worker_count > 1) {
        device->threads = kdr_thread_pool_create(&device->alloc, device->crew.worker_count);
        if (!device->threads) {
            kdr_device_destroy(device);
            return kdr_device_fail(&early, KDR_ERROR_OUT_OF_MEMORY, "no memory or no threads for the workers");
        }
        device->crew.backend = kdr_thread_pool_backend(device->threads);
    }
    device->workshop =
        kdr_workshop_create(&device->alloc, &device->bulk, device->crew.worker_count, KDR_NODE_MAX_INDEX);
    if (!device->workshop) {
        kdr_device_destroy(device);
        return kdr_device_fail(&early, KDR_ERROR_OUT_OF_MEMORY, "out of memory for the builder's tables");
    }
    *out = device;
    return KDR_OK;
}

void kdr_device_destroy(kdr_device *device) {
    if (!device)
        return;
    kdr_workshop_destroy(device->workshop);
    kdr_bulk_destroy(&device->bulk);
    if (device->threads)
        kdr_thread_pool_destroy(device->threads);
    kdr_alloc alloc;
    kdr_alloc_init(&alloc, &device->alloc.functions);
    alloc.bytes = sizeof *device;
    kdr_alloc_release(&alloc, device, sizeof *device);
}

kdr_isa kdr_device_isa(const kdr_device *device) { return device->isa; }

uint32_t kdr_device_worker_count(const kdr_device *device) { return device->crew.worker_count; }

size_t kdr_device_bytes(const kdr_device *device) {
    return atomic_load_explicit(&device->alloc.bytes, memory_order_relaxed);
}

size_t kdr_device_peak_bytes(const kdr_device *device) {
    return atomic_load_explicit(&device->alloc.peak_bytes, memory_order_relaxed);
}

void kdr_device_trim(kdr_device *device) {
    kdr_workshop_trim(device->workshop);
    kdr_bulk_trim(&device->bulk);
}

void kdr_device_run(kdr_device *device, kdr_task_fn *task, void *context, uint32_t count) {
    kdr_crew_run(&device->crew, task, context, count);
}
