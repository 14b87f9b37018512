/* Kinematics of three omniwheels, (9)-(19), (29), (30), (33)-(35).
 *
 * Wheel i has radial direction n_i = (cos, sin) and rolling direction t_i = (-sin, cos) at its azimuth in the base
 * frame. Everything is in the base frame; the matrices also come for a yaw angle, in the world frame.
 *
 * Life cycle: gw_kinematics_init, then read-only. All members are private. Pointers must not be NULL except in init.
 */
#ifndef GW_KINEMATICS_H
#define GW_KINEMATICS_H

#include "giveway/gw_config.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    /* Wheel radius r_w, m, [0.005, 1]. */
    gw_real_t wheel_radius_m;
    /* Roller radius r_r, m, [0.001, 0.5]. */
    gw_real_t roller_radius_m;
    /* Distance R from the centre to each wheel, m, [0.01, 5]. */
    gw_real_t wheel_distance_m;
    /* Which of the three places each wheel has: its azimuth is slot * 120 degrees + azimuth_rad. Each of 0, 1, 2 once,
     * so that wires may come in any order. */
    uint32_t wheel_slot[GW_WHEEL_COUNT];
    /* Azimuth of slot 0 in the base frame, rad, [-3.2, 3.2]. */
    gw_real_t azimuth_rad;
} gw_geometry_config_t;

typedef struct {
    gw_vector_t radial[GW_WHEEL_COUNT]; /* n_i; t_i = (-n_i.y, n_i.x) */
    gw_real_t wheel_radius_m;
    gw_real_t roller_radius_m;
    gw_real_t wheel_distance_m;
    gw_real_t per_wheel_radius; /* 1/r_w */
    gw_real_t per_roller_radius;
} gw_kinematics_t;

typedef struct {
    gw_real_t m[3][3];
} gw_matrix_t;

/* J_c of (19): rows of wheels, then of rollers; columns (x, q_w, q_r) as in (17). */
typedef struct {
    gw_real_t m[6][9];
} gw_constraint_matrix_t;

void gw_geometry_config_check(const gw_geometry_config_t *config, gw_config_error_t *error);
gw_status_t gw_kinematics_init(gw_kinematics_t *kinematics, const gw_geometry_config_t *config);
bool gw_kinematics_invariant_holds(const gw_kinematics_t *kinematics);

/* (15) and (16) at yaw theta; theta = 0 gives the base frame. |theta| <= GW_ANGLE_MAX. */
gw_matrix_t gw_kinematics_wheel_jacobian(const gw_kinematics_t *kinematics, gw_real_t theta_rad);
gw_matrix_t gw_kinematics_roller_jacobian(const gw_kinematics_t *kinematics, gw_real_t theta_rad);
/* Inverse of (15) in closed form. */
gw_matrix_t gw_kinematics_wheel_jacobian_inverse(const gw_kinematics_t *kinematics, gw_real_t theta_rad);
/* (19). */
gw_constraint_matrix_t gw_kinematics_constraint_jacobian(const gw_kinematics_t *kinematics, gw_real_t theta_rad);
/* (34) for the contact point relative to the centre, in the frame of the point. */
gw_matrix_t gw_kinematics_external_jacobian(gw_vector_t point_m);

/* (13): wheel rates of a twist, and back. rad/s. */
gw_wheels_t gw_kinematics_wheel_rates(const gw_kinematics_t *kinematics, gw_twist_t twist);
gw_twist_t gw_kinematics_twist(const gw_kinematics_t *kinematics, const gw_wheels_t *wheel_rates);
/* (14): roller rates of a twist, rad/s. */
gw_wheels_t gw_kinematics_roller_rates(const gw_kinematics_t *kinematics, gw_twist_t twist);
/* (29), corrected: acceleration over the floor, expressed along the base's axes. */
gw_acceleration_t gw_kinematics_acceleration(const gw_kinematics_t *kinematics, const gw_wheels_t *wheel_rates,
                                             const gw_wheels_t *wheel_accelerations);
/* Derivative of (13) and (30): wheel and roller accelerations, rad/s^2. */
gw_wheels_t gw_kinematics_wheel_accelerations(const gw_kinematics_t *kinematics, gw_twist_t twist,
                                              gw_acceleration_t acceleration);
gw_wheels_t gw_kinematics_roller_accelerations(const gw_kinematics_t *kinematics, gw_twist_t twist,
                                               gw_acceleration_t acceleration);
/* J_w^T T: the wrench on the base of torques at the wheels; and J_w^-T F, its inverse. */
gw_wrench_t gw_kinematics_wrench_of_torques(const gw_kinematics_t *kinematics, const gw_wheels_t *torque_nm);
gw_wheels_t gw_kinematics_torques_of_wrench(const gw_kinematics_t *kinematics, gw_wrench_t wrench);
/* J_r^T B. */
gw_wrench_t gw_kinematics_wrench_of_rollers(const gw_kinematics_t *kinematics, const gw_wheels_t *torque_nm);
/* J_ext^T F: the wrench about the centre of a wrench at a point. */
gw_wrench_t gw_kinematics_wrench_at_centre(gw_vector_t point_m, gw_wrench_t at_point);

#ifdef __cplusplus
}
#endif

#endif
