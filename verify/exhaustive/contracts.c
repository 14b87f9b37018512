/* The bounds of eva/math_contracts.h on every float there is. Prints "N arguments, 0 broken"; exit code 1 if one is
 * broken or a finite argument raised a floating-point exception (overflow, division by zero, invalid: a cast out of
 * range, too). */
#include "giveway/gw_math.h"

#include <fenv.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TURN_HALF ((gw_real_t)3.1415928)

static bool unit(gw_real_t value)
{
    return (value >= -1.0F) && (value <= 1.0F);
}

static bool good_sqrt(gw_real_t x)
{
    const gw_real_t y = gw_sqrt(x);
    return (y >= 0.0F) && (y <= 1.8447e19F) && (!(x >= 1.0F) || (y >= 1.0F)) && (!(x <= 1e8F) || (y <= 1e4F)) &&
           (!(x <= 1e12F) || (y <= 1e6F)) && (!(x <= 1e20F) || (y <= 1e10F));
}

static bool good_exp(gw_real_t x)
{
    const gw_real_t y = gw_exp(x);
    const gw_real_t less = gw_expm1(x);
    return (y >= 0.0F) && (y <= GW_REAL_MAX) && (less >= -1.0F) && (less <= GW_REAL_MAX) &&
           (!(x <= 0.0F) || ((y <= 1.0F) && (less <= 0.0F)));
}

static bool good_circle(gw_real_t x)
{
    const gw_rotation_t rotation = gw_sincos(x);
    const gw_real_t wrapped = gw_wrap_angle(x);
    return unit(rotation.sine) && unit(rotation.cosine) && (wrapped >= -TURN_HALF) && (wrapped <= TURN_HALF);
}

static bool good_tanh(gw_real_t x)
{
    return unit(gw_tanh(x));
}

/* gw_atan2 takes the angle whose tangent is the smaller argument over the larger, a float in [0, 1], and possibly
 * subtracts it from a quarter turn, then the result from half a turn, and negates it. Rounding of differences is
 * monotonic, so they stay within [0, pi] if the angle is within [0, pi/2]. */
static bool good_atan2(gw_real_t x)
{
    const gw_real_t angle = gw_atan2(x, 1.0F);
    return (angle >= 0.0F) && (angle <= 0.7854F);
}

typedef struct {
    const char *name;
    bool (*good)(gw_real_t x);
    uint32_t last; /* bits of the last argument */
} contract_t;

static const contract_t contracts[] = {
    {"sqrt", good_sqrt, UINT32_MAX},     {"exp", good_exp, UINT32_MAX},
    {"circle", good_circle, UINT32_MAX}, {"tanh", good_tanh, 0x7FFFFFFFU}, /* odd, as rung elementary shows */
    {"atan2", good_atan2, 0x3F800000U},                                    /* 1.0 */
};

/* 0, or 1 at the first float that breaks it. */
static unsigned long broken_by(const contract_t *contract)
{
    unsigned long broken = 0UL;
    uint32_t bits = 0U;
    for (;;) {
        gw_real_t x;
        (void)memcpy(&x, &bits, sizeof(x));
        bool good = contract->good(x);
        if (!isfinite(x)) {
            (void)feclearexcept(FE_ALL_EXCEPT);
        } else if ((bits & 0xFFU) == 0xFFU) { /* flags stay raised, so checking after every 256th argument is enough */
            good = good && (fetestexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW) == 0);
        } else {
            /* the next check sees it */
        }
        if (!good) {
            (void)printf("%s: broken at or just below %a\n", contract->name, (double)x);
            broken++;
        }
        if ((broken > 0UL) || (bits == contract->last)) {
            break;
        }
        bits++;
    }
    return broken;
}

int main(int argc, char **argv)
{
    for (size_t i = 0U; i < (sizeof(contracts) / sizeof(contracts[0])); i++) {
        if ((argc == 2) && (strcmp(argv[1], contracts[i].name) == 0)) {
            const unsigned long broken = broken_by(&contracts[i]);
            (void)printf("%lu arguments, %lu broken\n", (unsigned long)contracts[i].last + 1UL, broken);
            return (broken == 0UL) ? EXIT_SUCCESS : EXIT_FAILURE;
        }
    }
    (void)printf("contracts sqrt|exp|circle|tanh|atan2\n");
    return EXIT_FAILURE;
}
