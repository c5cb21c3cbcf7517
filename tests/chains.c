/* Hair by the laws before the thesis's (MODEL: what came before): forces against the written
 * law, momentum and torque, closed solutions, Jacobians against differences, and the source's
 * recurrence. */
#include "model/chains.h"

#include "model/problems.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <gsl/gsl_sf_ellint.h>
#include <gsl/gsl_sf_elljac.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MOST = 40 };

/* A model of one wisp, with its part. */
struct lab {
    struct scene *scene;
    struct model *model;
    struct system *system;
    double *q, *v;
    int n; /* nodes */
};

#define OPEN(lab, name, ...) open_lab(lab, LAB_LOAD(name, __VA_ARGS__))

static void open_lab(struct lab *lab, struct scene *scene) {
    lab->scene = scene;
    lab->model = lab_model(scene, 0, 4);
    lab->system = &lab->model->parts[0].system;
    lab->q = lab->model->parts[0].q;
    lab->v = lab->model->parts[0].v;
    lab->n = scene->wisps[0].nodes;
}

/* Each unknown and each rate moved at random. */
static void shake(struct lab *lab, double size, double speed, unsigned *seed) {
    for (int i = 0; i < lab->system->size; i++) {
        lab->q[i] += lab_between(seed, -size, size);
        lab->v[i] += lab_between(seed, -speed, speed);
    }
}

#define HAIR(direction, nodes) \
    "wisps=({root=[0.1,0.2,-0.3];direction=" direction ";length=0.3;nodes=" nodes ";})"
#define ASKEW HAIR("[0.6,0.2,-0.7]", "9")

/* --- Rosenblum --- */

/* The force of springs and hinges on every node, from the words of the law. */
static void law_forces(const struct lab *lab, double x[MOST][3], double f[MOST][3]) {
    const struct wisp *w = &lab->scene->wisps[0];
    const double l = w->length / (w->nodes - 1), k = w->stretch_stiffness / l,
                 kc = w->bending_stiffness / (l * l);
    memset(f, 0, MOST * sizeof *f);
    for (int i = 1; i < w->nodes - 1; i++) {
        double length = 0, base = 0, along = 0, first = 0, second = 0, dot = 0, high = 0, m[3];
        for (int c = 0; c < 3; c++) {
            const double b = x[i][c] - x[i - 1][c], d = x[i + 1][c] - x[i][c];
            length += d * d;
            base += (b + d) * (b + d);
            along += b * (b + d);
            first += b * b;
            second += d * d;
            dot += b * d;
        }
        for (int c = 0; c < 3; c++) {
            const double pull = k * (l - sqrt(length)) * (x[i + 1][c] - x[i][c]) / sqrt(length);
            f[i][c] -= pull;
            f[i + 1][c] += pull;
            m[c] = x[i][c] - x[i - 1][c] - along / base * (x[i + 1][c] - x[i - 1][c]);
            high += m[c] * m[c];
        }
        const double push = kc * acos(fmin(1, dot / sqrt(first * second))) / sqrt(high);
        for (int c = 0; c < 3 && high > 1e-24; c++) {
            f[i - 1][c] += push * m[c];
            f[i][c] -= 2 * push * m[c];
            f[i + 1][c] += push * m[c];
        }
    }
}

static void places(const struct lab *lab, double x[MOST][3]) {
    double rows[MOST * 8];
    lab->scene->problem->sample(lab->model, rows);
    for (int i = 0; i < lab->n; i++)
        memcpy(x[i], rows + 8 * i + 2, sizeof x[i]);
}

