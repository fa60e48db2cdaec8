/* One tree asked in every way that there is: by every traversal, layout of nodes and mailbox, on every instruction set,
 * in every query for rays, of rays that are awkward for its triangles and for its cells.
 *
 * The scalar stack traversal is held to the exact oracle; all others are held to its bits. What is asked can be
 * spoiled, so that a test can show that a fault is found. */
#ifndef KDR_TESTS_SUPPORT_TRACE_CHECK_H
#define KDR_TESTS_SUPPORT_TRACE_CHECK_H

#include "support/soup.h"

/* Words of a plan: traversals with their layouts of nodes, of which the first is "trace=auto"; mailboxes, the first of
 * which is none. All but auto go with every mailbox. */
extern const char *const trace_rows[], *const mailbox_rows[];
extern const size_t trace_row_count, mailbox_row_count;

/* Queries for rays. Packets of 4, 8 and 16 are told apart by their width. */
typedef struct trace_queries {
    void (*intersect1)(const kdr_scene *scene, kdr_ray_hit *ray_hit);
    bool (*occluded1)(const kdr_scene *scene, const kdr_ray *ray);
    void (*intersect_n)(const kdr_scene *scene, const kdr_trace_def *def, kdr_ray_hit *ray_hits, size_t count);
    void (*occluded_n)(const kdr_scene *scene, const kdr_trace_def *def, const kdr_ray *rays, uint8_t *occluded,
                       size_t count);
    void (*intersect_packet)(const kdr_scene *scene, uint32_t width, const int32_t *valid, void *ray_hits);
    void (*occluded_packet)(const kdr_scene *scene, uint32_t width, const int32_t *valid, void *rays);
} trace_queries;

/* Those of the library. */
extern const trace_queries trace_library;

/* A fault, for tests of this check. */
typedef struct trace_fault {
    trace_queries queries;
    void (*spoil)(kdr_scene *scene); /* called after every commit; may be NULL */
} trace_fault;

typedef struct trace_case {
    const soup_kind *kind;
    size_t triangles;
    size_t rays;                                      /* a multiple of 16; the last half are bundles of 16 */
    uint64_t sequence;                                /* of random numbers */
    const char *split, *axis, *share, *order, *costs; /* words of the plan, "" for the default */
    bool is_whole; /* else a tree and traversal get one mailbox, and traversals by name, which ask every ray alone, one
                      width of packets and one coherence: those by the sequence */
} trace_case;

typedef struct trace_report {
    size_t scenes, rays, hits; /* asked; rays and hits are counted once a tree */
    size_t wrong_scenes;
    uint32_t wrong_rows; /* bit i: trace_rows[i] */
    uint32_t isas;       /* bit i: instruction set i was asked */
    uint32_t wrong_isas;
    char first[640]; /* the first wrong answer: plan, instruction set, query and ray; "" if all are right */
} trace_report;

/* Adds to the report. fault NULL: none. Fails the running test if a tree cannot be built, is not sound or is not the
 * same on every instruction set, or if the scalar stack traversal does not answer as the oracle. */
void trace_check(const trace_case *asked, const trace_fault *fault, trace_report *report);

#endif
