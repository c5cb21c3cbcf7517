/* `wisplab eval`: the accelerations of a start or of a saved state are those of the model, and a
 * file that holds no state of the scene is refused in one line. */
#include "base/digits.h"
#include "base/table.h"
#include "model/problems.h"
#include "run/results.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* As in wisp_kernel.c; numbers in files have all their digits. */
static const double twin_tolerance = 1e-13;

static char *folder;

static void open_folder(void) {
    folder = folder_make();
}

static void read_text(const char *text, struct table *table) {
    char reason[REASON_SIZE];
    cr_assert_eq(table_read(table, file_write(folder, "table.tsv", text), reason), 0, "%s", reason);
}

static void expect_names(const struct table *table, const char *const *names, int count,
                         const char *what) {
    cr_assert_eq(table->column_count, count, "%s: %d columns, not %d", what, table->column_count,
                 count);
    for (int i = 0; i < count; i++)
        cr_assert_str_eq(table->name[i], names[i], "%s: column '%s', not '%s'", what,
                         table->name[i], names[i]);
}

/* --- wisps against the twin --- */

/* A frame's rows from `first` on into the twin's q and v: t wisp node x y z vx vy vz r0 rd0 ... or
 * e0x e0y e0z e0vx e0vy e0vz ... */
static void unpack(const struct wisp *wisp, enum wisp_treatment treatment,
                   const struct table *table, int first, double *q, double *v) {
    const int per = treatment == WISP_PENALTY ? 3 : 1;
    for (int i = 2; i < wisp->nodes; i++) {
        for (int k = 0; k < 3; k++) {
            *q++ = table_value(table, first + i, 3 + k);
            *v++ = table_value(table, first + i, 6 + k);
        }
        for (int u = 0; u < per * wisp->samples; u++) {
            const int column = 9 + u / per * 2 * per + u % per;
            *q++ = table_value(table, first + i, column);
            *v++ = table_value(table, first + i, column + per);
        }
    }
}

static void check_wisp(const struct scene *scene, int which, enum wisp_treatment treatment,
                       double t, const double *q, const double *v, const struct table *got,
                       int first, const char *what) {
    static struct wisp_twin twin;
    static double a[LAB_SIZE], scale[LAB_SIZE];
    const struct wisp *wisp = &scene->wisps[which];
    const int unknowns = wisp_node_unknowns(wisp, treatment);
    wisp_twin_init(&twin, wisp, &scene->around, treatment);
    cr_assert_eq(wisp_twin_acceleration(&twin, t, q, v, a), 0, "the twin fails");
    wisp_twin_scale(&twin, t, q, v, scale);
    for (int i = 0; i < wisp->nodes; i++) {
        cr_assert(table_value(got, first + i, 0) == which && table_value(got, first + i, 1) == i,
                  "%s: row %d is not wisp %d, node %d", what, first + i, which, i);
        for (int u = 0; u < unknowns; u++) {
            const int at = (i - 2) * unknowns + u;
            const double x = table_value(got, first + i, 2 + u);
            if (i < 2)
                cr_assert_eq(x, 0, "%s: the head moves", what);
            else
                cr_assert(lab_close(x, a[at], twin_tolerance * scale[at], NULL),
                          "%s: wisp %d, node %d, column %s: %.17g, twin %.17g", what, which, i,
                          got->name[2 + u], x, a[at]);
        }
    }
}

/* Evaluates with these words and checks the answer at time t against the twin, from the last frame
 * of `states` or, where it is NULL, from the rest shape. */
