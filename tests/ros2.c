/* What linearise has prepared holds until the next linearise, shown by a method that needs it: ROS2
 * solves twice with one matrix, and asks for an acceleration in between. */
#include "model/problems.h"
#include "order.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ROS2 (Verwer, Spee, Blom & Hundsdorfer 1999, SIAM J. Sci. Comput. 20, 1456,
 * doi:10.1137/S1064827597326651) for y' = F(t, y):
 *
 *     (1 - g h A) k1 = F(t, y),   (1 - g h A) k2 = F(t + h, y + h k1) - 2 k1,
 *     y <- y + h (3 k1 + k2) / 2.
 *
 * It is of order 2 for any A, which need not be F'; g = 1 - 1/sqrt 2 makes it L-stable where it
 * is. But A must be one matrix throughout the step. */
struct ros2 {
    struct stepper base;
    enum jacobian kind;
    struct linear_solver *linear;
    double *q, *v, *a;              /* the second stage's state; an acceleration */
    double *kq1, *kv1, *kq2, *kv2;  /* the stages */
    double *right, *stiffness_part; /* of the linear system */
    double memory[];
};

static int ros2_refuse(const struct stepper_settings *settings, struct system *system) {
    enum jacobian kind;
    return linear_choose(settings->linear, system, JACOBIAN_AUTO, &kind);
}

static struct stepper *ros2_create(const struct stepper_settings *settings, struct system *system) {
    const size_t n = (size_t)system->size;
    struct ros2 *self = malloc(sizeof *self + 9 * n * sizeof(double));
    if (!self)
        return NULL;
    double **const vectors[] = {&self->q,   &self->v,     &self->a,
                                &self->kq1, &self->kv1,   &self->kq2,
                                &self->kv2, &self->right, &self->stiffness_part};
    for (size_t i = 0; i < 9; i++)
        *vectors[i] = self->memory + i * n;
    self->linear = NULL;
    if (!linear_choose(settings->linear, system, JACOBIAN_AUTO, &self->kind))
        self->linear = linear_create(settings->linear, system, &settings->options);
    if (!self->linear) {
        free(self);
        return NULL;
    }
    return &self->base;
}

/* (kq, kv) <- (1 - gh A)^-1 (rq, rv), where A = ((0, 1), (M^-1 K, M^-1 D)). Its first row,
 * kq = rq + gh kv, in the second:  (M - gh D - gh^2 K) kv = M rv + gh K rq. */
static int stage(struct ros2 *self, double gh, const double *rq, const double *rv, double *kq,
                 double *kv) {
    struct system *system = self->base.system;
    system_product(system, 1, 0, 0, rv, self->right);
    system_product(system, 0, 0, gh, rq, self->stiffness_part);
    for (int i = 0; i < system->size; i++)
        self->right[i] += self->stiffness_part[i];
    const int code = linear_solve(self->linear, self->right, kv);
    for (int i = 0; i < system->size; i++)
        kq[i] = rq[i] + gh * kv[i];
    return code;
}

static int ros2_step(struct stepper *stepper, double t, double h, double *q, double *v) {
    struct ros2 *self = (struct ros2 *)stepper;
    struct system *system = stepper->system;
    const int n = system->size;
    const double gh = (1 - sqrt(0.5)) * h;

    int code = system_linearise(system, self->kind, t, q, v);
    code = code ? code : linear_factor(self->linear, gh, gh * gh);
    code = code ? code : system_acceleration(system, t, q, v, self->a);
    code = code ? code : stage(self, gh, v, self->a, self->kq1, self->kv1);
    if (code)
        return code;
    for (int i = 0; i < n; i++) {
        self->q[i] = q[i] + h * self->kq1[i];
        self->v[i] = v[i] + h * self->kv1[i];
    }
    code = system_acceleration(system, t + h, self->q, self->v, self->a);
    for (int i = 0; i < n; i++) {
        self->v[i] -= 2 * self->kq1[i];
        self->a[i] -= 2 * self->kv1[i];
    }
    code = code ? code : stage(self, gh, self->v, self->a, self->kq2, self->kv2);
    if (code)
        return code;
    for (int i = 0; i < n; i++) {
        q[i] += h / 2 * (3 * self->kq1[i] + self->kq2[i]);
        v[i] += h / 2 * (3 * self->kv1[i] + self->kv2[i]);
    }
    return 0;
}

