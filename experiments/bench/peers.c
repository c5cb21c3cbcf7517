/* One smooth scene by others: the loop that one writes by hand, GSL, and CVODE as it comes, each
 * with its longest step or loosest tolerance that is exact enough, beside the program's own methods
 * with theirs.
 *
 * Others have the plain loop's forces, which are faster for one wisp than the kernel's on one lane,
 * but CVODE, whose Jacobian is the kernel's, has the kernel's. The scene is the smooth `swing`. */
#include "experiments/common/measure.h"
#include "integrators/configurations.h"
#include "model/problems.h"
#include "plain_chain.h"
#include "run/simulation.h"
#include "scene/scene_load.h"
#include "speed.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const struct peer_question peer_questions[PEER_QUESTIONS] = {
    {"1 wisp, 0.1 mm", 1, 1e-4},
    {"64 wisps, 1e-9 m", 64, 1e-9},
};

enum { FRAMES = 30 };
static const double duration = 1; /* s */

/* One wisp's free nodes at the frames, of frame f at f size. */
struct path {
    int size;
    double *x;
};

static struct path path_of(int size) {
    return (struct path){size, zeros((size_t)((FRAMES + 1) * size) * sizeof(double))};
}

/* rms of the distance of nodes, m; infinite where one is nowhere. */
static double path_error(const struct path *path, const struct path *truth) {
    double sum = 0;
    for (int i = path->size; i < (FRAMES + 1) * path->size; i++)
        sum += (path->x[i] - truth->x[i]) * (path->x[i] - truth->x[i]);
    return isfinite(sum) ? sqrt(sum / (FRAMES * path->size / 3.)) : INFINITY;
}

/* --- those who take part --- */

struct peer {
    const char *name;
    const struct configuration *method; /* of the program's own; else NULL */
    const struct chain *chain;
    const struct scene *one, *scene; /* of 1 wisp, and of as many as are asked for */
    struct part *part;               /* of CVODE */
    double setting;                  /* a step, s, or a relative tolerance */
    int wisps;
    int is_adaptive;

    /* Runs its wisps, or where path is not NULL one, of which it writes the frames. Returns 0 where
     * it got to the end. */
    int (*run)(const struct peer *peer, struct path *path);
};

static void keep(struct path *path, int frame, const double *q) {
    if (path)
        memcpy(path->x + frame * path->size, q, (size_t)path->size * sizeof(double));
}

static int run_loop(const struct peer *peer, struct path *path,
                    void (*step)(const struct chain *, double, double *, double *)) {
    const struct chain *chain = peer->chain;
    const double interval = duration / FRAMES;
    const int steps = (int)ceil(interval / peer->setting - 1e-9);
    double q[CHAIN_SIZE_MAX], v[CHAIN_SIZE_MAX] = {0};
    memcpy(q, chain->q, sizeof q);
    for (int f = 1; f <= FRAMES; f++) {
        for (int k = 0; k < steps; k++)
            step(chain, interval / steps, q, v);
        keep(path, f, q);
    }
    return 0;
}

static int run_euler(const struct peer *peer, struct path *path) {
    return run_loop(peer, path, chain_euler);
}

static int run_rk4(const struct peer *peer, struct path *path) {
    return run_loop(peer, path, chain_rk4);
}

static int gsl_rate(double t, const double *y, double *rate, void *chain_) {
    (void)t;
    const struct chain *chain = chain_;
    memcpy(rate, y + chain->size, (size_t)chain->size * sizeof(double));
    chain_acceleration(chain, y, y + chain->size, rate + chain->size);
    return GSL_SUCCESS;
}

static int run_gsl(const struct peer *peer, struct path *path) {
    const struct chain *chain = peer->chain;
    const gsl_odeiv2_system system = {gsl_rate, NULL, 2 * (size_t)chain->size, (void *)chain};
    gsl_odeiv2_driver *driver = gsl_odeiv2_driver_alloc_y_new(&system, gsl_odeiv2_step_rk8pd, 1e-4,
                                                              1e-3 * peer->setting, peer->setting);
    if (!driver)
        out_of_memory();
    double y[2 * CHAIN_SIZE_MAX] = {0}, t = 0;
    int code = 0;
    memcpy(y, chain->q, (size_t)chain->size * sizeof(double));
    for (int f = 1; f <= FRAMES && !code; f++) {
        code = gsl_odeiv2_driver_apply(driver, &t, f * duration / FRAMES, y);
        keep(path, f, y);
    }
    gsl_odeiv2_driver_free(driver);
    return code;
}

static int run_cvode(const struct peer *peer, struct path *path) {
    struct stock *stock = stock_create(peer->part, peer->setting, 1e-3 * peer->setting, 0);
    stock_run(stock, duration, FRAMES, path ? path->x : NULL);
    stock_free(stock);
    return 0;
}

/* --- own methods --- */

struct watcher {
    struct path *path;
    int frame;
};

/* The first wisp's free nodes: rows begin with wisp, node, x, y, z. */
static int watch_frame(void *ctx, const struct model *model, double t, const double *rows) {
    struct watcher *watcher = ctx;
    (void)t;
    for (int i = 0; i < watcher->path->size / 3; i++)
        memcpy(watcher->path->x + watcher->frame * watcher->path->size + 3 * i,
               rows + (i + 2) * model->column_count + 2, 3 * sizeof(double));
    watcher->frame++;
    return 0;
}

