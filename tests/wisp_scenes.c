/* Scene files of wisps: what is wrong is refused in one line with its place and reason, and what is
 * right becomes the stated numbers. */
#include "model/problems.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

/* --- what is wrong --- */

/* A scene that is right, setting by setting; each line below replaces or adds one of them. */
static const struct {
    const char *name, *text;
} sound[] = {
    {"duration", "duration = 0.01;"},
    {"frame_rate", "frame_rate = 100.0;"},
    {"gravity", "gravity = [0.0, -9.81, 0.0];"},
    {"material", "material = { };"},
    {"envelope", "envelope = { };"},
    {"wisps", "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0]; length = 0.3; "
              "nodes = 11; } );"},
};
enum { SOUND = sizeof sound / sizeof *sound };

#define WISP(rest)                                                                                 \
    "wisps = (\n{ root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0]; length = 0.3;\n" rest " } " \
    ");"
#define BODY(root, direction, length) "wisps = (\n{ " root direction length " nodes = 11; } );"
#define ROOT                          "root = [0.0, 0.0, 0.0]; "
#define DIRECTION                     "direction = [1.0, 0.0, 0.0]; "
#define LENGTH                        "length = 0.3; "
#define GRID(rest)                    WISP("nodes = 5;\n" rest)
#define ACROSS                        " across = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);"

#define PARTED(rest)                                                                    \
    "style = { times = [0.0, 1.0]; accelerations = ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0]);" \
    " parting = { " rest " }; };"
#define PLANE "origin = [0.0, 0.0, 0.0]; normal = [2.0, 0.0, 0.0]; "

#define NAME       "name = \"ball\"; "
#define CENTER     "center = [0.0, 1.0, 0.0]; "
#define RADII      "radii = [0.1, 0.1, 0.1]; "
#define FRICTION   "friction = 50.0; "
#define ELASTICITY "elasticity = 0.1; "
#define OFFSET     "offset = 1e-4; "
#define ELLIPSOID(name, center, radii, friction, elasticity, offset, rest) \
    "body = ( { " name center radii friction elasticity offset rest " } );"
#define SPHERE(rest) ELLIPSOID(NAME, CENTER, RADII, FRICTION, ELASTICITY, OFFSET, "\n" rest)
#define BALL         "{ " NAME CENTER RADII FRICTION ELASTICITY OFFSET " }"

/* `name` of the setting that `text` replaces; an empty text leaves it out. `line` where the message
 * must say one: of the replaced setting (the first is 1) plus what `text` goes on, or 0. */
