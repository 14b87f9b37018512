#include "generator.h"
#include "giveway/gw_controller.h"
#include "giveway/gw_math.h"
#include "modules.h"

#define PHASES 30U
#define PHASE_TICKS 150U

static void add_output(digest_t *digest, const gw_estimator_output_t *output)
{
    digest_wrench(digest, output->wrench);
    digest_wrench(digest, output->mean);
    digest_wrench(digest, output->window_mean);
    digest_u32(digest, output->mean_samples);
    digest_real(digest, output->sigma.force_n);
    digest_real(digest, output->sigma.torque_nm);
    digest_wheels(digest, &output->nominal_nm);
    digest_twist(digest, output->measured_twist);
    digest_u32(digest, (uint32_t)output->regime);
    digest_bool(digest, output->zero_changed);
    digest_real(digest, output->gear_n2);
    digest_wheels(digest, &output->torque_nm);
}

/* Standing, creeping and moving in turn, with tares, wild torques and non-finite planned motions. */
static void drive(digest_t *digest, generator_t *generator, const gw_controller_config_t *config)
{
    static gw_estimator_t estimator;
    static const gw_real_t speeds_mps[3] = {(gw_real_t)0.0, (gw_real_t)0.01, (gw_real_t)0.3};
    gw_estimator_input_t input;
    digest_u32(digest, (uint32_t)gw_estimator_init(&estimator, &config->estimator, &config->geometry, &config->base,
                                                   &config->friction, config->period_s));
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        input.encoder_count[i] = 0;
    }
    for (uint32_t phase = 0U; phase < PHASES; phase++) {
        const gw_real_t speed_mps = speeds_mps[generator_below(generator, 3U)];
        const uint32_t turning = generator_below(generator, 30U);
        for (uint32_t tick = 0U; tick < PHASE_TICKS; tick++) {
            gw_estimator_output_t output;
            input.planned_twist = generator_twist(generator, speed_mps, speed_mps);
            input.planned_acceleration.ax_mps2 = generator_wild(generator, speed_mps);
            input.planned_acceleration.ay_mps2 = generator_between(generator, -speed_mps, speed_mps);
            input.planned_acceleration.alpha_radps2 = generator_between(generator, -speed_mps, speed_mps);
            input.torque_nm = generator_wheels(generator, (gw_real_t)0.2);
            input.torque_nm.wheel[phase % GW_WHEEL_COUNT] = generator_wild(generator, (gw_real_t)0.2);
            for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
                input.encoder_count[i] += (int32_t)(turning * i);
            }
            digest_u32(digest, (uint32_t)gw_estimator_step(&estimator, &input, &output));
            add_output(digest, &output);
            if ((phase % 7U) == 3U) {
                const gw_wheels_t quiet = generator_wheels(generator, (gw_real_t)0.1);
                digest_u32(digest, (uint32_t)gw_estimator_tare(&estimator, &quiet));
            }
        }
        digest_real(digest, gw_estimator_encoder_angle(&estimator, input.encoder_count[1]));
        if ((phase % 7U) == 2U) {
            gw_estimator_start_tare(&estimator);
        } else if ((phase % 7U) == 5U) {
            gw_estimator_restart(&estimator);
        } else {
            /* continue */
        }
    }
}

digest_t drive_estimator(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(20U);
    for (uint32_t velocity = 0U; velocity <= 1U; velocity++) {
        for (uint32_t acceleration = 0U; acceleration <= 3U; acceleration++) {
            gw_controller_config_t config;
            gw_controller_config_paper(&config);
            config.estimator.velocity_source = velocity;
            config.estimator.acceleration_source = (acceleration <= GW_SOURCE_ZERO) ? acceleration : 4U; /* refused */
            config.estimator.rest_ticks = 60U;
            config.estimator.retare_ticks = 40U;
            config.estimator.gear.coulomb_torque_nm = (acceleration == GW_SOURCE_ZERO) ? (gw_real_t)0.3 : GW_ZERO;
            drive(&digest, &generator, &config);
        }
    }
    return digest;
}
