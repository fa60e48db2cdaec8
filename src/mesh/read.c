/* Mesh files: opened, unpacked, told apart, read and finished. */
#include "mesh/file_bytes.h"
#include "mesh/finish.h"
#include "mesh/glb_frame.h"
#include "mesh/number.h"
#include "mesh/report.h"
#include "mesh/source.h"

#include <math.h>
#include <string.h>

typedef kdr_status reader(const kdr_source *source, kdr_mesh **out);

/* Content first, then the name, then content that is only likely. NULL: nobody knows it. */
static reader *find_reader(const kdr_source *source) {
    if (kdr_source_is_ply(source))
        return kdr_read_ply;
    if (kdr_source_is_glb(source))
        return kdr_read_assimp;
    if (kdr_source_is_stl(source))
        return kdr_read_stl;
    if (kdr_source_has_ending(source, "ply"))
        return kdr_read_ply;
    if (kdr_source_has_ending(source, "obj"))
        return kdr_read_obj;
    if (kdr_source_has_ending(source, "stl"))
        return kdr_read_stl;
    if (kdr_read_assimp_knows(source))
        return kdr_read_assimp;
    return kdr_source_looks_like_obj(source) ? kdr_read_obj : NULL;
}

static kdr_status read_unpacked(const kdr_source *source, kdr_mesh **out) {
    if (source->length == 0)
        return kdr_source_fail_byte(source, 0, "expected a mesh file, found an empty one");
    reader *read = find_reader(source);
    if (!read)
        return kdr_source_fail(source, KDR_ERROR_UNSUPPORTED, "expected a mesh (PLY, OBJ, STL%s), found none of them",
                               kdr_read_assimp_is_built() ? ", glTF or another that assimp reads" : "");
    kdr_mesh *mesh;
    kdr_status status = read(source, &mesh);
    if (status == KDR_OK)
        status = kdr_mesh_finish(mesh, source);
    if (status == KDR_OK)
        *out = mesh;
    else
        kdr_mesh_destroy(mesh);
    return status;
}

kdr_status kdr_mesh_read_source(const kdr_source *source, kdr_mesh **out) {
    *out = NULL;
    if (!kdr_bytes_are_gzip(source->bytes, source->length))
        return read_unpacked(source, out);
    kdr_file_bytes unpacked;
    kdr_status status = kdr_bytes_unpack(source->name, source->bytes, source->length, source->logger, &unpacked);
    if (status != KDR_OK)
        return status;
    kdr_source inside = *source;
    inside.bytes = unpacked.bytes;
    inside.length = unpacked.length;
    status = read_unpacked(&inside, out);
    kdr_file_bytes_release(&unpacked);
    return status;
}

#define BUILTIN "builtin:"
#define MAX_BUILTIN_NAME 63

/* NAME[:TRIANGLES[:TIME]] */
static kdr_status make_builtin(const char *text, const kdr_logger *logger, kdr_mesh **out) {
    char name[MAX_BUILTIN_NAME + 1];
    size_t length = strcspn(text, ":");
    const char *p = text + length, *end = text + strlen(text);
    int64_t triangle_count = 0;
    double time = 0;
    bool is_sound = length <= MAX_BUILTIN_NAME;
    if (is_sound && *p == ':') {
        p++;
        is_sound = kdr_number_read_int(&p, end, &triangle_count) && triangle_count >= 0;
    }
    if (is_sound && *p == ':') {
        p++;
        is_sound = kdr_number_read_double(&p, end, &time) && isfinite(time);
    }
    if (!is_sound || p != end)
        return kdr_report(logger, KDR_ERROR_INVALID_ARGUMENT,
                          "%s%s: expected " BUILTIN "NAME, NAME:TRIANGLES or NAME:TRIANGLES:SECONDS", BUILTIN, text);
    memcpy(name, text, length);
    name[length] = '\0';
    return kdr_mesh_make(name, (size_t)triangle_count, time, logger, out);
}

kdr_status kdr_mesh_read(const char *path, const kdr_logger *logger, kdr_mesh **out) {
    if (!out)
        return kdr_report(logger, KDR_ERROR_INVALID_ARGUMENT, "expected a place for the mesh, found NULL");
    *out = NULL;
    if (!path)
        return kdr_report(logger, KDR_ERROR_INVALID_ARGUMENT, "expected a path, found NULL");
    if (strncmp(path, BUILTIN, strlen(BUILTIN)) == 0)
        return make_builtin(path + strlen(BUILTIN), logger, out);

    kdr_file_bytes file;
    kdr_status status = kdr_file_bytes_open(path, logger, &file);
    if (status != KDR_OK)
        return status;
    kdr_source source = {path, file.bytes, file.length, true, logger};
    status = kdr_mesh_read_source(&source, out);
    kdr_file_bytes_release(&file);
    return status;
}
