/* Packets and instances: rays that go together are asked of an instance together, so that the scene that is shown
 * traces them as a packet.
 *
 * First each ray goes through the tree of instances alone and only notes which ones it meets, wherever along its way;
 * there are few, or it gives up. Then the instances are asked one after the other, the nearest first, each by all rays
 * that meet its box no later than their closest hits so far. An instance answers a ray as it would answer it alone, and
 * of equal distances the lowest instance wins, so the order changes no answer.
 * Cost: a walk a ray, without the early end that a hit gives; then a packet an instance. */
#include "scene/customs.h"
#include "scene/triangles.h"
#include "trace/custom.h"

#define MOST_MET 64 /* instances that one packet meets; with more rays go one by one */

/* An instance that rays of the packet meet. */
typedef struct met_instance {
    uint32_t primitive; /* its number among the custom primitives */
    float entry;        /* where the first of them enters its box */
    uint64_t rays;
} met_instance;

typedef struct meeting {
    const kdr_customs *customs;
    met_instance met[MOST_MET];
    uint32_t count;
    uint32_t ray;  /* the one under way */
    uint32_t next; /* where the instance is looked for first that the ray meets next */
    bool too_many;
} meeting;

static const kdr_instances *instances_of(const kdr_customs *c, uint32_t primitive, uint32_t *instance) {
    uint32_t g = kdr_geometry_of(c->first, c->count, primitive);
    *instance = primitive - c->first[g];
    return c->defs[g].user;
}

/* Notes an instance; true ends the ray's walk. */
static bool note(void *context, const kdr_ray *ray, uint32_t primitive) {
    meeting *m = context;
    uint32_t i = 0;
    /* Rays that go together meet the same instances in the same order. */
    if (m->next < m->count && m->met[m->next].primitive == primitive)
        i = m->next;
    while (i < m->count && m->met[i].primitive != primitive)
        i++;
    if (i == MOST_MET)
        return m->too_many = true;
    if (i == m->count) {
        uint32_t instance;
        float entry = INFINITY;
        const kdr_instances *instances = instances_of(m->customs, primitive, &instance);
        kdr_instances_meet(instances, instance, ray, &entry);
        m->met[m->count++] = (met_instance){.primitive = primitive, .entry = entry};
    }
    m->met[i].rays |= UINT64_C(1) << m->ray;
    m->next = i + 1;
    return false;
}

/* False if the rays meet too many instances. stride: bytes from one ray to the next. */
static bool meet(meeting *m, const kdr_ray *rays, size_t stride, uint32_t count, const uint8_t *skipped) {
    if (m->customs->has_others)
        return false;
    const kdr_custom_answers notes = {.context = m, .occluded = note};
    for (m->ray = 0; m->ray < count && !m->too_many; m->ray++) {
        m->next = 0;
        if (!skipped || !skipped[m->ray])
            kdr_custom_any(&m->customs->tree, &notes, (const kdr_ray *)((const char *)rays + m->ray * stride));
    }
    if (m->too_many)
        return false;

    /* The nearest first. */
    for (uint32_t i = 1; i < m->count; i++) {
        met_instance one = m->met[i];
        uint32_t k = i;
        for (; k > 0 && m->met[k - 1].entry > one.entry; k--)
            m->met[k] = m->met[k - 1];
        m->met[k] = one;
    }
    return true;
}

/* ---- closest hits */

