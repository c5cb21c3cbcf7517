/* The bodies of a scene in a picture: what is seen of them, and what they hide. */
#ifndef WISPLAB_FIGURE_H
#define WISPLAB_FIGURE_H

#include "camera.h"
#include "model/scene.h"

/* Ellipsoids where they are at one time. */
struct figure {
    int count;
    struct figure_body {
        double radii[3]; /* m */
        struct body_motion motion;
    } body[BODIES_MAX];
};

void figure_place(struct figure *figure, const struct scene *scene, double t);

/* Whether a point is behind or within a body, seen from the eye; not if it is on the surface. */
int figure_hides(const struct figure *figure, const double eye[3], const double point[3]);

/* Paints the bodies, lit from `light`, into `pixels`: red, green, blue and opacity, row by row from
 * the bottom, of a picture of the camera's size. Returns whether there is anything to be seen. */
int figure_paint(const struct figure *figure, const struct camera *camera, const double light[3],
                 unsigned char *pixels);

#endif
