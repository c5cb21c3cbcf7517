/* The energy of a run by frames: where it is, what changed it, and what is left over. */
#include "simulation_parts.h"

#include <math.h>
#include <stdio.h>

/* The frame's diagnosis: the model's, with what only the run knows: its start, the frame before,
 * the ticks. */
void make_diagnosis(struct simulation *sim) {
    struct diagnosis *d = &sim->diagnosis;
    const double body_contacts = sim->body_contacts, wisp_contacts = sim->wisp_contacts;
    if (diagnose(sim->model, sim->rows, d)) {
        end_run(sim, OUT_OF_MEMORY, "no memory for a diagnosis");
        return;
    }
    if (sim->result->frames == 1)
        sim->first_energy = d->residual;
    d->other = sim->other_jumps;
    d->residual -= sim->first_energy + d->other;
    sim->body_contacts = d->body_contacts;
    sim->wisp_contacts = d->wisp_contacts;
    d->body_contacts -= body_contacts;
    d->wisp_contacts -= wisp_contacts;
    sim->model->diagnosis = d;
}

/* What all hair has at a speed at which it is at rest, J: less is rounding. */
static double energy_at_rest(const struct scene *scene) {
    const double at_rest = 1e-9; /* m/s, as in contacts */
    double mass = 0;
    for (int w = 0; w < scene->wisp_count; w++)
        for (int i = 2; i < scene->wisps[w].nodes; i++)
            mass += wisp_node_mass(&scene->wisps[w], i);
    return mass * at_rest * at_rest / 2;
}

/* No step's error is worth ten times what the scene ever held: such a run is wrong whatever its
 * lengths. The energies are taken absolutely, since gravity's has its zero somewhere. */
void check_energy(struct simulation *sim) {
    const struct diagnosis *d = &sim->diagnosis;
    double stored = energy_at_rest(sim->scene);
#define X(name, meaning) stored += fabs(d->energy.name);
    ENERGIES(X)
#undef X
    sim->most_energy = fmax(sim->most_energy, stored);
    if (sim->settings->method->checked_by || !(fabs(d->residual) > 10 * sim->most_energy))
        return;
    char reason[REASON_SIZE];
    snprintf(reason, sizeof reason,
             "%.3g J of energy are accounted for by no work, and it never held more than %.3g J",
             d->residual, sim->most_energy);
    end_run(sim, DIVERGED, reason);
}
