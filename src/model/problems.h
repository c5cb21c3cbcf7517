/* All problems that a scene can pose. */
#ifndef WISPLAB_PROBLEMS_H
#define WISPLAB_PROBLEMS_H

#include "model.h"

extern const struct problem circle_problem, wisp_problem, rosenblum_problem, anjyo_problem;

/* NULL-terminated; and the one of that name or NULL. */
extern const struct problem *const problems[];
const struct problem *problem_find(const char *name);

/* problem->terms, where there is one. */
int problem_terms(const struct scene *scene, const char **names, int most);

/* Columns of nodes without samples, as struct model has them, and of their accelerations. */
extern const char *const node_columns[], *const node_rate_columns[];
enum { NODE_COLUMNS = 8, NODE_RATE_COLUMNS = 5 };

/* What runs on a problem that has no more to say: its first treatment, and its own solver. */
int first_treatment(const struct stepper_method *method);
const char *direct_solver(const struct stepper_method *method);

/* Index of a treatment's name, or -1. */
int treatment_find(const struct problem *problem, const char *name);

#endif
