#include "statements.h"

#include "output.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static const char *const verdict_words[] = {
#define X(symbol, word, meaning) word,
    VERDICTS(X)
#undef X
};

static const struct {
    const char *word, *text;
} questions[] = {
#define X(symbol, word, text) {word, text},
    QUESTIONS(X)
#undef X
};

static const char *const whose_words[] = {[OURS] = "ours", [THESIS] = "thesis"};

enum { TEXT_SIZE = 1024 };
static const char nothing[] = "-";

#define ROW_COLUMNS(X)                                                             \
    X("key", "-", "name of the row", "%s", CELL(row.key))                          \
    X("figure", "-", "figure that it stands under", "%s", CELL(row.figure))        \
    X("question", "-", "question of the report that it answers", "%s",             \
      questions[row.answers].word)                                                 \
    X("statement", "-", "the sentence", "%s", CELL(text))                          \
    X("verdict", "-", "what the runs say of it", "%s", verdict_words[row.verdict]) \
    X("value", "see unit", "number that the verdict rests on", "%s", CELL(value))  \
    X("unit", "-", "unit of value", "%s", CELL(has_value ? row.unit : NULL))       \
    X("by", "-", "whose claim it is", "%s", whose_words[row.by])                   \
    X("tables", "-", "tables that it follows from", "%s", CELL(row.tables))

static const struct column *const columns = COLUMNS(ROW_COLUMNS);

const char *question_word(enum question question) {
    return questions[question].word;
}

const char *question_text(enum question question) {
    return questions[question].text;
}

/* --- writing --- */

int statements_open(struct statements *statements, const char *folder, const struct scene *scene,
                    const char *cut, char *reason) {
    char what[1024];
    int used = snprintf(what, sizeof what, "what was found, a sentence a row; verdict:");
#define X(symbol, word, meaning) \
    used += snprintf(what + used, sizeof what - (size_t)used, " %s: " meaning ";", word);
    VERDICTS(X)
#undef X
    snprintf(what + used, sizeof what - (size_t)used,
             " value: what the verdict rests on; by: whose claim it is; tables: that it follows "
             "from; -: none%s%s",
             cut ? "; " : "", cut ? cut : "");
    const struct table_form form = {"statements", what, columns};
    return open_table(&statements->file, folder, &form, scene, reason);
}

/* A text as a cell: one line, no tabs, and something in it. */
#define CELL(text) cell_of((char[TEXT_SIZE]){0}, text)
static const char *cell_of(char room[TEXT_SIZE], const char *text) {
    snprintf(room, TEXT_SIZE, "%s", text && *text ? text : nothing);
    for (char *at = room; *at; at++)
        if ((unsigned char)*at < ' ')
            *at = ' ';
    return room;
}

void statements_add(struct statements *statements, struct statement row, const char *sentence,
                    ...) {
    char text[TEXT_SIZE], value[32] = "";
    const int has_value = row.unit && isfinite(row.value);
    va_list arguments;
    va_start(arguments, sentence);
    vsnprintf(text, sizeof text, sentence, arguments);
    va_end(arguments);
    if (has_value)
        snprintf(value, sizeof value, "%.17g", row.value);
    WRITE_ROW(statements->file.stream, ROW_COLUMNS);
}

struct statement statement_row(enum whose by, const char *figure, const char *tables,
                               enum claim_verdict verdict, double value, const char *unit,
                               const char *key, ...) {
    struct statement row = {
        .figure = figure, .by = by, .verdict = verdict, .value = value, .unit = unit};
    va_list arguments;
    va_start(arguments, key);
    vsnprintf(row.key, sizeof row.key, key, arguments);
    va_end(arguments);
    snprintf(row.tables, sizeof row.tables, "%s", tables ? tables : "");
    return row;
}

void list_add(char *list, size_t size, const char *item, ...) {
    const size_t used = strlen(list), more = used > 0 ? used + 2 : 0;
    va_list arguments;
    if (more >= size)
        return;
    memcpy(list + used, ", ", more - used);
    va_start(arguments, item);
    vsnprintf(list + more, size - more, item, arguments);
    va_end(arguments);
}

static int by_counted(const void *a, const void *b) {
    const double x = ((const struct rival *)a)->counted, y = ((const struct rival *)b)->counted;
    return (x > y) - (x < y);
}

void list_rivals(char text[512], struct rival *rivals, int count) {
    const int most = 3, named = count > most + 1 ? most : count;
    size_t used = 0;
    qsort(rivals, (size_t)count, sizeof *rivals, by_counted);
    text[0] = '\0';
    for (int i = 0; i < named && used < 512; i++)
        used +=
            (size_t)snprintf(text + used, 512 - used, "%s %s (%.3g ms)",
                             i + 1 == count ? " and" : ",", rivals[i].name, 1e3 * rivals[i].cpu);
    if (named < count && used < 512)
        snprintf(text + used, 512 - used, " and %d more", count - named);
}

void statements_of_changed(struct statements *statements, const char *const *sets, int set_count) {
    char changes[512] = "";
    for (int i = 0; i < set_count; i++)
        list_add(changes, sizeof changes, "%s", sets[i]);
    if (set_count > 0)
        statements_add(
            statements, (struct statement){.key = "changed scenes", .verdict = NOT_ASKED},
            "What follows is of scenes with %s, and says nothing of them as they are.", changes);
}

int statements_close(struct statements *statements, int code, char *reason) {
    if (!code)
        return atomic_commit(&statements->file, reason);
    atomic_discard(&statements->file);
    return code;
}

/* --- reading --- */

static int is_verdict(const char *word) {
    for (int i = 0; i < VERDICT_COUNT; i++)
        if (strcmp(verdict_words[i], word) == 0)
            return 1;
    return 0;
}

const char *statement_finding(const char *sentence) {
    const char *colon = strstr(sentence, ": ");
    return colon ? colon + 2 : NULL;
}

/* What is wrong with a row; NULL where it is one. */
static const char *fault_of(const struct text_table *rows, int row) {
    for (const struct column *c = columns; c->name; c++)
        if (text_cell_is_empty(text_table_cell(rows, row, c->name)))
            return c->name;
    if (strcmp(text_table_cell(rows, row, "by"), whose_words[THESIS]) == 0 &&
        !statement_finding(text_table_cell(rows, row, "statement")))
        return "statement";
    return is_verdict(text_table_cell(rows, row, "verdict")) ? NULL : "verdict";
}

int statements_read(struct text_table *rows, const char *folder, char *reason) {
    char path[PATH_SIZE];
    if (path_format(path, "%s/statements.tsv", folder))
        return fail_with(reason, "%.150s: the path is too long", folder);
    if (text_table_read(rows, path, reason))
        return -1;
    for (int row = 0; row < rows->row_count; row++) {
        const char *fault = fault_of(rows, row);
        if (!fault)
            continue;
        snprintf(reason, REASON_SIZE, "%.150s: row %d, column %s: '%.40s' says nothing", path,
                 row + 1, fault, text_table_cell(rows, row, fault));
        text_table_free(rows);
        return -1;
    }
    return 0;
}

int statements_print(const char *folder, char *reason) {
    struct text_table rows;
    if (statements_read(&rows, folder, reason))
        return -1;
    for (int row = 0; row < rows.row_count; row++)
        printf("  %-13s  %-6s  %s\n", text_table_cell(&rows, row, "verdict"),
               text_table_cell(&rows, row, "by"), text_table_cell(&rows, row, "statement"));
    text_table_free(&rows);
    return 0;
}
