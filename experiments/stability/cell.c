/* A cell of the search for the longest stable step: places and steps, the runs of a method in it,
 * and when an error is wrong. */
#include "base/table.h"
#include "model/problems.h"
#include "stability_limits.h"

#include <math.h>

static const double beyond_order = 10;  /* an error is wrong beyond this times what order says */
static const double never_wrong = 1e-4; /* m: an error below it is not */

double limits_step(const struct cell *cell, int place) {
    return place < 0 ? NAN : place_step(1 / stop_rate(cell->scene), LIMITS_STRIDE, place);
}

int limits_place(const struct cell *cell, double step) {
    return step_place(1 / stop_rate(cell->scene), LIMITS_STRIDE, step);
}

double limits_tolerated(const struct trial *trial, double step) {
    const int order = trial->contestant->method->order;
    const double by_order = trial->anchor_error * pow(step / trial->anchor_step, order);
    return fmax(never_wrong, beyond_order * by_order);
}

double limits_first_wrong(const struct table *run, const struct table *tight, double bound) {
    enum { X = 3 };
    for (int i = 0; i < run->row_count && i < tight->row_count; i++) {
        double square = 0;
        for (int k = X; k < X + 3; k++)
            square += pow(table_value(run, i, k) - table_value(tight, i, k), 2);
        if (!(sqrt(square) <= bound))
            return table_value(run, i, 0);
    }
    return NAN;
}

const char *limits_treatment(const struct cell *cell) {
    return wisp_problem.treatments[cell->treatment].name;
}

struct run_request limits_request(const struct cell *cell, const struct configuration *contestant,
                                  double step) {
    struct run_request request =
        contestant_request(contestant, step, cell->scene->run.atol / cell->scene->run.rtol);
    request.treatment = limits_treatment(cell);
    return request;
}
