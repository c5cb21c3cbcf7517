/* The report: a page that is whole, says something of every figure, and hides no gap. */
#include "report/report.h"

#include "base/text_table.h"
#include "experiments/registry.h"
#include "support.h"

#include <criterion/criterion.h>
#include <ctype.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* --- a strict reader of what must be XML --- */

enum { DEPTH_MAX = 64, IDS_MAX = 16384 };

struct page {
    char *text;
    char *id[IDS_MAX]; /* owned */
    int id_count;
    int figures, captions;
};

/* Reads the value of an attribute from `at`, behind its quote, into `value`. */
static const char *read_value(const char *at, char quote, char *value, size_t size) {
    const char *end = strchr(at, quote);
    cr_assert(end, "an attribute without an end: %.40s", at);
    snprintf(value, size, "%.*s", (int)(end - at), at);
    return end + 1;
}

/* The attributes of a tag, up to its end; adds ids. Returns what follows `>`; *empty: it ended
 * with `/>`. */
static const char *read_attributes(struct page *page, const char *at, int *empty) {
    static char value[1 << 20]; /* a path of many points */
    for (;;) {
        at += strspn(at, " \t\r\n");
        if (*at == '>' || strncmp(at, "/>", 2) == 0) {
            *empty = *at == '/';
            return at + 1 + *empty;
        }
        const size_t length = strcspn(at, "= \t\n>");
        const char *name = at;
        at += length + strspn(at + length, " ");
        cr_assert(length > 0 && *at == '=', "no attribute: %.60s", name);
        at += 1 + strspn(at + 1, " ");
        cr_assert(*at == '"' || *at == '\'', "no quoted value: %.60s", name);
        at = read_value(at + 1, *at, value, sizeof value);
        cr_assert(!strchr(value, '<'), "a < in an attribute: %.60s", name);
        if (length == 2 && strncmp(name, "id", 2) == 0) {
            for (int i = 0; i < page->id_count; i++)
                cr_assert(strcmp(page->id[i], value) != 0, "id %s is there twice", value);
            cr_assert(page->id_count < IDS_MAX);
            page->id[page->id_count++] = strdup(value);
        }
    }
}

/* Text between tags: no bare & and, in a figcaption, something to read. */
static void check_text(const char *at, const char *end) {
    static const char *const entities[] = {"&amp;", "&lt;", "&gt;", "&quot;"};
    for (; at < end; at++) {
        int known = *at != '&';
        for (int i = 0; i < 4; i++)
            known |= strncmp(at, entities[i], strlen(entities[i])) == 0;
        cr_assert(known, "a bare & in %.40s", at);
    }
}

/* Reads the whole page: every tag is closed in its turn. */
static void read_page(struct page *page) {
    char open[DEPTH_MAX][32];
    int depth = 0;
    const char *at = page->text;
    cr_assert(strncmp(at, "<!DOCTYPE html>\n", 16) == 0);
    at += 16;
    while (*at) {
        const char *tag = strchr(at, '<');
        check_text(at, tag ? tag : at + strlen(at));
        if (!tag)
            break;
        if (strncmp(tag, "<!--", 4) == 0) {
            at = strstr(tag, "-->") + 3;
            continue;
        }
        const int closes = tag[1] == '/';
        char name[32];
        snprintf(name, sizeof name, "%.*s", (int)strcspn(tag + 1 + closes, " \t\n/>"),
                 tag + 1 + closes);
        cr_assert(isalpha((unsigned char)name[0]), "no tag: %.40s", tag);
        if (closes) {
            cr_assert(depth > 0 && strcmp(open[depth - 1], name) == 0, "</%s> closes <%s>", name,
                      depth ? open[depth - 1] : "");
            depth--;
            at = strchr(tag, '>') + 1;
            continue;
        }
        int empty;
        page->figures += strcmp(name, "figure") == 0;
        page->captions += strcmp(name, "figcaption") == 0;
        at = read_attributes(page, tag + 1 + strlen(name), &empty);
        if (!empty) {
            cr_assert(depth < DEPTH_MAX);
            snprintf(open[depth++], sizeof open[0], "%s", name);
        }
    }
    cr_assert_eq(depth, 0, "<%s> is not closed", depth ? open[depth - 1] : "");
}

/* Every reference to an id, `mark` and then the id up to `end`, finds one. */
static void references_are_there(const struct page *page, const char *mark, char end) {
    for (const char *at = page->text; (at = strstr(at, mark)) != NULL;) {
        int found = 0;
        at += strlen(mark);
        const size_t length = (size_t)(strchr(at, end) - at);
        for (int i = 0; i < page->id_count; i++)
            found |= strlen(page->id[i]) == length && strncmp(page->id[i], at, length) == 0;
        cr_assert(found, "%s%.*s refers to nothing", mark, (int)length, at);
    }
}

