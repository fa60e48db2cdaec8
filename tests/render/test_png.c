/* PNG files: what is written is read again, all kinds are read, broken ones are refused, failures leave nothing. */
#include "render/image_png.h"
#include "rendering.h"

#include <dirent.h>
#include <fcntl.h>
#include <png.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>

static char folder[64];

static const char *path_in_folder(const char *name) {
    static char path[4][192];
    static unsigned turn;
    char *out = path[turn++ % 4];
    snprintf(out, sizeof path[0], "%s/%s", folder, name);
    return out;
}

static int make_folder(void **state) {
    (void)state;
    told.count = 0;
    snprintf(folder, sizeof folder, "/tmp/kdr-render-test-XXXXXX");
    return mkdtemp(folder) ? 0 : -1;
}

static int count_files(void) {
    int count = 0;
    DIR *directory = opendir(folder);
    assert_non_null(directory);
    for (struct dirent *entry; (entry = readdir(directory));)
        count += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
    closedir(directory);
    return count;
}

static int remove_folder(void **state) {
    (void)state;
    DIR *directory = opendir(folder);
    for (struct dirent *entry; (entry = readdir(directory));)
        unlinkat(dirfd(directory), entry->d_name, 0);
    closedir(directory);
    return rmdir(folder) != 0 || kdr_render_bytes() != 0;
}

/* Every 8-bit code in every channel; odd sides. */
static kdr_image *make_image(uint32_t width, uint32_t height) {
    kdr_image *image;
    assert_int_equal(kdr_image_create(width, height, &image), KDR_OK);
    for (size_t i = 0; i < (size_t)width * height * 3; i++) {
        double code = (double)(i * 7 % 256) / 255;
        image->rgb[i] = (float)(code <= 0.04045 ? code / 12.92 : pow((code + 0.055) / 1.055, 2.4));
    }
    return image;
}

static void an_image_written_and_read_again_has_the_same_8_bit_values(void **state) {
    (void)state;
    kdr_image *image = make_image(77, 31), *again;
    const char *path = path_in_folder("image.png");
    assert_int_equal(kdr_image_write_png(image, path, &hearing), KDR_OK);
    assert_int_equal(kdr_image_read_png(path, &hearing, &again), KDR_OK);
    assert_int_equal(again->width, 77);
    assert_int_equal(again->height, 31);
    double difference;
    assert_int_equal(kdr_image_compare(image, again, &difference), KDR_OK);
    assert_true(difference == 0);
    for (size_t i = 0; i < 77 * 31 * 3; i++)
        expect_near(again->rgb[i], image->rgb[i], 1e-6);
    assert_int_equal(count_files(), 1);
    kdr_image_destroy(again);
    kdr_image_destroy(image);
}

static void values_outside_0_to_1_are_clamped_and_nan_is_black(void **state) {
    (void)state;
    kdr_image *image, *again;
    assert_int_equal(kdr_image_create(1, 2, &image), KDR_OK);
    const float values[6] = {-1, 2, NAN, INFINITY, -INFINITY, 0.5f};
    const float wanted[6] = {0, 1, 0, 1, 0, 0.5f};
    memcpy(image->rgb, values, sizeof values);
    const char *path = path_in_folder("image.png");
    assert_int_equal(kdr_image_write_png(image, path, &hearing), KDR_OK);
    assert_int_equal(kdr_image_read_png(path, &hearing, &again), KDR_OK);
    for (int i = 0; i < 6; i++)
        expect_near(again->rgb[i], wanted[i], 0.004);
    kdr_image_destroy(again);
    kdr_image_destroy(image);
}

/* The difference of one step in one of three channels, over four pixels. */
static void the_difference_of_images_is_the_root_mean_square_of_their_codes(void **state) {
    (void)state;
    kdr_image *a, *b, *c;
    assert_int_equal(kdr_image_create(2, 2, &a), KDR_OK);
    assert_int_equal(kdr_image_create(2, 2, &b), KDR_OK);
    assert_int_equal(kdr_image_create(2, 1, &c), KDR_OK);
    double difference;
    assert_int_equal(kdr_image_compare(a, b, &difference), KDR_OK);
    expect_near(difference, 0, 0);
    b->rgb[4] = 1;
    assert_int_equal(kdr_image_compare(a, b, &difference), KDR_OK);
    expect_near(difference, 255 / sqrt(12), 1e-9);
    assert_int_equal(kdr_image_compare(a, c, &difference), KDR_ERROR_INVALID_ARGUMENT);
    kdr_image_destroy(a);
    kdr_image_destroy(b);
    kdr_image_destroy(c);
}

