/* The commands of the program: main.c finds one by name and runs it. */
#ifndef KDR_APPS_KDRAY_COMMAND_H
#define KDR_APPS_KDRAY_COMMAND_H

/* Exit status of a command and of the program. */
enum {
    KDR_EXIT_DONE = 0,
    KDR_EXIT_FAILED = 1,
    KDR_EXIT_USAGE = 2,
};

typedef struct kdr_command {
    const char *name;
    const char *summary; /* a few words, for the list in --help */
    /* argv[0] is the command's name as messages show it ("kdray render"). Returns the exit status. */
    int (*run)(int argc, char **argv);
} kdr_command;

int kdr_command_render(int argc, char **argv);
int kdr_command_animate(int argc, char **argv);
int kdr_command_view(int argc, char **argv);
int kdr_command_info(int argc, char **argv);
int kdr_command_bench(int argc, char **argv);

#endif
