/* A glTF or GLB file that kdray plays itself: whatever the bytes, samples that keep the promise of a mesh, or one
 * sentence, and no memory left. */
#include "mesh/gltf_animation.h"
#include "reading.h"

static void sample_some(const kdr_animation_source *animation, const kdr_logger *logger, int *errors) {
    static const double shares[] = {0, 0.5, 1, 0.25};
    kdr_mesh *mesh = NULL;
    for (size_t i = 0; i < sizeof shares / sizeof shares[0]; i++) {
        *errors = 0;
        kdr_status status = animation->sample(animation->state, shares[i] * animation->duration, logger, &mesh);
        must(*errors == (status != KDR_OK));
        must(mesh != NULL);
        check_mesh(mesh);
    }
    kdr_mesh_destroy(mesh);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    int errors = 0;
    kdr_logger logger = {count_errors, &errors};
    kdr_source source = {"fuzz.gltf", data, size, false, &logger};
    kdr_animation_source animation;
    kdr_status status = kdr_gltf_animation_open_source(&source, &animation);
    must((status == KDR_OK) == (animation.state != NULL));
    must(errors == (status != KDR_OK));
    if (status == KDR_OK) {
        must(animation.duration >= 0 && isfinite(animation.duration));
        sample_some(&animation, &logger, &errors);
        animation.destroy(animation.state);
    }
    must(kdr_render_bytes() == 0);
    return 0;
}
