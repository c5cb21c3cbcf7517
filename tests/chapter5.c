/* The experiments of the thesis's chapter 5 as a user starts them: their tables, and sentences that
 * must turn with what they are about. */
#include "support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Small scenes with what an experiment looks at. */
#define COMMON                                                                            \
    "name = \"small\"; frame_rate = 30.0; gravity = [0.0, -9.81, 0.0]; material = { };\n" \
    "envelope = { };\n"
#define HANGING                                                                                 \
    "wisps = ( { root = [0.1, 0.0, 0.0]; direction = [0.0, -1.0, 0.0]; length = 0.30; nodes = " \
    "6;\n"                                                                                      \
    "            grid = [2, 2]; spacing = 0.03;\n"                                              \
    "            across = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]); } );\n"
static const char radii[] = COMMON HANGING
    "duration = 0.5; contacts = { };\n"
    "wind = { kind = \"irregular\"; velocity = [1.0, 0.0, 0.3]; amplitudes = [0.5];\n"
    "         frequencies = [2.0]; };\n";
static const char gust[] = COMMON HANGING
    "duration = 2.5;\n"
    "wind = { kind = \"gust\"; velocity = [5.0, 0.0, 0.0]; hold = 0.4; decay = 0.05; };\n";
static const char breath[] = COMMON HANGING
    "duration = 2.5;\n"
    "wind = { kind = \"gust\"; velocity = [0.1, 0.0, 0.0]; hold = 0.4; decay = 0.05; };\n";
static const char long_gust[] = COMMON HANGING
    "duration = 2.5;\n"
    "wind = { kind = \"gust\"; velocity = [5.0, 0.0, 0.0]; hold = 2.4; decay = 0.05; };\n";
static const char steady[] =
    COMMON HANGING "duration = 2.5; wind = { kind = \"steady\"; velocity = [5.0, 0.0, 0.0]; };\n";
static const char shaken[] = COMMON HANGING
    "duration = 3.0;\n"
    "head = { times = [0.0, 0.2, 0.6, 0.8]; positions = ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0],\n"
    "         [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]); rotations = ([0.0, 0.0, 0.0], [0.0, 0.7, 0.0],\n"
    "         [0.0, -0.7, 0.0], [0.0, 0.0, 0.0]); };\n";
/* Wisps that start in each other, and stay so up to the frame at which the thesis's have parted. */
static const char hugging[] = COMMON HANGING "duration = 0.7; contacts = { };\n";
static const char still[] = COMMON HANGING "duration = 0.5;\n";
/* A body that never comes near the hair. */
static const char far[] =
    COMMON HANGING "duration = 0.5; contacts = { };\n"
                   "body = ( { name = \"far\"; center = [2.0, 0.0, 0.0]; radii = [0.1, 0.1, 0.1];\n"
                   "           friction = 50.0; elasticity = 0.1; offset = 1.0e-4; } );\n";
/* The wisps of figure 5.3 as they first were, with every response switched off: they part and come
 * back by gravity and air alone. */
static const char untouched[] =
    "name = \"no-contact\"; duration = 3.0; frame_rate = 30.0; gravity = [0.0, -9.81, 0.0];\n"
    "material = { drag_rate = 2.0; bending = \"hinge\"; bending_stiffness = 3.0e-4; };\n"
    "envelope = { };\n"
    "wisps = ( { root = [-0.045, 0.0, -0.003]; direction = [0.25, -1.0, 0.0]; length = 0.60;\n"
    "            nodes = 21; },\n"
    "          { root = [0.045, 0.0, 0.003]; direction = [-0.25, -1.0, 0.0]; length = 0.60;\n"
    "            nodes = 21; } );\n"
    "contacts = { viscosity = 0.5; interpenetration = false; collision = false; };\n";

