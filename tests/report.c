/* The report: a page that is whole, says something of every figure, and hides no gap. */
#include "report/report.h"

#include "base/text_table.h"
#include "experiments/registry.h"
#include "picture/canvas.h"
#include "picture/tips.h"
#include "report/svg.h"
#include "support.h"

#include <criterion/criterion.h>
#include <ctype.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* --- a strict reader of what must be XML --- */

enum { DEPTH_MAX = 64, IDS_MAX = 16384 };

struct page {
    char *text;
    char *id[IDS_MAX];
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
            page->id[page->id_count++] = printed("%s", value);
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
        const char *const name =
            printed("%.*s", (int)strcspn(tag + 1 + closes, " \t\n/>"), tag + 1 + closes);
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
static const char circle_rows[] =
    STATED "near\torbits-30s\t-\trk4 is < 0.02 m away.\tholds\t0.0125\tm\tours\ttable\n"
           "far\torbits-160s\t-\tEuler is not far: it is 0.75 m away.\tdoes not "
           "hold\t0.75\tm\tthesis\ttable orbits-30s\n"
           "left\tradius\t-\tNobody asked for the radius.\tnot asked\t-\t-\tours\t-\n";
static const char race_rows[] = STATED
    "a\tswing\ttargets\tOn swing rk4 takes 2 ms.\tholds\t2\tms\tours\tswing\n"
    "b\tswing\tchoice\tOn swing Euler is right: rk4 is four times cheaper.\tdoes not "
    "hold\t4\t1\tthesis\tswing\n"
    "c\tswing\tfailures\tOn swing Euler fails.\tholds\t1\t1\tours\tswing\n"
    "d\t-\ttargets\tIn all rk4 is cheapest.\tholds\t-\t-\tours\tscenes\n"
    "e\t-\tchoice\tIn all Euler is right: nobody knows.\tnot reached\t-\t-\tthesis\tscenes\n";

/* A part of the report whose folder is there. */
static struct report_part *add_part(struct report *report, const char *name, char *folder) {
    struct report_part *part = &report->parts[report->part_count++];
    *part = (struct report_part){.experiment = experiment_find(name), .included = 1};
    char reason[REASON_SIZE];
    path_format(folder, "%s/%s", report->root, name);
    cr_assert(part->experiment && make_folder(folder, reason) == 0, "%s", reason);
    return part;
}

static void prepare(struct report *report) {
    char folder[PATH_SIZE];
    const char *const root = folder_make();
    *report = (struct report){.root = root, .quick = 1};
    add_part(report, "circle", folder);
    file_write(folder, "table.tsv", circle_table);
    file_write(folder, "statements.tsv", circle_rows);
    file_write(folder, "orbits-30s.tsv", "# lines\nx\ty\n0\t1\n1\t0\n");
    file_write(folder, "orbits-160s.tsv", "# lines\nx\ty\n0\t1\n");
    file_write(folder, "orbits-30s.svg", picture);
    file_write(folder, "orbits-160s.svg", picture);
    add_part(report, "work-precision", folder);
    file_write(folder, "scenes.tsv", "# scenes\nfile\tname\nswing\tswing\n");
    file_write(folder, "swing.tsv", points);
    file_write(folder, "swing-slopes.tsv", "# slopes\nmethod\tslope\n");
    file_write(folder, "statements.tsv", race_rows);
    file_write(folder, "swing.svg", picture);
    struct report_part *part = add_part(report, "horizon", folder);
    part->included = 0;
    snprintf(part->note, REASON_SIZE, "left out for want of time");
}

static void make_page(const struct report *report, struct page *page) {
    char reason[REASON_SIZE];
    *page = (struct page){.id_count = 0};
    cr_assert(report_write(report, reason) == 0, "%s", reason);
    page->text = file_read(printed("%s/report.html", report->root));
    cr_assert(page->text);
}

Test(report, page_is_well_formed_and_stands_alone) {
    struct report report;
    struct page page;
    prepare(&report);
    make_page(&report, &page);
    read_page(&page);
    references_are_there(&page, "href=\"#", '"');
    references_are_there(&page, "href='#", '\'');
    references_are_there(&page, "url(#", ')');
    cr_assert(!strstr(page.text, "src=") && !strstr(page.text, "<script") &&
                  !strstr(page.text, "<link") && !strstr(page.text, "href=\"http"),
              "it needs another file");
}

/* The part of a text from one place to another. */
static char *part_of(const char *text, const char *from, const char *to) {
    const char *start = strstr(text, from);
    cr_assert(start, "no %s", from);
    const char *end = strstr(start, to);
    cr_assert(end, "no %s after %s", to, from);
    return printed("%.*s", (int)(end - start), start);
}

#define HAS(text, from, to, ...) must_have(text, from, to, (const char *const[]){__VA_ARGS__, NULL})
static void must_have(const char *text, const char *from, const char *to, const char *const *says) {
    char *part = part_of(text, from, to);
    for (; *says; says++)
        cr_assert(strstr(part, *says), "%s: no '%s' in %s", from, *says, part);
}

/* Rows stand under their figure with their verdict, and where there is no such figure at the head
 * of the part; a figure's data are the tables of its name and those that its rows name. */
Test(report, every_figure_has_its_statements_and_its_data) {
    struct report report;
    struct page page;
    prepare(&report);
    make_page(&report, &page);
    read_page(&page);
    cr_assert_eq(page.figures, 3);
    cr_assert_eq(page.captions, 3);
    HAS(page.text, "<figure id=\"circle-orbits-30s\">", "</figcaption>",
        "<p class=\"claim\">rk4 is &lt; 0.02 m away <a", "aria-label=\"rk4 is &lt; 0.02 m away.\"",
        "<a href=\"circle/orbits-30s.tsv\">", "<a href=\"circle/table.tsv\">");
    HAS(page.text, "<figure id=\"circle-orbits-160s\">", "</figcaption>",
        "<p class=\"claim\">Euler is not far? <span class=\"verdict fails\">does not hold</span> "
        "it is "
        "0.75 m away <a",
        "<tr><td>Euler is not far</td><td>it is 0.75 m away.</td><td><span class=\"verdict fails\">"
        "does not hold</span></td></tr>",
        "<a href=\"circle/orbits-160s.tsv\">", "<a href=\"circle/orbits-30s.tsv\">");
    HAS(page.text, "<details class=\"part\" id=\"circle\"", "<figure",
        "<span class=\"verdict\">not asked</span> Nobody asked for the radius.");
    HAS(page.text, "<figure id=\"work-precision-swing\">", "</figcaption>",
        "<a href=\"work-precision/swing-slopes.tsv\">",
        "<p class=\"claim\">On swing rk4 takes 2 ms <a", "<li>On swing Euler fails.</li>");
    HAS(page.text, "positions &lt;", "</details>", "&lt;exact &amp; computed&gt;",
        "left &quot;the&quot; plane");
    char *swing = part_of(page.text, "<figure id=\"work-precision-swing\">", "</figcaption>");
    cr_assert(!strstr(swing, "swing-envelope.tsv"), "another figure's table");
}

/* In the chapter of each question the rows that answer it, those that sum up first and the others
 * in a fold, and nothing else. */
Test(report, answers_are_the_rows_of_their_question) {
    struct report report;
    struct page page;
    prepare(&report);
    make_page(&report, &page);
    char *targets = part_of(page.text, "What would one choose today", "<figure");
    const char *sum = strstr(targets, "In all rk4 is cheapest."),
               *fold = strstr(targets, "<details><summary>Scene by scene: 1 sentences"),
               *one = strstr(targets, "On swing rk4 takes 2 ms.");
    cr_assert(sum && fold && one && sum < fold && fold < one && !strstr(targets, "Euler"), "%s",
              targets);
    HAS(page.text, "Was explicit Euler with projection", "</section>",
        "<td>In all Euler is right</td><td>nobody knows.</td>",
        "<td>On swing Euler is right</td><td>rk4 is four times cheaper.</td>",
        "Scene by scene none of its 1 claims holds.");
    HAS(page.text, "Where does each method fail?", "</section>", "On swing Euler fails.");
    HAS(page.text, "What does each scene need?", "</section>",
        "No experiment of this report answers it.");
}

/* The page begins with the sentence of an experiment that its headline names, and links to its
 * fold; a figure that is shown at the head of a chapter is not shown again in that. */
Test(report, what_matters_most_comes_first_and_once) {
    struct report report;
    struct page page;
    char folder[PATH_SIZE];
    prepare(&report);
    add_part(&report, "ladder", folder);
    file_write(folder, "ladder.svg", picture);
    file_write(folder, "statements.tsv",
               STATED "other\tladder\t-\tSomething else.\tholds\t1\t1\tours\t-\n"
                      "price, default\tladder\t-\tA millimetre is cheap.\tholds\t1\t1\tours\t-\n");
    add_part(&report, "stability", folder);
    file_write(folder, "limits.svg", picture);
    file_write(folder, "statements.tsv",
               STATED "swing, longest steps\t-\t-\tSteps are long.\tholds\t1\tms\tours\t-\n"
                      "one\tlimits\t-\tOne is.\tholds\t1\tms\tours\t-\n");
    make_page(&report, &page);
    read_page(&page);
    HAS(page.text, "<figure id=\"ladder-ladder\"", "</figure>",
        "<p class=\"claim\">A millimetre is cheap <a", "<li>Something else.</li>");
    HAS(page.text, "<figure id=\"stability-limits\"", "</figure>",
        "<p class=\"claim\">Steps are long <a", "<li>One is.</li>");
    HAS(page.text, "<ol", "</ol>", "Steps are long. <a href=\"#stability\">stability</a>");
    const char *figure = strstr(page.text, "<figure id=\"ladder-ladder\"");
    cr_assert(figure && figure < strstr(page.text, "<ol") &&
              !strstr(figure + 1, "<figure id=\"ladder-ladder\""));
    HAS(page.text, "<details class=\"part\" id=\"ladder\"", "</details>",
        "<a href=\"#ladder-ladder\">");
}

/* Writes a picture of some pixels, all of one colour but for a line. */
static void write_png(const char *folder, const char *name, int width, int height) {
    char reason[REASON_SIZE];
    struct canvas *canvas = canvas_create(width, height, 0);
    canvas_line(canvas, 1, 1, 5, 5, 0x8F6136);
    cr_assert_eq(canvas_write(canvas, printed("%s/%s", folder, name), reason), 0, "%s", reason);
    canvas_free(canvas);
}

/* The height of the n-th WebP of a page, which its bytes 28 and 29 are (RFC 9649, 2.5). */
static int webp_height(const char *page, int n) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/",
                      before[] = "data:image/webp;base64,";
    for (; n > 0; n--)
        page = strstr(page, before) + strlen(before);
    int bits = 0;
    for (int i = 36; i < 40; i++) /* bytes 27 to 29 */
        bits = bits << 6 | (int)(strchr(digits, page[i]) - digits);
    return (bits >> 8 & 0xFF) | (bits & 0x3F) << 8;
}

