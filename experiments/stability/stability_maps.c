/* Tables of what is measured on small systems, here and now: it takes seconds and no clock. */
#include "stability.h"

#include <math.h>
#include <string.h>

/* Tolerance of adaptive methods where one must do: loose, since a tight one forbids what a map of
 * stability could show. */
static const double loose = 1e-2;

static int is_fixed(const struct stepper_method *method) {
    return method->step != NULL;
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
    if (agreement->count)
        statements_add(
            statements,
            our_row(map, map, holds_if(agreement->worst < 1e-6), agreement->worst, "1", "%s", map),
            "In the real code the %s is within %.2g of that of the stability function, at %d "
            "points.",
            what, agreement->worst, agreement->count);
    else
        statements_add(statements, our_row(map, map, NOT_ASKED, NAN, NULL, "%s", map),
                       "No method with a stability function was asked for.");
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

static void write_region(FILE *stream, const struct stepper_method *method, int quick,
                         struct agreement *agreement) {
    const double fine = quick ? 0.2 : 0.05, coarse = quick ? 0.5 : 0.25;
    const double spacing = is_fixed(method) ? fine : coarse;
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

static void write_rings(FILE *stream, const struct stepper_method *method, int quick,
                        struct agreement *agreement) {
    for (int k = 0; k <= 18; k++) { /* from 3 steps to the period to 200, or 1e-2 to 1e-8 */
        const double setting =
            is_fixed(method) ? 2 * M_PI / 3 * exp(-k * log(200. / 3) / 18) : pow(10, -2 - k / 3.);
        if (!quick || k % 3 == 0)
            write_ring(stream, method, setting, agreement);
    }
    fprintf(stream, "\n\n");
}

/* --- all --- */

static const struct map {
    struct table_form form;
    const char *what; /* is measured, in words */
    int fixed_only;
    void (*write)(FILE *stream, const struct stepper_method *method, int quick,
                  struct agreement *agreement);
} maps[] = {
    {{"regions",
      "growth per step of u' = z u, h = 1, measured by stepping the real code (growth) and by "
      "the stability function where there is one; adaptive methods take no step that is forced "
      "on them: growth per unit of time at rtol 0.01; nan: of theory, there is no stability "
      "function; of growth, the method failed there",
      COLUMNS(REGION_COLUMNS)},
     "growth on u' = zu",
     0,
     write_region},
    {{"oscillator",
      "growth per step of q'' = -omega^2 q - 2 zeta omega q' with fixed steps h, measured by "
      "stepping the real code, and by linear theory where the method has one; adaptive methods "
      "have no omega h; nan: of theory, there is none; of growth, the method failed there",
      COLUMNS(OSCILLATOR_COLUMNS)},
     "growth on a damped oscillator",
     1,
     write_oscillator},
    {{"damping",
      "an undamped oscillator let go: the damping that is the method's own (of critical; "
      "negative: it grows) and its relative shift of frequency, by ring-down of the real code "
      "and by |R(i omega h)| and arg R, R what linear theory multiplies by; setting: omega h, or "
      "rtol of adaptive methods, whose steps per period are the mean; nan: of theory, there is "
      "none; else the ring-down grew or died too fast to be read",
      COLUMNS(RING_COLUMNS)},
     "damping of an undamped oscillator",
     0,
     write_rings},
};

int stability_maps(struct plan *plan) {
    for (size_t k = 0; k < sizeof maps / sizeof *maps; k++) {
        const struct map *map = &maps[k];
        struct agreement agreement = {0};
        FILE *stream;
        if (output_tables(&plan->output, &stream, &map->form, 1, "", plan->loaded[0]))
            return -1;
        for (int i = 0; stepper_methods[i]; i++)
            if (plan_wants(plan, stepper_methods[i]->name) &&
                (is_fixed(stepper_methods[i]) || !map->fixed_only))
                map->write(stream, stepper_methods[i], plan->quick, &agreement);
        state_agreement(&plan->output.statements, map->form.name, map->what, &agreement);
    }
    return 0;
}
