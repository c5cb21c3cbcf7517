#include "settings.h"

#include "base/files.h"
#include "integrators/plugin.h"
#include "model/problems.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *const states_format_names[STATES_FORMATS] = {"text", "binary", "none"};

static int refuse_name(char *reason, const char *what, const char *name, const char *list) {
    return fail_with(reason, "no %s '%.60s'; `wisplab list %s` names them", what, name, list);
}

static int resolve_linear(const struct scene *scene, const struct run_request *request,
                          struct settings *settings, char *reason) {
    if (!(settings->method->capabilities & STEPPER_SOLVES)) {
        if (!request->linear)
            return 0;
        return fail_with(reason, "%s takes no linear solver; leave out --linear",
                         settings->method->name);
    }
    const char *name =
        request->linear ? request->linear : scene->problem->default_linear(settings->method);
    settings->stepper.linear = linear_find(name);
    if (!settings->stepper.linear)
        return refuse_name(reason, "linear solver", name, "linear");
    return 0;
}

static int resolve_treatment(const struct scene *scene, const struct run_request *request,
                             struct settings *settings, char *reason) {
    settings->treatment = request->treatment ? treatment_find(scene->problem, request->treatment)
                                             : scene->problem->default_treatment(settings->method);
    if (settings->treatment >= 0)
        return 0;
    int used = snprintf(reason, REASON_SIZE, "no treatment '%.60s' of scene %s; it has",
                        request->treatment, scene->name);
    for (int i = 0; scene->problem->treatments[i].name && used < REASON_SIZE; i++)
        used += snprintf(reason + used, REASON_SIZE - (size_t)used, "%s %s", i ? "," : "",
                         scene->problem->treatments[i].name);
    return -1;
}

static int check_option(const char *option, const struct settings *settings, char *reason) {
    const char *equals = strchr(option, '=');
    const size_t length = equals ? (size_t)(equals - option) : strlen(option);
    const struct linear_method *linear = settings->stepper.linear;
    const struct option_spec *specs = settings->method->options;
    double value;
    int i = options_find(specs, option, length);

    if (i < 0 && linear) {
        specs = linear->options;
        i = options_find(specs, option, length);
    }
    if (i < 0)
        return fail_with(reason,
                         "%s%s%s has no option '%.*s'; `wisplab list steppers -v` lists them",
                         settings->method->name, linear ? " with " : "", linear ? linear->name : "",
                         (int)(length < 60 ? length : 60), option);
    if (!equals)
        return fail_with(reason, "option %s has no value; write --option %s=VALUE", specs[i].name,
                         specs[i].name);
    return options_parse(&specs[i], equals + 1, &value, reason, REASON_SIZE);
}

static int refuse_number(char *reason, const char *option, double value, const char *why) {
    return fail_with(reason, "--%s %g: %s", option, value, why);
}

static int resolve_steps(const struct scene *scene, const struct run_request *request,
                         struct settings *settings, char *reason) {
    static const char *const names[] = {"step", "rtol", "atol"};
    const double asked[] = {request->step, request->rtol, request->atol};
    const struct stepper_method *method = settings->method;
    const double defaults[] = {scene->run.step, method->rtol > 0 ? method->rtol : scene->run.rtol,
                               method->atol > 0 ? method->atol : scene->run.atol};
    double *const values[] = {&settings->step, &settings->stepper.rtol, &settings->stepper.atol};
    const int adaptive = (settings->method->capabilities & STEPPER_ADAPTIVE) != 0;

    for (int i = 0; i < 3; i++) {
        const int applies = adaptive == (i > 0);
        if (asked[i] != 0 && !applies)
            return refuse_number(reason, names[i], asked[i],
                                 adaptive ? "this stepper chooses its steps; give --rtol"
                                          : "this stepper has fixed steps; give --step");
        if (asked[i] != 0 && !(asked[i] > 0 && isfinite(asked[i])))
            return refuse_number(reason, names[i], asked[i], "must be a positive number");
        *values[i] = asked[i] != 0 ? asked[i] : defaults[i];
    }
    /* Such steps are lost in the rounding of the time, and the clock could not count them. */
    if (!adaptive && (scene->begin + scene->duration) / settings->step > 1e15)
        return refuse_number(reason, "step", settings->step, "more than 1e15 steps to the end");
    settings->frame_interval = !adaptive                      ? settings->step
                               : settings->method->checked_by ? scene->run.step
                                                              : 0;
    settings->every_step = scene->frame_rate == 0 && settings->frame_interval == 0;
    return 0;
}

