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

static const char points[] =
    "# points\nmethod\ttreatment\tstepper\tsetting\tstatus\tfailure_time\terror\tcpu_median\tnote\n"
    "euler\tprojection\teuler\t0.01\tdiverged\t0.2\tnan\t1e-4\ttoo stiff\n\n"
    "euler\tprojection\teuler\t0.0001\tfinished\tnan\t0.0005\t0.008\t\n"
    "euler\tprojection\teuler\t1e-05\tfinished\tnan\t5e-05\t0.08\t\n\n"
    "rk4\tprojection\trk4\t0.0002\tfinished\tnan\t0.0004\t0.002\t\n"
    "rk4\tgeneralised\trk4\t0.0002\tfinished\tnan\t0.0003\t0.005\t\n"
    "cvode\tgeneralised\tcvode\t0.001\tfinished\tnan\t0.0008\t0.003\t\n";
static const char references[] = "# tight\ntreatment\tbound\tstatus\ttreatment_error\tnote\n"
                                 "projection\t1e-12\tfinished\t0.0045\t\n"
                                 "generalised\t1e-12\tfinished\t0.0001\t\n";

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
    file_write(folder, "orbits-30s.tsv", "# lines\nx\ty\n0\t1\n1\t0\n", NULL);
    file_write(folder, "orbits-160s.tsv", "# lines\nx\ty\n0\t1\n", NULL);
    file_write(folder, "orbits-30s.svg", picture, NULL);
    file_write(folder, "orbits-160s.svg", picture, NULL);
    add_part(report, "work-precision", folder);
    file_write(folder, "scenes.tsv", "# scenes\nfile\tname\nswing\tswing\n", NULL);
    file_write(folder, "swing.tsv", points, NULL);
    file_write(folder, "swing-reference.tsv", references, NULL);
    file_write(folder, "swing-slopes.tsv", "# slopes\nmethod\tslope\n", NULL);
    file_write(folder, "swing-cheapest.tsv",
               "# least\ntreatment\ttarget\tmethod\tcpu_median\n"
               "projection\t0.01\trk4\t0.002\ngeneralised\t0.01\tcvode\t0.003\n",
               NULL);
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

