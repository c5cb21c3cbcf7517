/* Explicit Runge-Kutta on q' = v, v' = a(t, q, v) (Hairer, Norsett & Wanner, Solving Ordinary
 * Differential Equations I, 2nd ed. 1993, section II.1). */
#include "explicit_rk.h"

/* Vectors: the position of a stage, or of projected systems the state of the end; then velocity and
 * acceleration of each stage. The first's velocity is the state's. */
struct stepper *explicit_rk_create(const struct butcher_table *table, struct system *system) {
    return stepper_of_vectors(system, 2 + 2 * (size_t)table->stages);
}

/* One pass of `sum`, for a number of stages that is a constant where this is inlined. */
static inline __attribute__((always_inline)) void sum_stages(int stages, int n,
                                                             const double *restrict weight,
                                                             double *const *k, const double *x,
                                                             double *restrict to) {
    for (int i = 0; i < n; i++) {
        double sum = weight[0] * k[0][i];
        for (int j = 1; j < stages; j++)
            sum += weight[j] * k[j][i];
        to[i] = (x ? x[i] : to[i]) + sum;
    }
}

/* to <- x + h sum_j w_j k_j over the stages whose weight is not 0; x is NULL where it is `to`. */
static void sum(int n, double h, const double *weight, int stages, double *const *k,
                const double *x, double *to) {
    double used_weight[stages], *used[stages];
    int count = 0;
    for (int j = 0; j < stages; j++) {
        if (weight[j] == 0)
            continue;
        used_weight[count] = h * weight[j];
        used[count++] = k[j];
    }
    switch (count) {
    case 1:
        sum_stages(1, n, used_weight, used, x, to);
        break;
    case 4:
        sum_stages(4, n, used_weight, used, x, to);
        break;
    default:
        sum_stages(count, n, used_weight, used, x, to);
    }
}

int explicit_rk_step(struct stepper *stepper, double t, double h, double *q, double *v) {
    struct system *system = stepper->system;
    const struct butcher_table *table = stepper->method->table;
    const int n = system->size;
    double *q1 = stepper_vectors(stepper), *v1 = q1 + n, *stages = v1 + n;
    double *vk[table->stages], *ak[table->stages];

    for (int i = 0; i < table->stages; i++) {
        vk[i] = i > 0 ? stages + 2 * i * n : v;
        ak[i] = stages + (2 * i + 1) * n;
        if (i > 0) {
            sum(n, h, butcher_row(table, i), i, vk, q, q1);
            sum(n, h, butcher_row(table, i), i, ak, v, vk[i]);
        }
        const int code =
            system_acceleration(system, t + table->c[i] * h, i > 0 ? q1 : q, vk[i], ak[i]);
        if (code)
            return code;
    }
    if (!system_has_projection(system)) { /* nothing can fail any more */
        sum(n, h, table->b, table->stages, vk, NULL, q);
        sum(n, h, table->b, table->stages, ak, NULL, v);
        return 0;
    }
    sum(n, h, table->b, table->stages, vk, q, q1);
    sum(n, h, table->b, table->stages, ak, v, v1);
    return stepper_arrive(stepper, t + h, q1, v1, q, v);
}

void explicit_rk_free(struct stepper *stepper) {
    stepper_free(stepper);
}
