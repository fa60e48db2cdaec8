#include "output.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define LINK_LIMIT 40 /* symbolic links in a row, as many as Linux follows */

/* The directory part of a name, with its slash; empty: the current one. False: too long. */
static bool directory_of(const char *path, char directory[PATH_MAX]) {
    const char *slash = strrchr(path, '/');
    size_t length = slash ? (size_t)(slash - path) + 1 : 0;
    if (length >= PATH_MAX)
        return false;
    memcpy(directory, path, length);
    directory[length] = 0;
    return true;
}

static bool refuse(const char *path, int number, kdr_messages *messages) {
    kdr_messages_fail(messages, "%s cannot be written: %s", *path ? path : "a file without a name", strerror(number));
    return false;
}

/* Makes a file in a directory and removes it again: permissions alone do not tell, least of all for root. No signal may
 * come between. 0, or an error number. */
static int try_directory(const char *directory) {
    char name[PATH_MAX];
    int length = snprintf(name, sizeof(name), "%s.kdray-%ld.try", directory, (long)getpid());
    if (length < 0 || (size_t)length >= sizeof(name))
        return ENAMETOOLONG;
    sigset_t all, before;
    sigfillset(&all);
    sigprocmask(SIG_SETMASK, &all, &before);
    int file = open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    int number = file < 0 ? errno : 0;
    if (file >= 0) {
        close(file);
        unlink(name);
    }
    sigprocmask(SIG_SETMASK, &before, NULL);
    return number;
}

bool kdr_output_check(const char *path, kdr_messages *messages) {
    struct stat info;
    char target[PATH_MAX], directory[PATH_MAX];
    const char *own = path;
    if (stat(path, &info) == 0) {
        if (S_ISDIR(info.st_mode))
            return refuse(path, EISDIR, messages);
        if (access(path, W_OK) != 0)
            return refuse(path, errno, messages);
        if (!S_ISREG(info.st_mode))
            return true;
        if (!realpath(path, target))
            return refuse(path, errno, messages);
        own = target;
    } else if (errno != ENOENT || !*path) {
        return refuse(path, errno, messages);
    } else if (path[strlen(path) - 1] == '/') {
        return refuse(path, ENOENT, messages);
    }

    // A new file takes the name at the end, so the directory must let one be made.
    if (!directory_of(own, directory))
        return refuse(path, ENAMETOOLONG, messages);
    int number = try_directory(directory);
    if (number != 0)
        return refuse(path, number, messages);
    return true;
}

/* Where a file of a name that leads nowhere yet would come to be: its directory, and its name in there. Symbolic links
 * are followed, since whoever finds the file there later follows them too. False if that cannot be told. */
static bool place_of(const char *path, struct stat *directory_info, char name[PATH_MAX]) {
    char at[PATH_MAX], link[PATH_MAX], directory[PATH_MAX];
    if (snprintf(at, sizeof(at), "%s", path) >= PATH_MAX)
        return false;
    for (int links = 0; links < LINK_LIMIT; links++) {
        if (!directory_of(at, directory))
            return false;
        size_t prefix = strlen(directory);
        ssize_t length = readlink(at, link, sizeof(link) - 1);
        if (length < 0) {
            strcpy(name, at + prefix);
            return *name && stat(prefix ? directory : ".", directory_info) == 0;
        }
        link[length] = 0;
        prefix = link[0] == '/' ? 0 : prefix;
        if (prefix + (size_t)length >= sizeof(at))
            return false;
        memcpy(at + prefix, link, (size_t)length + 1);
    }
    return false;
}

bool kdr_output_same(const char *a, const char *b) {
    struct stat info_a, info_b;
    bool there_a = stat(a, &info_a) == 0, there_b = stat(b, &info_b) == 0;
    if (there_a && there_b)
        return S_ISREG(info_a.st_mode) && info_a.st_dev == info_b.st_dev && info_a.st_ino == info_b.st_ino;
    if (there_a || there_b)
        return false;
    char name_a[PATH_MAX], name_b[PATH_MAX];
    if (!place_of(a, &info_a, name_a) || !place_of(b, &info_b, name_b))
        return strcmp(a, b) == 0;
    return info_a.st_dev == info_b.st_dev && info_a.st_ino == info_b.st_ino && strcmp(name_a, name_b) == 0;
}

/* A new file beside the target. 0, or an error number. */
static int open_temporary(kdr_output *output) {
    char directory[PATH_MAX];
    if (!directory_of(output->target, directory))
        return ENAMETOOLONG;
    int length = snprintf(output->temporary, sizeof(output->temporary), "%s.kdray-%ld.txt", directory, (long)getpid());
    int file = -1;
    if (length > 0 && (size_t)length < sizeof(output->temporary))
        file = open(output->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    else
        errno = ENAMETOOLONG;
    if (file < 0) {
        output->temporary[0] = 0;
        return errno;
    }
    output->file = fdopen(file, "w");
    if (output->file)
        return 0;
    int number = errno;
    close(file);
    unlink(output->temporary);
    return number;
}

bool kdr_output_open(kdr_output *output, const char *path, kdr_messages *messages) {
    output->file = NULL;
    output->path = path;
    output->temporary[0] = 0;
    if (strcmp(path, "-") == 0) {
        output->file = stdout;
        return true;
    }
    if (strlen(path) >= sizeof(output->target))
        return refuse(path, ENAMETOOLONG, messages);
    strcpy(output->target, path);
    struct stat info;
    if (stat(path, &info) == 0) {
        if (!S_ISREG(info.st_mode)) {
            output->file = fopen(path, "we");
            return output->file || refuse(path, errno, messages);
        }
        if (!realpath(path, output->target))
            return refuse(path, errno, messages);
    }
    int number = open_temporary(output);
    return number == 0 || refuse(path, number, messages);
}

bool kdr_output_close(kdr_output *output, kdr_messages *messages) {
    // The program's end looks after stdout.
    if (output->file == stdout)
        return true;
    int number = 0;
    if (fflush(output->file) != 0 || ferror(output->file))
        number = errno ? errno : EIO;
    if (number == 0 && output->temporary[0] && fsync(fileno(output->file)) != 0)
        number = errno;
    if (fclose(output->file) != 0 && number == 0)
        number = errno;
    if (number == 0 && output->temporary[0] && rename(output->temporary, output->target) != 0)
        number = errno;
    if (number == 0)
        return true;
    if (output->temporary[0])
        unlink(output->temporary);
    return refuse(output->path, number, messages);
}
