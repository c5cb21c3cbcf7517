#include "configurations.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define OPTIONS(...)        \
    (const char *const[]) { \
        __VA_ARGS__, NULL   \
    }

/* Colours are Okabe and Ito's (doi 10.1038/nmeth.1618), and where these do not do darker ones;
 * variants have marks of other methods. A row is its name, its stepper's, and what is not 0. */
static const struct configuration table[] = {
    {"euler", "euler", .kind = CONFIGURATION_PLAIN, .cost = 5e-9, .colour = "#D55E00", .mark = 7},

    {"midpoint", "midpoint", .kind = CONFIGURATION_PLAIN, .cost = 10e-9, .colour = "#E69F00",
     .mark = 5},

    {"rk4", "rk4", .kind = CONFIGURATION_PLAIN, .cost = 20e-9, .colour = "#0072B2", .mark = 9},

    {"symplectic-euler", "symplectic-euler", .kind = CONFIGURATION_PLAIN, .cost = 4e-9,
     .colour = "#8C8C00", .mark = 6},

    {"drift-kick", "drift-kick", .kind = CONFIGURATION_PLAIN, .cost = 4.5e-9, .colour = "#7A5230",
     .mark = 4},

    {"implicit-euler", "implicit-euler", .linear = "direct", .kind = CONFIGURATION_PLAIN,
     .cost = 30e-9, .colour = "#009E73", .mark = 13},
    {"implicit-euler newton", "implicit-euler", .linear = "direct",
     .options = OPTIONS("newton.iterations=30"), .kind = CONFIGURATION_ITERATED, .cost = 170e-9,
     .mark = 12},
    {"implicit-euler cg", "implicit-euler", .linear = "cg", .kind = CONFIGURATION_SOLVER,
     .cost = 180e-9, .mark = 1},
    {"implicit-euler cg newton", "implicit-euler", .linear = "cg",
     .options = OPTIONS("newton.iterations=30"), .kind = CONFIGURATION_SOLVER_ITERATED,
     .cost = 700e-9, .mark = 3},
    {"implicit-euler klu", "implicit-euler", .linear = "klu", .options = OPTIONS("jacobian=exact"),
     .kind = CONFIGURATION_SOLVER_DETAILS, .mark = 4},
    {"implicit-euler klu newton", "implicit-euler", .linear = "klu",
     .options = OPTIONS("jacobian=exact", "newton.iterations=30"),
     .kind = CONFIGURATION_SOLVER_DETAILS, .mark = 5},
    {"implicit-euler cg 1e-2", "implicit-euler", .linear = "cg",
     .options = OPTIONS("cg.tolerance=1e-2"), .kind = CONFIGURATION_SOLVER_DETAILS, .mark = 6},
    {"implicit-euler cg 1e-4", "implicit-euler", .linear = "cg",
     .options = OPTIONS("cg.tolerance=1e-4"), .kind = CONFIGURATION_SOLVER_DETAILS, .mark = 7},

    {"linear-euler", "linear-euler", .kind = CONFIGURATION_PLAIN, .cost = 12e-9,
     .colour = "#56B4E9", .mark = 8},
    {"linear-euler stretch", "linear-euler", .options = OPTIONS("matrix=stretch"),
     .kind = CONFIGURATION_MATRIX, .cost = 9e-9, .mark = 5},

    {"exponential", "exponential", .kind = CONFIGURATION_COSTLY, .cost = 15e-6, .colour = "#44AA99",
     .mark = 3},
    {"xpbd", "xpbd", .kind = CONFIGURATION_COSTLY, .cost = 170e-9, .colour = "#6699CC", .mark = 1},
    {"arkode-erk", "arkode-erk", .kind = CONFIGURATION_COSTLY, .cost = 50e-9, .finest = 1e-11,
     .order = 4, .colour = "#999933", .mark = 7},
    {"arkode-dirk", "arkode-dirk", .linear = "direct", .kind = CONFIGURATION_COSTLY, .cost = 420e-9,
     .finest = 1e-11, .order = 4, .colour = "#332288", .mark = 5},
    {"arkode-imex", "arkode-imex", .kind = CONFIGURATION_COSTLY, .cost = 180e-9, .finest = 1e-11,
     .order = 4, .colour = "#661100", .mark = 9},

    {"bdf2", "bdf2", .kind = CONFIGURATION_PLAIN, .cost = 13e-9, .colour = "#882255", .mark = 14},
    {"bdf2 stretch", "bdf2", .options = OPTIONS("matrix=stretch"), .kind = CONFIGURATION_MATRIX,
     .cost = 10e-9, .mark = 7},
    {"bdf2 full", "bdf2", .options = OPTIONS("matrix=full"), .kind = CONFIGURATION_MATRIX,
     .cost = 20e-9, .mark = 9},

    {"bdf3", "bdf3", .kind = CONFIGURATION_PLAIN, .cost = 13e-9, .colour = "#4B0092", .mark = 12},
    {"bdf3 stretch", "bdf3", .options = OPTIONS("matrix=stretch"), .kind = CONFIGURATION_MATRIX,
     .cost = 10e-9, .mark = 11},

    {"bdf", "bdf", .kind = CONFIGURATION_PLAIN, .cost = 23e-9, .finest = 1e-7, .order = 2,
     .colour = "#E6194B", .mark = 10},
    {"bdf order 3", "bdf", .options = OPTIONS("order=3"), .kind = CONFIGURATION_ORDER,
     .cost = 22e-9, .finest = 1e-9, .order = 3, .mark = 4},

    {"cvode", "cvode", .linear = "direct", .kind = CONFIGURATION_PLAIN, .cost = 50e-9,
     .finest = 1e-11, .order = 5, .colour = "#CC79A7", .mark = 11},
    /* Lightly damped modes are where formulas of higher orders are unstable. */
    {"cvode order 2", "cvode", .linear = "direct", .options = OPTIONS("max_order=2"),
     .kind = CONFIGURATION_ORDER, .cost = 42e-9, .finest = 1e-8, .order = 2, .mark = 6},
    {"cvode 4 lanes", "cvode", .linear = "direct", .options = OPTIONS("lanes=4"),
     .kind = CONFIGURATION_LANES, .cost = 70e-9, .finest = 1e-11, .order = 5, .mark = 13},
    {"cvode adams", "cvode", .linear = "direct", .options = OPTIONS("method=adams"),
     .kind = CONFIGURATION_FORMULA, .finest = 1e-11, .order = 12, .mark = 3},
    {"cvode klu spd", "cvode", .linear = "klu", .options = OPTIONS("jacobian=spd"),
     .kind = CONFIGURATION_SOLVER_DETAILS, .finest = 1e-11, .order = 5, .mark = 8},
    {"cvode klu exact", "cvode", .linear = "klu", .options = OPTIONS("jacobian=exact"),
     .kind = CONFIGURATION_SOLVER_DETAILS, .finest = 1e-11, .order = 5, .mark = 9},
    {"cvode cg 1e-2", "cvode", .linear = "cg", .options = OPTIONS("cg.tolerance=1e-2"),
     .kind = CONFIGURATION_SOLVER_DETAILS, .finest = 1e-11, .order = 5, .mark = 14},
    {"cvode cg 1e-8", "cvode", .linear = "cg", .kind = CONFIGURATION_SOLVER_DETAILS,
     .finest = 1e-11, .order = 5, .mark = 15},

    {"reference", "reference", .kind = CONFIGURATION_PLAIN, .cost = 90e-9, .finest = 1e-10,
     .order = 8, .colour = "#000000", .mark = 15},
};
enum { ROWS = sizeof table / sizeof *table };

