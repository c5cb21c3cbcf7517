/* What the seam between steppers and the model costs, and what CVODE costs with our vectors and
 * linear solver against CVODE as it comes. */
#include "base/files.h"
#include "integrators/first_order.h"
#include "integrators/linear/sundials_support.h"
#include "measure.h"
#include "run/settings.h"

#include <cvode/cvode.h>
#include <cvode/cvode_ls.h>
#include <nvector/nvector_serial.h>
#include <stdlib.h>
#include <string.h>
#include <sunlinsol/sunlinsol_klu.h>
#include <sunmatrix/sunmatrix_sparse.h>

/* --- the seam: rk4 from its table against rk4 by hand --- */

enum { STEPS = 10, HAND_VECTORS = 9 };
static const double step_length = 1e-4; /* s */

struct advance {
    struct model *model;
    struct stepper **stepper;   /* by part */
    double **q, **v;            /* the start */
    double *work[HAND_VECTORS]; /* of the method by hand */
};

static void begin(const struct advance *a, int i) {
    struct part *part = &a->model->parts[i];
    const size_t bytes = (size_t)part->system.size * sizeof(double);
    memcpy(part->q, a->q[i], bytes);
    memcpy(part->v, a->v[i], bytes);
}

/* As simulation.c does. */
static void advance_by_table(void *ctx) {
    const struct advance *a = ctx;
    for (int i = 0; i < a->model->part_count; i++) {
        struct part *part = &a->model->parts[i];
        begin(a, i);
        for (int k = 0; k < STEPS; k++)
            if (a->stepper[i]->method->step(a->stepper[i], k * step_length, step_length, part->q,
                                            part->v))
                give_up("%s", part->system.reason);
    }
}

/* y <- x + h r for positions and velocities at once */
static void move(int n, double h, const double *q, const double *v, const double *restrict q_rate,
                 const double *restrict v_rate, double *restrict to_q, double *restrict to_v) {
    for (int i = 0; i < n; i++) {
        to_q[i] = q[i] + h * q_rate[i];
        to_v[i] = v[i] + h * v_rate[i];
    }
}

/* A step of the classical method as one writes it when there is no other. */
static int step_by_hand(struct system *s, double *const work[HAND_VECTORS], double t, double h,
                        double *restrict q, double *restrict v) {
    double *q2 = work[0], *v2 = work[1], *v3 = work[2], *v4 = work[3];
    double *a1 = work[4], *a2 = work[5], *a3 = work[6], *a4 = work[7];
    const int n = s->size;
    int code = s->ops->acceleration(s->ctx, t, q, v, a1);
    move(n, h / 2, q, v, v, a1, q2, v2);
    code |= s->ops->acceleration(s->ctx, t + h / 2, q2, v2, a2);
    move(n, h / 2, q, v, v2, a2, q2, v3);
    code |= s->ops->acceleration(s->ctx, t + h / 2, q2, v3, a3);
    move(n, h, q, v, v3, a3, q2, v4);
    code |= s->ops->acceleration(s->ctx, t + h, q2, v4, a4);
    for (int i = 0; i < n; i++) {
        q[i] += h / 6 * (v[i] + 2 * (v2[i] + v3[i]) + v4[i]);
        v[i] += h / 6 * (a1[i] + 2 * (a2[i] + a3[i]) + a4[i]);
    }
    return code;
}

static void advance_by_hand(void *ctx) {
    const struct advance *a = ctx;
    for (int i = 0; i < a->model->part_count; i++) {
        struct part *part = &a->model->parts[i];
        begin(a, i);
        for (int k = 0; k < STEPS; k++)
            if (step_by_hand(&part->system, a->work, k * step_length, step_length, part->q,
                             part->v))
                give_up("%s", part->system.reason);
    }
}

static struct advance *advance_of(const struct scene *scene, const struct wisp_set *set) {
    struct advance *a = zeros(sizeof *a);
    const struct stepper_settings none = {0};
    a->model = moving_model(scene, set, 4);
    const size_t parts = (size_t)a->model->part_count;
    a->stepper = zeros(parts * sizeof *a->stepper);
    a->q = zeros(parts * sizeof *a->q);
    a->v = zeros(parts * sizeof *a->v);
    for (size_t i = 0; i < parts; i++) {
        struct part *part = &a->model->parts[i];
        const size_t bytes = (size_t)part->system.size * sizeof(double);
        a->stepper[i] = stepper_create(stepper_find("rk4"), &none, &part->system);
        a->q[i] = memcpy(zeros(bytes), part->q, bytes);
        a->v[i] = memcpy(zeros(bytes), part->v, bytes);
        for (int k = 0; k < HAND_VECTORS && i == 0; k++)
            a->work[k] = zeros(bytes);
    }
    return a;
}

static void enter_seam(struct contest *contest, const struct scene *scene) {
    for (int samples = 0; samples <= 4; samples += 4) {
        const struct wisp_set set = {WISP_GENERALISED, BENDING_SKIP, samples, 64};
        char subject[SUBJECT_SIZE];
        struct advance *a = advance_of(scene, &set);
        wisp_set_subject(&set, subject);
        contest_add(contest, "seam", subject, "stepper", STEPS * set.wisps, advance_by_table, a);
        contest_add(contest, "seam", subject, "by hand", STEPS * set.wisps, advance_by_hand, a);
    }
}

