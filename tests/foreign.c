/* What others have named or written: names that are commands elsewhere, files that are not ours and
 * files without an end. */
#include "support.h"

#include <criterion/criterion.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char folder[PATH_SIZE];

static void open_folder(void) {
    folder_make(folder);
}

static void close_folder(void) {
    folder_remove(folder);
}

/* A scene with this in it. */
static void check_scene(const char *more, const char *says, const char *never) {
    static const char scene[] =
        "duration = 0.1; frame_rate = 30.0; gravity = [0.0, -9.81, 0.0]; material = { };\n"
        "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0]; length = 0.1;\n"
        "            nodes = 4; } );\n%s\n";
    char text[2048], path[PATH_SIZE];
    struct finished f;
    snprintf(text, sizeof text, scene, more);
    file_write(folder, "scene.cfg", text, path);
    PROGRAM(&f, NULL, "run", path, "--out", folder, "--no-progress");
    cr_expect_eq(f.code, 1, "%s: exit code %d: %s", more, f.code, f.err);
    cr_expect(count_lines(f.err) == 1 && strstr(f.err, says), "%s: '%s'", more, f.err);
    cr_expect(!never || !strstr(f.err, never), "%s: '%s'", more, f.err);
}

Test(foreign, a_start_is_a_file_with_an_end, .init = open_folder, .fini = close_folder,
     .timeout = 60) {
    check_scene("start = \"/dev/zero\";", "is no regular file", NULL);
}

Test(foreign, what_is_included_is_a_file_with_an_end, .init = open_folder, .fini = close_folder,
     .timeout = 60) {
    char link[PATH_SIZE];
    path_format(link, "%s/endless", folder);
    cr_assert_eq(symlink("/dev/zero", link), 0);
    check_scene("@include \"endless\"", "is no regular file", NULL);
}

Test(foreign, nothing_is_shown_of_a_file_that_is_not_ours, .init = open_folder,
     .fini = close_folder) {
    char start[PATH_SIZE], text[PATH_SIZE];
    file_write(folder, "other", "# a comment\nsecret:word:1000\nmore:of:it\n", start);
    snprintf(text, sizeof text, "start = \"other\";");
    check_scene(text, "is no table of states", "secret");
}

Test(foreign, texts_are_utf8, .init = open_folder, .fini = close_folder) {
    check_scene("start = \"a\\xff.tsv\";", "scene.cfg:4: start: must be a text in UTF-8", NULL);
}

/* A folder whose name is a command to gnuplot is a folder. */
Test(foreign, names_of_folders_are_no_commands, .init = open_folder, .fini = close_folder) {
    static const char *const names[] = {"| touch made;", "< touch made;", "'; touch made; '"};
    char made[PATH_SIZE];
    path_format(made, "%s/made", folder);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const struct launch here = {.folder = folder};
        char figure[PATH_SIZE];
        struct finished f;
        PROGRAM(&f, &here, "experiment", "circle", "--quick", "--stepper", "euler", "--out",
                names[i]);
        cr_expect_eq(f.code, 0, "%s: exit code %d: %s", names[i], f.code, f.err);
        path_format(figure, "%s/%s/circle/orbits-30s.svg", folder, names[i]);
        cr_expect_eq(access(figure, F_OK), 0, "no %s", figure);
        cr_assert(access(made, F_OK) != 0, "%s: the command has run", names[i]);
    }
}

/* One that says that all is well, and has drawn nothing. */
Test(foreign, a_gnuplot_that_draws_nothing_has_failed, .init = open_folder, .fini = close_folder) {
    char stub[PATH_SIZE], path[2 * PATH_SIZE];
    struct finished f;
    file_write(folder, "gnuplot", "#!/bin/sh\nexit 0\n", stub);
    chmod(stub, 0755);
    snprintf(path, sizeof path, "%s:%s", folder, getenv("PATH"));
    setenv("PATH", path, 1);
    PROGRAM(&f, NULL, "experiment", "circle", "--quick", "--stepper", "euler", "--out", folder);
    cr_expect(f.code == 2 && strstr(f.err, "has drawn no svg"), "%d: '%s'", f.code, f.err);
}
