/* What stands on the accessors: meshes, nodes, skins and animations. */
#include "mesh/gltf_check.h"
#include "mesh/mesh_memory.h"

#include <string.h>

/* Nodes inside one another: assimp walks them on the machine's own stack. */
#define MAX_NODE_DEPTH 512

#define FOR_EACH(gltf, one, value)                                                                                     \
    for (const kdr_json_value *one = kdr_json_first(&(gltf)->json, value); one; one = kdr_json_next(&(gltf)->json, one))

static const kdr_json_value *find(const kdr_gltf *gltf, const kdr_json_value *object, const char *key) {
    return kdr_json_find(&gltf->json, object, key);
}

static bool begins(kdr_word word, const char *start) {
    return word.length >= strlen(start) && memcmp(word.start, start, strlen(start)) == 0;
}

/* Whether values are of the kind that their attribute's name asks for. */
static bool suits(kdr_word name, const kdr_gltf_accessor *accessor) {
    bool is_float = accessor->component == KDR_GLTF_FLOAT;
    bool is_unsigned = accessor->component == KDR_GLTF_UBYTE || accessor->component == KDR_GLTF_USHORT;
    if (kdr_word_is(name, "POSITION") || kdr_word_is(name, "NORMAL"))
        return is_float && accessor->width == 3;
    if (kdr_word_is(name, "TANGENT"))
        return is_float && (accessor->width == 4 || accessor->width == 3); // of morph targets: three
    if (begins(name, "TEXCOORD"))
        return accessor->width == 2;
    if (begins(name, "COLOR"))
        return accessor->width == 3 || accessor->width == 4;
    if (begins(name, "JOINT"))
        return is_unsigned && accessor->width == 4;
    if (begins(name, "WEIGHT"))
        return (is_float || is_unsigned) && accessor->width == 4;
    return true;
}

/* All attributes are as many as the positions; *count is KDR_INVALID_ID before the first is seen. */
static kdr_status check_attributes(const kdr_gltf *gltf, const kdr_json_value *attributes, uint64_t *count) {
    if (attributes->kind != KDR_JSON_OBJECT)
        return kdr_gltf_fail(gltf, attributes, "an object of attributes");
    FOR_EACH(gltf, attribute, attributes) {
        uint32_t number;
        kdr_status status = kdr_gltf_check_reference(gltf, attribute, KDR_GLTF_ACCESSORS, &number);
        if (status != KDR_OK)
            return status;
        const kdr_gltf_accessor *accessor = &gltf->accessors[number];
        if (!suits(attribute->key, accessor))
            return kdr_source_fail_byte(
                gltf->source, attribute->byte, "expected an accessor of the type that '%.*s' has",
                (int)(attribute->key.length < 40 ? attribute->key.length : 40), attribute->key.start);
        if (*count != KDR_INVALID_ID && accessor->count != *count)
            return kdr_gltf_fail(gltf, attribute, "as many values as the other attributes have");
        *count = accessor->count;
    }
    return KDR_OK;
}

/* Vertex numbers that lie in this file are compared with the count of vertices. Of those that lie elsewhere assimp
 * leaves out the triangles that are wrong, but for loops and fans it does so at the price of a crash. */
static kdr_status check_indices(const kdr_gltf *gltf, const kdr_json_value *primitive, const kdr_gltf_accessor *indices,
                                uint64_t vertex_count, uint64_t mode) {
    size_t bytes = indices->component == KDR_GLTF_UBYTE    ? 1
                   : indices->component == KDR_GLTF_USHORT ? 2
                   : indices->component == KDR_GLTF_UINT   ? 4
                                                           : 0;
    if (bytes == 0 || indices->width != 1)
        return kdr_gltf_fail(gltf, primitive, "'indices' to be whole numbers");
    if (indices->begin == 0)
        return gltf->is_own || mode == 4 || mode < 2
                   ? KDR_OK
                   : kdr_source_fail(gltf->source, KDR_ERROR_UNSUPPORTED,
                                     "byte %zu: expected strips, loops and fans in a GLB only", primitive->byte);
    for (uint64_t i = 0; i < indices->count; i++) {
        size_t byte = (size_t)(indices->begin + i * indices->stride);
        uint32_t number = 0;
        for (size_t k = 0; k < bytes; k++)
            number |= (uint32_t)gltf->source->bytes[byte + k] << 8 * k;
        if (number >= vertex_count)
            return kdr_source_fail_byte(gltf->source, byte, "expected a vertex number below %llu, found %u",
                                        (unsigned long long)vertex_count, number);
    }
    return KDR_OK;
}

