/* The tables of contact-rate. */
#include "base/files.h"
#include "contact_rate.h"

#include <math.h>

enum { RATES, SERIES, SOURCES_TABLE, TABLES };
static const struct {
    const char *name, *what, *columns;
} tables[TABLES] = {
    {"rates",
     "one run of rk4 with generalised at each rate of wisps' or bodies' ticks, Hz; error: its "
     "distance from that at 9000 Hz up to the horizon (series.tsv), rms over free nodes and "
     "frames, m; largest: of a node there, m; whole: rms over all frames, m, after the horizon a "
     "draw from a distribution; parted: when its wisps are no longer the same (subdivision), s; "
     "contacts: points found in other wisps (wisps), or in bodies; sections: in which points were "
     "looked for; stops: of the smooth advance, at ticks and frames; evaluations: of forces; cpu: "
     "time, s, which depends on the machine and is no part of any statement; pairs, after_*: "
     "quartiles of the distance, after the horizon, of runs from starts displaced by 1e-6 m (rms; "
     "draws 2 to 9, --quick 2 to 5) from as many at 9000 Hz, there from each other, m; nan: it "
     "failed, or there is no such thing or run",
     "scene\tseries\tticks\tcontact\tresponse\trate\toutcome\tfailure_time\terror\tlargest\twhole"
     "\tparted\tcontacts\tsections\tstops\tevaluations\tcpu\tpairs\tafter_lower\tafter_median"
     "\tafter_upper"},
    {"series",
     "runs that differ in one rate alone; own: whether it is the scene's own contact; horizon: to "
     "which errors are compared, s: the last frame at which the run at 9000 Hz and the same from a "
     "start 1e-10 m away (draw 1) in half the step are within 1 mm; doubt: their rms distance up "
     "to there, m; compared: what was run of the scene's duration, s; effect: distance of the run "
     "at 9000 Hz from the one without contact between wisps up to the horizon, rms, m; order: "
     "slope of log error over log of the interval between ticks less the yardstick's, by least "
     "squares of the finest three errors above twice the doubt; order_spread: how far slopes from "
     "point to point differ; step: of rk4, s; nan: there is none",
     "scene\tseries\tticks\tcontact\tresponse\town\thorizon\tcompared\tduration\tdoubt\teffect"
     "\torder\torder_spread\torder_points\tstep"},
    {"sources",
     "who errs on the scene as it is: distances, rms over free nodes and frames, m, up to `span`, "
     "s, the least horizon of all that is compared with (error, doubt), and over all frames "
     "(whole, whole_doubt); doubts: how far the motion that is compared with is from itself in "
     "half or twice the step, from a start 1e-10 m away, or for the treatment twice what penalty "
     "ratio 100 changes in the limit; nan: a run failed, or the scene has no such ticks",
     "scene\tsource\terror\tdoubt\twhole\twhole_doubt\tspan\tcompared\tagainst"},
};

static const char *tick_name(enum tick_kind ticks) {
    return ticks == WISP_TICKS ? "wisps" : "bodies";
}

static void write_numbers(FILE *stream, const double *numbers, size_t count) {
    for (size_t i = 0; i < count; i++)
        fprintf(stream, "\t%.17g", numbers[i]);
}

/* What the rows of a series begin with. */
static void write_name(FILE *stream, const struct study *study, const struct series *series) {
    fprintf(stream, "%s\t%s\t%s\t%s\t%s", study->subject->name, series->name,
            tick_name(series->ticks), contact_names[series->contact],
            series->contact == 0 ? "none"
            : series->reciprocal ? "reciprocal"
                                 : "one-sided");
}

static void write_point(FILE *stream, const struct study *study, const struct series *series,
                        const struct rate_point *p) {
    const double numbers[] = {p->failure_time, p->error,    p->largest, p->whole,       p->parted,
                              p->contacts,     p->sections, p->stops,   p->evaluations, p->cpu};
    const double after[] = {p->after.lower, p->after.median, p->after.upper};
    write_name(stream, study, series);
    fprintf(stream, "\t%g\t%s", p->rate, outcome_name(p->outcome));
    write_numbers(stream, numbers, sizeof numbers / sizeof *numbers);
    fprintf(stream, "\t%d", p->after.pairs);
    for (size_t i = 0; i < sizeof after / sizeof *after; i++)
        fprintf(stream, "\t%.17g", p->after.pairs > 0 ? after[i] : NAN);
    fputc('\n', stream);
}

static void write_series(FILE *stream, const struct study *study, const struct series *series) {
    const double numbers[] = {series->horizon,
                              study->duration,
                              study->subject->scene->duration,
                              series->doubt,
                              series->ticks == WISP_TICKS ? series->effect : NAN,
                              series->order.slope,
                              series->order.spread};
    write_name(stream, study, series);
    fprintf(stream, "\t%d",
            series == own_series(study, WISP_TICKS) || series == own_series(study, BODY_TICKS));
    write_numbers(stream, numbers, sizeof numbers / sizeof *numbers);
    fprintf(stream, "\t%d\t%.17g\n", series->order.points, study->step);
}

static void write_sources(FILE *stream, const struct study *study) {
    for (int i = 0; i < SOURCES && study->has_sources; i++) {
        const struct source_error *e = &study->error[i];
        const double numbers[] = {e->error,       e->doubt,    e->whole,
                                  e->whole_doubt, study->span, study->duration};
        fprintf(stream, "%s\t%s", study->subject->name, source_names[i]);
        write_numbers(stream, numbers, sizeof numbers / sizeof *numbers);
        fprintf(stream, "\t%s\n", e->against);
    }
}

static void write_study(const struct atomic_file *files, const struct study *study) {
    for (int k = 0; k < study->series_count; k++) {
        const struct series *series = &study->series[k];
        write_series(files[SERIES].stream, study, series);
        for (int i = 0; i < series->rate_count; i++)
            write_point(files[RATES].stream, study, series, &series->point[i]);
    }
    write_sources(files[SOURCES_TABLE].stream, study);
}

/* Opens all tables and writes them. Returns 0, or -1 with plan->reason. */
static int write_tables(struct plan *plan, const char *folder) {
    const struct contact_rate *all = plan->memo;
    struct atomic_file files[TABLES];
    int opened = 0, code = 0;
    while (!code && opened < TABLES) {
        code = open_table(&files[opened], folder, tables[opened].name, tables[opened].what, NULL,
                          tables[opened].columns, plan->reason);
        opened += !code;
    }
    for (int i = 0; i < all->count && !code; i++)
        write_study(files, &all->study[i]);
    for (int i = 0; i < opened; i++) {
        if (code)
            atomic_discard(&files[i]);
        else
            code = atomic_commit(&files[i], plan->reason);
    }
    return code;
}

int contact_rate_tabulate(struct plan *plan, const char *folder) {
    struct contact_rate *all = plan->memo;
    struct statements statements;
    for (int i = 0; i < all->count; i++)
        if (read_study(plan, &all->study[i]))
            return -1;
    if (statements_open(&statements, folder, NULL,
                        plan->quick ? "--quick: two scenes, fewer rates and starts" : NULL,
                        plan->reason))
        return -1;
    const int code = write_tables(plan, folder);
    if (!code)
        state_all(&statements, all);
    return statements_close(&statements, code, plan->reason);
}
