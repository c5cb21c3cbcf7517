#include "scene_detail.h"

#include "base/files.h"
#include "scene_wisps.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

int detailed_nodes(int nodes, double factor) {
    return (int)fmax(3, round(factor * (nodes - 1)) + 1);
}

/* The length of the free hair's segments, m. */
static double detailed_spacing(const struct wisp *wisp, int nodes) {
    return (wisp->length - wisp_spacing(wisp)) / (nodes - 2);
}

/* --- the start --- */

enum { WISP, NODE, POSITION, VELOCITY = 5, SAMPLES = 8 }; /* columns of a start's rows */

static int row_columns(int samples) {
    return SAMPLES + 2 * samples;
}

/* One wisp's rows before. */
struct chain {
    const double *rows;
    int nodes, samples;
    double length; /* from node 1 on, as it lies, m */
};

static const double *chain_row(const struct chain *chain, int i) {
    return chain->rows + i * row_columns(chain->samples);
}

static double segment_length(const struct chain *chain, int i) {
    const double *a = chain_row(chain, i) + POSITION, *b = chain_row(chain, i + 1) + POSITION;
    return hypot(hypot(b[0] - a[0], b[1] - a[1]), b[2] - a[2]);
}

/* The segment in which a share of the length from node 1 on ends, and in *along which part of it.
 */
static int segment_at(const struct chain *chain, double share, double *along) {
    double left = share * chain->length;
    int i = 1;
    while (i + 2 < chain->nodes && left > segment_length(chain, i))
        left -= segment_length(chain, i++);
    *along = left / segment_length(chain, i);
    return i;
}

/* Sample j of `samples` around old node i: its distance (part 0) or rate (part 1), linear in the
 * angle between old samples. */
static double around(const struct chain *chain, int i, int j, int samples, int part) {
    const double *old = chain_row(chain, i) + SAMPLES + part;
    const double at = (double)j * chain->samples / samples;
    const int below = (int)at, above = (below + 1) % chain->samples;
    return old[2 * below] + (at - below) * (old[2 * above] - old[2 * below]);
}

/* A row that lies `along` segment i of the chain. */
static void interpolate(const struct chain *chain, int i, double along, int samples, double *row) {
    const double *a = chain_row(chain, i), *b = chain_row(chain, i + 1);
    for (int k = POSITION; k < SAMPLES; k++)
        row[k] = a[k] + along * (b[k] - a[k]);
    for (int j = 0; j < 2 * samples; j++) {
        const double from = around(chain, i, j / 2, samples, j % 2);
        const double to = around(chain, i + 1, j / 2, samples, j % 2);
        row[SAMPLES + j] = from + along * (to - from);
    }
}

/* Moves a row's position along the line to the one before it, to this distance from it. */
static void set_apart(const double *before, double distance, double *row) {
    double way[3], length = 0;
    for (int k = 0; k < 3; k++) {
        way[k] = row[POSITION + k] - before[POSITION + k];
        length = hypot(length, way[k]);
    }
    for (int k = 0; k < 3; k++)
        row[POSITION + k] = before[POSITION + k] + distance / length * way[k];
}

/* Nodes 0 and 1 are the head's: node 1 stays, and node 0 is on the line from it through the old
 * one, with a fixed ring. */
static void resample_chain(const struct chain *chain, double spacing, int nodes, int samples,
                           double *rows) {
    const int columns = row_columns(samples), same = nodes == chain->nodes;
    for (int i = 0; i < nodes; i++) {
        double *row = rows + i * columns, along = 0;
        int at = i < nodes - 1 ? i : i - 1;
        if (same)
            along = i - at;
        else if (i >= 2)
            at = segment_at(chain, (i - 1.) / (nodes - 2), &along);
        else if (i == 0)
            along = 1 - spacing / segment_length(chain, 0);
        interpolate(chain, at, along, samples, row);
        row[WISP] = chain_row(chain, 0)[WISP];
        row[NODE] = i;
        if (i >= 2 && !same)
            set_apart(row - columns, spacing, row);
    }
}

