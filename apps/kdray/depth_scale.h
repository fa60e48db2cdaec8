/* Colours that show how deep something lies. */
#ifndef KDR_APPS_KDRAY_DEPTH_SCALE_H
#define KDR_APPS_KDRAY_DEPTH_SCALE_H

#include <stdint.h>

/* The colour of a part from 0 (pale yellow) to 1 (dark blue), as 0xRRGGBB in sRGB. Equal steps look equally large, and
 * darker is more in print too. */
uint32_t kdr_depth_colour(double part);

#endif
