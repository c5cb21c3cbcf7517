#include "scene_contacts.h"

#include "base/visible.h"
#include "setting_read.h"

#include <stdlib.h>
#include <string.h>

static void read_name(struct config_reader *reader, config_setting_t *entry,
                      const struct scene *scene, struct body *body) {
    const config_setting_t *setting = config_setting_get_member(entry, "name");
    const char *name = setting_text(reader, entry, "body", "name", NULL);
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

static void read_body(struct config_reader *reader, config_setting_t *entry, struct scene *scene) {
    struct body *body = &scene->bodies[scene->body_count];
    if (!config_setting_is_group(entry)) {
        config_fail(reader, entry, "body: each entry must be a group in braces");
        return;
    }
    settings_read(reader, entry, "body", body);
    read_name(reader, entry, scene, body);
    body->moves = config_setting_get_member(entry, "velocity") || scene->around.head.knots > 0;
    scene->body_count++;
}

/* Those that push by penalty behind the others, all else in the order in which they are. */
static void sort_bodies(struct scene *scene) {
    struct body *list = scene->bodies;
    const int count = scene->body_count;
    int ticking = 0;
    for (int i = 0; i < count; i++) {
        const struct body body = list[i];
        if (body.response != RESPONSE_TICK)
            continue;
        memmove(list + ticking + 1, list + ticking, (size_t)(i - ticking) * sizeof *list);
        list[ticking++] = body;
    }
    scene->around.pushing = list + ticking;
    scene->around.pushing_count = count - ticking;
}

static void read_bodies(struct config_reader *reader, config_setting_t *top, struct scene *scene) {
    config_setting_t *list = setting_group(reader, top, "", "body");
    const int count = list ? config_setting_length(list) : 0;
    if (!list)
        return;
    if (count > BODIES_MAX) {
        config_fail(reader, list, "body: %d bodies; at most %d", count, BODIES_MAX);
        return;
    }
    scene->bodies = calloc((size_t)count, sizeof *scene->bodies);
    if (!scene->bodies)
        config_fail(reader, list, "no memory for %d bodies", count);
    for (int i = 0; i < count && !reader->failed; i++)
        read_body(reader, config_setting_get_elem(list, (unsigned)i), scene);
    sort_bodies(scene);
}

void scene_push_bodies(struct scene *scene, double frequency) {
    json_t *list = json_object_get(scene->source, "body"), *entry;
    size_t at;
    json_array_foreach(list, at, entry) {
        json_object_del(entry, "elasticity");
        json_object_del(entry, "offset");
        json_object_set_new(entry, "response", json_string("penalty"));
        json_object_set_new(entry, "frequency", json_real(frequency));
        json_object_set_new(entry, "damping_ratio", json_real(1));
    }
    for (int i = 0; i < scene->body_count; i++) {
        struct body *body = &scene->bodies[i];
        body->response = RESPONSE_PENALTY;
        body->elasticity = body->offset = 0;
        body->frequency = frequency;
        body->damping_ratio = 1;
    }
    sort_bodies(scene);
}

void scene_read_contacts(struct config_reader *reader, config_setting_t *top, int samples,
                         struct scene *scene) {
    struct interaction_settings *interaction = &scene->interaction;
    config_setting_t *group = setting_group(reader, top, "", "contacts");
    settings_read(reader, group, "contacts", scene);
    if (!group)
        interaction->interpenetration = interaction->collision = 0;
    if (samples == 0 && (interaction->interpenetration || interaction->collision))
        config_fail(reader, group,
                    "contacts: wisps touch with their envelopes, and these have none; add "
                    "envelope = { }; or set interpenetration and collision to false");
    read_bodies(reader, top, scene);
}

void scene_read_subdivision(struct config_reader *reader, config_setting_t *top, int samples,
                            struct scene *scene) {
    struct subdivision *subdivision = &scene->subdivision;
    config_setting_t *group = setting_group(reader, top, "", "subdivision");
    if (!group)
        return;
    settings_read(reader, group, "subdivision", subdivision);
    if (samples == 0)
        config_fail(reader, group,
                    "subdivision: wisps split by the shape of their envelopes, and these have "
                    "none; add envelope = { };");
    if (samples % 2 != 0)
        config_fail(reader, group,
                    "subdivision: %d samples have no diameters; envelope.samples must be even",
                    samples);
    if (subdivision->limit < scene->wisp_count) {
        const config_setting_t *limit = config_setting_get_member(group, "limit");
        config_fail(reader, limit ? limit : group,
                    "limit: %d is not from %d, the wisps of the scene, on", subdivision->limit,
                    scene->wisp_count);
    }
}
