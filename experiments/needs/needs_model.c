#include "needs_model.h"

#include "base/vector.h"
#include "experiments/common/measure.h"
#include "experiments/common/sets.h"
#include "model/model.h"
#include "model/problems.h"
#include "scene/scene_detail.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>

/* --- what can be chosen --- */

const char *const thing_names[THINGS] = {
#define Y(X, symbol, name, meaning) name,
    EACH_THING(Y, )
#undef Y
};

double value_of(const struct menu *menu, const struct choice *choice, enum thing thing) {
    return menu->option[thing][choice->of[thing]].value;
}

static void __attribute__((format(printf, 4, 5)))
add_option(struct menu *menu, enum thing thing, double value, const char *format, ...) {
    struct option *option = &menu->option[thing][menu->count[thing]++];
    va_list arguments;
    option->value = value;
    va_start(arguments, format);
    vsnprintf(option->name, sizeof option->name, format, arguments);
    va_end(arguments);
}

/* Twice the scene's segments, and then down to half of them. */
static void add_nodes(struct menu *menu, const struct scene *scene, int quick) {
    static const double factors[] = {2, 1.5, 1, 0.7, 0.5};
    int before = 0;
    for (int i = 0; i < 5; i++) {
        const int nodes = detailed_nodes(scene->wisps[0].nodes, factors[i]);
        if (nodes != before && !(quick && i % 2 != 0))
            add_option(menu, NODES, factors[i], "%d nodes", nodes);
        before = nodes;
    }
}

static void add_envelope(struct menu *menu, const struct scene *scene) {
    static const int samples[] = {6, 4, 3};
    const int own = scene->wisps[0].samples, most = own > 8 ? own : 8;
    if (own > 0) {
        add_option(menu, ENVELOPE, most, "%d samples", most);
        for (int i = 0; i < 3; i++)
            add_option(menu, ENVELOPE, samples[i], "%d samples", samples[i]);
    }
    add_option(menu, ENVELOPE, 0, "no envelope");
}

/* Hinges have a limit as nodes grow more, and skip springs have none: their energy goes with the
 * fourth power of an angle that halves. But a start has settled under the scene's own law, and what
 * a scene goes without is not added to its full model. */
static void add_bending(struct menu *menu, const struct scene *scene) {
    static const enum bending laws[] = {BENDING_HINGE, BENDING_SKIP, BENDING_NONE};
    static const char *const names[] = {"hinges", "skip springs", "no bending"};
    const enum bending own = scene->wisps[0].bending,
                       full = own == BENDING_NONE || scene->start.rows ? own : BENDING_HINGE;
    for (int is_first = 1; is_first >= 0; is_first--)
        for (int i = 0; i < 3; i++)
            if ((laws[i] == full) == is_first)
                add_option(menu, BENDING, laws[i], "%s", names[i]);
}

/* Rigid segments are the limit of stiff springs: what hair stretches is left out, and with it the
 * stiffest thing that steps must follow. */
static void add_stretching(struct menu *menu, const struct scene *scene) {
    if (scene->wisps[0].stretch == STRETCH_SPRING)
        add_option(menu, STRETCHING, STRETCH_SPRING, "springs that stretch");
    add_option(menu, STRETCHING, STRETCH_RIGID, "rigid segments");
}

static void add_treatments(struct menu *menu, const struct scene *scene) {
    static const enum wisp_treatment order[] = {WISP_GENERALISED, WISP_PENALTY, WISP_PROJECTION};
    for (int i = 0; i < (scene->wisps[0].samples > 0 ? 3 : 1); i++)
        add_option(menu, TREATMENT, order[i], "%s", wisp_problem.treatments[order[i]].name);
}

/* Twice the scene's rate, and then down to a quarter of it. */
static void add_rates(struct menu *menu, enum thing thing, double rate, int count) {
    for (int i = 0; i < count; i++)
        add_option(menu, thing, ldexp(rate, 1 - i), "%s at %g Hz",
                   thing == COLLISION_RATE ? "bodies" : "wisps", ldexp(rate, 1 - i));
}

/* At ticks, or by penalty of a frequency that little hair is too fast for; bodies that push already
 * are left as they are. */
