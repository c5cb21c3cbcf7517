#include "compare.h"

#include "base/files.h"
#include "base/text_table.h"
#include "html.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- what a row is known by, and what is looked at --- */

/* Columns that say what a row is about, wherever they are. */
static const char *const keys[] = {
    "key",     "scene",         "file",    "axis",   "hair",  "treatment", "method",
    "stepper", "configuration", "variant", "who",    "along", "figure",    "stretch_stiffness",
    "zeta",    "target",        "setting", "number", "value", "rate",      "ratio",
    "name",    "group",         "question"};
enum { KEYS = sizeof keys / sizeof *keys };

/* Columns of numbers of which less is better; between the other two repeats of it lie. */
static const struct measure {
    const char *name, *least, *greatest, *unit;
    int is_time;
} measures[] = {{"error", "error_least", "error_greatest", " m", 0},
                {"force_evaluations", NULL, NULL, " evaluations", 0},
                {"cpu_median", "cpu_least", "cpu_greatest", " s of CPU time", 1}};
enum { MEASURES = sizeof measures / sizeof *measures };

/* A statement's row is its key; of other tables all keys that they have. */
static int is_key(const struct text_table *table, int column) {
    const char *name = table->name[column];
    if (text_table_column(table, "verdict") >= 0)
        return strcmp(name, "key") == 0;
    for (int k = 0; k < KEYS; k++)
        if (strcmp(name, keys[k]) == 0)
            return 1;
    return 0;
}

static const char *cell_at(const struct text_table *table, int row, int column) {
    return table->cell[row * table->column_count + column];
}

/* Whether two rows are about the same; they may be of two tables. */
static int is_same(const struct text_table *a, int i, const struct text_table *b, int k) {
    int any = 0;
    for (int column = 0; column < a->column_count; column++) {
        if (!is_key(a, column))
            continue;
        any = 1;
        if (strcmp(cell_at(a, i, column), text_table_cell(b, k, a->name[column])) != 0)
            return 0;
    }
    return any;
}

static int find_same(const struct text_table *a, int i, const struct text_table *b) {
    for (int k = 0; k < b->row_count; k++)
        if (is_same(a, i, b, k))
            return k;
    return -1;
}

/* Whether no two rows are about the same, so that they can be told apart. */
static int has_keys(const struct text_table *table) {
    for (int i = 0; i < table->row_count; i++)
        if (find_same(table, i, table) != i)
            return 0;
    return table->row_count > 0;
}

static void name_row(const struct text_table *table, int row, char name[240]) {
    name[0] = '\0';
    for (int column = 0; column < table->column_count; column++) {
        const size_t used = strlen(name);
        const char *cell = cell_at(table, row, column);
        char *end;
        const double number = strtod(cell, &end);
        if (!is_key(table, column))
            continue;
        if (end > cell && !*end)
            snprintf(name + used, 240 - used, "%s%s %.6g", used ? ", " : "", table->name[column],
                     number);
        else
            snprintf(name + used, 240 - used, "%s%.80s", used ? ", " : "", cell);
    }
}

/* --- differences --- */

static int add(struct comparison *c, struct difference difference, char *reason) {
    if (c->count == c->capacity) {
        c->capacity = 2 * c->capacity + 64;
        struct difference *all =
            realloc(c->differences, (size_t)c->capacity * sizeof *c->differences);
        if (!all)
            return fail_with(reason, "out of memory");
        c->differences = all;
    }
    c->changes[difference.change]++;
    c->differences[c->count++] = difference;
    return 0;
}

/* A number with what its repeats were; where there are none, itself. */
struct number {
    double value, least, greatest;
};

static struct number read_number(const struct text_table *table, int row, const struct measure *m) {
    struct number n = {.value = text_table_number(table, row, m->name)};
    n.least = m->least ? text_table_number(table, row, m->least) : NAN;
    n.greatest = m->greatest ? text_table_number(table, row, m->greatest) : NAN;
    n.least = isnan(n.least) ? n.value : n.least;
    n.greatest = isnan(n.greatest) ? n.value : n.greatest;
    return n;
}

