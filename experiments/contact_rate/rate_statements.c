/* What contact-rate says of its numbers. */
#include "contact_rate.h"

#include <math.h>
#include <string.h>

/* The thesis's rate of contacts, a hundredth of its rate of everything else. */
static const double thesis_rate = 90;

/* Where contacts come a little too late the error is proportional to the interval, order 1; what
 * does not converge has order 0. Halfway is where a verdict turns. */
static const double converging = 0.5;

/* --- whether it converges --- */

/* "12 mm at 90 Hz, 3.1 at 300" of the rates below the yardstick's. */
static void list_errors(const struct series *series, char text[256]) {
    const char *mm = " mm", *hz = " Hz";
    text[0] = '\0';
    for (int i = 0; i + 1 < series->rate_count; i++) {
        const struct rate_point *point = &series->point[i];
        if (!isfinite(point->error))
            continue;
        list_add(text, 256, "%.3g%s at %g%s", 1e3 * point->error, mm, point->rate, hz);
        mm = hz = "";
    }
}

/* Errors fall as fast as that, and the finest is the least of those that tell. */
static int converges(const struct series *series) {
    const int finest = series->rate_count - 2;
    int falls = 1;
    for (int i = finest - 1; i >= 0 && i > finest - series->order.points; i--)
        falls &= series->point[finest].error < series->point[i].error;
    return falls && series->order.slope >= converging;
}

static void state_convergence(struct statements *statements, const struct study *study,
                              const struct series *series) {
    const char *scene = study->subject->name;
    char errors[256];
    list_errors(series, errors);
    struct statement row = our_row(
        scene, "rates series", series->has_order ? holds_if(converges(series)) : NOT_REACHED,
        series->order.slope, "1", "%.70s, %s, converges", scene, series->name);
    if (isnan(series->horizon))
        statements_add(statements, row, "On %s with %s the run at 9000 Hz fails.", scene,
                       series->name);
    else if (!series->has_order)
        statements_add(statements, row,
                       "On %s with %s too few rates can be told from the one they are compared "
                       "with, which is itself in doubt by %.2g mm: they are %s from it.",
                       scene, series->name, 1e3 * series->doubt, errors);
    else
        statements_add(statements, row,
                       "On %s with %s the motion %s as contacts become more frequent: up to %.3g s "
                       "it is %s from that at 9000 Hz, of order %.1f in the interval.",
                       scene, series->name,
                       row.verdict == HOLDS ? "converges" : "does not converge", series->horizon,
                       errors, series->order.slope);
}

/* --- whether a hundred times rarer does harm --- */

/* Whether this contact does anything that can be told; where a run failed nobody knows. */
static int acts(const struct series *series) {
    return !(series->effect <= series->doubt);
}

static void state_nothing(struct statements *statements, const struct study *study,
                          const struct series *series) {
    statements_add(statements,
                   thesis_row(study->subject->name, "series", NOT_REACHED, NAN, NULL, "%.70s, %s",
                              study->subject->name, series->name),
                   "On %s with %s contacts a hundred times rarer do no harm: nothing happens up to "
                   "%.3g s, and no rate could do any.",
                   study->subject->name, series->name, series->horizon);
}

static int is_told(const struct series *series, const struct rate_point *point) {
    return point && isfinite(point->error) && series->effect > HARM;
}

static void state_harm(struct statements *statements, const struct study *study,
                       const struct series *series) {
    const struct rate_point *point = point_at(series, thesis_rate);
    const char *scene = study->subject->name;
    if (!point)
        return;
    struct statement row =
        thesis_row(scene, "rates series",
                   is_told(series, point) ? holds_if(point->error <= HARM) : NOT_REACHED,
                   1e3 * point->error, "mm", "%.70s, %s, 90 Hz", scene, series->name);
    if (!isfinite(point->error))
        statements_add(statements, row,
                       "On %s with %s contacts a hundred times rarer do no harm: the run at 90 Hz "
                       "or that at 9000 Hz fails, and nobody knows.",
                       scene, series->name);
    else if (!is_told(series, point))
        statements_add(statements, row,
                       "On %s with %s contacts a hundred times rarer do no harm: up to %.3g s all "
                       "that contact does is %.2g mm.",
                       scene, series->name, series->horizon, 1e3 * series->effect);
    else
        statements_add(statements, row,
                       "On %s with %s contacts a hundred times rarer do no harm: up to %.3g s hair "
                       "at 90 Hz is %.3g mm (rms) from hair at 9000 Hz, %.2g of what contact does.",
                       scene, series->name, series->horizon, 1e3 * point->error,
                       point->error / series->effect);
}

