#include "results.h"

#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static int table_fail(const char *path, int line, const char *what, char *reason) {
    if (line > 0)
        snprintf(reason, REASON_SIZE, "%.150s:%d: %s", path, line, what);
    else
        snprintf(reason, REASON_SIZE, "%.150s: %s", path, what);
    return -1;
}

/* The cell as it stands, in one line. */
static int table_fail_cell(const char *path, int line, int column, const char *word, char *reason) {
    char what[100];
    const size_t length = strlen(word);
    if (length > 0 && word[length - 1] == '\r')
        snprintf(what, sizeof what, "ends in a carriage return; lines must end in a newline alone");
    else
        snprintf(what, sizeof what, "column %d: '%.40s' is not a number", column + 1, word);
    return table_fail(path, line, what, reason);
}

static int read_names(struct table *table, char *line, const char *path, int number, char *reason) {
    for (char *at = line, *word; (word = strsep(&at, "\t")) != NULL;) {
        if (table->column_count == TABLE_COLUMNS_MAX)
            return table_fail(path, number, "too many columns", reason);
        table->name[table->column_count] = strdup(word);
        if (!table->name[table->column_count++])
            return table_fail(path, number, "out of memory", reason);
    }
    return 0;
}

static int read_row(struct table *table, char *line, size_t *capacity, const char *path, int number,
                    char *reason) {
    const size_t used = (size_t)table->row_count * (size_t)table->column_count;
    if (used + (size_t)table->column_count > *capacity) {
        *capacity = 2 * *capacity + 64 * (size_t)table->column_count;
        double *value = realloc(table->value, *capacity * sizeof *value);
        if (!value)
            return table_fail(path, number, "out of memory", reason);
        table->value = value;
    }
    int column = 0;
    char *at = line;
    for (char *word; (word = strsep(&at, "\t")) != NULL; column++) {
        char *end;
        if (column == table->column_count)
            return table_fail(path, number, "more numbers than columns", reason);
        table->value[used + (size_t)column] = strtod(word, &end);
        if (end == word || *end)
            return table_fail_cell(path, number, column, word, reason);
    }
    if (column < table->column_count)
        return table_fail(path, number, "fewer numbers than columns", reason);
    table->row_count++;
    return 0;
}

int table_read(struct table *table, const char *path, char *reason) {
    *table = (struct table){0};
    FILE *file = fopen(path, "r");
    if (!file)
        return table_fail(path, 0, "cannot be read", reason);
    char *line = NULL;
    size_t size = 0, capacity = 0;
    int code = 0, number = 0;
    for (ssize_t length; !code && (length = getline(&line, &size, file)) > 0;) {
        number++;
        if (line[0] == '#')
            continue;
        if (line[length - 1] != '\n')
            code = table_fail(path, number, "the last line is not complete", reason);
        line[length - 1] = '\0';
        if (!code)
            code = table->column_count ? read_row(table, line, &capacity, path, number, reason)
                                       : read_names(table, line, path, number, reason);
    }
    if (!code && !feof(file))
        code = table_fail(path, 0, "cannot be read", reason);
    if (!code && !table->column_count)
        code = table_fail(path, number, "no column names", reason);
    free(line);
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

/* Whether all frames are there that run.json counts, and the last has no fewer nodes than the one
 * before: wisps become more, but not fewer. */
static int has_all_frames(const struct run_files *run) {
    const struct table *states = &run->states;
    int frames = 0, rows = 0, rows_before = 0;
    for (int i = 0; i < states->row_count; i++) {
        if (i == 0 || table_value(states, i, 0) != table_value(states, i - 1, 0)) {
            rows_before = rows;
            rows = 0;
            frames++;
        }
        rows++;
    }
    return frames > 0 && frames == run_number(run, "frames") && rows >= rows_before;
}

/* A run that died early has no frames. */
static int read_states(struct run_files *run, const char *path, char *reason) {
    enum { T_TO_VZ = 9 };
    if (run->outcome != FINISHED && !file_exists(path))
        return 0;
    if (table_read(&run->states, path, reason))
        return -1;
    if (run->states.column_count < T_TO_VZ)
        return table_fail(path, 0, "has not the columns of states", reason);
    if (run->outcome == FINISHED && !has_all_frames(run))
        return table_fail(path, 0, "has not all frames of a run that finished", reason);
    return 0;
}

int run_read(struct run_files *run, const char *folder, char *reason) {
    char path[PATH_SIZE];
    json_error_t error;
    *run = (struct run_files){0};
    path_format(path, "%s/run.json", folder);
    run->json = json_load_file(path, 0, &error);
    if (!run->json) {
        snprintf(reason, REASON_SIZE, "%.120s:%d: %.100s", path, error.line, error.text);
        return -1;
    }
    const char *status = json_string_value(json_object_get(run->json, "status"));
    run->outcome = outcome_from_name(status ? status : "");
    path_format(path, "%s/states.tsv", folder);
    if (run->outcome == OUTCOME_COUNT) {
        snprintf(reason, REASON_SIZE, "%.150s/run.json: unknown status", folder);
    } else if (read_states(run, path, reason) == 0) {
        return 0;
    }
    run_free(run);
    return -1;
}

void run_free(struct run_files *run) {
    json_decref(run->json);
    run->json = NULL;
    table_free(&run->states);
}

double run_number(const struct run_files *run, const char *path) {
    char copy[128];
    const json_t *json = run->json;
    snprintf(copy, sizeof copy, "%s", path);
    for (char *at = copy, *name; (name = strsep(&at, ".")) != NULL;)
        json = json_object_get(json, name);
    return json_is_number(json) ? json_number_value(json) : NAN;
}

struct spread run_cpu_time(const struct run_files *run) {
    const json_t *list = json_object_get(run->json, "cpu_seconds_repeated");
    const size_t count = json_array_size(list);
    double *seconds = malloc((count + 1) * sizeof *seconds);
    struct spread spread = {NAN, NAN, NAN};
    if (count > 0 && seconds) {
        for (size_t i = 0; i < count; i++)
            seconds[i] = json_number_value(json_array_get(list, i));
        gsl_sort(seconds, 1, count);
        spread = (struct spread){gsl_stats_median_from_sorted_data(seconds, 1, count), seconds[0],
                                 seconds[count - 1]};
    }
    free(seconds);
    return spread;
}
