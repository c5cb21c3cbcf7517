/* Races: from perturbed starts to the horizon, and a small one from plan to table. */
#include "experiments/work_precision/race.h"

#include "base/table.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- perturbed starts --- */

static void states_at_start(const char *perturb, const char *draw, struct table *states) {
    char reason[REASON_SIZE];
    const char *const folder = folder_make();
    WORKS("run", "swing-envelope", "--duration", "0.001", "--perturb", perturb, "--draw", draw,
          "--out", folder, "--no-progress");
    cr_assert(table_read(states, printed("%s/states.tsv", folder), reason) == 0, "%s", reason);
}

Test(race, a_perturbed_start_is_that_far_away_and_its_own) {
    struct table start, other, again;
    states_at_start("1e-6", "1", &start);
    states_at_start("1e-6", "2", &other);
    states_at_start("1e-6", "1", &again);
    double square = 0, apart = 0;
    for (int i = 0; i < 11; i++) {
        for (int k = 3; k < 6; k++) {
            const double at_rest = k == 3 ? 0.03 * i : 0;
            const double moved = table_value(&start, i, k) - at_rest;
            cr_assert(i >= 2 || moved == 0, "node %d belongs to the head", i);
            square += moved * moved;
            apart += fabs(moved - table_value(&other, i, k) + at_rest);
            cr_assert(table_value(&start, i, k) == table_value(&again, i, k), "node %d", i);
        }
        cr_assert(table_value(&start, i, 6) == 0, "velocities are not perturbed");
    }
    const double rms = sqrt(square / 9); /* of 27 Gaussian numbers: sd of the rms is 14 % */
    cr_assert(rms > 0.5e-6 && rms < 1.6e-6, "%g", rms);
    cr_assert(apart > 1e-6, "the draws are the same");
    table_free(&start);
    table_free(&other);
    table_free(&again);
}

/* --- the horizon --- */

/* A run's folder with one node at 0, `apart` times 1, 2, 3, ... in x at frames 0.1 s apart. */
static void write_run(const char *folder, const char *status, const double *x, int frames) {
    char text[4096] = "t\twisp\tnode\tx\ty\tz\tvx\tvy\tvz\n";
    for (int i = 0; i < frames; i++)
        snprintf(text + strlen(text), sizeof text - strlen(text),
                 "%.17g\t0\t2\t%.17g\t0\t0\t0\t0\t0\n", 0.1 * i, x[i]);
    const char *const json = printed("{\"status\": \"%s\", \"frames\": %d}", status, frames);
    file_write(folder, "states.tsv", text);
    file_write(folder, "run.json", json);
}

static double horizon(const char *status, const double *x, int frames) {
    static const double still[8];
    char reason[REASON_SIZE];
    double found = -1;
    const char *const one = folder_make();
    const char *const other = folder_make();
    write_run(one, "finished", still, frames);
    write_run(other, status, x, frames);
    cr_assert(measure_horizon(NULL, one, other, &found, reason) == 0, "%s", reason);
    return found;
}

Test(race, the_horizon_is_the_last_frame_within_a_millimetre) {
    const double never[] = {1e-10, 1e-8, 1e-6, 0.99e-3};
    const double late[] = {1e-10, 1e-8, 1e-6, 1.01e-3, 1e-10};
    const double back[] = {1e-10, 1e-8, 2e-3, 1e-10, 1e-10};
    const double at_once[] = {1e-10, 2e-3, 2e-3};
    cr_expect_float_eq(horizon("finished", never, 4), 0.3, 1e-12);
    cr_expect_float_eq(horizon("finished", late, 5), 0.2, 1e-12);
    cr_expect_float_eq(horizon("finished", back, 5), 0.1, 1e-12);
    cr_expect_float_eq(horizon("finished", at_once, 3), 0.1, 1e-12, "two frames are left");
    cr_expect(isnan(horizon("diverged", never, 4)));
}

/* --- a small race --- */

static const char small_scene[] =
    "name = \"small\"; duration = 0.1; frame_rate = 30.0; gravity = [0.0, -9.81, 0.0];\n"
    "material = { };\n"
    "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0]; length = 0.1; nodes = 4; } "
    ");\n"
    "run = { step = 2.5e-4; rtol = 1e-4; atol = 1e-6; };\n";