static const struct wrong {
    const char *name, *text;
    int line;
    const char *says[3];
} wrongs[] = {
    /* missing */
    {"duration", "", 6, {"duration", "missing"}},
    {"gravity", "", 6, {"gravity", "missing"}},
    {"material", "", 6, {"material", "missing"}},
    {"wisps", "", 6, {"wisps", "list of groups"}},
    {"wisps", BODY("", DIRECTION, LENGTH), 7, {"root", "missing"}},
    {"wisps", BODY(ROOT, "", LENGTH), 7, {"direction", "missing"}},
    {"wisps", BODY(ROOT, DIRECTION, ""), 7, {"length", "missing"}},
    {"wisps", WISP(""), 7, {"nodes", "missing"}},
    {"wisps", GRID("grid = [2, 2];" ACROSS), 7, {"spacing", "missing"}},
    {"wisps", GRID("grid = [2, 2]; spacing = 0.1;"), 7, {"across", "2 vectors"}},
    {"wisps", GRID("spacing = 0.1;"), 9, {"spacing", "grid"}},
    {"wisps", GRID(ACROSS), 9, {"across", "grid"}},
    {"wind", "wind = { };", 7, {"velocity", "missing"}},
    {"wind", "wind = { velocity = [1.0, 0.0, 0.0]; };", 7, {"kind", "steady"}},
    {"wind", "wind = { kind = \"steady\"; };", 7, {"velocity", "missing"}},
    {"wind",
     "wind = { kind = \"gust\"; velocity = [1.0, 0.0, 0.0]; hold = 1.0; };",
     7,
     {"decay", "missing"}},
    {"wind",
     "wind = { kind = \"gust\"; velocity = [1.0, 0.0, 0.0]; decay = 1.0; };",
     7,
     {"hold", "missing"}},
    {"wind", "wind = { kind = \"gust\"; hold = 1.0; decay = 1.0; };", 7, {"velocity", "missing"}},
    {"wind", "wind = { kind = \"irregular\"; velocity = [1.0, 0.0, 0.0]; };", 7, {"amplitudes"}},
    {"wind",
     "wind = { kind = \"irregular\"; velocity = [1.0, 0.0, 0.0]; amplitudes = [0.5]; };",
     7,
     {"frequencies"}},
    {"wind",
     "wind = { kind = \"irregular\"; velocity = [1.0, 0.0, 0.0]; frequencies = [0.5]; };",
     7,
     {"amplitudes"}},
    {"wind",
     "wind = { kind = \"irregular\"; velocity = [1.0, 0.0, 0.0]; amplitudes = [0.5, 0.2];\n"
     "frequencies = [2.0]; };",
     7,
     {"equally many"}},
    /* unknown */
    {"gravitation", "gravitation = [0.0, 0.0, 0.0];", 7, {"gravitation", "unknown"}},
    {"material",
     "material = { hair_count = 100;\n hair_cuont = 1; };",
     5,
     {"hair_cuont", "unknown", "hair_count"}},
    {"envelope", "envelope = {\n sample = 4; };", 6, {"sample:", "unknown"}},
    {"wisps", WISP("node = 11;"), 8, {"node:", "unknown"}},
    {"wind", "wind = { kind = \"breeze\"; velocity = [1.0, 0.0, 0.0]; };", 7, {"breeze", "gust"}},
    {"wind",
     "wind = { kind = \"steady\"; velocity = [1.0, 0.0, 0.0];\n hold = 1.0; };",
     8,
     {"hold", "kind = \"gust\"", "steady"}},
    {"wind",
     "wind = { kind = \"gust\"; velocity = [1.0, 0.0, 0.0]; hold = 1.0; decay = 1.0;\n"
     " amplitudes = [1.0]; };",
     8,
     {"amplitudes", "kind = \"irregular\"", "gust"}},
    {"material", "material = {\n bending = \"foo\"; };", 5, {"bending", "foo", "hinge"}},
    {"problem", "problem = \"wsips\";", 7, {"problem", "wsips"}},
    {"run", "run = {\n stride = 1; };", 8, {"stride", "unknown"}},
    /* of the wrong type */
    {"duration", "duration = \"long\";", 1, {"duration", "positive number"}},
    {"gravity", "gravity = 9.81;", 3, {"gravity", "3 numbers"}},
    {"gravity", "gravity = [0.0, -9.81];", 3, {"gravity", "3 numbers"}},
    {"gravity", "gravity = [0.0, -9.81, 0.0, 0.0];", 3, {"gravity", "3 numbers"}},
    {"gravity", "gravity = (0.0, \"down\", 0.0);", 3, {"gravity", "number 2"}},
    {"gravity", "gravity = { x = 0.0; y = 1.0; z = 0.0; };", 3, {"gravity", "3 numbers"}},
    {"material", "material = 3;", 4, {"material", "group"}},
    {"material", "material = ( { } );", 4, {"material", "group"}},
    {"material", "material = {\n hair_count = \"many\"; };", 5, {"hair_count", "positive number"}},
    {"material", "material = {\n bending = 3; };", 5, {"bending", "text"}},
    {"material", "material = {\n drag_rate = [1.0]; };", 5, {"drag_rate", "number"}},
    {"material", "material = {\n drag_rate = true; };", 5, {"drag_rate", "number"}},
    {"envelope", "envelope = \"yes\";", 5, {"envelope", "group"}},
    {"wisps", "wisps = { root = [0.0, 0.0, 0.0]; };", 6, {"wisps", "list"}},
    {"wisps", "wisps = ( 1 );", 6, {"wisps", "group"}},
    {"wisps", "wisps = ();", 6, {"wisps", "list"}},
    {"wisps", "wisps = 7;", 6, {"wisps", "list"}},
    {"wisps", WISP("nodes = \"many\";"), 8, {"nodes", "whole"}},
    {"wisps", GRID("grid = 3; spacing = 0.1;" ACROSS), 9, {"grid", "2 whole numbers"}},
    {"wisps", GRID("grid = [3]; spacing = 0.1;" ACROSS), 9, {"grid", "2 whole numbers"}},
    {"wisps", GRID("grid = [2, 2]; spacing = 0.1; across = 1.0;"), 9, {"across", "2 vectors"}},
    {"wisps", GRID("grid = [2, 2]; spacing = 0.1; across = ([1.0, 0.0, 0.0]);"), 9, {"across"}},
    {"wisps",
     GRID("grid = [2, 2]; spacing = 0.1; across = ([1.0, 0.0], [0.0, 0.0, 1.0]);"),
     9,
     {"across", "3 numbers"}},
    {"wisps", GRID("grid = [2, 2]; spacing = 0.1; across = (1.0, 2.0);"), 9, {"across"}},
    {"wind", "wind = 3.0;", 7, {"wind", "group"}},
    {"wind", "wind = { kind = 1; velocity = [1.0, 0.0, 0.0]; };", 7, {"kind", "text"}},
    {"wind", "wind = { kind = \"steady\"; velocity = 1.0; };", 7, {"velocity", "3 numbers"}},
    {"wind",
     "wind = { kind = \"irregular\"; velocity = [1.0, 0.0, 0.0]; amplitudes = 0.5;\n"
     " frequencies = [1.0]; };",
     7,
     {"amplitudes", "numbers"}},
    /* out of range */
    {"material", "material = {\n hair_count = 0; };", 5, {"hair_count", "positive"}},
    {"material", "material = {\n hair_count = -1.0; };", 5, {"hair_count", "positive"}},
    {"material", "material = {\n hair_density = 0.0; };", 5, {"hair_density", "positive"}},
    {"material", "material = {\n stretch_stiffness = -90.0; };", 5, {"stretch_stiffness", "-90"}},
    {"material", "material = {\n stretch_time = -1e-4; };", 5, {"stretch_time", "from 0"}},
    {"material",
     "material = {\n stretch = \"stiff\"; };",
     5,
     {"stretch", "'stiff'", "spring, rigid"}},
    {"material",
     "material = { stretch = \"rigid\";\n stretch_stiffness = 90.0; };",
     5,
     {"stretch_stiffness", "rigid"}},
    {"material",
     "material = { stretch = \"rigid\";\n\n stretch_time = 1e-4; };",
     6,
     {"stretch_time", "rigid"}},
    {"run", "run = {\n project = true; };", 8, {"project", "rigid"}},
    {"material", "material = {\n bending_stiffness = -1.0; };", 5, {"bending_stiffness"}},
    {"material", "material = {\n bending_angle = 0.0; };", 5, {"bending_angle", "positive"}},
    {"material", "material = {\n bending_time = -1.0; };", 5, {"bending_time"}},
    {"material", "material = {\n drag_rate = -4.0; };", 5, {"drag_rate", "from 0"}},
    {"envelope", "envelope = {\n samples = 2; };", 6, {"samples", "3 to 16"}},
    {"envelope", "envelope = {\n samples = 17; };", 6, {"samples", "3 to 16"}},
    {"envelope", "envelope = {\n samples = 4.5; };", 6, {"samples", "whole"}},
    {"envelope", "envelope = {\n samples = 0; };", 6, {"samples", "3 to 16"}},
    {"envelope", "envelope = {\n radius = 0.0; };", 6, {"radius", "positive"}},
    {"envelope", "envelope = {\n mass_fraction = 0.0; };", 6, {"mass_fraction"}},
    {"envelope", "envelope = {\n mass_fraction = 1.0; };", 6, {"mass_fraction", "0 and 1"}},
    {"envelope", "envelope = {\n frequency = -10.0; };", 6, {"frequency", "from 0"}},
    {"envelope", "envelope = {\n damping_ratio = -1.0; };", 6, {"damping_ratio"}},
    {"envelope", "envelope = {\n penalty_ratio = -1.0; };", 6, {"penalty_ratio"}},
    {"wisps", WISP("nodes = 2;"), 8, {"nodes", "3"}},
    {"wisps", WISP("nodes = 11.5;"), 8, {"nodes", "whole"}},
    {"wisps", WISP("nodes = -3;"), 8, {"nodes", "whole"}},
    {"wisps", BODY(ROOT, DIRECTION, "\nlength = 0.0;"), 8, {"length", "positive"}},
    {"wisps", BODY(ROOT, "\ndirection = [0.0, 0.0, 0.0];", LENGTH), 8, {"direction", "no length"}},
    {"wisps", GRID("grid = [0, 2]; spacing = 0.1;" ACROSS), 9, {"grid", "whole"}},
    {"wisps", GRID("grid = [2.0, 2.5]; spacing = 0.1;" ACROSS), 9, {"grid", "2.5"}},
    {"wisps", GRID("grid = [2, -2]; spacing = 0.1;" ACROSS), 9, {"grid", "-2"}},
    {"wisps", GRID("grid = [2, 2]; spacing = 0.0;" ACROSS), 9, {"spacing", "positive"}},
    {"wisps",
     GRID("grid = [2, 2]; spacing = 0.1; across = ([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]);"),
     9,
     {"across", "no length"}},
    {"wind",
     "wind = { kind = \"gust\"; velocity = [1.0, 0.0, 0.0]; hold = -1.0; decay = 1.0; };",
     7,
     {"hold", "from 0"}},
    {"wind",
     "wind = { kind = \"gust\"; velocity = [1.0, 0.0, 0.0]; hold = 1.0;\n decay = 0.0; };",
     8,
     {"decay", "positive"}},
    {"duration", "duration = -1.0;", 1, {"duration", "positive"}},
    {"frame_rate", "frame_rate = 0.0;", 2, {"frame_rate", "positive"}},
    /* not finite */
    {"gravity", "gravity = [0.0, 1e999, 0.0];", 3, {"gravity", "finite"}},
    {"material", "material = {\n hair_density = 1e999; };", 5, {"hair_density"}},
    {"envelope", "envelope = {\n frequency = 1e999; };", 6, {"frequency"}},
    {"wisps", BODY("\nroot = [1e999, 0.0, 0.0];", DIRECTION, LENGTH), 8, {"root", "finite"}},
    {"wisps", BODY(ROOT, "\ndirection = [1e999, 0.0, 0.0];", LENGTH), 8, {"direction", "finite"}},
    {"wisps", BODY(ROOT, DIRECTION, "\nlength = 1e999;"), 8, {"length"}},
    {"wisps", GRID("grid = [2, 2]; spacing = 1e999;" ACROSS), 9, {"spacing"}},
    {"wisps",
     GRID("grid = [2, 2]; spacing = 0.1; across = ([1e999, 0.0, 0.0], [0.0, 0.0, 1.0]);"),
     9,
     {"across", "finite"}},
    {"wind",
     "wind = { kind = \"steady\"; velocity = [1e999, 0.0, 0.0]; };",
     7,
     {"velocity", "finite"}},
    {"wind",
     "wind = { kind = \"irregular\"; velocity = [1.0, 0.0, 0.0]; amplitudes = [1e999];\n"
     " frequencies = [1.0]; };",
     7,
     {"amplitudes", "finite"}},
    /* bodies and contacts */
    {"body", "body = { name = \"head\"; };", 7, {"body", "list of"}},
    {"body", "body = ();", 7, {"body", "list of"}},
    {"body", "body = 3;", 7, {"body", "list of"}},
    {"body", "body = ( 3 );", 7, {"body", "group"}},
    {"body",
     ELLIPSOID("", CENTER, RADII, FRICTION, ELASTICITY, OFFSET, ""),
     7,
     {"name", "missing"}},
    {"body",
     ELLIPSOID(NAME, "", RADII, FRICTION, ELASTICITY, OFFSET, ""),
     7,
     {"center", "missing"}},
    {"body",
     ELLIPSOID(NAME, CENTER, "", FRICTION, ELASTICITY, OFFSET, ""),
     7,
     {"radii", "missing"}},
    {"body",
     ELLIPSOID(NAME, CENTER, RADII, "", ELASTICITY, OFFSET, ""),
     7,
     {"friction", "missing"}},
    {"body",
     ELLIPSOID(NAME, CENTER, RADII, FRICTION, "", OFFSET, ""),
     7,
     {"elasticity", "missing"}},
    {"body",
     ELLIPSOID(NAME, CENTER, RADII, FRICTION, ELASTICITY, "", ""),
     7,
     {"offset", "missing"}},
    {"body", SPHERE("mass = 1.0;"), 8, {"mass:", "unknown"}},
    {"body", SPHERE("velocity = 1.0;"), 8, {"velocity", "3 numbers"}},
    {"body", SPHERE("velocity = [1.0, 0.0, 1e999];"), 8, {"velocity", "finite"}},
    {"body",
     ELLIPSOID("name = 3;", CENTER, RADII, FRICTION, ELASTICITY, OFFSET, ""),
     7,
     {"name", "text"}},
    {"body",
     ELLIPSOID("name = \"\";", CENTER, RADII, FRICTION, ELASTICITY, OFFSET, ""),
     7,
     {"name", "63"}},
    {"body",
     ELLIPSOID(NAME, "center = [0.0, 1.0];", RADII, FRICTION, ELASTICITY, OFFSET, ""),
     7,
     {"center", "3 numbers"}},
    {"body",
     ELLIPSOID(NAME, CENTER, "radii = [1.0, 0.0, 1.0];", FRICTION, ELASTICITY, OFFSET, ""),
     7,
     {"radii", "number 2, 0,", "positive"}},
    {"body",
     ELLIPSOID(NAME, CENTER, "radii = [1.0, 1.0, -1.0];", FRICTION, ELASTICITY, OFFSET, ""),
     7,
     {"radii", "number 3", "positive"}},
    {"body",
     ELLIPSOID(NAME, CENTER, RADII, "friction = -1.0;", ELASTICITY, OFFSET, ""),
     7,
     {"friction", "from 0"}},
    {"body",
     ELLIPSOID(NAME, CENTER, RADII, FRICTION, "elasticity = -0.1;", OFFSET, ""),
     7,
     {"elasticity", "from 0"}},
    {"body",
     ELLIPSOID(NAME, CENTER, RADII, FRICTION, "elasticity = 1.1;", OFFSET, ""),
     7,
     {"elasticity", "0 to 1"}},
    {"body",
     ELLIPSOID(NAME, CENTER, RADII, FRICTION, ELASTICITY, "offset = -1e-4;", ""),
     7,
     {"offset", "from 0"}},
    {"body", "body = (\n" BALL ",\n" BALL ");", 9, {"name", "ball", "already"}},
    {"contacts", "contacts = {\n collision_rate = -1.0; };", 8, {"collision_rate", "from 0"}},
    {"contacts", "contacts = { interaction_rate = -90.0; };", 7, {"interaction_rate", "from 0"}},
    {"contacts", "contacts = { interaction_rate = 1e999; };", 7, {"interaction_rate", "from 0"}},
    {"contacts", "contacts = { threshold = 1.1; };", 7, {"threshold", "0 to 1"}},
    {"contacts", "contacts = { threshold = -0.1; };", 7, {"threshold", "from 0"}},
    {"contacts", "contacts = { viscosity = -5.0; };", 7, {"viscosity", "from 0"}},
    {"contacts", "contacts = { interpenetration = 1; };", 7, {"interpenetration", "true or false"}},
    {"contacts", "contacts = { collision = \"no\"; };", 7, {"collision", "true or false"}},
    {"contacts", "contacts = { reciprocal = 0.0; };", 7, {"reciprocal", "true or false"}},
    {"contacts", "contacts = { friction = 5.0; };", 7, {"friction", "unknown", "body"}},
    {"contacts", "contacts = 5.0;", 7, {"contacts", "group"}},
    /* of later chapters */
    {"subdivision", "subdivision = 0.5;", 7, {"subdivision", "group"}},
    {"envelope", "subdivision = { };", 5, {"subdivision", "none", "add envelope"}},
    {"envelope", "envelope = { samples = 3; };\nsubdivision = { };", 6, {"subdivision", "even"}},
    {"subdivision", "subdivision = { count = 2; };", 7, {"count"}},
    {"subdivision", "subdivision = { ratio = 0.0; };", 7, {"ratio", "above 0"}},
    {"subdivision", "subdivision = { ratio = 1.5; };", 7, {"ratio", "up to 1"}},
    {"subdivision", "subdivision = { separation = -0.1; };", 7, {"separation", "positive"}},
    {"subdivision", "subdivision = {\n limit = 0; };", 8, {"limit", "from 1"}},
    {"subdivision", "subdivision = { limit = 100001; };", 7, {"limit", "100000"}},
    {"subdivision", "subdivision = { limit = 2.5; };", 7, {"limit", "whole"}},
    {"wisps",
     GRID("grid = [1, 401]; spacing = 0.1;" ACROSS) "\nsubdivision = { };",
     10,
     {"limit", "from 401"}},
    {"style", "style = { };", 7, {"times", "missing"}},
    {"style", PARTED(""), 7, {"origin", "missing"}},
    {"style", PARTED(PLANE "width = 0.1;"), 7, {"accelerations", "2"}},
    {"style", PARTED(PLANE "accelerations = ([0, 0, 0], [0, 0, 0]);"), 7, {"width", "missing"}},
    {"style", PARTED(PLANE "width = 0.0;"), 7, {"width", "positive"}},
    {"style", PARTED(PLANE "width = 0.1; accelerations = ([0, 0, 0]);"), 7, {"2"}},
    {"style",
     PARTED("origin = [0, 0, 0]; normal = [0, 0, 0]; width = 0.1;"),
     7,
     {"normal", "no length"}},
    {"style", PARTED("side = 1;"), 7, {"side", "unknown", "normal"}},
    {"head", "head = { };", 7, {"times", "missing"}},
    {"start", "start = \"nothing.tsv\";", 7, {"start", "/nothing.tsv", "cannot be read"}},
    {"start", "start = \"\";", 7, {"start", "path"}},
    {"start", "start = 3;", 7, {"start", "text"}},
};
enum { WRONGS = sizeof wrongs / sizeof *wrongs };

