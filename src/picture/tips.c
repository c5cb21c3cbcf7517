#include "tips.h"

#include "base/files.h"
#include "base/memory.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* As gnuplot 5.4 writes it: in a group for its colours one with two handlers, an empty title, and
 * the point, of no colour. */
static const char begins[] = "<g onmousemove=\"gnuplot_svg.showHypertext(evt,'",
                  ends[] = "')\" onmouseout=\"gnuplot_svg.hideHypertext()\"><title> </title>",
                  closes[] = "</g>", place_mark[] = "translate(", size_mark[] = "scale(";

/* One of them, in the text. */
struct tip {
    const char *from, *to;           /* of all of it, its own group for colours included */
    const char *folder, *text, *end; /* the run's, up to the text or NULL; up to the end */
    const char *point;
};

static const char *skip_blanks(const char *at) {
    return at + strspn(at, " \t\r\n");
}

/* The start of the group that has the tip alone, or the tip's own. */
static const char *group_before(const char *svg, const char *tip) {
    const char *at = tip;
    while (at > svg && strchr(" \t\r\n", at[-1]))
        at--;
    if (at == svg || at[-1] != '>')
        return tip;
    while (at > svg && *at != '<')
        at--;
    return strncmp(at, "<g ", 3) == 0 ? at : tip;
}

/* The next one; returns whether there is one. */
static int find_tip(const char *svg, struct tip *tip) {
    const char *own = strstr(svg, begins);
    if (!own || !(tip->end = strstr(own, ends)))
        return 0;
    const char *close = strstr(tip->end, closes);
    if (!close)
        return 0;
    tip->folder = NULL;
    tip->text = own + strlen(begins);
    const char *line = strstr(tip->text, "\\n"); /* two letters */
    if (line && line < tip->end) {
        tip->folder = *tip->text == '-' ? NULL : tip->text;
        tip->text = line + 2;
    }
    tip->point = tip->end + strlen(ends);
    tip->to = close + strlen(closes);
    tip->from = group_before(svg, own);
    if (tip->from < own && strncmp(skip_blanks(tip->to), closes, strlen(closes)) == 0)
        tip->to = skip_blanks(tip->to) + strlen(closes);
    else
        tip->from = own;
    return 1;
}

/* A ring that is not drawn, where the point is and of its size. */
static void write_ring(FILE *stream, const struct tip *tip) {
    const char *at = strstr(tip->point, place_mark), *scale = strstr(tip->point, size_mark);
    double x = 0, y = 0;
    if (!at || !scale || at > tip->to || scale > tip->to ||
        sscanf(at + strlen(place_mark), "%lf,%lf", &x, &y) != 2)
        return;
    fprintf(stream, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\" fill-opacity=\"0\"/>", x, y,
            strtod(scale + strlen(size_mark), NULL));
}

static void write_tip(FILE *stream, const struct tip *tip) {
    if (tip->folder)
        fprintf(stream, "<a xlink:href=\"../runs/%.*s/run.json\"><title>",
                (int)(tip->text - 2 - tip->folder), tip->folder);
    else
        fputs("<g class=\"tip\"><title>", stream);
    for (const char *at = tip->text; at < tip->end; at++) {
        const int is_end = strncmp(at, "\\n", 2) == 0;
        fputc(is_end ? '\n' : *at, stream);
        at += is_end;
    }
    fputs("</title>", stream);
    write_ring(stream, tip);
    fputs(tip->folder ? "</a>" : "</g>", stream);
}

char *tips_text(const char *svg) {
    char *text = NULL;
    size_t length;
    struct tip tip;
    FILE *stream = memory_needed(open_memstream(&text, &length));
    for (; find_tip(svg, &tip); svg = tip.to) {
        fwrite(svg, 1, (size_t)(tip.from - svg), stream);
        write_tip(stream, &tip);
    }
    fputs(svg, stream);
    fclose(stream);
    return memory_needed(text);
}

int tips_make(const char *path, char *reason) {
    char *svg = file_text(path);
    struct atomic_file out;
    if (!svg)
        return fail_with(reason, "%.150s: cannot be read: %s", path, strerror(errno));
    char *text = tips_text(svg);
    int code = atomic_open(&out, path, reason);
    if (!code) {
        fputs(text, out.stream);
        code = atomic_commit(&out, reason);
    }
    free(svg);
    free(text);
    return code;
}
