/* Options that every command shares: workers, instruction set, constants of the build, and who hears what. */
#ifndef KDR_APPS_KDRAY_TREE_OPTIONS_H
#define KDR_APPS_KDRAY_TREE_OPTIONS_H

#include "messages.h"

#include <argp.h>
#include <kdray/render.h>

typedef struct kdr_tree_options {
    uint32_t threads; /* 0: as many as the machine allows */
    bool isa_given;
    kdr_isa isa;
    kdr_build_def build;
    const char *json; /* file name, "-": stdout, NULL: none */
} kdr_tree_options;

/* A child parser for argp; its input is a kdr_tree_options. */
extern const struct argp kdr_tree_argp;

kdr_tree_options kdr_default_tree_options(void);

/* Makes the device that the options ask for; NULL after a sentence. Release: kdr_device_destroy. */
kdr_device *kdr_tree_options_device(const kdr_tree_options *options, kdr_messages *messages);

#endif
