#include "statements.h"

#include "measure.h"

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

static const char *const columns[] = {"key",   "figure", "question", "statement", "verdict",
                                      "value", "unit",   "by",       "tables"};
enum { COLUMNS = sizeof columns / sizeof *columns };

static const char nothing[] = "-";

const char *question_word(enum question question) {
    return questions[question].word;
}

const char *question_text(enum question question) {
    return questions[question].text;
}

/* --- writing --- */

int statements_open(struct statements *statements, const char *folder, const struct scene *scene,
                    const char *cut, char *reason) {
    char what[1024], names[256] = "";
    int used = snprintf(what, sizeof what, "what was found, a sentence a row; verdict:");
#define X(symbol, word, meaning) \
    used += snprintf(what + used, sizeof what - (size_t)used, " %s: " meaning ";", word);
    VERDICTS(X)
#undef X
    snprintf(what + used, sizeof what - (size_t)used,
             " value: what the verdict rests on; by: whose claim it is; tables: that it follows "
             "from; -: none%s%s",
             cut ? "; " : "", cut ? cut : "");
    for (int i = 0; i < COLUMNS; i++)
        snprintf(names + strlen(names), sizeof names - strlen(names), "%s%s", i ? "\t" : "",
                 columns[i]);
    return open_table(&statements->file, folder, "statements", what, scene, names, reason);
}

/* A text as a cell: one line, no tabs, and something in it. */
static void write_cell(FILE *stream, const char *text, char end) {
    if (!text || !*text)
        text = nothing;
    for (; *text; text++)
        fputc((unsigned char)*text < ' ' ? ' ' : *text, stream);
    fputc(end, stream);
}

void statements_add(struct statements *statements, struct statement row, const char *sentence,
                    ...) {
    FILE *stream = statements->file.stream;
    char text[1024], value[32] = "";
    const int has_value = row.unit && isfinite(row.value);
    va_list arguments;
    va_start(arguments, sentence);
    vsnprintf(text, sizeof text, sentence, arguments);
    va_end(arguments);
    if (has_value)
        snprintf(value, sizeof value, "%.17g", row.value);
    write_cell(stream, row.key, '\t');
    write_cell(stream, row.figure, '\t');
    write_cell(stream, questions[row.answers].word, '\t');
    write_cell(stream, text, '\t');
    write_cell(stream, verdict_words[row.verdict], '\t');
    write_cell(stream, value, '\t');
    write_cell(stream, has_value ? row.unit : NULL, '\t');
    write_cell(stream, whose_words[row.by], '\t');
    write_cell(stream, row.tables, '\n');
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

/* What is wrong with a row; NULL where it is one. */
static const char *fault_of(const struct text_table *rows, int row) {
    for (int i = 0; i < COLUMNS; i++)
        if (text_cell_is_empty(text_table_cell(rows, row, columns[i])))
            return columns[i];
    return is_verdict(text_table_cell(rows, row, "verdict")) ? NULL : "verdict";
}

int statements_read(struct text_table *rows, const char *folder, char *reason) {
    char path[PATH_SIZE];
    if (path_format(path, "%s/statements.tsv", folder)) {
        snprintf(reason, REASON_SIZE, "%.150s: the path is too long", folder);
        return -1;
    }
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
