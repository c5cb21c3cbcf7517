#include "paper.h"

#include "base/text_table.h"
#include "plot.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/param.h>
#include <unistd.h>

/* Lengths are in units of 7/11 pt (plots/style.gp), which are the pixels of the screen's figure. */
static const double unit = 7 / 11. / 72 * 25.4; /* mm */

/* --- what a script would draw --- */

struct box {
    double left, top, width, height;
};

struct item {
    struct box screen, paper; /* on paper without width: left out */
    double least;             /* part of its width that will do, with its shape kept; 0: usual */
    double margin;            /* for an axis' words at the left of the first of a row */
    int is_legend, names, longest; /* of a legend: how many, and of how many letters */
    int rows;
    int first, last; /* of its row, of its column: has the axes' words there */
};

struct figure {
    char name[200];
    double width, height;
    struct item *item;
    int count;
};

struct figures {
    struct figure *figure;
    int count, failed;
};

static void free_figures(struct figures *figures) {
    for (int i = 0; i < figures->count; i++)
        free(figures->figure[i].item);
    free(figures->figure);
}

static struct figure *add_figure(struct figures *figures) {
    struct figure *all =
        realloc(figures->figure, ((size_t)figures->count + 1) * sizeof *figures->figure);
    if (!all) {
        figures->failed = 1;
        return NULL;
    }
    figures->figure = all;
    all[figures->count] = (struct figure){.count = 0};
    return &all[figures->count++];
}

static void add_item(struct figures *figures, const struct item *item) {
    struct figure *figure = figures->count > 0 ? &figures->figure[figures->count - 1] : NULL;
    struct item *all =
        figure ? realloc(figure->item, ((size_t)figure->count + 1) * sizeof *all) : NULL;
    if (!all) {
        figures->failed = 1;
        return;
    }
    figure->item = all;
    all[figure->count++] = *item;
}

/* A line of the survey, as plots/style.gp prints them. */
static void read_line(struct figures *figures, const char *line) {
    struct figure one;
    struct item item = {.rows = 0};
    struct box *box = &item.screen;
    if (sscanf(line, "figure %lf %lf %199[^\n]", &one.width, &one.height, one.name) == 3) {
        struct figure *figure = add_figure(figures);
        if (figure) {
            figure->width = one.width;
            figure->height = one.height;
            memcpy(figure->name, one.name, sizeof one.name);
        }
    } else if (sscanf(line, "panel %lf %lf %lf %lf %lf", &box->left, &box->top, &box->width,
                      &box->height, &item.least) == 5) {
        add_item(figures, &item);
    } else if (sscanf(line, "legend %lf %lf %lf %lf %*d %d %d", &box->left, &box->top, &box->width,
                      &box->height, &item.names, &item.longest) >= 4) {
        item.is_legend = 1;
        add_item(figures, &item);
    }
}

/* Letters of a name in a legend, and whose it is: the survey's are BAND units below each other. */
static void read_name(struct figure *figure, double y, const char *name) {
    enum { BAND = 1500 };
    const int number = (int)(y / BAND) - 1;
    int letters = 0;
    for (const char *at = name; *at && *at != '<' && *at != '\n'; at++)
        letters += (*at & 0xC0) != 0x80;
    if (number < 0 || number >= figure->count || letters == 0)
        return;
    figure->item[number].names++;
    figure->item[number].longest = MAX(figure->item[number].longest, letters);
}

/* What gnuplot has drawn of a figure's legends: a line with a place, and one with a name. */
static void read_legends(struct figure *figure, const char *drawing) {
    char path[PATH_SIZE], line[1024];
    double x, y = 0;
    path_format(path, "%s/%s.svg", drawing, figure->name);
    FILE *file = fopen(path, "r");
    while (file && fgets(line, sizeof line, file)) {
        const char *place = strstr(line, "translate("), *name = strstr(line, "<text>");
        if (place)
            sscanf(place, "translate(%lf,%lf)", &x, &y);
        if (name)
            read_name(figure, y, name + strlen("<text>"));
    }
    if (file)
        fclose(file);
}

/* --- where it is on paper --- */

enum { BELOW = 46, LINE = 17, RIGHT = 14, TITLES = 52, PANELS_MAX = 15 };
enum { NAMES = 150 }; /* a margin as wide as this has names in it, and not numbers */