/* Two wisps that meet so fast that contacts cannot keep them apart. */
static const char fast[] =
    "name = \"fast\"; frame_rate = 30.0; gravity = [0.0, -9.81, 0.0];\n"
    "material = { drag_rate = 2.0; }; envelope = { };\n"
    "duration = 1.5; contacts = { threshold = 0.44; };\n"
    "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.2, 0.0]; length = 0.30;\n"
    "            nodes = 13; },\n"
    "          { root = [-0.01, 0.0, -0.08]; direction = [0.0, 2.0, 1.0]; length = 0.30;\n"
    "            nodes = 13; } );\n";
/* Two wisps that start in each other, and hang apart. */
static const char crossed[] =
    COMMON "duration = 2.0; contacts = { viscosity = 0.5; };\n"
           "wisps = ( { root = [-0.05, 0.0, 0.0]; direction = [1.0, -2.0, 0.0]; length = 0.30;\n"
           "            nodes = 11; },\n"
           "          { root = [0.05, 0.0, 0.004]; direction = [-1.0, -2.0, 0.0]; length = 0.30;\n"
           "            nodes = 11; } );\n";

/* --- an experiment and its tables --- */

struct answer {
    char folder[PATH_SIZE];
    char *statement, *table, *steppers; /* the files */
};

static char *table_of(const struct answer *answer, const char *experiment, const char *name) {
    char path[PATH_SIZE];
    path_format(path, "%s/%s/%s.tsv", answer->folder, experiment, name);
    return file_read(path);
}

/* Runs an experiment of a stepper, or of all with --quick where it is NULL, on a scene of the text
 * or the experiment's own. */
static void ask(struct answer *answer, const char *experiment, const char *stepper,
                const char *scene) {
    char path[PATH_SIZE] = "";
    struct finished f;
    const char *words[10] = {"experiment", experiment, "--out", answer->folder};
    int count = 4;
    folder_make(answer->folder);
    words[count++] = stepper ? "--stepper" : "--quick";
    if (stepper)
        words[count++] = stepper;
    if (scene) {
        file_write(answer->folder, "small.cfg", scene, path);
        words[count++] = "--scene";
        words[count++] = path;
    }
    const struct process process = program_start(NULL, words);
    program_wait(&process, &f);
    cr_assert_eq(f.code, 0, "%s: exit code %d: %s", experiment, f.code, f.err);
    answer->statement = table_of(answer, experiment, "statements");
    answer->table = table_of(answer, experiment, "table");
    answer->steppers = table_of(answer, experiment, "steppers");
    cr_assert(answer->statement && answer->table && answer->steppers, "%s: a table is missing",
              experiment);
    path_format(path, "%s/%s", answer->folder, experiment);
    statements_must_be_whole(path);
}

static void forget(struct answer *answer) {
    free(answer->statement);
    free(answer->table);
    free(answer->steppers);
    folder_remove(answer->folder);
}

/* The row of a table that begins with a name, or NULL. */
static const char *row_named(const char *table, const char *name) {
    char start[128];
    snprintf(start, sizeof start, "\n%s\t", name);
    const char *at = strstr(table, start);
    return at ? at + 1 : NULL;
}

/* A column of a row as text. */
static const char *field(const char *row, int column, char *text) {
    for (int i = 0; i < column; i++)
        row = strchr(row, '\t') + 1;
    const size_t length = strcspn(row, "\t\n");
    cr_assert(length < 400);
    memcpy(text, row, length);
    text[length] = '\0';
    return text;
}

static int column_named(const char *table, const char *name) {
    const char *line = table;
    char text[400];
    while (*line == '#')
        line = strchr(line, '\n') + 1;
    for (int i = 0;; i++)
        if (strcmp(field(line, i, text), name) == 0)
            return i;
}

static double number(const char *table, const char *name, const char *column) {
    char text[400];
    const char *row = row_named(table, name);
    cr_assert(row, "no row %s in %s", name, table);
    return strtod(field(row, column_named(table, column), text), NULL);
}

