#include "scene_render.h"

#include "base/vector.h"

#include <math.h>

struct render_settings render_defaults(void) {
    return (struct render_settings){
        .angle = 0.5, .colour = {0.56, 0.38, 0.21}, .hairs = 50, .pieces = 4};
}

static int read_whole(struct config_reader *reader, config_setting_t *group, const char *name,
                      int least, int most, int absent) {
    const double value = config_number(reader, group, name, WHOLE, absent);
    if (value >= least && value <= most)
        return (int)value;
    config_fail(reader, config_setting_get_member(group, name),
                "%s: %g is not a whole number from %d to %d", name, value, least, most);
    return absent;
}

static void read_view(struct config_reader *reader, config_setting_t *group,
                      struct render_settings *render) {
    render->has_eye = config_numbers(reader, group, "eye", 3, 3, render->eye) > 0;
    render->has_target = config_numbers(reader, group, "target", 3, 3, render->target) > 0;
    render->angle = config_number(reader, group, "angle", POSITIVE, render->angle);
    if (render->angle > 3)
        config_fail(reader, config_setting_get_member(group, "angle"),
                    "angle: %g is not from 0 to 3 rad", render->angle);
    double apart[3];
    for (int k = 0; k < 3; k++)
        apart[k] = render->eye[k] - render->target[k];
    if (render->has_eye && !render->has_target)
        config_fail(reader, config_setting_get_member(group, "eye"),
                    "eye: needs a target = [x, y, z] to look at");
    if (render->has_eye && !(vector_length(apart) > RENDER_NEAREST))
        config_fail(reader, config_setting_get_member(group, "eye"),
                    "eye: must not be where the target is");
}

static void read_looks(struct config_reader *reader, config_setting_t *group,
                       struct render_settings *render) {
    config_numbers(reader, group, "colour", 3, 3, render->colour);
    for (int k = 0; k < 3; k++)
        if (!(render->colour[k] >= 0 && render->colour[k] <= 1))
            config_fail(reader, config_setting_get_member(group, "colour"),
                        "colour: number %d, %g, is not from 0 to 1", k + 1, render->colour[k]);
    if (config_numbers(reader, group, "light", 3, 3, render->light) > 0) {
        const double length = vector_length(render->light);
        if (!(length > 0) || isinf(length))
            config_fail(reader, config_setting_get_member(group, "light"),
                        "light: has no length, or too great a one");
        for (int k = 0; k < 3; k++)
            render->light[k] /= length;
    }
}

/* In a segment of one wisp: more takes minutes and is black. */
static const double most_lines = 1e6;

void render_read(struct config_reader *reader, config_setting_t *top,
                 struct render_settings *render) {
    static const char *const known[] = {"eye",    "target", "angle",  "light",
                                        "colour", "hairs",  "pieces", NULL};
    config_setting_t *group = config_group(reader, top, "render");
    *render = render_defaults();
    if (!group || reader->failed)
        return;
    config_known(reader, group, known);
    read_view(reader, group, render);
    read_looks(reader, group, render);
    render->hairs = read_whole(reader, group, "hairs", 1, 100000, render->hairs);
    render->pieces = read_whole(reader, group, "pieces", 1, 1000, render->pieces);
    if (1.0 * render->hairs * render->pieces > most_lines)
        config_fail(reader, group, "render: %d hairs of %d pieces: must be at most %g in all",
                    render->hairs, render->pieces, most_lines);
}