static int count_panels(const struct figure *figure) {
    int count = 0;
    for (int i = 0; i < figure->count; i++)
        count += !figure->item[i].is_legend;
    return count;
}

/* The panels of a figure that are wanted, in the order of drawing. */
static int choose(struct figure *figure, const struct paper_request *request,
                  struct item **chosen) {
    int panels = 0, count = 0;
    for (int i = 0; i < figure->count; i++) {
        struct item *item = &figure->item[i];
        int wanted = request->panel_count == 0;
        if (item->is_legend)
            continue;
        panels++;
        for (int k = 0; k < request->panel_count; k++)
            wanted |= request->panels[k] == panels;
        if (wanted)
            chosen[count++] = item;
    }
    return count;
}

/* How many of them, from the first on, are side by side on the screen, or are of one size. */
static int side_by_side(struct item *const *panel, int count) {
    int n = 1;
    while (n < count && n < PANELS_MAX && fabs(panel[n]->screen.top - panel[0]->screen.top) < 5 &&
           panel[n]->screen.left > panel[n - 1]->screen.left)
        n++;
    return n;
}

static int alike(struct item *const *panel, int count) {
    int n = 1;
    while (n < count && fabs(panel[n]->screen.width - panel[0]->screen.width) < 1 &&
           fabs(panel[n]->screen.height - panel[0]->screen.height) < 1)
        n++;
    return n;
}

static double end_of(const struct box *box) {
    return box->left + box->width;
}

/* What is between two panels that are side by side on the screen; 0 if they are not. */
static double between(const struct item *before, const struct item *panel) {
    const struct box *here = &panel->screen;
    return fabs(here->top - before->screen.top) < 5 ? fmax(0, here->left - end_of(&before->screen))
                                                    : 0;
}

/* The first of a row has its axis' words between it and the edge; others have less room, as theirs
 * are its, or more where they have words of their own. */
static void find_margins(struct figure *figure) {
    const struct item *before = NULL;
    double first = 0;
    for (int i = 0; i < figure->count; i++) {
        struct item *item = &figure->item[i];
        if (item->is_legend)
            continue;
        const double free = before ? between(before, item) : 0;
        first = free > 0 ? first : item->screen.left;
        item->margin = fmax(first, free < 250 ? free : 0);
        before = item;
    }
}

/* Room above a row for what stands over its panels; on the screen `end` is where the row before
 * ends, 0 where there is none but the titles. */
static double room_above(const struct item *panel, double end) {
    return fmin(84, fmax(14, panel->screen.top - (end > 0 ? end + BELOW : TITLES)));
}

/* A chart of names has them at its left, and a line for each: it keeps its height. Others keep
 * their shape, as far as their letters have room, and become no higher. */
static double height_on_paper(const struct item *panel, double left, double width) {
    const double scale = width / panel->screen.width, least = panel->least > 0 ? scale : 0.85;
    return panel->screen.height * (left >= NAMES ? 0.92 : fmin(1, fmax(scale, least)));
}

/* A row of panels on paper. */
struct row {
    struct item **panel;
    int count, places;       /* places for panels like the first: as many, or more */
    double left, top, right; /* of the first; from the edges of the paper */
    double apart;            /* its panels; 0: as they are on the screen */
};

/* Lays it out; returns its height. */
static double lay_row(const struct row *row, double paper_width) {
    double gap[PANELS_MAX] = {0}, gaps = 0, widths = 0, high = 0, at = row->left;
    for (int i = 0; i < row->count; i++) {
        const double apart =
            i == 0 || row->apart > 0 ? row->apart : between(row->panel[i - 1], row->panel[i]);
        gap[i] = i == 0 ? 0 : apart > 0 && apart < 250 ? apart : 40;
        gaps += gap[i];
        widths += row->panel[i]->screen.width;
    }
    gaps += (row->places - row->count) * (row->count > 1 ? gap[1] : 40);
    widths += (row->places - row->count) * row->panel[0]->screen.width;
    const double scale = (paper_width - row->left - row->right - gaps) / widths;
    for (int i = 0; i < row->count; i++) {
        struct item *item = row->panel[i];
        const double width = scale * item->screen.width;
        at += gap[i];
        item->paper = (struct box){at, row->top, width, height_on_paper(item, row->left, width)};
        item->first = i == 0;
        item->last = 1;
        at += width;
        high = fmax(high, item->paper.height);
    }
    return high;
}

/* Panels are at least this wide, as a part of their width on the screen: what is written into them
 * needs that, and more where there is nothing beside them. */
