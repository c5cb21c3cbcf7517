/* How every stepper fares on the main variant, and whether the thesis's choice is the best. */
#include "hair_study.h"
#include "integrators/configurations.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- attempts --- */

/* A stepper's run of the main variant. */
struct attempt {
    const struct stepper_method *method;
    const struct labelled_case *one; /* NULL: refused */
    struct run_files files;
    struct hair hair;
    struct cost cost;
};

static int open_attempt(struct plan *plan, const struct hair_study *study,
                        const struct stepper_method *method, struct attempt *attempt) {
    const struct labelled_case *recipe = study->runs[study->question->main].timed;
    *attempt = (struct attempt){.method = method, .cost.outcome = REFUSED};
    attempt->one = find_case(plan, "steppers", "%s", method->name);
    if (!attempt->one && recipe->run.settings.method == method)
        attempt->one = recipe;
    if (!attempt->one)
        return 0;
    if (plan_read(plan, attempt->one, &attempt->files))
        return -1;
    attempt->cost = run_cost(&attempt->files);
    return hair_open(&attempt->hair, attempt->one->run.scene, attempt->files.states,
                     (enum wisp_treatment)attempt->one->run.settings.treatment, plan->reason);
}

static void close_attempt(struct attempt *attempt) {
    hair_close(&attempt->hair);
    if (attempt->one)
        run_free(&attempt->files);
}

/* How far an attempt goes with another: rms distance over the common frames, and the last frame
 * until which it is never more than a millimetre. */
struct agreement {
    double distance, until; /* m, s */
};

static struct agreement agree(const struct hair *a, const struct hair *b) {
    struct agreement agreement = {NAN, NAN};
    double squares = 0;
    int frames = 0, parted = 0;
    for (double d; !isnan(d = hair_distance(a, b, frames)); frames++) {
        squares += d * d;
        parted |= d > 1e-3;
        agreement.until = parted ? agreement.until : a->frames[frames].t;
    }
    agreement.distance = frames > 0 ? sqrt(squares / frames) : NAN;
    return agreement;
}

static double largest_strain(const struct hair *hair) {
    double largest = hair->frame_count > 0 ? 0 : NAN;
    for (int f = 0; f < hair->frame_count; f++)
        largest = fmax(largest, hair_strain(hair, f));
    return largest;
}

/* What an attempt cost, and how far it is from the base's run. */
struct result {
    const struct stepper_method *method;
    const struct labelled_case *run;
    enum outcome outcome;
    struct spread cpu;          /* s per frame */
    double work;                /* evaluations per frame: hair_work_per_frame */
    struct agreement agreement; /* NaN of the base itself, and where there is none */
    double last;                /* distance at the base's last frame, m; NaN where it is not */
    char setting[64];
};

static struct result result_of(const struct attempt *attempt, const struct attempt *base) {
    struct result result = {.method = attempt->method,
                            .run = attempt->one,
                            .outcome = attempt->cost.outcome,
                            .cpu = {NAN, NAN, NAN},
                            .work = NAN,
                            .agreement = {NAN, NAN},
                            .last = NAN,
                            .setting = "–"};
    char name[HAIR_NAME];
    if (!attempt->one)
        return result;
    hair_name(name, &attempt->one->run.settings);
    snprintf(result.setting, sizeof result.setting, "%s",
             name + strlen(attempt->method->name) + strlen(", "));
    result.cpu = hair_per_frame(&attempt->cost, attempt->one->run.scene);
    result.work = hair_work_per_frame(&attempt->files, &attempt->cost, attempt->one->run.scene);
    if (base && base->method != attempt->method) {
        result.agreement = agree(&attempt->hair, &base->hair);
        result.last = hair_distance(&attempt->hair, &base->hair, base->hair.frame_count - 1);
    }
    return result;
}

#define ATTEMPT_COLUMNS(X)                                                                       \
    X("stepper", "-", "name of the stepper", "%s", attempt->method->name)                        \
    X("setting", "-", "rate or tolerance of the stepper", "%s", result->setting)                 \
    X("status", "-", "how the run ended", "%s", outcome_name(result->outcome))                   \
    X("failure_time", "s", "simulated time at which the run failed", "%.17g",                    \
      attempt->one ? attempt->cost.failure_time : (double)NAN)                                   \
    X("cpu_per_frame", "s", "CPU time of a frame", "%.17g", result->cpu.median)                  \
    X("real_time", "1", "simulated over CPU time", "%.17g", speed)                               \
    X("strain", "1", "largest |L/l - 1| of a stretch segment", "%.17g", strain)                  \
    X("compared_with", "-", "the stepper that distance is from", "%s",                           \
      base ? base->method->name : "–")                                                           \
    X("distance", "m", "distance from that run, rms over free nodes and common frames", "%.17g", \
      result->agreement.distance)                                                                \
    X("until", "s", "the last frame before the distance is more than 1 mm", "%.17g",             \
      result->agreement.until)                                                                   \
    X("work", "1", "work per frame, in evaluations of a wisp's forces", "%.17g", result->work)   \
    NOTE_COLUMN(X, note ? note : "")

