#include "giveway/gw_math.h"

/* Range limits for the real type. Cody-Waite parts: the leading ones have so few bits that their
 * product with the quotient (13 bits for angles, 11 for exponents) is exact. */
#if (GW_REAL_DOUBLE == 1)
#define LN2_HIGH ((gw_real_t)0.6931471805592082)
#define LN2_LOW ((gw_real_t)7.371002565167799e-13)
#define HALF_PI_HIGH ((gw_real_t)1.5707963267923333)
#define HALF_PI_MIDDLE ((gw_real_t)2.5633441515839558e-12)
#define HALF_PI_LOW ((gw_real_t)1.0562999066987428e-23)
#define EXP_LOWEST (-(gw_real_t)708.0)
#define EXP_HIGHEST ((gw_real_t)709.0)
#define EXPM1_LOWEST (-(gw_real_t)40.0) /* e^x is below half an ulp of 1 */
#define TANH_SATURATED ((gw_real_t)20.0)
typedef uint64_t tanh_power_t; /* beyond e^(2 TANH_SATURATED) */
#define SQRT_SCALINGS 9U
#define SQRT_LIFT ((gw_real_t)4.149515568880993e180)      /* 2^600 */
#define SQRT_LIFT_ROOT ((gw_real_t)4.909093465297727e-91) /* 2^-300 */
#define SQRT_NEWTON_STEPS 4U
#define BELOW_TWO (GW_TWO - DBL_EPSILON)
#define SPLITTER ((gw_real_t)134217729.0) /* 2^27 + 1 */
#else
#define LN2_HIGH ((gw_real_t)0.693115234375)
#define LN2_LOW ((gw_real_t)3.1946184945309415e-05)
#define HALF_PI_HIGH ((gw_real_t)1.5703125)
#define HALF_PI_MIDDLE ((gw_real_t)0.00048351287841796875)
#define HALF_PI_LOW ((gw_real_t)3.139164786504813e-07)
#define EXP_LOWEST (-(gw_real_t)87.0)
#define EXP_HIGHEST ((gw_real_t)88.0)
#define EXPM1_LOWEST (-(gw_real_t)20.0)
#define TANH_SATURATED ((gw_real_t)10.0)
typedef uint32_t tanh_power_t;
#define SQRT_SCALINGS 6U
#define SQRT_LIFT ((gw_real_t)7.922816251426434e28)       /* 2^96 */
#define SQRT_LIFT_ROOT ((gw_real_t)3.552713678800501e-15) /* 2^-48 */
#define SQRT_NEWTON_STEPS 3U
#define BELOW_TWO (GW_TWO - FLT_EPSILON)
#define SPLITTER ((gw_real_t)4097.0) /* 2^12 + 1 */
#endif

#define ALMOST_PI ((gw_real_t)3.0)
#define LOG2_E ((gw_real_t)1.44269504088896340736)
#define TWO_OVER_PI ((gw_real_t)0.6366197723675813430755)

gw_real_t gw_fraction(gw_real_t part, gw_real_t whole)
{
    gw_real_t fraction = GW_ZERO;
    if (gw_magnitude(part) < whole) {
        fraction = part / whole;
    } else if (!(whole > GW_ZERO)) {
        /* no whole: 0 */
    } else if (part >= whole) {
        fraction = GW_ONE;
    } else if (part <= -whole) {
        fraction = -GW_ONE;
    } else {
        /* NaN: 0 */
    }
    return fraction;
}

/* Nearest integer for |x| < 2^30, ties away from zero. */
static int32_t nearest_integer(gw_real_t x)
{
    const gw_real_t shifted = (x < GW_ZERO) ? (x - GW_HALF) : (x + GW_HALF);
    return (int32_t)shifted;
}

#if (GW_HARDWARE_SQRT == 0)
/* Powers of 4 with their inverses and roots: exact in either type. */
typedef struct {
    gw_real_t power;
    gw_real_t inverse;
    gw_real_t root;
} power_of_four_t;

/* x - root * root without rounding error (Dekker's product), for root in [1, 2). */
static gw_real_t exact_residual(gw_real_t x, gw_real_t root)
{
    const gw_real_t spread = SPLITTER * root;
    const gw_real_t high = spread - (spread - root);
    const gw_real_t low = root - high;
    const gw_real_t square = root * root;
    const gw_real_t square_error = (((high * high) - square) + (GW_TWO * high * low)) + (low * low);
    return (x - square) - square_error;
}