static kdr_status check_primitive(const kdr_gltf *gltf, const kdr_json_value *primitive) {
    const kdr_json_value *attributes = find(gltf, primitive, "attributes");
    if (!attributes)
        return kdr_gltf_fail(gltf, primitive, "an object with 'attributes'");
    uint64_t count = KDR_INVALID_ID, mode;
    kdr_status status = check_attributes(gltf, attributes, &count);
    if (status != KDR_OK)
        return status;
    if (!find(gltf, attributes, "POSITION"))
        return kdr_gltf_fail(gltf, attributes, "an attribute 'POSITION'");
    FOR_EACH(gltf, target, find(gltf, primitive, "targets")) {
        status = check_attributes(gltf, target, &count);
        if (status != KDR_OK)
            return status;
    }
    uint32_t indices, material;
    status = kdr_gltf_read_reference(gltf, primitive, "indices", KDR_GLTF_ACCESSORS, &indices);
    if (status == KDR_OK)
        status = kdr_gltf_read_reference(gltf, primitive, "material", KDR_GLTF_MATERIALS, &material);
    if (status == KDR_OK)
        status = kdr_gltf_read_whole(gltf, primitive, "mode", 6, 4, &mode);
    if (status != KDR_OK)
        return status;
    if (indices != KDR_INVALID_ID) {
        status = check_indices(gltf, primitive, &gltf->accessors[indices], count, mode);
        count = gltf->accessors[indices].count;
    }
    if (status != KDR_OK)
        return status;
    // Points, lines and triangles, and their strips: the least vertices of one, and what their number is a multiple of.
    static const uint8_t least[7] = {1, 2, 2, 2, 3, 3, 3}, multiple[7] = {1, 2, 1, 1, 3, 1, 1};
    if (count < least[mode] || count % multiple[mode])
        return kdr_gltf_fail(gltf, primitive, "as many vertices as the mode asks for");
    return KDR_OK;
}

kdr_status kdr_gltf_check_meshes(const kdr_gltf *gltf) {
    FOR_EACH(gltf, mesh, gltf->lists[KDR_GLTF_MESHES]) {
        const kdr_json_value *primitives = find(gltf, mesh, "primitives");
        if (!primitives || primitives->kind != KDR_JSON_ARRAY || primitives->count == 0)
            return kdr_gltf_fail(gltf, mesh, "a mesh with 'primitives'");
        FOR_EACH(gltf, primitive, primitives) {
            kdr_status status = check_primitive(gltf, primitive);
            if (status != KDR_OK)
                return status;
        }
    }
    return KDR_OK;
}

static kdr_status check_node(const kdr_gltf *gltf, const kdr_json_value *node, uint32_t number, uint32_t *parents) {
    uint32_t unused;
    kdr_status status = kdr_gltf_read_reference(gltf, node, "mesh", KDR_GLTF_MESHES, &unused);
    if (status == KDR_OK)
        status = kdr_gltf_read_reference(gltf, node, "skin", KDR_GLTF_SKINS, &unused);
    if (status == KDR_OK)
        status = kdr_gltf_read_reference(gltf, node, "camera", KDR_GLTF_CAMERAS, &unused);
    if (status != KDR_OK)
        return status;
    FOR_EACH(gltf, child, find(gltf, node, "children")) {
        uint32_t child_number;
        status = kdr_gltf_check_reference(gltf, child, KDR_GLTF_NODES, &child_number);
        if (status != KDR_OK)
            return status;
        if (parents[child_number] != KDR_INVALID_ID)
            return kdr_gltf_fail(gltf, child, "a child that has no other parent");
        parents[child_number] = number;
    }
    return KDR_OK;
}

