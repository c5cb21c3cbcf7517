/* From a run's files to pictures of it, and to files for other tools. */
#include "base/table.h"
#include "base/vector.h"
#include "command/cli.h"
#include "picture/strip.h"
#include "picture/usd.h"
#include "picture/vtk.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* --- runs to be drawn, written by hand --- */

static const char *const two_wisps =
    "wisps=({root=[0.0,0.0,0.0];direction=[0.0,-1.0,0.0];length=0.3;nodes=4;},"
    "{root=[0.1,0.0,0.0];direction=[0.0,-1.0,0.0];length=0.3;nodes=5;})";

static struct scene *scene_of(const char *set) {
    return lab_load("swing-envelope", &set, 1);
}

/* What a run of that scene has in its run.json, as far as pictures want it. */
static void write_run(const char *folder, const struct scene *scene, const char *status) {
    json_t *json = json_pack("{s:s, s:{s:s, s:s}, s:O}", "status", status, "settings", "stepper",
                             "rk4", "treatment", "generalised", "scene", scene->source);
    cr_assert_eq(json_dump_file(json, printed("%s/run.json", folder), JSON_REAL_PRECISION(17)), 0);
    json_decref(json);
}

/* A row: wisps hang from their roots, each `lean` m off in x at its tip, and r = R. */
static void write_wisp(FILE *file, double t, int index, int parent, const struct wisp *wisp,
                       double lean) {
    for (int i = 0; i < wisp->nodes; i++) {
        const double part = i < 2 ? 0 : (double)i / (wisp->nodes - 1);
        fprintf(file, "%.17g\t%d\t%d", t, index, i);
        for (int k = 0; k < 3; k++)
            fprintf(file, "\t%.17g",
                    wisp->root[k] + i * wisp_spacing(wisp) * wisp->direction[k] +
                        (k == 0) * part * lean);
        fprintf(file, "\t1\t2\t%.17g", (double)i);
        for (int j = 0; j < wisp->samples; j++)
            fprintf(file, "\t%.17g\t0", wisp->radius);
        fprintf(file, "\t%d\n", parent);
    }
}

static FILE *begin_states(const char *folder, int samples) {
    FILE *file = fopen(printed("%s/states.tsv", folder), "w");
    cr_assert(file);
    fputs("# states at the frames\nt\twisp\tnode\tx\ty\tz\tvx\tvy\tvz", file);
    for (int j = 0; j < samples; j++)
        fprintf(file, "\tr%d\trd%d", j, j);
    fputs("\tparent\n", file);
    return file;
}

/* `count` frames of the scene's wisps, whose tips lean `lean` m further in each. */
static void write_frames_of(const char *folder, const struct scene *scene, int count, double lean) {
    write_run(folder, scene, "finished");
    FILE *file = begin_states(folder, scene->wisps[0].samples);
    for (int frame = 0; frame < count; frame++)
        for (int i = 0; i < scene->wisp_count; i++)
            write_wisp(file, frame / 30., i, i, &scene->wisps[i], frame * lean);
    fclose(file);
}

/* The same in a folder of its own. */
static const char *write_frames(const struct scene *scene, int count, double lean) {
    const char *const folder = folder_make();
    write_frames_of(folder, scene, count, lean);
    return folder;
}

static void open_frames(struct frames *frames, const char *folder) {
    char reason[REASON_SIZE];
    cr_assert_eq(frames_open(frames, printed("%s/states.tsv", folder), NULL, NULL, 0, reason), 0,
                 "%s", reason);
}

static struct camera camera_at(const struct scene *scene, double width, double height) {
    const double upwards[3] = {0, 1, 0};
    const double most[4] = {0, 0, 0, 0.4};
    struct camera camera = camera_make(&scene->render, upwards, width, height);
    camera_fit(&camera, &scene->render, most);
    return camera;
}

/* --- reading --- */

Test(render, frames_are_read_back_with_their_scene) {
    struct scene *scene = scene_of(two_wisps);
    struct frames frames;
    const char *const folder = write_frames(scene, 3, 0.01);
    open_frames(&frames, folder);
    cr_expect_str_eq(frames.run, "rk4 generalised");
    cr_expect_str_eq(frames.scene->name, "swing-envelope");
    cr_assert_eq(frames.count, 3);
    cr_assert_eq(frames_wisps(&frames, 3), 2);
    cr_expect_eq(frames_time(&frames, 2), 1 / 30.);
    struct strand *strand = lab_strand(&frames.wisps[1], frames.treatment);
    frames_load(&frames, 3, 1, strand);
    cr_expect_eq(strand->p[4][1], -0.3);
    cr_expect_float_eq(strand->p[4][0], 0.1 + 2 * 0.01, 1e-15);
    cr_expect_eq(strand->v[4][2], 4);
    cr_expect_eq(strand->r[4 * 4 + 3], 0.02);
    frames_close(&frames);
}

/* A run of this program, every treatment: what was written is what is read. */
Test(render, frames_of_a_run_are_its_states) {
    static const char *const treatments[] = {"projection", "penalty", "generalised"};
    const char *const folder = folder_make();
    for (int i = 0; i < 3; i++) {
        struct frames frames;
        WORKS("run", "swing-envelope", "--duration", "0.1", "--treatment", treatments[i], "--out",
              folder);
        open_frames(&frames, folder);
        cr_assert_eq(frames.count, 4);
        cr_expect_eq(frames.treatment == WISP_PENALTY, i == 1);
        struct strand *strand = lab_strand(&frames.wisps[0], frames.treatment);
        frames_load(&frames, 4, 0, strand);
        const int row = frames.states->table.row_count - 1;
        for (int k = 0; k < 3; k++)
            cr_expect_eq(strand->p[10][k], table_value(&frames.states->table, row, 3 + k));
        for (int j = 0; j < 4; j++) { /* by another way: e - p, or r itself */
            double e[3];
            for (int k = 0; k < 3; k++)
                e[k] = i == 1 ? table_value(&frames.states->table, row, 9 + 6 * j + k)
                              : strand->e[40 + j][k];
            vector_add(e, -1, strand->p[10]);
            const double r =
                i == 1 ? strand->r[40 + j] : table_value(&frames.states->table, row, 9 + 2 * j);
            cr_expect(fabs(vector_length(e) - r) < 1e-4 && r > 0.01, "sample %d: %g", j, r);
        }
        frames_close(&frames);
    }
}