static void must_say(const struct page *page, const char *const *says) {
    for (; *says; says++)
        cr_assert(strstr(page->text, *says), "the page does not say: %s", *says);
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

/* The sentences are those of the prepared numbers. */
Test(report, every_figure_has_its_sentence_and_its_data) {
    static const char *const says[] = {
        "After 30 s rk4 (free) is nearest to where the particle should be, 0.0125 m away",
        "and euler (free) farthest, 0.75 m",
        "After 160 s rk4 (free) is nearest to where the particle should be, 0.5 m away, and rk4",
        "To 10 mm: rk4 with projection, 2 ms. No run is within 1 mm.",
        "5 settings finished, 1 failed, 0 were refused or left out",
        "the smallest error is euler's, 5e-05 m.",
        "<a href=\"circle/orbits-30s.tsv\">",
        "<a href=\"work-precision/swing-cheapest.tsv\">",
        "positions &lt;exact &amp; computed&gt;",
        "left &quot;the&quot; plane",
        NULL,
    };
    struct report report;
    struct page page;
    char root[PATH_SIZE];
    prepare(&report, root);
    make_page(&report, &page);
    read_page(&page);
    cr_assert_eq(page.figures, 3);
    cr_assert_eq(page.captions, 3);
    must_say(&page, says);
    page_free(&page);
    folder_remove(root);
}

/* At 10 000 Hz, nearest to 9000, rk4 is as accurate for a quarter of the cost, and the treatment is
 * nine times farther from the truth than the method. For 10 mm rk4 with projection is within
 * (0.4 + 4.5 mm), for 1 mm only cvode and rk4 with generalised are, for 0.1 mm nothing. */
Test(report, answers_follow_from_the_tables) {
    static const char *const says[] = {
        "swing, at 10000 Hz, the run nearest to 9000 Hz: as a method, no: it costs 4 times what",
        "what rk4 does for an error no larger (0.5 mm, 8 ms).",
        "As a treatment, no: projection is 4.5 mm from the exact constrained motion, 9 times",
        "<td class=\"number\">10</td><td>rk4</td><td>projection</td>",
        "<td class=\"number\">1</td><td>cvode</td><td>generalised</td>",
        "<td class=\"number\">0.1</td><td>none of the runs reaches it</td>",
        "<td>euler</td><td>projection</td><td>1 of 3</td><td>diverged</td><td>0.0001</td>",
        "<td>too stiff</td>",
        "<td>rk4</td><td>generalised</td><td>0 of 1</td><td>–</td>",
        "Right as a method (for its accuracy none was clearly cheaper) on 0 of 1 scenes",
        "as a treatment (no farther from the exact motion than the method's own error) on 0 of 1",
        "10 mm: rk4 (1); 1 mm: cvode (1); 0.1 mm: none (1)",
        "Failed: euler in 1 of 3 runs. Never failed: rk4, cvode.",
        NULL,
    };
    struct report report;
    struct page page;
    char root[PATH_SIZE];
    prepare(&report, root);
    make_page(&report, &page);
    must_say(&page, says);
    page_free(&page);
    folder_remove(root);
}

/* Where each method fails and what each scene needs, in a sentence above the tables. */
Test(report, limits_and_needs_are_answered_in_a_sentence) {
    static const char *const says[] = {
        "<p class=\"answer\">Longest stable steps on swing (projection): euler 1/8370 s, then "
        "diverged; implicit-euler any; cvode chooses its steps. Longest stable steps on ball "
        "(penalty): midpoint none that was tried (diverged); rk4 1/3240 s, then wrong.</p>",
        "<p class=\"answer\">swing: 8 nodes, hinges, at 0.31 of the full model's cost. ball: no "
        "answer.</p>",
        NULL,
    };
    struct report report;
    struct page page;
    char root[PATH_SIZE], folder[PATH_SIZE];
    prepare(&report, root);
    add_part(&report, "stability", folder);
    file_write(folder, "largest-step.tsv",
               "# steps; nan: of what fails, none does\n"
               "scene\ttreatment\tstepper\tstep\trate\tunstable_step\tkind\n"
               "swing\tprojection\teuler\t0.000119\t8370\t0.00012\tdiverged\n"
               "swing\tprojection\timplicit-euler\t0.0033\t300\tnan\tnone\n"
               "swing\tprojection\tcvode\t0.001\t1000\tnan\tchooses its steps\n"
               "swing\tpenalty\teuler\t0.000123\t8100\t0.00012\tdiverged\n"
               "ball\tpenalty\tmidpoint\tnan\tnan\t0.0003\tdiverged\n"
               "ball\tpenalty\trk4\t0.000308\t3240\t0.0003\twrong\n",
               NULL);
    file_write(folder, "largest-step.svg", picture, NULL);
    add_part(&report, "needs", folder);
    file_write(folder, "swing.svg", picture, NULL);
    file_write(folder, "needs.tsv", "# needs\nscene\tthing\tverdict\nswing\tnodes\tneeded\n", NULL);
    file_write(folder, "smallest.tsv",
               "# needs; nan: the run failed\n"
               "scene\tnodes\tenvelope\tbending law\tcompared\tcost_ratio\tnote\n"
               "swing\t8 nodes\t-\thinges\t1\t0.3075\t\n"
               "ball\t-\t-\t-\t1\tnan\tnone\n",
               NULL);
    make_page(&report, &page);
    read_page(&page);
    must_say(&page, says);
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
    report.parts[0].included = 0;
    must_fail(&report, -1, (const char *const[]){"ladder", "no figure", NULL});
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
