#include "generator.h"
#include "giveway/gw_config.h"
#include "giveway/gw_contact.h"
#include "giveway/gw_detector.h"
#include "giveway/gw_math.h"
#include "giveway/gw_sensor_check.h"
#include "giveway/gw_supervisor.h"
#include "modules.h"

digest_t drive_config(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(11U);
    for (uint32_t row = 0U; row <= (uint32_t)GW_FIELD_COUNT; row++) {
        const gw_config_field_t field = (gw_config_field_t)row;
        const gw_config_limit_t limit = gw_config_limit(field);
        digest_text(&digest, gw_config_name(field));
        digest_real(&digest, limit.minimum);
        digest_real(&digest, limit.maximum);
        for (uint32_t i = 0U; i < 16U; i++) {
            gw_config_error_t error;
            gw_config_check_begin(&error);
            gw_config_check_element(&error, field, i, generator_any(&generator));
            gw_config_check_element(&error, field, i, (gw_real_t)generator_u32(&generator));
            gw_config_check_relation(&error, field, i, generator_any(&generator), GW_ZERO, GW_ONE);
            digest_config_error(&digest, &error);
        }
    }
    return digest;
}

digest_t drive_sensor_check(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(12U);
    gw_sensor_check_config_t config = {(gw_real_t)28.0, 3U, 200U, 10U};
    gw_sensor_check_t check;
    gw_sensor_sample_t sample = {{GW_ZERO, GW_ZERO, GW_ZERO}, {0, 0, 0}, 0xFFFFFF00U, true};
    digest_u32(&digest, (uint32_t)gw_sensor_check_init(&check, &config));
    for (uint32_t i = 0U; i < 5000U; i++) {
        const uint32_t most = generator_one_in(&generator, 60U) ? 1000U : 150U;
        for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
            const uint32_t count = (uint32_t)sample.encoder_count[k] + generator_below(&generator, most);
            sample.torque_nm[k] = generator_between(&generator, (gw_real_t)-27.0, (gw_real_t)27.0);
            sample.encoder_count[k] = (int32_t)(count & GW_TICK_MASK);
        }
        if (generator_one_in(&generator, 40U)) {
            const uint32_t wheel = generator_below(&generator, GW_WHEEL_COUNT);
            sample.torque_nm[wheel] = generator_wild(&generator, (gw_real_t)40.0);
        }
        sample.present = !generator_one_in(&generator, 80U);
        sample.counter += generator_one_in(&generator, 4U) ? 0U : 1U;
        digest_u32(&digest, (uint32_t)gw_sensor_check_step(&check, &sample));
    }
    return digest;
}

digest_t drive_contact(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(13U);
    for (uint32_t count = 2U; count <= GW_OUTLINE_VERTEX_MAX; count++) { /* two are refused */
        gw_contact_config_t config;
        gw_contact_t contact;
        config.vertex_count = count;
        config.minimum_force_n = GW_ONE;
        for (uint32_t i = 0U; i < GW_OUTLINE_VERTEX_MAX; i++) {
            const gw_real_t angle_rad = ((GW_TWO * GW_PI) * (gw_real_t)(i % count)) / (gw_real_t)count;
            const gw_rotation_t corner = gw_sincos(angle_rad);
            config.vertex_m[i].x = corner.cosine;
            config.vertex_m[i].y = (gw_real_t)0.5 * corner.sine;
        }
        digest_u32(&digest, (uint32_t)gw_contact_init(&contact, &config));
        for (uint32_t i = 0U; i < 150U; i++) {
            gw_wrench_sigma_t sigma;
            gw_contact_estimate_t estimate;
            sigma.force_n = generator_between(&generator, GW_ZERO, GW_ONE);
            sigma.torque_nm = generator_between(&generator, GW_ZERO, GW_ONE);
            const gw_wrench_t wrench = generator_wrench(&generator, (gw_real_t)20.0, (gw_real_t)10.0);
            digest_u32(&digest, (uint32_t)gw_contact_locate(&contact, wrench, sigma, &estimate));
            digest_contact(&digest, &estimate);
        }
    }
    return digest;
}

