/* What variants and steppers cost, beside the thesis's times. */
#include "base/files.h"
#include "hair_study.h"

#include <math.h>
#include <string.h>

/* --- variants --- */

/* Frames of the whole run as the thesis counts them: its seconds per frame are the total over their
 * number. */
static double frames_of(const struct scene *scene) {
    return floor(scene->duration * scene->frame_rate + 1e-9) + 1;
}

static struct spread per_frame(const struct cost *cost, const struct scene *scene) {
    const double frames = cost->outcome == FINISHED
                              ? frames_of(scene)
                              : floor(cost->failure_time * scene->frame_rate + 1e-9) + 1;
    return (struct spread){cost->cpu.median / frames, cost->cpu.least / frames,
                           cost->cpu.greatest / frames};
}

struct spread hair_cpu_per_frame(const struct hair_run *run) {
    return per_frame(&run->cost, run->timed->run.scene);
}

/* Simulated over CPU time. */
static double real_time(const struct spread *cpu, const struct scene *scene) {
    return 1 / scene->frame_rate / cpu->median;
}

/* Over the first row's: the median of the medians, and what the spreads allow at most. */
struct ratio {
    double value, least, most;
};

static struct ratio normalise(const struct spread *cpu, const struct spread *first, int is_first) {
    if (is_first)
        return (struct ratio){1, 1, 1};
    return (struct ratio){cpu->median / first->median, cpu->least / first->greatest,
                          cpu->greatest / first->least};
}

/* What is to be said of our ratio beside the thesis's. */
static void compare(char *text, size_t size, const struct ratio *ours, double thesis) {
    if (!(thesis > 0) || !isfinite(ours->value))
        snprintf(text, size, "nothing to compare with");
    else if (thesis >= ours->least && thesis <= ours->most)
        snprintf(text, size, "as in the thesis, within the spread");
    else
        snprintf(text, size, "%.2f of the first row, in the thesis %.2f: %s by %.0f %%",
                 ours->value, thesis, ours->value > thesis ? "more" : "less",
                 100 * fabs(ours->value / thesis - 1));
}

static const char table_columns[] =
    "variant\tstatus\tfailure_time\tcpu_per_frame\tleast\tgreatest\tnormalised\tnormalised_least"
    "\tnormalised_greatest\tthesis_per_frame\tthesis_normalised\tthesis_over_ours\treal_time"
    "\twisp_contacts\tbody_contacts\tsplits\twisps_at_end\tcomparison";

static void write_variant(FILE *stream, const struct hair_study *study, int i) {
    const struct hair_run *run = &study->runs[i];
    const struct spread first = hair_cpu_per_frame(&study->runs[0]), cpu = hair_cpu_per_frame(run);
    const struct ratio ratio = normalise(&cpu, &first, i == 0);
    const double thesis = run->variant->thesis > 0 ? run->variant->thesis : NAN;
    const double thesis_ratio = thesis / study->runs[0].variant->thesis;
    const struct hair *hair = &run->hair;
    const int frames = hair->frame_count;
    const double numbers[] = {run->cost.failure_time,
                              cpu.median,
                              cpu.least,
                              cpu.greatest,
                              ratio.value,
                              ratio.least,
                              ratio.most,
                              thesis,
                              thesis_ratio,
                              thesis / cpu.median,
                              real_time(&cpu, run->timed->run.scene),
                              run_number(&run->files, "counters.wisp_contacts"),
                              run_number(&run->files, "counters.body_contacts"),
                              run_number(&run->files, "counters.splits"),
                              frames > 0 ? (double)hair->frames[frames - 1].wisps : NAN};
    char words[128];
    compare(words, sizeof words, &ratio, study->count > 1 ? thesis_ratio : NAN);
    fprintf(stream, "%s\t%s", run->variant->label, outcome_name(run->cost.outcome));
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
        fprintf(stream, "\t%.17g", numbers[k]);
    fprintf(stream, "\t%s\n", words);
    printf("  %-18s %9.3f %11.2f %11.2f %11.2f %9.1f %9.0f   %s\n", run->variant->label,
           1e3 * cpu.median, ratio.value, thesis, thesis_ratio, hair_contacts_per_frame(run),
           numbers[10], words);
}

