/* Equal keys found, so that what is written many times is kept once. */
#ifndef KDR_MESH_MERGE_H
#define KDR_MESH_MERGE_H

#include "kdray/kdray.h"
#include "mesh/text.h"

/* Numbers keys of `word_count` 32-bit words each in the order of their first appearance, equal ones alike: numbers[i]
 * is the number of key i, *unique_count how many there are. count is at most KDR_MESH_LIMIT. Errors: OUT_OF_MEMORY.
 * Cost: linear, one table of at most four words a key. */
kdr_status kdr_merge_keys(const uint32_t *keys, size_t word_count, size_t count, uint32_t *numbers,
                          size_t *unique_count);

/* Names with numbers in the order of their first appearance. Words are borrowed. All zero: empty. */
typedef struct kdr_names {
    kdr_word *words;
    size_t count, capacity;
    uint32_t *slots; /* number + 1, 0: free; open addressing */
    size_t slot_count;
} kdr_names;

/* KDR_INVALID_ID when it is not there. */
uint32_t kdr_names_find(const kdr_names *names, kdr_word word);

/* Adds a name that is not there; its number is count - 1 afterwards. Errors: OUT_OF_MEMORY. */
kdr_status kdr_names_add(kdr_names *names, kdr_word word);

void kdr_names_release(kdr_names *names);

#endif
