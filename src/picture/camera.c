#include "camera.h"

#include "base/vector.h"

#include <math.h>
#include <string.h>

static const double margin = 0.92; /* of the picture that a camera which finds its place fills */

/* An axis of the world that is far from along `a`. */
static void something_across(const double a[3], double across[3]) {
    const int axis = fabs(a[2]) < 0.9 ? 2 : 0;
    for (int k = 0; k < 3; k++)
        across[k] = k == axis;
}

/* right, up and forward from forward and what is upwards. */
static void turn(struct camera *camera, const double upwards[3]) {
    double side[3];
    vector_cross(camera->forward, upwards, side);
    if (vector_length(side) < 1e-3) { /* it looks straight up or down */
        double other[3];
        something_across(camera->forward, other);
        vector_cross(camera->forward, other, side);
    }
    vector_normalise(side);
    memcpy(camera->right, side, sizeof side);
    vector_cross(side, camera->forward, camera->up);
}

/* From a little to the right and above, on the side of +z. */
static void look_ahead(const double upwards[3], double forward[3]) {
    double ahead[3] = {0, 0, 1}, side[3];
    if (fabs(upwards[2]) > 0.9)
        something_across(upwards, ahead);
    vector_add(ahead, -vector_dot(ahead, upwards), upwards);
    vector_cross(upwards, ahead, side);
    for (int k = 0; k < 3; k++)
        forward[k] = -(ahead[k] + 0.35 * side[k] + 0.2 * upwards[k]);
    vector_normalise(forward);
}

struct camera camera_make(const struct render_settings *render, const double upwards[3],
                          double width, double height) {
    struct camera camera = {
        .scale = height / 2 / tan(render->angle / 2), .width = width, .height = height};
    if (render->has_eye) {
        for (int k = 0; k < 3; k++) {
            camera.eye[k] = render->eye[k];
            camera.forward[k] = render->target[k] - render->eye[k];
        }
        vector_normalise(camera.forward);
    } else {
        look_ahead(upwards, camera.forward);
    }
    turn(&camera, upwards);
    return camera;
}

/* Half of the width or height that is seen at a distance of 1, and drawn upon. */
static double half_view(const struct camera *camera, int upwards) {
    return margin * (upwards ? camera->height : camera->width) / 2 / camera->scale;
}

void camera_sides(const struct camera *camera, double sides[4][3]) {
    for (int i = 0; i < 4; i++) {
        const double *across = i / 2 ? camera->up : camera->right;
        for (int k = 0; k < 3; k++)
            sides[i][k] =
                (i % 2 ? -across[k] : across[k]) - half_view(camera, i / 2) * camera->forward[k];
    }
}

/* With the eye at (x, y, z) along right, up and forward, and h the half view, the two sides across
 * right ask for most[0] <= x - h z and most[1] <= -x - h z. Their sum says how far back z must be,
 * and x in the middle does for both; likewise y. With x given, each says it by itself. */
void camera_fit(struct camera *camera, const struct render_settings *render, const double most[4]) {
    const double *axes[3] = {camera->right, camera->up, camera->forward};
    double place[3] = {0, 0, INFINITY};
    if (render->has_eye)
        return;
    for (int d = 0; d < 2; d++) {
        place[d] = render->has_target ? vector_dot(render->target, axes[d])
                                      : 0.5 * (most[2 * d] - most[2 * d + 1]);
        const double h = half_view(camera, d);
        place[2] = fmin(place[2], fmin(place[d] - most[2 * d], -place[d] - most[2 * d + 1]) / h);
    }
    memset(camera->eye, 0, sizeof camera->eye);
    for (int k = 0; k < 3; k++)
        vector_add(camera->eye, place[k] - (k == 2 ? 10 * RENDER_NEAREST : 0), axes[k]);
}

void camera_enlarge(struct camera *camera, double by) {
    camera->scale *= by;
    camera->width = floor(by * camera->width);
    camera->height = floor(by * camera->height);
}

int camera_project(const struct camera *camera, const double point[3], double place[3]) {
    double from[3];
    for (int k = 0; k < 3; k++)
        from[k] = point[k] - camera->eye[k];
    place[2] = vector_dot(from, camera->forward);
    if (!(place[2] > RENDER_NEAREST))
        return 0;
    place[0] = camera->width / 2 + camera->scale * vector_dot(from, camera->right) / place[2];
    place[1] = camera->height / 2 + camera->scale * vector_dot(from, camera->up) / place[2];
    return 1;
}

void camera_ray(const struct camera *camera, double x, double y, double ray[3]) {
    memcpy(ray, camera->forward, 3 * sizeof *ray);
    vector_add(ray, (x - camera->width / 2) / camera->scale, camera->right);
    vector_add(ray, (y - camera->height / 2) / camera->scale, camera->up);
}

void camera_light(const struct camera *camera, const struct render_settings *render,
                  double light[3]) {
    if (vector_dot(render->light, render->light) > 0) {
        memcpy(light, render->light, sizeof render->light);
        return;
    }
    for (int k = 0; k < 3; k++)
        light[k] = -camera->forward[k] + 0.9 * camera->up[k] - 0.5 * camera->right[k];
    vector_normalise(light);
}
