/* How far does each method carry a particle off its circle? The thesis's section 2.3.3: figures
 * 2.4 and 2.5, and what they do not show: error against time and against cost. */
#include "model/circle.h"

#include "base/files.h"
#include "base/table.h"
#include "captions.h"
#include "experiments/common/measure.h"

#include <complex.h>
#include <math.h>
#include <string.h>

static const double ends[] = {30, 160}; /* s: the thesis's two snapshots */

/* The panels of figures 2.4 and 2.5 in their order, then a run of which the text speaks; with the
 * position errors and the last radius that these must have (worked out by hand from the discrete
 * solutions; m). */
static const struct panel {
    const char *stepper, *treatment, *title;
    double step;
    double error_30, error_160, radius_160;
    const char *statement;
} panels[] = {
    {"euler", "free", "explicit Euler", 0.8, 0.71150, 19.374, 20.211,
     "leaves the circle very fast"},
    {"midpoint", "free", "midpoint", 1.6, 0.12598, 0.72774, 1.09858,
     "much better than Euler at equal cost"},
    {"rk4", "free", "Runge-Kutta 4", 3.2, 0.01218, 0.06646, 0.86290,
     "strays little in 160 s, but lags in phase"},
    {"implicit-euler", "free", "implicit Euler", 0.8, 0.39854, 0.86272, 0.04008,
     "a little better than explicit Euler"},
    {"euler", "projection", "explicit Euler, projected", 0.8, 0.06141, 0.32901, 0.9,
     "stays on the circle, drifts in phase"},
    {"euler", "generalised", "explicit Euler, angle", 0.8, 0, 0, 0.9, "exact"},
    {"euler", "free", "explicit Euler, fine", 0.0125, 0.00837, 0.04556, 0.94556,
     "at 0.0125 s comparable with Runge-Kutta 4 at 3.2 s"},
};
enum { PANELS = sizeof panels / sizeof *panels, DRAWN_PANELS = 6 };

/* --- the runs --- */

static int plan_panels(struct plan *plan) {
    for (int e = 0; e < 2; e++) {
        char duration[32];
        snprintf(duration, sizeof duration, "duration=%g", ends[e]);
        const struct scene *scene = plan_scene(plan, "circle", (const char *[]){duration}, 1);
        if (!scene)
            return -1;
        for (int i = 0; i < PANELS; i++) {
            const struct panel *panel = &panels[i];
            const struct run_request request = {
                .stepper = panel->stepper, .treatment = panel->treatment, .step = panel->step};
            if (plan_wants(plan, panel->stepper) &&
                plan_add(plan, scene, &request, e ? "160 s" : "30 s", "%d", i))
                return -1;
        }
    }
    return 0;
}

/* The step or the tolerance of a contestant's k-th point. Steps divide the 20 s between frames;
 * the coarsest, 20 s, is 0.7 of a turn. */
static double setting(const struct configuration *contestant, int k) {
    return contestant_is_adaptive(contestant) ? pow(10, -2 - k) : ldexp(20, -k);
}

static int points(const struct plan *plan, const struct configuration *contestant) {
    return plan->quick ? 6 : contestant_is_adaptive(contestant) ? 11 : 14;
}

static int plan_work(struct plan *plan) {
    const char *sets[] = {"frame_rate=0.05"};
    const struct scene *scene = plan_scene(plan, "circle", sets, 1);
    if (!scene)
        return -1;
    for (int c = 0; c < plan->configuration_count; c++) {
        const struct configuration *contestant = &plan->configurations[c];
        for (int k = 0; k < points(plan, contestant); k++) {
            struct run_request request = contestant_request(contestant, setting(contestant, k), 1);
            char reason[REASON_SIZE];
            request.timings = 9;
            if (plan_takes(plan, scene, &request, reason) &&
                plan_add(plan, scene, &request, "work", "%d %d", c, k))
                return -1;
        }
    }
    return 0;
}

static int circle_plan(struct plan *plan) {
    if (plan->scene_count > 0) {
        snprintf(plan->reason, REASON_SIZE,
                 "experiment circle has a scene of its own; leave out --scene");
        return -1;
    }
    return plan_configurations(
               plan, CONFIGURATION_PLAIN | CONFIGURATION_ITERATED | CONFIGURATION_FORMULA, 0) ||
                   plan_panels(plan) || plan_work(plan)
               ? -1
               : 0;
}

