#include "problems.h"

#include "scene.h"

#include <string.h>

const struct problem *const problems[] = {&wisp_problem, &circle_problem, &rosenblum_problem,
                                          &anjyo_problem, NULL};

const char *const node_columns[] = {"wisp", "node", "x", "y", "z", "vx", "vy", "vz", NULL};
const char *const node_rate_columns[] = {"wisp", "node", "ax", "ay", "az", NULL};

const struct problem *problem_find(const char *name) {
    for (int i = 0; problems[i]; i++)
        if (strcmp(problems[i]->name, name) == 0)
            return problems[i];
    return NULL;
}

int problem_terms(const struct scene *scene, const char **names, int most) {
    return scene->problem->terms ? scene->problem->terms(scene, names, most) : 0;
}

int first_treatment(const struct stepper_method *method) {
    (void)method;
    return 0;
}

const char *direct_solver(const struct stepper_method *method) {
    (void)method;
    return "direct";
}

int treatment_find(const struct problem *problem, const char *name) {
    for (int i = 0; problem->treatments[i].name; i++)
        if (strcmp(problem->treatments[i].name, name) == 0)
            return i;
    return -1;
}
