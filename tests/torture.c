/* tests/torture.sh in its short form: kill -9, two processes, two hosts, a full disk, small limits.
 */
#include "support.h"

#include <criterion/criterion.h>

Test(torture, slow_all_is_there_afterwards, .timeout = 900) {
    const struct launch launch = {.program = printed("%s/torture.sh", WISPLAB_TESTS_DIR)};
    program_must(&launch, 0, NULL, WORDS("--short", program_path));
}
