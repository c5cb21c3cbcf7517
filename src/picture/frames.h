/* The frames of a run of wisps read back, with the scene that made them. */
#ifndef WISPLAB_FRAMES_H
#define WISPLAB_FRAMES_H

#include "model/scene.h"
#include "model/trajectory.h"
#include "wisp/hair.h"

struct frames {
    struct scene *scene; /* as run.json has it */
    char run[80];        /* "rk4 generalised": stepper and treatment, and how it failed */
    enum wisp_treatment treatment;
    int count;          /* numbered from 1 */
    int wisp_count;     /* in the last frame; no frame has more */
    struct wisp *wisps; /* numbers of each; those that came of a subdivision have their parent's */
    const int *parent;  /* by wisp, as states have it; of the scene's wisps they themselves */
    int *born;          /* by wisp: in which frame it is seen first */

    struct trajectories *owner;
    const struct trajectory *states; /* lent by the owner */
    int *first_row;                  /* of the states, by frame - 1; and the last's end */
    int *offset;                     /* from there, by wisp */
};

/* The states that a word names: a path that ends in .tsv or .npy, or the folder of a run. Returns
 * 1, with their path in `states` (PATH_SIZE), or 0 where it names none. */
int frames_path(const char *word, char *states);

/* Takes the file `states`, which must have its run.json beside it, from `owner` (or NULL); `sets`
 * change the scene as in scene_load. A last frame that is not complete is left out if the run says
 * that it failed. Returns 0, or with one line in `reason` (REASON_SIZE) the exit code: 1 where the
 * files are wrong, 2 where memory for the scene cannot be had. To be closed either way. */
int frames_open(struct frames *frames, const char *states, struct trajectories *owner,
                const char *const *sets, int set_count, char *reason);
void frames_close(struct frames *frames);

double frames_time(const struct frames *frames, int frame);
int frames_wisps(const struct frames *frames, int frame);

/* Puts a wisp's state at a frame into a strand that was made of its numbers and treatment. */
void frames_load(const struct frames *frames, int frame, int wisp, struct strand *strand);

/* A strand for each wisp, to be loaded. */
struct strand **frames_strands(const struct frames *frames);
void frames_strands_free(const struct frames *frames, struct strand **strands);

/* Who of the wisps of the scene a wisp comes from, and which of its hairs the wisp has in a frame.
 */
int frames_ancestor(const struct frames *frames, int wisp);
struct hair_share frames_share(const struct frames *frames, int frame, int wisp);

/* Raises `most` to the largest p . direction of the points p of all frames, nodes with their
 * envelopes, for each of four directions; of a run that diverged, as far as a wisp can reach. */
void frames_extent(const struct frames *frames, const double directions[4][3], double most[4]);

#endif
