#include "scene_settings.h"

#include "model/problems.h"
#include "model/scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- what rows are made of --- */

#define ANY \
    { -INFINITY, INFINITY, 1, 1, 0 }
#define POSITIVE \
    { 0, INFINITY, 1, 1, 0 }
#define NOT_NEGATIVE \
    { 0, INFINITY, 0, 1, 0 }
#define FROM_TO(a, b) \
    { a, b, 0, 0, 0 }
#define BETWEEN(a, b) \
    { a, b, 1, 1, 0 }
#define ABOVE_TO(a, b) \
    { a, b, 1, 0, 0 }
#define WHOLE(a, b) \
    { a, b, 0, 0, 1 }
#define WHOLE_FROM(a) \
    { a, INFINITY, 0, 1, 1 }

#define NUMBER(of, within, absent) SETTING_NUMBER, .unit = of, .range = within, .initial = absent
#define SWITCH(absent)             SETTING_SWITCH, .initial = absent
#define CHOICE(among, absent)      SETTING_CHOICE, .choices = among, .initial = absent
#define TEXT(absent)               SETTING_TEXT, .initial = absent
#define VECTORS(of)                SETTING_VECTORS, .unit = of, .range = ANY, .initial = NULL
#define GROUP(absent)              SETTING_GROUP, .initial = absent
#define LIST(absent)               SETTING_LIST, .initial = absent
#define VECTOR(of, within, absent) \
    SETTING_NUMBERS, .least = 3, .most = 3, .unit = of, .range = within, .initial = absent
#define NUMBERS(few, many, of, within, absent) \
    SETTING_NUMBERS, .least = few, .most = many, .unit = of, .range = within, .initial = absent

/* The reader writes it into that member of the group's struct: of a double or an int by its size.
 */
#define INTO(type, member) \
    .at = offsetof(struct type, member), .size = sizeof((struct type *)0)->member
#define BY_HAND .size = 0 /* what reads the group asks for it */

/* In the order of the enumerations whose values they are. */
static const char *const problem_words[] = {"wisps", "circle", "rosenblum", "anjyo", NULL};
static const char *const stretch_words[] = {
    [STRETCH_SPRING] = "spring", [STRETCH_RIGID] = "rigid", NULL};
static const char *const bending_words[] = {
    [BENDING_NONE] = "none", [BENDING_SKIP] = "skip", [BENDING_HINGE] = "hinge", NULL};
static const char *const response_words[] = {
    [RESPONSE_TICK] = "tick", [RESPONSE_PENALTY] = "penalty", NULL};
static const char *const wind_words[] = {"steady", "gust", "irregular",
                                         NULL}; /* from WIND_STEADY */

/* --- the table --- */

