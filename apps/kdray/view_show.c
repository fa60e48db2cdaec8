#include "view_show.h"

#include "depth_scale.h"

#include <math.h>
#include <string.h>

#define OUTLIERS 0.005 /* of the values may be beyond the end of the scale */
#define BINS 1024

const char *kdr_view_show_name(kdr_view_show show) {
    static const char *const names[] = {"picture", "normals", "depth", "nodes", "triangles"};
    return names[show];
}

/* Black, red, yellow, white. */
static uint32_t heat(double part) {
    uint32_t colour = 0;
    for (int k = 0; k < 3; k++) {
        double level = fmin(fmax(3 * part - k, 0), 1);
        colour = colour << 8 | (uint32_t)(255 * level + 0.5);
    }
    return colour;
}

uint32_t kdr_view_show_colour(kdr_view_show show, double part) {
    part = fmin(fmax(part, 0), 1);
    return show == KDR_SHOW_DEPTH ? kdr_depth_colour(part) : heat(part);
}

static double round_up(double value) {
    double power = pow(10, floor(log10(value)));
    for (int i = 0; i < 3; i++) {
        static const double steps[] = {1, 2, 5};
        if (value <= steps[i] * power * (1 + 1e-9))
            return steps[i] * power;
    }
    return 10 * power;
}

double kdr_view_show_end(const float *values, uint64_t count) {
    float largest = 0;
    uint64_t used = 0, bins[BINS];
    for (uint64_t i = 0; i < count; i++) {
        largest = fmaxf(largest, values[i]);
        used += values[i] >= 0;
    }
    if (!(largest > 0) || !isfinite(largest))
        return 1;
    memset(bins, 0, sizeof bins);
    for (uint64_t i = 0; i < count; i++)
        if (values[i] >= 0)
            bins[(int)((BINS - 1) * (double)(values[i] / largest))]++;

    // From above, as long as few are left out
    uint64_t beyond = 0;
    int last = BINS - 1;
    while (last > 0 && (double)(beyond + bins[last]) <= OUTLIERS * (double)used)
        beyond += bins[last--];
    return round_up((double)largest * (last + 1) / BINS);
}
