/* The words of lanes.h in plain C: for one lane, and for machines without a header of their own. */
#ifndef KDR_GEOMETRY_LANES_PLAIN_H
#define KDR_GEOMETRY_LANES_PLAIN_H

/* b where either is NaN, as the machine instructions do. */
KDR_LANES_INLINE kdr_lanes_f kdr_lanes_min(kdr_lanes_f a, kdr_lanes_f b) {
    kdr_lanes_i less = a < b;
    return (kdr_lanes_f)(((kdr_lanes_i)a & less) | ((kdr_lanes_i)b & ~less));
}

KDR_LANES_INLINE kdr_lanes_f kdr_lanes_max(kdr_lanes_f a, kdr_lanes_f b) {
    kdr_lanes_i more = a > b;
    return (kdr_lanes_f)(((kdr_lanes_i)a & more) | ((kdr_lanes_i)b & ~more));
}

/* The same for distances of which one is at least 0 for kdr_lanes_later, and for kdr_lanes_sooner but that of two below
 * 0 it may be either: compared as integers, which is several times as fast on many machines. */
KDR_LANES_INLINE kdr_lanes_f kdr_lanes_sooner(kdr_lanes_f a, kdr_lanes_f b) {
    kdr_lanes_i less = (kdr_lanes_i)a < (kdr_lanes_i)b;
    return (kdr_lanes_f)(((kdr_lanes_i)a & less) | ((kdr_lanes_i)b & ~less));
}

KDR_LANES_INLINE kdr_lanes_f kdr_lanes_later(kdr_lanes_f a, kdr_lanes_f b) {
    kdr_lanes_i more = (kdr_lanes_i)a > (kdr_lanes_i)b;
    return (kdr_lanes_f)(((kdr_lanes_i)a & more) | ((kdr_lanes_i)b & ~more));
}

/* The lanes of a comparison as bits. */
KDR_LANES_INLINE kdr_lane_bits kdr_lanes_bits(kdr_lanes_i comparison) {
    kdr_lane_bits bits = 0;
    for (int i = 0; i < KDR_LANES; i++)
        bits |= (kdr_lane_bits)(comparison[i] & 1) << i;
    return bits;
}

KDR_LANES_INLINE kdr_lane_bits kdr_lanes_less(kdr_lanes_f a, kdr_lanes_f b) { return kdr_lanes_bits(a < b); }

/* Reads no more than `count` floats, rounded up to 4; lanes beyond have no meaning. */
KDR_LANES_INLINE kdr_lanes_f kdr_lanes_load_first(const float *from, uint32_t count) {
    (void)count;
    return kdr_lanes_load(from);
}

/* a where the bit is set, b elsewhere. */
KDR_LANES_INLINE kdr_lanes_f kdr_lanes_choose(kdr_lane_bits bits, kdr_lanes_f a, kdr_lanes_f b) {
    for (int i = 0; i < KDR_LANES; i++)
        b[i] = bits >> i & 1 ? a[i] : b[i];
    return b;
}

/* Writes the chosen lanes one after the other, and nothing behind them. */
KDR_LANES_INLINE void kdr_lanes_compress(float *to, kdr_lane_bits bits, kdr_lanes_f v) {
    for (int i = 0; i < KDR_LANES; i++)
        if (bits >> i & 1)
            *to++ = v[i];
}

KDR_LANES_INLINE void kdr_lanes_compress_u(uint32_t *to, kdr_lane_bits bits, kdr_lanes_u v) {
    for (int i = 0; i < KDR_LANES; i++)
        if (bits >> i & 1)
            *to++ = v[i];
}

#endif
