/* Names of built-in scenes, where the name of a file may stand: "builtin:NAME[:TRIANGLES[:TIME]]". */
#ifndef KDR_MESH_BUILTIN_H
#define KDR_MESH_BUILTIN_H

#include "kdray/render.h"

#define KDR_BUILTIN_NAME_SIZE 64

typedef struct kdr_builtin {
    char name[KDR_BUILTIN_NAME_SIZE];
    size_t triangle_count; /* 0: the scene's own */
    double time;
} kdr_builtin;

bool kdr_builtin_is_meant(const char *path);

/* Takes a name apart; whether there is such a scene is not looked at. INVALID_ARGUMENT after a sentence. */
kdr_status kdr_builtin_parse(const char *path, const kdr_logger *logger, kdr_builtin *out);

#endif
