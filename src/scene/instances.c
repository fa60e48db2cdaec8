/* Instances: rays go into the scene that is shown, rather than its triangles out of it.
 *
 * The ray is taken through the inverse of the transform in doubles and rounded to floats; what it hits there is what
 * the instance answers, at the same distance, since a transform keeps the parameter along a line. The ray that was
 * rounded passes the box in the outer scene a little beside the one that was given. So an instance is asked only if the
 * ray given meets a box with room for that, by a rule in doubles that knows nothing of the tree, and the box that the
 * tree knows is larger still: the answer does not depend on the tree.
 *
 * Source: S. Parker et al., "OptiX: A General Purpose Ray Tracing Engine", 2010, for the shape of it; the paper of
 * 2007, section 5, for trees as primitives of a tree. Cost: 18 products, a division an axis and a ray in the other
 * scene; 120 bytes an instance beside the tree. */
#include "scene/instances.h"

#include "scene/scene.h"

#include <string.h>

/* Relative to the largest coordinate of the box: room for a ray that was rounded, from up to some hundred boxes away,
 * and what the tree's box has beyond that. */
#define ROOM 0x1p-15f
#define MORE_ROOM 0x1p-14f

typedef struct kdr_instance_place {
    double inverse[12]; /* rows of 4 */
    kdr_box box;        /* what a ray must meet */
} instance_place;

kdr_instances *kdr_instances_create(kdr_device *device, const kdr_instance_def *def) {
    size_t self = sizeof(kdr_instances), bytes = def->count * sizeof(instance_place);
    kdr_instances *instances = kdr_bulk_get(&device->bulk, &self);
    if (!instances)
        return NULL;
    *instances = (kdr_instances){.def = *def};
    instances->places = kdr_bulk_get(&device->bulk, &bytes);
    if (!instances->places) {
        kdr_bulk_put(&device->bulk, instances, sizeof *instances);
        return NULL;
    }
    float bounds[6];
    kdr_scene_bounds(def->scene, bounds);
    memcpy(instances->bounds.lo, bounds, sizeof instances->bounds.lo);
    memcpy(instances->bounds.hi, bounds + 3, sizeof instances->bounds.hi);
    return instances;
}

void kdr_instances_destroy(kdr_instances *instances, kdr_device *device) {
    if (!instances)
        return;
    kdr_bulk_put(&device->bulk, instances->places, instances->def.count * sizeof(instance_place));
    kdr_bulk_put(&device->bulk, instances, sizeof *instances);
}

/* ---- transforms */

/* False if there is none that undoes the transform to within 2^-20. */
static bool invert(const float m[12], double inverse[12]) {
    double cofactor[3][3], det = 0, residual = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
            cofactor[i][j] = (double)m[4 * a + c] * m[4 * b + d] - (double)m[4 * a + d] * m[4 * b + c];
        }
    for (int j = 0; j < 3; j++)
        det += m[j] * cofactor[0][j];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            inverse[4 * i + j] = cofactor[j][i] / det;
        inverse[4 * i + 3] = 0;
        for (int j = 0; j < 3; j++)
            inverse[4 * i + 3] -= inverse[4 * i + j] * m[4 * j + 3];
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double sum = i == j ? -1 : 0;
            for (int k = 0; k < 3; k++)
                sum += inverse[4 * i + k] * m[4 * k + j];
            residual = fmax(residual, fabs(sum));
            residual += inverse[4 * i + 3] - inverse[4 * i + 3]; /* NaN if not finite */
        }
    return residual <= 0x1p-20;
}

/* The box of a box that was moved, larger by `room` of its largest coordinate. */
static kdr_box moved(const float m[12], const kdr_box *box, float room) {
    double lo[3], hi[3], largest = 0;
    kdr_box out;
    for (int i = 0; i < 3; i++) {
        lo[i] = hi[i] = m[4 * i + 3];
        for (int j = 0; j < 3; j++) {
            double a = (double)m[4 * i + j] * box->lo[j], b = (double)m[4 * i + j] * box->hi[j];
            lo[i] += fmin(a, b);
            hi[i] += fmax(a, b);
        }
        largest = fmax(largest, fmax(fabs(lo[i]), fabs(hi[i])));
    }
    for (int i = 0; i < 3; i++) {
        out.lo[i] = (float)(lo[i] - room * largest);
        out.hi[i] = (float)(hi[i] + room * largest);
    }
    return out;
}

