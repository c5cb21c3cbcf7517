/* tests/accuracy.tsv: what every stepper achieved when the table was last updated. */
#include "build_info.h"
#include "model/problems.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char header[] =
    "# Errors and costs of every stepper. setting: step, s, or rtol = atol.\n"
    "# circle: to 160 s, a frame every 20 s. error: distance from the exact position at 160 s, m;\n"
    "# max_error: in all frames; x, y: the last position, m.\n"
    "# swing, swing-envelope: to 0.2 s. error: rms distance of the free nodes at 0.2 s from those\n"
    "# of `reference` with rtol 1e-13, m; max_error: the largest in all frames; x, y: of the tip.\n"
    "# swing-rigid, swing-envelope-rigid: the same with rigid segments.\n"
    "# radii to 0.1 s, wind and shake to 0.012 s: the same, with contacts counted; rtol 1e-11.\n"
    "# swing-pushed: swing-envelope to 0.2 s, onto a ball that pushes by penalty; rtol 1e-11.\n"
    "# Methods of fixed steps must give x and y again to 1e-13 (where wisps touch, to 1e-10 and\n"
    "# 1 % of contacts) and the counts exactly, but for\n"
    "# those that iterate on wisps. Of these and of others, whose steps change with the\n"
    "# processor's instructions, the errors must stay within a factor 2 and the counts within\n"
    "# 10 %; of methods with a history, which make much of a rounding, within a factor 5 (adams:\n"
    "# 200) and 30 %. What is better than that fails too: look why, and update the table by\n"
    "#   cmake --build build --target update-accuracy\n";

#define RIGID "material.stretch=rigid"
#define BALL                                                                        \
    "body=({ name=\"ball\"; center=[0.15, -0.13, 0.01]; radii=[0.06, 0.05, 0.07]; " \
    "velocity=[0.1, 0.1, 0.0]; friction=20.0; response=\"penalty\"; frequency=60.0; })"

enum { KEY_SIZE = 160, ROWS_MAX = 4096 };

struct row {
    char key[KEY_SIZE]; /* scene, treatment, stepper, option, setting, separated by tabs */
    char status[32];
    long long steps, evaluations, contacts; /* of bodies and of wisps */
    double error, max_error, x, y;
    int exact;                        /* of fixed steps, without iteration */
    double error_factor, count_share; /* else: how far from the table it may be */
};

struct rows {
    int count;
    struct row row[ROWS_MAX];
    const char *treatment;
    const struct scene *scene;
    int touching;             /* whether it has contacts */
    struct lab_run reference; /* of wisps */
};

/* The settings at which a method is measured. */
static const double *rates_of(const struct stepper_method *method, const struct scene *scene) {
    const int wisps = scene->problem == &wisp_problem;
    const int rigid = wisps && scene->wisps->stretch == STRETCH_RIGID;
    static const double circle[2][2] = {{0.8, 0.05}, {1e-4, 1e-7}};
    static const double explicit_steps[] = {1e-4, 2.5e-5}, implicit_steps[] = {1e-3, 2.5e-4},
                        rigid_steps[] = {1 / 300., 1 / 1500.}, tolerances[] = {1e-4, 1e-6};
    const int adaptive = (method->capabilities & STEPPER_ADAPTIVE) != 0;
    return !wisps                                    ? circle[adaptive]
           : adaptive                                ? tolerances
           : rigid                                   ? rigid_steps
           : method->capabilities & STEPPER_IMPLICIT ? implicit_steps
                                                     : explicit_steps;
}

/* How far a run may be from the table. Methods with a history: 25 runs that differ in the eleventh
 * digit of the tolerance have errors within a factor 3.7 of each other, and counts within 28 %; of
 * Adams on the circle, where errors of the phase cancel for some time, within a factor 176. */
static void set_bands(struct row *row, const struct variant *variant) {
    const int adams = variant->option && strcmp(variant->option, "method=adams") == 0;
    const int history = variant->method->reset != NULL;
    row->error_factor = adams ? 200 : history ? 5 : 2;
    row->count_share = history ? 0.3 : 0.1;
}

static void measure_circle(const struct rows *rows, const struct run_request *request,
                           struct row *row) {
    struct orbit orbit;
    run_circle(rows->scene, request, &orbit);
    snprintf(row->status, sizeof row->status, "%s", outcome_name(orbit.result.outcome));
    row->steps = orbit.result.counters.steps;
    row->evaluations = orbit.result.counters.force_evaluations;
    row->error = orbit.error;
    row->max_error = orbit.max_error;
    row->x = orbit.x;
    row->y = orbit.y;
}

