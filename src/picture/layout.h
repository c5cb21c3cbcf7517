/* Where the pictures of a page are, in pixels. Groups of panels are below each other: the frames of
 * a run, or all where runs stand beside each other and frames below each other. */
#ifndef WISPLAB_LAYOUT_H
#define WISPLAB_LAYOUT_H

enum {
    LAYOUT_TITLE = 34,   /* pixels above all, */
    LAYOUT_CAPTION = 20, /* above a panel or a row of them, */
    LAYOUT_BAR = 70,     /* below all, for a scale of colours, */
    LAYOUT_GAP = 6,      /* and between panels */
};

struct layout {
    int runs, frames;  /* how many */
    int width, height; /* of a panel */
    int columns;       /* panels of a group side by side; 0: all of a run, or all runs, but beside a
                        * large one as many as make three rows at most */
    int label;         /* room left of the panels, for their rows' names */
    int beside, untitled, has_bar, has_large;

    /* what follows from these */
    int groups, each, lines;     /* panels of a group; rows of panels in it */
    int left, top, across, down; /* the first panel, and the way from one to the next */
    double large;                /* by how much the sides of the large panel are longer */
    int page_width, page_height;
};

/* Fills in what follows. A large panel, left of all, is at least twice as high as one of the
 * others, and as high as up to three rows of them; of more rows it is at most three times as high
 * as one, and less, down to twice, where the page would be wider than 1200 pixels. */
void lay_out(struct layout *layout);

/* Whether there is one panel alone, whose title says all. */
int layout_is_alone(const struct layout *layout);

struct panel {
    int run, frame; /* from 0 */
    int x, y;       /* its top left corner */
    double scale;   /* of its sides over those of the others */
};

/* Panel i of groups * each, row by row; and the large one, whose run and frame are the caller's. */
struct panel layout_panel(const struct layout *layout, int i);
struct panel layout_large(const struct layout *layout);

#endif