static double narrowest(const struct paper_request *request) {
    return request->is_column ? 0.67 : 0.55;
}

/* Lays out the panels; returns where they end. If those of a row have no room side by side, they
 * and the following that are like them are put into shorter rows. No row begins left of `edge`,
 * which becomes the edge of that with the widest numbers. */
static double lay_panels(const struct figure *figure, const struct paper_request *request,
                         struct item **panel, int count, double width, double *edge) {
    double at = 0, end = 0, like = 0; /* of the row before: its end and its panels on the screen */
    int before = 0;
    for (int i = 0; i < count;) {
        const struct box *first = &panel[i]->screen;
        const int own = side_by_side(panel + i, count - i);
        const double room = width - panel[i]->margin - RIGHT,
                     all = end_of(&panel[i + own - 1]->screen) - first->left,
                     least = panel[i]->least > 0 ? panel[i]->least : 0.67;
        const int most = room >= narrowest(request) * all
                             ? own
                             : MAX(1, MIN(own, (int)(room / (least * first->width))));
        const int here = most < own ? MAX(own, alike(panel + i, count - i)) : own;
        const double above = room_above(panel[i], end);
        for (int k = 0; k < here; k += most) {
            struct row row = {
                .panel = panel + i + k, .count = MIN(most, here - k), .top = at + above};
            const double free = figure->width - end_of(&row.panel[row.count - 1]->screen);
            row.right = most < own ? RIGHT : fmin(fmax(free, RIGHT), 30);
            row.apart = most < own ? between(panel[i], panel[i + 1]) : 0;
            row.places = MAX(row.count, k > 0 ? most : first->width == like ? before : 0);
            row.left = fmin(0.62 * width, row.panel[0]->margin);
            if (row.left < NAMES)
                row.left = *edge = fmax(row.left, *edge);
            at += above + BELOW + lay_row(&row, width);
            before = row.places;
        }
        like = first->width;
        end = panel[i + here - 1]->screen.top + panel[i + here - 1]->screen.height;
        i += here;
    }
    return at;
}

/* As many columns as there is room for the longest name beside its mark; a panel's own legend,
 * which has no place on the screen, has only the panel's width. */
static void lay_legend(struct item *item, double width, double top) {
    static const double mark = 62, letter = 8.2; /* as wide as an svg takes them */
    const double room = item->screen.width > 0 ? width : 0.8 * width;
    const int columns = MAX(1, (int)(room / (mark + letter * item->longest)));
    item->rows = MAX(1, (item->names + columns - 1) / columns);
    item->paper = (struct box){0, top, width, LINE * item->rows};
}

/* Lays out a figure, whose height it returns. */
static double lay_out(struct figure *figure, const struct paper_request *request, double width,
                      struct item **chosen) {
    find_margins(figure);
    const int count = choose(figure, request, chosen);
    double edge = 0;
    lay_panels(figure, request, chosen, count, width, &edge); /* the edge is known then */
    double at = lay_panels(figure, request, chosen, count, width, &edge) + 6;
    for (int i = 0; i < figure->count; i++)
        if (figure->item[i].is_legend) {
            lay_legend(&figure->item[i], width, at);
            at += figure->item[i].paper.height + 4;
        }
    return ceil(at);
}

/* --- files for the script --- */

static int cannot_write(const char *path, char *reason) {
    snprintf(reason, REASON_SIZE, "%.150s: cannot write: %s", path, strerror(errno));
    return 2;
}

/* To an open file, which is closed. */
static int close_file(FILE *file, const char *path, char *reason) {
    const int bad = ferror(file);
    return fclose(file) || bad ? cannot_write(path, reason) : 0;
}

static FILE *open_layout(const char *drawing, char *path, char *reason) {
    path_format(path, "%s/paper.gp", drawing);
    FILE *file = fopen(path, "w");
    if (!file)
        cannot_write(path, reason);
    return file;
}

