#include "base/arena.h"
#include "support/failing_alloc.h"
#include "support/random.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#define CHUNK 4096

typedef struct fixture {
    failing_alloc failing;
    kdr_alloc alloc;
    kdr_arena arena;
} fixture;

static int open_arena(void **state) {
    static fixture f;
    failing_alloc_init(&f.failing);
    kdr_allocator functions = failing_alloc_functions(&f.failing);
    kdr_alloc_init(&f.alloc, &functions);
    kdr_arena_init(&f.arena, &f.alloc, CHUNK);
    *state = &f;
    return 0;
}

static int close_arena(void **state) {
    fixture *f = *state;
    kdr_arena_destroy(&f->arena);
    return failing_alloc_is_clean(&f->failing) && atomic_load(&f->alloc.bytes) == 0 ? 0 : -1;
}

static void requests_are_aligned_writable_and_apart(void **state) {
    fixture *f = *state;
    enum { COUNT = 300 };
    unsigned char *blocks[COUNT];
    for (int i = 0; i < COUNT; i++) {
        blocks[i] = kdr_arena_get(&f->arena, (size_t)i);
        assert_non_null(blocks[i]);
        assert_int_equal((uintptr_t)blocks[i] % 64, 0);
        memset(blocks[i], i & 255, (size_t)i);
    }
    for (int i = 0; i < COUNT; i++)
        for (int j = 0; j < i; j++)
            assert_int_equal(blocks[i][j], i & 255);
}

static void an_empty_request_has_an_address_of_its_own(void **state) {
    fixture *f = *state;
    void *first = kdr_arena_get(&f->arena, 0);
    void *second = kdr_arena_get(&f->arena, 0);
    assert_non_null(first);
    assert_ptr_not_equal(first, second);
}

static void small_requests_share_a_chunk(void **state) {
    fixture *f = *state;
    for (int i = 0; i < CHUNK / 64; i++)
        assert_non_null(kdr_arena_get(&f->arena, 64));
    assert_int_equal(atomic_load(&f->failing.calls), 1);
    assert_non_null(kdr_arena_get(&f->arena, 64));
    assert_int_equal(atomic_load(&f->failing.calls), 2);
}

static void a_request_larger_than_a_chunk_gets_one_of_its_size(void **state) {
    fixture *f = *state;
    unsigned char *memory = kdr_arena_get(&f->arena, 10 * CHUNK);
    assert_non_null(memory);
    memset(memory, 1, 10 * CHUNK);
    assert_int_equal(atomic_load(&f->failing.calls), 1);
}

static void a_restored_mark_gives_the_same_memory_again(void **state) {
    fixture *f = *state;
    kdr_arena_get(&f->arena, 100);
    kdr_arena_mark mark = kdr_arena_save(&f->arena);
    void *first = kdr_arena_get(&f->arena, 200);
    for (int i = 0; i < 50; i++)
        kdr_arena_get(&f->arena, 1000);
    kdr_arena_restore(&f->arena, mark);
    assert_ptr_equal(kdr_arena_get(&f->arena, 200), first);
}

static void a_mark_of_an_unused_arena_empties_it(void **state) {
    fixture *f = *state;
    kdr_arena_mark mark = kdr_arena_save(&f->arena);
    void *first = kdr_arena_get(&f->arena, 64);
    kdr_arena_get(&f->arena, CHUNK);
    kdr_arena_get(&f->arena, CHUNK);
    kdr_arena_restore(&f->arena, mark);
    assert_ptr_equal(kdr_arena_get(&f->arena, 64), first);
}

static void the_same_work_a_second_time_allocates_nothing(void **state) {
    fixture *f = *state;
    test_random random = test_random_start(test_random_seed(), 1);
    kdr_arena_mark mark = kdr_arena_save(&f->arena);
    for (int round = 0; round < 5; round++) {
        test_random again = random;
        for (int i = 0; i < 200; i++)
            assert_non_null(kdr_arena_get(&f->arena, test_random_below(&again, 3 * CHUNK)));
        if (round == 0)
            failing_alloc_fail_from(&f->failing, 1);
        assert_int_equal(atomic_load(&f->failing.calls), 0);
        kdr_arena_restore(&f->arena, mark);
    }
}

