/* Any bytes without a telling name: unpacking and finding the format, then the readers. */
#include "reading.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    read_fuzzed("fuzz", data, size, kdr_mesh_read_source);
    return 0;
}