/* --- reading the runs --- */

static double position_error(const struct table *states, int row) {
    double exact[2];
    circle_exact(table_value(states, row, 0), exact);
    return hypot(table_value(states, row, table_column(states, "x")) - exact[0],
                 table_value(states, row, table_column(states, "y")) - exact[1]);
}

static double radius(const struct table *states, int row) {
    return hypot(table_value(states, row, table_column(states, "x")),
                 table_value(states, row, table_column(states, "y")));
}

/* A table of the plan's, whose scene is that of its first run. */
static int open_circle_table(struct atomic_file *file, struct plan *plan, const char *folder,
                             const char *name, const char *what, const char *columns) {
    return open_table(file, folder, name, what, plan->case_count ? plan->cases[0].run.scene : NULL,
                      columns, plan->reason);
}

/* Calls `row` for each panel's run of a group with its files. */
static int each_panel(struct plan *plan, const char *group, FILE *stream,
                      void (*row)(FILE *stream, int panel, const struct run_files *run)) {
    for (int i = 0; i < PANELS; i++) {
        char label[16];
        struct run_files run;
        snprintf(label, sizeof label, "%d", i);
        const struct labelled_case *found = find_case(plan, group, label);
        if (!found)
            continue;
        if (run_read(&run, found->run.folder, plan->reason))
            return -1;
        row(stream, i, &run);
        run_free(&run);
    }
    return 0;
}

/* --- figures 2.4 and 2.5, error against time --- */

static void orbit_rows(FILE *stream, int panel, const struct run_files *run) {
    const struct table *states = &run->states;
    const int x = table_column(states, "x"), y = table_column(states, "y");
    const double evaluations = run_number(run, "counters.force_evaluations");
    for (int i = 0; i < states->row_count; i++)
        fprintf(stream, "%d\t%s\t%s\t%g\t%.17g\t%.17g\t%.17g\t%.17g\t%.17g\n", panel + 1,
                panels[panel].title, panels[panel].stepper, panels[panel].step,
                table_value(states, i, 0), table_value(states, i, x), table_value(states, i, y),
                position_error(states, i), evaluations);
    fprintf(stream, "\n\n");
}

static int write_orbits(struct plan *plan, const char *folder) {
    for (int e = 0; e < 2; e++) {
        struct atomic_file file;
        const char *group = e ? "160 s" : "30 s";
        if (open_circle_table(
                &file, plan, folder, e ? "orbits-160s" : "orbits-30s",
                "trajectories, one block for each panel: s, m; error: distance from the exact "
                "position, m; force_evaluations: of the whole run",
                "panel\ttitle\tstepper\tstep\tt\tx\ty\terror\tforce_evaluations"))
            return -1;
        if (each_panel(plan, group, file.stream, orbit_rows)) {
            atomic_discard(&file);
            return -1;
        }
        if (atomic_commit(&file, plan->reason))
            return -1;
    }
    return 0;
}

/* --- the table --- */

struct panel_errors {
    double error[2], radius;
    long long evaluations;
    int there;
};

static int read_panels(struct plan *plan, struct panel_errors errors[PANELS]) {
    memset(errors, 0, PANELS * sizeof *errors);
    for (int i = 0; i < PANELS; i++) {
        char label[16];
        snprintf(label, sizeof label, "%d", i);
        for (int e = 0; e < 2; e++) {
            struct run_files run;
            const struct labelled_case *found = find_case(plan, e ? "160 s" : "30 s", label);
            if (!found)
                continue;
            if (run_read(&run, found->run.folder, plan->reason))
                return -1;
            const int last = run.states.row_count - 1;
            errors[i].there = 1;
            errors[i].error[e] = position_error(&run.states, last);
            errors[i].radius = radius(&run.states, last);
            errors[i].evaluations = (long long)run_number(&run, "counters.force_evaluations");
            run_free(&run);
        }
    }
    return 0;
}

