/* One read of fuzzed bytes: whatever they are, a mesh that keeps its promise or one sentence, and no memory left. */
#ifndef KDR_FUZZ_READING_H
#define KDR_FUZZ_READING_H

#include "mesh/finish.h"
#include "mesh/source.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* assimp loses memory when it gives up a file; what kdray loses is counted by kdr_render_bytes. */
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void) { return "leak:libassimp"; }

static inline void must(bool holds) {
    if (!holds)
        abort();
}

static inline void count_errors(kdr_log_level level, const char *message, void *user) {
    must(message[0] != '\0' && !strchr(message, '\n'));
    if (level == KDR_LOG_ERROR)
        ++*(int *)user;
}

static inline void check_mesh(const kdr_mesh *mesh) {
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        must(isfinite(mesh->positions[i]));
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++)
        must(mesh->indices[i] < mesh->vertex_count);
    for (size_t i = 0; mesh->normals && i < mesh->vertex_count; i++) {
        const float *n = mesh->normals + 3 * i;
        must(fabsf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-4f);
    }
    for (size_t i = 0; mesh->triangle_materials && i < mesh->triangle_count; i++)
        must(mesh->triangle_materials[i] < mesh->material_count);
    for (size_t i = 0; i < mesh->material_count; i++) {
        must(mesh->materials[i].name != NULL);
        for (int k = 0; k < 3; k++)
            must(mesh->materials[i].diffuse[k] >= 0 && mesh->materials[i].diffuse[k] <= 1);
    }
}

/* read is one reader, or kdr_mesh_read_source. */
static inline void read_fuzzed(const char *name, const uint8_t *data, size_t size,
                               kdr_status (*read)(const kdr_source *, kdr_mesh **)) {
    int errors = 0;
    kdr_logger logger = {count_errors, &errors};
    kdr_source source = {name, data, size, false, &logger};
    kdr_mesh *mesh;
    kdr_status status = read(&source, &mesh);
    must((status == KDR_OK) == (mesh != NULL));
    must(errors == (status != KDR_OK));
    if (status == KDR_OK && read != kdr_mesh_read_source)
        must(kdr_mesh_finish(mesh, &source) == KDR_OK);
    if (status == KDR_OK)
        check_mesh(mesh);
    kdr_mesh_destroy(mesh);
    must(kdr_render_bytes() == 0);
}

#endif
