/* tests/faults.tsv is of this source: replay_faults.sh takes too long to say so at each change. */
#include "support.h"

#include <criterion/criterion.h>
#include <fnmatch.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int occurrences(const char *text, const char *part) {
    int count = 0;
    for (const char *at = text; (at = strstr(at, part)) != NULL; at += strlen(part))
        count++;
    return count;
}

/* All tests of this program as `suite/test`, as it lists them itself. */
enum { TESTS_MAX = 2000, NAME_SIZE = 160 };
static int list_tests(char names[TESTS_MAX][NAME_SIZE]) {
    char self[PATH_SIZE] = "", line[NAME_SIZE], suite[64] = "", name[96];
    int count = 0;
    cr_assert(readlink("/proc/self/exe", self, sizeof self - 1) > 0);
    FILE *list = popen(printed("env -i LC_ALL=C '%s' --list", self), "r");
    cr_assert(list, "no list of tests");
    while (fgets(line, sizeof line, list) && count < TESTS_MAX) {
        if (sscanf(line, "%*1[|`]-- %95s", name) == 1)
            snprintf(names[count++], NAME_SIZE, "%s/%s", suite, name);
        else
            sscanf(line, "%63[^:]", suite);
    }
    pclose(list);
    return count;
}

/* Sanitizers have an allocator of their own, and some tests of ours are not there then. */
#if defined(__SANITIZE_ADDRESS__)
enum { ALL_ARE_THERE = 0 };
#else
enum { ALL_ARE_THERE = 1 };
#endif

Test(faults, each_names_a_test) {
    static char names[TESTS_MAX][NAME_SIZE];
    char *list = file_read(WISPLAB_TESTS_DIR "/faults.tsv");
    const int count = list_tests(names);
    cr_assert(list, "no faults.tsv");
    cr_assert_gt(count, 100, "only %d tests", count);
    for (char *rest = list, *line; (line = strsep(&rest, "\n")) != NULL;) {
        const char *test = strrchr(line, '\t');
        int found = 0;
        for (int i = 0; i < count && test; i++)
            found |= fnmatch(test + 1, names[i], 0) == 0;
        cr_expect(!test || line[0] == '#' || found || !ALL_ARE_THERE, "no test is called %s",
                  test + 1);
    }
}

Test(faults, each_text_is_in_its_file_once) {
    char *list = file_read(WISPLAB_TESTS_DIR "/faults.tsv");
    int rows = 0;
    cr_assert(list, "no faults.tsv");
    for (char *rest = list, *line; (line = strsep(&rest, "\n")) != NULL;) {
        char *field[4] = {NULL};
        if (line[0] == '#' || line[0] == '\0')
            continue;
        for (int i = 0; i < 4; i++)
            field[i] = strsep(&line, "\t");
        cr_assert(field[3] && field[3][0] && !line, "row %d has not four fields", rows + 1);
        const char *const path = printed("%s/../%s", WISPLAB_TESTS_DIR, field[0]);
        char *text = file_read(path);
        cr_expect(text && occurrences(text, field[1]) == 1, "%s has '%s' %d times, not once",
                  field[0], field[1], text ? occurrences(text, field[1]) : 0);
        cr_expect_str_neq(field[1], field[2], "%s: '%s' stays as it is", field[0], field[1]);
        rows++;
    }
    cr_assert_gt(rows, 90, "only %d faults", rows);
}
