#include "scene_roots.h"

#include "base/files.h"
#include "base/visible.h"
#include "setting_read.h"
#include "wisp/ellipsoid.h"
#include "wisp/scalp.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Where the wisps of an entry are: one, or a grid along two directions. */
struct grid {
    int count[2];
    double spacing; /* m */
    double across[2][3];
};

static void read_grid(struct config_reader *reader, config_setting_t *entry, struct grid *grid) {
    double count[2];
    *grid = (struct grid){.count = {1, 1}};
    if (setting_numbers(reader, entry, "wisps", "grid", count) == 0)
        return;
    grid->spacing = setting_number(reader, entry, "wisps", "spacing");
    setting_vectors(reader, entry, "wisps", "across", 2, grid->across);
    for (int d = 0; d < 2 && !reader->failed; d++) {
        grid->count[d] = (int)count[d];
        setting_normalise(reader, entry, "across", grid->across[d]);
    }
}

/* Adds `count` wisps like `wisp`; returns the first, or NULL where memory cannot be had. */
static struct wisp *add_wisps(struct config_reader *reader, struct scene *scene,
                              const struct wisp *wisp, int count) {
    struct wisp *wisps = realloc(scene->wisps, (size_t)(scene->wisp_count + count) * sizeof *wisps);
    if (!wisps) {
        reader->out_of_memory = true;
        config_fail(reader, NULL, "no memory for %d wisps", scene->wisp_count + count);
        return NULL;
    }
    struct wisp *first = wisps + scene->wisp_count;
    scene->wisps = wisps;
    scene->wisp_count += count;
    for (int i = 0; i < count; i++)
        first[i] = *wisp;
    return first;
}

/* --- one wisp, or a grid --- */

/* Along the grid's first direction fastest. */
static void add_grid(struct config_reader *reader, struct scene *scene, const struct wisp *corner,
                     const struct grid *grid) {
    const int count = grid->count[0] * grid->count[1];
    struct wisp *wisps = add_wisps(reader, scene, corner, count);
    for (int i = 0; wisps && i < count; i++)
        for (int k = 0; k < 3; k++)
            wisps[i].root[k] += grid->spacing * (i % grid->count[0] * grid->across[0][k] +
                                                 i / grid->count[0] * grid->across[1][k]);
}

static void read_rooted(struct config_reader *reader, config_setting_t *entry, struct wisp *wisp,
                        struct scene *scene) {
    struct grid grid;
    read_grid(reader, entry, &grid);
    if (!reader->failed)
        setting_normalise(reader, entry, "direction", wisp->direction);
    if (!reader->failed)
        add_grid(reader, scene, wisp, &grid);
}

/* --- a scalp --- */

static const struct body *find_body(struct config_reader *reader, config_setting_t *entry,
                                    const struct scene *scene) {
    char name[BODY_NAME_SIZE];
    visible_text(setting_text(reader, entry, "wisps", "scalp", ""), name,
                 sizeof name); /* as the bodies' */
    char names[REASON_SIZE] = "";
    for (int i = 0; i < scene->body_count; i++) {
        if (strcmp(scene->bodies[i].name, name) == 0)
            return &scene->bodies[i];
        strncat(names, i ? ", " : "; there are ", sizeof names - strlen(names) - 1);
        strncat(names, scene->bodies[i].name, sizeof names - strlen(names) - 1);
    }
    config_fail(reader, config_setting_get_member(entry, "scalp"), "scalp: no body '%.63s'%s", name,
                scene->body_count ? names : "; this scene has none, add body = ( { ... } )");
    return NULL;
}

static int inside_any(const struct scene *scene, const struct wisp *wisp, int node) {
    for (int i = 0; i < scene->body_count; i++) {
        const struct body *body = &scene->bodies[i];
        double x[3];
        for (int k = 0; k < 3; k++)
            x[k] = wisp->root[k] + node * wisp_spacing(wisp) * wisp->direction[k] - body->centre[k];
        if (ellipsoid_contains(body->radii, x))
            return i;
    }
    return -1;
}

/* Nodes 0 and 1 cannot get out of a body, and what hangs on them would be stretched. */
static void check_outside(struct config_reader *reader, config_setting_t *entry,
                          const struct scene *scene, const struct wisp *wisps, int count) {
    for (int i = 0; i < count; i++)
        for (int node = 0; node < 2; node++) {
            const int body = inside_any(scene, &wisps[i], node);
            if (body >= 0)
                config_fail(reader, entry,
                            "scalp: wisp %d of %d starts in the body '%s'; turn crown away from it",
                            i + 1, count, scene->bodies[body].name);
        }
}

static void add_scalp(struct config_reader *reader, config_setting_t *entry,
                      const struct body *body, const double crown[3], int count,
                      const struct wisp *wisp, struct scene *scene) {
    double(*points)[3] = malloc(2 * (size_t)count * sizeof *points);
    struct wisp *wisps = points ? add_wisps(reader, scene, wisp, count) : NULL;
    if (!wisps || scalp_points(body, crown, count, points, points + count)) {
        reader->out_of_memory = true;
        config_fail(reader, entry, "no memory for %d wisps", count);
    } else {
        for (int i = 0; i < count; i++) {
            memcpy(wisps[i].root, points[i], sizeof wisps[i].root);
            memcpy(wisps[i].direction, points[count + i], sizeof wisps[i].direction);
        }
        check_outside(reader, entry, scene, wisps, count);
    }
    free(points);
}

/* Hair grows on top and behind, from above the forehead (towards +z) down to the nape. */
static void read_scalp(struct config_reader *reader, config_setting_t *entry,
                       const struct wisp *wisp, struct scene *scene) {
    double crown[3];
    const struct body *body = find_body(reader, entry, scene);
    const double count = setting_number(reader, entry, "wisps", "count");
    setting_numbers(reader, entry, "wisps", "crown", crown);
    if (!reader->failed)
        setting_normalise(reader, entry, "crown", crown);
    if (!reader->failed)
        add_scalp(reader, entry, body, crown, (int)count, wisp, scene);
}

/* --- the list --- */

static void read_entry(struct config_reader *reader, config_setting_t *entry,
                       const struct wisp *material, struct scene *scene) {
    struct wisp wisp = *material;
    if (!config_setting_is_group(entry)) {
        config_fail(reader, entry, "wisps: each entry must be a group in braces");
        return;
    }
    settings_read(reader, entry, "wisps", &wisp);
    if (config_setting_get_member(entry, "scalp"))
        read_scalp(reader, entry, &wisp, scene);
    else
        read_rooted(reader, entry, &wisp, scene);
}

void scene_read_roots(struct config_reader *reader, config_setting_t *top,
                      const struct wisp *material, struct scene *scene) {
    config_setting_t *wisps = setting_group(reader, top, "", "wisps");
    for (int i = 0; wisps && i < config_setting_length(wisps) && !reader->failed; i++)
        read_entry(reader, config_setting_get_elem(wisps, (unsigned)i), material, scene);
}