static void check_eval(const struct scene *scene, enum wisp_treatment treatment, double t,
                       const struct table *states, const char *const *words, const char *what) {
    static double q[LAB_SIZE], v[LAB_SIZE];
    struct table got;
    int first = 0, before = 0, rows = 0;
    struct finished *f = program_must(NULL, 0, NULL, words);
    cr_assert_eq(f->err[0], '\0', "%s: says %s", what, f->err);
    const char *const said = printed("# accelerations at t = %s s", DIGITS(t));
    cr_assert(strncmp(f->out, said, strlen(said)) == 0, "%s: no '%s' in %.60s", what, said, f->out);
    read_text(f->out, &got);
    struct model *model = lab_model(scene, treatment, 4);
    expect_names(&got, model->rate_columns, model->rate_column_count, what);
    for (int i = 0; i < scene->wisp_count; i++)
        rows += scene->wisps[i].nodes;
    cr_assert_eq(got.row_count, rows, "%s: %d rows, not %d", what, got.row_count, rows);
    if (states)
        before = states->row_count - rows;
    for (int i = 0; i < scene->wisp_count; first += scene->wisps[i++].nodes) {
        if (states) {
            unpack(&scene->wisps[i], treatment, states, before + first, q, v);
        } else {
            static struct wisp_twin twin;
            wisp_twin_init(&twin, &scene->wisps[i], &scene->around, treatment);
            wisp_twin_rest(&twin, q, v);
        }
        check_wisp(scene, i, treatment, t, q, v, &got, first, what);
    }
    table_free(&got);
}

#define WIND                                                                      \
    "wind={ kind=\"irregular\"; velocity=[1.0, 0.5, 2.0]; amplitudes=[0.5, 0.2];" \
    "       frequencies=[2.0, 7.0]; }"

/* The start: at t = 0, and at a time of its own, where the wind is another. */
Test(eval, the_start_is_the_twins, .init = open_folder) {
    static const char *const scenes[] = {"swing", "swing-envelope"};
    for (int i = 0; i < 2; i++) {
        struct scene *scene = LAB_LOAD(scenes[i], WIND);
        for (int treatment = 0; treatment < TREATMENTS; treatment++) {
            const char *name = treatment_names[treatment];
            check_eval(
                scene, (enum wisp_treatment)treatment, 0, NULL,
                (const char *const[]){"eval", scenes[i], "--set", WIND, "--treatment", name, NULL},
                name);
            check_eval(scene, (enum wisp_treatment)treatment, 0.3, NULL,
                       (const char *const[]){"eval", scenes[i], "--set", WIND, "--treatment", name,
                                             "--time", "0.3", NULL},
                       name);
        }
        /* what nobody names is generalised */
        check_eval(scene, WISP_GENERALISED, 0, NULL,
                   (const char *const[]){"eval", scenes[i], "--set", WIND, NULL}, scenes[i]);
    }
}

/* Six wisps of two node counts: lanes, padding and the order of rows matter. */
static const char flock[] =
    "duration = 0.05; frame_rate = 60.0; gravity = [0.0, -9.81, 0.0]; material = { };\n"
    "envelope = { samples = 5; radius = 0.01; };\n"
    "wind = { kind = \"irregular\"; velocity = [1.0, 0.5, 2.0];\n"
    "         amplitudes = [0.5, 0.2]; frequencies = [2.0, 7.0]; };\n"
    "run = { step = 1e-4; };\n"
    "wisps = (\n"
    "{ root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0]; length = 0.30; nodes = 11; },\n"
    "{ root = [0.1, 0.0, 0.2]; direction = [1.0, 0.3, 0.2]; length = 0.25; nodes = 11; },\n"
    "{ root = [0.0, 0.2, 0.0]; direction = [0.0, 1.0, 0.1]; length = 0.20; nodes = 7; },\n"
    "{ root = [0.3, 0.0, 0.0]; direction = [-1.0, 0.2, 1.0]; length = 0.30; nodes = 11; },\n"
    "{ root = [0.0, 0.0, 0.4]; direction = [0.2, -1.0, 0.0]; length = 0.20; nodes = 7; },\n"
    "{ root = [0.0, 0.5, 0.0]; direction = [1.0, 1.0, 1.0]; length = 0.35; nodes = 11; } );\n";

