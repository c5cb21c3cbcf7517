#include "diagnosis.h"

#include "base/columns.h"
#include "base/digits.h"
#include "model.h"

#include <math.h>

/* --- the smooth motion --- */

static void look(struct part *part, double t, struct powers *power) {
    struct system *system = &part->system;
    if (system->ops->powers(system->ctx, t, part->q, part->v, power) == 0)
        return;
#define X(name, meaning) power->name = NAN;
    POWERS(X)
#undef X
}

void account_begin(struct part *part, double t) {
    part->account->t = t;
    look(part, t, &part->account->power);
}

/* The trapezoid rule over the step: works are measured on the run itself, with an error of second
 * order in the step. A higher order would need the powers inside the step, where only some methods
 * have a state, or the powers' derivatives. (Simpson's rule with a middle from Hermite's polynomial
 * through both ends would be of fourth order, but takes h/8 of the difference of the accelerations
 * for a velocity: nonsense for implicit methods, which step over what is stiff.) */
void account_step(struct part *part, double t) {
    struct account *account = part->account;
    struct powers power;
    look(part, t, &power);
    const double half = (t - account->t) / 2;
#define X(name, meaning) account->work.name += half * (account->power.name + power.name);
    POWERS(X)
#undef X
    account->power = power;
    account->t = t;
}

/* --- ticks --- */

static double part_energy(const struct part *part, double t) {
    const struct system *system = &part->system;
    struct energies energies;
    const int code = system->ops->energies(system->ctx, t, part->q, part->v, &energies);
    return code ? NAN : energies_sum(&energies);
}

void account_before(struct part *part, double t) {
    if (part->account)
        part->account->energy = part_energy(part, t);
}

void account_after(struct part *part, double t, enum jump kind) {
    if (!part->account)
        return;
    const double before = part->account->energy;
    part->account->energy = part_energy(part, t);
    part->account->jump[kind] += part->account->energy - before;
}

static double jumps_sum(const double jump[JUMP_COUNT]) {
    double sum = 0;
    for (int k = 0; k < JUMP_COUNT; k++)
        sum += jump[k];
    return sum;
}

double model_energy(const struct model *model) {
    double sum = 0;
    for (int i = 0; i < model->part_count; i++)
        sum += part_energy(&model->parts[i], model->t);
    return sum;
}

double model_jumps(const struct model *model) {
    double sum = 0;
    for (int i = 0; i < model->part_count; i++)
        if (model->parts[i].account)
            sum += jumps_sum(model->parts[i].account->jump);
    return sum;
}

/* --- frames --- */

int diagnose(const struct model *model, const double *rows, struct diagnosis *diagnosis) {
    *diagnosis = (struct diagnosis){.t = model->t};
    for (int i = 0; i < model->part_count; i++) {
        const struct part *part = &model->parts[i];
        const struct system *system = &part->system;
        struct energies energies;
        const int code = system->ops->energies(system->ctx, model->t, part->q, part->v, &energies);
        if (code)
            return code;
#define X(name, meaning) diagnosis->energy.name += energies.name;
        ENERGIES(X)
#undef X
#define X(name, meaning) diagnosis->work.name += part->account->work.name;
        POWERS(X)
#undef X
        for (int k = 0; k < JUMP_COUNT; k++)
            diagnosis->jump[k] += part->account->jump[k];
        diagnosis->body_contacts += (double)system->counters.body_contacts;
        diagnosis->wisp_contacts += (double)system->counters.wisp_contacts;
    }
    diagnosis->residual = energies_sum(&diagnosis->energy) - powers_sum(&diagnosis->work) -
                          jumps_sum(diagnosis->jump);
    return model->problem->extremes(model, rows, &diagnosis->extremes);
}

/* --- the table --- */

/* One list makes the explanation, the names and the rows. X(column, unit, value, meaning) */
#define ENERGY_COLUMN(name, meaning) COLUMN(#name, "J", d->energy.name, meaning)
#define WORK_COLUMN(name, meaning)   COLUMN("work_" #name, "J", d->work.name, "work: " meaning)
#define JUMP_COLUMN(kind, name, meaning) \
    COLUMN("jump_" name, "J", d->jump[JUMP_##kind], "at ticks: " meaning)
#define EXTREME_COLUMN(name, unit, meaning) COLUMN(#name, unit, d->extremes.name, meaning)
#define ALL_COLUMNS                                                                             \
    COLUMN("t", "s", d->t, "time")                                                              \
    ENERGIES(ENERGY_COLUMN)                                                                     \
    POWERS(WORK_COLUMN)                                                                         \
    JUMPS(JUMP_COLUMN)                                                                          \
    COLUMN("jump_other", "J", d->other, "at ticks: all else, to rounding of the energy")        \
    COLUMN("residual", "J", d->residual,                                                        \
           "change of all energies since the start less all works and jumps: the integrator's " \
           "error, and the works' own, of second order in the step")                            \
    EXTREMES(EXTREME_COLUMN)                                                                    \
    COLUMN("body_contacts", "1", d->body_contacts,                                              \
           "nodes and samples put out of bodies since the frame before")                        \
    COLUMN("wisp_contacts", "1", d->wisp_contacts,                                              \
           "points found in sections of other wisps since the frame before")

void diagnosis_write_head(FILE *stream) {
#define COLUMN(name, unit, value, meaning) {name, unit, meaning},
    static const struct column columns[] = {ALL_COLUMNS{0}};
#undef COLUMN
    fprintf(stream, "# energies at the frame; works and jumps since the start, positive where they "
                    "add energy\n");
    columns_write(stream, columns);
}

void diagnosis_write_row(FILE *stream, const struct diagnosis *d) {
    const char *tab = "";
#define COLUMN(name, unit, value, meaning) fprintf(stream, "%s%s", tab, DIGITS(value)), tab = "\t";
    ALL_COLUMNS
#undef COLUMN
    fputc('\n', stream);
}