/* clang-format off */
const struct scene_setting scene_settings[] = {

{"", "base",       TEXT(""), OF_ALL, NULL, BY_HAND,
 "scene that this one builds on, by its path from this file's folder or the name of a shipped one"},
{"", "name",       TEXT(""), OF_ALL, NULL, BY_HAND,
 "what results call the scene; by default its file's name, also where it has a base"},
{"", "problem",    CHOICE(problem_words, "wisps"), OF_ALL, NULL, BY_HAND,
 "what is modelled: wisps as in the thesis, a particle on a circle, hair as in 1991 or 1992"},
{"", "begin",      NUMBER("s", NOT_NEGATIVE, "0"), OF_HAIR, NULL, INTO(scene, begin),
 "time of the first frame"},
{"", "duration",   NUMBER("s", POSITIVE, NULL), OF_ALL, NULL, INTO(scene, duration),
 "time from the first frame to the last"},
{"", "frame_rate", NUMBER("Hz", POSITIVE, ""), OF_ALL, NULL, INTO(scene, frame_rate),
 "frames per second; by default every step is a frame"},
{"", "seed",       NUMBER(NULL, WHOLE_FROM(0), "1"), OF_ALL, NULL, INTO(scene, seed),
 "number that decides what is random"},
{"", "start",      TEXT(""), OF_WISPS, NULL, BY_HAND,
 "file of states, from this file's folder, with whose last frame the scene starts; by default wisps "
 "start straight and at rest"},
{"", "gravity",    VECTOR("m/s^2", ANY, NULL), OF_HAIR, NULL, INTO(scene, around.gravity),
 "acceleration of everything"},

{"", "run", GROUP(""), OF_ALL, NULL, BY_HAND,
 "how a run is made where the command line does not say"},
{"run", "step",         NUMBER("s", POSITIVE, "1e-4"), OF_ALL, NULL, INTO(run_defaults, step),
 "step of methods that keep theirs"},
{"run", "rtol",         NUMBER(NULL, POSITIVE, "1e-6"), OF_ALL, NULL, INTO(run_defaults, rtol),
 "relative tolerance of methods that choose their steps"},
{"run", "atol",         NUMBER("m, m/s", POSITIVE, "1e-9"), OF_ALL, NULL, INTO(run_defaults, atol),
 "absolute tolerance of such methods"},
{"run", "strain_limit", NUMBER(NULL, POSITIVE, ""), OF_WISPS | OF_ROSENBLUM, NULL,
 INTO(run_defaults, strain_limit),
 "strain of a segment beyond which a run has diverged; by default 0.05, or twice what the softest wisp "
 "hangs longer by its own weight"},
{"run", "project",      SWITCH(""), OF_WISPS | OF_ROSENBLUM, NULL, INTO(run_defaults, project),
 "whether rigid segments are put back to their length after each step; by default with one-step "
 "methods"},

{"", "material", GROUP(NULL), OF_HAIR, NULL, BY_HAND, "what all wisps are made of"},
{"material", "hair_count",        NUMBER(NULL, POSITIVE, "1000"), OF_HAIR, NULL,
 INTO(wisp, hair_count), "hairs in a wisp"},
{"material", "hair_density",      NUMBER("kg/m", POSITIVE, "5.7e-6"), OF_HAIR, NULL,
 INTO(wisp, hair_density), "mass of one hair per length"},
{"material", "drag_rate",         NUMBER("1/s", NOT_NEGATIVE, "4"), OF_HAIR, NULL,
 INTO(wisp, drag_rate), "rate at which a wisp takes on the air's velocity"},
{"material", "stretch",           CHOICE(stretch_words, "spring"), OF_WISPS, NULL,
 INTO(wisp, stretch), "what keeps neighbouring nodes apart: springs, or a constraint"},
{"material", "stretch_stiffness", NUMBER("N", NOT_NEGATIVE, "90"), OF_WISPS | OF_ROSENBLUM,
 "stretch=spring", INTO(wisp, stretch_stiffness), "EA, the force at a strain of 1"},
{"material", "stretch_time",      NUMBER("s", NOT_NEGATIVE, "1.2e-4"), OF_WISPS,
 "stretch=spring", INTO(wisp, stretch_time), "damping of stretching over its stiffness"},
{"material", "bending",           CHOICE(bending_words, "skip"), OF_WISPS, NULL,
 INTO(wisp, bending), "what resists bending: springs over every second node, or hinges"},
{"material", "bending_stiffness", NUMBER("N m^2", NOT_NEGATIVE, "1e-5"), OF_WISPS | OF_ROSENBLUM,
 NULL, INTO(wisp, bending_stiffness), "EI, the moment at a curvature of 1/m"},
{"material", "bending_angle",     NUMBER("rad", POSITIVE, "0.3"), OF_WISPS, NULL,
 INTO(wisp, bending_angle), "angle at which a skip spring has the energy of the hinge"},
{"material", "bending_time",      NUMBER("s", NOT_NEGATIVE, "1e-3"), OF_WISPS, NULL,
 INTO(wisp, bending_time), "damping of bending over its stiffness"},

{"", "envelope", GROUP(""), OF_WISPS, NULL, BY_HAND,
 "samples around each free node; by default there are none"},
{"envelope", "samples",       NUMBER(NULL, WHOLE(3, SAMPLES_MAX), "4"), OF_WISPS, NULL,
 INTO(wisp, samples), "samples around a node; an even number where wisps may split"},
{"envelope", "radius",        NUMBER("m", POSITIVE, "0.02"), OF_WISPS, NULL,
 INTO(wisp, radius), "distance of a sample from its node at rest"},
{"envelope", "mass_fraction", NUMBER(NULL, BETWEEN(0, 1), "0.15"), OF_WISPS, NULL,
 INTO(wisp, mass_fraction), "part of a node's mass that is in its samples"},
{"envelope", "frequency",     NUMBER("Hz", NOT_NEGATIVE, "10"), OF_WISPS, NULL,
 INTO(wisp, frequency), "frequency of a sample on its spring"},
{"envelope", "damping_ratio", NUMBER(NULL, NOT_NEGATIVE, "1"), OF_WISPS, NULL,
 INTO(wisp, damping_ratio), "damping of that, 1 being critical"},
{"envelope", "penalty_ratio", NUMBER(NULL, NOT_NEGATIVE, "100"), OF_WISPS, NULL,
 INTO(wisp, penalty_ratio), "stiffness across the line over that along it, in treatment penalty"},

{"", "wisps", LIST(NULL), OF_HAIR, NULL, BY_HAND,
 "where wisps grow; each entry is one wisp, a grid of them, or those of a scalp"},
{"wisps", "length",    NUMBER("m", POSITIVE, NULL), OF_HAIR, NULL, INTO(wisp, length),
 "length of a wisp from its root to its tip"},
{"wisps", "nodes",     NUMBER(NULL, WHOLE(3, 10000), NULL), OF_HAIR, NULL, INTO(wisp, nodes),
 "nodes of a wisp, of which the first two belong to the head"},
{"wisps", "scalp",     TEXT(""), OF_HAIR, NULL, BY_HAND,
 "name of the body on which the entry's wisps grow evenly, by its normals"},
{"wisps", "count",     NUMBER(NULL, WHOLE(1, 100000), NULL), OF_HAIR, "scalp", BY_HAND,
 "wisps on the scalp"},
{"wisps", "crown",     VECTOR(NULL, ANY, "[0.0, 1.0, -1.0]"), OF_HAIR, "scalp", BY_HAND,
 "direction of the half of the body that is the scalp"},
{"wisps", "root",      VECTOR("m", ANY, NULL), OF_HAIR, "!scalp", INTO(wisp, root),
 "place of the first node"},
{"wisps", "direction", VECTOR(NULL, ANY, NULL), OF_HAIR, "!scalp", INTO(wisp, direction),
 "direction of the wisp at rest, of any length"},
{"wisps", "grid",      NUMBERS(2, 2, NULL, WHOLE(1, 1000), ""), OF_HAIR, "!scalp", BY_HAND,
 "columns and rows of wisps, of which the entry's is the first"},
{"wisps", "spacing",   NUMBER("m", POSITIVE, NULL), OF_HAIR, "grid", BY_HAND,
 "distance of neighbours in the grid"},
{"wisps", "across",    VECTORS(NULL), OF_HAIR, "grid", BY_HAND,
 "the two directions of the grid, of any length"},

{"", "wind", GROUP(""), OF_WISPS | OF_ANJYO, NULL, BY_HAND,
 "velocity of the air, the same everywhere; by default it is still"},
{"wind", "kind",        CHOICE(wind_words, NULL), OF_WISPS | OF_ANJYO, NULL, BY_HAND,
 "how it depends on time"},
{"wind", "velocity",    VECTOR("m/s", ANY, NULL), OF_WISPS | OF_ANJYO, NULL, INTO(wind, velocity),
 "velocity of steady wind, of a gust at first, and at an amplitude of 1"},
{"wind", "hold",        NUMBER("s", NOT_NEGATIVE, NULL), OF_WISPS | OF_ANJYO, "kind=gust",
 INTO(wind, hold), "time until which a gust is constant"},
{"wind", "decay",       NUMBER("s", POSITIVE, NULL), OF_WISPS | OF_ANJYO, "kind=gust",
 INTO(wind, decay), "time in which it then falls to 1/e"},
{"wind", "amplitudes",  NUMBERS(1, WIND_TERMS_MAX, NULL, ANY, NULL), OF_WISPS | OF_ANJYO,
 "kind=irregular", BY_HAND, "amplitudes of the sines that are added up, relative to velocity"},
{"wind", "frequencies", NUMBERS(1, WIND_TERMS_MAX, "Hz", ANY, NULL), OF_WISPS | OF_ANJYO,
 "kind=irregular", BY_HAND, "frequencies of these sines, as many"},

{"", "style", GROUP(""), OF_WISPS, NULL, BY_HAND,
 "acceleration that bends hair into shape, linear in time between knots; by default none"},
{"style", "times",         NUMBERS(1, KNOTS_MAX, "s", ANY, NULL), OF_WISPS, NULL, BY_HAND,
 "of the knots, ascending"},
{"style", "accelerations", VECTORS("m/s^2"), OF_WISPS, NULL, BY_HAND, "acceleration at each knot"},
{"style", "parting",       GROUP(""), OF_WISPS, NULL, BY_HAND,
 "what parts the hair: besides, a field with opposite signs on the two sides of a plane"},
{"style.parting", "origin",        VECTOR("m", ANY, NULL), OF_WISPS, NULL, INTO(parting, origin),
 "a point of the plane"},
{"style.parting", "normal",        VECTOR(NULL, ANY, NULL), OF_WISPS, NULL, INTO(parting, normal),
 "normal of the plane, of any length"},
{"style.parting", "width",         NUMBER("m", POSITIVE, NULL), OF_WISPS, NULL, INTO(parting, width),
 "distance from the plane at which the field is tanh 1 of its whole"},
{"style.parting", "accelerations", VECTORS("m/s^2"), OF_WISPS, NULL, BY_HAND,
 "field at each knot of the style, on the side of the normal"},

{"", "head", GROUP(""), OF_WISPS, NULL, BY_HAND,
 "motion of roots and bodies, cubic in time between knots; by default they rest"},
{"head", "times",     NUMBERS(1, KNOTS_MAX, "s", ANY, NULL), OF_WISPS, NULL, BY_HAND,
 "of the knots, ascending"},
{"head", "positions", VECTORS("m"), OF_WISPS, NULL, BY_HAND, "place of its origin at each knot"},
{"head", "rotations", VECTORS("rad"), OF_WISPS, NULL, BY_HAND, "rotation at each knot: axis times angle"},

{"", "body", LIST(""), OF_WISPS, NULL, BY_HAND, "ellipsoids that push hair out"},
{"body", "name",          TEXT(NULL), OF_WISPS, NULL, BY_HAND, "name by which scalps and pictures know the body"},
{"body", "center",        VECTOR("m", ANY, NULL), OF_WISPS, NULL, INTO(body, centre),
 "centre at t = 0 as the head rests"},
{"body", "radii",         VECTOR("m", POSITIVE, NULL), OF_WISPS, NULL, INTO(body, radii),
 "radii along the axes of the head"},
{"body", "velocity",      VECTOR("m/s", ANY, "[0.0, 0.0, 0.0]"), OF_WISPS, NULL, INTO(body, velocity),
 "velocity relative to the head, constant"},
{"body", "friction",      NUMBER("1/s", NOT_NEGATIVE, NULL), OF_WISPS, NULL, INTO(body, friction),
 "rate at which what moves along the surface slows down"},
{"body", "response",      CHOICE(response_words, "tick"), OF_WISPS, NULL, INTO(body, response),
 "whether it acts at ticks or, as a force, at all times"},
{"body", "elasticity",    NUMBER(NULL, FROM_TO(0, 1), NULL), OF_WISPS, "response=tick",
 INTO(body, elasticity), "part of the velocity across the surface that comes back"},
{"body", "offset",        NUMBER("m", NOT_NEGATIVE, NULL), OF_WISPS, "response=tick",
 INTO(body, offset), "height above the surface at which a node is put down"},
{"body", "frequency",     NUMBER("Hz", POSITIVE, NULL), OF_WISPS, "response=penalty",
 INTO(body, frequency), "frequency of a point on the spring that pushes it out"},
{"body", "damping_ratio", NUMBER(NULL, NOT_NEGATIVE, "1"), OF_WISPS, "response=penalty",
 INTO(body, damping_ratio), "damping of that, 1 being critical"},

{"", "contacts", GROUP(""), OF_WISPS, NULL, BY_HAND,
 "how wisps and bodies touch; without this group wisps do not touch each other"},
{"contacts", "collision_rate",   NUMBER("Hz", NOT_NEGATIVE, "300"), OF_WISPS, NULL,
 INTO(scene, collision_rate), "ticks with bodies per second; 0 lets nothing feel them"},
{"contacts", "interaction_rate", NUMBER("Hz", NOT_NEGATIVE, "90"), OF_WISPS, NULL,
 INTO(scene, interaction.rate), "ticks of wisps with each other per second"},
{"contacts", "threshold",        NUMBER(NULL, FROM_TO(0, 1), "0.9"), OF_WISPS, NULL,
 INTO(scene, interaction.threshold),
 "part of the relative velocity across both wisps below which they interpenetrate, else collide"},
{"contacts", "viscosity",        NUMBER("1/s", NOT_NEGATIVE, "5"), OF_WISPS, NULL,
 INTO(scene, interaction.viscosity), "rate at which wisps that interpenetrate drag each other along"},
{"contacts", "interpenetration", SWITCH("true"), OF_WISPS, NULL,
 INTO(scene, interaction.interpenetration), "whether wisps that interpenetrate drag each other along"},
{"contacts", "collision",        SWITCH("true"), OF_WISPS, NULL,
 INTO(scene, interaction.collision), "whether wisps collide"},
{"contacts", "reciprocal",       SWITCH("true"), OF_WISPS, NULL,
 INTO(scene, interaction.reciprocal),
 "whether contacts of wisps change both; else the point alone, as in the thesis"},

{"", "subdivision", GROUP(""), OF_WISPS, NULL, BY_HAND,
 "how wisps that are pressed flat split in two; by default none does"},
{"subdivision", "ratio",      NUMBER(NULL, ABOVE_TO(0, 1), "0.5"), OF_WISPS, NULL,
 INTO(subdivision, ratio), "ratio of the least to the largest diameter below which a wisp splits"},
{"subdivision", "separation", NUMBER("m", POSITIVE, "0.01"), OF_WISPS, NULL,
 INTO(subdivision, separation), "distance from which on twins touch as others do"},
{"subdivision", "limit",      NUMBER(NULL, WHOLE(1, 100000), "400"), OF_WISPS, NULL,
 INTO(subdivision, limit), "wisps at most; not fewer than the scene has"},

{"", "anjyo", GROUP(NULL), OF_ANJYO, NULL, BY_HAND, "what that problem has of its own"},
{"anjyo", "c", NUMBER("1/(kg m^2)", POSITIVE, NULL), OF_ANJYO, NULL, INTO(scene, anjyo_constant),
 "constant of the source: angular acceleration per moment"},

{"", "render", GROUP(""), OF_HAIR, NULL, BY_HAND,
 "how pictures look at the scene, which is no part of what is integrated"},
{"render", "eye",    VECTOR("m", ANY, ""), OF_HAIR, NULL, BY_HAND,
 "place of the camera; by default one from which all hair is seen"},
{"render", "target", VECTOR("m", ANY, ""), OF_HAIR, NULL, BY_HAND,
 "what is in the middle of the picture; by default the middle of the hair"},
{"render", "angle",  NUMBER("rad", ABOVE_TO(0, 3), "0.5"), OF_HAIR, NULL, INTO(render_settings, angle),
 "angle of view, from the picture's bottom to its top"},
{"render", "light",  VECTOR(NULL, ANY, ""), OF_HAIR, NULL, BY_HAND,
 "direction towards the light, of any length; by default over the camera's shoulder"},
{"render", "colour", VECTOR(NULL, FROM_TO(0, 1), "[0.56, 0.38, 0.21]"), OF_HAIR, NULL,
 INTO(render_settings, colour), "red, green and blue of hair in full light"},
{"render", "hairs",  NUMBER(NULL, WHOLE(1, 100000), "50"), OF_HAIR, NULL, INTO(render_settings, hairs),
 "hairs drawn in a wisp that has not split"},
{"render", "pieces", NUMBER(NULL, WHOLE(1, 1000), "4"), OF_HAIR, NULL, INTO(render_settings, pieces),
 "straight pieces of a hair, for each segment of its wisp"},

{0}};
/* clang-format on */