/* acos loses digits near 0, hence 1e-9 of the largest. */
Test(chains, rosenblum_has_the_forces_of_the_law) {
    unsigned seed = 1;
    struct lab lab;
    OPEN(&lab, "rosenblum", ASKEW);
    for (int trial = 0; trial < 20; trial++) {
        double x[MOST][3], f[MOST][3], a[3 * MOST];
        const struct wisp *w = &lab.scene->wisps[0];
        shake(&lab, 0.005, 1, &seed);
        places(&lab, x);
        law_forces(&lab, x, f);
        cr_assert_eq(system_acceleration(lab.system, 0, lab.q, lab.v, a), 0);
        for (int i = 2; i < lab.n; i++)
            for (int c = 0; c < 3; c++) {
                const double expected = f[i][c] / wisp_node_mass(w, i) +
                                        lab.scene->around.gravity[c] -
                                        w->drag_rate * lab.v[3 * (i - 2) + c];
                cr_assert_float_eq(a[3 * (i - 2) + c], expected, 1e-9 * (1e4 + fabs(expected)),
                                   "node %d: %g, %g", i, a[3 * (i - 2) + c], expected);
            }
    }
}

/* With the first four nodes in a row at rest, nothing pulls at the head: what springs and hinges do
 * to the free nodes adds up to no force. Their torque does not vanish: that of each hinge is f
 * (beta - alpha) e x m, of the springs none. */
Test(chains, rosenblum_keeps_momentum_and_turns_unequal_segments) {
    unsigned seed = 2;
    struct lab lab;
    OPEN(&lab, "rosenblum", ASKEW, "gravity=[0.0,0.0,0.0]", "material.drag_rate=0");
    const struct wisp *w = &lab.scene->wisps[0];
    const double l = wisp_spacing(w), kc = w->bending_stiffness / (l * l);
    double rest[6], x[MOST][3], a[3 * MOST], force[3] = {0}, torque[3] = {0}, size = 0, turn = 0;
    memcpy(rest, lab.q, sizeof rest);
    shake(&lab, 0.004, 0, &seed);
    memcpy(lab.q, rest, sizeof rest);
    places(&lab, x);
    cr_assert_eq(system_acceleration(lab.system, 0, lab.q, lab.v, a), 0);
    for (int i = 2; i < lab.n; i++)
        for (int c = 0; c < 3; c++) {
            const int d = (c + 1) % 3, e = (c + 2) % 3;
            const double m = wisp_node_mass(w, i), *f = a + 3 * (i - 2);
            force[c] += m * f[c];
            torque[c] += m * (x[i][d] * f[e] - x[i][e] * f[d]);
            size += fabs(m * f[c]);
        }
    for (int i = 3; i < lab.n - 1; i++) {
        double b[3], c[3], base = 0, alpha = 0, first = 0, second = 0, dot = 0, high, area[3];
        for (int k = 0; k < 3; k++) {
            b[k] = x[i][k] - x[i - 1][k];
            c[k] = x[i + 1][k] - x[i - 1][k];
            base += c[k] * c[k];
            alpha += b[k] * c[k];
            first += b[k] * b[k];
            dot += b[k] * (c[k] - b[k]);
            second += (c[k] - b[k]) * (c[k] - b[k]);
        }
        base = sqrt(base);
        alpha /= base;
        high = sqrt(first - alpha * alpha);
        for (int k = 0; k < 3; k++) /* c x b = |c| height e x m */
            area[k] =
                (c[(k + 1) % 3] * b[(k + 2) % 3] - c[(k + 2) % 3] * b[(k + 1) % 3]) / (base * high);
        const double push = kc * acos(dot / sqrt(first * second)) * (base - 2 * alpha);
        for (int k = 0; k < 3; k++)
            torque[k] -= push * area[k];
        turn += fabs(push);
    }
    cr_assert_gt(turn, 1e-7, "the hinges do not turn anything");
    for (int c = 0; c < 3; c++) {
        cr_assert_float_eq(force[c], 0, 1e-14 * size, "force %g of %g", force[c], size);
        cr_assert_float_eq(torque[c], 0, 1e-14 * size + 1e-9 * turn, "torque %g of %g", torque[c],
                           turn);
    }
}

