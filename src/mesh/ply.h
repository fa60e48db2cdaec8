/* The header of a PLY file: what its body holds, element by element. */
#ifndef KDR_MESH_PLY_H
#define KDR_MESH_PLY_H

#include "mesh/source.h"
#include "mesh/text.h"

/* More than any known writer uses; files beyond are refused with LIMIT. */
#define KDR_PLY_MAX_ELEMENTS 32
#define KDR_PLY_MAX_PROPERTIES 384

typedef enum kdr_ply_type {
    KDR_PLY_INT8,
    KDR_PLY_UINT8,
    KDR_PLY_INT16,
    KDR_PLY_UINT16,
    KDR_PLY_INT32,
    KDR_PLY_UINT32,
    KDR_PLY_FLOAT32,
    KDR_PLY_FLOAT64,
} kdr_ply_type;

typedef struct kdr_ply_property {
    kdr_word name;
    kdr_ply_type type;
    kdr_ply_type count_type; /* of a list */
    bool is_list;
} kdr_ply_property;

typedef struct kdr_ply_element {
    kdr_word name;
    uint64_t count; /* rows */
    size_t line;    /* in the header */
    kdr_ply_property *properties;
    size_t property_count;
    size_t list_count;  /* of the properties, those that are lists */
    size_t least_bytes; /* of a row in a binary body: scalars and the lists' counts */
} kdr_ply_element;

typedef struct kdr_ply_header {
    bool is_ascii;
    bool is_big_endian;
    kdr_ply_element elements[KDR_PLY_MAX_ELEMENTS];
    size_t element_count;
    kdr_ply_property properties[KDR_PLY_MAX_PROPERTIES]; /* of all elements, in order */
    size_t property_count;
    size_t body;      /* where it begins, bytes from the start of the file */
    size_t body_line; /* its first line */
} kdr_ply_header;

size_t kdr_ply_type_bytes(kdr_ply_type type);

/* Names point into the source. Errors: INVALID_DATA, UNSUPPORTED (another version), LIMIT, each with its sentence. */
kdr_status kdr_ply_read_header(const kdr_source *source, kdr_ply_header *header);

/* The position of a property in its element, or property_count. */
size_t kdr_ply_find_property(const kdr_ply_element *element, const char *name);

#endif
