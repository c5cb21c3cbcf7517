#include "report.h"

#include "base/files.h"
#include "build_info.h"
#include "chapters.h"
#include "html.h"
#include "model/problems.h"
#include "part.h"
#include "run/identity.h"
#include "run/program.h"

#include <errno.h>
#include <string.h>
#include <time.h>

/* Dark on white. What is wider than a phone scrolls in its own box, which says so; letters in
 * figures keep a size that can be read. On paper what is folded stays folded. */
static const char style[] =
    "body{color:#111;background:#fff;font:16px/1.45 sans-serif;max-width:76rem;margin:0 auto;"
    "padding:0 1rem 3rem}\n"
    "h1{font-size:1.7rem;line-height:1.2;margin:.6rem 0 .3rem}h2{font-size:1.35rem;margin:2rem 0 "
    ".4rem;border-top:2px solid #555;padding-top:.6rem}h3{font-size:1.05rem;margin:1rem 0 .2rem}\n"
    "p{margin:.4rem 0;max-width:60rem}ul,ol{margin:.3rem 0;padding-left:1.3rem;max-width:62rem}"
    "li{margin:.15rem 0}a{color:#00528a}section,details,figure{scroll-margin-top:2.6rem}\n"
    "nav{position:sticky;top:0;background:#fff;border-bottom:1px solid #bbb;padding:.35rem 0;"
    "font-size:.9rem;z-index:1}\n"
    ".first{display:grid;grid-template-columns:minmax(0,7fr) minmax(0,3fr);gap:1rem;"
    "align-items:start}.first figcaption{display:none}.first figure{margin:0}"
    ".first>figure>.claim{margin:.2rem 0}\n"
    "figure{margin:.8rem 0}figcaption{margin:.3rem 0;font-size:.92rem}"
    ".claim{font-weight:bold;margin:1rem 0 .3rem}.here{font-weight:normal;text-decoration:none;"
    "color:#767676}.claims{width:100%}.claims td:first-child{width:38%}"
    ".claims td:last-child{width:7rem}.about,.answers{max-width:none}\n"
    ".wide{overflow-x:auto;max-width:100%}.wide img,.wide svg{display:block;max-width:100%;"
    "height:auto;margin:0 auto}svg image{image-rendering:pixelated}\n"
    ".wide:has(table){background:linear-gradient(90deg,#fff 30%,#fff0) 0 0/2.5rem 100% no-repeat "
    "local,linear-gradient(270deg,#fff 30%,#fff0) 100% 0/2.5rem 100% no-repeat local,"
    "linear-gradient(90deg,#888,#fff0) 0 0/.6rem 100% no-repeat scroll,"
    "linear-gradient(270deg,#888,#fff0) 100% 0/.6rem 100% no-repeat scroll}\n" /* where more is */
    "table{border-collapse:collapse;font-size:.82rem;margin:.5rem 0}"
    "th,td{border-bottom:1px solid #ddd;padding:.15rem .5rem;text-align:left;vertical-align:top}"
    "th{background:#f3f3f3}.number{text-align:right;white-space:nowrap}.none{text-align:center}"
    ".name{white-space:nowrap}\n"
    ".small{font-size:.85rem;color:#333;overflow-wrap:anywhere}\n"
    "summary{cursor:pointer;padding:.2rem 0}.part{border-top:1px solid #ddd}"
    ".part[open]{border-left:3px solid #bbb;padding-left:.8rem;margin-bottom:1rem}"
    ".headline{display:block;color:#333;font-size:.88rem;padding-left:1rem}\n"
    ".verdict{font-size:.8rem;border:1px solid #767676;border-radius:.3rem;padding:0 .3rem;"
    "white-space:nowrap}.fails{background:#fbe3d6}\n"
    "@media (max-width:48rem){.first{display:block}.claims "
    "td:last-child{width:auto}.wide:has(svg,img)::before{content:\"scroll sideways "
    "\\2194\";display:block;position:sticky;left:0;font-size:.75rem;color:#555}"
    ".wide svg,.wide img{max-width:none;min-width:var(--legible,0)}}\n"
    "@media print{html{font-size:9.5pt}body{max-width:none;font-size:1rem;padding:0}"
    "nav,.here{display:none}.first{display:block}.first .film>div{max-width:9cm}"
    "h2,h3,summary{break-after:avoid}figure,tr{break-inside:avoid}thead{display:table-header-group}"
    ".wide{overflow:visible}.wide svg,.wide img{min-width:0;max-width:100%;max-height:19cm}"
    ".wide:has(svg,img)::before{content:none}.wide:has(table){background:none}"
    "table{font-size:7pt}th,td{padding:1pt 3pt}}\n";

