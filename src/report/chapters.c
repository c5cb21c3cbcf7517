#include "chapters.h"

#include "answers.h"
#include "base/files.h"
#include "html.h"
#include "part.h"

#include <string.h>

/* What is shown of an experiment without a fold: a figure, and some columns of a table or NULL. */
struct lead {
    const char *experiment, *figure, *table;
    const struct html_column *columns;
};

/* On the first screen, beside each other. */
static const struct lead front[] = {{.experiment = "ladder", .figure = "ladder"},
                                    {.experiment = "wind", .figure = "film"}};
enum { FRONT = sizeof front / sizeof *front };

/* And at the head of each chapter. */
static const struct lead leads[CHAPTER_COUNT] = {
    [CHAPTER_ACCURACY] = {"work-precision", "swing", "swing-cheapest",
                          (const struct html_column[]){{"target", "within (mm)", 1e3},
                                                       {"method", "the cheapest is", 0},
                                                       {"setting", "step (s) or rtol", 0},
                                                       {"error", "its error (mm)", 1e3},
                                                       {"cpu_median", "CPU time (ms)", 1e3},
                                                       {"next_method", "next is", 0},
                                                       {"next_cpu_median", "CPU time (ms)", 1e3},
                                                       {0}}},
    [CHAPTER_STABILITY] = {"stability", "limits", "largest-step",
                           (const struct html_column[]){{"scene", "scene", 0},
                                                        {"treatment", "treatment", 0},
                                                        {"stepper", "method", 0},
                                                        {"step", "longest step (ms)", 1e3},
                                                        {"kind", "the next longer one", 0},
                                                        {"time", "fails at (s)", 0},
                                                        {"mm_step", "longest for 1 mm (ms)", 1e3},
                                                        {0}}},
    [CHAPTER_MODEL] = {"needs", "swing-envelope", "smallest",
                       (const struct html_column[]){{"scene", "scene", 0},
                                                    {"nodes", "nodes", 0},
                                                    {"envelope", "envelope", 0},
                                                    {"bending law", "bending", 0},
                                                    {"stretching", "segments", 0},
                                                    {"treatment", "treatment", 0},
                                                    {"change_rms", "off the full model (mm)", 1e3},
                                                    {"cost_ratio", "CPU time over its", 0},
                                                    {0}}},
    [CHAPTER_THESIS] = {"chapter5", "figures", NULL, NULL},
};

static const struct {
    const char *anchor, *title, *about;
} chapters[CHAPTER_COUNT] = {
#define X(symbol, anchor, title, about) [symbol] = {anchor, title, about},
    CHAPTERS(X)
#undef X
};

/* The question that each chapter answers. */
static const enum question questions[CHAPTER_COUNT] = {[CHAPTER_ACCURACY] = ANSWERS_TARGETS,
                                                       [CHAPTER_STABILITY] = ANSWERS_FAILURES,
                                                       [CHAPTER_MODEL] = ANSWERS_NEEDS,
                                                       [CHAPTER_THESIS] = ANSWERS_CHOICE};

void chapters_write_links(FILE *stream) {
    for (int c = 0; c < CHAPTER_COUNT; c++) {
        fprintf(stream, " · <a href=\"#%s\">", chapters[c].anchor);
        html_text(stream, chapters[c].title);
        fputs("</a>", stream);
    }
}

static int write_lead_table(const struct page_part *part, const struct lead *lead) {
    struct text_table table;
    char path[PATH_SIZE];
    path_format(path, "%s/%s/%s.tsv", part->report->root, lead->experiment, lead->table);
    if (!file_exists(path))
        return 0; /* the user's own scenes have tables of other names */
    if (text_table_read(&table, path, part->reason))
        return -1;
    html_table(part->stream, &table, lead->columns);
    fprintf(part->stream,
            "<details class=\"small\"><summary>From <a href=\"%s/%s.tsv\">%s.tsv</a></summary>\n",
            lead->experiment, lead->table, lead->table);
    html_element(part->stream, "p", table.about, "</details>\n");
    text_table_free(&table);
    return 0;
}

static int write_lead(const struct page *page, const struct lead *lead) {
    struct page_part part;
    if (!page_find(page, lead->experiment, &part))
        return 0;
    const int code = part_write_lead(&part, lead->figure);
    return code || !lead->table ? code : write_lead_table(&part, lead);
}

int chapters_write_front(const struct page *page) {
    int code = 0;
    fputs("<div class=\"first\">\n", page->stream);
    for (int i = 0; i < FRONT && !code; i++)
        code = write_lead(page, &front[i]);
    fputs("</div>\n", page->stream);
    return code;
}

/* The figure of an experiment that is shown outside of its fold, or NULL. */
static const char *shown_outside(const char *experiment) {
    for (int i = 0; i < FRONT; i++)
        if (strcmp(front[i].experiment, experiment) == 0)
            return front[i].figure;
    for (int c = 0; c < CHAPTER_COUNT; c++)
        if (strcmp(leads[c].experiment, experiment) == 0)
            return leads[c].figure;
    return NULL;
}

/* Whether a part is of a chapter, in the report or not. */
static int is_of(const struct page_part *part, enum chapter chapter, int included) {
    return part->part->experiment->chapter == chapter && part->part->included == included;
}

/* The thesis's claims that the chapter's experiments are about, one of each. */
static void write_claims(const struct page *page, enum chapter chapter) {
    int count = 0;
    for (int i = 0; i < page->report->part_count; i++) {
        const struct page_part part = page_part(page, i);
        if (is_of(&part, chapter, 1))
            count += part_write_claim(&part, count == 0);
    }
    if (count > 0)
        html_claims_end(page->stream);
}

/* What is not there, with its question and why, in one paragraph. */
static void write_missing(const struct page *page, enum chapter chapter) {
    FILE *stream = page->stream;
    int count = 0;
    for (int i = 0; i < page->report->part_count; i++) {
        const struct page_part part = page_part(page, i);
        char title[256];
        if (!is_of(&part, chapter, 0))
            continue;
        experiment_title(part.part->experiment, title);
        fputs(count++ ? "" : "<p class=\"small\">Not in this report: ", stream);
        fprintf(stream, "<span id=\"%s\"><b>%s</b> ", part.name, part.name);
        html_print(stream, "(%s), %s. ", title, part.part->note);
        fputs("</span>", stream);
    }
    fputs(count ? "</p>\n" : "", stream);
}

static int write_chapter(const struct page *page, enum chapter chapter) {
    fprintf(page->stream, "<section id=\"%s\">", chapters[chapter].anchor);
    html_element(page->stream, "h2", chapters[chapter].title, "\n");
    html_element(page->stream, "p", chapters[chapter].about, "\n");
    answers_write(page, questions[chapter]);
    int code = write_lead(page, &leads[chapter]);
    if (!code)
        write_claims(page, chapter);
    for (int i = 0; i < page->report->part_count && !code; i++) {
        const struct page_part part = page_part(page, i);
        if (is_of(&part, chapter, 1))
            code = part_write(&part, shown_outside(part.name));
    }
    write_missing(page, chapter);
    fputs("</section>\n", page->stream);
    return code;
}

int chapters_write(const struct page *page) {
    int code = 0;
    for (int c = 0; c < CHAPTER_COUNT && !code; c++)
        code = write_chapter(page, (enum chapter)c);
    return code;
}
