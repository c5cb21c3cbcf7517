#include "text_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int fail(struct text_table *table, const char *path, int line, const char *what,
                char *reason) {
    text_table_free(table);
    return fail_at(reason, path, line, what);
}

/* Cuts a line at its tabs into at most `most` cells; returns their number. */
static int cut(char *line, char **cells, int most) {
    int count = 0;
    for (char *at = line; at && count < most;) {
        cells[count++] = at;
        at = count < most ? strchr(at, '\t') : NULL;
        if (at)
            *at++ = '\0';
    }
    return count;
}

static int count_of(const char *text, char letter) {
    int count = 0;
    for (; *text; text++)
        count += *text == letter;
    return count;
}

static int read_line(struct text_table *table, char *line) {
    if (line[0] == '#') {
        if (!*table->about)
            table->about = line + 1 + strspn(line + 1, " ");
        return 0;
    }
    if (!*line)
        return 0;
    if (!table->name) {
        const int columns = count_of(line, '\t') + 1;
        table->name = malloc((size_t)columns * sizeof *table->name);
        table->column_count = table->name ? cut(line, table->name, columns) : 0;
        return table->name ? 0 : -2;
    }
    const size_t rows = (size_t)table->row_count, columns = (size_t)table->column_count;
    if ((rows & (rows - 1)) == 0) { /* at 0, 1, 2, 4, ... it is full */
        char **cell = realloc(table->cell, (rows ? 2 * rows : 1) * columns * sizeof *cell);
        if (!cell)
            return -2;
        table->cell = cell;
    }
    if (cut(line, table->cell + rows * columns, table->column_count) < table->column_count)
        return -1;
    table->row_count++;
    return 0;
}

int text_table_read(struct text_table *table, const char *path, char *reason) {
    static char nothing[] = "";
    *table = (struct text_table){.about = nothing, .content = file_text(path)};
    if (!table->content)
        return fail(table, path, 0, "cannot be read", reason);
    const size_t length = strlen(table->content);
    if (length > 0 && table->content[length - 1] != '\n')
        return fail(table, path, count_of(table->content, '\n') + 1,
                    "the last line is not complete", reason);
    int number = 1;
    for (char *at = table->content, *line; (line = strsep(&at, "\n")) != NULL; number++) {
        const int code = read_line(table, line);
        if (code)
            return fail(table, path, number,
                        code == -2 ? "out of memory" : "fewer cells than columns", reason);
    }
    return table->name ? 0 : fail(table, path, 0, "no column names", reason);
}

void text_table_free(struct text_table *table) {
    free(table->name);
    free(table->cell);
    free(table->content);
    *table = (struct text_table){0};
}

int text_table_column(const struct text_table *table, const char *name) {
    for (int i = 0; i < table->column_count; i++)
        if (strcmp(table->name[i], name) == 0)
            return i;
    return -1;
}

const char *text_table_cell(const struct text_table *table, int row, const char *name) {
    const int column = text_table_column(table, name);
    return column < 0 ? "" : table->cell[row * table->column_count + column];
}

double text_table_number(const struct text_table *table, int row, const char *name) {
    const char *text = text_table_cell(table, row, name);
    char *end;
    const double value = strtod(text, &end);
    return end == text || *end ? NAN : value;
}

int text_cell_is_empty(const char *cell) {
    return !*cell || strcmp(cell, "nan") == 0 || strcmp(cell, "-nan") == 0;
}

/* --- is there a reason for what is not there? --- */

static int is_for_words(const char *column) {
    static const char *const words[] = {"note", "reason", "limit", "comparison"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (strcmp(column, words[i]) == 0)
            return 1;
    return 0;
}

static int row_has_reason(const struct text_table *table, int row, const char *column) {
    const char *status = text_table_cell(table, row, "status");
    const int finished = strcmp(status, "finished") == 0;
    if (*status && (!finished || strcmp(column, "failure_time") == 0))
        return 1;
    for (int i = 0; i < table->column_count; i++)
        if (is_for_words(table->name[i]) && table->cell[row * table->column_count + i][0])
            return 1;
    return 0;
}

static int table_has_reason(const struct text_table *table) {
    int rows_can = text_table_column(table, "status") >= 0;
    for (int i = 0; i < table->column_count; i++)
        rows_can |= is_for_words(table->name[i]);
    return !rows_can && strstr(table->about, "nan: ");
}

int text_table_check(const struct text_table *table, const char *path, char *reason) {
    if (table_has_reason(table))
        return 0;
    for (int row = 0; row < table->row_count; row++) {
        for (int i = 0; i < table->column_count; i++) {
            const char *cell = table->cell[row * table->column_count + i];
            if (!text_cell_is_empty(cell) || is_for_words(table->name[i]) ||
                row_has_reason(table, row, table->name[i]))
                continue;
            return fail_with(reason,
                             "%.150s: row %d, column %.40s: empty, and no status or note says why",
                             path, row + 1, table->name[i]);
        }
    }
    return 0;
}