/* One free node below two that rest is a mass on a spring in air: x = exp(-g t / 2) (cos w t + g /
 * (2 w) sin w t) about where it hangs. The reference is good to 1e-10 of it. */
Test(chains, rosenblum_of_one_node_is_an_oscillator) {
    struct scene *scene =
        LAB_LOAD("rosenblum", HAIR("[0.0,-1.0,0.0]", "3"), "material.stretch_stiffness=2",
                 "material.drag_rate=9", "duration=0.2", "frame_rate=100");
    const struct wisp *w = &scene->wisps[0];
    const double k = w->stretch_stiffness / wisp_spacing(w), m = wisp_node_mass(w, 2);
    const double sag = m * 9.81 / k, rate = sqrt(k / m - 9. * 9 / 4);
    struct lab_run run;
    lab_finish(scene, &(struct run_request){.stepper = "reference"}, &run);
    for (int f = 0; f < run.frames; f++) {
        const double t = run.t[f];
        const double down =
            sag * (1 - exp(-4.5 * t) * (cos(rate * t) + 4.5 / rate * sin(rate * t)));
        const double *row = run.row + (3 * f + 2) * run.columns;
        cr_assert_float_eq(row[3], 0.2 - 0.3 - down, 1e-9 * sag, "t = %g: %.17g, not %.17g", t,
                           row[3], -0.1 - down);
    }
}

/* What is softer than explicit Euler can bear at 60 Hz is no hair: it stretches. So it fails at
 * every stiffness, and says so. */
Test(chains, rosenblum_at_60_Hz_fails_at_every_stiffness) {
    for (int decade = -3; decade <= 5; decade++) {
        const char *const set = printed("material.stretch_stiffness=1e%d", decade);
        struct scene *scene = LAB_LOAD("rosenblum", set, "run.strain_limit=0.1");
        struct lab_run run;
        lab_run(scene, &(struct run_request){.stepper = "euler", .step = 1. / 60}, &run);
        cr_assert_eq(run.result.outcome, DIVERGED, "%s: %s", set, outcome_name(run.result.outcome));
    }
}

/* --- both: Jacobians and frames --- */

/* Central differences err by h^2 times the third derivative, and by rounding over h: with angles of
 * 1 rad and more, 1e-5 of the largest entry of the row. Products, the assembled matrix and the
 * solver then are of one matrix. */
static void check_jacobian(struct lab *lab) {
    const int n = lab->system->size;
    const double h = 1e-6, beta = 0.7e-4, alpha = 0.3e-2;
    double base[3 * MOST], low[3 * MOST], x[3 * MOST], y[3 * MOST], b[3 * MOST];
    double *values = test_room((size_t)lab->system->pattern->column_start[n] * sizeof *values);
    unsigned seed = 5;
    cr_assert_eq(system_linearise(lab->system, JACOBIAN_EXACT, 0, lab->q, lab->v), 0);
    system_assemble(lab->system, alpha, beta, values);
    for (int j = 0; j < 2 * n; j++) {
        double *moved = j < n ? &lab->q[j] : &lab->v[j - n], most = 1;
        double a[3 * MOST];
        memset(x, 0, sizeof x);
        *moved += h;
        system_acceleration(lab->system, 0, lab->q, lab->v, a);
        *moved -= 2 * h;
        system_acceleration(lab->system, 0, lab->q, lab->v, low);
        *moved += h;
        for (int i = 0; i < n; i++)
            base[i] = (a[i] - low[i]) / (2 * h);
        system_product(lab->system, 1, 0, 0, base, y); /* M times it is f's */
        x[j % n] = 1;
        system_product(lab->system, 0, j >= n, j < n, x, b);
        for (int i = 0; i < n; i++)
            most = fmax(most, fabs(y[i]));
        for (int i = 0; i < n; i++)
            cr_assert_float_eq(b[i], y[i], 1e-5 * most, "(%d, %d): %g, by differences %g", i, j,
                               b[i], y[i]);
    }
    for (int i = 0; i < n; i++)
        x[i] = lab_between(&seed, -1, 1);
    system_product(lab->system, 1, -alpha, -beta, x, b);
    memcpy(y, b, sizeof y);
    for (int j = 0; j < n; j++)
        for (int at = lab->system->pattern->column_start[j];
             at < lab->system->pattern->column_start[j + 1]; at++)
            y[lab->system->pattern->row[at]] -= values[at] * x[j];
    for (int i = 0; i < n; i++)
        cr_assert_float_eq(y[i], 0, 1e-12 * (1 + fabs(b[i])), "assembled: row %d is %g off", i,
                           y[i]);
    cr_assert_eq(system_factor(lab->system, alpha, beta), 0);
    system_solve(lab->system, b, y);
    for (int i = 0; i < n; i++)
        cr_assert_float_eq(y[i], x[i], 1e-9, "solved: %g for %g", y[i], x[i]);
}

