/* A track has keys: times that ascend, and a value for each. Between two keys a value is the earlier one (STEP), on the
 * line or the arc between them (LINEAR), or on a cubic with the tangents of the file (CUBICSPLINE).
 *
 * Source: Khronos Group, "glTF 2.0 Specification", chapter 3.11 and appendix C (interpolation); K. Shoemake, "Animating
 * Rotation with Quaternion Curves", 1985, for the arc. Cost: a binary search a track. */
#include "mesh/gltf_motion.h"

#include <math.h>

typedef enum track_shape { SHAPE_STEP, SHAPE_LINEAR, SHAPE_CUBIC } track_shape;
typedef enum track_path { PATH_TRANSLATION, PATH_ROTATION, PATH_SCALE, PATH_WEIGHTS } track_path;

struct kdr_gltf_track {
    uint32_t times, outputs; /* accessors */
    uint32_t node;
    track_shape shape;
    track_path path;
    size_t width; /* numbers of one value */
};

static bool find_path(kdr_word word, track_path *out) {
    static const char *const names[] = {"translation", "rotation", "scale", "weights"};
    for (int i = 0; i < 4; i++)
        if (kdr_word_is(word, names[i])) {
            *out = (track_path)i;
            return true;
        }
    return false;
}

static kdr_status read_shape(const kdr_gltf_asset *asset, const kdr_json_value *sampler, track_shape *out) {
    const kdr_json_value *word = kdr_gltf_find(asset, sampler, "interpolation");
    *out = SHAPE_LINEAR;
    if (!word || (word->kind == KDR_JSON_STRING && kdr_word_is(word->text, "LINEAR")))
        return KDR_OK;
    *out = word->kind == KDR_JSON_STRING && kdr_word_is(word->text, "STEP") ? SHAPE_STEP : SHAPE_CUBIC;
    if (*out == SHAPE_STEP || (word->kind == KDR_JSON_STRING && kdr_word_is(word->text, "CUBICSPLINE")))
        return KDR_OK;
    return kdr_gltf_fail(&asset->gltf, word, "STEP, LINEAR or CUBICSPLINE");
}

static kdr_status check_keys(const kdr_gltf_asset *asset, const kdr_gltf_track *track, const kdr_json_value *sampler) {
    const kdr_gltf_values *times = &asset->values[track->times], *outputs = &asset->values[track->outputs];
    uint64_t wanted = (uint64_t)times->count * track->width * (track->shape == SHAPE_CUBIC ? 3 : 1);
    uint64_t found = (uint64_t)outputs->count * outputs->width;
    if (found != wanted)
        return kdr_source_fail_byte(asset->gltf.source, sampler->byte,
                                    "expected %llu numbers for %zu times, found %llu", (unsigned long long)wanted,
                                    times->count, (unsigned long long)found);
    for (size_t i = 0; i < times->count; i++) {
        float time = kdr_gltf_number(times, i, 0);
        if (time < 0 || (i && time <= kdr_gltf_number(times, i - 1, 0)))
            return kdr_source_fail_byte(asset->gltf.source, sampler->byte,
                                        "expected times from 0 on that ascend, found %g as number %zu", (double)time,
                                        i);
    }
    return KDR_OK;
}

/* *is_used is false for what moves nothing that is known: glTF asks to leave such channels out. */
static kdr_status read_track(kdr_gltf_asset *asset, const kdr_gltf_nodes *nodes, const kdr_json_value *channel,
                             const kdr_json_value *const *samplers, kdr_gltf_track *out, bool *is_used) {
    const kdr_gltf *gltf = &asset->gltf;
    const kdr_json_value *target = kdr_gltf_find(asset, channel, "target");
    uint64_t number;
    *is_used = false;
    kdr_status status = kdr_gltf_read_reference(gltf, target, "node", KDR_GLTF_NODES, &out->node);
    if (status == KDR_OK)
        status = kdr_gltf_read_whole(gltf, channel, "sampler", UINT32_MAX, 0, &number);
    if (status != KDR_OK || out->node == KDR_INVALID_ID ||
        !find_path(kdr_gltf_find(asset, target, "path")->text, &out->path))
        return status;
    const kdr_json_value *sampler = samplers[number];
    const kdr_gltf_node *node = &nodes->nodes[out->node];
    if (out->path != PATH_WEIGHTS && node->has_matrix)
        return kdr_gltf_fail(gltf, channel, "a channel for a node without a matrix");
    out->width = out->path == PATH_WEIGHTS ? node->weight_count : out->path == PATH_ROTATION ? 4 : 3;
    if (out->width == 0)
        return kdr_gltf_fail(gltf, channel, "weights for a node whose mesh has morph targets");
    status = read_shape(asset, sampler, &out->shape);
    if (status == KDR_OK)
        status = kdr_gltf_read_reference(gltf, sampler, "input", KDR_GLTF_ACCESSORS, &out->times);
    if (status == KDR_OK)
        status = kdr_gltf_read_reference(gltf, sampler, "output", KDR_GLTF_ACCESSORS, &out->outputs);
    if (status == KDR_OK)
        status = kdr_gltf_open_values(asset, out->times);
    if (status == KDR_OK)
        status = kdr_gltf_open_values(asset, out->outputs);
    *is_used = true;
    return status == KDR_OK ? check_keys(asset, out, sampler) : status;
}

