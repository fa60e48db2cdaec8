/* The bytes of a glTF file's buffers, copied: the file may change or go while it plays.
 *
 * Source: S. Josefsson, "The Base16, Base32, and Base64 Data Encodings", RFC 4648, 2006. */
#include "mesh/file_bytes.h"
#include "mesh/gltf_asset.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/* The six bits of a letter; -1: none. */
static int sextet(char c) {
    if (c >= 'A' && c <= 'Z')
        return c - 'A';
    if (c >= 'a' && c <= 'z')
        return c - 'a' + 26;
    if (c >= '0' && c <= '9')
        return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : -1;
}

/* Fills `length` bytes; false when the text holds fewer or is no base64. JSON may write '/' as "\/". */
static bool decode_base64(const char *p, const char *end, unsigned char *out, size_t length) {
    uint32_t bits = 0;
    int count = 0;
    size_t done = 0;
    for (; p < end && *p != '=' && done < length; p++) {
        if (*p == '\\')
            continue;
        int six = sextet(*p);
        if (six < 0)
            return false;
        bits = bits << 6 | (uint32_t)six;
        count += 6;
        if (count >= 8) {
            count -= 8;
            out[done++] = (unsigned char)(bits >> count);
        }
    }
    return done == length;
}

static kdr_status read_text(const kdr_gltf *gltf, const kdr_json_value *uri, unsigned char *out, size_t length) {
    static const char mark[] = ";base64,";
    const char *start = memmem(uri->text.start, uri->text.length, mark, sizeof mark - 1);
    if (!start)
        return kdr_gltf_fail(gltf, uri, "a data: URI in base64");
    if (!decode_base64(start + sizeof mark - 1, uri->text.start + uri->text.length, out, length))
        return kdr_gltf_fail(gltf, uri, "base64 of as many bytes as the buffer has");
    return KDR_OK;
}

static int hex_digit(char c) {
    if (c >= '0' && c <= '9')
        return c - '0';
    c = (char)(c | 0x20);
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

/* The path of a file in the source's folder or below; false for any other, or where it is too long. */
static bool find_path(const kdr_source *source, kdr_word uri, char path[PATH_MAX]) {
    size_t length = 0;
    for (size_t i = 0; source->name[i]; i++)
        length = source->name[i] == '/' ? i + 1 : length;
    if (length + uri.length + 1 > PATH_MAX || uri.length == 0)
        return false;
    memcpy(path, source->name, length);
    size_t begin = length;
    for (const char *p = uri.start, *end = uri.start + uri.length; p < end; p++) {
        char c = *p;
        if (c == '\\') { // "\/" alone
            if (end - p < 2 || p[1] != '/')
                return false;
            c = *++p;
        } else if (c == '%') {
            int high = end - p > 2 ? hex_digit(p[1]) : -1, low = end - p > 2 ? hex_digit(p[2]) : -1;
            if (high < 0 || low < 0)
                return false;
            c = (char)(high << 4 | low);
            p += 2;
        }
        if (c == '\0' || c == ':')
            return false;
        path[length++] = c;
    }
    path[length] = '\0';
    return path[begin] != '/' && !strstr(path + begin, "..");
}

/* Opens the file before memory is asked for: a buffer's length is only what the JSON says of it. */
static kdr_status read_file(kdr_gltf_asset *asset, const kdr_json_value *uri, size_t length, unsigned char **out) {
    const kdr_source *source = asset->gltf.source;
    char path[PATH_MAX];
    if (!source->siblings || !find_path(source, uri->text, path))
        return kdr_gltf_fail(&asset->gltf, uri, "a buffer in a file beside this one");
    struct stat about;
    if (stat(path, &about) != 0 || !S_ISREG(about.st_mode))
        return kdr_source_fail(source, KDR_ERROR_IO, "byte %zu: expected the file '%s', which cannot be opened",
                               uri->byte, path);
    kdr_file_bytes file;
    kdr_status status = kdr_file_bytes_open(path, source->logger, &file);
    if (status != KDR_OK)
        return status;
    *out = file.length < length ? NULL : kdr_gltf_take(&asset->store, length, 1);
    if (*out)
        memcpy(*out, file.bytes, length);
    else if (file.length < length)
        status = kdr_source_fail_byte(source, uri->byte, "expected a file of at least %zu bytes, '%s' has %zu", length,
                                      path, file.length);
    else
        status = kdr_source_fail_status(source, KDR_ERROR_OUT_OF_MEMORY);
    kdr_file_bytes_release(&file);
    return status;
}

static kdr_status read_buffer(kdr_gltf_asset *asset, size_t number, unsigned char **out) {
    const kdr_gltf *gltf = &asset->gltf;
    const kdr_json_value *uri = kdr_gltf_find(asset, asset->objects[KDR_GLTF_BUFFERS][number], "uri");
    bool is_text = uri && uri->text.length > 5 && memcmp(uri->text.start, "data:", 5) == 0;
    size_t length = (size_t)gltf->buffers[number];
    if (uri && !is_text)
        return read_file(asset, uri, length, out);
    *out = kdr_gltf_take(&asset->store, length, 1);
    if (!*out)
        return kdr_source_fail_status(gltf->source, KDR_ERROR_OUT_OF_MEMORY);
    if (is_text)
        return read_text(gltf, uri, *out, length);
    memcpy(*out, gltf->source->bytes + gltf->binary_begin, length);
    return KDR_OK;
}

kdr_status kdr_gltf_read_buffers(kdr_gltf_asset *asset) {
    size_t count = asset->gltf.counts[KDR_GLTF_BUFFERS];
    asset->buffers = kdr_gltf_take(&asset->store, count, sizeof(void *));
    if (!asset->buffers)
        return kdr_source_fail_status(asset->gltf.source, KDR_ERROR_OUT_OF_MEMORY);
    for (size_t i = 0; i < count; i++) {
        unsigned char *bytes = NULL;
        kdr_status status = read_buffer(asset, i, &bytes);
        if (status != KDR_OK)
            return status;
        asset->buffers[i] = bytes;
        asset->buffer_bytes += asset->gltf.buffers[i];
    }
    return KDR_OK;
}
