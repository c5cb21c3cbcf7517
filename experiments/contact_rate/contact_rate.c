/* How often must contacts be looked at? The thesis does so at 90 Hz and integrates at 9000, "a
 * hundred times rarer without unrealistic movements" (section 4.3.2). Ticks are maps that belong to
 * the model, so that there is a motion for each rate, and no stepper has a part in how far it is
 * from that at 9000 Hz: Runge-Kutta 4 takes the same steps, a 9000th of a second or a fraction of
 * it, at every rate. Beside that error stand the integrator's and the treatment's on the same
 * scene.
 *
 * What contacts decide (in or out, friction or collision) is yes or no, and at 9000 Hz there are
 * many decisions. So the yardstick is run twice, the second time from a start 1e-10 m away and in
 * half the step: up to where these part by a millimetre errors are what they are, and after that
 * runs from starts a micrometre apart are compared, as two distributions. (Of `interactions` with
 * reciprocal responses half the step goes another way than the whole one from 0.2 s on, by a
 * difference of 7e-10 m before; eight starts 1e-10 m apart all go one way, and say nothing.)
 *
 * Bodies can also push at all times, by penalty: pushing.c. */
#include "contact_rate.h"

#include "experiments/common/sets.h"
#include "model/problems.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double wisp_rates[] = {30, 90, 300, 900, 3000, YARDSTICK_RATE};
static const double body_rates[] = {300, 900, 3000, YARDSTICK_RATE};
static const double scatter = 1e-6; /* m; below what is seen, above what Runge-Kutta 4 errs by */

const char *const contact_names[BOTH + 1] = {"no contact", "friction", "collision", "both"};
const char *const source_names[SOURCES] = {"integrator", "treatment", "wisp ticks", "body ticks"};
const double penalty_ratios[PENALTIES] = {100, 300, 1000, 3000};

/* Work is in free nodes times simulated seconds at steps of 1/9000 s: how long a scene is, and
 * which runs it has beside those of its own contact, follows from it. `interactions` has 30,
 * `viscosity` 114, `radii` 183, `wind` 3600. */
static const double most_work = 700, most_quick_work = 120; /* of one run */
static const double cheap_work = 200, cheap_quick_work = 50;

static int is_cheap(const struct plan *plan, const struct study *study) {
    return study->work <= (plan->quick ? cheap_quick_work : cheap_work);
}

/* --- scenes --- */

/* The scene over the study's time. */
static void set_frames(struct sets *sets, const struct study *study) {
    set_add(sets, "frame_rate=%.17e", study->frame_rate);
    set_add(sets, "duration=%.17e", study->duration);
    if (study->set)
        set_add(sets, "%s", study->set);
}

/* With some of its contact, and one of its rates. Nothing is switched on that the scene has not. */
static const struct scene *rate_scene(struct plan *plan, const struct study *study,
                                      const struct series *series, double rate) {
    struct sets sets = {0};
    set_frames(&sets, study);
    if (!json_object_get(study->subject->scene->source, "contacts"))
        set_add(&sets, "contacts={ interpenetration = false; collision = false; }");
    if (!(series->contact & FRICTION))
        set_add(&sets, "contacts.interpenetration=false");
    if (!(series->contact & COLLISION))
        set_add(&sets, "contacts.collision=false");
    set_add(&sets, "contacts.reciprocal=%s", series->reciprocal ? "true" : "false");
    set_add(&sets, "contacts.%s=%.17e",
            series->ticks == WISP_TICKS ? "interaction_rate" : "collision_rate", rate);
    return plan_scene(plan, study->subject->source, sets.list, sets.count);
}

/* --- runs --- */

static struct run_request request_for(const struct study *study, int treatment, double step_share,
                                      double perturbation, int draw) {
    return (struct run_request){.stepper = "rk4",
                                .treatment = wisp_problem.treatments[treatment].name,
                                .step = step_share * study->step,
                                .perturbation = perturbation,
                                .draw = draw};
}