static void measure_wisps(const struct rows *rows, const struct run_request *request,
                          struct row *row) {
    struct lab_run run;
    lab_run(rows->scene, request, &run);
    const double *tip = run.row + (run.frames * run.rows - 1) * run.columns;
    snprintf(row->status, sizeof row->status, "%s", outcome_name(run.result.outcome));
    row->steps = run.result.counters.steps;
    row->evaluations = run.result.counters.force_evaluations;
    row->contacts = run.result.counters.body_contacts + run.result.counters.wisp_contacts;
    if (run.result.outcome == FINISHED) {
        row->error = lab_distance(&run, &rows->reference, run.frames - 1, 2).rms;
        row->max_error = lab_distance(&run, &rows->reference, 1, 2).largest;
        row->x = tip[2];
        row->y = tip[3];
    } else { /* a failure is a row too: it must stay one, of that kind */
        row->error = row->max_error = row->x = row->y = NAN;
    }
}

/* Both settings of a variant with a linear solver, or with the default one. */
static void measure_with(struct rows *rows, const struct variant *variant, const char *linear) {
    const int wisps = rows->scene->problem == &wisp_problem;
    const int adaptive = (variant->method->capabilities & STEPPER_ADAPTIVE) != 0;
    for (int i = 0; i < 2; i++) {
        const double setting = rates_of(variant->method, rows->scene)[i];
        const struct run_request request = {.stepper = variant->method->name,
                                            .treatment = rows->treatment,
                                            .linear = linear,
                                            .step = adaptive ? 0 : setting,
                                            .rtol = adaptive ? setting : 0,
                                            .atol = adaptive ? setting : 0,
                                            .options = &variant->option,
                                            .option_count = variant->option != NULL};
        struct settings settings;
        char reason[REASON_SIZE], option[80] = "-";
        if (settings_resolve(rows->scene, &request, &settings, reason))
            return; /* not supported */
        cr_assert(rows->count < ROWS_MAX, "too many rows");
        struct row *row = &rows->row[rows->count++];
        if (variant->option || linear)
            snprintf(option, sizeof option, "%s%s%s%s", variant->option ? variant->option : "",
                     variant->option && linear ? " " : "", linear ? "linear=" : "",
                     linear ? linear : "");
        snprintf(row->key, sizeof row->key, "%s\t%s\t%s\t%s\t%g", rows->scene->name,
                 rows->treatment, variant->method->name, option, setting);
        const int iterates = linear && (variant->option || strcmp(linear, "direct") != 0);
        row->exact = !adaptive && !iterates;
        set_bands(row, variant);
        (wisps ? measure_wisps : measure_circle)(rows, &request, row);
    }
}

static void measure(const struct variant *variant, void *ctx) {
    struct rows *rows = ctx;
    if (rows->touching && variant->option)
        return; /* their options are told apart by the smooth scenes */
    const int rigid = rows->scene->wisp_count > 0 && rows->scene->wisps->stretch == STRETCH_RIGID;
    const int adams = variant->option && strcmp(variant->option, "method=adams") == 0;
    if (rigid && variant->option && !adams)
        return; /* there is nothing for their other options to do */
    const int implicit = (variant->method->capabilities & STEPPER_SOLVES) != 0;
    if (!implicit || rows->scene->problem != &wisp_problem) {
        measure_with(rows, variant, NULL);
        return;
    }
    const int exact = variant->option && strcmp(variant->option, "jacobian=exact") == 0;
    measure_with(rows, variant, exact ? "klu" : "direct");
    if (!variant->option && !rigid)
        measure_with(rows, variant, "cg");
}

static void measure_scene(struct rows *rows, const struct scene *scene) {
    const int wisps = scene->problem == &wisp_problem;
    rows->scene = scene;
    rows->touching = scene->body_count > 0 || scene->interaction.interpenetration;
    for (int i = 0; scene->problem->treatments[i].name; i++) {
        const struct run_request tight = {.stepper = "reference",
                                          .treatment = scene->problem->treatments[i].name,
                                          .rtol = rows->touching ? 1e-11 : 1e-13,
                                          .atol = rows->touching ? 1e-12 : 1e-14};
        rows->treatment = tight.treatment;
        if (wisps && scene->wisps->samples == 0 && i != WISP_GENERALISED)
            continue; /* treatments are of samples */
        if (wisps)
            lab_run(scene, &tight, &rows->reference);
        each_variant(measure, rows);
    }
}

