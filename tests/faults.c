/* tests/faults.tsv is of this source: replay_faults.sh takes too long to say so at each change. */
#include "support.h"

#include <criterion/criterion.h>
#include <stdlib.h>
#include <string.h>

static int occurrences(const char *text, const char *part) {
    int count = 0;
    for (const char *at = text; (at = strstr(at, part)) != NULL; at += strlen(part))
        count++;
    return count;
}

Test(faults, each_text_is_in_its_file_once) {
    char *list = file_read(WISPLAB_TESTS_DIR "/faults.tsv");
    int rows = 0;
    cr_assert(list, "no faults.tsv");
    for (char *rest = list, *line; (line = strsep(&rest, "\n")) != NULL;) {
        char path[PATH_SIZE], *field[4] = {NULL};
        if (line[0] == '#' || line[0] == '\0')
            continue;
        for (int i = 0; i < 4; i++)
            field[i] = strsep(&line, "\t");
        cr_assert(field[3] && field[3][0] && !line, "row %d has not four fields", rows + 1);
        path_format(path, "%s/../%s", WISPLAB_TESTS_DIR, field[0]);
        char *text = file_read(path);
        cr_expect(text && occurrences(text, field[1]) == 1, "%s has '%s' %d times, not once",
                  field[0], field[1], text ? occurrences(text, field[1]) : 0);
        cr_expect_str_neq(field[1], field[2], "%s: '%s' stays as it is", field[0], field[1]);
        free(text);
        rows++;
    }
    free(list);
    cr_assert_gt(rows, 90, "only %d faults", rows);
}