/* Text of a good states.tsv of four-node wisps, and what may be wrong with one. */
static const struct {
    const char *text, *instead, *says;
} spoilt[] = {
    {"\tx\ty\tz\tvx", "\tx\tz\ty\tvx", "column 5 is 'z'; in states of this scene it is y"},
    {"0.033333333333333333\t1\t2\t", "0.033333333333333333\t1\t3\t",
     "frame 2: row 16 is wisp 1, node 3 at 0.0333333 s, where wisp 1, node 2 at"},
    {"0.033333333333333333\t1\t0\t", "0.033333333333333333\t2\t0\t",
     "frame 2: row 14 is wisp 2, node 0 at 0.0333333 s, where wisp 1, node 0 at"},
    {"0.033333333333333333\t0\t0\t", "0\t0\t0\t", "where wisp 2, node 0 at 0 s should be"},
    {"\n0\t0\t3\t", "\n-1\t0\t3\t",
     "frame 1: row 4 is wisp 0, node 3 at -1 s, where wisp 0, node 3 at 0 s"},
    {"\t1\t2\t1\t", "\t1\tnan\t1\t", "row 2 (t = 0 s, wisp 0, node 1): vy is not a finite number"},
    {"\t1\t2\t1\t", "\tinf\t2\t1\t", "is not a finite number"},
    {"\t1\t2\t1\t", "\t1\tx\t1\t", "not a number"},
    {"\t1\t2\t1\t", "\t1\t2\t", "fewer numbers"},
    {"# states at the frames\n", "\n", "not a number"},
};

/* Replaces the first `text`, or returns NULL. */
static char *replace(const char *whole, const char *text, const char *instead) {
    const char *at = strstr(whole, text);
    char *changed = test_room(strlen(whole) + strlen(instead) + 1);
    if (!at || !changed)
        return NULL;
    sprintf(changed, "%.*s%s%s", (int)(at - whole), whole, instead, at + strlen(text));
    return changed;
}

/* The command refuses the folder's states in one line, and writes nothing. */
static void refused(const char *folder, const char *says) {
    struct stat status;
    const char *const out = printed("%s/out", folder);
    for (int i = 0; i < 2; i++) {
        if (i == 0)
            FAILS(1, says, "render", folder, "--out", out);
        else
            FAILS(1, says, "export", printed("%s/states.tsv", folder), "--vtk", out);
        cr_expect(stat(out, &status) != 0, "something was written");
    }
}

Test(render, states_that_are_not_right_are_refused_in_one_line) {
    struct scene *scene = scene_of(two_wisps);
    const char *const folder = write_frames(scene, 2, 0.01);
    char *good = file_read(printed("%s/states.tsv", folder));
    for (size_t i = 0; i < sizeof spoilt / sizeof *spoilt; i++) {
        char *bad = replace(good, spoilt[i].text, spoilt[i].instead);
        cr_assert(bad, "'%s' is not in the file", spoilt[i].text);
        file_write(folder, "states.tsv", bad);
        refused(folder, spoilt[i].says);
    }
    char *cut = strrchr(good, '\t'); /* within the last line, and a line from the end */
    *cut = '\0';
    file_write(folder, "states.tsv", good);
    refused(folder, "the last line is not complete");
    strrchr(good, '\n')[1] = '\0';
    file_write(folder, "states.tsv", good);
    refused(folder, "frame 2, the last, is not complete");
    write_frames_of(folder, scene, 1, 0);
    struct scene *other = scene_of("envelope={samples=3;}");
    write_run(folder, other, "finished");
    refused(folder, "has 17 columns besides parent; states of wisps with 3 samples have 15");
    file_write(folder, "run.json", "{\"status\":\"finished\"}");
    refused(folder, "has no scene");
    file_write(folder, "run.json", "{");
    refused(folder, "run.json: line");
    unlink(printed("%s/run.json", folder));
    refused(folder, "has no run.json beside it");
}

/* A run that was ended in the middle of a frame: what is whole is drawn. */
Test(render, the_whole_frames_of_a_failed_run_are_kept) {
    struct scene *scene = scene_of(two_wisps);
    struct frames frames;
    const char *const folder = write_frames(scene, 3, 0.01);
    char *text = file_read(printed("%s/states.tsv", folder));
    text[strlen(text) - 1] = '\0';
    strrchr(text, '\n')[1] = '\0';
    file_write(folder, "states.tsv", text);
    write_run(folder, scene, "out of time");
    open_frames(&frames, folder);
    cr_expect_eq(frames.count, 2);
    cr_expect_str_eq(frames.run, "rk4 generalised (out of time)");
    frames_close(&frames);
}

