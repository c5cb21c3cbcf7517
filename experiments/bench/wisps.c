/* Wisps to measure on: the scene's first wisp many times, bent and in motion. */
#include "measure.h"
#include "model/problems.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

void give_up(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    fputs("bench: ", stderr);
    vfprintf(stderr, format, arguments);
    fputc('\n', stderr);
    va_end(arguments);
    _Exit(3);
}

void out_of_memory(void) {
    fputs("bench: out of memory\n", stderr);
    _Exit(2);
}

void *zeros(size_t bytes) {
    const size_t whole = (bytes + 63) / 64 * 64;
    void *memory = aligned_alloc(64, whole ? whole : 64);
    if (!memory)
        out_of_memory();
    return memset(memory, 0, whole);
}

const char *bending_name(enum bending bending) {
    return bending == BENDING_SKIP ? "skip" : bending == BENDING_HINGE ? "hinge" : "none";
}

const char *treatment_name(enum wisp_treatment treatment) {
    return wisp_problem.treatments[treatment].name;
}

void wisp_set_subject(const struct wisp_set *set, char subject[SUBJECT_SIZE]) {
    snprintf(subject, SUBJECT_SIZE, "%s %s %d %d",
             set->samples ? treatment_name(set->treatment) : "skeleton", bending_name(set->bending),
             set->samples, set->wisps);
}

void rates_subject(const struct wisp_set *set, char subject[SUBJECT_SIZE]) {
    snprintf(subject, SUBJECT_SIZE, "rates %s %d", bending_name(set->bending), set->wisps);
}

int wisp_sets(int wisps, struct wisp_set sets[WISP_SETS_MAX]) {
    static const enum bending bendings[] = {BENDING_NONE, BENDING_SKIP, BENDING_HINGE};
    static const enum wisp_treatment treatments[] = {WISP_PROJECTION, WISP_GENERALISED,
                                                     WISP_PENALTY};
    int count = 0;
    for (int b = 0; b < 3; b++) {
        sets[count++] = (struct wisp_set){WISP_GENERALISED, bendings[b], 0, wisps};
        for (int t = 0; t < 3; t++)
            for (int samples = 4; samples <= 8; samples += 4)
                sets[count++] = (struct wisp_set){treatments[t], bendings[b], samples, wisps};
    }
    return count;
}

/* Wisp k's root and direction: a row of them, no two alike. */
static struct wisp wisp_of(const struct scene *scene, const struct wisp_set *set, int k) {
    struct wisp wisp = scene->wisps[0];
    const double turn = 2.399963 * k, rise = 0.4 * sin(0.7 * k); /* golden angle */
    const double flat = sqrt(1 - rise * rise);
    wisp.nodes = KERNEL_NODES;
    wisp.samples = set->samples;
    wisp.bending = set->bending;
    wisp.root[0] += 0.02 * k;
    wisp.direction[0] = flat * cos(turn);
    wisp.direction[1] = rise;
    wisp.direction[2] = flat * sin(turn);
    return wisp;
}

static struct scene *scene_of(const struct scene *scene, const struct wisp_set *set) {
    struct scene *many = zeros(sizeof *many);
    *many = *scene;
    many->wisp_count = set->wisps;
    many->wisps = zeros((size_t)set->wisps * sizeof *many->wisps);
    for (int k = 0; k < set->wisps; k++)
        many->wisps[k] = wisp_of(scene, set, k);
    return many;
}

/* A row's samples: displaced with the node, and a little by themselves. */
static void move_samples(const struct wisp_set *set, double *row, const double shift[3],
                         double phase) {
    const int numbers = set->treatment == WISP_PENALTY ? 6 : 2;
    for (int j = 0; j < set->samples; j++) {
        double *x = row + 8 + numbers * j;
        if (set->treatment != WISP_PENALTY) {
            x[0] *= 1 + 0.1 * sin(phase + j);
            x[1] += 0.05 * cos(phase + 2 * j);
            continue;
        }
        for (int c = 0; c < 3; c++) {
            x[c] += shift[c] + 2e-4 * sin(phase + j + c);
            x[3 + c] += row[5 + c] + 0.05 * cos(phase + j + 2 * c);
        }
    }
}