const struct recipe thesis_recipe = {"euler", "projection", 9000};

/* --- what has no row --- */

/* The k-th colour that no row has: what is left of Okabe and Ito's, dark ones of Paul Tol's, and
 * then colours that are far from those just before: hues in the golden section. */
static void spare_colour(int k, char colour[8]) {
    static const char *const spare[] = {"#1B4F72", "#AA3377", "#117733", "#B03A2E"};
    enum { SPARE = sizeof spare / sizeof *spare };
    if (k < SPARE) {
        memcpy(colour, spare[k], 8);
        return;
    }
    unsigned rgb[3];
    for (int i = 0; i < 3; i++) {
        const double hue = fmod(0.6180339887 * k + i / 3., 1);
        rgb[i] = (unsigned)lround(200 * fmin(1, fmax(0, fabs(6 * hue - 3) - 1)) + 20);
    }
    snprintf(colour, 8, "#%02X%02X%02X", rgb[0], rgb[1], rgb[2]);
}

/* The k-th mark that no method as it is has; where they are used up, again. */
static int spare_mark(int k) {
    enum { MARKS = 15, CROSS = 2 };
    int free[MARKS], count = 0;
    for (int mark = 1; mark <= MARKS; mark++) {
        int used = mark == CROSS;
        for (int i = 0; i < ROWS; i++)
            used |= table[i].mark == mark && table[i].kind == CONFIGURATION_PLAIN;
        if (!used)
            free[count++] = mark;
    }
    return free[k % count];
}

