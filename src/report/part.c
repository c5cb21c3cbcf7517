#include "part.h"

#include "base/files.h"
#include "html.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* --- which files belong to a part --- */

static int is_of_report(const struct report_part *part, const char *path) {
    struct stat status;
    return stat(path, &status) == 0 &&
           (double)status.st_mtim.tv_sec + 1e-9 * (double)status.st_mtim.tv_nsec >= part->since;
}

/* The files of a kind in the part's folder, "svg" or "tsv", in the order of their names. globfree
 * it. Returns 0, or -1 where there is no memory. */
static int find_files(const struct report *report, const struct report_part *part, const char *kind,
                      glob_t *found) {
    char folder[PATH_SIZE], pattern[16];
    *found = (glob_t){0};
    if (path_format(folder, "%s/%s", report->root, part->experiment->name))
        return 0;
    snprintf(pattern, sizeof pattern, "*.%s", kind);
    return files_like(folder, pattern, found);
}

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

/* A table of a part: a line with its name, size and file, behind which it is where it is small.
 * Returns 0, or -1 or 1 with a reason as report_write. */
static int write_table(FILE *stream, const struct report *report, const struct report_part *part,
                       const char *name, char *reason) {
    char path[PATH_SIZE];
    struct text_table table;
    if (path_format(path, "%s/%s/%s.tsv", report->root, part->experiment->name, name) ||
        text_table_read(&table, path, reason))
        return -1;
    const int code = text_table_check(&table, path, reason) ? 1 : 0;
    const int shown = table.row_count <= ROWS_SHOWN && table.column_count <= COLUMNS_SHOWN;
    fprintf(stream, shown ? "<details><summary>" : "<p class=\"small\">");
    fprintf(stream, "<a href=\"%s/%s.tsv\">%s.tsv</a> (%d row%s)", part->experiment->name, name,
            name, table.row_count, table.row_count == 1 ? "" : "s");
    if (shown) {
        fputs("</summary>\n<p class=\"small\">", stream);
        html_text(stream, table.about);
        fputs("</p>\n", stream);
        html_table(stream, &table, NULL);
    }
    fputs(shown ? "</details>\n" : "</p>\n", stream);
    text_table_free(&table);
    return code;
}

/* Every table of the part but its statements, which the page shows as sentences. */
static int write_tables(FILE *stream, const struct report *report, const struct report_part *part,
                        char *reason) {
    glob_t found;
    char stem[128];
    int code = find_files(report, part, "tsv", &found);
    for (size_t i = 0; i < found.gl_pathc && !code; i++) {
        stem_of(found.gl_pathv[i], stem);
        if (is_of_report(part, found.gl_pathv[i]) && strcmp(stem, "statements") != 0)
            code = write_table(stream, report, part, stem, reason);
    }
    globfree(&found);
    return code;
}

/* --- statements --- */

static int is_of_figure(const struct text_table *rows, int row, const char *figure) {
    return strcmp(text_table_cell(rows, row, "figure"), figure) == 0;
}

/* The sentences of a figure, a file, as one text, for who cannot see it. Returns 0, or -1 with a
 * reason where there are none. */
static int read_label(const struct text_table *rows, const char *path, char label[2048],
                      char *reason) {
    char figure[128];
    stem_of(path, figure);
    label[0] = '\0';
    for (int row = 0; row < rows->row_count; row++) {
        const size_t used = strlen(label);
        if (is_of_figure(rows, row, figure))
            snprintf(label + used, 2048 - used, "%s%s", used ? " " : "",
                     text_table_cell(rows, row, "statement"));
    }
    if (label[0])
        return 0;
    return fail_with(reason, "%.150s: nothing is stated of it in statements.tsv", path);
}

static int has_figure(const struct report *report, const struct report_part *part,
                      const char *figure) {
    static const char *const kinds[] = {"svg", "png"};
    char path[PATH_SIZE];
    for (int k = 0; k < 2; k++)
        if (path_format(path, "%s/%s/%s.%s", report->root, part->experiment->name, figure,
                        kinds[k]) == 0 &&
            is_of_report(part, path))
            return 1;
    return 0;
}

/* Whether a row stands under the figure, or where that is NULL, under none that is on the page. */
static int stands_under(const struct report *report, const struct report_part *part,
                        const struct text_table *rows, int row, const char *figure) {
    return figure ? is_of_figure(rows, row, figure)
                  : !has_figure(report, part, text_table_cell(rows, row, "figure"));
}

