#include "semi_implicit.h"

#include "eights.h"

#include <stdlib.h>

const char *const matrix_choices[] = {"stretch", "axial", "full", "spd", "auto", NULL};
static const struct option_spec matrix_option = MATRIX_OPTION_SPEC;

struct semi_implicit {
    struct system *system; /* not owned */
    enum force_part part;
    enum jacobian kind;   /* of a system without parts */
    double *coefficients; /* of linear Euler: h, then h^2, of each lane */
    double *step;         /* h, likewise */
    double *work, *right; /* of a system without parts */
    double *r, *change;   /* of linear Euler */
    IN_LINES double memory[];
};

/* The Jacobian that a system's own solver takes, spd before exact; or -1. */
static int own_kind(const struct system *system) {
    const struct system_ops *ops = system->ops;
    if (!ops->linearise || !ops->product || !ops->factor || !ops->solve || system->lanes > 1)
        return -1;
    return system->matrix[JACOBIAN_SPD] & MATRIX_FACTORABLE     ? JACOBIAN_SPD
           : system->matrix[JACOBIAN_EXACT] & MATRIX_FACTORABLE ? JACOBIAN_EXACT
                                                                : -1;
}

static int chosen(const struct stepper_settings *settings) {
    return (int)option_value(&settings->options, &matrix_option);
}

int semi_implicit_refuse(const struct stepper_settings *settings, struct system *system) {
    const int choice = chosen(settings);
    if (system->force_parts) {
        if (choice == MATRIX_AUTO || system->force_parts >> choice & 1)
            return 0;
        return system_fail(system, REFUSED, "matrix=%s: %s has no solver for it",
                           matrix_choices[choice], system->name);
    }
    if (choice != MATRIX_AUTO && choice != FORCES_FULL)
        return system_fail(system, REFUSED,
                           "matrix=%s: the forces of %s have no parts, its matrix is full",
                           matrix_choices[choice], system->name);
    if (own_kind(system) < 0)
        return system_fail(system, REFUSED, "%s has no solver of its own for its matrix",
                           system->name);
    return 0;
}

struct semi_implicit *semi_implicit_create(const struct stepper_settings *settings,
                                           struct system *system) {
    const size_t n = (size_t)system->size, lanes = (size_t)system->lanes;
    struct semi_implicit *self =
        stepper_memory(sizeof *self + (4 * n + 3 * lanes) * sizeof(double));
    if (!self)
        return NULL;
    const int choice = chosen(settings), kind = own_kind(system);
    self->system = system;
    self->part = choice == MATRIX_AUTO ? system->stiff_part : (enum force_part)choice;
    self->kind = kind < 0 ? JACOBIAN_EXACT : (enum jacobian)kind;
    self->work = self->memory;
    self->right = self->work + n;
    self->r = self->right + n;
    self->change = self->r + n;
    self->coefficients = self->change + n;
    self->step = self->coefficients + 2 * lanes;
    return self;
}

void semi_implicit_free(struct semi_implicit *self) {
    free(self);
}

const char *semi_implicit_caution(const struct semi_implicit *self) {
    if (!self->system->force_parts || self->part >= self->system->stiff_part)
        return NULL;
    return self->part == FORCES_STRETCH
               ? "matrix=stretch leaves bending, and bodies that push by penalty, to be explicit, "
                 "and that may be too stiff for such steps: matrix=auto does not"
               : "matrix=axial leaves hinges, and bodies that push by penalty, to be explicit, and "
                 "they may be too stiff for such steps: matrix=auto does not";
}

void *semi_implicit_stepper(const struct stepper_settings *settings, struct system *system,
                            size_t bytes) {
    struct semi_implicit_stepper *stepper = stepper_memory(bytes);
    if (stepper)
        stepper->matrix = semi_implicit_create(settings, system);
    if (stepper && stepper->matrix)
        return stepper;
    free(stepper);
    return NULL;
}

void semi_implicit_stepper_free(struct stepper *stepper) {
    semi_implicit_free(((struct semi_implicit_stepper *)stepper)->matrix);
    free(stepper);
}

const char *semi_implicit_stepper_caution(const struct stepper *stepper) {
    return semi_implicit_caution(((const struct semi_implicit_stepper *)stepper)->matrix);
}

/* By the whole matrix of a system without parts. */
static int solve_whole(struct semi_implicit *self, double t, const double *v,
                       const struct part_equation *e, double *x) {
    struct system *system = self->system;
    int code = system_linearise(system, self->kind, t, e->q, v);
    if (!code)
        code = system_factor(system, e->alpha[0], e->beta[0]);
    if (code)
        return code;
    system_product(system, 1, 0, 0, e->r, self->right);
    if (e->gamma[0] != 0) {
        system_product(system, 0, 0, e->gamma[0], e->g, self->work);
        for (int i = 0; i < system->size; i++)
            self->right[i] += self->work[i];
    }
    system->counters.linear_solves += system->wisps;
    system_solve(system, self->right, x);
    return 0;
}

int semi_implicit_solve(struct semi_implicit *self, double t, const double *v,
                        struct part_equation *equation, double *x) {
    if (!self->system->force_parts)
        return solve_whole(self, t, v, equation, x);
    equation->part = self->part;
    return system_solve_part(self->system, equation, x);
}

/* r <- h r, by lane. */
static void scale(int lanes, int n, const double *h, double *r) {
    const eight by = by_lane(h, lanes);
    int i = 0;
    for (; i + EIGHT <= n; i += EIGHT)
        store(r, i, load(r, i) * by);
    for (; i < n; i++)
        r[i] *= h[i % lanes];
}

/* The end of a step, which may be where it began. */
static void move(int lanes, int n, const double *h, const double *change, const double *q,
                 const double *v, double *q1, double *v1) {
    const eight by = by_lane(h, lanes);
    int i = 0;
    for (; i + EIGHT <= n; i += EIGHT) {
        const eight velocity = load(v, i) + load(change, i);
        store(v1, i, velocity);
        store(q1, i, load(q, i) + by * velocity);
    }
    for (; i < n; i++) {
        const double velocity = v[i] + change[i];
        v1[i] = velocity;
        q1[i] = q[i] + h[i % lanes] * velocity;
    }
}

int semi_implicit_euler_lanes(struct semi_implicit *self, double t1, const double *h,
                              const double *q, const double *v, double *q1, double *v1) {
    struct system *system = self->system;
    const int lanes = system->lanes;
    double *alpha = self->coefficients, *beta = alpha + lanes;
    double *r = self->r, *change = self->change;
    struct part_equation equation = {
        .alpha = alpha, .beta = beta, .gamma = beta, .q = q, .r = r, .g = v};
    for (int k = 0; k < lanes; k++) {
        alpha[k] = h[k];
        beta[k] = h[k] * h[k];
    }
    int code = system_acceleration(system, t1, q, v, r);
    if (code)
        return code;
    scale(lanes, system->size, h, r);
    code = semi_implicit_solve(self, t1, v, &equation, change);
    if (code)
        return code;
    move(lanes, system->size, h, change, q, v, q1, v1);
    return 0;
}

int semi_implicit_euler(struct semi_implicit *self, double t, double h, const double *q,
                        const double *v, double *q1, double *v1) {
    for (int k = 0; k < self->system->lanes; k++)
        self->step[k] = h;
    return semi_implicit_euler_lanes(self, t + h, self->step, q, v, q1, v1);
}
