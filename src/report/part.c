#include "part.h"

#include "html.h"

#include <stdlib.h>
#include <string.h>

/* "results/circle/radius.svg" -> "radius" */
static void stem_of(const char *path, char stem[128]) {
    const char *slash = strrchr(path, '/');
    snprintf(stem, 128, "%s", slash ? slash + 1 : path);
    char *dot = strrchr(stem, '.');
    if (dot)
        *dot = '\0';
}

/* Whether a list of words separated by blanks has this one. */
static int has_word(const char *list, const char *word) {
    const size_t length = strlen(word);
    for (const char *at = list; (at = strstr(at, word)) != NULL; at += length)
        if ((at == list || at[-1] == ' ') && (at[length] == ' ' || at[length] == '\0'))
            return 1;
    return 0;
}

/* --- tables --- */

/* What is small enough to be read on the page; the others are in their files. */
enum { ROWS_SHOWN = 12, COLUMNS_SHOWN = 9 };

/* A table of a part, a link with its size: where it is small before the table itself, else among
 * the `large` ones. Returns 0, or -1 or 1 with a reason as part_write. */
static int write_table(const struct page_part *part, const char *name, const char *path,
                       FILE *large) {
    struct text_table table;
    if (text_table_read(&table, path, part->reason))
        return -1;
    const int code = text_table_check(&table, path, part->reason) ? 1 : 0;
    const int shown = table.row_count <= ROWS_SHOWN && table.column_count <= COLUMNS_SHOWN;
    FILE *stream = shown ? part->stream : large;
    fputs(shown ? "<details><summary>" : ftell(large) > 0 ? ", " : "", stream);
    fprintf(stream, "<a href=\"%s/%s.tsv\">%s.tsv</a> (%d row%s)", part->name, name, name,
            table.row_count, table.row_count == 1 ? "" : "s");
    if (shown) {
        fputs("</summary>\n", stream);
        html_element(stream, "p class=\"small\"", table.about, "\n");
        html_table(stream, &table, NULL);
        fputs("</details>\n", stream);
    }
    text_table_free(&table);
    return code;
}

/* Every table of the part but its statements, which the page shows as sentences. */
static int write_tables(const struct page_part *part) {
    glob_t found;
    char *links = NULL;
    size_t length = 0;
    FILE *large = open_memstream(&links, &length);
    int code = large ? 0 : fail_with(part->reason, "out of memory");
    page_files(part, "tsv", &found);
    for (size_t i = 0; i < found.gl_pathc && !code; i++) {
        char stem[128], path[PATH_SIZE];
        stem_of(found.gl_pathv[i], stem);
        if (page_file(part, stem, "tsv", path) && strcmp(stem, "statements") != 0)
            code = write_table(part, stem, path, large);
    }
    globfree(&found);
    if (large)
        fclose(large);
    if (length > 0)
        fprintf(part->stream, "<p class=\"small\">Larger tables: %s.</p>\n", links);
    free(links);
    return code;
}

/* --- statements --- */

static int is_of_figure(const struct text_table *rows, int row, const char *figure) {
    return strcmp(text_table_cell(rows, row, "figure"), figure) == 0;
}

/* The sentences of a figure, a file, as one text, for who cannot see it. Returns 0, or -1 with a
 * reason where there are none. */
static int read_label(const struct page_part *part, const char *path, char label[2048]) {
    char figure[128];
    stem_of(path, figure);
    label[0] = '\0';
    for (int row = 0; row < part->rows->row_count; row++) {
        const size_t used = strlen(label);
        if (is_of_figure(part->rows, row, figure))
            snprintf(label + used, 2048 - used, "%s%s", used ? " " : "",
                     text_table_cell(part->rows, row, "statement"));
    }
    if (label[0])
        return 0;
    return fail_with(part->reason, "%.150s: nothing is stated of it in statements.tsv", path);
}

static int find_figure(const struct page_part *part, const char *figure, char path[PATH_SIZE]) {
    return page_file(part, figure, "svg", path) || page_file(part, figure, "png", path);
}

