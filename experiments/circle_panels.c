#include "circle_panels.h"

#include "experiments/common/measure.h"
#include "model/circle.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

static const double ends[] = {30, 160}; /* s: the thesis's two snapshots */

/* The panels of figures 2.4 and 2.5 in their order, then a run of which the text speaks; with the
 * position errors and the last radius that these must have (worked out by hand from the discrete
 * solutions; m). */
enum { EULER, MIDPOINT, RK4, IMPLICIT, PROJECTED, ANGLE, FINE, PANELS };
static const struct panel {
    const char *stepper, *treatment, *title;
    double step;
    double error_30, error_160, radius_160;
} panels[PANELS] = {
    [EULER] = {"euler", "free", "explicit Euler", 0.8, 0.71150, 19.374, 20.211},
    [MIDPOINT] = {"midpoint", "free", "midpoint", 1.6, 0.12598, 0.72774, 1.09858},
    [RK4] = {"rk4", "free", "Runge-Kutta 4", 3.2, 0.01218, 0.06646, 0.86290},
    [IMPLICIT] = {"implicit-euler", "free", "implicit Euler", 0.8, 0.39854, 0.86272, 0.04008},
    [PROJECTED] = {"euler", "projection", "explicit Euler, projected", 0.8, 0.06141, 0.32901, 0.9},
    [ANGLE] = {"euler", "generalised", "explicit Euler, angle", 0.8, 0, 0, 0.9},
    [FINE] = {"euler", "free", "explicit Euler, fine", 0.0125, 0.00837, 0.04556, 0.94556},
};

/* --- the runs --- */

int circle_plan_panels(struct plan *plan) {
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

/* --- reading them --- */

double circle_error(const double *row) {
    double exact[2];
    circle_exact(row[STATE_T], exact);
    return hypot(row[STATE_X] - exact[0], row[STATE_X + 1] - exact[1]);
}

double circle_radius(const double *row) {
    return hypot(row[STATE_X], row[STATE_X + 1]);
}

int circle_open_table(struct atomic_file *file, struct plan *plan, const char *folder,
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
        if (run_read_states(&run, found->run.folder, plan->trajectories, plan->reason))
            return -1;
        row(stream, i, &run);
        run_free(&run);
    }
    return 0;
}

/* --- figures 2.4 and 2.5, error against time --- */

static void orbit_rows(FILE *stream, int panel, const struct run_files *run) {
    const double evaluations = run_number(run, "counters.force_evaluations");
    for (int i = 0; i < run->states->table.row_count; i++) {
        const double *row = trajectory_row(run->states, i);
        fprintf(stream, "%d\t%s\t%s\t%g\t%.17g\t%.17g\t%.17g\t%.17g\t%.17g\n", panel + 1,
                panels[panel].title, panels[panel].stepper, panels[panel].step, row[STATE_T],
                row[STATE_X], row[STATE_X + 1], circle_error(row), evaluations);
    }
    fprintf(stream, "\n\n");
}

