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

const struct scene *circle_table_scene(const struct plan *plan) {
    return plan->case_count ? plan->cases[0].run.scene : NULL;
}

/* Reads a panel's run up to an end. Returns 1, or 0 where there is none, or -1 with plan->reason.
 */
static int read_panel(struct plan *plan, int panel, int end, struct run_files *run) {
    const struct labelled_case *found = find_case(plan, end ? "160 s" : "30 s", "%d", panel);
    return !found ? 0 : plan_read(plan, found, run) ? -1 : 1;
}

/* --- figures 2.4 and 2.5, error against time --- */

#define ORBIT_COLUMNS(X)                                                            \
    X("panel", "1", "number of the panel", "%d", panel + 1)                         \
    X("title", "-", "title of the panel", "%s", panels[panel].title)                \
    X("stepper", "-", "stepper of the panel", "%s", panels[panel].stepper)          \
    X("step", "s", "length of a step", "%g", panels[panel].step)                    \
    X("t", "s", "time", "%.17g", row[STATE_T])                                      \
    X("x", "m", "position", "%.17g", row[STATE_X])                                  \
    X("y", "m", "position", "%.17g", row[STATE_X + 1])                              \
    X("error", "m", "distance from the exact position", "%.17g", circle_error(row)) \
    X("force_evaluations", "1", "evaluations of the forces in the run", "%.17g", evaluations)

static void orbit_rows(FILE *stream, int panel, const struct run_files *run) {
    const double evaluations = run_number(run, "counters.force_evaluations");
    for (int i = 0; i < run->states->table.row_count; i++) {
        const double *row = trajectory_row(run->states, i);
        WRITE_ROW(stream, ORBIT_COLUMNS);
    }
    fprintf(stream, "\n\n");
}

static int write_orbits(struct plan *plan) {
    for (int e = 0; e < 2; e++) {
        FILE *stream =
            output_table(&plan->output, e ? "orbits-160s" : "orbits-30s",
                         "trajectories, one block for each panel: s, m; error: distance from the "
                         "exact position, m; force_evaluations: of the whole run",
                         circle_table_scene(plan), COLUMNS(ORBIT_COLUMNS));
        if (!stream)
            return -1;
        for (int i = 0; i < PANELS; i++) {
            struct run_files run;
            const int there = read_panel(plan, i, e, &run);
            if (there < 0)
                return -1;
            if (!there)
                continue;
            orbit_rows(stream, i, &run);
            run_free(&run);
        }
    }
    return 0;
}

/* --- the table --- */

struct panel_errors {
    double error[2], radius, speed; /* m; the last, m and m/s */
    long long evaluations;
    int there, finished;
};

static int read_panels(struct plan *plan, struct panel_errors errors[PANELS]) {
    memset(errors, 0, PANELS * sizeof *errors);
    for (int i = 0; i < PANELS; i++)
        for (int e = 0; e < 2; e++) {
            struct run_files run;
            const int there = read_panel(plan, i, e, &run);
            if (there < 0)
                return -1;
            if (!there)
                continue;
            const double *last = trajectory_row(run.states, run.states->table.row_count - 1);
            errors[i].finished = run.outcome == FINISHED && (e == 0 || errors[i].finished);
            errors[i].there = 1;
            errors[i].error[e] = circle_error(last);
            errors[i].radius = circle_radius(last);
            errors[i].speed = hypot(last[STATE_VX], last[STATE_VX + 1]);
            errors[i].evaluations = (long long)run_number(&run, "counters.force_evaluations");
            run_free(&run);
        }
    return 0;
}

#define PANEL_COLUMNS(X)                                                                       \
    X("method", "-", "the panel's stepper", "%s", p->stepper)                                  \
    X("treatment", "-", "how the particle is kept on the circle", "%s", p->treatment)          \
    X("step", "s", "length of a step", "%g", p->step)                                          \
    X("error_30s", "m", "distance from the exact position after 30 s", "%.17g", e->error[0])   \
    X("expected_30s", "m", "error after 30 s, worked out by hand", "%g", p->error_30)          \
    X("error_160s", "m", "distance from the exact position after 160 s", "%.17g", e->error[1]) \
    X("expected_160s", "m", "error after 160 s, worked out by hand", "%g", p->error_160)       \
    X("radius_160s", "m", "distance from the centre after 160 s", "%.17g", e->radius)          \
    X("expected_radius", "m", "radius after 160 s, worked out by hand", "%g", p->radius_160)   \
    X("force_evaluations", "1", "evaluations of the forces in 160 s", "%lld", e->evaluations)

static int write_panel_table(struct plan *plan, const struct panel_errors errors[PANELS]) {
    FILE *stream =
        output_table(&plan->output, "table", "position errors, m, beside the expected ones",
                     circle_table_scene(plan), COLUMNS(PANEL_COLUMNS));
    if (!stream)
        return -1;
    for (int i = 0; i < PANELS; i++) {
        const struct panel *p = &panels[i];
        const struct panel_errors *e = &errors[i];
        if (e->there)
            WRITE_ROW(stream, PANEL_COLUMNS);
    }
    return 0;
}