static void says(const struct answer *answer, const char *name, const char *verdict) {
    char text[400];
    const char *row = row_named(answer->statement, name);
    cr_assert(row, "no statement '%s' in %s", name, answer->statement);
    cr_assert_str_eq(field(row, column_named(answer->statement, "verdict"), text), verdict,
                     "%s: %s, not %s: %s", name, text, verdict, row);
}

#define HOLD(answer, ...) all_hold(answer, (const char *const[]){__VA_ARGS__, NULL})
static void all_hold(const struct answer *answer, const char *const *names) {
    for (; *names; names++)
        says(answer, *names, "holds");
}

static void must_say(const char *experiment, const char *scene, const char *name,
                     const char *verdict) {
    struct answer answer;
    ask(&answer, experiment, "euler", scene);
    says(&answer, name, verdict);
    forget(&answer);
}

static void must_not_hold(const char *experiment, const char *scene, const char *name) {
    must_say(experiment, scene, name, "does not hold");
}

#define QUIET .init = gnuplot_stub_quiet, .fini = gnuplot_stub_remove

/* --- what they say --- */

Test(chapter5, slow_interactions_tell_who_passes_through, QUIET) {
    struct answer answer;
    ask(&answer, "interactions", "euler", NULL);
    HOLD(&answer, "crossings, none", "crossings, interpenetration", "crossings, collision",
         "crossings, all");
    cr_assert_geq(number(answer.statement, "crossings, none", "value"), 1);
    static const char *const moved[] = {"influence, interpenetration", "influence, collision",
                                        "influence, all"};
    for (int i = 0; i < 3; i++)
        cr_assert_gt(number(answer.statement, moved[i], "value"), 20);
    forget(&answer);
    must_not_hold("interactions", radii, "crossings, none");
    must_not_hold("interactions", fast, "crossings, collision");
}

Test(chapter5, slow_viscosity_tells_when_wisps_part, QUIET) {
    struct answer answer;
    ask(&answer, "viscosity", "euler", NULL);
    HOLD(&answer, "stuck", "held together");
    says(&answer, "parted", "tells nothing"); /* 0.5 /s changes half a millimetre */
    cr_assert_float_eq(number(answer.statement, "parted", "value"), 13, 1.1);
    cr_assert_float_eq(number(answer.statement, "stay", "value"), 26, 2.1);
    forget(&answer);
    must_not_hold("viscosity", hugging, "parted");
    must_say("viscosity", radii, "parted", "not reached"); /* it ends before that frame */
    must_not_hold("viscosity", crossed, "stay");
}

/* How many statements of the figure `series` are whose, and have that verdict. */
static int count_series(const struct answer *answer, const char *by, const char *verdict) {
    const char *const table = answer->statement, *line = table;
    char figure[400], whose[400], came[400];
    int count = 0;
    while (*line == '#')
        line = strchr(line, '\n') + 1;
    for (line = strchr(line, '\n') + 1; *line; line = strchr(line, '\n') + 1) {
        field(line, column_named(table, "figure"), figure);
        field(line, column_named(table, "by"), whose);
        field(line, column_named(table, "verdict"), came);
        count +=
            strcmp(figure, "series") == 0 && strcmp(whose, by) == 0 && strcmp(came, verdict) == 0;
    }
    return count;
}

/* Where nothing is switched on, the control is what it is to be told from. */
Test(chapter5, slow_a_claim_that_the_control_passes_tells_nothing, QUIET) {
    struct answer answer;
    char text[400];
    ask(&answer, "viscosity", "euler", untouched);
    says(&answer, "parted", "tells nothing");
    says(&answer, "stay", "tells nothing");
    says(&answer, "stuck", "not reached");
    says(&answer, "held together", "not reached");
    field(row_named(answer.statement, "parted"), column_named(answer.statement, "statement"), text);
    cr_assert(strstr(text, "So it is without contact, too."), "%s", text);
    cr_assert_eq(count_series(&answer, "thesis", "holds"), 0, "%s", answer.statement);
    forget(&answer);
}

