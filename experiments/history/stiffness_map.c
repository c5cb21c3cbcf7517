/* Rosenblum's hair by stiffness and rate. Springs that nothing damps but the air are stable under
 * explicit Euler at a rate of omega^2 / gamma and more, which grows with the stiffness; and what is
 * soft enough for a rate is no hair. */
#include "experiments/common/sets.h"
#include "history.h"

#include <math.h>
#include <stdlib.h>

static const char group[] = "map";
static const double too_limp = 0.1; /* no hair stretches by a tenth */
static const double too_far = 0.05; /* of the length to which it stretches: rms from its motion */
static const double own_rate = 60;  /* Hz */

/* Half decades, up to that of real hair and beyond; and twice the rate each time. */
enum { STIFFNESSES = 18, RATES = 18 };

static double stiffness(int k) {
    return pow(10, -4 + k / 2.);
}

static double rate_of(int k) {
    return ldexp(15, k);
}

/* --quick: decades, every other rate, and none that takes long. */
static int is_run(const struct plan *plan, int s, int r) {
    return !plan->quick || (s % 2 == 0 && stiffness(s) <= 1e3 && r % 2 == 0 && rate_of(r) <= 5e5);
}

int stiffness_map_plan(struct plan *plan) {
    for (int s = 0; s < STIFFNESSES; s++) {
        struct sets sets = {0};
        const struct run_request reference = {.stepper = "reference"};
        if (!is_run(plan, s, 0))
            continue;
        set_add(&sets, "material.stretch_stiffness=%.17e", stiffness(s));
        const struct scene *scene = plan_scene(plan, "rosenblum", sets.list, sets.count);
        if (!scene || plan_add(plan, scene, &reference, group, "reference %d", s))
            return -1;
        for (int r = 0; r < RATES; r++) {
            const struct run_request request = {
                .stepper = "euler", .step = 1 / rate_of(r), .strain_limit = 1e3};
            if (is_run(plan, s, r) && plan_add(plan, scene, &request, group, "%d %d", s, r))
                return -1;
        }
    }
    return 0;
}

/* --- a stiffness --- */

enum state { IS_FINE, IS_UNSTABLE, IS_LIMP };
static const char *const state_names[] = {"fine", "unstable", "limp"};

struct row {
    double stiffness, strain, limit; /* N; of its exact motion; Hz by linear theory */
    int fine_rate;                   /* the first from which on runs are near it, or RATES */
    int is_limp;
};

/* h <= gamma / omega^2, from |1 + h lambda|^2 <= 1 with lambda' of omega^2 and gamma, for the
 * stiffest mode of the springs. */
static double stable_rate(const struct scene *scene) {
    const double frequency = stiffest_mode(scene).frequency;
    return frequency * frequency / scene->wisps[0].drag_rate;
}

/* The fastest rate of the hinges, where the hair is straight: a displacement of one node across is
 * felt as -1, 4, -6, 4, -1 times EI / l^3, and by one that alternates 16 times. */
static double hinge_rate(const struct scene *scene) {
    const struct wisp *wisp = scene->wisps;
    const double spacing = wisp_spacing(wisp),
                 stiffness_across = 16 * wisp->bending_stiffness / pow(spacing, 3);
    return stiffness_across / wisp_node_mass(wisp, 2) / wisp->drag_rate;
}

#define CELL_COLUMNS(X)                                                                            \
    X("stiffness", "N", "stretch stiffness", "%.17g", row->stiffness)                              \
    X("rate", "Hz", "steps in a second", "%.17g", rate)                                            \
    X("state", "-", "fine, unstable, limp or both", "%s",                                          \
      !*near && row->is_limp ? "both" : state_names[state])                                        \
    X("status", "-", "how the run ended", "%s", outcome_name(run.outcome))                         \
    X("failure_time", "s", "simulated time at which the run failed", "%.17g",                      \
      run_number(&run, "failure_time"))                                                            \
    X("error", "m", "distance from its own exact motion, rms over free nodes and frames", "%.17g", \
      error)

#define STIFFNESS_COLUMNS(X)                                                                   \
    X("stiffness", "N", "stretch stiffness", "%.17g", row->stiffness)                          \
    X("strain", "1", "largest strain of its exact motion", "%.17g", row->strain)               \
    X("theory_rate", "Hz", "rate from which on linear theory calls explicit Euler stable",     \
      "%.17g", row->limit)                                                                     \
    X("stable_rate", "Hz", "least rate from which on all runs are fine or limp only", "%.17g", \
      row->fine_rate == RATES ? (double)NAN : rate_of(row->fine_rate))

static int tabulate_cell(struct plan *plan, const struct labelled_case *one, const struct row *row,
                         const struct run_files *reference, double rate, FILE *stream, int *near) {
    struct run_files run;
    double error;
    if (read_compared(plan, one, reference, &run, &error))
        return -1;
    *near = error <= too_far * (1 + row->strain) * one->run.scene->wisps[0].length;
    const enum state state = row->is_limp ? IS_LIMP : *near ? IS_FINE : IS_UNSTABLE;
    WRITE_ROW(stream, CELL_COLUMNS);
    run_free(&run);
    return 0;
}

