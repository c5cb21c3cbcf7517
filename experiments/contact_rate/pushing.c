#include "pushing.h"

#include "contact_rate.h"
#include "experiments/common/sets.h"
#include "model/problems.h"
#include "wisp/body.h"

#include <math.h>
#include <string.h>

const double frequency_of[RESPONSES] = {0, 10, 30, 100, 300, 1000};
const char *const hair_names[HAIRS] = {"springs", "rigid"};

/* --- scenes with bodies --- */

/* The most free nodes times seconds at steps of 1/9000 s, see contact_rate.c. */
static const double most_work = 1000, most_quick_work = 60;

/* `sphere` begins when the sphere reaches the first row, and with --quick it meets three wisps in
 * its way. */
static const struct {
    const char *scene, *quick_set;
    double begin; /* s; 0: the scene's own */
    int quick;
} own_scenes[] = {
    {"sphere", "wisps.[0].grid=[3, 1]", 1.2, 1},
    {"wind", NULL, 0, 0},
};
enum { OWN_SCENES = sizeof own_scenes / sizeof *own_scenes };

/* What of a study's scene is otherwise than in its file. */
static void study_sets(const struct pushed *pushed, double rate, struct sets *sets) {
    set_add(sets, "frame_rate=%.17e", pushed->frame_rate);
    set_add(sets, "duration=%.17e", pushed->duration);
    if (pushed->begin > 0)
        set_add(sets, "begin=%.17e", pushed->begin);
    if (pushed->set)
        set_add(sets, "%s", pushed->set);
    if (!json_object_get(pushed->subject.scene->source, "contacts"))
        set_add(sets, "contacts={ interpenetration = false; collision = false; }");
    set_add(sets, "contacts.collision_rate=%.17e", rate);
}

static int add_run(struct plan *plan, const struct pushed *pushed, double rate, double frequency,
                   double step_share, double perturbation, int draw) {
    struct sets sets = {0};
    char name[96];
    study_sets(pushed, rate, &sets);
    const struct run_request request = {.stepper = "rk4",
                                        .treatment = "generalised",
                                        .step = step_share * pushed->step,
                                        .perturbation = perturbation,
                                        .draw = draw,
                                        .states = STATES_BINARY};
    const struct scene *scene = plan_scene(plan, pushed->subject.source, sets.list, sets.count);
    if (frequency > 0)
        scene = plan_push_bodies(plan, scene, frequency);
    if (!scene)
        return -1;
    snprintf(name, sizeof name, "%.70s, bodies", pushed->subject.name);
    if (plan_add(plan, scene, &request, name, "%s %g Hz, start %d",
                 frequency > 0 ? "penalty" : "ticks", frequency > 0 ? frequency : rate, draw))
        return -1;
    return plan->case_count - 1;
}

/* Up to ten frames in the place of one, where that is not too much to write: against a stiff body a
 * node stays for some milliseconds only. */
static double frame_rate_of(const struct scene *scene, double duration) {
    const double most = 2e6; /* numbers, 16 MB */
    const double nodes = free_nodes(scene) + 2. * scene->wisp_count;
    const double numbers = nodes * (9 + 2 * scene->wisps[0].samples) * duration * scene->frame_rate;
    return scene->frame_rate * fmin(10, fmax(1, floor(most / numbers)));
}

static void measure_out(const struct plan *plan, struct pushed *pushed, const struct scene *scene) {
    const double most = plan->quick ? most_quick_work : most_work;
    pushed->step = step_between_ticks(scene);
    const double left = scene->duration - (pushed->begin - scene->begin) * (pushed->begin > 0);
    const double seconds = fmin(left, most / (free_nodes(scene) / (pushed->step * YARDSTICK_RATE)));
    pushed->duration = fmax(2, floor(seconds * scene->frame_rate + 1e-9)) / scene->frame_rate;
    pushed->frame_rate = frame_rate_of(scene, pushed->duration);
}

