/* Points of a figure that say what they are. gnuplot marks them for a script of its own, which a
 * page would have to load; a title and a link say the same to every browser without one. */
#ifndef WISPLAB_TIPS_H
#define WISPLAB_TIPS_H

/* Rewrites an .svg of gnuplot in place: each hypertext becomes a title of its point, and where its
 * first line is the folder of a run, a link to that run's record, from a folder beside `runs`.
 * Returns 0, or -1 with one line in `reason` (REASON_SIZE). */
int tips_make(const char *path, char *reason);

/* Gives a text its tips; to be freed. */
char *tips_text(const char *svg);

#endif
