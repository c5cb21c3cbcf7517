/* How a hair is lit (Plante 1999, appendix A): it is a thin smooth cylinder, and of all its normals
 * in a pixel the one that shines most counts. */
#ifndef WISPLAB_SHADE_H
#define WISPLAB_SHADE_H

struct shine {
    double diffuse;  /* normal . light, from 0 to 1 */
    double specular; /* (reflected light . eye)^gloss, from 0 to 1 */
};

/* `tangent`, `light` (towards it) and `eye` (towards it) are unit vectors. */
struct shine shade_hair(const double tangent[3], const double light[3], const double eye[3],
                        double gloss);

#endif
