#include "reading.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    read_fuzzed("fuzz.stl", data, size, kdr_read_stl);
    return 0;
}