static int run_own(const struct peer *peer, struct path *path) {
    struct watcher watcher = {path, 0};
    const struct observer observer = {watch_frame, &watcher};
    const struct configuration *method = peer->method;
    int options = 0;
    while (method->options && method->options[options])
        options++;
    const struct run_request request = {.stepper = method->stepper,
                                        .linear = method->linear,
                                        .options = method->options,
                                        .option_count = options,
                                        .treatment = wisp_problem.treatments[WISP_GENERALISED].name,
                                        .step = peer->setting};
    struct timed_run *run = timed_run(path ? peer->one : peer->scene, &request);
    struct run_result result;
    simulate(run->scene, &run->settings, path ? &observer : NULL, NULL, &result);
    free(run);
    return result.outcome != FINISHED;
}

/* --- how exact is exact enough --- */

enum { PLACES = 400 };

/* Quarters of an octave of steps, of a decade of tolerances. */
static double setting_at(const struct peer *peer, int place) {
    if (peer->is_adaptive)
        return pow(10, -1 - 0.25 * place);
    return duration / FRAMES / ceil(pow(2, 0.25 * place) - 1e-9);
}

/* Whether a run is predicted to take longer than anyone would wait. */
static int is_long(const struct peer *peer) {
    return peer->method &&
           estimated_cost(peer->one, WISP_GENERALISED, peer->method, peer->setting) > 0.1;
}

/* The coarsest setting that is within the target; its error in *error. Returns 0, or -1: there is
 * none that anyone would wait for. */
static int fit(struct peer *peer, double target, const struct path *truth, double *error) {
    const double finest = peer->is_adaptive ? 1e-13 : 1e-5;
    struct path path = path_of(truth->size);
    *error = INFINITY;
    for (int place = 0; place < PLACES && !(*error <= target); place++) {
        peer->setting = setting_at(peer, place);
        if (peer->setting < finest || is_long(peer))
            break;
        *error = peer->run(peer, &path) ? INFINITY : path_error(&path, truth);
    }
    free(path.x);
    return *error <= target ? 0 : -1;
}

static struct path truth_of(const struct chain *chain) {
    struct peer tight = {.chain = chain, .setting = 1e-13};
    struct path path = path_of(chain->size);
    if (run_gsl(&tight, &path))
        give_up("rk8pd does not get to the end of swing");
    return path;
}

/* --- entries --- */

static void run_peer(void *ctx) {
    const struct peer *peer = ctx;
    if (peer->run(peer, NULL))
        give_up("%s does not get to the end of swing", peer->name);
}

static struct scene *scene_of(int wisps) {
    struct scene *scene = bench_scene("swing", NULL, 0);
    const struct wisp first = scene->wisps[0];
    scene->wisps = realloc(scene->wisps, (size_t)wisps * sizeof *scene->wisps);
    if (!scene->wisps)
        out_of_memory();
    for (int k = 0; k < wisps; k++)
        scene->wisps[k] = first;
    scene->wisp_count = wisps;
    return scene;
}

static void enter(struct contest *contest, const struct peer_question *question,
                  const struct peer *peer, const struct path *truth) {
    struct peer *fitted = memcpy(zeros(sizeof *fitted), peer, sizeof *fitted);
    double error;
    if (fit(fitted, question->target, truth, &error))
        return;
    contest_note(contest, "peer setting", question->name, peer->name, fitted->setting);
    contest_note(contest, "peer error", question->name, peer->name, error);
    contest_add(contest, "peer", question->name, peer->name, fitted->wisps * duration, run_peer,
                fitted);
}

void enter_peers(struct contest *contest) {
    struct chain *chain = zeros(sizeof *chain);
    const struct scene *one = scene_of(1);
    chain_init(chain, &one->wisps[0], &one->around);
    const struct path truth = truth_of(chain);
    struct model *model = wisp_problem.create(one, WISP_GENERALISED, 1);
    struct configuration *own = configurations_choose(CONFIGURATION_PLAIN, 0);
    if (!model || !own)
        out_of_memory();
    const struct peer others[] = {
        {.name = "plain loop, Euler", .run = run_euler},
        {.name = "plain loop, RK4", .run = run_rk4},
        {.name = "GSL rk8pd", .run = run_gsl, .is_adaptive = 1},
        {.name = "stock CVODE, KLU", .run = run_cvode, .is_adaptive = 1},
    };
    for (int k = 0; k < PEER_QUESTIONS; k++) {
        const struct peer_question *question = &peer_questions[k];
        const struct scene *scene = scene_of(question->wisps);
        for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
            struct peer peer = others[i];
            peer.chain = chain;
            peer.part = &model->parts[0];
            peer.wisps = 1;
            enter(contest, question, &peer, &truth);
        }
        for (int i = 0; own[i].name; i++)
            if (!(own[i].method->capabilities & STEPPER_ADAPTIVE)) {
                const struct peer peer = {.name = own[i].name,
                                          .method = &own[i],
                                          .one = one,
                                          .scene = scene,
                                          .wisps = question->wisps,
                                          .run = run_own};
                enter(contest, question, &peer, &truth);
            }
    }
}
