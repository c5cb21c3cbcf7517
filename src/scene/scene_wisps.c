#include "scene_wisps.h"

#include "scene_contacts.h"
#include "scene_render.h"
#include "scene_roots.h"
#include "scene_start.h"

#include <math.h>
#include <string.h>

/* The index of a text in a list, which ends with NULL; refused where it is not in it. */
static int read_choice(struct config_reader *reader, config_setting_t *group, const char *name,
                       const char *const *choices, const char *absent) {
    const char *text = config_text(reader, group, name, absent);
    char list[REASON_SIZE] = "";
    for (int i = 0; choices[i]; i++) {
        if (strcmp(choices[i], text) == 0)
            return i;
        strncat(list, i ? ", " : "", sizeof list - strlen(list) - 1);
        strncat(list, choices[i], sizeof list - strlen(list) - 1);
    }
    config_fail(reader, config_setting_get_member(group, name), "%s: '%.60s' is not one of %s",
                name, text, list);
    return 0;
}

/* Rigid segments have neither stiffness nor damping. Where it is --set that makes them rigid, the
 * springs of the file are what it overrides: they go, and are refused only if --set gives them too.
 */
static void read_stretch(struct config_reader *reader, config_setting_t *group, struct wisp *wisp) {
    static const char *const kinds[] = {
        [STRETCH_SPRING] = "spring", [STRETCH_RIGID] = "rigid", NULL};
    static const char *const of_springs[] = {"stretch_stiffness", "stretch_time"};
    wisp->stretch = (enum stretch)read_choice(reader, group, "stretch", kinds, "spring");
    if (wisp->stretch == STRETCH_SPRING) {
        wisp->stretch_stiffness =
            config_number(reader, group, "stretch_stiffness", NOT_NEGATIVE, 90);
        wisp->stretch_time = config_number(reader, group, "stretch_time", NOT_NEGATIVE, 1.2e-4);
        return;
    }
    const int overridden = config_is_set(config_setting_get_member(group, "stretch"));
    for (int i = 0; i < 2; i++) {
        const config_setting_t *setting = config_setting_get_member(group, of_springs[i]);
        if (setting && overridden && !config_is_set(setting))
            config_setting_remove(group, of_springs[i]);
        else if (setting)
            config_fail(reader, setting,
                        "%s: rigid segments have none; leave it out, or write stretch = "
                        "\"spring\"",
                        of_springs[i]);
    }
}

static void read_material(struct config_reader *reader, config_setting_t *top, struct wisp *wisp) {
    static const char *const known[] = {
        "hair_count",    "hair_density", "stretch",   "stretch_stiffness",
        "stretch_time",  "bending",      "drag_rate", "bending_stiffness",
        "bending_angle", "bending_time", NULL};
    static const char *const laws[] = {
        [BENDING_NONE] = "none", [BENDING_SKIP] = "skip", [BENDING_HINGE] = "hinge", NULL};
    config_setting_t *group = config_group(reader, top, "material");
    if (!group)
        config_fail(reader, top, "material: missing; write material = { }; for the defaults");
    config_known(reader, group, known);
    wisp->hair_count = config_number(reader, group, "hair_count", POSITIVE, 1000);
    wisp->hair_density = config_number(reader, group, "hair_density", POSITIVE, 5.7e-6);
    read_stretch(reader, group, wisp);
    wisp->bending_stiffness = config_number(reader, group, "bending_stiffness", NOT_NEGATIVE, 1e-5);
    wisp->bending_angle = config_number(reader, group, "bending_angle", POSITIVE, 0.3);
    wisp->bending_time = config_number(reader, group, "bending_time", NOT_NEGATIVE, 1e-3);
    wisp->drag_rate = config_number(reader, group, "drag_rate", NOT_NEGATIVE, 4);
    wisp->bending = (enum bending)read_choice(reader, group, "bending", laws, "skip");
}

static void read_envelope(struct config_reader *reader, config_setting_t *top, struct wisp *wisp) {
    static const char *const known[] = {
        "samples", "radius", "mass_fraction", "frequency", "damping_ratio", "penalty_ratio", NULL};
    config_setting_t *group = config_group(reader, top, "envelope");
    if (!group)
        return;
    config_known(reader, group, known);
    const double samples = config_number(reader, group, "samples", WHOLE, 4);
    if (samples < 3 || samples > SAMPLES_MAX)
        config_fail(reader, config_setting_get_member(group, "samples"),
                    "samples: %g is not a whole number from 3 to %d", samples, SAMPLES_MAX);
    else
        wisp->samples = (int)samples;
    wisp->radius = config_number(reader, group, "radius", POSITIVE, 0.02);
    wisp->mass_fraction = config_number(reader, group, "mass_fraction", POSITIVE, 0.15);
    if (wisp->mass_fraction >= 1)
        config_fail(reader, config_setting_get_member(group, "mass_fraction"),
                    "mass_fraction: %g is not between 0 and 1", wisp->mass_fraction);
    wisp->frequency = config_number(reader, group, "frequency", NOT_NEGATIVE, 10);
    wisp->damping_ratio = config_number(reader, group, "damping_ratio", NOT_NEGATIVE, 1);
    wisp->penalty_ratio = config_number(reader, group, "penalty_ratio", NOT_NEGATIVE, 100);
}

