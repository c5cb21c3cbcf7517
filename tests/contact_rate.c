/* How often contacts are looked at: the limit of penalty, counts against the clock's, a small
 * experiment whose errors are known in kind, and verdicts that follow from numbers. */
#include "experiments/contact_rate/contact_rate.h"

#include "base/text_table.h"
#include "experiments/common/limit.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- the limit of penalty --- */

/* What is a parabola in 1/sqrt(ratio) is met at its vertex for infinite ratios, whatever the three
 * ratios are; a cubic is not. */
Test(limit, is_exact_for_parabolas_in_the_root_of_the_ratio) {
    enum { COUNT = 3, COLUMNS = 5 };
    static const double ratio[COUNT] = {100, 400, 2500};
    double value[COUNT][COLUMNS];
    struct trajectory run[COUNT] = {0}, limit, other;
    const struct trajectory *list[COUNT];
    for (int i = 0; i < COUNT; i++) {
        const double e = 1 / sqrt(ratio[i]);
        const double row[COLUMNS] = {0.1, 2, 3, 7 - 3 * e + 11 * e * e, 7 + e * e * e};
        memcpy(value[i], row, sizeof row);
        run[i].table = (struct table){.column_count = COLUMNS, .row_count = 1, .value = value[i]};
        list[i] = &run[i];
    }
    cr_assert_eq(penalty_limit(list, ratio, COUNT, &limit), 0);
    cr_assert(limit.table.value[0] == 0.1 && limit.table.value[1] == 2 && limit.table.value[2] == 3,
              "labels");
    cr_assert_float_eq(limit.table.value[3], 7, 1e-12);
    cr_assert_float_eq(limit.table.value[4], 7 + 1. / 10 / 20 / 50, 1e-12); /* + e0 e1 e2 */
    free(limit.table.value);
    run[2].table.row_count = 2;
    cr_assert_eq(penalty_limit(list, ratio, COUNT, &other), -1);
    cr_assert_null(other.table.value);
}

/* --- a small experiment --- */

/* Two wisps that lie in each other and swing apart; they only rub. */
static const char rubbing[] =
    "name = \"rubbing\"; duration = 0.3; frame_rate = 30.0; gravity = [0.0, -9.81, 0.0];\n"
    "material = { bending = \"hinge\"; }; envelope = { };\n"
    "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [0.5, -1.0, 0.1]; length = 0.16; nodes = 6; "
    "},\n"
    "          { root = [0.012, 0.0, 0.003]; direction = [0.2, -1.0, -0.1]; length = 0.16; nodes = "
    "6; } );\n"
    "contacts = { viscosity = 300.0; %s };\n"
    "run = { step = 1.0e-4; rtol = 1.0e-6; atol = 1.0e-9; };\n";

static char *folder;

static struct text_table rates, series, statements;

static void read_table(struct text_table *table, const char *name) {
    char reason[REASON_SIZE];
    const char *const path = printed("contact-rate/%s", name);
    table_must_be_read(table, folder, path);
    cr_assert_eq(text_table_check(table, path, reason), 0, "%s", reason);
}

static void run_experiment_quick(const char *text) {
    folder = folder_make();
    gnuplot_stub_quiet();
    const char *const scene = file_write(folder, "scene.cfg", text);
    WORKS("experiment", "contact-rate", "--quick", "--scene", scene, "--out", folder,
          "--no-progress");
    read_table(&rates, "rates");
    read_table(&series, "series");
    read_table(&statements, "statements");
    statements_must_be_whole(printed("%s/contact-rate", folder));
    cr_assert_eq(new_runs(WORKS("experiment", "contact-rate", "--quick", "--scene", scene, "--out",
                                folder, "--no-progress"),
                          NULL),
                 0, "what is there is run again");
}

static void run_experiment_rubbing(const char *contacts) {
    run_experiment_quick(printed(rubbing, contacts));
}

static double at_rate(const char *name, double rate, const char *column) {
    for (int row = 0; row < rates.row_count; row++)
        if (strcmp(text_table_cell(&rates, row, "series"), name) == 0 &&
            text_table_number(&rates, row, "rate") == rate)
            return text_table_number(&rates, row, column);
    cr_assert_fail("no row of %s at %g Hz", name, rate);
    return NAN;
}

static const char *verdict_of(const char *key) {
    return text_table_cell(&statements, the_row(&statements, key), "verdict");
}

/* Nu dt is 3.3 at 90 Hz: the exponential stops what rubs at each tick and is near the motion in
 * which it stops at once, at any rate; its linearisation would turn velocities round, and is
 * decimetres off. */