static void an_image_has_1_to_65536_pixels_a_side(void **state) {
    (void)state;
    const uint32_t sides[4][2] = {{0, 1}, {1, 0}, {65537, 1}, {1, 65537}};
    for (int i = 0; i < 4; i++) {
        kdr_image *image = (kdr_image *)folder;
        assert_int_equal(kdr_image_create(sides[i][0], sides[i][1], &image), KDR_ERROR_INVALID_ARGUMENT);
        assert_null(image);
    }
    kdr_image *image;
    assert_int_equal(kdr_image_create(65536, 1, &image), KDR_OK);
    assert_true(image->rgb[3 * 65535 + 2] == 0);
    kdr_image_destroy(image);
    assert_int_equal(kdr_image_create(1, 1, NULL), KDR_ERROR_INVALID_ARGUMENT);
}

/* Writes samples with libpng as they are: a file of any kind. */
static void write_kind(const char *path, uint32_t width, uint32_t height, int depth, int colour, int interlace,
                       uint8_t *rows, size_t row_size) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_set_IHDR(png, info, width, height, depth, colour, interlace, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_color palette[4] = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {255, 255, 255}};
    png_byte opacity[2] = {0, 128};
    if (colour == PNG_COLOR_TYPE_PALETTE) {
        png_set_PLTE(png, info, palette, 4);
        png_set_tRNS(png, info, opacity, 2, NULL);
    }
    png_write_info(png, info);
    png_bytep pointers[16];
    assert_true(height <= 16);
    for (uint32_t y = 0; y < height; y++)
        pointers[y] = rows + y * row_size;
    png_write_image(png, pointers);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    assert_int_equal(fclose(file), 0);
}

static void expect_pixel(const kdr_image *image, uint32_t x, uint32_t y, float r, float g, float b) {
    const float *rgb = pixel_at(image, x, y);
    expect_near(rgb[0], r, 1e-6);
    expect_near(rgb[1], g, 1e-6);
    expect_near(rgb[2], b, 1e-6);
}

static void palettes_of_2_bits_with_transparency_are_read(void **state) {
    (void)state;
    uint8_t rows[2] = {0x1b, 0xe4}; // pixels 0 1 2 3 and 3 2 1 0
    kdr_image *image;
    const char *path = path_in_folder("palette.png");
    write_kind(path, 4, 2, 2, PNG_COLOR_TYPE_PALETTE, PNG_INTERLACE_NONE, rows, 1);
    assert_int_equal(kdr_image_read_png(path, &hearing, &image), KDR_OK);
    expect_pixel(image, 0, 0, 1, 0, 0);
    expect_pixel(image, 1, 0, 0, 1, 0);
    expect_pixel(image, 2, 0, 0, 0, 1);
    expect_pixel(image, 3, 0, 1, 1, 1);
    expect_pixel(image, 3, 1, 1, 0, 0);
    kdr_image_destroy(image);
}

static void grey_of_1_bit_is_read_as_black_and_white(void **state) {
    (void)state;
    uint8_t rows[1] = {0xa0};
    kdr_image *image;
    const char *path = path_in_folder("grey.png");
    write_kind(path, 3, 1, 1, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, rows, 1);
    assert_int_equal(kdr_image_read_png(path, &hearing, &image), KDR_OK);
    expect_pixel(image, 0, 0, 1, 1, 1);
    expect_pixel(image, 1, 0, 0, 0, 0);
    expect_pixel(image, 2, 0, 1, 1, 1);
    kdr_image_destroy(image);
}