const struct scene_setting *setting_find(const char *group, const char *name) {
    for (const struct scene_setting *s = scene_settings; s->name; s++)
        if (strcmp(s->group, group) == 0 && strcmp(s->name, name) == 0)
            return s;
    return NULL;
}

/* --- mistyped names --- */

enum { NAME_MOST = 32 }; /* letters; longer ones resemble nothing */

/* How many letters are to be put in, taken out or changed (Levenshtein), row by row. */
static int letters_apart(const char *a, const char *b) {
    const int length = (int)strlen(b);
    int row[NAME_MOST + 1];
    for (int j = 0; j <= length; j++)
        row[j] = j;
    for (int i = 0; a[i]; i++) {
        int corner = row[0];
        row[0] = i + 1;
        for (int j = 0; j < length; j++) {
            const int changed = corner + (a[i] != b[j]);
            const int inserted = 1 + (row[j] < row[j + 1] ? row[j] : row[j + 1]);
            corner = row[j + 1];
            row[j + 1] = changed < inserted ? changed : inserted;
        }
    }
    return row[length];
}

const struct scene_setting *setting_nearest(const char *group, const char *name, unsigned of) {
    const struct scene_setting *nearest = NULL;
    int least = 1 + (int)strlen(name) / 3; /* of which more are another word */
    if (strlen(name) > NAME_MOST)
        return NULL;
    for (const struct scene_setting *s = scene_settings; s->name; s++) {
        const int apart = strcmp(s->group, group) == 0 && s->problems & of
                              ? letters_apart(name, s->name)
                              : least + 1;
        if (apart < least || (apart == least && !nearest)) {
            least = apart;
            nearest = s;
        }
    }
    return nearest;
}

