/* run.json: how a run went, whether it is as it was written, and the scene and frames of its states
 * beside it. */
#include "base/hash.h"
#include "fuzz.h"
#include "picture/frames.h"
#include "run/results.h"
#include "run/seal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Of one wisp, in two frames. */
static const char states[] =
    "t\twisp\tnode\tx\ty\tz\tvx\tvy\tvz\tr0\trd0\tr1\trd1\tr2\trd2\tparent\n"
    "0\t0\t0\t0\t0\t0\t0\t0\t0\t0.02\t0\t0.02\t0\t0.02\t0\t0\n"
    "0\t0\t1\t0.1\t0\t0\t0\t0\t0\t0.02\t0\t0.02\t0\t0.02\t0\t0\n"
    "0\t0\t2\t0.2\t0\t0\t0\t0\t0\t0.02\t0\t0.02\t0\t0.02\t0\t0\n"
    "0.1\t0\t0\t0\t0\t0\t0\t0\t0\t0.02\t0\t0.02\t0\t0.02\t0\t0\n"
    "0.1\t0\t1\t0.1\t0\t0\t0\t0\t0\t0.02\t0\t0.02\t0\t0.02\t0\t0\n"
    "0.1\t0\t2\t0.2\t0\t0\t0\t0\t0\t0.02\t0\t0.02\t0\t0.02\t0\t0\n";

static void look_at_frames(const char *path) {
    static const double axes[4][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}};
    char reason[REASON_SIZE] = "";
    double most[4] = {0};
    struct frames frames;
    if (frames_open(&frames, path, NULL, NULL, 0, reason))
        fuzz_refusal(reason);
    else
        frames_extent(&frames, axes, most);
    frames_close(&frames);
}

/* What is sealed holds, once written and read. */
static void seal_anew(json_t *json, const char *folder) {
    char reason[REASON_SIZE] = "", hash[HASH_SIZE];
    hash_bytes(states, strlen(states), hash);
    seal_add(json, json_pack("{s:s}", "states.tsv", hash));
    char *text = json_dumps(json, JSON_REAL_PRECISION(17));
    fuzz_file("run.json", (const uint8_t *)text, strlen(text));
    free(text);
    if (seal_holds(folder, reason))
        return;
    fprintf(stderr, "a seal that was just made does not hold: %s\n", reason);
    abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char reason[REASON_SIZE] = "", path[PATH_SIZE], folder[PATH_SIZE];
    struct run_files run;
    path_format(path, "%s", fuzz_file("states.tsv", (const uint8_t *)states, strlen(states)));
    path_format(folder, "%.*s", (int)(strrchr(path, '/') - path), path);
    fuzz_file("run.json", data, size);
    if (!seal_holds(folder, reason))
        fuzz_refusal(reason);
    if (run_read_states(&run, folder, NULL, reason)) {
        fuzz_refusal(reason);
    } else {
        run_number(&run, "counters.steps");
        run_cpu_time(&run);
        seal_anew(run.json, folder);
        run_free(&run);
    }
    look_at_frames(path);
    return 0;
}
