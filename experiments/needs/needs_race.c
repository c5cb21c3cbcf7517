/* With what one would compute the smallest model: the cheapest method that is as near to its motion
 * as the model is to the full one. Each method begins with steps as long as there are and takes
 * shorter ones until it is near enough, or until its next run would cost more than one that is. */
#include "experiments/common/search.h"
#include "model/problems.h"
#include "needs.h"

#include <math.h>
#include <string.h>

/* Methods with steps of their own choice take a tolerance of 10^-2, 10^-2.5, ... */
enum { STRIDE = 3, TOLERANCES = 7 };

static double setting_of(const struct study *study, const struct contender *contender) {
    const struct scene *scene = study->race_scene;
    return configuration_is_adaptive(contender->method)
               ? pow(10, -2 - contender->place / 2.)
               : place_step(1 / stop_rate(scene), STRIDE, contender->place);
}

/* Runs that would cost more than the cheapest one that is near are not made. */
static int is_too_expensive(const struct study *study, const struct contender *contender) {
    if (configuration_is_adaptive(contender->method))
        return contender->place == TOLERANCES || contender->cost.counted > study->cheapest;
    return estimated_cost(study->race_scene, study->race_treatment, contender->method,
                          contender->setting) > study->cheapest;
}

static int try_place(struct plan *plan, struct study *study, struct contender *contender) {
    contender->setting = setting_of(study, contender);
    while (!configuration_is_adaptive(contender->method) && !is_too_expensive(study, contender) &&
           !may_hold(study->race_scene, contender->method->method, contender->setting)) {
        contender->place++;
        contender->setting = setting_of(study, contender);
    }
    contender->over = is_too_expensive(study, contender);
    if (contender->over)
        return 0;
    const struct run_defaults *run = &study->subject->scene->run;
    struct run_request request =
        configuration_request(contender->method, contender->setting, run->atol / run->rtol);
    request.treatment = wisp_problem.treatments[study->race_treatment].name;
    contender->at = plan->case_count;
    return plan_add(plan, study->race_scene, &request, study->subject->name,
                    "smallest model, %s, %.4g", contender->method->name, contender->setting);
}

int needs_begin_race(struct plan *plan, struct study *study) {
    const struct labelled_case *recipe = &plan->cases[study->smallest.at];
    study->race_scene = recipe->run.scene;
    study->race_treatment = (enum wisp_treatment)recipe->run.settings.treatment;
    study->cheapest = study->smallest.cost.counted;
    study->phase = RACING;
    for (int i = 0; i < plan->configuration_count; i++) {
        const struct configuration *method = &plan->configurations[i];
        struct run_request request = configuration_request(method, 1e-3, 1);
        char reason[REASON_SIZE];
        request.treatment = wisp_problem.treatments[study->race_treatment].name;
        if (!plan_takes(plan, study->race_scene, &request, reason))
            continue;
        struct contender *contender = &study->contender[study->contenders++];
        *contender = (struct contender){.method = method, .error = NAN, .cost = no_cost};
        contender->cost.counted = 0;
        if (try_place(plan, study, contender))
            return -1;
    }
    return 0;
}

/* What the contender's last run has shown. */
static int judge(struct plan *plan, struct study *study, const struct run_files *exact,
                 struct contender *contender) {
    struct curve_deviation change;
    struct run_files run;
    if (plan_read(plan, &plan->cases[contender->at], &run))
        return -1;
    int code = 0;
    contender->cost = run_cost(&run);
    cost_count(&contender->cost, study->race_scene, study->race_treatment, contender->method);
    contender->error = NAN;
    if (run.outcome == FINISHED && exact->outcome == FINISHED) {
        code =
            measure_curves(study->subject->scene, run.states, exact->states, &change, plan->reason);
        contender->error = change.rms;
    }
    run_free(&run);
    contender->reached = contender->error <= fmax(NEEDS_TARGET, needs_noise(study));
    if (contender->reached && contender->cost.counted < study->cheapest)
        study->cheapest = contender->cost.counted;
    return code;
}

int needs_go_on_racing(struct plan *plan, struct study *study) {
    struct run_files exact;
    int code = 0, running = 0;
    if (plan_read(plan, &plan->cases[study->race_yardstick], &exact))
        return -1;
    for (int i = 0; i < study->contenders && !code; i++)
        if (!study->contender[i].over)
            code = judge(plan, study, &exact, &study->contender[i]);
    for (int i = 0; i < study->contenders && !code; i++) {
        struct contender *contender = &study->contender[i];
        if (contender->over)
            continue;
        contender->over = contender->reached;
        contender->place += !contender->reached;
        if (!contender->reached)
            code = try_place(plan, study, contender);
        running += !contender->over;
    }
    run_free(&exact);
    if (!running)
        study->phase = DONE;
    return code;
}

const struct contender *needs_winner(const struct study *study) {
    const struct contender *best = NULL;
    for (int i = 0; i < study->contenders; i++) {
        const struct contender *one = &study->contender[i];
        if (one->reached && (!best || one->cost.counted < best->cost.counted))
            best = one;
    }
    return best;
}
