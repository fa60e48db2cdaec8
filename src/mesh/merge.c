/* Hash tables with open addressing and linear probing, at most half full. */
#include "mesh/merge.h"

#include "mesh/mesh_memory.h"

#include <string.h>

/* The finalizer of MurmurHash3 (A. Appleby): every bit of the input moves every bit of the result. */
static uint64_t mix(uint64_t h) {
    h = (h ^ h >> 33) * 0xff51afd7ed558ccdull;
    h = (h ^ h >> 33) * 0xc4ceb9fe1a85ec53ull;
    return h ^ h >> 33;
}

static uint64_t hash_words(const uint32_t *key, size_t word_count) {
    uint64_t h = word_count;
    for (size_t i = 0; i < word_count; i++)
        h = (h ^ key[i]) * 0x9e3779b97f4a7c15ull + (h >> 29);
    return mix(h);
}

static size_t slots_for(size_t count) {
    size_t slots = 16;
    while (slots < 2 * count)
        slots *= 2;
    return slots;
}

static uint32_t *take_slots(size_t count) {
    uint32_t *slots = kdr_alloc_array(kdr_mesh_memory(), count, sizeof *slots, KDR_MESH_ALIGNMENT);
    if (slots)
        memset(slots, 0, count * sizeof *slots);
    return slots;
}

kdr_status kdr_merge_keys(const uint32_t *keys, size_t word_count, size_t count, uint32_t *numbers,
                          size_t *unique_count) {
    size_t slot_count = slots_for(count), unique = 0;
    uint32_t *slots = take_slots(slot_count); // first key of its kind + 1
    if (!slots)
        return KDR_ERROR_OUT_OF_MEMORY;
    for (size_t i = 0; i < count; i++) {
        const uint32_t *key = keys + i * word_count;
        size_t slot = hash_words(key, word_count) & (slot_count - 1);
        while (slots[slot] && memcmp(keys + (size_t)(slots[slot] - 1) * word_count, key, word_count * sizeof *key) != 0)
            slot = (slot + 1) & (slot_count - 1);
        if (slots[slot]) {
            numbers[i] = numbers[slots[slot] - 1];
        } else {
            slots[slot] = (uint32_t)i + 1;
            numbers[i] = (uint32_t)unique++;
        }
    }
    kdr_alloc_release(kdr_mesh_memory(), slots, slot_count * sizeof *slots);
    *unique_count = unique;
    return KDR_OK;
}

static size_t find_slot(const uint32_t *slots, size_t slot_count, const kdr_word *words, kdr_word word) {
    uint64_t h = word.length;
    for (size_t i = 0; i < word.length; i++)
        h = (h ^ (unsigned char)word.start[i]) * 0x100000001b3ull;
    size_t slot = mix(h) & (slot_count - 1);
    while (slots[slot]) {
        kdr_word other = words[slots[slot] - 1];
        if (other.length == word.length && memcmp(other.start, word.start, word.length) == 0)
            break;
        slot = (slot + 1) & (slot_count - 1);
    }
    return slot;
}

uint32_t kdr_names_find(const kdr_names *names, kdr_word word) {
    if (names->slot_count == 0)
        return KDR_INVALID_ID;
    uint32_t number = names->slots[find_slot(names->slots, names->slot_count, names->words, word)];
    return number ? number - 1 : KDR_INVALID_ID;
}

/* Twice the room, all names put in again. */
static kdr_status grow_names(kdr_names *names) {
    size_t capacity = names->capacity ? 2 * names->capacity : 16, slot_count = slots_for(capacity);
    kdr_word *words = kdr_alloc_array(kdr_mesh_memory(), capacity, sizeof *words, KDR_MESH_ALIGNMENT);
    uint32_t *slots = take_slots(slot_count);
    if (!words || !slots) {
        kdr_alloc_release(kdr_mesh_memory(), words, capacity * sizeof *words);
        kdr_alloc_release(kdr_mesh_memory(), slots, slot_count * sizeof *slots);
        return KDR_ERROR_OUT_OF_MEMORY;
    }
    if (names->count)
        memcpy(words, names->words, names->count * sizeof *words);
    for (size_t i = 0; i < names->count; i++)
        slots[find_slot(slots, slot_count, words, words[i])] = (uint32_t)i + 1;
    size_t count = names->count;
    kdr_names_release(names);
    *names = (kdr_names){words, count, capacity, slots, slot_count};
    return KDR_OK;
}

kdr_status kdr_names_add(kdr_names *names, kdr_word word) {
    if (names->count == names->capacity) {
        kdr_status status = grow_names(names);
        if (status != KDR_OK)
            return status;
    }
    names->slots[find_slot(names->slots, names->slot_count, names->words, word)] = (uint32_t)names->count + 1;
    names->words[names->count++] = word;
    return KDR_OK;
}

void kdr_names_release(kdr_names *names) {
    kdr_alloc_release(kdr_mesh_memory(), names->words, names->capacity * sizeof *names->words);
    kdr_alloc_release(kdr_mesh_memory(), names->slots, names->slot_count * sizeof *names->slots);
    *names = (kdr_names){0};
}
