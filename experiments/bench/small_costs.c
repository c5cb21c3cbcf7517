/* What is beside the steps of a run: numbers as text, and stops. */
#include "base/digits.h"
#include "measure.h"
#include "run/settings.h"
#include "run/simulation.h"

#include <stdlib.h>

/* --- numbers as text --- */

enum { NUMBERS = 1000 };

struct numbers {
    double x[NUMBERS];
    char text[64];
};

static void write_shortest(void *ctx) {
    struct numbers *n = ctx;
    for (int i = 0; i < NUMBERS; i++)
        digits_put(n->text, n->x[i]);
}

static void write_by_printf(void *ctx) {
    struct numbers *n = ctx;
    for (int i = 0; i < NUMBERS; i++)
        snprintf(n->text, sizeof n->text, "%.17g", n->x[i]);
}

/* Enters numbers of the size of a wisp's positions and velocities, with all their digits. */
static void enter_digits(struct contest *contest) {
    struct numbers *n = zeros(sizeof *n);
    unsigned seed = 5;
    for (int i = 0; i < NUMBERS; i++) {
        seed = seed * 1664525u + 1013904223u;
        n->x[i] = (double)seed / 7e9 - 0.3;
    }
    contest_add(contest, "digits", "a number", "printf", NUMBERS, write_by_printf, n);
    contest_add(contest, "digits", "a number", "shortest", NUMBERS, write_shortest, n);
}

/* --- stops --- */

struct stopping {
    struct scene scene;
    struct settings settings;
};

static void run_stopping(void *ctx) {
    const struct stopping *s = ctx;
    struct run_result result;
    simulate(&s->scene, &s->settings, NULL, NULL, &result);
    if (result.outcome != FINISHED)
        give_up("%s: %s", s->scene.name, result.reason);
}

/* One wisp whose clamp is looked at after every step, and after every tenth. */
static void enter_stops(struct contest *contest, const struct scene *scene) {
    static const char *const names[] = {"every step", "every tenth"};
    const double rate = 3000; /* Hz, of steps */
    for (int i = 0; i < 2; i++) {
        struct stopping *s = zeros(sizeof *s);
        const struct run_request request = {.stepper = "linear-euler", .step = 1 / rate};
        char reason[REASON_SIZE];
        s->scene = *scene;
        s->scene.duration = 0.1;
        s->scene.wisp_count = 1;
        s->scene.collision_rate = i ? rate / 10 : rate;
        s->scene.interaction = (struct interaction_settings){.rate = scene->interaction.rate};
        if (settings_resolve(&s->scene, &request, &s->settings, reason))
            give_up("%s", reason);
        contest_add(contest, "stops", "linear-euler", names[i], s->scene.duration * rate,
                    run_stopping, s);
    }
}

void enter_small_costs(struct contest *contest, const struct scene *scene) {
    enter_digits(contest);
    enter_stops(contest, scene);
}
