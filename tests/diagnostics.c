/* Diagnoses: energies and powers against the twin and against each other, the books of whole runs,
 * and extremes of states that are known. */
#include "experiments/common/diagnostics.h"

#include "base/table.h"
#include "base/vector.h"
#include "model/clock.h"
#include "model/problems.h"
#include "picture/plot.h"
#include "run/record.h"
#include "run/results.h"
#include "run/runs.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp/body.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { ENERGY_COUNT = sizeof(struct energies) / sizeof(double) };
enum { POWER_COUNT = sizeof(struct powers) / sizeof(double) };

static const char *const power_names[] = {
#define X(name, meaning) #name,
    POWERS(X)
#undef X
};

/* Bodies that push by penalty: one around the middle of a wisp, and one around its root. */
enum { PUSHERS = 2 };
static void make_pushers(const struct wisp *wisp, struct body *bodies, struct surroundings *around,
                         unsigned *seed) {
    for (int b = 0; b < PUSHERS; b++) {
        bodies[b] = (struct body){.response = RESPONSE_PENALTY,
                                  .friction = lab_between(seed, 0, 60),
                                  .frequency = lab_between(seed, 2, 20),
                                  .damping_ratio = lab_between(seed, 0, 1.5)};
        for (int k = 0; k < 3; k++) {
            bodies[b].centre[k] = wisp->root[k] + b * wisp->length / 2 * wisp->direction[k];
            bodies[b].radii[k] = lab_between(seed, 0.05, 0.3);
            bodies[b].velocity[k] = lab_between(seed, -0.5, 0.5);
        }
    }
    around->pushing = bodies;
    around->pushing_count = PUSHERS;
}

/* --- energies --- */

/* Each term of the kernel is what the twin's energy loses with that term's constants. */
Test(diagnostics, each_energy_is_the_twins) {
    static struct wisp_twin twin;
    static double q[LAB_SIZE], v[LAB_SIZE], none[LAB_SIZE], Q[LAB_SIZE];
    static const int samples[] = {0, 3, 4, 8};
    unsigned seed = 71;
    int touched = 0;
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        for (int law = 0; law < LAWS; law++)
            for (int nodes = 3; nodes <= 20; nodes++) {
                struct surroundings around = lab_surroundings(WIND_NONE, &seed);
                const struct wisp wisp = lab_wisp(nodes, samples[nodes % 4], law, &seed);
                struct body bodies[PUSHERS];
                struct lab_part part;
                struct energies got;
                make_pushers(&wisp, bodies, &around, &seed);
                double expected[ENERGY_COUNT], all;
                lab_part_make(&part, 1, &wisp, 1, &around, treatment);
                lab_state(&wisp, treatment, STATE_RANDOM, 0, &seed, q, v);
                wisp_twin_init(&twin, &wisp, &around, treatment);
                all = wisp_twin_energy(&twin, 0, q, v);
                expected[0] = all - wisp_twin_energy(&twin, 0, q, none);
                memset(twin.gravity, 0, sizeof twin.gravity);
                expected[1] = all - wisp_twin_energy(&twin, 0, q, v);
                all -= expected[1]; /* of what is positive */
                twin.stretch_constant = 0;
                expected[2] = all - wisp_twin_energy(&twin, 0, q, v);
                twin.bend_constant = 0;
                expected[3] = all - expected[2] - wisp_twin_energy(&twin, 0, q, v);
                twin.pushing_count = 0;
                expected[5] = all - expected[2] - expected[3] - wisp_twin_energy(&twin, 0, q, v);
                expected[4] = all - expected[0] - expected[2] - expected[3] - expected[5];
                touched += expected[5] > 0;
                expected[1] += lab_root_potential(&wisp, &around); /* 0 there, the twin's at 0 */
                lab_place(&part, 0, q, Q);
                cr_assert_eq(part.system.ops->energies(part.system.ctx, 0, Q, v, &got), 0);
                for (int k = 0; k < ENERGY_COUNT; k++)
                    cr_assert(fabs(((double *)&got)[k] - expected[k]) <=
                                  1e-13 * (all + fabs(expected[1])),
                              "%s, bending %s, %d nodes: energy %d is %g, not %g",
                              treatment_names[treatment], law_names[law], nodes, k,
                              ((double *)&got)[k], expected[k]);
            }
    cr_assert_gt(touched, 100, "bodies held something in %d states", touched);
}

/* --- powers --- */

