#include "sundials_support.h"

#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdio.h>

#if SUNDIALS_VERSION_MAJOR < 7
void sundials_keep_message(int code, const char *module, const char *function, char *text,
                           void *sundials) {
    (void)code, (void)module, (void)function;
    struct sundials *s = sundials;
    snprintf(s->message, sizeof s->message, "%s", text);
}

static void keep_messages(struct sundials *sundials) {
    (void)sundials; /* each integrator is told */
}
#else
static void keep_message(int line, const char *function, const char *file, const char *text,
                         SUNErrCode code, void *sundials, SUNContext context) {
    (void)line, (void)function, (void)file, (void)context;
    struct sundials *s = sundials;
    snprintf(s->message, sizeof s->message, "%s", text ? text : SUNGetErrMsg(code));
}

static void keep_messages(struct sundials *sundials) {
    SUNContext_ClearErrHandlers(sundials->context);
    SUNContext_PushErrHandler(sundials->context, keep_message, sundials);
}
#endif

int sundials_open(struct sundials *sundials) {
    sundials->message[0] = '\0';
    if (SUNContext_Create(SUN_COMM_NULL, &sundials->context) < 0)
        return -1;
    keep_messages(sundials);
    return 0;
}

void sundials_close(struct sundials *sundials) {
    SUNContext_Free(&sundials->context);
}

/* The vector operations. Debian compiles SUNDIALS without optimisation: a step of CVODE on 72
 * unknowns took 7.5 us with the loops of the library and 1.5 us with these. A result may be one of
 * the operands, hence no restrict; a pragma to vectorise regardless gained 5 % and is not here. */
static void linear_sum(sunrealtype a, N_Vector x, sunrealtype b, N_Vector y, N_Vector z) {
    for (sunindextype i = 0; i < NV_LENGTH_S(z); i++)
        NV_Ith_S(z, i) = a * NV_Ith_S(x, i) + b * NV_Ith_S(y, i);
}

static void set_constant(sunrealtype c, N_Vector z) {
    for (sunindextype i = 0; i < NV_LENGTH_S(z); i++)
        NV_Ith_S(z, i) = c;
}

static void product(N_Vector x, N_Vector y, N_Vector z) {
    for (sunindextype i = 0; i < NV_LENGTH_S(z); i++)
        NV_Ith_S(z, i) = NV_Ith_S(x, i) * NV_Ith_S(y, i);
}

static void quotient(N_Vector x, N_Vector y, N_Vector z) {
    for (sunindextype i = 0; i < NV_LENGTH_S(z); i++)
        NV_Ith_S(z, i) = NV_Ith_S(x, i) / NV_Ith_S(y, i);
}

static void scale(sunrealtype c, N_Vector x, N_Vector z) {
    for (sunindextype i = 0; i < NV_LENGTH_S(z); i++)
        NV_Ith_S(z, i) = c * NV_Ith_S(x, i);
}

static void absolute(N_Vector x, N_Vector z) {
    for (sunindextype i = 0; i < NV_LENGTH_S(z); i++)
        NV_Ith_S(z, i) = fabs(NV_Ith_S(x, i));
}

static void inverse(N_Vector x, N_Vector z) {
    for (sunindextype i = 0; i < NV_LENGTH_S(z); i++)
        NV_Ith_S(z, i) = 1 / NV_Ith_S(x, i);
}

static void add_constant(N_Vector x, sunrealtype b, N_Vector z) {
    for (sunindextype i = 0; i < NV_LENGTH_S(z); i++)
        NV_Ith_S(z, i) = NV_Ith_S(x, i) + b;
}

static sunrealtype dot_product(N_Vector x, N_Vector y) {
    sunrealtype sum = 0;
    for (sunindextype i = 0; i < NV_LENGTH_S(x); i++)
        sum += NV_Ith_S(x, i) * NV_Ith_S(y, i);
    return sum;
}

static sunrealtype max_norm(N_Vector x) {
    sunrealtype most = 0;
    for (sunindextype i = 0; i < NV_LENGTH_S(x); i++)
        most = fabs(NV_Ith_S(x, i)) > most ? fabs(NV_Ith_S(x, i)) : most;
    return most;
}

static sunrealtype weighted_rms_norm(N_Vector x, N_Vector w) {
    sunrealtype sum = 0;
    for (sunindextype i = 0; i < NV_LENGTH_S(x); i++)
        sum += NV_Ith_S(x, i) * NV_Ith_S(w, i) * (NV_Ith_S(x, i) * NV_Ith_S(w, i));
    return sqrt(sum / (sunrealtype)NV_LENGTH_S(x));
}

static sunrealtype minimum(N_Vector x) {
    sunrealtype least = NV_Ith_S(x, 0);
    for (sunindextype i = 1; i < NV_LENGTH_S(x); i++)
        least = NV_Ith_S(x, i) < least ? NV_Ith_S(x, i) : least;
    return least;
}

/* Only the first operand may be the result. */
static int linear_combination(int count, sunrealtype *c, N_Vector *x, N_Vector z) {
    if (count == 1) {
        scale(c[0], x[0], z);
        return 0;
    }
    linear_sum(c[0], x[0], c[1], x[1], z);
    for (int k = 2; k < count; k++)
        linear_sum(c[k], x[k], 1, z, z);
    return 0;
}

static int scale_add_multi(int count, sunrealtype *a, N_Vector x, N_Vector *y, N_Vector *z) {
    for (int k = 0; k < count; k++)
        linear_sum(a[k], x, 1, y[k], z[k]);
    return 0;
}

static int dot_product_multi(int count, N_Vector x, N_Vector *y, sunrealtype *dots) {
    for (int k = 0; k < count; k++)
        dots[k] = dot_product(x, y[k]);
    return 0;
}

N_Vector sundials_vector(struct sundials *sundials, int size) {
    N_Vector vector = N_VNew_Serial(size, sundials->context);
    if (!vector)
        return NULL;
    N_Vector_Ops ops = vector->ops;
    ops->nvlinearsum = linear_sum;
    ops->nvconst = set_constant;
    ops->nvprod = product;
    ops->nvdiv = quotient;
    ops->nvscale = scale;
    ops->nvabs = absolute;
    ops->nvinv = inverse;
    ops->nvaddconst = add_constant;
    ops->nvdotprod = dot_product;
    ops->nvmaxnorm = max_norm;
    ops->nvwrmsnorm = weighted_rms_norm;
    ops->nvmin = minimum;
    ops->nvlinearcombination = linear_combination;
    ops->nvscaleaddmulti = scale_add_multi;
    ops->nvdotprodmulti = dot_product_multi;
    set_constant(0, vector);
    return vector;
}
