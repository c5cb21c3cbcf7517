#include "limit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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

int penalty_limit(const struct table *const *tables, const double *ratio, int count,
                  struct table *limit) {
    enum { LABELS = 3 };
    const struct table *first = tables[0];
    const size_t size = (size_t)(first->row_count * first->column_count);
    *limit = (struct table){.row_count = first->row_count, .column_count = first->column_count};
    for (int i = 0; i < count; i++)
        if (tables[i]->row_count != first->row_count)
            return -1;
    limit->value = calloc(size + 1, sizeof(double));
    if (!limit->value)
        return -1;
    for (size_t k = 0; k < size; k++) {
        if (k % (size_t)first->column_count < LABELS)
            limit->value[k] = first->value[k];
        else
            for (int i = 0; i < count; i++)
                limit->value[k] += limit_weight(ratio, count, i) * tables[i]->value[k];
    }
    memcpy(limit->name, first->name, sizeof limit->name); /* lent */
    return 0;
}
