/* Stability functions from the theory and not from the tables of the program. */
#ifndef WISPLAB_TESTS_CLOSED_FORMS_H
#define WISPLAB_TESTS_CLOSED_FORMS_H

#include <complex.h>

struct closed_form {
    const char *stepper;
    double complex (*r)(double complex z);
};
enum { CLOSED_FORMS = 4 };
extern const struct closed_form closed_forms[CLOSED_FORMS];

/* R(z) of a stepper of the list; stops the test where it is of none. */
double complex closed_form(const char *stepper, double complex z);

#endif
