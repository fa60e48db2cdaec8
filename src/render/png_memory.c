#include "render/png_memory.h"

#include "base/check.h"
#include "render/memory.h"

#include <stdio.h>
#include <string.h>

/* libpng does not say the size of what it releases: it stands in front, in a unit that keeps malloc's alignment. */
#define HEADER_BYTES 16

_Noreturn void kdr_png_fail(png_structp png, png_const_charp message) {
    kdr_png_fault *fault = png_get_error_ptr(png);
    snprintf(fault->message, sizeof(fault->message), "%s", message);
    png_longjmp(png, 1);
}

void kdr_png_ignore(png_structp png, png_const_charp message) {
    (void)png;
    (void)message;
}

png_voidp kdr_png_get(png_structp png, png_alloc_size_t size) {
    kdr_png_fault *fault = png_get_mem_ptr(png);
    size_t total;
    unsigned char *memory = kdr_size_add(size, HEADER_BYTES, &total) ? kdr_render_get(total, 1) : NULL;
    if (!memory) {
        fault->out_of_memory = true;
        return NULL;
    }
    memcpy(memory, &total, sizeof(total));
    return memory + HEADER_BYTES;
}

void kdr_png_release(png_structp png, png_voidp memory) {
    (void)png;
    if (!memory)
        return;
    unsigned char *start = (unsigned char *)memory - HEADER_BYTES;
    size_t total;
    memcpy(&total, start, sizeof(total));
    kdr_render_release(start, total);
}