/* A part of the kernel at a state, in surroundings that change in time. */
struct point {
    struct lab_part part;
    double t;
    double q[LAB_LANES * LAB_SIZE], v[LAB_LANES * LAB_SIZE], a[LAB_LANES * LAB_SIZE];
};

static double energy_at(const struct point *point, double dt) {
    static double q[LAB_LANES * LAB_SIZE], v[LAB_LANES * LAB_SIZE];
    const struct system *system = &point->part.system;
    struct energies energies;
    for (int i = 0; i < system->size; i++) {
        q[i] = point->q[i] + dt * (point->v[i] + dt / 2 * point->a[i]);
        v[i] = point->v[i] + dt * point->a[i];
    }
    cr_assert_eq(system->ops->energies(system->ctx, point->t + dt, q, v, &energies), 0);
    return energies_sum(&energies);
}

/* The energy's derivative by time along the model's acceleration, from central differences over h
 * and 2 h whose errors in h^2 cancel. */
static double energy_rate(struct point *point) {
    const struct system *system = &point->part.system;
    const double h = 1e-7;
    cr_assert_eq(system->ops->acceleration(system->ctx, point->t, point->q, point->v, point->a), 0);
    const double near = (energy_at(point, h) - energy_at(point, -h)) / (2 * h);
    const double far = (energy_at(point, 2 * h) - energy_at(point, -2 * h)) / (4 * h);
    return (4 * near - far) / 3;
}

/* Gravity, wind, style and a head that moves and turns, all changing between 0 and 1 s. */
static struct surroundings restless(int head, int style, unsigned *seed) {
    struct surroundings around = lab_surroundings(WIND_IRREGULAR, seed);
    around.style.knots = style ? 2 : 0;
    around.style.parting = (struct parting){.width = 0.05, .normal = {0.6, 0, -0.8}};
    around.head.knots = head ? 3 : 0;
    for (int k = 0; k < 3; k++) {
        around.style.time[k] = around.head.time[k] = k;
        for (int c = 0; c < 3; c++) {
            around.style.acceleration[k][c] = lab_between(seed, -20, 20);
            around.style.parting.acceleration[k][c] = lab_between(seed, -20, 20);
            around.head.position[k][c] = lab_between(seed, -0.01, 0.01);
            around.head.rotation[k][c] = lab_between(seed, -0.5, 0.5);
        }
    }
    return around;
}

/* Random states at a random time: the same ones for the same seed. */
static void make_point(struct point *point, int lanes, struct wisp *wisps, int count,
                       const struct surroundings *around, int treatment, unsigned seed) {
    static double q[LAB_SIZE], v[LAB_SIZE];
    lab_part_make(&point->part, lanes, wisps, count, around, treatment);
    point->t = lab_between(&seed, 0.1, 0.9);
    for (int k = lanes - 1; k >= 0; k--) {
        unsigned of_lane = seed + (unsigned)(k < count ? k : 0);
        lab_state(&wisps[k < count ? k : 0], treatment, k % 2 ? STATE_COMPRESSED : STATE_RANDOM, 0,
                  &of_lane, q, v);
        lab_place(&point->part, k, q, point->q);
        lab_scatter(&point->part, k, v, point->v);
    }
}

static void powers_of(struct point *point, double power[POWER_COUNT]) {
    const struct system *system = &point->part.system;
    struct powers powers;
    cr_assert_eq(system->ops->powers(system->ctx, point->t, point->q, point->v, &powers), 0);
    memcpy(power, &powers, sizeof powers);
}

static double size_of(const double power[POWER_COUNT]) {
    double size = 0;
    for (int k = 0; k < POWER_COUNT; k++)
        size += fabs(power[k]);
    return size;
}

/* The powers together are the energy's derivative: nothing is forgotten, in any treatment, with any
 * bending law, in any lane, whatever the head does. Differences turned out good to 2e-7 of the
 * powers. */
