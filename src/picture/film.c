#include "film.h"

#include "plot.h"
#include "run/program.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int cannot_write(const char *path, char *reason) {
    snprintf(reason, REASON_SIZE, "%.150s: cannot write: %s", path, strerror(errno));
    return 2;
}

/* Names that are numbers for the pictures, and what plots/film.gp has to know. */
static int prepare(const struct film *film, const char *drawing, char *reason) {
    char path[PATH_SIZE];
    for (int i = 0; i < film->count; i++) {
        char *picture = realpath(film->pictures[i], NULL);
        path_format(path, "%s/%06d.png", drawing, i + 1);
        const int bad = !picture || symlink(picture, path);
        free(picture);
        if (bad)
            return cannot_write(path, reason);
    }
    path_format(path, "%s/page.gp", drawing);
    FILE *file = fopen(path, "w");
    if (!file)
        return cannot_write(path, reason);
    fprintf(file, "WIDTH = %d; HEIGHT = %d; pictures = %d; delay = %.0f\n", film->width,
            film->height, film->count, fmax(1, round(100 / film->rate)));
    return fclose(file) ? cannot_write(path, reason) : 0;
}

/* Whether ffmpeg is there and has made a film. Its pictures have even sides. */
static int encode(const struct film *film, const char *drawing, const char *to) {
    char pictures[PATH_SIZE], rate[32];
    snprintf(rate, sizeof rate, "%.6g", film->rate);
    if (path_format(pictures, "%s/%%06d.png", drawing))
        return 0;
    const char *const argv[] = {"ffmpeg",
                                "-nostdin",
                                "-loglevel",
                                "error",
                                "-y",
                                "-framerate",
                                rate,
                                "-i",
                                pictures,
                                "-vf",
                                "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white",
                                "-pix_fmt",
                                "yuv420p",
                                to,
                                NULL};
    const int nothing = open("/dev/null", O_WRONLY | O_CLOEXEC);
    int status, out_of_time;
    const int error = program_finish(argv, &(struct run_limits){.seconds = 0},
                                     &(struct program_words){-1, nothing}, &status, &out_of_time);
    if (nothing >= 0)
        close(nothing);
    return !error && status == 0 && file_exists(to);
}

int film_write(const struct film *film, const char *folder, const char *name, int *mp4,
               char *reason) {
    char drawing[PATH_SIZE], gif[PATH_SIZE], movie[PATH_SIZE], to[PATH_SIZE], none[REASON_SIZE];
    *mp4 = 0;
    if (temporary_folder(folder, drawing, reason))
        return 2;
    path_format(gif, "%s/film.gif", drawing);
    path_format(movie, "%s/film.mp4", drawing);
    int code = prepare(film, drawing, reason);
    if (!code && plot_draw("film", drawing, drawing, NULL, "gif", reason))
        code = 2;
    if (!code && (path_format(to, "%s/%s.gif", folder, name) || file_put(gif, to)))
        code = cannot_write(to, reason);
    if (!code && encode(film, drawing, movie))
        *mp4 = path_format(to, "%s/%s.mp4", folder, name) == 0 && file_put(movie, to) == 0;
    plot_empty_folder(drawing, NULL, none);
    return code;
}
