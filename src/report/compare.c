#include "compare.h"

#include "base/files.h"
#include "base/text_table.h"
#include "html.h"
#include "row_join.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- what is looked at --- */

/* Columns of numbers, between the other two of which repeats of it lie. (A sweep's CPU times have
 * none: a run that took longer once tells nothing.) Less is better, but of the longest steps that
 * are stable or near the truth. */
static const struct measure {
    const char *name, *least, *greatest, *unit;
    int is_time, more_is_better;
    const char *beside; /* the column that tells such a table; NULL: in every table */
} measures[] = {{"error", "error_least", "error_greatest", " m", 0, 0, NULL},
                {"error_rms", NULL, NULL, " m", 0, 0, NULL},
                {"error_largest", NULL, NULL, " m", 0, 0, NULL},
                {"error_end", NULL, NULL, " m", 0, 0, NULL},
                {"force_evaluations", NULL, NULL, " evaluations", 0, 0, NULL},
                {"evaluations", NULL, NULL, " evaluations", 0, 0, NULL},
                {"step", NULL, NULL, " s", 0, 1, "unstable_step"},
                {"near_step", NULL, NULL, " s", 0, 1, NULL},
                {"mm_step", NULL, NULL, " s", 0, 1, NULL},
                {"cpu_median", "cpu_least", "cpu_greatest", " s of CPU time", 1, 0, NULL}};
enum { MEASURES = sizeof measures / sizeof *measures };

/* Columns of words of which one is good. (Verdicts are of statements; other tables have their own.)
 */
static const struct {
    const char *name, *good, *beside;
} words[] = {{"status", "finished", "status"},
             {"outcome", "finished", "outcome"},
             {"verdict", "holds", "key"}};
enum { WORDS = sizeof words / sizeof *words };

static int has_measure(const struct text_table *table, int m, int with_times) {
    const char *beside = measures[m].beside;
    return (with_times || !measures[m].is_time) &&
           text_table_column(table, measures[m].name) >= 0 &&
           (!beside || text_table_column(table, beside) >= 0);
}

static int has_word(const struct text_table *table, int w) {
    return text_table_column(table, words[w].name) >= 0 &&
           text_table_column(table, words[w].beside) >= 0;
}

/* --- differences --- */

/* Two tables of one name, and where what is found goes: the last of its tables. */
struct pair {
    const struct compare_request *request;
    const struct text_table *table[2]; /* older, newer */
    struct row_join join;
    struct comparison *found;
};

/* Adds a table, which the next differences are of. */
static int add_table(struct comparison *c, const char *name, char *reason) {
    struct compared_table *tables =
        realloc(c->tables, (size_t)(c->table_count + 1) * sizeof *tables);
    if (!tables)
        return fail_with(reason, "out of memory");
    c->tables = tables;
    tables[c->table_count] = (struct compared_table){.left_out = NULL};
    snprintf(tables[c->table_count++].name, sizeof tables->name, "%s", name);
    return 0;
}

int compare_is_failure(const struct comparison *c, const struct difference *d) {
    return d->change == CHANGE_WORSE || (c->complete && d->change == CHANGE_VANISHED);
}

