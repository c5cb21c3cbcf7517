/* The hair on which a millimetre is asked for. */
#include "experiments/common/sets.h"
#include "ladder.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double stiffnesses[] = {15, 90, 1500, 16800}; /* EA, N; the last is real hair's */
enum { STIFFNESSES = sizeof stiffnesses / sizeof *stiffnesses };

/* With --quick real hair, many nodes, which are the costliest, and the dampings are left out.
 *
 * Bending of 1e-3 N m2 is stiffer than a matrix of stretching alone can bear; so is the default
 * one between nodes that are four times as close, for its frequencies go with the spacing's inverse
 * square. Hinges are judged out of the plane, where each turns about two axes. */
static const struct hair hairs[] = {
    {.name = "default",
     .phrase = "hair with the scene's bending and damping",
     .quick_end = 3,
     .figure = "ladder"},
    {.name = "rigid segments",
     .phrase = "hair of rigid segments, the limit of stiff springs",
     .sets = {"material.stretch=rigid"},
     .rigid = 1,
     .quick_end = 4,
     .figure = "ladder"},
    {.name = "skip springs, EI 1e-3",
     .phrase = "hair bent by skip springs of 1e-3 N m2",
     .scene = "swing",
     .sets = {"material.bending_stiffness=1e-3"},
     .quick_from = 1,
     .quick_end = 3,
     .figure = "ladder"},
    {.name = "hinges, EI 1e-3",
     .phrase = "hair bent by hinges of 1e-3 N m2 and shaken",
     .scene = "swing-shaken",
     .sets = {"material.bending_stiffness=1e-3"},
     .quick_from = 1,
     .quick_end = 3,
     .figure = "ladder"},
    {.name = "41 nodes",
     .phrase = "hair of 41 nodes",
     .scene = "swing",
     .detail = 4,
     .most = 1500,
     .figure = "ladder"},
    {.name = "damping 0.02",
     .phrase = "hair with damping 0.02",
     .damping = 0.02,
     .figure = "dampings"},
    {.name = "damping 0.1",
     .phrase = "hair with damping 0.1",
     .damping = 0.1,
     .figure = "dampings"},
    {.name = "damping 0.5",
     .phrase = "hair with damping 0.5",
     .damping = 0.5,
     .figure = "dampings"},
};
enum { HAIRS = sizeof hairs / sizeof *hairs };

/* Whoever asks for a scene of his own gets what can be done with that: of rigid segments nothing
 * else. They are one cell, beyond the stiffest. */
static int is_in(const struct plan *plan, const struct scene *asked, const struct hair *hair,
                 int stiffness) {
    const int rigid = asked->wisps[0].stretch == STRETCH_RIGID;
    return (hair->rigid ? stiffness == STIFFNESSES - 1 : !rigid) &&
           (!hair->scene || plan_is_own(plan)) &&
           !(hair->most > 0 && stiffnesses[stiffness] > hair->most) &&
           (!plan->quick || (hair->quick_from <= stiffness && stiffness < hair->quick_end));
}

int ladder_goes_on(const struct ladder *ladder, int cell) {
    return cell > 0 && ladder->cell[cell].hair == ladder->cell[cell - 1].hair;
}

static const struct scene *scene_of(struct plan *plan, const char *source, const struct hair *hair,
                                    const struct sets *sets) {
    return hair->detail > 0
               ? plan_scene_detail(plan, source, sets->list, sets->count, hair->detail, 0)
               : plan_scene(plan, source, sets->list, sets->count);
}

/* On a mode of frequency w a damper of tau times the spring is tau w / 2 of critical. */
static int plan_cell(struct plan *plan, const struct subject *subject, struct cell *cell,
                     struct subject *to) {
    struct sets sets = {0};
    const struct hair *hair = cell->hair;
    const char *source = hair->scene ? hair->scene : subject->source;
    set_add(&sets, "frame_rate=%.17e", subject->scene->frame_rate);
    if (!hair->rigid)
        set_add(&sets, "material.stretch_stiffness=%.17e", cell->stiffness);
    for (int i = 0; hair->sets[i]; i++)
        set_add(&sets, "%s", hair->sets[i]);
    const struct scene *scene = scene_of(plan, source, hair, &sets);
    if (scene && hair->damping > 0) {
        set_add(&sets, "material.stretch_time=%.17e",
                2 * hair->damping / stiffest_mode(scene).frequency);
        scene = scene_of(plan, source, hair, &sets);
    }
    if (!scene)
        return -1;
    const struct mode mode = stiffest_mode(scene);
    cell->damping = hair->rigid ? NAN : mode.damping_time * mode.frequency / 2;
    *to = (struct subject){.scene = scene, .source = source};
    if (hair->rigid)
        snprintf(to->name, sizeof to->name, "%s", hair->name);
    else
        snprintf(to->name, sizeof to->name, "%s, EA %g N", hair->name, cell->stiffness);
    return 0;
}

int ladder_cells(struct plan *plan, struct ladder *ladder) {
    static const char *const own[] = {"swing"};
    if (plan_subjects(plan, own, 1))
        return -1;
    if (plan->subject_count > 1)
        return fail_with(plan->reason, "experiment ladder is of one scene, not of %d",
                         plan->subject_count);
    const struct subject base = plan->subjects[0];
    struct subject *subjects = calloc(LADDER_CELLS, sizeof *subjects);
    if (!subjects)
        return fail_with(plan->reason, "out of memory");
    free(plan->subjects);
    plan->subjects = subjects;
    plan->subject_count = 0;
    for (int h = 0; h < HAIRS; h++)
        for (int k = 0; k < STIFFNESSES; k++) {
            if (!is_in(plan, base.scene, &hairs[h], k))
                continue;
            struct cell *cell = &ladder->cell[ladder->cell_count++];
            *cell = (struct cell){.hair = &hairs[h],
                                  .stiffness = hairs[h].rigid ? INFINITY : stiffnesses[k]};
            if (plan_cell(plan, &base, cell, &subjects[plan->subject_count++]))
                return -1;
        }
    return 0;
}