/* Photographs, as it were, are in the page as WebP. A film is the sheet of its frames behind a
 * window of the height of one: it moves without a script, not where motion is not wanted, and on
 * paper is the last frame alone. */
Test(report, pictures_of_hair_and_films_are_in_the_page) {
    struct report report;
    struct page page;
    char folder[PATH_SIZE];
    prepare(&report);
    add_part(&report, "wind", folder);
    write_png(folder, "hair.png", 64, 48);
    write_png(folder, "film.png", 64, 3 * 50);
    file_write(folder, "film.tsv", "# frames\nframe\tt\n1\t0\n2\t1\n3\t2\n");
    file_write(folder, "statements.tsv",
               STATED "hair\thair\t-\tAll is drawn.\tholds\t1\t1\tours\t-\n"
                      "film\tfilm\t-\tIt moves.\tholds\t1\ts\tours\tfilm\n");
    make_page(&report, &page);
    read_page(&page);
    cr_assert_eq(count_of(page.text, "<img "), 3);
    HAS(page.text, "<figure id=\"wind-hair\">", "<figcaption>",
        "<img style=\"--legible:49px\" alt=\"All is drawn.\" src=\"data:image/webp;base64,UklGR");
    HAS(page.text, "<figure id=\"wind-film\">", "<figcaption>",
        "alt=\"It moves.\" src=\"data:image/webp;base64,UklGR", "aspect-ratio:64/50",
        "steps(3,jump-none)", "translateY(-66.6667%)",
        "@media screen and (prefers-reduced-motion:no-preference){\n.film .sheet img{animation:",
        ".film>.printed{display:none}", "@media print{.film label,.film>.sheet{display:none}");
    const char *film = strstr(page.text, "<figure id=\"wind-film\">");
    cr_expect(webp_height(film, 1) == 150 && webp_height(film, 2) == 50,
              "frames as high as %d and %d", webp_height(film, 1), webp_height(film, 2));
    char *style = part_of(page.text, "<figure id=\"wind-film\">", "@media");
    cr_assert(!strstr(style, "animation:"), "it moves everywhere: %s", style);
    cr_assert(!strstr(page.text, "<script"));
}

