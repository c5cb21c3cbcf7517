#include "report.h"

#include "answers.h"
#include "base/files.h"
#include "build_info.h"
#include "html.h"
#include "model/problems.h"
#include "run/identity.h"
#include "run/program.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Dark on white; tables and figures that are wider than a phone scroll in their own box; on paper
 * everything is there, and small enough for the page. */
static const char style[] =
    "body{color:#111;background:#fff;font:16px/1.5 sans-serif;max-width:60rem;margin:0 auto;"
    "padding:0 1rem 3rem}\n"
    "h1{font-size:1.7rem;line-height:1.2}h2{font-size:1.3rem;margin-top:2.5rem;border-top:1px "
    "solid "
    "#bbb;padding-top:1rem}h3{font-size:1.05rem;margin:1.6rem 0 .3rem}\n"
    "a{color:#00528a}figure{margin:1.2rem 0}figcaption{margin:.4rem 0}\n"
    ".wide{overflow-x:auto;max-width:100%}.wide img{display:block;max-width:100%;height:auto}.wide "
    "svg{display:block;height:auto;width:100%;"
    "min-width:40rem}\n"
    "table{border-collapse:collapse;font-size:.8rem;margin:.5rem 0}"
    "th,td{border-bottom:1px solid #ddd;padding:.15rem .5rem;text-align:left;vertical-align:top}"
    "th{background:#f3f3f3}.number{text-align:right;white-space:nowrap}.none{text-align:center}\n"
    ".small,.about{font-size:.85rem;color:#333;overflow-wrap:anywhere}\n"
    "@media screen{td:last-child:not(.number):not(.none){min-width:14rem}}\n"
    "summary{cursor:pointer;padding:.3rem 0}ul{margin:.3rem 0;padding-left:1.2rem}"
    "li{margin:.15rem 0}.verdict{font-size:.8rem;border:1px solid "
    "#767676;border-radius:.3rem;padding:0 .3rem;"
    "white-space:nowrap}.fails{background:#fbe3d6}\n"
    "@media print{body{max-width:none;font-size:10pt;padding:0}.there>h2{break-before:page}"
    "h2,h3,summary{break-after:avoid}figure>.wide,tr{break-inside:avoid}thead{display:table-header-"
    "group}"
    ".wide{overflow:visible}.wide svg{min-width:0;max-height:22cm}details::details-content"
    "{content-visibility:visible;display:block;height:auto}"
    "table{font-size:5.5pt;width:100%}th,td{padding:1pt 2pt;overflow-wrap:anywhere}"
    ".number{white-space:normal}nav{display:none}}\n";

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

/* Whether a list of words parted by blanks has this one. */
static int has_word(const char *list, const char *word) {
    const size_t length = strlen(word);
    for (const char *at = list; (at = strstr(at, word)) != NULL; at += length)
        if ((at == list || at[-1] == ' ') && (at[length] == ' ' || at[length] == '\0'))
            return 1;
    return 0;
}

/* --- tables --- */

/* A table of a part under its name, with what its own first line says. */
static int write_table(FILE *stream, const struct report *report, const struct report_part *part,
                       const char *name, char *reason) {
    char path[PATH_SIZE];
    struct text_table table;
    if (path_format(path, "%s/%s/%s.tsv", report->root, part->experiment->name, name) ||
        text_table_read(&table, path, reason))
        return -1;
    const int code = text_table_check(&table, path, reason) ? 1 : 0;
    fprintf(stream, "<details><summary>%s.tsv: %d row%s</summary>\n<p class=\"about\">", name,
            table.row_count, table.row_count == 1 ? "" : "s");
    html_text(stream, table.about);
    fprintf(stream, " (<a href=\"%s/%s.tsv\">data</a>)</p>\n", part->experiment->name, name);
    html_table(stream, &table, NULL);
    fputs("</details>\n", stream);
    text_table_free(&table);
    return code;
}

/* Every table of the part that no figure has shown. */
static int write_other_tables(FILE *stream, const struct report *report,
                              const struct report_part *part, const char *shown, char *reason) {
    glob_t found;
    char stem[128];
    int code = find_files(report, part, "tsv", &found);
    for (size_t i = 0; i < found.gl_pathc && !code; i++) {
        stem_of(found.gl_pathv[i], stem);
        if (is_of_report(part, found.gl_pathv[i]) && !has_word(shown, stem))
            code = write_table(stream, report, part, stem, reason);
    }
    globfree(&found);
    return code;
}

