#include "first_order.h"

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
    int finite = 1;
    for (int i = 0; i < 2 * n; i++)
        finite &= isfinite(rate[i]) != 0;
    return finite ? 0 : system_fail(system, NOT_FINITE, "a rate is not finite at t = %.9g s", t);
}

int step_is_lost(double t, double h) {
    return h < 10 * DBL_EPSILON * fabs(t);
}