/* Which statements: those under a figure or, where that is NULL, under none that is on the page;
 * claims of the thesis or what we found; but one row. */
struct chosen {
    const char *figure;
    int claims, but;
};

static int is_chosen(const struct report *report, const struct report_part *part,
                     const struct text_table *rows, int row, struct chosen chosen) {
    return html_is_claim(rows, row) == chosen.claims && row != chosen.but &&
           stands_under(report, part, rows, row, chosen.figure);
}

static int count_chosen(const struct report *report, const struct report_part *part,
                        const struct text_table *rows, struct chosen chosen) {
    int count = 0;
    for (int row = 0; row < rows->row_count; row++)
        count += is_chosen(report, part, rows, row, chosen);
    return count;
}

static void write_claims(FILE *stream, const struct report *report, const struct report_part *part,
                         const struct text_table *rows, struct chosen chosen) {
    chosen.claims = 1;
    chosen.but = -1; /* a title has no verdict */
    if (count_chosen(report, part, rows, chosen) == 0)
        return;
    html_claims_begin(stream);
    for (int row = 0; row < rows->row_count; row++)
        if (is_chosen(report, part, rows, row, chosen))
            html_claim(stream, rows, row, NULL);
    html_claims_end(stream);
}

/* The claims of a figure in a table, then what we found: the first rows, and the others in a fold.
 */