static int has_figure(const struct page_part *part, const char *figure) {
    char path[PATH_SIZE];
    return find_figure(part, figure, path);
}

/* Whether a row stands under the figure, or where that is NULL, under none that is on the page. */
static int stands_under(const struct page_part *part, int row, const char *figure) {
    return figure ? is_of_figure(part->rows, row, figure)
                  : !has_figure(part, text_table_cell(part->rows, row, "figure"));
}

/* Which statements: those under a figure or, where that is NULL, under none that is on the page;
 * claims of the thesis or what we found; but one row. */
struct chosen {
    const char *figure;
    int claims, but;
};

static int is_chosen(const struct page_part *part, int row, struct chosen chosen) {
    return html_is_claim(part->rows, row) == chosen.claims && row != chosen.but &&
           stands_under(part, row, chosen.figure);
}

static int count_chosen(const struct page_part *part, struct chosen chosen) {
    int count = 0;
    for (int row = 0; row < part->rows->row_count; row++)
        count += is_chosen(part, row, chosen);
    return count;
}

static void write_claims(const struct page_part *part, struct chosen chosen) {
    chosen.claims = 1;
    chosen.but = -1; /* a title has no verdict */
    if (count_chosen(part, chosen) == 0)
        return;
    html_claims_begin(part->stream);
    for (int row = 0; row < part->rows->row_count; row++)
        if (is_chosen(part, row, chosen))
            html_claim(part->stream, part->rows, row, NULL);
    html_claims_end(part->stream);
}

/* The claims of a figure in a table, then what we found: the first rows, and the others in a fold.
 */
static void write_statements(const struct page_part *part, struct chosen chosen) {
    FILE *stream = part->stream;
    const int open_rows = 3;
    int count = 0;
    write_claims(part, chosen);
    const int all = count_chosen(part, chosen), folds = all > open_rows + 1;
    for (int row = 0; row < part->rows->row_count; row++) {
        if (!is_chosen(part, row, chosen))
            continue;
        if (folds && count == open_rows)
            fprintf(stream, "</ul>\n<details><summary>%d more</summary>\n<ul>\n", all - count);
        else if (count == 0)
            fputs("<ul>\n", stream);
        html_statement(stream, part->rows, row);
        count++;
    }
    fputs(all > 0 ? "</ul>\n" : "", stream);
    fputs(folds ? "</details>\n" : "", stream);
}

/* --- what says most --- */

static int ends_with(const char *text, const char *end) {
    const size_t length = strlen(text), tail = strlen(end);
    return length >= tail && strcmp(text + length - tail, end) == 0;
}

/* The row that says most of the whole experiment; -1 where there is none. */
static int headline_of(const struct page_part *part) {
    const char *headline = part->part->experiment->headline;
    for (int row = 0; row < part->rows->row_count && headline; row++)
        if (ends_with(text_table_cell(part->rows, row, "key"), headline))
            return row;
    return part->rows->row_count > 0 ? 0 : -1;
}

/* And of a figure: the same where it is the figure's, else the figure's first that says something.
 */
static int title_of(const struct page_part *part, const char *figure) {
    const struct text_table *rows = part->rows;
    const int headline = headline_of(part);
    int first = -1;
    if (headline >= 0 && is_of_figure(rows, headline, figure))
        return headline;
    for (int row = rows->row_count - 1; row >= 0; row--)
        if (is_of_figure(rows, row, figure) &&
            (first < 0 || strncmp(text_table_cell(rows, row, "verdict"), "not ", 4) != 0))
            first = row;
    return first;
}

/* The row for the figure that stands for the experiment: what says most of it, even if it is no
 * figure's. */
static int lead_title_of(const struct page_part *part, const char *figure) {
    const int headline = headline_of(part);
    return headline >= 0 && is_of_figure(part->rows, headline, "-") ? headline
                                                                    : title_of(part, figure);
}

/* --- figures --- */