static int write_layout(struct figures *figures, const struct paper_request *request,
                        const char *drawing, char *path, char *reason) {
    const double width = round((request->is_column ? 86 : 178) / unit);
    FILE *file = open_layout(drawing, path, reason);
    if (!file)
        return 2;
    fprintf(file, "PAPER_WIDTH = %.0f; array PAPER_HEIGHTS[%d]; array PAPER_PLACES[%d]\n", width,
            figures->count, figures->count);
    for (int i = 0; i < figures->count; i++) {
        struct figure *figure = &figures->figure[i];
        struct item **chosen = calloc((size_t)figure->count + 1, sizeof *chosen);
        if (!chosen) {
            figures->failed = 1;
            break;
        }
        fprintf(file, "PAPER_HEIGHTS[%d] = %.0f; PAPER_PLACES[%d] = '", i + 1,
                lay_out(figure, request, width, chosen), i + 1);
        for (int k = 0; k < figure->count; k++) {
            const struct item *item = &figure->item[k];
            fprintf(file, "%.6g %.6g %.6g %.6g %d %d ", item->paper.left, item->paper.top,
                    item->paper.width, item->paper.height,
                    item->is_legend ? item->rows : item->first, item->last);
        }
        fputs("'\n", file);
        free(chosen);
    }
    return close_file(file, path, reason);
}

/* What the script would draw on the screen. Returns 0 or the exit code. */
static int survey(struct figures *figures, const char *name, const char *tables,
                  const char *drawing, char *reason) {
    char path[PATH_SIZE], said[PATH_SIZE], line[512];
    FILE *file = open_layout(drawing, path, reason);
    path_format(said, "%s/survey", drawing);
    if (!file)
        return 2;
    fputs("set print out.'/survey'\n", file);
    int code = close_file(file, path, reason);
    if (!code &&
        plot_draw(name, tables, drawing, &(struct plot_paper){"survey", path}, "svg", reason))
        code = 2;
    FILE *lines = code ? NULL : fopen(said, "r");
    while (lines && fgets(line, sizeof line, lines))
        read_line(figures, line);
    if (lines)
        fclose(lines);
    for (int i = 0; i < figures->count && !figures->failed; i++)
        read_legends(&figures->figure[i], drawing);
    if (!code && figures->failed) {
        snprintf(reason, REASON_SIZE, "out of memory");
        code = 2;
    }
    unlink(said);
    return code;
}

/* --- what there is to be chosen from --- */

/* Words with commas between, as many as there is room for. */
struct list {
    char text[240];
    int is_full;
};

static int list_has(const struct list *list, const char *word) {
    const size_t length = strlen(word);
    for (const char *at = list->text; (at = strstr(at, word)) != NULL; at++)
        if ((at == list->text || at[-1] == ' ') && (at[length] == ',' || at[length] == '\0'))
            return 1;
    return 0;
}

static void list_add(struct list *list, const char *word) {
    const size_t end = strlen(list->text);
    if (list->is_full)
        return;
    list->is_full = end + strlen(word) + sizeof ", , ..." > sizeof list->text;
    snprintf(list->text + end, sizeof list->text - end, "%s%s", end > 0 ? ", " : "",
             list->is_full ? "..." : word);
}

/* Whether a cell, which a tab or the line's end may follow, is a method's name or begins with it as
 * a word. */
static int is_of_method(const char *cell, const char *method) {
    const size_t length = strlen(method);
    return (length == strcspn(cell, "\t\n") || length == strcspn(cell, "\t\n ")) &&
           strncmp(cell, method, length) == 0;
}

static int is_named(const struct figure *figure, const struct paper_request *request) {
    return !request->figure || strcmp(request->figure, figure->name) == 0;
}

/* Whether a figure that is wanted has a panel, whose number may be 0 for any; `there` tells what
 * there is. */
static int has_panel(const struct figures *figures, const struct paper_request *request, int panel,
                     struct list *there) {
    int found = 0;
    for (int i = 0; i < figures->count; i++) {
        const struct figure *figure = &figures->figure[i];
        const int panels = count_panels(figure);
        char words[sizeof figure->name + 20];
        if (panel > 0 && !is_named(figure, request))
            continue;
        found |= is_named(figure, request) && panels >= panel;
        snprintf(words, sizeof words, panel > 0 ? "%s has %d" : "%s", figure->name, panels);
        list_add(there, words);
    }
    return found;
}

/* Returns 0, or 1 where a figure or panel is wanted that is not there. */
static int check_wanted(const struct figures *figures, const struct paper_request *request,
                        char *reason) {
    struct list there = {.is_full = 0};
    if (!has_panel(figures, request, 0, &there)) {
        snprintf(reason, REASON_SIZE, "%s has no figure '%.60s'; there are %s", request->name,
                 request->figure ? request->figure : "", there.text);
        return 1;
    }
    for (int i = 0; i < request->panel_count; i++) {
        there = (struct list){.is_full = 0};
        if (has_panel(figures, request, request->panels[i], &there))
            continue;
        snprintf(reason, REASON_SIZE, "--panel %d: no figure has so many panels: %s",
                 request->panels[i], there.text);
        return 1;
    }
    return 0;
}

