#include "first_order.h"

#include "base/vector.h"

#include <float.h>
#include <math.h>
#include <string.h>

int first_order_rate(struct system *system, double t, const double *y, double *rate) {
    const int n = system->size;
    const double *q = y, *v = y + n;
    memcpy(rate, v, (size_t)n * sizeof(double));
    const int code = system_acceleration(system, t, q, v, rate + n);
    if (code)
        return code;
    return all_finite(rate, 2 * n)
               ? 0
               : system_fail(system, NOT_FINITE, "a rate is not finite at t = %.9g s", t);
}

int step_is_lost(double t, double h) {
    return h < 10 * DBL_EPSILON * fabs(t);
}