static int plan_pushed(struct plan *plan, struct pushed *pushed) {
    const struct scene *scene = pushed->subject.scene;
    if (pushed->set)
        scene = plan_scene(plan, pushed->subject.source, &pushed->set, 1);
    if (!scene)
        return -1;
    measure_out(plan, pushed, scene);
    pushed->reference = add_run(plan, pushed, YARDSTICK_RATE, 0, 1, 0, 0);
    pushed->again = add_run(plan, pushed, YARDSTICK_RATE, 0, 0.5, HORIZON_PERTURBATION, 1);
    if (pushed->reference < 0 || pushed->again < 0)
        return -1;
    for (int i = 0; i < RESPONSES; i++) {
        pushed->run[i].at = -1;
        if (plan->quick && frequency_of[i] == 100) /* between the softest and the stiffest */
            continue;
        pushed->run[i].at = add_run(plan, pushed, scene->collision_rate, frequency_of[i], 1, 0, 0);
        if (pushed->run[i].at < 0)
            return -1;
    }
    return 0;
}

static int add_scene(struct plan *plan, struct pushing *pushing, const struct pushed *with) {
    struct pushed *pushed = &pushing->pushed[pushing->pushed_count++];
    *pushed = *with;
    return plan_pushed(plan, pushed);
}

static int add_own_scene(struct plan *plan, struct pushing *pushing, int i) {
    struct pushed pushed = {.subject.source = own_scenes[i].scene,
                            .set = plan->quick ? own_scenes[i].quick_set : NULL,
                            .begin = own_scenes[i].begin};
    snprintf(pushed.subject.name, sizeof pushed.subject.name, "%s", own_scenes[i].scene);
    pushed.subject.scene = plan_scene(plan, own_scenes[i].scene, NULL, 0);
    return pushed.subject.scene ? add_scene(plan, pushing, &pushed) : -1;
}

/* The user's scenes that have bodies at ticks, or our own. */
static int plan_scenes(struct plan *plan, struct pushing *pushing) {
    for (int i = 0; i < plan->subject_count && !plan_is_own(plan); i++) {
        const struct pushed pushed = {.subject = plan->subjects[i]};
        if (scene_tick_bodies(pushed.subject.scene) > 0 && add_scene(plan, pushing, &pushed))
            return -1;
    }
    for (int i = 0; i < OWN_SCENES && plan_is_own(plan); i++)
        if ((own_scenes[i].quick || !plan->quick) && add_own_scene(plan, pushing, i))
            return -1;
    return 0;
}

/* --- the probe --- */

enum { STRIDE = 24 }; /* places to the octave of steps */

/* Between the stops that cut steps. */
static double interval_of(const struct probe *probe) {
    return 1 / (probe->response == TICKS ? probe->scene->collision_rate : stop_rate(probe->scene));
}

double trial_step(const struct probe *probe, const struct push_trial *trial) {
    return trial->place.reached < 0 ? NAN
                                    : place_step(interval_of(probe), STRIDE, trial->place.reached);
}

static int add_step(struct plan *plan, const struct probe *probe, struct push_trial *trial) {
    const double step = place_step(interval_of(probe), STRIDE, trial->place.at);
    struct run_request request =
        configuration_request(trial->method, step, probe->scene->run.atol / probe->scene->run.rtol);
    request.treatment = "generalised";
    request.diagnostics = 1; /* a run whose energy nobody accounts for has diverged */
    trial->run = plan->case_count;
    return plan_add(plan, probe->scene, &request, probe->name, "%s, step %.4g", trial->method->name,
                    step);
}

static int is_too_expensive(const struct probe *probe, const struct push_trial *trial) {
    const double longest_run = 1; /* CPU s, roughly */
    return estimated_cost(probe->scene, WISP_GENERALISED, trial->method,
                          place_step(interval_of(probe), STRIDE, trial->place.at)) > longest_run;
}

static int try_step(struct plan *plan, const struct probe *probe, struct push_trial *trial) {
    trial->done = is_too_expensive(probe, trial);
    if (trial->done)
        snprintf(trial->note, sizeof trial->note, "shorter steps would take more than a second");
    return trial->done ? 0 : add_step(plan, probe, trial);
}

/* Rigid hair takes steps that are ten times longer. */
static int begin_trial(struct plan *plan, struct probe *probe, const struct configuration *method) {
    char reason[REASON_SIZE];
    struct run_request request = configuration_request(method, 1e-3, 1);
    request.treatment = "generalised";
    if (configuration_is_adaptive(method) || !plan_takes(plan, probe->scene, &request, reason))
        return 0;
    const double usual = usual_step(probe->scene, method->method) * (probe->hair ? 10 : 1);
    struct push_trial *trial = &probe->trials[probe->trial_count++];
    *trial = (struct push_trial){.method = method, .error = NAN};
    trial->place = bracket_begin(step_place(interval_of(probe), STRIDE, usual), 0);
    return try_step(plan, probe, trial);
}

