#include "generator.h"
#include "giveway/gw_math.h"
#include "giveway/gw_presliding.h"
#include "modules.h"
#include "random_robot.h"

static gw_presliding_config_t random_rollers(generator_t *generator)
{
    gw_presliding_config_t config;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        config.stiffness_n_per_m[i] = generator_between(generator, (gw_real_t)5000.0, (gw_real_t)60000.0);
    }
    config.damping_newton_s_per_m = generator_between(generator, GW_ZERO, (gw_real_t)50.0);
    config.stribeck_speed_mps = generator_between(generator, (gw_real_t)0.001, (gw_real_t)0.01);
    config.elastic_fraction = generator_between(generator, GW_ZERO, (gw_real_t)0.9);
    return config;
}

/* Rollers that stick, creep, slide and turn back; now and then a gap in the samples, or a tare. */
digest_t drive_presliding(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(30U);
    for (uint32_t k = 0U; k < 8U; k++) {
        const gw_kinematics_t kinematics = random_kinematics(&generator);
        const gw_presliding_config_t config = random_rollers(&generator);
        gw_friction_config_t friction;
        gw_rate_filter_constants_t constants;
        gw_presliding_t presliding;
        int32_t count[GW_WHEEL_COUNT] = {0, 0, 0};
        friction.coulomb_torque_nm = generator_between(&generator, GW_ZERO, GW_ONE);
        friction.tanh_slope_s_per_rad = generator_between(&generator, GW_ZERO, GW_TWO);
        (void)gw_rate_filter_constants(&constants, (gw_real_t)0.001, (gw_real_t)300.0, 8500U, (gw_real_t)700.0);
        digest_u32(&digest, (uint32_t)gw_presliding_init(&presliding, &config, &friction, &kinematics));
        for (uint32_t i = 0U; i < 500U; i++) {
            const gw_wheels_t torque_nm = generator_wheels(&generator, (gw_real_t)3.0);
            const gw_twist_t twist = generator_twist(&generator, (gw_real_t)0.05, (gw_real_t)0.2);
            for (uint32_t wheel = 0U; wheel < GW_WHEEL_COUNT; wheel++) {
                count[wheel] += (int32_t)generator_below(&generator, 5U) - 2;
            }
            if (generator_one_in(&generator, 60U)) {
                gw_presliding_gap(&presliding);
            }
            if (generator_one_in(&generator, 60U)) {
                gw_presliding_settle(&presliding, &torque_nm);
            }
            const gw_wheels_t friction_nm =
                gw_presliding_step(&presliding, &kinematics, &constants, count, &torque_nm, twist);
            const gw_wheels_t elastic_nm = gw_presliding_elastic_torques(&presliding, &kinematics);
            digest_wheels(&digest, &friction_nm);
            digest_wheels(&digest, &elastic_nm);
        }
    }
    return digest;
}
