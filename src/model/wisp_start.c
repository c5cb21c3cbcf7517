/* From what state wisps start. */
#include "wisp_model.h"

#include <stdlib.h>

/* The rows of one wisp, of whatever treatment, as rows of the model's: a strand knows samples both
 * by distance and by position. What needs no conversion comes through to the bit. */
static int convert(const struct wisp_model *m, const struct placement *head, int wisp,
                   double *rows) {
    const struct start *start = &m->scene->start;
    const int stride = m->model.column_count, first = m->first_row[wisp];
    struct strand *strand =
        strand_create(&m->scene->wisps[wisp], (enum wisp_treatment)start->treatment);
    if (!strand)
        return -1;
    strand_turn(strand, head);
    strand_load(strand, start->rows + first * start->columns + 2, start->columns);
    strand->treatment = m->treatment;
    strand_store(strand, rows + first * stride + 2, stride);
    strand_free(strand);
    return 0;
}

int wisps_start(struct wisp_model *m) {
    struct placement head;
    if (!m->scene->start.rows)
        return 0;
    double *rows = calloc((size_t)(m->model.row_count * m->model.column_count), sizeof *rows);
    int code = rows ? 0 : -1;
    head_placement(&m->scene->around.head, m->model.t, &head);
    for (int i = 0; i < m->scene->wisp_count && !code; i++)
        code = convert(m, &head, i, rows);
    if (!code) {
        m->model.problem->restore(&m->model, rows);
        m->model.problem->project(&m->model);
    }
    free(rows);
    return code;
}