/* Runs of two rates are of one distribution for all that these numbers tell if they are no farther
 * from each other than those of one rate are. */
static void state_after(struct statements *statements, const struct study *study,
                        const struct series *series) {
    const struct rate_point *point = point_at(series, thesis_rate),
                            *yardstick = point_at(series, YARDSTICK_RATE);
    const char *scene = study->subject->name;
    if (!point || point->after.pairs == 0 || yardstick->after.pairs == 0)
        return;
    statements_add(
        statements,
        thesis_row(scene, "rates", holds_if(point->after.median <= yardstick->after.upper),
                   1e3 * point->after.median, "mm", "%.70s, %s, 90 Hz after the horizon", scene,
                   series->name),
        "On %s with %s, after %.3g s, hair at 90 Hz is no farther from hair at 9000 Hz than that "
        "is from itself after starts 1e-6 m apart: median %.3g mm (quartiles %.3g, %.3g) against "
        "%.3g (%.3g, %.3g).",
        scene, series->name, series->horizon, 1e3 * point->after.median, 1e3 * point->after.lower,
        1e3 * point->after.upper, 1e3 * yardstick->after.median, 1e3 * yardstick->after.lower,
        1e3 * yardstick->after.upper);
}

/* --- bodies --- */

/* Whether hair was in a body at all. */
static int bodies_act(const struct study *study) {
    const struct rate_point *yardstick = point_at(own_series(study, BODY_TICKS), YARDSTICK_RATE);
    return yardstick && yardstick->contacts > 0;
}

/* At the scene's own rate. */
static void state_bodies(struct statements *statements, const struct study *study) {
    const struct series *series = own_series(study, BODY_TICKS);
    const struct rate_point *point = point_at(series, study->subject->scene->collision_rate);
    const char *scene = study->subject->name;
    if (!point)
        return;
    const int acting = bodies_act(study), told = acting && isfinite(point->error);
    struct statement row =
        our_row(scene, "rates series", told ? holds_if(point->error <= HARM) : NOT_REACHED,
                1e3 * point->error, "mm", "%.70s, bodies", scene);
    if (!acting)
        statements_add(statements, row,
                       "On %s no body touches hair within %.3g s, and nothing is told of how often "
                       "they should be looked at.",
                       scene, study->duration);
    else if (!told)
        statements_add(statements, row,
                       "On %s the run with bodies at %g Hz or that at 9000 Hz fails.", scene,
                       point->rate);
    else
        statements_add(statements, row,
                       "On %s bodies at %g Hz do no harm: up to %.3g s hair is %.3g mm (rms) from "
                       "where bodies at 9000 Hz leave it.",
                       scene, point->rate, series->horizon, 1e3 * point->error);
    if (acting)
        state_convergence(statements, study, series);
}

/* --- controls and costs --- */

static const double rounding = 1e-12; /* m: of stops at other times, where wisps may split */

static void state_control(struct statements *statements, const struct study *study) {
    const struct rate_point *point = point_at(series_of(study, 0, 1), thesis_rate);
    const char *scene = study->subject->name;
    const int told = isfinite(point->error);
    struct statement row =
        our_row(scene, "rates", told ? holds_if(point->error <= rounding) : NOT_REACHED,
                1e3 * point->error, "mm", "%.70s, control", scene);
    if (told)
        statements_add(statements, row,
                       "On %s with its contact off, runs at 90 and 9000 Hz are %.2g mm apart.",
                       scene, 1e3 * point->error);
    else
        statements_add(statements, row, "On %s with its contact off a run fails.", scene);
    if (study->own_contact == 0)
        statements_add(
            statements, our_row(scene, "rates", NOT_REACHED, NAN, NULL, "%.70s, contact", scene),
            "On %s wisps do nothing to each other, and nothing is told of how often they should.",
            scene);
}

