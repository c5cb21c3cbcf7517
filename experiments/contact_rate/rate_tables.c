/* The tables of contact-rate. */
#include "contact_rate.h"

#include <math.h>

static const char *tick_name(enum tick_kind ticks) {
    return ticks == WISP_TICKS ? "wisps" : "bodies";
}

static const char *response_name(const struct series *series) {
    return series->contact == 0 ? "none" : series->reciprocal ? "reciprocal" : "one-sided";
}

static int is_own(const struct study *study, const struct series *series) {
    return series == own_series(study, WISP_TICKS) || series == own_series(study, BODY_TICKS);
}

/* A distance after the horizon, which there is where pairs were compared. */
static double after(const struct rate_point *p, double distance) {
    return p->after.pairs > 0 ? distance : (double)NAN;
}

/* What the rows of a series begin with. */
#define NAME_COLUMNS(X)                                                                          \
    SCENE_COLUMN(X, study->subject->name)                                                        \
    X("series", "-", "name of the series", "%s", series->name)                                   \
    X("ticks", "-", "wisps or bodies: whose ticks", "%s", tick_name(series->ticks))              \
    X("contact", "-", "what wisps do to each other", "%s", contact_names[series->contact])       \
    X("response", "-", "reciprocal, one-sided or none: which side of a contact gives way", "%s", \
      response_name(series))

#define POINT_COLUMNS(X)                                                                    \
    NAME_COLUMNS(X)                                                                         \
    X("rate", "Hz", "rate of the ticks", "%g", p->rate)                                     \
    X("outcome", "-", "how the run ended", "%s", outcome_name(p->outcome))                  \
    X("failure_time", "s", "simulated time at which it failed", "%.17g", p->failure_time)   \
    X("error", "m",                                                                         \
      "distance from the run at 9000 Hz up to the horizon, rms over free nodes and frames", \
      "%.17g", p->error)                                                                    \
    X("largest", "m", "the largest distance of a node there", "%.17g", p->largest)          \
    X("whole", "m", "distance over all frames, rms", "%.17g", p->whole)                     \
    X("history_diverged", "s", "when its wisps are no longer the same", "%.17g",            \
      p->history_diverged)                                                                  \
    X("contacts", "1", "points found in other wisps, or in bodies", "%.17g", p->contacts)   \
    X("sections", "1", "sections in which points were looked for", "%.17g", p->sections)    \
    X("stops", "1", "stops of the smooth advance, at ticks and frames", "%.17g", p->stops)  \
    X("evaluations", "1", "evaluations of forces", "%.17g", p->evaluations)                 \
    X("cpu", "s", "CPU time", "%.17g", p->cpu)                                              \
    X("pairs", "1", "number of pairs of runs from displaced starts", "%d", p->after.pairs)  \
    X("after_lower", "m", "their distance after the horizon: lower quartile", "%.17g",      \
      after(p, p->after.lower))                                                             \
    X("after_median", "m", "their distance after the horizon: median", "%.17g",             \
      after(p, p->after.median))                                                            \
    X("after_upper", "m", "their distance after the horizon: upper quartile", "%.17g",      \
      after(p, p->after.upper))

#define SERIES_COLUMNS(X)                                                                         \
    NAME_COLUMNS(X)                                                                               \
    X("own", "1", "1 where it is the scene's own contact", "%d", is_own(study, series))           \
    X("horizon", "s", "to which errors are compared", "%.17g", series->horizon)                   \
    X("compared", "s", "time that was run", "%.17g", study->duration)                             \
    X("duration", "s", "duration of the scene", "%.17g", study->subject->scene->duration)         \
    X("doubt", "m", "doubt of the run at 9000 Hz up to the horizon, rms", "%.17g", series->doubt) \
    X("effect", "m", "distance from the run without contact between wisps, rms", "%.17g",         \
      series->ticks == WISP_TICKS ? series->effect : (double)NAN)                                 \
    X("order", "1", "slope of log error over log of the interval between ticks", "%.17g",         \
      series->order.slope)                                                                        \
    X("order_spread", "1", "how far slopes from point to point differ", "%.17g",                  \
      series->order.spread)                                                                       \
    X("order_points", "1", "number of points of the order's fit", "%d", series->order.points)     \
    X("step", "s", "step of rk4", "%.17g", study->step)

