/* Scalar functions from + - * / alone, so that every compiler and processor gives the same bits.
 *
 * Every function is defined for every input. Largest errors, in units in the last place of the result: for float
 * measured over every float in the domain (atan2: searched), for double searched. The rung "elementary" of
 * `make verify` holds them.
 *     sqrt     0.5  0.5
 *     exp      1.0  1.0
 *     expm1    1.5  2.0
 *     tanh     2.5  2.5
 *     sin      1.6  1.5
 *     cos      1.6  1.5
 *     sin_far  0.75 0.75
 *     cos_far  0.75 0.75
 *     atan2    3.0  3.5
 * sin, cos: angles up to pi; "far": all angles up to GW_ANGLE_MAX, in units in the last place of 1.
 */
#ifndef GW_MATH_H
#define GW_MATH_H

#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

#define GW_ZERO ((gw_real_t)0.0)
#define GW_HALF ((gw_real_t)0.5)
#define GW_ONE ((gw_real_t)1.0)
#define GW_TWO ((gw_real_t)2.0)
#define GW_PI ((gw_real_t)3.141592653589793238462643)
/* Largest magnitude that gw_sincos and gw_wrap_angle take. */
#define GW_ANGLE_MAX ((gw_real_t)1.0e4)

/* Short functions are inline: called, they would be a quarter of a step's instructions. */

/* True if low <= x <= high; false for NaN. */
static inline bool gw_in_range(gw_real_t x, gw_real_t low, gw_real_t high)
{
    return (x >= low) && (x <= high);
}

/* |x|; NaN stays NaN. */
static inline gw_real_t gw_abs(gw_real_t x)
{
    return (x < GW_ZERO) ? -x : x;
}

/* The smaller and the larger argument; b if a is NaN. */
static inline gw_real_t gw_min(gw_real_t a, gw_real_t b)
{
    return (a < b) ? a : b;
}

static inline gw_real_t gw_max(gw_real_t a, gw_real_t b)
{
    return (a > b) ? a : b;
}

/* x limited to [low, high], low <= high; low if x is NaN. */
static inline gw_real_t gw_clamp(gw_real_t x, gw_real_t low, gw_real_t high)
{
    return gw_min(gw_max(x, low), high);
}

/* 1 where |x| of a float is one instruction. A range around zero then takes one comparison instead of two, with the
 * same result. */
#if defined(__GNUC__) && defined(__arm__) && defined(__ARM_FP) && ((__ARM_FP & 4) != 0) && (GW_REAL_DOUBLE == 0)
#define GW_ARM_FLOAT 1
#else
#define GW_ARM_FLOAT 0
#endif
/* 1 if the processor has a square root instruction. -DGW_HARDWARE_SQRT=0 selects the portable one, as provers do. */
#ifndef GW_HARDWARE_SQRT
#if (GW_ARM_FLOAT == 1) || (defined(__GNUC__) && defined(__SSE2__))
#define GW_HARDWARE_SQRT 1
#else
#define GW_HARDWARE_SQRT 0
#endif
#endif

/* |x| for comparisons only: the sign of a zero depends on the machine. */
static inline gw_real_t gw_magnitude(gw_real_t x)
{
#if (GW_ARM_FLOAT == 1)
    return __builtin_fabsf(x);
#else
    return gw_abs(x);
#endif
}

/* True if -limit <= x <= limit; false for NaN. limit > 0 here and below. */
static inline bool gw_within(gw_real_t x, gw_real_t limit)
{
#if (GW_ARM_FLOAT == 1)
    return gw_magnitude(x) <= limit;
#else
    return (x >= -limit) && (x <= limit);
#endif
}

/* x limited to [-limit, limit]; -limit if x is NaN. */
static inline gw_real_t gw_limited(gw_real_t x, gw_real_t limit)
{
#if (GW_ARM_FLOAT == 1)
    return (gw_magnitude(x) <= limit) ? x : ((x > limit) ? limit : -limit);
#else
    return (x >= -limit) ? ((x <= limit) ? x : limit) : -limit;
#endif
}

/* x, which gw_within has found within the limit: only provers that look at ranges need to be told. On Cortex-M4F the
 * longest steps are 23 to 43 instructions shorter than with gw_limited, and the program is 0.6 to 0.8 kB smaller. */
static inline gw_real_t gw_known_within(gw_real_t x, gw_real_t limit)
{
#if defined(__FRAMAC__)
    return gw_limited(x, limit);
#else
    (void)limit;
    return x;
#endif
}

/* value, moved towards target by a share of the difference. With 0 <= share <= 0.5 it keeps a limit that both keep:
 * verify/esbmc/approach.c proves it, so only provers that look at ranges need to be told. */
static inline gw_real_t gw_approached(gw_real_t value, gw_real_t target, gw_real_t share, gw_real_t limit)
{
    const gw_real_t moved = value + (share * (target - value));
#if defined(__FRAMAC__)
    return gw_limited(moved, limit);
#else
    (void)limit;
    return moved;
#endif
}

/* True unless x is NaN or infinite. */
static inline bool gw_is_finite(gw_real_t x)
{
    return gw_within(x, GW_REAL_MAX);
}

