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
#include "giveway/gw_math.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

#define GW_TWO_THIRDS ((gw_real_t)0.6666666666666666666667)
#define GW_ONE_THIRD ((gw_real_t)0.3333333333333333333333)

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

/* What runs at every tick is inline and written out: as loops and calls it would take twice the instructions. */

/* Of a planar vector at a wheel with radial direction n, the parts along its rolling direction and its radial one. */
static inline gw_real_t gw_along_rolling(gw_vector_t n, gw_real_t x, gw_real_t y)
{
    return (n.x * y) - (n.y * x);
}

static inline gw_real_t gw_along_radial(gw_vector_t n, gw_real_t x, gw_real_t y)
{
    return (n.x * x) + (n.y * y);
}

/* The sum of n_i times a_i, and of t_i times a_i. */
static inline gw_vector_t gw_kinematics_radial_sum(const gw_kinematics_t *kinematics, gw_wheels_t a)
{
    const gw_vector_t *const n = kinematics->radial;
    const gw_vector_t sum = {((GW_ZERO + (n[0].x * a.wheel[0])) + (n[1].x * a.wheel[1])) + (n[2].x * a.wheel[2]),
                             ((GW_ZERO + (n[0].y * a.wheel[0])) + (n[1].y * a.wheel[1])) + (n[2].y * a.wheel[2])};
    return sum;
}

static inline gw_vector_t gw_kinematics_rolling_sum(const gw_kinematics_t *kinematics, gw_wheels_t a)
{
    const gw_vector_t *const n = kinematics->radial;
    const gw_vector_t sum = {((GW_ZERO - (n[0].y * a.wheel[0])) - (n[1].y * a.wheel[1])) - (n[2].y * a.wheel[2]),
                             ((GW_ZERO + (n[0].x * a.wheel[0])) + (n[1].x * a.wheel[1])) + (n[2].x * a.wheel[2])};
    return sum;
}

/* (13): wheel rates of a twist, and back. rad/s. */
static inline gw_wheels_t gw_kinematics_wheel_rates(const gw_kinematics_t *kinematics, gw_twist_t twist)
{
    const gw_vector_t *const n = kinematics->radial;
    const gw_real_t rim = kinematics->wheel_distance_m * twist.omega_radps;
    const gw_real_t per_radius = kinematics->per_wheel_radius;
    const gw_wheels_t rates = {{(gw_along_rolling(n[0], twist.vx_mps, twist.vy_mps) + rim) * per_radius,
                                (gw_along_rolling(n[1], twist.vx_mps, twist.vy_mps) + rim) * per_radius,
                                (gw_along_rolling(n[2], twist.vx_mps, twist.vy_mps) + rim) * per_radius}};
    return rates;
}

static inline gw_twist_t gw_kinematics_twist(const gw_kinematics_t *kinematics, const gw_wheels_t *wheel_rates)
{
    const gw_vector_t planar = gw_kinematics_rolling_sum(kinematics, *wheel_rates);
    const gw_real_t sum = ((GW_ZERO + wheel_rates->wheel[0]) + wheel_rates->wheel[1]) + wheel_rates->wheel[2];
    const gw_real_t linear = GW_TWO_THIRDS * kinematics->wheel_radius_m;
    const gw_twist_t twist = {linear * planar.x, linear * planar.y,
                              ((GW_ONE_THIRD * kinematics->wheel_radius_m) * sum) / kinematics->wheel_distance_m};
    return twist;
}

/* (14): roller rates of a twist, rad/s. */
static inline gw_wheels_t gw_kinematics_roller_rates(const gw_kinematics_t *kinematics, gw_twist_t twist)
{
    const gw_vector_t *const n = kinematics->radial;
    const gw_real_t per_radius = kinematics->per_roller_radius;
    const gw_wheels_t rates = {{gw_along_radial(n[0], twist.vx_mps, twist.vy_mps) * per_radius,
                                gw_along_radial(n[1], twist.vx_mps, twist.vy_mps) * per_radius,
                                gw_along_radial(n[2], twist.vx_mps, twist.vy_mps) * per_radius}};
    return rates;
}

