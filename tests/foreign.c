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

static char *folder;

static void open_folder(void) {
    folder = folder_make();
}

/* A scene with this in it. */
static void check_scene(const char *more, const char *says, const char *never) {
    static const char scene[] =
        "duration = 0.1; frame_rate = 30.0; gravity = [0.0, -9.81, 0.0]; material = { };\n"
        "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0]; length = 0.1;\n"
        "            nodes = 4; } );\n%s\n";
    struct finished *f =
        FAILS(1, says, "run", file_write(folder, "scene.cfg", printed(scene, more)), "--out",
              folder, "--no-progress");
    cr_expect(!never || !strstr(f->err, never), "%s: '%s'", more, f->err);
}

Test(foreign, a_start_is_a_file_with_an_end, .init = open_folder, .timeout = 60) {
    check_scene("start = \"/dev/zero\";", "is no regular file", NULL);
}

Test(foreign, what_is_included_is_a_file_with_an_end, .init = open_folder, .timeout = 60) {
    cr_assert_eq(symlink("/dev/zero", printed("%s/endless", folder)), 0);
    check_scene("@include \"endless\"", "is no regular file", NULL);
}

Test(foreign, nothing_is_shown_of_a_file_that_is_not_ours, .init = open_folder) {
    file_write(folder, "other", "# a comment\nsecret:word:1000\nmore:of:it\n");
    check_scene("start = \"other\";", "is no table of states", "secret");
}

Test(foreign, texts_are_utf8, .init = open_folder) {
    check_scene("start = \"a\\xff.tsv\";", "scene.cfg:4: start: must be a text in UTF-8", NULL);
}

/* A folder whose name is a command to gnuplot is a folder. */
Test(foreign, names_of_folders_are_no_commands, .init = open_folder) {
    static const char *const names[] = {"| touch made;", "< touch made;", "'; touch made; '"};
    const char *const made = printed("%s/made", folder);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const struct launch here = {.folder = folder};
        program_must(
            &here, 0, NULL,
            WORDS("experiment", "circle", "--quick", "--stepper", "euler", "--out", names[i]));
        const char *const figure = printed("%s/%s/circle/orbits-30s.svg", folder, names[i]);
        cr_expect_eq(access(figure, F_OK), 0, "no %s", figure);
        cr_assert(access(made, F_OK) != 0, "%s: the command has run", names[i]);
    }
}

