#include "answers.h"

#include "html.h"

#include <string.h>

/* How many rows of the thesis's claims had each verdict. */
struct tally {
    int holds, fails, of;
};

static void count(struct tally *tally, const struct text_table *rows, int row) {
    const char *verdict = text_table_cell(rows, row, "verdict");
    if (strcmp(text_table_cell(rows, row, "by"), "thesis") != 0)
        return;
    tally->holds += strcmp(verdict, "holds") == 0;
    tally->fails += strcmp(verdict, "does not hold") == 0;
    tally->of++;
}

/* The rows of a part that answer a question, and sum up or are of a figure. Returns 0, or -1 with a
 * reason. */
static int write_rows(FILE *stream, const struct report *report, const struct report_part *part,
                      enum question question, int sums_up, struct tally *tally, char *reason) {
    char folder[PATH_SIZE];
    struct text_table rows;
    if (path_format(folder, "%s/%s", report->root, part->experiment->name) ||
        statements_read(&rows, folder, reason))
        return -1;
    for (int row = 0; row < rows.row_count; row++) {
        const int of_none = strcmp(text_table_cell(&rows, row, "figure"), "-") == 0;
        if (strcmp(text_table_cell(&rows, row, "question"), question_word(question)) != 0 ||
            of_none != sums_up)
            continue;
        html_statement(stream, &rows, row);
        count(tally, &rows, row);
    }
    text_table_free(&rows);
    return 0;
}

static int answers(const struct report_part *part, enum question question) {
    return (part->experiment->answers & 1u << question) != 0;
}

static void write_missing(FILE *stream, const struct report *report, enum question question) {
    for (int i = 0; i < report->part_count; i++) {
        const struct report_part *part = &report->parts[i];
        if (part->included || !answers(part, question))
            continue;
        fputs("<p class=\"small\">", stream);
        html_print(stream, "Not in this report: experiment %s%s%s.", part->experiment->name,
                   part->note[0] ? ", " : "", part->note);
        fputs("</p>\n", stream);
    }
}

static int write_answer(FILE *stream, const struct report *report, enum question question,
                        char *reason) {
    struct tally tally = {0};
    int code = 0, there = 0;
    fputs("<h3>", stream);
    html_text(stream, question_text(question));
    fputs("</h3>\n<ul>\n", stream);
    for (int sums_up = 1; sums_up >= 0; sums_up--)
        for (int i = 0; i < report->part_count && !code; i++) {
            const struct report_part *part = &report->parts[i];
            if (!part->included || !answers(part, question))
                continue;
            there = 1;
            code = write_rows(stream, report, part, question, sums_up, &tally, reason);
        }
    fputs(there ? "</ul>\n" : "<li>No experiment of this report answers it.</li>\n</ul>\n", stream);
    if (tally.of > 0) {
        fputs("<p>", stream);
        html_print(stream, "Of the thesis's %d claims in this answer %d hold and %d do not.",
                   tally.of, tally.holds, tally.fails);
        fputs("</p>\n", stream);
    }
    write_missing(stream, report, question);
    return code;
}

int answers_write(FILE *stream, const struct report *report, char *reason) {
    int code = 0;
    fputs("<section id=\"answers\"><h2>Answers</h2>\n", stream);
    for (int question = ANSWERS_NONE + 1; question < QUESTION_COUNT && !code; question++)
        code = write_answer(stream, report, (enum question)question, reason);
    fputs("</section>\n", stream);
    return code;
}