static const struct {
    const char *words[10];
    const char *says;
} wrong[] = {
    {{"--frames", "9"}, "there is no frame 9; there are frames 1 to 2"},
    {{"--frames", "0"}, "there is no frame 0"},
    {{"--frames", "2-1"}, "as 1,6,10 or 1-31"},
    {{"--frames", "1,"}, "as 1,6,10"},
    {{"--frames", ""}, "--frames needs a value"},
    {{"--frames", "1,x"}, "as 1,6,10"},
    {{"--frames", "1-"}, "as 1,6,10"},
    {{"--frames", "99999999999999999999"}, "there is no frame"},
    {{"--size", "big"}, "--size big: must be two whole numbers from 64 to 8192"},
    {{"--size", "640x"}, "--size"},
    {{"--size", "640x480x3"}, "--size"},
    {{"--size", "640x1"}, "--size"},
    {{"--size", "99999x99999"}, "--size"},
    {{"--columns", "0"}, "--columns"},
    {{"--rate", "1e300"}, "--rate 1e+300: must be from 0.01 to 1000"},
    {{"--rate", "1e-300"}, "--rate 1e-300: must be from"},
    {{"--set", "render={hairs=100000; pieces=11;}"}, "100000 hairs of 11 pieces"},
    {{"--columns", "1.5"}, "--columns"},
    {{"--format", "gif"}, "png, svg"},
    {{"--film", "--strip"}, "--film"},
    {{"--style"}, "no style field"},
    {{"--section", "x"}, "--section x: must be the number of a node, or of wisp and node"},
    {{"--section", "1"}, "wisp 0 has no free node 1, but nodes 2 to 3"},
    {{"--section", "2:2"}, "there is no wisp 2; there are wisps 0 to 1"},
    {{"--section", "3", "--skeleton"}, "leave out --skeleton"},
    {{"--set", "render={hairs=-1;}"}, "hairs"},
    {{"--error", "nowhere"}, "nowhere"},
    {{"--error", "nowhere.tsv"}, "nowhere.tsv: no such file"},
};

/* And the size that is named fits. */
Test(render, a_page_that_is_no_png_is_refused_with_what_would_do) {
    char size[32] = "8192x8192";
    struct stat status;
    const char *const folder = write_frames(scene_of(two_wisps), 6, 0.01);
    const char *const out = printed("%s/out", folder);
    const struct finished *f = FAILS(1, "49188 x 8252 pixels", "render", folder, "--strip",
                                     "--bodies", "--size", size, "--out", out);
    cr_assert(stat(out, &status) != 0, "something was written");
    const char *named = strstr(f->err, "--size ");
    cr_assert(named && sscanf(named, "--size %31[0-9x]", size) == 1 &&
                  strcmp(size, "8192x8192") != 0,
              "%s", f->err);
    WORKS("render", folder, "--strip", "--bodies", "--frames", "1-6", "--size", size, "--columns",
          "6", "--out", out);
}

Test(render, wrong_commands_are_refused_in_one_line) {
    struct scene *scene = scene_of(two_wisps);
    struct stat status;
    const char *const folder = write_frames(scene, 2, 0.01);
    const char *const out = printed("%s/out", folder);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        const char *words[20] = {"render", folder, "--out", out};
        for (int k = 0; wrong[i].words[k]; k++)
            words[4 + k] = wrong[i].words[k];
        program_must(NULL, 1, wrong[i].says, words);
        cr_expect(stat(out, &status) != 0, "%s: something was written", wrong[i].words[0]);
    }
    FAILS(1, "no wisps", "render", "circle", "--out", out);
    FAILS(1, "nowhere.tsv: no such file", "export", "nowhere.tsv", "--vtk", out);
    FAILS(1, "--vtk", "export", folder);
    FAILS(1, "neither a file of states nor the folder", "export", "circle", "--vtk", out);
    WORKS("export", folder, "--vtk", out);
    cr_expect_eq(count_files(out, ".pvd"), 3, "of a folder");
}

/* Two pictures of one frame would be one file, by two threads. */
Test(render, a_frame_is_drawn_once) {
    struct scene *scene = scene_of(two_wisps);
    const char *const folder = write_frames(scene, 3, 0.01);
    const char *const out = printed("%s/out", folder);
    struct finished *f = WORKS("render", folder, "--frames", "2,1-2,1,2-3", "--size", "64x64",
                               "--threads", "2", "--out", out);
    cr_assert(strstr(f->out, "3 pictures"), "%s%s", f->out, f->err);
    cr_expect_eq(count_files(out, ".png"), 3);
}

/* --- making a picture --- */

static void draw(struct picture *picture, const struct frames *frames, unsigned views, int frame,
                 int width, int height) {
    struct drawing drawing;
    drawing_create(&drawing, frames, views);
    drawing.camera = camera_at(frames->scene, width, height);
    picture_draw(picture, &drawing, frame);
    drawing_free(&drawing);
}

/* --- wisps that split --- */

/* Wisp 0 splits after frame 1, its twin 1 after frame 2 and 0 again: parents are those that the
 * file names, though by their places 2 and 3 would be each other's twin's, and all hairs are drawn
 * in every frame, each once. */
Test(render, children_have_their_parents_hair) {
    static const double lean[3][4] = {{0}, {0.02, -0.02}, {0.021, -0.02, 0.022, -0.021}};
    static const int parent[4] = {0, 0, 1, 0};
    struct scene *scene =
        scene_of("wisps=({root=[0.0,0.0,0.0];direction=[0.0,-1.0,0.0];length=0.3;nodes=4;})");
    struct frames frames;
    const char *const folder = folder_make();
    write_run(folder, scene, "finished");
    FILE *file = begin_states(folder, 4);
    for (int frame = 0; frame < 3; frame++)
        for (int i = 0; i < 1 << frame; i++)
            write_wisp(file, frame / 30., i, parent[i], &scene->wisps[0], lean[frame][i]);
    fclose(file);
    open_frames(&frames, folder);
    cr_assert_eq(frames.wisp_count, 4);
    cr_expect_eq(frames.parent[1], 0);
    cr_expect_eq(frames.parent[2], 1);
    cr_expect_eq(frames.parent[3], 0);
    cr_expect_eq(frames.born[1], 2);
    cr_expect_eq(frames.born[3], 3);
    for (int frame = 1; frame <= 3; frame++) {
        struct picture picture;
        draw(&picture, &frames, VIEW_HAIR, frame, 320, 240);
        const size_t count = picture.layer[LAYER_HAIR].count;
        cr_expect(count > 500 && count <= 50 * 3 * 4, "frame %d: %zu segments", frame, count);
        picture_free(&picture);
        for (int hair = 0; hair < 50; hair++) {
            int owners = 0, first = 0, second = 0;
            for (int i = 0; i < frames_wisps(&frames, frame); i++) {
                owners += hair_share_has(frames_share(&frames, frame, i), hair);
                if (i % 3 == 0) /* 0 and its child 3 have what 0 had before */
                    first += hair_share_has(frames_share(&frames, frame, i), hair);
                else
                    second += hair_share_has(frames_share(&frames, frame, i), hair);
            }
            cr_assert_eq(owners, 1, "frame %d: hair %d is drawn %d times", frame, hair, owners);
            if (frame == 3)
                cr_assert(first == hair_share_has(frames_share(&frames, 2, 0), hair) &&
                          second == hair_share_has(frames_share(&frames, 2, 1), hair));
        }
    }
    frames_close(&frames);
}

