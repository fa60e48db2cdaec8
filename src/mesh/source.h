/* What a reader reads: bytes in memory, under the name that its sentences carry.
 *
 * Every reader takes a source and gives a mesh, or a sentence with the place (line of a text, byte of a binary
 * file) and what was expected there. Readers keep no pointer into the bytes. */
#ifndef KDR_MESH_SOURCE_H
#define KDR_MESH_SOURCE_H

#include "kdray/render.h"

typedef struct kdr_source {
    const char *name; /* in sentences, and for the ending that tells a format */
    const unsigned char *bytes;
    size_t length;
    bool siblings; /* files named inside may be opened: they lie beside `name` */
    const kdr_logger *logger;
} kdr_source;

/* "NAME: line N: ..." and "NAME: byte N: ..."; both return INVALID_DATA. Lines count from 1, bytes from 0. */
kdr_status kdr_source_fail_line(const kdr_source *source, size_t line, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
kdr_status kdr_source_fail_byte(const kdr_source *source, size_t byte, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* "NAME: ..." for what has no place; returns `status`. */
kdr_status kdr_source_fail(const kdr_source *source, kdr_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void kdr_source_warn(const kdr_source *source, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* The sentence of a failed allocation or a full mesh; anything else is returned untold. */
kdr_status kdr_source_fail_status(const kdr_source *source, kdr_status status);

/* Whether the name ends in `.ending` (lower case), a further `.gz` put aside, in any mixture of cases. */
bool kdr_source_has_ending(const kdr_source *source, const char *ending);

/* The readers. Errors: INVALID_DATA, UNSUPPORTED, OUT_OF_MEMORY, LIMIT, each with its sentence; *out is then NULL.
 * Positions may still be infinite or NaN, normals of any length: kdr_mesh_finish sees to that. */
kdr_status kdr_read_ply(const kdr_source *source, kdr_mesh **out);
kdr_status kdr_read_obj(const kdr_source *source, kdr_mesh **out);
kdr_status kdr_read_stl(const kdr_source *source, kdr_mesh **out);
kdr_status kdr_read_assimp(const kdr_source *source, kdr_mesh **out);

/* The same with an MD2 file as it is at a keyframe; others have none. */
kdr_status kdr_read_assimp_keyframe(const kdr_source *source, uint32_t keyframe, kdr_mesh **out);

/* Whether kdr_read_assimp knows the name's ending. False where the library was built without it. */
bool kdr_read_assimp_knows(const kdr_source *source);
bool kdr_read_assimp_is_built(void);

/* Content that a reader can be sure of. */
bool kdr_source_is_ply(const kdr_source *source);
bool kdr_source_is_stl(const kdr_source *source);
bool kdr_source_looks_like_obj(const kdr_source *source);

/* Unpacks if need be, finds the format, reads and finishes the mesh: kdr_mesh_read for bytes that are in memory. */
kdr_status kdr_mesh_read_source(const kdr_source *source, kdr_mesh **out);

#endif