/* --- words --- */

static void append(char *text, size_t size, const char *more) {
    strncat(text, more, size - strlen(text) - 1);
}

/* "a positive number"; of several the numbers' own, without "a". */
static void range_words(const struct setting_range *range, int several, char *text, size_t size) {
    char kind[40];
    snprintf(kind, sizeof kind, "%s%snumber%s", several ? "" : "a ", range->whole ? "whole " : "",
             several ? "s" : "");
    const int from_zero = range->least == 0, endless = range->most == INFINITY;
    if (from_zero && endless && range->above)
        snprintf(text, size, "%s", several ? "positive numbers" : "a positive number");
    else if (from_zero && endless)
        snprintf(text, size, "%s from 0 on", kind);
    else if (endless)
        snprintf(text, size, "%s", several ? "numbers" : "a finite number");
    else if (range->above && range->below)
        snprintf(text, size, "%s between %g and %g", kind, range->least, range->most);
    else if (range->above)
        snprintf(text, size, "%s above %g and up to %g", kind, range->least, range->most);
    else
        snprintf(text, size, "%s from %g to %g", kind, range->least, range->most);
}

static void choice_words(const struct scene_setting *setting, char *text, size_t size) {
    snprintf(text, size, "one of ");
    for (int i = 0; setting->choices[i]; i++) {
        append(text, size, i ? ", " : "");
        append(text, size, setting->choices[i]);
    }
}

