#include "giveway/gw_wrench.h"

#include "giveway/gw_math.h"

#define SQRT_3_HALVES ((gw_real_t)1.224744871391589049099)
#define SQRT_3 ((gw_real_t)1.732050807568877293527)

bool gw_wrench_is_valid(gw_wrench_t wrench)
{
    return gw_in_range(wrench.force_x_n, -GW_WRENCH_MAX, GW_WRENCH_MAX) &&
           gw_in_range(wrench.force_y_n, -GW_WRENCH_MAX, GW_WRENCH_MAX) &&
           gw_in_range(wrench.torque_nm, -GW_WRENCH_MAX, GW_WRENCH_MAX);
}

gw_wrench_t gw_wrench_limited(gw_wrench_t wrench)
{
    const gw_wrench_t limited = {gw_clamp(wrench.force_x_n, -GW_WRENCH_MAX, GW_WRENCH_MAX),
                                 gw_clamp(wrench.force_y_n, -GW_WRENCH_MAX, GW_WRENCH_MAX),
                                 gw_clamp(wrench.torque_nm, -GW_WRENCH_MAX, GW_WRENCH_MAX)};
    return limited;
}

gw_wheels_t gw_torques_limited(const gw_wheels_t *torque_nm)
{
    gw_wheels_t limited;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        limited.wheel[i] = gw_clamp(torque_nm->wheel[i], -GW_TORQUE_MAX, GW_TORQUE_MAX);
    }
    return limited;
}

gw_wrench_t gw_wrench_external(const gw_kinematics_t *kinematics, const gw_wheels_t *nominal_nm,
                               const gw_wheels_t *sensed_nm)
{
    gw_wheels_t missing;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        missing.wheel[i] = nominal_nm->wheel[i] - sensed_nm->wheel[i];
    }
    return gw_kinematics_wrench_of_torques(kinematics, &missing);
}

gw_wrench_sigma_t gw_wrench_noise(const gw_kinematics_t *kinematics, gw_real_t torque_noise_nm)
{
    gw_wrench_sigma_t sigma;
    const gw_real_t traction_n = torque_noise_nm * kinematics->per_wheel_radius;
    sigma.force_n = SQRT_3_HALVES * traction_n;
    sigma.torque_nm = (SQRT_3 * kinematics->wheel_distance_m) * traction_n;
    return sigma;
}