static void samples_of_16_bits_keep_what_8_bits_would_lose(void **state) {
    (void)state;
    uint8_t rows[16] = {0x80, 0x00, 0x80, 0x40, 0xff, 0xff, 0x12, 0x34, // RGBA, alpha is dropped
                        0x00, 0x00, 0x00, 0x01, 0x80, 0x80, 0xff, 0xff};
    kdr_image *image;
    const char *path = path_in_folder("deep.png");
    write_kind(path, 2, 1, 16, PNG_COLOR_TYPE_RGB_ALPHA, PNG_INTERLACE_NONE, rows, 16);
    assert_int_equal(kdr_image_read_png(path, &hearing, &image), KDR_OK);
    const double codes[6] = {0x8000, 0x8040, 0xffff, 0, 1, 0x8080};
    for (int i = 0; i < 6; i++) {
        double code = codes[i] / 65535;
        expect_near(image->rgb[i], code <= 0.04045 ? code / 12.92 : pow((code + 0.055) / 1.055, 2.4), 1e-7);
    }
    kdr_image_destroy(image);
}

static void an_interlaced_file_is_read_like_a_plain_one(void **state) {
    (void)state;
    uint8_t rows[13 * 11 * 3];
    for (size_t i = 0; i < sizeof rows; i++)
        rows[i] = (uint8_t)(i * 37);
    kdr_image *plain, *interlaced;
    write_kind(path_in_folder("plain.png"), 11, 13, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, rows, 33);
    write_kind(path_in_folder("interlaced.png"), 11, 13, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_ADAM7, rows, 33);
    assert_int_equal(kdr_image_read_png(path_in_folder("plain.png"), &hearing, &plain), KDR_OK);
    assert_int_equal(kdr_image_read_png(path_in_folder("interlaced.png"), &hearing, &interlaced), KDR_OK);
    assert_memory_equal(plain->rgb, interlaced->rgb, 13 * 11 * 3 * sizeof(float));
    kdr_image_destroy(plain);
    kdr_image_destroy(interlaced);
}

static size_t load(const char *path, uint8_t *bytes, size_t room) {
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    size_t size = fread(bytes, 1, room, file);
    fclose(file);
    assert_true(size < room);
    return size;
}

/* Decodes an exact copy on the heap, so that sanitizers see a read past its end. */
static kdr_status decode_copy(const uint8_t *bytes, size_t size, kdr_image **image) {
    uint8_t *copy = malloc(size ? size : 1);
    assert_non_null(copy);
    if (size)
        memcpy(copy, bytes, size);
    kdr_status status = kdr_image_decode_png(copy, size, "cut.png", &hearing, image);
    free(copy);
    return status;
}

static void a_file_cut_short_anywhere_is_refused_with_one_sentence(void **state) {
    (void)state;
    uint8_t rows[13 * 11 * 3], bytes[4096];
    for (size_t i = 0; i < sizeof rows; i++)
        rows[i] = (uint8_t)(i * i);
    const char *path = path_in_folder("whole.png");
    for (int interlace = 0; interlace < 2; interlace++) {
        write_kind(path, 11, 13, 8, PNG_COLOR_TYPE_RGB, interlace ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, rows, 33);
        size_t size = load(path, bytes, sizeof bytes);
        for (size_t length = 0; length < size; length++) {
            kdr_image *image = (kdr_image *)bytes;
            kdr_status status = decode_copy(bytes, length, &image);
            expect_failure(status, KDR_ERROR_INVALID_DATA, "cut.png: ");
            assert_null(image);
            assert_int_equal(kdr_render_bytes(), 0);
        }
        kdr_image *image;
        assert_int_equal(decode_copy(bytes, size, &image), KDR_OK);
        kdr_image_destroy(image);
    }
}

static void a_byte_changed_anywhere_never_leaves_memory_behind(void **state) {
    (void)state;
    uint8_t rows[8] = {1, 2, 3, 4, 5, 6, 7, 8}, bytes[1024];
    const char *path = path_in_folder("whole.png");
    write_kind(path, 8, 1, 8, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, rows, 8);
    size_t size = load(path, bytes, sizeof bytes);
    for (size_t i = 0; i < size; i++) {
        bytes[i] ^= 0x41;
        kdr_image *image;
        kdr_status status = decode_copy(bytes, size, &image);
        assert_true((status == KDR_OK) == (image != NULL));
        kdr_image_destroy(image);
        assert_int_equal(kdr_render_bytes(), 0);
        bytes[i] ^= 0x41;
    }
    told.count = 0;
}

