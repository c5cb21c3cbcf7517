/* Measures of one run: what its frames cost, and what its series reach. */
#include "hair_study.h"

#include <math.h>

/* Frames of the whole run as the thesis counts them: its seconds per frame are the total over their
 * number. */
double hair_frames(const struct cost *cost, const struct scene *scene) {
    const double until =
        cost->outcome == FINISHED ? scene->duration : cost->failure_time - scene->begin;
    return floor(until * scene->frame_rate + 1e-9) + 1;
}

struct spread hair_per_frame(const struct cost *cost, const struct scene *scene) {
    const double frames = hair_frames(cost, scene);
    return (struct spread){cost->cpu.median / frames, cost->cpu.least / frames,
                           cost->cpu.greatest / frames};
}

/* In one interleaved run (bench/solvers) a step of implicit Euler takes as long as seven of
 * explicit Euler's: an evaluation, one solution and, in all, five for what is made anew with each
 * factorisation. */
double hair_work_per_frame(const struct run_files *files, const struct cost *cost,
                           const struct scene *scene) {
    return (run_number(files, "counters.force_evaluations") +
            run_number(files, "counters.linear_solves") +
            5 * run_number(files, "counters.factorisations")) /
           hair_frames(cost, scene);
}

struct spread hair_cpu_per_frame(const struct hair_run *run) {
    return hair_per_frame(&run->cost, run->timed->run.scene);
}

double hair_real_time(const struct spread *cpu, const struct scene *scene) {
    return 1 / scene->frame_rate / cpu->median;
}

double hair_contacts(const struct hair_run *run) {
    return run_number(&run->files, "counters.wisp_contacts");
}

double hair_contacts_per_frame(const struct hair_run *run) {
    const struct scene *scene = run->watched->run.scene;
    return hair_contacts(run) / (scene->duration * run->timed->run.scene->frame_rate);
}

int hair_frame_numbered(const struct hair_run *run, int number) {
    return hair_frame_at(&run->hair, (number - 1) / 30.);
}

int hair_largest(const struct hair_run *run, int series) {
    int best = 0;
    for (int f = 1; f < run->hair.frame_count; f++)
        if (run->series[series][f] > run->series[series][best])
            best = f;
    return best;
}