/* --- what is drawn --- */

/* Frames in which nothing moves have the same hair, and all of it is there. */
Test(render, still_hair_is_the_same_in_every_frame) {
    struct scene *scene = scene_of(two_wisps);
    struct frames frames;
    struct picture first, second;
    const char *const folder = write_frames(scene, 2, 0);
    open_frames(&frames, folder);
    draw(&first, &frames, VIEW_HAIR, 1, 320, 240);
    draw(&second, &frames, VIEW_HAIR, 2, 320, 240);
    const struct layer *a = &first.layer[LAYER_HAIR], *b = &second.layer[LAYER_HAIR];
    cr_expect(a->count > 50 * 0.9 * (3 + 4) * 4 - 50 && a->count <= 50 * (3 + 4) * 4,
              "%zu segments", a->count);
    cr_assert_eq(a->count, b->count);
    cr_expect_eq(memcmp(a->segments, b->segments, a->count * sizeof *a->segments), 0);
    picture_free(&first);
    picture_free(&second);
    frames_close(&frames);
}

/* What a run that diverged leaves: what is near is drawn, and all numbers are such as gnuplot
 * reads. */
Test(render, a_wisp_that_flew_apart_is_drawn_as_far_as_it_is_seen) {
    struct scene *scene = scene_of(two_wisps);
    for (int power = 3; power <= 300; power += 27) {
        struct frames frames;
        struct picture picture;
        const char *const folder = write_frames(scene, 2, pow(10, power));
        open_frames(&frames, folder);
        struct render_settings *render = &frames.scene->render; /* across the way it flies */
        render->has_eye = render->has_target = 1;
        render->eye[2] = 1;
        draw(&picture, &frames, VIEW_HAIR | VIEW_SKELETON | VIEW_ENVELOPE, 2, 320, 240);
        cr_expect(picture.layer[LAYER_HAIR].count > 0, "1e%d m: nothing is seen", power);
        for (int k = 0; k < LAYER_COUNT; k++)
            for (size_t i = 0; i < picture.layer[k].count; i++) {
                const struct segment *s = &picture.layer[k].segments[i];
                cr_assert(fabsf(s->x) < 1e6f && fabsf(s->y) < 1e6f && fabsf(s->dx) < 1e6f &&
                              fabsf(s->dy) < 1e6f && isfinite(s->depth),
                          "1e%d m: a segment at %g, %g", power, (double)s->x, (double)s->y);
            }
        picture_free(&picture);
        frames_close(&frames);
    }
}

/* A ball before the first wisp hides it all, and nothing of the second; behind, nothing. */
Test(render, hair_behind_a_body_is_not_drawn) {
    static const double depth[2] = {1, -1};
    struct scene *scene = scene_of(two_wisps);
    size_t count[3];
    for (int i = 0; i < 3; i++) {
        struct frames frames;
        struct picture picture;
        const char *const folder = write_frames(scene, 1, 0);
        open_frames(&frames, folder);
        struct body ball = {.radii = {0.2, 0.2, 0.2}};
        const struct camera camera = camera_at(frames.scene, 320, 240);
        const double middle[3] = {0, -0.15, 0};
        for (int k = 0; k < 3 && i < 2; k++)
            ball.centre[k] = middle[k] + depth[i] * 0.5 * (camera.eye[k] - middle[k]);
        if (i < 2) {
            frames.scene->bodies = malloc(sizeof ball);
            memcpy(frames.scene->bodies, &ball, sizeof ball);
            frames.scene->body_count = 1;
        }
        draw(&picture, &frames, VIEW_HAIR, 1, 320, 240);
        count[i] = picture.layer[LAYER_HAIR].count;
        picture_free(&picture);
        frames_close(&frames);
    }
    cr_expect(count[2] > 1000 && count[1] == count[2], "behind: %zu of %zu", count[1], count[2]);
    cr_expect(count[0] < count[2], "before: %zu of %zu", count[0], count[2]);
}

/* --- the style field --- */

/* The arrows of a field; the caller frees the picture. */
static const struct layer *arrows(struct picture *picture, const char *style) {
    struct scene *scene = scene_of(style);
    struct frames frames;
    const char *const folder = write_frames(scene, 1, 0);
    open_frames(&frames, folder);
    draw(picture, &frames, VIEW_STYLE, 1, 320, 240);
    frames_close(&frames);
    return &picture->layer[LAYER_STYLE];
}

Test(render, arrows_of_a_uniform_field_are_parallel) {
    struct picture picture;
    const struct layer *layer =
        arrows(&picture, "style={ times=[0.0]; accelerations=([1.0,2.0,-9.0]); }");
    cr_assert_eq(layer->count, 63);
    for (size_t i = 0; i < layer->count; i++) {
        const struct segment *s = &layer->segments[i];
        cr_expect(s->dx == layer->segments->dx && s->dy == layer->segments->dy, "arrow %zu", i);
        cr_expect(hypot(s->dx, s->dy) > 5);
    }
    picture_free(&picture);
}

