/* A scene: geometries as given, and the trees of the last commit with what queries need to name a hit. */
#ifndef KDR_SCENE_SCENE_H
#define KDR_SCENE_SCENE_H

#include "scene/customs.h"
#include "scene/device.h"
#include "scene/instances.h"
#include "scene/part.h"
#include "scene/readers.h"

/* What a commit made. Queries read nothing else. */
typedef struct kdr_committed {
    kdr_part *dynamic_part; /* triangles of geometries that are not static; never NULL once it is shown */
    kdr_part *static_part;  /* those of static ones; NULL: there are none */
    kdr_customs *customs;   /* NULL: there are no custom primitives */
    bool is_commit;         /* false: the nothing that a new scene shows */
    bool is_named;          /* rays are asked by a traversal by name, one by one */
    bool wide;              /* all triangles are in wide trees, so rays may go together */
    bool has_more;          /* there is more than the dynamic triangles */
    uint32_t nesting;       /* scenes below one another that it shows; 0: it has no instances */
    double build_seconds;
} kdr_committed;

struct kdr_scene {
    kdr_device *device;
    uint64_t serial; /* of the device's scenes, in the order they were created: instances show lower ones only */
    kdr_triangles_def *geometries; /* those of custom primitives have no triangles here */
    kdr_custom_def *custom_defs;   /* a geometry; size 0: of triangles. NULL: all are. For instances see instances.h */
    uint32_t geometry_count;
    size_t geometry_capacity;
    bool dynamic_changed; /* something that is not static was added, set or touched since the last commit */
    bool static_changed;  /* the same of static triangles */
    kdr_plan static_plan;
    kdr_progress_fn *tell; /* NULL: nobody */
    void *tell_user;

    _Atomic(kdr_committed *) shown; /* one of places: the last commit, or nothing at all */
    kdr_committed places[2];
    kdr_readers *readers; /* NULL: queries and commits never run at once, and the place not shown is empty */
    bool committed;
};

/* What a query sees from enter to leave. */
typedef struct kdr_visit {
    const kdr_committed *seen;
    _Atomic uint32_t *counted; /* where it is counted in; NULL: nowhere */
} kdr_visit;

kdr_visit kdr_scene_count_in(const kdr_scene *scene);

static inline kdr_visit kdr_scene_enter(const kdr_scene *scene) {
    if (__builtin_expect(scene->readers != NULL, 0))
        return kdr_scene_count_in(scene);
    return (kdr_visit){atomic_load_explicit(&scene->shown, memory_order_relaxed), NULL};
}

static inline void kdr_scene_leave(kdr_visit visit) {
    if (__builtin_expect(visit.counted != NULL, 0))
        atomic_fetch_sub_explicit(visit.counted, 1, memory_order_release);
}

/* The place that is not shown, empty: waits for who still asks what was there. */
kdr_committed *kdr_scene_other_place(kdr_scene *scene);

/* Gives back what a place holds. */
void kdr_scene_empty_place(kdr_scene *scene, kdr_committed *place);

/* Adds a geometry, of triangles or, if custom is not NULL, of custom primitives. Both defs are sound. */
kdr_status kdr_scene_add(kdr_scene *scene, const kdr_triangles_def *triangles, const kdr_custom_def *custom,
                         uint32_t *geometry);

/* True if a geometry has custom primitives. */
static inline bool kdr_scene_is_custom(const kdr_scene *scene, uint32_t geometry) {
    return scene->custom_defs && scene->custom_defs[geometry].size > 0;
}

/* True if it has instances. */
static inline bool kdr_scene_is_instance(const kdr_scene *scene, uint32_t geometry) {
    return kdr_scene_is_custom(scene, geometry) && scene->custom_defs[geometry].bounds == kdr_instances_bounds;
}

#endif