/* The text of a run's states; for free. */
static char *states_of(const char *scene, const char *treatment, const char *duration) {
    WORKS("run", scene, "--treatment", treatment, "--duration", duration, "--stepper",
          strcmp(scene, "circle") == 0 && strcmp(treatment, "free") != 0 ? "euler" : "rk4", "--out",
          folder, "--no-progress");
    char *text = file_read(printed("%s/states.tsv", folder));
    cr_assert(text, "%s: no states", treatment);
    return text;
}

/* What a run has left gives the accelerations at its last frame, at its time or another. */
Test(eval, a_saved_state_is_the_twins, .init = open_folder) {
    const char *const scene_path = file_write(folder, "flock.cfg", flock);
    struct scene *scene = lab_load(scene_path, NULL, 0);
    for (int treatment = 0; treatment < TREATMENTS; treatment++) {
        const char *name = treatment_names[treatment];
        struct table states;
        states_of(scene_path, name, "0.05");
        const char *const states_path = printed("%s/states.tsv", folder);
        char *text = file_read(states_path);
        read_text(text, &states);
        cr_assert_gt(states.row_count, 2 * 58, "%s: only %d rows", name, states.row_count);
        check_eval(scene, (enum wisp_treatment)treatment, 0.05, &states,
                   (const char *const[]){"eval", scene_path, "--treatment", name, "--state",
                                         states_path, NULL},
                   name);
        check_eval(scene, (enum wisp_treatment)treatment, 0.33, &states,
                   (const char *const[]){"eval", scene_path, "--treatment", name, "--state",
                                         states_path, "--time", "0.33", NULL},
                   name);
        table_free(&states);
    }
}

/* --- the circle --- */

/* In every treatment a = -(v.v / p.p) p, from the start and from the last frame of a run. */
Test(eval, the_circle_is_centripetal, .init = open_folder) {
    const struct treatment *treatments = problem_find("circle")->treatments;
    for (int i = 0; treatments[i].name; i++)
        for (int saved = 0; saved < 2; saved++) {
            const char *name = treatments[i].name;
            struct table states, got;
            char *text = states_of("circle", name, "40");
            read_text(text, &states);
            const struct finished *f =
                WORKS("eval", "circle", "--treatment", name, saved ? "--state" : NULL,
                      printed("%s/states.tsv", folder));
            read_text(f->out, &got);
            static const char *const names[] = {"wisp", "node", "ax", "ay", "az"};
            expect_names(&got, names, 5, name);
            cr_assert_eq(got.row_count, 1, "%s: %d rows", name, got.row_count);
            const int row = saved ? states.row_count - 1 : 0;
            const double x = table_value(&states, row, 3), y = table_value(&states, row, 4),
                         vx = table_value(&states, row, 6), vy = table_value(&states, row, 7);
            const double factor = -(vx * vx + vy * vy) / (x * x + y * y);
            const double limit = 1e-14 * fabs(factor) * hypot(x, y);
            cr_assert(fabs(table_value(&got, 0, 2) - factor * x) <= limit &&
                          fabs(table_value(&got, 0, 3) - factor * y) <= limit &&
                          table_value(&got, 0, 4) == 0,
                      "%s: (%.17g, %.17g), not (%.17g, %.17g)", name, table_value(&got, 0, 2),
                      table_value(&got, 0, 3), factor * x, factor * y);
            cr_assert(!saved || fabs(y) > 0.01, "%s: the particle is where it was", name);
            table_free(&states);
            table_free(&got);
        }
}

/* --- what is wrong --- */