/* On both sides of the plane they point away from it. */
Test(render, arrows_of_a_parting_point_to_both_sides) {
    struct picture picture;
    const struct layer *layer = arrows(
        &picture, "style={ times=[0.0]; accelerations=([0.0,0.0,0.0]); parting={ width=1e-3; "
                  "origin=[0.0,0.0,0.0]; normal=[1.0,0.0,0.0]; accelerations=([3.0,0.0,0.0]); }; "
                  "}");
    int sides[2] = {0, 0};
    for (size_t i = 0; i < layer->count; i++)
        sides[layer->segments[i].dx > 0]++;
    cr_expect(sides[0] >= 20 && sides[1] >= 20, "%d and %d arrows", sides[0], sides[1]);
    for (size_t i = 0; i < layer->count; i++)
        for (size_t j = 0; j < layer->count; j++) {
            const struct segment *a = &layer->segments[i], *b = &layer->segments[j];
            cr_assert(!(a->dx < 0 && b->dx > 0 && a->y == b->y && a->x > b->x),
                      "arrows point at each other");
        }
    picture_free(&picture);
}

/* --- a plane --- */

/* Of six samples the first is at half of its distance, and takes along what hairs have of it:
 * between lines at 60 degrees a place (x, y) has x - |y| / sqrt 3 of the middle one. */
Test(render, a_plane_shows_samples_and_hairs) {
    struct scene *scene = scene_of("envelope={ samples=6; }");
    struct frames frames;
    struct drawing drawing;
    struct picture picture;
    const char *const folder = write_frames(scene, 1, 0);
    open_frames(&frames, folder);
    frames.states->table.value[3 * frames.states->table.column_count + 9] = 0.01;
    drawing_create(&drawing, &frames, VIEW_PLANE);
    drawing.camera = camera_at(frames.scene, 320, 240);
    drawing.plane = (struct plane_view){.wisp = 0, .node = 3, .extent = 0.02};
    picture_draw(&picture, &drawing, 1);
    const struct layer *layer = picture.layer;
    const double reach = 0.46 * 240;
    cr_assert(layer[LAYER_SAMPLES].count == 6 && layer[LAYER_STYLE].count == 6);
    for (int j = 0; j < 6; j++) {
        const struct segment *s = &layer[LAYER_SAMPLES].segments[j];
        const double r = j == 0 ? reach / 2 : reach;
        cr_expect_float_eq(s->x, 160 + r * cos(2 * M_PI * j / 6), 1e-3);
        cr_expect_float_eq(s->y, 120 + r * sin(2 * M_PI * j / 6), 1e-3);
    }
    cr_assert_eq(layer[LAYER_NODES].count, 50);
    for (int i = 0; i < 50; i++) {
        const double *place = drawing.hairs[0]->place[i * drawing.hairs[0]->nodes + 3];
        const struct segment *is = &layer[LAYER_NODES].segments[i],
                             *way = &layer[LAYER_HAIR].segments[i];
        const double back = reach / 2 * fmax(0, place[0] - fabs(place[1]) / sqrt(3));
        cr_expect_float_eq(is->x, 160 + reach * place[0] - back, 1e-3);
        cr_expect_float_eq(is->y, 120 + reach * place[1], 1e-3);
        cr_expect_float_eq(way->x, 160 + reach * place[0], 1e-3);
        cr_expect_float_eq(way->dx, -back, 1e-3);
        cr_expect_float_eq(way->dy, 0, 1e-3);
    }
    picture_free(&picture);
    drawing_free(&drawing);
    frames_close(&frames);
}

/* With a reference colour is the distance from it: 0 at the root, all of it at the tip. */
Test(render, the_error_is_the_distance_from_the_reference) {
    struct scene *scene = scene_of(two_wisps);
    struct frames frames, reference;
    struct drawing drawing;
    struct picture picture;
    const char *const folder = write_frames(scene, 2, 0);
    const char *const other = write_frames(scene, 2, 0.006);
    open_frames(&frames, folder);
    open_frames(&reference, other);
    drawing_create(&drawing, &frames, VIEW_SKELETON);
    drawing.camera = camera_at(scene, 320, 240);
    drawing.reference = &reference;
    picture_draw(&picture, &drawing, 2);
    const struct layer *nodes = &picture.layer[LAYER_NODES];
    int tips = 0, still = 0;
    cr_assert_eq(nodes->count, 4 + 5);
    for (size_t i = 0; i < nodes->count; i++) {
        tips += fabs(nodes->segments[i].error - 0.006) < 1e-9;
        still += nodes->segments[i].error == 0;
    }
    cr_expect(tips == 2 && still == 4, "%d tips, %d that stand", tips, still);
    picture_free(&picture);
    picture_draw(&picture, &drawing, 1); /* of the frame that they have in common */
    for (size_t i = 0; i < nodes->count; i++)
        cr_expect_eq(nodes->segments[i].error, 0);
    picture_free(&picture);
    drawing_free(&drawing);
    frames_close(&frames);
    frames_close(&reference);
}

/* --- files --- */

/* Width and height as the file itself says them. */
static void png_size(const char *path, long size[2]) {
    unsigned char head[24] = {0};
    FILE *file = fopen(path, "rb");
    cr_assert(file && fread(head, 1, 24, file) == 24 && memcmp(head + 1, "PNG", 3) == 0, "%s",
              path);
    fclose(file);
    for (int i = 0; i < 2; i++)
        size[i] = head[16 + 4 * i] * 16777216L + head[17 + 4 * i] * 65536L +
                  head[18 + 4 * i] * 256L + head[19 + 4 * i];
}