/* --- the page --- */

static void write_head(FILE *stream) {
    fprintf(stream,
            "<!DOCTYPE html>\n<html xmlns=\"http://www.w3.org/1999/xhtml\" lang=\"en\">\n<head>\n"
            "<meta charset=\"utf-8\"/>\n<meta name=\"viewport\" content=\"width=device-width, "
            "initial-scale=1\"/>\n<title>wisplab report</title>\n<style>\n%s</style>\n</head>\n"
            "<body>\n<h1 id=\"top\">Which time integrator for hair?</h1>\n<p class=\"about\">",
            style);
    int methods = 0;
    while (stepper_methods[methods])
        methods++;
    html_print(
        stream,
        "A wisp of hair is a chain of masses on springs. %d time integrators move the same "
        "wisps under the same forces: what does each cost, where does it fail, and how "
        "little of the model does a scene need? The chart shows the CPU time that each takes "
        "to stay within a millimetre of the true motion, from soft hair to stiff; a cross "
        "says that its next longer step fails.",
        methods);
    fputs("</p>\n", stream);
}

/* Answers of three chapters in a sentence each; that of the first is the chart's title. */
static void write_first_answers(const struct page *page) {
    static const char *const first[] = {"stability", "needs", "wind"};
    struct page_part part;
    fputs("<ol class=\"answers\">\n", page->stream);
    for (size_t i = 0; i < sizeof first / sizeof *first; i++)
        if (page_find(page, first[i], &part))
            part_write_headline(&part);
    fputs("</ol>\n", page->stream);
}

static void write_left_out(FILE *stream, const struct report *report) {
    const char *before = "What was not tried is in the experiments that this report leaves out: ";
    int count = 0;
    fputs("<p class=\"small\">", stream);
    for (int i = 0; i < report->part_count; i++)
        if (!report->parts[i].included) {
            fprintf(stream, "%s<a href=\"#%s\">%s</a>", count++ ? ", " : before,
                    report->parts[i].experiment->name, report->parts[i].experiment->name);
        }
    html_print(stream,
               "%swisplab %s, commit %s%s. Numbers in tables have four digits here, and all of "
               "them in the linked files.",
               count ? ". " : "", WISPLAB_VERSION, WISPLAB_COMMIT,
               report->quick ? "; --quick: small, stated subsets of each experiment" : "");
    fputs("</p>\n", stream);
}

static void write_contents(FILE *stream) {
    fputs("<nav><a href=\"#top\">top</a>", stream);
    chapters_write_links(stream);
    fputs(" · <a href=\"#methods\">Methods</a> · <a href=\"#machine\">Machine</a></nav>\n", stream);
}

/* Two cells of a row, or three. */
static void write_row(FILE *stream, const char *a, const char *b, const char *c) {
    fputs("<tr>", stream);
    html_cell(stream, a);
    html_cell(stream, b);
    if (c)
        html_cell(stream, c);
    fputs("</tr>\n", stream);
}

static void write_treatments(FILE *stream) {
    fputs("<p>A treatment is how a constraint is kept, the same by every stepper:</p>\n"
          "<div class=\"wide\"><table><thead><tr><th>problem</th><th>treatment</th><th>what it "
          "is</th>"
          "</tr></thead><tbody>\n",
          stream);
    for (int p = 0; problems[p]; p++)
        for (int i = 0; problems[p]->treatments[i].name; i++)
            write_row(stream, problems[p]->name, problems[p]->treatments[i].name,
                      problems[p]->treatments[i].summary);
    fputs("</tbody></table></div>\n", stream);
}

