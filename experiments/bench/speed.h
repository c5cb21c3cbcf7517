/* What `wisplab-bench speed` measures: whole scenes, steps, sizes, and other people's programs. */
#ifndef WISPLAB_BENCH_SPEED_H
#define WISPLAB_BENCH_SPEED_H

#include "base/hash.h"
#include "measure.h"
#include "run/settings.h"

/* --- what was chosen by runs: choices.tsv in the folder (speed_scenes.c) --- */

struct choice {
    char subject[SUBJECT_SIZE]; /* "1 mm recipe" */
    char method[48], treatment[24];
    double target, setting, error; /* m; step, s, or rtol; m */
    int is_recipe;
};

struct choices {
    int count;
    char hash[HASH_SIZE]; /* of the table */
    struct choice *choice;
};

/* NULL with one line in `reason` where it cannot be read. */
struct choices *choices_read(const char *folder, char *reason);
void choices_free(struct choices *choices);

/* --- a run in this process: no frames, no files --- */

struct timed_run {
    const struct scene *scene;
    struct settings settings;
};

/* Ends the program where the scene cannot be run so. */
struct timed_run *timed_run(const struct scene *scene, const struct run_request *request);

/* Runs it; ends the program where it does not finish. */
void timed_run_do(void *timed_run);

/* A scene of the experiments with overrides and other numbers of nodes and samples; 0: as they are.
 * Ends the program where there is none. */
struct scene *bench_scene(const char *name, const char *const *sets, int set_count);

/* --- entries --- */

/* That of section 5.6, which is also measured with ten times its wisps. */
extern const char thesis_scene[];
enum { THREADS = 2 };
void enter_scenes(struct contest *contest, const struct scene *scene,
                  const struct choices *choices);

/* A step of each fixed-step method over one of explicit Euler, in full parts. */
void enter_steps(struct contest *contest);
enum { STEP_SETS = 2 };
extern const char *const step_sets[STEP_SETS];

/* Cost against wisps, nodes and samples, and memory. */
void enter_sizes(struct contest *contest, int quick);
enum { SIZED_METHODS = 3 };
extern const char *const sized_methods[SIZED_METHODS];

/* One smooth scene by others: each at its longest step or loosest tolerance that is exact enough.
 */
void enter_peers(struct contest *contest);
struct peer_question {
    const char *name; /* the subject */
    int wisps;
    double target; /* m, rms over free nodes and frames */
};
enum { PEER_QUESTIONS = 2 };
extern const struct peer_question peer_questions[PEER_QUESTIONS];

/* --- tables (speed_tables.c) --- */

/* As write_tables. */
int write_speed_tables(const struct scene *scene, const struct choices *choices,
                       const struct samples *samples, struct output *output);

#endif
