/* What linear theory says of a wisp: the eigenvalues of its equations where they are linearised,
 * and the longest step of which no multiple of them leaves the region of stability. */
#include "model/model.h"
#include "stability.h"

#include <gsl/gsl_eigen.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Dense matrices for the modes of n unknowns. */
struct dense {
    gsl_matrix *mass, *companion;
    gsl_permutation *order;
    gsl_vector_complex *values;
    gsl_matrix_complex *vectors;
    gsl_eigen_nonsymmv_workspace *work;
    double *unit, *column; /* vectors of the system */
};

static void dense_free(struct dense *d) {
    gsl_matrix_free(d->mass);
    gsl_matrix_free(d->companion);
    gsl_permutation_free(d->order);
    gsl_vector_complex_free(d->values);
    gsl_matrix_complex_free(d->vectors);
    gsl_eigen_nonsymmv_free(d->work);
    free(d->unit);
    free(d->column);
}

static int dense_make(struct dense *d, size_t n) {
    *d = (struct dense){
        .mass = gsl_matrix_alloc(n, n),
        .companion = gsl_matrix_calloc(2 * n, 2 * n),
        .order = gsl_permutation_alloc(n),
        .values = gsl_vector_complex_alloc(2 * n),
        .vectors = gsl_matrix_complex_alloc(2 * n, 2 * n),
        .work = gsl_eigen_nonsymmv_alloc(2 * n),
        .unit = calloc(n, sizeof(double)),
        .column = malloc(n * sizeof(double)),
    };
    return d->mass && d->companion && d->order && d->values && d->vectors && d->work && d->unit &&
                   d->column
               ? 0
               : -1;
}

/* Column j of m M + d D + k K becomes column `to` of `matrix`, from row `from` on. */
static void take_column(struct system *system, struct dense *dense, const double mdk[3], int j,
                        gsl_matrix *matrix, int from, int to) {
    dense->unit[j] = 1;
    system_product(system, mdk[0], mdk[1], mdk[2], dense->unit, dense->column);
    dense->unit[j] = 0;
    for (int i = 0; i < system->size; i++)
        gsl_matrix_set(matrix, (size_t)(from + i), (size_t)to, dense->column[i]);
}

/* The companion matrix ( 0 1; M^-1 K, M^-1 D ), with M's own dense factors: no solver of the
 * program is trusted here. */
static int fill(struct system *system, struct dense *d) {
    const int n = system->size;
    int sign, code = 0;
    for (int j = 0; j < n; j++) {
        take_column(system, d, (const double[]){1, 0, 0}, j, d->mass, 0, j);
        take_column(system, d, (const double[]){0, 0, 1}, j, d->companion, n, j);
        take_column(system, d, (const double[]){0, 1, 0}, j, d->companion, n, n + j);
        gsl_matrix_set(d->companion, (size_t)j, (size_t)(n + j), 1);
    }
    code = gsl_linalg_LU_decomp(d->mass, d->order, &sign);
    for (int j = 0; j < 2 * n && !code; j++) {
        gsl_vector_view column =
            gsl_matrix_subcolumn(d->companion, (size_t)j, (size_t)n, (size_t)n);
        code = gsl_linalg_LU_svx(d->mass, d->order, &column.vector);
    }
    return code;
}

/* x' (m M + d D + k K) x */
static double form(struct system *system, struct dense *d, const double mdk[3], const double *x) {
    double sum = 0;
    system_product(system, mdk[0], mdk[1], mdk[2], x, d->column);
    for (int i = 0; i < system->size; i++)
        sum += x[i] * d->column[i];
    return sum;
}

/* The other rate of the mode that has the real i-th one. With its shape x, (l^2 M - l D - K) x = 0,
 * and x' of it is the equation of the mode's two rates: they add up to x' D x / x' M x. */
static double partner_of(struct system *system, struct dense *d, size_t i, double rate) {
    double *x = d->unit;
    for (int k = 0; k < system->size; k++) {
        const gsl_complex entry = gsl_matrix_complex_get(d->vectors, (size_t)k, i);
        x[k] = GSL_REAL(entry);
    }
    return form(system, d, (const double[]){0, 1, 0}, x) /
               form(system, d, (const double[]){1, 0, 0}, x) -
           rate;
}

