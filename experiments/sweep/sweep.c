#include "sweep.h"

#include "base/options.h"
#include "cells.h"
#include "model/problems.h"
#include "run/identity.h"
#include "scene/scene_load.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- the product --- */

const char *sweep_stepper(const struct sweep *sweep, int run) {
    int each = 1;
    for (int i = 0; i < sweep->vary_count; i++)
        each *= sweep->vary[i].count;
    return sweep->steppers[run / each];
}

const char *sweep_value(const struct sweep *sweep, int run, int setting) {
    for (int i = sweep->vary_count - 1; i > setting; i--)
        run /= sweep->vary[i].count;
    return sweep->vary[setting].value[run % sweep->vary[setting].count];
}

/* --- one of its runs --- */

static int refuse(char *reason, const char *name, const char *value, const char *why) {
    return fail_with(reason, "%s=%.60s: %s", name, value, why);
}

static int read_number(const char *name, const char *value, double *number, char *reason) {
    return parse_real(value, number) || *number <= 0
               ? refuse(reason, name, value, "must be a positive number")
               : 0;
}

static int read_rate(const char *value, double *step, char *reason) {
    if (read_number("rate", value, step, reason))
        return -1;
    *step = 1 / *step;
    return isfinite(*step) ? 0 : refuse(reason, "rate", value, "is too small");
}

static int read_draw(const char *value, int *draw, char *reason) {
    double number;
    if (read_number("draw", value, &number, reason))
        return -1;
    if (number != floor(number) || number > 1e9)
        return refuse(reason, "draw", value, "must be a whole number up to 1e9");
    *draw = (int)number;
    return 0;
}

/* Puts a setting where it belongs, by its name: the options of `wisplab run`, those of steppers and
 * solvers as option.KEY, and all else is the scene's. Returns 0, or -1 with a reason. */
static int apply(struct sweep_point *point, const char *name, const char *value, char *reason) {
    static const char option[] = "option.";
    struct run_request *request = &point->request;
    const struct {
        const char *name;
        double *number;
    } numbers[] = {{"step", &request->step},
                   {"rtol", &request->rtol},
                   {"atol", &request->atol},
                   {"perturb", &request->perturbation}};
    const struct {
        const char *name;
        const char **text;
    } texts[] = {{"treatment", &request->treatment}, {"linear", &request->linear}};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (strcmp(name, numbers[i].name) == 0)
            return read_number(name, value, numbers[i].number, reason);
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        if (strcmp(name, texts[i].name) == 0) {
            *texts[i].text = value;
            return 0;
        }
    if (strcmp(name, "rate") == 0)
        return read_rate(value, &request->step, reason);
    if (strcmp(name, "draw") == 0)
        return read_draw(value, &request->draw, reason);
    char **text = &point->text[point->count];
    const int is_option = strncmp(name, option, sizeof option - 1) == 0;
    if (asprintf(text, "%s=%s", is_option ? name + sizeof option - 1 : name, value) < 0) {
        *text = NULL;
        return fail_with(reason, "out of memory");
    }
    point->count++;
    if (is_option)
        point->options[point->option_count++] = *text;
    else
        point->sets[point->set_count++] = *text;
    return 0;
}

int sweep_open(const struct sweep *sweep, int run, struct sweep_point *point, char *reason) {
    const size_t most = (size_t)sweep->vary_count + 1;
    *point = (struct sweep_point){
        .request = {.stepper = sweep_stepper(sweep, run), .draw = 1, .states = sweep->states},
        .text = calloc(most, sizeof(char *)),
        .sets = calloc(most, sizeof(char *)),
        .options = calloc(most, sizeof(char *)),
    };
    if (!point->text || !point->sets || !point->options)
        return fail_with(reason, "out of memory");
    for (int i = 0; i < sweep->vary_count; i++)
        if (apply(point, sweep->vary[i].name, sweep_value(sweep, run, i), reason))
            return -1;
    point->request.options = point->options;
    point->request.option_count = point->option_count;
    point->scene = scene_load(sweep->scene, point->sets, point->set_count, reason);
    if (!point->scene)
        return -1;
    return settings_resolve(point->scene, &point->request, &point->settings, reason);
}

void sweep_close(struct sweep_point *point) {
    scene_free(point->scene);
    for (int i = 0; i < point->count; i++)
        free(point->text[i]);
    free(point->text);
    free(point->sets);
    free(point->options);
    *point = (struct sweep_point){0};
}

int sweep_reference(const struct sweep_point *point, struct settings *settings, char *reason) {
    const struct problem *problem = point->scene->problem;
    const struct run_request request = {.stepper = "reference",
                                        .treatment =
                                            problem->treatments[point->settings.treatment].name,
                                        .perturbation = point->request.perturbation,
                                        .draw = point->request.draw,
                                        .states = STATES_BINARY};
    return settings_resolve(point->scene, &request, settings, reason);
}

/* --- all of them --- */

/* Errors are distances of wisps at frames. */
static int check_comparable(const struct scene *scene, char *reason) {
    if (scene->problem != &wisp_problem)
        snprintf(reason, REASON_SIZE, "--reference is of wisps, and scene %s is of problem \"%s\"",
                 scene->name, scene->problem->name);
    else if (scene->frame_rate == 0)
        snprintf(reason, REASON_SIZE,
                 "--reference: runs are compared at frames; give scene %s some: --set "
                 "frame_rate=30",
                 scene->name);
    return scene->problem == &wisp_problem && scene->frame_rate > 0 ? 0 : -1;
}