/* The sound scene with `instead` in the place of that setting, or behind all; NULL: as it is. */
static const char *scene_text(const char *name, const char *instead) {
    static char text[4000];
    int replaced = 0;
    text[0] = '\0';
    for (int i = 0; i < SOUND; i++) {
        const int here = name && strcmp(sound[i].name, name) == 0;
        replaced |= here;
        strcat(strcat(text, here ? instead : sound[i].text), "\n");
    }
    if (name && !replaced)
        strcat(strcat(text, instead), "\n");
    return text;
}

Test(wisp_scenes, what_is_wrong_is_refused_in_one_line_with_its_place) {
    const char *place;
    const char *path;
    const char *const folder = folder_make();
    const char *const out = printed("%s/out", folder);
    for (int i = 0; i < WRONGS; i++) {
        const struct wrong *w = &wrongs[i];
        path = file_write(folder, "bad.cfg", scene_text(w->name, w->text));
        struct finished *f = FAILS(1, "", "run", path, "--no-progress", "--out", out);
        const char *end = strchr(f->err, '\n');
        cr_expect(end && end[1] == '\0', "%s: not one line: '%s'", w->text, f->err);
        if (w->line > 0)
            place = printed("%s:%d: ", path, w->line);
        else
            place = printed("%s: ", path);
        cr_expect(strstr(f->err, place), "%s: not at %s: '%s'", w->text, place, f->err);
        for (int k = 0; k < 3 && w->says[k]; k++)
            cr_expect(strstr(f->err, w->says[k]), "%s: does not say '%s': '%s'", w->text,
                      w->says[k], f->err);
        cr_expect_neq(access(out, F_OK), 0, "%s: something was written", w->text);
    }
    path = file_write(folder, "bad.cfg", scene_text(NULL, NULL));
    WORKS("run", path, "--no-progress", "--out", out);
    cr_expect(count_files(out, "") == 2 && count_files(folder, "") == 3, "something else is in %s",
              folder);
}

