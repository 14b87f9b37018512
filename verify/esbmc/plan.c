/* A plan of arbitrary bits becomes a valid plan; a valid plan is not changed. */
#include "nondet.h"

int main(void)
{
    const gw_plan_t plan = {{nondet_float(), nondet_float(), nondet_float()},
                            {nondet_float(), nondet_float(), nondet_float()},
                            {nondet_float(), nondet_float(), nondet_float()}};
    const gw_plan_t limited = gw_plan_limited(&plan);
    __ESBMC_assert(gw_plan_is_valid(&limited), "a limited plan is valid");
    if (gw_plan_is_valid(&plan)) {
        __ESBMC_assert((limited.pose.x_m == plan.pose.x_m) && (limited.twist.omega_radps == plan.twist.omega_radps) &&
                           (limited.acceleration.ay_mps2 == plan.acceleration.ay_mps2),
                       "a valid plan stays as it is");
    }
    return 0;
}
