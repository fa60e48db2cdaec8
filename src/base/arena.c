/* Chunks stand in one list in the order of use. Invariant: chunks before `last` are full as far as anyone cares,
 * chunks after it have used == 0; `last` is NULL exactly when nothing is taken and no mark is older. */
#include "base/arena.h"

#include "base/check.h"

#define ARENA_ALIGNMENT 64

struct kdr_arena_chunk {
    _Alignas(ARENA_ALIGNMENT) kdr_arena_chunk *next;
    size_t capacity; /* bytes after this header */
    size_t used;     /* of these, from the start; a multiple of ARENA_ALIGNMENT */
};

void kdr_arena_init(kdr_arena *arena, kdr_alloc *alloc, size_t chunk_size) {
    *arena = (kdr_arena){.alloc = alloc, .chunk_size = chunk_size};
}

void kdr_arena_destroy(kdr_arena *arena) {
    for (kdr_arena_chunk *chunk = arena->first; chunk;) {
        kdr_arena_chunk *next = chunk->next;
        kdr_alloc_release(arena->alloc, chunk, sizeof(*chunk) + chunk->capacity);
        chunk = next;
    }
    arena->first = arena->last = NULL;
}

/* Where the list goes on behind the chunk in use. */
static kdr_arena_chunk **after_last(kdr_arena *arena) { return arena->last ? &arena->last->next : &arena->first; }

/* Unlinks the first kept chunk with room enough; NULL when there is none. */
static kdr_arena_chunk *take_kept(kdr_arena *arena, size_t size) {
    for (kdr_arena_chunk **link = after_last(arena); *link; link = &(*link)->next) {
        kdr_arena_chunk *chunk = *link;
        if (chunk->capacity >= size) {
            *link = chunk->next;
            return chunk;
        }
    }
    return NULL;
}

static kdr_arena_chunk *make_chunk(kdr_arena *arena, size_t size) {
    size_t capacity = size > arena->chunk_size ? size : arena->chunk_size;
    size_t total;
    if (!kdr_size_add(capacity, sizeof(kdr_arena_chunk), &total))
        return NULL;
    kdr_arena_chunk *chunk = kdr_alloc_get(arena->alloc, total, ARENA_ALIGNMENT);
    if (chunk)
        *chunk = (kdr_arena_chunk){.capacity = capacity};
    return chunk;
}

void *kdr_arena_get(kdr_arena *arena, size_t size) {
    // Nothing at all still gets an address of its own.
    if (!kdr_size_add(size > 0 ? size : 1, ARENA_ALIGNMENT - 1, &size))
        return NULL;
    size &= ~(size_t)(ARENA_ALIGNMENT - 1);

    kdr_arena_chunk *chunk = arena->last;
    if (!chunk || chunk->capacity - chunk->used < size) {
        chunk = take_kept(arena, size);
        if (!chunk)
            chunk = make_chunk(arena, size);
        if (!chunk)
            return NULL;
        kdr_arena_chunk **link = after_last(arena);
        chunk->next = *link;
        *link = chunk;
        arena->last = chunk;
    }
    char *memory = (char *)(chunk + 1) + chunk->used;
    chunk->used += size;
    return memory;
}

kdr_arena_mark kdr_arena_save(const kdr_arena *arena) {
    return (kdr_arena_mark){arena->last, arena->last ? arena->last->used : 0};
}

void kdr_arena_restore(kdr_arena *arena, kdr_arena_mark mark) {
    // Empty every chunk that came into use after the mark.
    if (arena->last != mark.chunk) {
        kdr_arena_chunk *chunk = mark.chunk ? mark.chunk->next : arena->first;
        for (;; chunk = chunk->next) {
            KDR_CHECK(chunk);
            chunk->used = 0;
            if (chunk == arena->last)
                break;
        }
    }
    arena->last = mark.chunk;
    if (mark.chunk) {
        KDR_CHECK(mark.used <= mark.chunk->used);
        mark.chunk->used = mark.used;
    }
}
