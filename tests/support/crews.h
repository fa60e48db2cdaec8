/* Every kind of crew that kdray must be right with: one worker, few, more than processors, and hosts that make their
 * calls one after another, at the start or only when waited for, and backwards. */
#ifndef KDR_TESTS_SUPPORT_CREWS_H
#define KDR_TESTS_SUPPORT_CREWS_H

#include "base/task.h"

#define TEST_CREW_COUNT 5

typedef struct test_crew {
    kdr_crew crew;
    const char *name;
    kdr_alloc alloc;          /* of the threads */
    kdr_thread_pool *threads; /* NULL for hosts */

    /* what a start leaves for wait */
    kdr_task_fn *task;
    void *context;
    uint32_t count;
} test_crew;

/* number in [0, TEST_CREW_COUNT): the built-in threads with 1, 2 and 7 workers; a host that makes all calls in start;
 * a host that makes them in wait, the last one first. Fails the running test when there are no threads.
 * The struct must stay where it is until it is closed. */
void test_crew_open(test_crew *crew, int number);
void test_crew_close(test_crew *crew);

#endif
