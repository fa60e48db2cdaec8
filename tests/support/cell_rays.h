/* Rays that look for trouble in one tree: in its split planes, along the edges of its cells and through their corners,
 * a step of a float beside a plane, with intervals that end in one; and bundles of rays that are all but the same. */
#ifndef KDR_TESTS_SUPPORT_CELL_RAYS_H
#define KDR_TESTS_SUPPORT_CELL_RAYS_H

#include "support/oracle_tree.h"
#include "support/random.h"

#define CELL_SAMPLE 16

/* Interior cells of a tree, drawn with equal chances. */
typedef struct cell_sample {
    kdr_cell cells[CELL_SAMPLE];
    uint32_t count; /* 0: the tree is one leaf */
    uint32_t seen;
    test_random random;
} cell_sample;

cell_sample cell_sample_of(const kdr_scene *scene, test_random *random);

/* A ray made from one of the cells; an awkward ray (awkward_rays.h) if there are none. */
kdr_ray cell_ray(test_random *random, const oracle_tree *tree, const cell_sample *sample);

/* Rays around the first one, which is given: the same ray, off by steps of floats, towards one point, from one point,
 * with other intervals or with another sign of zero; now and then one is not valid. */
void cell_ray_bundle(test_random *random, const oracle_tree *tree, kdr_ray *rays, size_t count);

#endif