/* The registries as they are: what is compared, and where it comes from. */
static void write_methods(FILE *stream) {
    fputs(
        "<section id=\"methods\"><h2>Methods</h2>\n"
        "<p>Every stepper runs on the same forces. Errors are distances from a reference solution "
        "of the same problem with the same treatment, which a second method confirms; the first "
        "line of each table says of what. CPU times are of runs that are alone on the machine; a "
        "run is a process with limits on time and memory, and one that fails is a result.</p>\n"
        "<div class=\"wide\"><table><thead><tr><th>name</th><th>what it is</th><th>reference</th>"
        "</tr></thead><tbody>\n",
        stream);
    for (int i = 0; stepper_methods[i]; i++) {
        const struct stepper_method *m = stepper_methods[i];
        write_row(stream, m->name, m->summary, m->reference);
    }
    for (int i = 0; linear_methods[i]; i++)
        write_row(stream, linear_methods[i]->name, linear_methods[i]->summary,
                  linear_methods[i]->reference);
    fputs("</tbody></table></div>\n", stream);
    write_treatments(stream);
    fputs("</section>\n", stream);
}

/* Members of an object under other names; which goes with it. */
static void write_facts(FILE *stream, json_t *object, const char *const names[][2]) {
    for (int i = 0; names[i][0]; i++) {
        const json_t *value = json_object_get(object, names[i][0]);
        char number[32];
        snprintf(number, sizeof number, "%g", json_number_value(value));
        write_row(stream, names[i][1], json_is_string(value) ? json_string_value(value) : number,
                  NULL);
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

static void write_machine(FILE *stream, const struct report *report) {
    char version[128], date[64];
    const time_t now = time(NULL);
    struct tm utc;
    strftime(date, sizeof date, "%Y-%m-%d %H:%M UTC", gmtime_r(&now, &utc));
    gnuplot_version(version, sizeof version);
    fputs("<section id=\"machine\"><h2>Machine and versions</h2>\n<div class=\"wide\"><table>"
          "<tbody>\n",
          stream);
    write_facts(stream, machine_to_json(),
                (const char *const[][2]){{"processor", "processor"},
                                         {"clock", "its clock"},
                                         {"cores", "cores"},
                                         {"architecture", "architecture"},
                                         {"system", "system"},
                                         {NULL, NULL}});
    write_facts(stream, build_to_json(),
                (const char *const[][2]){{"version", "wisplab"},
                                         {"commit", "commit"},
                                         {"compiler", "compiler"},
                                         {"flags", "its flags"},
                                         {"libraries", "libraries"},
                                         {NULL, NULL}});
    write_row(stream, "figures drawn by", version, NULL);
    write_row(stream, "command", report->command ? report->command : "unknown", NULL);
    write_row(stream, "date", date, NULL);
    write_row(stream, "timed runs", "each alone: no other run of the program at the same time",
              NULL);
    fputs("</tbody></table></div></section>\n", stream);
}

/* Returns as report_write. */
static int write_page(const struct page *page) {
    write_head(page->stream);
    int code = chapters_write_front(page);
    write_first_answers(page);
    write_left_out(page->stream, page->report);
    write_contents(page->stream);
    if (!code)
        code = chapters_write(page);
    write_methods(page->stream);
    write_machine(page->stream, page->report);
    fputs("</body>\n</html>\n", page->stream);
    return code;
}

int report_write(const struct report *report, char *reason) {
    struct page page = {.report = report, .reason = reason};
    char path[PATH_SIZE];
    struct atomic_file file;
    if (path_format(path, "%s/report.html", report->root))
        return fail_with(reason, "the path of the report is too long");
    if (make_folder(report->root, reason) || atomic_open(&file, path, reason))
        return -1;
    page.stream = file.stream;
    int code = page_read_statements(&page);
    if (!code)
        code = write_page(&page);
    page_free(&page);
    if (!code)
        return atomic_commit(&file, reason);
    atomic_discard(&file);
    return code;
}
