/* The circle test (Plante 1999, section 2.3.3): one particle under Witkin's centripetal force
 * f = -m (v.v)/(p.p) p, whose exact motion is a circle at constant speed. */
#ifndef WISPLAB_CIRCLE_H
#define WISPLAB_CIRCLE_H

/* m, m/s, rad/s: the particle starts at (RADIUS, 0) with velocity (0, -SPEED). */
#define CIRCLE_RADIUS 0.9
#define CIRCLE_SPEED  0.2
#define CIRCLE_RATE   (CIRCLE_SPEED / CIRCLE_RADIUS)

/* The exact position at time t, m. */
void circle_exact(double t, double position[2]);

#endif
