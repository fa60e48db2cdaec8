/* An OBJ file while it is read. Internal to read_obj.c, obj_faces.c, obj_normals.c and read_mtl.c. */
#ifndef KDR_MESH_OBJ_H
#define KDR_MESH_OBJ_H

#include "base/alloc.h"
#include "mesh/merge.h"
#include "mesh/source.h"
#include "mesh/text.h"

/* v, vt and vn: what a corner of a face names. */
enum { KDR_OBJ_POSITION, KDR_OBJ_TEXTURE, KDR_OBJ_NORMAL, KDR_OBJ_KINDS };
extern const char *const kdr_obj_kind_names[KDR_OBJ_KINDS];

/* A number that the file has not come to yet; it must be there by the end. */
typedef struct kdr_obj_forward {
    size_t number; /* largest seen, from 1; 0: none */
    size_t line;
} kdr_obj_forward;

typedef struct kdr_obj {
    const kdr_source *source;
    kdr_text text;
    kdr_mesh *mesh;
    size_t counts[KDR_OBJ_KINDS]; /* of the lines so far; positions: the mesh's vertices */
    kdr_obj_forward forward[KDR_OBJ_KINDS];
    kdr_buffer normals;        /* 3 floats each */
    kdr_buffer corner_normals; /* a normal's number for each index of the mesh, or KDR_INVALID_ID */
    bool has_corner_normals;   /* from the first face with one */
    kdr_buffer polygon;        /* positions' and normals' numbers of the face that is being read */
    kdr_names materials;       /* numbered as the mesh's */
    uint32_t material;         /* of the faces to come */
    kdr_buffer libraries;      /* kdr_obj_library of each line mtllib */
    size_t library_count;
    size_t skipped_count; /* faces of fewer than three corners */
} kdr_obj;

typedef struct kdr_obj_library {
    kdr_word names; /* the line's rest: one name with blanks, or several */
    size_t line;
} kdr_obj_library;

/* The rest of a line `f`. */
kdr_status kdr_obj_read_face(kdr_obj *obj);

/* Gives every vertex one normal: vertices whose corners have different ones are split. */
kdr_status kdr_obj_split_normals(kdr_obj *obj);

/* Sets the colours of materials named in `names` (numbered as the mesh's) from the text of an .mtl file. Wrong lines
 * are told as warnings. */
void kdr_mtl_read(const kdr_source *source, const kdr_names *names, kdr_mesh *mesh);

/* Opens the material files named; one that cannot be read is a warning. */
void kdr_obj_read_libraries(kdr_obj *obj);

#endif
