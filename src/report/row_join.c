#include "row_join.h"

#include <stdlib.h>
#include <string.h>

/* --- what a row is known by --- */

/* Columns that say what a row is about, wherever they are. */
static const char *const keys[] = {
    "key",     "scene",     "file",     "axis",   "hair",    "treatment",     "method",
    "stepper", "variant",   "who",      "along",  "figure",  "configuration", "stretch_stiffness",
    "zeta",    "target",    "setting",  "number", "value",   "rate",          "ratio",
    "name",    "group",     "question", "thing",  "option",  "measure",       "panel",
    "t",       "node",      "series",   "ticks",  "contact", "response",      "frequency",
    "recipe",  "stiffness", "source",   "law"};
enum { KEYS = sizeof keys / sizeof *keys };

/* Between the number of a sweep's run and how it ended stands all that was varied. */
static int is_varied(const struct text_table *table, int column) {
    return strcmp(table->name[0], "run") == 0 && column > 0 &&
           column < text_table_column(table, "status");
}

/* A statement's row is its key; of other tables all keys that they have. */
int row_join_is_key(const struct text_table *table, int column) {
    const char *name = table->name[column];
    if (text_table_column(table, "verdict") >= 0 && text_table_column(table, "key") >= 0)
        return strcmp(name, "key") == 0;
    if (text_table_column(table, "unstable_step") >= 0 && strcmp(name, "rate") == 0)
        return 0; /* of the longest stable step: it was found */
    for (int k = 0; k < KEYS; k++)
        if (strcmp(name, keys[k]) == 0)
            return 1;
    return is_varied(table, column);
}

/* --- joining --- */

static const char *cell_at(const struct text_table *table, int row, int column) {
    return table->cell[row * table->column_count + column];
}

static int find_keys(struct row_join *join) {
    const struct text_table *older = join->table[0], *newer = join->table[1];
    join->key = calloc((size_t)older->column_count, sizeof *join->key);
    for (int column = 0; column < older->column_count && join->key; column++) {
        const int other = text_table_column(newer, older->name[column]);
        if (other < 0 || !row_join_is_key(older, column) || !row_join_is_key(newer, other))
            continue;
        join->key[join->key_count][0] = column;
        join->key[join->key_count++][1] = other;
    }
    return join->key ? 0 : -1;
}

/* The order of what two rows are about, each of either table: 0 where it is the same. */
static int compare_keys(const struct row_join *join, int a, int i, int b, int k) {
    int order = 0;
    for (int c = 0; c < join->key_count && !order; c++)
        order = strcmp(cell_at(join->table[a], i, join->key[c][a]),
                       cell_at(join->table[b], k, join->key[c][b]));
    return order;
}

struct side {
    const struct row_join *join;
    int side;
};

/* Rows about the same stay in their order. */
static int compare_rows(const void *a, const void *b, void *ctx) {
    const struct side *of = ctx;
    const int i = *(const int *)a, k = *(const int *)b,
              order = compare_keys(of->join, of->side, i, of->side, k);
    return order ? order : (i > k) - (i < k);
}

/* The rows of a side, sorted by what they are about, for free; NULL without memory. */
static int *sort_rows(struct row_join *join, int side) {
    const int count = join->table[side]->row_count;
    int *sorted = calloc((size_t)count + 1, sizeof *sorted);
    join->nth[side] = calloc((size_t)count + 1, sizeof *join->nth[side]);
    join->partner[side] = calloc((size_t)count + 1, sizeof *join->partner[side]);
    if (!sorted || !join->nth[side] || !join->partner[side]) {
        free(sorted);
        return NULL;
    }
    for (int i = 0; i < count; i++) {
        sorted[i] = i;
        join->partner[side][i] = -1;
    }
    qsort_r(sorted, (size_t)count, sizeof *sorted, compare_rows, &(struct side){join, side});
    for (int i = 1; i < count; i++) {
        int *before = &join->nth[side][sorted[i - 1]];
        if (compare_keys(join, side, sorted[i - 1], side, sorted[i]) != 0)
            continue;
        *before += *before == 0;
        join->nth[side][sorted[i]] = *before + 1;
    }
    return sorted;
}

static void merge(struct row_join *join, const int *older, const int *newer) {
    const int *older_end = older + join->table[0]->row_count,
              *newer_end = newer + join->table[1]->row_count;
    while (older < older_end && newer < newer_end) {
        const int order = compare_keys(join, 0, *older, 1, *newer);
        if (order == 0) {
            join->partner[0][*older] = *newer;
            join->partner[1][*newer] = *older;
        }
        older += order <= 0;
        newer += order >= 0;
    }
}

int row_join_make(struct row_join *join, const struct text_table *older,
                  const struct text_table *newer) {
    *join = (struct row_join){.table = {older, newer}};
    if (find_keys(join))
        return -1;
    int *sorted[2] = {sort_rows(join, 0), sort_rows(join, 1)};
    const int code = sorted[0] && sorted[1] ? 0 : -1;
    if (!code)
        merge(join, sorted[0], sorted[1]);
    free(sorted[0]);
    free(sorted[1]);
    return code;
}

void row_join_free(struct row_join *join) {
    for (int side = 0; side < 2; side++) {
        free(join->partner[side]);
        free(join->nth[side]);
    }
    free(join->key);
    *join = (struct row_join){.key = NULL};
}

void row_join_name(const struct row_join *join, int side, int row, char name[ROW_NAME_SIZE]) {
    const struct text_table *table = join->table[side];
    const int nth = join->nth[side][row];
    size_t used = 0;
    name[0] = '\0';
    for (int c = 0; c < join->key_count && used < ROW_NAME_SIZE; c++) {
        const int column = join->key[c][side];
        const char *cell = cell_at(table, row, column), *comma = used ? ", " : "";
        char *end;
        const double number = strtod(cell, &end);
        used += (size_t)(end > cell && !*end
                             ? snprintf(name + used, ROW_NAME_SIZE - used, "%s%s %.6g", comma,
                                        table->name[column], number)
                             : snprintf(name + used, ROW_NAME_SIZE - used, "%s%.80s", comma, cell));
    }
    if (used < ROW_NAME_SIZE && (nth || !join->key_count))
        snprintf(name + used, ROW_NAME_SIZE - used, "%s %d", used ? ", no." : "row", nth ? nth : 1);
}
