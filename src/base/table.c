#include "table.h"

#include "files.h"
#include "npy.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* What others write between columns. */
static const char separators[] = " ,;",
                  by_tabs[] = "columns must be separated by tabs, not by blanks or commas";

/* The cell as it stands, in one line. */
static int table_fail_cell(const char *path, int line, int column, const char *word, char *reason) {
    char what[100];
    const size_t length = strlen(word);
    if (length > 0 && word[length - 1] == '\r')
        snprintf(what, sizeof what, "ends in a carriage return; lines must end in a newline alone");
    else
        snprintf(what, sizeof what, "column %d: '%.40s' is not a number", column + 1, word);
    return fail_at(reason, path, line, what);
}

static int read_names(struct table *table, char *line, const char *path, int number, char *reason) {
    for (char *at = line, *word; (word = strsep(&at, "\t")) != NULL;) {
        if (table->column_count == TABLE_COLUMNS_MAX)
            return fail_at(reason, path, number, "too many columns");
        table->name[table->column_count] = strdup(word);
        if (!table->name[table->column_count++])
            return fail_at(reason, path, number, "out of memory");
    }
    return table->column_count == 1 && strpbrk(line, separators)
               ? fail_at(reason, path, number, by_tabs)
               : 0;
}

static int read_row(struct table *table, char *line, size_t *capacity, const char *path, int number,
                    char *reason) {
    const size_t used = (size_t)table->row_count * (size_t)table->column_count;
    if (used + (size_t)table->column_count > *capacity) {
        *capacity = 2 * *capacity + 64 * (size_t)table->column_count;
        double *value = realloc(table->value, *capacity * sizeof *value);
        if (!value)
            return fail_at(reason, path, number, "out of memory");
        table->value = value;
    }
    int column = 0;
    char *at = line;
    for (char *word; (word = strsep(&at, "\t")) != NULL; column++) {
        char *end;
        if (column == table->column_count)
            return fail_at(reason, path, number, "more numbers than columns");
        table->value[used + (size_t)column] = strtod(word, &end);
        if ((end == word || *end) && column == 0 && !at && strpbrk(word, separators))
            return fail_at(reason, path, number, by_tabs);
        if (end == word || *end)
            return table_fail_cell(path, number, column, word, reason);
    }
    if (column < table->column_count)
        return fail_at(reason, path, number, "fewer numbers than columns");
    table->row_count++;
    return 0;
}

/* Gives back what the array has grown beyond its rows: some tables are kept for long. */
static void fit(struct table *table) {
    const size_t used = (size_t)table->row_count * (size_t)table->column_count;
    double *value = used > 0 ? realloc(table->value, used * sizeof *value) : NULL;
    table->value = value ? value : table->value;
}

static int read_text(struct table *table, FILE *file, const char *path, char *reason) {
    char *line = NULL;
    size_t size = 0, capacity = 0;
    int code = 0, number = 0;
    for (ssize_t length; !code && (length = getline(&line, &size, file)) > 0;) {
        number++;
        if (line[0] == '#')
            continue;
        if (line[length - 1] != '\n')
            code = fail_at(reason, path, number, "the last line is not complete");
        line[length - 1] = '\0';
        if (!code)
            code = table->column_count ? read_row(table, line, &capacity, path, number, reason)
                                       : read_names(table, line, path, number, reason);
    }
    if (!code && !feof(file))
        code = fail_at(reason, path, 0, "cannot be read");
    if (!code && !table->column_count)
        code = fail_at(reason, path, number, "no column names");
    free(line);
    fit(table);
    return code;
}

int table_read(struct table *table, const char *path, char *reason) {
    *table = (struct table){0};
    FILE *file = open_regular(path);
    if (!file)
        return fail_at(reason, path, 0,
                       errno == EINVAL ? "is no regular file of at most a gibibyte"
                                       : "cannot be read");
    const int binary = npy_is_begun(file);
    const char *wrong = binary ? npy_read(table, file) : NULL;
    int code = wrong ? fail_at(reason, path, 0, wrong) : 0;
    if (!binary)
        code = read_text(table, file, path, reason);
    fclose(file);
    if (code)
        table_free(table);
    return code;
}

void table_free(struct table *table) {
    for (int i = 0; i < table->column_count; i++)
        free(table->name[i]);
    free(table->value);
    *table = (struct table){0};
}

int table_column(const struct table *table, const char *name) {
    for (int i = 0; i < table->column_count; i++)
        if (strcmp(table->name[i], name) == 0)
            return i;
    return -1;
}

double table_value(const struct table *table, int row, int column) {
    return table->value[row * table->column_count + column];
}
