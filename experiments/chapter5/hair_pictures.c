/* Film strips as lines on paper: skeletons, the outlines of envelopes and of bodies; and of the
 * hair itself. */
#include "base/files.h"
#include "base/vector.h"
#include "hair_study.h"
#include "picture/strip.h"

#include <math.h>
#include <string.h>

enum { RING = 24, CURVE = 48, BODIES = 0, ENVELOPES, SKELETONS = 3, KINDS = 5 };

/* The directions to the right and up on the paper. */
struct paper {
    double right[3], up[3];
};

static struct paper paper_from(double azimuth, double elevation) {
    const double a = azimuth * M_PI / 180, e = elevation * M_PI / 180;
    return (struct paper){{cos(a), 0, -sin(a)}, {-sin(a) * sin(e), cos(e), -cos(a) * sin(e)}};
}

static void project(const struct paper *paper, const double p[3], double xy[2]) {
    xy[0] = vector_dot(p, paper->right);
    xy[1] = vector_dot(p, paper->up);
}

/* Tenths of a millimetre are less than a pixel. */
static void write_point(FILE *stream, const double xy[2], int kind) {
    fprintf(stream, "%.4f\t%.4f\t%d\n", xy[0], xy[1], kind);
}

/* --- bodies --- */

/* The outline of an ellipsoid sum (x_k / R_k)^2 = 1 is that of the ellipse with the matrix S = P A
 * P^T, A = sum R_k^2 a_k a_k^T; the points c + L (cos, sin) with S = L L^T are on it. */
static void write_body(FILE *stream, const struct paper *paper, const struct scene *scene, int body,
                       double t) {
    const struct hair_body place = hair_body(scene, body, t);
    double centre[2], s00 = 0, s01 = 0, s11 = 0;
    project(paper, place.centre, centre);
    for (int k = 0; k < 3; k++) {
        double a[2];
        project(paper, place.axis[k], a);
        const double square = scene->bodies[body].radii[k] * scene->bodies[body].radii[k];
        s00 += square * a[0] * a[0];
        s01 += square * a[0] * a[1];
        s11 += square * a[1] * a[1];
    }
    const double l00 = sqrt(s00), l10 = s01 / l00, l11 = sqrt(fmax(0, s11 - l10 * l10));
    for (int i = 0; i <= CURVE; i++) {
        const double c = cos(2 * M_PI * i / CURVE), s = sin(2 * M_PI * i / CURVE);
        write_point(stream, (double[2]){centre[0] + l00 * c, centre[1] + l10 * c + l11 * s},
                    BODIES);
    }
    fputc('\n', stream);
}

/* --- wisps --- */

/* How far the envelope's ring at a node reaches to either side across `direction` on the paper. Its
 * radius at an angle is the quarter ellipse's between samples j and j + 1 (thesis, section 4.3.2).
 */
static void reach(const struct strand *s, const struct paper *paper, int node,
                  const double across[2], double *least, double *most) {
    const int samples = s->wisp->samples;
    *least = *most = 0;
    for (int i = 0; i < RING && samples > 0; i++) {
        const double theta = 2 * M_PI * i / RING;
        const int j = (int)(theta * samples / (2 * M_PI)) % samples;
        const double psi = (theta - 2 * M_PI * j / samples) * samples / 4;
        const double r0 = s->r[node * samples + j], r1 = s->r[node * samples + (j + 1) % samples];
        const double rho = 1 / hypot(cos(psi) / r0, sin(psi) / r1);
        double xy[2], a[3] = {0, 0, 0};
        vector_add(a, rho * cos(theta), s->axis_u[node]);
        vector_add(a, rho * sin(theta), s->axis_v[node]);
        project(paper, a, xy);
        const double d = xy[0] * across[0] + xy[1] * across[1];
        *least = fmin(*least, d);
        *most = fmax(*most, d);
    }
}

/* Where one side of the outline passes a node. */
static void side_point(const struct strand *s, const struct paper *paper, int node, int side,
                       double xy[2]) {
    const int last = s->wisp->nodes - 1;
    double before[2], after[2], least, most;
    project(paper, s->p[node > 0 ? node - 1 : 0], before);
    project(paper, s->p[node < last ? node + 1 : last], after);
    const double x = after[0] - before[0], y = after[1] - before[1], length = hypot(x, y);
    const double across[2] = {length > 0 ? -y / length : 1, length > 0 ? x / length : 0};
    reach(s, paper, node, across, &least, &most);
    project(paper, s->p[node], xy);
    for (int k = 0; k < 2; k++)
        xy[k] += (side ? most : least) * across[k];
}

static void write_envelope(FILE *stream, const struct paper *paper, const struct strand *s,
                           int kind) {
    const int n = s->wisp->nodes;
    for (int i = 0; i < 2 * n; i++) {
        double xy[2];
        side_point(s, paper, i < n ? i : 2 * n - 1 - i, i < n, xy);
        write_point(stream, xy, kind);
    }
    fputc('\n', stream);
}

static void write_skeleton(FILE *stream, const struct paper *paper, const struct strand *s,
                           int kind) {
    for (int i = 0; i < s->wisp->nodes; i++) {
        double xy[2];
        project(paper, s->p[i], xy);
        write_point(stream, xy, kind);
    }
    fputc('\n', stream);
}

/* Two colours tell few wisps apart, or where wisps divide, what split off from what is left. */
static int class_of(const struct hair *hair, int wisp) {
    if (json_object_get(hair->scene->source, "subdivision"))
        return wisp >= hair->scene->wisp_count;
    return hair->scene->wisp_count <= 4 ? wisp % 2 : 0;
}

