#include "scene_contacts.h"

#include "base/visible.h"

#include <stdlib.h>
#include <string.h>

static void read_name(struct config_reader *reader, config_setting_t *entry,
                      const struct scene *scene, struct body *body) {
    config_setting_t *setting = config_setting_get_member(entry, "name");
    const char *name = config_text(reader, entry, "name", NULL);
    if (!setting)
        config_fail(reader, entry, "name: missing; must be a text in quotes");
    if (!name)
        return;
    if (!*name || strlen(name) >= sizeof body->name)
        config_fail(reader, setting, "name: must have 1 to %d characters",
                    (int)sizeof body->name - 1);
    visible_text(name, body->name, sizeof body->name);
    for (int i = 0; i < scene->body_count; i++)
        if (strcmp(scene->bodies[i].name, body->name) == 0)
            config_fail(reader, setting, "name: there is a body '%s' already", body->name);
}

static void read_radii(struct config_reader *reader, config_setting_t *entry, double radii[3]) {
    config_vector(reader, entry, "radii", radii);
    for (int k = 0; k < 3; k++)
        if (!(radii[k] > 0))
            config_fail(reader, config_setting_get_member(entry, "radii"),
                        "radii: number %d, %g, is not positive", k + 1, radii[k]);
}

static void read_body(struct config_reader *reader, config_setting_t *entry, struct scene *scene) {
    static const char *const known[] = {"name",     "center",     "radii",  "velocity",
                                        "friction", "elasticity", "offset", NULL};
    struct body *body = &scene->bodies[scene->body_count];
    if (!config_setting_is_group(entry)) {
        config_fail(reader, entry, "body: each entry must be a group in braces");
        return;
    }
    config_known(reader, entry, known);
    read_name(reader, entry, scene, body);
    config_vector(reader, entry, "center", body->centre);
    read_radii(reader, entry, body->radii);
    body->moves = config_numbers(reader, entry, "velocity", 3, 3, body->velocity) > 0 ||
                  scene->around.head.knots > 0;
    body->friction = config_required(reader, entry, "friction", NOT_NEGATIVE);
    body->elasticity = config_required(reader, entry, "elasticity", NOT_NEGATIVE);
    if (body->elasticity > 1)
        config_fail(reader, config_setting_get_member(entry, "elasticity"),
                    "elasticity: %g is not from 0 to 1", body->elasticity);
    body->offset = config_required(reader, entry, "offset", NOT_NEGATIVE);
    scene->body_count++;
}

static void read_bodies(struct config_reader *reader, config_setting_t *top, struct scene *scene) {
    config_setting_t *list = config_setting_get_member(top, "body");
    if (!list)
        return;
    const int count = config_setting_is_list(list) ? config_setting_length(list) : 0;
    if (count < 1 || count > BODIES_MAX) {
        config_fail(reader, list,
                    "body: must be a list of 1 to %d groups, ( { name = ...; }, ... )", BODIES_MAX);
        return;
    }
    scene->bodies = calloc((size_t)count, sizeof *scene->bodies);
    if (!scene->bodies)
        config_fail(reader, list, "no memory for %d bodies", count);
    for (int i = 0; i < count && !reader->failed; i++)
        read_body(reader, config_setting_get_elem(list, (unsigned)i), scene);
}

void scene_read_contacts(struct config_reader *reader, config_setting_t *top, int samples,
                         struct scene *scene) {
    static const char *const known[] = {
        "collision_rate",   "interaction_rate", "threshold",  "viscosity",
        "interpenetration", "collision",        "reciprocal", NULL};
    struct interaction_settings *interaction = &scene->interaction;
    config_setting_t *group = config_group(reader, top, "contacts");
    config_known(reader, group, known);
    scene->collision_rate = config_number(reader, group, "collision_rate", NOT_NEGATIVE, 300);
    interaction->rate = config_number(reader, group, "interaction_rate", NOT_NEGATIVE, 90);
    interaction->threshold = config_number(reader, group, "threshold", NOT_NEGATIVE, 0.9);
    interaction->viscosity = config_number(reader, group, "viscosity", NOT_NEGATIVE, 5);
    interaction->interpenetration = config_switch(reader, group, "interpenetration", group != NULL);
    interaction->collision = config_switch(reader, group, "collision", group != NULL);
    interaction->reciprocal = config_switch(reader, group, "reciprocal", true);
    if (interaction->threshold > 1)
        config_fail(reader, config_setting_get_member(group, "threshold"),
                    "threshold: %g is not between 0 and 1", interaction->threshold);
    if (samples == 0 && (interaction->interpenetration || interaction->collision))
        config_fail(reader, group,
                    "contacts: wisps touch with their envelopes, and these have none; add "
                    "envelope = { }; or set interpenetration and collision to false");
    read_bodies(reader, top, scene);
}

/* More would not be refused by the model, but the room for it is taken at the start. */
static const double most_wisps = 100000;

void scene_read_subdivision(struct config_reader *reader, config_setting_t *top, int samples,
                            struct scene *scene) {
    static const char *const known[] = {"ratio", "separation", "limit", NULL};
    config_setting_t *group = config_group(reader, top, "subdivision");
    if (!group)
        return;
    config_known(reader, group, known);
    scene->subdivision.ratio = config_number(reader, group, "ratio", POSITIVE, 0.5);
    scene->subdivision.separation = config_number(reader, group, "separation", POSITIVE, 0.01);
    const config_setting_t *limit_given = config_setting_get_member(group, "limit");
    const double limit = config_number(reader, group, "limit", WHOLE, 400);
    if (samples == 0)
        config_fail(reader, group,
                    "subdivision: wisps split by the shape of their envelopes, and these have "
                    "none; add envelope = { };");
    if (samples % 2 != 0)
        config_fail(reader, group,
                    "subdivision: %d samples have no diameters; envelope.samples must be even",
                    samples);
    if (scene->subdivision.ratio > 1)
        config_fail(reader, config_setting_get_member(group, "ratio"),
                    "ratio: %g is not between 0 and 1", scene->subdivision.ratio);
    if (limit < scene->wisp_count || limit > most_wisps)
        config_fail(reader, limit_given ? limit_given : group,
                    "limit: %g is not a whole number from %d, the wisps of the scene, to %g", limit,
                    scene->wisp_count, most_wisps);
    else
        scene->subdivision.limit = (int)limit;
}
