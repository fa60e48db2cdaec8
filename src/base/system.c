#include "base/system.h"

#include "base/check.h"

#include <sched.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#define HUGE_PAGE ((size_t)2 << 20)

/* Sets of 1024 processors each: the kernel refuses a mask smaller than the one it was built for. */
#define CPU_SETS 16

static size_t whole_pages(size_t size) {
    size_t page = (size_t)sysconf(_SC_PAGESIZE);
    return (size + page - 1) / page * page;
}

static void *map_pages(size_t size) {
    void *memory = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    return memory == MAP_FAILED ? NULL : memory;
}

void *kdr_system_map(size_t size) {
    if (size > SIZE_MAX / 2)
        return NULL;
    size = whole_pages(size);
    if (size < HUGE_PAGE)
        return map_pages(size);

    // Huge pages begin at their own multiples only: map too much, and give back what sticks out on both sides.
    char *start = map_pages(size + HUGE_PAGE);
    if (!start)
        return map_pages(size);
    size_t head = (HUGE_PAGE - (uintptr_t)start % HUGE_PAGE) % HUGE_PAGE;
    if (head > 0)
        munmap(start, head);
    munmap(start + head + size, HUGE_PAGE - head);

    // Advice only: without huge pages everything still works.
    madvise(start + head, size, MADV_HUGEPAGE);
    return start + head;
}

void kdr_system_unmap(void *memory, size_t size) {
    int failed = munmap(memory, whole_pages(size));
    KDR_CHECK(!failed);
}

uint32_t kdr_system_cpu_count(void) {
    cpu_set_t sets[CPU_SETS];
    if (sched_getaffinity(0, sizeof(sets), sets) == 0) {
        int count = CPU_COUNT_S(sizeof(sets), sets);
        if (count > 0)
            return (uint32_t)count;
    }
    long online = sysconf(_SC_NPROCESSORS_ONLN);
    return online > 0 ? (uint32_t)online : 1;
}

uint64_t kdr_system_nanoseconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}
