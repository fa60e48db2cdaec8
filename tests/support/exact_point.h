/* The distance from a point to a triangle in numbers of 113 bits: an oracle that shares no formula with the library.
 * Cost: some microseconds. */
#ifndef KDR_TESTS_SUPPORT_EXACT_POINT_H
#define KDR_TESTS_SUPPORT_EXACT_POINT_H

/* Rounded to double. Everything is finite; the triangle may have no area. */
double exact_point_distance(const float query[3], const float (*corner)[3]);

/* The root of `square` less the distance: what a computed square of it is wrong by. */
double exact_point_error(const float query[3], const float (*corner)[3], double square);

#endif
