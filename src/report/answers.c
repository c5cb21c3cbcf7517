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

/* Writes them, of all parts, or only counts them, and in `tally` (NULL: they are written) those of
 * the thesis. Returns how many there are. */
static int each_row(const struct page *page, struct chosen chosen, struct tally *tally) {
    int done = 0;
    for (int i = 0; i < page->report->part_count; i++) {
        const struct page_part part = page_part(page, i);
        if (!part.part->included || !(part.part->experiment->answers & 1u << chosen.question))
            continue;
        for (int row = 0; row < part.rows->row_count; row++) {
            if (!is_chosen(part.rows, row, chosen))
                continue;
            if (tally)
                count(tally, part.rows, row);
            else
                write_row(page->stream, part.rows, row, done == 0);
            done++;
        }
    }
    return done;
}

static void write_rows(const struct page *page, enum question question, int sums_up) {
    if (each_row(page, (struct chosen){question, sums_up, 1}, NULL) > 0)
        html_claims_end(page->stream);
    if (each_row(page, (struct chosen){question, sums_up, 0}, NULL) > 0)
        fputs("</ul>\n", page->stream);
}

static int count_rows(const struct page *page, enum question question, int sums_up,
                      struct tally *tally) {
    return each_row(page, (struct chosen){question, sums_up, 0}, tally) +
           each_row(page, (struct chosen){question, sums_up, 1}, tally);
}

static void write_tally(FILE *stream, const struct tally *tally) {
    if (tally->of == 0)
        return;
    fputs("<p>", stream);
    if (tally->of == tally->fails)
        html_print(stream, "Scene by scene none of its %d claims holds.", tally->of);
    else
        html_print(stream, "Scene by scene %d of its %d claims %s, and %d %s not.", tally->holds,
                   tally->of, tally->holds == 1 ? "holds" : "hold", tally->fails,
                   tally->fails == 1 ? "does" : "do");
    fputs("</p>\n", stream);
}

void answers_write(const struct page *page, enum question question) {
    const int few = 8;
    struct tally tally = {0}, other = {0};
    const int single = count_rows(page, question, 0, &tally),
              sums = count_rows(page, question, 1, &other);
    html_element(page->stream, "h3", question_text(question), "\n");
    if (single + sums == 0) {
        fputs("<p>No experiment of this report answers it.</p>\n", page->stream);
        return;
    }
    const int folds = single > 0 && (sums > 0 || single > few);
    write_rows(page, question, 1);
    write_tally(page->stream, &tally);
    if (folds)
        fprintf(page->stream, "<details><summary>Scene by scene: %d sentences</summary>\n", single);
    write_rows(page, question, 0);
    fputs(folds ? "</details>\n" : "", page->stream);
}
