/* How far a build is. Finished tasks count by their budgets, which add up to the root's. */
#include "build/work.h"

#define STEPS 256 /* a worker tells after such a part of the root's budget */

void kdr_build_report(kdr_build_state *state, double part) {
    if (!kdr_listener_tell(state->input->listener, part))
        kdr_build_fail(state, KDR_ERROR_CANCELLED);
}

void kdr_build_report_opening(kdr_build_state *state) {
    double done = (double)atomic_load_explicit(&state->done, memory_order_relaxed) / (double)(state->budget + 1);
    kdr_build_report(state, KDR_BUILD_GATHERED + (KDR_BUILD_OPENED - KDR_BUILD_GATHERED) * done);
}

void kdr_build_finished(kdr_build_state *state, kdr_build_worker *worker, const kdr_build_task *task) {
    if (!state->input->listener)
        return;
    worker->done += task->budget;
    if (worker->done < state->budget / STEPS + 1)
        return;
    atomic_fetch_add_explicit(&state->done, worker->done, memory_order_relaxed);
    worker->done = 0;
    kdr_build_report_opening(state);
}
