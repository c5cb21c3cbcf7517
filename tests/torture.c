/* tests/torture.sh in its short form: kill -9, two processes, two hosts, a full disk, small limits.
 */
#include "support.h"

#include <criterion/criterion.h>

Test(torture, slow_all_is_there_afterwards, .timeout = 900) {
    static struct finished f;
    char script[PATH_SIZE];
    path_format(script, "%s/torture.sh", WISPLAB_TESTS_DIR);
    const struct launch launch = {.program = script};
    PROGRAM(&f, &launch, "--short", program_path);
    cr_assert_eq(f.code, 0, "%s%s", f.out, f.err);
}