void kdr_instances_bounds(uint32_t instance, float lo[3], float hi[3], void *user) {
    const kdr_instances *instances = user;
    instance_place *place = &instances->places[instance];
    float m[12], sum = 0; /* of zeros, unless a number is not finite */
    memcpy(m, (const char *)instances->def.transforms + instance * instances->def.transform_stride, sizeof m);
    for (int i = 0; i < 12; i++)
        sum += m[i] - m[i];
    if (sum != 0 || kdr_box_is_empty(&instances->bounds))
        return; /* left out: the box is NaN as it came */
    place->box = moved(m, &instances->bounds, ROOM);
    kdr_box larger = moved(m, &instances->bounds, MORE_ROOM);
    if (!invert(m, place->inverse)) {
        for (int k = 0; k < 3; k++) {
            lo[k] = 1;
            hi[k] = 0;
        }
        return;
    }
    memcpy(lo, larger.lo, sizeof larger.lo);
    memcpy(hi, larger.hi, sizeof larger.hi);
}

/* ---- queries */

bool kdr_instances_meet(const kdr_instances *instances, uint32_t instance, const kdr_ray *ray, float *entry) {
    const kdr_box *box = &instances->places[instance].box;
    const float origin[3] = {ray->origin_x, ray->origin_y, ray->origin_z};
    const float direction[3] = {ray->direction_x, ray->direction_y, ray->direction_z};
    double enter = ray->tmin, leave = ray->tmax;
    for (int k = 0; k < 3; k++) {
        double below = (double)box->lo[k] - origin[k], above = (double)box->hi[k] - origin[k];
        if (direction[k] == 0) {
            if (below > 0 || above < 0)
                return false;
            continue;
        }
        double reciprocal = 1 / (double)direction[k], a = below * reciprocal, b = above * reciprocal;
        double sooner = a < b ? a : b, later = a < b ? b : a;
        enter = sooner > enter ? sooner : enter;
        leave = later < leave ? later : leave;
    }
    *entry = (float)enter;
    return enter <= leave;
}

kdr_ray kdr_instances_take_in(const kdr_instances *instances, uint32_t instance, const kdr_ray *ray) {
    const double *inverse = instances->places[instance].inverse;
    float origin[3], direction[3];
    for (int i = 0; i < 3; i++) {
        const double *row = &inverse[4 * i];
        origin[i] = (float)(row[0] * ray->origin_x + row[1] * ray->origin_y + row[2] * ray->origin_z + row[3]);
        direction[i] = (float)(row[0] * ray->direction_x + row[1] * ray->direction_y + row[2] * ray->direction_z);
    }
    kdr_ray inside = *ray;
    memcpy(&inside.origin_x, origin, sizeof origin);
    memcpy(&inside.direction_x, direction, sizeof direction);
    return inside;
}

/* The normal: with edges e and f that become M e and M f, their cross product becomes det(M) times the inverse,
 * transposed, times e x f. */
void kdr_instances_take_out(const kdr_instances *instances, uint32_t instance, const kdr_ray_hit *inside,
                            kdr_custom_hit *hit) {
    const double *r = instances->places[instance].inverse;
    double det =
        r[0] * (r[5] * r[10] - r[6] * r[9]) - r[1] * (r[4] * r[10] - r[6] * r[8]) + r[2] * (r[4] * r[9] - r[5] * r[8]);
    double n[3] = {inside->hit.normal_x, inside->hit.normal_y, inside->hit.normal_z};
    hit->normal_x = (float)((r[0] * n[0] + r[4] * n[1] + r[8] * n[2]) / det);
    hit->normal_y = (float)((r[1] * n[0] + r[5] * n[1] + r[9] * n[2]) / det);
    hit->normal_z = (float)((r[2] * n[0] + r[6] * n[1] + r[10] * n[2]) / det);
    hit->t = inside->ray.tmax;
    hit->u = inside->hit.u;
    hit->v = inside->hit.v;
}

bool kdr_instances_closest(const kdr_instances *instances, uint32_t instance, const kdr_ray *ray, kdr_custom_hit *hit,
                           kdr_hit *met) {
    float entry;
    if (!kdr_instances_meet(instances, instance, ray, &entry))
        return false;
    kdr_ray_hit inside = {.ray = kdr_instances_take_in(instances, instance, ray)};
    kdr_intersect1(instances->def.scene, &inside);
    if (inside.hit.geometry == KDR_INVALID_ID)
        return false;
    kdr_instances_take_out(instances, instance, &inside, hit);
    met->primitive = inside.hit.primitive;
    met->geometry = inside.hit.geometry;
    return true;
}

bool kdr_instances_any(const kdr_instances *instances, uint32_t instance, const kdr_ray *ray) {
    float entry;
    if (!kdr_instances_meet(instances, instance, ray, &entry))
        return false;
    kdr_ray inside = kdr_instances_take_in(instances, instance, ray);
    return kdr_occluded1(instances->def.scene, &inside);
}