static int write_panel_table(struct plan *plan, const char *folder) {
    struct panel_errors errors[PANELS];
    struct atomic_file file;
    if (read_panels(plan, errors) ||
        open_circle_table(
            &file, plan, folder, "table",
            "position errors, m, beside the expected ones and the thesis's words",
            "method\ttreatment\tstep\terror_30s\texpected_30s\terror_160s\texpected_160s\t"
            "radius_160s\texpected_radius\tforce_evaluations\tthesis"))
        return -1;
    printf("  %-26s %8s %10s %10s %10s   %s\n", "method", "step s", "30 s: m", "160 s: m",
           "radius m", "the thesis says");
    for (int i = 0; i < PANELS; i++) {
        const struct panel *p = &panels[i];
        const struct panel_errors *e = &errors[i];
        if (!e->there)
            continue;
        fprintf(file.stream, "%s\t%s\t%g\t%.17g\t%g\t%.17g\t%g\t%.17g\t%g\t%lld\t%s\n", p->stepper,
                p->treatment, p->step, e->error[0], p->error_30, e->error[1], p->error_160,
                e->radius, p->radius_160, e->evaluations, p->statement);
        printf("  %-26s %8g %10.5f %10.5f %10.5f   %s\n", p->title, p->step, e->error[0],
               e->error[1], e->radius, p->statement);
    }
    return atomic_commit(&file, plan->reason);
}

/* --- error against cost, and the radius that the stability function foretells --- */

struct point {
    int contestant, k;
    double setting, error, last_radius;
    struct cost cost;
};

static struct point read_point(const struct plan *plan, const struct labelled_case *labelled,
                               const struct run_files *run) {
    struct point p = {.error = NAN, .last_radius = NAN, .cost = run_cost(run)};
    sscanf(labelled->label, "%d %d", &p.contestant, &p.k);
    p.setting = setting(&plan->configurations[p.contestant], p.k);
    const struct table *states = &run->states;
    if (run->outcome == FINISHED) {
        p.error = 0;
        for (int i = 0; i < states->row_count; i++)
            p.error = fmax(p.error, position_error(states, i));
        p.last_radius = radius(states, states->row_count - 1);
    }
    return p;
}

/* Points whose error is neither of the circle's size nor of rounding's make the slope. */
static void add_to_slope(struct slope *slope, const struct point *p) {
    if (p->error < 0.05 && p->error > 1e-10)
        slope_add(slope, p->cost.evaluations, p->error);
}

static void write_slope(FILE *stream, const struct configuration *contestant,
                        const struct slope *slope) {
    const struct fit fit = slope_fit(slope, contestant);
    if (fit.points > 0)
        fprintf(stream, "%s\t%s\t%.3f\t%.3f\t%d\n", contestant->name,
                contestant_is_adaptive(contestant) ? "adaptive" : "fixed", fit.slope, fit.spread,
                fit.points);
}

/* |R(-i omega h)|^n, the radius after n steps over the first, where there is a table. */
static double predicted_radius(const struct configuration *contestant, double h, double steps) {
    const struct butcher_table *table = contestant->method->table;
    const double growth = cabs(butcher_stability(table, -I * CIRCLE_RATE * h));
    return CIRCLE_RADIUS * pow(growth, steps);
}

struct work_tables {
    struct atomic_file work, slopes, radius;
};

static int open_work_tables(struct work_tables *tables, struct plan *plan, const char *folder) {
    if (open_circle_table(
            &tables->work, plan, folder, "work-precision",
            "largest position error at the 9 frames of 160 s, m, against force evaluations "
            "and CPU time, s, of 9 repeated runs; setting: step, s, or rtol = atol; nan: "
            "there is no number, see status",
            "method\tstepper\tsetting\terror\tforce_evaluations\tsteps\tcpu_median\tcpu_least\t"
            "cpu_greatest\tstatus\tfailure_time"))
        return -1;
    if (open_circle_table(
            &tables->slopes, plan, folder, "work-precision-slopes",
            "slopes of log error over log evaluations, between 1e-10 and 0.05 m, " SLOPE_RULE,
            "method\tkind\tslope\tspread\tpoints")) {
        atomic_discard(&tables->work);
        return -1;
    }
    if (open_circle_table(
            &tables->radius, plan, folder, "radius",
            "radius after 160 s, m, measured and as |R(-i omega h)|^n foretells it (no "
            "prediction: the method has no stability function)",
            "method\tstepper\tstep\tomega_h\tradius\tpredicted\tsteps")) {
        atomic_discard(&tables->work);
        atomic_discard(&tables->slopes);
        return -1;
    }
    return 0;
}