struct mode_rate *system_modes(struct system *system, double t, const double *q, const double *v) {
    gsl_set_error_handler_off(); /* it would abort */
    struct dense dense;
    const size_t n = (size_t)system->size;
    if (!system->ops->linearise)
        return NULL;
    struct mode_rate *modes = malloc(2 * n * sizeof *modes);
    int code = dense_make(&dense, n) || !modes ||
               system_linearise(system, JACOBIAN_EXACT, t, q, v) || fill(system, &dense);
    if (!code) {
        gsl_eigen_nonsymmv_params(1, dense.work); /* balanced: rates differ by thousands */
        code = gsl_eigen_nonsymmv(dense.companion, dense.values, dense.vectors, dense.work);
    }
    for (size_t i = 0; i < 2 * n && !code; i++) {
        const gsl_complex z = gsl_vector_complex_get(dense.values, i);
        const double complex rate = GSL_REAL(z) + I * GSL_IMAG(z);
        modes[i].rate = rate;
        modes[i].partner =
            GSL_IMAG(z) == 0 ? partner_of(system, &dense, i, creal(rate)) : conj(rate);
    }
    dense_free(&dense);
    if (code) {
        free(modes);
        return NULL;
    }
    return modes;
}

/* --- the longest step --- */

static int all_stable(const struct stepper_method *method, const struct mode_rate *modes, int count,
                      double h) {
    for (int i = 0; i < count; i++) {
        const double complex z = h * modes[i].rate, partner = h * modes[i].partner;
        const double allowed = fmax(1, fmax(exp(creal(z)), exp(creal(partner))));
        if (!(cabs(stepper_amplification(method, z, partner)) <= allowed * (1 + 1e-6)))
            return 0;
    }
    return 1;
}

double stable_step(const struct stepper_method *method, const struct mode_rate *modes, int count) {
    const double first = 1e-4, last = 1e4, ratio = 1.02; /* of a turn or time constant */
    double fastest = 0;
    for (int i = 0; i < count; i++)
        fastest = fmax(fastest, cabs(modes[i].rate));
    if (fastest == 0)
        return INFINITY;
    double low = 0, high = first / fastest;
    while (high < last / fastest && all_stable(method, modes, count, high)) {
        low = high;
        high *= ratio;
    }
    if (high >= last / fastest)
        return INFINITY;
    for (int i = 0; i < 40 && low > 0; i++) {
        const double middle = (low + high) / 2;
        *(all_stable(method, modes, count, middle) ? &low : &high) = middle;
    }
    return low;
}

/* --- of a scene --- */

/* Whether they have the same modes: at rest only root and direction may differ, for air and springs
 * know no direction. */
static int same_modes(const struct wisp *a, const struct wisp *b) {
    struct wisp moved = *b;
    memcpy(moved.root, a->root, sizeof moved.root);
    memcpy(moved.direction, a->direction, sizeof moved.direction);
    return memcmp(a, &moved, sizeof moved) == 0;
}

static int is_new(const struct scene *scene, int wisp) {
    for (int i = 0; i < wisp; i++)
        if (same_modes(&scene->wisps[i], &scene->wisps[wisp]))
            return 0;
    return 1;
}

/* Appends a part's modes. 0, or -1. */
static int add_modes(struct part *part, struct mode_rate **all, int *count) {
    const int more = 2 * part->system.size;
    struct mode_rate *modes = system_modes(&part->system, 0, part->q, part->v);
    struct mode_rate *longer = modes ? realloc(*all, (size_t)(*count + more) * sizeof **all) : NULL;
    if (longer) {
        memcpy(longer + *count, modes, (size_t)more * sizeof *modes);
        *all = longer;
        *count += more;
    }
    free(modes);
    return longer ? 0 : -1;
}

struct mode_rate *scene_modes(const struct scene *scene, enum wisp_treatment treatment,
                              int *count) {
    enum { MOST = 250 }; /* unknowns of a wisp: some seconds */
    struct mode_rate *all = NULL;
    struct model *model = scene->problem->create(scene, (int)treatment, 1);
    int code = model ? 0 : -1;
    *count = 0;
    for (int i = 0; !code && i < model->part_count; i++) /* a part is a wisp */
        if (is_new(scene, i))
            code =
                model->parts[i].system.size > MOST ? -1 : add_modes(&model->parts[i], &all, count);
    if (model)
        scene->problem->free(model);
    if (code) {
        free(all);
        return NULL;
    }
    return all;
}
