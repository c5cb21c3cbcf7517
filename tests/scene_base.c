/* Scenes that build on others: they are what one file would be that says the same, and what is
 * wrong is said where it stands. */
#include "base/hash.h"
#include "model/problems.h"
#include "run/identity.h"
#include "scene/scene_load.h"
#include "scene/scene_settings.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char *folder;

static void open_folder(void) {
    folder = folder_make();
}

static struct scene *load(const char *name, const char *text) {
    return lab_load(file_write(folder, name, text), NULL, 0);
}

/* `says` of two parts, or one and NULL. */
static void refuse(const char *text, const char *const *says) {
    lab_refuse(file_write(folder, "scene.cfg", text), NULL, 0, says, 2);
}

static void expect_same(const char *text, const char *spelled_out) {
    char hash[HASH_SIZE], expected[HASH_SIZE];
    const struct scene *scene = load("scene.cfg", text), *same = load("scene.cfg", spelled_out);
    scene_hash(scene, hash);
    scene_hash(same, expected);
    cr_expect_str_eq(hash, expected, "another scene than\n%s\nis\n%s", spelled_out, text);
    cr_expect_str_eq(scene->name, same->name);
}

#define COMMON "duration = 0.1; frame_rate = 10.0; gravity = [0.0, -9.81, 0.0];\n"
#define WISP   "root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0]; nodes = 4;"

/* A scene of three files: groups are merged, lists are not. */
Test(scene_base, is_what_one_file_would_be, .init = open_folder) {
    char reason[REASON_SIZE];
    const char *const below = printed("%s/below", folder);
    cr_assert_eq(make_folder(below, reason), 0, "%s", reason);
    file_write(below, "first.cfg",
               "name = \"first\";\n" COMMON "material = { drag_rate = 2.0; hair_count = 10.0; };\n"
               "wisps = ( { length = 0.1; " WISP " }, { length = 0.2; " WISP " } );\n"
               "run = { step = 1.0e-3; };\n");
    file_write(below, "second.cfg",
               "base = \"first.cfg\";\nmaterial = { drag_rate = 3.0; };\nenvelope = { };\n");
    expect_same("base = \"below/second.cfg\";\nwisps = ( { length = 0.3; " WISP " } );\n"
                "envelope = { radius = 0.01; };\nrun = { rtol = 1.0e-5; };\n",
                COMMON "material = { drag_rate = 3.0; hair_count = 10.0; };\n"
                       "envelope = { radius = 0.01; };\nwisps = ( { length = 0.3; " WISP " } );\n"
                       "run = { step = 1.0e-3; rtol = 1.0e-5; };\n");
    expect_same("base = \"below/first.cfg\"; name = \"mine\";",
                "name = \"mine\";" COMMON "material = { drag_rate = 2.0; hair_count = 10.0; };\n"
                "wisps = ( { length = 0.1; " WISP " }, { length = 0.2; " WISP " } );\n"
                "run = { step = 1.0e-3; };\n");
}

/* A shipped scene is built upon by its name, wherever the file is. */
Test(scene_base, may_be_a_shipped_scene, .init = open_folder) {
    char hash[HASH_SIZE], expected[HASH_SIZE];
    scene_hash(LAB_LOAD("swing", "duration=0.5"), expected);
    scene_hash(load("mine.cfg", "base = \"swing\"; name = \"swing\"; duration = 0.5;"), hash);
    cr_assert_str_eq(hash, expected);
    const struct scene *scene = load("mine.cfg", "base = \"swing\"; duration = 0.5;");
    cr_assert_str_eq(scene->name, "mine", "not its own name but %s", scene->name);
}

/* What goes with a choice of a base goes with it where that is made otherwise. */
Test(scene_base, choices_take_with_them_what_goes_with_them, .init = open_folder) {
    static const char gust[] = COMMON
        "material = { stretch_stiffness = 80.0; stretch_time = 1.0e-4; };\n"
        "wisps = ( { length = 0.1; " WISP " } );\n"
        "wind = { kind = \"gust\"; velocity = [1.0, 0.0, 0.0]; hold = 1.0; decay = 1.0; };\n";
    file_write(folder, "gust.cfg", gust);
    expect_same("base = \"gust.cfg\"; wind = { kind = \"steady\"; };"
                "material = { stretch = \"rigid\"; };",
                COMMON "material = { stretch = \"rigid\"; };\n"
                       "wisps = ( { length = 0.1; " WISP " } );\n"
                       "wind = { kind = \"steady\"; velocity = [1.0, 0.0, 0.0]; };\n");
    /* but not what the file says itself */
    refuse("base = \"gust.cfg\";\nwind = { kind = \"steady\";\nhold = 2.0; };",
           WORDS("scene.cfg:3: hold: goes with kind = \"gust\""));
}

/* A start is beside the file that says it. */
Test(scene_base, starts_are_beside_the_file_that_names_them, .init = open_folder) {
    cr_assert(load("mine.cfg", "base = \"wind\"; duration = 0.1;")->start.rows);
    refuse("base = \"wind\";\nstart = \"wind-start.tsv\";", WORDS("scene.cfg:2: start: "));
}