/* Rows of a table that begin with this. */
static int rows_of(const char *table, const char *beginning) {
    int count = 0;
    for (const char *line = table; line && *line; line = strchr(line, '\n'), line += line != NULL)
        count += strncmp(line, beginning, strlen(beginning)) == 0;
    return count;
}

/* How many wisps a method computes side by side is in each of its rows. */
static void lanes_must_be(const char *folder, const char *method, int lanes) {
    struct text_table table;
    int found = 0;
    table_must_be_read(&table, folder, "small");
    for (int row = 0; row < table.row_count; row++) {
        if (strcmp(text_table_cell(&table, row, "method"), method) != 0)
            continue;
        found++;
        cr_expect(text_table_number(&table, row, "lanes") == lanes &&
                      text_table_number(&table, row, "threads") == 1,
                  "%s in row %d", method, row);
    }
    cr_expect(found > 0, "no %s", method);
}

Test(race, a_small_one_has_every_point_and_runs_nothing_twice, .timeout = 120) {
    const char *const folder = folder_make();
    const char *const scene = file_write(folder, "small.cfg", small_scene);
    WORKS("experiment", "work-precision", "--scene", scene, "--quick", "--stepper", "cvode",
          "--stepper", "rk4", "--out", folder, "--no-progress");
    const char *const results = printed("%s/work-precision", folder);
    const char *const table = file_of(results, "small.tsv");
    cr_expect(rows_of(table, "cvode\tgeneralised\t") == 6, "every other of 11 tolerances");
    cr_expect(rows_of(table, "cvode order 2\tgeneralised\t") == 6);
    cr_expect(rows_of(table, "rk4\tgeneralised\t") >= 9, "two beyond its largest stable step, six "
                                                         "below it");
    cr_expect(strstr(table, "\tstrain\tpenetration\tdrift\tlanes\tthreads\trun\tnote\n"),
              "measures of the state");
    cr_expect(strstr(table, "diverged") || strstr(table, "not finite"), "a long step of rk4 fails");
    lanes_must_be(results, "cvode", 1);
    lanes_must_be(results, "cvode 4 lanes", 4);
    statements_must_be_whole(results);
    cr_assert_eq(
        new_runs(WORKS("experiment", "work-precision", "--scene", scene, "--quick", "--stepper",
                       "cvode", "--stepper", "rk4", "--out", folder, "--no-progress"),
                 NULL),
        0);
}

/* --- which settings a chart has --- */

/* A bare wisp under two methods with fixed steps, of which the second one is stable at any step,
 * and an adaptive one. */
struct chart {
    struct scene *scene;
    struct plan plan;
    struct configuration configurations[3];
    struct entry entries[3];
    struct field field;
};

static void open_chart(struct chart *c) {
    static const char *const names[] = {"euler", "implicit-euler", "cvode"};
    static const double costs[] = {50e-9, 30e-9, 35e-9}; /* Euler is the costliest */
    *c = (struct chart){.scene = lab_load("swing", NULL, 0)};
    for (int i = 0; i < 3; i++) {
        c->configurations[i] = (struct configuration){.name = names[i],
                                                      .stepper = names[i],
                                                      .method = stepper_find(names[i]),
                                                      .cost = costs[i],
                                                      .finest = 1e-8,
                                                      .order = 2};
        c->entries[i] = (struct entry){.configuration = &c->configurations[i]};
    }
    c->field = (struct field){.whole = c->scene,
                              .scene = c->scene,
                              .treatment = WISP_GENERALISED,
                              .entries = c->entries,
                              .entry_count = 3};
}

/* The search for the largest stable step of an entry where all are stable that are at most `limit`
 * long, s. */
static void search(struct chart *c, int who, double limit) {
    struct entry *entry = &c->entries[who];
    race_search(&c->plan, &c->field, entry);
    for (int turn = 0; entry->searching; turn++) {
        cr_assert(turn < 20, "the search of %s does not end", entry->configuration->name);
        if (configuration_is_adaptive(entry->configuration))
            entry->pace = 1000;
        race_search_on(&c->plan, &c->field, entry,
                       race_setting(&c->field, entry, entry->place.at) <= limit ? FINISHED
                                                                                : DIVERGED);
    }
}