static void state_cost(struct statements *statements, const struct study *study) {
    const struct series *series = own_series(study, WISP_TICKS);
    const struct rate_point *rare = point_at(series, thesis_rate),
                            *often = point_at(series, YARDSTICK_RATE);
    if (!rare)
        return;
    const int told = rare->outcome == FINISHED && often->outcome == FINISHED && rare->contacts > 0;
    const double sections = often->sections / rare->sections;
    struct statement row =
        thesis_row("cost", "rates", told ? holds_if(sections >= 50) : NOT_REACHED, sections, "1",
                   "%.70s, cost", study->subject->name);
    if (told)
        statements_add(statements, row,
                       "On %s rare contacts are cheap: at 9000 Hz points are looked for in %.3g "
                       "times as many sections as at 90 Hz and found %.3g times as often, and the "
                       "advance stops %.3g times as often.",
                       study->subject->name, sections, often->contacts / rare->contacts,
                       often->stops / rare->stops);
    else
        statements_add(statements, row,
                       "On %s rare contacts are cheap: nothing is told of it, for there are no "
                       "contacts, or a run fails.",
                       study->subject->name);
}

/* --- where effort belongs --- */

/* Errors of one span, with what each is in doubt by. */
struct judged {
    double error[SOURCES], doubt[SOURCES];
};

static struct judged judge(const struct source_error *all, int whole) {
    struct judged judged;
    for (int i = 0; i < SOURCES; i++) {
        judged.error[i] = whole ? all[i].whole : all[i].error;
        judged.doubt[i] = whole ? all[i].whole_doubt : all[i].doubt;
    }
    return judged;
}

static int beyond(const struct judged *e, int a, int b) {
    return e->error[a] - e->doubt[a] > e->error[b] + e->doubt[b];
}

/* That with the larger error, of which either may not be there. */
static int larger(const struct judged *e, int a, int b) {
    return isnan(e->error[a]) || e->error[b] > e->error[a] ? b : a;
}

/* "wisp ticks 4 mm, treatment 2, integrator 1" of those that are there, with their doubts where
 * these matter. */
static void list_sources(const struct judged *e, char text[256]) {
    static const enum source order[] = {OF_WISP_TICKS, OF_BODY_TICKS, TREATMENT, INTEGRATOR};
    const char *mm = " mm";
    text[0] = '\0';
    for (int k = 0; k < SOURCES; k++) {
        const int i = (int)order[k];
        if (!(e->error[i] > 1e-9)) /* none, or bodies where there are none */
            continue;
        char doubt[48] = "";
        if (e->doubt[i] > 0.1 * e->error[i])
            snprintf(doubt, sizeof doubt, " (in doubt by %.2g)", 1e3 * e->doubt[i]);
        list_add(text, 256, "%s %.3g%s%s", source_names[i], 1e3 * e->error[i], mm, doubt);
        mm = "";
    }
}

