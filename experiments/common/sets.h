/* Overrides of a scene, made up one by one for plan_scene. */
#ifndef WISPLAB_SETS_H
#define WISPLAB_SETS_H

enum { SETS_MAX = 12, SET_SIZE = 256 };

/* All zero at first; `list` points into it, so that it must not be copied. */
struct sets {
    int count;
    char text[SETS_MAX][SET_SIZE];
    const char *list[SETS_MAX];
};

/* Adds one (printf). */
void set_add(struct sets *sets, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