static gw_detector_config_t detector_config(uint32_t kind)
{
    gw_detector_config_t config;
    config.kind = kind;
    config.force_threshold_n = (gw_real_t)10.0;
    config.impulse_threshold_newton_s = (gw_real_t)1.4;
    config.leak_rest_n = GW_ONE;
    config.leak_creep_n = (gw_real_t)20.0;
    config.leak_motion_n = (gw_real_t)3.0;
    config.release_force_n = (gw_real_t)6.0;
    config.blanking_ticks = 30U;
    return config;
}

digest_t drive_detector(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(14U);
    static const uint32_t kinds[] = {GW_DETECTOR_FORCE_AVERAGE, GW_DETECTOR_IMPULSE, 3U /* refused */};
    for (uint32_t k = 0U; k < 3U; k++) {
        const gw_detector_config_t config = detector_config(kinds[k]);
        gw_detector_t detector;
        gw_wrench_t push = {GW_ZERO, GW_ZERO, GW_ZERO};
        uint32_t regime = 0U;
        digest_u32(&digest, (uint32_t)gw_detector_init(&detector, &config, (gw_real_t)0.001));
        for (uint32_t i = 0U; i < 5000U; i++) {
            gw_detector_input_t input;
            gw_detector_output_t output;
            if (generator_one_in(&generator, 120U)) {
                push.force_x_n = generator_between(&generator, (gw_real_t)-60.0, (gw_real_t)60.0);
                push.force_y_n = generator_between(&generator, (gw_real_t)-60.0, (gw_real_t)60.0);
                regime = generator_below(&generator, 3U);
            }
            input.wrench = generator_wrench(&generator, GW_ONE, GW_ONE);
            input.wrench.force_x_n += push.force_x_n;
            input.wrench.force_y_n += push.force_y_n;
            input.mean = push;
            input.window_mean = push;
            input.mean_samples = 20U;
            input.regime = (gw_regime_t)regime;
            input.enabled = !generator_one_in(&generator, 200U);
            input.reaction_over = generator_one_in(&generator, 100U);
            digest_u32(&digest, (uint32_t)gw_detector_step(&detector, &input, &output));
            digest_bool(&digest, output.tripped);
            digest_bool(&digest, output.active);
            digest_real(&digest, output.statistic);
            digest_wrench(&digest, output.mean_wrench);
            digest_u32(&digest, output.samples);
            if (generator_one_in(&generator, 1000U)) {
                gw_detector_reset(&detector);
            }
        }
    }
    return digest;
}

digest_t drive_supervisor(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(15U);
    for (uint32_t after = 0U; after < 3U; after++) { /* the third is refused */
        const gw_supervisor_config_t config = {(gw_real_t)0.005, 4U, after, (gw_real_t)0.0002, (gw_real_t)0.0005};
        gw_supervisor_t supervisor;
        digest_u32(&digest, (uint32_t)gw_supervisor_init(&supervisor, &config));
        for (uint32_t i = 0U; i < 4000U; i++) {
            gw_supervisor_events_t events;
            events.sensors_good = !generator_one_in(&generator, 50U);
            events.stop_request = generator_one_in(&generator, 60U);
            events.tare_accepted = generator_one_in(&generator, 30U);
            events.tare_done = generator_one_in(&generator, 5U);
            events.hit = generator_one_in(&generator, 20U);
            events.quiet = !generator_one_in(&generator, 4U);
            events.on_path = generator_one_in(&generator, 5U);
            events.plan_valid = !generator_one_in(&generator, 10U);
            digest_u32(&digest, (uint32_t)gw_supervisor_step(&supervisor, &events));
            digest_u32(&digest, supervisor.path_ticks);
        }
    }
    return digest;
}
