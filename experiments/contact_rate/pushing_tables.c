/* The tables of bodies by penalty, and what is said of them. */
#include "contact_rate.h"
#include "pushing.h"

#include <math.h>

static const char *response_name(int response) {
    return response == TICKS ? "ticks" : "penalty";
}

#define PUSHED_COLUMNS(X)                                                                        \
    SCENE_COLUMN(X, pushed->subject.name)                                                        \
    X("response", "-", "ticks or penalty: how bodies act", "%s", response_name(i))               \
    X("frequency", "Hz", "frequency of the penalty; 0: ticks", "%g", frequency_of[i])            \
    X("outcome", "-", "how the run ended", "%s", outcome_name(run->outcome))                     \
    X("depth", "m", "largest depth of a free node in a body at a frame", "%.17g", run->depth)    \
    X("error", "m",                                                                              \
      "distance from the run with ticks at 9000 Hz up to the horizon, rms over free nodes and "  \
      "frames",                                                                                  \
      "%.17g", run->error)                                                                       \
    X("largest", "m", "the largest distance of a node there", "%.17g", run->largest)             \
    X("whole", "m", "distance over all frames, rms", "%.17g", run->whole)                        \
    X("evaluations", "1", "evaluations of forces", "%.17g", run->evaluations)                    \
    X("counted", "s", "counted cost: what the table of costs makes of its steps and ticks",      \
      "%.17g", run->counted)                                                                     \
    X("horizon", "s", "to which errors are compared, after the begin", "%.17g", pushed->horizon) \
    X("doubt", "m", "doubt of the run with ticks at 9000 Hz up to the horizon, rms", "%.17g",    \
      pushed->doubt)                                                                             \
    X("compared", "s", "time that was run", "%.17g", pushed->duration)

#define TRIAL_COLUMNS(X)                                                                           \
    X("hair", "-", "springs or rigid segments", "%s", hair_names[probe->hair])                     \
    X("frequency", "Hz", "frequency of the ball's penalty; 0: ticks", "%g",                        \
      frequency_of[probe->response])                                                               \
    METHOD_COLUMNS(X, trial->method)                                                               \
    X("step", "s", "longest step that is good", "%.17g", trial_step(probe, trial))                 \
    X("error", "m", "error with that step, rms over free nodes and frames", "%.17g", trial->error) \
    X("beyond", "s", "the shortest step tried that is not good", "%.17g",                          \
      trial_step(probe, &missed))                                                                  \
    NOTE_COLUMN(X, *trial->note ? trial->note : "-")

enum { PENALTY, STEPS, TABLES };
static const struct table_form tables[TABLES] = {
    {"penalty",
     "one run of rk4 with generalised, bodies acting at ticks or pushing by penalty (damping ratio "
     "1) of a frequency, Hz; 0: ticks, at the scene's own rate; depth: of a free node in a body at "
     "most at a frame, m; error: distance from the run with ticks at 9000 Hz up to the horizon, "
     "rms over free nodes and frames, m; largest: of a node there, m; whole: rms over all frames, "
     "m; evaluations: of forces; counted: what the table of costs makes of its steps and ticks, s; "
     "horizon: the last frame at which the run with ticks at 9000 Hz and the same from a start "
     "1e-10 m away in half the step are within 1 mm, s after the begin; doubt: their rms distance "
     "up to there, m; compared: what was run, s; nan: it failed, or there is none",
     COLUMNS(PUSHED_COLUMNS)},
    {"penalty-steps",
     "the longest fixed step of a method with which one wisp of `swing` that falls onto a ball "
     "stays within a twentieth of its length from `reference` (rms over free nodes and frames, 0.6 "
     "s, generalised), s; hair: default springs, or rigid segments, which only explicit methods "
     "take; frequency: of the ball's penalty, Hz; 0: ticks at 300 Hz, which a step never goes "
     "beyond; error: of that step, m; beyond: the shortest step tried that does not, s; nan: there "
     "is none",
     COLUMNS(TRIAL_COLUMNS)},
};

static void write_pushed(FILE *stream, const struct pushed *pushed) {
    for (int i = 0; i < RESPONSES; i++) {
        const struct pushed_run *run = &pushed->run[i];
        if (run->at >= 0)
            WRITE_ROW(stream, PUSHED_COLUMNS);
    }
}

static void write_trial(FILE *stream, const struct probe *probe, const struct push_trial *trial) {
    struct push_trial missed = *trial;
    missed.place.reached = trial->place.missed;
    WRITE_ROW(stream, TRIAL_COLUMNS);
}

/* A method's rows follow each other, from ticks to the stiffest. */
static void write_steps(FILE *stream, const struct plan *plan, const struct pushing *pushing) {
    for (int hair = 0; hair < HAIRS; hair++)
        for (int i = 0; i < plan->configuration_count; i++)
            for (int response = 0; response < RESPONSES; response++) {
                const struct probe *probe;
                const struct push_trial *trial =
                    trial_of(pushing, hair, response, plan->configurations[i].name, &probe);
                if (trial)
                    write_trial(stream, probe, trial);
            }
}

int pushing_tabulate(struct plan *plan, const struct pushing *pushing) {
    FILE *streams[TABLES];
    if (output_tables(&plan->output, streams, tables, TABLES, "", NULL))
        return -1;
    for (int i = 0; i < pushing->pushed_count; i++)
        write_pushed(streams[PENALTY], &pushing->pushed[i]);
    write_steps(streams[STEPS], plan, pushing);
    return 0;
}