/* One run of a series; returns its place in the plan, or -1. */
static int add_run(struct plan *plan, const struct study *study, const struct series *series,
                   double rate, double step_share, double perturbation, int draw) {
    const struct scene *scene = rate_scene(plan, study, series, rate);
    const struct run_request request =
        request_for(study, WISP_GENERALISED, step_share, perturbation, draw);
    if (!scene || plan_add(plan, scene, &request, study->subject->name, "%s, %g Hz, start %d",
                           series->name, rate, draw))
        return -1;
    return plan->case_count - 1;
}

static int add_point(struct plan *plan, const struct study *study, struct series *series,
                     double rate) {
    struct rate_point *point = &series->point[series->rate_count++];
    *point = (struct rate_point){.rate = rate};
    point->at = add_run(plan, study, series, rate, 1, 0, 0);
    return point->at < 0 ? -1 : 0;
}

/* The rates of the experiment, and the scene's own in its place. */
static int add_points(struct plan *plan, const struct study *study, struct series *series) {
    const struct scene *scene = study->subject->scene;
    const int wisps = series->ticks == WISP_TICKS;
    const double *rates = wisps ? wisp_rates : body_rates;
    const double own = wisps ? scene->interaction.rate : scene->collision_rate;
    const size_t count = (wisps ? sizeof wisp_rates : sizeof body_rates) / sizeof *rates;
    double before = 0;
    for (size_t i = 0; i < count; before = rates[i++]) {
        if (own > before && own < rates[i] && add_point(plan, study, series, own))
            return -1;
        /* --quick leaves out the slowest rate and the one next to the yardstick */
        if ((!plan->quick || (rates[i] != 30 && rates[i] != 3000) || rates[i] == own) &&
            add_point(plan, study, series, rates[i]))
            return -1;
    }
    return 0;
}

static struct series *begin_series(struct study *study, enum tick_kind ticks, int contact,
                                   int reciprocal) {
    struct series *series = &study->series[study->series_count++];
    *series = (struct series){.ticks = ticks, .contact = contact, .reciprocal = reciprocal};
    if (ticks == BODY_TICKS)
        snprintf(series->name, sizeof series->name, "bodies");
    else if (contact == 0)
        snprintf(series->name, sizeof series->name, "%s", contact_names[0]);
    else
        snprintf(series->name, sizeof series->name, "%s, %s", contact_names[contact],
                 reciprocal ? "reciprocal" : "one-sided");
    return series;
}

/* The yardstick's second run is its first in all that should not matter. */
static int add_series(struct plan *plan, struct study *study, enum tick_kind ticks, int contact,
                      int reciprocal) {
    struct series *series = begin_series(study, ticks, contact, reciprocal);
    if (add_points(plan, study, series))
        return -1;
    series->again = add_run(plan, study, series, YARDSTICK_RATE, 0.5, HORIZON_PERTURBATION, 1);
    return series->again < 0 ? -1 : 0;
}

/* The control: without contact there is nothing that a rate could change. */
static int add_control(struct plan *plan, struct study *study) {
    struct series *series = begin_series(study, WISP_TICKS, 0, 1);
    series->again = -1;
    return add_point(plan, study, series, 90) || add_point(plan, study, series, YARDSTICK_RATE) ? -1
                                                                                                : 0;
}

/* Part of the scene's contact at a time, with either response; of an expensive scene parts have its
 * own response alone, with --quick all that it has. */
static int is_asked(const struct plan *plan, const struct study *study, int contact,
                    int reciprocal) {
    if ((contact & study->own_contact) != contact)
        return 0;
    return is_cheap(plan, study) || (contact == study->own_contact && !plan->quick) ||
           reciprocal == study->subject->scene->interaction.reciprocal;
}

static int add_all_series(struct plan *plan, struct study *study) {
    const struct scene *scene = study->subject->scene;
    for (int contact = BOTH; contact > 0; contact--)
        for (int reciprocal = 1; reciprocal >= 0; reciprocal--)
            if (is_asked(plan, study, contact, reciprocal) &&
                add_series(plan, study, WISP_TICKS, contact, reciprocal))
                return -1;
    if (add_control(plan, study))
        return -1;
    if (scene_tick_bodies(scene) > 0 || scene->wisps[0].samples > 0)
        return add_series(plan, study, BODY_TICKS, study->own_contact,
                          scene->interaction.reciprocal);
    return 0;
}

