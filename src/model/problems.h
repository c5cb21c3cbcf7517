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

/* Index of a treatment's name, or -1. */
int treatment_find(const struct problem *problem, const char *name);

#endif
