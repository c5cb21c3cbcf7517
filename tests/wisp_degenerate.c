/* States in which a formula of the model has nothing to divide by: finite numbers or a failure with
 * its reason, never a NaN in silence; and no harm to a sound wisp in the next lane. */
#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NODES = 7 };

/* Whether the equations have a meaning there, by bending law. */
enum verdict { SOUND, SOUND_BUT_STIFF, REFUSED_WITH_SKIP, REFUSED_ALWAYS };

/* Where the free nodes are, in spacings from node 1 along the wisp and across it. */
static const struct degenerate {
    const char *name;
    double at[NODES - 2][2];
    enum verdict verdict;
} states[] = {
    {"straight", {{1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}}, SOUND},
    {"straight and stretched", {{1.5, 0}, {3, 0}, {4.5, 0}, {6, 0}, {7.5, 0}}, SOUND},
    {"straight but for one rounding", {{1, 0}, {2, 0}, {3, 1e-16}, {4, 0}, {5, 0}}, SOUND},
    {"straight but for 1e-9", {{1, 0}, {2, 1e-9}, {3, 0}, {4, 1e-9}, {5, 0}}, SOUND},
    {"a right angle", {{1, 0}, {1, 1}, {1, 2}, {2, 2}, {3, 2}}, SOUND},
    {"folded at node 3", {{1, 0}, {2, 0}, {1.5, 0}, {0.5, 0}, {-0.6, 0}}, SOUND},
    {"folded at node 1", {{-0.5, 0}, {-1.5, 0}, {-2.5, 0}, {-3.5, 0}, {-4.5, 0}}, SOUND},
    {"folded at each node", {{1, 0}, {0.3, 0}, {1.4, 0}, {0.2, 0}, {1.1, 0}}, SOUND},
    {"folded but for 1e-10", {{1, 0}, {2, 0}, {1.5, 1e-10}, {0.5, 0}, {-0.6, 0}}, SOUND},
    {"folded at the tip", {{1, 0}, {2, 0}, {3, 0}, {4, 0}, {3.2, 0}}, SOUND},
    {"a skip spring of no length", {{1, 0}, {2, 0}, {1, 0}, {1.5, 1}, {2, 1.5}}, REFUSED_WITH_SKIP},
    {"one at node 0", {{-1, 0}, {-2, 0}, {-3, 0}, {-3, 1}, {-3, 2}}, REFUSED_WITH_SKIP},
    {"one at node 1", {{1, 0}, {0, 0}, {-1.2, 0}, {-1.2, 1}, {-2, 2}}, REFUSED_WITH_SKIP},
    {"all of no length", {{1, 0}, {0, 0}, {1, 0}, {0, 0}, {1, 0}}, REFUSED_WITH_SKIP},
    {"a segment of no length", {{1, 0}, {2, 0}, {2, 0}, {3, 0}, {4, 0}}, REFUSED_ALWAYS},
    {"node 2 on node 1", {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}}, REFUSED_ALWAYS},
    {"the last of no length", {{1, 0}, {2, 0}, {3, 0}, {4, 0}, {4, 0}}, REFUSED_ALWAYS},
    {"all in one point", {{0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}}, REFUSED_ALWAYS},
    {"a segment of 1e-12", {{1, 0}, {2, 0}, {2 + 1e-12, 0}, {3, 0}, {4, 0}}, SOUND_BUT_STIFF},
};
enum { DEGENERATE = sizeof states / sizeof *states };

/* A wisp of spacing 0.0625 along x from (-0.0625, 0, 0): the places above are exact numbers. */
static struct wisp wisp_along_x(int samples, enum bending law, unsigned *seed) {
    struct wisp wisp = lab_wisp(NODES, samples, law, seed);
    wisp.length = 0.0625 * (NODES - 1);
    memcpy(wisp.root, (double[3]){-0.0625, 0, 0}, sizeof wisp.root);
    memcpy(wisp.direction, (double[3]){1, 0, 0}, sizeof wisp.direction);
    return wisp;
}

