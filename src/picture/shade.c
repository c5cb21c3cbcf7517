#include "shade.h"

#include "base/vector.h"

/* The diffuse term's normal is n = unit(l'), l' being what is left of the light l across the
 * tangent: n.l = |l'|, the sine of the angle between light and hair. The specular one's is the
 * bisector of l' and e', the same of the eye: across the tangent it turns l' to the direction of
 * e', and along it the reflection 2 (n.l) n - l is -(t.l) t. So
 *
 *     reflection . eye = |l'| |e'| - (t.l) (t.e),
 *
 * where no bisector is left to be made: where l' or e' vanishes, any normal gives the same number,
 * which has no part of it; and where they are opposite, n is across both, and turns l' round. */
struct shine shade_hair(const double tangent[3], const double light[3], const double eye[3],
                        double gloss) {
    const double along_light = vector_dot(tangent, light), along_eye = vector_dot(tangent, eye);
    const double across_light = sqrt(fmax(0, 1 - along_light * along_light)),
                 across_eye = sqrt(fmax(0, 1 - along_eye * along_eye));
    const double reflected = across_light * across_eye - along_light * along_eye;
    return (struct shine){across_light, reflected > 0 ? pow(fmin(1, reflected), gloss) : 0};
}
