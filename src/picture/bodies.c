#include "bodies.h"

#include "base/vector.h"

#include <string.h>

void figure_place(struct figure *figure, const struct scene *scene, double t) {
    struct placement head;
    head_placement(&scene->around.head, t, &head);
    figure->count = scene->body_count;
    for (int i = 0; i < scene->body_count; i++) {
        struct ellipsoid *body = &figure->body[i];
        const struct body_motion motion = body_motion(&scene->bodies[i], &head, t);
        memcpy(body->centre, motion.centre, sizeof body->centre);
        memcpy(body->radii, scene->bodies[i].radii, sizeof body->radii);
        memcpy(body->axes, motion.axes, sizeof body->axes);
    }
}

/* Along the body's axes in units of its radii, where it is the unit sphere. */
static void to_sphere(const struct ellipsoid *body, const double x[3], double y[3]) {
    for (int k = 0; k < 3; k++)
        y[k] = (body->axes[0][k] * x[0] + body->axes[1][k] * x[1] + body->axes[2][k] * x[2]) /
               body->radii[k];
}

/* Where eye + s way is on the unit sphere first, s > 0; `from` is the eye, in its units both.
 * INFINITY where it is nowhere, 0 for an eye within. */
static double entry(const double from[3], const double way[3]) {
    const double a = vector_dot(way, way), b = vector_dot(from, way),
                 c = vector_dot(from, from) - 1, d = b * b - a * c;
    if (c <= 0)
        return 0;
    return d >= 0 && b < 0 ? c / (sqrt(d) - b) : INFINITY;
}

int figure_hides(const struct figure *figure, const double eye[3], const double point[3]) {
    static const double on_surface = 1e-6; /* of the way from the eye */
    for (int i = 0; i < figure->count; i++) {
        const struct ellipsoid *body = &figure->body[i];
        double from[3], way[3], a[3], b[3];
        for (int k = 0; k < 3; k++) {
            from[k] = eye[k] - body->centre[k];
            way[k] = point[k] - eye[k];
        }
        to_sphere(body, from, a);
        to_sphere(body, way, b);
        if (entry(a, b) < 1 - on_surface)
            return 1;
    }
    return 0;
}

/* --- painting --- */

enum { SIDE = 2, RAYS = SIDE * SIDE }; /* for each pixel, so that edges are smooth */

/* A ray's first body, or -1; *s is where. `eyes`: the eye in each body's units. */
static int first_body(const struct figure *figure, double (*eyes)[3], const double ray[3],
                      double *s) {
    int first = -1;
    *s = INFINITY;
    for (int i = 0; i < figure->count; i++) {
        double way[3];
        to_sphere(&figure->body[i], ray, way);
        const double at = entry(eyes[i], way);
        if (at < *s) {
            *s = at;
            first = i;
        }
    }
    return first;
}

/* Of a pale matt body: from dark to light with the angle to the light, half of it from all round.
 */
static void add_light(const struct ellipsoid *body, const double from[3], const double ray[3],
                      double s, const double light[3], double sum[3]) {
    static const double colour[3] = {0.93, 0.88, 0.83};
    double at[3], sphere[3], normal[3] = {0, 0, 0};
    memcpy(at, from, sizeof at);
    vector_add(at, s, ray);
    to_sphere(body, at, sphere);
    for (int k = 0; k < 3; k++)
        for (int l = 0; l < 3; l++)
            normal[k] += body->axes[k][l] * sphere[l] / body->radii[l];
    const double lit = vector_dot(normal, light) / vector_length(normal);
    const double half = 0.5 + 0.5 * lit;
    for (int k = 0; k < 3; k++)
        sum[k] += colour[k] * (0.45 + 0.55 * half * half);
}

static int paint_pixel(const struct figure *figure, const struct camera *camera,
                       const double light[3], double (*eyes)[3], const double corner[2],
                       unsigned char pixel[4]) {
    double sum[3] = {0, 0, 0};
    int seen = 0;
    for (int i = 0; i < RAYS; i++) {
        double ray[3], from[3], s;
        camera_ray(camera, corner[0] + (i % SIDE + 0.5) / SIDE, corner[1] + (i / SIDE + 0.5) / SIDE,
                   ray);
        const int body = first_body(figure, eyes, ray, &s);
        if (body < 0)
            continue;
        for (int k = 0; k < 3; k++)
            from[k] = camera->eye[k] - figure->body[body].centre[k];
        add_light(&figure->body[body], from, ray, s, light, sum);
        seen++;
    }
    for (int k = 0; k < 3; k++)
        pixel[k] = (unsigned char)(seen ? 255 * sum[k] / seen + 0.5 : 255);
    pixel[3] = (unsigned char)(255 * seen / RAYS);
    return seen;
}

int figure_paint(const struct figure *figure, const struct camera *camera, const double light[3],
                 unsigned char *pixels) {
    double eyes[BODIES_MAX][3];
    const int width = (int)camera->width, height = (int)camera->height;
    int seen = 0;
    for (int i = 0; i < figure->count; i++) {
        double from[3];
        for (int k = 0; k < 3; k++)
            from[k] = camera->eye[k] - figure->body[i].centre[k];
        to_sphere(&figure->body[i], from, eyes[i]);
    }
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++, pixels += 4)
            seen |= paint_pixel(figure, camera, light, eyes, (const double[]){x, y}, pixels);
    return seen != 0;
}