static struct configuration default_of(const struct stepper_method *method, int k) {
    struct configuration made = {.name = method->name,
                                 .stepper = method->name,
                                 .linear = method->capabilities & STEPPER_SOLVES ? "direct" : NULL,
                                 .kind = CONFIGURATION_PLAIN,
                                 .mark = spare_mark(k)};
    spare_colour(k, made.colour);
    return made;
}

/* --- the list --- */

/* What a row need not say: tolerances and order of adaptive methods; a step costs as many
 * evaluations as the order of explicit ones, and several with their matrix of implicit and of
 * adaptive ones. */
static void complete(struct configuration *configuration, const struct stepper_method *method) {
    configuration->method = method;
    if (method->capabilities & STEPPER_ADAPTIVE) {
        configuration->finest = configuration->finest > 0 ? configuration->finest : 1e-10;
        configuration->order = configuration->order > 0 ? configuration->order : method->order;
    }
    if (!(configuration->cost > 0))
        configuration->cost = method->capabilities & (STEPPER_IMPLICIT | STEPPER_ADAPTIVE) ? 50e-9
                              : method->order > 0 ? 5e-9 * method->order
                                                  : 5e-9;
}

/* A method's rows, or its default, of all kinds, to `to`. Returns how many; `spare` counts methods
 * without a row. */
static int rows_of(const struct stepper_method *method, struct configuration *to, int *spare) {
    int count = 0;
    for (int i = 0; i < ROWS; i++)
        if (strcmp(table[i].stepper, method->name) == 0)
            to[count++] = table[i];
    if (count == 0)
        to[count++] = default_of(method, (*spare)++);
    for (int i = 0; i < count; i++) {
        complete(&to[i], method);
        memcpy(to[i].colour, to[0].colour, sizeof to[i].colour);
    }
    return count;
}

struct configuration configuration_of(const struct stepper_method *method) {
    struct configuration rows[ROWS + 1];
    int spare = 0;
    rows_of(method, rows, &spare);
    return rows[0];
}

struct configuration *configurations_choose(unsigned kinds, unsigned capabilities) {
    size_t methods = 0;
    int count = 0, spare = 0;
    while (stepper_methods[methods])
        methods++;
    struct configuration *chosen = calloc(ROWS + methods + 1, sizeof *chosen);
    for (size_t m = 0; m < methods && chosen; m++) {
        const int fits = (stepper_methods[m]->capabilities & capabilities) == capabilities;
        const int more = rows_of(stepper_methods[m], chosen + count, &spare), first = count;
        for (int i = first; i < first + more; i++)
            if (fits && (kinds & chosen[i].kind))
                chosen[count++] = chosen[i];
    }
    if (chosen)
        chosen[count] = (struct configuration){.name = NULL};
    return chosen;
}
