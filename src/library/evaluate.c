/* What a handle's model is at a given state: forces, energy, matrices, frames. */
#include "base/vector.h"
#include "library.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- forces and energy --- */

/* Before something is asked at time t: which smooth interval it is in. Returns 0 or a code. */
static int look_at(wisplab *w, double t) {
    if (!isfinite(t))
        return library_fail(w, WISPLAB_REFUSED, "a time must be finite");
    const double next = isfinite(w->next.t) ? w->next.t : fmax(t, w->last) + 1;
    const int inside = t >= w->last && t <= next;
    for (int i = 0; i < w->model->part_count; i++) {
        struct system *system = &w->model->parts[i].system;
        system->from = inside ? w->last : 0;
        system->until = inside ? next : 0;
    }
    return WISPLAB_OK;
}

static int fail_part(wisplab *w, int i, int outcome) {
    return library_outcome(w, outcome, w->model->parts[i].system.reason);
}

int wisplab_acceleration(wisplab *w, double t, const double *q, const double *v, double *a) {
    int code = look_at(w, t);
    for (int i = 0, at = 0; i < w->model->part_count && !code;
         at += w->model->parts[i++].system.size)
        code = fail_part(
            w, i, system_acceleration(&w->model->parts[i].system, t, q + at, v + at, a + at));
    return code;
}

int wisplab_time_rate(wisplab *w, double t, const double *q, const double *v, double *rate) {
    int code = look_at(w, t);
    if (!w->model->parts[0].system.ops->time_rate)
        return library_fail(w, WISPLAB_REFUSED, "%s: no da/dt is known",
                            w->model->parts[0].system.name);
    for (int i = 0, at = 0; i < w->model->part_count && !code;
         at += w->model->parts[i++].system.size) {
        struct system *system = &w->model->parts[i].system;
        code = fail_part(w, i, system_acceleration(system, t, q + at, v + at, rate + at));
        if (!code)
            system_time_rate(system, t, q + at, v + at, rate + at);
    }
    return code;
}

/* A part at a time, and none of them where one fails: the others' are kept. */
int wisplab_project(wisplab *w, double t, double *q, double *v) {
    int code = look_at(w, t);
    if (code || !w->model->parts[0].system.ops->project)
        return code;
    const size_t bytes = (size_t)wisplab_unknowns(w) * sizeof *q;
    double *kept = malloc(2 * bytes + 1);
    if (!kept)
        return library_fail(w, WISPLAB_NO_MEMORY, "no memory for a projection");
    memcpy(kept, q, bytes);
    memcpy((char *)kept + bytes, v, bytes);
    for (int i = 0, at = 0; i < w->model->part_count && !code;
         at += w->model->parts[i++].system.size)
        code = fail_part(w, i, system_project(&w->model->parts[i].system, t, q + at, v + at));
    if (code) {
        memcpy(q, kept, bytes);
        memcpy(v, (char *)kept + bytes, bytes);
    }
    free(kept);
    return code;
}

static const char *const energy_names[] = {
#define X(name, meaning) #name,
    ENERGIES(X)
#undef X
};

int wisplab_energies(void) {
    return sizeof energy_names / sizeof *energy_names;
}

const char *wisplab_energy_name(int i) {
    return i >= 0 && i < wisplab_energies() ? energy_names[i] : NULL;
}

int wisplab_energy(wisplab *w, double t, const double *q, const double *v, double *energies) {
    int code = look_at(w, t);
    if (!w->model->parts[0].system.ops->energies)
        return library_fail(w, WISPLAB_REFUSED, "%s: no energy is known",
                            w->model->parts[0].system.name);
    memset(energies, 0, sizeof energy_names / sizeof *energy_names * sizeof *energies);
    for (int i = 0, at = 0; i < w->model->part_count && !code;
         at += w->model->parts[i++].system.size) {
        const struct system *system = &w->model->parts[i].system;
        struct energies of_part;
        int k = 0;
        code = fail_part(w, i, system->ops->energies(system->ctx, t, q + at, v + at, &of_part));
#define X(name, meaning) energies[k++] += of_part.name;
        if (!code) {
            ENERGIES(X)
        }
#undef X
    }
    return code;
}

/* --- matrices --- */

