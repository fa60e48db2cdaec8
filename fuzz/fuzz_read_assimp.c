/* A GLB of sound JSON whose numbers and binary chunk come from the input, through assimp. Text that is no glTF is not
 * tried: assimp then guesses among all of its formats, whose readers are not ours to mend. */
#include "reading.h"

#include <stdio.h>

#define MOST_JSON 2048

typedef struct input {
    const uint8_t *data;
    size_t size;
} input;

static uint32_t take(input *in, size_t bytes) {
    uint32_t value = 0;
    for (size_t i = 0; i < bytes && in->size; i++, in->data++, in->size--)
        value |= (uint32_t)*in->data << 8 * i;
    return value;
}

/* Usually what a sound file says, else anything, small or large. */
static uint32_t number(input *in, uint32_t sound) {
    uint32_t choice = take(in, 1);
    return choice < 128 ? sound : choice < 192 ? take(in, 1) : choice < 224 ? take(in, 2) : take(in, 4);
}

static float real(input *in) {
    uint32_t bits = take(in, 4);
    float value;
    memcpy(&value, &bits, sizeof value);
    return isfinite(value) ? value : 1;
}

static void put_word(uint8_t *to, uint32_t word) {
    for (int i = 0; i < 4; i++)
        to[i] = (uint8_t)(word >> 8 * i);
}

static size_t write_json(input *in, size_t binary_bytes, char json[MOST_JSON]) {
    static const char *const component_types[] = {"5126", "5123", "5125", "5121", "5120", "5122"};
    static const char *const types[] = {"\"VEC3\"", "\"SCALAR\"", "\"VEC2\"", "\"VEC4\"", "\"MAT4\""};
    uint32_t modes = take(in, 1), shapes = take(in, 1);
    float t[3] = {real(in), real(in), real(in)}, s[3] = {real(in), real(in), real(in)};
    int length = snprintf(
        json, MOST_JSON,
        "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"name\":\"a\","
        "\"translation\":[%g,%g,%g],\"scale\":[%g,%g,%g],\"mesh\":%u,\"children\":[1]},{\"mesh\":%u}],"
        "\"materials\":[{\"name\":\"m\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[%g,%g,0,1]}}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":%u,\"NORMAL\":%u},\"indices\":%u,\"mode\":%u,"
        "\"material\":%u}]}],\"accessors\":[{\"bufferView\":0,\"byteOffset\":%u,\"componentType\":%s,\"count\":%u,"
        "\"type\":%s},{\"bufferView\":%u,\"byteOffset\":%u,\"componentType\":%s,\"count\":%u,\"type\":%s}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteOffset\":%u,\"byteLength\":%u,\"byteStride\":%u},{\"buffer\":0,"
        "\"byteOffset\":%u,\"byteLength\":%u}],\"buffers\":[{\"byteLength\":%u}]}",
        (double)t[0], (double)t[1], (double)t[2], (double)s[0], (double)s[1], (double)s[2], number(in, 0),
        number(in, 0), (double)t[0], (double)s[0], number(in, 0), number(in, 0), number(in, 1),
        modes < 200 ? 4 : modes % 7, number(in, 0), number(in, 0), component_types[shapes < 128 ? 0 : shapes % 6],
        number(in, 4), types[shapes < 128 ? 0 : shapes / 6 % 5], number(in, 1), number(in, 0),
        component_types[shapes % 64 < 32 ? 1 : shapes % 6], number(in, 12), types[shapes % 64 < 48 ? 1 : shapes % 5],
        number(in, 0), number(in, 48), number(in, 12), number(in, 48), number(in, 24),
        number(in, (uint32_t)binary_bytes));
    must(length > 0 && length < MOST_JSON - 4);
    while (length % 4)
        json[length++] = ' ';
    return (size_t)length;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    // The binary chunk stands first: a mutation of the numbers leaves it in its place.
    input in = {data, size};
    size_t binary_bytes = take(&in, 1);
    const uint8_t *binary = in.data;
    binary_bytes = binary_bytes < in.size ? binary_bytes : in.size;
    in.data += binary_bytes;
    in.size -= binary_bytes;
    char json[MOST_JSON];
    size_t json_bytes = write_json(&in, binary_bytes, json), all = 12 + 8 + json_bytes + 8 + binary_bytes;
    uint8_t *glb = malloc(all);
    must(glb != NULL);
    memcpy(glb, "glTF", 4);
    put_word(glb + 4, 2);
    put_word(glb + 8, (uint32_t)all);
    put_word(glb + 12, (uint32_t)json_bytes);
    memcpy(glb + 16, "JSON", 4);
    memcpy(glb + 20, json, json_bytes);
    put_word(glb + 20 + json_bytes, (uint32_t)binary_bytes);
    memcpy(glb + 24 + json_bytes, "BIN", 4);
    if (binary_bytes)
        memcpy(glb + 28 + json_bytes, binary, binary_bytes);
    read_fuzzed("fuzz.glb", glb, all, kdr_read_assimp);
    free(glb);
    return 0;
}
