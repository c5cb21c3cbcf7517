/* Figures as a journal prints them: a column or a page wide, without titles, letters of 7 to 8
 * points. */
#ifndef WISPLAB_PAPER_H
#define WISPLAB_PAPER_H

#include "base/files.h"

struct paper_request {
    const char *name;   /* the experiment's; its script is plots/NAME.gp */
    const char *folder; /* of its tables */
    int is_column;      /* 86 mm wide, and not 178 */
    const char *format; /* "pdf", "svg" or "png"; NULL: each of them */
    const char *figure; /* the only one that is wanted; NULL: all */
    const int *panels;  /* those that are wanted, numbered from 1 as they are drawn; NULL: all */
    int panel_count;
    const char *const *methods; /* those that are wanted; NULL: all */
    int method_count;
};

/* Draws into the folder `to` figure-column.pdf or figure-page.pdf and so on, all together or none.
 * Returns 0 or the exit code, with one line in `reason` (REASON_SIZE). */
int paper_draw(const struct paper_request *request, const char *to, char *reason);

#endif
