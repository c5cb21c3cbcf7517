/* Arithmetic on LANES wisps side by side. Every file of the kernel is compiled three times, for
 * parts of 1, of 4 and of 8 wisps: the same operations in the same order, so that a wisp's bits do
 * not depend on how it is packed. Names that leave the folder carry the kernel's. A compiler
 * without registers of that width takes several. */
#ifndef WISPLAB_LANES_H
#define WISPLAB_LANES_H

#include <math.h>
#include <string.h>
#ifdef __AVX__
#include <immintrin.h>
#endif

#ifndef LANES
#define LANES 1 /* for editors; the build always says */
#endif
#ifndef KERNEL
#define KERNEL LANES /* the kernel's name: wide_4 and wide_8 are for wider registers */
#endif

#define LANED_2(name, kernel) name##_##kernel
#define LANED_1(name, kernel) LANED_2(name, kernel)
#define LANED(name)           LANED_1(name, KERNEL)

/* For functions whose arguments become constants where they are inlined: the compiler makes one
 * body for all otherwise. */
#define SPECIALISED static inline __attribute__((always_inline))

/* Loops with constant bounds over arrays that are to live in registers. */
#define EACH(i, from, to)      _Pragma("GCC unroll 16") for (int i = (from); i < (to); i++)
#define EACH_DOWN(i, from, to) _Pragma("GCC unroll 16") for (int i = (from); i >= (to); i--)

#if LANES == 1
typedef double lane;
typedef int mask;
#else
typedef double lane __attribute__((vector_size(8 * LANES)));
typedef long long mask __attribute__((vector_size(8 * LANES)));
#endif

/* Unknown number i of every lane; vectors need only the alignment of a double. */
static inline lane load(const double *x, int i) {
    lane y;
    memcpy(&y, x + LANES * i, sizeof y);
    return y;
}

static inline void store(double *x, int i, lane y) {
    memcpy(x + LANES * i, &y, sizeof y);
}

#if LANES == 1
static inline lane lane_all(double x) {
    return x;
}
static inline lane lane_sqrt(lane x) {
    return sqrt(x);
}
static inline lane lane_select(mask m, lane yes, lane no) {
    return m ? yes : no;
}
static inline lane lane_max(lane a, lane b) {
    return a > b ? a : b;
}
static inline lane lane_min(lane a, lane b) {
    return a < b ? a : b;
}
static inline int mask_all(mask m) {
    return m != 0;
}
static inline int mask_none(mask m) {
    return m == 0;
}
static inline unsigned mask_bits(mask m) {
    return m != 0;
}
static inline mask mask_of_bits(unsigned bits) {
    return bits & 1;
}
static inline double lane_get(lane x, int k) {
    (void)k;
    return x;
}
static inline void lane_set(lane *x, int k, double value) {
    (void)k;
    *x = value;
}
#else
static inline lane lane_all(double x) {
    return x - (lane){0};
}
/* Compilers that spare the widest registers find two instructions in the loop. */
static inline lane lane_sqrt(lane x) {
#if LANES == 8 && defined(__AVX512F__)
    return (lane)_mm512_sqrt_pd((__m512d)x);
#else
    lane y;
    for (int k = 0; k < LANES; k++)
        y[k] = sqrt(x[k]);
    return y;
#endif
}
static inline lane lane_select(mask m, lane yes, lane no) {
    return (lane)((m & (mask)yes) | (~m & (mask)no));
}
/* b where one of them is no number, as the instruction has it, which compilers do not find. */
static inline lane lane_max(lane a, lane b) {
#if LANES == 4 && defined(__AVX__)
    return (lane)_mm256_max_pd((__m256d)a, (__m256d)b);
#elif LANES == 8 && defined(__AVX512F__)
    return (lane)_mm512_max_pd((__m512d)a, (__m512d)b);
#else
    return lane_select(a > b, a, b);
#endif
}
static inline lane lane_min(lane a, lane b) {
#if LANES == 4 && defined(__AVX__)
    return (lane)_mm256_min_pd((__m256d)a, (__m256d)b);
#elif LANES == 8 && defined(__AVX512F__)
    return (lane)_mm512_min_pd((__m512d)a, (__m512d)b);
#else
    return lane_select(a < b, a, b);
#endif
}
/* Bit k for lane k; compilers do not find the one instruction in the loop. */
static inline unsigned mask_bits(mask m) {
#if LANES == 4 && defined(__AVX__)
    return (unsigned)_mm256_movemask_pd((__m256d)m);
#elif LANES == 8 && defined(__AVX512F__)
    return _mm512_test_epi64_mask((__m512i)m, (__m512i)m);
#else
    unsigned bits = 0;
    for (int k = 0; k < LANES; k++)
        bits |= (unsigned)(m[k] != 0) << k;
    return bits;
#endif
}
static inline mask mask_of_bits(unsigned bits) {
    mask m = {0};
    for (int k = 0; k < LANES; k++)
        m[k] = -(long long)(bits >> k & 1);
    return m;
}
static inline int mask_all(mask m) {
    return mask_bits(m) == (1u << LANES) - 1;
}
static inline int mask_none(mask m) {
    return mask_bits(m) == 0;
}
static inline double lane_get(lane x, int k) {
    return x[k];
}
static inline void lane_set(lane *x, int k, double value) {
    (*x)[k] = value;
}
#endif

/* Vectors in space. */
struct vec {
    lane x, y, z;
};

static inline struct vec vec_load(const double *x, int i) {
    return (struct vec){load(x, i), load(x, i + 1), load(x, i + 2)};
}

static inline void vec_store(double *x, int i, struct vec a) {
    store(x, i, a.x);
    store(x, i + 1, a.y);
    store(x, i + 2, a.z);
}

/* One lane of a vector, as three numbers. */
static inline void vec_get(double *to, struct vec x, int which) {
    to[0] = lane_get(x.x, which);
    to[1] = lane_get(x.y, which);
    to[2] = lane_get(x.z, which);
}

static inline void vec_set(struct vec *to, int which, const double x[3]) {
    lane_set(&to->x, which, x[0]);
    lane_set(&to->y, which, x[1]);
    lane_set(&to->z, which, x[2]);
}

/* The same vector in all lanes. */
static inline struct vec vec_all(const double x[3]) {
    return (struct vec){lane_all(x[0]), lane_all(x[1]), lane_all(x[2])};
}

static inline struct vec add(struct vec a, struct vec b) {
    return (struct vec){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline struct vec sub(struct vec a, struct vec b) {
    return (struct vec){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline struct vec scale(lane s, struct vec a) {
    return (struct vec){s * a.x, s * a.y, s * a.z};
}

/* a + s b */
static inline struct vec add_scaled(struct vec a, lane s, struct vec b) {
    return (struct vec){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

static inline lane dot(struct vec a, struct vec b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline struct vec cross(struct vec a, struct vec b) {
    return (struct vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline struct vec vec_select(mask m, struct vec yes, struct vec no) {
    return (struct vec){lane_select(m, yes.x, no.x), lane_select(m, yes.y, no.y),
                        lane_select(m, yes.z, no.z)};
}

#endif