/* What is no picture is said, and not put into the page. */
Test(report, a_png_that_is_none_is_a_failure) {
    struct report report;
    char folder[PATH_SIZE], reason[REASON_SIZE];
    prepare(&report);
    add_part(&report, "wind", folder);
    file_write(folder, "hair.png", "half a");
    file_write(folder, "statements.tsv",
               STATED "hair\thair\t-\tAll is drawn.\tholds\t1\t1\tours\t-\n");
    cr_assert(report_write(&report, reason) != 0);
    cr_assert(strstr(reason, "hair.png: cannot be read"), "%s", reason);
}

/* Every experiment has a chapter, the page every chapter. */
Test(report, chapters_hold_their_experiments) {
    struct report report = {.quick = 1};
    struct page page;
    char folder[PATH_SIZE];
    const char *const root = folder_make();
    report.root = root;
    for (int i = 0; experiments[i]; i++) {
        add_part(&report, experiments[i]->name, folder);
        report.parts[i].included = 0;
        snprintf(report.parts[i].note, REASON_SIZE, "left out");
    }
    make_page(&report, &page);
    read_page(&page);
    references_are_there(&page, "href=\"#", '"');
    for (int i = 0; experiments[i]; i++) {
        static const char *const anchors[] = {
#define X(symbol, anchor, title, about) "<section id=\"" anchor "\">",
            CHAPTERS(X)
#undef X
        };
        char *chapter = part_of(page.text, anchors[experiments[i]->chapter], "</section>");
        cr_assert(strstr(chapter, printed("id=\"%s\"", experiments[i]->name)), "%s",
                  experiments[i]->name);
    }
}