Test(contact_rate, strong_friction_is_near_its_limit_at_any_rate) {
    run_experiment_rubbing("collision = false;");
    for (int one_sided = 0; one_sided < 2; one_sided++) {
        const char *name = one_sided ? "friction, one-sided" : "friction, reciprocal";
        const double error = at_rate(name, 90, "error"), finer = at_rate(name, 900, "error");
        cr_expect(error < 8e-3 && finer < error && finer > 0, "%s: %g, %g", name, error, finer);
        cr_expect_eq(at_rate(name, 9000, "error"), 0);
    }
    cr_expect_str_eq(verdict_of("rubbing, friction, reciprocal, converges"), "holds");
    cr_expect_str_eq(verdict_of("rubbing, control"), "holds");
    cr_expect_str_eq(verdict_of("rubbing, bodies"), "not reached");
    cr_expect_lt(text_table_find(&statements, "rubbing, collision, reciprocal, converges", NULL), 0,
                 "what the scene has switched off stays off");

    /* Wisps that are never far apart look in all of their 2 x 4 sections at each of 27 ticks; 90 of
     * the bodies' ticks, 27 of theirs, 9 of which are at one time. */
    cr_expect_eq(at_rate("friction, reciprocal", 90, "sections"), 27 * 8);
    cr_expect_eq(at_rate("friction, reciprocal", 900, "sections"), 270 * 8);
    cr_expect_eq(at_rate("friction, reciprocal", 90, "stops"), 90 + 27 - 9);
    cr_expect_eq(at_rate("no contact", 9000, "stops"), 90);
    cr_expect_gt(at_rate("friction, reciprocal", 90, "contacts"), 0);
    cr_expect_eq(at_rate("no contact", 9000, "contacts"), 0);
}

/* A scene in which nothing touches passes no claim on contact. */
Test(contact_rate, without_contact_nothing_is_told) {
    run_experiment_rubbing("interpenetration = false; collision = false;");
    cr_expect_str_eq(verdict_of("rubbing, control"), "holds");
    cr_expect_eq(at_rate("no contact", 90, "error"), 0);
    for (int row = 0; row < statements.row_count; row++) {
        const char *key = text_table_cell(&statements, row, "key");
        const char *verdict = text_table_cell(&statements, row, "verdict");
        if (strcmp(text_table_cell(&statements, row, "by"), "thesis") == 0)
            cr_expect_str_eq(verdict, "not reached", "%s", key);
    }
    cr_expect_str_eq(verdict_of("rubbing, contact"), "not reached");
    cr_expect_str_eq(verdict_of("rubbing, sources"), "not reached");
}

/* Two wisps that meet crosswise, as in `interactions`. */
static const char meeting[] =
    "name = \"meeting\"; duration = 0.5; frame_rate = 30.0; gravity = [0.0, -9.81, 0.0];\n"
    "material = { drag_rate = 1.15; bending = \"hinge\"; bending_stiffness = 8.5e-6; };\n"
    "envelope = { radius = 0.03; };\n"
    "wisps = (\n"
    "  { root = [0.0, 0.0, 0.0]; direction = [0.99, -0.08, 0.4]; length = 0.16; nodes = 7; },\n"
    "  { root = [0.087, 0.033, -0.066]; direction = [-0.58, 0.81, 0.95]; length = 0.16; nodes = 7; "
    "} );\n"
    "contacts = { threshold = 0.44; };\n"
    "run = { step = 1.0e-4; rtol = 1.0e-6; atol = 1.0e-9; };\n";

/* From half the step the motion with ticks at 9000 Hz is another one after 0.3 s. */
Test(contact_rate, after_the_horizon_pairs_of_runs_are_compared) {
    static const char own[] = "both, reciprocal";
    run_experiment_quick(meeting);
    const int row = text_table_find(&series, "meeting", own);
    cr_assert(row >= 0);
    const double horizon = text_table_number(&series, row, "horizon");
    cr_assert(horizon > 0.1 && horizon < 0.45, "%g", horizon);
    cr_expect_lt(text_table_number(&series, row, "doubt"), 1e-3);
    cr_expect_eq(at_rate(own, 9000, "pairs"), 4 * 3 / 2, "each two of four starts");
    cr_expect_eq(at_rate(own, 90, "pairs"), 4 * 4, "each with each");
    cr_expect_eq(at_rate("both, one-sided", 90, "pairs"), 0, "of its own contact alone");
    const double lower = at_rate(own, 90, "after_lower"), middle = at_rate(own, 90, "after_median"),
                 upper = at_rate(own, 90, "after_upper");
    cr_expect(lower > 0 && lower <= middle && middle <= upper);
    /* Squares add up over frames, 0.3 s of which are before the horizon, up to what starts 1e-6 m
     * apart make of them. */
    const double whole = at_rate(own, 90, "whole"), before = at_rate(own, 90, "error");
    const double frames = 16, early = round(30 * horizon) + 1;
    const double after =
        sqrt((frames * whole * whole - early * before * before) / (frames - early));
    cr_expect_float_eq(middle, after, 0.05 * after, "%g, %g", middle, after);
}

