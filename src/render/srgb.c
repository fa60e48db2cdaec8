#include "render/srgb.h"

#include <math.h>
#include <pthread.h>

static kdr_srgb_tables tables;
static pthread_once_t tables_once = PTHREAD_ONCE_INIT;

static double to_linear(double code) { return code <= 0.04045 ? code / 12.92 : pow((code + 0.055) / 1.055, 2.4); }

static void make_tables(void) {
    for (int i = 0; i < 256; i++) {
        tables.linear[i] = (float)to_linear(i / 255.0);
        tables.threshold[i] = i == 0 ? 0 : (float)to_linear((i - 0.5) / 255.0);
    }
    tables.threshold[256] = INFINITY;

    unsigned code = 0;
    for (int i = 0; i <= 4096; i++) {
        while ((float)i / 4096 >= tables.threshold[code + 1])
            code++;
        tables.start[i] = (uint8_t)code;
    }
}

const kdr_srgb_tables *kdr_srgb_get_tables(void) {
    pthread_once(&tables_once, make_tables);
    return &tables;
}

float kdr_srgb_to_linear(float code) { return (float)to_linear(code); }