/* One block of lines. It begins with a point that is nowhere, so that none is empty. */
static void write_kind(FILE *stream, const struct paper *paper, struct hair *hair, int frame,
                       int kind) {
    fprintf(stream, "nan\tnan\t%d\n\n", kind);
    for (int b = 0; b < hair->scene->body_count && kind == BODIES; b++)
        write_body(stream, paper, hair->scene, b, hair->frames[frame].t);
    for (int w = 0; w < hair->frames[frame].wisps; w++) {
        const int class = class_of(hair, w);
        if (kind == ENVELOPES + class && hair->wisps[w].samples > 0)
            write_envelope(stream, paper, hair->strands[w], kind);
        if (kind == SKELETONS + class)
            write_skeleton(stream, paper, hair->strands[w], kind);
    }
    fputc('\n', stream);
}

/* --- the strip --- */

static void write_picture(FILE *lines, FILE *cells, const struct hair_question *question,
                          struct hair_run *run, int picture, int *cell) {
    const struct paper paper = paper_from(question->azimuth, question->elevation);
    const int number = run->variant->pictures[picture];
    const double t = (number - 1) / 30.;
    const int frame = hair_frame_at(&run->hair, t);
    if (frame < 0)
        return;
    hair_lay_open(&run->hair, frame);
    for (int kind = 0; kind < KINDS; kind++)
        write_kind(lines, &paper, &run->hair, frame, kind);
    fprintf(cells, "%d\t%d\t%d\t%s\t%d\t%.17g\n", *cell, picture / question->columns,
            picture % question->columns, run->variant->label, number, t);
    ++*cell;
}

static void write_pictures(FILE *lines, FILE *cells, struct hair_study *study) {
    int cell = 0;
    for (int i = 0; i < study->count; i++)
        for (int k = 0; k < HAIR_PICTURES && study->runs[i].variant->pictures[k]; k++)
            write_picture(lines, cells, study->question, &study->runs[i], k, &cell);
}

int hair_pictures(struct plan *plan, const char *folder, struct hair_study *study) {
    struct atomic_file lines, cells;
    if (open_table(
            &lines, folder, "strip",
            "lines on paper, m, in blocks: of each cell the outlines of bodies, of the "
            "envelopes of even and of odd wisps (few wisps), of wisps and of those that split "
            "off from them, or of all, and their skeletons; "
            "nan: the pen is lifted",
            study->subject->scene, "x\ty\tkind", plan->reason))
        return -1;
    if (open_table(&cells, folder, "strip-cells",
                   "the frames shown, numbered from 1 at 30 a second", study->subject->scene,
                   "cell\trow\tcolumn\tvariant\tframe\tt", plan->reason)) {
        atomic_discard(&lines);
        return -1;
    }
    write_pictures(lines.stream, cells.stream, study);
    if (atomic_commit(&lines, plan->reason)) {
        atomic_discard(&cells);
        return -1;
    }
    return atomic_commit(&cells, plan->reason);
}

/* --- the hair itself --- */

int hair_is_drawn(const struct hair_study *study, int variant) {
    return memcmp(study->question->variants[variant].pictures,
                  study->question->variants[0].pictures,
                  sizeof study->question->variants[0].pictures) == 0;
}

/* The first variant's pictures, as the timed runs number their frames, that all rows have. */
static int frames_shown(const struct hair_study *study, int *frames) {
    const int *pictures = study->question->variants[0].pictures;
    const double rate = study->runs[0].timed->run.scene->frame_rate;
    int count = 0;
    for (int k = 0; k < HAIR_PICTURES && pictures[k]; k++) {
        int frame = 0;
        for (int i = 0; i < study->count && frame >= 0; i++)
            if (hair_is_drawn(study, i))
                frame = hair_frame_numbered(&study->runs[i], pictures[k]);
        if (frame >= 0)
            frames[count++] = 1 + (int)lround((pictures[k] - 1) / 30. * rate);
    }
    return count;
}

int hair_strip(struct plan *plan, const char *folder, const struct hair_study *study) {
    char paths[HAIR_VARIANTS][PATH_SIZE];
    struct strip_row rows[HAIR_VARIANTS] = {{0}};
    int frames[HAIR_PICTURES], row_count = 0;
    for (int i = 0; i < study->count; i++) {
        const struct hair_run *run = &study->runs[i];
        if (!hair_is_drawn(study, i))
            continue;
        if (path_format(paths[i], "%s/states.tsv", run->timed->run.folder))
            return -1;
        rows[row_count++] = (struct strip_row){
            .label = run->variant->label, .states = paths[i], .scene = run->timed->run.scene};
    }
    if (row_count == 1)
        rows[0].label = "";
    /* with --quick a head of hair is sparse: drawing takes longer than what is drawn */
    static const char *const sparse[] = {"render={ hairs = 12; }"};
    const int is_sparse = plan->quick && study->subject->scene->wisp_count > 60;
    const struct strip_request request = {.rows = rows,
                                          .sets = sparse,
                                          .set_count = is_sparse,
                                          .row_count = row_count,
                                          .views = VIEW_HAIR,
                                          .trajectories = plan->trajectories,
                                          .width = study->question->width,
                                          .height = study->question->height,
                                          .columns = study->question->columns};
    const int count = frames_shown(study, frames);
    if (count == 0 || study->subject->scene->wisps[0].samples == 0)
        return 0; /* hair fills the envelope: without one there is none */
    return strip_draw(&request, frames, count, folder, "hair", plan->reason) ? -1 : 0;
}
