/* The page while it is written, by the files of this folder. */
#ifndef WISPLAB_REPORT_PAGE_H
#define WISPLAB_REPORT_PAGE_H

#include "base/text_table.h"
#include "report.h"

struct page {
    FILE *stream;
    const struct report *report;
    char *reason; /* REASON_SIZE: why a function has failed that says so */
    struct text_table statements[REPORT_PARTS_MAX]; /* of the parts that are included */
};

/* A part of the page and where it is written. */
struct page_part {
    FILE *stream;
    const struct report *report;
    char *reason;
    const struct report_part *part;
    const char *name;              /* the experiment's */
    const struct text_table *rows; /* its statements */
};

/* Reads the statements of all parts that are included. Returns 0, or -1 with a reason; to be freed
 * either way. */
int page_read_statements(struct page *page);
void page_free(struct page *page);

/* Part i; and that of an experiment, by its name: returns whether it is included. */
struct page_part page_part(const struct page *page, int i);
int page_find(const struct page *page, const char *experiment, struct page_part *part);

/* The files of a kind in the part's folder, "svg" or "tsv", in the order of their names; globfree
 * it. */
void page_files(const struct page_part *part, const char *kind, glob_t *found);

/* The path of one of them; returns whether it is there, and of this report. */
int page_file(const struct page_part *part, const char *name, const char *kind,
              char path[PATH_SIZE]);

#endif
