/* wisplab export: frames for other tools. */
#include "base/complain.h"
#include "base/files.h"
#include "cli.h"
#include "picture/usd.h"
#include "picture/vtk.h"

static const struct cli_option options[] = {
    {"vtk", "DIR", "folder for .vtp files of each frame and .pvd files that name them", 0},
    {"usd", "DIR", "folder for a .usda: wisps as curves, bodies as spheres, all frames", 0},
    {0},
};

/* Writes every format that was asked for. */
static int write_formats(const struct arguments *arguments, const struct frames *f, char *reason) {
    const char *vtk = argument_text(arguments, "vtk"), *usd = argument_text(arguments, "usd");
    char name[80];
    plain_name(f->scene->name, name, sizeof name);
    if ((vtk && make_folder(vtk, reason)) || (usd && make_folder(usd, reason)))
        return 2;
    int code = vtk ? vtk_write(f, vtk, name, reason) : 0;
    if (vtk && !code)
        say("%s/%s*.pvd: %d frames of %d wisps", vtk, name, f->count, f->wisp_count);
    if (usd && !code)
        code = usd_write(f, usd, name, reason);
    if (usd && !code)
        say("%s/%s.usda: %d frames of %d wisps", usd, name, f->count, f->wisp_count);
    return code;
}

static int export(const struct arguments *arguments) {
    char states[PATH_SIZE], reason[REASON_SIZE];
    struct frames frames;
    if (!argument_given(arguments, "vtk") && !argument_given(arguments, "usd"))
        return complain(1, "export: say --vtk DIR, --usd DIR or both");
    if (!frames_path(arguments->words[0], states))
        return complain(1, "export: %.100s is neither a file of states nor the folder of a run",
                        arguments->words[0]);
    int code = frames_open(&frames, states, NULL, NULL, 0, reason);
    if (!code)
        code = write_formats(arguments, &frames, reason);
    if (code)
        complain(code, "%s", reason);
    frames_close(&frames);
    return code;
}

const struct command export_command = {
    .name = "export",
    .usage = "STATES --vtk DIR | --usd DIR",
    .summary = "frames for ParaView and other tools",
    .details =
        "STATES is a states.tsv or states.npy with its run.json beside it, or the folder of both.\n"
        "Each frame becomes .vtp files (VTK's XML, binary): wisps as lines with velocity (m/s),\n"
        "strain and radius (m) at the nodes; with an envelope also their surfaces, and the hairs\n"
        "that pictures show; and the bodies as meshes. Each line has its wisp and the parent that\n"
        "it split off from. In ParaView open SCENE.pvd, SCENE-envelopes.pvd, SCENE-hairs.pvd and\n"
        "SCENE-bodies.pvd.\n"
        "\n"
        "--usd writes one .usda with all frames, in metres: wisps as BasisCurves with widths, and\n"
        "bodies as Spheres that are scaled to ellipsoids.\n"
        "\n"
        "  wisplab run sphere --out sphere\n"
        "  wisplab export sphere/states.tsv --vtk sphere/vtk\n",
    .options = options,
    .words_least = 1,
    .words_most = 1,
    .run = export,
};