/* --- pictures for the page --- */

static char *fit(const char *attributes) {
    static char *text; /* a stream keeps its place, as compilers know */
    static size_t size;
    FILE *stream = open_memstream(&text, &size);
    svg_write(stream, attributes, "p-");
    fclose(stream);
    return text;
}

/* Lines are written from point to point in tenths, and end where they ended however many there are;
 * a second move stays a move. Marks keep their shapes. */
Test(report, pictures_lose_nothing_that_can_be_seen) {
    static const char *const pairs[][2] = {
        {" viewBox=\"0 0 9 9\"\n >\n\n<g id='a'  fill=\"rgb( 1,  2,3)\">\n</g><path  d='M1.04,2.00 "
         "L2.06,1.5 L2.06,1.5 L0,1.5  '/></svg>",
         " viewBox=\"0 0 9 9\">\n<path d='M1,2l1.1-.5-2.1,0'/></svg>"},
        {"><path d='M10,10 M12,10 L13,10 Z'/></svg>", "><path d='M10,10m2,0l1,0z'/></svg>"},
        {"><defs><path d='M0,-1.33 L-1.33,0.67 z'/></defs></svg>",
         "><defs><path d='M0,-1.33 L-1.33,0.67 z'/></defs></svg>"},
        {"><path d='M0,0 c 1.234,5'/><text>a  b</text></svg>",
         "><path d='M0,0 c 1.234,5'/><text>a  b</text></svg>"},
        {"><use xlink:href='#m' fill=\"url(#g)\" clip-path=\"url('#h')\"/><a "
         "href=\"x#y\">#z</a></svg>",
         "><use xlink:href='#p-m' fill=\"url(#p-g)\" clip-path=\"url('#p-h')\"/><a "
         "href=\"x#y\">#z</a></svg>"},
        {"><defs><filter id='f'><x/></filter></defs></svg>", "><defs></defs></svg>"},
        {"><defs><filter id='f'><x/></filter></defs><g filter=\"url(#f)\">a</g></svg>",
         "><defs><filter id='p-f'><x/></filter></defs><g filter=\"url(#p-f)\">a</g></svg>"},
        {"><title>G</title><g ><desc>d</desc></g></svg>", "><g></g></svg>"},
        {"><g stroke-linecap=\"butt\" stroke-linejoin='miter' font-family=\"sans-serif\" "
         "stroke-width=\"1\">a</g><g stroke-linecap=\"round\" stroke-linejoin=\"round\" "
         "font-family=\"sans-serif,a\">b</g></svg>",
         "><g stroke-width=\"1\">a</g><g stroke-linecap=\"round\" stroke-linejoin=\"round\" "
         "font-family=\"sans-serif,a\">b</g></svg>"},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        char *text = fit(pairs[i][0]);
        cr_assert_str_eq(text, pairs[i][1], "%s", text);
        free(text);
    }
}

