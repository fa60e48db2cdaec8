/* Axis-aligned boxes in binary32. A box with lo > hi on an axis is empty. */
#ifndef KDR_GEOMETRY_BOX_H
#define KDR_GEOMETRY_BOX_H

#include <math.h>
#include <stdbool.h>

typedef struct kdr_box {
    float lo[3], hi[3];
} kdr_box;

static inline kdr_box kdr_box_empty(void) {
    return (kdr_box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

static inline bool kdr_box_is_empty(const kdr_box *box) {
    return !(box->lo[0] <= box->hi[0] && box->lo[1] <= box->hi[1] && box->lo[2] <= box->hi[2]);
}

static inline void kdr_box_add(kdr_box *box, const kdr_box *other) {
    for (int k = 0; k < 3; k++) {
        box->lo[k] = other->lo[k] < box->lo[k] ? other->lo[k] : box->lo[k];
        box->hi[k] = other->hi[k] > box->hi[k] ? other->hi[k] : box->hi[k];
    }
}

/* Half the surface area, in double so that no finite box overflows. 0 for an empty box. */
static inline double kdr_box_area(const kdr_box *box) {
    if (kdr_box_is_empty(box))
        return 0;
    double x = (double)box->hi[0] - box->lo[0], y = (double)box->hi[1] - box->lo[1],
           z = (double)box->hi[2] - box->lo[2];
    return x * y + y * z + z * x;
}

#endif
