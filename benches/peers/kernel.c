/* The jobs in C, in blocks that stay in the first-level cache.

   Compiled at run time with
     WORK, STORE   types to compute in and to store
     VML           1: tangent and arc tangent by the functions handed to `use`
     LANES         or functions TAN and ATAN of so many doubles
   and otherwise with those of <math.h>, which -ffast-math turns into calls of libmvec. */
#include <tgmath.h>

typedef WORK work;
typedef STORE store;
enum { BLOCK = 1024 };
enum { ANGLE, MOTION, MOMENT, CHAIN, SWEEP };

#define LOOP for (long i = 0; i < m; i++)
#define SINGLE (sizeof(work) == sizeof(float))
#define ROWS store *restrict o0, store *restrict o1, store *restrict o2, const work *k
#define ONE const work cosine = k[0], square = k[1], versine = k[2], slope = k[3]

/* Takes half turns off in double, so that what is left can be rounded to single. */
static inline work reduced(double a) {
    const double high = 3.1415926218032837, low = 3.178650954705639e-08;
    double turns = SINGLE ? rint(a * (1 / (high + low))) : 0;
    return (a - turns * high) - turns * low;
}

#if VML
typedef void unary(long, const double *, double *, long);
static unary *vml_tan, *vml_atan;
static long vml_mode;
void use(unary *tangent, unary *arc, long mode) {
    vml_tan = tangent, vml_atan = arc, vml_mode = mode;
}
static void tangents(long m, const double *a, work *t) { vml_tan(m, a, t, vml_mode); }
static void arcs(long m, work *x) { vml_atan(m, x, x, vml_mode); }
#elif defined LANES
#include <string.h>
typedef double lanes __attribute__((vector_size(8 * LANES)));
extern lanes TAN(lanes), ATAN(lanes);
#define SOME(f, from, to, size)                                                                    \
    {                                                                                              \
        lanes some = {0};                                                                          \
        memcpy(&some, (from) + i, size);                                                           \
        some = f(some);                                                                            \
        memcpy((to) + i, &some, size);                                                             \
    }
#define BY_LANES(f, from, to)                                                                      \
    long i = 0;                                                                                    \
    for (; i + LANES <= m; i += LANES) SOME(f, from, to, 8 * LANES)                                \
    if (i < m) SOME(f, from, to, 8 * (m - i))
static void tangents(long m, const double *a, work *t) { BY_LANES(TAN, a, t) }
static void arcs(long m, work *x) { BY_LANES(ATAN, x, x) }
#else
static void tangents(long m, const double *a, work *t) { LOOP t[i] = tan(reduced(a[i])); }
static void arcs(long m, work *x) { LOOP x[i] = atan(x[i]); }
#endif

static void finish(long m, const double *restrict a, work *restrict x, store *restrict o) {
    arcs(m, x);
    LOOP o[i] = a[i] + x[i];
}

static void angle(long m, const double *restrict a, store *restrict o0, const work *k) {
    const work cosine = k[0], versine = k[2];
    work t[BLOCK];
    tangents(m, a, t);
    LOOP t[i] = versine * t[i] / (cosine + t[i] * t[i]);
    finish(m, a, t, o0);
}

static void motion(long m, const double *restrict a, ROWS) {
    ONE;
    work t[BLOCK];
    tangents(m, a, t);
    LOOP {
        work t2 = t[i] * t[i], below = 1 / (t2 + square), ratio = cosine * (1 + t2) * below;
        o1[i] = ratio;
        o2[i] = slope * t[i] * below * ratio;
        t[i] = versine * t[i] / (cosine + t2);
    }
    finish(m, a, t, o0);
}

static void moment(long m, const double *restrict a, ROWS) {
    const work torque = k[4], bending = k[5];
    work t[BLOCK];
    tangents(m, a, t);
    LOOP o0[i] = torque;
    LOOP {
        work part = bending * t[i] / (1 + t[i] * t[i]);
        o1[i] = part * t[i];
        o2[i] = -part;
    }
}

static void chain(long m, const double *restrict a, ROWS) {
    const work n0 = k[0], n1 = k[1], d0 = k[2], d1 = k[3], d2 = k[4], whole = k[5];
    const work a0 = k[6], a1 = k[7], a2 = k[8], middle = 2 * (k[6] - k[8]);
    work x[BLOCK];
    tangents(m, a, x);
    LOOP {
        work t = x[i], below = 1 / (a0 + t * (a1 + t * a2)), ratio = whole * (1 + t * t) * below;
        o1[i] = ratio;
        o2[i] = ratio * ((t * a1 + middle) * t - a1) * below;
        x[i] = (n0 + t * (n1 - t * n0)) / (d0 + t * (d1 + t * d2));
    }
    finish(m, a, x, o0);
}

/* Sines of a uniform sweep by the addition theorem: one pair per block, one table per call. */
static void sweep(long m, const double *restrict a, const work *restrict st,
                  const work *restrict ct, ROWS) {
    ONE;
    const work first = reduced(a[0]), s0 = sin(first), c0 = cos(first);
    work x[BLOCK];
    LOOP {
        work s = s0 * ct[i] + c0 * st[i], c = c0 * ct[i] - s0 * st[i], sc = s * c;
        work below = 1 / (s * s + c * c * square), ratio = cosine * below;
        o1[i] = ratio;
        o2[i] = slope * sc * below * ratio;
        x[i] = versine * sc / (s * s + c * c * cosine);
    }
    finish(m, a, x, o0);
}

/* Fill rows of n results at o, a row every `stride`; a sweep has a step and no angles. */
void run(int kernel, long n, const double *angles, double step, store *o, long stride,
         const work *k, int threads) {
    work st[BLOCK], ct[BLOCK];
    if (kernel == SWEEP)
        for (long i = 0; i < BLOCK; i++) st[i] = sin((work)(i * step)), ct[i] = cos((work)(i * step));
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1)
    for (long from = 0; from < n; from += BLOCK) {
        long m = n - from < BLOCK ? n - from : BLOCK;
        store *o0 = o + from, *o1 = o0 + stride, *o2 = o1 + stride;
        const double *a = angles + from;
        double own[BLOCK];
        if (kernel == SWEEP) {
            LOOP own[i] = (from + i) * step;
            a = own;
        }
        switch (kernel) {
        case ANGLE: angle(m, a, o0, k); break;
        case MOTION: motion(m, a, o0, o1, o2, k); break;
        case MOMENT: moment(m, a, o0, o1, o2, k); break;
        case CHAIN: chain(m, a, o0, o1, o2, k); break;
        case SWEEP: sweep(m, a, st, ct, o0, o1, o2, k); break;
        }
    }
}
