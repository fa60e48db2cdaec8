/* Material files of OBJ: newmtl and Kd, all else passed over. They lie beside the OBJ file. */
#include "mesh/file_bytes.h"
#include "mesh/obj.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

static float clamp_to_unit(double value) { return value < 0 ? 0.0f : value > 1 ? 1.0f : (float)value; }

void kdr_mtl_read(const kdr_source *source, const kdr_names *names, kdr_mesh *mesh) {
    const char *start = (const char *)source->bytes;
    kdr_text text = {start, start + source->length, 1, true};
    uint32_t material = KDR_INVALID_ID;
    while (kdr_text_skip_blank_lines(&text)) {
        kdr_word word = kdr_text_take_word(&text);
        if (kdr_word_is(word, "newmtl")) {
            material = kdr_names_find(names, kdr_text_take_rest(&text));
        } else if (kdr_word_is(word, "Kd") && material != KDR_INVALID_ID) {
            double rgb[3];
            size_t line = text.line;
            bool is_whole = true;
            for (int i = 0; i < 3 && is_whole; i++)
                is_whole = kdr_text_take_double(&text, &rgb[i]) && isfinite(rgb[i]);
            for (int i = 0; i < 3 && is_whole; i++)
                mesh->materials[material].diffuse[i] = clamp_to_unit(rgb[i]);
            if (!is_whole)
                kdr_source_warn(source, "line %zu: expected three numbers after Kd; the colour stays grey", line);
        }
        kdr_text_skip_rest(&text);
    }
}

/* Reads a material file beside the source. Only regular files: what a file names must not make us wait for a pipe. */
static bool read_library(kdr_obj *obj, kdr_word name) {
    char path[PATH_MAX];
    const char *base = obj->source->name, *slash = strrchr(base, '/');
    int folder_length = slash && *name.start != '/' ? (int)(slash + 1 - base) : 0;
    if (name.length >= sizeof path)
        return false;
    int length = snprintf(path, sizeof path, "%.*s%.*s", folder_length, base, (int)name.length, name.start);
    if (length < 0 || (size_t)length >= sizeof path)
        return false;
    for (char *c = path + folder_length; *c; c++)
        if (*c == '\\')
            *c = '/';

    struct stat about;
    kdr_file_bytes file;
    if (stat(path, &about) != 0 || !S_ISREG(about.st_mode) || kdr_file_bytes_open(path, NULL, &file) != KDR_OK)
        return false;
    kdr_source source = {path, file.bytes, file.length, false, obj->source->logger};
    kdr_mtl_read(&source, &obj->materials, obj->mesh);
    kdr_file_bytes_release(&file);
    return true;
}

/* A file that names itself on every line must not be read again for each of them. */
#define MAX_LIBRARIES 64

void kdr_obj_read_libraries(kdr_obj *obj) {
    const kdr_obj_library *libraries = obj->libraries.memory;
    int opened = 0;
    for (size_t i = 0; i < obj->library_count && obj->source->siblings; i++) {
        if (++opened > MAX_LIBRARIES) {
            kdr_source_warn(obj->source, "line %zu: more than %d material files; the others are passed over",
                            libraries[i].line, MAX_LIBRARIES);
            return;
        }
        // A name may hold blanks, a line several names.
        kdr_word names = libraries[i].names;
        if (names.length == 0 || obj->materials.count == 0 || read_library(obj, names))
            continue;
        kdr_text text = {names.start, names.start + names.length, 1, false};
        bool is_one = true;
        for (; !kdr_text_at_line_end(&text) && opened <= MAX_LIBRARIES; opened++) {
            kdr_word name = kdr_text_take_word(&text);
            is_one &= name.length == names.length;
            if (is_one || !read_library(obj, name))
                kdr_source_warn(obj->source, "line %zu: material file '%.*s' cannot be read; its materials stay grey",
                                libraries[i].line, (int)(name.length < 200 ? name.length : 200), name.start);
        }
    }
}
