/* How far does each method carry a particle off its circle? The thesis's section 2.3.3: figures
 * 2.4 and 2.5, and what they do not show: error against time and against cost. */
#include "model/circle.h"

#include "base/files.h"
#include "base/table.h"
#include "circle_panels.h"
#include "experiments/common/measure.h"
#include "experiments/common/statements.h"

#include <complex.h>
#include <math.h>
#include <string.h>

/* --- the runs --- */

/* The step or the tolerance of a configuration's k-th point. Steps divide the 20 s between frames;
 * the coarsest, 20 s, is 0.7 of a turn. */
static double setting(const struct configuration *configuration, int k) {
    return configuration_is_adaptive(configuration) ? pow(10, -2 - k) : ldexp(20, -k);
}

static int points(const struct plan *plan, const struct configuration *configuration) {
    return plan->quick ? 6 : configuration_is_adaptive(configuration) ? 11 : 14;
}

static int plan_work(struct plan *plan) {
    const char *sets[] = {"frame_rate=0.05"};
    const struct scene *scene = plan_scene(plan, "circle", sets, 1);
    if (!scene)
        return -1;
    for (int c = 0; c < plan->configuration_count; c++) {
        const struct configuration *configuration = &plan->configurations[c];
        for (int k = 0; k < points(plan, configuration); k++) {
            struct run_request request =
                configuration_request(configuration, setting(configuration, k), 1);
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
    const unsigned kinds = CONFIGURATION_PLAIN | CONFIGURATION_ITERATED | CONFIGURATION_FORMULA;
    if (plan_has_no_scenes(plan) || plan_configurations(plan, kinds, 0) || circle_plan_panels(plan))
        return -1;
    return plan_work(plan);
}

/* --- error against cost, and the radius that the stability function predicts --- */

struct point {
    int configuration, k;
    double setting, error, last_radius;
    struct cost cost;
};

static struct point read_point(const struct plan *plan, const struct labelled_case *labelled,
                               const struct run_files *run) {
    struct point p = {.error = NAN, .last_radius = NAN, .cost = run_cost(run)};
    sscanf(labelled->label, "%d %d", &p.configuration, &p.k);
    p.setting = setting(&plan->configurations[p.configuration], p.k);
    const struct trajectory *states = run->states;
    if (run->outcome == FINISHED) {
        p.error = 0;
        const int rows = states->table.row_count;
        for (int i = 0; i < rows; i++)
            p.error = fmax(p.error, circle_error(trajectory_row(states, i)));
        p.last_radius = circle_radius(trajectory_row(states, rows - 1));
    }
    return p;
}

/* What is known of all curves of the chart. */
struct work_summary {
    struct statements *statements;
    int finished, failed;
    double least; /* error, m */
    char best[64];
    int predicted, within; /* radii that there is a prediction for; within a millionth of it */
    double apart;          /* the largest relative distance from it, and whose */
    char farthest[80];
    char unsloped[256]; /* methods of fixed steps with too few errors for a slope */
};

/* The error of a method of order p with steps of h is proportional to h^p, its cost to 1 / h. */
static void state_slope(struct work_summary *summary, const struct configuration *configuration,
                        const struct fit *fit) {
    const int order = configuration->method->order;
    statements_add(summary->statements,
                   our_row("work-precision", "work-precision-slopes",
                           holds_if(fabs(-fit->slope - order) < 0.1), -fit->slope, "1",
                           "slope, %.60s", configuration->name),
                   "The error of %s falls with the power %.2f of its cost, and its order is %d.",
                   configuration->name, -fit->slope, order);
}

#define SLOPE_COLUMNS(X)                                   \
    CONFIGURATION_COLUMN(X, "method", configuration->name) \
    FIT_COLUMNS(X, fixed, &fit)

static void write_slope(FILE *stream, const struct configuration *configuration,
                        const struct slope *slope, struct work_summary *summary) {
    const struct fit fit = slope_fit(slope, configuration);
    const int fixed = !configuration_is_adaptive(configuration);
    if (fit.points > 0)
        WRITE_ROW(stream, SLOPE_COLUMNS);
    if (fit.points > 0 && fixed)
        state_slope(summary, configuration, &fit);
    else if (fixed)
        list_add(summary->unsloped, sizeof summary->unsloped, "%s", configuration->name);
}

/* |R(-i omega h)|^n, the radius after n steps over the first, where there is a table. */
static double predicted_radius(const struct configuration *configuration, double h, double steps) {
    const struct butcher_table *table = configuration->method->table;
    const double growth = cabs(butcher_stability(table, -I * CIRCLE_RATE * h));
    return CIRCLE_RADIUS * pow(growth, steps);
}

#define WORK_COLUMNS(X)                                                                            \
    METHOD_COLUMNS(X, c)                                                                           \
    X("setting", "s or 1", "step, s, or rtol = atol", "%.17g", p->setting)                         \
    X("error", "m", "largest distance from the exact position at the 9 frames", "%.17g", p->error) \
    EVALUATIONS_COLUMN(X, cost)                                                                    \
    STEPS_COLUMN(X, cost)                                                                          \
    CPU_COLUMNS(X, cost)                                                                           \
    STATUS_COLUMNS(X, cost)

#define RADIUS_COLUMNS(X)                                                                 \
    METHOD_COLUMNS(X, c)                                                                  \
    X("step", "s", "length of a step", "%.17g", p->setting)                               \
    X("omega_h", "rad", "angle by which the particle turns in a step", "%.17g",           \
      CIRCLE_RATE * p->setting)                                                           \
    X("radius", "m", "distance from the centre after 160 s", "%.17g", p->last_radius)     \
    X("predicted", "m", "radius after 160 s as the stability function predicts it", "%s", \
      predicted)                                                                          \
    STEPS_COLUMN(X, cost)

enum { WORK, SLOPES, RADIUS, TABLES };
static const struct table_form tables[TABLES] = {
    [WORK] = {"work-precision",
              "largest position error at the 9 frames of 160 s, m, against force evaluations and "
              "CPU time, s, of 9 repeated runs; setting: step, s, or rtol = atol; nan: there is no "
              "number, see status",
              COLUMNS(WORK_COLUMNS)},
    [SLOPES] = {"work-precision-slopes",
                "slopes of log error over log evaluations, between 1e-10 and 0.05 m, " SLOPE_RULE,
                COLUMNS(SLOPE_COLUMNS)},
    [RADIUS] = {"radius",
                "radius after 160 s, m, measured and as |R(-i omega h)|^n predicts it (no "
                "prediction: the method has no stability function)",
                COLUMNS(RADIUS_COLUMNS)},
};

static void add_radius(struct work_summary *summary, const struct configuration *c,
                       const struct point *p, double predicted) {
    const double apart = fabs(p->last_radius / predicted - 1);
    if (isnan(apart))
        return;
    summary->predicted++;
    summary->within += apart < 1e-6;
    if (apart < summary->apart)
        return;
    summary->apart = apart;
    snprintf(summary->farthest, sizeof summary->farthest, "%.40s at %.3g s", c->name, p->setting);
}

static void add_point(struct work_summary *summary, const struct configuration *c,
                      const struct point *p) {
    summary->finished += p->cost.outcome == FINISHED;
    summary->failed += p->cost.outcome != FINISHED;
    if (isnan(p->error) || (summary->best[0] && p->error >= summary->least))
        return;
    summary->least = p->error;
    snprintf(summary->best, sizeof summary->best, "%s", c->name);
}

static void write_point(FILE *const *streams, const struct configuration *c, const struct point *p,
                        struct work_summary *summary) {
    const struct cost *cost = &p->cost;
    add_point(summary, c, p);
    WRITE_ROW(streams[WORK], WORK_COLUMNS);
    if (configuration_is_adaptive(c) || cost->outcome != FINISHED)
        return;
    char predicted[32] = "no prediction";
    if (c->method->table) {
        const double radius = predicted_radius(c, p->setting, cost->steps);
        snprintf(predicted, sizeof predicted, "%.17g", radius);
        add_radius(summary, c, p, radius);
    }
    WRITE_ROW(streams[RADIUS], RADIUS_COLUMNS);
}

/* Rows of one configuration, in the order of its settings; blocks are separated by two blank lines.
 */
static int write_configuration(struct plan *plan, int c, FILE *const *streams,
                               struct work_summary *summary) {
    struct slope slope = {.count = 0};
    for (int i = 0; i < plan->case_count; i++) {
        struct run_files run;
        int configuration;
        if (strcmp(plan->cases[i].group, "work") != 0 ||
            sscanf(plan->cases[i].label, "%d", &configuration) != 1 || configuration != c)
            continue;
        if (plan_read(plan, &plan->cases[i], &run))
            return -1;
        const struct point point = read_point(plan, &plan->cases[i], &run);
        write_point(streams, &plan->configurations[c], &point, summary);
        if (point.error < 0.05 && point.error > 1e-10) /* neither as the circle nor of rounding */
            slope_add(&slope, point.cost.evaluations, point.error);
        run_free(&run);
    }
    write_slope(streams[SLOPES], &plan->configurations[c], &slope, summary);
    fprintf(streams[WORK], "\n\n");
    fprintf(streams[RADIUS], "\n\n");
    return 0;
}

static void state_work(const struct work_summary *summary) {
    static const char chart[] = "work-precision";
    const enum claim_verdict verdict = summary->finished > 0 ? HOLDS : NOT_REACHED;
    if (summary->unsloped[0])
        statements_add(summary->statements,
                       our_row(chart, chart, NOT_REACHED, NAN, NULL, "no slope"),
                       "No slope is given where fewer than three errors lie between 1e-10 and 0.05 "
                       "m, as with %s.",
                       summary->unsloped);
    statements_add(summary->statements,
                   our_row(chart, chart, verdict, summary->finished, "1", "finished"),
                   "%d of %d runs finish.", summary->finished, summary->finished + summary->failed);
    if (summary->best[0])
        statements_add(summary->statements,
                       our_row(chart, chart, verdict, summary->least, "m", "smallest error"),
                       "The smallest error is that of %s, %.2g m.", summary->best, summary->least);
}

static void state_radius(const struct work_summary *summary) {
    struct statement row =
        our_row("radius", "radius radius-predicted",
                holds_if(summary->within == summary->predicted), summary->apart, "1", "radius");
    if (summary->predicted > 0) {
        statements_add(summary->statements, row,
                       "In %d of %d runs the radius is that of the stability function to one part "
                       "in a million; the largest relative difference is %.2g, of %s.",
                       summary->within, summary->predicted, summary->apart, summary->farthest);
        return;
    }
    row.verdict = summary->finished > 0 ? NOT_ASKED : NOT_REACHED;
    row.unit = NULL;
    statements_add(summary->statements, row, "No method with a stability function %s.",
                   summary->finished > 0 ? "was asked for" : "reached its end");
}

static int write_work(struct plan *plan) {
    struct work_summary summary = {.statements = &plan->output.statements};
    FILE *streams[TABLES];
    if (output_tables(&plan->output, streams, tables, TABLES, "", circle_table_scene(plan)))
        return -1;
    for (int c = 0; c < plan->configuration_count; c++)
        if (write_configuration(plan, c, streams, &summary))
            return -1;
    state_work(&summary);
    state_radius(&summary);
    return 0;
}

/* The prediction as a curve: radius after 160 s with steps of h, for every method with a table. */
#define PREDICTION_COLUMNS(X)                                                                   \
    METHOD_COLUMNS(X, configuration)                                                            \
    X("step", "s", "length of a step", "%.17g", h)                                              \
    X("radius", "m", "distance from the centre after 160 s by the stability function", "%.17g", \
      predicted_radius(configuration, h, 160 / h))

static int write_prediction(struct plan *plan) {
    FILE *stream = output_table(&plan->output, "radius-predicted",
                                "0.9 |R(-i omega h)|^(160 s / h), m, from the stability function",
                                circle_table_scene(plan), COLUMNS(PREDICTION_COLUMNS));
    if (!stream)
        return -1;
    for (int c = 0; c < plan->configuration_count; c++) {
        const struct configuration *configuration = &plan->configurations[c];
        if (!configuration->method->table || configuration->kind != CONFIGURATION_PLAIN)
            continue;
        for (int k = 0; k <= 400; k++) {
            const double h = 2e-3 * pow(1e4, k / 400.);
            WRITE_ROW(stream, PREDICTION_COLUMNS);
        }
        fprintf(stream, "\n\n");
    }
    return 0;
}

static int circle_tabulate(struct plan *plan) {
    if (plan_open_statements(plan, circle_table_scene(plan),
                             plan->quick ? "--quick: six points a curve" : NULL) ||
        circle_tabulate_panels(plan) || write_work(plan))
        return -1;
    return write_prediction(plan);
}

const struct experiment circle_experiment = {
    .name = "circle",
    .question = "how far does each method carry a particle off its circle?",
    .thesis = "section 2.3.3",
    .chapter = CHAPTER_THESIS,
    .place = 4,
    .headline = "explicit Euler",
    .quick_seconds = 4,
    .full_seconds = 10,
    .plan = circle_plan,
    .tabulate = circle_tabulate,
};