/* A ball in the way of `swing`, of the radius of a quarter of the hair's length. */
static const struct scene *probe_scene(struct plan *plan, int hair, int response) {
    static const char ball[] =
        "body=({ name = \"ball\"; center = [0.15, -0.13, 0.01]; radii = [0.06, 0.06, 0.06]; "
        "friction = 50.0; elasticity = 0.1; offset = 1.0e-4; })";
    const char *const sets[] = {"duration=0.6", ball, "material.stretch=rigid"};
    const struct scene *scene = plan_scene(plan, "swing", sets, hair ? 3 : 2);
    return response == TICKS ? scene : plan_push_bodies(plan, scene, frequency_of[response]);
}

static int plan_probe(struct plan *plan, struct pushing *pushing, int hair, int response) {
    struct probe *probe = &pushing->probe[pushing->probe_count++];
    const struct run_request exact = {.stepper = "reference", .treatment = "generalised"};
    probe->hair = hair;
    probe->response = response;
    probe->scene = probe_scene(plan, hair, response);
    snprintf(probe->name, sizeof probe->name, "ball, %s, %g Hz", hair_names[hair],
             frequency_of[response]);
    probe->reference = plan->case_count;
    if (!probe->scene || plan_add(plan, probe->scene, &exact, probe->name, "reference"))
        return -1;
    for (int i = 0; i < plan->configuration_count; i++)
        if (begin_trial(plan, probe, &plan->configurations[i]))
            return -1;
    return 0;
}

/* --quick takes rigid hair, which feels bodies most, at the softest and the stiffest. */
static int plan_probes(struct plan *plan, struct pushing *pushing, struct push_trial *trials) {
    for (int hair = 0; hair < HAIRS; hair++)
        for (int response = 0; response < RESPONSES; response++) {
            if (plan->quick &&
                (hair == 0 || (frequency_of[response] != 10 && frequency_of[response] != 300)))
                continue;
            pushing->probe[pushing->probe_count].trials =
                trials + pushing->probe_count * plan->configuration_count;
            if (plan_probe(plan, pushing, hair, response))
                return -1;
        }
    return 0;
}

size_t pushing_size(const struct plan *plan) {
    return ((size_t)plan->subject_count + OWN_SCENES) * sizeof(struct pushed) +
           HAIRS * RESPONSES * (size_t)plan->configuration_count * sizeof(struct push_trial);
}

int pushing_plan(struct plan *plan, struct pushing *pushing, void *room) {
    pushing->pushed = room;
    struct push_trial *trials =
        (struct push_trial *)(pushing->pushed + plan->subject_count + OWN_SCENES);
    if (plan_scenes(plan, pushing))
        return -1;
    return plan_is_own(plan) ? plan_probes(plan, pushing, trials) : 0;
}

/* --- from round to round --- */

static int is_done(const void *ctx, int i) {
    return ((const struct probe *)ctx)->trials[i].done;
}

static int go_on(struct plan *plan, void *ctx, int i, const struct run_files *reference) {
    const int resolution = plan->quick ? 8 : 2; /* 26 %, 6 % */
    const struct probe *probe = ctx;
    /* a twentieth of the hair's length, as experiment stability has it */
    const double allowed = 0.05 * probe->scene->wisps[0].length;
    struct push_trial *trial = &probe->trials[i];
    struct verdict verdict;
    trial->done = reference->outcome != FINISHED;
    if (trial->done)
        return 0;
    if (judge_runs(plan, trial->run, 1, probe->scene, reference, &verdict))
        return -1;
    const int good = verdict.outcome == FINISHED && verdict.error <= allowed;
    if (good)
        trial->error = verdict.error;
    if (bracket_take(&trial->place, good, STRIDE, resolution))
        return try_step(plan, probe, trial);
    trial->done = 1;
    return 0;
}

