/* The bounded pool of tasks inside a crew run.
 *
 * Order: first the tasks given at the start, one after the other, so that every worker begins with a large one of its
 * own; then what was offered, the newest first, whose data is still in some cache. Since whoever makes two tasks keeps
 * one, the pool sees only what is meant for others, and a few entries feed many workers.
 *
 * Source: M. Shevtsov, A. Soupikov, A. Kapustin, "Highly Parallel Fast KD-tree Construction for Interactive Ray Tracing
 * of Dynamic Scenes", 2007, section 4.1: 256 entries, and work done on the spot when they are taken.
 *
 * Invariants: `outstanding` counts the tasks that wait or run; only a running task can offer, so once it is 0 it stays
 * 0 and everybody leaves. A worker leaves or sleeps only when nothing waits, hence one worker alone never sleeps, and a
 * backend that makes its calls one after another is served by the first call. Cost: a lock held for one copy a task. */
#include "base/check.h"
#include "base/spin.h"
#include "base/task.h"

#include <pthread.h>
#include <string.h>

typedef struct pool_task {
    _Alignas(64) char bytes[KDR_TASK_BYTES];
} pool_task;

struct kdr_pool {
    kdr_pool_fn *run;
    void *context;
    uint32_t spin_rounds;

    _Alignas(64) pthread_mutex_t mutex;
    pthread_cond_t changed; /* sleepers wait for a task or for the end */
    const char *given;      /* tasks of the start that nobody took yet */
    size_t given_count;
    uint32_t sleeping;

    /* written under the lock, read without it as hints */
    _Alignas(64) _Atomic uint32_t offered_count;
    _Atomic bool work_waits; /* given_count + offered_count > 0 */
    _Atomic uint32_t idle;   /* workers that look for a task */

    _Alignas(64) _Atomic size_t outstanding;

    pool_task offered[KDR_POOL_CAPACITY];
};

bool kdr_pool_offer(kdr_pool *pool, const void *task) {
    if (atomic_load_explicit(&pool->offered_count, memory_order_relaxed) == KDR_POOL_CAPACITY)
        return false;
    pthread_mutex_lock(&pool->mutex);
    uint32_t count = atomic_load_explicit(&pool->offered_count, memory_order_relaxed);
    bool taken = count < KDR_POOL_CAPACITY;
    if (taken) {
        atomic_fetch_add_explicit(&pool->outstanding, 1, memory_order_relaxed);
        memcpy(&pool->offered[count], task, KDR_TASK_BYTES);
        atomic_store_explicit(&pool->offered_count, count + 1, memory_order_relaxed);
        atomic_store_explicit(&pool->work_waits, true, memory_order_relaxed);
        if (pool->sleeping > 0)
            pthread_cond_signal(&pool->changed);
    }
    pthread_mutex_unlock(&pool->mutex);
    return taken;
}

bool kdr_pool_hungry(const kdr_pool *pool) {
    return atomic_load_explicit(&pool->idle, memory_order_relaxed) >
           atomic_load_explicit(&pool->offered_count, memory_order_relaxed);
}

/* Under the lock. */
static bool take_waiting(kdr_pool *pool, pool_task *task) {
    uint32_t count = atomic_load_explicit(&pool->offered_count, memory_order_relaxed);
    if (pool->given_count > 0) {
        memcpy(task, pool->given, KDR_TASK_BYTES);
        pool->given += KDR_TASK_BYTES;
        pool->given_count--;
    } else if (count > 0) {
        count--;
        memcpy(task, &pool->offered[count], KDR_TASK_BYTES);
        atomic_store_explicit(&pool->offered_count, count, memory_order_relaxed);
    } else {
        return false;
    }
    atomic_store_explicit(&pool->work_waits, pool->given_count > 0 || count > 0, memory_order_relaxed);
    return true;
}

static bool all_done(const kdr_pool *pool) {
    return atomic_load_explicit(&pool->outstanding, memory_order_acquire) == 0;
}

static bool try_take(kdr_pool *pool, pool_task *task) {
    pthread_mutex_lock(&pool->mutex);
    bool taken = take_waiting(pool, task);
    pthread_mutex_unlock(&pool->mutex);
    return taken;
}

static bool sleep_and_take(kdr_pool *pool, pool_task *task) {
    pthread_mutex_lock(&pool->mutex);
    pool->sleeping++;
    bool taken;
    while (!(taken = take_waiting(pool, task)) && !all_done(pool))
        pthread_cond_wait(&pool->changed, &pool->mutex);
    pool->sleeping--;
    pthread_mutex_unlock(&pool->mutex);
    return taken;
}

/* Spins, then sleeps, until there is a task or there will be none. */
static bool wait_and_take(kdr_pool *pool, pool_task *task) {
    atomic_fetch_add_explicit(&pool->idle, 1, memory_order_relaxed);
    bool taken = false;
    for (uint32_t round = 0; round < pool->spin_rounds && !taken && !all_done(pool); round++) {
        if (atomic_load_explicit(&pool->work_waits, memory_order_relaxed))
            taken = try_take(pool, task);
        else
            kdr_spin_pause();
    }
    if (!taken && !all_done(pool))
        taken = sleep_and_take(pool, task);
    atomic_fetch_sub_explicit(&pool->idle, 1, memory_order_relaxed);
    return taken;
}

static void finish_one(kdr_pool *pool) {
    if (atomic_fetch_sub_explicit(&pool->outstanding, 1, memory_order_acq_rel) == 1) {
        pthread_mutex_lock(&pool->mutex);
        pthread_cond_broadcast(&pool->changed);
        pthread_mutex_unlock(&pool->mutex);
    }
}

static void work(void *argument, uint32_t worker) {
    kdr_pool *pool = argument;
    pool_task task;
    while (try_take(pool, &task) || wait_and_take(pool, &task)) {
        pool->run(pool, &task, worker, pool->context);
        finish_one(pool);
    }
}

size_t kdr_pool_bytes(void) { return sizeof(kdr_pool); }

void kdr_pool_run_in(void *room, const kdr_crew *crew, const void *tasks, size_t count, kdr_pool_fn *run,
                     void *context) {
    if (count == 0)
        return;
    kdr_pool *pool = room;
    pool->run = run;
    pool->context = context;
    pool->spin_rounds = kdr_spin_rounds(crew->worker_count);
    pthread_mutex_init(&pool->mutex, NULL);
    pthread_cond_init(&pool->changed, NULL);
    pool->given = tasks;
    pool->given_count = count;
    pool->sleeping = 0;
    atomic_init(&pool->offered_count, 0);
    atomic_init(&pool->work_waits, true);
    atomic_init(&pool->idle, 0);
    atomic_init(&pool->outstanding, count);

    kdr_crew_run(crew, work, pool, crew->worker_count > 0 ? crew->worker_count : 1);

    KDR_CHECK(all_done(pool));
    pthread_mutex_destroy(&pool->mutex);
    pthread_cond_destroy(&pool->changed);
}

kdr_status kdr_pool_run(const kdr_crew *crew, kdr_alloc *alloc, const void *tasks, size_t count, kdr_pool_fn *run,
                        void *context) {
    if (count == 0)
        return KDR_OK;
    void *room = kdr_alloc_get(alloc, kdr_pool_bytes(), KDR_POOL_ALIGNMENT);
    if (!room)
        return KDR_ERROR_OUT_OF_MEMORY;
    kdr_pool_run_in(room, crew, tasks, count, run, context);
    kdr_alloc_release(alloc, room, kdr_pool_bytes());
    return KDR_OK;
}
