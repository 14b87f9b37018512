/* The external wrench, (40): J_ext^T F_ext = J_w^T (T|0 - T_s), and how torque noise shows in it. */
#ifndef GW_WRENCH_H
#define GW_WRENCH_H

#include "giveway/gw_kinematics.h"
#include "giveway/gw_math.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Standard deviations of one force component and of the torque about the centre. */
typedef struct {
    gw_real_t force_n;
    gw_real_t torque_nm;
} gw_wrench_sigma_t;

/* Largest force, N, and torque, N m, that the library works with; beyond it a value is a fault, not a push. */
#define GW_WRENCH_MAX ((gw_real_t)1.0e9)

/* Largest torque at a wheel that is valid, N m: more than any sensor measures. */
#define GW_TORQUE_MAX ((gw_real_t)1.0e6)

/* True if no component is NaN or beyond GW_WRENCH_MAX. */
static inline bool gw_wrench_is_valid(gw_wrench_t wrench)
{
    return gw_within(wrench.force_x_n, GW_WRENCH_MAX) && gw_within(wrench.force_y_n, GW_WRENCH_MAX) &&
           gw_within(wrench.torque_nm, GW_WRENCH_MAX);
}

/* The wrench with every component kept within GW_WRENCH_MAX: the same for a valid one. */
static inline gw_wrench_t gw_wrench_limited(gw_wrench_t wrench)
{
    const gw_wrench_t limited = {gw_limited(wrench.force_x_n, GW_WRENCH_MAX),
                                 gw_limited(wrench.force_y_n, GW_WRENCH_MAX),
                                 gw_limited(wrench.torque_nm, GW_WRENCH_MAX)};
    return limited;
}

/* A wrench that gw_wrench_is_valid, as provers need to be told. */
static inline gw_wrench_t gw_wrench_known_valid(gw_wrench_t wrench)
{
    const gw_wrench_t known = {gw_known_within(wrench.force_x_n, GW_WRENCH_MAX),
                               gw_known_within(wrench.force_y_n, GW_WRENCH_MAX),
                               gw_known_within(wrench.torque_nm, GW_WRENCH_MAX)};
    return known;
}

/* Likewise for torques and GW_TORQUE_MAX. */
static inline bool gw_torques_are_valid(const gw_wheels_t *torque_nm)
{
    bool valid = true;
    GW_UNROLLED
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        valid = valid && gw_within(torque_nm->wheel[i], GW_TORQUE_MAX);
    }
    return valid;
}

static inline gw_wheels_t gw_torques_limited(const gw_wheels_t *torque_nm)
{
    gw_wheels_t known;
    GW_UNROLLED
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        known.wheel[i] = gw_known_within(torque_nm->wheel[i], GW_TORQUE_MAX);
    }
    return known;
}

/* The wrench of the environment ON the robot, from torques without contact and sensed torques. Pointers not NULL. */
static inline gw_wrench_t gw_wrench_external(const gw_kinematics_t *kinematics, const gw_wheels_t *nominal_nm,
                                             const gw_wheels_t *sensed_nm)
{
    gw_wheels_t missing;
    GW_UNROLLED
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        missing.wheel[i] = nominal_nm->wheel[i] - sensed_nm->wheel[i];
    }
    return gw_kinematics_wrench_of_torques(kinematics, &missing);
}

/* sigma_F = sigma_tau sqrt(1.5)/r_w per axis, sigma_M = sqrt(3) R sigma_tau/r_w, for independent equal noise. */
GW_SMALL gw_wrench_sigma_t gw_wrench_noise(const gw_kinematics_t *kinematics, gw_real_t torque_noise_nm);

#ifdef __cplusplus
}
#endif

#endif