Test(render, pictures_have_the_size_that_was_asked_for) {
    struct scene *scene = scene_of(two_wisps);
    long size[2];
    const char *const folder = write_frames(scene, 3, 0.01);
    const char *const out = printed("%s/out", folder);
    WORKS("render", folder, "--frames", "1-2,3", "--size", "401x303", "--film", "--out", out);
    png_size(printed("%s/swing-envelope-0003.png", out), size);
    cr_expect(size[0] == 401 && size[1] == 303, "%ld x %ld", size[0], size[1]);
    char *gif = file_read(printed("%s/swing-envelope.gif", out));
    cr_expect(gif && strncmp(gif, "GIF89a", 6) == 0);
    cr_expect_eq(count_files(out, "png"), 3);
    cr_expect_eq(count_files(out, "drawing"), 0, "something was left behind");
}

/* Pictures that are there are whole, and nothing else is. */
Test(render, an_interruption_leaves_whole_pictures) {
    struct scene *scene = scene_of(two_wisps);
    const char *const folder = write_frames(scene, 300, 0.0001);
    const char *const out = printed("%s/out", folder);
    const struct process process = program_start(
        NULL, WORDS("render", folder, "--frames", "all", "--size", "900x600", "--out", out));
    for (int i = 0; i < 1000 && count_files(out, "-0001.png") < 1; i++)
        wait_for(0.01);
    kill(process.pid, SIGTERM);
    struct finished *f = program_wait(&process);
    must_have_failed(f, 3, "interrupted");
    const int pictures = count_files(out, ".png");
    cr_expect(pictures > 0 && pictures < 300, "%d pictures", pictures);
    cr_expect_eq(count_files(out, ""), pictures, "something else was left");
}

/* Rows, columns and a bar of colours, in the words of an svg. */
Test(render, a_strip_says_what_it_shows) {
    struct scene *scene = scene_of(two_wisps);
    static const char *const says[] = {"swing-envelope", "rk4 generalised", "frame 1, 0.000 s",
                                       "frame 2, 0.033 s", "distance from the reference, m"};
    const char *const folder = write_frames(scene, 2, 0.01);
    const char *const other = write_frames(scene, 3, 0.02);
    const char *const out = printed("%s/out", folder);
    WORKS("render", folder, other, "--skeleton", "--frames", "1,2", "--format", "svg", "--error",
          other, "--out", out);
    char *svg = file_read(printed("%s/swing-envelope-strip.svg", out));
    cr_assert(svg);
    for (size_t i = 0; i < sizeof says / sizeof *says; i++)
        cr_expect(strstr(svg, says[i]), "no '%s'", says[i]);
}

/* Runs beside each other have their names above them; a large frame has its own caption, and is not
 * among the others. */
Test(render, a_strip_shows_runs_beside_each_other_and_one_frame_large) {
    struct scene *scene = scene_of(two_wisps);
    const char *const folder = write_frames(scene, 3, 0.01);
    const char *const other = write_frames(scene, 3, 0.02);
    const char *const out = printed("%s/out", folder);
    const char *const path = printed("%s/swing-envelope-strip.svg", out);
    WORKS("render", folder, other, "--skeleton", "--frames", "1,2", "--format", "svg", "--beside",
          "--out", out);
    char *svg = file_read(path);
    cr_expect_eq(count_of(svg, "rk4 generalised, 0.000 s"), 2);
    cr_expect_eq(count_of(svg, "rk4 generalised, 0.033 s"), 2);
    WORKS("render", folder, "--skeleton", "--frames", "1,2", "--format", "svg", "--large", "3",
          "--out", out);
    svg = file_read(path);
    cr_expect(strstr(svg, "<svg width=\"1006\" height=\"566\"") != NULL, "%.300s", svg);
    cr_expect(strstr(svg, "<svg x=\"0\" y=\"54\" width=\"674\" height=\"506\"") != NULL,
              "what is large is not");
    cr_expect_eq(count_of(svg, "frame 3, 0.067 s"), 1);
    cr_expect_eq(count_of(svg, "frame 2, 0.033 s"), 1);
    FAILS(1, "there is no frame 4", "render", folder, "--skeleton", "--large", "4", "--out", out);
}

/* The scale of colours ends with the next power of ten, or where a run has diverged with what whole
 * hair of 30 cm can be off. */
Test(render, the_scale_of_errors_ends_with_a_power_of_ten) {
    static const struct {
        double tip;
        const char *least, *most, *beyond;
    } cases[] = {{0.002, "10⁻⁶", "10⁻²", "10⁻¹"}, {1e30, "10⁻⁴", "10⁰", "10³⁰"}};
    struct scene *scene = scene_of(two_wisps);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *const folder = write_frames(scene, 2, cases[i].tip);
        WORKS("render", folder, "--skeleton", "--frames", "1,2", "--strip", "--format", "svg",
              "--error", write_frames(scene, 2, 0), "--out", folder);
        const char *svg = file_of(folder, "swing-envelope-strip.svg");
        cr_expect(strstr(svg, cases[i].least) && strstr(svg, cases[i].most) &&
                      !strstr(svg, cases[i].beyond),
                  "not from %s to %s", cases[i].least, cases[i].most);
    }
}

/* The palest where the two are one, and what is far away darker. */
Test(render, colour_tells_the_distance) {
    struct scene *scene = scene_of(two_wisps);
    const char *const folder = write_frames(scene, 2, 0.08);
    const char *const other = write_frames(scene, 2, 0);
    const char *const out = printed("%s/out", folder);
    WORKS("render", folder, "--skeleton", "--frames", "1,2", "--strip", "--format", "svg",
          "--error", other, "--out", out);
    char *svg = file_read(printed("%s/swing-envelope-strip.svg", out)),
         *second = strstr(strstr(svg, "overflow") + 1, "overflow");
    cr_assert(second);
    cr_expect(strstr(svg, "stroke=\"#f2c14e\"") < second, "what is nowhere off is not pale");
    for (char *at = svg; (at = strstr(at, "stroke=\"#")) && at < second; at++)
        cr_expect_eq(strncmp(at, "stroke=\"#f2c14e", 15), 0, "frame 1: %.16s", at);
    cr_expect(strstr(second, "stroke=\"#18088a\"") != NULL, "no tip is as far off as it is");
}

