/* The sentences under the figures of experiments, computed from their tables: what is said of a
 * figure follows the data, whatever they are. The contract is that of struct experiment's caption.
 */
#ifndef WISPLAB_CAPTIONS_H
#define WISPLAB_CAPTIONS_H

#include "experiments/common/plan.h"

int caption_circle(const char *folder, const char *figure, struct caption *caption, char *reason);
int caption_treatments(const char *folder, const char *figure, struct caption *caption,
                       char *reason);
int caption_race(const char *folder, const char *figure, struct caption *caption, char *reason);
int caption_horizon(const char *folder, const char *figure, struct caption *caption, char *reason);
int caption_ladder(const char *folder, const char *figure, struct caption *caption, char *reason);
int caption_hair(const char *folder, const char *figure, struct caption *caption, char *reason);
int caption_stability(const char *folder, const char *figure, struct caption *caption,
                      char *reason);
int caption_needs(const char *folder, const char *figure, struct caption *caption, char *reason);
int caption_kernel(const char *folder, const char *figure, struct caption *caption, char *reason);

#endif