static void page_free(struct page *page) {
    for (int i = 0; i < page->id_count; i++)
        free(page->id[i]);
    free(page->text);
}

/* --- prepared folders --- */

/* As gnuplot writes them: ids that are the same in every picture, and what refers to them. */
static const char picture[] =
    "<?xml version=\"1.0\"?>\n<svg width=\"9\" height=\"9\" viewBox=\"0 0 9 9\"\n "
    "xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\">\n"
    "<title>Gnuplot</title><desc>drawn &lt;so&gt;</desc>\n"
    "<g id=\"gnuplot_canvas\"><defs><circle id='gpDot' r='0.5'/>"
    "<clipPath id=\"clip\"><rect width=\"1\" height=\"1\"/></clipPath></defs>\n"
    "<use xlink:href='#gpDot'/><g clip-path=\"url(#clip)\"><text>a &amp; b</text></g></g>\n"
    "</svg>\n";

static const char circle_table[] = "# positions <exact & computed>\n"
                                   "method\ttreatment\terror_30s\terror_160s\tnote\n"
                                   "rk4\tfree\t0.0125\t0.5\t\n"
                                   "euler\tfree\t0.75\tnan\tleft \"the\" plane\n";

static const char points[] = "# points\nmethod\tstatus\terror\nrk4\tfinished\t0.0004\n";

#define STATED "# found\nkey\tfigure\tquestion\tstatement\tverdict\tvalue\tunit\tby\ttables\n"
static const char circle_rows[] = STATED
    "near\torbits-30s\t-\trk4 is < 0.02 m away.\tholds\t0.0125\tm\tours\ttable\n"
    "far\torbits-160s\t-\tEuler is not far.\tdoes not hold\t0.75\tm\tthesis\ttable orbits-30s\n"
    "left\tradius\t-\tNobody asked for the radius.\tnot asked\t-\t-\tours\t-\n";
static const char race_rows[] =
    STATED "a\tswing\ttargets\tOn swing rk4 takes 2 ms.\tholds\t2\tms\tours\tswing\n"
           "b\tswing\tchoice\tOn swing Euler is right.\tdoes not hold\t4\t1\tthesis\tswing\n"
           "c\tswing\tfailures\tOn swing Euler fails.\tholds\t1\t1\tours\tswing\n"
           "d\t-\ttargets\tIn all rk4 is cheapest.\tholds\t-\t-\tours\tscenes\n"
           "e\t-\tchoice\tIn all Euler is right.\tnot reached\t-\t-\tthesis\tscenes\n";

/* A part of the report whose folder is there. */
static struct report_part *add_part(struct report *report, const char *name, char *folder) {
    struct report_part *part = &report->parts[report->part_count++];
    *part = (struct report_part){.experiment = experiment_find(name), .included = 1};
    char reason[REASON_SIZE];
    path_format(folder, "%s/%s", report->root, name);
    cr_assert(part->experiment && make_folder(folder, reason) == 0, "%s", reason);
    return part;
}

static void prepare(struct report *report, char *root) {
    char folder[PATH_SIZE];
    folder_make(root);
    *report = (struct report){.root = root, .quick = 1};
    add_part(report, "circle", folder);
    file_write(folder, "table.tsv", circle_table, NULL);
    file_write(folder, "statements.tsv", circle_rows, NULL);
    file_write(folder, "orbits-30s.tsv", "# lines\nx\ty\n0\t1\n1\t0\n", NULL);
    file_write(folder, "orbits-160s.tsv", "# lines\nx\ty\n0\t1\n", NULL);
    file_write(folder, "orbits-30s.svg", picture, NULL);
    file_write(folder, "orbits-160s.svg", picture, NULL);
    add_part(report, "work-precision", folder);
    file_write(folder, "scenes.tsv", "# scenes\nfile\tname\nswing\tswing\n", NULL);
    file_write(folder, "swing.tsv", points, NULL);
    file_write(folder, "swing-slopes.tsv", "# slopes\nmethod\tslope\n", NULL);
    file_write(folder, "statements.tsv", race_rows, NULL);
    file_write(folder, "swing.svg", picture, NULL);
    struct report_part *part = add_part(report, "horizon", folder);
    part->included = 0;
    snprintf(part->note, REASON_SIZE, "left out for want of time");
}