/* One that says that all is well, and has drawn nothing. */
Test(foreign, a_gnuplot_that_draws_nothing_has_failed, .init = open_folder) {
    const char *const stub = file_write(folder, "gnuplot", "#!/bin/sh\nexit 0\n");
    chmod(stub, 0755);
    setenv("PATH", printed("%s:%s", folder, getenv("PATH")), 1);
    FAILS(2, "has drawn no svg", "experiment", "circle", "--quick", "--stepper", "euler", "--out",
          folder);
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
Test(foreign, names_do_not_command_the_terminal, .init = open_folder) {
    static const char scene[] =
        "name = \"\xc2\x9b\\x1b[31mred\"; duration = 0.01; frame_rate = 100.0;\n"
        "gravity = [0.0, -9.81, 0.0]; material = { }; contacts = { interpenetration = false;\n"
        "collision = false; }; wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0];\n"
        "length = 0.1; nodes = 4; } );\n"
        "body = ( { name = \"\xc2\x9d\\x1b]0;\"; center = [9.0, 0.0, 0.0];\n"
        "radii = [0.001, 0.001, 0.001]; friction = 0.0; elasticity = 0.0; offset = 0.0; } );\n";
    const char *const path = file_write(folder, "\x1b\xc2\x9b\xff.cfg", scene);
    const char *const out = printed("%s/\x1b\xc2\x9b\xff", folder);
    struct finished *f = WORKS("run", path, "--out", out);
    cr_assert(strstr(f->out, "\\u009b\\u001b[31mred: finished"), "%s%s", f->out, f->err);
    cr_expect(strstr(f->out, "/\\u001b\\u009b\\xff/states.tsv"), "%s", f->out);
    cr_expect(strstr(f->err, "body '\\u009d\\u001b]0;' can pass"), "%s", f->err);
    cr_expect(!has_controls(f->out) && !has_controls(f->err), "'%s' '%s'", f->out, f->err);
    f = FAILS(1, "", "run", path, "--out", out, "--set", "wisps.[0].scalp=\"\xc2\x9b\"");
    cr_assert(!has_controls(f->err), "%s", f->err);
    f = FAILS(1, "", "experiment", "\x1b\xc2\x9b");
    cr_assert(!has_controls(f->err), "%s", f->err);
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
Test(foreign, names_do_not_command_a_picture, .init = open_folder) {
    const struct launch here = {.folder = folder};
    const char *const made = printed("%s/made", folder);
    const char *const json = printed("%s/run.json", folder);
    struct finished *f = program_must(
        &here, 0, NULL, WORDS("run", "swing-envelope", "--duration", "0.05", "--out", "."));
    char *text = file_read(json), *name = strstr(text, "\"stepper\": \"rk4\""), other[8192];
    cr_assert(name, "%s", text);
    snprintf(other, sizeof other, "%.*s\"stepper\": \"a'\\n!touch made #\\n\\u009b\"%s",
             (int)(name - text), text, name + strlen("\"stepper\": \"rk4\""));
    file_write(folder, "run.json", other);
    f = program_must(&here, 0, NULL,
                     WORDS("render", "./states.tsv", "./states.tsv", "--frames", "1,2", "--strip",
                           "--format", "svg", "--out", "."));
    cr_assert(access(made, F_OK) != 0, "the command has run");
    const char *const figure = printed("%s/%s", folder, strtok(f->out, "\n"));
    char *svg = file_read(figure);
    cr_assert(svg, "no %s", figure);
    cr_expect(strstr(svg, "\\u009b") && !strstr(svg, "\xc2\x9b"), "%s", figure);
}

/* --- what is not there --- */

/* What is missing in a group is missed at the group, what is missing in a scene at its end. */
Test(foreign, what_is_missing_is_missed_at_a_line, .init = open_folder) {
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
        const char *const path = file_write(folder, "scene.cfg", cases[i].text);
        FAILS(1, cases[i].says, "run", path, "--out", folder);
    }
}

/* A number that is refused is one that all further reading can stand: none is converted that an
 * integer cannot hold. */
Test(foreign, what_is_refused_reads_as_a_number_in_range, .init = open_folder) {
    static const char *const values[] = {"\"x\"", "-1", "1e999", "0.5", "true", "{ }"};
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        char reason[REASON_SIZE];
        struct config_reader reader;
        double grid[2] = {-1, -1};
        const char *const text = printed("limit = %s; grid = ( %s, 1 );", values[i], values[i]);
        config_open(&reader, file_write(folder, "scene.cfg", text), NULL, 0, reason);
        reader.problem = OF_WISPS;
        cr_assert_not(reader.failed, "%s", reason);
        const double limit = setting_number(&reader, config_top(&reader), "subdivision", "limit");
        cr_expect(reader.failed && limit == 400, "%s reads as %g", values[i], limit);
        setting_numbers(&reader, config_top(&reader), "wisps", "grid", grid);
        cr_expect(grid[0] >= 1 && grid[0] <= 1000, "%s reads as %g", values[i], grid[0]);
        config_close(&reader);
    }
}

Test(foreign, turns_of_more_than_half_a_turn_warn, .init = open_folder) {
    for (int more = 0; more <= 1; more++) {
        const char *const text = printed(
            "duration = 0.01; frame_rate = 100.0; gravity = [0.0, 0.0, 0.0]; material = { };\n"
            "head = { times = [0.0, 1.0]; positions = ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0]);\n"
            "rotations = ([0.0, 3.0, 0.0], [0.0, %s, 0.0]); };\n"
            "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0];\n"
            "length = 0.1; nodes = 4; } );\n",
            more ? "-0.15" : "-0.14");
        struct finished *f = WORKS("run", file_write(folder, "scene.cfg", text), "--out", folder);
        cr_expect_eq(strstr(f->err, "rad apart, more than half a turn") != NULL, more, "'%s'",
                     f->err);
    }
}