/* A run with an error is another one than a run without. */
static void name_run(const struct sweep *sweep, const struct sweep_point *point,
                     struct sweep_run *run) {
    char both[2 * HASH_SIZE], reason[REASON_SIZE];
    struct settings reference;
    run_hash(point->scene, &point->settings, run->key);
    if (!sweep->reference)
        return;
    if (sweep_reference(point, &reference, reason) == 0)
        run_hash(point->scene, &reference, run->reference);
    snprintf(both, sizeof both, "%s %s", run->key, run->reference);
    hash_bytes(both, strlen(both), run->key);
}

static int refuse_run(struct sweep *sweep, struct sweep_run *run, const char *why, char *reason) {
    char cells[CELLS_SIZE];
    const struct run_result result = {.outcome = REFUSED, .time = NAN};
    const struct sweep_error none = {NAN, NAN, NAN, NAN, ""};
    if (cells_write(cells, &result, why, 0, sweep->reference ? &none : NULL) == 0)
        run->cells = strdup(cells);
    sweep->done += run->cells != NULL;
    if (!run->cells)
        snprintf(reason, REASON_SIZE, "out of memory");
    return run->cells ? 0 : -1;
}

/* Returns 0, REFUSED, or -1 with a reason. */
static int plan_run(struct sweep *sweep, int i, char *reason) {
    struct sweep_point point;
    char why[REASON_SIZE];
    int code = sweep_open(sweep, i, &point, why);
    if (!code && sweep->reference)
        code = check_comparable(point.scene, why);
    if (!code)
        name_run(sweep, &point, &sweep->runs[i]);
    if (code == REFUSED && refuse_run(sweep, &sweep->runs[i], why, why))
        code = -1;
    if (code)
        snprintf(reason, REASON_SIZE, "%s", why);
    sweep_close(&point);
    return code == 0 || code == REFUSED ? code : -1;
}

static int count_runs(struct sweep *sweep, char *reason) {
    double count = sweep->stepper_count;
    for (int i = 0; i < sweep->vary_count; i++)
        count *= sweep->vary[i].count;
    if (count > INT_MAX / 2)
        return fail_with(reason, "%g runs are too many", count);
    sweep->count = (int)count;
    return 0;
}

/* Each setting once: the later would win, and a column be wrong. */
static int check_names(const struct sweep *sweep, char *reason) {
    for (int i = 0; i < sweep->vary_count; i++) {
        const char *name = sweep->vary[i].name;
        if (strcmp(name, "stepper") == 0)
            return refuse(reason, name, sweep->vary[i].value[0], "give --stepper for each of them");
        for (int k = 0; k < i; k++) {
            const char *other = sweep->vary[k].name;
            const int same_step = (strcmp(name, "rate") == 0 && strcmp(other, "step") == 0) ||
                                  (strcmp(name, "step") == 0 && strcmp(other, "rate") == 0);
            if (same_step || strcmp(name, other) == 0)
                return refuse(reason, name, sweep->vary[i].value[0],
                              same_step ? "step and rate say the same thing"
                                        : "that setting is given twice");
        }
    }
    return 0;
}

/* Draws of no displacement are one run. */
static int check_draw(const struct sweep *sweep, char *reason) {
    const struct vary *draw = NULL;
    for (int i = 0; i < sweep->vary_count; i++) {
        if (strcmp(sweep->vary[i].name, "perturb") == 0)
            return 0;
        if (strcmp(sweep->vary[i].name, "draw") == 0)
            draw = &sweep->vary[i];
    }
    return draw ? refuse(reason, "draw", draw->value[0],
                         "says which displacement, and there is none; add --vary perturb=1e-6")
                : 0;
}

static const struct sweep_run *sorted; /* qsort hands nothing on */

static int compare_keys(const void *a, const void *b) {
    return strcmp(sorted[*(const int *)a].key, sorted[*(const int *)b].key);
}

int sweep_plan(struct sweep *sweep, char *reason) {
    int refused = 0;
    if (check_names(sweep, reason) || check_draw(sweep, reason) || count_runs(sweep, reason))
        return 1;
    sweep->runs = calloc((size_t)sweep->count, sizeof *sweep->runs);
    sweep->by_key = calloc((size_t)sweep->count, sizeof *sweep->by_key);
    if (!sweep->runs || !sweep->by_key) {
        snprintf(reason, REASON_SIZE, "out of memory");
        return 2;
    }
    for (int i = 0; i < sweep->count; i++) {
        const int code = plan_run(sweep, i, reason);
        if (code < 0)
            return errno == ENOMEM ? 2 : 1;
        refused += code == REFUSED;
        sweep->by_key[i] = i;
    }
    sorted = sweep->runs;
    qsort(sweep->by_key, (size_t)sweep->count, sizeof *sweep->by_key, compare_keys);
    return refused == sweep->count;
}

/* The first run in the order of keys that is not before that one. */
static int first_with(const struct sweep *sweep, const char *key) {
    int low = 0, high = sweep->count;
    while (low < high) {
        const int middle = low + (high - low) / 2;
        if (strcmp(sweep->runs[sweep->by_key[middle]].key, key) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

void sweep_take(void *ctx, const char *key, const char *cells) {
    struct sweep *sweep = ctx;
    for (int k = first_with(sweep, key); k < sweep->count; k++) {
        struct sweep_run *run = &sweep->runs[sweep->by_key[k]];
        if (strcmp(run->key, key) != 0)
            return;
        if (run->cells)
            continue;
        run->cells = strdup(cells); /* without memory it is done again */
        sweep->done += run->cells != NULL;
    }
}

void sweep_free(struct sweep *sweep) {
    for (int i = 0; i < sweep->count && sweep->runs; i++)
        free(sweep->runs[i].cells);
    for (int i = 0; i < sweep->vary_count; i++)
        vary_free(&sweep->vary[i]);
    free(sweep->runs);
    free(sweep->by_key);
    free(sweep->vary);
}