Test(chains, jacobians_are_derivatives) {
    unsigned seed = 3;
    for (int trial = 0; trial < 6; trial++) {
        struct lab lab;
        if (trial % 2) /* wind couples the two angles */
            OPEN(&lab, "anjyo", ASKEW, "wind={kind=\"steady\";velocity=[3.0,1.0,-2.0];}");
        else
            OPEN(&lab, "rosenblum", ASKEW);
        shake(&lab, trial % 2 ? 0.5 : 0.01, 1, &seed);
        check_jacobian(&lab);
    }
}

/* Where the hair is straight every direction across it is as good as another. */
Test(chains, straight_hair_has_its_hinges_in_the_jacobian) {
    struct lab lab;
    double x[3 * MOST] = {0}, y[3 * MOST];
    OPEN(&lab, "rosenblum", "material.stretch_stiffness=0");
    const struct wisp *w = &lab.scene->wisps[0];
    const double l = wisp_spacing(w), each = w->bending_stiffness / (l * l) * 2 / l;
    cr_assert_eq(system_linearise(lab.system, JACOBIAN_EXACT, 0, lab.q, lab.v), 0);
    x[3 * 4 + 1] = 1; /* node 6 up by 1: hinges at 5, 6, 7 turn by -1/l, 2/l, -1/l of it */
    system_product(lab.system, 0, 0, 1, x, y);
    const double expected[] = {-0.5, 2, -3, 2, -0.5};
    for (int i = 0; i < 5; i++)
        cr_assert_float_eq(y[3 * (2 + i) + 1], each * expected[i], 1e-12 * each, "node %d: %g",
                           4 + i, y[3 * (2 + i) + 1] / each);
}

/* Positions, velocities and accelerations of the nodes belong together, and a state that was
 * written is the one that is read. */
