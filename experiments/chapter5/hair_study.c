#include "hair_study.h"

#include "base/files.h"
#include "experiments/common/diagnostics.h"
#include "experiments/common/sets.h"
#include "model/model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double reference_duration = 0.5; /* s, on a large scene: minutes for all of it */

static int variant_count(const struct hair_question *question) {
    int count = 0;
    while (count < HAIR_VARIANTS && question->variants[count].label)
        count++;
    return count;
}

/* --- the runs --- */

/* Runs that take seconds are repeated less often; their times spread less, too. */
static int is_large(const struct scene *scene) {
    return scene->wisp_count * scene->duration > 60;
}

/* 1/Hz. The highest mode decides. */
static double stable_step(const struct scene *scene, const struct stepper_method *method) {
    int hundreds = 1;
    while (hundreds < 1000000 && !seems_stable(method, scene, 1 / (100. * hundreds)))
        hundreds++;
    return 1 / (100 * ceil(1.25 * hundreds));
}

/* The request for a run by a stepper: the thesis's recipe for explicit Euler, for other
 * explicit methods a quarter more than the least rate, in hundreds of Hz, that linear theory calls
 * stable, and their usual rate where theory says nothing, as for implicit ones; for adaptive ones a
 * relative tolerance of 1e-4; the reference is what it is, and on large scenes goes only so far as
 * its time allows. All with the treatment `projection`, so that they solve the same equations. */
static struct run_request request_for(const struct scene *scene,
                                      const struct stepper_method *method) {
    struct run_request request = {.stepper = method->name, .treatment = thesis_recipe.treatment};
    const unsigned is = method->capabilities;
    if (method->checked_by)
        return request;
    if (is & STEPPER_ADAPTIVE) {
        request.rtol = 1e-4;
        request.atol = request.rtol * scene->run.atol / scene->run.rtol;
        return request;
    }
    request.timings = !is_large(scene);
    if (is & STEPPER_SOLVES)
        request.linear = "direct"; /* the matrix of this treatment is not symmetric */
    request.step = method == stepper_find(thesis_recipe.stepper) ? 1 / thesis_recipe.rate
                   : stepper_is_predictable(method) && !(is & STEPPER_IMPLICIT)
                       ? stable_step(scene, method)
                       : 1 / stepper_usual_rate(method);
    return request;
}

struct run_request hair_timed_request(const struct plan *plan, const struct scene *scene,
                                      const struct stepper_method *method) {
    struct run_request request = request_for(scene, method);
    const int is_long = is_large(scene) || method->advance;
    request.timings = plan->quick ? (is_long ? 1 : 3) : is_long ? 3 : 7;
    return request;
}

/* A variant at a frame rate, over the whole scene or its first seconds. */
static const struct scene *variant_scene(struct plan *plan, const struct hair_question *question,
                                         const struct hair_variant *variant, double frame_rate,
                                         double most) {
    const struct subject *subject = &plan->subjects[0];
    struct sets sets = {0};
    for (int i = 0; i < HAIR_SETS && variant->sets[i]; i++)
        set_add(&sets, "%s", variant->sets[i]);
    set_add(&sets, "frame_rate=%.17e", frame_rate);
    set_add(&sets, "duration=%.17e", fmin(most, subject->scene->duration));
    if (question->start && plan->scene_count == 0)
        set_add(&sets, "%s", question->start);
    return plan_scene(plan, subject->source, sets.list, sets.count);
}

/* These are whole, also with --quick: statements are about all of a scene, and it is cheap. */
static int plan_variant(struct plan *plan, const struct hair_question *question,
                        const struct hair_variant *variant, const struct stepper_method *method) {
    const double rate = plan->subjects[0].scene->frame_rate;
    const struct scene *scene = variant_scene(plan, question, variant, rate, INFINITY);
    if (!scene)
        return -1;
    struct run_request request = hair_timed_request(plan, scene, method);
    if (plan_add(plan, scene, &request, "variants", "%s", variant->label))
        return -1;
    if (is_large(scene) && variant == &question->variants[question->control])
        return 0; /* where its energy goes is not asked */
    request.timings = 0;
    request.diagnostics = 1;
    scene = variant_scene(plan, question, variant,
                          question->watch_rate > 0 ? question->watch_rate : rate, INFINITY);
    return scene ? plan_add(plan, scene, &request, "watched", "%s", variant->label) : -1;
}

/* How far the steppers are tried: reference_duration is for one of error control on a large scene,
 * and --quick cuts all alike. */
