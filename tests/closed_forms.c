/* Hairer & Wanner, Solving ODEs II, section IV.2: the Taylor polynomial of exp for explicit methods
 * of order = stages, and 1 / (1 - z) of implicit Euler. */
#include "closed_forms.h"

#include <criterion/criterion.h>
#include <string.h>

static double complex euler(double complex z) {
    return 1 + z;
}

static double complex midpoint(double complex z) {
    return 1 + z + z * z / 2;
}

static double complex rk4(double complex z) {
    return 1 + z + z * z / 2 + z * z * z / 6 + z * z * z * z / 24;
}

static double complex implicit_euler(double complex z) {
    return 1 / (1 - z);
}

const struct closed_form closed_forms[CLOSED_FORMS] = {
    {"euler", euler}, {"midpoint", midpoint}, {"rk4", rk4}, {"implicit-euler", implicit_euler}};

double complex closed_form(const char *stepper, double complex z) {
    for (int i = 0; i < CLOSED_FORMS; i++)
        if (strcmp(closed_forms[i].stepper, stepper) == 0)
            return closed_forms[i].r(z);
    cr_assert_fail("%s has no stability function in tests/closed_forms.c", stepper);
    return 0;
}