static void fill_state(const struct wisp *wisp, enum wisp_treatment treatment,
                       const struct degenerate *state, unsigned *seed, double *q, double *v) {
    const int unknowns = wisp_node_unknowns(wisp, treatment);
    lab_state(wisp, treatment, STATE_RANDOM, 0, seed, q, v);
    for (int i = 0; i < NODES - 2; i++) {
        const double p[3] = {0.0625 * state->at[i][0], 0.0625 * state->at[i][1], 0};
        for (int j = 0; treatment == WISP_PENALTY && j < wisp->samples; j++)
            for (int k = 0; k < 3; k++)
                q[i * unknowns + 3 + 3 * j + k] += p[k] - q[i * unknowns + k];
        memcpy(q + i * unknowns, p, sizeof p);
    }
}

static int all_finite(const double *x, int n) {
    for (int i = 0; i < n; i++)
        if (!isfinite(x[i]))
            return 0;
    return 1;
}

static double Q[LAB_LANES * LAB_SIZE], V[LAB_LANES * LAB_SIZE], A[LAB_LANES * LAB_SIZE],
    B[LAB_LANES * LAB_SIZE];

/* A failure has a code and a reason; success has numbers. */
static void check_answer(int code, int refused, const struct system *system, const double *x,
                         const char *what) {
    if (refused)
        cr_assert(code != 0 && abs(code) < OUTCOME_COUNT && system->reason[0] != '\0',
                  "%s: code %d, reason '%s'", what, code, system->reason);
    else
        cr_assert(code == 0 && (!x || all_finite(x, system->size)), "%s: code %d (%s)%s", what,
                  code, system->reason, code ? "" : ", and not finite");
}

static void check_matrices(struct lab_part *part, int refused, int stiff, const char *what) {
    for (int kind = 0; kind < JACOBIAN_COUNT; kind++) {
        const char *const text = printed("%s, %s Jacobian", what, jacobian_choices[kind]);
        part->system.reason[0] = '\0';
        const int code = system_linearise(&part->system, (enum jacobian)kind, 0.3, Q, V);
        check_answer(code, refused, &part->system, NULL, text);
        if (refused)
            continue;
        system_product(&part->system, 1, -1e-3, -1e-6, V, B);
        cr_assert(all_finite(B, part->system.size), "%s: a product is not finite", text);
        if (kind != JACOBIAN_SPD)
            continue;
        const int failed = system_factor(&part->system, 1e-3, 1e-6);
        if (failed &&
            stiff) /* 1/L^2 = 1e27 beside the masses: rounding may not leave it definite */
            continue;
        cr_assert_eq(failed, 0, "%s: %s", text, part->system.reason);
        system_solve(&part->system, V, B);
        cr_assert(all_finite(B, part->system.size), "%s: a solution is not finite", text);
    }
}

/* The state in one lane or in four, and in lane `lane` of four beside a sound wisp, whose bits must
 * be what they are beside itself. */
