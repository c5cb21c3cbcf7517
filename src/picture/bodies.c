#include "bodies.h"

#include "base/vector.h"
#include "wisp/ellipsoid.h"

#include <string.h>

void figure_place(struct figure *figure, const struct scene *scene, double t) {
    struct placement head;
    head_placement(&scene->around.head, t, &head);
    figure->count = scene->body_count;
    for (int i = 0; i < scene->body_count; i++) {
        memcpy(figure->body[i].radii, scene->bodies[i].radii, sizeof figure->body[i].radii);
        figure->body[i].motion = body_motion(&scene->bodies[i], &head, t);
    }
}

/* A vector of the world as it is where the body is the unit sphere. */
static void to_sphere(const struct figure_body *body, const double x[3], double y[3]) {
    double along[3];
    body_to_axes(&body->motion, x, along);
    ellipsoid_to_sphere(body->radii, along, y);
}

/* Where eye + s way is in the sphere first, INFINITY where it is nowhere. (With ellipsoid_entry,
 * which also is exact where a line grazes, a picture takes half as long again.) */
static double entry(const double eye[3], const double way[3]) {
    const double a = vector_dot(way, way), b = vector_dot(eye, way), c = vector_dot(eye, eye) - 1,
                 d = b * b - a * c;
    if (c <= 0)
        return 0;
    return d >= 0 && b < 0 ? c / (sqrt(d) - b) : INFINITY;
}

/* Whether a line passes a body by more than this reaches in any direction; `from` is a point of it
 * seen from the body's centre. */
static int passes_by(const struct figure_body *body, const double from[3], const double way[3]) {
    const double reach = (1 + 1e-9) * vector_largest(body->radii);
    double across[3];
    vector_cross(from, way, across);
    return vector_dot(across, across) > reach * reach * vector_dot(way, way);
}

int figure_hides(const struct figure *figure, const double eye[3], const double point[3]) {
    static const double on_surface = 1e-6; /* of the way from the eye */
    for (int i = 0; i < figure->count; i++) {
        const struct figure_body *body = &figure->body[i];
        double from[3], way[3], a[3], b[3];
        for (int k = 0; k < 3; k++) {
            from[k] = eye[k] - body->motion.centre[k];
            way[k] = point[k] - eye[k];
        }
        if (passes_by(body, from, way))
            continue;
        to_sphere(body, from, a);
        to_sphere(body, way, b);
        if (entry(a, b) < 1 - on_surface)
            return 1;
    }
    return 0;
}

/* --- painting --- */

enum { SIDE = 2, RAYS = SIDE * SIDE }; /* for each pixel, so that edges are smooth */

/* What a picture of them is painted with. */
struct painting {
    const struct figure *figure;
    const struct camera *camera;
    const double *light;
    double eye[BODIES_MAX][3]; /* in each body's units */
    struct bounds {
        double least[2], most[2];
    } bounds[BODIES_MAX]; /* pixels: within, it is seen */
};

/* The corners of the box around a body have it among them, seen from anywhere. */
static struct bounds find_bounds(const struct figure_body *body, const struct camera *camera) {
    struct bounds bounds = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
    for (int corner = 0; corner < 8; corner++) {
        double point[3], place[3];
        memcpy(point, body->motion.centre, sizeof point);
        for (int axis = 0; axis < 3; axis++)
            for (int k = 0; k < 3; k++)
                point[k] +=
                    (corner >> axis & 1 ? 1 : -1) * body->radii[axis] * body->motion.axes[k][axis];
        if (!camera_project(camera, point, place)) /* partly behind the eye: anywhere */
            return (struct bounds){{-INFINITY, -INFINITY}, {INFINITY, INFINITY}};
        for (int k = 0; k < 2; k++) {
            bounds.least[k] = fmin(bounds.least[k], place[k] - 1);
            bounds.most[k] = fmax(bounds.most[k], place[k] + 1);
        }
    }
    return bounds;
}