static void make_page(const struct report *report, struct page *page) {
    char reason[REASON_SIZE], path[PATH_SIZE];
    *page = (struct page){.id_count = 0};
    cr_assert(report_write(report, reason) == 0, "%s", reason);
    path_format(path, "%s/report.html", report->root);
    page->text = file_read(path);
    cr_assert(page->text);
}

Test(report, page_is_well_formed_and_stands_alone) {
    struct report report;
    struct page page;
    char root[PATH_SIZE];
    prepare(&report, root);
    make_page(&report, &page);
    read_page(&page);
    references_are_there(&page, "href=\"#", '"');
    references_are_there(&page, "href='#", '\'');
    references_are_there(&page, "url(#", ')');
    cr_assert(!strstr(page.text, "src=") && !strstr(page.text, "<script") &&
                  !strstr(page.text, "<link") && !strstr(page.text, "href=\"http"),
              "it needs another file");
    page_free(&page);
    folder_remove(root);
}

/* The part of a text from one place to another. */
static char *part_of(const char *text, const char *from, const char *to) {
    const char *start = strstr(text, from);
    cr_assert(start, "no %s", from);
    const char *end = strstr(start, to);
    cr_assert(end, "no %s after %s", to, from);
    return strndup(start, (size_t)(end - start));
}

#define HAS(text, from, to, ...) must_have(text, from, to, (const char *const[]){__VA_ARGS__, NULL})
static void must_have(const char *text, const char *from, const char *to, const char *const *says) {
    char *part = part_of(text, from, to);
    for (; *says; says++)
        cr_assert(strstr(part, *says), "%s: no '%s' in %s", from, *says, part);
    free(part);
}

/* Rows stand under their figure with their verdict, and where there is no such figure at the head
 * of the part; a figure's data are the tables of its name and those that its rows name. */
Test(report, every_figure_has_its_statements_and_its_data) {
    struct report report;
    struct page page;
    char root[PATH_SIZE];
    prepare(&report, root);
    make_page(&report, &page);
    read_page(&page);
    cr_assert_eq(page.figures, 3);
    cr_assert_eq(page.captions, 3);
    HAS(page.text, "<figure id=\"circle-orbits-30s\">", "</figcaption>",
        "<li><span class=\"verdict\">holds</span> rk4 is &lt; 0.02 m away.</li>",
        "aria-label=\"rk4 is &lt; 0.02 m away.\"", "<a href=\"circle/orbits-30s.tsv\">",
        "<a href=\"circle/table.tsv\">");
    HAS(page.text, "<figure id=\"circle-orbits-160s\">", "</figcaption>",
        "<span class=\"verdict fails\">thesis: does not hold</span> Euler is not far.</li>",
        "<a href=\"circle/orbits-160s.tsv\">", "<a href=\"circle/orbits-30s.tsv\">");
    HAS(page.text, "<section id=\"circle\"", "<figure",
        "<span class=\"verdict\">not asked</span> Nobody asked for the radius.");
    HAS(page.text, "<figure id=\"work-precision-swing\">", "</figcaption>",
        "<a href=\"work-precision/swing-slopes.tsv\">", "On swing rk4 takes 2 ms.");
    HAS(page.text, "positions &lt;", "</details>", "&lt;exact &amp; computed&gt;",
        "left &quot;the&quot; plane");
    page_free(&page);
    folder_remove(root);
}

/* Under each question the rows that answer it, those that sum up first, and nothing else. */
Test(report, answers_are_the_rows_of_their_question) {
    struct report report;
    struct page page;
    char root[PATH_SIZE];
    prepare(&report, root);
    make_page(&report, &page);
    char *answers = part_of(page.text, "<section id=\"answers\">", "</section>");
    char *targets = part_of(answers, "What would one choose today", "<h3>");
    const char *sum = strstr(targets, "In all rk4 is cheapest."),
               *one = strstr(targets, "On swing rk4 takes 2 ms.");
    cr_assert(sum && one && sum < one && !strstr(targets, "Euler"), "%s", targets);
    HAS(answers, "Was explicit Euler with projection", "<h3>", "In all Euler is right.",
        "On swing Euler is right.", "Of the thesis's 2 claims in this answer 0 hold and 1 do not.");
    HAS(answers, "Where does each method fail?", "<h3>", "On swing Euler fails.");
    free(targets);
    free(answers);
    page_free(&page);
    folder_remove(root);
}