double settings_frames(const struct scene *scene, const struct settings *settings) {
    return scene->frame_rate > 0          ? scene->duration * scene->frame_rate
           : settings->frame_interval > 0 ? scene->duration / settings->frame_interval
                                          : 0;
}

/* A scene with a frame rate has been asked when it was read. */
static int check_rows(const struct scene *scene, const struct settings *settings, char *reason) {
    const double rows = settings_frames(scene, settings) * settings->rows;
    if (scene->frame_rate > 0 || settings->states == STATES_NONE || !(rows > SCENE_ROWS_MOST))
        return 0;
    return fail_with(
        reason,
        "steps of %g s, each of them a frame, are %.3g rows of states, and a run has up "
        "to %g; --set frame_rate=HZ says how many frames there are, --states none "
        "writes none",
        settings->frame_interval, rows, SCENE_ROWS_MOST);
}

/* Asks the stepper itself, on a model that is thrown away. */
static int refuse_combination(const struct scene *scene, struct settings *settings, char *reason) {
    struct model *model =
        scene->problem->create(scene, settings->treatment, settings_lanes(settings));
    int code = 0;
    if (!model) {
        snprintf(reason, REASON_SIZE, "out of memory");
        return OUT_OF_MEMORY;
    }
    for (int i = 0; i < model->part_count && !code; i++) {
        struct system *system = &model->parts[i].system;
        system->unprojected = settings->unprojected;
        settings->unknowns += system->size / system->lanes * system->wisps;
        code = stepper_refuse(settings->method, &settings->stepper, system);
        if (code)
            snprintf(reason, REASON_SIZE, "%s", system->reason);
    }
    if (!code && settings->every_step && model->part_count + model->parts_to_come > 1) {
        snprintf(reason, REASON_SIZE,
                 "scene %s needs a frame_rate: its parts choose their own steps", scene->name);
        code = REFUSED;
    }
    settings->rows = model->row_count;
    settings->columns = model->column_count + 2; /* time, and parent */
    scene->problem->free(model);
    return code || check_rows(scene, settings, reason) ? REFUSED : 0;
}

/* Steps of one-step methods are projected, those of multistep ones would make less of their
 * history. On the circle the projection is the treatment. */
static int leaves_constraint(const struct scene *scene, const struct stepper_method *method) {
    const int rigid = scene->wisp_count > 0 && scene->wisps[0].stretch == STRETCH_RIGID;
    const int by_method = !(method->capabilities & STEPPER_MULTISTEP);
    return rigid && !(scene->run.project >= 0 ? scene->run.project : by_method);
}

double scene_strain_limit(const struct scene *scene) {
    if (!scene->problem->strain_limit)
        return INFINITY;
    return scene->run.strain_limit > 0 ? scene->run.strain_limit
                                       : scene->problem->strain_limit(scene);
}

static int check_perturbation(const struct settings *settings, char *reason) {
    const double size = settings->perturbation;
    return size == 0 || (size > 0 && isfinite(size))
               ? 0
               : refuse_number(reason, "perturb", size, "must be a positive number");
}

int settings_resolve(const struct scene *scene, const struct run_request *request,
                     struct settings *settings, char *reason) {
    *settings = (struct settings){.timings = request->timings,
                                  .threads = request->threads > 0 ? request->threads : 1,
                                  .profile = request->profile,
                                  .perturbation = request->perturbation,
                                  .draw = request->draw,
                                  .diagnostics = request->diagnostics,
                                  .states = request->states};
    settings->lanes = scene->problem->lanes ? scene->problem->lanes(scene) : LANES_MOST;
    settings->strain_limit =
        request->strain_limit > 0 ? request->strain_limit : scene_strain_limit(scene);
    const char *name = request->stepper ? request->stepper : "rk4";
    settings->method = stepper_find(name);
    if (!settings->method)
        return refuse_name(reason, "stepper", name, "steppers") ? REFUSED : 0;
    settings->stepper.options = (struct options){request->options, request->option_count};
    settings->unprojected = leaves_constraint(scene, settings->method);
    if (settings->method->checked_by) /* it has error control, and a cross-check */
        settings->strain_limit = INFINITY;
    if (settings->diagnostics && !scene->problem->extremes) {
        snprintf(reason, REASON_SIZE,
                 "--diagnostics is of wisps, and scene %s is of problem \"%s\"", scene->name,
                 scene->problem->name);
        return REFUSED;
    }
    if (resolve_treatment(scene, request, settings, reason) ||
        resolve_linear(scene, request, settings, reason) ||
        resolve_steps(scene, request, settings, reason) || check_perturbation(settings, reason))
        return REFUSED;
    for (int i = 0; i < request->option_count; i++)
        if (check_option(request->options[i], settings, reason))
            return REFUSED;
    return refuse_combination(scene, settings, reason);
}

