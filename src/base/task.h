/* Work shared by workers: a crew runs a function on every worker at once; a pool hands tasks around inside it.
 *
 * A crew start asks the backend (the built-in threads, OpenMP or the host's) for worker_count concurrent calls and
 * waits for them: only the thread that commits ever waits. Inside, workers share a bounded pool of tasks (256 entries,
 * as in section 4.1 of the 2007 paper): who makes two tasks keeps one and offers the other, or does both when the pool
 * is full. Tasks never wait for tasks. Nothing depends on how many calls the backend really runs at once: with one
 * worker the same code is serial. */
#ifndef KDR_BASE_TASK_H
#define KDR_BASE_TASK_H

#include "kdray/kdray.h"
#include "base/alloc.h"

#define KDR_MAX_WORKERS 256
#define KDR_POOL_CAPACITY 256
#define KDR_TASK_BYTES 152

typedef struct kdr_crew {
    kdr_task_backend backend;
    uint32_t worker_count;
} kdr_crew;

/* Threads this process may run on (sched_getaffinity), at least 1, at most KDR_MAX_WORKERS. */
uint32_t kdr_cpu_count(void);

/* The built-in backend: worker_count - 1 threads that sleep between starts; the thread that waits is the last worker.
 * NULL when there is no memory or not a single thread can be made; with some of the threads it works, only slower.
 * Starts on one pool follow one another, each waited for before the next. Destroying NULL is allowed. */
typedef struct kdr_thread_pool kdr_thread_pool;
kdr_thread_pool *kdr_thread_pool_create(kdr_alloc *alloc, uint32_t worker_count);
void kdr_thread_pool_destroy(kdr_thread_pool *pool);
kdr_task_backend kdr_thread_pool_backend(kdr_thread_pool *pool);

/* fn(context, i) for i in [0, count), each exactly once, all done on return. count may exceed worker_count. */
void kdr_crew_run(const kdr_crew *crew, kdr_task_fn *fn, void *context, uint32_t count);

/* A bounded pool of tasks of KDR_TASK_BYTES bytes each, copied in and out.
 * A worker's run function gets the task, the worker's number and the pool, to offer more. */
typedef struct kdr_pool kdr_pool;
typedef void kdr_pool_fn(kdr_pool *pool, void *task, uint32_t worker, void *context);

/* Runs every task in `tasks` (count x KDR_TASK_BYTES bytes, of any alignment, copied as they are taken) and all that
 * they offer, on all workers; returns when none is left. `run` gets a copy of its own, aligned to 64 bytes. The order
 * is not defined; larger tasks should stand first. OUT_OF_MEMORY: nothing was run. */
kdr_status kdr_pool_run(const kdr_crew *crew, kdr_alloc *alloc, const void *tasks, size_t count, kdr_pool_fn *run,
                        void *context);

/* The same in room that the caller has: kdr_pool_bytes of it, aligned to KDR_POOL_ALIGNMENT. */
#define KDR_POOL_ALIGNMENT 64
size_t kdr_pool_bytes(void);
void kdr_pool_run_in(void *room, const kdr_crew *crew, const void *tasks, size_t count, kdr_pool_fn *run,
                     void *context);

/* Offers a task to the others. False when the pool is full: the caller then does the work. Never blocks for long:
 * the lock is held for a copy of KDR_TASK_BYTES. */
bool kdr_pool_offer(kdr_pool *pool, const void *task);

/* True when some worker is idle and an offer would be taken at once. A hint, read without a lock. */
bool kdr_pool_hungry(const kdr_pool *pool);

#endif