/* Statements are of all frames also with --quick. */
Test(chapter5, slow_quick_ones_watch_the_whole_scene, QUIET) {
    static const char *const names[] = {"interactions", "viscosity", "sphere", "subdivision"};
    for (int i = 0; i < 4; i++) {
        struct answer answer;
        ask(&answer, names[i], NULL, NULL);
        cr_assert_eq(count_series(&answer, "thesis", "not reached") +
                         count_series(&answer, "ours", "not reached"),
                     0, "%s", answer.statement);
        cr_assert_gt(count_series(&answer, "thesis", "holds"), 0, "%s", answer.statement);
        forget(&answer);
    }
}

Test(chapter5, slow_the_sphere_keeps_hair_out, QUIET) {
    struct answer answer;
    ask(&answer, "sphere", "euler", NULL);
    HOLD(&answer, "touched", "nodes left inside", "deepest point", "strain");
    cr_assert_gt(number(answer.statement, "deepest segment", "value"), 0.1);
    cr_assert_float_eq(number(answer.table, "sphere", "thesis_per_frame"), 21.6, 0);
    forget(&answer);
    must_say("sphere", far, "touched", "not reached");
    must_say("sphere", far, "strain", "not reached"); /* of a push that never came */
}

/* Two wisps whose soft envelopes are flattened by their fall: twins stay where they are. */
static const char close_twins[] =
    "name = \"twins\"; duration = 1.0; frame_rate = 30.0; gravity = [0.0, -9.81, 0.0];\n"
    "material = { }; envelope = { frequency = 2.0; };\n"
    "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.345, -0.074]; length = 0.30;\n"
    "            nodes = 11; },\n"
    "          { root = [0.085, 0.065, 0.035]; direction = [0.007, 1.057, -1.0];\n"
    "            length = 0.30; nodes = 11; } );\n"
    "contacts = { }; subdivision = { ratio = 0.75; separation = 0.01; limit = 4; };\n";

Test(chapter5, slow_subdivision_adds_what_is_seen, QUIET) {
    struct answer answer;
    ask(&answer, "subdivision", "euler", NULL);
    HOLD(&answer, "wisps, without", "wisps", "the same until", "complexity", "evaluations");
    cr_assert_gt(number(answer.statement, "complexity", "value"), 20);
    forget(&answer);
    must_not_hold("subdivision", close_twins, "complexity");
}

Test(chapter5, slow_wind_lays_over_and_lets_fall, QUIET) {
    struct answer answer;
    ask(&answer, "wind", "euler", gust);
    HOLD(&answer, "laid over", "in the gust", "fallen back");
    forget(&answer);
    must_not_hold("wind", breath, "laid over");
    must_not_hold("wind", steady, "fallen back");
    must_say("wind", long_gust, "fallen back", "not reached"); /* it ends before the gust does */
}

Test(chapter5, slow_hair_lags_a_head_that_shakes, QUIET) {
    struct answer answer;
    ask(&answer, "shake", "euler", shaken);
    HOLD(&answer, "lag", "returned");
    const double lag = number(answer.statement, "lag", "value");
    cr_assert(lag > 0.02 && lag < 0.5, "a lag of %g s", lag);
    forget(&answer);
    must_say("shake", still, "lag", "not reached"); /* its head does not turn */
}

Test(chapter5, slow_radii_are_compared_from_one_to_the_next, QUIET) {
    struct answer answer;
    ask(&answer, "radii", "euler", radii);
    double angles[3];
    for (int i = 0; i < 3; i++) {
        char name[32];
        snprintf(name, sizeof name, "largest, radius %d cm", i + 1);
        angles[i] = number(answer.statement, name, "value");
        cr_assert(angles[i] > 1 && angles[i] < 90, "%s: %g degrees", name, angles[i]);
    }
    const double less = fmin(angles[0], angles[1]) - angles[2];
    says(&answer, "largest falls",
         angles[0] > angles[1] && angles[1] > angles[2] ? "holds" : "does not hold");
    cr_assert_float_eq(number(answer.statement, "largest", "value"), less, 1e-9);
    says(&answer, "largest", less > 3 ? "holds" : "does not hold");
    says(&answer, "contacts", "holds");
    cr_assert_gt(number(answer.table, "radius 3 cm", "wisp_contacts"),
                 number(answer.table, "radius 1 cm", "wisp_contacts"));
    forget(&answer);
}