static void write_attempt(FILE *stream, const struct attempt *attempt, const struct attempt *base,
                          const struct result *result) {
    const char *note = attempt->one
                           ? json_string_value(json_object_get(attempt->files.json, "reason"))
                           : "refused";
    if ((!note || !*note) && (!base || base->method == attempt->method))
        note = base ? "what the others are compared with" : "nothing to compare with";
    const double speed = attempt->one ? hair_real_time(&result->cpu, attempt->one->run.scene) : NAN;
    const double strain = attempt->one ? largest_strain(&attempt->hair) : NAN;
    WRITE_ROW(stream, ATTEMPT_COLUMNS);
}

static void state_result(struct hair_study *study, const struct result *result,
                         const struct attempt *base) {
    const char *name = result->method->name;
    const double distance = 1e3 * result->agreement.distance, ms = 1e3 * result->cpu.median;
    char over[48] = "";
    struct statement row =
        our_row("cost", "steppers", HOLDS, distance, "mm", "stepper %.60s", name);
    const double until = base ? base->one->run.scene->duration : 0,
                 whole = study->runs[study->question->main].timed->run.scene->duration;
    if (base && until < whole)
        snprintf(over, sizeof over, ", in the first %.3g s", until);
    if (result->outcome == REFUSED) {
        row.verdict = NOT_REACHED;
        hair_state(study, row, "The scene refuses %s.", name);
    } else if (result->outcome != FINISHED) {
        row.verdict = HOLDS_NOT;
        hair_state(study, row, "%s at %s does not reach its end: %s.", name, result->setting,
                   outcome_name(result->outcome));
    } else if (isfinite(distance)) {
        hair_state(study, row, "%s at %s is %.2g mm (rms%s) from %s and takes %.3g ms a frame.",
                   name, result->setting, distance, over, base->method->name, ms);
    } else {
        row.value = ms;
        row.unit = "ms";
        hair_state(study, row, "%s at %s takes %.3g ms a frame.", name, result->setting, ms);
    }
}

/* --- the thesis's choice --- */

static const char choice[] = "explicit Euler with projection at 9000 Hz";

/* The cheapest of those that are nearer and have less to compute than the thesis's choice, or NULL.
 */
static const struct result *better_than(const struct result *own, const struct result *results,
                                        int count) {
    const struct result *best = NULL;
    for (int i = 0; i < count; i++)
        if (results[i].outcome == FINISHED &&
            results[i].agreement.distance < own->agreement.distance &&
            results[i].work < own->work && (!best || results[i].work < best->work))
            best = &results[i];
    return best;
}

static void state_choice(struct hair_study *study, const struct result *results, int count) {
    const char *scene = study->subject->name;
    const struct result *own = NULL;
    for (int i = 0; i < count; i++)
        if (results[i].method == stepper_find(thesis_recipe.stepper))
            own = &results[i];
    const struct result *best = own ? better_than(own, results, count) : NULL;
    study->rival = best ? best->run : NULL;
    struct statement row = thesis_row("cost", "steppers", NOT_ASKED,
                                      best ? own->work / best->work : NAN, "1", "choice");
    row.answers = ANSWERS_CHOICE;
    if (!own || count == 1) {
        hair_state(study, row,
                   "On %s %s is the best: that was not asked, for it or the others were left out.",
                   scene, choice);
    } else if (own->outcome != FINISHED) {
        row.verdict = HOLDS_NOT;
        hair_state(study, row, "On %s %s is the best: it does not reach its end (%s).", scene,
                   choice, outcome_name(own->outcome));
    } else if (isnan(own->agreement.distance)) {
        row.verdict = NOT_REACHED;
        hair_state(study, row,
                   "On %s %s is the best: no run tells how far it is from the solution.", scene,
                   choice);
    } else if (best) {
        row.verdict = HOLDS_NOT;
        hair_state(study, row,
                   "On %s %s is the best: %s at %s is nearer to the solution (%.2g mm against %.2g "
                   "mm) with %.2g %% of its evaluations.",
                   scene, choice, best->method->name, best->setting, 1e3 * best->agreement.distance,
                   1e3 * own->agreement.distance, 100 * best->work / own->work);
    } else {
        row.verdict = HOLDS;
        hair_state(study, row,
                   "On %s %s is the best: no stepper is nearer to the solution than %.2g mm for "
                   "fewer evaluations.",
                   scene, choice, 1e3 * own->agreement.distance);
    }
}

