/* Largest error of each scalar function, in units in the last place of its result.
 *
 * errors FIRST LAST: float, over all bit patterns from FIRST to LAST of the sign-less half (0 to 7F800000) and their
 * negatives. errors SAMPLES: double, over this number of seeded samples.
 * The references are the C library's double functions for float and its long double ones for double: their errors are
 * below a thousandth of the unit they are compared in. */
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "generator.h"
#include "giveway/gw_math.h"

#if (GW_REAL_DOUBLE == 1)
typedef long double reference_t;
#define OF(function) function##l
#define DIGITS DBL_MANT_DIG
#define LOWEST_EXPONENT DBL_MIN_EXP
#define EPSILON ((reference_t)DBL_EPSILON / 2)
#else
typedef double reference_t;
#define OF(function) function
#define DIGITS FLT_MANT_DIG
#define LOWEST_EXPONENT FLT_MIN_EXP
#define EPSILON ((reference_t)FLT_EPSILON / 2)
#endif

enum { SQRT, EXP, EXPM1, TANH, SIN, COS, SIN_FAR, COS_FAR, ATAN2, FUNCTIONS };

static const char *const names[FUNCTIONS] = {"sqrt", "exp",     "expm1",   "tanh", "sin",
                                             "cos",  "sin_far", "cos_far", "atan2"};

typedef struct {
    reference_t error;
    gw_real_t at;
} worst_t;

static worst_t worst[FUNCTIONS];

static void note(int function, gw_real_t x, gw_real_t found, reference_t expected)
{
    const reference_t difference = OF(fabs)((reference_t)found - expected);
    /* A unit in the last place is at least 2^-DIGITS of the number, so most errors need no closer look. NaN does. */
    if (!(difference <= (worst[function].error * OF(fabs)(expected) * EPSILON))) {
        int exponent = 0;
        (void)OF(frexp)(expected, &exponent);
        const int lowest = (exponent < LOWEST_EXPONENT) ? LOWEST_EXPONENT : exponent;
        const reference_t error = OF(ldexp)(difference, DIGITS - lowest);
        if (!(error <= worst[function].error)) {
            worst[function].error = error;
            worst[function].at = x;
        }
    }
}

/* Far from 0, near a zero of the sine, the error is that of the angle's reduction: measured in units of the last place
 * of 1. */
static void note_far(int function, gw_real_t x, gw_real_t found, reference_t expected)
{
    const reference_t error = OF(fabs)((reference_t)found - expected) / ((reference_t)2 * EPSILON);
    if (!(error <= worst[function].error)) {
        worst[function].error = error;
        worst[function].at = x;
    }
}

static void expect(bool holds, gw_real_t x)
{
    if (!holds) {
        (void)printf("not symmetric at %a\n", (double)x);
        exit(1);
    }
}

/* The domains on which the header promises more than a limit value. */
#if (GW_REAL_DOUBLE == 1)
static const gw_real_t exp_lowest = -708.0, exp_highest = 709.0;
#else
static const gw_real_t exp_lowest = -87.0F, exp_highest = 88.0F;
#endif

static void one_argument(gw_real_t x)
{
    const reference_t exact = (reference_t)x;
    if (x >= GW_ZERO) {
        note(SQRT, x, gw_sqrt(x), OF(sqrt)(exact));
    }
    if ((x >= exp_lowest) && (x <= exp_highest)) {
        note(EXP, x, gw_exp(x), OF(exp)(exact));
    }
    if (x <= exp_highest) {
        note(EXPM1, x, gw_expm1(x), OF(expm1)(exact));
    }
}

/* Odd and even functions: for -x it is only checked that the bits are the same. */
static void symmetric(gw_real_t x)
{
    const reference_t exact = (reference_t)x;
    const gw_real_t tanh_x = gw_tanh(x);
    note(TANH, x, tanh_x, OF(tanh)(exact));
    expect(gw_tanh(-x) == -tanh_x, x);
    if (x <= GW_ANGLE_MAX) {
        const gw_rotation_t rotation = gw_sincos(x);
        const gw_rotation_t mirrored = gw_sincos(-x);
        const reference_t sine = OF(sin)(exact);
        const reference_t cosine = OF(cos)(exact);
        if (x <= GW_PI) {
            note(SIN, x, rotation.sine, sine);
            note(COS, x, rotation.cosine, cosine);
        }
        note_far(SIN_FAR, x, rotation.sine, sine);
        note_far(COS_FAR, x, rotation.cosine, cosine);
        expect((mirrored.sine == -rotation.sine) && (mirrored.cosine == rotation.cosine), x);
    }
}

static void two_arguments(gw_real_t y, gw_real_t x)
{
    note(ATAN2, y, gw_atan2(y, x), OF(atan2)((reference_t)y, (reference_t)x));
}

/* Quotients of every size, and both arguments near each other. */
static void search_atan2(generator_t *generator, uint32_t samples)
{
    for (uint32_t i = 0U; i < samples; i++) {
        const gw_vector_t vector = generator_vector(generator, GW_ONE);
        const gw_real_t y = (gw_real_t)ldexp((double)vector.y, -(int)generator_below(generator, 24U));
        two_arguments(y, vector.x);
        two_arguments(vector.x, y);
    }
}

#if (GW_REAL_DOUBLE == 1)
static void sample(gw_real_t x)
{
    one_argument(x);
    symmetric(gw_abs(x));
}

static void search(generator_t *generator, uint32_t samples)
{
    for (uint32_t i = 0U; i < samples; i++) {
        const gw_real_t fine = generator_between(generator, GW_ZERO, GW_ONE) * (gw_real_t)5.9604644775390625e-08;
        sample(generator_between(generator, (gw_real_t)-1.0, (gw_real_t)1.0) + fine);
        sample(generator_between(generator, (gw_real_t)-20.0, (gw_real_t)20.0) + fine);
        sample(generator_between(generator, (gw_real_t)-1000.0, (gw_real_t)1000.0) + fine);
        sample(generator_between(generator, -GW_ANGLE_MAX, GW_ANGLE_MAX) + fine);
        const gw_real_t any = generator_any(generator);
        if (gw_is_finite(any)) {
            sample(any);
        }
    }
}
#endif

int main(int count, char **arguments)
{
    generator_t generator = generator_begin(300U);
#if (GW_REAL_DOUBLE == 1)
    const uint32_t samples = (count > 1) ? (uint32_t)strtoul(arguments[1], NULL, 10) : 0U;
    search(&generator, samples);
    search_atan2(&generator, samples);
#else
    const uint32_t first = (count > 2) ? (uint32_t)strtoul(arguments[1], NULL, 16) : 0U;
    const uint32_t last = (count > 2) ? (uint32_t)strtoul(arguments[2], NULL, 16) : 0U;
    for (uint32_t bits = first; bits < last; bits++) {
        gw_real_t x;
        memcpy(&x, &bits, sizeof x);
        one_argument(x);
        one_argument(-x);
        symmetric(x);
    }
    search_atan2(&generator, (last - first) / 256U);
#endif
    for (int i = 0; i < FUNCTIONS; i++) {
        (void)printf("%s %.4f %a\n", names[i], (double)worst[i].error, (double)worst[i].at);
    }
    return 0;
}
