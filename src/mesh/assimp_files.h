/* The files that assimp sees: the source's own bytes, and regular files beside it where the source allows. */
#ifndef KDR_MESH_ASSIMP_FILES_H
#define KDR_MESH_ASSIMP_FILES_H

#include "mesh/source.h"

#include <assimp/cfileio.h>

/* What the files need to know; lives as long as the import. */
typedef struct kdr_assimp_files {
    const kdr_source *source;
    const char *name; /* by which assimp asks for the source's bytes */
} kdr_assimp_files;

/* Fills in the functions by which assimp opens files. */
void kdr_assimp_files_begin(kdr_assimp_files *files, struct aiFileIO *io);

#endif
