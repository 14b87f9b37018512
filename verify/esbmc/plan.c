/* What gw_known_within tells the provers that look at ranges is true: a value that gw_within has found within a limit
 * is not changed by gw_limited. So a valid plan, which is told to them with it, stays as it is. */
#include "nondet.h"

int main(void)
{
    const gw_plan_t plan = {{nondet_float(), nondet_float(), nondet_float()},
                            {nondet_float(), nondet_float(), nondet_float()},
                            {nondet_float(), nondet_float(), nondet_float()}};
    const gw_plan_t limited = gw_plan_limited(&plan);
    const gw_real_t x = nondet_float();
    const gw_real_t limit = nondet_float();
    __ESBMC_assume(gw_in_range(limit, GW_ZERO, GW_REAL_MAX));
    if (gw_within(x, limit)) {
        __ESBMC_assert(gw_limited(x, limit) == x, "a value within the limit stays as it is");
    }
    if (gw_plan_is_valid(&plan)) {
        __ESBMC_assert(gw_plan_is_valid(&limited), "it stays valid");
        __ESBMC_assert((limited.pose.x_m == plan.pose.x_m) && (limited.twist.omega_radps == plan.twist.omega_radps) &&
                           (limited.acceleration.ay_mps2 == plan.acceleration.ay_mps2),
                       "a valid plan stays as it is");
    }
    return 0;
}