Test(chains, frames_are_of_the_state) {
    unsigned seed = 4;
    for (int p = 0; p < 2; p++) {
        struct lab lab;
        const double h = 1e-5;
        double rows[3][MOST * 8], rates[MOST * 5], a[3 * MOST], q[3 * MOST], v[3 * MOST];
        double *const all[] = {a};
        OPEN(&lab, p ? "anjyo" : "rosenblum", ASKEW);
        const int size = lab.system->size;
        const struct problem *problem = lab.scene->problem;
        shake(&lab, p ? 0.4 : 0.005, 2, &seed);
        memcpy(q, lab.q, (size_t)size * sizeof *q);
        memcpy(v, lab.v, (size_t)size * sizeof *v);
        system_acceleration(lab.system, 0, q, v, a);
        problem->sample_accelerations(lab.model, all, rates);
        problem->sample(lab.model, rows[0]);
        problem->restore(lab.model, rows[0]);
        for (int i = 0; i < size; i++) {
            cr_assert_float_eq(lab.q[i], q[i], 1e-13, "q %d", i);
            cr_assert_float_eq(lab.v[i], v[i], 1e-11, "v %d", i);
        }
        for (int side = 1; side < 3; side++) {
            const double s = side == 1 ? h : -h;
            for (int i = 0; i < size; i++) {
                lab.q[i] = q[i] + s * v[i] + s * s / 2 * a[i];
                lab.v[i] = v[i] + s * a[i];
            }
            problem->sample(lab.model, rows[side]);
        }
        for (int i = 0; i < lab.n; i++)
            for (int c = 0; c < 3; c++) {
                const int at = 8 * i + 2 + c;
                cr_assert_float_eq((rows[1][at] - rows[2][at]) / (2 * h), rows[0][at + 3], 1e-6,
                                   "velocity of node %d", i);
                cr_assert_float_eq((rows[1][at + 3] - rows[2][at + 3]) / (2 * h),
                                   rates[5 * i + 2 + c], 1e-5 * (1 + fabs(rates[5 * i + 2 + c])),
                                   "acceleration of node %d", i);
            }
        cr_assert_eq(rows[0][8 * 1 + 1], 1);
        cr_assert_float_eq(rows[0][8 + 2], 0.1 + 0.3 / 8 * lab.scene->wisps[0].direction[0], 1e-15,
                           "node 1 is not where the head has it");
    }
}

/* --- Anjyo --- */

/* In the plane of its start each segment is a pendulum of w^2 = c i m g l / 2, which begins
 * horizontal: from hanging, sin(angle / 2) = sin(pi/4) cd(w t). The reference is good to 1e-11. */
Test(chains, anjyos_segments_are_pendulums) {
    struct scene *scene = LAB_LOAD("anjyo", "anjyo.c=2.5e6", "frame_rate=60");
    const struct wisp *w = &scene->wisps[0];
    const double l = wisp_spacing(w), m = w->hair_count * w->hair_density * l;
    struct lab_run run;
    lab_finish(scene, &(struct run_request){.stepper = "reference"}, &run);
    for (int f = 0; f < run.frames; f++)
        for (int i = 2; i < w->nodes; i++) {
            const double rate = sqrt(2.5e6 * i * m * 9.81 * l / 2);
            double sn, cn, dn;
            gsl_sf_elljac_e(rate * run.t[f], 0.5, &sn, &cn, &dn);
            const double angle = 2 * asin(sqrt(0.5) * cn / dn);
            const double *row = run.row + (f * w->nodes + i) * run.columns,
                         *before = row - run.columns;
            cr_assert_float_eq(row[2] - before[2], l * sin(angle), 1e-9 * l, "t = %g, segment %d",
                               run.t[f], i);
            cr_assert_float_eq(row[3] - before[3], -l * cos(angle), 1e-9 * l, "t = %g, segment %d",
                               run.t[f], i);
        }
}

/* Out of the plane, with wind: 1/2 (theta'^2 + phi'^2) - c_i (l/2) f.s/l is kept. */
Test(chains, anjyos_segments_keep_their_energy) {
    struct scene *scene =
        LAB_LOAD("anjyo", "anjyo.c=2e5", ASKEW, "wind={kind=\"steady\";velocity=[0.0,0.0,3.0];}");
    const struct wisp *w = &scene->wisps[0];
    const double l = wisp_spacing(w), m = w->hair_count * w->hair_density * l;
    const double force[3] = {0, -9.81 * m, w->drag_rate * 3 * m};
    double first[MOST] = {0};
    struct lab_run run;
    lab_finish(scene, &(struct run_request){.stepper = "reference"}, &run);
    double moved = 0;
    for (int f = 0; f < run.frames; f++)
        for (int i = 2; i < w->nodes; i++) {
            const double *row = run.row + (f * w->nodes + i) * run.columns,
                         *before = row - run.columns;
            double s[3], slip[3];
            for (int c = 0; c < 3; c++) {
                s[c] = row[2 + c] - before[2 + c];
                slip[c] = row[5 + c] - before[5 + c];
            }
            const double across = hypot(s[0], s[2]);
            const double phi_rate = (slip[0] * s[2] - slip[2] * s[0]) / (across * across);
            const double theta_rate = -slip[1] / across;
            const double energy = (theta_rate * theta_rate + phi_rate * phi_rate) / 2 -
                                  2e5 * i / 2 * (force[1] * s[1] + force[2] * s[2]);
            first[i] = f ? first[i] : energy;
            moved = fmax(moved, fabs(phi_rate));
            cr_assert_float_eq(energy, first[i], 1e-7 * fmax(1, fabs(first[i])),
                               "t = %g, segment %d: %g, at first %g", run.t[f], i, energy,
                               first[i]);
        }
    cr_assert_gt(moved, 0.5, "nothing leaves its plane");
}