/* A run of the scene as it is, but for its envelope's penalty ratio. Returns its place or -1. */
static int add_source(struct plan *plan, const struct study *study, struct run_request request,
                      double ratio, const char *label) {
    struct sets sets = {0};
    set_frames(&sets, study);
    if (ratio > 0)
        set_add(&sets, "envelope.penalty_ratio=%.17e", ratio);
    const struct scene *scene = plan_scene(plan, study->subject->source, sets.list, sets.count);
    if (!scene || plan_add(plan, scene, &request, study->subject->name, "%s", label))
        return -1;
    return plan->case_count - 1;
}

/* The thesis's recipe, what it approximates, and the exact constrained motion. */
static int add_sources(struct plan *plan, struct study *study) {
    struct run_request euler = request_for(study, WISP_PROJECTION, 1, 0, 0);
    euler.stepper = "euler";
    euler.step = 1 / YARDSTICK_RATE;
    study->has_sources = study->subject->scene->wisps[0].samples > 0;
    if (!study->has_sources)
        return 0;
    study->euler = add_source(plan, study, euler, 0, "euler, 9000 Hz");
    study->reference =
        add_source(plan, study, request_for(study, WISP_PROJECTION, 0.5, 0, 0), 0, "projection");
    study->reference_again =
        add_source(plan, study, request_for(study, WISP_PROJECTION, 1, HORIZON_PERTURBATION, 1), 0,
                   "projection, perturbed");
    if (study->euler < 0 || study->reference < 0 || study->reference_again < 0)
        return -1;
    for (int i = 0; i < PENALTIES; i++) {
        char label[32];
        snprintf(label, sizeof label, "penalty %g", penalty_ratios[i]);
        study->penalty[i] = add_source(plan, study, request_for(study, WISP_PENALTY, 1, 0, 0),
                                       penalty_ratios[i], label);
        if (study->penalty[i] < 0)
            return -1;
    }
    return 0;
}

/* --- the plan --- */

double step_between_ticks(const struct scene *scene) {
    const double own = usual_step(scene, stepper_find("rk4"));
    return 1 / YARDSTICK_RATE / fmax(1, round(1 / (YARDSTICK_RATE * own)));
}

/* A frame rate that writes what is of use, but tells when runs part to a tenth of a second. */
static double frame_rate_of(const struct scene *scene, double duration) {
    const double sparse = sparse_frame_rate(scene, duration), least = 10;
    return sparse >= least ? sparse : scene->frame_rate / fmax(1, floor(scene->frame_rate / least));
}

static void measure_out(const struct plan *plan, struct study *study) {
    const struct scene *scene = study->subject->scene;
    const double most = plan->quick ? most_quick_work : most_work;
    study->step = step_between_ticks(scene);
    const double work = free_nodes(scene) / (study->step * YARDSTICK_RATE);
    study->frame_rate = frame_rate_of(scene, fmin(scene->duration, most / work));
    const double frames = fmax(2, floor(most / work * study->frame_rate + 1e-9));
    study->duration = fmin(scene->duration, frames / study->frame_rate);
    study->work = work * study->duration;
    study->own_contact = (scene->interaction.interpenetration ? FRICTION : 0) |
                         (scene->interaction.collision ? COLLISION : 0);
}

/* `viscosity` has two: at 0.5 /s all that contact does is a third of a millimetre, and no rate can
 * do harm. */
static const struct {
    const char *scene, *set, *name;
    int quick;
} own_subjects[] = {
    {"interactions", NULL, NULL, 1}, {"viscosity", "contacts.viscosity=50", "viscosity-50", 1},
    {"viscosity", NULL, NULL, 0},    {"radii", NULL, NULL, 0},
    {"wind", NULL, NULL, 0},
};
enum { OWN_SUBJECTS = sizeof own_subjects / sizeof *own_subjects };

/* Gives the experiment's own subjects what they have otherwise than their scenes. */
static int set_own_subjects(struct plan *plan, struct contact_rate *all) {
    for (int i = 0; i < plan->subject_count; i++) {
        struct subject *subject = &plan->subjects[i];
        all->study[i].set = own_subjects[i].set;
        if (own_subjects[i].name)
            snprintf(subject->name, sizeof subject->name, "%s%s", own_subjects[i].name,
                     plan->set_count > 0 ? "-changed" : "");
        else if (plan_is_own(plan))
            snprintf(subject->name, sizeof subject->name, "%s", subject->scene->name);
        if (!own_subjects[i].set)
            continue;
        subject->scene = plan_scene(plan, subject->source, &own_subjects[i].set, 1);
        if (!subject->scene)
            return -1;
    }
    return 0;
}

