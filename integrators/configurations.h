/* The one table of what experiments compare: methods with the solver and options that they run
 * with, the settings that are worth trying, and how they are drawn. It stands beside the registry
 * and knows its methods by name. A method that has no row here gets a configuration made from its
 * facts: itself, with the direct solver where it takes one, in the next colour and mark that are
 * free. So a stepper that is one file and one line in the registry is in every comparison that it
 * can take part in; a row is for who wants variants, costs and looks of his own.
 *
 * Experiments have no lists of methods. They ask by capability and by what a configuration is a
 * variant in, which is what an experiment's question is about; plots get colours and marks from
 * here whenever something is drawn. */
#ifndef WISPLAB_CONFIGURATIONS_H
#define WISPLAB_CONFIGURATIONS_H

#include "stepper.h"

/* In what it differs from the method as it is. */
enum configuration_kind {
    CONFIGURATION_PLAIN = 1,           /* it does not: one of each method */
    CONFIGURATION_ITERATED = 2,        /* implicit equations solved to the end */
    CONFIGURATION_SOLVER = 4,          /* the other linear solver that people use */
    CONFIGURATION_SOLVER_ITERATED = 8, /* both */
    CONFIGURATION_ORDER = 16,          /* another highest order */
    CONFIGURATION_FORMULA = 32,        /* another family of formulas */
    CONFIGURATION_SOLVER_DETAILS = 64, /* solver, its tolerance, Jacobian */
    CONFIGURATION_MATRIX = 128,        /* which forces are in its matrix */
    CONFIGURATION_LANES = 256,         /* how many wisps share its steps */
    CONFIGURATION_COSTLY = 512, /* it does not, but costs too much for all but charts of cost */
};

struct configuration {
    const char *name;           /* in tables and legends: the method's, then what differs */
    const char *stepper;        /* the method's */
    const char *linear;         /* solver; NULL: the problem's default, or none */
    const char *const *options; /* "key=value", NULL-terminated; NULL: none */
    enum configuration_kind kind;

    double finest; /* of adaptive methods: the tightest rtol that is worth trying on wisps */
    int order;     /* likewise: with which its steps follow the tolerance */
    double cost; /* CPU time of a step, s per unknown of a wisp, on one processor of 2022, good to a
                    factor of two: what a run will cost is predicted from it, on all machines */

    /* A colour is a method's, "#rrggbb", and a mark is a configuration's: gnuplot's point type
     * (from 4 on: squares, circles, triangles, inverted ones, diamonds, pentagons, the even ones
     * open; 1 is a plus, 3 a star, and the cross 2 is of failures). No two have both in common, and
     * methods as they are have no mark in common: there are more variants than marks. */
    char colour[8];
    int mark;

    const struct stepper_method *method; /* that is called `stepper`, found in the registry */
};

/* The configurations of the kinds in a mask, of methods that have all the capabilities in another
 * one (0: any), in the registry's order; complete, and ended by one without a name. To be freed;
 * NULL where memory cannot be had. */
struct configuration *configurations_choose(unsigned kinds, unsigned capabilities);

/* The first configuration of a method: itself, as experiments run it. */
struct configuration configuration_of(const struct stepper_method *method);

/* All kinds. */
enum { CONFIGURATION_ANY = 1023 };

/* What the thesis runs hair with (Plante 1999, sections 4.2.1 and 5). */
struct recipe {
    const char *stepper, *treatment;
    double rate; /* Hz */
};
extern const struct recipe thesis_recipe;

#endif
