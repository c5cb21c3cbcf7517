#include "scene_chains.h"

#include "scene_render.h"
#include "scene_roots.h"
#include "scene_wisps.h"
#include "setting_read.h"

#include <math.h>

void scene_read_rosenblum(struct config_reader *reader, config_setting_t *top,
                          struct scene *scene) {
    struct wisp material = {0};
    scene_read_material(reader, top, &material);
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
    scene_read_material(reader, top, &material);
    scene_read_wind(reader, top, &scene->around.wind);
    settings_read(reader, setting_group(reader, top, "", "anjyo"), "anjyo", scene);
    scene_read_roots(reader, top, &material, scene);
    check_direction(reader, top, scene);
    render_read(reader, top, &scene->render);
}