Test(race, a_chart_goes_from_beyond_the_largest_stable_step_as_deep_as_its_costliest_needs) {
    static struct chart c;
    open_chart(&c);
    const double limit = 1 / 9100.;
    search(&c, 0, limit);
    search(&c, 1, 1);
    search(&c, 2, 1);
    race_fit(&c.plan, &c.field, 1);
    const struct entry *euler = &c.entries[0], *implicit = &c.entries[1], *cvode = &c.entries[2];
    const int b = euler->place.reached;
    cr_assert(race_setting(&c.field, euler, b) <= limit &&
              race_setting(&c.field, euler, b - 1) > limit);
    cr_expect_eq(euler->first, b - LEVELS_BEYOND);
    cr_expect_geq(euler->last, b + LEVELS_BELOW);
    cr_expect_eq(implicit->first, 0, "it is stable at any step");
    cr_expect_geq(implicit->last, LEVELS_BELOW);
    cr_expect_eq(cvode->last, TOLERANCES - 1);
    /* nothing that is left out is cheaper than anything that is run */
    double most = 0;
    for (int i = 0; i < 3; i++)
        most = fmax(most, race_predicted(&c.field, &c.entries[i], c.entries[i].last));
    for (int i = 0; i < 2; i++)
        cr_expect_gt(race_predicted(&c.field, &c.entries[i], c.entries[i].last + 1), most, "%s",
                     c.entries[i].configuration->name);
}

/* Where no step is stable that costs less than the costliest run, those tried are in the chart, and
 * a word says so; linear theory being wrong by far is no matter. */
Test(race, a_method_without_a_stable_step_is_in_the_chart_with_what_was_tried) {
    static struct chart c;
    open_chart(&c);
    search(&c, 0, 0);
    search(&c, 1, 1e-5);
    search(&c, 2, 1);
    race_fit(&c.plan, &c.field, 1);
    cr_expect_lt(c.entries[0].place.reached, 0);
    cr_expect(strstr(c.entries[0].left_out, "no step is stable"), "%s", c.entries[0].left_out);
    cr_expect_geq(c.entries[0].last, c.entries[0].place.missed);
    cr_expect(race_setting(&c.field, &c.entries[1], c.entries[1].place.reached) <= 1e-5);
    cr_expect_eq(c.entries[1].first, c.entries[1].place.reached - LEVELS_BEYOND);
}

/* What runs into a limit at a long step does so at shorter ones. */
Test(race, a_limit_ends_the_search) {
    static struct chart c;
    open_chart(&c);
    race_search(&c.plan, &c.field, &c.entries[0]);
    race_search_on(&c.plan, &c.field, &c.entries[0], OUT_OF_TIME);
    cr_expect(!c.entries[0].searching);
    search(&c, 1, 1);
    search(&c, 2, 1);
    race_fit(&c.plan, &c.field, 1);
    cr_expect(strstr(c.entries[0].left_out, "out of time"), "%s", c.entries[0].left_out);
}

/* A scene is run for what the budget allows; where that is not even a second, the costliest
 * treatment goes first, and one is left. */
Test(race, what_a_budget_does_not_allow_is_left_out_by_name) {
    static struct chart c;
    static const struct race rich = {.seconds = 1e6}, poor = {.seconds = 1e-3};
    open_chart(&c);
    struct scene *scene = LAB_LOAD("swing-envelope", "duration=2.0");
    char left_out[64];
    int treatments[] = {WISP_PROJECTION, WISP_PENALTY, WISP_GENERALISED}, count = 3;
    c.plan.configurations = c.configurations;
    c.plan.configuration_count = 3;
    c.plan.subject_count = 1;
    cr_expect_eq(race_afford(&c.plan, &rich, scene, treatments, &count, left_out), 2);
    cr_expect(count == 3 && !left_out[0]);
    cr_expect_eq(race_afford(&c.plan, &poor, scene, treatments, &count, left_out), 1);
    cr_expect(count == 1 && treatments[0] == WISP_PROJECTION);
    cr_expect_str_eq(left_out, "penalty and generalised");
}