/* Bends a wisp's rows of a frame (wisp node x y z vx vy vz, samples) by some 0.1 rad at each node,
 * with strains of some 0.002 and velocities that grow to some m/s. */
static void bend_rows(const struct wisp_set *set, const struct wisp *wisp, double *rows, int stride,
                      int k) {
    double t[3], p[3];
    const double length = wisp_spacing(wisp);
    for (int c = 0; c < 3; c++) {
        t[c] = wisp->direction[c];
        p[c] = wisp->root[c] + length * t[c];
    }
    for (int i = 2; i < wisp->nodes; i++) {
        double *row = rows + i * stride, shift[3], square = 0;
        const double phase = 1.3 * k + 0.9 * i;
        for (int c = 0; c < 3; c++)
            t[c] += 0.1 * sin(phase + 2.1 * c);
        for (int c = 0; c < 3; c++)
            square += t[c] * t[c];
        for (int c = 0; c < 3; c++) {
            t[c] /= sqrt(square);
            p[c] += length * (1 + 0.002 * cos(phase)) * t[c];
            shift[c] = p[c] - row[2 + c];
            row[2 + c] = p[c];
            row[5 + c] = 0.1 * i * cos(phase + c);
        }
        move_samples(set, row, shift, phase);
    }
}

/* A frame of the set in motion, from the rest shape. */
static double *moving_rows(const struct wisp_set *set, const struct scene *many,
                           const struct model *model) {
    const int stride = model->column_count;
    double *rows = zeros((size_t)(model->row_count * stride) * sizeof *rows);
    wisp_problem.sample(model, rows);
    for (int k = 0; k < set->wisps; k++)
        bend_rows(set, &many->wisps[k], rows + k * KERNEL_NODES * stride, stride, k);
    return rows;
}

static struct model *create(const struct scene *many, const struct wisp_set *set, int lanes) {
    struct model *model = wisp_problem.create(many, (int)set->treatment, lanes);
    if (!model)
        out_of_memory();
    return model;
}

struct model *resting_model(const struct scene *scene, const struct wisp_set *set, int lanes) {
    return create(scene_of(scene, set), set, lanes);
}

struct model *moving_model(const struct scene *scene, const struct wisp_set *set, int lanes) {
    const struct scene *many = scene_of(scene, set);
    struct model *model = create(many, set, lanes);
    double *rows = moving_rows(set, many, model);
    wisp_problem.restore(model, rows);
    free(rows);
    return model;
}

/* Parts of 1 wisp have just the vectors of a twin whose root is at 0. */
struct twins *moving_twins(const struct scene *scene, const struct wisp_set *set) {
    const struct scene *many = scene_of(scene, set);
    const struct model *model = moving_model(scene, set, 1);
    struct twins *twins = zeros(sizeof *twins);
    twins->count = set->wisps;
    twins->size = model->parts[0].system.size;
    const size_t bytes = (size_t)(twins->count * twins->size) * sizeof(double);
    twins->twin = zeros((size_t)twins->count * sizeof *twins->twin);
    twins->q = zeros(bytes);
    twins->v = zeros(bytes);
    twins->a = zeros(bytes);
    for (int k = 0; k < set->wisps; k++) {
        struct wisp wisp = many->wisps[k];
        memset(wisp.root, 0, sizeof wisp.root);
        if (wisp_twin_init(&twins->twin[k], &wisp, &many->around, set->treatment))
            give_up("the twin refuses the scene's wisp");
        memcpy(twins->q + k * twins->size, model->parts[k].q, bytes / (size_t)twins->count);
        memcpy(twins->v + k * twins->size, model->parts[k].v, bytes / (size_t)twins->count);
    }
    return twins;
}