/* --- statements --- */

static int is_of_figure(const struct text_table *rows, int row, const char *figure) {
    return strcmp(text_table_cell(rows, row, "figure"), figure) == 0;
}

/* The sentences of a figure as one text, for who cannot see it. */
static void join_sentences(const struct text_table *rows, const char *figure, char label[2048]) {
    label[0] = '\0';
    for (int row = 0; row < rows->row_count; row++) {
        const size_t used = strlen(label);
        if (is_of_figure(rows, row, figure))
            snprintf(label + used, 2048 - used, "%s%s", used ? " " : "",
                     text_table_cell(rows, row, "statement"));
    }
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

/* The rows of a figure, or where it is NULL those whose figure is not on the page. Returns how
 * many there are. */
static int write_statements(FILE *stream, const struct report *report,
                            const struct report_part *part, const struct text_table *rows,
                            const char *figure) {
    int count = 0;
    for (int row = 0; row < rows->row_count; row++) {
        if (figure ? !is_of_figure(rows, row, figure)
                   : has_figure(report, part, text_table_cell(rows, row, "figure")))
            continue;
        if (count++ == 0)
            fputs("<ul>\n", stream);
        html_statement(stream, rows, row);
    }
    fputs(count ? "</ul>\n" : "", stream);
    return count;
}

/* --- figures --- */

/* Adds words that are not there yet to a list parted by blanks. */
static void add_words(char list[512], const char *words) {
    char copy[512], *at = copy;
    snprintf(copy, sizeof copy, "%s", words);
    for (char *word; (word = strsep(&at, " ")) != NULL;) {
        const size_t used = strlen(list);
        if (*word && strcmp(word, "-") != 0 && !has_word(list, word))
            snprintf(list + used, 512 - used, "%s%s", used ? " " : "", word);
    }
}

/* The tables of a figure: those whose name is its own, or begins with it and a dash, and those that
 * its statements follow from. Returns 0, or -1 where there is no memory. */
static int find_tables(const struct report *report, const struct report_part *part,
                       const struct text_table *rows, const char *figure, char tables[512]) {
    const size_t length = strlen(figure);
    glob_t found;
    char stem[128];
    tables[0] = '\0';
    const int code = find_files(report, part, "tsv", &found);
    for (size_t i = 0; i < found.gl_pathc && !code; i++) {
        stem_of(found.gl_pathv[i], stem);
        if (is_of_report(part, found.gl_pathv[i]) && strncmp(stem, figure, length) == 0 &&
            (stem[length] == '\0' || stem[length] == '-'))
            add_words(tables, stem);
    }
    globfree(&found);
    for (int row = 0; row < rows->row_count; row++)
        if (is_of_figure(rows, row, figure))
            add_words(tables, text_table_cell(rows, row, "tables"));
    return code;
}

/* A picture with what is stated of it. Leaves in `tables` what it is drawn from. Returns 0, or -1
 * with a reason. */
static int write_figure(FILE *stream, const struct report *report, const struct report_part *part,
                        const char *path, const struct text_table *rows, char tables[512],
                        char *reason) {
    char figure[128], prefix[256], label[2048];
    const char *name = part->experiment->name;
    stem_of(path, figure);
    join_sentences(rows, figure, label);
    if (find_tables(report, part, rows, figure, tables)) {
        snprintf(reason, REASON_SIZE, "out of memory");
        return -1;
    }
    if (!label[0]) {
        snprintf(reason, REASON_SIZE, "%.150s: nothing is stated of it in statements.tsv", path);
        return -1;
    }
    snprintf(prefix, sizeof prefix, "%s-%s-", name, figure);
    fprintf(stream, "<figure id=\"%s-%s\">\n", name, figure);
    const int is_png = strcmp(path + strlen(path) - 4, ".png") == 0;
    if (is_png ? html_png(stream, path, label, reason)
               : html_svg(stream, path, prefix, label, reason))
        return -1;
    fprintf(stream, "<figcaption><b>%s/%s.</b>\n", name, figure);
    write_statements(stream, report, part, rows, figure);
    fputs("Data:", stream);
    char list[512], *at = list;
    snprintf(list, sizeof list, "%s", tables);
    for (char *table; *list && (table = strsep(&at, " ")) != NULL;)
        fprintf(stream, " <a href=\"%s/%s.tsv\">%s.tsv</a>", name, table, table);
    fputs("</figcaption>\n", stream);
    return 0;
}

/* Whether a .png is only the same as an .svg that is there. */
static int has_twin(const char *path) {
    char twin[PATH_SIZE];
    const int stem = (int)strlen(path) - 4;
    return strcmp(path + stem, ".png") == 0 && path_format(twin, "%.*s.svg", stem, path) == 0 &&
           file_exists(twin);
}

/* Figures, each with those of its tables that were not shown before, and then the tables that are
 * left. */
static int write_figures(FILE *stream, const struct report *report, const struct report_part *part,
                         const char *kind, const struct text_table *rows, char shown[8192],
                         int *figures, char *reason) {
    glob_t found;
    int code = find_files(report, part, kind, &found);
    for (size_t i = 0; i < found.gl_pathc && !code; i++) {
        char tables[512], *at = tables;
        if (!is_of_report(part, found.gl_pathv[i]) || has_twin(found.gl_pathv[i]))
            continue;
        ++*figures;
        code = write_figure(stream, report, part, found.gl_pathv[i], rows, tables, reason);
        for (char *name; !code && *tables && (name = strsep(&at, " ")) != NULL;) {
            const size_t used = strlen(shown);
            if (has_word(shown, name))
                continue;
            snprintf(shown + used, 8192 - used, "%s%s", used ? " " : "", name);
            code = write_table(stream, report, part, name, reason);
        }
        fputs("</figure>\n", stream);
    }
    globfree(&found);
    return code;
}

static int write_part(FILE *stream, const struct report *report, const struct report_part *part,
                      char *reason) {
    char shown[8192] = "", folder[PATH_SIZE];
    struct text_table rows;
    int figures = 0;
    if (path_format(folder, "%s/%s", report->root, part->experiment->name) ||
        statements_read(&rows, folder, reason))
        return -1;
    write_statements(stream, report, part, &rows, NULL);
    int code = write_figures(stream, report, part, "png", &rows, shown, &figures, reason);
    if (!code)
        code = write_figures(stream, report, part, "svg", &rows, shown, &figures, reason);
    text_table_free(&rows);
    if (!code && !figures) {
        snprintf(reason, REASON_SIZE, "%.150s/%.80s: no figure is there", report->root,
                 part->experiment->name);
        return -1;
    }
    return code ? code : write_other_tables(stream, report, part, shown, reason);
}

/* --- the page --- */

static void write_head(FILE *stream, const struct report *report) {
    fprintf(stream,
            "<!DOCTYPE html>\n<html xmlns=\"http://www.w3.org/1999/xhtml\" lang=\"en\">\n<head>\n"
            "<meta charset=\"utf-8\"/>\n<meta name=\"viewport\" content=\"width=device-width, "
            "initial-scale=1\"/>\n<title>wisplab report</title>\n<style>\n%s</style>\n</head>\n"
            "<body>\n<h1>Time integrators on one model of hair</h1>\n",
            style);
    html_print(stream,
               "wisplab %s, commit %s%s. Numbers in tables have four digits here, and all "
               "of them in the linked files.",
               WISPLAB_VERSION, WISPLAB_COMMIT,
               report->quick ? "; --quick: small, stated subsets" : "");
    fputs("\n<nav><p><a href=\"#answers\">answers</a>", stream);
    for (int i = 0; i < report->part_count; i++)
        fprintf(stream, " · <a href=\"#%s\">%s</a>", report->parts[i].experiment->name,
                report->parts[i].experiment->name);
    fputs(" · <a href=\"#methods\">methods</a> · <a href=\"#machine\">machine</a></p></nav>\n",
          stream);
}

static int write_parts(FILE *stream, const struct report *report, char *reason) {
    int code = 0;
    for (int i = 0; i < report->part_count && !code; i++) {
        const struct report_part *part = &report->parts[i];
        char title[256];
        fprintf(stream, "<section id=\"%s\"%s><h2>%s: ", part->experiment->name,
                part->included ? " class=\"there\"" : "", part->experiment->name);
        experiment_title(part->experiment, title);
        html_text(stream, title);
        fputs("</h2>\n", stream);
        if (part->note[0]) {
            fprintf(stream, "<p class=\"small\">%s", part->included ? "" : "Not in this report: ");
            html_text(stream, part->note);
            fputs(".</p>\n", stream);
        }
        if (part->included)
            code = write_part(stream, report, part, reason);
        fputs("</section>\n", stream);
    }
    return code;
}

static void write_row(FILE *stream, const char *const *cells, int count, const char *kind) {
    fputs("<tr>", stream);
    for (int i = 0; i < count; i++) {
        fprintf(stream, "<%s>", kind);
        html_text(stream, cells[i]);
        fprintf(stream, "</%s>", kind);
    }
    fputs("</tr>\n", stream);
}

/* The registries as they are: what is compared, and where it comes from. */
static void write_methods(FILE *stream) {
    fputs(
        "<section id=\"methods\"><h2>Methods</h2>\n"
        "<p>Every stepper runs on the same forces. Errors are distances from a tight solution of "
        "the same problem with the same treatment, which a second method confirms; the first line "
        "of each table says of what. CPU times are of runs that are alone on the machine; a run "
        "is a process with limits on time and memory, and one that fails is a result.</p>\n"
        "<div class=\"wide\"><table><thead>",
        stream);
    write_row(stream, (const char *const[]){"name", "what it is", "reference"}, 3, "th");
    fputs("</thead><tbody>\n", stream);
    for (int i = 0; stepper_methods[i]; i++) {
        const struct stepper_method *m = stepper_methods[i];
        write_row(stream, (const char *const[]){m->name, m->summary, m->reference}, 3, "td");
    }
    for (int i = 0; linear_methods[i]; i++)
        write_row(stream,
                  (const char *const[]){linear_methods[i]->name, linear_methods[i]->summary,
                                        linear_methods[i]->reference},
                  3, "td");
    for (int p = 0; problems[p]; p++)
        for (int i = 0; problems[p]->treatments[i].name; i++)
            write_row(stream,
                      (const char *const[]){problems[p]->treatments[i].name,
                                            problems[p]->treatments[i].summary, problems[p]->name},
                      3, "td");
    fputs("</tbody></table></div></section>\n", stream);
}

static void write_object(FILE *stream, json_t *object) {
    const char *key;
    json_t *value;
    char number[32];
    json_object_foreach(object, key, value) {
        snprintf(number, sizeof number, "%g", json_number_value(value));
        write_row(
            stream,
            (const char *const[]){key, json_is_string(value) ? json_string_value(value) : number},
            2, "td");
    }
    json_decref(object);
}

/* What drew the figures, by its own words. */
static void gnuplot_version(char *version, int size) {
    const char *const argv[] = {"gnuplot", "--version", NULL};
    const struct run_limits limits = {.seconds = 10};
    int status, out_of_time;
    FILE *words = tmpfile();
    const int error =
        words ? program_finish(argv, &limits, &(struct program_words){fileno(words), fileno(words)},
                               &status, &out_of_time)
              : errno;
    if (words)
        rewind(words);
    if (error || !fgets(version, size, words))
        snprintf(version, (size_t)size, "unknown");
    version[strcspn(version, "\n")] = '\0';
    if (words)
        fclose(words);
}

static void write_machine(FILE *stream) {
    char version[128];
    gnuplot_version(version, sizeof version);
    fputs("<section id=\"machine\"><h2>Machine and versions</h2>\n<div class=\"wide\"><table>"
          "<tbody>\n",
          stream);
    write_object(stream, machine_to_json());
    write_object(stream, build_to_json());
    write_row(stream, (const char *const[]){"figures", version}, 2, "td");
    fputs("</tbody></table></div></section>\n", stream);
}

int report_write(const struct report *report, char *reason) {
    char path[PATH_SIZE];
    struct atomic_file file;
    if (path_format(path, "%s/report.html", report->root)) {
        snprintf(reason, REASON_SIZE, "the path of the report is too long");
        return -1;
    }
    if (make_folder(report->root, reason) || atomic_open(&file, path, reason))
        return -1;
    write_head(file.stream, report);
    int code = answers_write(file.stream, report, reason);
    if (!code)
        code = write_parts(file.stream, report, reason);
    write_methods(file.stream);
    write_machine(file.stream);
    fputs("</body>\n</html>\n", file.stream);
    if (!code)
        return atomic_commit(&file, reason);
    atomic_discard(&file);
    return code;
}
