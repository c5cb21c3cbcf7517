/* No folder includes or calls one above it: layers.sh looks, at this tree and at small ones that
 * are wrong. */
#include "support.h"

#include <criterion/criterion.h>
#include <stdlib.h>
#include <string.h>

/* What the script says of a tree, for free; its exit code. */
static char *look(const char *tree, const char *objects, int *code) {
    char folder[PATH_SIZE], path[PATH_SIZE], command[4 * PATH_SIZE];
    folder_make(folder);
    path_format(path, "%s/said", folder);
    snprintf(command, sizeof command, "'%s/layers.sh' '%s' '%s' >'%s' 2>&1", WISPLAB_TESTS_DIR,
             tree, objects, path);
    *code = system(command);
    char *said = file_text(path);
    cr_assert(said, "the script says nothing");
    folder_remove(folder);
    return said;
}

static void write_source(const char *tree, const char *folder, const char *name, const char *text) {
    char path[PATH_SIZE], reason[REASON_SIZE];
    path_format(path, "%s/%s", tree, folder);
    cr_assert_eq(make_folder(path, reason), 0, "%s", reason);
    file_write(path, name, text, NULL);
}

Test(layers, no_folder_includes_or_calls_one_above_it) {
    int code;
    char *said = look(WISPLAB_TESTS_DIR "/..", WISPLAB_BUILD_DIR "/CMakeFiles", &code);
    cr_expect_eq(code, 0, "%s", said);
    free(said);
}

/* A small tree of three layers, and the same with one include in the wrong direction. */
Test(layers, an_include_upwards_is_found) {
    for (int wrong = 0; wrong <= 1; wrong++) {
        char tree[PATH_SIZE];
        int code;
        folder_make(tree);
        write_source(tree, "src/base", "files.c",
                     wrong ? "#include \"model/scene.h\"\n" : "#include \"files.h\"\n");
        write_source(tree, "src/model", "scene.c", "#include \"base/files.h\"\n");
        write_source(tree, "integrators", "rk4.c", "#include \"system/system.h\"\n");
        write_source(tree, "experiments", "circle.c", "#include \"experiments/common/plan.h\"\n");
        char *said = look(tree, "", &code);
        cr_expect_eq(code != 0, wrong, "%s", said);
        cr_expect_eq(strstr(said, "src/base/files.c: includes src/model/scene.h, which is above") !=
                         NULL,
                     wrong, "%s", said);
        free(said);
        folder_remove(tree);
    }
}

/* Calls too, by the symbols of what was compiled: here `lower`, of base, uses `upper` of model. */
Test(layers, a_call_upwards_is_found) {
    char tree[PATH_SIZE], command[4 * PATH_SIZE];
    int code;
    folder_make(tree);
    write_source(tree, "src/base", "lower.c",
                 "int upper(void); int lower(void) { return upper(); }");
    write_source(tree, "src/model", "upper.c", "int upper(void) { return 1; }");
    write_source(tree, "integrators", "rk4.c", "#include \"system/system.h\"\n");
    write_source(tree, "experiments", "circle.c", "");
    write_source(tree, "objects/wisplab-core.dir/src/base", "x", "");
    write_source(tree, "objects/wisplab-core.dir/src/model", "x", "");
    snprintf(command, sizeof command,
             "cd '%s' && for f in src/base/lower src/model/upper; do"
             " cc -c $f.c -o objects/wisplab-core.dir/$f.c.o || exit 1; done",
             tree);
    cr_assert_eq(system(command), 0);
    path_format(command, "%s/objects", tree);
    char *said = look(tree, command, &code);
    cr_expect(code != 0 && strstr(said, "src/base/lower.c: uses upper of src/model/upper.c"), "%s",
              said);
    free(said);
    folder_remove(tree);
}
