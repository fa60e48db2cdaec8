#include "reading.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    read_fuzzed("fuzz.ply", data, size, kdr_read_ply);
    return 0;
}