/* Adds to `there` the methods that a table has rows of, and marks those that are wanted. Returns
 * whether there are any. */
static int note_methods(const char *path, const struct paper_request *request, char *found,
                        struct list *there) {
    struct text_table table;
    char none[REASON_SIZE];
    if (text_table_read(&table, path, none))
        return 0;
    const char *const column = text_table_column(&table, "method") >= 0 ? "method" : "stepper";
    const int any = text_table_column(&table, column) >= 0 && table.row_count > 0;
    for (int row = 0; row < table.row_count && any; row++) {
        const char *name = text_table_cell(&table, row, column);
        for (int i = 0; i < request->method_count; i++)
            if (is_of_method(name, request->methods[i]))
                found[i] = 1;
        if (!list_has(there, name))
            list_add(there, name);
    }
    text_table_free(&table);
    return any;
}

/* Returns 0, or the exit code: 1 where a method is wanted that no table has a row of, or not the
 * table of the wanted figure, where that has methods. */
static int check_methods(const struct paper_request *request, char *reason) {
    struct list there = {.is_full = 0};
    char path[PATH_SIZE], *found = calloc((size_t)request->method_count, 1);
    glob_t tables;
    if (!found || files_like(request->folder, "*.tsv", &tables)) {
        free(found);
        snprintf(reason, REASON_SIZE, "out of memory");
        return 2;
    }
    path_format(path, "%s/%s.tsv", request->folder, request->figure ? request->figure : "");
    const int has_own = request->figure && note_methods(path, request, found, &there);
    for (size_t i = 0; i < tables.gl_pathc && !has_own; i++)
        note_methods(tables.gl_pathv[i], request, found, &there);
    globfree(&tables);
    int first = 0;
    while (first < request->method_count && found[first])
        first++;
    free(found);
    if (first == request->method_count)
        return 0;
    snprintf(reason, REASON_SIZE, "no table of %s%s%.60s has a row of method '%.60s'; there are %s",
             request->name, has_own ? "/" : "", has_own ? request->figure : "",
             request->methods[first], there.text);
    return 1;
}

/* --- chosen methods --- */

/* The column whose rows are of methods, or -1. */
static int method_column(const char *heads) {
    int found = -1, column = 0;
    for (const char *at = heads; at; at = strchr(at, '\t'), column++) {
        at += *at == '\t';
        const size_t length = strcspn(at, "\t\n");
        if (length == 6 && strncmp(at, "method", 6) == 0)
            return column;
        if (length == 7 && strncmp(at, "stepper", 7) == 0 && found < 0)
            found = column;
    }
    return found;
}

/* Whether a row is of one of the chosen methods. */
static int is_chosen(const char *row, int column, const struct paper_request *request) {
    for (; column > 0 && row; column--) {
        row = strchr(row, '\t');
        row += row != NULL;
    }
    for (int i = 0; i < request->method_count && row; i++)
        if (is_of_method(row, request->methods[i]))
            return 1;
    return 0;
}

/* Copies a table with the rows of the chosen methods alone, or all of one that has none. */
static int copy_table(const char *from, const char *to, const struct paper_request *request,
                      char *reason) {
    char *text = file_text(from);
    FILE *file = text ? fopen(to, "w") : NULL;
    int column = -2; /* the heads are to come */
    for (char *line = text; file && line && *line;) {
        char *next = strchr(line, '\n');
        const size_t length = next ? (size_t)(next - line) + 1 : strlen(line);
        int keep = 1;
        if (column == -2 && *line != '#') {
            char *heads = strndup(line, length);
            column = heads ? method_column(heads) : -1;
            free(heads);
        } else if (column >= 0 && *line != '#' && *line != '\n') {
            keep = is_chosen(line, column, request);
        }
        if (keep)
            fwrite(line, 1, length, file);
        line += length;
    }
    free(text);
    if (!file)
        return cannot_write(text ? to : from, reason);
    return close_file(file, to, reason);
}