static void numbers_words(const struct scene_setting *setting, char *text, size_t size) {
    char numbers[100];
    range_words(&setting->range, 1, numbers, sizeof numbers);
    if (setting->least == setting->most)
        snprintf(text, size, "%d %s in brackets", setting->most, numbers);
    else
        snprintf(text, size, "%d to %d %s in brackets", setting->least, setting->most, numbers);
}

void setting_what(const struct scene_setting *setting, char *text, size_t size) {
    static const char *const words[] = {[SETTING_VECTORS] = "a list of vectors, ([x, y, z], ...)",
                                        [SETTING_SWITCH] = "true or false",
                                        [SETTING_TEXT] = "a text in quotes",
                                        [SETTING_GROUP] = "a group in braces",
                                        [SETTING_LIST] = "a list of groups, ( { ... }, ... )"};
    if (setting->type == SETTING_NUMBER)
        range_words(&setting->range, 0, text, size);
    else if (setting->type == SETTING_NUMBERS)
        numbers_words(setting, text, size);
    else if (setting->type == SETTING_CHOICE)
        choice_words(setting, text, size);
    else
        snprintf(text, size, "%s", words[setting->type]);
    if (setting->unit) {
        append(text, size, ", in ");
        append(text, size, setting->unit);
    }
}

void setting_right(const struct scene_setting *setting, char *text, size_t size) {
    setting_what(setting, text, size);
    if (!setting->initial || !*setting->initial)
        return;
    append(text, size, " (default ");
    append(text, size, setting->initial);
    append(text, size, ")");
}