/* --- other tools --- */

/* The numbers of an array of a file, which stand behind their length where the document says. */
static const char *appended(const char *file, const char *name) {
    const char *array = strstr(file, printed("Name=\"%s\"", name)),
               *data = strstr(file, "encoding=\"raw\"");
    cr_assert(array && data, "no %s", name);
    return strchr(data, '_') + 1 +
           strtol(strstr(array, "offset=\"") + strlen("offset=\""), NULL, 10);
}

/* Every state is in the files to the last bit. */
Test(render, exported_frames_have_all_bits) {
    char reason[REASON_SIZE];
    struct scene *scene = scene_of(two_wisps);
    struct frames frames;
    const char *const folder = write_frames(scene, 2, 0.0123456789012345);
    open_frames(&frames, folder);
    cr_assert_eq(vtk_write(&frames, folder, "name", reason), 0, "%s", reason);
    char *text = file_read(printed("%s/name-0002.vtp", folder));
    cr_assert(text);
    static const struct {
        const char *name;
        int first;
    } arrays[] = {{"position", 3}, {"velocity", 6}};
    for (int a = 0; a < 2; a++) {
        const char *at = appended(text, arrays[a].name);
        unsigned long long bytes;
        memcpy(&bytes, at, sizeof bytes);
        cr_assert_eq(bytes, (4 + 5) * 3 * sizeof(double));
        at += sizeof bytes;
        for (int row = frames.first_row[1]; row < frames.states->table.row_count; row++)
            for (int k = 0; k < 3; k++, at += sizeof(double)) {
                const double x = table_value(&frames.states->table, row, arrays[a].first + k);
                cr_assert_eq(memcmp(at, &x, sizeof x), 0, "%s, row %d", arrays[a].name, row);
            }
    }
    text = file_read(printed("%s/name.pvd", folder));
    cr_expect(text && strstr(text, "timestep=\"0.03333333333333333\"") &&
              strstr(text, "file=\"name-0002.vtp\""));
    frames_close(&frames);
}

/* VTK's own reader, where Debian's python3-vtk9 is installed, which is for Debian's python3. Bodies
 * are closed and have their outside outside: their volume by Gauss's theorem is nearly an
 * ellipsoid's. A hair starts in its wisp's first plane, and an envelope is as wide as it is. */
static const char *const reader =
    "import sys\n"
    "try:\n"
    "    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader\n"
    "except ImportError:\n"
    "    sys.exit(42)\n"
    "import xml.etree.ElementTree as tree, os, math\n"
    "folder = sys.argv[1]\n"
    "def second(name):\n"
    "    sets = tree.parse(folder + '/' + name + '.pvd').getroot().findall('.//DataSet')\n"
    "    assert len(sets) == 2\n"
    "    r = vtkXMLPolyDataReader()\n"
    "    r.SetFileName(os.path.join(folder, sets[1].get('file')))\n"
    "    r.Update()\n"
    "    d = r.GetOutput()\n"
    "    assert r.GetErrorCode() == 0, r\n"
    "    t = d.GetFieldData().GetArray('TimeValue').GetTuple1(0)\n"
    "    assert t == float(sets[1].get('timestep')), t\n"
    "    return d\n"
    "def corners(cell):\n"
    "    return [cell.GetPointId(k) for k in range(cell.GetNumberOfPoints())]\n"
    "d = second('name')\n"
    "assert d.GetNumberOfPoints() == 9 and d.GetNumberOfLines() == 2, d\n"
    "assert [d.GetCell(i).GetNumberOfPoints() for i in (0, 1)] == [4, 5]\n"
    "assert corners(d.GetCell(1)) == [4, 5, 6, 7, 8]\n"
    "assert d.GetPoint(8) == (0.1 + 0.0625, -0.3, 0.0), d.GetPoint(8)\n"
    "p = d.GetPointData()\n"
    "assert p.GetArray('velocity').GetTuple(8) == (1.0, 2.0, 4.0)\n"
    "assert p.GetArray('radius').GetTuple1(8) == 0.02\n"
    "assert p.GetArray('strain').GetTuple1(4) == 0.0\n"
    "assert p.GetArray('strain').GetTuple1(8) > 0.01\n"
    "assert d.GetCellData().GetArray('wisp').GetTuple1(1) == 1\n"
    "assert d.GetCellData().GetArray('parent').GetTuple1(1) == 1\n"
    "d = second('name-envelopes')\n"
    "assert d.GetNumberOfPoints() == 24 * (3 + 4), d\n"
    "assert d.GetNumberOfPolys() == 24 * (2 + 3), d\n"
    "assert d.GetCellData().GetArray('wisp').GetTuple1(24 * 2 - 1) == 0\n"
    "assert d.GetCellData().GetArray('wisp').GetTuple1(24 * 2) == 1\n"
    "edges = set()\n"
    "for i in range(d.GetNumberOfCells()):\n"
    "    c = corners(d.GetCell(i))\n"
    "    edges.update(zip(c, c[1:] + c[:1]))\n"
    "assert len(edges) == 4 * d.GetNumberOfCells()\n"
    "assert sum((b, a) not in edges for a, b in edges) == 4 * 24\n"
    "nodes = second('name')\n"
    "for i in range(24 * 7):\n"
    "    ring = i // 24\n"
    "    node = 1 + ring if ring < 3 else 4 + 1 + ring - 3\n"
    "    gap = math.dist(d.GetPoint(i), nodes.GetPoint(node))\n"
    "    assert abs(gap - 0.02) < 1e-12, (i, gap)\n"
    "d = second('name-hairs')\n"
    "assert d.GetNumberOfLines() == 2 * 50, d\n"
    "assert d.GetCellData().GetArray('hair').GetTuple1(99) == 49\n"
    "for i in (0, 99):\n"
    "    start = d.GetPoint(d.GetCell(i).GetPointId(0))\n"
    "    assert math.dist(start, nodes.GetPoint(0 if i == 0 else 4)) < 0.02, start\n"
    "d = second('name-bodies')\n"
    "assert d.GetCellData().GetNumberOfArrays() == 1\n"
    "owner = d.GetCellData().GetArray('body')\n"
    "volume, edges = [0, 0], {}\n"
    "for i in range(d.GetNumberOfCells()):\n"
    "    c = corners(d.GetCell(i))\n"
    "    p = [d.GetPoint(k) for k in c]\n"
    "    for k in range(1, len(c) - 1):\n"
    "        (a, b, e), (f, g, h), (l, m, n) = p[0], p[k], p[k + 1]\n"
    "        volume[int(owner.GetTuple1(i))] += (a * (g * n - h * m) + b * (h * l - f * n)\n"
    "                                            + e * (f * m - g * l)) / 6\n"
    "    for edge in zip(c, c[1:] + c[:1]):\n"
    "        assert edge not in edges, edge\n"
    "        edges[edge] = i\n"
    "for v, radii in zip(volume, ((0.03, 0.02, 0.01), (0.02, 0.02, 0.02))):\n"
    "    exact = 4 / 3 * math.pi * radii[0] * radii[1] * radii[2]\n"
    "    assert 0.98 < v / exact < 1, (v, exact)\n";

