/* Trajectories of other programs in a race: a file of states each, which is checked against the
 * scene that it is of before anything is run, and compared with the scene's reference as our own
 * runs are. What it cost it says itself, or nobody knows. */
#include "base/hash.h"
#include "base/options.h"
#include "base/visible.h"
#include "model/model.h"
#include "model/problems.h"
#include "race.h"
#include "run/identity.h"
#include "scene/scene_load.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

/* Frames are ours to that, s, and the start to that, m. Less than that is no error of a method. */
static const double same_time = 1e-9, same_place = 1e-6;

/* Writes "FILE:LINE: what" (printf), without a line where that is 0, and returns -1. */
static int wrong(const struct foreign *foreign, int line, char *reason, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
static int wrong(const struct foreign *foreign, int line, char *reason, const char *format, ...) {
    va_list arguments;
    int used = snprintf(reason, REASON_SIZE, "--states %s: %.120s:", foreign->name, foreign->file);
    if (line > 0)
        used += snprintf(reason + used, REASON_SIZE - (size_t)used, "%d:", line);
    used += snprintf(reason + used, REASON_SIZE - (size_t)used, " ");
    va_start(arguments, format);
    vsnprintf(reason + used, REASON_SIZE - (size_t)used, format, arguments);
    va_end(arguments);
    return -1;
}

/* --- what is said of it --- */

/* "name=file", where no other curve of the chart has the name. */
static int read_name(struct plan *plan, struct foreign *foreign, const char *given) {
    static const char letters[] =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-+._ ";
    const size_t length = strspn(given, letters);
    int taken = 0;
    if (length == 0 || given[length] != '=' || !given[length + 1] ||
        length >= sizeof foreign->name || given[0] == ' ')
        return fail_with(plan->reason,
                         "--states %.150s: must be NAME=FILE, with a NAME of up to %d letters, "
                         "digits, blanks and -+._",
                         given, (int)sizeof foreign->name - 1);
    snprintf(foreign->name, sizeof foreign->name, "%.*s", (int)length, given);
    foreign->file = given + length + 1;
    struct configuration *all = configurations_choose(CONFIGURATION_ANY, 0);
    for (const struct configuration *own = all; own && own->name; own++)
        taken |= strcmp(own->name, foreign->name) == 0;
    free(all);
    return taken ? wrong(foreign, 0, plan->reason,
                         "a method of wisplab has that name; give the curve another one")
                 : 0;
}

/* What the lines before the column names say. */
struct heading {
    char treatment[32];   /* empty: not said */
    char hash[HASH_SIZE]; /* of the scene; empty likewise */
    int treatment_line, hash_line;
};

/* The text after `key`, or NULL where the line is of something else. */
static const char *value_of(const char *line, const char *key) {
    return strncmp(line, key, strlen(key)) == 0 ? line + strlen(key) : NULL;
}

/* Where wisplab wrote the table itself, its settings say the treatment. */
static void take_settings(struct heading *heading, const char *text, int line) {
    json_t *settings = json_loads(text, 0, NULL);
    const char *treatment = json_string_value(json_object_get(settings, "treatment"));
    if (treatment) {
        snprintf(heading->treatment, sizeof heading->treatment, "%s", treatment);
        heading->treatment_line = line;
    }
    json_decref(settings);
}

static int take_line(struct foreign *foreign, struct heading *heading, const char *text, int line,
                     char *reason) {
    const struct {
        const char *key;
        double *number;
    } numbers[] = {{"# evaluations: ", &foreign->evaluations},
                   {"# cpu_seconds: ", &foreign->cpu},
                   {"# setting: ", &foreign->setting}};
    const char *value;
    for (int i = 0; i < 3; i++)
        if ((value = value_of(text, numbers[i].key)) != NULL &&
            (parse_real(value, numbers[i].number) || !(*numbers[i].number > 0)))
            return wrong(foreign, line, reason, "'%.60s' must end in a positive number", text);
    if ((value = value_of(text, "# treatment: ")) != NULL) {
        snprintf(heading->treatment, sizeof heading->treatment, "%s", value);
        heading->treatment_line = line;
    }
    if ((value = value_of(text, "# settings ")) != NULL)
        take_settings(heading, value, line);
    if (value_of(text, "# scene ") && (value = strstr(text, ", hash ")) != NULL) {
        snprintf(heading->hash, HASH_SIZE, "%s", value + strlen(", hash "));
        heading->hash_line = line;
    }
    return 0;
}

static int read_heading(struct foreign *foreign, struct heading *heading, char *reason) {
    FILE *file = open_regular(foreign->file);
    char *line = NULL;
    size_t size = 0;
    int code = 0, number = 1;
    *heading = (struct heading){.treatment_line = 0};
    foreign->evaluations = foreign->cpu = foreign->setting = NAN;
    if (!file || hash_file(foreign->file, foreign->hash))
        code =
            wrong(foreign, 0, reason, "%s",
                  errno == EINVAL ? "is no regular file of at most a gibibyte" : strerror(errno));
    for (; !code && getline(&line, &size, file) > 0 && line[0] == '#'; number++) {
        line[strcspn(line, "\r\n")] = '\0';
        code = take_line(foreign, heading, line, number, reason);
    }
    free(line);
    if (file)
        fclose(file);
    return code;
}

/* --- which field it is of --- */

static int is_of(const struct subject *subject, const struct scene *whole, const char *hash) {
    char own[HASH_SIZE], reason[REASON_SIZE];
    struct scene *as_it_is = scene_load(subject->source, NULL, 0, reason);
    const struct scene *const scenes[] = {subject->scene, whole, as_it_is};
    int same = 0;
    for (int i = 0; i < 3; i++)
        if (scenes[i]) {
            scene_hash(scenes[i], own);
            same |= strcmp(own, hash) == 0;
        }
    if (as_it_is)
        scene_free(as_it_is);
    return same;
}

/* Where nothing is said it is of the only scene, and of the equations that others can write down:
 * without an envelope all treatments are one. */
static int find_field(struct plan *plan, const struct race_notes *notes, struct foreign *foreign,
                      const struct heading *heading) {
    const char *name = plan->subjects[0].name;
    int found = 0;
    for (int f = 0; f < notes->field_count; f++) {
        const struct field *field = &notes->fields[f];
        const struct scene *scene = field->subject->scene;
        const int any =
            scene->wisps[0].samples == 0 && treatment_find(scene->problem, heading->treatment) >= 0;
        const char *treatment =
            heading->treatment[0] && !any ? heading->treatment : race_treatment(WISP_GENERALISED);
        if (heading->hash[0] ? !is_of(field->subject, field->whole, heading->hash)
                             : plan->subject_count > 1)
            continue;
        found = 1;
        name = field->subject->name;
        if (strcmp(treatment, race_treatment(field->treatment)) == 0)
            foreign->field = field;
    }
    if (foreign->field)
        return 0;
    if (found)
        return wrong(foreign, heading->treatment_line, plan->reason,
                     "is of treatment '%.30s', with which nothing is run on %s; '# treatment: ' in "
                     "its first lines says another one",
                     heading->treatment[0] ? heading->treatment : race_treatment(WISP_GENERALISED),
                     name);
    if (heading->hash[0])
        return wrong(foreign, heading->hash_line, plan->reason,
                     "is of a scene with hash %s, which %s has not; compute it on the scene that "
                     "is run here",
                     heading->hash, plan->subject_count > 1 ? "none of the scenes" : name);
    return wrong(foreign, 0, plan->reason,
                 "does not say of which of %d scenes it is; give --scene, or its line '# scene "
                 "NAME, hash ...'",
                 plan->subject_count);
}

/* --- its rows --- */

/* The line of a row of the table, for messages; 0 where that is not text. */
static int line_of_row(const char *path, int row) {
    FILE *file = open_regular(path);
    char *line = NULL;
    size_t size = 0;
    int number = 0, at = -1; /* the column names are no row */
    while (file && at <= row && getline(&line, &size, file) > 0) {
        number++;
        if (line[0] != '#' && at++ == row)
            break;
    }
    free(line);
    if (file)
        fclose(file);
    return at > row ? number : 0;
}

/* The frame at a time, or -1. */
static int frame_at(const struct trajectory *trajectory, double t) {
    for (int f = 0; f < trajectory->frame_count; f++)
        if (fabs(trajectory->frames[f].t - t) <= same_time)
            return f;
    return -1;
}

static int place_columns(const struct foreign *foreign, const struct trajectory *trajectory,
                         int columns[3], char *reason) {
    static const char *const names[] = {"x", "y", "z"};
    for (int k = 0; k < 3; k++) {
        columns[k] = table_column(&trajectory->table, names[k]);
        if (columns[k] < 0)
            return wrong(foreign, line_of_row(foreign->file, -1), reason,
                         "has no column %s; it must have t, wisp, node, x, y, z", names[k]);
    }
    return 0;
}

/* What is wrong with row i of a frame, where a scene's frame has the row `own`: 0, or -1 with a
 * reason. */
static int check_row(const struct foreign *foreign, const struct trajectory *trajectory, int row,
                     const int columns[3], const double *own, int at_start, char *reason) {
    const double *values = trajectory_row(trajectory, row);
    const char *scene = foreign->field->subject->name;
    double square = 0;
    if (values[STATE_WISP] != own[0] || values[STATE_NODE] != own[1])
        return wrong(foreign, line_of_row(foreign->file, row), reason,
                     "is of wisp %g, node %g, not of wisp %g, node %g: a frame of %s has all wisps "
                     "and all their nodes in order, from 0 on",
                     values[STATE_WISP], values[STATE_NODE], own[0], own[1], scene);
    for (int k = 0; k < 3; k++) {
        const double off = values[columns[k]] - own[2 + k];
        square += off * off;
        if (!isfinite(values[columns[k]]))
            return wrong(foreign, line_of_row(foreign->file, row), reason,
                         "has no finite position; a run that failed has no error");
    }
    if (at_start && !(sqrt(square) <= same_place))
        return wrong(foreign, line_of_row(foreign->file, row), reason,
                     "begins with node %g of wisp %g %.3g m from where %s has it; begin with the "
                     "scene's own state",
                     own[1], own[0], sqrt(square), scene);
    return 0;
}

static int check_frame(const struct foreign *foreign, const struct trajectory *trajectory,
                       int frame, const struct model *model, const double *start, char *reason) {
    const int first = trajectory->frames[frame].row,
              count = trajectory_end(trajectory, frame) - first;
    int columns[3], code = place_columns(foreign, trajectory, columns, reason);
    for (int i = 0; i < count && i < model->row_count && !code; i++)
        code = check_row(foreign, trajectory, first + i, columns, start + i * model->column_count,
                         frame == 0, reason);
    if (!code && count != model->row_count)
        code = wrong(foreign, line_of_row(foreign->file, first + count - 1), reason,
                     "ends a frame of %d rows; one of %s has %d, for each wisp and node", count,
                     foreign->field->subject->name, model->row_count);
    return code;
}

/* All frames up to where the scene may be compared. */
static int check_frames(const struct foreign *foreign, const struct trajectory *trajectory,
                        const struct model *model, const double *start, char *reason) {
    const struct scene *scene = foreign->field->whole;
    const int frames = (int)lround(scene->duration * scene->frame_rate);
    int code = 0;
    for (int k = 0; k <= frames && !code; k++) {
        const double t = scene->begin + fmin(k / scene->frame_rate, scene->duration);
        const int frame = frame_at(trajectory, t);
        if (frame < 0)
            return wrong(
                foreign, 0, reason,
                "has no frame at t = %.17g s; %s is compared at %g frames a second from %g to %g s",
                t, foreign->field->subject->name, scene->frame_rate, scene->begin,
                scene->begin + scene->duration);
        code = check_frame(foreign, trajectory, frame, model, start, reason);
    }
    return code;
}

static int check_rows(struct plan *plan, const struct foreign *foreign) {
    const struct scene *scene = foreign->field->whole;
    const struct trajectory *trajectory =
        trajectories_take(plan->trajectories, foreign->file, plan->reason);
    if (!trajectory)
        return -1;
    struct model *model = scene->problem->create(scene, foreign->field->treatment, 1);
    double *start =
        model ? calloc((size_t)model->row_count, (size_t)model->column_count * sizeof *start)
              : NULL;
    int code = -1;
    if (start) {
        model->problem->sample(model, start);
        code = check_frames(foreign, trajectory, model, start, plan->reason);
    } else {
        snprintf(plan->reason, REASON_SIZE, "out of memory");
    }
    free(start);
    if (model)
        scene->problem->free(model);
    trajectories_return(plan->trajectories, trajectory);
    return code;
}

/* --- all of them --- */

/* Points of a curve follow each other from what took least on. */
static int by_curve(const void *one, const void *other) {
    const struct foreign *a = one, *b = other;
    const int names = strcmp(a->name, b->name);
    const double x = isnan(a->evaluations) ? a->cpu : a->evaluations,
                 y = isnan(b->evaluations) ? b->cpu : b->evaluations;
    return names ? names : (x > y) - (x < y);
}

/* Rows of a table differ in their method, treatment or setting. */
static int check_settings(struct plan *plan, const struct race_notes *notes) {
    for (int i = 0; i < notes->foreign_count; i++)
        for (int k = 0; k < i; k++) {
            const struct foreign *one = &notes->foreign[k], *other = &notes->foreign[i];
            if (strcmp(one->name, other->name) == 0 && one->field == other->field &&
                (one->setting == other->setting || (isnan(one->setting) && isnan(other->setting))))
                return wrong(other, 0, plan->reason,
                             "has the setting of %.100s; points of one curve are told apart by '# "
                             "setting: ' in their first lines",
                             one->file);
        }
    return 0;
}

int race_foreign_plan(struct plan *plan, struct race_notes *notes) {
    for (int i = 0; i < plan->states_count; i++) {
        struct foreign *foreign = &notes->foreign[i];
        struct heading heading;
        if (read_name(plan, foreign, plan->states[i]) ||
            read_heading(foreign, &heading, plan->reason) ||
            find_field(plan, notes, foreign, &heading) || check_rows(plan, foreign))
            return -1;
    }
    notes->foreign_count = plan->states_count;
    qsort(notes->foreign, (size_t)notes->foreign_count, sizeof *notes->foreign, by_curve);
    return check_settings(plan, notes);
}

/* --- its point --- */

/* The frames that are compared, in the columns of the reference: those of samples where the file
 * has all, and no velocity where it has none. Returns 0, or -1 where memory cannot be had. */
static int take_frames(const struct foreign *foreign, const struct trajectory *given,
                       struct table *table) {
    const struct trajectory *reference = foreign->field->reference.states;
    const struct scene *scene = foreign->field->scene;
    int columns[TABLE_COLUMNS_MAX], count = 0, samples = 1;
    for (; count < reference->table.column_count; count++) {
        columns[count] = table_column(&given->table, reference->table.name[count]);
        samples &= count < STATE_SAMPLES || columns[count] >= 0;
    }
    count = samples ? count : STATE_SAMPLES;
    *table = (struct table){
        .value = malloc((size_t)reference->table.row_count * (size_t)count * sizeof(double))};
    for (int i = 0; i < count; i++, table->column_count++)
        if (!(table->name[i] = strdup(reference->table.name[i])))
            return -1;
    for (int f = 0; f < reference->frame_count && table->value; f++) {
        const double t = reference->frames[f].t;
        if (t > scene->begin + scene->duration + same_time)
            break;
        const int frame = frame_at(given, t);
        for (int row = given->frames[frame].row; row < trajectory_end(given, frame); row++) {
            const double *from = trajectory_row(given, row);
            double *to = table->value + table->row_count++ * count;
            for (int i = 0; i < count; i++)
                to[i] = i == STATE_T ? t : columns[i] < 0 ? NAN : from[columns[i]];
        }
    }
    return table->value ? 0 : -1;
}

static int measure(struct plan *plan, const struct foreign *foreign, struct deviation *deviation) {
    const struct field *field = foreign->field;
    const struct trajectory *given =
        trajectories_take(plan->trajectories, foreign->file, plan->reason);
    struct trajectory run;
    struct table table;
    if (!given)
        return -1;
    int code = take_frames(foreign, given, &table);
    if (code) {
        table_free(&table);
        snprintf(plan->reason, REASON_SIZE, "out of memory");
    } else {
        code = trajectory_of_table(&run, &table, foreign->file, plan->reason);
    }
    trajectories_return(plan->trajectories, given);
    if (code)
        return -1;
    code =
        measure_deviation(field->scene, &run, field->reference.states,
                          field->scene->run.atol / field->scene->run.rtol, deviation, plan->reason);
    if (run.table.column_count < field->reference.states->table.column_count)
        deviation->radius = NAN;
    trajectory_free(&run);
    return code;
}

int race_foreign_read(struct plan *plan, const struct foreign *foreign, const struct entry *entry,
                      struct point *p) {
    char shown[120];
    const double cpu = foreign->cpu;
    visible_text(foreign->file, shown, sizeof shown);
    *p = (struct point){.entry = entry,
                        .setting = foreign->setting,
                        .status = outcome_name(FINISHED),
                        .threads = 1,
                        .run = "-",
                        .runs = 1,
                        .cost = {FINISHED, foreign->evaluations, NAN, NAN, {cpu, cpu, cpu}, NAN},
                        .extent = {NAN, NAN, NAN}};
    snprintf(p->note, sizeof p->note, "the trajectory in %s, hash %s%s", shown, foreign->hash,
             isnan(cpu) && isnan(foreign->evaluations) ? "; cost not given"
             : isnan(cpu)                              ? "; CPU time not given"
             : isnan(foreign->evaluations)             ? "; evaluations not given"
                                                       : "");
    if (measure(plan, foreign, &p->deviation))
        return -1;
    p->error_least = p->error_greatest = p->deviation.rms;
    p->reference_limited = p->deviation.rms < 10 * foreign->field->bound;
    return 0;
}
