/* Memory of the program itself: checked here once, so that no caller has to. */
#ifndef KDR_APPS_KDRAY_MEMORY_H
#define KDR_APPS_KDRAY_MEMORY_H

#include <stddef.h>

/* count * size bytes aligned to 64; contents undefined; never NULL. When there is no memory, or the product does not
 * fit, a sentence goes to stderr and the program ends with status 1. Release: kdr_memory_release. */
void *kdr_memory_get(size_t count, size_t size);

/* NULL is allowed. */
void kdr_memory_release(void *memory);

#endif