static void read_gust(struct config_reader *reader, config_setting_t *group, struct wind *wind) {
    static const char *const known[] = {"kind", "velocity", "hold", "decay", NULL};
    config_known(reader, group, known);
    wind->hold = config_required(reader, group, "hold", NOT_NEGATIVE);
    wind->decay = config_required(reader, group, "decay", POSITIVE);
}

/* Knot times: ascending. Returns their number. */
static int read_times(struct config_reader *reader, config_setting_t *group, double *times) {
    const int count = config_numbers(reader, group, "times", 1, KNOTS_MAX, times);
    if (count == 0)
        config_fail(reader, group, "times: missing; must be 1 to %d numbers in brackets",
                    KNOTS_MAX);
    for (int k = 1; k < count; k++)
        if (times[k] <= times[k - 1])
            config_fail(reader, config_setting_get_member(group, "times"),
                        "times: %g does not come after %g", times[k], times[k - 1]);
    return count;
}

static void read_style(struct config_reader *reader, config_setting_t *top, struct style *style) {
    static const char *const known[] = {"times", "accelerations", NULL};
    config_setting_t *group = config_group(reader, top, "style");
    if (!group || reader->failed)
        return;
    config_known(reader, group, known);
    style->knots = read_times(reader, group, style->time);
    config_vectors(reader, group, "accelerations", style->knots, style->acceleration);
}

static void read_head(struct config_reader *reader, config_setting_t *top,
                      struct head_motion *head) {
    static const char *const known[] = {"times", "positions", "rotations", NULL};
    config_setting_t *group = config_group(reader, top, "head");
    if (!group || reader->failed)
        return;
    config_known(reader, group, known);
    head->knots = read_times(reader, group, head->time);
    config_vectors(reader, group, "positions", head->knots, head->position);
    config_vectors(reader, group, "rotations", head->knots, head->rotation);
}

static void read_irregular(struct config_reader *reader, config_setting_t *group,
                           struct wind *wind) {
    static const char *const known[] = {"kind", "velocity", "amplitudes", "frequencies", NULL};
    config_known(reader, group, known);
    wind->terms = config_numbers(reader, group, "amplitudes", 1, WIND_TERMS_MAX, wind->amplitude);
    const int frequencies =
        config_numbers(reader, group, "frequencies", 1, WIND_TERMS_MAX, wind->frequency);
    if (wind->terms == 0 || wind->terms != frequencies)
        config_fail(reader, group,
                    "wind: amplitudes and frequencies must be there, and equally many");
}

static void read_wind(struct config_reader *reader, config_setting_t *top, struct wind *wind) {
    static const char *const steady[] = {"kind", "velocity", NULL};
    config_setting_t *group = config_group(reader, top, "wind");
    if (!group)
        return;
    const char *kind = config_text(reader, group, "kind", "");
    config_vector(reader, group, "velocity", wind->velocity);
    if (strcmp(kind, "steady") == 0) {
        wind->kind = WIND_STEADY;
        config_known(reader, group, steady);
    } else if (strcmp(kind, "gust") == 0) {
        wind->kind = WIND_GUST;
        read_gust(reader, group, wind);
    } else if (strcmp(kind, "irregular") == 0) {
        wind->kind = WIND_IRREGULAR;
        read_irregular(reader, group, wind);
    } else {
        config_fail(reader, group, "wind: kind '%.60s' is not one of steady, gust, irregular",
                    kind);
    }
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
    static const char *const known[] = {
        "name",    "problem",  "begin",       "duration", "frame_rate", "seed",  "run",
        "gravity", "material", "envelope",    "wisps",    "wind",       "style", "head",
        "body",    "contacts", "subdivision", "start",    "render",     NULL};
    struct wisp material = {0};
    config_known(reader, top, known);
    config_vector(reader, top, "gravity", scene->around.gravity);
    read_material(reader, top, &material);
    read_envelope(reader, top, &material);
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
