#include "wisp.h"

#include <math.h>

void wind_velocity(const struct wind *wind, double t, double velocity[3]) {
    double factor = wind->kind == WIND_NONE ? 0 : 1;
    if (wind->kind == WIND_GUST && t > wind->hold)
        factor = exp(-(t - wind->hold) / wind->decay);
    for (int k = 0; wind->kind == WIND_IRREGULAR && k < wind->terms; k++)
        factor += wind->amplitude[k] * sin(2 * M_PI * wind->frequency[k] * t);
    for (int k = 0; k < 3; k++)
        velocity[k] = factor * wind->velocity[k];
}

void wind_rate(const struct wind *wind, double inside, double t, double rate[3]) {
    const double since = t - wind->hold;
    double factor = 0;
    if (wind->kind == WIND_GUST && inside > wind->hold)
        factor = -exp(-since / wind->decay) / wind->decay;
    for (int k = 0; wind->kind == WIND_IRREGULAR && k < wind->terms; k++) {
        const double omega = 2 * M_PI * wind->frequency[k];
        factor += wind->amplitude[k] * omega * cos(omega * t);
    }
    for (int k = 0; k < 3; k++)
        rate[k] = factor * wind->velocity[k];
}

double wisp_spacing(const struct wisp *wisp) {
    return wisp->length / (wisp->nodes - 1);
}

/* All of the hair between the middles of the segments at the node. */
static double tributary_mass(const struct wisp *wisp, int node) {
    const double whole = wisp->hair_count * wisp->hair_density * wisp_spacing(wisp);
    return node == wisp->nodes - 1 ? whole / 2 : whole;
}

double wisp_node_mass(const struct wisp *wisp, int node) {
    const double fraction = wisp->samples > 0 ? wisp->mass_fraction : 0;
    return (1 - fraction) * tributary_mass(wisp, node);
}

double wisp_sample_mass(const struct wisp *wisp, int node) {
    return wisp->samples > 0 ? wisp->mass_fraction * tributary_mass(wisp, node) / wisp->samples : 0;
}

double wisp_stretch_constant(const struct wisp *wisp) {
    return wisp->stretch_stiffness / wisp_spacing(wisp);
}

double wisp_bending_constant(const struct wisp *wisp) {
    const double l = wisp_spacing(wisp), angle = wisp->bending_angle;
    if (wisp->bending == BENDING_NONE)
        return 0;
    return wisp->bending == BENDING_HINGE
               ? wisp->bending_stiffness / l
               : 16 * wisp->bending_stiffness / (l * l * l * angle * angle);
}

int wisp_node_unknowns(const struct wisp *wisp, enum wisp_treatment treatment) {
    return 3 + (treatment == WISP_PENALTY ? 3 : 1) * wisp->samples;
}

void wisp_sample_way(int samples, int j, double way[2]) {
    static const double quarter[] = {1, 0, -1, 0, 1};
    const int exact = 4 * j % samples == 0, q = 4 * j / samples;
    const double angle = 2 * M_PI * j / samples;
    way[0] = exact ? quarter[q] : cos(angle);
    way[1] = exact ? quarter[(q + 3) % 4] : sin(angle);
}

void wisp_first_normal(const double tangent[3], double normal[3]) {
    const int axis = fabs(tangent[1]) > 0.9 ? 0 : 1;
    double square = 0;
    for (int k = 0; k < 3; k++) {
        normal[k] = (k == axis) - tangent[axis] * tangent[k];
        square += normal[k] * normal[k];
    }
    for (int k = 0; k < 3; k++)
        normal[k] /= sqrt(square);
}
