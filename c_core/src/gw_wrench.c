#include "giveway/gw_wrench.h"

#include "giveway/gw_math.h"

#define SQRT_3_HALVES ((gw_real_t)1.224744871391589049099)
#define SQRT_3 ((gw_real_t)1.732050807568877293527)

GW_SELDOM gw_wrench_sigma_t gw_wrench_noise(const gw_kinematics_t *kinematics, gw_real_t torque_noise_nm)
{
    gw_wrench_sigma_t sigma;
    const gw_real_t traction_n = torque_noise_nm * kinematics->per_wheel_radius;
    sigma.force_n = SQRT_3_HALVES * traction_n;
    sigma.torque_nm = (SQRT_3 * kinematics->wheel_distance_m) * traction_n;
    return sigma;
}
