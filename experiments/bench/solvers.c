/* The linear solvers of the implicit step on wisps: Jacobians, factors and solutions. */
#include "measure.h"

#include <math.h>

/* A solver for each part of a model, with right sides like those of an implicit Euler step. */
struct solving {
    struct model *model;
    struct linear_solver **solver; /* one for each part; NULL: none is asked for */
    double **b, **x;
    double h; /* s */
    int stay; /* times that a stage is done to a part before the next part's turn */
};

/* A run stays with a part from stop to stop, so that a stage finds in the cache what the one before
 * it left; 200 wisps together do not fit. Stages of a microsecond are therefore repeated on each
 * part. */
enum { STAY = 8 };

static void check(int code, const struct part *part) {
    if (code)
        give_up("%s", part->system.reason);
}

static void evaluate(void *ctx) {
    const struct solving *s = ctx;
    for (int n = 0; n < s->stay * s->model->part_count; n++) {
        const int i = n / s->stay;
        struct part *part = &s->model->parts[i];
        check(system_acceleration(&part->system, 0, part->q, part->v, s->x[i]), part);
    }
}

static void linearise(void *ctx) {
    const struct solving *s = ctx;
    for (int n = 0; n < s->stay * s->model->part_count; n++) {
        const int i = n / s->stay;
        struct part *part = &s->model->parts[i];
        check(system_linearise(&part->system, JACOBIAN_SPD, 0, part->q, part->v), part);
    }
}

/* As a general sparse matrix; part of the factor of klu and cholmod. */
static void assemble(void *ctx) {
    const struct solving *s = ctx;
    static double values[1 << 16];
    for (int i = 0; i < s->model->part_count; i++)
        system_assemble(&s->model->parts[i].system, s->h, s->h * s->h, values);
}

static void factor(void *ctx) {
    const struct solving *s = ctx;
    for (int n = 0; n < s->stay * s->model->part_count; n++)
        check(linear_factor(s->solver[n / s->stay], s->h, s->h * s->h),
              &s->model->parts[n / s->stay]);
}

static void solve(void *ctx) {
    const struct solving *s = ctx;
    for (int n = 0; n < s->stay * s->model->part_count; n++)
        check(linear_solve(s->solver[n / s->stay], s->b[n / s->stay], s->x[n / s->stay]),
              &s->model->parts[n / s->stay]);
}

/* b = h M a, the right side of an implicit Euler step without its term in h^2 K v. */
static struct solving *solving_of(struct model *model, double h, int stay) {
    struct solving *s = zeros(sizeof *s);
    const size_t parts = (size_t)model->part_count;
    s->model = model;
    s->h = h;
    s->stay = stay;
    s->solver = zeros(parts * sizeof *s->solver);
    s->b = zeros(parts * sizeof *s->b);
    s->x = zeros(parts * sizeof *s->x);
    for (size_t i = 0; i < parts; i++) {
        const size_t bytes = (size_t)model->parts[i].system.size * sizeof(double);
        s->b[i] = zeros(bytes);
        s->x[i] = zeros(bytes);
    }
    linearise(s);
    evaluate(s);
    for (size_t i = 0; i < parts; i++)
        system_product(&model->parts[i].system, h, 0, 0, s->x[i], s->b[i]);
    return s;
}

static void create_solvers(struct solving *s, const struct linear_method *method) {
    const struct options defaults = {0};
    for (int i = 0; i < s->model->part_count; i++) {
        s->solver[i] = linear_create(method, &s->model->parts[i].system, &defaults);
        if (!s->solver[i])
            out_of_memory();
    }
}

/* Residual over right side of the first part: a solver that does not solve is not fast. */
static double residual(const struct solving *s) {
    struct system *system = &s->model->parts[0].system;
    double *y = zeros((size_t)system->size * sizeof *y), rest = 0, whole = 0;
    factor((void *)s);
    solve((void *)s);
    system_product(system, 1, -s->h, -s->h * s->h, s->x[0], y);
    for (int i = 0; i < system->size; i++) {
        rest += (y[i] - s->b[0][i]) * (y[i] - s->b[0][i]);
        whole += s->b[0][i] * s->b[0][i];
    }
    return sqrt(rest / whole);
}

static void enter_solver(struct contest *contest, struct solving *s, const char *subject,
                         const char *method, int wisps) {
    char name[2][32];
    const int lanes = s->model->parts[0].system.lanes;
    create_solvers(s, linear_find(method));
    snprintf(name[0], sizeof name[0], "factor %s %d %g", method, lanes, s->h);
    snprintf(name[1], sizeof name[1], "solve %s %d %g", method, lanes, s->h);
    const double rest = residual(s);
    if (!(rest < 1e-6))
        give_up("%s, %s: residual %g", subject, name[1], rest);
    const long long before = s->model->parts[0].system.counters.linear_iterations;
    check(linear_solve(s->solver[0], s->b[0], s->x[0]), &s->model->parts[0]);
    contest_note(contest, "iterations", subject, name[1],
                 (double)(s->model->parts[0].system.counters.linear_iterations - before));
    contest_add(contest, "solver", subject, name[0], wisps * s->stay, factor, s);
    contest_add(contest, "solver", subject, name[1], wisps * s->stay, solve, s);
}

static void enter_set(struct contest *contest, const struct scene *scene,
                      const struct wisp_set *set) {
    static const double steps[] = {1e-4, 1e-3, 1e-2};
    char subject[SUBJECT_SIZE];
    wisp_set_subject(set, subject);
    struct model *wide = moving_model(scene, set, 4), *narrow = moving_model(scene, set, 1);
    struct solving *four = solving_of(wide, 1e-3, STAY), *one = solving_of(narrow, 1e-3, STAY);
    contest_add(contest, "solver", subject, "evaluation 4", STAY * set->wisps, evaluate, four);
    contest_add(contest, "solver", subject, "linearise 4", STAY * set->wisps, linearise, four);
    enter_solver(contest, four, subject, "direct", set->wisps);
    contest_add(contest, "solver", subject, "evaluation 1", STAY * set->wisps, evaluate, one);
    contest_add(contest, "solver", subject, "linearise 1", STAY * set->wisps, linearise, one);
    contest_add(contest, "solver", subject, "assemble 1", set->wisps, assemble, one);
    enter_solver(contest, one, subject, "direct", set->wisps);
    enter_solver(contest, solving_of(narrow, 1e-3, 1), subject, "klu", set->wisps);
    enter_solver(contest, solving_of(narrow, 1e-3, 1), subject, "cholmod", set->wisps);
    for (int i = 0; i < 3; i++)
        enter_solver(contest, solving_of(narrow, steps[i], 1), subject, "cg", set->wisps);
}

void enter_solvers(struct contest *contest, const struct scene *scene) {
    for (int samples = 0; samples <= 4; samples += 4)
        for (int wisps = 1; wisps <= 200; wisps += 199) {
            const struct wisp_set set = {WISP_GENERALISED, BENDING_SKIP, samples, wisps};
            enter_set(contest, scene, &set);
        }
}
