/* A cell of the search for the longest stable step: places and steps, the runs of a method in it,
 * and the errors that they may have. */
#include "model/problems.h"
#include "stability_limits.h"

#include <math.h>

static const double beyond_order = 10; /* order is lost beyond this times the error it predicts */
static const double never_lost = 1e-4; /* m: with an error below it it is not */

double limits_step(const struct cell *cell, int place) {
    return place < 0 ? NAN : place_step(1 / stop_rate(cell->scene), LIMITS_STRIDE, place);
}

int limits_place(const struct cell *cell, double step) {
    return step_place(1 / stop_rate(cell->scene), LIMITS_STRIDE, step);
}

double limits_allowed(const struct cell *cell, const struct trial *trial, enum aim_kind aim,
                      double step) {
    const double share_of_length = 0.05, millimetre = 1e-3;
    const int order = trial->configuration->method->order;
    switch (aim) {
    case NEAR:
        return share_of_length * longest_wisp(cell->scene);
    case MILLIMETRE:
        return millimetre;
    default:
        return fmax(never_lost,
                    beyond_order * trial->anchor_error * pow(step / trial->anchor_step, order));
    }
}

const char *limits_treatment(const struct cell *cell) {
    return wisp_problem.treatments[cell->treatment].name;
}

struct run_request limits_request(const struct cell *cell,
                                  const struct configuration *configuration, double step) {
    struct run_request request =
        configuration_request(configuration, step, cell->scene->run.atol / cell->scene->run.rtol);
    request.treatment = limits_treatment(cell);
    request.diagnostics = 1; /* a run whose energy nobody accounts for has diverged */
    return request;
}
