#include "support/exact_point.h"

#include <math.h>
#include <stdbool.h>

typedef __float128 quadruple;

static quadruple dot(const quadruple p[3], const quadruple q[3]) { return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]; }

static void cross(const quadruple p[3], const quadruple q[3], quadruple product[3]) {
    for (int k = 0; k < 3; k++)
        product[k] = p[(k + 1) % 3] * q[(k + 2) % 3] - p[(k + 2) % 3] * q[(k + 1) % 3];
}

static quadruple root(quadruple x) {
    quadruple guess = sqrt((double)x);
    for (int i = 0; i < 2 && guess > 0; i++)
        guess = (guess + x / guess) / 2;
    return guess;
}

/* The least of the distances to the corners, to the lines of edges beside which the point lies, and to the plane if it
 * lies above the triangle. */
static quadruple distance_to(const float query[3], const float (*corner)[3]) {
    quadruple seen[3][3], edge[3][3], normal[3], product[3], least = INFINITY;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            seen[i][k] = (quadruple)query[k] - corner[i][k];
            edge[i][k] = (quadruple)corner[(i + 1) % 3][k] - corner[i][k];
        }
    }
    cross(edge[0], edge[1], normal);
    bool above = true;
    for (int i = 0; i < 3; i++) {
        quadruple square = dot(seen[i], seen[i]), along = dot(seen[i], edge[i]), length = dot(edge[i], edge[i]);
        least = square < least ? square : least;
        cross(edge[i], seen[i], product);
        above = above && dot(product, normal) >= 0;
        square = length > 0 ? dot(product, product) / length : square;
        least = along > 0 && along < length && square < least ? square : least;
    }
    quadruple height = dot(seen[0], normal), area = dot(normal, normal);
    if (above && area > 0 && height * height / area < least)
        least = height * height / area;
    return root(least);
}

double exact_point_distance(const float query[3], const float (*corner)[3]) {
    return (double)distance_to(query, corner);
}

double exact_point_error(const float query[3], const float (*corner)[3], double square) {
    return (double)(root(square) - distance_to(query, corner));
}
