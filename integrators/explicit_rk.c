/* Explicit Runge-Kutta on q' = v, v' = a(t, q, v) (Hairer, Norsett & Wanner, Solving Ordinary
 * Differential Equations I, 2nd ed. 1993, section II.1). */
#include "explicit_rk.h"

#include <stdlib.h>
#include <string.h>

struct explicit_rk {
    struct stepper base;
    double *q, *v;                           /* the state of a stage, then of the end */
    double *vk[STAGES_MAX], *ak[STAGES_MAX]; /* the stages' derivatives of q and of v */
    double memory[];
};

struct stepper *explicit_rk_create(const struct stepper_settings *settings, struct system *system) {
    (void)settings;
    const size_t n = (size_t)system->size;
    struct explicit_rk *rk = malloc(sizeof *rk + (2 + 2 * STAGES_MAX) * n * sizeof(double));
    if (!rk)
        return NULL;
    rk->q = rk->memory;
    rk->v = rk->q + n;
    for (size_t i = 0; i < STAGES_MAX; i++) {
        rk->vk[i] = rk->v + (1 + 2 * i) * n;
        rk->ak[i] = rk->vk[i] + n;
    }
    return &rk->base;
}

/* rk->(q, v) <- (q, v) + h sum_j w_j (vk_j, ak_j), zero weights skipped, one pass per pair of
 * stages at most: every table here has one or, at the end, all of them. */
static void combine(struct explicit_rk *rk, int n, double h, const double *weight, int stages,
                    const double *q, const double *v) {
    const double *base_q = q, *base_v = v;
    for (int j = 0; j < stages; j++) {
        if (weight[j] == 0)
            continue;
        const double hw = h * weight[j];
        const double *restrict vk = rk->vk[j], *restrict ak = rk->ak[j];
        double *to_q = rk->q, *to_v = rk->v;
        for (int i = 0; i < n; i++) {
            to_q[i] = base_q[i] + hw * vk[i];
            to_v[i] = base_v[i] + hw * ak[i];
        }
        base_q = rk->q;
        base_v = rk->v;
    }
}

int explicit_rk_step(struct stepper *stepper, double t, double h, double *q, double *v) {
    struct explicit_rk *rk = (struct explicit_rk *)stepper;
    struct system *system = stepper->system;
    const struct butcher_table *table = stepper->method->table;
    const int n = system->size;
    const size_t bytes = (size_t)n * sizeof(double);

    for (int i = 0; i < table->stages; i++) {
        const double *stage_q = q, *stage_v = v;
        if (i > 0) {
            combine(rk, n, h, table->a[i], i, q, v);
            stage_q = rk->q;
            stage_v = rk->v;
        }
        memcpy(rk->vk[i], stage_v, bytes);
        const int code =
            system_acceleration(system, t + table->c[i] * h, stage_q, stage_v, rk->ak[i]);
        if (code)
            return code;
    }
    combine(rk, n, h, table->b, table->stages, q, v);
    if (system_has_projection(system)) {
        const int code = system_project(system, t + h, rk->q, rk->v);
        if (code)
            return code;
    }
    memcpy(q, rk->q, bytes);
    memcpy(v, rk->v, bytes);
    return 0;
}

void explicit_rk_free(struct stepper *stepper) {
    free(stepper);
}
