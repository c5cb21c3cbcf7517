/* Evaluations of the accelerations: the kernel with 4, 1 and 8 lanes, and its plain twin. */
#include "measure.h"

#include <math.h>

/* All parts in turn, as in a run; accelerations of each have a place of their own. */
struct evaluation {
    struct model *model;
    double **a;
};

static void evaluate(void *ctx) {
    const struct evaluation *e = ctx;
    for (int i = 0; i < e->model->part_count; i++) {
        struct part *part = &e->model->parts[i];
        if (system_acceleration(&part->system, 0, part->q, part->v, e->a[i]))
            give_up("%s", part->system.reason);
    }
}

static void evaluate_twins(void *ctx) {
    const struct twins *t = ctx;
    for (int k = 0; k < t->count; k++) {
        const int at = k * t->size;
        if (wisp_twin_acceleration(&t->twin[k], 0, t->q + at, t->v + at, t->a + at))
            give_up("the twin has no acceleration");
    }
}

static struct evaluation *evaluation_of(const struct scene *scene, const struct wisp_set *set,
                                        int lanes) {
    struct evaluation *e = zeros(sizeof *e);
    e->model = moving_model(scene, set, lanes);
    e->a = zeros((size_t)e->model->part_count * sizeof *e->a);
    for (int i = 0; i < e->model->part_count; i++)
        e->a[i] = zeros((size_t)e->model->parts[i].system.size * sizeof(double));
    return e;
}

/* Largest difference of the kernel's accelerations from the twin's, over what the twin sums them
 * from: who computes something else is not faster. */
static double difference(const struct evaluation *e, const struct twins *twins) {
    double most = 0, *scale = zeros((size_t)twins->size * sizeof *scale);
    const int lanes = e->model->parts[0].system.lanes;
    for (int k = 0; k < twins->count; k++) {
        const double *a = twins->a + k * twins->size;
        wisp_twin_scale(&twins->twin[k], 0, twins->q + k * twins->size, twins->v + k * twins->size,
                        scale);
        for (int i = 0; i < twins->size; i++) {
            const double other = e->a[k / lanes][i * lanes + k % lanes];
            most = fmax(most, fabs(other - a[i]) / scale[i]);
        }
    }
    return most;
}

/* Counts by stepping through one part's evaluation, per free node. */
static void note_executed(struct contest *contest, const char *subject, const char *lanes,
                          const struct evaluation *e) {
    double executed[EXECUTED_KINDS];
    struct part *part = &e->model->parts[0];
    if (trace_evaluation(&part->system, part->q, part->v, e->a[0], executed))
        return;
    for (int k = 0; k < EXECUTED_KINDS; k++) {
        char name[32];
        snprintf(name, sizeof name, "%s %s", executed_names[k], lanes);
        contest_note(contest, "executed", subject, name, executed[k] / (KERNEL_NODES - 2));
    }
}

static void enter_set(struct contest *contest, const struct scene *scene,
                      const struct wisp_set *set) {
    static const char *const names[] = {"kernel 4", "kernel 1", "kernel 8"};
    static const int lanes[] = {4, 1, 8};
    const double units = set->wisps * (KERNEL_NODES - 2.);
    char subject[SUBJECT_SIZE];
    struct twins *twins = moving_twins(scene, set);
    wisp_set_subject(set, subject);
    evaluate_twins(twins);
    for (int i = 0; i < 3; i++) {
        struct evaluation *e = evaluation_of(scene, set, lanes[i]);
        evaluate(e);
        const double off = difference(e, twins);
        if (!(off < 1e-12))
            give_up("%s, %s: differs from its twin by %g", subject, names[i], off);
        contest_note(contest, "difference", subject, names[i], off);
        if (set->wisps == 64 && set->samples <= 4)
            note_executed(contest, subject, names[i], e);
        contest_add(contest, "evaluation", subject, names[i], units, evaluate, e);
    }
    contest_add(contest, "evaluation", subject, "twin", units, evaluate_twins, twins);
}

void enter_evaluations(struct contest *contest, const struct scene *scene) {
    static const int batches[] = {4, 64, 256};
    struct wisp_set sets[WISP_SETS_MAX];
    char subject[SUBJECT_SIZE];
    for (int b = 0; b < 3; b++) {
        const int count = wisp_sets(batches[b], sets);
        for (int i = 0; i < count; i++) {
            if (i == 0 || sets[i].bending != sets[i - 1].bending) {
                rates_subject(&sets[i], subject);
                enter_rates(contest, subject);
            }
            enter_set(contest, scene, &sets[i]);
        }
    }
}