/* --- CVODE --- */

static const double cvode_end = 0.1; /* s: a wisp let go from rest falls by 5 cm */

/* Ours: the stepper of the registry on a part of 1 wisp. */
struct ours {
    struct advance *start;
    struct stepper *stepper;
    long steps;
};

static void run_ours(void *ctx) {
    struct ours *o = ctx;
    struct part *part = &o->start->model->parts[0];
    double t = 0;
    begin(o->start, 0);
    o->stepper->method->reset(o->stepper, ~0u);
    for (o->steps = 0; t < cvode_end; o->steps++)
        if (o->stepper->method->advance(o->stepper, &t, cvode_end, part->q, part->v))
            give_up("%s", part->system.reason);
}

/* As it comes: its own vectors, a sparse matrix of the first-order system (q' = v, v' = a), KLU. */
struct stock {
    struct part *part;
    double *q, *v; /* the start */
    SUNContext context;
    void *cvode;
    N_Vector y;
    SUNMatrix jacobian;
    SUNLinearSolver klu;
    double *mass; /* values in the order of the pattern: M, M - D, M - K */
    double *with_damping, *with_stiffness;
};

static int stock_rate(sunrealtype t, N_Vector y, N_Vector rate, void *ctx) {
    struct stock *s = ctx;
    return first_order_rate(&s->part->system, t, N_VGetArrayPointer(y), N_VGetArrayPointer(rate));
}

/* A column of the Jacobian: first its entry on the upper half, explicit zeros included, then those
 * of M^-1 K or M^-1 D; M is diagonal here, for there are no samples. */
static int put_column(const struct sparse_matrix *p, int column, double upper, const double *mass,
                      const double *with, SUNMatrix J, int at) {
    const int n = p->size;
    SM_INDEXVALS_S(J)[at] = column;
    SM_DATA_S(J)[at++] = upper;
    for (int i = p->column_start[column]; i < p->column_start[column + 1]; i++) {
        int diagonal = p->column_start[p->row[i]];
        while (p->row[diagonal] != p->row[i])
            diagonal++;
        SM_INDEXVALS_S(J)[at] = n + p->row[i];
        SM_DATA_S(J)[at++] = (mass[i] - with[i]) / mass[diagonal];
    }
    return at;
}

static int stock_jacobian(sunrealtype t, N_Vector y, N_Vector rate, SUNMatrix J, void *ctx,
                          N_Vector work_1, N_Vector work_2, N_Vector work_3) {
    (void)rate, (void)work_1, (void)work_2, (void)work_3;
    struct stock *s = ctx;
    struct system *system = &s->part->system;
    const struct sparse_matrix *p = system->pattern;
    const double *q = N_VGetArrayPointer(y);
    const int n = system->size;
    int at = 0;
    if (system_linearise(system, JACOBIAN_SPD, t, q, q + n))
        return 1;
    system_assemble(system, 1, 0, s->with_damping);
    system_assemble(system, 0, 1, s->with_stiffness);
    for (int half = 0; half < 2; half++)
        for (int j = 0; j < n; j++) {
            SM_INDEXPTRS_S(J)[half * n + j] = at;
            at = put_column(p, j, half, s->mass, half ? s->with_damping : s->with_stiffness, J, at);
        }
    SM_INDEXPTRS_S(J)[2 * n] = at;
    return 0;
}

static void stock_begin(struct stock *s) {
    const size_t bytes = (size_t)s->part->system.size * sizeof(double);
    memcpy(N_VGetArrayPointer(s->y), s->q, bytes);
    memcpy(N_VGetArrayPointer(s->y) + s->part->system.size, s->v, bytes);
}

void stock_run(struct stock *s, double end, int frames, double *positions) {
    const int n = s->part->system.size;
    double t = 0;
    stock_begin(s);
    if (CVodeReInit(s->cvode, 0, s->y) < 0)
        give_up("cvode cannot begin");
    for (int f = 1; f <= frames; f++) {
        if (CVodeSetStopTime(s->cvode, f * end / frames) < 0 ||
            CVode(s->cvode, f * end / frames, s->y, &t, CV_NORMAL) < 0)
            give_up("cvode failed at %g s", t);
        if (positions)
            memcpy(positions + f * n, N_VGetArrayPointer(s->y), (size_t)n * sizeof(double));
    }
}

static void run_stock(void *ctx) {
    stock_run(ctx, cvode_end, 1, NULL);
}

void stock_free(struct stock *s) {
    N_VDestroy(s->y);
    CVodeFree(&s->cvode);
    SUNLinSolFree(s->klu);
    SUNMatDestroy(s->jacobian);
    SUNContext_Free(&s->context);
    free(s->mass);
    free(s->with_damping);
    free(s->with_stiffness);
    free(s->q);
    free(s->v);
    free(s);
}