int pushing_refine(struct plan *plan, struct pushing *pushing) {
    for (int i = 0; i < pushing->probe_count; i++) {
        struct probe *probe = &pushing->probe[i];
        const struct searches trials = {probe->reference, probe->trial_count, probe, is_done,
                                        go_on};
        if (searches_go_on(plan, &trials))
            return -1;
    }
    return 0;
}

/* --- what runs have shown --- */

const struct push_trial *trial_of(const struct pushing *pushing, int hair, int response,
                                  const char *method, const struct probe **probe) {
    for (int i = 0; i < pushing->probe_count; i++) {
        *probe = &pushing->probe[i];
        if ((*probe)->hair != hair || (*probe)->response != response)
            continue;
        for (int k = 0; k < (*probe)->trial_count; k++)
            if (strcmp((*probe)->trials[k].method->name, method) == 0)
                return &(*probe)->trials[k];
    }
    return NULL;
}

/* How deep a free node is in a body at any frame. */
static double deepest(const struct scene *scene, const struct trajectory *states) {
    double most = 0;
    for (int f = 0; f < states->frame_count; f++) {
        struct placement head;
        const double t = states->frames[f].t;
        head_placement(&scene->around.head, t, &head);
        for (int b = 0; b < scene->body_count; b++) {
            const struct body_motion motion = body_motion(&scene->bodies[b], &head, t);
            for (int r = states->frames[f].row; r < trajectory_end(states, f); r++) {
                const double *row = trajectory_row(states, r);
                if (row[STATE_NODE] >= 2)
                    most = fmax(most, body_depth(&scene->bodies[b], &motion, row + STATE_X));
            }
        }
    }
    return most;
}

static int distance(struct plan *plan, const struct pushed *pushed, const struct run_files *run,
                    const struct run_files *reference, double to, struct deviation *d) {
    const struct trajectory a = frames_between(run->states, -1, to),
                            b = frames_between(reference->states, -1, to);
    *d = (struct deviation){.rms = NAN, .largest = NAN};
    if (run->outcome != FINISHED || reference->outcome != FINISHED || isnan(to))
        return 0;
    return measure_deviation(pushed->subject.scene, &a, &b, 1, d, plan->reason);
}

static int read_one(struct plan *plan, const struct pushed *pushed,
                    const struct run_files *reference, struct pushed_run *one) {
    const struct configuration rk4 = configuration_of(stepper_find("rk4"));
    const struct scene *scene = plan->cases[one->at].run.scene;
    struct run_files run;
    struct deviation near, whole;
    if (plan_read(plan, &plan->cases[one->at], &run))
        return -1;
    const int code = distance(plan, pushed, &run, reference, pushed->horizon, &near) ||
                     distance(plan, pushed, &run, reference, INFINITY, &whole);
    struct cost cost = run_cost(&run);
    cost_count(&cost, scene, WISP_GENERALISED, &rk4);
    one->outcome = run.outcome;
    one->depth = run.outcome == FINISHED ? deepest(scene, run.states) : NAN;
    one->error = near.rms;
    one->largest = near.largest;
    one->whole = whole.rms;
    one->evaluations = cost.evaluations;
    one->counted = cost.counted;
    run_free(&run);
    return code ? -1 : 0;
}

static int read_pushed(struct plan *plan, struct pushed *pushed) {
    struct run_files reference, again;
    struct deviation d;
    if (measure_horizon(plan->trajectories, plan->cases[pushed->reference].run.folder,
                        plan->cases[pushed->again].run.folder, &pushed->horizon, plan->reason) ||
        plan_read(plan, &plan->cases[pushed->reference], &reference))
        return -1;
    int code = plan_read(plan, &plan->cases[pushed->again], &again);
    if (!code) {
        code = distance(plan, pushed, &again, &reference, pushed->horizon, &d);
        pushed->doubt = d.rms;
        run_free(&again);
    }
    for (int i = 0; i < RESPONSES && !code; i++)
        if (pushed->run[i].at >= 0)
            code = read_one(plan, pushed, &reference, &pushed->run[i]);
    run_free(&reference);
    return code ? -1 : 0;
}

int pushing_read(struct plan *plan, struct pushing *pushing) {
    for (int i = 0; i < pushing->pushed_count; i++)
        if (read_pushed(plan, &pushing->pushed[i]))
            return -1;
    return 0;
}
