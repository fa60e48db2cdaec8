/* A scene: geometries as given, and the trees of the last commit with what queries need to name a hit. */
#ifndef KDR_SCENE_SCENE_H
#define KDR_SCENE_SCENE_H

#include "scene/customs.h"
#include "scene/device.h"
#include "scene/instances.h"
#include "scene/triangles.h"

struct kdr_scene {
    kdr_device *device;
    uint64_t serial; /* of the device's scenes, in the order they were created: instances show lower ones only */
    kdr_triangles_def *geometries; /* those of custom primitives have no triangles here */
    kdr_custom_def *custom_defs;   /* a geometry; size 0: of triangles. NULL: all are. For instances see instances.h */
    uint32_t geometry_count;
    size_t geometry_capacity;
    bool changed; /* something was added, set or touched since the last commit */

    /* Of the last commit; queries read nothing else. */
    kdr_tree tree;            /* of the triangles */
    kdr_customs *customs;     /* NULL: there are no custom primitives */
    kdr_lone lone;            /* how a lone ray is asked, by the plan */
    uint32_t *first;          /* first[g]: number of geometry g's first triangle; committed_count + 1 entries */
    uint32_t committed_count; /* geometries */
    uint32_t nesting;         /* scenes below one another that it shows; 0: it has no instances */
    bool committed;
    kdr_plan plan;
    double build_seconds;
};

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
