/* One scene committed on every instruction set of this machine, with one worker and two, and with build constants from
 * plain to absurd: every tree must be sound, equal wherever its build def is, and answer as the oracle does.
 * All memory comes through a counting allocator and must be back in the end. */
#ifndef KDR_TESTS_SUPPORT_EVERYWHERE_H
#define KDR_TESTS_SUPPORT_EVERYWHERE_H

#include "support/query_sheet.h"

typedef struct build_case {
    const char *name;
    kdr_build_def def;
} build_case;

#define BUILD_CASE_COUNT 9

/* The cases; [0] is the default def. */
const build_case *build_cases(void);

/* Devices of the instruction set `isa` only; NULL if this machine has no such. functions may be NULL. */
kdr_device *device_of_isa(kdr_isa isa, uint32_t worker_count, const kdr_allocator *functions);

/* Fails the running test on the first scene with a wrong answer. Only the first `case_count` cases are built. */
void hold_everywhere(const kdr_triangles_def *geometries, uint32_t geometry_count, const query_sheet *sheet,
                     size_t case_count, const char *label);

/* Makes the oracle's answers to `ray_count` awkward rays and holds the library to them everywhere. */
void hold_awkward_rays_everywhere(const kdr_triangles_def *geometries, uint32_t geometry_count, uint64_t sequence,
                                  size_t ray_count, size_t case_count, const char *label);

/* A committed scene of these geometries. Fails the running test if anything does. */
kdr_scene *committed_scene(kdr_device *device, const kdr_triangles_def *geometries, uint32_t geometry_count,
                           const kdr_build_def *def);

#endif
