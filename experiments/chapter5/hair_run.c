/* Measures of one run: what its frames cost, and what its series reach. */
#include "hair_study.h"

#include <math.h>

/* Frames of the whole run as the thesis counts them: its seconds per frame are the total over their
 * number. */
static double frames_of(const struct scene *scene) {
    return floor(scene->duration * scene->frame_rate + 1e-9) + 1;
}

struct spread hair_per_frame(const struct cost *cost, const struct scene *scene) {
    const double frames =
        cost->outcome == FINISHED
            ? frames_of(scene)
            : floor((cost->failure_time - scene->begin) * scene->frame_rate + 1e-9) + 1;
    return (struct spread){cost->cpu.median / frames, cost->cpu.least / frames,
                           cost->cpu.greatest / frames};
}

struct spread hair_cpu_per_frame(const struct hair_run *run) {
    return hair_per_frame(&run->cost, run->timed->run.scene);
}

double hair_real_time(const struct spread *cpu, const struct scene *scene) {
    return 1 / scene->frame_rate / cpu->median;
}

double hair_contacts_per_frame(const struct hair_run *run) {
    const struct scene *scene = run->watched->run.scene;
    return run_number(&run->files, "counters.wisp_contacts") /
           (scene->duration * run->timed->run.scene->frame_rate);
}

int hair_largest(const struct hair_run *run, int series) {
    int best = 0;
    for (int f = 1; f < run->hair.frame_count; f++)
        if (run->series[series][f] > run->series[series][best])
            best = f;
    return best;
}
