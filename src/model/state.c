#include "state.h"

#include "base/columns.h"
#include "base/files.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The column of each of the model's columns in the table. Returns 0, or -1 with a reason. */
static int match_columns(const struct model *model, const struct table *table, const char *file,
                         int *columns, char *reason) {
    for (int i = 0; i < model->column_count; i++) {
        columns[i] = table_column(table, model->columns[i]);
        if (columns[i] < 0)
            return fail_with(reason, "%.120s: no column '%s', which this treatment needs", file,
                             model->columns[i]);
    }
    if (table_column(table, "t") == 0 && table->column_count == model->column_count + 1)
        return 0;
    return fail_with(
        reason, "%.120s: has %d columns besides parent; this scene and treatment have t and %d",
        file, table->column_count, model->column_count);
}

/* Row i of the last frame, to be that of the wisp and node which `expected` begins with. */
static int take_row(const struct model *model, const struct table *table, const int *columns, int i,
                    const double *expected, double *row) {
    const int at = table->row_count - model->row_count + i;
    const double t = table_value(table, table->row_count - 1, 0);
    int sound = isfinite(t) && table_value(table, at, 0) == t;
    for (int j = 0; j < model->column_count; j++) {
        row[j] = table_value(table, at, columns[j]);
        sound &= isfinite(row[j]) && (j >= 2 || row[j] == expected[j]);
    }
    return sound;
}

/* Why row i is not what was expected there. */
static void refuse_row(const struct model *model, const struct table *table, const int *columns,
                       int i, const double *expected, const char *file, char *reason) {
    const int first = table->row_count - model->row_count, count = model->column_count;
    const double wisps = table_value(table, table->row_count - 1, columns[0]) + 1;
    const double own_wisps = expected[(model->row_count - 1) * count] + 1;
    if (wisps > own_wisps)
        snprintf(reason, REASON_SIZE,
                 "%.120s: its last frame has %g wisps, and the scene %g: after a subdivision a "
                 "state is none of the scene's",
                 file, wisps, own_wisps);
    else
        snprintf(reason, REASON_SIZE,
                 "%.120s: row %d is not wisp %g, node %g of the last frame in finite numbers", file,
                 first + i + 1, expected[i * count], expected[i * count + 1]);
}

/* The scene's wisps split off from none. */
static int check_parents(const struct trajectory *trajectory, const char *file, char *reason) {
    for (int i = 0; i < trajectory->wisp_count; i++) {
        if (trajectory->parent[i] == i)
            continue;
        return fail_with(
            reason,
            "%.120s: wisp %d has split off from wisp %d: after a subdivision a state is none "
            "of the scene's",
            file, i, trajectory->parent[i]);
    }
    return 0;
}

int state_of(const struct model *model, const struct trajectory *trajectory, const char *file,
             double *rows, double *t, char *reason) {
    const struct table *table = &trajectory->table;
    int columns[TABLE_COLUMNS_MAX], i = 0;
    const int first = table->row_count - model->row_count, count = model->column_count;
    if (match_columns(model, table, file, columns, reason))
        return -1;
    if (first < 0)
        return fail_with(reason, "%.120s: has %d rows; a frame of this scene has %d", file,
                         table->row_count, model->row_count);
    double *expected = malloc((size_t)(model->row_count * count) * sizeof *expected);
    if (!expected)
        return fail_with(reason, "out of memory");
    model->problem->sample(model, expected); /* for the numbers of wisps and nodes */
    while (i < model->row_count &&
           take_row(model, table, columns, i, expected + i * count, rows + i * count))
        i++;
    if (i < model->row_count)
        refuse_row(model, table, columns, i, expected, file, reason);
    *t = table_value(table, table->row_count - 1, 0);
    free(expected);
    return i < model->row_count ? -1 : check_parents(trajectory, file, reason);
}

/* --- what the columns are --- */

