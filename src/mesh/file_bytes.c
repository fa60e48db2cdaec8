#include "mesh/file_bytes.h"

#include "mesh/mesh_memory.h"
#include "mesh/report.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

/* A pipe tells no size: the first buffer for one. */
#define FIRST_CAPACITY ((size_t)64 << 10)

void kdr_file_bytes_release(kdr_file_bytes *file) {
    if (file->capacity)
        kdr_alloc_release(kdr_mesh_memory(), (void *)(uintptr_t)file->bytes, file->capacity);
    else if (file->bytes)
        munmap((void *)(uintptr_t)file->bytes, file->length);
    *file = (kdr_file_bytes){0};
}

/* Doubles the memory behind `file`, contents kept. */
static bool grow(kdr_file_bytes *file, size_t used) {
    size_t capacity = file->capacity ? file->capacity : FIRST_CAPACITY / 2;
    unsigned char *fresh = kdr_alloc_array(kdr_mesh_memory(), capacity, 2, KDR_MESH_ALIGNMENT);
    if (!fresh)
        return false;
    if (used)
        memcpy(fresh, file->bytes, used);
    kdr_alloc_release(kdr_mesh_memory(), (void *)(uintptr_t)file->bytes, file->capacity);
    file->bytes = fresh;
    file->capacity = 2 * capacity;
    return true;
}

static kdr_status read_all(int descriptor, const char *path, const kdr_logger *logger, kdr_file_bytes *file) {
    for (;;) {
        if (file->length == file->capacity && !grow(file, file->length))
            return kdr_report(logger, KDR_ERROR_OUT_OF_MEMORY, "%s: out of memory after %zu bytes", path, file->length);
        ssize_t got =
            read(descriptor, (unsigned char *)(uintptr_t)file->bytes + file->length, file->capacity - file->length);
        if (got == 0)
            return KDR_OK;
        if (got > 0)
            file->length += (size_t)got;
        else if (errno != EINTR)
            return kdr_report(logger, KDR_ERROR_IO, "%s: cannot be read: %s", path, strerror(errno));
    }
}

static kdr_status open_descriptor(int descriptor, const char *path, const kdr_logger *logger, kdr_file_bytes *file) {
    struct stat about;
    if (fstat(descriptor, &about) != 0)
        return kdr_report(logger, KDR_ERROR_IO, "%s: cannot be read: %s", path, strerror(errno));
    if (S_ISDIR(about.st_mode))
        return kdr_report(logger, KDR_ERROR_IO, "%s: is a directory, expected a mesh file", path);
    if (S_ISFIFO(about.st_mode) || S_ISSOCK(about.st_mode))
        return read_all(descriptor, path, logger, file);
    if (!S_ISREG(about.st_mode))
        return kdr_report(logger, KDR_ERROR_IO, "%s: is a device, expected a mesh file", path);
    if (about.st_size == 0)
        return read_all(descriptor, path, logger, file); // files of the kernel's claim no size but have contents

    // Mapping with all pages at once spares a fault for each.
    void *mapped = mmap(NULL, (size_t)about.st_size, PROT_READ, MAP_PRIVATE | MAP_POPULATE, descriptor, 0);
    if (mapped == MAP_FAILED)
        return read_all(descriptor, path, logger, file);
    file->bytes = mapped;
    file->length = (size_t)about.st_size;
    return KDR_OK;
}

kdr_status kdr_file_bytes_open(const char *path, const kdr_logger *logger, kdr_file_bytes *out) {
    *out = (kdr_file_bytes){0};
    int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NOCTTY);
    if (descriptor < 0)
        return kdr_report(logger, KDR_ERROR_IO, "%s: cannot be opened: %s", path, strerror(errno));
    kdr_status status = open_descriptor(descriptor, path, logger, out);
    if (status != KDR_OK)
        kdr_file_bytes_release(out);
    close(descriptor);
    return status;
}
