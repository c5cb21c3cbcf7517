/* Every setting of a scene file, once: the reader, `wisplab list settings`, the man page
 * wisplab-scene(5) and what is said of a wrong value are made from this table. */
#ifndef WISPLAB_SCENE_SETTINGS_H
#define WISPLAB_SCENE_SETTINGS_H

#include <stddef.h>

enum setting_type {
    SETTING_NUMBER,
    SETTING_SWITCH,  /* true or false */
    SETTING_CHOICE,  /* one of some words; stored as its place among them */
    SETTING_TEXT,    /* in quotes */
    SETTING_NUMBERS, /* some of them in brackets */
    SETTING_VECTORS, /* a list of vectors, one for each knot or direction */
    SETTING_GROUP,   /* settings in braces */
    SETTING_LIST     /* a list of groups */
};

/* What each number of a setting may be, always finite. */
struct setting_range {
    double least, most;
    int above, below; /* whether `least`, and whether `most`, itself is out of it */
    int whole;
};

/* Whose scenes have a setting, as bits. */
enum { OF_WISPS = 1, OF_CIRCLE = 2, OF_ROSENBLUM = 4, OF_ANJYO = 8, OF_HAIR = 13, OF_ALL = 15 };

struct scene_setting {
    const char *group; /* that it stands in: "" the top, "style.parting"; of lists each entry's */
    const char *name;
    enum setting_type type;
    const char *unit; /* NULL: none */
    struct setting_range range;
    int least, most;            /* how many NUMBERS */
    const char *const *choices; /* NULL-terminated */
    const char *initial; /* the default, as a file would say it; "": what `meaning` says of it;
                            NULL: it must be there */
    unsigned problems;
    const char *with; /* what it goes with in its group: "kind=gust", "grid", "!scalp"; NULL: all */
    size_t at, size;  /* where in its group's struct the reader puts it; size 0: it does not */
    const char *meaning;
};

/* In the order of lists and pages, a group before its settings and what others go with before
 * those; ends with a name of NULL. */
extern const struct scene_setting scene_settings[];

/* The one of that name in a group, or NULL. */
const struct scene_setting *setting_find(const char *group, const char *name);

/* The one of a group, of the problems `of`, whose name a mistyped one most resembles; NULL
 * where it resembles none. */
const struct scene_setting *setting_nearest(const char *group, const char *name, unsigned of);

/* What its value must be: "a positive number, in m". */
void setting_what(const struct scene_setting *setting, char *text, size_t size);

/* The same, and its default where it has one: "a positive number, in m (default 0.02)". */
void setting_right(const struct scene_setting *setting, char *text, size_t size);

/* As --set names it: "material.drag_rate", "wisps.[0].nodes", the first entry standing for all. */
void setting_path(const struct scene_setting *setting, char *path, size_t size);

/* What it goes with: "with kind = "gust"", "without scalp"; or an empty text. */
void setting_with(const struct scene_setting *setting, char *text, size_t size);

/* In a word or two: "number", "whole number", "group". */
void setting_type(const struct scene_setting *setting, char *text, size_t size);

/* Its problems by their names where they are not all: "wisps, anjyo"; else an empty text. */
void setting_problems(const struct scene_setting *setting, char *text, size_t size);

#endif
