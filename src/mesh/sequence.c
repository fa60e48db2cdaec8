#include "mesh/sequence.h"

#include "mesh/mesh_memory.h"
#include "mesh/report.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define DIGIT_LIMIT 15 /* numbers stay exact in every type they pass through */

typedef struct sequence {
    char before[PATH_MAX], after[PATH_MAX]; /* of the number in a file's name; `before` with the folder */
    int digits;
    uint64_t first, count;
    double rate;
    uint64_t shown; /* number of the file in the caller's mesh; UINT64_MAX: none */
} sequence;

static const char *last_part(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

bool kdr_sequence_is_meant(const char *path) { return strchr(last_part(path), '#') != NULL; }

static void destroy(void *state) { kdr_alloc_release(kdr_mesh_memory(), state, sizeof(sequence)); }

/* False if the name is too long. */
static bool file_name(const sequence *of, uint64_t number, char name[PATH_MAX]) {
    int length = snprintf(name, PATH_MAX, "%s%0*" PRIu64 "%s", of->before, of->digits, number, of->after);
    return length >= 0 && length < PATH_MAX;
}

static kdr_status sample(void *state, double seconds, const kdr_logger *logger, kdr_mesh **mesh) {
    sequence *of = state;
    /* A time that was made as number / rate may have come out a little below it. */
    double place = floor(seconds * of->rate * (1 + 0x1p-40) + 0x1p-30);
    uint64_t index = place <= 0 ? 0 : place >= (double)(of->count - 1) ? of->count - 1 : (uint64_t)place;
    if (*mesh && of->shown == index)
        return KDR_OK;
    char name[PATH_MAX];
    kdr_mesh *read;
    if (!file_name(of, of->first + index, name))
        return kdr_report(logger, KDR_ERROR_LIMIT, "%s#%s: the name is too long", of->before, of->after);
    kdr_status status = kdr_mesh_read(name, logger, &read);
    if (status != KDR_OK)
        return status;
    kdr_mesh_destroy(*mesh);
    *mesh = read;
    of->shown = index;
    return KDR_OK;
}

/* The number in a file's name, if it is one of the sequence. */
static bool number_of(const char *name, const char *before, const char *after, int digits, uint64_t *number) {
    size_t length = strlen(name), head = strlen(before), tail = strlen(after);
    if (length < head + tail + (size_t)digits || length > head + tail + DIGIT_LIMIT)
        return false;
    if (memcmp(name, before, head) != 0 || memcmp(name + length - tail, after, tail) != 0)
        return false;
    const char *end = name + length - tail, *p = name + head;
    if (end - p > digits && *p == '0')
        return false;
    for (*number = 0; p < end; p++) {
        if (*p < '0' || *p > '9')
            return false;
        *number = 10 * *number + (uint64_t)(*p - '0');
    }
    return true;
}

/* Looks through the folder. */
static kdr_status find_files(sequence *of, const char *path, const kdr_logger *logger) {
    char folder[PATH_MAX];
    const char *part = last_part(of->before);
    snprintf(folder, sizeof folder, "%.*s", (int)(part - of->before), of->before);
    DIR *opened = opendir(*folder ? folder : ".");
    if (!opened)
        return kdr_report(logger, KDR_ERROR_IO, "%s: %s", path, strerror(errno));
    uint64_t first = UINT64_MAX, last = 0, found = 0, number;
    for (struct dirent *entry = readdir(opened); entry; entry = readdir(opened)) {
        if (!number_of(entry->d_name, part, of->after, of->digits, &number))
            continue;
        first = number < first ? number : first;
        last = number > last ? number : last;
        found++;
    }
    closedir(opened);
    if (found == 0)
        return kdr_report(logger, KDR_ERROR_IO, "%s: there is no file with a number in place of #", path);
    of->first = first;
    of->count = last - first + 1;
    if (found == of->count)
        return KDR_OK;
    /* Name the first one that is not there. */
    for (number = first; number < last; number++) {
        char name[PATH_MAX];
        FILE *file = file_name(of, number, name) ? fopen(name, "rb") : NULL;
        if (!file)
            return kdr_report(logger, KDR_ERROR_INVALID_DATA,
                              "%s: expected the numbers %" PRIu64 " to %" PRIu64 ", found none of %" PRIu64, path,
                              first, last, number);
        fclose(file);
    }
    return kdr_report(logger, KDR_ERROR_INVALID_DATA, "%s: files came or went", path);
}

kdr_status kdr_sequence_open(const char *path, double rate, const kdr_logger *logger, kdr_animation_source *out) {
    *out = (kdr_animation_source){0};
    const char *mark = strchr(last_part(path), '#');
    size_t digits = strspn(mark, "#");
    if (strchr(mark + digits, '#'))
        return kdr_report(logger, KDR_ERROR_INVALID_ARGUMENT, "%s: expected # in one place only", path);
    if (digits > DIGIT_LIMIT || strlen(path) >= PATH_MAX)
        return kdr_report(logger, KDR_ERROR_LIMIT, "%.100s: the name or its number is too long", path);
    sequence *of = kdr_alloc_get(kdr_mesh_memory(), sizeof *of, KDR_MESH_ALIGNMENT);
    if (!of)
        return kdr_report(logger, KDR_ERROR_OUT_OF_MEMORY, "%s: out of memory", path);
    of->digits = (int)digits;
    of->rate = rate;
    of->shown = UINT64_MAX;
    snprintf(of->before, sizeof of->before, "%.*s", (int)(mark - path), path);
    snprintf(of->after, sizeof of->after, "%s", mark + digits);
    kdr_status status = find_files(of, path, logger);
    if (status == KDR_OK)
        *out = (kdr_animation_source){of, (double)of->count / rate, sample, destroy};
    else
        destroy(of);
    return status;
}