/* The source's theta <- 2 theta - theta_before + dt^2 theta'' with theta_before = theta - dt theta'
 * at the start: n steps of it round like n^2 epsilon. */
Test(chains, anjyos_recurrence_is_symplectic_euler) {
    static const double rates[] = {30, 60, 240};
    for (int r = 0; r < 3; r++) {
        struct lab lab;
        double now[2 * MOST], before[2 * MOST], a[2 * MOST];
        const double h = 1 / rates[r];
        const int steps = 200;
        unsigned seed = 7;
        const struct stepper_settings settings = {.linear = NULL};
        OPEN(&lab, "anjyo", ASKEW, "anjyo.c=8e4");
        const int size = lab.system->size;
        shake(&lab, 0.3, 1, &seed);
        for (int i = 0; i < size; i++) {
            now[i] = lab.q[i];
            before[i] = lab.q[i] - h * lab.v[i];
        }
        struct stepper *stepper =
            stepper_create(stepper_find("symplectic-euler"), &settings, lab.system);
        for (int n = 0; n < steps; n++) {
            system_acceleration(lab.system, n * h, now, lab.v, a);
            for (int i = 0; i < size; i++) {
                const double next = 2 * now[i] - before[i] + h * h * a[i];
                before[i] = now[i];
                now[i] = next;
            }
            cr_assert_eq(stepper->method->step(stepper, n * h, h, lab.q, lab.v), 0);
            for (int i = 0; i < size; i++)
                cr_assert_float_eq(lab.q[i], now[i], 40 * (n + 1.) * (n + 1.) * 2.2e-16,
                                   "%g Hz, step %d: %.17g, %.17g", rates[r], n + 1, lab.q[i],
                                   now[i]);
        }
        cr_assert_gt(fabs(now[0] - before[0]), 0, "it rests");
        stepper->method->free(stepper);
    }
}

/* A gust's end is a kink of the force, at which every method stops: 0.053 s are six steps of 0.01 s
 * and less, what is left of 0.1 s five. */
Test(chains, steps_end_where_a_gust_does) {
    static const char *const winds[] = {
        "wind={kind=\"steady\";velocity=[1.0,0.0,0.0];}",
        "wind={kind=\"gust\";velocity=[1.0,0.0,0.0];hold=0.053;decay=0.1;}"};
    for (int gust = 0; gust < 2; gust++) {
        struct scene *scene = LAB_LOAD("anjyo", "duration=0.1", "frame_rate=10", winds[gust]);
        struct lab_run run;
        lab_run(scene, &(struct run_request){.stepper = "rk4", .step = 0.01}, &run);
        cr_assert_eq(run.result.counters.steps, 10 + gust, "%lld steps", run.result.counters.steps);
    }
}

/* --- scene files --- */

