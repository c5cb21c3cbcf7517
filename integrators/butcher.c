#include "butcher.h"

const double *butcher_row(const struct butcher_table *table, int i) {
    return table->a + i * table->stages;
}

double complex butcher_stability(const struct butcher_table *table, double complex z) {
    const int s = table->stages;
    double complex m[s][s], x[s];

    for (int i = 0; i < s; i++) {
        for (int j = 0; j < s; j++)
            m[i][j] = (i == j) - z * butcher_row(table, i)[j];
        x[i] = 1;
    }
    /* Elimination without pivoting: the diagonal is 1 - z a_ii and the tables are triangular. */
    for (int k = 0; k < s; k++)
        for (int i = k + 1; i < s; i++) {
            const double complex factor = m[i][k] / m[k][k];
            for (int j = k; j < s; j++)
                m[i][j] -= factor * m[k][j];
            x[i] -= factor * x[k];
        }
    double complex sum = 0;
    for (int i = s - 1; i >= 0; i--) {
        for (int j = i + 1; j < s; j++)
            x[i] -= m[i][j] * x[j];
        x[i] /= m[i][i];
        sum += table->b[i] * x[i];
    }
    return 1 + z * sum;
}
