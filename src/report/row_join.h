/* Which rows of two tables are about the same: an older table and a newer one of one name. */
#ifndef WISPLAB_ROW_JOIN_H
#define WISPLAB_ROW_JOIN_H

#include "base/text_table.h"

/* Rows are known by the cells of key columns (method, treatment, setting, ...) that both tables
 * have. Of several rows about the same the first is joined with the first, the second with the
 * second; in tables without keys all are about the same. Index 0 is of the older table, 1 of the
 * newer. */
struct row_join {
    const struct text_table *table[2]; /* not owned */
    int (*key)[2];                     /* the columns of both; owned, as what follows */
    int key_count;
    int *partner[2]; /* of each row, that of the other table; -1: it has none */
    int *nth[2];     /* which of its table's rows about that it is, from 1; 0: the only one */
};

enum { ROW_NAME_SIZE = 240 };

/* Whether a column says what a row is about, not what came of it. */
int row_join_is_key(const struct text_table *table, int column);

/* Takes n log n for n rows. Returns 0, or -1 where there is no memory; to be freed in any case. */
int row_join_make(struct row_join *join, const struct text_table *older,
                  const struct text_table *newer);
void row_join_free(struct row_join *join);

/* What a row of one of the two is about: "rk4, setting 0.1", or "rk4, no. 2" of several. */
void row_join_name(const struct row_join *join, int side, int row, char name[ROW_NAME_SIZE]);

#endif
