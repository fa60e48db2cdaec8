/* Counting what queries do, for a build with KDR_COUNTING; in any other the words below are nothing. */
#ifndef KDR_TREE_COUNTS_H
#define KDR_TREE_COUNTS_H

#include "kdray/counts.h"

#ifdef KDR_COUNTING
extern _Thread_local kdr_trace_counts kdr_thread_counts;
#define KDR_COUNT(field, number) (kdr_thread_counts.field += (number))
#define KDR_COUNT_WIDTH(lanes) (kdr_thread_counts.width = (lanes))
#else
#define KDR_COUNT(field, number) ((void)0)
#define KDR_COUNT_WIDTH(lanes) ((void)0)
#endif

#endif