/* Less is better, and what is no number is worst. */
static enum change judge(struct number was, struct number is, double tolerance) {
    if (isnan(was.value) || isnan(is.value))
        return isnan(was.value) && isnan(is.value) ? CHANGE_NONE
               : isnan(is.value)                   ? CHANGE_WORSE
                                                   : CHANGE_BETTER;
    if (is.least > was.greatest * (1 + tolerance))
        return CHANGE_WORSE;
    return is.greatest * (1 + tolerance) < was.least ? CHANGE_BETTER : CHANGE_NONE;
}

/* A word of which one value is good: a status that was finished, a verdict that held. */
static enum change judge_word(const char *old, const char *new, const char *good) {
    const int was = strcmp(old, good) == 0, is = strcmp(new, good) == 0;
    return was == is ? CHANGE_NONE : is ? CHANGE_BETTER : CHANGE_WORSE;
}

static int compare_words(const struct text_table *old, int i, const struct text_table *new, int k,
                         struct difference *d, struct comparison *c, char *reason) {
    static const char *const words[][2] = {{"status", "finished"}, {"verdict", "holds"}};
    for (int w = 0; w < 2; w++) {
        const char *was = text_table_cell(old, i, words[w][0]),
                   *is = text_table_cell(new, k, words[w][0]);
        if (!*was || !*is)
            continue;
        d->change = judge_word(was, is, words[w][1]);
        snprintf(d->what, sizeof d->what, "%s '%.50s', was '%.50s'", words[w][0], is, was);
        if (d->change && add(c, *d, reason))
            return -1;
    }
    return 0;
}

static int compare_row(const struct compare_request *request, const struct text_table *old, int i,
                       const struct text_table *new, int k, const char *name, struct comparison *c,
                       char *reason) {
    struct difference d = {.change = CHANGE_NONE};
    const int before = c->count;
    snprintf(d.table, sizeof d.table, "%s", name);
    name_row(old, i, d.row);
    if (compare_words(old, i, new, k, &d, c, reason))
        return -1;
    for (int m = 0; m < MEASURES; m++) {
        if (text_table_column(old, measures[m].name) < 0 ||
            text_table_column(new, measures[m].name) < 0 ||
            (measures[m].is_time && !request->with_times))
            continue;
        const struct number was = read_number(old, i, &measures[m]),
                            is = read_number(new, k, &measures[m]);
        d.change = judge(was, is, request->tolerance);
        snprintf(d.what, sizeof d.what, "%s %.4g%s, was %.4g", measures[m].name, is.value,
                 measures[m].unit, was.value);
        if (d.change && add(c, d, reason))
            return -1;
    }
    c->changes[CHANGE_NONE] += c->count == before;
    return 0;
}

/* Rows of `from` that `in` has not. */
static int compare_missing(const struct text_table *from, const struct text_table *in,
                           enum change change, const char *name, struct comparison *c,
                           char *reason) {
    for (int i = 0; i < from->row_count; i++) {
        struct difference d = {.change = change};
        if (find_same(from, i, in) >= 0)
            continue;
        snprintf(d.table, sizeof d.table, "%s", name);
        name_row(from, i, d.row);
        if (add(c, d, reason))
            return -1;
    }
    return 0;
}

static int compare_tables(const struct compare_request *request, const struct text_table *old,
                          const struct text_table *new, const char *name, struct comparison *c,
                          char *reason) {
    if (!has_keys(old) || !has_keys(new)) {
        c->keyless++;
        return 0;
    }
    char(*tables)[160] = realloc(c->tables, (size_t)(c->table_count + 1) * sizeof *tables);
    if (!tables)
        return fail_with(reason, "out of memory");
    c->tables = tables;
    snprintf(c->tables[c->table_count++], sizeof *c->tables, "%s", name);
    for (int i = 0; i < old->row_count; i++) {
        const int k = find_same(old, i, new);
        if (k >= 0 && compare_row(request, old, i, new, k, name, c, reason))
            return -1;
    }
    return compare_missing(old, new, CHANGE_VANISHED, name, c, reason) ||
                   compare_missing(new, old, CHANGE_APPEARED, name, c, reason)
               ? -1
               : 0;
}