/* For x > 0. */
static gw_real_t root_of(gw_real_t x)
{
    static const power_of_four_t powers_of_four[SQRT_SCALINGS] = {
#if (GW_REAL_DOUBLE == 1)
        /* 2^512 */
        {(gw_real_t)1.3407807929942597e+154, (gw_real_t)7.458340731200207e-155, (gw_real_t)1.157920892373162e+77},
        /* 2^256 */
        {(gw_real_t)1.157920892373162e+77, (gw_real_t)8.636168555094445e-78, (gw_real_t)3.402823669209385e+38},
        /* 2^128 */
        {(gw_real_t)3.402823669209385e+38, (gw_real_t)2.938735877055719e-39, (gw_real_t)1.8446744073709552e+19},
#endif
        {(gw_real_t)1.8446744073709552e+19, (gw_real_t)5.421010862427522e-20, (gw_real_t)4294967296.0}, /* 2^64 */
        {(gw_real_t)4294967296.0, (gw_real_t)2.3283064365386963e-10, (gw_real_t)65536.0},               /* 2^32 */
        {(gw_real_t)65536.0, (gw_real_t)1.52587890625e-05, (gw_real_t)256.0},                           /* 2^16 */
        {(gw_real_t)256.0, (gw_real_t)0.00390625, (gw_real_t)16.0},                                     /* 2^8 */
        {(gw_real_t)16.0, (gw_real_t)0.0625, (gw_real_t)4.0},                                           /* 2^4 */
        {(gw_real_t)4.0, (gw_real_t)0.25, (gw_real_t)2.0},                                              /* 2^2 */
    };
    /* x = reduced * scale^2 with reduced in [1, 4). Factors are powers of 4, so nothing is rounded. */
    gw_real_t reduced = gw_min(x, GW_REAL_MAX);
    gw_real_t scale = GW_ONE;
    for (uint32_t i = 0U; i < 2U; i++) { /* the smallest subnormal number needs both */
        if (reduced < GW_ONE) {
            reduced *= SQRT_LIFT;
            scale *= SQRT_LIFT_ROOT;
        }
    }
    for (uint32_t i = 0U; i < SQRT_SCALINGS; i++) {
        if (reduced >= powers_of_four[i].power) {
            reduced *= powers_of_four[i].inverse;
            scale *= powers_of_four[i].root;
        }
    }
    /* Within 4 %, then Newton's steps square the error. */
    gw_real_t root = (gw_real_t)(17.0 / 24.0) + (reduced * (gw_real_t)(1.0 / 3.0));
    for (uint32_t i = 0U; i < SQRT_NEWTON_STEPS; i++) {
        root = GW_HALF * (root + (reduced / root));
    }
    /* The exact residual makes the last rounding the correct one. */
    root += GW_HALF * (exact_residual(reduced, root) / root);
    /* It decides a tie wrongly just below 4, where the root is just below 2. */
    root = gw_min(root, BELOW_TWO);
    return root * scale;
}

gw_real_t gw_sqrt(gw_real_t x)
{
    return (x > GW_ZERO) ? root_of(x) : GW_ZERO;
}
#endif

/* 2^times and 2^-times, if that is a normal number. */
#define LONGEST_SHIFT 31U
#define LONGEST_POWER ((gw_real_t)2147483648.0) /* 2^31 */

static inline gw_real_t rising_power_of_two(uint32_t times)
{
    gw_real_t result = GW_ONE;
    uint32_t left = times;
    while (left > LONGEST_SHIFT) {
        result *= LONGEST_POWER;
        left -= LONGEST_SHIFT;
    }
    const uint32_t power = (uint32_t)1U << left;
    const gw_real_t factor = (gw_real_t)power;
    return result * factor;
}

static inline gw_real_t falling_power_of_two(uint32_t times)
{
    gw_real_t result = GW_ONE;
    uint32_t left = times;
    while (left > LONGEST_SHIFT) {
        result /= LONGEST_POWER;
        left -= LONGEST_SHIFT;
    }
    const uint32_t power = (uint32_t)1U << left;
    const gw_real_t factor = (gw_real_t)power;
    return result / factor;
}