static struct chain next_chain(const double *rows, int nodes, int samples) {
    struct chain chain = {.rows = rows, .nodes = nodes, .samples = samples};
    for (int i = 1; i + 1 < nodes; i++)
        chain.length += segment_length(&chain, i);
    return chain;
}

static int out_of_memory(char *reason) {
    errno = ENOMEM;
    return fail_with(reason, "out of memory");
}

static int resample_start(struct scene *scene, double factor, int samples, char *reason) {
    const struct start old = scene->start;
    const double *from = old.rows;
    size_t size = 0;
    if (!old.rows)
        return 0;
    for (int w = 0; w < scene->wisp_count; w++)
        size += (size_t)(detailed_nodes(scene->wisps[w].nodes, factor) * row_columns(samples));
    double *rows = malloc(size * sizeof *rows), *to = rows;
    if (!rows)
        return out_of_memory(reason);
    for (int w = 0; w < scene->wisp_count; w++) {
        const struct wisp *wisp = &scene->wisps[w];
        const int nodes = detailed_nodes(wisp->nodes, factor);
        const struct chain chain = next_chain(from, wisp->nodes, wisp->samples);
        resample_chain(&chain, detailed_spacing(wisp, nodes), nodes, samples, to);
        from += wisp->nodes * old.columns;
        to += nodes * row_columns(samples);
    }
    free(old.rows);
    scene->start = (struct start){.treatment = old.treatment,
                                  .columns = row_columns(samples),
                                  .count = (int)size,
                                  .rows = rows};
    return 0;
}

/* --- the scene --- */

static int check(const struct scene *scene, double factor, int samples, char *reason) {
    const int own = scene->wisps[0].samples;
    const char *why = NULL;
    if (!(factor > 0) || factor > 1000 || samples < 0 || samples > SAMPLES_MAX ||
        (samples > 0 && samples < 3))
        why = "no such number of nodes or samples";
    else if (own == 0 && samples > 0)
        why = "there is no envelope to have samples";
    else if (samples % 2 != 0 && scene->subdivision.limit > 0)
        why = "an odd number of samples has no diameters, by which wisps split";
    else if (samples == 0 && (scene->interaction.interpenetration || scene->interaction.collision))
        why = "wisps touch with their envelopes";
    else if (scene->start.rows && scene->start.treatment == WISP_PENALTY &&
             (factor != 1 || samples != own))
        why = "its start is a state of penalty, whose samples are particles; one of generalised "
              "can be carried over";
    if (why)
        snprintf(reason, REASON_SIZE, "scene %s: %s", scene->name, why);
    return why ? -1 : 0;
}

static void set_nodes(struct wisp *wisp, int nodes) {
    const double spacing = detailed_spacing(wisp, nodes), behind = wisp_spacing(wisp) - spacing;
    for (int k = 0; k < 3; k++)
        wisp->root[k] += behind * wisp->direction[k];
    wisp->length = spacing * (nodes - 1);
    wisp->nodes = nodes;
}

int scene_set_detail(struct scene *scene, double factor, int samples, char *reason) {
    if (factor == 1 && samples == scene->wisps[0].samples)
        return 0;
    if (check(scene, factor, samples, reason) || resample_start(scene, factor, samples, reason))
        return -1;
    if (json_object_set_new(scene->source, "detail",
                            json_pack("{s:f, s:f}", "factor", factor, "samples", 1. * samples)))
        return out_of_memory(reason);
    for (int w = 0; w < scene->wisp_count; w++) {
        if (factor != 1)
            set_nodes(&scene->wisps[w], detailed_nodes(scene->wisps[w].nodes, factor));
        scene->wisps[w].samples = samples;
    }
    if (samples == 0)
        scene_remove_envelope(scene);
    return 0;
}