static void write_statements(FILE *stream, const struct report *report,
                             const struct report_part *part, const struct text_table *rows,
                             struct chosen chosen) {
    const int open_rows = 3;
    int count = 0;
    write_claims(stream, report, part, rows, chosen);
    const int all = count_chosen(report, part, rows, chosen), folds = all > open_rows + 1;
    for (int row = 0; row < rows->row_count; row++) {
        if (!is_chosen(report, part, rows, row, chosen))
            continue;
        if (folds && count == open_rows)
            fprintf(stream, "</ul>\n<details><summary>%d more</summary>\n<ul>\n", all - count);
        else if (count == 0)
            fputs("<ul>\n", stream);
        html_statement(stream, rows, row);
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
static int headline_of(const struct experiment *experiment, const struct text_table *rows) {
    for (int row = 0; row < rows->row_count && experiment->headline; row++)
        if (ends_with(text_table_cell(rows, row, "key"), experiment->headline))
            return row;
    return rows->row_count > 0 ? 0 : -1;
}

/* And of a figure: the same where it is the figure's, else the figure's first that says something.
 */
static int title_of(const struct report_part *part, const struct text_table *rows,
                    const char *figure) {
    const int headline = headline_of(part->experiment, rows);
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
static int lead_title_of(const struct report_part *part, const struct text_table *rows,
                         const char *figure) {
    const int headline = headline_of(part->experiment, rows);
    return headline >= 0 && is_of_figure(rows, headline, "-") ? headline
                                                              : title_of(part, rows, figure);
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
static int belongs(const struct report *report, const struct report_part *part, char stem[128]) {
    while (!has_figure(report, part, stem)) {
        char *dash = strrchr(stem, '-');
        if (!dash)
            return 0;
        *dash = '\0';
    }
    return 1;
}

/* The tables of a figure: those that belong to it by their names, and those that its statements
 * follow from. Returns 0, or -1 where there is no memory. */
static int find_tables(const struct report *report, const struct report_part *part,
                       const struct text_table *rows, const char *figure, char tables[512]) {
    glob_t found;
    tables[0] = '\0';
    const int code = find_files(report, part, "tsv", &found);
    for (size_t i = 0; i < found.gl_pathc && !code; i++) {
        char stem[128], owner[128];
        stem_of(found.gl_pathv[i], stem);
        memcpy(owner, stem, sizeof owner);
        if (is_of_report(part, found.gl_pathv[i]) && belongs(report, part, owner) &&
            strcmp(owner, figure) == 0)
            add_words(tables, stem);
    }
    globfree(&found);
    for (int row = 0; row < rows->row_count; row++)
        if (is_of_figure(rows, row, figure))
            add_words(tables, text_table_cell(rows, row, "tables"));
    return code;
}

/* Frames of a film, which is a sheet with one for each row of its table; 0: the figure is none. */
static int film_frames(const struct report *report, const struct report_part *part,
                       const char *figure) {
    struct text_table table;
    char path[PATH_SIZE], none[REASON_SIZE];
    if (strcmp(figure, "film") != 0 ||
        path_format(path, "%s/%s/film.tsv", report->root, part->experiment->name) ||
        text_table_read(&table, path, none))
        return 0;
    const int frames = table.row_count;
    text_table_free(&table);
    return frames;
}

/* A picture under what it shows, the row `title`, with what else is stated of it and what it is
 * drawn from. Returns 0, or -1 with a reason. */
static int write_figure(FILE *stream, const struct report *report, const struct report_part *part,
                        const char *path, const struct text_table *rows, int title, char *reason) {
    char figure[128], prefix[256], label[2048], tables[512], *at = tables;
    const char *name = part->experiment->name;
    stem_of(path, figure);
    if (read_label(rows, path, label, reason))
        return -1;
    if (find_tables(report, part, rows, figure, tables))
        return fail_with(reason, "out of memory");
    snprintf(prefix, sizeof prefix, "%s-%s-", name, figure);
    fprintf(stream, "<figure id=\"%s-%s\">\n<p class=\"claim\">", name, figure);
    html_title(stream, rows, title);
    fprintf(stream, " <a class=\"here\" href=\"#%s-%s\">#</a></p>\n", name, figure);
    const int is_png = strcmp(path + strlen(path) - 4, ".png") == 0,
              frames = is_png ? film_frames(report, part, figure) : 0;
    if (frames > 0 ? html_film(stream, path, frames, label, reason)
        : is_png   ? html_png(stream, path, label, reason)
                   : html_svg(stream, path, prefix, label, reason))
        return -1;
    fputs("<figcaption>\n", stream);
    write_statements(stream, report, part, rows, (struct chosen){figure, 0, title});
    fprintf(stream, "<p class=\"small\">Figure %s/%s, from", name, figure);
    for (char *table; at && *at && (table = strsep(&at, " ")) != NULL;)
        fprintf(stream, " <a href=\"%s/%s.tsv\">%s.tsv</a>", name, table, table);
    fputs("</p></figcaption></figure>\n", stream);
    return 0;
}

/* Whether a .png is only the same as an .svg that is there. */
static int has_twin(const char *path) {
    char twin[PATH_SIZE];
    const int stem = (int)strlen(path) - 4;
    return strcmp(path + stem, ".png") == 0 && path_format(twin, "%.*s.svg", stem, path) == 0 &&
           file_exists(twin);
}

/* Whether a figure is only linked: what diagnoses a run is for who doubts it. */
static int is_linked(const char *figure) {
    return strncmp(figure, "diagnostics", strlen("diagnostics")) == 0;
}

static int write_link(FILE *stream, const struct report_part *part, const char *path,
                      const struct text_table *rows, char *reason) {
    char figure[128], label[2048];
    stem_of(path, figure);
    if (read_label(rows, path, label, reason))
        return -1;
    fprintf(stream, "<p class=\"small\"><a href=\"%s/%s%s\">%s</a>: ", part->experiment->name,
            figure, strrchr(path, '.'), figure);
    html_text(stream, label);
    fputs("</p>\n", stream);
    return 0;
}

/* All figures of a kind but the one that is elsewhere on the page. */
static int write_figures(FILE *stream, const struct report *report, const struct report_part *part,
                         const char *kind, const struct text_table *rows, const char *elsewhere,
                         int *figures, char *reason) {
    glob_t found;
    int code = find_files(report, part, kind, &found);
    for (size_t i = 0; i < found.gl_pathc && !code; i++) {
        const char *path = found.gl_pathv[i];
        char figure[128];
        if (!is_of_report(part, path) || has_twin(path))
            continue;
        ++*figures;
        stem_of(path, figure);
        if (elsewhere && strcmp(figure, elsewhere) == 0)
            fprintf(stream, "<p class=\"small\"><a href=\"#%s-%s\">%s</a> is shown above.</p>\n",
                    part->experiment->name, figure, figure);
        else if (is_linked(figure))
            code = write_link(stream, part, path, rows, reason);
        else
            code = write_figure(stream, report, part, path, rows, title_of(part, rows, figure),
                                reason);
    }
    globfree(&found);
    return code;
}

/* --- a part --- */

static int read_statements(const struct report *report, const struct report_part *part,
                           struct text_table *rows, char *reason) {
    char folder[PATH_SIZE];
    return path_format(folder, "%s/%s", report->root, part->experiment->name) ||
                   statements_read(rows, folder, reason)
               ? -1
               : 0;
}

static void write_summary(FILE *stream, const struct report_part *part,
                          const struct text_table *rows) {
    char title[256];
    experiment_title(part->experiment, title);
    fprintf(stream, "<summary><b>%s</b>: ", part->experiment->name);
    html_text(stream, title);
    const int row = headline_of(part->experiment, rows);
    if (row >= 0 && !html_is_claim(rows, row)) { /* claims are in their chapter's table */
        fputs("<span class=\"headline\">", stream);
        html_sentence(stream, rows, row);
        fputs("</span>", stream);
    }
    fputs("</summary>\n", stream);
}

int part_write(FILE *stream, const struct report *report, const struct report_part *part,
               const char *elsewhere, char *reason) {
    struct text_table rows;
    int figures = 0;
    if (read_statements(report, part, &rows, reason))
        return -1;
    fprintf(stream, "<details class=\"part\" id=\"%s\">", part->experiment->name);
    write_summary(stream, part, &rows);
    if (part->note[0]) {
        fputs("<p class=\"small\">", stream);
        html_print(stream, "It is %s.", part->note);
        fputs("</p>\n", stream);
    }
    write_statements(stream, report, part, &rows, (struct chosen){.but = -1});
    int code = write_figures(stream, report, part, "png", &rows, elsewhere, &figures, reason);
    if (!code)
        code = write_figures(stream, report, part, "svg", &rows, elsewhere, &figures, reason);
    text_table_free(&rows);
    if (!code && !figures)
        return fail_with(reason, "%.150s/%.80s: no figure is there", report->root,
                         part->experiment->name);
    if (!code)
        code = write_tables(stream, report, part, reason);
    fputs("</details>\n", stream);
    return code;
}

int part_write_lead(FILE *stream, const struct report *report, const struct report_part *part,
                    const char *figure, char *reason) {
    static const char *const kinds[] = {"svg", "png"};
    struct text_table rows;
    char path[PATH_SIZE];
    int code = read_statements(report, part, &rows, reason), there = 0;
    if (code)
        return -1;
    for (int k = 0; k < 2 && !there; k++)
        there = path_format(path, "%s/%s/%s.%s", report->root, part->experiment->name, figure,
                            kinds[k]) == 0 &&
                is_of_report(part, path);
    if (there)
        code = write_figure(stream, report, part, path, &rows, lead_title_of(part, &rows, figure),
                            reason);
    text_table_free(&rows);
    return code ? -1 : there;
}

int part_write_headline(FILE *stream, const struct report *report, const struct report_part *part,
                        char *reason) {
    struct text_table rows;
    if (read_statements(report, part, &rows, reason))
        return -1;
    if (rows.row_count == 0) {
        text_table_free(&rows);
        return 0;
    }
    fputs("<li>", stream);
    html_sentence(stream, &rows, headline_of(part->experiment, &rows));
    fprintf(stream, " <a href=\"#%s\">%s</a></li>\n", part->experiment->name,
            part->experiment->name);
    text_table_free(&rows);
    return 0;
}

/* The claim that stands for all of an experiment: of the thesis, and none that answers a question
 * of the report, which has them all. -1: there is none. */
static int telling_claim(const struct experiment *experiment, const struct text_table *rows) {
    const int headline = headline_of(experiment, rows);
    int told = -1;
    for (int row = rows->row_count - 1; row >= 0; row--)
        if (html_is_claim(rows, row) && told != headline &&
            strcmp(text_table_cell(rows, row, "question"), question_word(ANSWERS_NONE)) == 0)
            told = row;
    return told;
}

int part_write_claim(FILE *stream, const struct report *report, const struct report_part *part,
                     int first, char *reason) {
    struct text_table rows;
    if (read_statements(report, part, &rows, reason))
        return -1;
    const int row = telling_claim(part->experiment, &rows);
    if (row >= 0 && first)
        html_claims_begin(stream);
    if (row >= 0)
        html_claim(stream, &rows, row, part->experiment->name);
    text_table_free(&rows);
    return row >= 0;
}
