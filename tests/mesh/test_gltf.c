/* What is checked of a glTF file before assimp sees it. */
#include "mesh/gltf_check.h"
#include "mesh/samples.h"

#define TRIANGLE                                                                                                       \
    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"                                               \
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],"                         \
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"buffers\":[{\"byteLength\":36,\"uri\":\"none.bin\"}]"
#define ASSET "{\"asset\":{\"version\":\"2.0\"},"

/* Checks JSON by itself; "" when nothing is wrong. */
static const char *check_text(const char *text, kdr_status wanted) {
    heard = (told){0};
    char *copy = malloc(strlen(text) + 1);
    assert_non_null(copy);
    memcpy(copy, text, strlen(text));
    kdr_source source = {"t.gltf", (const unsigned char *)copy, strlen(text), false, &hearing};
    kdr_glb_frame frame = {.json_end = strlen(text)};
    kdr_status status = kdr_gltf_check(&source, &frame);
    free(copy);
    if (status != wanted)
        fail_msg("'%s': expected %s, got %s: %s", text, kdr_status_text(wanted), kdr_status_text(status), heard.error);
    assert_int_equal(heard.errors, status != KDR_OK);
    assert_int_equal(kdr_render_bytes(), 0);
    return heard.error;
}

static void assert_wrong(const char *text, const char *part) {
    const char *error = check_text(text, KDR_ERROR_INVALID_DATA);
    if (!strstr(error, part))
        fail_msg("'%s': expected '%s', got '%s'", text, part, error);
}

/* The sample with one piece of its text replaced. */
static void assert_wrong_piece(const char *piece, const char *instead, const char *part) {
    const char *whole = ASSET TRIANGLE "}", *at = strstr(whole, piece);
    assert_non_null(at);
    char text[2000];
    snprintf(text, sizeof text, "%.*s%s%s", (int)(at - whole), whole, instead, at + strlen(piece));
    assert_wrong(text, part);
}

static void sound_files_pass(void **state) {
    (void)state;
    assert_string_equal(check_text(ASSET TRIANGLE "}", KDR_OK), "");
    assert_string_equal(check_text(" {\"asset\" : {\"version\":\"2.0\",\"extras\":[[],{},null,true,false,-1.5e3,"
                                   "\"\\\"\\\\\"]}}\r\n",
                                   KDR_OK),
                        "");
    assert_string_equal(check_text(ASSET TRIANGLE ",\"nodes\":[{\"children\":[1,2]},{\"mesh\":0},{}],"
                                                  "\"scenes\":[{\"nodes\":[0]}],\"scene\":0}",
                                   KDR_OK),
                        "");
}

static void text_that_is_no_json_names_its_byte(void **state) {
    (void)state;
    assert_wrong("", "byte 0: expected a JSON value, found the end of the file");
    assert_wrong("{", "byte 1: expected a string, found the end of the file");
    assert_wrong("{\"a\" 1}", "byte 5: expected ':', found '1}'");
    assert_wrong("{\"a\":1 2}", "byte 7: expected ',' or '}', found '2}'");
    assert_wrong("[1,2", "expected ',' or ']', found the end of the file");
    assert_wrong("[1,]", "byte 3: expected a JSON value, found ']'");
    assert_wrong("[tru]", "byte 1: expected a JSON value");
    assert_wrong("[-]", "byte 1: expected a number");
    assert_wrong("[\"a\\\"]", "expected the end of a string");
    assert_wrong("[\"a\nb\"]", "expected a string without control characters");
    assert_wrong("{} {}", "byte 3: expected the end of the JSON");
    assert_wrong("{\"\\u006deshes\":1}", "expected a name without \\u");
}

static void depth_is_limited(void **state) {
    (void)state;
    char text[4 * KDR_JSON_MAX_DEPTH];
    memset(text, '[', sizeof text);
    text[sizeof text - 1] = '\0';
    assert_non_null(strstr(check_text(text, KDR_ERROR_LIMIT), "byte 64: JSON is more than 64 levels deep"));
}

static void numbers_that_lead_out_of_their_lists_are_refused(void **state) {
    (void)state;
    assert_wrong_piece("\"POSITION\":0", "\"POSITION\":1", "expected a number into 'accessors', of which there are 1");
    assert_wrong_piece("\"bufferView\":0", "\"bufferView\":-1", "expected a number into 'bufferViews'");
    assert_wrong_piece("\"buffer\":0", "\"buffer\":0.5", "expected a number into 'buffers'");
    assert_wrong_piece("}}]}]", "},\"material\":0}]}]", "into 'materials', of which there are 0");
    assert_wrong_piece("}}]}]", "},\"indices\":7}]}]", "into 'accessors', of which there are 1");
    assert_wrong(ASSET "\"nodes\":[{\"mesh\":0}]}", "into 'meshes', of which there are 0");
    assert_wrong(ASSET "\"nodes\":[{\"children\":[1]}]}", "into 'nodes', of which there are 1");
    assert_wrong(ASSET "\"scenes\":[{\"nodes\":[0]}]}", "into 'nodes', of which there are 0");
    assert_wrong(ASSET "\"scene\":0}", "into 'scenes', of which there are 0");
    assert_wrong(ASSET TRIANGLE ",\"skins\":[{\"joints\":[0],\"inverseBindMatrices\":0}]}", "a matrix for each of its");
    assert_wrong(ASSET TRIANGLE ",\"animations\":[{\"channels\":[{\"sampler\":0,\"target\":{\"path\":\"scale\"}}]}]}",
                 "expected a channel with a sampler");
}

