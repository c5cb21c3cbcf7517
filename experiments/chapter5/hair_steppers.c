/* How every stepper fares on the main variant, and whether the thesis's choice is the best. */
#include "base/files.h"
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
    attempt->one = find_case(plan, "steppers", method->name);
    if (!attempt->one && recipe->run.settings.method == method)
        attempt->one = recipe;
    if (!attempt->one)
        return 0;
    if (run_read_states(&attempt->files, attempt->one->run.folder, plan->trajectories,
                        plan->reason))
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

static void name_setting(char *text, size_t size, const struct settings *settings) {
    if (settings->method->capabilities & STEPPER_ADAPTIVE)
        snprintf(text, size, "rtol %g", settings->stepper.rtol);
    else
        snprintf(text, size, "%.0f Hz", 1 / settings->step);
}

/* What an attempt cost, and how far it is from the base's run. */
struct result {
    const struct stepper_method *method;
    enum outcome outcome;
    struct spread cpu;          /* s per frame */
    double work;                /* evaluations per frame: hair_work_per_frame */
    struct agreement agreement; /* NaN of the base itself, and where there is none */
    char setting[64];
};

static struct result result_of(const struct attempt *attempt, const struct attempt *base) {
    struct result result = {.method = attempt->method,
                            .outcome = attempt->cost.outcome,
                            .cpu = {NAN, NAN, NAN},
                            .work = NAN,
                            .agreement = {NAN, NAN},
                            .setting = "–"};
    if (!attempt->one)
        return result;
    name_setting(result.setting, sizeof result.setting, &attempt->one->run.settings);
    result.cpu = hair_per_frame(&attempt->cost, attempt->one->run.scene);
    result.work = hair_work_per_frame(&attempt->files, &attempt->cost, attempt->one->run.scene);
    if (base && base->method != attempt->method)
        result.agreement = agree(&attempt->hair, &base->hair);
    return result;
}

static void write_attempt(FILE *stream, const struct attempt *attempt, const struct attempt *base,
                          const struct result *result) {
    const char *note = attempt->one
                           ? json_string_value(json_object_get(attempt->files.json, "reason"))
                           : "refused";
    if ((!note || !*note) && (!base || base->method == attempt->method))
        note = base ? "what the others are compared with" : "nothing to compare with";
    const double speed = attempt->one ? hair_real_time(&result->cpu, attempt->one->run.scene) : NAN;
    const double strain = attempt->one ? largest_strain(&attempt->hair) : NAN;
    fprintf(stream, "%s\t%s\t%s\t%.17g\t%.17g\t%.17g\t%.17g\t%s\t%.17g\t%.17g\t%.17g\t%s\n",
            attempt->method->name, result->setting, outcome_name(result->outcome),
            attempt->one ? attempt->cost.failure_time : NAN, result->cpu.median, speed, strain,
            base ? base->method->name : "–", result->agreement.distance, result->agreement.until,
            result->work, note ? note : "");
}