/* (29), corrected: acceleration over the floor, expressed along the base's axes. */
static inline gw_acceleration_t gw_kinematics_acceleration(const gw_kinematics_t *kinematics,
                                                           const gw_wheels_t *wheel_rates,
                                                           const gw_wheels_t *wheel_accelerations)
{
    const gw_twist_t twist = gw_kinematics_twist(kinematics, wheel_rates);
    const gw_twist_t relative = gw_kinematics_twist(kinematics, wheel_accelerations);
    /* The base's axes turn: the second term is what the derivative of J_w^-1 adds in (29). */
    const gw_acceleration_t acceleration = {relative.vx_mps - (twist.omega_radps * twist.vy_mps),
                                            relative.vy_mps + (twist.omega_radps * twist.vx_mps),
                                            relative.omega_radps};
    return acceleration;
}

/* Derivative of (13) and (30): wheel and roller accelerations, rad/s^2. */
gw_wheels_t gw_kinematics_wheel_accelerations(const gw_kinematics_t *kinematics, gw_twist_t twist,
                                              gw_acceleration_t acceleration);
gw_wheels_t gw_kinematics_roller_accelerations(const gw_kinematics_t *kinematics, gw_twist_t twist,
                                               gw_acceleration_t acceleration);
/* J_w^T T: the wrench on the base of torques at the wheels; and J_w^-T F, its inverse. */
static inline gw_wrench_t gw_kinematics_wrench_of_torques(const gw_kinematics_t *kinematics,
                                                          const gw_wheels_t *torque_nm)
{
    const gw_real_t per_radius = kinematics->per_wheel_radius;
    const gw_wheels_t traction_n = {
        {torque_nm->wheel[0] * per_radius, torque_nm->wheel[1] * per_radius, torque_nm->wheel[2] * per_radius}};
    const gw_vector_t force_n = gw_kinematics_rolling_sum(kinematics, traction_n);
    const gw_real_t distance_m = kinematics->wheel_distance_m;
    const gw_wrench_t wrench = {
        force_n.x, force_n.y,
        ((GW_ZERO + (distance_m * traction_n.wheel[0])) + (distance_m * traction_n.wheel[1])) +
            (distance_m * traction_n.wheel[2])};
    return wrench;
}

static inline gw_wheels_t gw_kinematics_torques_of_wrench(const gw_kinematics_t *kinematics, gw_wrench_t wrench)
{
    const gw_vector_t *const n = kinematics->radial;
    const gw_real_t x_n = wrench.force_x_n;
    const gw_real_t y_n = wrench.force_y_n;
    const gw_real_t radius_m = kinematics->wheel_radius_m;
    const gw_real_t shared = (GW_ONE_THIRD * wrench.torque_nm) / kinematics->wheel_distance_m;
    const gw_wheels_t torques = {{radius_m * ((GW_TWO_THIRDS * (gw_along_rolling(n[0], x_n, y_n) + GW_ZERO)) + shared),
                                  radius_m * ((GW_TWO_THIRDS * (gw_along_rolling(n[1], x_n, y_n) + GW_ZERO)) + shared),
                                  radius_m * ((GW_TWO_THIRDS * (gw_along_rolling(n[2], x_n, y_n) + GW_ZERO)) + shared)}};
    return torques;
}

/* J_r^T B. */
static inline gw_wrench_t gw_kinematics_wrench_of_rollers(const gw_kinematics_t *kinematics,
                                                          const gw_wheels_t *torque_nm)
{
    const gw_real_t per_radius = kinematics->per_roller_radius;
    const gw_wheels_t traction_n = {
        {torque_nm->wheel[0] * per_radius, torque_nm->wheel[1] * per_radius, torque_nm->wheel[2] * per_radius}};
    const gw_vector_t force_n = gw_kinematics_radial_sum(kinematics, traction_n);
    const gw_wrench_t wrench = {force_n.x, force_n.y, GW_ZERO};
    return wrench;
}

/* J_ext^T F: the wrench about the centre of a wrench at a point. */
gw_wrench_t gw_kinematics_wrench_at_centre(gw_vector_t point_m, gw_wrench_t at_point);

#ifdef __cplusplus
}
#endif

#endif
