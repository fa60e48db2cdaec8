/* Rays that look for trouble: through vertices and edges, along axes and planes, from points of triangles, with zero,
 * denormal, huge and NaN components, and with intervals that end at a hit. */
#ifndef KDR_TESTS_SUPPORT_AWKWARD_RAYS_H
#define KDR_TESTS_SUPPORT_AWKWARD_RAYS_H

#include "support/oracle_tree.h"
#include "support/random.h"

/* A ray made from the triangles of the scene, or from nothing if it has none. One in thirty is not valid. */
kdr_ray awkward_ray(test_random *random, const oracle_tree *tree);

/* `count` of them; free() them. Aborts without memory. */
kdr_ray *awkward_rays_create(test_random *random, const oracle_tree *tree, size_t count);

#endif