Test(report, what_is_missing_is_said_with_its_reason) {
    struct report report;
    struct page page;
    char root[PATH_SIZE];
    prepare(&report, root);
    make_page(&report, &page);
    cr_assert(strstr(page.text, "Not in this report: left out for want of time"));
    page_free(&page);
    report.parts[1].included = 0;
    snprintf(report.parts[1].note, REASON_SIZE, "failed: disk & all");
    make_page(&report, &page);
    read_page(&page);
    cr_assert(strstr(page.text, "Not in this report: experiment work-precision, failed: disk "
                                "&amp; all."));
    cr_assert(strstr(page.text, "No experiment of this report answers it."));
    page_free(&page);
    folder_remove(root);
}

/* --- what must not be shown --- */

static void must_fail(const struct report *report, int code, const char *const *says) {
    char reason[REASON_SIZE], path[PATH_SIZE];
    cr_assert_eq(report_write(report, reason), code);
    for (int i = 0; says[i]; i++)
        cr_assert(strstr(reason, says[i]), "'%s' does not say %s", reason, says[i]);
    path_format(path, "%s/report.html", report->root);
    cr_assert(!file_exists(path) && count_files(report->root, ".part") == 0,
              "half a report is there");
}

/* The page of circle with that table in its folder. */
static void table_must_fail(const char *name, const char *text, const char *const *says) {
    struct report report;
    char root[PATH_SIZE], folder[PATH_SIZE];
    prepare(&report, root);
    path_format(folder, "%s/circle", root);
    file_write(folder, name, text, NULL);
    must_fail(&report, 1, says);
    folder_remove(root);
}

Test(report, an_empty_cell_without_a_reason_is_a_failure) {
    table_must_fail("table.tsv",
                    "# x\nmethod\ttreatment\terror_30s\terror_160s\tnote\nrk4\tfree\t1\tnan\t\n",
                    (const char *const[]){"circle/table.tsv", "row 1", "column error_160s", NULL});
}

Test(report, tables_that_no_figure_shows_are_checked_too) {
    table_must_fail("other.tsv", "# x\na\tb\n1\t\n",
                    (const char *const[]){"circle/other.tsv", "column b", NULL});
}

Test(report, half_a_picture_and_none_are_failures) {
    struct report report;
    char root[PATH_SIZE], folder[PATH_SIZE];
    prepare(&report, root);
    path_format(folder, "%s/circle", root);
    file_write(folder, "orbits-30s.svg", "<svg width=\"1\"><g>", NULL);
    must_fail(&report, -1, (const char *const[]){"orbits-30s.svg", "not a whole picture", NULL});
    add_part(&report, "ladder", folder);
    file_write(folder, "statements.tsv", STATED, NULL);
    report.parts[0].included = 0;
    must_fail(&report, -1, (const char *const[]){"ladder", "no figure", NULL});
    folder_remove(root);
}

/* A picture of which nothing is stated says nothing. */
Test(report, a_figure_without_a_statement_is_a_failure) {
    struct report report;
    char root[PATH_SIZE], folder[PATH_SIZE];
    prepare(&report, root);
    path_format(folder, "%s/circle", root);
    file_write(folder, "error-time.svg", picture, NULL);
    must_fail(&report, -1, (const char *const[]){"error-time.svg", "nothing is stated", NULL});
    folder_remove(root);
}

/* Figures and tables of an earlier report in the same folder are not this one's. */
Test(report, older_files_are_not_shown) {
    struct report report;
    struct page page;
    char root[PATH_SIZE], folder[PATH_SIZE], path[PATH_SIZE], command[2 * PATH_SIZE];
    prepare(&report, root);
    path_format(folder, "%s/circle", root);
    file_write(folder, "error-time.svg", picture, path);
    snprintf(command, sizeof command, "touch -d @1000 %s", path);
    cr_assert_eq(system(command), 0);
    report.parts[0].since = 2000;
    make_page(&report, &page);
    cr_assert(strstr(page.text, "id=\"circle-orbits-30s\"") &&
              !strstr(page.text, "id=\"circle-error-time\""));
    page_free(&page);
    folder_remove(root);
}

static const struct {
    const char *text;
    int good;
} gaps[] = {
    {"# x\na\tb\n1\t2\n", 1},
    {"# x\na\tb\n1\tnan\n", 0},
    {"# x\na\tb\n1\t\n", 0},
    {"# x; nan: not measured\na\tb\n1\tnan\n", 1},
    {"# x; nan: see note\na\tb\tnote\n1\tnan\t\n", 0},
    {"# x\na\tb\tnote\n1\tnan\tit fell\n", 1},
    {"# x\na\tb\tnote\n1\t2\t\n", 1},
    {"# x\na\tstatus\n1\t\n", 0},
    {"# x\na\tstatus\nnan\tdiverged\n", 1},
    {"# x\na\tstatus\nnan\tfinished\n", 0},
    {"# x\nfailure_time\tstatus\nnan\tfinished\n", 1},
    {"# x\n\n\na\tb\n\n\n1\t2\n\n1\tnan\n", 0},
};