/* Follows every node up to a node without parent. Depths that are known end the way: linear in all. */
static kdr_status check_depths(const kdr_gltf *gltf, const uint32_t *parents, uint32_t *depths) {
    size_t count = gltf->counts[KDR_GLTF_NODES];
    memset(depths, 0, count * sizeof *depths);
    for (size_t i = 0; i < count; i++) {
        uint32_t steps = 1, node = (uint32_t)i;
        while (parents[node] != KDR_INVALID_ID && !depths[parents[node]] && steps <= MAX_NODE_DEPTH) {
            node = parents[node];
            steps++;
        }
        uint32_t depth = (parents[node] != KDR_INVALID_ID ? depths[parents[node]] : 0) + steps;
        if (steps > MAX_NODE_DEPTH || depth > MAX_NODE_DEPTH)
            return kdr_source_fail(gltf->source, KDR_ERROR_LIMIT, "node %zu lies in itself, or more than %d nodes deep",
                                   i, MAX_NODE_DEPTH);
        for (node = (uint32_t)i; node != KDR_INVALID_ID && !depths[node]; node = parents[node])
            depths[node] = depth--;
    }
    return KDR_OK;
}

static kdr_status check_scenes(const kdr_gltf *gltf, const uint32_t *parents) {
    uint32_t unused;
    kdr_status status = kdr_gltf_read_reference(gltf, gltf->root, "scene", KDR_GLTF_SCENES, &unused);
    if (status != KDR_OK)
        return status;
    FOR_EACH(gltf, scene, gltf->lists[KDR_GLTF_SCENES]) {
        FOR_EACH(gltf, root, find(gltf, scene, "nodes")) {
            uint32_t number;
            status = kdr_gltf_check_reference(gltf, root, KDR_GLTF_NODES, &number);
            if (status != KDR_OK)
                return status;
            if (parents[number] != KDR_INVALID_ID)
                return kdr_gltf_fail(gltf, root, "a scene of nodes that have no parent");
        }
    }
    return KDR_OK;
}

kdr_status kdr_gltf_check_nodes(const kdr_gltf *gltf) {
    size_t count = gltf->counts[KDR_GLTF_NODES];
    kdr_buffer memory = {0};
    if (!kdr_mesh_buffer_grow(&memory, 0, (2 * count + 1) * sizeof(uint32_t)))
        return kdr_source_fail_status(gltf->source, KDR_ERROR_OUT_OF_MEMORY);
    uint32_t *parents = memory.memory, number = 0;
    memset(parents, 0xff, count * sizeof *parents);
    kdr_status status = KDR_OK;
    const kdr_json_value *node = kdr_json_first(&gltf->json, gltf->lists[KDR_GLTF_NODES]);
    for (; node && status == KDR_OK; node = kdr_json_next(&gltf->json, node))
        status = check_node(gltf, node, number++, parents);
    if (status == KDR_OK)
        status = check_depths(gltf, parents, parents + count);
    if (status == KDR_OK)
        status = check_scenes(gltf, parents);
    kdr_buffer_release(kdr_mesh_memory(), &memory);
    return status;
}

static kdr_status check_skin(const kdr_gltf *gltf, const kdr_json_value *skin) {
    const kdr_json_value *joints = find(gltf, skin, "joints");
    uint32_t matrices, number;
    kdr_status status = kdr_gltf_read_reference(gltf, skin, "inverseBindMatrices", KDR_GLTF_ACCESSORS, &matrices);
    if (status == KDR_OK)
        status = kdr_gltf_read_reference(gltf, skin, "skeleton", KDR_GLTF_NODES, &number);
    if (status != KDR_OK)
        return status;
    const kdr_gltf_accessor *accessor = matrices == KDR_INVALID_ID ? NULL : &gltf->accessors[matrices];
    bool has_matrices = accessor && accessor->width == 16 && accessor->component == KDR_GLTF_FLOAT && joints &&
                        accessor->count >= joints->count;
    if (!joints || joints->count == 0 || !(has_matrices || (gltf->is_own && !accessor)))
        return kdr_gltf_fail(gltf, skin, "a skin with a matrix for each of its joints");
    FOR_EACH(gltf, joint, joints) {
        status = kdr_gltf_check_reference(gltf, joint, KDR_GLTF_NODES, &number);
        if (status != KDR_OK)
            return status;
    }
    return KDR_OK;
}