/* Exit code 1, one line with the file and these words, and nothing on standard output. */
static void expect_refusal(const struct finished *f, const char *file, const char *says,
                           const char *what) {
    cr_expect_eq(f->code, 1, "%s: exit code %d, '%s'", what, f->code, f->err);
    cr_expect(count_lines(f->err) == 1 && strncmp(f->err, "wisplab: ", 9) == 0,
              "%s: not one line: '%s'", what, f->err);
    cr_expect(strstr(f->err, file) && strstr(f->err, says), "%s: no '%s', '%s' in '%s'", what, file,
              says, f->err);
    cr_expect_eq(f->out[0], '\0', "%s: prints '%.60s'", what, f->out);
}

static void refuse_text(const char *scene, const char *treatment, const char *text,
                        const char *says, const char *what) {
    const char *const path = file_write(folder, "bad.tsv", text);
    struct finished *f = PROGRAM(NULL, "eval", scene, "--treatment", treatment, "--state", path);
    expect_refusal(f, path, says, what);
}

/* Begin of the last line but `above`. */
static char *line_from_end(char *text, int above) {
    char *at = text + strlen(text) - 1;
    while (at > text && (at[-1] != '\n' || above-- > 0))
        at--;
    return at;
}

/* Puts `word` in place of field `field` of the line that begins at `line`; returns new text. */
static char *with_field(const char *text, const char *line, int field, const char *word) {
    const char *from = line;
    for (int i = 0; i < field; i++)
        from = strchr(from, '\t') + 1;
    const char *to = from + strcspn(from, "\t\n");
    return printed("%.*s%s%s", (int)(from - text), text, word, to);
}

static char *without_lines(const char *text, const char *from, const char *to) {
    return printed("%.*s%s", (int)(from - text), text, to);
}

Test(eval, wrong_files_are_refused_in_one_line, .init = open_folder) {
    static const char scene[] = "swing-envelope";
    char *good = states_of(scene, "generalised", "0.05"), *bad;
    char *names = strstr(good, "\nt\t") + 1, *rows = strchr(names, '\n') + 1;
    char *last = line_from_end(good, 0), *frame = line_from_end(good, 10);
    cr_assert(strncmp(last, "0.05", 4) == 0 && strncmp(frame, "0.05", 4) == 0, "'%.20s', '%.20s'",
              last, frame);

    /* single fields */
    static const struct {
        int field; /* of the last row: t wisp node x ... */
        const char *word, *says;
    } fields[] = {
        {0, "0.04", "row"}, {1, "1", "wisp"},   {2, "9", "node"},       {3, "nan", "finite"},
        {4, "inf", "row"},  {8, "-inf", "row"}, {9, "nan", "finite"},   {16, "nan", "finite"},
        {5, "", "number"},  {6, "x", "number"}, {7, "1.0 m", "number"}, {3, "1\t2", "more"},
    };
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
        bad = with_field(good, last, fields[i].field, fields[i].word);
        refuse_text(scene, "generalised", bad, fields[i].says, fields[i].word);
        bad = with_field(good, frame, fields[i].field, fields[i].word);
        refuse_text(scene, "generalised", bad, fields[i].says, fields[i].word);
    }

    /* names */
    bad = with_field(good, names, 9, "q0");
    refuse_text(scene, "generalised", bad, "'r0'", "no r0");
    bad = with_field(good, names, 0, "time");
    refuse_text(scene, "generalised", bad, "has not the columns of states", "no t");
    bad = with_field(good, names, 17, "more");
    refuse_text(scene, "generalised", bad, "have t and 16", "more than parent");
    bad = without_lines(good, names, rows);
    refuse_text(scene, "generalised", bad, "column", "no names");

    /* cut off: in a number, at the end of one, between rows, after the names, before them */
    const size_t length = strlen(good);
    static const char *const cut_says[] = {"complete", "complete", "row", "rows", "column"};
    char *const cuts[] = {good + length - 3, good + length - 1, last, rows, names};
    for (int i = 0; i < 5; i++) {
        bad = without_lines(good, cuts[i], "");
        refuse_text(scene, "generalised", bad, cut_says[i], "cut off");
    }
    bad = without_lines(good, rows, last); /* one row only */
    refuse_text(scene, "generalised", bad, "rows", "one row");
    bad = without_lines(good, strrchr(good, '\t'), "\n");
    refuse_text(scene, "generalised", bad, "fewer", "a short row");
    refuse_text(scene, "generalised", "", "no column names", "an empty file");

    /* of another treatment or scene */
    refuse_text(scene, "penalty", good, "e0x", "a file of generalised");
    refuse_text("swing", "generalised", good, "columns", "a file with samples");
    bad = states_of(scene, "penalty", "0.05");
    refuse_text(scene, "generalised", bad, "'r0'", "a file of penalty");
    bad = states_of("swing", "generalised", "0.05");
    refuse_text(scene, "generalised", bad, "'r0'", "a file without samples");
    static const char shorter[] = "wisps.[0].nodes=10";
    const char *path = file_write(folder, "bad.tsv", good);
    struct finished *f = PROGRAM(NULL, "eval", scene, "--set", shorter, "--state", path);
    expect_refusal(f, path, "node", "a file of more nodes");

    /* no file at all */
    f = PROGRAM(NULL, "eval", scene, "--state", folder);
    expect_refusal(f, folder, "", "a folder");
    path = printed("%s/none.tsv", folder);
    f = PROGRAM(NULL, "eval", scene, "--state", path);
    expect_refusal(f, path, "cannot be read", "no file");
}

