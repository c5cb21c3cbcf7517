#include "warnings.h"

#include "base/vector.h"

#include <complex.h>
#include <math.h>
#include <stdio.h>

static void warn(json_t *warnings, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void warn(json_t *warnings, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    json_array_append_new(warnings, json_vsprintf(format, arguments));
    va_end(arguments);
}

/* --- bodies act on points, and at ticks only --- */

/* The largest speed of a body's centre within an interval of the head's motion, m/s: as a cubic
 * moves it, and turns, its speed is smooth, and 64 looks miss its largest by less than one in a
 * thousand. */
static double fastest_between(const struct scene *scene, const struct body *body, double from,
                              double to) {
    enum { LOOKS = 64 };
    double most = 0;
    for (int i = 0; i <= LOOKS; i++) {
        const double t = from + (to - from) * i / LOOKS;
        struct placement head;
        head_placement(&scene->around.head, t, &head);
        most = fmax(most, vector_length(body_motion(body, &head, t).velocity));
    }
    return most;
}

static double fastest(const struct scene *scene, const struct body *body) {
    const struct head_motion *head = &scene->around.head;
    const double end = scene->begin + scene->duration;
    double from = scene->begin, most = 0;
    for (int k = 0; k <= head->knots; k++) {
        const double to = k < head->knots ? fmin(head->time[k], end) : end;
        if (to <= from)
            continue;
        most = fmax(most, fastest_between(scene, body, from, to));
        from = to;
    }
    return most;
}

static double longest_segment(const struct scene *scene) {
    double most = 0;
    for (int i = 0; i < scene->wisp_count; i++)
        most = fmax(most, wisp_spacing(&scene->wisps[i]));
    return most;
}

static void look_at_body(const struct scene *scene, const struct body *body, json_t *warnings) {
    const double radius = fmin(body->radii[0], fmin(body->radii[1], body->radii[2]));
    const double way = fastest(scene, body) / scene->collision_rate;
    const double segment = longest_segment(scene);
    if (way > 2 * radius)
        warn(warnings,
             "body '%s' can pass hair unseen: it moves by up to %.3g m from tick to tick (%g Hz), "
             "and its least diameter is %.3g m",
             body->name, way, scene->collision_rate, 2 * radius);
    if (radius < segment / 2)
        warn(warnings,
             "body '%s' can pass between nodes unseen: its least radius is %.3g m, below half a "
             "segment of %.3g m",
             body->name, radius, segment);
}

/* --- the clock --- */

static int depends_on_time(const struct scene *scene) {
    const struct surroundings *around = &scene->around;
    int moving = around->wind.kind == WIND_GUST || around->wind.kind == WIND_IRREGULAR ||
                 around->style.knots > 1 || around->head.knots > 1;
    for (int i = 0; i < scene->body_count; i++)
        moving |= vector_length(scene->bodies[i].velocity) > 0;
    return moving;
}

static void look_at_clock(const struct scene *scene, json_t *warnings) {
    if (scene->start.rows && depends_on_time(scene) && !json_object_get(scene->source, "begin"))
        warn(warnings, "start without begin: wind, style, head or bodies depend on time, and the "
                       "clock begins at 0 s; begin = 0.0 says that this is meant");
}

/* --- the head --- */

/* A rotation vector is interpolated as three numbers: what it does between two knots is the turn
 * from one to the other only where they are near. */
static void look_at_head(const struct scene *scene, json_t *warnings) {
    const struct head_motion *head = &scene->around.head;
    const double pi = acos(-1);
    for (int k = 1; k < head->knots; k++) {
        double apart[3] = {0};
        vector_add(apart, 1, head->rotation[k]);
        vector_add(apart, -1, head->rotation[k - 1]);
        if (vector_length(apart) > pi)
            warn(warnings,
                 "the head's rotations at %g and %g s are %.3g rad apart, more than half a turn: "
                 "between them it does not turn the short way; knots between them say which way",
                 head->time[k - 1], head->time[k], vector_length(apart));
    }
}

/* --- bodies that push by penalty --- */

/* Whether steps of h of an explicit method keep a point on a body's spring, deep enough for the
 * whole damping, where linear theory says: a sphere's is its own there, and no ellipsoid is
 * stiffer. */
static int follows(const struct stepper_method *method, const struct body *body, double h) {
    const double omega = 2 * acos(-1) * body->frequency, zeta = body->damping_ratio;
    const double complex root = csqrt(zeta * zeta - 1);
    return cabs(stepper_amplification(method, h * omega * (-zeta + root),
                                      h * omega * (-zeta - root))) <= 1;
}

static void look_at_spring(const struct stepper_method *method, double step,
                           const struct body *body, json_t *warnings) {
    double least = step;
    if (follows(method, body, step))
        return;
    while (least > step / 1000 && !follows(method, body, least))
        least *= 0.99;
    if (least > step / 1000)
        warn(
            warnings,
            "body '%s' pushes at %g Hz: %s follows that with steps of up to %.2g s, and these have "
            "%.2g s",
            body->name, body->frequency, method->name, least, step);
    else
        warn(warnings,
             "body '%s' pushes at %g Hz with damping ratio %g: no step of %s follows that",
             body->name, body->frequency, body->damping_ratio, method->name);
}

static void look_at_springs(const struct scene *scene, const struct settings *settings,
                            json_t *warnings) {
    const struct stepper_method *method = settings->method;
    if (method->capabilities & (STEPPER_IMPLICIT | STEPPER_ADAPTIVE) ||
        !stepper_is_predictable(method))
        return;
    for (int i = 0; i < scene->around.pushing_count; i++)
        look_at_spring(method, settings->step, &scene->around.pushing[i], warnings);
}

/* --- files that are too large to be read back --- */

static void look_at_size(const struct scene *scene, const struct settings *settings,
                         json_t *warnings) {
    const double number = settings->states == STATES_TEXT
                              ? 16 /* bytes: 6 to 15 in shipped scenes */
                          : settings->states == STATES_BINARY ? 8
                                                              : 0;
    const double bytes =
        settings_frames(scene, settings) * settings->rows * settings->columns * number;
    if (bytes > 1 << 30)
        warn(warnings,
             "the states can take %.2g GB, and files of more than a gibibyte are read back "
             "by "
             "nothing here: fewer frames a second (frame_rate) or --states none take less",
             1e-9 * bytes);
}

json_t *scene_warnings(const struct scene *scene, const struct settings *settings) {
    json_t *warnings = json_array();
    look_at_clock(scene, warnings);
    look_at_head(scene, warnings);
    for (int i = 0; i < scene_tick_bodies(scene) && scene->collision_rate > 0; i++)
        look_at_body(scene, &scene->bodies[i], warnings);
    if (settings) {
        look_at_springs(scene, settings, warnings);
        look_at_size(scene, settings, warnings);
    }
    return warnings;
}