/* What gnuplot leaves to a script of its own is a title, and a link to the run where there is one;
 * on the page, which lies beside the runs, the link has one folder less. */
Test(report, points_say_what_they_are) {
    static const char drawn[] =
        "<svg><title>Gnuplot</title><g stroke='red'><path d='M0,0'/></g>\n"
        "<g fill=\"none\">\n\t<g onmousemove=\"gnuplot_svg.showHypertext(evt,'swing-rk4-1\\nrk4 at "
        "0.1: "
        "finished\\n&lt; 1')\" onmouseout=\"gnuplot_svg.hideHypertext()\"><title> </title>\n\t"
        "<use xlink:href='#m' transform='translate(54.53,91.00) scale(4.50)' opacity='0.00'/></g>\n"
        "</g>"
        "<g stroke='blue'><path d='M0,0'/><g "
        "onmousemove=\"gnuplot_svg.showHypertext(evt,'-\\neuler')\" "
        "onmouseout=\"gnuplot_svg.hideHypertext()\"><title> </title>\n\t"
        "<use transform='translate(1,2) scale(3)'/></g></g></svg>\n";
    static const char linked[] =
        "<svg><title>Gnuplot</title><g stroke='red'><path d='M0,0'/></g>\n"
        "<a xlink:href=\"../runs/swing-rk4-1/run.json\"><title>rk4 at 0.1: finished\n&lt; 1</title>"
        "<circle cx=\"54.5\" cy=\"91.0\" r=\"4.5\" fill-opacity=\"0\"/></a>"
        "<g stroke='blue'><path d='M0,0'/><g class=\"tip\"><title>euler</title>"
        "<circle cx=\"1.0\" cy=\"2.0\" r=\"3.0\" fill-opacity=\"0\"/></g></g></svg>\n";
    char *text = tips_text(drawn);
    cr_assert_str_eq(text, linked, "%s", text);
    char *page = fit(text + strlen("<svg"));
    cr_assert_str_eq(page,
                     "><g stroke='red'><path d='M0,0'/></g>\n"
                     "<a xlink:href=\"runs/swing-rk4-1/run.json\"><title>rk4 at 0.1: finished\n"
                     "&lt; 1</title><circle cx=\"54.5\" cy=\"91.0\" r=\"4.5\" "
                     "fill-opacity=\"0\"/></a><g stroke='blue'><path d='M0,0'/><g class=\"tip\">"
                     "<title>euler</title><circle cx=\"1.0\" cy=\"2.0\" r=\"3.0\" "
                     "fill-opacity=\"0\"/></g></g></svg>\n",
                     "%s", page);
    free(page);
    free(text);
    char *half = tips_text("<svg><g onmousemove=\"gnuplot_svg.showHypertext(evt,'a");
    cr_assert_str_eq(half, "<svg><g onmousemove=\"gnuplot_svg.showHypertext(evt,'a");
    free(half);
}

/* Of ten thousand points the last is where it was: roundings do not add up. */
Test(report, long_lines_end_where_they_ended) {
    char *given = NULL;
    size_t size;
    double x = 0, y = 0;
    FILE *stream = open_memstream(&given, &size);
    fputs("><path d='", stream);
    for (int i = 0; i < 10000; i++)
        fprintf(stream, "%c%.2f,%.2f ", i ? 'L' : 'M', 300 + 0.033 * i, 200 - 0.017 * i);
    fputs("'/></svg>", stream);
    fclose(stream);
    char *text = fit(given);
    for (char *at = strstr(text, "d='M") + 4, *end; *at != '\''; at = end) {
        x += strtod(at + (*at == 'l' || *at == ' '), &end);
        y += strtod(end + (*end == ','), &end);
    }
    cr_assert(fabs(x - (300 + 0.033 * 9999)) < 0.06 && fabs(y - (200 - 0.017 * 9999)) < 0.06,
              "%g, %g", x, y);
    free(text);
    free(given);
}

