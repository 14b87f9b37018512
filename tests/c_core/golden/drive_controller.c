#include "giveway/gw_math.h"
#include "modules.h"
#include "recorded_collision.h"
#include "script.h"

/* Sets of what the controller has shown so far, by bits. */
typedef struct {
    uint32_t modes;
    uint32_t statuses;
} reached_t;

static reached_t reached_so_far = {0U, 0U};

static void one_step(digest_t *digest, gw_controller_t *controller, const gw_controller_input_t *input,
                     gw_controller_output_t *output)
{
    const gw_status_t status = gw_controller_step(controller, input, output);
    digest_controller(digest, status, output);
    reached_so_far.modes |= (uint32_t)1U << (uint32_t)output->mode;
    reached_so_far.statuses |= (uint32_t)1U << (uint32_t)status;
}

static digest_t play(const gw_controller_config_t *config, uint32_t seed, bool valid_plans)
{
    static gw_controller_t controller;
    static script_t script;
    digest_t digest = digest_begin();
    gw_controller_output_t output;
    (void)gw_controller_init(&controller, config, NULL); /* refused: only fault, and controller.reached would change */
    gw_controller_safe_output(&output);
    script_begin(&script, config, seed, valid_plans);
    for (uint32_t tick = 0U; tick < SCRIPT_TICKS; tick++) {
        one_step(&digest, &controller, script_next(&script, &output), &output);
    }
    return digest;
}

digest_t drive_controller_trikey(void)
{
    gw_controller_config_t config;
    gw_controller_config_paper(&config);
    return play(&config, SCRIPT_TRIKEY_SEED, true);
}

/* Everything that the first drive does not cover: measured motion, live force, force average, odd geometry, non-finite
 * plans.
 */
digest_t drive_controller_measuring(void)
{
    gw_controller_config_t config;
    gw_controller_config_paper(&config);
    config.period_s = (gw_real_t)0.002;
    config.geometry.azimuth_rad = (gw_real_t)0.7;
    config.geometry.wheel_slot[0] = 2U;
    config.geometry.wheel_slot[2] = 0U;
    config.estimator.velocity_source = GW_SOURCE_MEASURED;
    config.estimator.acceleration_source = GW_SOURCE_MEASURED;
    config.estimator.average_window = 7U;
    config.estimator.rest_ticks = 100U;
    config.detector.kind = GW_DETECTOR_FORCE_AVERAGE;
    config.detector.blanking_ticks = 50U;
    config.admittance.kind = GW_ADMITTANCE_LIVE_FORCE;
    config.admittance.damping_newton_s_per_m = (gw_real_t)40.0;
    config.supervisor.settled_ticks = 50U;
    config.contact.vertex_count = GW_OUTLINE_VERTEX_MAX;
    for (uint32_t i = 0U; i < GW_OUTLINE_VERTEX_MAX; i++) {
        const gw_rotation_t corner = gw_sincos((gw_real_t)i * (GW_PI / (gw_real_t)8.0));
        config.contact.vertex_m[i].x = (gw_real_t)0.4 * corner.cosine;
        config.contact.vertex_m[i].y = (gw_real_t)0.3 * corner.sine;
    }
    return play(&config, 22U, false);
}

/* The drives are never enabled, and there is no tare. */
digest_t drive_controller_watching(void)
{
    gw_controller_config_t config;
    gw_controller_config_paper(&config);
    config.drives_enabled = false;
    config.estimator.tare_ticks = 0U;
    config.estimator.acceleration_source = GW_SOURCE_ZERO;
    config.estimator.drivetrain_stiffness_nm_per_rad = GW_ZERO;
    config.supervisor.after_settled = GW_AFTER_SETTLED_HOLD;
    return play(&config, 23U, false);
}

/* The estimator that follows the rollers' bristles. */
digest_t drive_controller_bristles(void)
{
    gw_controller_config_t config;
    gw_controller_config_paper(&config);
    config.estimator.friction_model = GW_FRICTION_BRISTLE;
    config.estimator.velocity_source = GW_SOURCE_MEASURED;
    config.estimator.acceleration_source = GW_SOURCE_MEASURED;
    config.estimator.rate_cutoff_radps = (gw_real_t)300.0;
    return play(&config, 24U, true);
}

#if (GW_WITH_CHANNELS == 1)
/* What is recommended, with an IMU. */
digest_t drive_controller_channels(void)
{
    gw_controller_config_t config;
    gw_controller_config_trikey(&config);
    config.estimator.acceleration_source = GW_SOURCE_IMU;
    config.imu.use = 1U;
    return play(&config, 39U, true);
}
#endif

digest_t drive_controller_recorded(void)
{
    static gw_controller_t controller;
    digest_t digest = digest_begin();
    gw_controller_config_t config;
    gw_controller_output_t output;
    recorded_collision_config(&config);
    (void)gw_controller_init(&controller, &config, NULL);
    for (uint32_t tick = 0U; tick < RECORDED_TICKS; tick++) {
        gw_controller_input_t input;
        recorded_collision_input(tick, &input);
        one_step(&digest, &controller, &input, &output);
    }
    return digest;
}

digest_t drive_controller_reached(void)
{
    const digest_t reached = {((uint64_t)reached_so_far.modes << 32U) | reached_so_far.statuses};
    return reached;
}