static void ros2_free(struct stepper *stepper) {
    struct ros2 *self = (struct ros2 *)stepper;
    self->linear->method->free(self->linear);
    free(self);
}

static const struct stepper_method ros2 = {
    .name = "ros2",
    .summary = "linearly implicit, two stages, one matrix",
    .reference = "Verwer, Spee, Blom & Hundsdorfer 1999, doi:10.1137/S1064827597326651",
    .order = 2,
    .capabilities = STEPPER_IMPLICIT | STEPPER_SOLVES,
    .refuse = ros2_refuse,
    .create = ros2_create,
    .step = ros2_step,
    .free = ros2_free,
};

/* The method is what it says where every Jacobian is exact. */
Test(ros2, has_order_2_on_small_problems) {
    const struct variant variant = {.method = &ros2, .name = "ros2"};
    for (int y = 0; y < SMALL_YARDSTICKS; y++) {
        const struct order_seen seen = see_order(&variant, &small_yardsticks[y], 256);
        cr_assert_str_empty(seen.fault, "%s: %s", small_yardsticks[y].name, seen.fault);
    }
}

/* The wisp of `swing-envelope`, samples and all, after `to` in so many steps. Returns its number of
 * unknowns. */
static int swing(const struct variant *variant, int treatment, double to, int steps, double *q) {
    const struct stepper_settings settings = variant_settings(variant, 1e-13, 1e-14);
    struct scene *scene = LAB_LOAD("swing-envelope", "seed=1");
    struct model *model = lab_model(scene, treatment, 1);
    struct part *part = &model->parts[0];
    const int size = part->system.size;
    struct stepper *stepper = stepper_create(variant->method, &settings, &part->system);
    cr_assert(stepper, "no memory for a stepper");
    cr_assert_eq(integrate(stepper, 0, to, steps, part->q, part->v), 0, "%s, %s: %s", variant->name,
                 treatment_names[treatment], part->system.reason);
    memcpy(q, part->q, (size_t)size * sizeof *q);
    variant->method->free(stepper);
    return size;
}

/* The mass matrix of `generalised` turns with the frames, by h times their rate in a step: a matrix
 * half of which is of the next state is as far from being one, and the order falls to 1. In the
 * other treatments frames are in terms with h alone, and the order would stay. */
Test(ros2, has_order_2_on_the_swing_with_an_envelope) {
    static double exact[LAB_SIZE], q[LAB_SIZE];
    const struct variant variant = {.method = &ros2, .name = "ros2"};
    const struct variant reference = {.method = stepper_find("reference"), .name = "reference"};
    const double to = 0.1;
    for (int treatment = 0; treatment < TREATMENTS; treatment++) {
        double error[3];
        swing(&reference, treatment, to, 0, exact);
        for (int k = 0; k < 3; k++) {
            const int size = swing(&variant, treatment, to, 3200 << k, q);
            error[k] = 0;
            for (int i = 0; i < size; i++)
                error[k] += (q[i] - exact[i]) * (q[i] - exact[i]);
            error[k] = sqrt(error[k]);
        }
        cr_log_info("%s: errors %.2e %.2e %.2e", treatment_names[treatment], error[0], error[1],
                    error[2]);
        for (int k = 0; k < 2; k++) {
            const double order = log2(error[k] / error[k + 1]);
            cr_assert(fabs(order - 2) <= 0.1, "%s: errors %.2e, %.2e: order %.3f",
                      treatment_names[treatment], error[k], error[k + 1], order);
        }
    }
}