/* --- what the thesis says of them (section 2.3.3) --- */

/* A claim on one panel beside another, or itself, after 30 or after 160 s. */
enum { AFTER_30, AFTER_160 };
struct claim {
    const char *key; /* NULL: the panel's title */
    int panel, other, end, shown;
    double value;
    const char *unit;
};

/* Adds it (printf). */
__attribute__((format(printf, 4, 5))) static void state_claim(struct statements *statements,
                                                              const struct panel_errors *errors,
                                                              struct claim claim,
                                                              const char *sentence, ...) {
    const char *title = panels[claim.panel].title;
    struct statement row = thesis_row(claim.end == AFTER_30 ? "orbits-30s" : "orbits-160s", "table",
                                      holds_if(claim.shown), claim.value, claim.unit, "%s",
                                      claim.key ? claim.key : title);
    char text[400];
    va_list arguments;
    va_start(arguments, sentence);
    vsnprintf(text, sizeof text, sentence, arguments);
    va_end(arguments);
    const struct panel_errors *one = &errors[claim.panel], *other = &errors[claim.other];
    const int asked = one->there && other->there;
    if (asked && one->finished && other->finished) {
        statements_add(statements, row, "%s", text);
        return;
    }
    row.verdict = asked ? NOT_REACHED : NOT_ASKED;
    row.unit = NULL;
    statements_add(statements, row, "What the thesis says of %s cannot be checked (%s): %s.", title,
                   row.key, asked ? "a run ended before 160 s" : "a method was left out");
}

static void state_euler(struct statements *statements, const struct panel_errors *e) {
    const double shorter = panels[EULER].step / panels[FINE].step;
    state_claim(statements, e,
                (struct claim){NULL, EULER, EULER, AFTER_160, e[EULER].radius > 2 * CIRCLE_RADIUS,
                               e[EULER].radius, "m"},
                "Explicit Euler leaves the circle of %.1f m very fast: after 160 s it is %.3g m "
                "from the centre.",
                CIRCLE_RADIUS, e[EULER].radius);
    state_claim(statements, e,
                (struct claim){"explicit Euler, shorter steps", FINE, EULER, AFTER_160,
                               e[FINE].error[1] < e[EULER].error[1] / shorter, e[FINE].error[1],
                               "m"},
                "Explicit Euler's error gets as small as its step: with steps %.0f times as short "
                "it is %.3g m off after 160 s, and not %.3g m.",
                shorter, e[FINE].error[1], e[EULER].error[1]);
    state_claim(statements, e,
                (struct claim){NULL, FINE, RK4, AFTER_160,
                               e[FINE].error[1] < 2 * e[RK4].error[1] &&
                                   e[FINE].error[1] > 0.5 * e[RK4].error[1],
                               e[FINE].error[1], "m"},
                "Explicit Euler at 0.0125 s compares with Runge-Kutta 4 at 3.2 s: it is %.3g m off "
                "after 160 s, Runge-Kutta 4 %.3g m.",
                e[FINE].error[1], e[RK4].error[1]);
}

/* Its way behind the particle's place, as an angle: the error is a chord between two radii. */
static double angle_behind(const struct panel_errors *e) {
    const double off = e->radius - CIRCLE_RADIUS;
    return sqrt(fmax(0, e->error[1] * e->error[1] - off * off) / (e->radius * CIRCLE_RADIUS));
}

static void state_higher_orders(struct statements *statements, const struct panel_errors *e) {
    const double off = fabs(e[RK4].radius - CIRCLE_RADIUS), behind = angle_behind(&e[RK4]);
    state_claim(statements, e,
                (struct claim){NULL, MIDPOINT, EULER, AFTER_160,
                               e[MIDPOINT].error[1] < 0.1 * e[EULER].error[1], e[MIDPOINT].error[1],
                               "m"},
                "Midpoint is much better than explicit Euler at equal cost: it is %.3g m off after "
                "160 s, Euler %.3g m.",
                e[MIDPOINT].error[1], e[EULER].error[1]);
    state_claim(statements, e,
                (struct claim){"midpoint, less precise", MIDPOINT, RK4, AFTER_160,
                               e[MIDPOINT].error[1] > e[RK4].error[1],
                               e[MIDPOINT].error[1] / e[RK4].error[1], "1"},
                "Midpoint is less precise than Runge-Kutta 4: it is %.3g m off after 160 s, "
                "Runge-Kutta 4 %.3g m.",
                e[MIDPOINT].error[1], e[RK4].error[1]);
    state_claim(statements, e,
                (struct claim){NULL, RK4, RK4, AFTER_160, off < 0.1 * CIRCLE_RADIUS, off, "m"},
                "Runge-Kutta 4 strays but little from the circle: after 160 s it is %.3g m off it.",
                off);
    /* "pas du tout": farther off than what the thesis calls a visible gap in another panel */
    state_claim(
        statements, e,
        (struct claim){"Runge-Kutta 4, not at all", RK4, PROJECTED, AFTER_160,
                       e[RK4].error[1] >= e[PROJECTED].error[1], e[RK4].error[1], "m"},
        "Runge-Kutta 4 is not at all where the particle should be: after 160 s it is %.3g m off, "
        "and explicit Euler with projection, whose gap the thesis calls visible, %.3g m.",
        e[RK4].error[1], e[PROJECTED].error[1]);
    state_claim(
        statements, e,
        (struct claim){"Runge-Kutta 4, speed", RK4, RK4, AFTER_160, behind > 0.01, behind, "rad"},
        "Runge-Kutta 4 goes round at another speed: in 160 s it is %.2g rad of %.3g off, %.2g %%.",
        behind, 160 * CIRCLE_RATE, 100 * behind / (160 * CIRCLE_RATE));
}