static void check_state(const struct degenerate *state, int samples, enum bending law,
                        enum wisp_treatment treatment, unsigned *seed) {
    static double q[LAB_SIZE], v[LAB_SIZE], sound_q[LAB_SIZE], sound_v[LAB_SIZE], own[LAB_SIZE],
        other[LAB_SIZE];
    const struct surroundings around = lab_surroundings(WIND_STEADY, seed);
    const struct wisp wisp = wisp_along_x(samples, law, seed);
    struct wisp wisps[LAB_LANES];
    const int refused = state->verdict == REFUSED_ALWAYS ||
                        (state->verdict == REFUSED_WITH_SKIP && law == BENDING_SKIP);
    struct lab_part part;
    for (int k = 0; k < LAB_LANES; k++)
        wisps[k] = k < 2 ? wisp : lab_wisp(NODES, samples, law, seed);
    fill_state(&wisp, treatment, state, seed, q, v);
    lab_state(&wisps[2], treatment, STATE_RANDOM, 0, seed, sound_q, sound_v);

    for (int lanes = 1; lanes <= LAB_LANES; lanes = lab_wider(lanes)) {
        lab_part_make(&part, lanes, wisps, lanes, &around, treatment);
        for (int k = 0; k < lanes; k++) {
            lab_place(&part, k, k < 2 ? q : sound_q, Q);
            lab_scatter(&part, k, k < 2 ? v : sound_v, V);
        }
        const char *const what =
            printed("%s, %s, bending %s, %d samples, %d lanes", state->name,
                    treatment_names[treatment], law_names[law], samples, lanes);
        part.system.reason[0] = '\0';
        check_answer(system_acceleration(&part.system, 0.3, Q, V, A), refused, &part.system, A,
                     what);
        if (lanes > 1 && !refused) {
            lab_gather(&part, 2, A, other);
            cr_assert_eq(memcmp(other, own, (size_t)part.size * sizeof *own), 0,
                         "%s: the sound wisp has other bits", what);
        }
        check_matrices(&part, refused, state->verdict == SOUND_BUT_STIFF, what);

        lab_part_make(&part, 1, &wisps[2], 1, &around, treatment);
        lab_place(&part, 0, sound_q, Q);
        cr_assert_eq(system_acceleration(&part.system, 0.3, Q, sound_v, own), 0);
    }
}

Test(wisp_degenerate, states_have_finite_accelerations_or_a_reason) {
    static const int samples[] = {0, 3, 4, 5};
    unsigned seed = 41;
    for (int s = 0; s < DEGENERATE; s++)
        for (int treatment = 0; treatment < TREATMENTS; treatment++)
            for (int law = 0; law < LAWS; law++)
                for (int m = 0; m < 4; m++)
                    check_state(&states[s], samples[m], (enum bending)law,
                                (enum wisp_treatment)treatment, &seed);
}

/* The twin agrees where both have an answer: the branches for straight and folded wisps are those
 * of the model. Both sit on a fold's edge with a condition of 1e10 (|t + t'| = 1e-10). */
Test(wisp_degenerate, the_twin_takes_the_same_branches) {
    static struct wisp_twin twin;
    static double q[LAB_SIZE], v[LAB_SIZE], a[LAB_SIZE], b[LAB_SIZE], scale[LAB_SIZE];
    unsigned seed = 42;
    for (int s = 0; s < DEGENERATE; s++)
        for (int treatment = 0; treatment < TREATMENTS; treatment++)
            for (int law = 0; law < LAWS; law++) {
                const struct surroundings around = lab_surroundings(WIND_STEADY, &seed);
                const struct wisp wisp = wisp_along_x(4, (enum bending)law, &seed);
                struct lab_part part;
                fill_state(&wisp, (enum wisp_treatment)treatment, &states[s], &seed, q, v);
                lab_part_make(&part, 1, &wisp, 1, &around, (enum wisp_treatment)treatment);
                wisp_twin_init(&twin, &wisp, &around, (enum wisp_treatment)treatment);
                lab_place(&part, 0, q, Q);
                const int code = system_acceleration(&part.system, 0.3, Q, v, a);
                cr_assert_eq(code != 0, wisp_twin_acceleration(&twin, 0.3, q, v, b) != 0,
                             "%s: kernel %d", states[s].name, code);
                if (!code) {
                    wisp_twin_scale(&twin, 0.3, q, v, scale);
                    for (int i = 0; i < part.size; i++)
                        cr_assert(fabs(a[i] - b[i]) <= 1e-13 * scale[i],
                                  "%s, %s, bending %s, unknown %d: %.17g, twin %.17g",
                                  states[s].name, treatment_names[treatment], law_names[law], i,
                                  a[i], b[i]);
                }
            }
}