static const char *const with_bodies[] = {
    two_wisps,
    "body=({name=\"a\";center=[0.3,0.1,0.0];radii=[0.03,0.02,0."
    "01];friction=0.0;elasticity=0.0;offset=0.0;},"
    "{name=\"b\";center=[-0.3,0.1,0.2];radii=[0.02,0.02,0.02];"
    "friction=0.0;elasticity=0.0;offset=0.0;})",
    "head={times=[0.0];positions=([0.0,0.0,0.0]);rotations=([0.3,0.2,0.7]);}"};

Test(render, exported_frames_are_read_by_vtk) {
    char reason[REASON_SIZE];
    struct scene *scene = lab_load("swing-envelope", with_bodies, 3);
    struct frames frames;
    const char *const folder = write_frames(scene, 2, 0.0625);
    open_frames(&frames, folder);
    cr_assert_eq(vtk_write(&frames, folder, "name", reason), 0, "%s", reason);
    const struct finished *f =
        shell("/usr/bin/python3 '%s' '%s'", file_write(folder, "reader.py", reader), folder);
    frames_close(&frames);
    if (f->code == 127 || f->code == 42)
        skip_test("VTK's own reader, for there is no python3-vtk9");
    cr_expect_eq(f->code, 0, "VTK reads something else: %s", f->out);
}

/* The numbers of an attribute at a frame; returns how many. */
static int numbers_at(const char *layer, const char *attribute, int frame, double *number,
                      int most) {
    const char *at = strstr(layer, attribute);
    cr_assert(at, "no %s", attribute);
    const char *const key = printed("\n            %d: ", frame);
    at = strstr(at, key);
    cr_assert(at, "no frame %d of %s", frame, attribute);
    at += strlen(key);
    int count = 0;
    while (*at != '\n' && count < most) {
        char *end;
        const double x = strtod(at, &end);
        if (end != at)
            number[count++] = x;
        at = end != at ? end : at + 1;
    }
    return count;
}

/* Curves go through the nodes and are as wide as envelopes; a row of 4 numbers, on the left of a
 * body's matrix, takes the ends of the unit sphere's axes to those of the body's. */
Test(render, a_usd_layer_has_all_frames) {
    char reason[REASON_SIZE];
    struct scene *scene = lab_load("swing-envelope", with_bodies, 3);
    struct frames frames;
    double number[40];
    const char *const folder = write_frames(scene, 2, 0.0123456789012345);
    open_frames(&frames, folder);
    cr_assert_eq(usd_write(&frames, folder, "name", reason), 0, "%s", reason);
    char *layer = file_read(printed("%s/name.usda", folder));
    cr_assert(layer && strncmp(layer, "#usda 1.0\n", 10) == 0);
    cr_expect_eq(numbers_at(layer, "curveVertexCounts", 2, number, 40), 2);
    cr_expect(number[0] == 4 && number[1] == 5);
    cr_expect_eq(numbers_at(layer, "point3f[] points", 2, number, 40), 27);
    for (int row = 0; row < 9; row++)
        for (int k = 0; k < 3; k++)
            cr_expect_eq(number[3 * row + k],
                         table_value(&frames.states->table, frames.first_row[1] + row, 3 + k));
    cr_expect_eq(numbers_at(layer, "float[] widths", 1, number, 40), 9);
    for (int i = 0; i < 9; i++)
        cr_expect_float_eq(number[i], 0.04, 1e-15);
    cr_expect_eq(numbers_at(strstr(layer, "\"body_0\""), "xformOp:transform.", 1, number, 40), 16);
    const struct body *body = &scene->bodies[0];
    struct placement head;
    head_placement(&scene->around.head, 0, &head);
    const struct body_motion motion = body_motion(body, &head, 0);
    for (int axis = 0; axis < 3; axis++)
        for (int k = 0; k < 3; k++)
            cr_expect_float_eq(number[12 + k] + number[4 * axis + k],
                               motion.centre[k] + body->radii[axis] * motion.axes[k][axis], 1e-15,
                               "axis %d, %c", axis, "xyz"[k]);
    frames_close(&frames);
}