static void write_point(const struct work_tables *tables, const struct configuration *c,
                        const struct point *p) {
    const struct cost *cost = &p->cost;
    fprintf(tables->work.stream,
            "%s\t%s\t%.17g\t%.17g\t%.17g\t%.17g\t%.17g\t%.17g\t%.17g\t%s\t%.17g\n", c->name,
            c->stepper, p->setting, p->error, cost->evaluations, cost->steps, cost->cpu.median,
            cost->cpu.least, cost->cpu.greatest, outcome_name(cost->outcome), cost->failure_time);
    if (contestant_is_adaptive(c) || cost->outcome != FINISHED)
        return;
    char predicted[32] = "no prediction";
    if (c->method->table)
        snprintf(predicted, sizeof predicted, "%.17g",
                 predicted_radius(c, p->setting, cost->steps));
    fprintf(tables->radius.stream, "%s\t%s\t%.17g\t%.17g\t%.17g\t%s\t%.17g\n", c->name, c->stepper,
            p->setting, CIRCLE_RATE * p->setting, p->last_radius, predicted, cost->steps);
}

/* Rows of one contestant, in the order of its settings; blocks are parted by two blank lines. */
static int write_contestant(struct plan *plan, int c, const struct work_tables *tables) {
    struct slope slope = {.count = 0};
    for (int i = 0; i < plan->case_count; i++) {
        struct run_files run;
        int contestant;
        if (strcmp(plan->cases[i].group, "work") != 0 ||
            sscanf(plan->cases[i].label, "%d", &contestant) != 1 || contestant != c)
            continue;
        if (run_read(&run, plan->cases[i].run.folder, plan->reason))
            return -1;
        const struct point point = read_point(plan, &plan->cases[i], &run);
        write_point(tables, &plan->configurations[c], &point);
        add_to_slope(&slope, &point);
        run_free(&run);
    }
    write_slope(tables->slopes.stream, &plan->configurations[c], &slope);
    fprintf(tables->work.stream, "\n\n");
    fprintf(tables->radius.stream, "\n\n");
    return 0;
}

static int write_work(struct plan *plan, const char *folder) {
    struct work_tables tables;
    int code = 0;
    if (open_work_tables(&tables, plan, folder))
        return -1;
    for (int c = 0; c < plan->configuration_count && !code; c++)
        code = write_contestant(plan, c, &tables);
    struct atomic_file *const files[] = {&tables.work, &tables.slopes, &tables.radius};
    for (int i = 0; i < 3; i++) {
        if (code)
            atomic_discard(files[i]);
        else
            code = atomic_commit(files[i], plan->reason);
    }
    return code;
}

/* The prediction as a curve: radius after 160 s with steps of h, for every method with a table. */
static int write_prediction(struct plan *plan, const char *folder) {
    struct atomic_file file;
    if (open_circle_table(&file, plan, folder, "radius-predicted",
                          "0.9 |R(-i omega h)|^(160 s / h), m, from the stability function",
                          "method\tstepper\tstep\tradius"))
        return -1;
    for (int c = 0; c < plan->configuration_count; c++) {
        const struct configuration *contestant = &plan->configurations[c];
        if (!contestant->method->table || contestant->kind != CONFIGURATION_PLAIN)
            continue;
        for (int k = 0; k <= 400; k++) {
            const double h = 2e-3 * pow(1e4, k / 400.);
            fprintf(file.stream, "%s\t%s\t%.17g\t%.17g\n", contestant->name, contestant->stepper, h,
                    predicted_radius(contestant, h, 160 / h));
        }
        fprintf(file.stream, "\n\n");
    }
    return atomic_commit(&file, plan->reason);
}

static int circle_tabulate(struct plan *plan, const char *folder) {
    return write_orbits(plan, folder) || write_panel_table(plan, folder) ||
                   write_work(plan, folder) || write_prediction(plan, folder)
               ? -1
               : 0;
}

const struct experiment circle_experiment = {
    .name = "circle",
    .question =
        "how far does each method carry a particle off its circle? (thesis, figures 2.4 and 2.5)",
    .plan = circle_plan,
    .tabulate = circle_tabulate,
    .caption = caption_circle,
};
