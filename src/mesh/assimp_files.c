#ifdef KDR_WITH_ASSIMP

#include "mesh/assimp_files.h"

#include "mesh/file_bytes.h"
#include "mesh/mesh_memory.h"

#include <string.h>
#include <sys/stat.h>

/* An open file: bytes in memory and a place among them. */
typedef struct open_file {
    struct aiFile file;
    const unsigned char *bytes;
    size_t length, place;
    kdr_file_bytes owned; /* of a file beside the source; empty for the source itself */
} open_file;

static open_file *of(struct aiFile *file) { return (open_file *)(void *)file->UserData; }

/* Whole units only, as fread gives them. */
static size_t read_units(struct aiFile *file, char *to, size_t size, size_t count) {
    open_file *open = of(file);
    if (size == 0)
        return 0;
    size_t units = (open->length - open->place) / size;
    units = units < count ? units : count;
    if (units)
        memcpy(to, open->bytes + open->place, units * size);
    open->place += units * size;
    return units;
}

static size_t write_nothing(struct aiFile *file, const char *from, size_t size, size_t count) {
    (void)file, (void)from, (void)size, (void)count;
    return 0;
}

static size_t tell(struct aiFile *file) { return of(file)->place; }

static size_t size_of(struct aiFile *file) { return of(file)->length; }

static enum aiReturn seek(struct aiFile *file, size_t offset, enum aiOrigin origin) {
    open_file *open = of(file);
    size_t base = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? open->place : open->length;
    size_t place = base + offset; // a step back is a huge offset that wraps around
    if (place > open->length)
        return aiReturn_FAILURE;
    open->place = place;
    return aiReturn_SUCCESS;
}

static void flush(struct aiFile *file) { (void)file; }

static bool open_sibling(const char *path, open_file *open) {
    struct stat about;
    if (stat(path, &about) != 0 || !S_ISREG(about.st_mode) || kdr_file_bytes_open(path, NULL, &open->owned) != KDR_OK)
        return false;
    open->bytes = open->owned.bytes;
    open->length = open->owned.length;
    return true;
}

static struct aiFile *open_by_name(struct aiFileIO *io, const char *path, const char *mode) {
    const kdr_assimp_files *files = (const kdr_assimp_files *)(void *)io->UserData;
    if (mode[0] != 'r')
        return NULL;
    open_file *open = kdr_alloc_get(kdr_mesh_memory(), sizeof *open, KDR_MESH_ALIGNMENT);
    if (!open)
        return NULL;
    *open = (open_file){.file = {read_units, write_nothing, tell, size_of, seek, flush, (aiUserData)(void *)open}};
    bool is_open = true;
    if (strcmp(path, files->name) == 0) {
        open->bytes = files->source->bytes;
        open->length = files->source->length;
    } else {
        is_open = files->source->siblings && open_sibling(path, open);
    }
    if (is_open)
        return &open->file;
    kdr_alloc_release(kdr_mesh_memory(), open, sizeof *open);
    return NULL;
}

static void close_file(struct aiFileIO *io, struct aiFile *file) {
    (void)io;
    open_file *open = of(file);
    kdr_file_bytes_release(&open->owned);
    kdr_alloc_release(kdr_mesh_memory(), open, sizeof *open);
}

void kdr_assimp_files_begin(kdr_assimp_files *files, struct aiFileIO *io) {
    *io = (struct aiFileIO){open_by_name, close_file, (aiUserData)(void *)files};
}

#else
typedef int kdr_assimp_files_are_left_out; // a file of C holds at least one declaration
#endif