static const struct {
    const char *scene, *set, *says[2];
} wrongs[] = {
    {"rosenblum", "envelope={}", {"envelope", "unknown"}},
    {"rosenblum", "wind={kind=\"steady\";velocity=[1.0,0.0,0.0];}", {"wind", "unknown"}},
    {"rosenblum", "start=\"x.tsv\"", {"start", "unknown"}},
    {"rosenblum", "material.stretch_time=1e-4", {"stretch_time", "unknown"}},
    {"rosenblum", "material.bending=\"hinge\"", {"bending", "unknown"}},
    {"rosenblum", "run.project=true", {"project", "rigid"}},
    {"rosenblum", HAIR("[1.0,0.0,0.0]", "2"), {"nodes", "from 3"}},
    {"anjyo", "material.stretch_stiffness=90.0", {"stretch_stiffness", "unknown"}},
    {"anjyo", "material.bending_stiffness=1e-5", {"bending_stiffness", "unknown"}},
    {"anjyo", "anjyo.c=0", {"c:", "positive"}},
    {"anjyo", "anjyo.d=1", {"d:", "unknown"}},
    {"anjyo", "run.strain_limit=0.1", {"strain_limit", "unknown"}},
    {"anjyo", HAIR("[0.0,2.0,1e-6]", "5"), {"y axis", "direction"}},
    {"anjyo", HAIR("[0.0,-1.0,0.0]", "5"), {"y axis", "direction"}},
    {"swing", "problem=\"anjyo\"", {"unknown", NULL}},
    {"swing", "problem=\"rosenblun\"", {"rosenblum, anjyo", NULL}},
};

Test(chains, what_the_problems_have_not_is_refused) {
    for (size_t i = 0; i < sizeof wrongs / sizeof *wrongs; i++)
        lab_refuse(wrongs[i].scene, &wrongs[i].set, 1, wrongs[i].says, 2);
    LAB_LOAD("anjyo", HAIR("[0.0,-1.0,3e-6]", "5"));
}

/* Every wisp is alone: two of them are each what it is without the other, to the bit. */
Test(chains, wisps_do_not_feel_each_other) {
    static const char *const names[] = {"rosenblum", "anjyo"};
#define ONE   "{root=[0.0,0.0,0.0];direction=[1.0,0.0,0.1];length=0.2;nodes=6;}"
#define OTHER "{root=[0.0,0.1,0.0];direction=[1.0,0.5,0.1];length=0.3;nodes=9;}"
    for (int p = 0; p < 2; p++) {
        struct scene *both = LAB_LOAD(names[p], "wisps=(" ONE "," OTHER ")", "duration=0.1"),
                     *alone = LAB_LOAD(names[p], "wisps=(" OTHER ")", "duration=0.1");
        const struct run_request request = {.stepper = "rk4", .threads = 2};
        struct lab_run two, one;
        lab_run(both, &request, &two);
        lab_run(alone, &request, &one);
        cr_assert(two.frames == one.frames && two.rows == 15 && one.rows == 9);
        for (int f = 0; f < one.frames; f++)
            for (int i = 0; i < 9; i++)
                cr_assert_eq(memcmp(two.row + (15 * f + 6 + i) * two.columns + 2,
                                    one.row + (9 * f + i) * one.columns + 2, 6 * sizeof(double)),
                             0, "%s: frame %d, node %d", names[p], f, i);
    }
}

/* A run, its picture and the accelerations of its last state, as a user has them. */
Test(chains, a_user_runs_and_draws_them) {
    static const char *const names[] = {"rosenblum", "anjyo"};
    const char *const folder = folder_make();
    gnuplot_stub_quiet();
    for (int p = 0; p < 2; p++) {
        const char *const out = printed("%s/%s", folder, names[p]);
        WORKS("run", names[p], "--duration", "0.2", "--out", out, "--no-progress");
        struct finished *f = WORKS("eval", names[p], "--state", printed("%s/states.tsv", out));
        cr_assert(strstr(f->out, "wisp\tnode\tax\tay\taz"), "%s%s", f->out, f->err);
        WORKS("render", out, "--skeleton", "--frames", "1,4", "--strip", "--out", folder);
        FAILS(1, "", "run", names[p], "--diagnostics", "--out", out, "--no-progress");
    }
}