static void stock_solver(struct stock *s, const struct sparse_matrix *p) {
    const int entries = 2 * (p->size + p->column_start[p->size]);
    SUNMatrix J = SUNSparseMatrix(2 * p->size, 2 * p->size, entries, CSC_MAT, s->context);
    /* KLU analyses the pattern when it is made known to CVODE, so it is filled once before. */
    stock_begin(s);
    if (!J || stock_jacobian(0, s->y, s->y, J, s, NULL, NULL, NULL))
        give_up("no sparse matrix");
    s->jacobian = J;
    s->klu = SUNLinSol_KLU(s->y, J, s->context);
    if (!s->klu || CVodeSetLinearSolver(s->cvode, s->klu, J) < 0 ||
        CVodeSetJacFn(s->cvode, stock_jacobian) < 0)
        give_up("no KLU in SUNDIALS");
}

struct stock *stock_create(struct part *part, double rtol, double atol, long frequency) {
    struct stock *s = zeros(sizeof *s);
    struct system *system = &part->system;
    const size_t size = (size_t)system->size * sizeof(double);
    s->part = part;
    s->q = memcpy(zeros(size), part->q, size);
    s->v = memcpy(zeros(size), part->v, size);
    const struct sparse_matrix *p = system->pattern;
    const size_t bytes = (size_t)p->column_start[p->size] * sizeof(double);
    s->mass = zeros(bytes);
    s->with_damping = zeros(bytes);
    s->with_stiffness = zeros(bytes);
    if (system_linearise(system, JACOBIAN_SPD, 0, s->q, s->v) ||
        SUNContext_Create(SUN_COMM_NULL, &s->context) < 0)
        give_up("no SUNDIALS context");
    system_assemble(system, 0, 0, s->mass);
    s->y = N_VNew_Serial(2 * system->size, s->context);
    s->cvode = CVodeCreate(CV_BDF, s->context);
    if (!s->y || !s->cvode || CVodeInit(s->cvode, stock_rate, 0, s->y) < 0 ||
        CVodeSStolerances(s->cvode, rtol, atol) < 0 || CVodeSetUserData(s->cvode, s) < 0 ||
        CVodeSetMaxNumSteps(s->cvode, -1) < 0)
        give_up("no CVODE");
    stock_solver(s, p);
    if (frequency > 0 && (CVodeSetLSetupFrequency(s->cvode, frequency) < 0 ||
                          CVodeSetJacEvalFrequency(s->cvode, frequency) < 0))
        give_up("no CVODE");
    return s;
}

static void enter_stock(struct contest *contest, const struct advance *start, const char *subject,
                        const char *name, double rtol, double atol, long frequency) {
    begin(start, 0);
    struct stock *s = stock_create(&start->model->parts[0], rtol, atol, frequency);
    long steps = 0;
    run_stock(s);
    CVodeGetNumSteps(s->cvode, &steps);
    contest_note(contest, "cvode steps", subject, name, (double)steps);
    contest_add(contest, "cvode", subject, name, (double)steps, run_stock, s);
}

static void enter_ours(struct contest *contest, const struct scene *scene, struct advance *start,
                       const char *subject, double rtol, double atol) {
    const struct run_request request = {
        .stepper = "cvode", .linear = "direct", .rtol = rtol, .atol = atol};
    struct settings settings;
    char reason[REASON_SIZE];
    struct ours *o = zeros(sizeof *o);
    o->start = start;
    if (settings_resolve(scene, &request, &settings, reason))
        give_up("%s", reason);
    o->stepper = stepper_create(settings.method, &settings.stepper, &start->model->parts[0].system);
    if (!o->stepper)
        out_of_memory();
    run_ours(o);
    contest_note(contest, "cvode steps", subject, "ours", (double)o->steps);
    contest_add(contest, "cvode", subject, "ours", (double)o->steps, run_ours, o);
}

/* A part of 1 wisp without samples, as a run of cvode has it. */
static struct advance *lone_wisp(const struct scene *scene) {
    const struct wisp_set set = {WISP_GENERALISED, BENDING_SKIP, 0, 1};
    struct advance *a = zeros(sizeof *a);
    a->model = resting_model(scene, &set, 1);
    const struct part *part = &a->model->parts[0];
    const size_t bytes = (size_t)part->system.size * sizeof(double);
    a->q = zeros(sizeof *a->q);
    a->v = zeros(sizeof *a->v);
    a->q[0] = memcpy(zeros(bytes), part->q, bytes);
    a->v[0] = memcpy(zeros(bytes), part->v, bytes);
    return a;
}

void enter_steppers(struct contest *contest, const struct scene *scene) {
    static const double rtol[] = {1e-4, 1e-6};
    enter_seam(contest, scene);
    struct advance *start = lone_wisp(scene);
    for (int i = 0; i < 2; i++) {
        char subject[SUBJECT_SIZE];
        snprintf(subject, sizeof subject, "rtol %g", rtol[i]);
        enter_ours(contest, scene, start, subject, rtol[i], 1e-3 * rtol[i]);
        enter_stock(contest, start, subject, "stock", rtol[i], 1e-3 * rtol[i], 0);
        enter_stock(contest, start, subject, "stock, our settings", rtol[i], 1e-3 * rtol[i], 5);
    }
}