static kdr_status check_track(const kdr_gltf *gltf, const kdr_json_value *track) {
    uint32_t input, output;
    kdr_status status = kdr_gltf_read_reference(gltf, track, "input", KDR_GLTF_ACCESSORS, &input);
    if (status == KDR_OK)
        status = kdr_gltf_read_reference(gltf, track, "output", KDR_GLTF_ACCESSORS, &output);
    if (status != KDR_OK)
        return status;
    const kdr_gltf_accessor *accessors = gltf->accessors;
    if (input == KDR_INVALID_ID || output == KDR_INVALID_ID || accessors[input].component != KDR_GLTF_FLOAT ||
        accessors[input].width != 1 || (accessors[output].component != KDR_GLTF_FLOAT && !gltf->is_own))
        return kdr_gltf_fail(gltf, track, "a sampler with times and values in floats");
    const kdr_json_value *shape = find(gltf, track, "interpolation");
    bool is_cubic = shape && shape->kind == KDR_JSON_STRING && kdr_word_is(shape->text, "CUBICSPLINE");
    if (accessors[output].count < accessors[input].count * (is_cubic ? 3 : 1))
        return kdr_gltf_fail(gltf, track, "a sampler with a value for each time");
    return KDR_OK;
}

static kdr_status check_channel(const kdr_gltf *gltf, const kdr_json_value *channel, const kdr_json_value *tracks) {
    const kdr_json_value *target = find(gltf, channel, "target"), *path = find(gltf, target, "path");
    uint64_t number;
    uint32_t node, output;
    kdr_status status = kdr_gltf_read_whole(gltf, channel, "sampler", UINT32_MAX, UINT32_MAX, &number);
    if (status == KDR_OK)
        status = kdr_gltf_read_reference(gltf, target, "node", KDR_GLTF_NODES, &node);
    if (status != KDR_OK)
        return status;
    if (!tracks || number >= tracks->count || !path || path->kind != KDR_JSON_STRING)
        return kdr_gltf_fail(gltf, channel, "a channel with a sampler and the path of its target");
    const kdr_json_value *track = kdr_json_first(&gltf->json, tracks);
    while (number--)
        track = kdr_json_next(&gltf->json, track);
    status = kdr_gltf_read_reference(gltf, track, "output", KDR_GLTF_ACCESSORS, &output);
    if (status != KDR_OK)
        return status;
    uint32_t wanted = kdr_word_is(path->text, "rotation") ? 4 : kdr_word_is(path->text, "weights") ? 1 : 3;
    return gltf->accessors[output].width == wanted ? KDR_OK
                                                   : kdr_gltf_fail(gltf, channel, "values that suit the target's path");
}

kdr_status kdr_gltf_check_motion(const kdr_gltf *gltf) {
    FOR_EACH(gltf, skin, gltf->lists[KDR_GLTF_SKINS]) {
        kdr_status status = check_skin(gltf, skin);
        if (status != KDR_OK)
            return status;
    }
    FOR_EACH(gltf, animation, find(gltf, gltf->root, "animations")) {
        const kdr_json_value *tracks = find(gltf, animation, "samplers");
        FOR_EACH(gltf, track, tracks) {
            kdr_status status = check_track(gltf, track);
            if (status != KDR_OK)
                return status;
        }
        FOR_EACH(gltf, channel, find(gltf, animation, "channels")) {
            kdr_status status = check_channel(gltf, channel, tracks);
            if (status != KDR_OK)
                return status;
        }
    }
    return KDR_OK;
}