/* --- folders --- */

/* `path` is of the older folder. A table that the newer one has not is no part of this: an
 * experiment may not have been asked for. */
static int compare_file(const struct compare_request *request, const char *path,
                        struct comparison *c, char *reason) {
    char other[PATH_SIZE], name[160];
    struct text_table old, new;
    const char *rest = path + strlen(request->older);
    if (path_format(other, "%s%s", request->newer, rest) || !file_exists(other))
        return 0;
    snprintf(name, sizeof name, "%s", rest + 1);
    name[strlen(name) - strlen(".tsv")] = '\0';
    if (text_table_read(&old, path, reason))
        return -1;
    int code = text_table_read(&new, other, reason);
    if (!code) {
        code = compare_tables(request, &old, &new, name, c, reason);
        text_table_free(&new);
    }
    text_table_free(&old);
    return code;
}

int compare_results(const struct compare_request *request, struct comparison *comparison,
                    char *reason) {
    glob_t found;
    *comparison = (struct comparison){.count = 0};
    int code = files_like(request->older, "*/*.tsv", &found);
    if (code)
        snprintf(reason, REASON_SIZE, "out of memory");
    for (size_t i = 0; i < found.gl_pathc && !code; i++)
        code = compare_file(request, found.gl_pathv[i], comparison, reason);
    globfree(&found);
    if (!code && comparison->table_count == 0) {
        snprintf(reason, REASON_SIZE,
                 "%.100s and %.100s have no table in common; both must be an --out of experiments",
                 request->older, request->newer);
        code = -1;
    }
    if (code)
        compare_free(comparison);
    return code;
}

void compare_free(struct comparison *comparison) {
    free(comparison->differences);
    free(comparison->tables);
    *comparison = (struct comparison){.count = 0};
}

/* --- for programs that run tests --- */

static int count_worse(const struct comparison *c, const char *table) {
    int count = 0;
    for (int i = 0; i < c->count; i++)
        count +=
            c->differences[i].change == CHANGE_WORSE && strcmp(c->differences[i].table, table) == 0;
    return count;
}

static void write_case(FILE *stream, const struct comparison *c, const char *table) {
    const int worse = count_worse(c, table);
    fputs("  <testcase classname=\"wisplab.compare\" name=\"", stream);
    html_text(stream, table);
    fputs(worse ? "\">\n" : "\"/>\n", stream);
    if (!worse)
        return;
    fprintf(stream, "    <failure message=\"%d worse\">", worse);
    for (int i = 0; i < c->count; i++) {
        const struct difference *d = &c->differences[i];
        if (d->change == CHANGE_WORSE && strcmp(d->table, table) == 0)
            html_print(stream, "%s: %s\n", d->row, d->what);
    }
    fputs("</failure>\n  </testcase>\n", stream);
}

int compare_write_junit(const struct comparison *comparison, const char *path, char *reason) {
    struct atomic_file file;
    int failed = 0;
    if (atomic_open(&file, path, reason))
        return -1;
    for (int i = 0; i < comparison->table_count; i++)
        failed += count_worse(comparison, comparison->tables[i]) > 0;
    fprintf(file.stream,
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
            "<testsuite name=\"wisplab compare\" tests=\"%d\" failures=\"%d\">\n",
            comparison->table_count, failed);
    for (int i = 0; i < comparison->table_count; i++)
        write_case(file.stream, comparison, comparison->tables[i]);
    fputs("</testsuite>\n", file.stream);
    return atomic_commit(&file, reason);
}
