/* PNG files to images: every colour type and depth, interlaced or not, as linear RGB.
 *
 * A file is decoded from memory, so that its length is known before its header is believed: deflate
 * expands by less than 1,032, and a header that promises more than that is refused before anything is allocated.
 * Samples are taken as sRGB, whatever the file's own gamma says. */
#include "render/image_png.h"

#include "mesh/file_bytes.h"
#include "mesh/report.h"
#include "render/memory.h"
#include "render/png_memory.h"
#include "render/srgb.h"

#include <string.h>

#define SIDE_LIMIT 65536u
#define PIXEL_LIMIT ((uint64_t)1 << 28)
#define DEFLATE_EXPANSION 1032u
#define SIGNATURE_BYTES 8

typedef struct png_input {
    kdr_png_fault fault; /* first: libpng's error and memory pointer */
    png_structp png;
    png_infop info;
    const uint8_t *bytes;
    size_t size, offset;
    const char *name;
    const kdr_logger *logger;
    const kdr_srgb_tables *srgb;
    kdr_image *image;
    uint32_t width, height;
    bool deep;       /* 16 bits a sample */
    int passes;      /* 7 for an interlaced file, else 1 */
    size_t row_size; /* bytes of a row of RGB samples */
    uint8_t *rows;   /* one row, or all of them for an interlaced file */
    size_t rows_size;
} png_input;

static void get_bytes(png_structp png, png_bytep bytes, size_t size) {
    png_input *input = png_get_io_ptr(png);
    if (size > input->size - input->offset) {
        input->offset = input->size;
        png_error(png, "the file ends too early");
    }
    memcpy(bytes, input->bytes + input->offset, size);
    input->offset += size;
}

/* Reads what stands before the pixels and holds it against the limits. */
static kdr_status read_header(png_input *input) {
    png_set_read_fn(input->png, input, get_bytes);
    png_set_user_limits(input->png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    png_read_info(input->png, input->info);
    input->width = png_get_image_width(input->png, input->info);
    input->height = png_get_image_height(input->png, input->info);
    if (input->width > SIDE_LIMIT || input->height > SIDE_LIMIT || (uint64_t)input->width * input->height > PIXEL_LIMIT)
        return kdr_report(input->logger, KDR_ERROR_LIMIT,
                          "%s: %u x %u pixels are more than %u a side or %u million in all", input->name, input->width,
                          input->height, SIDE_LIMIT, (unsigned)(PIXEL_LIMIT >> 20));
    uint64_t unpacked = (uint64_t)png_get_rowbytes(input->png, input->info) * input->height;
    if (unpacked / DEFLATE_EXPANSION > input->size)
        return kdr_report(input->logger, KDR_ERROR_INVALID_DATA, "%s: %zu bytes cannot hold %u x %u pixels",
                          input->name, input->size, input->width, input->height);
    return KDR_OK;
}

/* Asks for RGB samples of 8 or 16 bits and makes room for them. */
static kdr_status prepare_rows(png_input *input) {
    input->deep = png_get_bit_depth(input->png, input->info) == 16;
    png_set_expand(input->png);
    png_set_gray_to_rgb(input->png);
    png_set_strip_alpha(input->png);
    input->passes = png_set_interlace_handling(input->png);
    png_read_update_info(input->png, input->info);
    input->row_size = (size_t)input->width * (input->deep ? 6 : 3);
    if (png_get_rowbytes(input->png, input->info) != input->row_size)
        png_error(input->png, "rows of an unexpected size");

    size_t rows_size = input->row_size * (input->passes > 1 ? input->height : 1);
    input->rows = kdr_render_get(rows_size, 1);
    if (!input->rows)
        return KDR_ERROR_OUT_OF_MEMORY;
    input->rows_size = rows_size;
    return kdr_image_create(input->width, input->height, &input->image);
}

static void convert_row(png_input *input, const uint8_t *row, float *rgb) {
    size_t count = (size_t)input->width * 3;
    for (size_t i = 0; i < count; i++)
        rgb[i] = input->deep ? kdr_srgb_to_linear((float)(row[2 * i] << 8 | row[2 * i + 1]) / 65535)
                             : input->srgb->linear[row[i]];
}

/* Passes of an interlaced file fill in the same rows again and again; the last one completes them. */
static void read_rows(png_input *input) {
    for (int pass = 0; pass < input->passes; pass++) {
        for (uint32_t y = 0; y < input->height; y++) {
            uint8_t *row = input->rows + (input->passes > 1 ? y * input->row_size : 0);
            png_read_row(input->png, row, NULL);
            if (pass == input->passes - 1)
                convert_row(input, row, input->image->rgb + (size_t)y * input->width * 3);
        }
    }
    png_read_end(input->png, NULL);
}

static kdr_status decode(png_input *input) {
    if (setjmp(png_jmpbuf(input->png))) {
        if (input->fault.out_of_memory)
            return KDR_ERROR_OUT_OF_MEMORY;
        return kdr_report(input->logger, KDR_ERROR_INVALID_DATA, "%s: PNG data is broken at byte %zu: %s", input->name,
                          input->offset, input->fault.message);
    }
    kdr_status status = read_header(input);
    if (status == KDR_OK)
        status = prepare_rows(input);
    if (status == KDR_OK)
        read_rows(input);
    return status;
}

kdr_status kdr_image_decode_png(const uint8_t *bytes, size_t size, const char *name, const kdr_logger *logger,
                                kdr_image **out) {
    *out = NULL;
    if (size < SIGNATURE_BYTES || png_sig_cmp(bytes, 0, SIGNATURE_BYTES) != 0)
        return kdr_report(logger, KDR_ERROR_INVALID_DATA,
                          "%s: expected a PNG file, but its first 8 bytes are not the signature of one", name);
    png_input *input = kdr_render_get(1, sizeof(png_input));
    if (!input)
        return kdr_report(logger, KDR_ERROR_OUT_OF_MEMORY, "%s: out of memory while reading", name);
    *input = (png_input){
        .bytes = bytes, .size = size, .name = name, .logger = logger, .srgb = kdr_srgb_get_tables(), .passes = 1};
    input->png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, input, kdr_png_fail, kdr_png_ignore, input,
                                          kdr_png_get, kdr_png_release);
    input->info = input->png ? png_create_info_struct(input->png) : NULL;
    kdr_status status = input->info ? decode(input) : KDR_ERROR_OUT_OF_MEMORY;

    if (status == KDR_OK)
        *out = input->image;
    else
        kdr_image_destroy(input->image);
    if (status == KDR_ERROR_OUT_OF_MEMORY)
        kdr_report(logger, status, "%s: out of memory while reading", name);
    png_destroy_read_struct(&input->png, &input->info, NULL);
    kdr_render_release(input->rows, input->rows_size);
    kdr_render_release(input, sizeof(png_input));
    return status;
}

kdr_status kdr_image_read_png(const char *path, const kdr_logger *logger, kdr_image **out) {
    if (out)
        *out = NULL;
    if (!path || !out)
        return kdr_report(logger, KDR_ERROR_INVALID_ARGUMENT,
                          "reading a PNG file needs a file name and room for an image");
    kdr_file_bytes file;
    kdr_status status = kdr_file_bytes_open(path, logger, &file);
    if (status != KDR_OK)
        return status;
    status = kdr_image_decode_png(file.bytes, file.length, path, logger, out);
    kdr_file_bytes_release(&file);
    return status;
}
