/* A task backend on OpenMP: kdray's work on the threads that the host's own parallel regions run on.
 *
 *   def.worker_count = 8;
 *   def.tasks = kdr_openmp_backend(8);
 *
 * In a library of its own, kdray-openmp, so that libkdray needs no OpenMP runtime. */
#ifndef KDRAY_OPENMP_H
#define KDRAY_OPENMP_H

#include "kdray/kdray.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A backend whose starts run in one parallel region of at most worker_count threads; 0: as many as OpenMP would take by
 * itself (OMP_NUM_THREADS). Calls are handed to threads as these become free. Inside another parallel region OpenMP may
 * give one thread only: all calls are still made, one after another.
 * Holds no memory: the struct may be copied and forgotten. Thread safe. */
KDR_API kdr_task_backend kdr_openmp_backend(uint32_t worker_count);

#ifdef __cplusplus
}
#endif

#endif