Test(scene_base, what_is_wrong_is_said_where_it_stands, .init = open_folder) {
    static const struct {
        const char *text, *says[2];
    } wrong[] = {
        {"base = \"nowhere.cfg\";", {"scene.cfg:1: base: \"nowhere.cfg\": there is no such file"}},
        {"\nbase = \"nowhere\";", {"scene.cfg:2: base: \"nowhere\": there is no such shipped"}},
        {"base = \"scene.cfg\";", {"scene.cfg:1: base: \"scene.cfg\": goes in a circle"}},
        {"base = \"ring.cfg\";", {"other-ring.cfg:1: base: \"ring.cfg\"", "circle"}},
        {"base = \"level.cfg\";", {"other-ring.cfg:1: base: \"ring.cfg\"", "circle"}},
        {"base = \".\";", {"scene.cfg:1: base: ", "no such file"}},
        {"base = \"./\";", {"scene.cfg:1: base: ", "regular"}},
        {"base = \"/dev/zero\";", {"scene.cfg:1: base: ", "regular"}},
        {"base = \"\";", {"scene.cfg:1: base: must be a text"}},
        {"base = 3;", {"scene.cfg:1: base: must be a text"}},
        {"base = \"syntax.cfg\";", {"syntax.cfg:2: syntax error"}},
        {"base = \"wrong.cfg\";", {"wrong.cfg:3: drag_rate: -4 is not a number from 0 on, in 1/s"}},
        {"base = \"part.cfg\";", {"part.inc:2: drag_rate"}},
        {"base = \"wrong.cfg\"; material = {\ndrag_rate = -5.0; };",
         {"scene.cfg:2: drag_rate: -5"}},
        {"base = \"wrong.cfg\"; material = { drag_rate = 5.0; };\n\n",
         {"scene.cfg:2: wisps: missing"}},
        {"base = \"wrong.cfg\"; material = { drag_rat = 5.0; };",
         {"scene.cfg:1: drag_rat: unknown setting; did you mean drag_rate?"}},
    };
    file_write(folder, "ring.cfg", "\nbase = \"other-ring.cfg\";");
    file_write(folder, "other-ring.cfg", "base = \"ring.cfg\";");
    file_write(folder, "level.cfg", "base = \"ring.cfg\";");
    file_write(folder, "syntax.cfg", "duration = 1.0;\n = 3;\n");
    file_write(folder, "wrong.cfg", COMMON "material = {\ndrag_rate = -4.0; };\n");
    file_write(folder, "part.cfg", COMMON "@include \"part.inc\"\n");
    file_write(folder, "part.inc", "material = {\ndrag_rate = -4.0; };\n");
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        refuse(wrong[i].text, wrong[i].says);
}

/* A long chain is no circle. */
Test(scene_base, chains_may_be_long, .init = open_folder) {
    const char *path = file_write(folder, "0.cfg",
                                  COMMON "material = { }; wisps = ( { length = 0.1; " WISP " } );");
    for (int i = 1; i <= 100; i++)
        path = file_write(folder, printed("%d.cfg", i),
                          printed("base = \"%d.cfg\"; seed = %d;", i - 1, i));
    cr_assert_eq(lab_load(path, NULL, 0)->seed, 100);
}

/* Neither --set nor a run.json can name a base. */
Test(scene_base, is_said_by_files_alone, .init = open_folder) {
    LAB_REFUSE("swing", "base=swing", "base: is said by a scene's file alone");
}

/* --- the hashes that results are kept by --- */

/* A scene that is meant to be another one gets another hash here, and all its results are made
 * again. Anything else that changes one of these throws away what users have computed. */
static const char *const hashes[][2] = {
    {"anjyo", "bb4ec03379ad4757"},          {"circle", "ad6879fadbed346b"},
    {"interactions", "f89f101e5e6d2bb3"},   {"parting", "7114d9b54419c571"},
    {"radii", "1a074b6aa4157ee7"},          {"rosenblum", "f263e942ae008e03"},
    {"shake", "8741d881dbf1c570"},          {"sphere", "e39562e707d39a6b"},
    {"subdivision", "b05fb94d7482105f"},    {"swing-64", "e76eb90cba3fae46"},
    {"swing-envelope", "34bbc87123637220"}, {"swing-shaken", "833eab595e00575c"},
    {"swing", "7184edb28efdff5b"},          {"treatments", "f73d259b30a764d7"},
    {"viscosity", "5c64f08559d63d85"},      {"wind-parted", "2ef53baeac22cd4b"},
    {"wind-settle", "9a172cd639242086"},    {"wind", "74b94a53782ec762"},
};

