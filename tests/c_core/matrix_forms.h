/* The kinematics of three wheels as the matrices that (15) to (34) print, and (28), (30) and (38) as functions of the
 * motion: gw_kinematics and gw_nominal are compared with them. Their bits are part of the golden bits, too. */
#ifndef MATRIX_FORMS_H
#define MATRIX_FORMS_H

#include "giveway/giveway.h"

typedef struct {
    gw_real_t m[3][3];
} matrix_t;

/* J_c of (19): rows of wheels, then of rollers; columns (x, q_w, q_r) as in (17). */
typedef struct {
    gw_real_t m[6][9];
} constraint_matrix_t;

/* (15) at yaw theta; theta = 0 gives the base frame. |theta| <= GW_ANGLE_MAX here and below. */
static inline matrix_t wheel_jacobian(const gw_kinematics_t *kinematics, gw_real_t theta_rad)
{
    matrix_t jacobian;
    const gw_rotation_t yaw = gw_sincos(theta_rad);
    for (uint32_t i = 0U; i < 3U; i++) {
        const gw_vector_t n = gw_rotate(yaw, kinematics->radial[i]);
        jacobian.m[i][0] = -n.y * kinematics->per_wheel_radius;
        jacobian.m[i][1] = n.x * kinematics->per_wheel_radius;
        jacobian.m[i][2] = kinematics->wheel_distance_m * kinematics->per_wheel_radius;
    }
    return jacobian;
}

/* (16). */
static inline matrix_t roller_jacobian(const gw_kinematics_t *kinematics, gw_real_t theta_rad)
{
    matrix_t jacobian;
    const gw_rotation_t yaw = gw_sincos(theta_rad);
    for (uint32_t i = 0U; i < 3U; i++) {
        const gw_vector_t n = gw_rotate(yaw, kinematics->radial[i]);
        jacobian.m[i][0] = n.x * kinematics->per_roller_radius;
        jacobian.m[i][1] = n.y * kinematics->per_roller_radius;
        jacobian.m[i][2] = GW_ZERO;
    }
    return jacobian;
}

/* Inverse of (15) in closed form. */
static inline matrix_t wheel_jacobian_inverse(const gw_kinematics_t *kinematics, gw_real_t theta_rad)
{
    matrix_t inverse;
    const gw_rotation_t yaw = gw_sincos(theta_rad);
    const gw_real_t linear = (gw_real_t)(2.0 / 3.0) * kinematics->wheel_radius_m;
    const gw_real_t angular = ((gw_real_t)(1.0 / 3.0) * kinematics->wheel_radius_m) / kinematics->wheel_distance_m;
    for (uint32_t i = 0U; i < 3U; i++) {
        const gw_vector_t n = gw_rotate(yaw, kinematics->radial[i]);
        inverse.m[0][i] = -n.y * linear;
        inverse.m[1][i] = n.x * linear;
        inverse.m[2][i] = angular;
    }
    return inverse;
}

/* (19). */
static inline constraint_matrix_t constraint_jacobian(const gw_kinematics_t *kinematics, gw_real_t theta_rad)
{
    constraint_matrix_t constraint = {{{GW_ZERO}}};
    const matrix_t wheel = wheel_jacobian(kinematics, theta_rad);
    const matrix_t roller = roller_jacobian(kinematics, theta_rad);
    for (uint32_t row = 0U; row < 6U; row++) {
        for (uint32_t column = 0U; column < 3U; column++) {
            constraint.m[row][column] = (row < 3U) ? wheel.m[row][column] : roller.m[row - 3U][column];
        }
        constraint.m[row][row + 3U] = -GW_ONE;
    }
    return constraint;
}

/* (34) for the contact point relative to the centre, in the frame of the point. */
static inline matrix_t external_jacobian(gw_vector_t point_m)
{
    const matrix_t jacobian = {{
        {GW_ONE, GW_ZERO, -point_m.y},
        {GW_ZERO, GW_ONE, point_m.x},
        {GW_ZERO, GW_ZERO, GW_ONE},
    }};
    return jacobian;
}

/* J_ext^T F: the wrench about the centre of a wrench at a point. */
static inline gw_wrench_t wrench_at_centre(gw_vector_t point_m, gw_wrench_t at_point)
{
    gw_wrench_t wrench = at_point;
    wrench.torque_nm += (point_m.x * at_point.force_y_n) - (point_m.y * at_point.force_x_n);
    return wrench;
}

/* Derivative of (13): wheel accelerations, rad/s^2. */
static inline gw_wheels_t wheel_accelerations(const gw_kinematics_t *kinematics, gw_twist_t twist,
                                              gw_acceleration_t acceleration)
{
    gw_wheels_t result;
    const gw_real_t rim = kinematics->wheel_distance_m * acceleration.alpha_radps2;
    for (uint32_t i = 0U; i < 3U; i++) {
        const gw_vector_t n = kinematics->radial[i];
        const gw_real_t turning = twist.omega_radps * gw_along_radial(n, twist.vx_mps, twist.vy_mps);
        result.wheel[i] = ((gw_along_rolling(n, acceleration.ax_mps2, acceleration.ay_mps2) + rim) - turning) *
                          kinematics->per_wheel_radius;
    }
    return result;
}

/* (30): roller accelerations, rad/s^2. */
static inline gw_wheels_t roller_accelerations(const gw_kinematics_t *kinematics, gw_twist_t twist,
                                               gw_acceleration_t acceleration)
{
    gw_wheels_t result;
    for (uint32_t i = 0U; i < 3U; i++) {
        const gw_vector_t n = kinematics->radial[i];
        const gw_real_t turning = twist.omega_radps * gw_along_rolling(n, twist.vx_mps, twist.vy_mps);
        result.wheel[i] =
            (gw_along_radial(n, acceleration.ax_mps2, acceleration.ay_mps2) + turning) * kinematics->per_roller_radius;
    }
    return result;
}

/* T|0 of (27) with the friction of (28). */
static inline gw_wheels_t nominal_torques(const gw_nominal_t *nominal, const gw_kinematics_t *kinematics,
                                          gw_twist_t twist, gw_acceleration_t acceleration)
{
    const gw_wheels_t roller_rates = gw_kinematics_roller_rates(kinematics, twist);
    const gw_wheels_t friction_nm = gw_friction_torques(&nominal->friction, &roller_rates);
    return gw_nominal_torques(nominal, kinematics, twist, acceleration, &friction_nm);
}

#endif
