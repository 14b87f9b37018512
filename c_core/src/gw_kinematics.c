#include "giveway/gw_kinematics.h"

#include "giveway/gw_math.h"

#define HALF_SQRT_3 ((gw_real_t)0.8660254037844386467637)

GW_SELDOM void gw_geometry_config_check(const gw_geometry_config_t *config, gw_config_error_t *error)
{
    uint32_t slots_seen = 0U;
    gw_config_check_real(error, GW_FIELD_GEOMETRY_WHEEL_RADIUS, config->wheel_radius_m);
    gw_config_check_real(error, GW_FIELD_GEOMETRY_ROLLER_RADIUS, config->roller_radius_m);
    gw_config_check_real(error, GW_FIELD_GEOMETRY_WHEEL_DISTANCE, config->wheel_distance_m);
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        gw_config_check_element(error, GW_FIELD_GEOMETRY_WHEEL_SLOT, i, (gw_real_t)config->wheel_slot[i]);
        if (config->wheel_slot[i] < GW_WHEEL_COUNT) {
            slots_seen |= ((uint32_t)1U << config->wheel_slot[i]);
        }
    }
    if (slots_seen != 7U) {
        /* Two wheels share a slot: name the last one, which leaves another slot free. No value repairs it alone. */
        gw_config_check_relation(error, GW_FIELD_GEOMETRY_WHEEL_SLOT, GW_WHEEL_COUNT - 1U,
                                 (gw_real_t)config->wheel_slot[GW_WHEEL_COUNT - 1U], GW_ONE, GW_ZERO);
    }
    gw_config_check_real(error, GW_FIELD_GEOMETRY_AZIMUTH, config->azimuth_rad);
}

GW_SELDOM gw_status_t gw_kinematics_init(gw_kinematics_t *kinematics, const gw_geometry_config_t *config)
{
    /* cos and sin of 0, 120 and 240 degrees, better than computed ones. */
    static const gw_vector_t slot_direction[GW_WHEEL_COUNT] = {
        {(gw_real_t)1.0, (gw_real_t)0.0},
        {(gw_real_t)-0.5, HALF_SQRT_3},
        {(gw_real_t)-0.5, -HALF_SQRT_3},
    };
    gw_status_t status = GW_STATUS_OK;
    if ((kinematics == NULL) || (config == NULL)) {
        status = GW_STATUS_NULL_POINTER;
    } else {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_geometry_config_check(config, &error);
        if (error.field != GW_FIELD_NONE) {
            status = GW_STATUS_CONFIG_INVALID;
        } else {
            const gw_rotation_t rotation = gw_sincos(config->azimuth_rad);
            for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
                kinematics->radial[i] = gw_rotate(rotation, slot_direction[config->wheel_slot[i]]);
            }
            kinematics->wheel_radius_m = config->wheel_radius_m;
            kinematics->roller_radius_m = config->roller_radius_m;
            kinematics->wheel_distance_m = config->wheel_distance_m;
            kinematics->per_wheel_radius = GW_ONE / config->wheel_radius_m;
            kinematics->per_roller_radius = GW_ONE / config->roller_radius_m;
        }
    }
    return status;
}

GW_SELDOM bool gw_kinematics_invariant_holds(const gw_kinematics_t *kinematics)
{
    bool holds = (kinematics != NULL);
    if (holds) {
        holds = (kinematics->wheel_radius_m > GW_ZERO) && (kinematics->roller_radius_m > GW_ZERO) &&
                (kinematics->wheel_distance_m > GW_ZERO) && gw_is_finite(kinematics->per_wheel_radius) &&
                gw_is_finite(kinematics->per_roller_radius) && gw_is_finite(kinematics->wheel_distance_m);
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            holds = holds && gw_in_range(gw_length(kinematics->radial[i]), (gw_real_t)0.99, (gw_real_t)1.01);
        }
    }
    return holds;
}

gw_matrix_t gw_kinematics_wheel_jacobian(const gw_kinematics_t *kinematics, gw_real_t theta_rad)
{
    gw_matrix_t jacobian;
    const gw_rotation_t yaw = gw_sincos(theta_rad);
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        const gw_vector_t n = gw_rotate(yaw, kinematics->radial[i]);
        jacobian.m[i][0] = -n.y * kinematics->per_wheel_radius;
        jacobian.m[i][1] = n.x * kinematics->per_wheel_radius;
        jacobian.m[i][2] = kinematics->wheel_distance_m * kinematics->per_wheel_radius;
    }
    return jacobian;
}