kdr_status kdr_gltf_motion_open(kdr_gltf_asset *asset, const kdr_gltf_nodes *nodes, kdr_gltf_motion *out) {
    *out = (kdr_gltf_motion){0};
    const kdr_json *json = &asset->gltf.json;
    const kdr_json_value *animation = kdr_json_first(json, kdr_gltf_find(asset, asset->gltf.root, "animations"));
    const kdr_json_value *samplers = kdr_gltf_find(asset, animation, "samplers");
    const kdr_json_value *channels = kdr_gltf_find(asset, animation, "channels");
    if (!samplers || !channels)
        return KDR_OK;
    const kdr_json_value **table = kdr_gltf_take(&asset->store, samplers->count, sizeof(void *));
    out->tracks = kdr_gltf_take(&asset->store, channels->count, sizeof *out->tracks);
    if (!table || !out->tracks)
        return kdr_source_fail_status(asset->gltf.source, KDR_ERROR_OUT_OF_MEMORY);
    size_t count = 0;
    for (const kdr_json_value *one = kdr_json_first(json, samplers); one; one = kdr_json_next(json, one))
        table[count++] = one;
    for (const kdr_json_value *one = kdr_json_first(json, channels); one; one = kdr_json_next(json, one)) {
        bool is_used;
        kdr_gltf_track *track = &out->tracks[out->count];
        kdr_status status = read_track(asset, nodes, one, table, track, &is_used);
        if (status != KDR_OK)
            return status;
        if (!is_used)
            continue;
        const kdr_gltf_values *times = &asset->values[track->times];
        out->duration = fmax(out->duration, (double)kdr_gltf_number(times, times->count - 1, 0));
        out->count++;
    }
    return KDR_OK;
}

/* Where a time lies among the keys. */
typedef struct track_place {
    size_t before, after; /* keys; the same where the track stands still */
    double share;         /* of the way from one to the other, 0 up to 1 */
    double seconds;       /* from one to the other */
} track_place;

static track_place find_place(const kdr_gltf_values *times, double seconds) {
    size_t low = 0, high = times->count; // the key in force is in low..high-1
    if (seconds <= (double)kdr_gltf_number(times, 0, 0))
        return (track_place){0, 0, 0, 0};
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        *((double)kdr_gltf_number(times, middle, 0) <= seconds ? &low : &high) = middle;
    }
    if (low + 1 == times->count)
        return (track_place){low, low, 0, 0};
    double begin = (double)kdr_gltf_number(times, low, 0), end = (double)kdr_gltf_number(times, low + 1, 0);
    return (track_place){low, low + 1, (seconds - begin) / (end - begin), end - begin};
}

/* Number k of a value; values of weights lie in as many elements as there are targets. */
static double number_of(const kdr_gltf_values *outputs, const kdr_gltf_track *track, size_t value, size_t k) {
    size_t flat = value * track->width + k;
    return (double)kdr_gltf_number(outputs, flat / outputs->width, (uint32_t)(flat % outputs->width));
}

/* The shorter arc between two rotations, at even speed. */
static void turn(const double from[4], const double to[4], double share, double out[4]) {
    double lengths = 0, other = 0, cosine = 0;
    for (int k = 0; k < 4; k++) {
        lengths += from[k] * from[k];
        other += to[k] * to[k];
        cosine += from[k] * to[k];
    }
    lengths = sqrt(lengths * other);
    cosine = lengths > 0 ? cosine / lengths : 1;
    double side = cosine < 0 ? -1 : 1, first = 1 - share, second = share;
    cosine *= side;
    if (cosine < 0.9999) { // else the chord is the arc as far as a float can tell
        double angle = acos(cosine), sine = sin(angle);
        first = sin(first * angle) / sine;
        second = sin(second * angle) / sine;
    }
    for (int k = 0; k < 4; k++)
        out[k] = first * from[k] + side * second * to[k];
}

static double cubic(double from, double out_slope, double in_slope, double to, const track_place *at) {
    double t = at->share, t2 = t * t, t3 = t2 * t;
    return (2 * t3 - 3 * t2 + 1) * from + at->seconds * (t3 - 2 * t2 + t) * out_slope + (3 * t2 - 2 * t3) * to +
           at->seconds * (t3 - t2) * in_slope;
}

static void sample_track(const kdr_gltf_track *track, const kdr_gltf_asset *asset, double seconds, double *out) {
    const kdr_gltf_values *outputs = &asset->values[track->outputs];
    track_place at = find_place(&asset->values[track->times], seconds);
    if (track->path == PATH_ROTATION && track->shape == SHAPE_LINEAR && at.after != at.before) {
        double from[4], to[4];
        for (size_t k = 0; k < 4; k++) {
            from[k] = number_of(outputs, track, at.before, k);
            to[k] = number_of(outputs, track, at.after, k);
        }
        turn(from, to, at.share, out);
        return;
    }
    for (size_t k = 0; k < track->width; k++) {
        if (track->shape == SHAPE_CUBIC) { // each key: the slope into it, its value, the slope out of it
            double from = number_of(outputs, track, 3 * at.before + 1, k);
            out[k] = at.before == at.after ? from
                                           : cubic(from, number_of(outputs, track, 3 * at.before + 2, k),
                                                   number_of(outputs, track, 3 * at.after, k),
                                                   number_of(outputs, track, 3 * at.after + 1, k), &at);
            continue;
        }
        double from = number_of(outputs, track, at.before, k), to = number_of(outputs, track, at.after, k);
        out[k] = track->shape == SHAPE_STEP ? from : (1 - at.share) * from + at.share * to;
    }
}

void kdr_gltf_motion_apply(const kdr_gltf_motion *motion, const kdr_gltf_asset *asset, double seconds,
                           kdr_gltf_nodes *nodes) {
    for (size_t i = 0; i < motion->count; i++) {
        const kdr_gltf_track *track = &motion->tracks[i];
        kdr_gltf_node *node = &nodes->nodes[track->node];
        double *const moved[] = {node->translation, node->rotation, node->scale, node->weights};
        sample_track(track, asset, seconds, moved[track->path]);
    }
}
