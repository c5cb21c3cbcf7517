/* From where a scene is looked at, and where its points are in a picture. */
#ifndef WISPLAB_CAMERA_H
#define WISPLAB_CAMERA_H

#include "model/scene.h"

struct camera {
    double eye[3];                      /* m */
    double right[3], up[3], forward[3]; /* unit vectors across each other */
    double scale;                       /* pixels for m/m off the axis */
    double width, height;               /* of the picture, pixels */
};

/* A camera for a picture of so many pixels, which has its eye only where the scene says so;
 * `upwards` is a unit vector. */
struct camera camera_make(const struct render_settings *render, const double upwards[3],
                          double width, double height);

/* The picture's four sides as seen from the eye, a little within it: a point p is in the picture
 * where p . side <= eye . side for all of them. */
void camera_sides(const struct camera *camera, double sides[4][3]);

/* Gives an eye to a camera whose scene does not say: as near as it may be for all points whose p .
 * side is at most `most` to be in the picture, with the target, if the scene has one, in its
 * middle. */
void camera_fit(struct camera *camera, const struct render_settings *render, const double most[4]);

/* Keeps the view in a picture whose sides are so many times as long. */
void camera_enlarge(struct camera *camera, double by);

/* x to the right and y upwards from the picture's lower left corner, pixels; and the depth along
 * the camera's axis, m. Returns 0 for a point that is not in front of the camera. */
int camera_project(const struct camera *camera, const double point[3], double place[3]);

/* The direction, not of unit length but with 1 along the camera's axis, in which a place is seen.
 */
void camera_ray(const struct camera *camera, double x, double y, double ray[3]);

/* Towards the light, a unit vector. */
void camera_light(const struct camera *camera, const struct render_settings *render,
                  double light[3]);

#endif