/* Takes the hits of an instance that come before the closest so far, or at its distance under a lower number. */
static void improve(const kdr_instances *instances, uint32_t instance, uint32_t primitive, const kdr_ray_hit *inside,
                    kdr_ray_hit *ray_hit, uint32_t *closest) {
    if (inside->hit.geometry == KDR_INVALID_ID)
        return;
    kdr_custom_hit hit;
    kdr_instances_take_out(instances, instance, inside, &hit);
    if (!(hit.t > ray_hit->ray.tmin) ||
        !(hit.t < ray_hit->ray.tmax || (hit.t == ray_hit->ray.tmax && primitive < *closest)))
        return;
    *closest = primitive;
    ray_hit->ray.tmax = hit.t;
    ray_hit->hit = (kdr_hit){.normal_x = hit.normal_x,
                             .normal_y = hit.normal_y,
                             .normal_z = hit.normal_z,
                             .u = hit.u,
                             .v = hit.v,
                             .primitive = inside->hit.primitive,
                             .geometry = inside->hit.geometry,
                             .instance = instances->first + instance};
}

void kdr_customs_closest_n(const kdr_customs *customs, kdr_ray_hit *ray_hits, uint32_t count) {
    meeting m;
    m.customs = customs;
    m.count = 0;
    m.too_many = false;
    if (!meet(&m, &ray_hits->ray, sizeof *ray_hits, count, NULL)) {
        for (uint32_t i = 0; i < count; i++)
            kdr_customs_closest(customs, &ray_hits[i]);
        return;
    }

    /* At the distance of a triangle only instances of lower geometries count. */
    uint32_t closest[KDR_PACKET_RAYS];
    for (uint32_t i = 0; i < count; i++) {
        uint32_t triangle = ray_hits[i].hit.geometry;
        closest[i] = triangle == KDR_INVALID_ID ? UINT32_MAX : customs->first[triangle];
    }
    for (uint32_t k = 0; k < m.count; k++) {
        kdr_ray_hit inside[KDR_PACKET_RAYS];
        uint8_t asked[KDR_PACKET_RAYS];
        uint32_t instance, rays = 0;
        const kdr_instances *instances = instances_of(customs, m.met[k].primitive, &instance);
        for (uint64_t left = m.met[k].rays; left; left &= left - 1) {
            uint32_t i = (uint32_t)__builtin_ctzll(left);
            float entry;
            if (!kdr_instances_meet(instances, instance, &ray_hits[i].ray, &entry))
                continue;
            inside[rays].ray = kdr_instances_take_in(instances, instance, &ray_hits[i].ray);
            asked[rays++] = (uint8_t)i;
        }
        kdr_intersect_n(instances->def.scene, NULL, inside, rays);
        for (uint32_t i = 0; i < rays; i++)
            improve(instances, instance, m.met[k].primitive, &inside[i], &ray_hits[asked[i]], &closest[asked[i]]);
    }
}

/* ---- any hit */

void kdr_customs_any_n(const kdr_customs *customs, const kdr_ray *rays, uint8_t *occluded, uint32_t count) {
    meeting m;
    m.customs = customs;
    m.count = 0;
    m.too_many = false;
    if (!meet(&m, rays, sizeof *rays, count, occluded)) {
        for (uint32_t i = 0; i < count; i++)
            occluded[i] = occluded[i] || kdr_customs_any(customs, &rays[i]);
        return;
    }
    for (uint32_t k = 0; k < m.count; k++) {
        kdr_ray inside[KDR_PACKET_RAYS];
        uint8_t asked[KDR_PACKET_RAYS], found[KDR_PACKET_RAYS];
        uint32_t instance, left_rays = 0;
        const kdr_instances *instances = instances_of(customs, m.met[k].primitive, &instance);
        for (uint64_t left = m.met[k].rays; left; left &= left - 1) {
            uint32_t i = (uint32_t)__builtin_ctzll(left);
            float entry;
            if (occluded[i] || !kdr_instances_meet(instances, instance, &rays[i], &entry))
                continue;
            inside[left_rays] = kdr_instances_take_in(instances, instance, &rays[i]);
            asked[left_rays++] = (uint8_t)i;
        }
        kdr_occluded_n(instances->def.scene, NULL, inside, found, left_rays);
        for (uint32_t i = 0; i < left_rays; i++)
            occluded[asked[i]] = found[i];
    }
}