/* --- what is right --- */

Test(wisp_scenes, the_named_defaults_hold) {
    struct scene *scene = lab_read(scene_text(NULL, NULL));
    cr_assert_eq(scene->wisp_count, 1);
    const struct wisp *w = scene->wisps;
    cr_assert(w->nodes == 11 && w->samples == 4 && w->bending == BENDING_SKIP);
    cr_assert(w->hair_count == 1000 && w->hair_density == 5.7e-6 && w->stretch_stiffness == 90 &&
              w->stretch_time == 1.2e-4 && w->bending_stiffness == 1e-5 &&
              w->bending_angle == 0.3 && w->bending_time == 1e-3 && w->drag_rate == 4);
    cr_assert(w->radius == 0.02 && w->mass_fraction == 0.15 && w->frequency == 10 &&
              w->damping_ratio == 1 && w->penalty_ratio == 100);
    cr_assert(scene->collision_rate == 300 && scene->around.wind.kind == WIND_NONE);
    /* and are those that the shipped scenes spell out */
    struct scene *swing = lab_load("swing", NULL, 0),
                 *envelope = lab_load("swing-envelope", NULL, 0);
    struct scene *spare = LAB_LOAD("swing", "material={}");
    struct scene *spare_envelope = LAB_LOAD("swing-envelope", "material={}", "envelope={}");
    cr_assert_eq(memcmp(swing->wisps, spare->wisps, sizeof *swing->wisps), 0);
    cr_assert_eq(memcmp(envelope->wisps, spare_envelope->wisps, sizeof *swing->wisps), 0);
    cr_assert_eq(swing->wisps->samples, 0, "swing has an envelope");
}

