/* The body of a PLY file while it is read: a cursor, and values of any type at it. */
#ifndef KDR_MESH_PLY_BODY_H
#define KDR_MESH_PLY_BODY_H

#include "base/alloc.h"
#include "mesh/ply.h"

typedef struct kdr_ply_body {
    const kdr_source *source;
    const kdr_ply_header *header;
    const unsigned char *p, *end; /* of a binary body */
    kdr_text text;                /* of an ascii body */
    bool swaps;                   /* bytes stand in the other order than this machine's */
    kdr_mesh *mesh;
    kdr_buffer polygon;   /* vertex numbers of the list that is being read */
    size_t skipped_count; /* faces of fewer than three corners */
} kdr_ply_body;

/* INVALID_DATA with the line or byte of the cursor. */
kdr_status kdr_ply_fail(const kdr_ply_body *body, const char *format, ...) __attribute__((format(printf, 2, 3)));

size_t kdr_ply_bytes_left(const kdr_ply_body *body);

/* Refuses an element whose rows cannot fit into what is left of the file. A number of an ascii body takes two bytes. */
kdr_status kdr_ply_check_room(const kdr_ply_body *body, const kdr_ply_element *element);

/* Beginning and end of a row: a line of an ascii body, nothing in a binary one. */
kdr_status kdr_ply_begin_row(kdr_ply_body *body, const kdr_ply_element *element, uint64_t row);
kdr_status kdr_ply_end_row(kdr_ply_body *body);

/* The value at the cursor, which moves past it. Every type fits a double. */
kdr_status kdr_ply_read_value(kdr_ply_body *body, kdr_ply_type type, double *out);

/* The count of a list; its values fit into what is left of the file. */
kdr_status kdr_ply_read_count(kdr_ply_body *body, const kdr_ply_property *list, size_t *out);

kdr_status kdr_ply_skip_property(kdr_ply_body *body, const kdr_ply_property *property);
kdr_status kdr_ply_skip_element(kdr_ply_body *body, const kdr_ply_element *element);

/* A scalar in memory. */
double kdr_ply_decode(const unsigned char *p, kdr_ply_type type, bool swaps);

/* Vertices with x, y, z and perhaps nx, ny, nz into the mesh. */
kdr_status kdr_ply_read_vertices(kdr_ply_body *body, const kdr_ply_element *element);

/* Polygons, or with is_strips triangle strips in which -1 begins a new one, into the mesh's triangles. */
kdr_status kdr_ply_read_faces(kdr_ply_body *body, const kdr_ply_element *element, bool is_strips);

#endif