static void state_implicit(struct statements *statements, const struct panel_errors *e) {
    state_claim(statements, e,
                (struct claim){NULL, IMPLICIT, EULER, AFTER_30,
                               e[IMPLICIT].error[0] < e[EULER].error[0] &&
                                   e[IMPLICIT].error[0] > 0.1 * e[EULER].error[0],
                               e[IMPLICIT].error[0], "m"},
                "Implicit Euler is a little better than explicit Euler: it is %.3g m off after 30 "
                "s, explicit Euler %.3g m.",
                e[IMPLICIT].error[0], e[EULER].error[0]);
    state_claim(statements, e,
                (struct claim){"implicit Euler, far off", IMPLICIT, IMPLICIT, AFTER_160,
                               e[IMPLICIT].error[1] > 0.5 * CIRCLE_RADIUS, e[IMPLICIT].error[1],
                               "m"},
                "Implicit Euler strays far from the solution: it is %.3g m off after 160 s, and "
                "%.3g m from the centre.",
                e[IMPLICIT].error[1], e[IMPLICIT].radius);
}

static void state_constrained(struct statements *statements, const struct panel_errors *e) {
    state_claim(statements, e,
                (struct claim){NULL, PROJECTED, PROJECTED, AFTER_160,
                               fabs(e[PROJECTED].radius - CIRCLE_RADIUS) < 1e-9 &&
                                   fabs(e[PROJECTED].speed - CIRCLE_SPEED) < 1e-9,
                               e[PROJECTED].radius, "m"},
                "Explicit Euler with projection looks right: after 160 s the particle is on the "
                "circle, %.3g m from its centre, at %.3g m/s.",
                e[PROJECTED].radius, e[PROJECTED].speed);
    state_claim(statements, e,
                (struct claim){"explicit Euler, projected, gap", PROJECTED, PROJECTED, AFTER_160,
                               e[PROJECTED].error[1] > 0.1, e[PROJECTED].error[1], "m"},
                "Explicit Euler with projection, after the step and not in it, is visibly off its "
                "place: after 160 s it is %.3g m off.",
                e[PROJECTED].error[1]);
    state_claim(
        statements, e,
        (struct claim){NULL, ANGLE, ANGLE, AFTER_160, e[ANGLE].error[1] < 1e-9, e[ANGLE].error[1],
                       "m"},
        "Explicit Euler in the angle is exact: after 160 s it is off by no more than %.1g m.",
        fmax(e[ANGLE].error[1], 1e-15));
}

/* Who of the panels is nearest after a time, and who farthest. */
static void state_distances(struct statements *statements, const struct panel_errors *errors,
                            int end, const char *figure) {
    int near = -1, far = -1, there = 0;
    for (int i = 0; i < PANELS; i++) {
        there += errors[i].there;
        if (!errors[i].finished)
            continue;
        if (near < 0 || errors[i].error[end] < errors[near].error[end])
            near = i;
        if (far < 0 || errors[i].error[end] > errors[far].error[end])
            far = i;
    }
    const struct statement row =
        our_row(figure, end ? "table orbits-160s" : "table",
                near >= 0 ? HOLDS
                : there   ? NOT_REACHED
                          : NOT_ASKED,
                near < 0 ? NAN : errors[far].error[end], "m", "distances at %g s", ends[end]);
    char distance[48] = "with no error but rounding";
    if (near >= 0 && errors[near].error[end] > 1e-12)
        snprintf(distance, sizeof distance, "%.2g m from it", errors[near].error[end]);
    if (near < 0)
        statements_add(statements, row, "None of the figure's runs %s.",
                       there ? "reached its end" : "was asked for");
    else
        statements_add(
            statements, row,
            "After %g s the particle should be where '%s' has it, %s, and '%s' has it %.3g m away.",
            ends[end], panels[near].title, distance, panels[far].title, errors[far].error[end]);
}

int circle_tabulate_panels(struct plan *plan) {
    struct statements *statements = &plan->output.statements;
    struct panel_errors errors[PANELS];
    if (write_orbits(plan) || read_panels(plan, errors) || write_panel_table(plan, errors))
        return -1;
    state_euler(statements, errors);
    state_higher_orders(statements, errors);
    state_implicit(statements, errors);
    state_constrained(statements, errors);
    state_distances(statements, errors, 0, "orbits-30s");
    state_distances(statements, errors, 1, "error-time");
    return 0;
}
