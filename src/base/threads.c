/* The built-in backend: threads that sleep between starts and race for the calls of a start.
 *
 * All that a start publishes hangs on one word, the cursor: the number of the start in its upper half, the next call in
 * its lower half. A worker takes a call by moving the cursor on with compare-exchange. That succeeds only while the
 * start it read the function from is still the one in force, so a worker that wakes late can take nothing stale, and
 * nobody waits for a worker that never woke: the wait ends when every call was made, whoever made it.
 *
 * Invariant: between starts the cursor is closed (its lower half is CLOSED), and only then are function, context and
 * count written. Cost: a compare-exchange and an add a call; one lock a start. */
#include "base/spin.h"
#include "base/task.h"

#include <pthread.h>
#include <signal.h>

#define CLOSED UINT32_MAX

struct kdr_thread_pool {
    kdr_alloc *alloc;
    size_t size; /* bytes of this block */
    uint32_t thread_count;
    uint32_t spin_rounds;

    /* the start in force */
    _Alignas(64) _Atomic uint64_t cursor;
    _Atomic(kdr_task_fn *) task;
    _Atomic(void *) context;
    _Atomic uint32_t count;
    _Alignas(64) _Atomic uint32_t done; /* calls that have returned */

    /* sleep */
    _Alignas(64) pthread_mutex_t mutex;
    pthread_cond_t started;  /* workers wait for the next start */
    pthread_cond_t finished; /* the starter waits for the last call */
    uint32_t sleeping;
    bool stop;

    pthread_t threads[];
};

static uint32_t start_of(uint64_t cursor) { return (uint32_t)(cursor >> 32); }
static uint64_t cursor_at(uint32_t start, uint32_t index) { return (uint64_t)start << 32 | index; }

/* Makes calls until none is left; returns the number of the start that was found empty. */
static uint32_t make_calls(kdr_thread_pool *pool) {
    uint64_t cursor = atomic_load_explicit(&pool->cursor, memory_order_acquire);
    for (;;) {
        // These may already belong to a later start. Then the cursor was closed before they were written, and the
        // exchange fails.
        kdr_task_fn *task = atomic_load_explicit(&pool->task, memory_order_acquire);
        void *context = atomic_load_explicit(&pool->context, memory_order_acquire);
        uint32_t count = atomic_load_explicit(&pool->count, memory_order_acquire);
        uint32_t index = (uint32_t)cursor;
        if (index >= count || index == CLOSED)
            return start_of(cursor);
        if (!atomic_compare_exchange_weak_explicit(&pool->cursor, &cursor, cursor + 1, memory_order_acq_rel,
                                                   memory_order_acquire))
            continue;

        task(context, index);

        if (atomic_fetch_add_explicit(&pool->done, 1, memory_order_acq_rel) + 1 == count) {
            pthread_mutex_lock(&pool->mutex);
            pthread_cond_signal(&pool->finished);
            pthread_mutex_unlock(&pool->mutex);
        }
        cursor = atomic_load_explicit(&pool->cursor, memory_order_acquire);
    }
}

/* Returns when there is a start other than `seen`; false when the pool ends. */
static bool wait_for_start(kdr_thread_pool *pool, uint32_t seen) {
    for (uint32_t round = 0; round < pool->spin_rounds; round++) {
        if (start_of(atomic_load_explicit(&pool->cursor, memory_order_acquire)) != seen)
            return true;
        kdr_spin_pause();
    }
    pthread_mutex_lock(&pool->mutex);
    pool->sleeping++;
    while (!pool->stop && start_of(atomic_load_explicit(&pool->cursor, memory_order_acquire)) == seen)
        pthread_cond_wait(&pool->started, &pool->mutex);
    pool->sleeping--;
    bool go_on = !pool->stop;
    pthread_mutex_unlock(&pool->mutex);
    return go_on;
}

static void *thread_main(void *argument) {
    kdr_thread_pool *pool = argument;
    uint32_t seen = 0;
    while (wait_for_start(pool, seen))
        seen = make_calls(pool);
    return NULL;
}

