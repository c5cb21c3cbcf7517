#include "limit.h"

#include <math.h>
#include <stdlib.h>

/* The samples' damper sees them move with the line as it turns, and pushes them off it by
 * c_p r da/dt / k_p ~ 1/sqrt(ratio); so the motion is a series in e = 1/sqrt(ratio), whose first
 * term is small but there. Lagrange's polynomial in e through `count` of the runs, at e = 0: the
 * weight of run i is the product over the others of e_j / (e_j - e_i). */
static double limit_weight(const double *ratio, int count, int i) {
    double weight = 1;
    for (int j = 0; j < count; j++)
        if (j != i)
            weight *= sqrt(ratio[i]) / (sqrt(ratio[i]) - sqrt(ratio[j]));
    return weight;
}

int penalty_limit(const struct trajectory *const *runs, const double *ratio, int count,
                  struct trajectory *limit) {
    const struct table *first = &runs[0]->table;
    const size_t size = (size_t)(first->row_count * first->column_count);
    *limit = *runs[0];
    limit->table.value = NULL;
    for (int i = 0; i < count; i++)
        if (runs[i]->table.row_count != first->row_count)
            return -1;
    double *value = limit->table.value = calloc(size + 1, sizeof *value);
    if (!value)
        return -1;
    for (size_t k = 0; k < size; k++) {
        if (k % (size_t)first->column_count < STATE_X)
            value[k] = first->value[k];
        else
            for (int i = 0; i < count; i++)
                value[k] += limit_weight(ratio, count, i) * runs[i]->table.value[k];
    }
    return 0;
}