/* A time that is none, on the command line or in the file: wind at no time is no number. */
Test(eval, times_are_finite, .init = open_folder) {
    static const char *const times[] = {"nan", "inf", "-inf", "1e999", "now", "1s", ""};
    for (int i = 0; i < 7; i++) {
        struct finished *f = PROGRAM(NULL, "eval", "swing", "--time", times[i]);
        expect_refusal(f, times[i], "--time", times[i]);
    }
    char *good = states_of("swing", "generalised", "0.05");
    static const char *const in_files[] = {"inf", "nan", "-inf"};
    for (int i = 0; i < 3; i++) {
        char *bad = good;
        for (int row = 0; row < 11; row++)
            bad = with_field(bad, line_from_end(bad, row), 0, in_files[i]);
        refuse_text("swing", "generalised", bad, "finite", in_files[i]);
    }
}

/* A state in which the model has no answer: exit code 3, and why. */
Test(eval, a_state_without_direction_exits_3, .init = open_folder) {
    char *text = states_of("swing", "generalised", "0.05");
    static const char *const on_node_1[] = {"0.029999999999999999", "0", "0"};
    for (int k = 0; k < 3; k++)
        text = with_field(text, line_from_end(text, 8), 3 + k, on_node_1[k]);
    struct finished *f = FAILS(3, "wisp 0: nodes 1 and 2 coincide", "eval", "swing", "--state",
                               file_write(folder, "bad.tsv", text));
    cr_assert_eq(f->out[0], '\0', "prints '%.60s'", f->out);
    text = states_of("radii", "generalised", "0.05"); /* of nine wisps, and the last one's tip */
    for (int line = 1; line <= 2; line++)
        for (int k = 0; k < 3; k++)
            text = with_field(text, line_from_end(text, line), 3 + k, on_node_1[k]);
    FAILS(3, "wisp 8: nodes ", "eval", "radii", "--treatment", "generalised", "--state",
          file_write(folder, "bad.tsv", text));
}

/* Numbers whose squares are none, and then accelerations of which some are NaN: no table. */
Test(eval, a_huge_state_exits_3, .init = open_folder) {
    char *text = states_of("swing", "generalised", "0.05");
    char *huge = with_field(text, line_from_end(text, 8), 3, "1e308");
    struct finished *f =
        FAILS(3, "not finite", "eval", "swing", "--state", file_write(folder, "huge.tsv", huge));
    cr_expect_eq(f->out[0], '\0', "prints '%.60s'", f->out);
}