static void a_kept_chunk_that_fits_is_found_behind_those_that_do_not(void **state) {
    fixture *f = *state;
    kdr_arena_mark mark = kdr_arena_save(&f->arena);
    kdr_arena_get(&f->arena, CHUNK);
    kdr_arena_get(&f->arena, CHUNK);
    void *large = kdr_arena_get(&f->arena, 8 * CHUNK);
    kdr_arena_restore(&f->arena, mark);
    failing_alloc_fail_from(&f->failing, 1);
    assert_ptr_equal(kdr_arena_get(&f->arena, 8 * CHUNK), large);
    assert_non_null(kdr_arena_get(&f->arena, CHUNK));
    assert_non_null(kdr_arena_get(&f->arena, CHUNK));
    assert_null(kdr_arena_get(&f->arena, CHUNK));
}

/* Nested marks, as a recursive build sets them: whatever is live keeps its contents. */
static void recurse(kdr_arena *arena, test_random *random, int depth) {
    kdr_arena_mark mark = kdr_arena_save(arena);
    size_t size = 1 + test_random_below(random, 2000);
    unsigned char *memory = kdr_arena_get(arena, size);
    assert_non_null(memory);
    memset(memory, depth, size);
    if (depth > 0) {
        recurse(arena, random, depth - 1);
        recurse(arena, random, depth - 1);
    }
    for (size_t i = 0; i < size; i++)
        assert_int_equal(memory[i], depth);
    kdr_arena_restore(arena, mark);
}

static void nested_marks_never_touch_what_is_live(void **state) {
    fixture *f = *state;
    test_random random = test_random_start(test_random_seed(), 2);
    recurse(&f->arena, &random, 7);
    assert_null(kdr_arena_save(&f->arena).chunk);
}

static void without_memory_a_request_fails_and_the_arena_goes_on(void **state) {
    fixture *f = *state;
    failing_alloc_fail_nth(&f->failing, 1);
    assert_null(kdr_arena_get(&f->arena, 100));
    unsigned char *memory = kdr_arena_get(&f->arena, 100);
    assert_non_null(memory);
    memset(memory, 9, 100);
    failing_alloc_fail_nth(&f->failing, 1);
    assert_null(kdr_arena_get(&f->arena, CHUNK));
    assert_non_null(kdr_arena_get(&f->arena, 64));
    assert_int_equal(memory[99], 9);
}

static void a_size_that_overflows_is_refused(void **state) {
    fixture *f = *state;
    assert_null(kdr_arena_get(&f->arena, SIZE_MAX));
    assert_null(kdr_arena_get(&f->arena, SIZE_MAX - 63));
    assert_null(kdr_arena_get(&f->arena, SIZE_MAX - 127));
    assert_non_null(kdr_arena_get(&f->arena, 1));
}

static void a_destroyed_arena_holds_nothing_and_may_be_destroyed_again(void **state) {
    fixture *f = *state;
    kdr_arena_get(&f->arena, 10 * CHUNK);
    kdr_arena_destroy(&f->arena);
    assert_int_equal(atomic_load(&f->alloc.bytes), 0);
    kdr_arena_destroy(&f->arena);
    assert_non_null(kdr_arena_get(&f->arena, 10));
}

#define arena_test(name) cmocka_unit_test_setup_teardown(name, open_arena, close_arena)

int main(void) {
    const struct CMUnitTest tests[] = {
        arena_test(requests_are_aligned_writable_and_apart),
        arena_test(an_empty_request_has_an_address_of_its_own),
        arena_test(small_requests_share_a_chunk),
        arena_test(a_request_larger_than_a_chunk_gets_one_of_its_size),
        arena_test(a_restored_mark_gives_the_same_memory_again),
        arena_test(a_mark_of_an_unused_arena_empties_it),
        arena_test(the_same_work_a_second_time_allocates_nothing),
        arena_test(a_kept_chunk_that_fits_is_found_behind_those_that_do_not),
        arena_test(nested_marks_never_touch_what_is_live),
        arena_test(without_memory_a_request_fails_and_the_arena_goes_on),
        arena_test(a_size_that_overflows_is_refused),
        arena_test(a_destroyed_arena_holds_nothing_and_may_be_destroyed_again),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
