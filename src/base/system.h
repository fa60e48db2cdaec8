/* What is asked of the operating system beyond ISO C: memory in whole pages, processors and a clock.
 * Threads are the one other need; they are POSIX's own. */
#ifndef KDR_BASE_SYSTEM_H
#define KDR_BASE_SYSTEM_H

#include <stddef.h>
#include <stdint.h>

/* Fresh zero pages, aligned to at least 4096, that cost nothing until they are touched; huge pages are asked for.
 * NULL when there is no address space. Thread safe, as is unmap. */
void *kdr_system_map(size_t size);
void kdr_system_unmap(void *memory, size_t size);

/* Processors that the calling thread may run on; at least 1. */
uint32_t kdr_system_cpu_count(void);

/* Nanoseconds of a clock that never goes back. */
uint64_t kdr_system_nanoseconds(void);

#endif
