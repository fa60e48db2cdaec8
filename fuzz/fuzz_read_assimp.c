/* Bytes under the name of a GLB, through assimp. */
#include "reading.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    read_fuzzed("fuzz.glb", data, size, kdr_read_assimp);
    return 0;
}
