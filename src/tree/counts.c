#include "tree/counts.h"

#ifdef KDR_COUNTING
_Thread_local kdr_trace_counts kdr_thread_counts;
#endif
