/* The program kdray: finds the command and runs it. */
#include "command.h"
#include "signals.h"

#include <argp.h>
#include <errno.h>
#include <fcntl.h>
#include <kdray/kdray.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const kdr_command commands[] = {
    {"render", "a picture of a mesh file", kdr_command_render},
    {"animate", "numbered pictures, or a video, of what moves", kdr_command_animate},
    {"view", "a window on a mesh, still or moving", kdr_command_view},
    {"info", "what a mesh and its tree are made of", kdr_command_info},
#ifdef KDR_WITH_BENCH
    {"bench", "speed of kdray, and of Embree beside it where it is there", kdr_command_bench},
#endif
};

#define COMMAND_COUNT (sizeof(commands) / sizeof(commands[0]))

static void print_help(FILE *file) {
    fputs("Usage: kdray COMMAND [OPTION...]\n"
          "   or: kdray --help | --version\n"
          "kdray -- mesh files to pictures, through a kd-tree\n\n"
          "Commands:\n",
          file);
    for (size_t i = 0; i < COMMAND_COUNT; i++)
        fprintf(file, "  %-8s %s\n", commands[i].name, commands[i].summary);
    fputs("\n`kdray COMMAND --help' lists the options of a command.\n"
          "Exit status: 0 done, 1 failed, 2 wrong usage.\n",
          file);
}

static void print_version(FILE *file, struct argp_state *state) {
    (void)state;
    fprintf(file, "kdray %s\n", kdr_version());
}

static int refuse_usage(void) {
    fputs("Try `kdray --help' for more information.\n", stderr);
    return KDR_EXIT_USAGE;
}

/* A standard file that is closed would lend its number to the next file that is opened, which would then get what is
 * printed. Each gets one that cannot be used instead: printing fails, and the end of the program says so. */
static void fill_standard_files(void) {
    for (int file = 0; file <= STDERR_FILENO; file++)
        if (fcntl(file, F_GETFD) < 0 && errno == EBADF && open("/dev/null", file == 0 ? O_WRONLY : O_RDONLY) != file)
            _exit(KDR_EXIT_FAILED);
}

/* Runs at every exit: what was printed has to have arrived. */
static void finish_stdout(void) {
    bool failed = ferror(stdout) != 0;
    errno = 0;
    if (fflush(stdout) != 0)
        failed = true;
    if (!failed)
        return;
    fprintf(stderr, "kdray: stdout cannot be written: %s\n", errno ? strerror(errno) : "input or output failed");
    _exit(KDR_EXIT_FAILED);
}

int main(int argc, char **argv) {
    fill_standard_files();
    kdr_signals_prepare();
    atexit(finish_stdout);
    argp_err_exit_status = KDR_EXIT_USAGE;
    argp_program_version_hook = print_version;

    if (argc < 2) {
        fputs("kdray: expected a command\n", stderr);
        return refuse_usage();
    }
    const char *name = argv[1];
    if (strcmp(name, "--help") == 0 || strcmp(name, "-?") == 0 || strcmp(name, "-h") == 0 ||
        strcmp(name, "help") == 0) {
        print_help(stdout);
        return KDR_EXIT_DONE;
    }
    if (strcmp(name, "--version") == 0 || strcmp(name, "-V") == 0) {
        print_version(stdout, NULL);
        return KDR_EXIT_DONE;
    }
    for (size_t i = 0; i < COMMAND_COUNT; i++) {
        if (strcmp(name, commands[i].name) != 0)
            continue;
        // Messages name the command as it is typed.
        char title[32];
        snprintf(title, sizeof(title), "kdray %s", commands[i].name);
        argv[1] = title;
        return commands[i].run(argc - 1, argv + 1);
    }
    fprintf(stderr, "kdray: expected a command, found \"%.40s\"\n", name);
    return refuse_usage();
}
