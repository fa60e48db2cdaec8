#include "whole_file.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define PATH_SIZE 4096

static bool complain(const kdr_logger *logger, const char *path) {
    char sentence[PATH_SIZE + 128];
    snprintf(sentence, sizeof sentence, "%.4000s: %s", path, strerror(errno));
    logger->log(KDR_LOG_ERROR, sentence, logger->user);
    return false;
}

/* An empty file beside `path`, with the rights that a new file has; its name in `name`. -1 and errno on failure. */
static int make_neighbour(const char *path, char name[PATH_SIZE]) {
    if (snprintf(name, PATH_SIZE, "%s.XXXXXX", path) >= PATH_SIZE) {
        errno = ENAMETOOLONG;
        return -1;
    }
    int file = mkstemp(name);
    mode_t mask = umask(0);
    umask(mask);
    if (file >= 0 && fchmod(file, 0666 & ~mask) != 0) {
        int number = errno;
        close(file);
        unlink(name);
        errno = number;
        return -1;
    }
    return file;
}

static bool is_special(const char *path) {
    struct stat what;
    return stat(path, &what) == 0 && !S_ISREG(what.st_mode);
}

static bool may_be_written(const char *path) {
    struct stat what;
    if (stat(path, &what) == 0 && S_ISDIR(what.st_mode)) {
        errno = EISDIR;
        return false;
    }
    return access(path, W_OK) == 0;
}

/* Writes and closes; errno tells of the first failure. */
static bool write_and_close(int file, kdr_whole_file_fn *write_to, const void *context) {
    FILE *stream = fdopen(file, "w");
    if (!stream) {
        close(file);
        return false;
    }
    errno = 0;
    write_to(stream, context);
    bool good = fflush(stream) == 0 && !ferror(stream);
    int number = errno;
    good = fclose(stream) == 0 && good;
    if (number)
        errno = number;
    return good;
}

bool kdr_whole_file_possible(const char *path, const kdr_logger *logger) {
    if (is_special(path))
        return may_be_written(path) || complain(logger, path);
    char name[PATH_SIZE];
    int file = make_neighbour(path, name);
    if (file < 0)
        return complain(logger, path);
    close(file);
    unlink(name);
    return true;
}

static bool replace(const char *path, kdr_whole_file_fn *write_to, const void *context) {
    char name[PATH_SIZE];
    int file = make_neighbour(path, name);
    if (file < 0)
        return false;
    if (write_and_close(file, write_to, context) && rename(name, path) == 0)
        return true;
    int number = errno;
    unlink(name);
    errno = number;
    return false;
}

bool kdr_whole_file_write(const char *path, kdr_whole_file_fn *write_to, const void *context,
                          const kdr_logger *logger) {
    if (is_special(path)) {
        int file = open(path, O_WRONLY | O_CLOEXEC);
        return (file >= 0 && write_and_close(file, write_to, context)) || complain(logger, path);
    }

    /* A signal that ends the program would leave the neighbour behind */
    sigset_t every, before;
    sigfillset(&every);
    sigprocmask(SIG_BLOCK, &every, &before);
    bool good = replace(path, write_to, context) || complain(logger, path);
    sigprocmask(SIG_SETMASK, &before, NULL);
    return good;
}
