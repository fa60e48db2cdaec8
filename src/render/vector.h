/* Three floats with the few operations that shading needs. */
#ifndef KDR_RENDER_VECTOR_H
#define KDR_RENDER_VECTOR_H

#include <math.h>

typedef struct kdr_vector {
    float x, y, z;
} kdr_vector;

/* Without the library's calls, which care for NaN. */
static inline float kdr_larger(float a, float b) { return a > b ? a : b; }
static inline float kdr_smaller(float a, float b) { return a < b ? a : b; }

static inline kdr_vector kdr_vector_of(const float v[3]) { return (kdr_vector){v[0], v[1], v[2]}; }

static inline kdr_vector kdr_vector_add(kdr_vector a, kdr_vector b) {
    return (kdr_vector){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline kdr_vector kdr_vector_sub(kdr_vector a, kdr_vector b) {
    return (kdr_vector){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline kdr_vector kdr_vector_mul(kdr_vector a, kdr_vector b) {
    return (kdr_vector){a.x * b.x, a.y * b.y, a.z * b.z};
}

static inline kdr_vector kdr_vector_scale(kdr_vector a, float s) { return (kdr_vector){a.x * s, a.y * s, a.z * s}; }

static inline float kdr_vector_dot(kdr_vector a, kdr_vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

static inline kdr_vector kdr_vector_mix(kdr_vector a, kdr_vector b, float t) {
    return kdr_vector_add(kdr_vector_scale(a, 1 - t), kdr_vector_scale(b, t));
}

/* The largest magnitude of a component. */
static inline float kdr_vector_extent(kdr_vector a) {
    return kdr_larger(kdr_larger(fabsf(a.x), fabsf(a.y)), fabsf(a.z));
}

/* Unit length; a zero vector stays zero. In double: neither huge nor tiny components spoil it. */
static inline kdr_vector kdr_vector_unit(double x, double y, double z) {
    double length = sqrt(x * x + y * y + z * z);
    if (!(length > 0) || !isfinite(length))
        return (kdr_vector){0, 0, 0};
    return (kdr_vector){(float)(x / length), (float)(y / length), (float)(z / length)};
}

/* The unit vector from one point to another. */
static inline kdr_vector kdr_vector_towards(kdr_vector from, kdr_vector to) {
    return kdr_vector_unit((double)to.x - from.x, (double)to.y - from.y, (double)to.z - from.z);
}

#endif