static int add(struct comparison *c, struct difference difference, char *reason) {
    struct compared_table *table = &c->tables[c->table_count - 1];
    if (c->count == c->capacity) {
        c->capacity = 2 * c->capacity + 64;
        struct difference *all =
            realloc(c->differences, (size_t)c->capacity * sizeof *c->differences);
        if (!all)
            return fail_with(reason, "out of memory");
        c->differences = all;
    }
    snprintf(difference.table, sizeof difference.table, "%s", table->name);
    table->failures += compare_is_failure(c, &difference);
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

/* What is no number is worst. */
static enum change judge(const struct measure *measure, struct number was, struct number is,
                         double tolerance) {
    if (isnan(was.value) || isnan(is.value))
        return isnan(was.value) && isnan(is.value) ? CHANGE_NONE
               : isnan(is.value)                   ? CHANGE_WORSE
                                                   : CHANGE_BETTER;
    const struct number bad = measure->more_is_better ? was : is,
                        good = measure->more_is_better ? is : was; /* where that one is larger */
    if (bad.least > good.greatest * (1 + tolerance))
        return CHANGE_WORSE;
    return good.least > bad.greatest * (1 + tolerance) ? CHANGE_BETTER : CHANGE_NONE;
}

/* A word of which one value is good: a status that was finished, a verdict that held. */
static enum change judge_word(const char *old, const char *new, const char *good) {
    const int was = strcmp(old, good) == 0, is = strcmp(new, good) == 0;
    return was == is ? CHANGE_NONE : is ? CHANGE_BETTER : CHANGE_WORSE;
}

static int compare_words(struct pair *pair, int i, int k, struct difference *d, char *reason) {
    for (int w = 0; w < WORDS; w++) {
        if (!has_word(pair->table[0], w) || !has_word(pair->table[1], w))
            continue;
        const char *was = text_table_cell(pair->table[0], i, words[w].name),
                   *is = text_table_cell(pair->table[1], k, words[w].name);
        d->change = judge_word(was, is, words[w].good);
        snprintf(d->what, sizeof d->what, "%s '%.50s', was '%.50s'", words[w].name, is, was);
        if (d->change && add(pair->found, *d, reason))
            return -1;
    }
    return 0;
}

static int compare_measures(struct pair *pair, int i, int k, struct difference *d, char *reason) {
    for (int m = 0; m < MEASURES; m++) {
        if (!has_measure(pair->table[0], m, pair->request->with_times) ||
            !has_measure(pair->table[1], m, pair->request->with_times))
            continue;
        const struct number was = read_number(pair->table[0], i, &measures[m]),
                            is = read_number(pair->table[1], k, &measures[m]);
        d->change = judge(&measures[m], was, is, pair->request->tolerance);
        snprintf(d->what, sizeof d->what, "%s %.4g%s, was %.4g", measures[m].name, is.value,
                 measures[m].unit, was.value);
        if (d->change && add(pair->found, *d, reason))
            return -1;
    }
    return 0;
}

static int compare_row(struct pair *pair, int i, int k, char *reason) {
    struct difference d = {.change = CHANGE_NONE};
    const int before = pair->found->count;
    row_join_name(&pair->join, 0, i, d.row);
    if (compare_words(pair, i, k, &d, reason) || compare_measures(pair, i, k, &d, reason))
        return -1;
    pair->found->changes[CHANGE_NONE] += pair->found->count == before;
    return 0;
}

/* Rows of one of the tables that the other has not. */
static int add_missing(struct pair *pair, int side, enum change change, char *reason) {
    for (int i = 0; i < pair->table[side]->row_count; i++) {
        struct difference d = {.change = change};
        if (pair->join.partner[side][i] >= 0)
            continue;
        row_join_name(&pair->join, side, i, d.row);
        if (add(pair->found, d, reason))
            return -1;
    }
    return 0;
}

static int compare_rows(struct pair *pair, char *reason) {
    for (int i = 0; i < pair->table[0]->row_count; i++) {
        const int k = pair->join.partner[0][i];
        if (k >= 0 && compare_row(pair, i, k, reason))
            return -1;
    }
    return add_missing(pair, 0, CHANGE_VANISHED, reason) ||
                   add_missing(pair, 1, CHANGE_APPEARED, reason)
               ? -1
               : 0;
}

/* --- tables --- */

/* Whether a column is looked at, or rows are known by it. */
static int counts(const struct text_table *table, int column, int with_times) {
    for (int w = 0; w < WORDS; w++)
        if (strcmp(table->name[column], words[w].name) == 0 && has_word(table, w))
            return 1;
    for (int m = 0; m < MEASURES; m++)
        if (strcmp(table->name[column], measures[m].name) == 0)
            return has_measure(table, m, with_times);
    return row_join_is_key(table, column);
}

/* Columns of one of the tables that the other has not. */
static int add_columns(struct pair *pair, int side, enum change change, char *reason) {
    const struct text_table *table = pair->table[side];
    for (int i = 0; i < table->column_count; i++) {
        struct difference d = {.change = change};
        snprintf(d.row, sizeof d.row, "column %.100s", table->name[i]);
        if (text_table_column(pair->table[!side], table->name[i]) < 0 &&
            counts(table, i, pair->request->with_times) && add(pair->found, d, reason))
            return -1;
    }
    return 0;
}

/* Why nothing can be said of two tables; NULL: something can. */
static const char *left_out(const struct pair *pair) {
    const struct text_table *older = pair->table[0], *newer = pair->table[1];
    int looked_at = 0, times = 0;
    for (int m = 0; m < MEASURES; m++) {
        const int has = has_measure(older, m, 1) && has_measure(newer, m, 1);
        times += has && measures[m].is_time;
        looked_at += has && (pair->request->with_times || !measures[m].is_time);
    }
    for (int w = 0; w < WORDS; w++)
        looked_at += has_word(older, w) && has_word(newer, w);
    return !looked_at ? times ? "of what is looked at it has only CPU times"
                              : "has no column that is looked at"
           : older->row_count == 0 && newer->row_count == 0 ? "has no rows"
                                                            : NULL;
}

static int compare_tables(struct pair *pair, char *reason) {
    struct comparison *c = pair->found;
    const char *why = left_out(pair);
    c->tables[c->table_count - 1].left_out = why;
    c->left_out += why != NULL;
    if (add_columns(pair, 0, CHANGE_VANISHED, reason) ||
        add_columns(pair, 1, CHANGE_APPEARED, reason))
        return -1;
    if (why)
        return 0;
    const int code = row_join_make(&pair->join, pair->table[0], pair->table[1])
                         ? fail_with(reason, "out of memory")
                         : compare_rows(pair, reason);
    row_join_free(&pair->join);
    return code;
}

static int compare_files(const struct compare_request *request, const char *older_path,
                         const char *newer_path, struct comparison *c, char *reason) {
    struct text_table older, newer;
    if (text_table_read(&older, older_path, reason))
        return -1;
    int code = text_table_read(&newer, newer_path, reason);
    if (!code) {
        struct pair pair = {.request = request, .table = {&older, &newer}, .found = c};
        code = compare_tables(&pair, reason);
        text_table_free(&newer);
    }
    text_table_free(&older);
    return code;
}

/* --- folders --- */

/* Takes up a table of one of the folders: one that both have with the older folder, one that only
 * the newer has with that. */
static int compare_file(const struct compare_request *request, const char *path, int is_newer,
                        struct comparison *c, char *reason) {
    char other[PATH_SIZE], name[160];
    const char *folder = is_newer ? request->newer : request->older, *rest = path + strlen(folder);
    const size_t length = strlen(rest) - strlen("/.tsv");
    if (path_format(other, "%s%s", is_newer ? request->older : request->newer, rest))
        return fail_with(reason, "%.150s: the path is too long", path);
    const int in_both = file_exists(other);
    if (strncmp(rest, "/runs/", 6) == 0 || (is_newer && in_both))
        return 0;
    snprintf(name, sizeof name, "%.*s", (int)length, rest + 1);
    if (add_table(c, name, reason))
        return -1;
    if (in_both)
        return compare_files(request, path, other, c, reason);
    struct compared_table *table = &c->tables[c->table_count - 1];
    table->alone = 1;
    table->left_out = is_newer ? "is new" : "has vanished";
    return add(c,
               (struct difference){.change = is_newer ? CHANGE_APPEARED : CHANGE_VANISHED,
                                   .row = "the whole table"},
               reason);
}

static int compare_folder(const struct compare_request *request, const char *pattern, int is_newer,
                          struct comparison *c, char *reason) {
    glob_t found;
    int code = files_like(is_newer ? request->newer : request->older, pattern, &found)
                   ? fail_with(reason, "out of memory")
                   : 0;
    for (size_t i = 0; i < found.gl_pathc && !code; i++)
        code = compare_file(request, found.gl_pathv[i], is_newer, c, reason);
    globfree(&found);
    return code;
}

/* Tables are in the folders of experiments; a sweep's folder has its own. */
static int compare_folders(const struct compare_request *request, struct comparison *c,
                           char *reason) {
    static const char *const patterns[] = {"*.tsv", "*/*.tsv"};
    const char *const folders[] = {request->older, request->newer};
    for (int i = 0; i < 2; i++)
        if (!file_exists(folders[i]))
            return fail_with(reason, "%.150s: %s", folders[i], strerror(errno));
    for (int is_newer = 0; is_newer <= 1; is_newer++)
        for (int i = 0; i < 2; i++)
            if (compare_folder(request, patterns[i], is_newer, c, reason))
                return -1;
    for (int i = 0; i < c->table_count; i++)
        if (!c->tables[i].left_out)
            return 0;
    return fail_with(reason,
                     "%.100s and %.100s have no table in common%s; both must be an --out of "
                     "experiments or of a sweep",
                     request->older, request->newer,
                     c->left_out ? " in which anything is looked at" : "");
}

int compare_results(const struct compare_request *request, struct comparison *comparison,
                    char *reason) {
    *comparison = (struct comparison){.complete = request->complete};
    const int code = compare_folders(request, comparison, reason);
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

static void write_case(FILE *stream, const struct comparison *c,
                       const struct compared_table *table) {
    fputs("  <testcase classname=\"wisplab.compare\" name=\"", stream);
    html_text(stream, table->name);
    if (!table->failures && !table->left_out) {
        fputs("\"/>\n", stream);
        return;
    }
    if (!table->failures) {
        fprintf(stream, "\"><skipped message=\"%s\"/></testcase>\n", table->left_out);
        return;
    }
    fprintf(stream, "\">\n    <failure message=\"%d worse\">", table->failures);
    for (int i = 0; i < c->count; i++) {
        const struct difference *d = &c->differences[i];
        if (compare_is_failure(c, d) && strcmp(d->table, table->name) == 0)
            html_print(stream, "%s: %s\n", d->row, *d->what ? d->what : "vanished");
    }
    fputs("</failure>\n  </testcase>\n", stream);
}

int compare_write_junit(const struct comparison *comparison, const char *path, char *reason) {
    struct atomic_file file;
    int failed = 0, skipped = 0;
    if (atomic_open(&file, path, reason))
        return -1;
    for (int i = 0; i < comparison->table_count; i++) {
        const struct compared_table *table = &comparison->tables[i];
        failed += table->failures > 0;
        skipped += !table->failures && table->left_out;
    }
    fprintf(file.stream,
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
            "<testsuite name=\"wisplab compare\" tests=\"%d\" failures=\"%d\" skipped=\"%d\">\n",
            comparison->table_count, failed, skipped);
    for (int i = 0; i < comparison->table_count; i++)
        write_case(file.stream, comparison, &comparison->tables[i]);
    fputs("</testsuite>\n", file.stream);
    return atomic_commit(&file, reason);
}
