#include "support/cell_rays.h"

#include "support/awkward_rays.h"

#include <float.h>
#include <math.h>
#include <string.h>

static kdr_cell_step keep_cell(const kdr_cell *cell, void *user) {
    cell_sample *sample = user;
    if (cell->is_leaf || cell->is_custom)
        return KDR_CELL_INTO;
    // The n-th cell takes a place with the chance that all before it had.
    uint32_t place = sample->seen < CELL_SAMPLE ? sample->seen : test_random_below(&sample->random, sample->seen + 1);
    if (place < CELL_SAMPLE)
        sample->cells[place] = *cell;
    sample->seen++;
    sample->count = sample->seen < CELL_SAMPLE ? sample->seen : CELL_SAMPLE;
    return KDR_CELL_INTO;
}

cell_sample cell_sample_of(const kdr_scene *scene, test_random *random) {
    cell_sample sample = {.random = test_random_start(test_random_u64(random), 1)};
    kdr_scene_cells(scene, keep_cell, &sample);
    return sample;
}

static float to_finite(double value) { return (float)fmax(fmin(value, FLT_MAX), -FLT_MAX); }

static bool one_in(test_random *random, uint32_t count) { return test_random_below(random, count) == 0; }

static const float *any_vertex(test_random *random, const oracle_scene *scene) {
    const oracle_primitive *primitive = &scene->primitives[test_random_below(random, (uint32_t)scene->count)];
    return (const float *[]){primitive->a, primitive->b, primitive->c}[test_random_below(random, 3)];
}

/* A corner of the cell or of its two halves. */
static void corner_of(test_random *random, const kdr_cell *cell, float out[3]) {
    for (uint32_t k = 0; k < 3; k++)
        out[k] =
            k == cell->axis && one_in(random, 2) ? cell->plane : cell->bounds[3 * test_random_below(random, 2) + k];
}

static void point_around(test_random *random, const kdr_cell *cell, float out[3]) {
    for (uint32_t k = 0; k < 3; k++) {
        double low = cell->bounds[k], high = cell->bounds[3 + k];
        out[k] = to_finite(low + (high - low) * (test_random_float(random) * 2 - 0.5));
    }
}

static void turn_to(const float from[3], const float to[3], float direction[3]) {
    for (int k = 0; k < 3; k++)
        direction[k] = to_finite((double)to[k] - from[k]);
}

static void set_vectors(kdr_ray *ray, const float o[3], const float d[3]) {
    ray->origin_x = o[0], ray->origin_y = o[1], ray->origin_z = o[2];
    ray->direction_x = d[0], ray->direction_y = d[1], ray->direction_z = d[2];
}

kdr_ray cell_ray(test_random *random, const oracle_tree *tree, const cell_sample *sample) {
    if (sample->count == 0 || tree->scene->count == 0)
        return awkward_ray(random, tree);
    const kdr_cell *cell = &sample->cells[test_random_below(random, sample->count)];
    const kdr_cell *other = &sample->cells[test_random_below(random, sample->count)];
    const uint32_t axis = cell->axis;
    kdr_ray ray = {.tmin = one_in(random, 4) ? -INFINITY : 0, .tmax = INFINITY, .id = test_random_u32(random)};
    float o[3], d[3] = {0}, to[3];
    point_around(random, cell, o);
    memcpy(to, any_vertex(random, tree->scene), sizeof to);
    switch (test_random_below(random, 8)) {
    case 0: // in the plane all the way
        o[axis] = cell->plane;
        turn_to(o, to, d);
        d[axis] = one_in(random, 2) ? 0.0f : -0.0f;
        break;
    case 1: // along an edge of the cell or of a half
        corner_of(random, cell, o);
        d[test_random_below(random, 3)] = one_in(random, 2) ? 1 : -2;
        ray.tmin = -INFINITY;
        break;
    case 2: // through corners of two cells
        corner_of(random, cell, o);
        corner_of(random, other, to);
        turn_to(o, to, d);
        ray.tmin = -INFINITY;
        break;
    case 3: // from a vertex through a corner
        corner_of(random, cell, o);
        turn_to(to, o, d);
        memcpy(o, to, sizeof to);
        break;
    case 4: // from the plane
        o[axis] = cell->plane;
        turn_to(o, to, d);
        break;
    case 5: { // at right angles to the plane, ending or beginning in it
        o[(axis + 1) % 3] = to[(axis + 1) % 3];
        o[(axis + 2) % 3] = to[(axis + 2) % 3];
        d[axis] = o[axis] < cell->plane ? 1 : -1;
        float distance = to_finite(fabs((double)cell->plane - o[axis]));
        *(one_in(random, 3) ? &ray.tmin : &ray.tmax) = distance;
        break;
    }
    case 6: // all but in the plane
        o[axis] = cell->plane;
        turn_to(o, to, d);
        d[axis] = (float)((int)test_random_below(random, 7) - 3) * (one_in(random, 2) ? 0x1p-149f : 0x1p-60f);
        break;
    default: // a step beside it
        turn_to(o, to, d);
        o[axis] = nextafterf(cell->plane, one_in(random, 2) ? INFINITY : -INFINITY);
        d[axis] = one_in(random, 2) ? 0.0f : d[axis];
    }
    set_vectors(&ray, o, d);
    return ray;
}

static void jitter(test_random *random, float *value) {
    for (uint32_t steps = test_random_below(random, 3); steps > 0; steps--)
        *value = nextafterf(*value, one_in(random, 2) ? FLT_MAX : -FLT_MAX);
}

void cell_ray_bundle(test_random *random, const oracle_tree *tree, kdr_ray *rays, size_t count) {
    const uint32_t recipe = test_random_below(random, 6);
    const kdr_ray first = rays[0];
    double length = fmax(fmax(fabsf(first.direction_x), fabsf(first.direction_y)), fabsf(first.direction_z));
    oracle_hit hit = oracle_tree_closest(tree, &first);
    for (size_t i = 1; i < count; i++) {
        rays[i] = first;
        rays[i].id = test_random_u32(random);
        float o[3] = {first.origin_x, first.origin_y, first.origin_z};
        float d[3] = {first.direction_x, first.direction_y, first.direction_z};
        for (int k = 0; k < 3; k++) {
            double shift = length * test_random_between(random, -0.05f, 0.05f);
            switch (recipe) {
            case 0: jitter(random, &d[k]); break;
            case 1: jitter(random, &o[k]); break;
            case 2: d[k] = to_finite(d[k] + shift); break; // from one point
            case 3:                                        // to one point
                o[k] = to_finite(o[k] - shift);
                d[k] = to_finite(d[k] + shift);
                break;
            case 4: d[k] = d[k] == 0 && one_in(random, 2) ? -d[k] : d[k]; break;
            default: break; // the same
            }
        }
        if (hit.primitive && one_in(random, 3)) {
            rays[i].tmax = hit.t;
            jitter(random, &rays[i].tmax);
        }
        if (one_in(random, 40))
            d[test_random_below(random, 3)] = NAN;
        set_vectors(&rays[i], o, d);
    }
}
