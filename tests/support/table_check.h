/* One instruction set's traversals held against the scalar stack traversal, on a soup of triangles and on rays of every
 * kind that traversals treat apart. No test library: it also runs on machines that have none. */
#ifndef KDR_TESTS_SUPPORT_TABLE_CHECK_H
#define KDR_TESTS_SUPPORT_TABLE_CHECK_H

#include "kdray/kdray.h"

#include <stddef.h>

typedef struct table_check {
    size_t builds;      /* how many trees were asked */
    size_t rays, hits;  /* in all */
    size_t differences; /* rays with an answer other than the scalar stack's */
    size_t unsound;     /* trees that failed, or lack the wide nodes that the table wants, or have no long leaf */
} table_check;

/* Builds on a device of this instruction set. A machine without it, or without memory, makes no tree. */
table_check table_check_run(kdr_isa isa, size_t triangles, uint32_t rays);

#endif