/* A header alone, with its check sum, and a data chunk that begins. */
static void a_small_file_that_claims_a_huge_picture_is_refused_before_memory_is_taken(void **state) {
    (void)state;
    const struct {
        uint32_t width, height;
        kdr_status wanted;
    } claims[] = {{65536, 4096, KDR_ERROR_INVALID_DATA},
                  {70000, 1, KDR_ERROR_LIMIT},
                  {65536, 65536, KDR_ERROR_LIMIT},
                  {0x7fffffff, 0x7fffffff, KDR_ERROR_LIMIT}};
    for (size_t i = 0; i < sizeof claims / sizeof claims[0]; i++) {
        uint8_t bytes[64] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n', 0, 0, 0, 13, 'I', 'H', 'D', 'R'};
        for (int k = 0; k < 4; k++) {
            bytes[16 + k] = (uint8_t)(claims[i].width >> (24 - 8 * k));
            bytes[20 + k] = (uint8_t)(claims[i].height >> (24 - 8 * k));
        }
        bytes[24] = 8;
        bytes[25] = 2;
        uint32_t crc = 0xffffffff;
        for (int k = 12; k < 29; k++) {
            crc ^= bytes[k];
            for (int bit = 0; bit < 8; bit++)
                crc = crc >> 1 ^ (crc & 1 ? 0xedb88320 : 0);
        }
        for (int k = 0; k < 4; k++)
            bytes[29 + k] = (uint8_t)(~crc >> (24 - 8 * k));
        memcpy(bytes + 33, "\0\0\0\1IDAT", 8);
        kdr_image *image;
        kdr_status status = kdr_image_decode_png(bytes, sizeof bytes, "huge.png", &hearing, &image);
        expect_failure(status, claims[i].wanted, "pixels");
        assert_null(image);
    }
}

static void what_is_no_png_file_is_told_so(void **state) {
    (void)state;
    kdr_image *image;
    FILE *file = fopen(path_in_folder("text.png"), "wb");
    assert_non_null(file);
    fputs("a text that is no picture", file);
    fclose(file);
    expect_failure(kdr_image_read_png(path_in_folder("text.png"), &hearing, &image), KDR_ERROR_INVALID_DATA,
                   "signature");
    expect_failure(kdr_image_read_png(path_in_folder("missing.png"), &hearing, &image), KDR_ERROR_IO,
                   "No such file or directory");
    expect_failure(kdr_image_read_png(folder, &hearing, &image), KDR_ERROR_IO, folder);
    expect_failure(kdr_image_read_png(NULL, &hearing, &image), KDR_ERROR_INVALID_ARGUMENT, "needs a file name");
}

static void a_write_to_a_missing_folder_or_a_folder_says_why(void **state) {
    (void)state;
    kdr_image *image = make_image(3, 3);
    expect_failure(kdr_image_write_png(image, path_in_folder("none/a.png"), &hearing), KDR_ERROR_IO,
                   "none/a.png: No such file or directory");
    expect_failure(kdr_image_write_png(image, folder, &hearing), KDR_ERROR_IO, "Is a directory");
    expect_failure(kdr_image_write_png(NULL, folder, &hearing), KDR_ERROR_INVALID_ARGUMENT, "needs an image");
    assert_int_equal(count_files(), 0);
    kdr_image_destroy(image);
}

static void a_full_disk_says_so_and_leaves_the_device_in_place(void **state) {
    (void)state;
    kdr_image *image = make_image(300, 300);
    const char *path = path_in_folder("full.png");
    assert_int_equal(symlink("/dev/full", path), 0);
    expect_failure(kdr_image_write_png(image, path, &hearing), KDR_ERROR_IO, "full.png: No space left on device");
    struct stat info;
    assert_int_equal(stat(path, &info), 0);
    assert_true(S_ISCHR(info.st_mode));
    assert_int_equal(count_files(), 1);
    kdr_image_destroy(image);
}

