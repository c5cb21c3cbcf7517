/* Tables of what is measured on small systems, here and now: it takes seconds and no clock. */
#include "base/files.h"
#include "stability.h"

#include <math.h>
#include <string.h>

/* Tolerance of adaptive methods where one must do: loose, since a tight one forbids what a map of
 * stability could show. */
static const double loose = 1e-2;

static int is_fixed(const struct stepper_method *method) {
    return method->step != NULL;
}

static int open_map(struct plan *plan, struct atomic_file *file, const char *folder,
                    const char *name, const char *what, const struct column *columns) {
    return open_table(file, folder, name, what, plan->loaded[0], columns, plan->reason);
}

/* How far what was measured is from theory, where there is one. */
struct agreement {
    double worst; /* |difference| over the larger of 1 and the theory */
    int count, asked;
};

static void agree(struct agreement *agreement, double measured, double theory) {
    agreement->asked++;
    if (isnan(measured) || isnan(theory))
        return;
    agreement->worst = fmax(agreement->worst, fabs(measured - theory) / fmax(1, fabs(theory)));
    agreement->count++;
}

static void state_agreement(struct statements *statements, const char *map, const char *what,
                            const struct agreement *agreement) {
    struct statement row = {.key = map, .figure = map, .tables = map, .unit = "1"};
    row.value = agreement->count ? agreement->worst : NAN;
    row.verdict = !agreement->count ? NOT_ASKED : holds_if(agreement->worst < 1e-6);
    if (agreement->count)
        statements_add(statements, row,
                       "In the real code the %s is within %.2g of that of the stability function, "
                       "at %d points.",
                       what, agreement->worst, agreement->count);
    else
        statements_add(statements, row, "No method with a stability function was asked for.");
}

#define STEPPER_COLUMN(X) X("stepper", "-", "name of the stepper", "%s", method->name)
#define GROWTH_COLUMNS(X)                                                                   \
    X("growth", "1", "growth per step, measured by stepping the real code", "%.9g", growth) \
    X("theory", "1", "growth per step by the stability function", "%.9g", theory)

/* --- the regions --- */

#define REGION_COLUMNS(X)                                 \
    STEPPER_COLUMN(X)                                     \
    X("re", "1", "real part of z h", "%g", creal(z))      \
    X("im", "1", "imaginary part of z h", "%g", cimag(z)) \
    GROWTH_COLUMNS(X)

static void write_region(FILE *stream, const struct stepper_method *method, double spacing,
                         struct agreement *agreement) {
    const double left = -4, right = 3, top = 3.5;
    const int columns = (int)round((right - left) / spacing), rows = (int)round(2 * top / spacing);
    struct small_system small;
    for (int row = 0; row <= rows; row++) {
        for (int column = 0; column <= columns; column++) {
            const double complex z = left + column * spacing + I * (row * spacing - top);
            small_dahlquist(&small, z);
            const double growth = measured_growth(method, loose, &small, 1),
                         theory = method->table ? cabs(butcher_stability(method->table, z)) : NAN;
            WRITE_ROW(stream, REGION_COLUMNS);
            agree(agreement, growth, theory);
        }
        fprintf(stream, "\n");
    }
    fprintf(stream, "\n");
}

static int write_regions(struct plan *plan, const char *folder, struct statements *statements) {
    struct agreement agreement = {0};
    struct atomic_file file;
    if (open_map(plan, &file, folder, "regions",
                 "growth per step of u' = z u, h = 1, measured by stepping the real code (growth) "
                 "and by the stability function where there is one; adaptive methods take no step "
                 "that is forced on them: growth per unit of time at rtol 0.01; nan: of theory, "
                 "there is no stability function; of growth, the method failed there",
                 COLUMNS(REGION_COLUMNS)))
        return -1;
    for (int i = 0; stepper_methods[i]; i++) {
        const double fine = plan->quick ? 0.2 : 0.05, coarse = plan->quick ? 0.5 : 0.25;
        if (plan_wants(plan, stepper_methods[i]->name))
            write_region(file.stream, stepper_methods[i],
                         is_fixed(stepper_methods[i]) ? fine : coarse, &agreement);
    }
    state_agreement(statements, "regions", "growth on u' = zu", &agreement);
    return atomic_commit(&file, plan->reason);
}

/* --- the damped oscillator --- */

/* On the modes of q'' = -q - 2 zeta q'; NaN where there is no theory. */
static double oscillator_theory(const struct stepper_method *method, double h, double zeta) {
    const double complex root = csqrt(zeta * zeta - 1);
    return stepper_is_predictable(method)
               ? cabs(stepper_amplification(method, h * (-zeta + root), h * (-zeta - root)))
               : NAN;
}

#define OSCILLATOR_COLUMNS(X)                           \
    STEPPER_COLUMN(X)                                   \
    X("omega_h", "1", "omega times the step", "%g", h)  \
    X("zeta", "1", "damping over critical", "%g", zeta) \
    GROWTH_COLUMNS(X)