Test(diagnostics, powers_are_the_derivative_of_the_energy) {
    static struct point point;
    static const int samples[] = {0, 3, 4, 8};
    unsigned seed = 72;
    double worst = 0;
    int pushed = 0;
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        for (int law = 0; law < LAWS; law++)
            for (int nodes = 3; nodes <= 16; nodes++)
                for (int lanes = 1; lanes <= LAB_LANES; lanes = lab_wider(lanes)) {
                    const int count = 1 + nodes % lanes;
                    struct surroundings around = restless(nodes % 3 > 0, 1, &seed);
                    struct wisp wisps[LAB_LANES];
                    struct body bodies[PUSHERS];
                    double power[POWER_COUNT], sum = 0;
                    for (int k = 0; k < LAB_LANES; k++)
                        wisps[k] = lab_wisp(nodes, samples[nodes % 4], law, &seed);
                    if (nodes % 2)
                        make_pushers(&wisps[0], bodies, &around, &seed);
                    make_point(&point, lanes, wisps, count, &around, treatment, seed);
                    powers_of(&point, power);
                    const double rate = energy_rate(&point);
                    for (int k = 0; k < POWER_COUNT; k++)
                        sum += power[k];
                    pushed += fabs(power[POWER_COUNT - 1]) > 1e-3 * size_of(power);
                    cr_assert(lab_close(sum, rate, 1e-6 * size_of(power), &worst),
                              "%s, bending %s, %d nodes, %d of %d lanes: %.12g W, differences "
                              "%.12g",
                              treatment_names[treatment], law_names[law], nodes, count, lanes, sum,
                              rate);
                }
    cr_assert_gt(pushed, 20, "bodies put in a thousandth of all power in %d states", pushed);
    cr_log_info("largest difference: %.2g of the tolerance", worst);
}

/* What damps, drags or styles takes its own power with it when it goes, and leaves the others: the
 * sum being right (above), so is each. The treatment's is another in `projection`, which the forces
 * themselves are part of; across the half-lines `penalty` damps whatever the damping ratio; and the
 * head pulls less where dampers do not. */
Test(diagnostics, each_power_goes_with_its_cause) {
    static struct point point;
    unsigned seed = 73;
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        for (int law = 0; law < LAWS; law++)
            for (int cause = 0; cause < 5; cause++) {
                static const char *const gone[] = {"drag", "stretch_damping", "bending_damping",
                                                   "envelope_damping", "style"};
                const int damper = cause >= 1 && cause <= 2;
                struct surroundings around = restless(1, 1, &seed);
                struct wisp wisp = lab_wisp(8, 4, law, &seed);
                double with[POWER_COUNT], without[POWER_COUNT];
                make_point(&point, 1, &wisp, 1, &around, treatment, seed);
                powers_of(&point, with);
                double *const parameter[] = {&wisp.drag_rate, &wisp.stretch_time,
                                             &wisp.bending_time, &wisp.damping_ratio};
                if (cause < 4)
                    *parameter[cause] = 0;
                else
                    around.style.knots = 0;
                make_point(&point, 1, &wisp, 1, &around, treatment, seed);
                powers_of(&point, without);
                for (int k = 0; k < POWER_COUNT; k++) {
                    const char *name = power_names[k];
                    const int other = (strcmp(name, "treatment") == 0 && treatment == 0) ||
                                      (strcmp(name, "head") == 0 && damper);
                    const int left = strcmp(name, gone[cause]) == 0 &&
                                     !(cause == 3 && treatment == WISP_PENALTY);
                    const int bent = strcmp(name, "bending_damping") == 0 && law == BENDING_NONE;
                    if (strcmp(name, gone[cause]) == 0)
                        cr_assert(bent || fabs(with[k]) > fabs(without[k]), "%s is %g and %g", name,
                                  with[k], without[k]);
                    if (left)
                        cr_assert_eq(without[k], 0, "%s is %g without its cause", name, without[k]);
                    else if (!other && strcmp(name, gone[cause]) != 0)
                        cr_assert(fabs(with[k] - without[k]) <= 1e-12 * fabs(with[k]),
                                  "%s: %s is %g, and %g without %s", treatment_names[treatment],
                                  name, with[k], without[k], gone[cause]);
                }
            }
}

/* The dampers' powers are those of the twin's forces, whose head rests; and the head that rests
 * does no work. */
Test(diagnostics, dampers_take_what_the_twins_forces_take) {
    static struct wisp_twin twin;
    static struct point point;
    static double f[LAB_NODES][3];
    unsigned seed = 74;
    for (int law = 0; law < LAWS; law++)
        for (int nodes = 3; nodes <= 16; nodes++) {
            const struct surroundings around = restless(0, 1, &seed);
            struct wisp wisp = lab_wisp(nodes, 0, law, &seed);
            double power[POWER_COUNT];
            memset(wisp.root, 0, sizeof wisp.root); /* from which the unknowns are */
            make_point(&point, 1, &wisp, 1, &around, WISP_GENERALISED, seed);
            powers_of(&point, power);
            wisp_twin_init(&twin, &wisp, &around, WISP_GENERALISED);
            for (int term = WISP_TWIN_STRETCH; term <= WISP_TWIN_BEND; term++) {
                double taken = 0;
                wisp_twin_spring_forces(&twin, (enum wisp_twin_term)term, WISP_TWIN_DAMPING,
                                        point.q, point.v, f[0]);
                for (int i = 2; i < nodes; i++)
                    taken += vector_dot(f[i], point.v + 3 * (i - 2));
                cr_assert(fabs(power[1 + term] - taken) <= 1e-12 * fabs(taken),
                          "bending %s, %d nodes, term %d: %g W, the twin's forces %g",
                          law_names[law], nodes, term, power[1 + term], taken);
            }
            cr_assert_eq(power[5], 0, "a head that rests puts in %g W", power[5]);
        }
}