/* Wherever the program is started, and errors in it have its name and line. */
Test(wisp_scenes, includes_stand_beside_the_scene) {
    static const char *const parts[] = {"# made of\nmaterial = { drag_rate = 3.0; };\n",
                                        "# made of\nmaterial = { drag_rate = -3.0; };\n"};
    const char *const folder = folder_make();
    const char *const path =
        file_write(folder, "scene.cfg", scene_text("material", "@include \"part.inc\""));
    for (int bad = 0; bad < 2; bad++) {
        file_write(folder, "part.inc", parts[bad]);
        if (bad)
            lab_refuse(path, NULL, 0, (const char *[]){"part.inc:2: drag_rate"}, 1);
        else
            cr_assert_eq(lab_load(path, NULL, 0)->wisps->drag_rate, 3);
    }
    remove(printed("%s/part.inc", folder));
    lab_refuse(path, NULL, 0, (const char *[]){"include"}, 1);
}

/* Rates hold without the group, responses only with it; without envelope there is nothing to
 * touch with. */
Test(wisp_scenes, contacts_are_read_and_need_an_envelope) {
    const char *set = "contacts={}";
    struct scene *without = lab_load("swing-envelope", NULL, 0),
                 *with = LAB_LOAD("swing-envelope", set),
                 *changed = LAB_LOAD("swing-envelope",
                                     "contacts={collision_rate = 200; interaction_rate = 45.5;"
                                     "threshold = 1; viscosity = 0; reciprocal = false;}");
    LAB_LOAD("swing", "contacts={interpenetration = false; collision = false;}");
    const struct interaction_settings *i = &with->interaction, *c = &changed->interaction;
    cr_assert(without->collision_rate == 300 && without->interaction.rate == 90);
    cr_assert(!without->interaction.interpenetration && !without->interaction.collision);
    cr_assert(with->collision_rate == 300 && i->rate == 90 && i->threshold == 0.9 &&
              i->viscosity == 5 && i->interpenetration && i->collision && i->reciprocal);
    cr_assert(changed->collision_rate == 200 && c->rate == 45.5 && c->threshold == 1 &&
              c->viscosity == 0 && c->interpenetration && c->collision && !c->reciprocal);
    LAB_REFUSE("swing", set, "envelope", "contacts");
}

