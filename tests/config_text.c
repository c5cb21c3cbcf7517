/* What libconfig would read wrongly, or end the program at, is refused with its place; and what
 * only looks like it is not. */
#include "scene/config_text.h"

#include "scene/scene_load.h"
#include "support.h"

#include <criterion/criterion.h>
#include <string.h>

#define CIRCLE "problem = \"circle\"; duration = 1.0;\n"

static const struct {
    const char *text, *says[3];
} wrong[] = {
    /* 2^32 + 1 would be 1, and 2^31 the least of all */
    {CIRCLE "seed = 4294967297;", {":2:", "4294967297", "point"}},
    {CIRCLE "\nseed = 2147483648;", {":3:", "2147483648", "point"}},
    {CIRCLE "frame_rate = -4294967297;", {":2:", "4294967297", "point"}},
    {CIRCLE "seed = 0x100000001;", {":2:", "0x100000001", "decimals"}},
    {CIRCLE "seed = 99999999999999999999L;", {":2:", "99999999999999999999"}},
    {CIRCLE "/* 1 */ frame_rate = 10;seed=4294967297;", {":2:", "4294967297"}},
    {"\xef\xbb\xbf" CIRCLE, {":1:", "byte-order mark"}},
    {CIRCLE "name = \"caf\xe9\";", {":2:", "UTF-8", "0xe9"}},
    {CIRCLE "name = \"\xc0\xaf\";", {":2:", "UTF-8", "0xc0"}},
    {CIRCLE "name = \"\xed\xa0\x80\";", {":2:", "UTF-8", "0xed"}},
    {CIRCLE "name = \"\xf4\x90\x80\x80\";", {":2:", "UTF-8", "0xf4"}},
    {CIRCLE "name = \"caf\xc3", {":2:", "UTF-8", "0xc3"}},
    {CIRCLE "name = \"a\nb\nc", {":2:", "quote"}},
    {CIRCLE "seed = 2; /* or\n 3;\n", {":2:", "comment", "no end"}},
    {CIRCLE "seed = 3; # three", {":2:", "comment", "newline"}},
    {CIRCLE "@include \"/dev/null\"\n", {":2:", "/dev/null", "no such file beside"}},
    {CIRCLE "@include \"nowhere.inc\"\n", {":2:", "nowhere.inc", "no such file"}},
    {CIRCLE "  @include \".\"\n", {":2:", "\".\"", "folder"}},
    {CIRCLE "@include \"part.inc\"\n@include \"/\"\n", {":3:", "\"/\"", "folder"}},
    {CIRCLE "@include \"scene.cfg\"\n", {"scene.cfg:2:", "circle"}},
    {CIRCLE "@include \"ring.inc\"\n", {"ring.inc:1:", "circle"}},
    {CIRCLE "@include \"long.inc\"\n", {"long.inc:3:", "4294967297"}},
};

static const char *const right[] = {
    CIRCLE,
    CIRCLE "seed = 2147483647;",
    CIRCLE "seed = 4294967297.0;",
    CIRCLE "seed = 4294967297L;",
    CIRCLE "seed = 4.294967297e+9;",
    CIRCLE "seed = 0x7fffffff;",
    CIRCLE "name = \"4294967297 /* # // \\\" \\\\\";",
    CIRCLE "name = \"caf\xc3\xa9 \xe2\x82\xac \xf0\x9f\x92\x87\";",
    CIRCLE "# caf\xe9 4294967297 \"\n// \" /*\n/* \" 4294967297 @include */ seed = 2;",
    CIRCLE "@include \"part.inc\"\n",
    CIRCLE "seed = 3",
    "problem = \"circle\";\r\nduration = 1.0;\r\n",
};

static char *folder;

static void open_folder(void) {
    folder = folder_make();
    file_write(folder, "part.inc", "run = { step = 0.5; };\n");
    file_write(folder, "ring.inc", "@include \"ring.inc\"\n");
    file_write(folder, "long.inc", "\n\nseed = 4294967297;\n");
}

Test(config_text, what_libconfig_would_not_say_is_refused, .init = open_folder) {
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        const char *const path = file_write(folder, "scene.cfg", wrong[i].text);
        lab_refuse(path, NULL, 0, (const char *[]){folder}, 1);
        lab_refuse(path, NULL, 0, wrong[i].says, 3);
    }
}

Test(config_text, what_only_looks_like_it_is_taken, .init = open_folder) {
    for (size_t i = 0; i < sizeof right / sizeof *right; i++) {
        lab_load(file_write(folder, "scene.cfg", right[i]), NULL, 0);
    }
}

/* A folder is no file, wherever it stands. */
Test(config_text, a_folder_is_no_scene, .init = open_folder) {
    lab_refuse(printed("%s/", folder), NULL, 0, (const char *[]){"is a folder"}, 1);
}

/* What --set gives goes through the same. */
Test(config_text, so_is_a_value_that_is_set) {
    static const struct {
        const char *set, *says;
    } sets[] = {
        {"seed=4294967297", "4294967297: too long"},
        {"name=\"caf\xe9\"", "UTF-8"},
        {"name=caf\xe9", "UTF-8"},
        {"name=\"cafe", "closing quote"},
        {"seed=1;\n@include \"/\"\n", "folder"},
    };
    for (size_t i = 0; i < sizeof sets / sizeof *sets; i++)
        lab_refuse("circle", &sets[i].set, 1, (const char *[]){sets[i].says, "--set"}, 2);
}
