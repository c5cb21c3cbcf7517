/* Inside the library: a handle, and how its functions fail. */
#ifndef WISPLAB_LIBRARY_H
#define WISPLAB_LIBRARY_H

#include "base/files.h"
#include "model/clock.h"
#include "model/model.h"
#include "model/scene.h"
#include "wisplab.h"

/* What the matrices are good for. */
enum prepared { NOTHING, LINEARISED, FACTORISED };

/* Parts of one lane: part i is wisp i, and the unknowns of all of them follow each other. */
struct wisplab {
    struct scene *scene;
    struct model *model;
    int treatment;
    struct clock clock; /* of ticks and kinks */
    struct stop next;   /* infinite where there is none */
    double last;        /* the stop before it, or where the clock was started, s */
    int *changed;       /* by part, of all that may come: room for ticks */
    size_t part_room;
    enum jacobian kind;
    enum prepared prepared;
    char error[REASON_SIZE];
};

/* Returns `code` with its reason (printf) in w->error. */
int library_fail(wisplab *w, int code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Returns the code of an outcome, also a negative one, with what is said of it in w->error. */
int library_outcome(wisplab *w, int outcome, const char *reason);

/* How many texts there are in a list that ends with NULL, or is NULL. */
int library_count(const char *const *texts);

/* Starts the clock at the model's time. */
void library_start_clock(wisplab *w);

#endif
