/* A start is one parallel region that is over when it returns, so there is never anything to wait for and nothing to
 * keep: the number of threads travels in the user pointer itself. */
#include "kdray/openmp.h"

#include <omp.h>

#define MOST_THREADS 256 /* as for devices */

static void *openmp_start(kdr_task_fn *task, void *context, uint32_t count, void *user) {
    uint32_t threads = (uint32_t)(uintptr_t)user;
    if (threads == 0)
        threads = (uint32_t)omp_get_max_threads();
    if (threads > MOST_THREADS)
        threads = MOST_THREADS;
    if (threads > count)
        threads = count > 0 ? count : 1;
#pragma omp parallel for num_threads((int)threads) schedule(dynamic, 1)
    for (uint32_t i = 0; i < count; i++)
        task(context, i);
    return NULL;
}

static void openmp_wait(void *handle, void *user) {
    (void)handle;
    (void)user;
}

kdr_task_backend kdr_openmp_backend(uint32_t worker_count) {
    return (kdr_task_backend){openmp_start, openmp_wait, (void *)(uintptr_t)worker_count};
}
