#include "picture_options.h"

#include "fit_view.h"
#include "option_numbers.h"

#include <string.h>
#include <unistd.h>

#define SIDE_LIMIT 65536u
#define SAMPLE_LIMIT 65536u

enum { CAMERA = 0x300, TARGET, UP, FOV, VIEW, LIGHT, BOX, TEXTURE, SPP, SEED };

static const struct argp_option options[] = {
    {"resolution", 'r', "WxH", 0, "Pixels (default: 1024x1024)", 1},
    {"spp", SPP, "N", 0, "Samples a pixel, 1 to 65536 (default: 1)", 1},
    {"seed", SEED, "N", 0, "Seed of the samples' positions (default: 0)", 1},
    {"box", BOX, NULL, 0, "Put the model in a textured box", 2},
    {"texture", TEXTURE, "FILE", 0, "PNG file on the box (default: a checkerboard)", 2},
    {0},
};

static const struct argp_option camera_options[] = {
    {NULL, 0, NULL, 0, "View (default: the model from three quarters above):", 2},
    {"view", VIEW, "FILE", 0, "Read one line of 13 numbers: eye, target, up, field of view, light", 2},
    {"camera", CAMERA, "X,Y,Z", 0, "Where the eye is", 2},
    {"target", TARGET, "X,Y,Z", 0, "What it looks at", 2},
    {"up", UP, "X,Y,Z", 0, "Which way is up (default: 0,1,0)", 2},
    {"fov", FOV, "DEGREES", 0, "Vertical field of view, above 0 and below 180 (default: 45)", 2},
    {"light", LIGHT, "X,Y,Z", 0, "A point light; up to 16 of them", 2},
    {0},
};

static void add_light(kdr_picture_options *picture, const char *text, struct argp_state *state) {
    if (picture->light_count == KDR_MAX_LIGHTS) {
        argp_error(state, "--light: expected at most %d lights", KDR_MAX_LIGHTS);
        return;
    }
    kdr_option_triple(state, "--light", text, picture->lights[picture->light_count]);
    picture->light_count++;
}

static error_t parse_camera(int key, char *text, struct argp_state *state) {
    kdr_picture_options *picture = state->input;
    switch (key) {
    case VIEW: picture->view = text; break;
    case CAMERA:
        kdr_option_triple(state, "--camera", text, picture->camera.eye);
        picture->eye_given = true;
        break;
    case TARGET:
        kdr_option_triple(state, "--target", text, picture->camera.target);
        picture->target_given = true;
        break;
    case UP:
        kdr_option_triple(state, "--up", text, picture->camera.up);
        picture->up_given = true;
        break;
    case FOV:
        picture->camera.fov = (float)kdr_option_inside(state, "--fov", text, 0, 180);
        picture->fov_given = true;
        break;
    case LIGHT: add_light(picture, text, state); break;
    default: return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

const struct argp kdr_camera_argp = {.options = camera_options, .parser = parse_camera};

static error_t parse(int key, char *text, struct argp_state *state) {
    kdr_picture_options *picture = state->input;
    switch (key) {
    case ARGP_KEY_INIT: state->child_inputs[0] = picture; break;
    case 'r':
        kdr_option_size(state, "--resolution", text, SIDE_LIMIT, &picture->width, &picture->height);
        picture->size_given = true;
        break;
    case SPP: picture->samples = (uint32_t)kdr_option_whole(state, "--spp", text, 1, SAMPLE_LIMIT); break;
    case SEED: picture->seed = kdr_option_whole(state, "--seed", text, 0, UINT64_MAX); break;
    case BOX: picture->box = true; break;
    case TEXTURE: picture->texture = text; break;
    case ARGP_KEY_END:
        if (picture->texture && !picture->box)
            argp_error(state, "--texture: expected --box as well, since the texture is the box's");
        break;
    default: return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

static const struct argp_child children[] = {{&kdr_camera_argp, 0, NULL, 0}, {0}};

const struct argp kdr_picture_argp = {.options = options, .parser = parse, .children = children};

kdr_picture_options kdr_default_picture_options(void) {
    return (kdr_picture_options){.width = 1024, .height = 1024, .samples = 1};
}

bool kdr_picture_options_prepare(const kdr_picture_options *asked, kdr_messages *messages, kdr_picture_def *picture) {
    *picture = kdr_default_picture_def();
    picture->width = asked->width;
    picture->height = asked->height;
    picture->samples = asked->samples;
    picture->seed = asked->seed;
    picture->box = asked->box;
    picture->texture = asked->texture;
    if (asked->texture && access(asked->texture, R_OK) != 0) {
        kdr_messages_fail(messages, "%s: %m", asked->texture);
        return false;
    }
    if (!asked->view)
        return true;
    kdr_logger logger = kdr_messages_logger(messages);
    kdr_status status = kdr_camera_read(asked->view, &logger, &picture->camera, picture->lights[0]);
    if (status != KDR_OK)
        kdr_messages_fail_status(messages, asked->view, status);
    return status == KDR_OK;
}

void kdr_picture_options_look(const kdr_picture_options *asked, const float bounds[6], kdr_picture_def *picture) {
    if (!asked->view) {
        picture->camera = kdr_camera_for_bounds(bounds);
        kdr_light_for_bounds(bounds, picture->lights[0]);

        // Who says nothing of the camera sees the whole model; the room of --box is made for the plain one.
        bool framed = asked->eye_given || asked->target_given || asked->up_given || asked->fov_given;
        if (!framed && !picture->box)
            kdr_fit_view(&picture->camera, bounds, picture->width, picture->height);
    }
    if (asked->eye_given)
        memcpy(picture->camera.eye, asked->camera.eye, sizeof(picture->camera.eye));
    if (asked->target_given)
        memcpy(picture->camera.target, asked->camera.target, sizeof(picture->camera.target));
    if (asked->up_given)
        memcpy(picture->camera.up, asked->camera.up, sizeof(picture->camera.up));
    if (asked->fov_given)
        picture->camera.fov = asked->camera.fov;
    if (asked->light_count > 0) {
        picture->light_count = asked->light_count;
        memcpy(picture->lights, asked->lights, sizeof(picture->lights));
    }
}