/* Adds words that are not there yet to a list separated by blanks. */
static void add_words(char list[512], const char *words) {
    char copy[512], *at = copy;
    snprintf(copy, sizeof copy, "%s", words);
    for (char *word; (word = strsep(&at, " ")) != NULL;) {
        const size_t used = strlen(list);
        if (*word && strcmp(word, "-") != 0 && !has_word(list, word))
            snprintf(list + used, 512 - used, "%s%s", used ? " " : "", word);
    }
}

/* The figure that a table belongs to by its name: the longest that this is, or begins with before a
 * dash. Leaves it in `stem`, cut; returns whether there is one. */
static int belongs(const struct page_part *part, char stem[128]) {
    while (!has_figure(part, stem)) {
        char *dash = strrchr(stem, '-');
        if (!dash)
            return 0;
        *dash = '\0';
    }
    return 1;
}

/* The tables of a figure: those that belong to it by their names, and those that its statements
 * follow from. */
static void find_tables(const struct page_part *part, const char *figure, char tables[512]) {
    glob_t found;
    tables[0] = '\0';
    page_files(part, "tsv", &found);
    for (size_t i = 0; i < found.gl_pathc; i++) {
        char stem[128], owner[128], path[PATH_SIZE];
        stem_of(found.gl_pathv[i], stem);
        memcpy(owner, stem, sizeof owner);
        if (page_file(part, stem, "tsv", path) && belongs(part, owner) &&
            strcmp(owner, figure) == 0)
            add_words(tables, stem);
    }
    globfree(&found);
    for (int row = 0; row < part->rows->row_count; row++)
        if (is_of_figure(part->rows, row, figure))
            add_words(tables, text_table_cell(part->rows, row, "tables"));
}

/* Frames of a film, which is a sheet with one for each row of its table; 0: the figure is none. */
static int film_frames(const struct page_part *part, const char *figure) {
    struct text_table table;
    char path[PATH_SIZE], none[REASON_SIZE];
    if (strcmp(figure, "film") != 0 ||
        path_format(path, "%s/%s/film.tsv", part->report->root, part->name) ||
        text_table_read(&table, path, none))
        return 0;
    const int frames = table.row_count;
    text_table_free(&table);
    return frames;
}

/* A picture under what it shows, the row `title`, with what else is stated of it and what it is
 * drawn from. Returns 0, or -1 with a reason. */
static int write_figure(const struct page_part *part, const char *path, int title) {
    FILE *stream = part->stream;
    char figure[128], prefix[256], label[2048], tables[512], *at = tables;
    stem_of(path, figure);
    if (read_label(part, path, label))
        return -1;
    find_tables(part, figure, tables);
    snprintf(prefix, sizeof prefix, "%s-%s-", part->name, figure);
    fprintf(stream, "<figure id=\"%s-%s\">\n<p class=\"claim\">", part->name, figure);
    html_title(stream, part->rows, title);
    fprintf(stream, " <a class=\"here\" href=\"#%s-%s\">#</a></p>\n", part->name, figure);
    const int is_png = ends_with(path, ".png"), frames = is_png ? film_frames(part, figure) : 0;
    if (frames > 0 ? html_film(stream, path, frames, label, part->reason)
        : is_png   ? html_png(stream, path, label, part->reason)
                   : html_svg(stream, path, prefix, label, part->reason))
        return -1;
    fputs("<figcaption>\n", stream);
    write_statements(part, (struct chosen){figure, 0, title});
    fprintf(stream, "<p class=\"small\">Figure %s/%s, from", part->name, figure);
    for (char *table; at && *at && (table = strsep(&at, " ")) != NULL;)
        fprintf(stream, " <a href=\"%s/%s.tsv\">%s.tsv</a>", part->name, table, table);
    fputs("</p></figcaption></figure>\n", stream);
    return 0;
}

/* Whether a .png is only the same as an .svg that is there. */
static int has_twin(const char *path) {
    char twin[PATH_SIZE];
    return ends_with(path, ".png") &&
           path_format(twin, "%.*s.svg", (int)strlen(path) - 4, path) == 0 && file_exists(twin);
}

/* Whether a figure is only linked: what diagnoses a run is for who doubts it. */
static int is_linked(const char *figure) {
    return strncmp(figure, "diagnostics", strlen("diagnostics")) == 0;
}