/* --- statements --- */

/* "0.3 mm at 300 Hz, 4 at 30" of the depths or errors, from the stiffest down. */
static void list_runs(const struct pushed *pushed, int depth, char text[256]) {
    const char *mm = " mm", *hz = " Hz";
    text[0] = '\0';
    for (int i = RESPONSES - 1; i > TICKS; i--) {
        const struct pushed_run *run = &pushed->run[i];
        const double value = depth ? run->depth : run->error;
        if (run->at < 0 || !isfinite(value))
            continue;
        list_add(text, 256, "%.2g%s at %g%s", 1e3 * value, mm, frequency_of[i], hz);
        mm = hz = "";
    }
}

/* The softest is what hair sinks into most. */
static void state_depth(struct statements *statements, const struct pushed *pushed) {
    const struct pushed_run *soft = &pushed->run[1], *stiff = &pushed->run[RESPONSES - 1];
    const char *scene = pushed->subject.name;
    char list[256];
    list_runs(pushed, 1, list);
    const int there = isfinite(soft->depth) && isfinite(stiff->depth);
    statements_add(statements,
                   our_row("penalty", "penalty",
                           there ? holds_if(stiff->depth <= HARM) : NOT_REACHED, 1e3 * stiff->depth,
                           "mm", "%.70s, penalty, depth", scene),
                   "On %s bodies by penalty let nodes in by at most %s.", scene,
                   *list ? list : "an unknown depth, for no run came to its end");
}

/* The frequency that comes nearest to what ticks at 9000 Hz do; 0: none can be told. */
static int nearest(const struct pushed *pushed) {
    int best = 0;
    for (int i = TICKS + 1; i < RESPONSES; i++)
        if (pushed->run[i].at >= 0 && isfinite(pushed->run[i].error) &&
            (best == 0 || pushed->run[i].error < pushed->run[best].error))
            best = i;
    return best;
}

static void state_error(struct statements *statements, const struct pushed *pushed) {
    const int best = nearest(pushed);
    const struct pushed_run *run = &pushed->run[best], *ticks = &pushed->run[TICKS];
    const char *scene = pushed->subject.name;
    char list[256];
    list_runs(pushed, 0, list);
    struct statement row =
        our_row("penalty", "penalty",
                best && isfinite(ticks->error) ? holds_if(run->error <= ticks->error) : NOT_REACHED,
                best ? 1e3 * run->error : NAN, "mm", "%.70s, penalty, error", scene);
    if (!best || !isfinite(ticks->error))
        statements_add(statements, row, "On %s no penalty can be compared with ticks: runs fail.",
                       scene);
    else
        statements_add(
            statements, row,
            "On %s %s penalty puts hair as near to where ticks at 9000 Hz put it as ticks at the "
            "scene's own rate, which are %.2g mm off (rms up to %.3g s), for it is %s off.",
            scene, row.verdict == HOLDS ? "some" : "no", 1e3 * ticks->error, pushed->horizon, list);
}

/* By how much a method's longest step is shorter against a body of a high frequency than against
 * the softest: at most `least` times as long where it is said to feel it, at least where it is not.
 */
struct claim {
    int hair, response; /* of frequency_of */
    const char *method;
    int feels;
    double least;
    const char *text;
};

static const struct claim claims[] = {
    {1, 4, "rk4", 1, 0.7, "On rigid segments rk4 feels a body's stiffness at 300 Hz"},
    {0, 4, "rk4", 0, 0.9, "With springs, which are stiffer, rk4 does not feel a body of 300 Hz"},
    {0, 5, "rk4", 0, 0.9, "With springs rk4 does not even feel a body of 1000 Hz"},
    {0, 5, "bdf2", 0, 0.5,
     "With the body in its matrix bdf2 keeps half of its longest step against 1000 Hz"},
};

static void state_stiffness(struct statements *statements, const struct pushing *pushing,
                            const struct claim *claim) {
    const struct probe *soft_probe, *stiff_probe;
    const struct push_trial *soft = trial_of(pushing, claim->hair, 1, claim->method, &soft_probe);
    const struct push_trial *stiff =
        trial_of(pushing, claim->hair, claim->response, claim->method, &stiff_probe);
    if (!soft || !stiff)
        return;
    const double from = trial_step(soft_probe, soft), to = trial_step(stiff_probe, stiff);
    const int there = isfinite(from) && isfinite(to), shorter = to <= claim->least * from;
    struct statement row = our_row(
        "penalty-steps", "penalty-steps", there ? holds_if(shorter == claim->feels) : NOT_REACHED,
        to / from, "1", "penalty, %s, %.60s, %g Hz", hair_names[claim->hair], claim->method,
        frequency_of[claim->response]);
    if (there)
        statements_add(statements, row,
                       "%s: its longest step is %.2g ms there and %.2g ms against %g Hz.",
                       claim->text, 1e3 * to, 1e3 * from, frequency_of[1]);
    else
        statements_add(statements, row, "%s: no step of it is good.", claim->text);
}

void pushing_state(struct statements *statements, const struct pushing *pushing) {
    for (int i = 0; i < pushing->pushed_count; i++) {
        state_depth(statements, &pushing->pushed[i]);
        state_error(statements, &pushing->pushed[i]);
    }
    for (size_t i = 0; i < sizeof claims / sizeof *claims; i++)
        state_stiffness(statements, pushing, &claims[i]);
}