static void measure_all(struct rows *rows) {
    struct scene *const scenes[] = {
        circle_scene(160, 0.05),
        LAB_LOAD("swing", "duration=0.2"),
        LAB_LOAD("swing-envelope", "duration=0.2"),
        LAB_LOAD("swing", RIGID, "name=swing-rigid", "duration=0.2"),
        LAB_LOAD("swing-envelope", RIGID, "name=swing-envelope-rigid", "duration=0.2"),
        LAB_LOAD("radii", "duration=0.1"),
        LAB_LOAD("wind", "duration=0.012"),
        LAB_LOAD("shake", "duration=0.012"),
        LAB_LOAD("swing-envelope", BALL, "name=swing-pushed", "duration=0.2")};
    rows->count = 0;
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        measure_scene(rows, scenes[i]);
    }
}

static void write_table(const struct rows *rows, const char *path) {
    FILE *file = fopen(path, "w");
    cr_assert(file, "%s cannot be written", path);
    fprintf(
        file,
        "%sscene\ttreatment\tstepper\toption\tsetting\tstatus\tsteps\tforce_evaluations\tcontacts"
        "\terror\tmax_error\tx\ty\n",
        header);
    for (int i = 0; i < rows->count; i++) {
        const struct row *r = &rows->row[i];
        fprintf(file, "%s\t%s\t%lld\t%lld\t%lld\t%.6e\t%.6e\t%.17g\t%.17g\n", r->key, r->status,
                r->steps, r->evaluations, r->contacts, r->error, r->max_error, r->x, r->y);
    }
    fclose(file);
}

static void read_table(struct rows *rows, const char *path) {
    char *text = file_read(path);
    cr_assert(text, "%s is not there", path);
    rows->count = 0;
    for (char *rest = text, *line; (line = strsep(&rest, "\n")) != NULL;) {
        struct row *r = &rows->row[rows->count];
        char *tab = line;
        if (line[0] == '#' || line[0] == '\0' || strncmp(line, "scene\t", 6) == 0)
            continue;
        for (int i = 0; i < 5 && tab; i++)
            tab = strchr(tab + 1, '\t');
        cr_assert(tab && rows->count < ROWS_MAX &&
                      sscanf(tab, "\t%31[^\t]\t%lld\t%lld\t%lld\t%lf\t%lf\t%lf\t%lf", r->status,
                             &r->steps, &r->evaluations, &r->contacts, &r->error, &r->max_error,
                             &r->x, &r->y) == 8,
                  "%s: cannot read '%s'", path, line);
        snprintf(r->key, sizeof r->key, "%.*s", (int)(tab - line), line);
        rows->count++;
    }
}

/* Errors near rounding are noise, which a factor 2 does not describe: 1e-12 is a hundred roundings
 * of each of 160 s. */
static int within_factor(double factor, double now, double then) {
    return now <= factor * then + 1e-12 && now >= then / factor - 1e-12;
}

static int within_share(double share, long long now, long long then) {
    return fabs((double)(now - then)) <= share * (double)then + 1;
}

/* Whether a row is in its band, and else in `why` how it left it. */
static int is_in_band(const struct row *now, const struct row *then, char why[512]) {
    const char *verdict = now->error > then->error ? "worse" : "better";
    const double share = now->exact ? 0.01 : 0.1, digits = then->contacts > 0 ? 1e-10 : 1e-13;
    if (strcmp(now->status, then->status) != 0) {
        snprintf(why, 512, "%s: %s, and was %s", now->key, now->status, then->status);
        return 0;
    }
    if (strcmp(now->status, outcome_name(FINISHED)) != 0)
        return 1;
    if (!within_share(share, now->contacts, then->contacts)) {
        snprintf(why, 512, "%s: %lld contacts, and were %lld", now->key, now->contacts,
                 then->contacts);
        return 0;
    }
    if (now->exact ? now->steps != then->steps || now->evaluations != then->evaluations
                   : !within_share(now->count_share, now->steps, then->steps) ||
                         !within_share(now->count_share, now->evaluations, then->evaluations)) {
        snprintf(why, 512, "%s: %lld steps and %lld evaluations, and were %lld and %lld", now->key,
                 now->steps, now->evaluations, then->steps, then->evaluations);
        return 0;
    }
    if (now->exact && !(fabs(now->x - then->x) <= digits * fmax(1, fabs(then->x)) &&
                        fabs(now->y - then->y) <= digits * fmax(1, fabs(then->y)))) {
        snprintf(why, 512, "%s: ends at (%.17g, %.17g), and did at (%.17g, %.17g): %s", now->key,
                 now->x, now->y, then->x, then->y, verdict);
        return 0;
    }
    if (!now->exact && !(within_factor(now->error_factor, now->error, then->error) &&
                         within_factor(now->error_factor, now->max_error, then->max_error))) {
        snprintf(why, 512, "%s: errors %.2e and %.2e, and were %.2e and %.2e: %s", now->key,
                 now->error, now->max_error, then->error, then->max_error, verdict);
        return 0;
    }
    return 1;
}