Test(contact_rate, compares_rates_and_not_steppers) {
    FAILS(1, "--stepper", "experiment", "contact-rate", "--stepper", "rk4");
}

/* --- verdicts --- */

/* A wisp that falls onto a ball: a softer penalty lets it in deeper, ticks let it in not at all,
 * and bodies that push make no ticks. */
Test(contact_rate, slow_bodies_by_penalty_are_compared_with_ticks) {
    struct text_table penalty, steps;
    run_experiment_quick(
        "name = \"falling\"; duration = 0.4; frame_rate = 30.0; gravity = [0.0, -9.81, 0.0];\n"
        "material = { };\n"
        "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0]; length = 0.3; nodes = 8; "
        "} );\n"
        "body = ( { name = \"ball\"; center = [0.15, -0.13, 0.01]; radii = [0.06, 0.06, 0.06];\n"
        "           friction = 50.0; elasticity = 0.1; offset = 1.0e-4; } );\n"
        "run = { step = 1.0e-4; rtol = 1.0e-6; atol = 1.0e-9; };\n");
    read_table(&penalty, "penalty");
    read_table(&steps, "penalty-steps");
    cr_assert_eq(penalty.row_count, 5, "%d rows", penalty.row_count);
    cr_assert_eq(steps.row_count, 0, "the probe is no scene of the user's");
    double before = INFINITY;
    for (int row = 0; row < 5; row++) {
        const double frequency = text_table_number(&penalty, row, "frequency");
        const double depth = text_table_number(&penalty, row, "depth");
        cr_assert_str_eq(text_table_cell(&penalty, row, "outcome"), "finished");
        cr_assert_gt(text_table_number(&penalty, row, "error"), 0);
        if (frequency == 0) {
            cr_assert_eq(depth, 0, "at a tick %g m deep", depth);
            continue;
        }
        cr_assert(depth > 0 && depth < before, "%g m at %g Hz, %g before", depth, frequency,
                  before);
        before = depth;
    }
    cr_assert(before < 2e-3 && text_table_number(&penalty, 1, "depth") > 1e-2, "%g m", before);
    cr_assert_geq(text_table_find(&statements, "falling, penalty, depth", NULL), 0);
    cr_assert_geq(text_table_find(&statements, "falling, penalty, error", NULL), 0);
}

/* A scene with its own contact, reciprocal, at three rates; the control; no bodies. */
struct prepared {
    struct scene *scene;
    struct subject subject;
    struct contact_rate *all;
    struct study *study;
    struct series *touch;
};

static void add_series(struct study *study, int contact, double e30, double e90) {
    struct series *s = &study->series[study->series_count++];
    *s = (struct series){.contact = contact,
                         .reciprocal = 1,
                         .rate_count = 3,
                         .again = contact ? 1 : -1,
                         .horizon = 0.5,
                         .effect = contact ? 0.02 : 0,
                         .order = {.slope = 0.9, .points = 3},
                         .has_order = contact > 0};
    snprintf(s->name, sizeof s->name, "%s", contact ? "both, reciprocal" : "no contact");
    s->point[0] = (struct rate_point){.rate = 30, .error = e30};
    s->point[1] = (struct rate_point){.rate = 90, .error = e90, .sections = 10, .contacts = 4};
    s->point[2] = (struct rate_point){.rate = YARDSTICK_RATE, .sections = 1000, .contacts = 400};
    s->point[1].stops = 100;
    s->point[2].stops = 3000;
}

static void set_errors(struct study *study, double integrator, double treatment, double ticks) {
    const double errors[SOURCES] = {integrator, treatment, ticks, NAN};
    study->span = 0.5;
    study->has_sources = 1;
    for (int i = 0; i < SOURCES; i++)
        study->error[i] = (struct source_error){.error = errors[i], .doubt = 1e-4};
}

static void prepare(struct prepared *p) {
    *p = (struct prepared){.scene = lab_load("interactions", NULL, 0)};
    p->scene->interaction.reciprocal = 1;
    p->subject = (struct subject){.scene = p->scene, .name = "two"};
    p->all = test_room(sizeof *p->all + sizeof *p->all->study);
    p->all->count = 1;
    p->study = &p->all->study[0];
    *p->study = (struct study){.subject = &p->subject, .own_contact = BOTH};
    add_series(p->study, BOTH, 3e-3, 0.9e-3);
    add_series(p->study, 0, 0, 0);
    p->touch = &p->study->series[0];
    set_errors(p->study, 1e-3, 2e-3, 4e-3);
}