void setting_path(const struct scene_setting *setting, char *path, size_t size) {
    const struct scene_setting *group = setting_find("", setting->group);
    snprintf(path, size, "%s%s%s%s", setting->group, *setting->group ? "." : "",
             group && group->type == SETTING_LIST ? "[0]." : "", setting->name);
}

void setting_with(const struct scene_setting *setting, char *text, size_t size) {
    const char *with = setting->with, *value = with ? strchr(with, '=') : NULL;
    if (!with)
        *text = '\0';
    else if (value)
        snprintf(text, size, "with %.*s = \"%s\"", (int)(value - with), with, value + 1);
    else
        snprintf(text, size, "%s %s", *with == '!' ? "without" : "with", with + (*with == '!'));
}

void setting_type(const struct scene_setting *setting, char *text, size_t size) {
    static const char *const names[] = {
        [SETTING_NUMBER] = "number", [SETTING_SWITCH] = "switch",   [SETTING_CHOICE] = "choice",
        [SETTING_TEXT] = "text",     [SETTING_NUMBERS] = "numbers", [SETTING_VECTORS] = "vectors",
        [SETTING_GROUP] = "group",   [SETTING_LIST] = "list"};
    if (setting->type == SETTING_NUMBER && setting->range.whole)
        snprintf(text, size, "whole number");
    else
        snprintf(text, size, "%s", names[setting->type]);
}

void setting_problems(const struct scene_setting *setting, char *text, size_t size) {
    *text = '\0';
    for (int i = 0; problem_words[i] && setting->problems != OF_ALL; i++)
        if (setting->problems & 1u << i) {
            append(text, size, *text ? ", " : "");
            append(text, size, problem_words[i]);
        }
}
