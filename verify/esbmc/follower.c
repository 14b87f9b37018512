/* Any configuration, any state within the invariant (after any drift), a regressor and a residual of any bits: each of
 * the two updates of gw_follower_learn keeps the invariant. */
#include "nondet.h"

#include "gw_follower.c"

int main(void)
{
    gw_follower_t follower;
    gw_real_t h[GW_FOLLOWER_STATE_COUNT];
    follower.config.friction_common = nondet_float();
    follower.config.friction_wheel = nondet_float();
    follower.config.mass = nondet_float();
    follower.config.drift_per_root_s = nondet_float();
    follower.config.offset_n = nondet_float();
    follower.config.residual_n = nondet_float();
    follower.drift_per_call = nondet_float();
    for (uint32_t i = 0U; i < GW_FOLLOWER_STATE_COUNT; i++) {
        follower.difference[i] = nondet_float();
        for (uint32_t k = 0U; k < GW_FOLLOWER_STATE_COUNT; k++) {
            follower.covariance[i][k] = nondet_float();
        }
    }
    __ESBMC_assume(gw_follower_invariant_holds(&follower));
    for (uint32_t i = 0U; i < GW_FOLLOWER_STATE_COUNT; i++) {
        h[i] = nondet_float();
        if (nondet_bool()) {
            follower.covariance[i][i] += follower.drift_per_call;
        }
    }
#ifdef MUTANT
    /* To refute one, the residual alone is searched: for more the solver needs too long. */
    gw_follower_config_trikey(&follower.config);
    gw_follower_init(&follower, &follower.config, GW_ONE);
    for (uint32_t i = 0U; i < GW_FOLLOWER_STATE_COUNT; i++) {
        h[i] = GW_ZERO;
    }
#endif
    learn_component(&follower, h, nondet_float());
    __ESBMC_assert(gw_follower_invariant_holds(&follower), "an update keeps the invariant");
    return 0;
}
