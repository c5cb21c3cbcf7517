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

/* Which questions a chapter answers, bit k for question k. */
static unsigned questions_of(enum chapter chapter) {
    static const unsigned questions[CHAPTER_COUNT] = {
        [CHAPTER_ACCURACY] = 1 << ANSWERS_TARGETS,
        [CHAPTER_STABILITY] = 1 << ANSWERS_FAILURES,
        [CHAPTER_MODEL] = 1 << ANSWERS_NEEDS,
        [CHAPTER_THESIS] = 1 << ANSWERS_CHOICE,
    };
    return questions[chapter];
}

const struct report_part *report_part_of(const struct report *report, const char *experiment) {
    for (int i = 0; i < report->part_count; i++)
        if (report->parts[i].included && strcmp(report->parts[i].experiment->name, experiment) == 0)
            return &report->parts[i];
    return NULL;
}

void chapters_write_links(FILE *stream) {
    for (int c = 0; c < CHAPTER_COUNT; c++) {
        fprintf(stream, " · <a href=\"#%s\">", chapters[c].anchor);
        html_text(stream, chapters[c].title);
        fputs("</a>", stream);
    }
}

static int write_lead_table(FILE *stream, const struct report *report, const struct lead *lead,
                            char *reason) {
    struct text_table table;
    char path[PATH_SIZE];
    if (path_format(path, "%s/%s/%s.tsv", report->root, lead->experiment, lead->table) ||
        !file_exists(path))
        return 0; /* the user's own scenes have tables of other names */
    if (text_table_read(&table, path, reason))
        return -1;
    html_table(stream, &table, lead->columns);
    fprintf(
        stream,
        "<details class=\"small\"><summary>From <a href=\"%s/%s.tsv\">%s.tsv</a></summary>\n<p>",
        lead->experiment, lead->table, lead->table);
    html_text(stream, table.about);
    fputs("</p></details>\n", stream);
    text_table_free(&table);
    return 0;
}

static int write_lead(FILE *stream, const struct report *report, const struct lead *lead,
                      char *reason) {
    const struct report_part *part = report_part_of(report, lead->experiment);
    if (!part)
        return 0;
    if (part_write_lead(stream, report, part, lead->figure, reason) < 0)
        return -1;
    return lead->table ? write_lead_table(stream, report, lead, reason) : 0;
}

int chapters_write_front(FILE *stream, const struct report *report, char *reason) {
    int code = 0;
    fputs("<div class=\"first\">\n", stream);
    for (int i = 0; i < FRONT && !code; i++)
        code = write_lead(stream, report, &front[i], reason);
    fputs("</div>\n", stream);
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

/* The thesis's claims that the chapter's experiments are about, one of each. */
static int write_claims(FILE *stream, const struct report *report, enum chapter chapter,
                        char *reason) {
    int count = 0;
    for (int i = 0; i < report->part_count; i++) {
        const struct report_part *part = &report->parts[i];
        if (!part->included || part->experiment->chapter != chapter)
            continue;
        const int written = part_write_claim(stream, report, part, count == 0, reason);
        if (written < 0)
            return -1;
        count += written;
    }
    if (count > 0)
        html_claims_end(stream);
    return 0;
}

/* What is not there, with its question and why, in one paragraph. */
static void write_missing(FILE *stream, const struct report *report, enum chapter chapter) {
    int count = 0;
    for (int i = 0; i < report->part_count; i++) {
        const struct report_part *part = &report->parts[i];
        char title[256];
        if (part->included || part->experiment->chapter != chapter)
            continue;
        experiment_title(part->experiment, title);
        fputs(count++ ? "" : "<p class=\"small\">Not in this report: ", stream);
        fprintf(stream, "<span id=\"%s\"><b>%s</b> ", part->experiment->name,
                part->experiment->name);
        html_print(stream, "(%s), %s. ", title, part->note);
        fputs("</span>", stream);
    }
    fputs(count ? "</p>\n" : "", stream);
}

static int write_chapter(FILE *stream, const struct report *report, enum chapter chapter,
                         char *reason) {
    fprintf(stream, "<section id=\"%s\"><h2>", chapters[chapter].anchor);
    html_text(stream, chapters[chapter].title);
    fputs("</h2>\n<p>", stream);
    html_text(stream, chapters[chapter].about);
    fputs("</p>\n", stream);
    int code = answers_write(stream, report, questions_of(chapter), reason);
    if (!code)
        code = write_lead(stream, report, &leads[chapter], reason);
    if (!code)
        code = write_claims(stream, report, chapter, reason);
    for (int i = 0; i < report->part_count && !code; i++) {
        const struct report_part *part = &report->parts[i];
        if (!part->included || part->experiment->chapter != chapter)
            continue;
        code = part_write(stream, report, part, shown_outside(part->experiment->name), reason);
    }
    write_missing(stream, report, chapter);
    fputs("</section>\n", stream);
    return code;
}

int chapters_write(FILE *stream, const struct report *report, char *reason) {
    int code = 0;
    for (int c = 0; c < CHAPTER_COUNT && !code; c++)
        code = write_chapter(stream, report, (enum chapter)c, reason);
    return code;
}