/* --- the tables --- */

Test(chapter5, slow_costs_are_normalised_to_the_first_row, QUIET) {
    static const char *const names[] = {"none", "interpenetration", "collision", "all"};
    static const double thesis[] = {0.76, 0.86, 0.84, 0.91};
    struct answer answer;
    ask(&answer, "interactions", "euler", NULL);
    const char *table = answer.table;
    for (int i = 0; i < 4; i++) {
        const double cpu = number(table, names[i], "cpu_per_frame"),
                     least = number(table, names[i], "least"),
                     greatest = number(table, names[i], "greatest"),
                     ratio = number(table, names[i], "normalised"),
                     low = number(table, names[i], "normalised_least"),
                     high = number(table, names[i], "normalised_greatest"),
                     theirs = number(table, names[i], "thesis_normalised");
        char text[400];
        const char *words =
            field(row_named(table, names[i]), column_named(table, "comparison"), text);
        cr_assert(0 < least && least <= cpu && cpu <= greatest, "%s: %g %g %g", names[i], least,
                  cpu, greatest);
        cr_assert_float_eq(ratio, cpu / number(table, "none", "cpu_per_frame"), 1e-12);
        cr_assert(low <= ratio && ratio <= high, "%s: %g %g %g", names[i], low, ratio, high);
        if (i > 0) {
            cr_assert_float_eq(low, least / number(table, "none", "greatest"), 1e-12);
            cr_assert_float_eq(high, greatest / number(table, "none", "least"), 1e-12);
        }
        cr_assert_float_eq(theirs, thesis[i] / thesis[0], 1e-12);
        cr_assert_float_eq(number(table, names[i], "real_time"), 1 / (30 * cpu), 1e-6 / cpu);
        cr_assert_float_eq(number(table, names[i], "wisps_at_end"), 2, 0);
        const double theirs_low = (thesis[i] - 0.005) / (thesis[0] + 0.005),
                     theirs_high = (thesis[i] + 0.005) / (thesis[0] - 0.005);
        const int alike = i == 0 || (low <= theirs_high && theirs_low <= high);
        cr_assert_eq(strstr(words, "within the spread") != NULL, alike, "%s: %s", names[i], words);
        cr_assert_eq(strstr(words, ": more") != NULL, i > 0 && low > theirs_high, "%s: %s",
                     names[i], words);
        snprintf(text, sizeof text, "cost, %s", names[i]);
        says(&answer, text, "holds"); /* it is measured: nothing is judged by a time */
    }
    forget(&answer);
}

/* The thesis's times of a wisp over those of figure 5.2 without interaction, worked out by hand
 * from its tables; and where the scenes are off the common model. */