Test(scene_base, shipped_scenes_keep_their_hashes) {
    for (size_t i = 0; i < sizeof hashes / sizeof *hashes; i++) {
        char hash[HASH_SIZE];
        struct scene *scene = lab_load(hashes[i][0], NULL, 0);
        scene_hash(scene, hash);
        cr_expect_str_eq(hash, hashes[i][1], "%s: %s", hashes[i][0], hash);
    }
}

/* --- the table --- */

/* Each row says all that pages and messages are made of, and is there once; what it goes with and
 * its group are rows too, before it. */
Test(scene_base, rows_of_the_table_are_whole) {
    for (const struct scene_setting *s = scene_settings; s->name; s++) {
        const struct scene_setting *group = setting_find("", s->group);
        char path[100], text[REASON_SIZE], name[40] = "";
        setting_path(s, path, sizeof path);
        cr_expect_eq(setting_find(s->group, s->name), s, "%s is there twice", path);
        cr_expect(s->meaning && strlen(s->meaning) > 8, "%s means nothing", path);
        cr_expect(s->problems != 0 && (s->problems & ~(unsigned)OF_ALL) == 0, "%s", path);
        cr_expect(!*s->group || strchr(s->group, '.') || (group && group < s), "%s: no group",
                  path);
        if (s->with)
            snprintf(name, sizeof name, "%.*s", (int)strcspn(s->with + (*s->with == '!'), "="),
                     s->with + (*s->with == '!'));
        cr_expect(!s->with || (setting_find(s->group, name) && setting_find(s->group, name) < s),
                  "%s goes with %s", path, name);
        setting_right(s, text, sizeof text);
        cr_expect(strlen(text) + strlen(path) < REASON_SIZE / 2, "%s is too long", text);
    }
    const struct scene_setting *problem = setting_find("", "problem");
    for (int i = 0; problems[i] || problem->choices[i]; i++)
        cr_assert(problems[i] && problem->choices[i] &&
                      strcmp(problems[i]->name, problem->choices[i]) == 0,
                  "problem %d", i);
}

/* A default that is told is the one that holds: a scene that says it is the same, in numbers. */
Test(scene_base, told_defaults_hold) {
    static const char everything[] = "contacts={}",
                      wind[] = "wind={kind=\"steady\"; velocity=[1.0, 0.0, 0.0];}";
    int count = 0;
    for (const struct scene_setting *s = scene_settings; s->name; s++) {
        char path[100];
        if (!s->initial || !*s->initial || !(s->problems & OF_WISPS) || strchr(s->group, '.') ||
            strcmp(s->group, "body") == 0 || strcmp(s->group, "wisps") == 0)
            continue;
        setting_path(s, path, sizeof path);
        const char *const set = printed("%s=%s", path, s->initial);
        struct scene *plain = LAB_LOAD("swing-envelope", "material={}", "envelope={}", everything,
                                       wind, "run={}", "subdivision={}", "render={}");
        struct scene *told = LAB_LOAD("swing-envelope", "material={}", "envelope={}", everything,
                                      wind, "run={}", "subdivision={}", "render={}", set);
        cr_expect(memcmp(plain->wisps, told->wisps, sizeof *plain->wisps) == 0, "%s", set);
        cr_expect(memcmp(&plain->run, &told->run, sizeof plain->run) == 0, "%s", set);
        cr_expect(memcmp(&plain->interaction, &told->interaction, sizeof plain->interaction) == 0,
                  "%s", set);
        cr_expect(memcmp(&plain->subdivision, &told->subdivision, sizeof plain->subdivision) == 0,
                  "%s", set);
        cr_expect(memcmp(&plain->render, &told->render, sizeof plain->render) == 0, "%s", set);
        cr_expect(plain->begin == told->begin && plain->seed == told->seed &&
                      plain->collision_rate == told->collision_rate &&
                      plain->problem == told->problem,
                  "%s", set);
        count++;
    }
    cr_expect_gt(count, 30, "only %d defaults", count);
}

/* Every number that must be in a range is refused beside it, and taken at its ends where they are
 * in it; the message tells the range and the unit. */
Test(scene_base, ranges_are_kept_at_their_ends) {
    int count = 0;
    for (const struct scene_setting *s = scene_settings; s->name; s++) {
        const struct setting_range *r = &s->range;
        char path[100], right[REASON_SIZE];
        if (s->type != SETTING_NUMBER || !isfinite(r->least) || s->problems == OF_ANJYO ||
            strcmp(s->group, "body") == 0 || strchr(s->group, '.') || s->with)
            continue;
        setting_path(s, path, sizeof path);
        setting_right(s, right, sizeof right);
        const double outside[] = {r->above ? r->least : r->least - 1,
                                  r->below ? r->most : r->most + 1};
        for (int k = 0; k < 2; k++) {
            const char *sets[] = {"envelope={}", "contacts={}", "subdivision={}", "render={}",
                                  printed("%s=%.17e", path, outside[k])};
            if (isfinite(outside[k]))
                lab_refuse("swing-envelope", sets, 5, (const char *[]){right, s->unit}, 2);
        }
        count++;
    }
    cr_expect_gt(count, 25, "only %d ranges", count);
}