/* The limit is met at once, early and late; the last time an older file stands there. */
static void a_file_that_may_not_grow_is_removed_and_the_older_one_stays(void **state) {
    (void)state;
    const char *path = path_in_folder("image.png");
    kdr_image *image = make_image(200, 200), *small = make_image(2, 2), *again;
    uint32_t noise = 1; // deflate makes nothing of it: more bytes than one write takes
    for (size_t i = 0; i < 200 * 200 * 3; i++)
        image->rgb[i] = (float)((noise = noise * 1664525 + 1013904223) >> 8) * 0x1p-24f;
    signal(SIGXFSZ, SIG_IGN);
    struct rlimit before, limited;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    const rlim_t limits[3] = {0, 1000, 100000};
    for (int i = 0; i < 3; i++) {
        limited = before;
        limited.rlim_cur = limits[i];
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &limited), 0);
        kdr_status status = kdr_image_write_png(image, path, &hearing);
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
        expect_failure(status, KDR_ERROR_IO, "image.png: File too large");
        assert_int_equal(count_files(), i == 2 ? 1 : 0);
        if (i == 1)
            assert_int_equal(kdr_image_write_png(small, path, &hearing), KDR_OK);
    }
    assert_int_equal(kdr_image_read_png(path, &hearing, &again), KDR_OK);
    assert_int_equal(again->width, 2);
    kdr_image_destroy(again);
    kdr_image_destroy(small);
    kdr_image_destroy(image);
}

static void a_symbolic_link_stays_and_its_file_is_replaced(void **state) {
    (void)state;
    kdr_image *image = make_image(5, 4), *again;
    FILE *file = fopen(path_in_folder("real.png"), "wb");
    assert_non_null(file);
    fclose(file);
    assert_int_equal(symlink("real.png", path_in_folder("link.png")), 0);
    assert_int_equal(kdr_image_write_png(image, path_in_folder("link.png"), &hearing), KDR_OK);
    struct stat info;
    assert_int_equal(lstat(path_in_folder("link.png"), &info), 0);
    assert_true(S_ISLNK(info.st_mode));
    assert_int_equal(kdr_image_read_png(path_in_folder("real.png"), &hearing, &again), KDR_OK);
    assert_int_equal(count_files(), 2);
    kdr_image_destroy(again);
    kdr_image_destroy(image);
}

int main(void) {
#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, make_folder, remove_folder)
    const struct CMUnitTest tests[] = {
        IN_FOLDER(an_image_written_and_read_again_has_the_same_8_bit_values),
        IN_FOLDER(values_outside_0_to_1_are_clamped_and_nan_is_black),
        IN_FOLDER(the_difference_of_images_is_the_root_mean_square_of_their_codes),
        IN_FOLDER(an_image_has_1_to_65536_pixels_a_side),
        IN_FOLDER(palettes_of_2_bits_with_transparency_are_read),
        IN_FOLDER(grey_of_1_bit_is_read_as_black_and_white),
        IN_FOLDER(samples_of_16_bits_keep_what_8_bits_would_lose),
        IN_FOLDER(an_interlaced_file_is_read_like_a_plain_one),
        IN_FOLDER(a_file_cut_short_anywhere_is_refused_with_one_sentence),
        IN_FOLDER(a_byte_changed_anywhere_never_leaves_memory_behind),
        IN_FOLDER(a_small_file_that_claims_a_huge_picture_is_refused_before_memory_is_taken),
        IN_FOLDER(what_is_no_png_file_is_told_so),
        IN_FOLDER(a_write_to_a_missing_folder_or_a_folder_says_why),
        IN_FOLDER(a_full_disk_says_so_and_leaves_the_device_in_place),
        IN_FOLDER(a_file_that_may_not_grow_is_removed_and_the_older_one_stays),
        IN_FOLDER(a_symbolic_link_stays_and_its_file_is_replaced),
    };
    return cmocka_run_group_tests_name("PNG files", tests, NULL, NULL);
}