/* A step of Horner's scheme. The series are written out: as loops they would take twice the instructions. */
static inline gw_real_t on(gw_real_t value, gw_real_t x, gw_real_t coefficient)
{
    return (value * x) + coefficient;
}

/* Taylor series of (e^r - 1 - r)/r^2; in double up to (ln 2/2)^13/14!, 1e-17. */
static inline gw_real_t exp_series(gw_real_t r)
{
#if (GW_REAL_DOUBLE == 1)
    gw_real_t value = (gw_real_t)(1.0 / 87178291200.0);
    value = on(value, r, (gw_real_t)(1.0 / 6227020800.0));
    value = on(value, r, (gw_real_t)(1.0 / 479001600.0));
    value = on(value, r, (gw_real_t)(1.0 / 39916800.0));
    value = on(value, r, (gw_real_t)(1.0 / 3628800.0));
    value = on(value, r, (gw_real_t)(1.0 / 362880.0));
    value = on(value, r, (gw_real_t)(1.0 / 40320.0));
#else
    gw_real_t value = (gw_real_t)(1.0 / 40320.0);
#endif
    value = on(value, r, (gw_real_t)(1.0 / 5040.0));
    value = on(value, r, (gw_real_t)(1.0 / 720.0));
    value = on(value, r, (gw_real_t)(1.0 / 120.0));
    value = on(value, r, (gw_real_t)(1.0 / 24.0));
    value = on(value, r, (gw_real_t)(1.0 / 6.0));
    value = on(value, r, (gw_real_t)(1.0 / 2.0));
    return value;
}

/* e^r - 1, for |r| up to half of ln 2. */
static inline gw_real_t short_expm1(gw_real_t r)
{
    return r + ((r * r) * exp_series(r));
}

/* e^x = scale * (1 + result), for EXP_LOWEST <= x <= EXP_HIGHEST; scale is a power of 2. */
static gw_real_t reduced_expm1(gw_real_t x, gw_real_t *scale)
{
    const int32_t exponent = nearest_integer(x * LOG2_E);
    const gw_real_t k = (gw_real_t)exponent;
    *scale = (exponent < 0) ? falling_power_of_two((uint32_t)(-exponent)) : rising_power_of_two((uint32_t)exponent);
    return short_expm1((x - (k * LN2_HIGH)) - (k * LN2_LOW));
}

/* The same for x = -size <= 0, where the sign of the exponent is known: the scale is 2^-halvings. */
static inline gw_real_t falling_expm1(gw_real_t size, uint32_t *halvings)
{
    const gw_real_t shifted = (size * LOG2_E) + GW_HALF;
    *halvings = (uint32_t)shifted;
    const gw_real_t k = (gw_real_t)*halvings;
    return short_expm1(((k * LN2_HIGH) - size) + (k * LN2_LOW));
}

gw_real_t gw_exp(gw_real_t x)
{
    gw_real_t result = GW_ZERO;
    if ((x <= GW_ZERO) && (x >= EXP_LOWEST)) {
        uint32_t halvings;
        const gw_real_t part = falling_expm1(-x, &halvings);
        result = (GW_ONE + part) * falling_power_of_two(halvings); /* not rounded: the result is a normal number */
    } else if (x > EXP_HIGHEST) {
        result = GW_REAL_MAX;
    } else if (x > GW_ZERO) {
        gw_real_t scale;
        const gw_real_t part = reduced_expm1(x, &scale);
        result = (GW_ONE + part) * scale;
    } else {
        /* NaN or far below: 0 */
    }
    return result;
}

gw_real_t gw_expm1(gw_real_t x)
{
    gw_real_t result = GW_ZERO;
    if (x > EXP_HIGHEST) {
        result = GW_REAL_MAX;
    } else if (x >= EXPM1_LOWEST) {
        gw_real_t scale;
        const gw_real_t part = reduced_expm1(x, &scale);
        result = (part * scale) + (scale - GW_ONE);
    } else if (x < EXPM1_LOWEST) {
        result = -GW_ONE;
    } else {
        /* NaN: 0 */
    }
    return result;
}