/* Masses and spring constants by other formulas: what hangs below node 1.5 is there,
 * and the skip spring has the hinge's energy at the bending angle (to (angle)^2 / 24 of it, from
 * 2 l (1 - cos(angle / 2)) = l angle^2 / 4). */
Test(wisp_scenes, masses_and_constants_follow) {
    struct scene *scene = lab_load("swing-envelope", NULL, 0);
    const struct wisp *w = scene->wisps;
    const double l = 0.03, whole = 1000 * 5.7e-6 * (0.3 - 1.5 * l);
    double sum = 0;
    for (int i = 2; i < w->nodes; i++) {
        const double node = wisp_node_mass(w, i), sample = wisp_sample_mass(w, i);
        sum += node + 4 * sample;
        cr_assert(fabs(4 * sample / (node + 4 * sample) - 0.15) <= 1e-15, "share of the samples");
    }
    cr_assert(fabs(sum - whole) <= 1e-15 * whole * 10, "%.17g kg, not %.17g", sum, whole);
    cr_assert(fabs(wisp_node_mass(w, 10) / wisp_node_mass(w, 9) - 0.5) <= 1e-15, "the last node");
    cr_assert(fabs(wisp_stretch_constant(w) / 3000 - 1) <= 1e-15, "stretch");
    struct wisp hinge = *w;
    hinge.bending = BENDING_HINGE;
    const double shorter = 2 * l * (1 - cos(0.15));
    const double skip_energy = wisp_bending_constant(w) / 2 * shorter * shorter;
    const double hinge_energy = wisp_bending_constant(&hinge) / 2 * 0.3 * 0.3;
    cr_assert(fabs(skip_energy / hinge_energy - 1) <= 0.3 * 0.3 / 24, "energies %g and %g",
              skip_energy, hinge_energy);
}

