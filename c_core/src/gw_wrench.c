#include "giveway/gw_wrench.h"

#include "giveway/gw_math.h"

gw_wrench_sigma_t gw_wrench_noise(const gw_kinematics_t *kinematics, gw_real_t torque_noise_nm)
{
    gw_wrench_sigma_t sigma;
    const gw_real_t traction_n = torque_noise_nm * kinematics->per_wheel_radius;
    sigma.force_n = GW_ROOT_OF_HALF_WHEELS * traction_n;
    sigma.torque_nm = (GW_ROOT_OF_WHEELS * kinematics->wheel_distance_m) * traction_n;
    return sigma;
}