static void state(const struct prepared *p) {
    struct statements all;
    char reason[REASON_SIZE];
    folder = folder_make();
    cr_assert_eq(statements_open(&all, folder, NULL, NULL, reason), 0, "%s", reason);
    state_all(&all, p->all);
    cr_assert_eq(statements_close(&all, 0, reason), 0, "%s", reason);
    statements_must_be_whole(folder);
    statements_must_be_read(&statements, folder);
}

static void row_is(const char *key, const char *verdict, const char *sentence) {
    must_state(&statements, key, verdict, sentence);
}

Test(contact_rate, statements_follow_from_the_numbers) {
    static struct prepared p;
    prepare(&p);
    p.touch->point[1].after = (struct spread_of_pairs){16, 2e-3, 3e-3, 4e-3};
    p.touch->point[2].after = (struct spread_of_pairs){6, 1e-3, 2e-3, 3.5e-3};
    state(&p);
    row_is("two, both, reciprocal, 90 Hz", "holds",
           "On two with both, reciprocal contacts a hundred times rarer do no harm: up to 0.5 s "
           "hair at 90 Hz is 0.9 mm (rms) from hair at 9000 Hz, 0.045 of what contact does.");
    row_is(
        "two, both, reciprocal, converges", "holds",
        "On two with both, reciprocal the motion converges as contacts become more frequent: up to "
        "0.5 s it is 3 mm at 30 Hz, 0.9 at 90 from that at 9000 Hz, of order 0.9 in the interval.");
    row_is("two, both, reciprocal, 90 Hz after the horizon", "holds", NULL);
    row_is("two, sources", "holds",
           "On two rare ticks are the largest error up to 0.5 s: wisp ticks 4 mm, treatment 2, "
           "integrator 1.");
    row_is("two, control", "holds", NULL);
    row_is("two, cost", "holds", NULL);
    row_is("both, reciprocal", "holds", NULL);
    row_is("friction, one-sided", "not reached", NULL);
}

/* Other numbers, other verdicts. */
Test(contact_rate, verdicts_turn_with_the_numbers) {
    static struct prepared p;
    prepare(&p);
    p.touch->point[1].error = 1.1e-3;
    p.touch->order.slope = 0.4;
    p.touch->point[1].after = (struct spread_of_pairs){16, 2e-3, 3.6e-3, 4e-3};
    p.touch->point[2].after = (struct spread_of_pairs){6, 1e-3, 2e-3, 3.5e-3};
    p.touch->point[2].sections = 400;
    p.study->series[1].point[1].error = 2e-12;
    set_errors(p.study, 1e-3, 4e-3, 2e-3);
    state(&p);
    row_is("two, both, reciprocal, 90 Hz", "does not hold", NULL);
    row_is("two, both, reciprocal, converges", "does not hold", NULL);
    row_is("two, both, reciprocal, 90 Hz after the horizon", "does not hold", NULL);
    row_is("two, sources", "does not hold", NULL);
    row_is("two, control", "does not hold", NULL);
    row_is("two, cost", "does not hold", NULL);
    row_is("both, reciprocal", "does not hold", NULL);
    /* Errors that rise do not converge, whatever their slope. */
    p.touch->order.slope = 0.9;
    p.touch->point[0].error = 1e-3;
    state(&p);
    row_is("two, both, reciprocal, converges", "does not hold", NULL);
    /* Contact does less than harm, errors are within their doubts, or too few of them are not. */
    p.touch->effect = 0.9e-3;
    p.touch->has_order = 0;
    set_errors(p.study, 1e-3, 2e-3, 2.1e-3);
    state(&p);
    row_is("two, both, reciprocal, 90 Hz", "not reached", NULL);
    row_is("two, both, reciprocal, converges", "not reached", NULL);
    row_is("two, sources", "not reached", NULL);
    row_is("both, reciprocal", "not reached", NULL);
    /* To the end the ticks' error is as large, but in doubt. */
    set_errors(p.study, 1e-3, 2e-3, 4e-3);
    p.study->duration = 2;
    for (int i = 0; i < SOURCES; i++)
        p.study->error[i].whole = p.study->error[i].error;
    p.study->error[OF_WISP_TICKS].whole_doubt = 2.1e-3;
    state(&p);
    row_is("two, sources", "holds", NULL);
    row_is("two, sources, to the end", "not reached",
           "On two several sources could be the largest error over all 2 s: wisp ticks 4 mm (in "
           "doubt by 2.1), treatment 2, integrator 1.");
    /* Of contact that does nothing nothing is told. */
    p.touch->effect = 1e-9;
    p.touch->doubt = 2e-9;
    state(&p);
    row_is("two, sources", "not reached", NULL);
    row_is("two, both, reciprocal", "not reached", NULL);
    cr_expect_lt(text_table_find(&statements, "two, both, reciprocal, converges", NULL), 0);
}