/* Roots of a grid: the first corner, then along the first direction, then the second, however long
 * the directions are given; entries one after another. */
Test(wisp_scenes, grids_are_spread_out) {
    struct scene *scene = LAB_LOAD(
        "swing-envelope",
        "wisps=({ root=[0.1, 0.2, 0.3]; direction=[0, -3, 0]; length=0.2; nodes=5; grid=[3, 2];"
        "         spacing=0.025; across=([2.0, 0.0, 0.0], (0, 0.0, -4)); },"
        "       { root=[1, 2, 3]; direction=[3.0, 0.0, 4.0]; length=1; nodes=4; },"
        "       { root=[0.0, 0.0, 0.0]; direction=[0, 0, 1]; length=0.2; nodes=3; grid=[1, 1];"
        "         spacing=1; across=([1, 1, 0], [0, 0, 1]); })");
    cr_assert_eq(scene->wisp_count, 8, "%d wisps", scene->wisp_count);
    for (int i = 0; i < 6; i++) {
        const double expected[3] = {0.1 + 0.025 * (i % 3), 0.2, 0.3 - 0.025 * (i / 3)};
        for (int k = 0; k < 3; k++)
            cr_assert(fabs(scene->wisps[i].root[k] - expected[k]) <= 1e-16 &&
                          scene->wisps[i].direction[k] == (k == 1 ? -1 : 0),
                      "wisp %d: root %.17g, not %.17g", i, scene->wisps[i].root[k], expected[k]);
        cr_assert(scene->wisps[i].nodes == 5 && scene->wisps[i].length == 0.2);
    }
    const struct wisp *single = &scene->wisps[6];
    cr_assert(single->root[0] == 1 && single->root[1] == 2 && single->root[2] == 3 &&
              single->nodes == 4 && single->length == 1);
    cr_assert(fabs(single->direction[0] - 0.6) <= 1e-16 && single->direction[1] == 0 &&
              fabs(single->direction[2] - 0.8) <= 1.2e-16);
    cr_assert(scene->wisps[7].nodes == 3 && scene->wisps[7].root[0] == 0);
}

/* Directions of any length: squares that overflow or vanish. */
Test(wisp_scenes, directions_are_normalised) {
    static const char *const directions[] = {
        "wisps=({ root=[0,0,0]; direction=[3e300, 4e300, 0.0]; length=1; nodes=3; })",
        "wisps=({ root=[0,0,0]; direction=[3e-310, 4e-310, 0.0]; length=1; nodes=3; })",
        "wisps=({ root=[0,0,0]; direction=[0.3, 0.4, 0.0]; length=1; nodes=3; })",
    };
    for (int i = 0; i < 3; i++) {
        struct scene *scene = LAB_LOAD("swing", directions[i]);
        const double *d = scene->wisps->direction;
        /* the second is of denormal numbers of 1e-14 relative precision */
        cr_assert(fabs(d[0] - 0.6) <= 1e-13 && fabs(d[1] - 0.8) <= 1e-13 && d[2] == 0,
                  "%s: %.17g, %.17g", directions[i], d[0], d[1]);
        cr_assert(fabs(hypot(d[0], d[1]) - 1) <= 2.3e-16, "%s: of length %.17g", directions[i],
                  hypot(d[0], d[1]));
    }
}

Test(wisp_scenes, bodies_and_rates_are_read) {
    struct scene *scene =
        LAB_LOAD("swing-envelope", "contacts={ collision_rate = 600; }",
                 "body=({ name=\"head\"; center=[1, 2, 3]; radii=[4, 5, 6]; velocity=[7, 8, 9];"
                 "        friction=10; elasticity=1; offset=0; },"
                 "      " BALL ")");
    cr_assert(scene->body_count == 2 && scene->collision_rate == 600);
    const struct body *head = &scene->bodies[0], *ball = &scene->bodies[1];
    cr_assert(strcmp(head->name, "head") == 0 && strcmp(ball->name, "ball") == 0);
    for (int k = 0; k < 3; k++)
        cr_assert(head->centre[k] == 1 + k && head->radii[k] == 4 + k &&
                  head->velocity[k] == 7 + k);
    cr_assert(head->friction == 10 && head->elasticity == 1 && head->offset == 0);
    cr_assert(ball->velocity[0] == 0 && ball->velocity[1] == 0 && ball->velocity[2] == 0);
    cr_assert(ball->friction == 50 && ball->elasticity == 0.1 && ball->offset == 1e-4);
    scene = LAB_LOAD("swing-envelope", "contacts={ }");
    cr_assert(scene->body_count == 0 && scene->collision_rate == 300);
}