gw_matrix_t gw_kinematics_roller_jacobian(const gw_kinematics_t *kinematics, gw_real_t theta_rad)
{
    gw_matrix_t jacobian;
    const gw_rotation_t yaw = gw_sincos(theta_rad);
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        const gw_vector_t n = gw_rotate(yaw, kinematics->radial[i]);
        jacobian.m[i][0] = n.x * kinematics->per_roller_radius;
        jacobian.m[i][1] = n.y * kinematics->per_roller_radius;
        jacobian.m[i][2] = GW_ZERO;
    }
    return jacobian;
}

gw_matrix_t gw_kinematics_wheel_jacobian_inverse(const gw_kinematics_t *kinematics, gw_real_t theta_rad)
{
    gw_matrix_t inverse;
    const gw_rotation_t yaw = gw_sincos(theta_rad);
    const gw_real_t linear = GW_TWO_THIRDS * kinematics->wheel_radius_m;
    const gw_real_t angular = (GW_ONE_THIRD * kinematics->wheel_radius_m) / kinematics->wheel_distance_m;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        const gw_vector_t n = gw_rotate(yaw, kinematics->radial[i]);
        inverse.m[0][i] = -n.y * linear;
        inverse.m[1][i] = n.x * linear;
        inverse.m[2][i] = angular;
    }
    return inverse;
}

gw_constraint_matrix_t gw_kinematics_constraint_jacobian(const gw_kinematics_t *kinematics, gw_real_t theta_rad)
{
    gw_constraint_matrix_t constraint;
    /* cppcheck-suppress misra-c2012-9.3 ; DEV-01 a whole struct from a call */
    const gw_matrix_t wheel = gw_kinematics_wheel_jacobian(kinematics, theta_rad);
    /* cppcheck-suppress misra-c2012-9.3 ; DEV-01 a whole struct from a call */
    const gw_matrix_t roller = gw_kinematics_roller_jacobian(kinematics, theta_rad);
    for (uint32_t row = 0U; row < 6U; row++) {
        for (uint32_t column = 0U; column < 9U; column++) {
            gw_real_t entry = GW_ZERO;
            if (column < 3U) {
                entry = (row < 3U) ? wheel.m[row][column] : roller.m[row - 3U][column];
            } else if ((column - 3U) == row) {
                entry = -GW_ONE;
            } else {
                /* off the diagonal: zero */
            }
            constraint.m[row][column] = entry;
        }
    }
    return constraint;
}

gw_matrix_t gw_kinematics_external_jacobian(gw_vector_t point_m)
{
    const gw_matrix_t jacobian = {{
        {GW_ONE, GW_ZERO, -point_m.y},
        {GW_ZERO, GW_ONE, point_m.x},
        {GW_ZERO, GW_ZERO, GW_ONE},
    }};
    return jacobian;
}

gw_wheels_t gw_kinematics_wheel_accelerations(const gw_kinematics_t *kinematics, gw_twist_t twist,
                                              gw_acceleration_t acceleration)
{
    gw_wheels_t result;
    const gw_real_t rim = kinematics->wheel_distance_m * acceleration.alpha_radps2;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        const gw_vector_t n = kinematics->radial[i];
        const gw_real_t turning = twist.omega_radps * gw_along_radial(n, twist.vx_mps, twist.vy_mps);
        result.wheel[i] = ((gw_along_rolling(n, acceleration.ax_mps2, acceleration.ay_mps2) + rim) - turning) *
                          kinematics->per_wheel_radius;
    }
    return result;
}

gw_wheels_t gw_kinematics_roller_accelerations(const gw_kinematics_t *kinematics, gw_twist_t twist,
                                               gw_acceleration_t acceleration)
{
    gw_wheels_t result;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        const gw_vector_t n = kinematics->radial[i];
        const gw_real_t turning = twist.omega_radps * (gw_along_rolling(n, twist.vx_mps, twist.vy_mps) + GW_ZERO);
        result.wheel[i] = (gw_along_radial(n, acceleration.ax_mps2, acceleration.ay_mps2) + turning) *
                          kinematics->per_roller_radius;
    }
    return result;
}

gw_wrench_t gw_kinematics_wrench_at_centre(gw_vector_t point_m, gw_wrench_t at_point)
{
    gw_wrench_t wrench = at_point;
    wrench.torque_nm += (point_m.x * at_point.force_y_n) - (point_m.y * at_point.force_x_n);
    return wrench;
}