static int tabulate_row(struct plan *plan, int s, FILE *cells, FILE *stiffnesses, struct row *row) {
    struct run_files reference;
    const struct labelled_case *truth = find_case(plan, group, "reference %d", s);
    const struct scene *scene = truth->run.scene;
    int code = read_reference(plan, truth, &reference);
    if (code)
        return code;
    *row = (struct row){.stiffness = stiffness(s),
                        .strain = run_number(&reference, "largest_strain"),
                        .limit = fmax(stable_rate(scene), hinge_rate(scene)),
                        .fine_rate = RATES};
    row->is_limp = row->strain > too_limp;
    int all_near = 1;
    for (int r = RATES - 1; r >= 0 && !code; r--) {
        int near = 0;
        const struct labelled_case *one = find_case(plan, group, "%d %d", s, r);
        if (!one)
            continue;
        code = tabulate_cell(plan, one, row, &reference, rate_of(r), cells, &near);
        all_near = all_near && near;
        if (all_near)
            row->fine_rate = r;
    }
    WRITE_ROW(stiffnesses, STIFFNESS_COLUMNS);
    run_free(&reference);
    return code;
}

/* --- sentences --- */

static void state_map(struct statements *statements, const struct row *rows, int count,
                      const struct scene *scene) {
    int fine = 0, stable = 0;
    double stiffest_stable = NAN, limpest = NAN;
    for (int i = 0; i < count; i++) {
        const int is_stable = rows[i].fine_rate < RATES && rate_of(rows[i].fine_rate) <= own_rate;
        fine += is_stable && !rows[i].is_limp;
        stable += is_stable;
        if (is_stable)
            stiffest_stable = rows[i].stiffness;
        if (rows[i].is_limp)
            limpest = rows[i].stiffness;
    }
    char soft[160];
    if (stable > 0)
        snprintf(soft, sizeof soft, "it is stable only up to %.2g N", stiffest_stable);
    else
        snprintf(soft, sizeof soft,
                 "none is stable there, since the hinges alone ask for %.2g kHz (without them "
                 "theory allows %.1g N)",
                 1e-3 * hinge_rate(scene),
                 scene->wisps[0].stretch_stiffness * own_rate / stable_rate(scene));
    statements_add(
        statements, our_row("map", "map stiffnesses", holds_if(fine == 0), fine, "1", "60 Hz"),
        "At 60 Hz, the step of Rosenblum et al., explicit Euler moves their hair rightly at %d of "
        "%d stiffnesses: %s, and up to %.2g N hair stretches by more than a tenth.",
        fine, count, soft, limpest);
    statements_add(statements,
                   our_row("map", "stiffnesses", HOLDS, stable_rate(scene), "Hz", "rate of theory"),
                   "By linear theory the %g N of swing take %.2g MHz, for nothing but the air "
                   "damps the springs, and the 16 800 N of real hair %.2g GHz.",
                   scene->wisps[0].stretch_stiffness, 1e-6 * stable_rate(scene),
                   1e-9 * stable_rate(scene) * 16800 / scene->wisps[0].stretch_stiffness);
}

enum { MAP, STIFFNESS_ROWS, TABLES };
static const struct table_form tables[TABLES] = {
    [MAP] =
        {"map",
         "Rosenblum's hair under explicit Euler, by stiffness (N) and rate (Hz). state: fine; "
         "unstable: not finite, or farther from its own exact motion (rms over free nodes and "
         "frames) than a twentieth of the length to which that stretches; limp: it stretches by "
         "more than a tenth; both; error in m, nan: the run failed; failure_time: nan: it did not",
         COLUMNS(CELL_COLUMNS)},
    [STIFFNESS_ROWS] =
        {"stiffnesses",
         "of each stiffness (N): the largest strain of its exact motion, the rate from which on "
         "linear theory calls explicit Euler stable (omega^2 / gamma of springs and hinges, Hz), "
         "and the least rate from which on all runs are fine or limp only (Hz; nan: none)",
         COLUMNS(STIFFNESS_COLUMNS)},
};

int stiffness_map_tabulate(struct plan *plan) {
    FILE *streams[TABLES];
    struct row rows[STIFFNESSES];
    int code = 0, count = 0;
    if (output_tables(&plan->output, streams, tables, TABLES, "", NULL))
        return -1;
    for (int s = 0; s < STIFFNESSES && !code; s++)
        if (is_run(plan, s, 0))
            code = tabulate_row(plan, s, streams[MAP], streams[STIFFNESS_ROWS], &rows[count++]);
    if (!code)
        state_map(&plan->output.statements, rows, count,
                  find_case(plan, eras[0].name, "reference")->run.scene);
    return code;
}
