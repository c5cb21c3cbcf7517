/* A handle: opened, asked what it is, and its state. */
#include "wisplab.h"

#include "base/vector.h"
#include "build_info.h"
#include "library.h"
#include "model/problems.h"
#include "scene/scene_load.h"

#include <dlfcn.h>
#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

const char *wisplab_version(void) {
    return WISPLAB_VERSION;
}

int library_fail(wisplab *w, int code, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(w->error, sizeof w->error, format, arguments);
    va_end(arguments);
    return code;
}

int library_outcome(wisplab *w, int outcome, const char *reason) {
    const enum outcome how = (enum outcome)abs(outcome);
    const int code = how == FINISHED        ? WISPLAB_OK
                     : how == REFUSED       ? WISPLAB_REFUSED
                     : how == OUT_OF_MEMORY ? WISPLAB_NO_MEMORY
                     : how == INTERRUPTED   ? WISPLAB_STOPPED
                                            : WISPLAB_FAILED;
    if (code == WISPLAB_OK)
        return code;
    if (code == WISPLAB_FAILED)
        return library_fail(w, code, "%s: %s", outcome_name(how), reason);
    return library_fail(w, code, "%s", reason);
}

/* --- opening --- */

/* Scenes are where the library is installed, whatever program it is in. */
static void find_data(void) {
    char folder[PATH_SIZE];
    Dl_info info;
    char *file = dladdr(__extension__(void *) wisplab_open, &info) && info.dli_fname
                     ? realpath(info.dli_fname, NULL)
                     : NULL;
    char *slash = file ? strrchr(file, '/') : NULL;
    if (slash)
        *slash = '\0';
    if (slash && path_format(folder, "%s/%s", file, WISPLAB_DATA_FROM_LIBRARY) == 0)
        data_folder_is(folder);
    free(file);
}

int library_count(const char *const *texts) {
    int count = 0;
    while (texts && texts[count])
        count++;
    return count;
}

/* What holds where nothing is said: no method's, for there is none. */
static int default_treatment(const struct problem *problem) {
    const int generalised = treatment_find(problem, "generalised");
    return problem == &wisp_problem && generalised >= 0 ? generalised : 0;
}

/* Brings w->scene to life. Returns 0 or a code. */
static int create_model(wisplab *w, const char *treatment) {
    const struct problem *problem = w->scene->problem;
    w->treatment = treatment ? treatment_find(problem, treatment) : default_treatment(problem);
    if (w->treatment < 0)
        return library_fail(w, WISPLAB_REFUSED, "scene %s has no treatment '%.60s'", w->scene->name,
                            treatment);
    w->model = problem->create(w->scene, w->treatment, 1);
    if (!w->model)
        return library_fail(w, WISPLAB_NO_MEMORY, "no memory for the model");
    w->part_room = (size_t)w->model->part_count + (size_t)w->model->parts_to_come;
    w->changed = calloc(w->part_room, sizeof *w->changed);
    if (!w->changed)
        return library_fail(w, WISPLAB_NO_MEMORY, "no memory for ticks");
    library_start_clock(w);
    return 0;
}

static int open_either(wisplab **opened, const char *text, const char *path,
                       const char *const *sets, const char *treatment, char *error, size_t size) {
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, find_data);
    *opened = NULL;
    wisplab *w = calloc(1, sizeof *w);
    if (!w) {
        snprintf(error, error ? size : 0, "no memory for a handle");
        return WISPLAB_NO_MEMORY;
    }
    const int count = library_count(sets);
    w->scene = text ? scene_from_text(text, path, sets, count, w->error)
                    : scene_load(path, sets, count, w->error);
    int code = w->scene ? 0 : errno == ENOMEM ? WISPLAB_NO_MEMORY : WISPLAB_REFUSED;
    if (!code)
        code = create_model(w, treatment);
    if (!code) {
        *opened = w;
        return WISPLAB_OK;
    }
    snprintf(error, error ? size : 0, "%s", w->error);
    wisplab_close(w);
    return code;
}

int wisplab_open(wisplab **w, const char *scene, const char *const *sets, const char *treatment,
                 char *error, size_t size) {
    return open_either(w, NULL, scene, sets, treatment, error, size);
}