static int write_orbits(struct plan *plan, const char *folder) {
    for (int e = 0; e < 2; e++) {
        struct atomic_file file;
        const char *group = e ? "160 s" : "30 s";
        if (circle_open_table(
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
    int there, finished;
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
            if (run_read_states(&run, found->run.folder, plan->trajectories, plan->reason))
                return -1;
            const double *last = trajectory_row(run.states, run.states->table.row_count - 1);
            errors[i].finished = run.outcome == FINISHED && (e == 0 || errors[i].finished);
            errors[i].there = 1;
            errors[i].error[e] = circle_error(last);
            errors[i].radius = circle_radius(last);
            errors[i].evaluations = (long long)run_number(&run, "counters.force_evaluations");
            run_free(&run);
        }
    }
    return 0;
}

static int write_panel_table(struct plan *plan, const char *folder,
                             const struct panel_errors errors[PANELS]) {
    struct atomic_file file;
    if (circle_open_table(
            &file, plan, folder, "table", "position errors, m, beside the expected ones",
            "method\ttreatment\tstep\terror_30s\texpected_30s\terror_160s\texpected_160s\t"
            "radius_160s\texpected_radius\tforce_evaluations"))
        return -1;
    for (int i = 0; i < PANELS; i++) {
        const struct panel *p = &panels[i];
        const struct panel_errors *e = &errors[i];
        if (!e->there)
            continue;
        fprintf(file.stream, "%s\t%s\t%g\t%.17g\t%g\t%.17g\t%g\t%.17g\t%g\t%lld\n", p->stepper,
                p->treatment, p->step, e->error[0], p->error_30, e->error[1], p->error_160,
                e->radius, p->radius_160, e->evaluations);
    }
    return atomic_commit(&file, plan->reason);
}

/* --- what the thesis says of them (section 2.3.3) --- */

/* Adds (printf) a claim on one panel beside another, or itself; `value` in m. */
__attribute__((format(printf, 7, 8))) static void
state_claim(struct statements *statements, const struct panel_errors *errors, int panel, int other,
            int shown, double value, const char *sentence, ...) {
    struct statement row = {.key = panels[panel].title,
                            .figure = panel == IMPLICIT ? "orbits-30s" : "orbits-160s",
                            .tables = "table",
                            .by = THESIS,
                            .verdict = holds_if(shown),
                            .value = value,
                            .unit = "m"};
    char text[400];
    va_list arguments;
    va_start(arguments, sentence);
    vsnprintf(text, sizeof text, sentence, arguments);
    va_end(arguments);
    const int asked = errors[panel].there && errors[other].there;
    if (asked && errors[panel].finished && errors[other].finished) {
        statements_add(statements, row, "%s", text);
        return;
    }
    row.verdict = asked ? NOT_REACHED : NOT_ASKED;
    row.unit = NULL;
    statements_add(statements, row, "What the thesis says of %s cannot be checked: %s.",
                   panels[panel].title,
                   asked ? "a run ended before 160 s" : "a method was left out");
}

static void state_claims(struct statements *statements, const struct panel_errors *e) {
    const double off = fabs(e[RK4].radius - CIRCLE_RADIUS);
    state_claim(statements, e, EULER, EULER, e[EULER].radius > 2 * CIRCLE_RADIUS, e[EULER].radius,
                "Explicit Euler leaves the circle of %.1f m very fast: after 160 s it is %.3g m "
                "from its centre.",
                CIRCLE_RADIUS, e[EULER].radius);
    state_claim(statements, e, MIDPOINT, EULER, e[MIDPOINT].error[1] < 0.1 * e[EULER].error[1],
                e[MIDPOINT].error[1],
                "Midpoint is much better than explicit Euler at equal cost: it is %.3g m off after "
                "160 s, Euler %.3g m.",
                e[MIDPOINT].error[1], e[EULER].error[1]);
    state_claim(statements, e, RK4, RK4, off < 0.1 * CIRCLE_RADIUS && e[RK4].error[1] > 1.2 * off,
                e[RK4].error[1],
                "Runge-Kutta 4 strays little in 160 s, but is not where it should be on its way: "
                "%.3g m off the circle, %.3g m off its place.",
                off, e[RK4].error[1]);
    state_claim(statements, e, IMPLICIT, EULER,
                e[IMPLICIT].error[0] < e[EULER].error[0] &&
                    e[IMPLICIT].error[0] > 0.1 * e[EULER].error[0],
                e[IMPLICIT].error[0],
                "Implicit Euler is a little better than explicit Euler: it is %.3g m off after "
                "30 s, explicit Euler %.3g m.",
                e[IMPLICIT].error[0], e[EULER].error[0]);
    state_claim(statements, e, PROJECTED, PROJECTED,
                fabs(e[PROJECTED].radius - CIRCLE_RADIUS) < 1e-9 && e[PROJECTED].error[1] > 0.1,
                e[PROJECTED].error[1],
                "Explicit Euler with projection stays on the circle and is visibly off its place: "
                "by %.3g m after 160 s.",
                e[PROJECTED].error[1]);
    state_claim(statements, e, ANGLE, ANGLE, e[ANGLE].error[1] < 1e-9, e[ANGLE].error[1],
                "Explicit Euler in the angle is exact: it is %.1g m off after 160 s.",
                e[ANGLE].error[1]);
    state_claim(statements, e, FINE, RK4,
                e[FINE].error[1] < 2 * e[RK4].error[1] && e[FINE].error[1] > 0.5 * e[RK4].error[1],
                e[FINE].error[1],
                "Explicit Euler at 0.0125 s compares with Runge-Kutta 4 at 3.2 s: it is %.3g m off "
                "after 160 s, Runge-Kutta 4 %.3g m.",
                e[FINE].error[1], e[RK4].error[1]);
}

/* Who of the panels is nearest after a time, and who farthest. */
static void state_distances(struct statements *statements, const struct panel_errors *errors,
                            int end, const char *figure) {
    int near = -1, far = -1, there = 0;
    char key[32];
    snprintf(key, sizeof key, "distances at %g s", ends[end]);
    for (int i = 0; i < PANELS; i++) {
        there += errors[i].there;
        if (!errors[i].finished)
            continue;
        if (near < 0 || errors[i].error[end] < errors[near].error[end])
            near = i;
        if (far < 0 || errors[i].error[end] > errors[far].error[end])
            far = i;
    }
    struct statement row = {.key = key,
                            .figure = figure,
                            .tables = end ? "table orbits-160s" : "table",
                            .verdict = near >= 0 ? HOLDS
                                       : there   ? NOT_REACHED
                                                 : NOT_ASKED,
                            .value = near < 0 ? NAN : errors[far].error[end],
                            .unit = "m"};
    if (near < 0)
        statements_add(statements, row, "None of the figure's runs %s.",
                       there ? "reached its end" : "was asked for");
    else
        statements_add(statements, row,
                       "After %g s nearest to where the particle should be is '%s', %.2g m away; "
                       "farthest is '%s', %.3g m.",
                       ends[end], panels[near].title, errors[near].error[end], panels[far].title,
                       errors[far].error[end]);
}

int circle_tabulate_panels(struct plan *plan, const char *folder, struct statements *statements) {
    struct panel_errors errors[PANELS];
    if (write_orbits(plan, folder) || read_panels(plan, errors) ||
        write_panel_table(plan, folder, errors))
        return -1;
    state_claims(statements, errors);
    state_distances(statements, errors, 0, "orbits-30s");
    state_distances(statements, errors, 1, "error-time");
    return 0;
}
