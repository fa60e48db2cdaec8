/* A scene: geometries as given, and the tree of the last commit with what queries need to name a hit. */
#ifndef KDR_SCENE_SCENE_H
#define KDR_SCENE_SCENE_H

#include "scene/device.h"
#include "scene/triangles.h"

struct kdr_scene {
    kdr_device *device;
    kdr_triangles_def *geometries;
    uint32_t geometry_count;
    size_t geometry_capacity;
    bool changed; /* something was added, set or touched since the last commit */

    /* Of the last commit; queries read nothing else. */
    kdr_tree tree;
    kdr_lone lone;            /* how a lone ray is asked, by the plan */
    uint32_t *first;          /* first[g]: number of geometry g's first triangle; committed_count + 1 entries */
    uint32_t committed_count; /* geometries */
    bool committed;
    kdr_plan plan;
    double build_seconds;
};

#endif