/* The ticks' error is the largest, or another is, beyond what both are in doubt by. */
static void state_sources(struct statements *statements, const struct study *study, int whole) {
    const struct judged e = judge(study->error, whole);
    const int ticks = larger(&e, OF_WISP_TICKS, OF_BODY_TICKS),
              other = larger(&e, INTEGRATOR, TREATMENT);
    const char *scene = study->subject->name;
    const struct series *own = own_series(study, WISP_TICKS);
    const int touches = (own && acts(own)) || bodies_act(study);
    const int there = isfinite(e.error[INTEGRATOR]) && isfinite(e.error[TREATMENT]);
    const int told = study->has_sources && touches && there &&
                     (beyond(&e, ticks, other) || beyond(&e, other, ticks));
    char list[256];
    list_sources(&e, list);
    struct statement row =
        our_row("sources", "sources", told ? holds_if(beyond(&e, ticks, other)) : NOT_REACHED,
                1e3 * e.error[ticks], "mm", "%.70s, sources%s", scene, whole ? ", to the end" : "");
    if (!study->has_sources)
        statements_add(statements, row, "On %s there is no envelope, and no treatment to compare.",
                       scene);
    else if (!there)
        statements_add(
            statements, row,
            "On %s no error can be told from another: a run fails, or wisps split at other times.",
            scene);
    else if (!touches)
        statements_add(statements, row,
                       "On %s nothing touches, and nothing is told of where the largest error is.",
                       scene);
    else
        statements_add(statements, row, "On %s %s the largest error %s %.3g s: %s.", scene,
                       !told                     ? "several sources could be"
                       : row.verdict == HOLDS    ? "rare ticks are"
                       : other == (int)TREATMENT ? "the treatment is"
                                                 : "the integrator is",
                       whole ? "over all" : "up to", whole ? study->duration : study->span, list);
}

/* --- of all scenes --- */

/* The thesis's claim by kind of contact. */
static void state_kind(struct statements *statements, const struct contact_rate *all, int contact,
                       int reciprocal) {
    static const char *const phrases[BOTH + 1] = {"", "friction", "collision",
                                                  "friction and collision"};
    const char *response = reciprocal ? "reciprocal" : "one-sided";
    const char *kind = phrases[contact],
               *pushes = reciprocal ? "that push both wisps" : "that push one wisp alone";
    int told = 0, harmless = 0;
    double worst = 0;
    for (int i = 0; i < all->count; i++) {
        const struct series *series = series_of(&all->study[i], contact, reciprocal);
        const struct rate_point *point = point_at(series, thesis_rate);
        if (!point || !is_told(series, point))
            continue;
        told++;
        harmless += point->error <= HARM;
        worst = fmax(worst, point->error);
    }
    struct statement row =
        thesis_row(NULL, "rates series", told ? holds_if(harmless == told) : NOT_REACHED,
                   1e3 * worst, "mm", "%s, %s", contact_names[contact], response);
    if (told == 0)
        statements_add(statements, row,
                       "Contacts a hundred times rarer do no harm with %s %s: on no scene does "
                       "contact do more than 1 mm, and nothing is told of its rate.",
                       kind, pushes);
    else
        statements_add(
            statements, row,
            "Contacts a hundred times rarer do no harm with %s %s: where contact does more than 1 "
            "mm, hair stays within 1 mm (rms) on %d of %d scenes, and at most it is %.3g mm off.",
            kind, pushes, harmless, told, 1e3 * worst);
}

/* Where nothing collides friction alone is all of the contact, whose rows speak for both. */
static int is_said(const struct study *study, const struct series *series) {
    const struct series *collision = series_of(study, COLLISION, series->reciprocal);
    return series->ticks == WISP_TICKS && series->contact > 0 &&
           (series->contact != FRICTION || !collision || acts(collision));
}

static void state_study(struct statements *statements, const struct study *study) {
    state_sources(statements, study, 0);
    if (study->has_sources && study->span < study->duration - 1e-9)
        state_sources(statements, study, 1);
    for (int i = 0; i < study->series_count; i++) {
        const struct series *series = &study->series[i];
        if (!is_said(study, series))
            continue;
        if (!acts(series)) {
            state_nothing(statements, study, series);
            continue;
        }
        state_harm(statements, study, series);
        state_after(statements, study, series);
        state_convergence(statements, study, series);
    }
    state_control(statements, study);
    state_bodies(statements, study);
    state_cost(statements, study);
}

void state_all(struct statements *statements, const struct contact_rate *all) {
    for (int contact = FRICTION; contact <= BOTH; contact++)
        for (int reciprocal = 1; reciprocal >= 0; reciprocal--)
            state_kind(statements, all, contact, reciprocal);
    for (int i = 0; i < all->count; i++)
        state_study(statements, &all->study[i]);
}