gw_real_t gw_tanh(gw_real_t x)
{
    gw_real_t result = -GW_ZERO;
    const gw_real_t size = gw_magnitude(x);
    if (size < TANH_SATURATED) {
        uint32_t halvings;
        const gw_real_t part = falling_expm1(GW_TWO * size, &halvings);
        const tanh_power_t power = (tanh_power_t)1U << halvings;
        const gw_real_t scale = GW_ONE / (gw_real_t)power;
        const gw_real_t e = (part * scale) + (scale - GW_ONE); /* expm1 */
        const gw_real_t magnitude = -e / (e + GW_TWO);
        result = (x < GW_ZERO) ? -magnitude : magnitude;
    } else if (size >= TANH_SATURATED) {
        result = (x < GW_ZERO) ? -GW_ONE : GW_ONE;
    } else {
        /* NaN: the zero that x = 0 gives */
    }
    return result;
}

/* angle - quarter_turns * pi/2, for at most 13 bits of quarter turns. */
static gw_real_t less_quarter_turns(gw_real_t angle_rad, int32_t quarter_turns)
{
    const gw_real_t n = (gw_real_t)quarter_turns;
    return ((angle_rad - (n * HALF_PI_HIGH)) - (n * HALF_PI_MIDDLE)) - (n * HALF_PI_LOW);
}

/* Taylor series of (sin r - r)/r^3 in r^2; in double up to (pi/4)^18/19!, 1e-19. */
static inline gw_real_t sin_series(gw_real_t square)
{
#if (GW_REAL_DOUBLE == 1)
    gw_real_t value = (gw_real_t)(1.0 / 355687428096000.0);
    value = on(value, square, (gw_real_t)(-1.0 / 1307674368000.0));
    value = on(value, square, (gw_real_t)(1.0 / 6227020800.0));
    value = on(value, square, (gw_real_t)(-1.0 / 39916800.0));
#else
    gw_real_t value = (gw_real_t)(-1.0 / 39916800.0);
#endif
    value = on(value, square, (gw_real_t)(1.0 / 362880.0));
    value = on(value, square, (gw_real_t)(-1.0 / 5040.0));
    value = on(value, square, (gw_real_t)(1.0 / 120.0));
    value = on(value, square, (gw_real_t)(-1.0 / 6.0));
    return value;
}

/* Taylor series of (cos r - 1)/r^2 in r^2. */
static inline gw_real_t cos_series(gw_real_t square)
{
#if (GW_REAL_DOUBLE == 1)
    gw_real_t value = (gw_real_t)(1.0 / 20922789888000.0);
    value = on(value, square, (gw_real_t)(-1.0 / 87178291200.0));
    value = on(value, square, (gw_real_t)(1.0 / 479001600.0));
    value = on(value, square, (gw_real_t)(-1.0 / 3628800.0));
#else
    gw_real_t value = (gw_real_t)(-1.0 / 3628800.0);
#endif
    value = on(value, square, (gw_real_t)(1.0 / 40320.0));
    value = on(value, square, (gw_real_t)(-1.0 / 720.0));
    value = on(value, square, (gw_real_t)(1.0 / 24.0));
    value = on(value, square, (gw_real_t)(-1.0 / 2.0));
    return value;
}

gw_rotation_t gw_sincos(gw_real_t angle_rad)
{
    gw_rotation_t result = {GW_ZERO, GW_ONE};
    if (gw_within(angle_rad, GW_ANGLE_MAX)) {
        const int32_t quarter_turns = nearest_integer(angle_rad * TWO_OVER_PI);
        const gw_real_t r = less_quarter_turns(angle_rad, quarter_turns);
        const gw_real_t square = r * r;
        const gw_real_t sine = r + ((r * square) * sin_series(square));
        const gw_real_t cosine = GW_ONE + (square * cos_series(square));
        const uint32_t quadrant = (uint32_t)quarter_turns & 3U; /* two's complement keeps the residue */
        if (quadrant == 0U) {
            result.sine = sine;
            result.cosine = cosine;
        } else if (quadrant == 1U) {
            result.sine = cosine;
            result.cosine = -sine;
        } else if (quadrant == 2U) {
            result.sine = -sine;
            result.cosine = -cosine;
        } else {
            result.sine = -cosine;
            result.cosine = sine;
        }
    }
    return result;
}

