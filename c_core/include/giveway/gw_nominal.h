/* The torques that the sensors would show without contact, (27); (38) when both rotational inertias are zero.
 *
 *     T|0 = J_w^-T [M_t a + c(nu) + J_r^T B_r]
 *     M_t = diag(M + 1.5 I_w/r_w^2 + 1.5 I_r/r_r^2, same, I_b + 3 I_w R^2/r_w^2)
 *     c   = 1.5 (I_w/r_w^2 + I_r/r_r^2) omega (v_y, -v_x, 0)
 * for three wheels; the factors come from gw_kinematics.h.
 *
 * Life cycle: gw_nominal_init, then read-only. All members are private.
 */
#ifndef GW_NOMINAL_H
#define GW_NOMINAL_H

#include "giveway/gw_config.h"
#include "giveway/gw_friction.h"
#include "giveway/gw_kinematics.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    /* Mass of the robot with its wheels, kg, [0.1, 2000]. */
    gw_real_t mass_kg;
    /* Yaw inertia about the centre, wheels included, kg m^2, [0.0001, 10000]. */
    gw_real_t yaw_inertia_kgm2;
    /* Inertia of a wheel about its axle, kg m^2, [0, 10]; with what stands between it and the torque signal: rotor and
     * gear, if that is the motor's current. */
    gw_real_t wheel_inertia_kgm2;
    /* Inertia of the roller that touches the floor about its own axle, kg m^2, [0, 1]. */
    gw_real_t roller_inertia_kgm2;
} gw_inertia_config_t;

typedef struct {
    gw_real_t total_mass_kg;
    gw_real_t total_yaw_inertia_kgm2;
    gw_real_t rolling_mass_kg; /* factor of c */
    gw_friction_config_t friction;
} gw_nominal_t;

/* The values of Trikey, the paper's robot. Pointers not NULL in these two. */
void gw_inertia_config_trikey(gw_inertia_config_t *config);
GW_SMALL void gw_inertia_config_check(const gw_inertia_config_t *config, gw_config_error_t *error);
GW_SMALL gw_status_t gw_nominal_init(gw_nominal_t *nominal, const gw_inertia_config_t *inertia,
                                     const gw_friction_config_t *friction, const gw_kinematics_t *kinematics);
bool gw_nominal_invariant_holds(const gw_nominal_t *nominal);
/* T|0, N m, at a twist and an acceleration over the floor, both along the base's axes and finite, and with this
 * friction of the rollers, N m per roller. Pointers not NULL. */
static inline gw_wheels_t gw_nominal_torques(const gw_nominal_t *nominal, const gw_kinematics_t *kinematics,
                                             gw_twist_t twist, gw_acceleration_t acceleration,
                                             const gw_wheels_t *friction_nm)
{
    gw_wrench_t wrench = gw_kinematics_wrench_of_rollers(kinematics, friction_nm);
    const gw_real_t turning = nominal->rolling_mass_kg * twist.omega_radps;
    wrench.force_x_n += (nominal->total_mass_kg * acceleration.ax_mps2) + (turning * twist.vy_mps);
    wrench.force_y_n += (nominal->total_mass_kg * acceleration.ay_mps2) - (turning * twist.vx_mps);
    wrench.torque_nm += nominal->total_yaw_inertia_kgm2 * acceleration.alpha_radps2;
    return gw_kinematics_torques_of_wrench(kinematics, wrench);
}

#ifdef __cplusplus
}
#endif

#endif
