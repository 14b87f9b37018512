/* Functions whose code is too hard for the solver are replaced by their bounds: angles of gw_math (rung `contracts`
 * checks these bounds on every float), and the remainder of a division (bounds of C99 6.5.5). Include it before the
 * sources under proof. */
#ifndef ESBMC_CONTRACTS_H
#define ESBMC_CONTRACTS_H

#include "nondet.h"

static gw_real_t contract_wrap_angle(gw_real_t angle_rad)
{
    const gw_real_t wrapped = nondet_float();
    (void)angle_rad;
    __ESBMC_assume(gw_in_range(wrapped, -GW_PI, GW_PI));
    return wrapped;
}

static gw_rotation_t contract_sincos(gw_real_t angle_rad)
{
    const gw_rotation_t rotation = {nondet_float(), nondet_float()};
    (void)angle_rad;
    __ESBMC_assume(gw_in_range(rotation.sine, -GW_ONE, GW_ONE) && gw_in_range(rotation.cosine, -GW_ONE, GW_ONE));
    return rotation;
}

/* dividend % divisor, for divisor > 0. */
static int contract_remainder(int dividend, int divisor)
{
    const int remainder = nondet_int();
    __ESBMC_assert(divisor > 0, "the divisor is positive");
    __ESBMC_assume((remainder > -divisor) && (remainder < divisor));
    __ESBMC_assume((dividend < 0) ? (remainder <= 0) : (remainder >= 0));
    return remainder;
}

#define gw_wrap_angle contract_wrap_angle
#define gw_sincos contract_sincos

#endif