/* --- side by side --- */

static int nearest_first(const void *a, const void *b) {
    const struct hair_error *p = a, *q = b;
    return (p->distance > q->distance) - (p->distance < q->distance);
}

/* At the base's last frame, of those that have it. */
static int draw_errors(struct plan *plan, struct hair_study *study, const struct result *results,
                       int count, const struct attempt *base) {
    struct hair_error *errors = calloc((size_t)count + 1, sizeof *errors);
    int near = 0, code = 0;
    char first[HAIR_NAME], last[HAIR_NAME];
    if (!errors)
        return fail_with(plan->reason, "out of memory");
    for (int i = 0; i < count; i++)
        if (isfinite(results[i].last))
            errors[near++] = (struct hair_error){results[i].run, results[i].last};
    qsort(errors, (size_t)near, sizeof *errors, nearest_first);
    if (near > 1 && errors[near - 1].distance > 0) {
        const int frame = base->hair.frame_count;
        hair_name(first, &errors[0].run->run.settings);
        hair_name(last, &errors[near - 1].run->run.settings);
        hair_state(
            study,
            our_row("errors", "steppers", HOLDS, 1e3 * errors[near - 1].distance, "mm", "errors"),
            "After %.3g s %s is nearest to %s, %.2g mm (rms), and %s furthest, %.2g mm.",
            base->hair.frames[frame - 1].t, first, base->method->name, 1e3 * errors[0].distance,
            last, 1e3 * errors[near - 1].distance);
        code = hair_errors(plan, study, errors, near, base->one, frame);
    }
    free(errors);
    return code;
}

/* Whom the others are compared with: `reference`, else rk4, where it reached its end. */
static int open_base(struct plan *plan, const struct hair_study *study, struct attempt *base,
                     int *there) {
    static const char *const names[] = {"reference", "rk4"};
    *there = 0;
    for (int i = 0; i < 2 && !*there; i++) {
        if (open_attempt(plan, study, stepper_find(names[i]), base)) {
            close_attempt(base);
            return -1;
        }
        *there = base->one && base->cost.outcome == FINISHED;
        if (!*there)
            close_attempt(base);
    }
    return 0;
}

int hair_takes(const struct plan *plan, const struct stepper_method *method) {
    return plan_wants(plan, method->name) &&
           (plan->stepper_count > 0 || configuration_of(method).kind != CONFIGURATION_COSTLY);
}

static int method_count(void) {
    int count = 0;
    while (stepper_methods[count])
        count++;
    return count;
}

static int write_attempts(struct plan *plan, struct hair_study *study, FILE *stream,
                          const struct attempt *base) {
    struct result *results = calloc((size_t)method_count(), sizeof *results);
    int count = 0, code = results ? 0 : fail_with(plan->reason, "out of memory");
    for (int i = 0; stepper_methods[i] && !code; i++) {
        struct attempt attempt;
        if (!hair_takes(plan, stepper_methods[i]))
            continue;
        code = open_attempt(plan, study, stepper_methods[i], &attempt);
        if (!code) {
            results[count] = result_of(&attempt, base);
            write_attempt(stream, &attempt, base, &results[count]);
            state_result(study, &results[count++], base);
        }
        close_attempt(&attempt);
    }
    if (!code)
        state_choice(study, results, count);
    if (!code && base && study->question->film > 0)
        code = draw_errors(plan, study, results, count, base);
    free(results);
    return code;
}

int hair_steppers(struct plan *plan, struct hair_study *study) {
    const struct scene *main_scene = study->runs[study->question->main].timed->run.scene;
    struct attempt base;
    int there;
    FILE *stream = output_table(
        &plan->output, "steppers",
        "every stepper, one run, treatment projection; CPU time, s per frame (up to its failure, "
        "where it failed); real_time: simulated over CPU time; largest |L/l - 1| of a stretch "
        "spring; distance: rms over free nodes and common frames from the run it is compared with, "
        "m; until: the last frame before it is more than 1 mm, s; work: per frame, in evaluations "
        "of a wisp's forces, a linear solution as one and a factorisation as five",
        main_scene, COLUMNS(ATTEMPT_COLUMNS));
    if (!stream || open_base(plan, study, &base, &there))
        return -1;
    const int code = write_attempts(plan, study, stream, there ? &base : NULL);
    if (there)
        close_attempt(&base);
    return code;
}
