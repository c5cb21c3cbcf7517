/* Prescribed functions of time: the head's rigid motion, and style fields. */
#ifndef WISPLAB_PRESCRIBED_H
#define WISPLAB_PRESCRIBED_H

enum { KNOTS_MAX = 64 };

/* The head's motion: cubic Hermite between knots, per component of position and of the rotation
 * vector (axis times angle), with slope (x_(k+1) - x_(k-1)) / (t_(k+1) - t_(k-1)), 0 at the first
 * and last knot; held outside them. Its acceleration jumps at knots: at one it is that after it.
 * Without knots the head rests. */
struct head_motion {
    int knots;
    double time[KNOTS_MAX];        /* s, ascending */
    double position[KNOTS_MAX][3]; /* m */
    double rotation[KNOTS_MAX][3]; /* rad */
};

/* A rigid motion at one time: what rests at x stands at position + turn x, moves with position' +
 * turn' x, and so on. */
struct placement {
    double position[3][3]; /* value, first and second derivative: m, m/s, m/s^2 */
    double turn[3][3][3];  /* the same of the rotation matrix: 1, 1/s, 1/s^2 */
};

void head_placement(const struct head_motion *head, double t, struct placement *placement);

/* The interval between knots that holds t: -1 before the first, knots - 1 after the last one. */
int head_interval(const struct head_motion *head, double t);

/* Does what head_placement does, by the cubic that holds at time `inside`, for t in that interval
 * or at one of its ends, to rounding. */
void head_placement_within(const struct head_motion *head, double inside, double t,
                           struct placement *placement);

/* Where a point of the head is (derivative 0), its velocity (1) or acceleration (2); a direction is
 * only turned. */
void placed_point(const struct placement *placement, int derivative, const double rest[3],
                  double point[3]);
void placed_direction(const struct placement *placement, const double rest[3], double direction[3]);

/* What parts hair (figure 4.10 of the thesis): a field with opposite signs on the two sides of a
 * plane, B(t) tanh((p - origin).normal / width). */
struct parting {
    double width;                      /* m; 0: there is none */
    double origin[3], normal[3];       /* of the plane, in space: m, and a unit vector */
    double acceleration[KNOTS_MAX][3]; /* B at the knots of the style, m/s^2 */
};

/* An acceleration A(t) that is uniform in space, and that of a parting besides: both linear in time
 * between knots, held outside; 0 without. */
struct style {
    int knots;
    double time[KNOTS_MAX];            /* s, ascending */
    double acceleration[KNOTS_MAX][3]; /* A, m/s^2 */
    struct parting parting;
};

/* A(t), and B(t). */
void style_acceleration(const struct style *style, double t, double acceleration[3]);
void style_parting(const struct style *style, double t, double acceleration[3]);

/* All of it at a point in space. */
void style_at(const struct style *style, double t, const double point[3], double acceleration[3]);

/* Their rates between the knots on either side of `inside`, m/s^3. */
void style_rate(const struct style *style, double inside, double rate[3]);
void style_parting_rate(const struct style *style, double inside, double rate[3]);

#endif
