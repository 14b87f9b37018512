/* Kinematics of three omniwheels, (9)-(19), (29), (30), (33)-(35).
 *
 * Wheel i has radial direction n_i = (cos, sin) and rolling direction t_i = (-sin, cos) at its azimuth in the base
 * frame. Everything is in the base frame.
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

/* Wheels are evenly spaced: the sums of n_i n_i^T and of t_i t_i^T are half their number times the unit matrix. All
 * closed forms follow from these: the inverses below, the masses of (27) and the noise of (40). */
#define GW_HALF_WHEELS (GW_HALF * GW_WHEELS)
#define GW_PER_WHEEL (GW_ONE / GW_WHEELS)
#define GW_TWO_PER_WHEEL (GW_TWO / GW_WHEELS)
#define GW_ROOT_OF_WHEELS ((gw_real_t)1.732050807568877293527)
#define GW_ROOT_OF_HALF_WHEELS ((gw_real_t)1.224744871391589049099)
#if (GW_WHEEL_COUNT != 3U)
#error "these two roots, and the directions of the slots in gw_kinematics.c, are those of three wheels"
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

/* The values of Trikey, the paper's robot. Pointers not NULL in these two. */
void gw_geometry_config_trikey(gw_geometry_config_t *config);
GW_SMALL void gw_geometry_config_check(const gw_geometry_config_t *config, gw_config_error_t *error);
GW_SMALL gw_status_t gw_kinematics_init(gw_kinematics_t *kinematics, const gw_geometry_config_t *config);
bool gw_kinematics_invariant_holds(const gw_kinematics_t *kinematics);

/* What runs at every tick is inline: as calls it would take a quarter more instructions. */

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
static inline gw_vector_t gw_kinematics_radial_sum(const gw_kinematics_t *kinematics, const gw_wheels_t *a)
{
    gw_vector_t sum = {GW_ZERO, GW_ZERO};
    GW_UNROLLED
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        sum.x += kinematics->radial[i].x * a->wheel[i];
        sum.y += kinematics->radial[i].y * a->wheel[i];
    }
    return sum;
}

static inline gw_vector_t gw_kinematics_rolling_sum(const gw_kinematics_t *kinematics, const gw_wheels_t *a)
{
    gw_vector_t sum = {GW_ZERO, GW_ZERO};
    GW_UNROLLED
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        sum.x -= kinematics->radial[i].y * a->wheel[i];
        sum.y += kinematics->radial[i].x * a->wheel[i];
    }
    return sum;
}

/* (13): wheel rates of a twist, and back. rad/s. */
static inline gw_wheels_t gw_kinematics_wheel_rates(const gw_kinematics_t *kinematics, gw_twist_t twist)
{
    const gw_real_t rim_mps = kinematics->wheel_distance_m * twist.omega_radps;
    gw_wheels_t rates;
    GW_UNROLLED
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        const gw_real_t rolling_mps = gw_along_rolling(kinematics->radial[i], twist.vx_mps, twist.vy_mps);
        rates.wheel[i] = (rolling_mps + rim_mps) * kinematics->per_wheel_radius;
    }
    return rates;
}

static inline gw_twist_t gw_kinematics_twist(const gw_kinematics_t *kinematics, const gw_wheels_t *wheel_rates)
{
    const gw_vector_t planar = gw_kinematics_rolling_sum(kinematics, wheel_rates);
    const gw_real_t linear_m = GW_TWO_PER_WHEEL * kinematics->wheel_radius_m;
    gw_real_t sum_radps = GW_ZERO;
    GW_UNROLLED
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        sum_radps += wheel_rates->wheel[i];
    }
    const gw_twist_t twist = {linear_m * planar.x, linear_m * planar.y,
                              ((GW_PER_WHEEL * kinematics->wheel_radius_m) * sum_radps) / kinematics->wheel_distance_m};
    return twist;
}

/* (14): roller rates of a twist, rad/s. */
static inline gw_wheels_t gw_kinematics_roller_rates(const gw_kinematics_t *kinematics, gw_twist_t twist)
{
    gw_wheels_t rates;
    GW_UNROLLED
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        rates.wheel[i] =
            gw_along_radial(kinematics->radial[i], twist.vx_mps, twist.vy_mps) * kinematics->per_roller_radius;
    }
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
                                            relative.vy_mps + (twist.omega_radps * twist.vx_mps), relative.omega_radps};
    return acceleration;
}

/* J_w^T T: the wrench on the base of torques at the wheels; and its inverse, J_w^-T F. */
static inline gw_wrench_t gw_kinematics_wrench_of_torques(const gw_kinematics_t *kinematics,
                                                          const gw_wheels_t *torque_nm)
{
    gw_wheels_t traction_n;
    gw_real_t moment_nm = GW_ZERO;
    GW_UNROLLED
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        traction_n.wheel[i] = torque_nm->wheel[i] * kinematics->per_wheel_radius;
        moment_nm += kinematics->wheel_distance_m * traction_n.wheel[i];
    }
    const gw_vector_t force_n = gw_kinematics_rolling_sum(kinematics, &traction_n);
    const gw_wrench_t wrench = {force_n.x, force_n.y, moment_nm};
    return wrench;
}

static inline gw_wheels_t gw_kinematics_torques_of_wrench(const gw_kinematics_t *kinematics, gw_wrench_t wrench)
{
    const gw_real_t turning_n = (GW_PER_WHEEL * wrench.torque_nm) / kinematics->wheel_distance_m;
    gw_wheels_t torques;
    GW_UNROLLED
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        const gw_real_t rolling_n = gw_along_rolling(kinematics->radial[i], wrench.force_x_n, wrench.force_y_n);
        torques.wheel[i] = kinematics->wheel_radius_m * ((GW_TWO_PER_WHEEL * rolling_n) + turning_n);
    }
    return torques;
}

/* J_r^T B: the wrench on the base of torques about the rollers' axles. */
static inline gw_wrench_t gw_kinematics_wrench_of_rollers(const gw_kinematics_t *kinematics,
                                                          const gw_wheels_t *torque_nm)
{
    gw_wheels_t traction_n;
    GW_UNROLLED
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        traction_n.wheel[i] = torque_nm->wheel[i] * kinematics->per_roller_radius;
    }
    const gw_vector_t force_n = gw_kinematics_radial_sum(kinematics, &traction_n);
    const gw_wrench_t wrench = {force_n.x, force_n.y, GW_ZERO};
    return wrench;
}

#ifdef __cplusplus
}
#endif

#endif
