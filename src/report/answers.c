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

static int answers(const struct report_part *part, enum question question) {
    return part->included && (part->experiment->answers & 1u << question) != 0;
}

/* Rows of a part that answer a question: those that sum up, which are of no figure, or the others;
 * claims of the thesis or what we found. */
struct chosen {
    enum question question;
    int sums_up, claims;
};

static int is_chosen(const struct text_table *rows, int row, struct chosen chosen) {
    return strcmp(text_table_cell(rows, row, "question"), question_word(chosen.question)) == 0 &&
           (strcmp(text_table_cell(rows, row, "figure"), "-") == 0) == chosen.sums_up &&
           html_is_claim(rows, row) == chosen.claims;
}

static void write_row(FILE *stream, const struct text_table *rows, int row, int is_first) {
    const int is_claim = html_is_claim(rows, row);
    if (is_first && is_claim)
        html_claims_begin(stream);
    else if (is_first)
        fputs("<ul>\n", stream);
    if (is_claim)
        html_claim(stream, rows, row, NULL);
    else
        html_statement(stream, rows, row);
}

/* Writes them, of all parts, and counts those of the thesis; where `stream` is NULL only counts.
 * Returns how many there are, or -1 with a reason. */
static int write_rows(FILE *stream, const struct report *report, struct chosen chosen,
                      struct tally *tally, char *reason) {
    int written = 0;
    for (int i = 0; i < report->part_count; i++) {
        const struct report_part *part = &report->parts[i];
        char folder[PATH_SIZE];
        struct text_table rows;
        if (!answers(part, chosen.question))
            continue;
        if (path_format(folder, "%s/%s", report->root, part->experiment->name) ||
            statements_read(&rows, folder, reason))
            return -1;
        for (int row = 0; row < rows.row_count; row++) {
            if (!is_chosen(&rows, row, chosen))
                continue;
            if (stream)
                write_row(stream, &rows, row, written == 0);
            else
                count(tally, &rows, row);
            written++;
        }
        text_table_free(&rows);
    }
    if (stream && written > 0 && chosen.claims)
        html_claims_end(stream);
    else if (stream && written > 0)
        fputs("</ul>\n", stream);
    return written;
}

static void write_tally(FILE *stream, const struct tally *tally) {
    if (tally->of == 0)
        return;
    fputs("<p>", stream);
    if (tally->of == tally->fails)
        html_print(stream, "None of the thesis's %d claims on single scenes holds.", tally->of);
    else
        html_print(stream, "Of the thesis's %d claims on single scenes %d %s, and %d %s not.",
                   tally->of, tally->holds, tally->holds == 1 ? "holds" : "hold", tally->fails,
                   tally->fails == 1 ? "does" : "do");
    fputs("</p>\n", stream);
}

/* How many rows sum a question up, and how many are of single scenes; the claims among these in
 * `tally`. Returns 0, or -1 with a reason. */
static int count_rows(const struct report *report, enum question question, int counts[2],
                      struct tally *tally, char *reason) {
    for (int sums_up = 0; sums_up < 2; sums_up++) {
        struct tally other = {0};
        counts[sums_up] = 0;
        for (int claims = 0; claims < 2; claims++) {
            const int rows = write_rows(NULL, report, (struct chosen){question, sums_up, claims},
                                        sums_up ? &other : tally, reason);
            if (rows < 0)
                return -1;
            counts[sums_up] += rows;
        }
    }
    return 0;
}

/* A question that many sentences answer is answered by those that sum up; the others are in a fold.
 */
static int write_answer(FILE *stream, const struct report *report, enum question question,
                        char *reason) {
    const int few = 8;
    struct tally tally = {0};
    int counts[2];
    fputs("<h3>", stream);
    html_text(stream, question_text(question));
    fputs("</h3>\n", stream);
    if (count_rows(report, question, counts, &tally, reason))
        return -1;
    if (counts[0] + counts[1] == 0) {
        fputs("<p>No experiment of this report answers it.</p>\n", stream);
        return 0;
    }
    const int folds = counts[0] > 0 && (counts[1] > 0 || counts[0] > few);
    for (int claims = 1; claims >= 0; claims--)
        write_rows(stream, report, (struct chosen){question, 1, claims}, &tally, reason);
    write_tally(stream, &tally);
    if (folds)
        fprintf(stream, "<details><summary>Scene by scene: %d sentences</summary>\n", counts[0]);
    for (int claims = 1; claims >= 0; claims--)
        write_rows(stream, report, (struct chosen){question, 0, claims}, &tally, reason);
    fputs(folds ? "</details>\n" : "", stream);
    return 0;
}

int answers_write(FILE *stream, const struct report *report, unsigned questions, char *reason) {
    int code = 0;
    for (int question = ANSWERS_NONE + 1; question < QUESTION_COUNT && !code; question++)
        if (questions & 1u << question)
            code = write_answer(stream, report, (enum question)question, reason);
    return code;
}
