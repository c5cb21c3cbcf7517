/* Scene files: to a scene, what it warns of and how it would be run, or to one line. */
#include "fuzz.h"
#include "run/settings.h"
#include "run/warnings.h"
#include "scene/scene_load.h"

#include <string.h>

/* A start stands beside it: two wisps of three nodes, without an envelope. */
static const char start[] = "t\twisp\tnode\tx\ty\tz\tvx\tvy\tvz\tparent\n"
                            "0\t0\t0\t0\t0\t0\t0\t0\t0\t0\n0\t0\t1\t0.1\t0\t0\t0\t0\t0\t0\n"
                            "0\t0\t2\t0.2\t0\t0\t0\t0\t0\t0\n";
static const char part[] = "name = \"part\";\n";

/* So do scenes to build on: a chain of two with the start, and two that go in a circle. */
static const char lower[] =
    "duration = 0.1; frame_rate = 10.0; gravity = [0.0, -9.81, 0.0];\n"
    "material = { stretch_stiffness = 80.0; stretch_time = 1.0e-4; };\n"
    "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0]; length = 0.2; nodes = 3; } "
    ");\n"
    "wind = { kind = \"gust\"; velocity = [1.0, 0.0, 0.0]; hold = 1.0; decay = 1.0; };\n";
static const char upper[] = "base = \"lower.cfg\"; start = \"start.tsv\";\n@include \"part.inc\"\n"
                            "run = { step = 1.0e-3; };\n";
static const char ring[] = "base = \"scene.cfg\"; material = { };\n";

/* Lines at the beginning that say `# set: path=value` override settings. */
static int take_sets(char *text, const char **sets, int most) {
    static const char mark[] = "# set: ";
    int count = 0;
    while (count < most && strncmp(text, mark, strlen(mark)) == 0 && strchr(text, '\n')) {
        sets[count++] = text + strlen(mark);
        text = strchr(text, '\n') + 1;
        text[-1] = '\0';
    }
    return count;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char reason[REASON_SIZE] = "", head[1024];
    const char *sets[4];
    snprintf(head, sizeof head, "%.*s", (int)(size < 1000 ? size : 1000), (const char *)data);
    const int count = take_sets(head, sets, 4);
    struct settings settings;
    static int there;
    if (!there++) {
        fuzz_file("start.tsv", (const uint8_t *)start, strlen(start));
        fuzz_file("part.inc", (const uint8_t *)part, strlen(part));
        fuzz_file("lower.cfg", (const uint8_t *)lower, strlen(lower));
        fuzz_file("upper.cfg", (const uint8_t *)upper, strlen(upper));
        fuzz_file("ring.cfg", (const uint8_t *)ring, strlen(ring));
    }
    struct scene *scene = scene_load(fuzz_file("scene.cfg", data, size), sets, count, reason);
    if (!scene) {
        fuzz_refusal(reason);
        return 0;
    }
    json_decref(scene_warnings(scene, NULL));
    if (settings_resolve(scene, &(struct run_request){.step = 0}, &settings, reason))
        fuzz_refusal(reason);
    json_t *source = json_incref(scene->source);
    scene_free(scene);
    scene = scene_from_json(source, "run.json", NULL, 0, reason); /* as run.json gives it back */
    if (!scene)
        fuzz_refusal(reason);
    scene_free(scene);
    json_decref(source);
    return 0;
}