static double trial_duration(const struct plan *plan, const struct hair_question *question,
                             const struct scene *scene, const struct stepper_method *method) {
    if (plan->quick)
        return question->quick > 0 ? question->quick : 0.4;
    return method->checked_by && is_large(scene) ? reference_duration : INFINITY;
}

/* A stepper that refuses the scene has a row in the table and no run. */
static int plan_stepper(struct plan *plan, const struct hair_question *question,
                        const struct stepper_method *method) {
    const struct hair_variant *variant = &question->variants[question->main];
    const struct scene *scene = find_case(plan, "variants", "%s", variant->label)->run.scene;
    const struct run_request request = request_for(scene, method);
    const double until = trial_duration(plan, question, scene, method);
    if (until < scene->duration)
        scene = variant_scene(plan, question, variant, scene->frame_rate, until);
    if (!scene)
        return -1;
    char reason[REASON_SIZE];
    return plan_takes(plan, scene, &request, reason)
               ? plan_add(plan, scene, &request, "steppers", "%s", method->name)
               : 0;
}

static int refuse_scene(struct plan *plan, const struct hair_question *question) {
    const struct scene *scene = plan->subjects[0].scene;
    for (int i = 0; i < HAIR_NEEDS && question->needs[i]; i++) {
        if (json_object_get(scene->source, question->needs[i]))
            continue;
        return fail_with(plan->reason, "experiment %s needs a scene with %s, and scene %s has none",
                         plan->experiment->name, question->needs[i], scene->name);
    }
    return 0;
}

int hair_plan(struct plan *plan) {
    const struct hair_question *question = plan->experiment->study;
    const struct stepper_method *recipe =
        stepper_find(plan->stepper_count > 0 ? plan->steppers[0] : thesis_recipe.stepper);
    plan->run_seconds = 300;
    if (plan->scene_count > 1)
        return fail_with(plan->reason, "experiment %s takes one --scene; %d were given",
                         plan->experiment->name, plan->scene_count);
    if (plan_subjects(plan, &question->scene, 1) || refuse_scene(plan, question))
        return -1;
    for (int i = 0; i < variant_count(question); i++)
        if (plan_variant(plan, question, &question->variants[i], recipe))
            return -1;
    for (int i = 0; stepper_methods[i]; i++)
        if ((plan->quick || stepper_methods[i] != recipe) && hair_takes(plan, stepper_methods[i]) &&
            plan_stepper(plan, question, stepper_methods[i]))
            return -1;
    return 0;
}

/* --- reading them --- */

static int measure_run(struct hair_study *study, struct hair_run *run) {
    const int frames = run->hair.frame_count;
    for (int k = 0; k < HAIR_SERIES; k++) {
        run->series[k] = calloc((size_t)frames + 1, sizeof(double));
        if (!run->series[k])
            return -1;
    }
    return study->question->measure(study, run);
}

static int read_run(struct plan *plan, struct hair_study *study, int i) {
    struct hair_run *run = &study->runs[i];
    struct run_files timed;
    run->variant = &study->question->variants[i];
    run->timed = find_case(plan, "variants", "%s", run->variant->label);
    run->watched = find_case(plan, "watched", "%s", run->variant->label);
    if (!run->watched)
        run->watched = run->timed;
    if (run_read(&timed, run->timed->run.folder, plan->reason))
        return -1;
    run->cost = run_cost(&timed);
    run_free(&timed);
    if (plan_read(plan, run->watched, &run->files))
        return -1;
    study->count = i + 1;
    run->finished = run->cost.outcome == FINISHED && run->files.outcome == FINISHED;
    if (hair_open(&run->hair, run->watched->run.scene, run->files.states,
                  (enum wisp_treatment)run->watched->run.settings.treatment, plan->reason))
        return -1;
    if (measure_run(study, run) == 0)
        return 0;
    return fail_with(plan->reason, "out of memory");
}

static void free_study(struct hair_study *study) {
    for (int i = 0; i < study->count; i++) {
        struct hair_run *run = &study->runs[i];
        for (int k = 0; k < HAIR_SERIES; k++)
            free(run->series[k]);
        hair_close(&run->hair);
        run_free(&run->files);
    }
    free(study->trials);
}

/* --- what is stated --- */

/* Every claim on the control alone: its run stands in the place of each. */
static void try_control(struct hair_study *study) {
    struct hair_study control = *study;
    control.statements = NULL;
    for (int i = 0; i < control.count; i++) {
        control.runs[i] = study->runs[study->question->control];
        control.runs[i].variant = study->runs[i].variant;
    }
    study->question->state(&control);
    study->trials = control.trials;
    study->trial_count = control.trial_count;
    study->out_of_memory = control.out_of_memory;
}