static void add_bodies(struct menu *menu, const struct scene *scene) {
    const int there = scene_tick_bodies(scene) > 0;
    add_option(menu, BODIES, there ? AT_TICKS : 0, "%s", thing_names[BODIES]);
    if (!there)
        return;
    add_option(menu, BODIES, 100, "bodies by penalty, 100 Hz");
    add_option(menu, BODIES, 30, "bodies by penalty, 30 Hz");
    add_option(menu, BODIES, 0, "no bodies");
}

static void add_switch(struct menu *menu, enum thing thing, int there, const char *off) {
    add_option(menu, thing, there, "%s", thing_names[thing]);
    if (there)
        add_option(menu, thing, 0, "%s", off);
}

static int scene_touches(const struct scene *scene) {
    return scene->interaction.interpenetration || scene->interaction.collision;
}

static int scene_splits(const struct scene *scene) {
    return scene->subdivision.limit > scene->wisp_count;
}

void make_menu(struct menu *menu, const struct scene *scene, int quick) {
    const int touches = scene_touches(scene), splits = scene_splits(scene);
    *menu = (struct menu){.count = {0}};
    add_nodes(menu, scene, quick);
    add_envelope(menu, scene);
    add_bending(menu, scene);
    add_stretching(menu, scene);
    add_treatments(menu, scene);
    add_rates(menu, COLLISION_RATE, scene->collision_rate, scene_tick_bodies(scene) > 0 ? 4 : 1);
    add_rates(menu, INTERACTION_RATE, scene->interaction.rate, touches || splits ? 3 : 1);
    add_switch(menu, INTERACTIONS, touches, "no wisp contact");
    add_bodies(menu, scene);
    add_switch(menu, STYLE, scene->around.style.knots > 0, "no style field");
    add_switch(menu, SPLITS, splits, "no subdivision");
}

int applies(const struct menu *menu, const struct choice *choice, enum thing thing) {
    const int bare = value_of(menu, choice, ENVELOPE) == 0;
    const int untouched = bare || value_of(menu, choice, INTERACTIONS) == 0;
    const int whole = bare || value_of(menu, choice, SPLITS) == 0;
    return !(bare && (thing == TREATMENT || thing == INTERACTIONS || thing == SPLITS)) &&
           !(untouched && whole && thing == INTERACTION_RATE) &&
           !(value_of(menu, choice, BODIES) != AT_TICKS && thing == COLLISION_RATE);
}

/* --- its scene --- */

/* Without bodies there are no ticks of them: nothing is put out, nor are samples that would be
 * nearer to their node than a thousandth of the radius, which bodies bring about. */
static void set_contacts(struct sets *sets, const struct scene *own, const struct menu *menu,
                         const struct choice *choice) {
    const int bodies = value_of(menu, choice, BODIES) != 0;
    const int touch =
        value_of(menu, choice, INTERACTIONS) != 0 && value_of(menu, choice, ENVELOPE) > 0;
    if (!json_object_get(own->source, "contacts"))
        set_add(sets, "contacts={ interpenetration = false; collision = false; }");
    if (scene_tick_bodies(own) > 0)
        set_add(sets, "contacts.collision_rate=%.17e",
                bodies ? value_of(menu, choice, COLLISION_RATE) : 0);
    set_add(sets, "contacts.interaction_rate=%.17e", value_of(menu, choice, INTERACTION_RATE));
    if (!touch) {
        set_add(sets, "contacts.interpenetration=false");
        set_add(sets, "contacts.collision=false");
    }
}

const struct scene *choose_scene(struct plan *plan, const struct subject *subject, double duration,
                                 const struct menu *menu, const struct choice *choice) {
    static const char *const laws[] = {"none", "skip", "hinge"};
    struct sets sets = {0};
    const struct scene *own = subject->scene;
    set_add(&sets, "frame_rate=%.17e", own->frame_rate);
    set_add(&sets, "duration=%.17e", duration);
    set_add(&sets, "material.bending=\"%s\"", laws[(int)value_of(menu, choice, BENDING)]);
    if (value_of(menu, choice, STRETCHING) == STRETCH_RIGID)
        set_add(&sets, "material.stretch=rigid");
    set_contacts(&sets, own, menu, choice);
    if (own->around.style.knots > 0 && value_of(menu, choice, STYLE) == 0)
        set_add(&sets, "style={ times = [0.0]; accelerations = ([0.0, 0.0, 0.0]); }");
    if (scene_splits(own) && value_of(menu, choice, SPLITS) == 0)
        set_add(&sets, "subdivision.limit=%d", own->wisp_count);
    errno = 0;
    const double bodies = value_of(menu, choice, BODIES);
    const struct scene *scene =
        plan_scene_detail(plan, subject->source, sets.list, sets.count,
                          value_of(menu, choice, NODES), (int)value_of(menu, choice, ENVELOPE));
    return bodies > AT_TICKS ? plan_push_bodies(plan, scene, bodies) : scene;
}

