#include "signals.h"

#include "command.h"

#include <signal.h>
#include <stdatomic.h>
#include <string.h>
#include <unistd.h>

static const char *command_name = "kdray";
static atomic_bool deferred;
static atomic_bool cancelled;

static void say(const char *text) {
    ssize_t written = write(STDERR_FILENO, text, strlen(text));
    (void)written; // on the way out nobody could be told
}

/* Only what a handler may do. */
static void take_signal(int number) {
    (void)number;
    atomic_store(&cancelled, true);
    if (atomic_load(&deferred))
        return;
    // A line of progress may stand there.
    if (isatty(STDERR_FILENO))
        say("\n");
    say(command_name);
    say(": cancelled\n");
    _exit(KDR_EXIT_FAILED);
}

void kdr_signals_prepare(void) {
    struct sigaction ignore = {.sa_handler = SIG_IGN};
    sigemptyset(&ignore.sa_mask);
    sigaction(SIGPIPE, &ignore, NULL);
    sigaction(SIGXFSZ, &ignore, NULL);
}

void kdr_signals_watch(const char *command) {
    command_name = command;
    // Without SA_RESTART, so that opening a pipe nobody reads ends too. Also where a shell has made background jobs
    // ignore SIGINT: whoever sends it means it.
    struct sigaction action = {.sa_handler = take_signal};
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);

    // A terminal that is closed, unless nohup has said that it does not matter.
    struct sigaction before;
    if (sigaction(SIGHUP, NULL, &before) == 0 && before.sa_handler != SIG_IGN)
        sigaction(SIGHUP, &action, NULL);
}

void kdr_signals_defer(void) { atomic_store(&deferred, true); }

bool kdr_signals_cancelled(void) { return atomic_load(&cancelled); }
