#include "energy.h"

double energies_sum(const struct energies *energies) {
    double sum = 0;
#define X(name, meaning) sum += energies->name;
    ENERGIES(X)
#undef X
    return sum;
}

double powers_sum(const struct powers *powers) {
    double sum = 0;
#define X(name, meaning) sum += powers->name;
    POWERS(X)
#undef X
    return sum;
}