/* The bodies that may be seen in a pixel; returns how many. */
static int bodies_at(const struct painting *painting, const double corner[2], int *bodies) {
    int count = 0;
    for (int i = 0; i < painting->figure->count; i++) {
        const struct bounds *bounds = &painting->bounds[i];
        if (corner[0] >= bounds->least[0] && corner[0] <= bounds->most[0] &&
            corner[1] >= bounds->least[1] && corner[1] <= bounds->most[1])
            bodies[count++] = i;
    }
    return count;
}

/* A ray's first body of these, or -1; *s is where. */
static int first_body(const struct painting *painting, const int *bodies, int count,
                      const double ray[3], double *s) {
    int first = -1;
    *s = INFINITY;
    for (int i = 0; i < count; i++) {
        double way[3];
        to_sphere(&painting->figure->body[bodies[i]], ray, way);
        const double at = entry(painting->eye[bodies[i]], way);
        if (at < *s) {
            *s = at;
            first = bodies[i];
        }
    }
    return first;
}

/* The light on a pale matt body: from dark to light with the angle to the light, half of it from
 * all round.
 */
static void add_light(const struct figure_body *body, const double from[3], const double ray[3],
                      double s, const double light[3], double sum[3]) {
    static const double colour[3] = {0.93, 0.88, 0.83};
    double at[3], sphere[3], normal[3] = {0, 0, 0};
    memcpy(at, from, sizeof at);
    vector_add(at, s, ray);
    to_sphere(body, at, sphere);
    for (int k = 0; k < 3; k++)
        for (int l = 0; l < 3; l++)
            normal[k] += body->motion.axes[k][l] * sphere[l] / body->radii[l];
    const double lit = vector_dot(normal, light) / vector_length(normal);
    const double half = 0.5 + 0.5 * lit;
    for (int k = 0; k < 3; k++)
        sum[k] += colour[k] * (0.45 + 0.55 * half * half);
}

static int paint_pixel(const struct painting *painting, const double corner[2],
                       unsigned char pixel[4]) {
    const struct camera *camera = painting->camera;
    double sum[3] = {0, 0, 0};
    int bodies[BODIES_MAX], seen = 0;
    const int count = bodies_at(painting, corner, bodies);
    for (int i = 0; i < RAYS && count > 0; i++) {
        double ray[3], from[3], s;
        camera_ray(camera, corner[0] + (i % SIDE + 0.5) / SIDE, corner[1] + (i / SIDE + 0.5) / SIDE,
                   ray);
        const int body = first_body(painting, bodies, count, ray, &s);
        if (body < 0)
            continue;
        for (int k = 0; k < 3; k++)
            from[k] = camera->eye[k] - painting->figure->body[body].motion.centre[k];
        add_light(&painting->figure->body[body], from, ray, s, painting->light, sum);
        seen++;
    }
    for (int k = 0; k < 3; k++)
        pixel[k] = (unsigned char)(seen ? 255 * sum[k] / seen + 0.5 : 255);
    pixel[3] = (unsigned char)(255 * seen / RAYS);
    return seen;
}

int figure_paint(const struct figure *figure, const struct camera *camera, const double light[3],
                 unsigned char *pixels) {
    struct painting painting = {.figure = figure, .camera = camera, .light = light};
    const int width = (int)camera->width, height = (int)camera->height;
    int seen = 0;
    for (int i = 0; i < figure->count; i++) {
        double from[3];
        for (int k = 0; k < 3; k++)
            from[k] = camera->eye[k] - figure->body[i].motion.centre[k];
        to_sphere(&figure->body[i], from, painting.eye[i]);
        painting.bounds[i] = find_bounds(&figure->body[i], camera);
    }
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++, pixels += 4)
            seen |= paint_pixel(&painting, (const double[]){x, y}, pixels);
    return seen != 0;
}