/* The prediction knows no clock: it is the same whatever was measured. */
Test(race, costs_are_predicted_from_counts) {
    static struct chart c;
    open_chart(&c);
    const double one = race_predicted(&c.field, &c.entries[0], 10);
    const double finer = race_predicted(&c.field, &c.entries[0], 12);
    const double start = 2 * one - finer; /* a process */
    cr_expect_float_eq(finer - start, 2 * (one - start), 1e-12,
                       "an octave down is twice as expensive");
    c.entries[2].pace = 1000;
    const double loose = race_predicted(&c.field, &c.entries[2], LEVEL_PROBED);
    cr_expect_float_eq(loose - start, 35e-9 * 27 * 1000, 1e-9, "%g", loose - start);
}

/* Who is timed is alone on the machine: of nine jittered runs one is, and the others go two at a
 * time. */
Test(race, one_of_the_jittered_runs_is_timed) {
    static struct chart c;
    open_chart(&c);
    c.entries[2].pace = 1000;
    cr_assert_eq(race_jitters(&c.plan, &c.field, &c.entries[2], LEVEL_PROBED), JITTERS);
    for (int j = 0; j < JITTERS; j++)
        cr_expect_eq(race_timings(&c.plan, &c.field, &c.entries[2], LEVEL_PROBED, j), 3 * (j == 0));
    cr_expect_eq(race_timings(&c.plan, &c.field, &c.entries[0], 10, 0), 3);
    c.entries[2].pace = 1e5;
    cr_assert(race_is_expensive(&c.field, &c.entries[2], LEVEL_PROBED + 2));
    cr_expect_eq(race_jitters(&c.plan, &c.field, &c.entries[2], LEVEL_PROBED + 2), 1,
                 "what is expensive is run once");
}

/* --- what is said of its points --- */

enum { FIELDS = 2, EULER = 0, RK4, CVODE, POINTS = 6 };

/* Two treatments of a scene: at 10 000 Hz, just above the thesis's 9000, rk4 is as accurate as
 * Euler for a quarter of the cost, and projection is nine times farther from the truth. */
struct prepared {
    struct scene *scene;
    struct subject subject;
    struct configuration configurations[3];
    struct entry entries[FIELDS][3];
    struct point points[FIELDS][POINTS];
    struct field fields[FIELDS];
};

static void add(struct prepared *p, int field, int who, double setting, const char *status,
                double error, double cpu) {
    struct field *f = &p->fields[field];
    p->points[field][f->point_count++] = (struct point){
        .entry = &p->entries[field][who],
        .setting = setting,
        .status = status,
        .runs = 1,
        .failed = strcmp(status, "finished") != 0,
        .cost = {.cpu = {cpu, cpu, cpu}, .counted = cpu},
        .deviation = {.rms = error},
        .error_least = error,
        .error_greatest = error,
    };
}

static void prepare(struct prepared *p) {
    static const char *const names[] = {"euler", "rk4", "cvode"};
    static const int treatments[] = {WISP_PROJECTION, WISP_GENERALISED};
    static const double off[] = {4.5e-3, 1e-4};
    *p = (struct prepared){.scene = lab_load("swing-envelope", NULL, 0)};
    p->subject = (struct subject){.scene = p->scene, .name = "swing"};
    for (int who = 0; who < 3; who++)
        p->configurations[who] = (struct configuration){
            .name = names[who], .stepper = names[who], .method = stepper_find(names[who])};
    for (int f = 0; f < FIELDS; f++) {
        for (int who = 0; who < 3; who++)
            p->entries[f][who] = (struct entry){.configuration = &p->configurations[who]};
        p->fields[f] = (struct field){.subject = &p->subject,
                                      .whole = p->scene,
                                      .scene = p->scene,
                                      .treatment = treatments[f],
                                      .has_reference = 1,
                                      .points = p->points[f],
                                      .treatment_error = off[f],
                                      .entries = p->entries[f],
                                      .entry_count = 3};
    }
    add(p, 0, EULER, 0.01, "diverged", NAN, 1e-4);
    add(p, 0, EULER, 1e-4, "finished", 5e-4, 8e-3);
    add(p, 0, EULER, 1e-5, "finished", 5e-5, 8e-2);
    add(p, 0, RK4, 2e-4, "finished", 4e-4, 2e-3);
    add(p, 1, RK4, 2e-4, "finished", 3e-4, 5e-3);
    add(p, 1, CVODE, 1e-3, "finished", 8e-4, 3e-3);
}