static int choose_methods(const struct paper_request *request, const char *tables, char *reason) {
    glob_t found;
    int code = check_methods(request, reason);
    if (code)
        return code;
    if (make_folder(tables, reason) || files_like(request->folder, "*.tsv", &found))
        return 2;
    for (size_t i = 0; i < found.gl_pathc && !code; i++) {
        char to[PATH_SIZE];
        path_format(to, "%s/%s", tables, strrchr(found.gl_pathv[i], '/') + 1);
        code = copy_table(found.gl_pathv[i], to, request, reason);
    }
    globfree(&found);
    return code;
}

/* --- drawing --- */

/* An svg that is as wide as on paper: its units are what they were. */
static int set_size_of_svg(const char *path, char *reason) {
    char *text = file_text(path), *at = text ? strstr(text, " width=\"") : NULL;
    double width, height;
    int length = 0;
    if (!at || sscanf(at, " width=\"%lf\" height=\"%lf\"%n", &width, &height, &length) != 2 ||
        length == 0) {
        free(text);
        snprintf(reason, REASON_SIZE, "%.150s: is no picture of gnuplot's", path);
        return 2;
    }
    FILE *file = fopen(path, "w");
    int code = file ? 0 : cannot_write(path, reason);
    if (file) {
        fprintf(file, "%.*s width=\"%.2fmm\" height=\"%.2fmm\"%s", (int)(at - text), text,
                width * unit, height * unit, at + length);
        code = close_file(file, path, reason);
    }
    free(text);
    return code;
}

/* Whether a figure is wanted and has a panel that is. */
static int is_wanted(const struct figure *figure, const struct paper_request *request) {
    for (int i = 0; i < figure->count; i++)
        if (!figure->item[i].is_legend && figure->item[i].paper.width > 0)
            return is_named(figure, request);
    return 0;
}

/* Gives the figures that are wanted their names, and adds to `count`. */
static int keep_wanted(const struct figures *figures, const struct paper_request *request,
                       const char *drawing, const char *to, const char *format, int *count,
                       char *reason) {
    int code = 0;
    for (int i = 0; i < figures->count && !code; i++) {
        char from[PATH_SIZE], path[PATH_SIZE];
        path_format(from, "%s/%s.%s", drawing, figures->figure[i].name, format);
        if (!is_wanted(&figures->figure[i], request) || !file_exists(from))
            continue;
        if (strcmp(format, "svg") == 0)
            code = set_size_of_svg(from, reason);
        if (!code && (path_format(path, "%s/%s-%s.%s", to, figures->figure[i].name,
                                  request->is_column ? "column" : "page", format) ||
                      file_put(from, path)))
            code = cannot_write(from, reason);
        *count += !code;
    }
    return code;
}

static int draw_formats(struct figures *figures, const struct paper_request *request,
                        const char *tables, const char *drawing, const char *to, char *reason) {
    static const char *const formats[] = {"pdf", "svg", "png", NULL};
    char layout[PATH_SIZE];
    int count = 0, code = write_layout(figures, request, drawing, layout, reason);
    for (int i = 0; formats[i] && !code; i++) {
        if (request->format && strcmp(request->format, formats[i]) != 0)
            continue;
        if (plot_draw(request->name, tables, drawing, &(struct plot_paper){"draw", layout},
                      formats[i], reason))
            code = 2;
        else
            code = keep_wanted(figures, request, drawing, to, formats[i], &count, reason);
    }
    if (!code && count == 0) {
        snprintf(reason, REASON_SIZE, "the figures of %s: gnuplot has drawn none", request->name);
        code = 2;
    }
    return code;
}

int paper_draw(const struct paper_request *request, const char *to, char *reason) {
    char drawing[PATH_SIZE], tables[PATH_SIZE], other[REASON_SIZE];
    struct figures figures = {.count = 0};
    if (make_folder(to, reason) || temporary_folder(to, drawing, reason))
        return 2;
    path_format(tables, "%s", request->folder);
    int code = 0;
    if (request->method_count > 0) {
        path_format(tables, "%s/tables", drawing);
        code = choose_methods(request, tables, reason);
    }
    if (!code)
        code = survey(&figures, request->name, tables, drawing, reason);
    if (!code)
        code = check_wanted(&figures, request, reason);
    if (!code)
        code = draw_formats(&figures, request, tables, drawing, to, reason);
    free_figures(&figures);
    if (request->method_count > 0)
        plot_empty_folder(tables, NULL, other);
    plot_empty_folder(drawing, NULL, other);
    return code;
}