Test(report, gaps_need_their_reason_in_their_row) {
    char folder[PATH_SIZE], path[PATH_SIZE], reason[REASON_SIZE];
    folder_make(folder);
    for (size_t i = 0; i < sizeof gaps / sizeof *gaps; i++) {
        struct text_table table;
        file_write(folder, "gap.tsv", gaps[i].text, path);
        cr_assert(text_table_read(&table, path, reason) == 0, "%s", reason);
        cr_assert_eq(text_table_check(&table, path, reason) == 0, gaps[i].good, "table %zu", i);
        text_table_free(&table);
    }
    folder_remove(folder);
}

Test(report, tables_that_are_none_are_refused_in_one_line) {
    static const char *const texts[] = {"", "# only a comment\n", "a\tb\n1\n"};
    char folder[PATH_SIZE], path[PATH_SIZE], reason[REASON_SIZE];
    struct text_table table;
    folder_make(folder);
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        file_write(folder, "none.tsv", texts[i], path);
        cr_assert(text_table_read(&table, path, reason) == -1 && strstr(reason, "none.tsv"),
                  "text %zu", i);
    }
    path_format(path, "%s/nowhere.tsv", folder);
    cr_assert(text_table_read(&table, path, reason) == -1 && strstr(reason, "cannot be read"));
    folder_remove(folder);
}

/* --- the command --- */

/* Where a part begins on the page. */
static const char *part_at(const struct page *page, int place) {
    char section[128];
    for (int i = 0; experiments[i]; i++) {
        snprintf(section, sizeof section, "<section id=\"%s\"", experiments[i]->name);
        if (experiments[i]->place == place)
            return strstr(page->text, section);
    }
    return NULL;
}

/* Every experiment has a place of its own, from 1 on, and the page has them in this order. */
static void parts_must_be_in_place(const struct page *page) {
    int count = 0;
    while (experiments[count])
        count++;
    for (int place = 1; place <= count; place++) {
        cr_assert(part_at(page, place), "nobody has place %d", place);
        cr_assert(place == 1 || part_at(page, place - 1) < part_at(page, place), "place %d", place);
    }
}

/* Runs that get no time fail, and with them what compares with their best: that is a report too. */
Test(report, slow_failures_are_reported_as_results) {
    char folder[PATH_SIZE], path[PATH_SIZE];
    struct finished f;
    struct page page = {.id_count = 0};
    folder_make(folder);
    PROGRAM(&f, NULL, "report", "--quick", "--time-limit", "0.003", "--no-progress", "--out",
            folder);
    cr_assert_eq(f.code, 0, "exit code %d: %s", f.code, f.err);
    path_format(path, "%s/report.html", folder);
    page.text = file_read(path);
    cr_assert(page.text);
    read_page(&page);
    cr_assert(page.figures > 0 && page.figures == page.captions);
    cr_assert(strstr(page.text, "Not in this report: failed: no reference run reached its end"));
    cr_assert(strstr(page.text, "left out of --quick"));
    cr_assert(strstr(page.text, "out of time"));
    parts_must_be_in_place(&page);
    for (int i = 0; experiments[i]; i++) {
        path_format(path, "%s/%s/statements.tsv", folder, experiments[i]->name);
        if (!file_exists(path))
            continue;
        *strrchr(path, '/') = '\0';
        statements_must_be_whole(path);
    }
    page_free(&page);
    folder_remove(folder);
}

/* Ctrl-C ends the report, not one experiment of it. */
Test(report, an_interrupted_report_ends) {
    char folder[PATH_SIZE], path[PATH_SIZE];
    struct finished f;
    folder_make(folder);
    const char *const words[] = {"report", "--quick", "--no-progress", "--out", folder, NULL};
    const struct process process = program_start(NULL, words);
    path_format(path, "%s/runs", folder);
    for (int i = 0; i < 2000 && !file_exists(path); i++) /* until it is at its runs */
        nanosleep(&(struct timespec){.tv_nsec = 5000000}, NULL);
    kill(process.pid, SIGINT);
    program_wait(&process, &f);
    cr_assert_eq(f.code, 3, "exit code %d", f.code);
    cr_assert(strstr(f.err, "interrupted") && count_lines(f.err) == 1, "%s", f.err);
    path_format(path, "%s/report.html", folder);
    cr_assert(!file_exists(path));
    folder_remove(folder);
}
