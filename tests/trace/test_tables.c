/* Every traversal of every instruction set gives the same answer to the bit: the stack traversal of the kd-tree, the
 * traversals by name, the lone-ray traversal of the wide tree and packets, held against the scalar stack. */
#include "support/table_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>

static void every_traversal_of_every_instruction_set_gives_the_same_bits(void **state) {
    (void)state;
    size_t builds = 0;
    for (int isa = KDR_ISA_SCALAR; isa <= KDR_ISA_NEON; isa++) {
        table_check check = table_check_run((kdr_isa)isa, 600, 4000);
        assert_int_equal(check.unsound, 0);
        assert_int_equal(check.differences, 0);
        assert_true(check.hits >= check.rays / 10);
        builds += check.builds;
    }
    assert_true(builds >= 3);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_traversal_of_every_instruction_set_gives_the_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