/* Numbers that are none, or overflow: in q or v, in a part of its own or in a lane. */
Test(wisp_degenerate, what_is_not_finite_does_not_pass_in_silence) {
    static double q[LAB_SIZE], v[LAB_SIZE];
    static const double poison[] = {NAN, INFINITY, -INFINITY, 1e200, -1e308};
    unsigned seed = 43;
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        for (int law = 0; law < LAWS; law++)
            for (int p = 0; p < 5; p++)
                for (int in_velocity = 0; in_velocity < 2; in_velocity++)
                    for (int lanes = 1; lanes <= LAB_LANES; lanes = lab_wider(lanes))
                        for (int u = 0; u < 14; u++) {
                            const struct surroundings around = lab_surroundings(WIND_NONE, &seed);
                            const struct wisp wisp = lab_wisp(NODES, 4, (enum bending)law, &seed);
                            struct lab_part part;
                            lab_part_make(&part, lanes, &wisp, 1, &around,
                                          (enum wisp_treatment)treatment);
                            lab_state(&wisp, (enum wisp_treatment)treatment, STATE_RANDOM, 0, &seed,
                                      q, v);
                            for (int k = 0; k < lanes; k++) {
                                lab_place(&part, k, q, Q);
                                lab_scatter(&part, k, v, V);
                            }
                            (in_velocity ? V : Q)[u * lanes + lanes / 2] = poison[p];
                            const int code = system_acceleration(&part.system, 0.3, Q, V, A);
                            /* not in silence: a code with a reason, or numbers that show it, which
                             * steppers with error control and every stop of a run look for */
                            if (code)
                                cr_assert(abs(code) < OUTCOME_COUNT && part.system.reason[0],
                                          "a failure without code or reason");
                            else if (!isfinite(poison[p]))
                                cr_assert(!all_finite(A, part.system.size),
                                          "%s: %g in %c[%d] vanishes", treatment_names[treatment],
                                          poison[p], in_velocity ? 'v' : 'q', u);
                        }
}

/* --- runs that meet such states --- */

/* A wisp that falls along itself, from straight up: its mirror symmetry keeps it straight until
 * rounding or its fold decides. Whatever happens, a run ends with an outcome and its reason, and
 * all its frames are finite. */
Test(wisp_degenerate, runs_end_with_an_outcome_and_finite_frames) {
    static const char *const laws[] = {"material.bending=\"none\"", "material.bending=\"skip\"",
                                       "material.bending=\"hinge\""};
    for (int law = 0; law < 3; law++)
        for (int m = 0; stepper_methods[m]; m++)
            for (int treatment = 0; treatment < TREATMENTS; treatment++) {
                struct scene *scene = LAB_LOAD(
                    "swing-envelope", laws[law], "duration=0.4", "material.stretch_stiffness=2.0",
                    "material.stretch_time=1e-2", "material.bending_stiffness=1e-8",
                    "wisps=({ root=[0,0,0]; direction=[0,1,0]; length=0.3; nodes=5; })");
                struct run_request request = lab_request(stepper_methods[m], treatment);
                struct lab_run run;
                if (!(stepper_methods[m]->capabilities & STEPPER_ADAPTIVE))
                    request.step = 1e-4;
                else if (!stepper_methods[m]->checked_by)
                    request.rtol = 1e-4;
                else
                    request.rtol = request.atol = 1e-8;
                if (!is_taken(scene, &request)) {
                    continue;
                }
                lab_run(scene, &request, &run);
                cr_assert(run.result.outcome == FINISHED || run.result.reason[0],
                          "%s: %s without a reason", request.stepper,
                          outcome_name(run.result.outcome));
                for (int i = 0; i < run.frames * run.rows * run.columns; i++)
                    cr_assert(isfinite(run.row[i]), "%s, %s: a frame is not finite",
                              request.stepper, request.treatment);
            }
}