/* What is stated of them, row by key. */
static struct text_table rows;

static void state(const struct prepared *p) {
    const char *cheapest[RACE_TARGETS], *const folder = folder_make();
    int among[3 * RACE_TARGETS] = {0};
    struct race_answers answers = {.asked = ~0u,
                                   .cheapest = cheapest,
                                   .configurations = p->configurations,
                                   .configuration_count = 3,
                                   .among = among};
    struct statements statements;
    char reason[REASON_SIZE];
    cr_assert_eq(statements_open(&statements, folder, NULL, NULL, reason), 0, "%s", reason);
    race_state_subject(&statements, p->fields, FIELDS, &answers);
    race_state_all(&statements, &answers);
    cr_assert_eq(statements_close(&statements, 0, reason), 0, "%s", reason);
    statements_must_be_whole(folder);
    statements_must_be_read(&rows, folder);
}

static void row_is(const char *key, const char *verdict, const char *sentence) {
    must_state(&rows, key, verdict, sentence);
}

static struct prepared p;

Test(race, statements_follow_from_the_points) {
    prepare(&p);
    state(&p);
    row_is("swing, 10 mm", "holds",
           "Within 10 mm on swing (with its treatment's error) the cheapest is rk4 with "
           "projection, which takes 2 ms of CPU time at h = 0.0002 s; cvode is next with 3 ms.");
    row_is("swing, 1 mm", "holds",
           "Within 1 mm on swing (with its treatment's error) the cheapest is cvode with "
           "generalised, which takes 3 ms of CPU time at rtol 0.001; rk4 is next with 5 ms.");
    row_is("swing, 0.1 mm", "not reached",
           "No run on swing is within 0.1 mm (with its treatment's error).");
    row_is("swing, choice of method", "does not hold",
           "On swing explicit Euler with projection at 10000 Hz is the right method: rk4 errs no "
           "more (0.5 mm) and takes 2 ms against 8 ms.");
    row_is("swing, choice of treatment", "does not hold",
           "On swing projection itself errs no more than the method: it is 4.5 mm from the exact "
           "constrained motion, 9 times the method's error.");
    row_is("swing, failures of euler", "holds",
           "On swing euler fails at 1 of 3 settings (diverged), and at none from h = 0.1 ms on.");
    row_is("swing, no failures", "holds", "On swing these methods never fail: rk4, cvode.");
    row_is("swing, settings", "holds",
           "On swing 5 settings finish, 1 fail, and 0 are refused or left out.");
    row_is("swing, smallest error", "holds",
           "The smallest error on swing is that of euler, 0.05 mm.");
    row_is("10 mm", "holds", "Within 10 mm rk4 is the cheapest on 1 of 1 scenes.");
    row_is("0.1 mm", "not reached", "No run on any scene is within 0.1 mm.");
    row_is(
        "choice of the method", "does not hold",
        "No method is as accurate as explicit Euler with projection at 9000 Hz and cheaper: of 1 "
        "scenes tried, one is on 1.");
}

/* A winner is named only where its times and those of the next are apart, and by more than a
 * machine drifts. */
Test(race, a_winner_is_beyond_both_spreads) {
    prepare(&p);
    p.points[0][3].cost.cpu.greatest = 3.1e-3; /* rk4's times reach cvode's */
    p.points[1][0].cost.counted = 4e-3;        /* and by counts not clearly costlier */
    state(&p);
    row_is("swing, 10 mm", "holds",
           "Within 10 mm on swing (with its treatment's error) the cheapest are rk4 (2 ms of CPU "
           "time) and cvode (3 ms), too close to tell apart.");
    row_is("swing, 1 mm", "holds",
           "Within 1 mm on swing (with its treatment's error) the cheapest are cvode (3 ms of CPU "
           "time) and rk4 (5 ms), too close to tell apart.");
    row_is("10 mm", "holds", "Within 10 mm rk4 and cvode are among the cheapest on 1 of 1 scenes.");
}