static void values_outside_their_views_and_buffers_are_refused(void **state) {
    (void)state;
    assert_wrong_piece("\"count\":3", "\"count\":4", "expected an accessor whose values lie in its view");
    assert_wrong_piece("\"count\":3", "\"count\":4294967290", "expected an accessor whose values lie in its view");
    assert_wrong_piece("\"count\":3", "\"count\":1e30", "expected 'count' to be a whole number");
    assert_wrong_piece("\"count\":3", "\"count\":0", "a count of at least 1");
    assert_wrong_piece("\"count\":3", "\"count\":3,\"byteOffset\":4", "expected an accessor whose values lie in its");
    assert_wrong_piece("5126", "5124", "expected an accessor with componentType, type");
    assert_wrong_piece("VEC3", "VEC5", "expected an accessor with componentType, type");
    assert_wrong_piece("VEC3", "VEC2", "expected an accessor of the type that 'POSITION' has");
    assert_wrong_piece("\"byteLength\":36}]", "\"byteLength\":36,\"byteStride\":24}]", "values lie in its view");
    assert_wrong_piece("\"byteLength\":36}]", "\"byteLength\":37}]",
                       "expected a view of at least one byte that lies in");
    assert_wrong_piece(",\"uri\":\"none.bin\"", "", "expected a buffer of 1 to 0 bytes");
    assert_wrong_piece("none.bin", "data:;base64,AAAA", "expected a buffer of 1 to 17 bytes");
    assert_wrong_piece("}}]}]", "},\"mode\":7}]}]", "expected 'mode' to be a whole number up to 6");
    assert_wrong_piece("}}]}]", "},\"mode\":1}]}]", "expected as many vertices as the mode asks for");
    assert_wrong_piece("}}]}]", "},\"indices\":0}]}]", "expected 'indices' to be whole numbers");
    assert_wrong_piece("\"POSITION\":0", "\"NORMAL\":0", "expected an attribute 'POSITION'");
    assert_wrong_piece("[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]", "[{}]", "a mesh with 'primitives'");
}

static void nodes_in_circles_or_too_deep_are_refused(void **state) {
    (void)state;
    assert_wrong(ASSET "\"nodes\":[{\"children\":[1]},{},{\"children\":[1]}]}", "a child that has no other parent");
    assert_wrong(ASSET "\"nodes\":[{\"children\":[1]},{}],\"scenes\":[{\"nodes\":[1]}]}", "nodes that have no parent");
    const char *circle = ASSET "\"nodes\":[{\"children\":[1]},{\"children\":[2]},{\"children\":[0]}]}";
    assert_non_null(strstr(check_text(circle, KDR_ERROR_LIMIT), "node 0 lies in itself, or more than 512"));
    assert_non_null(strstr(check_text(ASSET "\"nodes\":[{\"children\":[0]}]}", KDR_ERROR_LIMIT), "lies in itself"));

    char *text = malloc(40000);
    assert_non_null(text);
    for (int count = 512; count <= 513; count++) {
        int length = sprintf(text, ASSET "\"nodes\":[");
        for (int i = 1; i < count; i++)
            length += sprintf(text + length, "{\"children\":[%d]},", i);
        sprintf(text + length, "{}]}");
        check_text(text, count == 512 ? KDR_OK : KDR_ERROR_LIMIT);
    }
    free(text);
}

static void other_versions_are_refused(void **state) {
    (void)state;
    assert_wrong("{}", "byte 0: expected an asset with a version");
    const char *error = check_text("{\"asset\":{\"version\":\"1.0\"}}", KDR_ERROR_UNSUPPORTED);
    assert_non_null(strstr(error, "byte 20: expected glTF version 2"));
}

static void a_wrong_frame_names_its_byte(void **state) {
    (void)state;
    byte_list file = {.length = 0};
    sample_glb(&file, "");
    assert_refused("t.glb", file.bytes, 19, KDR_ERROR_INVALID_DATA, "byte 19: expected the 20 bytes that begin a GLB");
    assert_refused("t.glb", file.bytes, file.length - 1, KDR_ERROR_INVALID_DATA, "byte 8: expected the length of the");
    byte_list wrong = file;
    wrong.bytes[15] = 0x7f;
    assert_refused("t.glb", wrong.bytes, wrong.length, KDR_ERROR_INVALID_DATA,
                   "byte 12: expected the length of a chunk");
    wrong = file;
    wrong.bytes[4] = 1;
    assert_refused("t.glb", wrong.bytes, wrong.length, KDR_ERROR_UNSUPPORTED,
                   "byte 4: expected GLB version 2, found 1");
    wrong = file;
    wrong.bytes[16] = 'X';
    assert_refused("t.glb", wrong.bytes, wrong.length, KDR_ERROR_INVALID_DATA,
                   "byte 12: expected a first chunk of the");
    assert_text_refused("t.glb", "no glTF at all", "byte 0: expected 'glTF' as the first four bytes of a GLB");
    assert_text_refused("t.gltf", "no glTF at all", "byte 0: expected a JSON value, found 'no'");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sound_files_pass),
        cmocka_unit_test(text_that_is_no_json_names_its_byte),
        cmocka_unit_test(depth_is_limited),
        cmocka_unit_test(numbers_that_lead_out_of_their_lists_are_refused),
        cmocka_unit_test(values_outside_their_views_and_buffers_are_refused),
        cmocka_unit_test(nodes_in_circles_or_too_deep_are_refused),
        cmocka_unit_test(other_versions_are_refused),
#ifdef KDR_WITH_ASSIMP
        cmocka_unit_test(a_wrong_frame_names_its_byte),
#endif
    };
#ifndef KDR_WITH_ASSIMP
    (void)a_wrong_frame_names_its_byte;
#endif
    return cmocka_run_group_tests(tests, NULL, NULL);
}