Test(chapter5, slow_figures_are_compared_by_the_wisp, QUIET) {
    static const struct {
        const char *name;
        double thesis;
        const char *deviates;
    } rows[] = {{"5.2 none", 1, "no wisp contact"},      {"5.1 radius 1 cm", 1.146, "length"},
                {"5.1 radius 3 cm", 1.503, "viscosity"}, {"5.3 viscosity 0.5", 1.118, "bending"},
                {"5.4 sphere", 1.579, "nothing"},        {"5.5 without", 1.158, "drag"},
                {"5.5 with", 2.184, "one-sided"},        {"5.6 wind", 6.184, "nothing"}};
    struct answer answer;
    struct finished f;
    char text[400];
    folder_make(answer.folder);
    PROGRAM(&f, NULL, "experiment", "chapter5", "--quick", "--out", answer.folder);
    cr_assert_eq(f.code, 0, "%s", f.err);
    char *figures = table_of(&answer, "chapter5", "figures"),
         *models = table_of(&answer, "chapter5", "models");
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const double cpu = number(figures, rows[i].name, "cpu"),
                     none = number(figures, "5.2 none", "cpu");
        cr_assert_float_eq(number(figures, rows[i].name, "thesis"), rows[i].thesis, 6e-4, "%s: %g",
                           rows[i].name, number(figures, rows[i].name, "thesis"));
        cr_assert_float_eq(number(figures, rows[i].name, "ours"), cpu / none, 1e-9);
        field(row_named(models, rows[i].name), column_named(models, "deviates"), text);
        cr_assert(strstr(text, rows[i].deviates), "%s deviates: %s", rows[i].name, text);
    }
    cr_assert_eq(number(figures, "5.2 none", "contacts"), 0);
    free(figures);
    free(models);
    PROGRAM(&f, NULL, "experiment", "chapter5", "--scene", "swing", "--out", answer.folder);
    cr_assert(f.code == 1 && strstr(f.err, "leave out --scene"), "%d: %s", f.code, f.err);
    folder_remove(answer.folder);
}

/* Every stepper has a row; two are compared by their distance. */
Test(chapter5, slow_every_stepper_has_a_row, QUIET) {
    struct answer answer;
    ask(&answer, "viscosity", NULL, NULL);
    for (int i = 0; stepper_methods[i]; i++) {
        const char *name = stepper_methods[i]->name;
        const double distance = number(answer.steppers, name, "distance"),
                     strain = number(answer.steppers, name, "strain");
        cr_assert(strain > 0 && strain < 0.1, "%s: strain %g", name, strain);
        cr_assert(stepper_methods[i]->checked_by ? isnan(distance)
                                                 : distance > 0 && distance < 0.02,
                  "%s is %g m away", name, distance);
    }
    cr_assert(number(answer.steppers, "rk4", "distance") <
              number(answer.steppers, "euler", "distance"));
    forget(&answer);
}

/* Also one that fails: the scene is stiff beyond what 9000 Hz can do. */
Test(chapter5, slow_a_stepper_that_fails_has_a_row, QUIET) {
    static const char stiff[] =
        "name = \"stiff\"; duration = 0.2; frame_rate = 30.0; gravity = [0.0, -9.81, 0.0];\n"
        "material = { stretch_stiffness = 16800.0; }; envelope = { };\n"
        "contacts = { };\n" HANGING;
    struct answer answer;
    ask(&answer, "viscosity", "euler", stiff);
    cr_assert_not(strstr(row_named(answer.steppers, "euler"), "finished"), "%s", answer.steppers);
    cr_assert(strstr(answer.statement, "did not reach its end"), "%s", answer.statement);
    forget(&answer);
}

/* --- quick, with figures; and again without runs --- */

static int new_runs(const struct finished *f, const char *experiment) {
    int runs, new;
    const char *line = strstr(f->out, ": ");
    cr_assert(line && sscanf(line, ": %d runs, %d of them new", &runs, &new) == 2, "%s: '%s'",
              experiment, f->out);
    return new;
}

enum { TABLES = 6 }; /* table, steppers, series, statements, strip, strip-cells */