/* --- its steps --- */

/* The weight of the free part of a wisp, N. */
static double weight_of(const struct scene *scene, const struct wisp *wisp) {
    double mass = 0;
    for (int i = 2; i < wisp->nodes; i++)
        mass += wisp_node_mass(wisp, i) + wisp->samples * wisp_sample_mass(wisp, i);
    return mass * vector_length(scene->around.gravity);
}

/* A mode that the stiffest of the bodies holds besides: stiffnesses and dampings add up. */
static struct mode mode_against_bodies(const struct scene *scene, struct mode mode) {
    double square = 0, damping = 0;
    for (int b = 0; b < scene->around.pushing_count; b++) {
        const double omega = 2 * acos(-1) * scene->around.pushing[b].frequency;
        square = fmax(square, omega * omega);
        damping = fmax(damping, 2 * scene->around.pushing[b].damping_ratio * omega);
    }
    const double own = mode.frequency * mode.frequency, all = own + square;
    return (struct mode){sqrt(all), (mode.damping_time * own + damping) / all};
}

/* The highest mode of a wisp's stretch and bending springs together is below that of both added up:
 * w^2 = 4 k/m for a chain of springs k, also for springs over every second node; a hinge of energy
 * kappa/2 phi^2 pulls with at most 16 kappa/l^2. Rigid segments have no such mode; the stiffest
 * that they leave is that of nodes across a chain under tension T, w^2 = 4 T/(m l), taken with five
 * times the weight of the free part: a pendulum let go from the horizontal pulls with three times
 * its own.
 */
static struct mode highest_mode(const struct scene *scene, const struct wisp *wisp) {
    const double l = wisp_spacing(wisp), mass = wisp_node_mass(wisp, 2);
    const double stretch = 4 * wisp_stretch_constant(wisp),
                 bending = wisp->bending == BENDING_NONE ? 0
                           : wisp->bending == BENDING_SKIP
                               ? 4 * wisp_bending_constant(wisp)
                               : 16 * wisp_bending_constant(wisp) / (l * l);
    const double tight = wisp->stretch == STRETCH_RIGID ? 4 * 5 * weight_of(scene, wisp) / l : 0;
    const double all = stretch + bending + tight;
    const struct mode mode = {
        sqrt(all / mass),
        all > 0 ? (stretch * wisp->stretch_time + bending * wisp->bending_time) / all : 0};
    return scene->around.pushing_count > 0 ? mode_against_bodies(scene, mode) : mode;
}

/* The longest step that linear theory allows Runge-Kutta 4, times the share, s. */
double recipe_step(const struct scene *scene) {
    const struct stepper_method *rk4 = stepper_find("rk4");
    double step = 1 / scene->frame_rate;
    for (int w = 0; w < scene->wisp_count; w++) {
        const struct mode mode = highest_mode(scene, &scene->wisps[w]);
        while (step > 1e-9 && !is_stable(rk4, &mode, step))
            step *= 0.99;
    }
    return STABILITY_SHARE * step;
}

int may_hold(const struct scene *scene, const struct stepper_method *method, double step) {
    int holds = 1;
    for (int w = 0; w < scene->wisp_count && stepper_is_predictable(method); w++) {
        const struct mode mode = highest_mode(scene, &scene->wisps[w]);
        holds &= is_stable(method, &mode, step / 2);
    }
    return holds;
}

/* Runge-Kutta 4 with contacts and diagnoses, per step and unknown of a scene's wisps; one wisp
 * alone costs less. */
double model_seconds(const struct scene *scene) {
    const double cost = 20e-9;
    return cost * scene_unknowns(scene, WISP_GENERALISED) * scene->duration / recipe_step(scene);
}