/* --- the books of runs --- */

struct books {
    int frames;
    struct counters counters; /* of the whole run */
    struct diagnosis frame[400];
};

static int keep_diagnosis(void *ctx, const struct model *model, double t, const double *rows) {
    (void)rows;
    struct books *books = ctx;
    cr_assert(books->frames < 400 && model->diagnosis && model->diagnosis->t == t);
    books->frame[books->frames++] = *model->diagnosis;
    return 0;
}

static void run_with_books(const struct scene *scene, struct run_request request,
                           struct books *books) {
    request.diagnostics = 1;
    *books = (struct books){.frames = 0};
    books->counters = run_finished(scene, &request, keep_diagnosis, books).counters;
}

static double largest_residual(const struct books *books) {
    double most = 0;
    cr_assert_eq(books->frame[0].residual, 0);
    for (int f = 0; f < books->frames; f++)
        most = fmax(most, fabs(books->frame[f].residual));
    return most;
}

static double last_work(const struct books *books) {
    return size_of((const double *)&books->frame[books->frames - 1].work);
}

/* log2 of how the residual falls when the step is halved. */
static double residual_order(const struct scene *scene, const char *stepper, const char *treatment,
                             double rate, struct books *fine) {
    static struct books coarse;
    const struct run_request request = {
        .stepper = stepper, .treatment = treatment, .step = 1 / rate};
    struct run_request half = request;
    half.step /= 2;
    run_with_books(scene, request, &coarse);
    run_with_books(scene, half, fine);
    const double order = log2(largest_residual(&coarse) / largest_residual(fine));
    cr_log_info("%s, %s, %s: residuals %.2e, %.2e J of %.2e J: order %.2f", scene->name, stepper,
                treatment, largest_residual(&coarse), largest_residual(fine), last_work(fine),
                order);
    return order;
}

/* Of rk4 on a swing the works' own error shows, of second order; of the Euler method its own. */
Test(diagnostics, residuals_fall_with_the_step) {
    static struct books books;
    struct scene *scene = LAB_LOAD("swing-envelope", "duration=0.1");
    for (int treatment = 0; treatment < TREATMENTS; treatment++) {
        const char *name = treatment_names[treatment];
        const double order = residual_order(scene, "rk4", name, 120000, &books);
        cr_assert(fabs(order - 2) <= 0.1, "rk4, %s: order %.3f", name, order);
        cr_assert(largest_residual(&books) < 1e-6 * last_work(&books), "rk4, %s: %g J", name,
                  largest_residual(&books));
        cr_assert_neq(books.frame[books.frames - 1].work.treatment, 0);
        const double first = residual_order(scene, "euler", name, 48000, &books);
        cr_assert(fabs(first - 1) <= 0.1, "euler, %s: order %.3f", name, first);
    }
}

/* Where nothing does any work, the residual is the energy's drift alone, and falls as the method
 * has it: a wisp that swings without damping, and one that hangs straight, whose frames are still,
 * in which the samples swing along their lines. */
Test(diagnostics, without_works_the_residual_is_the_methods_drift) {
    static struct books books;
    static const double zero[POWER_COUNT];
    for (int hangs = 0; hangs < 2; hangs++) {
        struct scene *scene = LAB_LOAD("swing-envelope", "duration=0.1", "material.drag_rate=0",
                                       "material.stretch_time=0", "material.bending_time=0",
                                       "envelope.damping_ratio=0");
        if (hangs)
            memcpy(scene->wisps[0].direction, (double[]){0, -1, 0}, 3 * sizeof(double));
        else
            scene->wisps[0].samples = 0;
        const double order = residual_order(scene, "rk4", "generalised", 12000, &books);
        cr_assert(order > 3.8, "order %.3f", order);
        cr_assert(memcmp(&books.frame[books.frames - 1].work, zero, sizeof zero) == 0,
                  "work of nothing: %g J", last_work(&books));
        cr_assert_gt(books.frame[books.frames - 1].energy.kinetic, 1e-9);
    }
}