static int write_table(struct plan *plan, const char *folder, const struct hair_study *study) {
    struct atomic_file file;
    if (open_table(
            &file, folder, "table",
            "CPU time, s per frame, of repeated runs, beside the thesis's (one processor, MIPS "
            "R4400 at 200 MHz); normalised: over the first row's, with what the spreads allow; "
            "real_time: simulated over CPU time; wisp_contacts: how often a node or sample was in "
            "a "
            "section of another wisp at a tick, body_contacts: in a body; nan: there is no number",
            study->subject->scene, table_columns, plan->reason))
        return -1;
    printf("  %-18s %9s %11s %11s %11s %9s %9s\n", "CPU time per frame", "ms", "normalised",
           "thesis: s", "normalised", "contacts", "real time");
    for (int i = 0; i < study->count; i++)
        write_variant(file.stream, study, i);
    return atomic_commit(&file, plan->reason);
}

/* --- steppers --- */

/* A stepper's run of the main variant. */
struct attempt {
    const struct stepper_method *method;
    const struct labelled_case *one; /* NULL: refused */
    struct run_files files;
    struct hair hair;
    struct cost cost;
};

static int open_attempt(struct plan *plan, const struct hair_study *study,
                        const struct stepper_method *method, struct attempt *attempt) {
    const struct labelled_case *recipe = study->runs[study->question->main].timed;
    *attempt = (struct attempt){.method = method, .cost.outcome = REFUSED};
    attempt->one =
        recipe->run.settings.method == method ? recipe : find_case(plan, "steppers", method->name);
    if (!attempt->one)
        return 0;
    if (run_read(&attempt->files, attempt->one->run.folder, plan->reason))
        return -1;
    attempt->cost = run_cost(&attempt->files);
    return hair_open(&attempt->hair, attempt->one->run.scene, &attempt->files.states,
                     (enum wisp_treatment)attempt->one->run.settings.treatment, plan->reason);
}

static void close_attempt(struct attempt *attempt) {
    hair_close(&attempt->hair);
    if (attempt->one)
        run_free(&attempt->files);
}

/* How far an attempt goes with another: rms distance over the common frames, and the last frame
 * until which it is never more than a millimetre. */
struct agreement {
    double distance, until; /* m, s */
};

static struct agreement agree(const struct hair *a, const struct hair *b) {
    struct agreement agreement = {NAN, NAN};
    double squares = 0;
    int frames = 0, parted = 0;
    for (double d; !isnan(d = hair_distance(a, b, frames)); frames++) {
        squares += d * d;
        parted |= d > 1e-3;
        agreement.until = parted ? agreement.until : a->frames[frames].t;
    }
    agreement.distance = frames > 0 ? sqrt(squares / frames) : NAN;
    return agreement;
}

static double largest_strain(const struct hair *hair) {
    double largest = hair->frame_count > 0 ? 0 : NAN;
    for (int f = 0; f < hair->frame_count; f++)
        largest = fmax(largest, hair_strain(hair, f));
    return largest;
}

static void name_setting(char *text, size_t size, const struct settings *settings) {
    if (settings->method->capabilities & STEPPER_ADAPTIVE)
        snprintf(text, size, "rtol %g", settings->stepper.rtol);
    else
        snprintf(text, size, "%.0f Hz", 1 / settings->step);
}