Test(report, what_is_missing_is_said_with_its_reason) {
    struct report report;
    struct page page;
    prepare(&report);
    make_page(&report, &page);
    HAS(page.text, "<section id=\"stable\">", "</section>",
        "Not in this report: ", "left out for want of time.");
    HAS(page.text, "<ol", "<nav>", "What was not tried", "<a href=\"#horizon\">");
    report.parts[1].included = 0;
    snprintf(report.parts[1].note, REASON_SIZE, "failed: disk & all");
    make_page(&report, &page);
    read_page(&page);
    HAS(page.text, "<section id=\"accuracy\">", "</section>",
        "Not in this report: ", "failed: disk &amp; all.");
    cr_assert(strstr(page.text, "No experiment of this report answers it."));
}

/* --- what must not be shown --- */

static void must_fail(const struct report *report, int code, const char *const *says) {
    char reason[REASON_SIZE];
    cr_assert_eq(report_write(report, reason), code);
    for (int i = 0; says[i]; i++)
        cr_assert(strstr(reason, says[i]), "'%s' does not say %s", reason, says[i]);
    cr_assert(!file_exists(printed("%s/report.html", report->root)) &&
                  count_files(report->root, ".part") == 0,
              "half a report is there");
}

/* The page of circle with that table in its folder. */
static void table_must_fail(const char *name, const char *text, const char *const *says) {
    struct report report;
    prepare(&report);
    file_write(printed("%s/circle", report.root), name, text);
    must_fail(&report, 1, says);
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
    prepare(&report);
    const char *const folder = printed("%s/circle", report.root);
    file_write(folder, "orbits-30s.svg", "<svg width=\"1\"><g>");
    must_fail(&report, -1, (const char *const[]){"orbits-30s.svg", "not a whole picture", NULL});
    char ladder[PATH_SIZE];
    add_part(&report, "ladder", ladder);
    file_write(ladder, "statements.tsv", STATED);
    report.parts[0].included = 0;
    must_fail(&report, -1, (const char *const[]){"ladder", "no figure", NULL});
}

/* A picture of which nothing is stated says nothing. */
Test(report, a_figure_without_a_statement_is_a_failure) {
    struct report report;
    prepare(&report);
    file_write(printed("%s/circle", report.root), "error-time.svg", picture);
    must_fail(&report, -1, (const char *const[]){"error-time.svg", "nothing is stated", NULL});
}

/* Figures and tables of an earlier report in the same folder are not this one's. */
Test(report, older_files_are_not_shown) {
    struct report report;
    struct page page;
    prepare(&report);
    const char *const path =
        file_write(printed("%s/circle", report.root), "error-time.svg", picture);
    SHELL("touch -d @1000 %s", path);
    report.parts[0].since = 2000;
    make_page(&report, &page);
    cr_assert(strstr(page.text, "id=\"circle-orbits-30s\"") &&
              !strstr(page.text, "id=\"circle-error-time\""));
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
    char reason[REASON_SIZE];
    const char *const folder = folder_make();
    for (size_t i = 0; i < sizeof gaps / sizeof *gaps; i++) {
        struct text_table table;
        const char *const path = file_write(folder, "gap.tsv", gaps[i].text);
        cr_assert(text_table_read(&table, path, reason) == 0, "%s", reason);
        cr_assert_eq(text_table_check(&table, path, reason) == 0, gaps[i].good, "table %zu", i);
        text_table_free(&table);
    }
}

Test(report, tables_that_are_none_are_refused_in_one_line) {
    static const char *const texts[] = {"", "# only a comment\n", "a\tb\n1\n"};
    char reason[REASON_SIZE];
    struct text_table table;
    const char *const folder = folder_make();
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        cr_assert(text_table_read(&table, file_write(folder, "none.tsv", texts[i]), reason) == -1 &&
                      strstr(reason, "none.tsv"),
                  "text %zu", i);
    }
    cr_assert(text_table_read(&table, printed("%s/nowhere.tsv", folder), reason) == -1 &&
              strstr(reason, "cannot be read"));
}

/* --- the command --- */

/* Where a part begins on the page. */
static const char *part_at(const struct page *page, const struct experiment *experiment) {
    return strstr(page->text, printed("id=\"%s\">", experiment->name));
}

/* Every experiment has a place of its own, from 1 on; of those of a chapter that are there, the
 * page has them in this order. */