static void write_oscillator(FILE *stream, const struct stepper_method *method, int quick,
                             struct agreement *agreement) {
    const double h_step = quick ? 0.2 : 0.05, zeta_step = quick ? 0.25 : 0.05;
    const double h_last = 4, zeta_last = 2;
    struct small_system small;
    for (int row = 0; row <= (int)round(zeta_last / zeta_step); row++) {
        for (int column = 1; column <= (int)round(h_last / h_step); column++) {
            const double zeta = row * zeta_step, h = column * h_step;
            small_oscillator(&small, zeta);
            const double growth = measured_growth(method, loose, &small, h),
                         theory = oscillator_theory(method, h, zeta);
            WRITE_ROW(stream, OSCILLATOR_COLUMNS);
            agree(agreement, growth, theory);
        }
        fprintf(stream, "\n");
    }
    fprintf(stream, "\n");
}

static int write_oscillators(struct plan *plan, const char *folder, struct statements *statements) {
    struct agreement agreement = {0};
    struct atomic_file file;
    if (open_map(plan, &file, folder, "oscillator",
                 "growth per step of q'' = -omega^2 q - 2 zeta omega q' with fixed steps h, "
                 "measured by stepping the real code, and by linear theory where the method has "
                 "one; adaptive methods have no omega h; nan: of theory, there is none; of growth, "
                 "the method failed there",
                 COLUMNS(OSCILLATOR_COLUMNS)))
        return -1;
    for (int i = 0; stepper_methods[i]; i++)
        if (is_fixed(stepper_methods[i]) && plan_wants(plan, stepper_methods[i]->name))
            write_oscillator(file.stream, stepper_methods[i], plan->quick, &agreement);
    state_agreement(statements, "oscillator", "growth on a damped oscillator", &agreement);
    return atomic_commit(&file, plan->reason);
}

/* --- numerical damping --- */

#define RING_COLUMNS(X)                                                                      \
    STEPPER_COLUMN(X)                                                                        \
    X("setting", "1", "omega h, or rtol of adaptive methods", "%g", setting)                 \
    X("steps_per_period", "1", "steps to a period, in the mean", "%.9g", m.steps_per_period) \
    X("damping", "1", "damping of the method's own, over critical, by ring-down", "%.9g",    \
      m.damping)                                                                             \
    X("frequency_shift", "1", "relative shift of the frequency, by ring-down", "%.9g",       \
      m.frequency_shift)                                                                     \
    X("damping_theory", "1", "damping of the method by linear theory", "%.9g", p.damping)    \
    X("frequency_shift_theory", "1", "shift of the frequency by linear theory", "%.9g",      \
      p.frequency_shift)

static void write_ring(FILE *stream, const struct stepper_method *method, double setting,
                       struct agreement *agreement) {
    const int fixed = is_fixed(method);
    const struct ring_down m = measured_ring_down(method, fixed ? loose : setting, setting);
    const struct ring_down p = stepper_is_predictable(method) ? predicted_ring_down(method, setting)
                                                              : (struct ring_down){NAN, NAN, NAN};
    if (isnan(m.damping))
        return;
    WRITE_ROW(stream, RING_COLUMNS);
    agree(agreement, m.damping, p.damping);
}

static int write_damping(struct plan *plan, const char *folder, struct statements *statements) {
    struct agreement agreement = {0};
    struct atomic_file file;
    if (open_map(
            plan, &file, folder, "damping",
            "an undamped oscillator let go: the damping that is the method's own (of critical; "
            "negative: it grows) and its relative shift of frequency, by ring-down of the real "
            "code and by |R(i omega h)| and arg R, R what linear theory multiplies by; setting: "
            "omega h, or rtol of adaptive methods, whose steps per period are the mean; nan: of "
            "theory, there is none; else the ring-down grew or died too fast to be read",
            COLUMNS(RING_COLUMNS)))
        return -1;
    for (int i = 0; stepper_methods[i]; i++) {
        const struct stepper_method *method = stepper_methods[i];
        if (!plan_wants(plan, method->name))
            continue;
        for (int k = 0; k <= 18; k++) { /* from 3 steps to the period to 200, or 1e-2 to 1e-8 */
            const double setting = is_fixed(method) ? 2 * M_PI / 3 * exp(-k * log(200. / 3) / 18)
                                                    : pow(10, -2 - k / 3.);
            if (!plan->quick || k % 3 == 0)
                write_ring(file.stream, method, setting, &agreement);
        }
        fprintf(file.stream, "\n\n");
    }
    state_agreement(statements, "damping", "damping of an undamped oscillator", &agreement);
    return atomic_commit(&file, plan->reason);
}

int stability_maps(struct plan *plan, const char *folder, struct statements *statements) {
    return write_regions(plan, folder, statements) || write_oscillators(plan, folder, statements) ||
                   write_damping(plan, folder, statements)
               ? -1
               : 0;
}
