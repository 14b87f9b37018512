#include "parts.h"

static gw_follower_t follower;
static gw_follower_config_t config;
static gw_kinematics_t kinematics;

static void part_init(void)
{
    draw_follower_config(&config);
    gw_follower_init(&follower, &config, draw_real(GW_ZERO, (gw_real_t)100.0));
    hold_follower(&follower);
}

static void part_step(void)
{
    gw_model_forces_t forces;
    gw_vector_t residual_n;
    draw_follower(&follower);
    draw_kinematics(&kinematics);
    draw_model_forces(&forces, GW_WRENCH_MAX);
    draw_vector(&residual_n, GW_WRENCH_MAX);
    const gw_regressors_t regressors = gw_follower_regressors(&kinematics, &forces);
    gw_vector_t correction = gw_follower_correction(&follower, &kinematics, &forces);
    hold_vector(&correction, (gw_real_t)4.2e9);
    const gw_planar_covariance_t s = gw_follower_uncertainty(&follower, &regressors);
    demand_real(s.xx, GW_ZERO, (gw_real_t)1.0e20);
    demand_real(s.xy, (gw_real_t)-1.0e20, (gw_real_t)1.0e20);
    demand_real(s.yy, GW_ZERO, (gw_real_t)1.0e20);
    gw_follower_learn(&follower, &regressors, residual_n, any_flag());
    hold_follower(&follower);
    (void)gw_follower_invariant_holds(&follower);
}

static void part_refusals(void)
{
    disturb_follower(&follower);
    (void)gw_follower_invariant_holds(any_flag() ? &follower : NULL);
}