static void parts_must_be_in_place(const struct page *page) {
    int count = 0;
    while (experiments[count])
        count++;
    for (int i = 0; i < count; i++) {
        const struct experiment *e = experiments[i];
        cr_assert(part_at(page, e), "%s is not there", e->name);
        cr_assert(e->place >= 1 && e->place <= count, "%s has place %d", e->name, e->place);
        for (int k = 0; k < i; k++) {
            const struct experiment *other = experiments[k];
            cr_assert(other->place != e->place, "two have place %d", e->place);
            const char *here = part_at(page, e), *there = part_at(page, other);
            const int both = strncmp(here - 13, "class=\"part\"", 12) == 0 &&
                             strncmp(there - 13, "class=\"part\"", 12) == 0;
            if (both && other->chapter == e->chapter)
                cr_assert((here < there) == (e->place < other->place), "%s and %s", e->name,
                          other->name);
        }
    }
}

/* Runs that get no time fail, and with them what compares with their best: that is a report too. */
Test(report, slow_failures_are_reported_as_results) {
    struct page page = {.id_count = 0};
    const char *const folder = folder_make();
    WORKS("report", "--quick", "--time-limit", "0.003", "--no-progress", "--out", folder);
    const char *path = printed("%s/report.html", folder);
    page.text = file_read(path);
    cr_assert(page.text);
    read_page(&page);
    cr_assert(page.figures > 0 && page.figures == page.captions);
    cr_assert(strstr(page.text, "failed: no reference run reached its end"));
    cr_assert(strstr(page.text, "left out of --quick"));
    cr_assert(strstr(page.text, "out of time"));
    HAS(page.text, "<section id=\"machine\">", "</section>",
        "<td>command</td><td>wisplab report --quick --time-limit 0.003</td>", "<td>its clock</td>",
        "<td>date</td>");
    HAS(page.text, "id=\"methods\"", "</table>", "<td class=\"name\">symplectic-euler</td>",
        "<td>rk4</td>");
    parts_must_be_in_place(&page);
    for (int i = 0; experiments[i]; i++) {
        path = printed("%s/%s/statements.tsv", folder, experiments[i]->name);
        if (!file_exists(path))
            continue;
        *strrchr(path, '/') = '\0';
        statements_must_be_whole(path);
    }
}

/* Each point of a chart, here two of each run, says its row and leads to the run's record. */
Test(report, slow_points_of_a_chart_tell_their_runs) {
    struct text_table rows;
    const char *const folder = folder_make();
    WORKS("experiment", "work-precision", "--quick", "--scene", "swing", "--stepper", "rk4",
          "--no-progress", "--out", folder);
    table_must_be_read(&rows, folder, "work-precision/swing");
    const char *path, *const drawn = file_of(folder, "work-precision/swing.svg");
    int shown = 0, failed = 0;
    for (int row = 0; row < rows.row_count; row++) {
        const char *status = text_table_cell(&rows, row, "status"),
                   *run = text_table_cell(&rows, row, "run");
        if (strcmp(status, "finished") != 0 && strcmp(status, "diverged") != 0)
            continue;
        const char *const link =
            printed("<a xlink:href=\"../runs/%s/run.json\"><title>rk4\ntreatment generalised\n"
                    "setting ",
                    run);
        cr_assert_eq(count_of(drawn, link), 2, "%s", link);
        path = printed("%s/runs/%s/run.json", folder, run);
        cr_assert(file_exists(path), "%s", path);
        shown++;
        failed += strcmp(status, "diverged") == 0;
    }
    cr_assert(shown > failed && failed > 0, "%d, of which %d failed", shown, failed);
    cr_assert_eq(count_of(drawn, "<title>rk4\n"), 2 * shown);
    cr_assert_eq(count_of(drawn, "\nstatus diverged\n"), 2 * failed);
}

/* Ctrl-C ends the report, not one experiment of it. */
Test(report, an_interrupted_report_ends) {
    const char *const folder = folder_make();
    const char *const words[] = {"report", "--quick", "--no-progress", "--out", folder, NULL};
    const struct process process = program_start(NULL, words);
    const char *path = printed("%s/runs", folder);
    for (int i = 0; i < 2000 && !file_exists(path); i++) /* until it is at its runs */
        wait_for(5e-3);
    kill(process.pid, SIGINT);
    struct finished *f = program_wait(&process);
    must_have_failed(f, 3, "interrupted");
    path = printed("%s/report.html", folder);
    cr_assert(!file_exists(path));
}
