#include "scene_wisps.h"

#include "scene_contacts.h"
#include "scene_render.h"
#include "scene_roots.h"
#include "scene_start.h"
#include "setting_read.h"

#include <math.h>

static void read_material(struct config_reader *reader, config_setting_t *top, struct wisp *wisp) {
    settings_read(reader, setting_group(reader, top, "", "material"), "material", wisp);
}

/* Knot times: ascending. Returns their number. */
static int read_times(struct config_reader *reader, config_setting_t *group, const char *path,
                      double *times) {
    const int count = setting_numbers(reader, group, path, "times", times);
    for (int k = 1; k < count; k++)
        if (times[k] <= times[k - 1])
            config_fail(reader, config_setting_get_member(group, "times"),
                        "times: %g does not come after %g", times[k], times[k - 1]);
    return count;
}

/* What parts the hair has one acceleration for each knot of the style. */
static void read_parting(struct config_reader *reader, config_setting_t *style_group,
                         struct style *style) {
    static const char path[] = "style.parting";
    config_setting_t *group = setting_group(reader, style_group, "style", "parting");
    struct parting *parting = &style->parting;
    if (!group || reader->failed)
        return;
    settings_read(reader, group, path, parting);
    if (!reader->failed)
        setting_normalise(reader, group, "normal", parting->normal);
    setting_vectors(reader, group, path, "accelerations", style->knots, parting->acceleration);
}

static void read_style(struct config_reader *reader, config_setting_t *top, struct style *style) {
    config_setting_t *group = setting_group(reader, top, "", "style");
    if (!group || reader->failed)
        return;
    settings_read(reader, group, "style", style);
    style->knots = read_times(reader, group, "style", style->time);
    setting_vectors(reader, group, "style", "accelerations", style->knots, style->acceleration);
    read_parting(reader, group, style);
}

static void read_head(struct config_reader *reader, config_setting_t *top,
                      struct head_motion *head) {
    config_setting_t *group = setting_group(reader, top, "", "head");
    if (!group || reader->failed)
        return;
    settings_read(reader, group, "head", head);
    head->knots = read_times(reader, group, "head", head->time);
    setting_vectors(reader, group, "head", "positions", head->knots, head->position);
    setting_vectors(reader, group, "head", "rotations", head->knots, head->rotation);
}

static void read_irregular(struct config_reader *reader, config_setting_t *group,
                           struct wind *wind) {
    wind->terms = setting_numbers(reader, group, "wind", "amplitudes", wind->amplitude);
    if (wind->terms != setting_numbers(reader, group, "wind", "frequencies", wind->frequency))
        config_fail(reader, group,
                    "wind: amplitudes and frequencies must be there, and equally many");
}

static void read_wind(struct config_reader *reader, config_setting_t *top, struct wind *wind) {
    config_setting_t *group = setting_group(reader, top, "", "wind");
    if (!group)
        return;
    settings_read(reader, group, "wind", wind);
    wind->kind = (enum wind_kind)(WIND_STEADY + setting_choice(reader, group, "wind", "kind"));
    if (wind->kind == WIND_IRREGULAR)
        read_irregular(reader, group, wind);
}

/* Rows and numbers of a frame are counted in an int; a machine's memory is full before. */
static void check_size(struct config_reader *reader, config_setting_t *top,
                       const struct scene *scene) {
    const double most = 1e7;
    double nodes = 0, longest = 0;
    for (int i = 0; i < scene->wisp_count; i++) {
        nodes += scene->wisps[i].nodes;
        longest = fmax(longest, scene->wisps[i].nodes);
    }
    nodes += fmax(0, scene->subdivision.limit - scene->wisp_count) * longest;
    if (nodes > most)
        config_fail(reader, config_setting_get_member(top, "wisps"),
                    "wisps: %g nodes, with those of the wisps that subdivision may add; at most %g",
                    nodes, most);
}

void scene_read_wisps(struct config_reader *reader, config_setting_t *top, struct scene *scene) {
    struct wisp material = {0};
    read_material(reader, top, &material);
    config_setting_t *envelope = setting_group(reader, top, "", "envelope");
    if (envelope)
        settings_read(reader, envelope, "envelope", &material);
    read_wind(reader, top, &scene->around.wind);
    read_style(reader, top, &scene->around.style);
    read_head(reader, top, &scene->around.head);
    scene_read_contacts(reader, top, material.samples, scene);
    scene_read_roots(reader, top, &material, scene);
    scene_read_subdivision(reader, top, material.samples, scene);
    check_size(reader, top, scene);
    scene_read_start(reader, top, scene);
    render_read(reader, top, &scene->render);
}

/* --- what came before the thesis --- */

void scene_read_rosenblum(struct config_reader *reader, config_setting_t *top,
                          struct scene *scene) {
    struct wisp material = {0};
    read_material(reader, top, &material);
    material.stretch_time = material.bending_time = 0; /* nothing is damped but by the air */
    scene_read_roots(reader, top, &material, scene);
    render_read(reader, top, &scene->render);
}

/* Straight up or down phi is no angle: the source's own singularity. */
static void check_direction(struct config_reader *reader, config_setting_t *top,
                            const struct scene *scene) {
    for (int i = 0; i < scene->wisp_count; i++) {
        const double *d = scene->wisps[i].direction;
        if (atan2(hypot(d[0], d[2]), fabs(d[1])) < 1e-6)
            config_fail(reader, config_setting_get_member(top, "wisps"),
                        "wisps: wisp %d is within 1e-6 rad of the y axis, where the angles of "
                        "problem \"anjyo\" are not defined; turn its direction",
                        i);
    }
}

void scene_read_anjyo(struct config_reader *reader, config_setting_t *top, struct scene *scene) {
    struct wisp material = {0};
    read_material(reader, top, &material);
    read_wind(reader, top, &scene->around.wind);
    settings_read(reader, setting_group(reader, top, "", "anjyo"), "anjyo", scene);
    scene_read_roots(reader, top, &material, scene);
    check_direction(reader, top, scene);
    render_read(reader, top, &scene->render);
}

/* --- without an envelope --- */

void scene_remove_envelope(struct scene *scene) {
    json_object_del(scene->source, "envelope");
    json_object_del(scene->source, "subdivision");
    scene->subdivision.limit = 0;
    for (int i = 0; i < scene->wisp_count; i++) {
        struct wisp *wisp = &scene->wisps[i];
        wisp->samples = 0;
        wisp->radius = wisp->mass_fraction = 0;
        wisp->frequency = wisp->damping_ratio = wisp->penalty_ratio = 0;
    }
}
