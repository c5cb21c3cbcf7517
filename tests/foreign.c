/* What others have named or written: names that are commands elsewhere, files that are not ours and
 * files without an end. */
#include "base/visible.h"
#include "report/html.h"
#include "scene/scene_settings.h"
#include "scene/setting_read.h"
#include "support.h"

#include <criterion/criterion.h>
#include <math.h>
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

/* --- names that a terminal would obey --- */

/* Whether a text has control characters besides newlines, or bytes that are not UTF-8. */
static int has_controls(const char *text) {
    for (; *text; text += utf8_length(text))
        if (utf8_length(text) == 0 || (is_control(text) && *text != '\n'))
            return 1;
    return 0;
}

/* Each kind of name through each kind of message. */
Test(foreign, names_do_not_command_the_terminal, .init = open_folder, .fini = close_folder) {
    static const char scene[] =
        "name = \"\xc2\x9b\\x1b[31mred\"; duration = 0.01; frame_rate = 100.0;\n"
        "gravity = [0.0, -9.81, 0.0]; material = { }; contacts = { interpenetration = false;\n"
        "collision = false; }; wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0];\n"
        "length = 0.1; nodes = 4; } );\n"
        "body = ( { name = \"\xc2\x9d\\x1b]0;\"; center = [9.0, 0.0, 0.0];\n"
        "radii = [0.001, 0.001, 0.001]; friction = 0.0; elasticity = 0.0; offset = 0.0; } );\n";
    char path[PATH_SIZE], out[PATH_SIZE];
    static struct finished f;
    file_write(folder, "\x1b\xc2\x9b\xff.cfg", scene, path);
    path_format(out, "%s/\x1b\xc2\x9b\xff", folder);
    PROGRAM(&f, NULL, "run", path, "--out", out);
    cr_expect(f.code == 0 && strstr(f.out, "\\u009b\\u001b[31mred: finished"), "%s%s", f.out,
              f.err);
    cr_expect(strstr(f.out, "/\\u001b\\u009b\\xff/states.tsv"), "%s", f.out);
    cr_expect(strstr(f.err, "body '\\u009d\\u001b]0;' can pass"), "%s", f.err);
    cr_expect(!has_controls(f.out) && !has_controls(f.err), "'%s' '%s'", f.out, f.err);
    PROGRAM(&f, NULL, "run", path, "--out", out, "--set", "wisps.[0].scalp=\"\xc2\x9b\"");
    cr_expect(f.code == 1 && !has_controls(f.err), "%d: '%s'", f.code, f.err);
    PROGRAM(&f, NULL, "experiment", "\x1b\xc2\x9b");
    cr_expect(f.code == 1 && !has_controls(f.err), "%d: '%s'", f.code, f.err);
}

Test(foreign, names_do_not_command_a_page) {
    char *text = NULL;
    size_t size;
    FILE *stream = open_memstream(&text, &size);
    html_text(stream, "\xc2\x9b<\x1b\x7f\xff\xc3\xa9");
    fclose(stream);
    cr_expect_str_eq(text, "\\u009b&lt;\\u001b\\u007f\\xff\xc3\xa9");
    free(text);
}

/* The stepper's name in a run.json, which anybody can have written, becomes a label, and that
 * stands in a script of gnuplot's. */
Test(foreign, names_do_not_command_a_picture, .init = open_folder, .fini = close_folder) {
    const struct launch here = {.folder = folder};
    char made[PATH_SIZE], json[PATH_SIZE], figure[PATH_SIZE];
    static struct finished f;
    path_format(made, "%s/made", folder);
    path_format(json, "%s/run.json", folder);
    PROGRAM(&f, &here, "run", "swing-envelope", "--duration", "0.05", "--out", ".");
    cr_assert_eq(f.code, 0, "%s", f.err);
    char *text = file_read(json), *name = strstr(text, "\"stepper\": \"rk4\""), other[8192];
    cr_assert(name, "%s", text);
    snprintf(other, sizeof other, "%.*s\"stepper\": \"a'\\n!touch made #\\n\\u009b\"%s",
             (int)(name - text), text, name + strlen("\"stepper\": \"rk4\""));
    file_write(folder, "run.json", other, NULL);
    free(text);
    PROGRAM(&f, &here, "render", "./states.tsv", "./states.tsv", "--frames", "1,2", "--strip",
            "--format", "svg", "--out", ".");
    cr_expect_eq(f.code, 0, "%d: %s", f.code, f.err);
    cr_assert(access(made, F_OK) != 0, "the command has run");
    path_format(figure, "%s/%s", folder, strtok(f.out, "\n"));
    char *svg = file_read(figure);
    cr_assert(svg, "no %s", figure);
    cr_expect(strstr(svg, "\\u009b") && !strstr(svg, "\xc2\x9b"), "%s", figure);
    free(svg);
}

