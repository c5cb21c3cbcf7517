/* wisplab export: frames for other tools. */
#include "base/complain.h"
#include "base/files.h"
#include "cli.h"
#include "picture/vtk.h"

static const struct cli_option options[] = {
    {"vtk", "DIR", "folder for a .vtp of each frame and a .pvd that names them all", 0},
    {0},
};

static int export(const struct arguments *arguments) {
    const char *folder = argument_text(arguments, "vtk");
    char states[PATH_SIZE], reason[REASON_SIZE], name[80];
    struct frames frames;
    if (!folder)
        return complain(1, "export: --vtk DIR is missing; it is the one format there is");
    if (!frames_path(arguments->words[0], states))
        return complain(1, "export: %.100s is neither a file of states nor the folder of a run",
                        arguments->words[0]);
    int code = frames_open(&frames, states, NULL, NULL, 0, reason);
    if (!code && make_folder(folder, reason))
        code = 2;
    if (!code) {
        plain_name(frames.scene->name, name, sizeof name);
        code = vtk_write(&frames, folder, name, reason);
    }
    if (code)
        complain(code, "%s", reason);
    else
        say("%s/%s.pvd: %d frames of %d wisps", folder, name, frames.count, frames.wisp_count);
    frames_close(&frames);
    return code;
}

const struct command export_command = {
    .name = "export",
    .usage = "STATES --vtk DIR",
    .summary = "frames for ParaView and other tools",
    .details =
        "STATES is a states.tsv or states.npy with its run.json beside it, or the folder of both.\n"
        "Each frame becomes a .vtp (VTK's XML of lines, as text) with velocity (m/s), strain and\n"
        "radius (m) at the nodes, and each line's wisp and the parent that it split off from; the\n"
        ".pvd is what to open in ParaView.\n"
        "\n"
        "  wisplab run sphere --out sphere\n"
        "  wisplab export sphere/states.tsv --vtk sphere/vtk\n",
    .options = options,
    .words_least = 1,
    .words_most = 1,
    .run = export,
};
