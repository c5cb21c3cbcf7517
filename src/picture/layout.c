#include "layout.h"

#include <math.h>

enum { LARGE_LEAST = 2, LARGE_MOST = 3, LARGE_ROWS = 3, WIDEST = 1200 };

int layout_is_alone(const struct layout *layout) {
    return layout->groups * layout->each == 1 && !layout->has_large;
}

static int rows(const struct layout *layout) {
    return layout->groups * layout->lines;
}

/* The large panel is as high as the others together, of many rows where it does not become a giant
 * or the page too wide. */
static double enlargement(const struct layout *l, int high) {
    const double all = (double)high / l->height;
    const int beside = l->label + l->columns * l->across;
    if (rows(l) <= LARGE_ROWS)
        return fmax(LARGE_LEAST, all);
    return fmax(LARGE_LEAST, fmin(all, fmin(LARGE_MOST, (double)(WIDEST - beside) / l->width)));
}

/* Beside a large panel those of one group are in as many rows as go with it; frames of several runs
 * stay together. */
static int columns_beside_large(const struct layout *l, int usual) {
    const int together = l->beside && l->frames > 1 ? l->runs : 1;
    return l->groups > 1 ? usual : together * ((l->each / together + LARGE_ROWS - 1) / LARGE_ROWS);
}

void lay_out(struct layout *l) {
    const int usual = l->beside ? l->runs : l->frames;
    l->groups = l->beside ? 1 : l->runs;
    l->each = l->beside ? l->runs * l->frames : l->frames;
    if (l->columns == 0 && l->has_large)
        l->columns = columns_beside_large(l, usual);
    else if (l->columns == 0 || l->columns > l->each)
        l->columns = usual;
    l->lines = (l->each + l->columns - 1) / l->columns;
    const int gap = layout_is_alone(l) ? 0 : LAYOUT_GAP,
              between = l->lines > 1 ? LAYOUT_CAPTION : 0;
    l->across = l->width + gap;
    l->down = l->height + gap + between;
    l->top = (l->untitled ? 0 : LAYOUT_TITLE) + (layout_is_alone(l) ? 0 : LAYOUT_CAPTION);
    const int high = rows(l) * l->down - gap - between;
    l->large = l->has_large ? enlargement(l, high) : 0;
    l->left = l->label + (l->has_large ? (int)(l->large * l->width) + LAYOUT_GAP : 0);
    l->page_width = l->left + l->columns * l->across;
    l->page_height =
        l->top + (int)fmax(high, l->large * l->height) + gap + (l->has_bar ? LAYOUT_BAR : 0);
}

struct panel layout_panel(const struct layout *l, int i) {
    const int group = i / l->each, k = i % l->each;
    return (struct panel){.run = l->beside ? k % l->runs : group,
                          .frame = l->beside ? k / l->runs : k,
                          .x = l->left + k % l->columns * l->across,
                          .y = l->top + (group * l->lines + k / l->columns) * l->down,
                          .scale = 1};
}

struct panel layout_large(const struct layout *l) {
    return (struct panel){.y = l->top, .scale = l->large};
}