static int write_link(const struct page_part *part, const char *path) {
    char figure[128], label[2048];
    stem_of(path, figure);
    if (read_label(part, path, label))
        return -1;
    fprintf(part->stream, "<p class=\"small\"><a href=\"%s/%s%s\">%s</a>: ", part->name, figure,
            strrchr(path, '.'), figure);
    html_text(part->stream, label);
    fputs("</p>\n", part->stream);
    return 0;
}

/* All figures of a kind but the one that is elsewhere on the page. */
static int write_figures(const struct page_part *part, const char *kind, const char *elsewhere,
                         int *figures) {
    glob_t found;
    int code = 0;
    page_files(part, kind, &found);
    for (size_t i = 0; i < found.gl_pathc && !code; i++) {
        char figure[128], path[PATH_SIZE];
        stem_of(found.gl_pathv[i], figure);
        if (!page_file(part, figure, kind, path) || has_twin(path))
            continue;
        ++*figures;
        if (elsewhere && strcmp(figure, elsewhere) == 0)
            fprintf(part->stream,
                    "<p class=\"small\"><a href=\"#%s-%s\">%s</a> is shown above.</p>\n",
                    part->name, figure, figure);
        else if (is_linked(figure))
            code = write_link(part, path);
        else
            code = write_figure(part, path, title_of(part, figure));
    }
    globfree(&found);
    return code;
}

/* --- a part --- */

static void write_summary(const struct page_part *part) {
    char title[256];
    experiment_title(part->part->experiment, title);
    fprintf(part->stream, "<summary><b>%s</b>: ", part->name);
    html_text(part->stream, title);
    const int row = headline_of(part);
    if (row >= 0 && !html_is_claim(part->rows, row)) { /* claims are in their chapter's table */
        fputs("<span class=\"headline\">", part->stream);
        html_sentence(part->stream, part->rows, row);
        fputs("</span>", part->stream);
    }
    fputs("</summary>\n", part->stream);
}

int part_write(const struct page_part *part, const char *elsewhere) {
    int figures = 0;
    fprintf(part->stream, "<details class=\"part\" id=\"%s\">", part->name);
    write_summary(part);
    if (part->part->note[0]) {
        fputs("<p class=\"small\">", part->stream);
        html_print(part->stream, "It is %s.", part->part->note);
        fputs("</p>\n", part->stream);
    }
    write_statements(part, (struct chosen){.but = -1});
    int code = write_figures(part, "png", elsewhere, &figures);
    if (!code)
        code = write_figures(part, "svg", elsewhere, &figures);
    if (!code && !figures)
        return fail_with(part->reason, "%.150s/%.80s: no figure is there", part->report->root,
                         part->name);
    if (!code)
        code = write_tables(part);
    fputs("</details>\n", part->stream);
    return code;
}

int part_write_lead(const struct page_part *part, const char *figure) {
    char path[PATH_SIZE];
    return find_figure(part, figure, path) ? write_figure(part, path, lead_title_of(part, figure))
                                           : 0;
}

void part_write_headline(const struct page_part *part) {
    const int row = headline_of(part);
    if (row < 0)
        return;
    fputs("<li>", part->stream);
    html_sentence(part->stream, part->rows, row);
    fprintf(part->stream, " <a href=\"#%s\">%s</a></li>\n", part->name, part->name);
}

/* The claim that stands for all of an experiment: of the thesis, and none that answers a question
 * of the report, which has them all. -1: there is none. */
static int telling_claim(const struct page_part *part) {
    const int headline = headline_of(part);
    int told = -1;
    for (int row = part->rows->row_count - 1; row >= 0; row--)
        if (html_is_claim(part->rows, row) && told != headline &&
            strcmp(text_table_cell(part->rows, row, "question"), question_word(ANSWERS_NONE)) == 0)
            told = row;
    return told;
}

int part_write_claim(const struct page_part *part, int first) {
    const int row = telling_claim(part);
    if (row < 0)
        return 0;
    if (first)
        html_claims_begin(part->stream);
    html_claim(part->stream, part->rows, row, part->name);
    return 1;
}
