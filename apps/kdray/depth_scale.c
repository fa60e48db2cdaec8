/* A scale of colours in even steps: a straight way through lightness, and around it through hue, in a space where equal
 * distances look equal.
 *
 * Source: B. Ottosson, "A perceptual color space for image processing", 2020 (OKLab, and its matrices to linear sRGB).
 */
#include "depth_scale.h"

#include <math.h>
#include <stdbool.h>

/* Both ends of the scale. */
#define LIGHTNESS_0 0.93
#define LIGHTNESS_1 0.32
#define HUE_0 105.0 /* degrees: yellow, then over green to blue */
#define HUE_1 280.0
#define CHROMA 0.13

static void to_linear(double lightness, double a, double b, double rgb[3]) {
    double l = lightness + 0.3963377774 * a + 0.2158037573 * b;
    double m = lightness - 0.1055613458 * a - 0.0638541728 * b;
    double s = lightness - 0.0894841775 * a - 1.2914855480 * b;
    l = l * l * l, m = m * m * m, s = s * s * s;
    rgb[0] = 4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s;
    rgb[1] = -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s;
    rgb[2] = -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s;
}

static uint32_t to_byte(double linear) {
    double v = linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1 / 2.4) - 0.055;
    return (uint32_t)(255 * fmin(fmax(v, 0), 1) + 0.5);
}

uint32_t kdr_depth_colour(double part) {
    double lightness = LIGHTNESS_0 + (LIGHTNESS_1 - LIGHTNESS_0) * part;
    double hue = (HUE_0 + (HUE_1 - HUE_0) * part) * acos(-1.0) / 180;

    /* Colours that no screen shows lose chroma until one does; lightness and hue stay. */
    double rgb[3], chroma = CHROMA;
    for (bool shown = false; !shown; chroma -= 0.005) {
        to_linear(lightness, chroma * cos(hue), chroma * sin(hue), rgb);
        shown = chroma <= 0;
        if (fmin(fmin(rgb[0], rgb[1]), rgb[2]) >= 0 && fmax(fmax(rgb[0], rgb[1]), rgb[2]) <= 1)
            shown = true;
    }
    return to_byte(rgb[0]) << 16 | to_byte(rgb[1]) << 8 | to_byte(rgb[2]);
}