/* Taylor series of (atan z - z)/z^3 in z^2; in double up to (1/8)^20/21, 4e-20. */
static inline gw_real_t atan_series(gw_real_t square)
{
#if (GW_REAL_DOUBLE == 1)
    gw_real_t value = (gw_real_t)(-1.0 / 19.0);
    value = on(value, square, (gw_real_t)(1.0 / 17.0));
    value = on(value, square, (gw_real_t)(-1.0 / 15.0));
    value = on(value, square, (gw_real_t)(1.0 / 13.0));
    value = on(value, square, (gw_real_t)(-1.0 / 11.0));
    value = on(value, square, (gw_real_t)(1.0 / 9.0));
#else
    gw_real_t value = (gw_real_t)(1.0 / 9.0);
#endif
    value = on(value, square, (gw_real_t)(-1.0 / 7.0));
    value = on(value, square, (gw_real_t)(1.0 / 5.0));
    value = on(value, square, (gw_real_t)(-1.0 / 3.0));
    return value;
}

/* atan of x in [0, 1]: atan(c) + atan((x - c)/(1 + x c)) with c the nearest quarter. */
static gw_real_t atan_of_fraction(gw_real_t x)
{
    /* atan(k/4). */
    static const gw_real_t atan_quarters[5] = {
        (gw_real_t)0.0,
        (gw_real_t)0.2449786631268641541721,
        (gw_real_t)0.4636476090008061162143,
        (gw_real_t)0.6435011087932843868028,
        (gw_real_t)0.7853981633974483096157,
    };
    const gw_real_t shifted = (x * (gw_real_t)4.0) + GW_HALF;
    const int32_t quarter = (int32_t)shifted;
    const gw_real_t c = (gw_real_t)quarter * (gw_real_t)0.25;
    const gw_real_t z = (x - c) / (GW_ONE + (x * c));
    const gw_real_t square = z * z;
    return atan_quarters[quarter] + (z + ((z * square) * atan_series(square)));
}

gw_real_t gw_atan2(gw_real_t y, gw_real_t x)
{
    gw_real_t angle = GW_ZERO;
    const gw_real_t x_size = gw_magnitude(x);
    const gw_real_t y_size = gw_magnitude(y);
    const bool steep = (y_size > x_size);
    const gw_real_t larger = steep ? y_size : x_size;
    const gw_real_t smaller = steep ? x_size : y_size;
    /* The first fails if either is NaN. */
    if ((smaller <= larger) && (larger > GW_ZERO) && (larger <= GW_REAL_MAX)) {
        angle = atan_of_fraction(smaller / larger);
        if (steep) {
            angle = (GW_HALF * GW_PI) - angle;
        }
        if (x < GW_ZERO) {
            angle = GW_PI - angle;
        }
        if (y < GW_ZERO) {
            angle = -angle;
        }
    }
    return angle;
}

gw_real_t gw_wrap_angle(gw_real_t angle_rad)
{
    gw_real_t wrapped = GW_ZERO;
    if (gw_within(angle_rad, ALMOST_PI)) {
        wrapped = angle_rad; /* no whole turn to take off */
    } else if (gw_within(angle_rad, GW_ANGLE_MAX)) {
        const int32_t turns = nearest_integer(angle_rad * (TWO_OVER_PI * (gw_real_t)0.25));
        wrapped = less_quarter_turns(angle_rad, 4 * turns);
        /* Rounding may leave it a little outside; these differences are exact. */
        if (wrapped >= GW_PI) {
            wrapped -= GW_TWO * GW_PI;
        }
        if (wrapped < -GW_PI) {
            wrapped += GW_TWO * GW_PI;
        }
    } else {
        /* not an angle: 0 */
    }
    return wrapped;
}

gw_vector_t gw_limit_length(gw_vector_t vector, gw_real_t limit)
{
    gw_vector_t result = vector;
    const gw_real_t length = gw_length(vector);
    if (length > limit) {
        /* Rounding must not exceed the limit: bounds on speeds have to be exact. */
        const gw_real_t factor = limit / length;
        result.x = gw_limited(vector.x * factor, limit);
        result.y = gw_limited(vector.y * factor, limit);
    }
    return result;
}

gw_real_t gw_braking_speed(gw_real_t deceleration, gw_real_t period, gw_real_t distance)
{
    gw_real_t speed = GW_ZERO;
    if (distance > GW_ZERO) {
        /* v^2 = 2 a (distance - T v/2) */
        const gw_real_t half_step = (GW_HALF * deceleration) * period;
        speed = gw_sqrt_of_square((half_step * half_step) + ((GW_TWO * deceleration) * distance)) - half_step;
    }
    return speed;
}
