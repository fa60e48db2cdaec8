/* PNG data in memory to an image. */
#ifndef KDR_RENDER_IMAGE_PNG_H
#define KDR_RENDER_IMAGE_PNG_H

#include "kdray/render.h"

/* Decodes a whole PNG file that lies in memory; name is used in sentences. Errors as kdr_image_read_png. */
kdr_status kdr_image_decode_png(const uint8_t *bytes, size_t size, const char *name, const kdr_logger *logger,
                                kdr_image **out);

#endif
