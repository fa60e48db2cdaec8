/* Mesh files: opened, unpacked, told apart, read and finished. */
#include "mesh/builtin.h"
#include "mesh/file_bytes.h"
#include "mesh/finish.h"
#include "mesh/glb_frame.h"
#include "mesh/report.h"
#include "mesh/source.h"

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

kdr_status kdr_mesh_read(const char *path, const kdr_logger *logger, kdr_mesh **out) {
    if (!out)
        return kdr_report(logger, KDR_ERROR_INVALID_ARGUMENT, "expected a place for the mesh, found NULL");
    *out = NULL;
    if (!path)
        return kdr_report(logger, KDR_ERROR_INVALID_ARGUMENT, "expected a path, found NULL");
    if (kdr_builtin_is_meant(path)) {
        kdr_builtin scene;
        kdr_status status = kdr_builtin_parse(path, logger, &scene);
        return status == KDR_OK ? kdr_mesh_make(scene.name, scene.triangle_count, scene.time, logger, out) : status;
    }

    kdr_file_bytes file;
    kdr_status status = kdr_file_bytes_open(path, logger, &file);
    if (status != KDR_OK)
        return status;
    kdr_source source = {path, file.bytes, file.length, true, logger};
    status = kdr_mesh_read_source(&source, out);
    kdr_file_bytes_release(&file);
    return status;
}