/* Those of a sample are without its number. */
static const struct column known[] = {
    {"t", "s", "time"},
    {"wisp", "1", "number of the wisp"},
    {"node", "1", "number of the node; 0 and 1 belong to the head"},
    {"x", "m", "position"},
    {"y", "m", "position"},
    {"z", "m", "position"},
    {"vx", "m/s", "velocity"},
    {"vy", "m/s", "velocity"},
    {"vz", "m/s", "velocity"},
    {"ax", "m/s^2", "acceleration"},
    {"ay", "m/s^2", "acceleration"},
    {"az", "m/s^2", "acceleration"},
    {"r", "m", "distance of the sample from its node"},
    {"rd", "m/s", "rate of that distance"},
    {"rdd", "m/s^2", "second derivative of that distance"},
    {"ex", "m", "position of the sample"},
    {"ey", "m", "position of the sample"},
    {"ez", "m", "position of the sample"},
    {"evx", "m/s", "velocity of the sample"},
    {"evy", "m/s", "velocity of the sample"},
    {"evz", "m/s", "velocity of the sample"},
    {"eax", "m/s^2", "acceleration of the sample"},
    {"eay", "m/s^2", "acceleration of the sample"},
    {"eaz", "m/s^2", "acceleration of the sample"},
    {"parent", "1", "the wisp that this one split off from; its own number where there is none"},
};
enum { KNOWN = sizeof known / sizeof *known };

static struct column describe(const char *name) {
    char bare[16];
    size_t length = 0;
    for (const char *at = name; *at && length + 1 < sizeof bare; at++)
        if (!isdigit((unsigned char)*at))
            bare[length++] = *at;
    bare[length] = '\0';
    for (int i = 0; i < KNOWN; i++)
        if (strcmp(known[i].name, bare) == 0)
            return (struct column){name, known[i].unit, known[i].meaning};
    return (struct column){name, "", ""};
}

static void write_columns(FILE *stream, const char *first, const char *const *names,
                          const char *last) {
    struct column columns[TABLE_COLUMNS_MAX + 1] = {{0}};
    int count = 0;
    if (first)
        columns[count++] = describe(first);
    for (int i = 0; names[i]; i++)
        columns[count++] = describe(names[i]);
    if (last)
        columns[count++] = describe(last);
    columns_write(stream, columns);
}

void state_write_columns(FILE *stream, const struct model *model) {
    write_columns(stream, "t", model->columns, "parent");
}

void state_write_rate_columns(FILE *stream, const struct model *model) {
    write_columns(stream, NULL, model->rate_columns, NULL);
}

/* --- a file with the last frame of another --- */

/* Copies a text file from where it stands, up to `end` or, where that is negative, to its end. */
static void copy(FILE *from, long end, FILE *to) {
    for (int c; (end < 0 || ftell(from) < end) && (c = fgetc(from)) != EOF;)
        fputc(c, to);
}

/* Where the first row stands, and the first of the rows that have the last one's time. Returns 0,
 * or -1 where the table cannot be read to its end. */
static int find_last_frame(FILE *table, long *rows, long *frame) {
    char *line = NULL, time[64] = "";
    size_t size = 0;
    int named = 0;
    *rows = *frame = 0;
    for (long at = 0; getline(&line, &size, table) > 0; at = ftell(table)) {
        const size_t length = strcspn(line, "\t\n");
        if (line[0] == '#')
            continue;
        if (!named) {
            named = 1;
            *rows = *frame = ftell(table);
        } else if (length >= sizeof time || strlen(time) != length ||
                   strncmp(time, line, length) != 0) {
            snprintf(time, sizeof time, "%.*s", (int)length, line);
            *frame = at;
        }
    }
    free(line);
    return feof(table) ? 0 : -1;
}

int state_save(const char *states, const char *file, char *reason) {
    struct atomic_file saved;
    long rows, frame;
    FILE *table = fopen(states, "r");
    if (!table)
        return fail_with(reason, "%.150s: %s", states, strerror(errno));
    int code = find_last_frame(table, &rows, &frame);
    if (code)
        snprintf(reason, REASON_SIZE, "%.150s: cannot be read", states);
    else
        code = atomic_open(&saved, file, reason);
    if (!code) {
        rewind(table);
        copy(table, rows, saved.stream);
        fseek(table, frame, SEEK_SET);
        copy(table, -1, saved.stream);
        code = atomic_commit(&saved, reason);
    }
    fclose(table);
    return code;
}
