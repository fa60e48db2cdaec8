/* An OBJ file, and after a zero byte the material file that goes with it. */
#include "mesh/mesh.h"
#include "mesh/obj.h"
#include "reading.h"

static kdr_status read_both(const kdr_source *source, kdr_mesh **out) {
    const uint8_t *zero = source->length ? memchr(source->bytes, 0, source->length) : NULL;
    kdr_source text = *source, library = *source;
    if (zero) {
        text.length = (size_t)(zero - source->bytes);
        library.bytes = zero + 1;
        library.length = source->length - text.length - 1;
    }
    kdr_status status = kdr_read_obj(&text, out);
    if (status != KDR_OK || !zero)
        return status;
    kdr_names names = {0};
    for (size_t i = 0; i < (*out)->material_count; i++) {
        const char *name = (*out)->materials[i].name;
        must(kdr_names_add(&names, (kdr_word){name, strlen(name)}) == KDR_OK);
    }
    kdr_mtl_read(&library, &names, *out);
    kdr_names_release(&names);
    return KDR_OK;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    read_fuzzed("fuzz.obj", data, size, read_both);
    return 0;
}
