/* One ray on its way through the planes of a tree: the interval of the ray inside a cell, and how a plane cuts it.
 *
 * Included with REAL defined as float or double and STEP(name) as a name of its own for each. Float serves nearly all
 * rays. Double serves those whose reciprocals or distances leave the range in which the error bound below holds
 * (denormal or huge directions, huge coordinates): same steps, wider numbers.
 *
 * Nothing may fall between two cells, so intervals are closed and never shorter than the true ones. A distance
 * t = (plane - origin) * reciprocal carries three roundings; `slack` is four roundings of the longest distance inside
 * the scene, so t - slack and t + slack enclose every true distance that lies inside. Where the ray lies in the plane,
 * t is NaN: every comparison with it is false, and both children are visited with the whole interval. */

typedef struct STEP(ray) {
    REAL origin[3], reciprocal[3];
    uint32_t near_is_right[3]; /* 1 where the ray runs downwards */
    REAL tmin, tmax;           /* inside the entry's box */
    REAL slack;
} STEP(ray);

/* Clips the ray to a box. False if it misses the box for sure. *holds says whether the error bound does. */
static inline bool STEP(begin)(STEP(ray) * r, const kdr_ray *ray, const kdr_box *box, bool *holds) {
    const REAL origin[3] = {ray->origin_x, ray->origin_y, ray->origin_z};
    const REAL direction[3] = {ray->direction_x, ray->direction_y, ray->direction_z};
    const REAL slack = 4 * EPSILON, largest = LARGEST;
    /* A true distance up to half a float step beyond tmax rounds to tmax and counts. */
    r->tmin = ray->tmin;
    r->tmax = ray->tmax;
    r->tmax += (r->tmax < 0 ? -r->tmax : r->tmax) * (REAL)0x1p-23 + (REAL)0x1p-149;
    bool in_range = true;
    *holds = true;
    for (int k = 0; k < 3; k++) {
        r->origin[k] = origin[k];
        r->reciprocal[k] = 1 / direction[k];
        r->near_is_right[k] = direction[k] < 0;
        REAL lo = box->lo[k] - origin[k], hi = box->hi[k] - origin[k];
        if (direction[k] == 0) {
            /* Parallel to the axis's planes: outside for good, or inside for good. */
            if (lo > 0 || hi < 0)
                return false;
            r->near_is_right[k] = 0;
            r->reciprocal[k] = (REAL)INFINITY;
            continue;
        }
        REAL size = direction[k] < 0 ? -direction[k] : direction[k];
        in_range &= size >= 1 / largest && size <= largest && lo >= -largest && hi <= largest;
        REAL t0 = lo * r->reciprocal[k], t1 = hi * r->reciprocal[k];
        REAL enter = t0 < t1 ? t0 : t1, leave = t0 < t1 ? t1 : t0;
        enter -= (enter < 0 ? -enter : enter) * slack;
        leave += (leave < 0 ? -leave : leave) * slack;
        r->tmin = enter > r->tmin ? enter : r->tmin;
        r->tmax = leave < r->tmax ? leave : r->tmax;
    }
    REAL a = r->tmin < 0 ? -r->tmin : r->tmin, b = r->tmax < 0 ? -r->tmax : r->tmax;
    REAL longest = a > b ? a : b;
    r->slack = slack * longest;
    *holds = in_range && longest >= 1 / largest && longest <= largest;
    return r->tmin <= r->tmax || !*holds;
}

/* Which children of a plane the interval [tmin, tmax] reaches. */
typedef enum STEP(side) { STEP(near_only), STEP(far_only), STEP(both) } STEP(side);

static inline __attribute__((always_inline)) STEP(side)
    STEP(cross)(const STEP(ray) * r, uint32_t axis, REAL plane, REAL tmin, REAL tmax, REAL *near_tmax, REAL *far_tmin) {
    REAL t = (plane - r->origin[axis]) * r->reciprocal[axis];
    REAL sooner = t - r->slack, later = t + r->slack;
    *near_tmax = later < tmax ? later : tmax;
    *far_tmin = sooner > tmin ? sooner : tmin;
    if (sooner > tmax)
        return STEP(near_only);
    return later < tmin ? STEP(far_only) : STEP(both);
}
