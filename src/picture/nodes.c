#include "nodes.h"

#include "base/vector.h"
#include "wisp/section.h"

#include <string.h>

/* The strain of the segment from node i to the next; those of the head do not stretch. */
static double segment_strain(const struct strand *strand, int i) {
    double d[3] = {strand->p[i + 1][0], strand->p[i + 1][1], strand->p[i + 1][2]};
    vector_add(d, -1, strand->p[i]);
    return vector_length(d) / wisp_spacing(strand->wisp) - 1;
}

double node_strain(const struct strand *strand, int node) {
    const int last = strand->wisp->nodes - 1;
    const double before = node > 0 ? segment_strain(strand, node - 1) : 0,
                 after = node < last ? segment_strain(strand, node) : 0;
    return node == 0 ? after : node == last ? before : 0.5 * (before + after);
}

double node_radius(const struct strand *strand, int node) {
    const int samples = strand->wisp->samples;
    double sum = 0;
    for (int j = 0; j < samples; j++)
        sum += strand->r[node * samples + j];
    return samples > 0 ? sum / samples : 0;
}

void node_rim(const struct strand *strand, int node, double turn, double point[3]) {
    const double rho = section_rim(strand, node, turn);
    memcpy(point, strand->p[node], sizeof strand->p[node]);
    vector_add(point, rho * cos(2 * M_PI * turn), strand->axis_u[node]);
    vector_add(point, rho * sin(2 * M_PI * turn), strand->axis_v[node]);
}