int wisplab_open_text(wisplab **w, const char *text, const char *path, const char *const *sets,
                      const char *treatment, char *error, size_t size) {
    return open_either(w, text, path, sets, treatment, error, size);
}

void wisplab_close(wisplab *w) {
    if (!w)
        return;
    if (w->model)
        w->scene->problem->free(w->model);
    scene_free(w->scene);
    free(w->changed);
    free(w);
}

/* --- what there is --- */

const char *wisplab_error(const wisplab *w) {
    return w->error;
}

const char *wisplab_scene(const wisplab *w) {
    return w->scene->name;
}

const char *wisplab_treatment(const wisplab *w) {
    return w->scene->problem->treatments[w->treatment].name;
}

int wisplab_unknowns(const wisplab *w) {
    int sum = 0;
    for (int i = 0; i < w->model->part_count; i++)
        sum += w->model->parts[i].system.size;
    return sum;
}

int wisplab_wisps(const wisplab *w) {
    return w->model->part_count;
}

int wisplab_nodes(const wisplab *w) {
    return w->model->row_count;
}

int wisplab_parent(const wisplab *w, int wisp) {
    return w->model->parent[wisp];
}

int wisplab_unknown(const wisplab *w, int i, struct wisplab_unknown *unknown) {
    int part = 0;
    while (part < w->model->part_count && i >= w->model->parts[part].system.size)
        i -= w->model->parts[part++].system.size;
    if (i < 0 || part == w->model->part_count)
        return WISPLAB_REFUSED;
    const struct unknown u = w->scene->problem->unknown(w->model, part, i);
    *unknown = (struct wisplab_unknown){u.wisp, u.node, u.name, u.unit};
    return WISPLAB_OK;
}

void wisplab_times(const wisplab *w, double *begin, double *end, double *frame_rate) {
    *begin = w->scene->begin;
    *end = w->scene->begin + w->scene->duration;
    *frame_rate = w->scene->frame_rate;
}

/* --- the state --- */

void wisplab_state(const wisplab *w, double *t, double *q, double *v) {
    if (t)
        *t = w->model->t;
    for (int i = 0, at = 0; i < w->model->part_count; at += w->model->parts[i++].system.size) {
        const struct part *part = &w->model->parts[i];
        const size_t bytes = (size_t)part->system.size * sizeof *q;
        if (q)
            memcpy(q + at, part->q, bytes);
        if (v)
            memcpy(v + at, part->v, bytes);
    }
}

int wisplab_set_state(wisplab *w, double t, const double *q, const double *v) {
    const int n = wisplab_unknowns(w);
    if (!isfinite(t) || !all_finite(q, n) || !all_finite(v, n))
        return library_fail(w, WISPLAB_REFUSED, "a state must be finite");
    for (int i = 0, at = 0; i < w->model->part_count; at += w->model->parts[i++].system.size) {
        const struct part *part = &w->model->parts[i];
        const size_t bytes = (size_t)part->system.size * sizeof *q;
        memcpy(part->q, q + at, bytes);
        memcpy(part->v, v + at, bytes);
    }
    w->model->t = t;
    if (t < w->last || (t > w->next.t && !clock_same(t, w->next.t)))
        library_start_clock(w);
    return WISPLAB_OK;
}

/* --- what was counted --- */

static const char *const counter_names[] = {
#define X(field, definition) #field,
    COUNTERS(X)
#undef X
};

int wisplab_counters(void) {
    return sizeof counter_names / sizeof *counter_names;
}

const char *wisplab_counter_name(int i) {
    return i >= 0 && i < wisplab_counters() ? counter_names[i] : NULL;
}

void wisplab_counts(const wisplab *w, long long *counts) {
    memset(counts, 0, sizeof counter_names / sizeof *counter_names * sizeof *counts);
    for (int i = 0; i < w->model->part_count; i++) {
        const struct counters *part = &w->model->parts[i].system.counters;
        int k = 0;
#define X(field, definition) counts[k++] += part->field;
        COUNTERS(X)
#undef X
    }
}
