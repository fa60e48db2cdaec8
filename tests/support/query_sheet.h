/* Rays with the oracle's answers, and a scene of the library held against them.
 *
 * Distances, geometries and primitives must be equal; u and v lie within QUERY_WEIGHT_SLACK of the exact values, plus
 * what plain doubles may be wrong by, and the normal within rounding of (b - a) x (c - a). What differs is printed with
 * %a, so that it can be asked again. */
#ifndef KDR_TESTS_SUPPORT_QUERY_SHEET_H
#define KDR_TESTS_SUPPORT_QUERY_SHEET_H

#include "support/oracle_tree.h"

#define QUERY_WEIGHT_SLACK 1e-6

typedef struct query_sheet {
    const kdr_ray *rays; /* borrowed */
    oracle_hit *answers;
    size_t count;
    size_t hit_count;
} query_sheet;

/* Asks the oracle's tree. Aborts without memory. */
query_sheet query_sheet_create(const oracle_tree *tree, const kdr_ray *rays, size_t count);
void query_sheet_destroy(query_sheet *sheet);

/* Asks every query of the scene, the ones for many rays in runs of 0, 1, 15, 16, 17 and 1000, with every coherence,
 * and packets of every width with some rays not active.
 * Prints the first few wrong answers and returns how many it counted: 0 if all is right. Thread safe. */
size_t query_sheet_differences(const query_sheet *sheet, const kdr_scene *scene, const char *label);

/* The same for one ray and kdr_intersect1: whether this is the right answer to it; prints it if not. */
bool query_answer_is_right(const kdr_ray *ray, const oracle_hit *answer, const kdr_ray_hit *given, const char *label);

/* Prints a ray and a triangle (which may be NULL) so that they can be read back exactly. */
void query_print_ray(const kdr_ray *ray);
void query_print_primitive(const char *name, const oracle_primitive *primitive);

#endif
