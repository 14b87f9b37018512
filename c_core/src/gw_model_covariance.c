#include "giveway/gw_model_covariance.h"

#include "giveway/gw_math.h"

#if (GW_WITH_CHANNELS == 1)

gw_planar_covariance_t gw_model_covariance(const gw_channels_config_t *config, const gw_kinematics_t *kinematics,
                                           const gw_follower_t *follower, const gw_model_forces_t *change,
                                           const gw_model_forces_t *model, gw_real_t sliding_n, gw_real_t presliding)
{
    const gw_real_t shape = config->friction_shape * config->friction_shape;
    const gw_real_t presliding2 = presliding * presliding;
    const gw_real_t sliding_n2 = sliding_n * sliding_n;
    /* cppcheck-suppress misra-c2012-9.3 ; DEV-01 a whole struct from a call */
    const gw_regressors_t regressors = gw_follower_regressors(kinematics, change);
    gw_planar_covariance_t sum = gw_follower_uncertainty(follower, &regressors);
    GW_UNROLLED
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        const gw_vector_t g = regressors.of[i];
        const gw_vector_t n = kinematics->radial[i];
        const gw_real_t friction_n = model->friction_n.wheel[i];
        const gw_real_t before_n = friction_n - change->friction_n.wheel[i];
        const gw_real_t missing_n2 =
            presliding2 * gw_clamp(sliding_n2 - (friction_n * before_n), GW_ZERO, GW_TWO * sliding_n2);
        sum.xx += (shape * (g.x * g.x)) + (missing_n2 * (n.x * n.x));
        sum.xy += (shape * (g.x * g.y)) + (missing_n2 * (n.x * n.y));
        sum.yy += (shape * (g.y * g.y)) + (missing_n2 * (n.y * n.y));
    }
    return gw_planar_scaled(sum, config->model_multiple * config->model_multiple);
}

#endif
