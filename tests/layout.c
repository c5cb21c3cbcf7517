/* Where pictures are on a page: none meet, none leave it, and a film's sheet is of equal frames. */
#include "picture/layout.h"

#include <criterion/criterion.h>
#include <stdlib.h>

/* Whether two panels, with what is above them, have a pixel in common. */
static int meet(const struct layout *l, const struct panel *a, const struct panel *b) {
    const int above = l->lines > 1 ? LAYOUT_CAPTION : 0;
    return a->x < b->x + (int)(b->scale * l->width) && b->x < a->x + (int)(a->scale * l->width) &&
           a->y - above < b->y + (int)(b->scale * l->height) &&
           b->y - above < a->y + (int)(a->scale * l->height);
}

static void check_panels(const struct layout *l) {
    const int count = l->groups * l->each;
    const int top = (l->untitled ? 0 : LAYOUT_TITLE) + (layout_is_alone(l) ? 0 : LAYOUT_CAPTION),
              bottom = l->page_height - (l->has_bar ? LAYOUT_BAR : 0);
    for (int i = 0; i < count + l->has_large; i++) {
        const struct panel p = i < count ? layout_panel(l, i) : layout_large(l);
        cr_assert(p.x >= (i < count ? l->label : 0) && p.y >= top);
        cr_assert(p.x + (int)(p.scale * l->width) <= l->page_width &&
                      p.y + (int)(p.scale * l->height) <= bottom,
                  "panel %d leaves the page", i);
        for (int k = 0; k < i && k < count; k++) {
            const struct panel q = layout_panel(l, k);
            cr_assert(!meet(l, &p, &q), "panels %d and %d meet", i, k);
        }
    }
}

Test(layout, panels_neither_meet_nor_leave_the_page) {
    for (int i = 0; i < 4 * 7 * 9 * 16; i++) {
        struct layout l = {.runs = 1 + i % 4,
                           .frames = 1 + i / 4 % 7,
                           .columns = i / 28 % 9,
                           .width = 160,
                           .height = 120 + 7 * (i % 5),
                           .label = i % 3 ? 50 : 0,
                           .beside = i / 252 % 2,
                           .untitled = i / 504 % 2,
                           .has_bar = i / 1008 % 2,
                           .has_large = i / 2016 % 2};
        lay_out(&l);
        check_panels(&l);
    }
}

/* Each run and frame once, a run's frames in their order, and run by run or frame by frame. */
Test(layout, rows_are_runs_or_frames) {
    for (int beside = 0; beside < 2; beside++) {
        struct layout l = {.runs = 3, .frames = 2, .width = 9, .height = 9, .beside = beside};
        lay_out(&l);
        for (int i = 0; i < 6; i++) {
            const struct panel p = layout_panel(&l, i);
            cr_assert(p.run == (beside ? i % 3 : i / 2) && p.frame == (beside ? i / 3 : i % 2));
        }
        const struct panel first = layout_panel(&l, 0), second = layout_panel(&l, 1);
        cr_assert(first.y == second.y && first.x < second.x);
    }
}

/* The page moves them up behind a window by whole heights. */
Test(layout, frames_of_a_sheet_are_as_high_as_each_other) {
    for (int runs = 1; runs <= 2; runs++) {
        struct layout l = {
            .runs = runs, .frames = 31, .width = 320, .height = 240, .beside = 1, .untitled = 1};
        lay_out(&l);
        cr_assert_eq(l.page_height % l.frames, 0);
        for (int i = 0; i < runs * l.frames; i++) {
            const int high = l.page_height / l.frames, frame = layout_panel(&l, i).frame;
            const int y = layout_panel(&l, i).y;
            cr_assert(y - LAYOUT_CAPTION >= frame * high && y + l.height <= (frame + 1) * high,
                      "frame %d is not in its window", frame);
        }
    }
}

/* As high as all together, but no giant. */
Test(layout, one_may_be_large) {
    struct layout l = {
        .runs = 1, .frames = 6, .columns = 3, .width = 160, .height = 120, .has_large = 1};
    lay_out(&l);
    const struct panel large = layout_large(&l), last = layout_panel(&l, 5);
    cr_assert_eq(large.y + (int)(large.scale * l.height), last.y + l.height);
    cr_assert(large.scale > 2 && large.scale < 3);
    l.columns = 1;
    lay_out(&l);
    cr_assert_eq(l.large, 3);
    l.width = 310; /* three times as large it would be too wide */
    lay_out(&l);
    cr_assert(l.large > 2 && l.large < 3 && l.page_width <= 1206, "%d", l.page_width);
    l.columns = l.frames = 2;
    lay_out(&l);
    cr_assert_eq(l.large, 2);
    check_panels(&l);
}

/* Nothing is white beside a large one, of whatever size: up to three rows are as high as it. */
Test(layout, a_large_one_is_as_high_as_up_to_three_rows) {
    for (int i = 0; i < 3 * 7 * 2 * 2; i++) {
        struct layout l = {.runs = 1 + i % 3,
                           .frames = 1 + i / 3 % 7,
                           .width = i / 42 ? 640 : 320,
                           .height = i / 42 ? 480 : 240,
                           .beside = i / 21 % 2,
                           .has_large = 1};
        lay_out(&l);
        check_panels(&l);
        if (l.runs * l.frames == 1)
            continue;
        const struct panel large = layout_large(&l), last = layout_panel(&l, l.groups * l.each - 1);
        cr_expect(l.groups * l.lines >= 2 && l.groups * l.lines <= 3 &&
                      abs(large.y + (int)(large.scale * l.height) - last.y - l.height) <= 1,
                  "%d runs of %d frames%s: %d rows, large to %g, others to %d", l.runs, l.frames,
                  l.beside ? " beside each other" : "", l.groups * l.lines,
                  large.y + large.scale * l.height, last.y + l.height);
    }
}