/* Tells the failure of the timed run, or of the watched one where only that did not reach its end.
 */
static void state_failure(struct hair_study *study, const struct hair_run *run) {
    const int timed = run->cost.outcome != FINISHED;
    const double t = timed ? run->cost.failure_time : run_number(&run->files, "failure_time");
    hair_state(study, our_row(NULL, NULL, NOT_REACHED, t, "s", "%s", run->variant->label),
               "Nothing is stated, for the run %s did not reach its end: %s at %.3g s.",
               run->variant->label, outcome_name(timed ? run->cost.outcome : run->files.outcome),
               t);
}

/* Counts the frames that are to be shown and those that were computed. */
static void state_pictures(struct hair_study *study) {
    const int *number = study->question->pictures;
    int wanted = 0, shown = 0;
    for (int i = 0; i < study->count; i++)
        for (int k = 0; k < HAIR_PICTURES && number[k] && !study->runs[i].variant->undrawn; k++) {
            wanted++;
            shown += hair_frame_numbered(&study->runs[i], number[k]) >= 0;
        }
    const struct statement row =
        our_row("hair", NULL, shown == wanted ? HOLDS : NOT_REACHED, shown, "1", "hair");
    if (shown == wanted)
        hair_state(study, row, "All %d pictures are drawn.", wanted);
    else if (shown == 0)
        hair_state(study, row, "The runs reach none of %d pictures; their last frame is drawn.",
                   wanted);
    else
        hair_state(study, row, "Of %d pictures %d are drawn; the runs do not reach the others.",
                   wanted, shown);
}

/* Returns whether every variant reached its end. */
static int state_all(struct hair_study *study) {
    int finished = 1;
    for (int i = 0; i < study->count; i++)
        if (!study->runs[i].finished) {
            state_failure(study, &study->runs[i]);
            finished = 0;
        }
    if (finished) {
        try_control(study);
        study->question->state(study);
    }
    state_pictures(study);
    return finished;
}

static int write_series(struct plan *plan, const struct hair_study *study) {
    const struct column *series = study->question->series;
    struct column columns[2 + HAIR_SERIES + 1] = {{"variant", "-", "name of the variant"},
                                                  {"t", "s", "time of the frame"}};
    memcpy(columns + 2, series, HAIR_SERIES * sizeof *series);
    FILE *stream =
        output_table(&plan->output, "series", "what the statements are made from, by frame",
                     study->subject->scene, columns);
    for (int i = 0; i < study->count && stream; i++) {
        const struct hair_run *run = &study->runs[i];
        for (int f = 0; f < run->hair.frame_count; f++) {
            fprintf(stream, "%s\t%.17g", run->variant->label, run->hair.frames[f].t);
            for (int k = 0; k < HAIR_SERIES && series[k].name; k++)
                fprintf(stream, "\t%.17g", run->series[k][f]);
            fputc('\n', stream);
        }
        fputs("\n\n", stream);
    }
    return stream ? 0 : -1;
}

static int keep_diagnoses(struct plan *plan, struct hair_study *study) {
    int code = 0;
    for (int i = 0; i < study->count && !code; i++)
        if (study->runs[i].watched != study->runs[i].timed)
            code = keep_diagnostics(&study->runs[i].watched->run, plan->output.folder,
                                    study->runs[i].variant->label, study->statements, plan->reason);
    return code;
}

/* The tables with what is to be stated of them, and the pictures. Returns 0, or -1 with
 * plan->reason. */
static int write_all(struct plan *plan, struct hair_study *study) {
    if (write_series(plan, study))
        return -1;
    const int finished = state_all(study);
    if (study->out_of_memory)
        return fail_with(plan->reason, "out of memory");
    if (finished && study->question->tables && study->question->tables(plan, study))
        return -1;
    return hair_costs(plan, study) || hair_steppers(plan, study) || keep_diagnoses(plan, study) ||
                   hair_strip(plan, study) || hair_film(plan, study)
               ? -1
               : 0;
}

int hair_tabulate(struct plan *plan) {
    struct hair_study study = {.question = plan->experiment->study,
                               .subject = &plan->subjects[0],
                               .is_own = plan_is_own(plan),
                               .statements = &plan->output.statements};
    int code = plan_open_statements(
        plan, study.subject->scene,
        plan->quick
            ? "--quick: the table of steppers is cut, and without those that cost too much"
            : "the table of steppers is without those that cost too much: --steppers names them");
    for (int i = 0; i < variant_count(study.question) && !code; i++)
        code = read_run(plan, &study, i);
    if (!code)
        code = write_all(plan, &study);
    free_study(&study);
    return code;
}