/* A title that names ten methods is read by nobody. */
Test(race, of_many_rivals_the_first_are_named) {
    static const char *const texts[] = {"",
                                        " and a (1 ms)",
                                        ", a (1 ms) and b (2 ms)",
                                        ", a (1 ms), b (2 ms) and c (3 ms)",
                                        ", a (1 ms), b (2 ms), c (3 ms) and d (4 ms)",
                                        ", a (1 ms), b (2 ms), c (3 ms) and 2 more"};
    for (int count = 0; count < 6; count++) {
        struct rival rivals[] = {
            {"e", 5, 5e-3}, {"d", 4, 4e-3}, {"c", 3, 3e-3}, {"b", 2, 2e-3}, {"a", 1, 1e-3}};
        char text[512];
        list_rivals(text, rivals + 5 - count, count);
        cr_expect_str_eq(text, texts[count]);
    }
}

/* Times that a busy machine has measured put nobody in another order: they can only leave open who
 * wins. */
Test(race, a_busy_machine_makes_no_winner) {
    prepare(&p);
    p.points[0][3].cost.cpu = (struct spread){4e-3, 3.9e-3, 4.1e-3}; /* rk4, and cvode took 3 */
    state(&p);
    row_is("swing, 10 mm", "holds",
           "Within 10 mm on swing (with its treatment's error) the cheapest are rk4 (4 ms of CPU "
           "time) and cvode (3 ms), too close to tell apart.");
}

/* How good a run is that comes near the reference's bound nobody knows: it beats nobody. */
Test(race, who_is_limited_keeps_nobody_off_the_front) {
    prepare(&p);
    struct field *field = &p.fields[0];
    struct point *best = &p.points[0][3], *beaten = &p.points[0][1];
    race_mark_fronts(field);
    cr_expect(best->front[0] && !beaten->front[0], "rk4 is cheaper and better than Euler");
    best->reference_limited = 1;
    race_mark_fronts(field);
    cr_expect(!best->front[0] && beaten->front[0]);
}

/* What is left out is said to be costlier than all that was run: it may still reach what none has.
 */
Test(race, what_is_left_out_is_said_with_what_it_could_have_won) {
    prepare(&p);
    snprintf(p.entries[0][RK4].left_out, sizeof p.entries[0][RK4].left_out, "this and shorter");
    state(&p);
    row_is("swing, left out", "not reached",
           "On swing the settings of 1 method end where runs are predicted to cost more than any "
           "that was made, and could not have been the cheapest within an error that was reached; "
           "they could have been within 0.1 mm.");
}

/* Other numbers, other verdicts. */
Test(race, verdicts_turn_with_the_points) {
    prepare(&p);
    p.points[0][3].cost.counted = 8e-3; /* rk4 is no cheaper */
    p.fields[0].treatment_error = 5e-4; /* and projection no worse than Euler */
    state(&p);
    row_is("swing, choice of method", "holds",
           "On swing explicit Euler with projection at 10000 Hz is the right method: no run is as "
           "accurate (0.5 mm) and clearly cheaper (8 ms).");
    row_is("swing, choice of treatment", "holds",
           "On swing projection itself errs no more than the method: it is 0.5 mm from the exact "
           "constrained motion, 1 times the method's error.");
    p.points[0][1].status = "not finite";
    p.points[0][1].failed = 1;
    state(&p);
    row_is("swing, choice of method", "does not hold",
           "On swing explicit Euler with projection at 10000 Hz is the right method: it ends 'not "
           "finite'.");
    row_is("swing, failures of euler", "holds",
           "On swing euler fails at 2 of 3 settings (diverged, not finite), and at none from h = "
           "0.01 ms on.");
    p.points[0][1].setting = 1.3e-4; /* 7692 Hz is not the thesis's rate */
    state(&p);
    row_is("swing, choice", "not reached",
           "On swing explicit Euler with projection at 9000 Hz is the right method: it has no run "
           "near that rate.");
    p.configurations[EULER].name = "midpoint";
    state(&p);
    row_is("swing, choice", "not asked",
           "On swing explicit Euler with projection at 9000 Hz is the right method: it was not "
           "asked for.");
}