static const struct row *row_with(const struct rows *rows, const char *key) {
    for (int i = 0; i < rows->count; i++)
        if (strcmp(rows->row[i].key, key) == 0)
            return &rows->row[i];
    return NULL;
}

/* What is in its band keeps its row: the rest of the differences between two tables is noise of
 * processors and compilers. */
static void keep_what_is_in_band(struct rows *now, const struct rows *then) {
    char why[512];
    for (int i = 0; i < now->count; i++) {
        const struct row *old = row_with(then, now->row[i].key);
        if (old && is_in_band(&now->row[i], old, why))
            now->row[i] = *old;
    }
}

/* Whether the table has rows of the stepper of a row. One that was registered since then has none
 * before the table is updated. */
static int is_known(const struct rows *table, const struct row *row) {
    char stepper[2][KEY_SIZE];
    sscanf(row->key, "%*[^\t]\t%*[^\t]\t%[^\t]", stepper[0]);
    for (int i = 0; i < table->count; i++) {
        sscanf(table->row[i].key, "%*[^\t]\t%*[^\t]\t%[^\t]", stepper[1]);
        if (strcmp(stepper[0], stepper[1]) == 0)
            return 1;
    }
    return 0;
}

Test(accuracy, is_what_the_table_says) {
    static struct rows now, then;
    const char *path = WISPLAB_TESTS_DIR "/accuracy.tsv";
    measure_all(&now);
    read_table(&then, path);
    if (getenv("WISPLAB_UPDATE_ACCURACY")) {
        keep_what_is_in_band(&now, &then);
        write_table(&now, path);
        return;
    }
    int known = 0;
    for (int i = 0; i < now.count; i++) {
        const struct row *old = row_with(&then, now.row[i].key);
        char why[512];
        if (!is_known(&then, &now.row[i]))
            continue;
        known++;
        cr_assert(old, "the table lacks %s; cmake --build build --target update-accuracy",
                  now.row[i].key);
        cr_assert(is_in_band(&now.row[i], old, why),
                  "%s; if that is meant, cmake --build build --target update-accuracy", why);
    }
    cr_assert_eq(known, then.count,
                 "%d rows of the table are of nothing; cmake --build build --target "
                 "update-accuracy",
                 then.count - known);
}

/* An update writes anew what left its band, what is new, and nothing else. */
Test(accuracy, an_update_touches_only_what_left_its_band) {
    static struct rows now, then;
    then.count = 2;
    now.count = 3;
    for (int i = 0; i < 2; i++)
        then.row[i] = (struct row){.status = "finished", .steps = 100, .error = 1, .max_error = 1};
    snprintf(then.row[0].key, KEY_SIZE, "within");
    snprintf(then.row[1].key, KEY_SIZE, "without");
    for (int i = 0; i < 2; i++) {
        now.row[i] = then.row[i];
        now.row[i].error_factor = 2;
        now.row[i].count_share = 0.1;
    }
    now.row[0].error = 1.5;
    now.row[0].steps = 105;
    now.row[1].error = 2.5;
    snprintf(now.row[2].key, KEY_SIZE, "new");
    now.row[2].error = 7;
    keep_what_is_in_band(&now, &then);
    cr_expect_eq(now.row[0].error, 1);
    cr_expect_eq(now.row[0].steps, 100);
    cr_expect_eq(now.row[1].error, 2.5);
    cr_expect_eq(now.row[2].error, 7);
}