#define SOURCE_COLUMNS(X)                                                                     \
    SCENE_COLUMN(X, study->subject->name)                                                     \
    X("source", "-", "who errs", "%s", source_names[i])                                       \
    X("error", "m", "distance up to span, rms over free nodes and frames", "%.17g", e->error) \
    X("doubt", "m", "how far what it is from is in doubt, up to span", "%.17g", e->doubt)     \
    X("whole", "m", "distance over all frames, rms", "%.17g", e->whole)                       \
    X("whole_doubt", "m", "the doubt over all frames", "%.17g", e->whole_doubt)               \
    X("span", "s", "the least horizon of all that is compared with", "%.17g", study->span)    \
    X("compared", "s", "time that was run", "%.17g", study->duration)                         \
    X("against", "-", "the run that the distance is measured from", "%s", e->against)

enum { RATES, SERIES, SOURCES_TABLE, TABLES };
static const struct table_form tables[TABLES] = {
    {"rates",
     "one run of rk4 with generalised at each rate of wisps' or bodies' ticks, Hz; error: its "
     "distance from that at 9000 Hz up to the horizon (series.tsv), rms over free nodes and "
     "frames, m; largest: of a node there, m; whole: rms over all frames, m, after the horizon a "
     "draw from a distribution; history_diverged: when its wisps are no longer the same "
     "(subdivision), s; contacts: points found in other wisps (wisps), or in bodies; sections: in "
     "which points were looked for; stops: of the smooth advance, at ticks and frames; "
     "evaluations: of forces; cpu: time, s, which depends on the machine and is no part of any "
     "statement; pairs, after_*: quartiles of the distance, after the horizon, of runs from starts "
     "displaced by 1e-6 m (rms; draws 2 to 9, --quick 2 to 5) from as many at 9000 Hz, there from "
     "each other, m; nan: it failed, or there is no such thing or run",
     COLUMNS(POINT_COLUMNS)},
    {"series",
     "runs that differ in one rate alone; own: whether it is the scene's own contact; horizon: to "
     "which errors are compared, s: the last frame at which the run at 9000 Hz and the same from a "
     "start 1e-10 m away (draw 1) in half the step are within 1 mm; doubt: their rms distance up "
     "to there, m; compared: what was run of the scene's duration, s; effect: distance of the run "
     "at 9000 Hz from the one without contact between wisps up to the horizon, rms, m; order: "
     "slope of log error over log of the interval between ticks less the yardstick's, by least "
     "squares of the finest three errors above twice the doubt; order_spread: how far slopes from "
     "point to point differ; step: of rk4, s; nan: there is none",
     COLUMNS(SERIES_COLUMNS)},
    {"sources",
     "who errs on the scene as it is: distances, rms over free nodes and frames, m, up to `span`, "
     "s, the least horizon of all that is compared with (error, doubt), and over all frames "
     "(whole, whole_doubt); doubts: how far the motion that is compared with is from itself in "
     "half or twice the step, from a start 1e-10 m away, or for the treatment twice what penalty "
     "ratio 100 changes in the limit; nan: a run failed, or the scene has no such ticks",
     COLUMNS(SOURCE_COLUMNS)},
};

static void write_study(FILE *const *streams, const struct study *study) {
    for (int k = 0; k < study->series_count; k++) {
        const struct series *series = &study->series[k];
        WRITE_ROW(streams[SERIES], SERIES_COLUMNS);
        for (int i = 0; i < series->rate_count; i++) {
            const struct rate_point *p = &series->point[i];
            WRITE_ROW(streams[RATES], POINT_COLUMNS);
        }
    }
    for (int i = 0; i < SOURCES && study->has_sources; i++) {
        const struct source_error *e = &study->error[i];
        WRITE_ROW(streams[SOURCES_TABLE], SOURCE_COLUMNS);
    }
}

int contact_rate_tabulate(struct plan *plan) {
    struct contact_rate *all = plan->memo;
    FILE *streams[TABLES];
    for (int i = 0; i < all->count; i++)
        if (read_study(plan, &all->study[i]))
            return -1;
    if (pushing_read(plan, &all->pushing) ||
        plan_open_statements(plan, NULL,
                             plan->quick ? "--quick: two scenes, fewer rates and starts" : NULL) ||
        output_tables(&plan->output, streams, tables, TABLES, "", NULL) ||
        pushing_tabulate(plan, &all->pushing))
        return -1;
    for (int i = 0; i < all->count; i++)
        write_study(streams, &all->study[i]);
    state_all(&plan->output.statements, all);
    pushing_state(&plan->output.statements, &all->pushing);
    return 0;
}
