#include "chains.h"

#include "problems.h"

#include <stdlib.h>
#include <string.h>
#include <sys/param.h>

const struct treatment chain_treatments[] = {
    {"free", "positions and velocities, or angles and their rates, no constraint"},
    {0},
};

struct chains {
    struct model model;
    const struct chain_law *law;
    int *parent;
    double kink; /* s: the end of a gust's hold */
};

/* --- frames --- */

/* A vector of each node of a part into its rows, from column `column` on. */
static void write_points(const struct model *model, int i, double *rows, int stride, int column) {
    const struct chain *chain = chain_of(model, i);
    for (int node = 0; node < chain->wisp->nodes; node++) {
        double *row = rows + node * stride;
        row[0] = i;
        row[1] = node;
        memcpy(row + column, chain->point[node], sizeof chain->point[node]);
    }
}

void chains_sample(const struct model *model, double *rows) {
    for (int i = 0; i < model->part_count; i++) {
        const struct chain *chain = chain_of(model, i);
        for (int derivative = 0; derivative < 2; derivative++) {
            chain->law->points(chain, derivative, model->parts[i].q, model->parts[i].v, NULL);
            write_points(model, i, rows, NODE_COLUMNS, 2 + 3 * derivative);
        }
        rows += chain->wisp->nodes * NODE_COLUMNS;
    }
}

void chains_restore(struct model *model, const double *rows) {
    for (int i = 0; i < model->part_count; i++) {
        const struct chain *chain = chain_of(model, i);
        chain->law->take(chain, rows + 2, NODE_COLUMNS, model->parts[i].q, model->parts[i].v);
        rows += chain->wisp->nodes * NODE_COLUMNS;
    }
}

void chains_sample_accelerations(const struct model *model, double *const *a, double *rows) {
    for (int i = 0; i < model->part_count; i++) {
        const struct chain *chain = chain_of(model, i);
        chain->law->points(chain, 2, model->parts[i].q, model->parts[i].v, a[i]);
        write_points(model, i, rows, NODE_RATE_COLUMNS, 2);
        rows += chain->wisp->nodes * NODE_RATE_COLUMNS;
    }
}

struct unknown chains_unknown(const struct model *model, int i, int k) {
    const struct chain_law *law = chain_of(model, i)->law;
    const int each = law->node_unknowns;
    return (struct unknown){i, 2 + k / each, law->unknowns[k % each], law->unit};
}

/* --- making --- */

/* Each unknown is felt by those of the nodes that are within reach. */
static int make_pattern(struct sparse_matrix *pattern, int nodes, int each, int reach) {
    const int size = nodes * each, most = size * (2 * reach + 1) * each;
    int count = 0;
    pattern->size = size;
    pattern->column_start = malloc(((size_t)size + 1 + (size_t)most) * sizeof(int));
    if (!pattern->column_start)
        return -1;
    pattern->row = pattern->column_start + size + 1;
    for (int j = 0; j < size; j++) {
        const int first = MAX(j / each - reach, 0), end = MIN(j / each + reach + 1, nodes);
        pattern->column_start[j] = count;
        for (int i = first * each; i < end * each; i++)
            pattern->row[count++] = i;
    }
    pattern->column_start[size] = count;
    return 0;
}

static int make_chain(struct chains *m, const struct scene *scene, int i) {
    const struct chain_law *law = m->law;
    const struct wisp *wisp = &scene->wisps[i];
    struct part *part = &m->model.parts[i];
    struct chain *chain = law->create(scene, wisp);
    if (!chain)
        return -1;
    const int size = (wisp->nodes - 2) * law->node_unknowns;
    chain->law = law;
    chain->wisp = wisp;
    chain->around = &scene->around;
    chain->system = &part->system;
    chain->point = calloc((size_t)wisp->nodes, sizeof *chain->point);
    part->system = (struct system){.ops = law->ops,
                                   .ctx = chain,
                                   .name = law->name,
                                   .size = size,
                                   .lanes = 1,
                                   .wisps = 1,
                                   .matrix = {[JACOBIAN_EXACT] = law->matrix},
                                   .matrix_note = law->matrix_note,
                                   .pattern = &chain->pattern};
    part->q = calloc((size_t)size, sizeof(double));
    part->v = calloc((size_t)size, sizeof(double));
    if (!chain->point || !part->q || !part->v ||
        make_pattern(&chain->pattern, wisp->nodes - 2, law->node_unknowns, law->reach))
        return -1;
    law->start(chain, part->q, part->v);
    m->parent[i] = i;
    m->model.row_count += wisp->nodes;
    return 0;
}

void chains_free(struct model *model) {
    struct chains *m = (struct chains *)model;
    for (int i = 0; i < model->part_count; i++) {
        struct chain *chain = model->parts[i].system.ctx;
        free(model->parts[i].q);
        free(model->parts[i].v);
        if (!chain)
            continue;
        free(chain->pattern.column_start);
        free(chain->point);
        free(chain);
    }
    free(model->parts);
    free(m->parent);
    free(m);
}

struct model *chains_create(const struct scene *scene, const struct chain_law *law) {
    const size_t count = (size_t)scene->wisp_count;
    struct chains *m = calloc(1, sizeof *m);
    if (!m)
        return NULL;
    m->law = law;
    m->parent = calloc(count, sizeof *m->parent);
    m->kink = scene->around.wind.hold;
    m->model = (struct model){.problem = law->problem,
                              .t = scene->begin,
                              .parts = calloc(count, sizeof(struct part)),
                              .parent = m->parent,
                              .columns = node_columns,
                              .column_count = NODE_COLUMNS,
                              .rate_columns = node_rate_columns,
                              .rate_column_count = NODE_RATE_COLUMNS,
                              .kinks = &m->kink,
                              .kink_count = scene->around.wind.kind == WIND_GUST};
    int code = m->parent && m->model.parts ? 0 : -1;
    for (int i = 0; i < scene->wisp_count && !code; i++) {
        m->model.part_count++;
        code = make_chain(m, scene, i);
    }
    if (code) {
        chains_free(&m->model);
        return NULL;
    }
    return &m->model;
}