/* Square root, correctly rounded; 0 for negative x and NaN; for infinity the root of GW_REAL_MAX. */
#if (GW_HARDWARE_SQRT == 1)
/* One instruction rounds correctly: the same bits as the portable function in a tenth of the time. */
static inline gw_real_t gw_sqrt_by_fpu(gw_real_t x)
{
    gw_real_t root;
#if (GW_ARM_FLOAT == 1)
    __asm("vsqrt.f32 %0, %1" : "=t"(root) : "t"(x));
#elif (GW_REAL_DOUBLE == 1)
    __asm("sqrtsd %1, %0" : "=x"(root) : "x"(x));
#else
    __asm("sqrtss %1, %0" : "=x"(root) : "x"(x));
#endif
    return root;
}

static inline gw_real_t gw_sqrt(gw_real_t x)
{
    return (x > GW_ZERO) ? gw_sqrt_by_fpu(gw_min(x, GW_REAL_MAX)) : GW_ZERO;
}
#else
gw_real_t gw_sqrt(gw_real_t x);
#endif

/* The same for x that is known to be finite and not negative: without checks. */
static inline gw_real_t gw_sqrt_of_square(gw_real_t x)
{
#if (GW_HARDWARE_SQRT == 1)
    return gw_sqrt_by_fpu(x);
#else
    return gw_sqrt(x);
#endif
}

/* part / whole, limited to [-1, 1] so that no rounding leads beyond; 0 unless whole > 0. */
gw_real_t gw_fraction(gw_real_t part, gw_real_t whole);
/* The same; the usual case takes no call. */
static inline gw_real_t gw_fraction_inline(gw_real_t part, gw_real_t whole)
{
#if (GW_ARM_FLOAT == 1)
    return (gw_magnitude(part) < whole) ? (part / whole) : gw_fraction(part, whole);
#else
    return gw_fraction(part, whole);
#endif
}
/* e^x; 0 below the smallest normal number and for NaN, GW_REAL_MAX where it would overflow. */
gw_real_t gw_exp(gw_real_t x);
/* e^x - 1 without cancellation near 0; -1 far below 0, GW_REAL_MAX where it would overflow, 0 for NaN. */
GW_SMALL gw_real_t gw_expm1(gw_real_t x);
/* tanh x; exactly +-1 far from 0; 0 for NaN. */
gw_real_t gw_tanh(gw_real_t x);
/* Sine and cosine for |angle| <= GW_ANGLE_MAX; else (0, 1). */
gw_rotation_t gw_sincos(gw_real_t angle_rad);
/* Angle of the vector (x, y) in [-pi, pi]; 0 for (0, 0) and where an argument is not finite. */
gw_real_t gw_atan2(gw_real_t y, gw_real_t x);
/* The angle modulo one turn, in [-pi, pi), for |angle| <= GW_ANGLE_MAX; else 0. */
GW_SMALL gw_real_t gw_wrap_angle(gw_real_t angle_rad);

/* later - earlier of two counters that wrap at 32 bits, for steps below 2^31 counts. */
static inline int32_t gw_count_difference(int32_t later, int32_t earlier)
{
    const uint32_t difference = (uint32_t)later - (uint32_t)earlier; /* modulo 2^32 by definition */
    int32_t result;
    /* A plain cast of the upper half would be implementation-defined. */
    if (difference <= 0x7FFFFFFFU) {
        result = (int32_t)difference;
    } else {
        const uint32_t below = 0xFFFFFFFFU - difference;
        result = -1 - (int32_t)below;
    }
    return result;
}

/* The vector turned by the angle, and turned back. */
static inline gw_vector_t gw_rotate(gw_rotation_t rotation, gw_vector_t vector)
{
    gw_vector_t result;
    result.x = (rotation.cosine * vector.x) - (rotation.sine * vector.y);
    result.y = (rotation.sine * vector.x) + (rotation.cosine * vector.y);
    return result;
}

static inline gw_vector_t gw_rotate_back(gw_rotation_t rotation, gw_vector_t vector)
{
    gw_vector_t result;
    result.x = (rotation.cosine * vector.x) + (rotation.sine * vector.y);
    result.y = (rotation.cosine * vector.y) - (rotation.sine * vector.x);
    return result;
}

/* The component of a vector along a direction, a unit vector. */
static inline gw_real_t gw_along(gw_vector_t vector, gw_vector_t direction)
{
    return (vector.x * direction.x) + (vector.y * direction.y);
}

/* Length of the vector, for components below 1e18 in magnitude; the rung `eva` shows that no step needs others. */
static inline gw_real_t gw_length(gw_vector_t vector)
{
    return gw_sqrt_of_square((vector.x * vector.x) + (vector.y * vector.y));
}

/* The vector (x, y) over its length: (0, 0) if that is not positive. */
static inline gw_vector_t gw_unit(gw_real_t x, gw_real_t y, gw_real_t length)
{
    const gw_vector_t unit = {gw_fraction_inline(x, length), gw_fraction_inline(y, length)};
    return unit;
}

/* The vector, shortened to the limit if it is longer; limit >= 0. */
gw_vector_t gw_limit_length(gw_vector_t vector, gw_real_t limit);
/* Highest speed at the end of a tick from which the deceleration still stops at the goal, for motion by trapezoids.
 * distance: remaining distance if the tick ended at speed zero; 0 if that is negative or the goal cannot be met. */
gw_real_t gw_braking_speed(gw_real_t deceleration, gw_real_t period, gw_real_t distance);

#ifdef __cplusplus
}
#endif

#endif
