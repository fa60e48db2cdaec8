#include "base/task.h"

void kdr_crew_run(const kdr_crew *crew, kdr_task_fn *fn, void *context, uint32_t count) {
    // Alone: no backend is bothered.
    if (crew->worker_count <= 1 || count <= 1 || !crew->backend.start) {
        for (uint32_t i = 0; i < count; i++)
            fn(context, i);
        return;
    }
    void *handle = crew->backend.start(fn, context, count, crew->backend.user);
    if (handle)
        crew->backend.wait(handle, crew->backend.user);
}
