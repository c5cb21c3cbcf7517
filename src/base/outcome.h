/* How a run, or one step of it, can end. Failure is a result: every kind has a name that is
 * written to run.json and drawn on charts. */
#ifndef WISPLAB_OUTCOME_H
#define WISPLAB_OUTCOME_H

/* X(symbol, name in files, exit code of `wisplab run`, meaning) */
#define OUTCOMES(X)                                                                              \
    X(FINISHED, "finished", 0, "the run reached its end")                                        \
    X(NOT_FINITE, "not finite", 3, "a state holds an infinity or a NaN")                         \
    X(DIVERGED, "diverged", 3, "the state is finite but outside what the model can mean")        \
    X(SOLVER_STALLED, "solver stalled", 3, "a linear or nonlinear iteration did not converge")   \
    X(STEP_TOO_SMALL, "step too small", 3, "an adaptive method could not go on at any step")     \
    X(MODEL_FAILED, "model failed", 3, "the force model could not be evaluated at a state")      \
    X(OUT_OF_TIME, "out of time", 3, "the time limit ended the run")                             \
    X(OUT_OF_MEMORY, "out of memory", 2, "memory could not be had, or the memory limit was hit") \
    X(CRASHED, "crashed", 3, "the process of the run died")                                      \
    X(INTERRUPTED, "interrupted", 3, "the user ended the run")                                   \
    X(REFUSED, "refused", 1, "the combination of scene, stepper and settings is not supported")  \
    X(OUTPUT_FAILED, "output failed", 2, "a result could not be written")

enum outcome {
#define X(symbol, name, code, meaning) symbol,
    OUTCOMES(X)
#undef X
        OUTCOME_COUNT
};

/* Name of an outcome as written to files; static storage. */
const char *outcome_name(enum outcome outcome);

/* Exit code of `wisplab run` for an outcome. */
int outcome_exit_code(enum outcome outcome);

/* The outcome of that name, or OUTCOME_COUNT where there is none. */
enum outcome outcome_from_name(const char *name);

#endif