int wisplab_linearise(wisplab *w, enum wisplab_jacobian kind, double t, const double *q,
                      const double *v) {
    const struct system *first = &w->model->parts[0].system;
    int code = look_at(w, t);
    if (kind != WISPLAB_EXACT && kind != WISPLAB_SPD)
        return library_fail(w, WISPLAB_REFUSED, "no Jacobians of kind %d", (int)kind);
    w->kind = kind == WISPLAB_SPD ? JACOBIAN_SPD : JACOBIAN_EXACT;
    w->prepared = NOTHING;
    if (!(first->matrix[w->kind] & MATRIX_AVAILABLE))
        return library_fail(w, WISPLAB_REFUSED, "%s: %s", first->name,
                            first->no_jacobians ? first->no_jacobians
                                                : "it has no Jacobians of this kind");
    for (int i = 0, at = 0; i < w->model->part_count && !code;
         at += w->model->parts[i++].system.size)
        code = fail_part(w, i,
                         system_linearise(&w->model->parts[i].system, w->kind, t, q + at, v + at));
    if (!code)
        w->prepared = LINEARISED;
    return code;
}

static int must_be(wisplab *w, enum prepared prepared) {
    if (w->prepared >= prepared)
        return WISPLAB_OK;
    return library_fail(w, WISPLAB_REFUSED, "%s first",
                        prepared == LINEARISED ? "linearise" : "factor");
}

int wisplab_product(wisplab *w, double m, double d, double k, const double *x, double *y) {
    const int code = must_be(w, LINEARISED);
    for (int i = 0, at = 0; i < w->model->part_count && !code;
         at += w->model->parts[i++].system.size)
        system_product(&w->model->parts[i].system, m, d, k, x + at, y + at);
    return code;
}

/* A matrix whose columns are asked for one by one. */
struct columns {
    double m, d, k;
    double *unit, *column; /* of a part's size */
};

/* Room for the columns of the largest part. */
static int take_columns(wisplab *w, struct columns *columns) {
    int most = 0;
    for (int i = 0; i < w->model->part_count; i++)
        most = w->model->parts[i].system.size > most ? w->model->parts[i].system.size : most;
    columns->unit = calloc(2 * (size_t)most, sizeof *columns->unit);
    columns->column = columns->unit + most;
    return columns->unit ? WISPLAB_OK
                         : library_fail(w, WISPLAB_NO_MEMORY, "no memory for a matrix");
}

static const double *column(struct system *system, const struct columns *columns, int j) {
    columns->unit[j] = 1;
    system_product(system, columns->m, columns->d, columns->k, columns->unit, columns->column);
    columns->unit[j] = 0;
    return columns->column;
}

int wisplab_dense(wisplab *w, double m, double d, double k, double *matrix) {
    const size_t n = (size_t)wisplab_unknowns(w);
    struct columns columns = {.m = m, .d = d, .k = k};
    int code = must_be(w, LINEARISED);
    code = code ? code : take_columns(w, &columns);
    if (code)
        return code;
    memset(matrix, 0, n * n * sizeof *matrix);
    size_t at = 0;
    for (int i = 0; i < w->model->part_count; i++) {
        struct system *system = &w->model->parts[i].system;
        const size_t size = (size_t)system->size;
        for (size_t j = 0; j < size; j++)
            memcpy(matrix + (at + j) * n + at, column(system, &columns, (int)j),
                   size * sizeof *matrix);
        at += size;
    }
    free(columns.unit);
    return WISPLAB_OK;
}

int wisplab_entries(const wisplab *w) {
    int sum = 0;
    for (int i = 0; i < w->model->part_count; i++) {
        const struct sparse_matrix *pattern = w->model->parts[i].system.pattern;
        if (!pattern)
            return 0;
        sum += pattern->column_start[pattern->size];
    }
    return sum;
}

int wisplab_pattern(wisplab *w, int *column_start, int *row) {
    if (wisplab_entries(w) == 0)
        return library_fail(w, WISPLAB_REFUSED, "%s: it has no Jacobians",
                            w->model->parts[0].system.name);
    int at = 0, entries = 0;
    for (int i = 0; i < w->model->part_count; i++) {
        const struct sparse_matrix *pattern = w->model->parts[i].system.pattern;
        const int count = pattern->column_start[pattern->size];
        for (int j = 0; j < pattern->size; j++)
            column_start[at + j] = entries + pattern->column_start[j];
        for (int k = 0; k < count; k++)
            row[entries + k] = at + pattern->row[k];
        at += pattern->size;
        entries += count;
    }
    column_start[at] = entries;
    return WISPLAB_OK;
}

