/* Which of some boxes meet another one: a wisp far from every other touches none, and its box says
 * so. */
#ifndef WISPLAB_NEIGHBOURS_H
#define WISPLAB_NEIGHBOURS_H

struct neighbours;

/* For at most so many boxes; NULL where memory cannot be had. */
struct neighbours *neighbours_create(int most);
void neighbours_free(struct neighbours *neighbours);

/* Boxes are least x y z, most x y z, m. near[i] becomes 1 where box i meets another, borders
 * included, and else stays as it is; where boxes differ much in size, it may become 1 for all of
 * them. Fastest where boxes that follow one another meet. Returns 0, or -1 where memory cannot be
 * had. */
int neighbours_find(struct neighbours *neighbours, const double (*boxes)[6], int count,
                    unsigned char *near);

#endif
