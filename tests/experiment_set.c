/* --set in experiments: a changed scene is what a file would be that says the change, is named by
 * it in tables, and leaves out what is known of the experiment's own scenes. */
#include "base/files.h"
#include "base/text_table.h"
#include "experiments/common/statements.h"
#include "support.h"

#include <criterion/criterion.h>
#include <glob.h>
#include <stdlib.h>
#include <string.h>

static char *folder;

static void open_folder(void) {
    folder = folder_make();
}

/* The experiment on a scene with one method; `set` may be NULL. */
static struct finished *race(const char *scene, const char *set, const char *out) {
    return WORKS("experiment", "work-precision", "--quick", "--no-progress", "--scene", scene,
                 "--stepper", "rk4", "--out", out, set ? "--set" : NULL, set);
}

/* The hashes by which the folders of runs are named, in their order, a line each. */
static void hashes_of(const char *out, char *hashes, size_t size) {
    glob_t found;
    cr_assert_eq(files_like(printed("%s/runs", out), "*", &found), 0);
    char(*list)[20] = test_room(found.gl_pathc * sizeof *list);
    for (size_t i = 0; i < found.gl_pathc; i++)
        snprintf(list[i], sizeof *list, "%s", strrchr(found.gl_pathv[i], '-') + 1);
    qsort(list, found.gl_pathc, sizeof *list, (int (*)(const void *, const void *))strcmp);
    hashes[0] = '\0';
    for (size_t i = 0; i < found.gl_pathc; i++) {
        strncat(hashes, list[i], size - strlen(hashes) - 1);
        strncat(hashes, "\n", size - strlen(hashes) - 1);
    }
    globfree(&found);
}

/* The same runs, to their hashes, whether a change is set or is in a file; and others without it.
 */
Test(experiment_set, is_what_a_file_would_say, .init = open_folder, .timeout = 100) {
    static char set[8192], said[8192], plain[8192];
    const char *out[3];
    const char *const scene =
        file_write(folder, "short.cfg", "base = \"swing\"; name = \"short\"; duration = 0.05;\n");
    const char *const changed =
        file_write(folder, "changed.cfg",
                   "base = \"short.cfg\"; name = \"short\"; material = { drag_rate = 2.0; };\n");
    for (int i = 0; i < 3; i++)
        out[i] = printed("%s/out-%d", folder, i);
    const struct finished *f = race(scene, "material.drag_rate=2.0", out[0]);
    cr_expect(strstr(f->out, "not asked      ours    What follows is of scenes with "
                             "material.drag_rate=2.0"),
              "%s", f->out);
    f = race(changed, NULL, out[1]);
    cr_expect(!strstr(f->out, "What follows"), "%s", f->out);
    race(scene, NULL, out[2]);
    hashes_of(out[0], set, sizeof set);
    hashes_of(out[1], said, sizeof said);
    hashes_of(out[2], plain, sizeof plain);
    cr_expect_str_eq(set, said);
    for (char *hash = strtok(plain, "\n"); hash; hash = strtok(NULL, "\n"))
        cr_expect(!strstr(set, hash), "%s is a run of both scenes", hash);

    /* and every table is named by the change */
    const char *text = file_of(out[0], "work-precision/short-with-material.drag_rate-2.0.tsv");
    cr_expect(strstr(text, "# scene short with material.drag_rate=2.0, hash "), "%.400s", text);
    struct text_table rows;
    statements_must_be_read(&rows, printed("%s/work-precision", out[0]));
    cr_expect_eq(text_table_find(&rows, "changed scenes", NULL), 0);
}

Test(experiment_set, what_it_cannot_change_is_refused, .init = open_folder) {
    static const struct {
        const char *experiment, *set, *says;
    } wrong[] = {
        {"circle", "duration=1", "experiment circle has scenes of its own; leave out --set"},
        {"history", "material.drag_rate=2", "leave out --set"},
        {"chapter5", "material.drag_rate=2", "leave out --set"},
        {"radii", "envelope.radius=0.05", "experiment radii sets that itself in all of its runs"},
        {"needs", "materail.drag_rate=2", "did you mean material?"},
        {"needs", "material.drag_rate=-2", "--set: drag_rate: -2 is not a number from 0 on"},
        {"needs", "material.drag_rate", "write --set path.to.setting=value"},
        {"kernel", "envelope.samples=2", "--set: samples: 2 is not a whole number from 3"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        FAILS(1, wrong[i].says, "experiment", wrong[i].experiment, "--quick", "--set", wrong[i].set,
              "--out", folder);
        cr_expect_eq(count_files(folder, ""), 0, "%s: wrote something", wrong[i].experiment);
    }
}
