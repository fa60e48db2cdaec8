/* What reading and writing share: libpng's errors and its memory.
 *
 * libpng leaves a call that fails by longjmp. Each side of kdray has one function that calls setjmp; its locals do not
 * change after that, everything that does lives in a context on the heap. */
#ifndef KDR_RENDER_PNG_MEMORY_H
#define KDR_RENDER_PNG_MEMORY_H

#include <png.h>
#include <stdbool.h>

/* Stands first in the context that libpng gets as error and memory pointer. */
typedef struct kdr_png_fault {
    bool out_of_memory;
    char message[160]; /* libpng's own words; empty: none */
} kdr_png_fault;

/* Keeps the message and leaves by longjmp. The error pointer is a kdr_png_fault. */
_Noreturn void kdr_png_fail(png_structp png, png_const_charp message);

/* Warnings speak of chunks that kdray does not use. */
void kdr_png_ignore(png_structp png, png_const_charp message);

/* Counted memory for libpng and the zlib under it. The memory pointer is a kdr_png_fault. */
png_voidp kdr_png_get(png_structp png, png_alloc_size_t size);
void kdr_png_release(png_structp png, png_voidp memory);

#endif
