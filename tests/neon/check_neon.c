/* The tables of this machine's instruction sets against each other, without a test library: run under an emulator for
 * machines that the tests are not on. */
#include "support/table_check.h"

#include <stdio.h>

int main(void) {
    size_t builds = 0, wrong = 0;
    for (int isa = KDR_ISA_SCALAR; isa <= KDR_ISA_NEON; isa++) {
        table_check check = table_check_run((kdr_isa)isa, 600, 2000);
        if (check.builds == 0)
            continue;
        printf("%s: %zu trees, %zu rays, %zu hits, %zu different answers, %zu unsound trees\n",
               kdr_isa_name((kdr_isa)isa), check.builds, check.rays, check.hits, check.differences, check.unsound);
        builds += check.builds;
        wrong += check.differences + check.unsound + (check.hits < check.rays / 10);
    }
    return builds >= 6 && wrong == 0 ? 0 : 1;
}