int settings_cross_check(const struct scene *scene, const struct settings *settings,
                         struct settings *second, char *reason) {
    const struct cross_check *opinion = settings->method->checked_by;
    struct run_request request = {
        .stepper = opinion->method,
        .treatment = scene->problem->treatments[settings->treatment].name,
        .rtol = settings->stepper.rtol * opinion->rtol_ratio,
        .atol = settings->stepper.atol * opinion->rtol_ratio,
        .options = opinion->options,
        .threads = settings->threads,
        .perturbation = settings->perturbation,
        .draw = settings->draw,
        .strain_limit = INFINITY,
    };
    while (request.options && request.options[request.option_count])
        request.option_count++;
    const int code = settings_resolve(scene, &request, second, reason);
    second->frame_interval = settings->frame_interval;
    second->every_step = settings->every_step;
    return code;
}

/* Wisps at times of their own cannot be looked at together; alone they have the same bits. What a
 * diagnosis sums over wisps it sums part by part: that would not have the same bits with parts of
 * another width, so it is the one that all machines have. */
int settings_lanes(const struct settings *settings) {
    const struct options *options = &settings->stepper.options;
    const int most = stepper_lanes(settings->method, settings->stepper.linear, options);
    if (stepper_steps_by_lane(settings->method) && (settings->diagnostics || settings->every_step))
        return 1;
    if (stepper_shares_steps(settings->method, options))
        return most;
    const int fastest = settings->diagnostics ? 4 : settings->lanes;
    return fastest < most ? fastest : most;
}

static json_t *options_to_json(const struct option_spec *specs, const struct options *given) {
    json_t *json = json_object();
    for (int i = 0; specs && specs[i].name; i++) {
        const double value = option_value(given, &specs[i]);
        json_object_set_new(json, specs[i].name,
                            specs[i].kind == OPTION_CHOICE
                                ? json_string(specs[i].choices[(int)value])
                                : json_real(value));
    }
    return json;
}

json_t *settings_to_json(const struct scene *scene, const struct settings *settings) {
    json_t *json = json_object();
    const struct plugin *plugin = plugin_of(settings->method);
    json_object_set_new(json, "stepper", json_string(settings->method->name));
    if (plugin) /* two builds of one are two methods */
        json_object_set_new(json, "plugin", json_string(plugin->hash));
    json_object_set_new(json, "treatment",
                        json_string(scene->problem->treatments[settings->treatment].name));
    if (settings->method->capabilities & STEPPER_ADAPTIVE) {
        json_object_set_new(json, "rtol", json_real(settings->stepper.rtol));
        json_object_set_new(json, "atol", json_real(settings->stepper.atol));
    } else {
        json_object_set_new(json, "step", json_real(settings->step));
    }
    if (scene->frame_rate == 0)
        json_object_set_new(json, "frame_interval", json_real(settings->frame_interval));
    json_object_set_new(json, "options",
                        options_to_json(settings->method->options, &settings->stepper.options));
    if (settings->stepper.linear) {
        json_object_set_new(json, "linear", json_string(settings->stepper.linear->name));
        json_object_set_new(
            json, "linear_options",
            options_to_json(settings->stepper.linear->options, &settings->stepper.options));
    }
    if (settings->perturbation > 0) {
        json_object_set_new(json, "perturbation", json_real(settings->perturbation));
        json_object_set_new(json, "draw", json_integer(settings->draw));
    }
    if (isfinite(settings->strain_limit) && settings->strain_limit != scene_strain_limit(scene))
        json_object_set_new(json, "strain_limit", json_real(settings->strain_limit));
    json_object_set_new(json, "timings", json_integer(settings->timings));
    if (settings->diagnostics)
        json_object_set_new(json, "diagnostics", json_true());
    if (settings->states != STATES_TEXT)
        json_object_set_new(json, "states", json_string(states_format_names[settings->states]));
    return json;
}