static void write_attempt(FILE *stream, const struct attempt *attempt, const struct attempt *base) {
    char setting[64] = "–";
    struct spread cpu = {NAN, NAN, NAN};
    struct agreement agreement = {NAN, NAN};
    const char *note = "refused";
    if (attempt->one) {
        name_setting(setting, sizeof setting, &attempt->one->run.settings);
        cpu = per_frame(&attempt->cost, attempt->one->run.scene);
        note = json_string_value(json_object_get(attempt->files.json, "reason"));
    }
    if ((!note || !*note) && (!base || base->method == attempt->method))
        note = base ? "what the others are compared with" : "nothing to compare with";
    if (attempt->one && base && base->method != attempt->method)
        agreement = agree(&attempt->hair, &base->hair);
    const double speed = attempt->one ? real_time(&cpu, attempt->one->run.scene) : NAN;
    const double strain = attempt->one ? largest_strain(&attempt->hair) : NAN;
    const char *outcome = outcome_name(attempt->cost.outcome);
    fprintf(stream, "%s\t%s\t%s\t%.17g\t%.17g\t%.17g\t%.17g\t%s\t%.17g\t%.17g\t%s\n",
            attempt->method->name, setting, outcome,
            attempt->one ? attempt->cost.failure_time : NAN, cpu.median, speed, strain,
            base ? base->method->name : "–", agreement.distance, agreement.until, note ? note : "");
    printf("  %-16s %-12s %-14s %9.3f %9.1f %10.4f %13.4f %10.2f\n", attempt->method->name, setting,
           outcome, 1e3 * cpu.median, speed, strain, 1e3 * agreement.distance, agreement.until);
}

/* Whom the others are compared with: `reference`, else rk4, where it reached its end. */
static int open_base(struct plan *plan, const struct hair_study *study, struct attempt *base,
                     int *there) {
    static const char *const names[] = {"reference", "rk4"};
    *there = 0;
    for (int i = 0; i < 2 && !*there; i++) {
        if (open_attempt(plan, study, stepper_find(names[i]), base)) {
            close_attempt(base);
            return -1;
        }
        *there = base->one && base->cost.outcome == FINISHED;
        if (!*there)
            close_attempt(base);
    }
    return 0;
}

static int write_attempts(struct plan *plan, const struct hair_study *study, FILE *stream,
                          const struct attempt *base) {
    int code = 0;
    for (int i = 0; stepper_methods[i] && !code; i++) {
        struct attempt attempt;
        if (!plan_wants(plan, stepper_methods[i]->name))
            continue;
        code = open_attempt(plan, study, stepper_methods[i], &attempt);
        if (!code)
            write_attempt(stream, &attempt, base);
        close_attempt(&attempt);
    }
    return code;
}

static int write_steppers(struct plan *plan, const char *folder, const struct hair_study *study) {
    const struct scene *main_scene = study->runs[study->question->main].timed->run.scene;
    struct atomic_file file;
    struct attempt base;
    int there;
    if (open_base(plan, study, &base, &there))
        return -1;
    int code = open_table(
        &file, folder, "steppers",
        "every stepper, one run, treatment projection; CPU time, s per frame (up to its failure, "
        "where it failed); real_time: simulated over CPU time; largest |L/l - 1| of a stretch "
        "spring; distance: rms over free nodes and common frames from the run it is compared "
        "with, m; until: the last frame before it is more than 1 mm, s",
        main_scene,
        "stepper\tsetting\tstatus\tfailure_time\tcpu_per_frame\treal_time\tstrain"
        "\tcompared_with\tdistance\tuntil\tnote",
        plan->reason);
    if (!code) {
        printf("  %-16s %-12s %-14s %9s %9s %10s %13s %10s\n", "stepper", "", "", "ms/frame",
               "real time", "strain", "distance, mm", "until, s");
        code = write_attempts(plan, study, file.stream, there ? &base : NULL);
        if (code)
            atomic_discard(&file);
        else
            code = atomic_commit(&file, plan->reason);
    }
    if (there && base.one->run.scene->duration < main_scene->duration)
        printf("  (%s goes to %g s only, for it takes minutes; distances are up to there)\n",
               base.method->name, base.one->run.scene->duration);
    if (there)
        close_attempt(&base);
    return code;
}

int hair_cost_tables(struct plan *plan, const char *folder, struct hair_study *study) {
    return write_table(plan, folder, study) || write_steppers(plan, folder, study) ? -1 : 0;
}