int wisplab_sparse(wisplab *w, double m, double d, double k, double *values) {
    struct columns columns = {.m = m, .d = d, .k = k};
    int code = must_be(w, LINEARISED);
    code = code ? code : take_columns(w, &columns);
    if (code)
        return code;
    for (int i = 0; i < w->model->part_count; i++) {
        struct system *system = &w->model->parts[i].system;
        const struct sparse_matrix *pattern = system->pattern;
        for (int j = 0; j < pattern->size; j++) {
            const double *whole = column(system, &columns, j);
            for (int at = pattern->column_start[j]; at < pattern->column_start[j + 1]; at++)
                *values++ = whole[pattern->row[at]];
        }
    }
    free(columns.unit);
    return WISPLAB_OK;
}

int wisplab_factor(wisplab *w, double alpha, double beta) {
    const struct system *first = &w->model->parts[0].system;
    int code = must_be(w, LINEARISED);
    if (!code && !(first->matrix[w->kind] & MATRIX_FACTORABLE))
        code = library_fail(w, WISPLAB_REFUSED,
                            "%s: the direct solver takes the Jacobians of WISPLAB_SPD alone",
                            first->name);
    if (!code)
        w->prepared = LINEARISED;
    for (int i = 0; i < w->model->part_count && !code; i++)
        code = fail_part(w, i, system_factor(&w->model->parts[i].system, alpha, beta));
    if (!code)
        w->prepared = FACTORISED;
    return code;
}

int wisplab_solve(wisplab *w, const double *b, double *x) {
    const int code = must_be(w, FACTORISED);
    for (int i = 0, at = 0; i < w->model->part_count && !code;
         at += w->model->parts[i++].system.size) {
        w->model->parts[i].system.counters.linear_solves += w->model->parts[i].system.wisps;
        system_solve(&w->model->parts[i].system, b + at, x + at);
    }
    return code;
}

int wisplab_mass_solve(wisplab *w, double t, const double *q, const double *v, const double *b,
                       double *x) {
    const unsigned spd = w->model->parts[0].system.matrix[JACOBIAN_SPD];
    int code = wisplab_linearise(w, spd & MATRIX_FACTORABLE ? WISPLAB_SPD : WISPLAB_EXACT, t, q, v);
    code = code ? code : wisplab_factor(w, 0, 0);
    return code ? code : wisplab_solve(w, b, x);
}

/* --- frames --- */

int wisplab_columns(const wisplab *w) {
    return w->model->column_count;
}

const char *wisplab_column(const wisplab *w, int i) {
    return i >= 0 && i < w->model->column_count ? w->model->columns[i] : NULL;
}

/* A model samples its own state: for as long as this takes, (t, q, v) is it. */
int wisplab_frame(wisplab *w, double t, const double *q, const double *v, double *rows) {
    struct model *model = w->model;
    const double own_t = model->t;
    const int code = look_at(w, t);
    double **own = code ? NULL : malloc(2 * (size_t)model->part_count * sizeof *own);
    if (!own)
        return code ? code : library_fail(w, WISPLAB_NO_MEMORY, "no memory for a frame");
    for (int i = 0, at = 0; i < model->part_count; at += model->parts[i++].system.size) {
        own[2 * i] = model->parts[i].q;
        own[2 * i + 1] = model->parts[i].v;
        model->parts[i].q = (double *)q + at;
        model->parts[i].v = (double *)v + at;
    }
    model->t = t;
    model->problem->sample(model, rows);
    model->t = own_t;
    for (int i = 0; i < model->part_count; i++) {
        model->parts[i].q = own[2 * i];
        model->parts[i].v = own[2 * i + 1];
    }
    free(own);
    return WISPLAB_OK;
}

/* x y z of all nodes, or of the tips alone, which are the last nodes of their wisps. */
static int points(wisplab *w, double t, const double *q, const double *v, int tips, double *xyz) {
    const int columns = w->model->column_count, count = w->model->row_count;
    double *rows = malloc((size_t)(count * columns) * sizeof *rows);
    const int code = rows ? wisplab_frame(w, t, q, v, rows)
                          : library_fail(w, WISPLAB_NO_MEMORY, "no memory for a frame");
    for (int i = 0; i < count && !code; i++) {
        const double *row = rows + i * columns;
        if (tips && i + 1 < count && row[columns] == row[0])
            continue;
        memcpy(xyz, row + 2, 3 * sizeof *xyz);
        xyz += 3;
    }
    free(rows);
    return code;
}

int wisplab_positions(wisplab *w, double t, const double *q, const double *v, double *xyz) {
    return points(w, t, q, v, 0, xyz);
}

int wisplab_tips(wisplab *w, double t, const double *q, const double *v, double *xyz) {
    return points(w, t, q, v, 1, xyz);
}