Test(wisp_scenes, set_works_into_groups_and_lists) {
    struct scene *scene = LAB_LOAD(
        "swing", "material.stretch_stiffness=1500", "material.bending=hinge", "wisps.[0].nodes=7",
        "wisps.[0].direction=[0.0, 2.0, 0.0]", "gravity=[0, 0, -1]",
        "wind={ kind=\"irregular\"; velocity=[1, 2, 3]; amplitudes=[0.5]; frequencies=[2]; }",
        "wind.frequencies=[3.5]", "envelope={ samples=5; }", "envelope.radius=0.03");
    const struct wisp *w = scene->wisps;
    cr_assert(w->stretch_stiffness == 1500 && w->bending == BENDING_HINGE && w->nodes == 7);
    cr_assert(w->direction[0] == 0 && w->direction[1] == 1 && w->direction[2] == 0);
    cr_assert(w->samples == 5 && w->radius == 0.03);
    cr_assert_eq(scene->around.gravity[2], -1);
    const struct wind *wind = &scene->around.wind;
    cr_assert(wind->kind == WIND_IRREGULAR && wind->velocity[2] == 3 && wind->terms == 1 &&
              wind->amplitude[0] == 0.5 && wind->frequency[0] == 3.5);

    static const struct {
        const char *set, *says[2];
    } bad[] = {
        {"wisps.[1].nodes=7", {"wisps.[1]"}},
        {"wisps.[0].nodes=2", {"nodes", "3"}},
        {"wisps.[0].colour=3", {"colour", "unknown"}},
        {"material.bending=foo", {"bending", "foo"}},
        {"material.drag_rate=fast", {"drag_rate", "number"}},
        {"wind.velocity=[1, 0, 0]", {"wind"}},
        {"envelope={ samples=17; }", {"samples", "16"}},
        {"body=()", {"body"}},
        {"wisps.nodes=7", {"no group wisps", "[0]"}},
        {"contacts={ collision_rate=1e18; interpenetration=false; collision=false; }",
         {"collision_rate", "1e15"}},
        {"contacts={ interaction_rate=1e18; interpenetration=false; collision=false; }",
         {"interaction_rate", "1e15"}},
        {"wisps=({ root=[0,0,0]; direction=[1,0,0]; length=1; nodes=11; grid=[1000, 1000]; "
         "spacing=1; across=([1,0,0],[0,1,0]); })",
         {"wisps", "1.1e+07 nodes"}},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        lab_refuse("swing", &bad[i].set, 1, bad[i].says, 2);
}

/* What runs where the user names nothing. */
Test(wisp_scenes, steppers_have_their_default_treatment_and_solver) {
    static const struct {
        const char *stepper, *treatment, *linear;
    } defaults[] = {
        {NULL, "generalised", NULL},        {"euler", "projection", NULL},
        {"midpoint", "generalised", NULL},  {"implicit-euler", "penalty", "cg"},
        {"cvode", "generalised", "direct"}, {"reference", "generalised", NULL},
    };
    struct scene *scene = lab_load("swing-envelope", NULL, 0);
    for (size_t i = 0; i < sizeof defaults / sizeof *defaults; i++) {
        const struct run_request request = {.stepper = defaults[i].stepper};
        const struct settings settings = settings_of(scene, &request);
        cr_assert_str_eq(treatment_names[settings.treatment], defaults[i].treatment);
        cr_assert_eq(settings.stepper.linear != NULL, defaults[i].linear != NULL);
        if (defaults[i].linear)
            cr_assert_str_eq(settings.stepper.linear->name, defaults[i].linear);
    }
}

/* What `run` says is in a scene. */
Test(wisp_scenes, terms_are_those_that_act) {
    static const struct {
        const char *scene, *set, *terms;
    } cases[] = {
        {"swing", "seed=1", "gravity|air|stretch|bending (skip springs)|"},
        {"swing-envelope", "seed=1", "gravity|air|stretch|bending (skip springs)|envelope|"},
        {"swing", "gravity=[0, 0, 0]", "air|stretch|bending (skip springs)|"},
        {"swing", "material.bending=hinge", "gravity|air|stretch|bending (hinges)|"},
        {"swing", "material.bending=none", "gravity|air|stretch|"},
        {"swing", "material.bending_stiffness=0", "gravity|air|stretch|"},
        {"swing", "material={ drag_rate=0; stretch_stiffness=0; bending=\"none\"; }", "gravity|"},
        {"swing", "wind={ kind=\"gust\"; velocity=[1, 0, 0]; hold=1; decay=1; }",
         "gravity|air|gust|stretch|bending (skip springs)|"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct scene *scene = LAB_LOAD(cases[i].scene, cases[i].set);
        const char *names[16];
        char all[200] = "";
        const int count = problem_terms(scene, names, 16);
        for (int k = 0; k < count; k++)
            strcat(strcat(all, names[k]), "|");
        cr_assert_str_eq(all, cases[i].terms, "%s: %s, not %s", cases[i].set, all, cases[i].terms);
        cr_assert_eq(problem_terms(scene, names, 1), 1, "more names than asked for");
    }
}
