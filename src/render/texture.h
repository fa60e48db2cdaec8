/* A colour for every point of a plane, repeating in both directions. */
#ifndef KDR_RENDER_TEXTURE_H
#define KDR_RENDER_TEXTURE_H

#include "kdray/render.h"
#include "render/vector.h"

typedef struct kdr_texture {
    const kdr_image *image; /* NULL: a checkerboard; borrowed */
} kdr_texture;

/* Linear RGB at (u, v), v down. An image fills [0, 1) x [0, 1), read bilinearly; the checkerboard has 16 x 16 squares
 * there. */
kdr_vector kdr_texture_at(const kdr_texture *texture, float u, float v);

#endif