static void try_quickly(const char *experiment, const char *scene) {
    char folder[PATH_SIZE], path[PATH_SIZE] = "";
    folder_make(folder);
    if (scene)
        file_write(folder, "small.cfg", scene, path);
    for (int again = 0; again < 2; again++) {
        struct finished f;
        const char *const arguments[] = {"experiment", experiment, "--quick",
                                         "--out",      folder,     scene ? "--scene" : NULL,
                                         path,         NULL};
        const struct process process = program_start(NULL, arguments);
        program_wait(&process, &f);
        cr_assert_eq(f.code, 0, "%s: exit code %d: %s", experiment, f.code, f.err);
        cr_assert_eq(new_runs(&f, experiment) > 0, !again, "%s: '%s'", experiment, f.out);
    }
    /* frames, cost, series, and the diagnoses of each variant */
    char runs[PATH_SIZE];
    path_format(runs, "%s/%s", folder, experiment);
    const int figures = 3 + count_files(runs, ".tsv") - TABLES;
    statements_must_be_whole(runs);
    cr_assert_gt(figures, 3, "%s: no run is diagnosed", experiment);
    cr_assert_eq(count_files(runs, "hair.png"), 1, "%s: pictures of hair", experiment);
    cr_assert_eq(count_files(runs, ".png"), figures + 1, "%s: not %d figures", experiment, figures);
    cr_assert_eq(count_files(runs, ".svg"), figures, "%s: not %d figures", experiment, figures);
    folder_remove(folder);
}

Test(chapter5, slow_quick_ones_draw_and_resume) {
    try_quickly("interactions", NULL);
    try_quickly("viscosity", NULL);
    try_quickly("radii", radii);
}

Test(chapter5, slow_quick_ones_draw_and_resume_with_bodies_wind_and_head) {
    try_quickly("sphere", NULL);
    try_quickly("wind", gust);
    try_quickly("shake", shaken);
}

Test(chapter5, two_scenes_are_refused) {
    struct finished f;
    PROGRAM(&f, NULL, "experiment", "wind", "--scene", "swing", "--scene", "swing");
    cr_assert_eq(f.code, 1);
    cr_assert(count_lines(f.err) == 1 && strstr(f.err, "one --scene"), "'%s'", f.err);
}

/* Variants of what a scene has not would be its own, all alike. */
Test(chapter5, a_scene_without_what_is_varied_is_refused) {
    static const char *const needs[][2] = {
        {"radii", "envelope"},          {"interactions", "contacts"}, {"viscosity", "contacts"},
        {"subdivision", "subdivision"}, {"sphere", "body"},           {"wind", "wind"}};
    char folder[PATH_SIZE];
    folder_make(folder);
    for (size_t i = 0; i < sizeof needs / sizeof *needs; i++) {
        struct finished f;
        PROGRAM(&f, NULL, "experiment", needs[i][0], "--scene", "swing", "--out", folder);
        cr_assert_eq(f.code, 1, "%s: exit code %d", needs[i][0], f.code);
        cr_assert(count_lines(f.err) == 1 && strstr(f.err, "needs a scene with") &&
                      strstr(f.err, needs[i][1]),
                  "%s: '%s'", needs[i][0], f.err);
    }
    cr_assert_eq(count_files(folder, ""), 0, "something was written");
    folder_remove(folder);
}

/* Hair without an envelope, in a picture in which it has no height. */
Test(chapter5, hair_along_a_line_is_drawn) {
    static const char scene[] =
        "duration = 0.02;\nframe_rate = 30.0;\ngravity = [0, 0, 0];\nmaterial = { };\n"
        "wind = { kind = \"steady\"; velocity = [0, 0, 0]; };\n"
        "wisps = ({ root = [0, 0, 0]; direction = [1, 0, 0]; length = 0.2; nodes = 5; });\n";
    struct finished f;
    char folder[PATH_SIZE], path[PATH_SIZE];
    folder_make(folder);
    file_write(folder, "line.cfg", scene, path);
    PROGRAM(&f, NULL, "experiment", "wind", "--quick", "--stepper", "euler", "--scene", path,
            "--out", folder);
    cr_assert_eq(f.code, 0, "exit code %d: %s", f.code, f.err);
    cr_assert_null(strstr(f.out, "nan %"), "%s", f.out);
    cr_assert_null(strstr(f.out, "diverged"), "hair without weight is at rest: %s", f.out);
    path_format(path, "%s/wind", folder);
    cr_assert_eq(count_files(path, "frames.svg"), 1, "no picture of it");
    folder_remove(folder);
}
