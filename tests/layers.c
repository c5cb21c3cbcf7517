/* No folder includes or calls one above it: layers.sh looks, at this tree and at small ones that
 * are wrong. */
#include "support.h"

#include <criterion/criterion.h>
#include <stdlib.h>
#include <string.h>

static struct finished *look(const char *tree, const char *objects) {
    return shell("'%s/layers.sh' '%s' '%s'", WISPLAB_TESTS_DIR, tree, objects);
}

static void write_source(const char *tree, const char *folder, const char *name, const char *text) {
    char reason[REASON_SIZE];
    const char *const path = printed("%s/%s", tree, folder);
    cr_assert_eq(make_folder(path, reason), 0, "%s", reason);
    file_write(path, name, text);
}

Test(layers, no_folder_includes_or_calls_one_above_it) {
    SHELL("%s/layers.sh %s/.. %s/CMakeFiles", WISPLAB_TESTS_DIR, WISPLAB_TESTS_DIR,
          WISPLAB_BUILD_DIR);
}

/* A small tree of three layers, and the same with one include in the wrong direction. */
Test(layers, an_include_upwards_is_found) {
    for (int wrong = 0; wrong <= 1; wrong++) {
        const char *const tree = folder_make();
        write_source(tree, "src/base", "files.c",
                     wrong ? "#include \"model/scene.h\"\n" : "#include \"files.h\"\n");
        write_source(tree, "src/model", "scene.c", "#include \"base/files.h\"\n");
        write_source(tree, "integrators", "rk4.c", "#include \"system/system.h\"\n");
        write_source(tree, "experiments", "circle.c", "#include \"experiments/common/plan.h\"\n");
        const struct finished *f = look(tree, "");
        cr_expect_eq(f->code != 0, wrong, "%s", f->out);
        cr_expect_eq(
            strstr(f->out, "src/base/files.c: includes src/model/scene.h, which is above") != NULL,
            wrong, "%s", f->out);
    }
}

/* Calls too, by the symbols of what was compiled: here `lower`, of base, uses `upper` of model. */
Test(layers, a_call_upwards_is_found) {
    const char *const tree = folder_make();
    write_source(tree, "src/base", "lower.c",
                 "int upper(void); int lower(void) { return upper(); }");
    write_source(tree, "src/model", "upper.c", "int upper(void) { return 1; }");
    write_source(tree, "integrators", "rk4.c", "#include \"system/system.h\"\n");
    write_source(tree, "experiments", "circle.c", "");
    write_source(tree, "objects/wisplab-core.dir/src/base", "x", "");
    write_source(tree, "objects/wisplab-core.dir/src/model", "x", "");
    SHELL("cd '%s' && for f in src/base/lower src/model/upper; do"
          " cc -c $f.c -o objects/wisplab-core.dir/$f.c.o || exit 1; done",
          tree);
    const struct finished *f = look(tree, printed("%s/objects", tree));
    cr_expect(f->code != 0 && strstr(f->out, "src/base/lower.c: uses upper of src/model/upper.c"),
              "%s", f->out);
}