static int contact_rate_plan(struct plan *plan) {
    const char *scenes[OWN_SUBJECTS];
    int count = 0;
    plan->run_seconds = 200;
    for (int i = 0; i < OWN_SUBJECTS; i++) /* those of --quick come first */
        if (!plan->quick || own_subjects[i].quick)
            scenes[count++] = own_subjects[i].scene;
    if (plan_has_no_steppers(plan, "rates") || plan_subjects(plan, scenes, count) ||
        plan_configurations(plan, CONFIGURATION_PLAIN, 0))
        return -1;
    const size_t studies = (size_t)plan->subject_count * sizeof(struct study);
    struct contact_rate *all = plan->memo = calloc(1, sizeof *all + studies + pushing_size(plan));
    if (!all)
        return fail_with(plan->reason, "out of memory");
    all->count = plan->subject_count;
    if (plan->scene_count == 0 && set_own_subjects(plan, all))
        return -1;
    for (int i = 0; i < all->count; i++) {
        struct study *study = &all->study[i];
        study->subject = &plan->subjects[i];
        measure_out(plan, study);
        if (add_all_series(plan, study) || add_sources(plan, study))
            return -1;
    }
    return pushing_plan(plan, &all->pushing, (char *)all->study + studies);
}

/* --- after the horizon --- */

/* At the thesis's rate, at ten times that, and at the yardstick's. */
static int has_members(const struct plan *plan, const struct rate_point *point) {
    return point->rate == 90 || point->rate == YARDSTICK_RATE ||
           (point->rate == 900 && !plan->quick);
}

static int add_members(struct plan *plan, const struct study *study, struct series *series) {
    for (int i = 0; i < series->rate_count; i++) {
        struct rate_point *point = &series->point[i];
        if (!has_members(plan, point))
            continue;
        point->first = plan->case_count;
        point->count = plan->quick ? QUICK_MEMBERS : MEMBERS;
        for (int k = 0; k < point->count; k++)
            if (add_run(plan, study, series, point->rate, 1, scatter, 2 + k) < 0)
                return -1;
    }
    return 0;
}

/* Where the horizon comes before the end, of the scene's own contact; of its parts and the other
 * response in as much as the scene is cheap. */
static int wants_members(const struct plan *plan, const struct study *study,
                         const struct series *series) {
    const int own = series == own_series(study, WISP_TICKS);
    const int whole = series->contact == study->own_contact;
    if (series->again < 0 || series->ticks != WISP_TICKS ||
        !(series->horizon < study->duration - 1e-9))
        return 0;
    if (plan->quick)
        return own && is_cheap(plan, study);
    return own || study->work <= cheap_quick_work || (whole && is_cheap(plan, study));
}

static int contact_rate_refine(struct plan *plan) {
    struct contact_rate *all = plan->memo;
    if (pushing_refine(plan, &all->pushing))
        return -1;
    if (all->members_planned)
        return 0;
    all->members_planned = 1;
    for (int i = 0; i < all->count; i++)
        for (int k = 0; k < all->study[i].series_count; k++) {
            struct study *study = &all->study[i];
            struct series *series = &study->series[k];
            if (series->again >= 0 && read_horizon(plan, series))
                return -1;
            if (wants_members(plan, study, series) && add_members(plan, study, series))
                return -1;
        }
    return 0;
}

const struct experiment contact_rate_experiment = {
    .name = "contact-rate",
    .question = "how often must contacts be looked at, and is that where the largest error is?",
    .thesis = "section 4.3.2",
    .chapter = CHAPTER_MODEL,
    .place = 17,
    .headline = "both, reciprocal",
    .quick_seconds = 9,
    .full_seconds = 70,
    .plan = contact_rate_plan,
    .refine = contact_rate_refine,
    .tabulate = contact_rate_tabulate,
};