static void state_result(struct hair_study *study, const struct result *result,
                         const struct attempt *base) {
    const char *name = result->method->name;
    const double distance = 1e3 * result->agreement.distance, ms = 1e3 * result->cpu.median;
    char key[80], over[48] = "";
    snprintf(key, sizeof key, "stepper %.60s", name);
    struct statement row = {
        .key = key, .figure = "cost", .tables = "steppers", .value = distance, .unit = "mm"};
    const double until = base ? base->one->run.scene->duration : 0,
                 whole = study->runs[study->question->main].timed->run.scene->duration;
    if (base && until < whole)
        snprintf(over, sizeof over, ", in the first %.3g s", until);
    if (result->outcome == REFUSED) {
        row.verdict = NOT_REACHED;
        hair_state(study, row, "%s is refused by this scene.", name);
    } else if (result->outcome != FINISHED) {
        row.verdict = HOLDS_NOT;
        hair_state(study, row, "%s, %s, reaches its end: %s.", name, result->setting,
                   outcome_name(result->outcome));
    } else if (isfinite(distance)) {
        hair_state(study, row, "%s, %s, is %.2g mm (rms%s) from %s and takes %.3g ms a frame.",
                   name, result->setting, distance, over, base->method->name, ms);
    } else {
        row.value = ms;
        row.unit = "ms";
        hair_state(study, row, "%s, %s, takes %.3g ms a frame.", name, result->setting, ms);
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
    struct statement row = {.key = "choice",
                            .figure = "cost",
                            .tables = "steppers",
                            .answers = ANSWERS_CHOICE,
                            .by = THESIS,
                            .verdict = NOT_ASKED,
                            .unit = "1"};
    row.value = best ? own->work / best->work : NAN;
    if (!own || count == 1) {
        hair_state(study, row,
                   "Whether %s is the best on %s was not asked: it or the others were left out.",
                   choice, scene);
    } else if (own->outcome != FINISHED) {
        row.verdict = HOLDS_NOT;
        hair_state(study, row, "On %s %s does not reach its end: %s.", scene, choice,
                   outcome_name(own->outcome));
    } else if (isnan(own->agreement.distance)) {
        row.verdict = NOT_REACHED;
        hair_state(study, row, "On %s no run tells how far %s is from the solution.", scene,
                   choice);
    } else if (best) {
        row.verdict = HOLDS_NOT;
        hair_state(study, row,
                   "On %s %s is the best: %s, %s, is nearer to the solution (%.2g mm, not %.2g) "
                   "for %.2g of its evaluations.",
                   scene, choice, best->method->name, best->setting, 1e3 * best->agreement.distance,
                   1e3 * own->agreement.distance, best->work / own->work);
    } else {
        row.verdict = HOLDS;
        hair_state(study, row,
                   "On %s %s is the best: no stepper is nearer to the solution than %.2g mm for "
                   "fewer evaluations.",
                   scene, choice, 1e3 * own->agreement.distance);
    }
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

static int method_count(void) {
    int count = 0;
    while (stepper_methods[count])
        count++;
    return count;
}

static int write_attempts(struct plan *plan, struct hair_study *study, FILE *stream,
                          const struct attempt *base) {
    struct result *results = calloc((size_t)method_count(), sizeof *results);
    int count = 0, code = results ? 0 : -1;
    if (!results)
        snprintf(plan->reason, REASON_SIZE, "out of memory");
    for (int i = 0; stepper_methods[i] && !code; i++) {
        struct attempt attempt;
        if (!plan_wants(plan, stepper_methods[i]->name))
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
    free(results);
    return code;
}

int hair_steppers(struct plan *plan, const char *folder, struct hair_study *study) {
    const struct scene *main_scene = study->runs[study->question->main].timed->run.scene;
    struct atomic_file file;
    struct attempt base;
    int there;
    if (open_base(plan, study, &base, &there))
        return -1;
    int code = open_table(
        &file, folder, "steppers",
        "every stepper, one run, treatment projection; CPU time, s per frame (up to its failure, "
        "where it failed); real_time: simulated over CPU time; largest |L/l - 1| of a stretch "
        "spring; distance: rms over free nodes and common frames from the run it is compared "
        "with, m; until: the last frame before it is more than 1 mm, s; work: per frame, in "
        "evaluations of a wisp's forces, a linear solution as one and a factorisation as five",
        main_scene,
        "stepper\tsetting\tstatus\tfailure_time\tcpu_per_frame\treal_time\tstrain"
        "\tcompared_with\tdistance\tuntil\twork\tnote",
        plan->reason);
    if (!code) {
        code = write_attempts(plan, study, file.stream, there ? &base : NULL);
        if (code)
            atomic_discard(&file);
        else
            code = atomic_commit(&file, plan->reason);
    }
    if (there)
        close_attempt(&base);
    return code;
}
