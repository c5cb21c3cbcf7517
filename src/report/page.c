#include "page.h"

#include "experiments/common/statements.h"

#include <string.h>
#include <sys/stat.h>

int page_read_statements(struct page *page) {
    const struct report *report = page->report;
    int code = 0;
    for (int i = 0; i < report->part_count && !code; i++) {
        char folder[PATH_SIZE];
        path_format(folder, "%s/%s", report->root, report->parts[i].experiment->name);
        if (report->parts[i].included)
            code = statements_read(&page->statements[i], folder, page->reason);
    }
    return code;
}

void page_free(struct page *page) {
    for (int i = 0; i < REPORT_PARTS_MAX; i++)
        text_table_free(&page->statements[i]);
}

struct page_part page_part(const struct page *page, int i) {
    const struct report_part *part = &page->report->parts[i];
    return (struct page_part){page->stream, page->report,           page->reason,
                              part,         part->experiment->name, &page->statements[i]};
}

int page_find(const struct page *page, const char *experiment, struct page_part *part) {
    for (int i = 0; i < page->report->part_count; i++) {
        *part = page_part(page, i);
        if (part->part->included && strcmp(part->name, experiment) == 0)
            return 1;
    }
    return 0;
}

void page_files(const struct page_part *part, const char *kind, glob_t *found) {
    char folder[PATH_SIZE], pattern[16];
    path_format(folder, "%s/%s", part->report->root, part->name);
    snprintf(pattern, sizeof pattern, "*.%s", kind);
    files_like(folder, pattern, found);
}

int page_file(const struct page_part *part, const char *name, const char *kind,
              char path[PATH_SIZE]) {
    struct stat status;
    return path_format(path, "%s/%s/%s.%s", part->report->root, part->name, name, kind) == 0 &&
           stat(path, &status) == 0 &&
           (double)status.st_mtim.tv_sec + 1e-9 * (double)status.st_mtim.tv_nsec >=
               part->part->since;
}