/* Contacts, bodies and clamps are all in the books: what is left is as small as without them. */
Test(diagnostics, jumps_at_ticks_are_booked) {
    static struct books books;
    static const struct {
        const char *scene, *sets[2];
        enum jump kind;
    } cases[] = {
        {"interactions", {"duration=0.95"}, JUMP_WISP_CONTACT},
        {"viscosity", {"duration=0.3", "contacts.viscosity=50"}, JUMP_WISP_CONTACT},
        {"sphere", {"duration=1.7", "wisps.[0].grid=[1, 1]"}, JUMP_BODY_CONTACT},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (int treatment = 0; treatment < TREATMENTS; treatment++) {
            struct scene *scene = lab_load(cases[i].scene, cases[i].sets, cases[i].sets[1] ? 2 : 1);
            const struct run_request request = {.treatment = treatment_names[treatment],
                                                .step = 1. / 60000};
            run_with_books(scene, request, &books);
            const struct diagnosis *last = &books.frame[books.frames - 1];
            double contacts = 0, jumps = 0;
            for (int f = 0; f < books.frames; f++)
                contacts += books.frame[f].wisp_contacts + books.frame[f].body_contacts;
            for (int k = 0; k < JUMP_COUNT; k++)
                jumps += fabs(last->jump[k]);
            cr_log_info("%s, %s: %g contacts, jump %g, other %g, residual %g of %g J",
                        cases[i].scene, treatment_names[treatment], contacts,
                        last->jump[cases[i].kind], last->other, largest_residual(&books),
                        last_work(&books) + jumps);
            cr_assert_gt(contacts, 0);
            cr_assert_eq((long long)contacts,
                         books.counters.body_contacts + books.counters.wisp_contacts);
            cr_assert_neq(last->jump[cases[i].kind], 0);
            cr_assert(fabs(last->other) <= 1e-12 * (last_work(&books) + jumps), "other: %g J",
                      last->other);
            cr_assert(largest_residual(&books) <= 1e-4 * (last_work(&books) + jumps),
                      "%s, %s: %g J are in no book, of %g", cases[i].scene,
                      treatment_names[treatment], largest_residual(&books),
                      last_work(&books) + jumps);
        }
}

/* An event that no account knows of, such as one that is not written yet, is booked apart. */
static double taken_by_brake;

static enum outcome brake(struct model *model, struct workers *workers, unsigned events,
                          int *changed) {
    struct part *part = &model->parts[0];
    const enum outcome outcome = wisp_problem.tick(model, workers, events, changed);
    const double before = model_energy(model);
    for (int i = 0; i < part->system.size && model->t < 0.05; i++)
        part->v[i] *= 0.5;
    taken_by_brake += model_energy(model) - before;
    changed[0] = 1;
    return outcome;
}

Test(diagnostics, an_unknown_event_is_booked_apart) {
    static struct books books;
    struct scene *scene = LAB_LOAD("swing-envelope", "duration=0.1");
    struct problem braked = wisp_problem;
    braked.tick = brake;
    scene->problem = &braked;
    run_with_books(scene, (struct run_request){.treatment = "generalised"}, &books);
    const struct diagnosis *last = &books.frame[books.frames - 1];
    cr_assert_lt(last->other, -1e-7);
    cr_assert(fabs(last->other - taken_by_brake) <= 1e-12 * fabs(taken_by_brake), "%g J, not %g",
              last->other, taken_by_brake);
    cr_assert(largest_residual(&books) <= 1e-5 * last_work(&books), "residual %g J",
              largest_residual(&books));
}

/* A body that rests takes from what meets it and gives nothing: at a tick the kinetic energy of a
 * bare wisp never grows. What jump_body_contact has besides is the way out: springs are stretched
 * and nodes lifted. (With an envelope a node's samples change their velocity with it, which may
 * well speed them up.) */
Test(diagnostics, bodies_at_rest_add_no_kinetic_energy) {
    struct scene *scene = lab_load("swing", NULL, 0);
    struct body ball = {.centre = {0.12, -0.08, 0.01},
                        .radii = {0.05, 0.04, 0.06},
                        .friction = 50,
                        .elasticity = 0.5,
                        .offset = 1e-4};
    struct stepper_settings settings = {.rtol = 1e-6};
    scene->bodies = &ball;
    scene->body_count = 1;
    struct model *model = lab_model(scene, WISP_GENERALISED, 1);
    struct part *part = &model->parts[0];
    struct account account = {.t = 0};
    struct stepper *stepper = stepper_create(stepper_find("rk4"), &settings, &part->system);
    cr_assert(stepper);
    part->account = &account;
    int touched = 0, changed;
    double lost = 0, elsewhere = 0;
    for (int tick = 1; tick <= 180; tick++) {
        struct energies before, after;
        changed = 0;
        cr_assert_eq(integrate(stepper, (tick - 1) / 300., tick / 300., 40, part->q, part->v), 0);
        model->t = tick / 300.;
        part->system.ops->energies(part->system.ctx, model->t, part->q, part->v, &before);
        const double booked = account.jump[JUMP_BODY_CONTACT];
        cr_assert_eq(wisp_problem.tick(model, NULL, STOP_COLLISION, &changed), FINISHED);
        part->system.ops->energies(part->system.ctx, model->t, part->q, part->v, &after);
        cr_assert(after.kinetic <= before.kinetic * (1 + 1e-14), "tick %d: %g J after %g", tick,
                  after.kinetic, before.kinetic);
        const double jump = energies_sum(&after) - energies_sum(&before);
        cr_assert(fabs(account.jump[JUMP_BODY_CONTACT] - booked - jump) <= 1e-16,
                  "tick %d: booked %g J of %g", tick, account.jump[JUMP_BODY_CONTACT] - booked,
                  jump);
        lost += before.kinetic - after.kinetic;
        elsewhere += jump - (after.kinetic - before.kinetic);
        touched += changed;
    }
    cr_log_info("%d ticks with contact; %g J of motion lost, %g J put into springs and height",
                touched, lost, elsewhere);
    cr_assert(touched > 20 && lost > 1e-5);
    scene->bodies = NULL;
    scene->body_count = 0;
    stepper->method->free(stepper);
}

/* Wisps that interpenetrate drag each other along, and what they lose is lost. */
Test(diagnostics, wisps_that_drag_each_other_only_lose_energy) {
    static struct books books;
    struct scene *scene =
        LAB_LOAD("viscosity", "duration=0.4", "frame_rate=90", "contacts.viscosity=20");
    run_with_books(scene, (struct run_request){.treatment = "penalty"}, &books);
    for (int f = 1; f < books.frames; f++) {
        const struct diagnosis *now = &books.frame[f], *before = now - 1;
        cr_assert(now->wisp_contacts > 0 ||
                  now->jump[JUMP_WISP_CONTACT] == before->jump[JUMP_WISP_CONTACT]);
        cr_assert_leq(now->jump[JUMP_WISP_CONTACT], before->jump[JUMP_WISP_CONTACT]);
    }
    cr_assert_lt(books.frame[books.frames - 1].jump[JUMP_WISP_CONTACT], -1e-5);
}

/* --- bits --- */

Test(diagnostics, bits_depend_neither_on_threads_nor_states_on_diagnoses) {
    static struct books one, other;
    static const char *const steppers[] = {"rk4", "implicit-euler", "cvode"};
    for (int i = 0; i < 3; i++) {
        struct scene *scene = LAB_LOAD("sphere", "duration=0.02", "wisps.[0].grid=[3, 2]",
                                       "body.[0].center=[-0.1, -0.24, 0.0]");
        struct run_request request = {
            .stepper = steppers[i], .treatment = "penalty", .strain_limit = 1};
        struct lab_run plain, diagnosed;
        request.threads = 1;
        run_with_books(scene, request, &one);
        cr_assert_gt(one.frame[one.frames - 1].body_contacts, 0);
        for (request.threads = 2; request.threads <= 3; request.threads++) {
            run_with_books(scene, request, &other);
            cr_assert(one.frames == other.frames &&
                          memcmp(one.frame, other.frame, (size_t)one.frames * sizeof *one.frame) ==
                              0,
                      "%s: other diagnoses with %d threads", steppers[i], request.threads);
        }
        lab_run(scene, &request, &plain);
        request.diagnostics = 1;
        lab_run(scene, &request, &diagnosed);
        cr_assert(plain.frames == diagnosed.frames &&
                      memcmp(plain.row, diagnosed.row,
                             (size_t)(plain.frames * plain.rows * plain.columns) *
                                 sizeof *plain.row) == 0,
                  "%s: other states when diagnosed", steppers[i]);
        cr_assert_eq(plain.result.counters.force_evaluations,
                     diagnosed.result.counters.force_evaluations);
    }
}

/* --- extremes --- */

/* A wisp along x from 0.1 m on, a ball around its node 5, another that touches nothing, and a state
 * that is made here. */
Test(diagnostics, extremes_are_those_of_the_state) {
    static const char *const treatments[] = {"projection", "penalty", "generalised"};
    for (int treatment = 0; treatment < TREATMENTS; treatment++) {
        struct scene *scene = lab_load("swing-envelope", NULL, 0);
        struct body bodies[2] = {{.centre = {0.152, 0.01, 0}, .radii = {0.05, 0.05, 0.05}},
                                 {.centre = {5, 5, 5}, .radii = {1, 1, 1}}};
        struct extremes got;
        struct model *model = lab_model(scene, treatment, 4);
        cr_assert_eq(scene->wisps[0].nodes, 11);
        double *rows = test_room((size_t)(model->row_count * model->column_count) * sizeof *rows);
        cr_assert(rows);
        scene->bodies = bodies;
        scene->body_count = 2;
        wisp_problem.sample(model, rows);
        double *row = rows + 7 * model->column_count, *tip = rows + 10 * model->column_count;
        tip[2] += 0.0015; /* of a segment of 0.03 m */
        for (int s = 0; s < 4 && treatment == WISP_PENALTY; s++)
            tip[8 + 6 * s] += 0.0015;
        row[5] = 3;
        row[7] = -4;
        if (treatment == WISP_PENALTY) {
            row[8 + 1] += 0.01;       /* sample 0 is along y: r = 1.5 R */
            row[8 + 12 + 1] += 0.005; /* sample 2 is along -y: r = 0.75 R */
        } else {
            row[8] = 0.03;
            row[12] = 0.015;
        }
        wisp_problem.restore(model, rows);
        cr_assert_eq(wisp_problem.extremes(model, rows, &got), 0);
        const char *name = treatments[treatment];
        cr_assert_float_eq(got.strain, 0.05, 1e-12, "%s: strain %g", name, got.strain);
        /* nodes 4 to 6 are inside; node 5 is 0.05 - |(0.002, 0.01)| deep */
        cr_assert_eq(got.nodes_inside, 3, "%s: %g nodes inside", name, got.nodes_inside);
        cr_assert_float_eq(got.penetration, 0.05 - hypot(0.002, 0.01), 1e-12, "%s: depth %g", name,
                           got.penetration);
        cr_assert_float_eq(got.least_radius, 0.75, 1e-12, "%s: %g", name, got.least_radius);
        cr_assert_float_eq(got.largest_radius, 1.5, 1e-12, "%s: %g", name, got.largest_radius);
        cr_assert_float_eq(got.speed, 5, 1e-12, "%s: speed %g", name, got.speed);
        scene->bodies = NULL;
        scene->body_count = 0;
    }
}

/* --- the program --- */

Test(diagnostics, the_program_writes_them_where_asked) {
    char reason[REASON_SIZE];
    char *states[2];
    struct table table;
    const char *const folder = folder_make();
    const char *out = printed("%s/run", folder);
    for (int with = 0; with < 2; with++) {
        WORKS("run", "swing", "--duration", "0.1", "--out", out,
              with ? "--diagnostics" : "--no-progress");
        const char *path = printed("%s/states.tsv", out);
        states[with] = file_read(path);
        path = printed("%s/run.json", out);
        char *json = file_read(path);
        cr_assert(states[with] && json);
        cr_assert(
            strstr(json, with ? "\"times_comparable\": false" : "\"times_comparable\": true"));
        path = printed("%s/diagnostics.tsv", out);
        cr_assert_eq(file_exists(path), with);
        if (!with)
            continue;
        cr_assert_eq(table_read(&table, path, reason), 0, "%s", reason);
        cr_assert_eq(table.row_count, 4);
        cr_assert_eq(table_column(&table, "t"), 0);
        cr_assert(isnan(table_value(&table, 1, table_column(&table, "least_radius"))));
        double sum = 0, first = 0;
        for (int c = 1; c <= table_column(&table, "residual"); c++) {
            const int energy = c <= ENERGY_COUNT;
            sum += (energy ? 1 : -1) * table_value(&table, 3, c);
            first += energy ? table_value(&table, 0, c) : 0;
        }
        cr_assert(fabs(sum - first) <= 1e-17, "the columns do not add up: %g J", sum - first);
        table_free(&table);
    }
    cr_assert_str_eq(states[0], states[1], "other states when diagnosed");
    PROGRAM(NULL, "run", "swing", "--duration", "0.1", "--out", out);
    out = printed("%s/run/diagnostics.tsv", folder);
    cr_assert_not(file_exists(out), "diagnoses of an earlier run are left");
    FAILS(1, "scene circle is of problem", "run", "circle", "--diagnostics", "--out", folder);
}

/* The figure of a run, and of each table that an experiment keeps; names are made safe. */
Test(diagnostics, runs_and_experiments_have_their_figures) {
    char reason[REASON_SIZE];
    struct run_case run = {.scene = NULL};
    struct statements statements;
    const char *const folder = folder_make();
    path_format(run.folder, "%s/run", folder);
    WORKS("run", "viscosity", "--duration", "0.1", "--diagnostics", "--out", run.folder);
    WORKS("plot", run.folder);
    cr_assert_eq(count_files(run.folder, "diagnostics."), 3, "no table, .svg and .png");
    const char *const path = printed("%s/kept", folder);
    cr_assert_eq(make_folder(path, reason), 0);
    cr_assert_eq(plot_diagnostics(path, reason), 0, "there is nothing to draw");
    cr_assert_eq(statements_open(&statements, path, NULL, NULL, reason), 0, "%s", reason);
    cr_assert_eq(keep_diagnostics(&run, path, "one", &statements, reason), 0, "%s", reason);
    cr_assert_eq(keep_diagnostics(&run, path, "two/3 4", &statements, reason), 0, "%s", reason);
    cr_assert_eq(plot_diagnostics(path, reason), 1, "%s", reason);
    cr_assert_eq(count_files(path, "diagnostics-one."), 3);
    cr_assert_eq(count_files(path, "diagnostics-two-3-4."), 3);
    path_format(run.folder, "%s/nowhere", folder);
    cr_assert_eq(keep_diagnostics(&run, path, "three", &statements, reason), 0, "%s", reason);
    cr_assert_eq(statements_close(&statements, 0, reason), 0, "%s", reason);
    statements_must_be_whole(path);
    cr_assert_eq(count_files(path, "diagnostics-three."), 0, "a run that died has no diagnoses");
    FAILS(1, "", "plot", run.folder);
}

/* A process that died leaves its diagnoses up to the last complete line. */
Test(diagnostics, a_dead_run_keeps_its_complete_lines) {
    const struct run_request request = {.diagnostics = 1};
    char link[PATH_SIZE], reason[REASON_SIZE];
    struct scene *scene = lab_load("swing", NULL, 0);
    const struct settings settings = settings_of(scene, &request);
    const char *const folder = folder_make();
    file_write(folder, "states.tsv.17.part", "t\n0\n0.1\n");
    file_write(folder, "diagnostics.tsv.17.part", "t\n0\n0.");
    cr_assert_eq(record_death(scene, &settings, folder, CRASHED, "it died", 0.1, reason), 0);
    const char *path = printed("%s/diagnostics.tsv", folder);
    char *kept = file_read(path);
    cr_assert(kept && strcmp(kept, "t\n0\n") == 0, "kept: %s", kept ? kept : "nothing");

    /* somebody has put a link there: what it leads to is not the run's */
    path = file_write(folder, "precious", "t\n0");
    path_format(link, "%s/states.tsv.0.part", folder);
    cr_assert_eq(symlink(path, link), 0);
    cr_assert_eq(record_death(scene, &settings, folder, CRASHED, "it died", 0.1, reason), 0);
    kept = file_read(path);
    cr_assert(kept && strcmp(kept, "t\n0") == 0, "%s", kept ? kept : "it is gone");
}

/* A diagnosed run is another run to experiments. */
Test(diagnostics, diagnosed_runs_have_folders_of_their_own) {
    struct scene *scene = lab_load("swing", NULL, 0);
    char folder[2][PATH_SIZE];
    for (int with = 0; with < 2; with++) {
        const struct run_request request = {.diagnostics = with};
        const struct settings settings = settings_of(scene, &request);
        run_folder("results", scene, &settings, folder[with]);
    }
    cr_assert_str_neq(folder[0], folder[1]);
}

/* What the table has of works the figure draws; energies it takes from the table's columns. */
Test(diagnostics, the_figure_draws_every_work) {
    char *script = file_read(WISPLAB_TESTS_DIR "/../plots/diagnostics.gp");
    const char *works = strstr(script, "WORKS = ");
    cr_assert(works);
#define X(name, meaning)                                  \
    const char *at_##name = strstr(works, "work_" #name); \
    cr_expect(at_##name &&at_##name < strstr(works, "title_of"), "no work_" #name " in it");
    POWERS(X)
#undef X
}