static void *threads_start(kdr_task_fn *task, void *context, uint32_t count, void *user) {
    kdr_thread_pool *pool = user;
    if (count == 0)
        return NULL;
    uint32_t start = start_of(atomic_load_explicit(&pool->cursor, memory_order_relaxed)) + 1;
    atomic_store_explicit(&pool->task, task, memory_order_release);
    atomic_store_explicit(&pool->context, context, memory_order_release);
    atomic_store_explicit(&pool->count, count, memory_order_release);
    atomic_store_explicit(&pool->done, 0, memory_order_relaxed);

    // Publish under the lock: a worker on its way to sleep either sees the start or is counted as sleeping.
    pthread_mutex_lock(&pool->mutex);
    atomic_store_explicit(&pool->cursor, cursor_at(start, 0), memory_order_release);
    uint32_t helpers = count - 1 < pool->sleeping ? count - 1 : pool->sleeping;
    for (uint32_t i = 0; i < helpers; i++)
        pthread_cond_signal(&pool->started);
    pthread_mutex_unlock(&pool->mutex);
    return pool;
}

static void threads_wait(void *handle, void *user) {
    kdr_thread_pool *pool = handle;
    (void)user;
    uint32_t start = make_calls(pool);
    uint32_t count = atomic_load_explicit(&pool->count, memory_order_relaxed);

    // Calls of others are still running: they rarely take much longer than our own last one.
    for (uint32_t round = 0; round < pool->spin_rounds; round++) {
        if (atomic_load_explicit(&pool->done, memory_order_acquire) == count)
            break;
        kdr_spin_pause();
    }
    if (atomic_load_explicit(&pool->done, memory_order_acquire) != count) {
        pthread_mutex_lock(&pool->mutex);
        while (atomic_load_explicit(&pool->done, memory_order_acquire) != count)
            pthread_cond_wait(&pool->finished, &pool->mutex);
        pthread_mutex_unlock(&pool->mutex);
    }
    atomic_store_explicit(&pool->cursor, cursor_at(start, CLOSED), memory_order_release);
}

static void stop_threads(kdr_thread_pool *pool) {
    pthread_mutex_lock(&pool->mutex);
    pool->stop = true;
    pthread_cond_broadcast(&pool->started);
    pthread_mutex_unlock(&pool->mutex);
    for (uint32_t i = 0; i < pool->thread_count; i++)
        pthread_join(pool->threads[i], NULL);
}

/* As many of `wanted` threads as the system gives. They take no signals: these stay with the host's own threads. */
static void make_threads(kdr_thread_pool *pool, uint32_t wanted) {
    sigset_t all, before;
    sigfillset(&all);
    bool masked = pthread_sigmask(SIG_SETMASK, &all, &before) == 0;
    while (pool->thread_count < wanted &&
           pthread_create(&pool->threads[pool->thread_count], NULL, thread_main, pool) == 0)
        pool->thread_count++;
    if (masked)
        pthread_sigmask(SIG_SETMASK, &before, NULL);
}

kdr_thread_pool *kdr_thread_pool_create(kdr_alloc *alloc, uint32_t worker_count) {
    uint32_t wanted = worker_count > 0 ? worker_count - 1 : 0;
    size_t size = sizeof(kdr_thread_pool) + wanted * sizeof(pthread_t);
    kdr_thread_pool *pool = kdr_alloc_get(alloc, size, _Alignof(kdr_thread_pool));
    if (!pool)
        return NULL;
    *pool = (kdr_thread_pool){
        .alloc = alloc,
        .size = size,
        .spin_rounds = kdr_spin_rounds(worker_count),
        .cursor = cursor_at(0, CLOSED),
        .mutex = PTHREAD_MUTEX_INITIALIZER,
        .started = PTHREAD_COND_INITIALIZER,
        .finished = PTHREAD_COND_INITIALIZER,
    };

    // Fewer threads than wanted are slower, never wrong; none at all is a failure.
    make_threads(pool, wanted);
    if (wanted > 0 && pool->thread_count == 0) {
        kdr_thread_pool_destroy(pool);
        return NULL;
    }
    return pool;
}

void kdr_thread_pool_destroy(kdr_thread_pool *pool) {
    if (!pool)
        return;
    stop_threads(pool);
    pthread_mutex_destroy(&pool->mutex);
    pthread_cond_destroy(&pool->started);
    pthread_cond_destroy(&pool->finished);
    kdr_alloc_release(pool->alloc, pool, pool->size);
}

kdr_task_backend kdr_thread_pool_backend(kdr_thread_pool *pool) {
    return (kdr_task_backend){threads_start, threads_wait, pool};
}