/* --- what is not there --- */

/* What is missing in a group is missed at the group, what is missing in a scene at its end. */
Test(foreign, what_is_missing_is_missed_at_a_line, .init = open_folder, .fini = close_folder) {
    static const struct {
        const char *text, *says;
    } cases[] = {
        {"gravity = [0.0, 0.0, 0.0];\nmaterial = { };\nwisps = ( );\n", ":3: duration: missing"},
        {"duration = 1.0;\nmaterial = { };\n\n", ":3: gravity: missing"},
        {"duration = 1.0;\ngravity = [0.0, 0.0, 0.0];", ":2: material: missing"},
        {"duration = 1.0;\ngravity = [0.0, 0.0, 0.0];\nmaterial = { };\nwind = {\n"
         "kind = \"gust\"; velocity = [1.0, 0.0, 0.0]; };\n",
         ":4: hold: missing"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char path[PATH_SIZE];
        struct finished f;
        file_write(folder, "scene.cfg", cases[i].text, path);
        PROGRAM(&f, NULL, "run", path, "--out", folder);
        cr_expect(f.code == 1 && count_lines(f.err) == 1 && strstr(f.err, cases[i].says),
                  "%d, not '%s': '%s'", f.code, cases[i].says, f.err);
    }
}

/* A number that is refused is one that all further reading can stand: none is converted that an
 * integer cannot hold. */
Test(foreign, what_is_refused_reads_as_a_number_in_range, .init = open_folder,
     .fini = close_folder) {
    static const char *const values[] = {"\"x\"", "-1", "1e999", "0.5", "true", "{ }"};
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        char path[PATH_SIZE], text[64], reason[REASON_SIZE];
        struct config_reader reader;
        double grid[2] = {-1, -1};
        snprintf(text, sizeof text, "limit = %s; grid = ( %s, 1 );", values[i], values[i]);
        file_write(folder, "scene.cfg", text, path);
        config_open(&reader, path, NULL, 0, reason);
        reader.problem = OF_WISPS;
        cr_assert_not(reader.failed, "%s", reason);
        const double limit = setting_number(&reader, config_top(&reader), "subdivision", "limit");
        cr_expect(reader.failed && limit == 400, "%s reads as %g", values[i], limit);
        setting_numbers(&reader, config_top(&reader), "wisps", "grid", grid);
        cr_expect(grid[0] >= 1 && grid[0] <= 1000, "%s reads as %g", values[i], grid[0]);
        config_close(&reader);
    }
}

Test(foreign, turns_of_more_than_half_a_turn_warn, .init = open_folder, .fini = close_folder) {
    for (int more = 0; more <= 1; more++) {
        char text[512], path[PATH_SIZE];
        static struct finished f;
        snprintf(text, sizeof text,
                 "duration = 0.01; frame_rate = 100.0; gravity = [0.0, 0.0, 0.0]; material = { };\n"
                 "head = { times = [0.0, 1.0]; positions = ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0]);\n"
                 "rotations = ([0.0, 3.0, 0.0], [0.0, %s, 0.0]); };\n"
                 "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0];\n"
                 "length = 0.1; nodes = 4; } );\n",
                 more ? "-0.15" : "-0.14");
        file_write(folder, "scene.cfg", text, path);
        PROGRAM(&f, NULL, "run", path, "--out", folder);
        cr_expect_eq(f.code, 0, "%s", f.err);
        cr_expect_eq(strstr(f.err, "rad apart, more than half a turn") != NULL, more, "'%s'",
                     f.err);
    }
}
