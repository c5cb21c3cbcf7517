#include "search.h"

#include <math.h>

struct bracket bracket_begin(int at, int coarsest) {
    return (struct bracket){.at = at, .coarsest = coarsest, .missed = -1, .reached = -1};
}

int bracket_take(struct bracket *b, int reached, int stride, int resolution) {
    *(reached ? &b->reached : &b->missed) = b->at;
    if (b->reached < 0)
        b->at = b->missed + stride;
    else if (b->missed >= 0)
        b->at = (b->missed + b->reached) / 2;
    else
        b->at = b->reached - stride > b->coarsest ? b->reached - stride : b->coarsest;
    if (b->reached < 0)
        return 1;
    return b->missed < 0 ? b->reached > b->coarsest : b->reached - b->missed > resolution;
}

double place_step(double interval, int stride, int place) {
    return interval / round(exp2((double)place / stride));
}

int step_place(double interval, int stride, double step) {
    const int near = (int)floor(stride * log2(interval / step)) - stride;
    int place = near > 0 ? near : 0;
    while (place_step(interval, stride, place) > step * (1 + 1e-12))
        place++;
    return place;
}

int judge_runs(struct plan *plan, int first, int count, const struct scene *scene,
               const struct run_files *reference, struct verdict *verdict) {
    *verdict = (struct verdict){0, FINISHED, NAN};
    for (int i = first; i < first + count && verdict->outcome == FINISHED; i++) {
        struct run_files run;
        struct deviation deviation;
        int code = 0;
        if (plan_read(plan, &plan->cases[i], &run))
            return -1;
        if (run.outcome == FINISHED) {
            code = measure_deviation(scene, run.states, reference->states, 1, &deviation,
                                     plan->reason);
            verdict->error = fmax(verdict->error, deviation.rms);
        } else {
            *verdict = (struct verdict){NAN, run.outcome, run_number(&run, "failure_time")};
        }
        run_free(&run);
        if (code)
            return -1;
    }
    return 0;
}

int searches_go_on(struct plan *plan, const struct searches *s) {
    struct run_files reference;
    int left = 0, code = 0;
    for (int i = 0; i < s->count; i++)
        left += !s->is_done(s->ctx, i);
    if (left == 0)
        return 0;
    if (plan_read(plan, &plan->cases[s->reference], &reference))
        return -1;
    for (int i = 0; i < s->count && !code; i++)
        if (!s->is_done(s->ctx, i))
            code = s->go_on(plan, s->ctx, i, &reference);
    run_free(&reference);
    return code ? -1 : 0;
}

int read_cost(struct plan *plan, int at, struct cost *cost) {
    struct run_files run;
    if (run_read(&run, plan->cases[at].run.folder, plan->reason))
        return -1;
    *cost = run_cost(&run);
    run_free(&run);
    return 0;
}
