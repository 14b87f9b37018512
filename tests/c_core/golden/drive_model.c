#include "../matrix_forms.h"
#include "giveway/gw_friction.h"
#include "giveway/gw_gear.h"
#include "giveway/gw_math.h"
#include "giveway/gw_wrench.h"
#include "modules.h"
#include "random_robot.h"

static gw_acceleration_t random_acceleration(generator_t *generator)
{
    const gw_twist_t twist = generator_twist(generator, (gw_real_t)5.0, (gw_real_t)20.0);
    const gw_acceleration_t acceleration = {twist.vx_mps, twist.vy_mps, twist.omega_radps};
    return acceleration;
}

static void add_matrix(digest_t *digest, matrix_t matrix)
{
    for (uint32_t row = 0U; row < 3U; row++) {
        digest_reals(digest, matrix.m[row], 3U);
    }
}

static void jacobians(digest_t *digest, const gw_kinematics_t *kinematics, gw_real_t theta_rad)
{
    const constraint_matrix_t constraint = constraint_jacobian(kinematics, theta_rad);
    const gw_vector_t point_m = {theta_rad, -theta_rad};
    add_matrix(digest, wheel_jacobian(kinematics, theta_rad));
    add_matrix(digest, roller_jacobian(kinematics, theta_rad));
    add_matrix(digest, wheel_jacobian_inverse(kinematics, theta_rad));
    add_matrix(digest, external_jacobian(point_m));
    for (uint32_t row = 0U; row < 6U; row++) {
        digest_reals(digest, constraint.m[row], 9U);
    }
}

digest_t drive_kinematics(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(3U);
    for (uint32_t i = 0U; i < 200U; i++) {
        const gw_kinematics_t kinematics = random_kinematics(&generator);
        const gw_twist_t twist = generator_twist(&generator, GW_ONE, GW_TWO);
        const gw_acceleration_t acceleration = random_acceleration(&generator);
        const gw_wheels_t wheels = generator_wheels(&generator, (gw_real_t)20.0);
        const gw_wheels_t others = generator_wheels(&generator, (gw_real_t)20.0);
        const gw_wrench_t wrench = {wheels.wheel[0], wheels.wheel[1], wheels.wheel[2]};
        const gw_wheels_t results[6] = {
            gw_kinematics_wheel_rates(&kinematics, twist),
            gw_kinematics_roller_rates(&kinematics, twist),
            wheel_accelerations(&kinematics, twist, acceleration),
            roller_accelerations(&kinematics, twist, acceleration),
            gw_kinematics_torques_of_wrench(&kinematics, wrench),
            others,
        };
        for (uint32_t k = 0U; k < 6U; k++) {
            digest_wheels(&digest, &results[k]);
        }
        digest_twist(&digest, gw_kinematics_twist(&kinematics, &wheels));
        digest_acceleration(&digest, gw_kinematics_acceleration(&kinematics, &wheels, &others));
        digest_wrench(&digest, gw_kinematics_wrench_of_torques(&kinematics, &wheels));
        digest_wrench(&digest, gw_kinematics_wrench_of_rollers(&kinematics, &wheels));
        digest_wrench(&digest, wrench_at_centre(generator_vector(&generator, GW_ONE), wrench));
        jacobians(&digest, &kinematics, generator_between(&generator, -GW_PI, GW_PI));
    }
    return digest;
}

digest_t drive_friction(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(4U);
    for (uint32_t i = 0U; i < 500U; i++) {
        gw_friction_config_t friction;
        friction.coulomb_torque_nm = generator_between(&generator, GW_ZERO, GW_ONE);
        friction.tanh_slope_s_per_rad = generator_between(&generator, GW_ZERO, GW_TWO);
        const gw_wheels_t rates = generator_wheels(&generator, (gw_real_t)50.0);
        const gw_wheels_t torques = gw_friction_torques(&friction, &rates);
        digest_wheels(&digest, &torques);
    }
    return digest;
}

digest_t drive_gear(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(61U);
    for (uint32_t i = 0U; i < 500U; i++) {
        gw_gear_config_t gear;
        gear.coulomb_torque_nm = generator_between(&generator, GW_ZERO, GW_TWO);
        gear.viscous_nms_per_rad = generator_between(&generator, GW_ZERO, GW_ONE);
        gear.tanh_slope_s_per_rad = generator_between(&generator, GW_ZERO, (gw_real_t)20.0);
        gear.uncertainty = generator_between(&generator, GW_ZERO, GW_ONE);
        const gw_wheels_t rates = generator_wheels(&generator, GW_TWO);
        gw_wheels_t torques = generator_wheels(&generator, GW_ONE);
        digest_real(&digest, gw_gear_add(&gear, &rates, &torques));
        digest_wheels(&digest, &torques);
    }
    return digest;
}

digest_t drive_nominal(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(5U);
    for (uint32_t i = 0U; i < 300U; i++) {
        const gw_kinematics_t kinematics = random_kinematics(&generator);
        const gw_nominal_t nominal = random_nominal(&generator, &kinematics);
        const gw_twist_t twist = generator_twist(&generator, GW_ONE, GW_TWO);
        const gw_wheels_t torques = nominal_torques(&nominal, &kinematics, twist, random_acceleration(&generator));
        digest_wheels(&digest, &torques);
        digest_real(&digest, nominal.total_mass_kg);
        digest_real(&digest, nominal.total_yaw_inertia_kgm2);
    }
    return digest;
}

digest_t drive_wrench(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(6U);
    for (uint32_t i = 0U; i < 300U; i++) {
        const gw_kinematics_t kinematics = random_kinematics(&generator);
        const gw_wheels_t nominal = generator_wheels(&generator, (gw_real_t)20.0);
        const gw_wheels_t sensed = generator_wheels(&generator, (gw_real_t)20.0);
        const gw_wrench_sigma_t sigma = gw_wrench_noise(&kinematics, generator_between(&generator, GW_ZERO, GW_ONE));
        digest_wrench(&digest, gw_wrench_external(&kinematics, &nominal, &sensed));
        digest_real(&digest, sigma.force_n);
        digest_real(&digest, sigma.torque_nm);
        digest_bool(&digest, gw_wrench_is_valid(generator_wrench(&generator, (gw_real_t)2.0e9, GW_ONE)));
    }
    return digest;
}
