/* The two-channel detector and its parts, the IMU, the limit of tipping. */
#include "generator.h"
#include "giveway/gw_balance.h"
#include "giveway/gw_channels.h"
#include "giveway/gw_imu.h"
#include "giveway/gw_math.h"
#include "giveway/gw_model_covariance.h"
#include "giveway/gw_ripple.h"
#include "giveway/gw_slip.h"
#include "giveway/gw_tip.h"
#include "modules.h"
#include "random_robot.h"

#define PERIOD_S ((gw_real_t)0.001)

static gw_model_forces_t random_forces(generator_t *generator, gw_real_t size_n)
{
    gw_model_forces_t forces;
    forces.friction_n = generator_wheels(generator, size_n);
    forces.inertia_n = generator_vector(generator, size_n);
    forces.inertia_moment_nm = generator_between(generator, -size_n, size_n);
    return forces;
}

static void digest_model_forces(digest_t *digest, const gw_model_forces_t *forces)
{
    digest_wheels(digest, &forces->friction_n);
    digest_vector(digest, forces->inertia_n);
    digest_real(digest, forces->inertia_moment_nm);
}

static void digest_balance(digest_t *digest, const gw_balance_t *balance)
{
    digest_wrench(digest, balance->residual);
    digest_model_forces(digest, &balance->model);
}

/* Forces within and beyond the limits. */
digest_t drive_balance(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(31U);
    gw_balance_t balance = {{GW_ZERO, GW_ZERO, GW_ZERO}, {{{GW_ZERO, GW_ZERO, GW_ZERO}}, {GW_ZERO, GW_ZERO}, GW_ZERO}};
    for (uint32_t i = 0U; i < 1000U; i++) {
        const gw_real_t size = generator_one_in(&generator, 4U) ? (gw_real_t)1.0e7 : (gw_real_t)100.0;
        const gw_wrench_t residual = generator_wrench(&generator, size, size);
        const gw_model_forces_t model = random_forces(&generator, size);
        const gw_balance_t now = gw_balance_limited(&residual, &model);
        const gw_balance_t change = gw_balance_difference(&now, &balance);
        gw_balance_approach(&balance, &now, generator_between(&generator, GW_ZERO, GW_HALF));
        balance.residual = gw_balance_sum(balance.residual, generator_wrench(&generator, size, size));
        digest_balance(&digest, &change);
        digest_balance(&digest, &balance);
    }
    return digest;
}

#if (GW_WITH_ESCAPE == 1)
digest_t drive_tip(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(32U);
    for (uint32_t k = 0U; k < 50U; k++) {
        const gw_kinematics_t kinematics = random_kinematics(&generator);
        gw_tip_config_t config;
        gw_tip_t tip;
        gw_tip_config_trikey(&config);
        config.height_m = generator_one_in(&generator, 5U) ? GW_ZERO : generator_between(&generator, GW_ZERO, GW_TWO);
        config.share = generator_between(&generator, (gw_real_t)0.01, GW_ONE);
        gw_tip_init(&tip, &config, &kinematics);
        digest_real(&digest, tip.margin_mps2);
        for (uint32_t i = 0U; i < 50U; i++) {
            const gw_rotation_t along = gw_sincos(generator_between(&generator, -GW_PI, GW_PI));
            const gw_vector_t unit = {along.cosine, along.sine};
            digest_real(&digest, gw_tip_share(&tip, generator_vector(&generator, (gw_real_t)0.02), PERIOD_S));
            digest_real(&digest, gw_tip_along(&tip, unit, generator_between(&generator, GW_ZERO, (gw_real_t)20.0)));
        }
    }
    return digest;
}
#endif

#if (GW_WITH_CHANNELS == 1)
static void digest_covariance(digest_t *digest, gw_planar_covariance_t covariance)
{
    digest_real(digest, covariance.xx);
    digest_real(digest, covariance.xy);
    digest_real(digest, covariance.yy);
}

/* Friction and mass that differ, a slope, and what no factor explains. */
static void teach(generator_t *generator, const gw_kinematics_t *kinematics, gw_follower_t *follower)
{
    const gw_model_forces_t forces = random_forces(generator, (gw_real_t)25.0);
    const gw_regressors_t regressors = gw_follower_regressors(kinematics, &forces);
    gw_vector_t residual_n = generator_vector(generator, (gw_real_t)4.0);
    for (uint32_t i = 0U; i < GW_FOLLOWED_COUNT; i++) {
        residual_n.x -= (gw_real_t)0.2 * regressors.of[i].x;
        residual_n.y -= (gw_real_t)0.2 * regressors.of[i].y;
    }
    gw_follower_learn(follower, &regressors, residual_n, generator_one_in(generator, 2U));
}

digest_t drive_follower(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(33U);
    for (uint32_t k = 0U; k < 10U; k++) {
        const gw_kinematics_t kinematics = random_kinematics(&generator);
        gw_follower_config_t config;
        gw_follower_t follower;
        gw_follower_config_trikey(&config);
        gw_follower_init(&follower, &config, (gw_real_t)0.008);
        for (uint32_t i = 0U; i < 200U; i++) {
            const gw_model_forces_t forces = random_forces(&generator, (gw_real_t)25.0);
            const gw_regressors_t regressors = gw_follower_regressors(&kinematics, &forces);
            teach(&generator, &kinematics, &follower);
            digest_vector(&digest, gw_follower_correction(&follower, &kinematics, &forces));
            digest_covariance(&digest, gw_follower_uncertainty(&follower, &regressors));
        }
    }
    return digest;
}

digest_t drive_model_covariance(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(34U);
    gw_channels_config_t config;
    gw_follower_t follower;
    gw_channels_config_trikey(&config);
    gw_follower_init(&follower, &config.follower, (gw_real_t)0.008);
    for (uint32_t i = 0U; i < 500U; i++) {
        const gw_kinematics_t kinematics = random_kinematics(&generator);
        const gw_model_forces_t change = random_forces(&generator, (gw_real_t)25.0);
        const gw_model_forces_t model = random_forces(&generator, (gw_real_t)25.0);
        const gw_real_t sliding_n = generator_between(&generator, GW_ZERO, (gw_real_t)30.0);
        teach(&generator, &kinematics, &follower);
        digest_covariance(&digest, gw_model_covariance(&config, &kinematics, &follower, &change, &model, sliding_n,
                                                       config.presliding));
    }
    return digest;
}

/* Robots with and without grip, whose wheels come near it and do not, while that matters and while it does not. */
digest_t drive_slip(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(42U);
    for (uint32_t i = 0U; i < 40U; i++) {
        const gw_kinematics_t kinematics = random_kinematics(&generator);
        const bool grips = !generator_one_in(&generator, 8U);
        const gw_real_t grip = grips ? generator_between(&generator, GW_ZERO, GW_TWO) : GW_ZERO;
        const gw_real_t mass_kg = generator_between(&generator, GW_ONE, (gw_real_t)60.0);
        gw_slip_t slip;
        gw_slip_init(&slip, grip, mass_kg, (gw_real_t)2.5, (gw_real_t)0.85);
        for (uint32_t k = 0U; k < 50U; k++) {
            const gw_wheels_t torques_nm = generator_wheels(&generator, (gw_real_t)15.0);
            const gw_planar_covariance_t known = {GW_ONE, GW_HALF, GW_TWO};
            gw_slip_step(&slip, &kinematics, &torques_nm, !generator_one_in(&generator, 3U));
            digest_covariance(&digest, gw_slip_added(&slip, &kinematics, known));
            digest_real(&digest, gw_slip_sum(&slip));
        }
    }
    return digest;
}

/* Wheels that are even and uneven, and contacts in between. */
digest_t drive_ripple(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(43U);
    for (uint32_t i = 0U; i < 40U; i++) {
        const gw_kinematics_t kinematics = random_kinematics(&generator);
        const gw_real_t uneven = generator_between(&generator, GW_ZERO, (gw_real_t)0.12);
        gw_ripple_t ripple;
        gw_ripple_init(&ripple, generator_between(&generator, GW_ZERO, GW_ONE), (gw_real_t)0.004);
        for (uint32_t k = 0U; k < 800U; k++) {
            const gw_real_t friction_n2 = generator_between(&generator, (gw_real_t)400.0, (gw_real_t)1500.0);
            const gw_real_t force_n2 = friction_n2 * generator_between(&generator, GW_ZERO, uneven);
            const gw_real_t turned_rad = generator_between(&generator, GW_ZERO, (gw_real_t)0.02);
            const bool reacting = generator_one_in(&generator, 4U);
            if (generator_one_in(&generator, 60U)) {
                gw_ripple_leave_out(&ripple);
            } else {
                gw_ripple_follow(&ripple, turned_rad, force_n2, friction_n2, reacting);
                gw_ripple_go_on(&ripple);
            }
            const gw_real_t variance = gw_ripple_variance(&ripple, reacting);
            const gw_wheels_t friction_n = generator_wheels(&generator, (gw_real_t)25.0);
            const gw_planar_covariance_t known = {GW_ONE, GW_HALF, GW_TWO};
            digest_real(&digest, variance);
            digest_real(&digest, gw_ripple_usual(&ripple, reacting));
            digest_covariance(&digest, gw_ripple_added(variance, &kinematics, &friction_n, known));
        }
    }
    return digest;
}

/* An IMU on a robot that stands and moves, with samples that are missing, old, saturated or not finite. */
digest_t drive_imu(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(35U);
    gw_imu_config_t config;
    gw_imu_t imu;
    gw_imu_sample_t sample = {{GW_ZERO, GW_ZERO}, GW_ZERO, 0xFFFFFF00U, true};
    gw_imu_config_trikey(&config);
    config.use = 1U;
    config.position_x_m = (gw_real_t)0.1;
    config.position_y_m = (gw_real_t)-0.05;
    config.angle_rad = (gw_real_t)0.7;
    config.gyro_scale = (gw_real_t)1.01;
    digest_u32(&digest, (uint32_t)gw_imu_init(&imu, &config, PERIOD_S));
    for (uint32_t i = 0U; i < 5000U; i++) {
        const bool at_rest = (i % 700U) < 300U;
        const gw_real_t size = at_rest ? (gw_real_t)0.1 : GW_TWO;
        gw_imu_output_t output;
        sample.specific_force_mps2[0] = (gw_real_t)0.2 + generator_between(&generator, -size, size);
        sample.specific_force_mps2[1] = (gw_real_t)-0.1 + generator_between(&generator, -size, size);
        sample.yaw_rate_radps = generator_between(&generator, -size, size);
        sample.counter += generator_one_in(&generator, 50U) ? 0U : 1U;
        sample.present = !generator_one_in(&generator, 400U);
        if (generator_one_in(&generator, 300U)) {
            sample.yaw_rate_radps = generator_wild(&generator, (gw_real_t)30.0);
        }
        digest_u32(&digest, (uint32_t)gw_imu_step(&imu, &sample, at_rest, &output));
        digest_acceleration(&digest, output.acceleration);
        digest_acceleration(&digest, output.zero_step);
        digest_bool(&digest, output.trusted);
        digest_real(&digest, output.shaking_mps2_2);
    }
    return digest;
}

static gw_channels_noise_t trikey_noise(void)
{
    gw_channels_noise_t noise;
    gw_imu_config_t imu_config;
    gw_imu_t imu;
    gw_imu_config_trikey(&imu_config);
    (void)gw_imu_init(&imu, &imu_config, PERIOD_S);
    noise.period_s = PERIOD_S;
    noise.cutoff_radps = (gw_real_t)500.0;
    noise.encoder_step_m = (gw_real_t)0.000074;
    noise.observed_step_m = noise.encoder_step_m;
    noise.twist_noise_m = (gw_real_t)0.00002;
    noise.force_noise_n = GW_ONE;
    noise.sliding_n = (gw_real_t)20.0;
    noise.mass_kg = (gw_real_t)25.0;
    noise.yaw_inertia_kgm2 = GW_ONE;
    noise.wheel_distance_m = (gw_real_t)0.2;
    noise.imu = gw_imu_noise(&imu);
    return noise;
}

/* A robot that stands, creeps and moves, is hit and pushed, whose zero and whose sensor change. */
static digest_t play_channels(uint32_t seed, void (*take)(digest_t *digest, const gw_channels_t *channels,
                                                          const gw_channels_output_t *output))
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(seed);
    const gw_kinematics_t kinematics = random_kinematics(&generator);
    const gw_channels_noise_t noise = trikey_noise();
    gw_channels_config_t config;
    gw_channels_t channels;
    gw_channels_output_t output = {.mean_wrench = {GW_ZERO, GW_ZERO, GW_ZERO}};
    gw_wrench_t push = {GW_ZERO, GW_ZERO, GW_ZERO};
    gw_model_forces_t steady = random_forces(&generator, (gw_real_t)20.0);
    uint32_t regime = 0U;
    bool felt = false;
    gw_channels_config_trikey(&config);
    config.settle_ticks = 100U;
    config.rocking = GW_ONE;
    gw_channels_init(&channels, &config, &noise);
    for (uint32_t i = 0U; i < 8000U; i++) {
        gw_channels_input_t input;
        gw_wrench_t wrench = generator_wrench(&generator, GW_ONE, (gw_real_t)0.2);
        const gw_wrench_t zero_step = generator_wrench(&generator, GW_TWO, GW_HALF);
        if (generator_one_in(&generator, 250U)) {
            const bool lets_go = generator_one_in(&generator, 2U);
            push = generator_wrench(&generator, lets_go ? GW_ZERO : (gw_real_t)60.0, lets_go ? GW_ZERO : GW_TWO);
            regime = (generator_below(&generator, 4U) == 0U) ? generator_below(&generator, 2U) : 2U;
            steady = random_forces(&generator, (regime == 0U) ? GW_ZERO : (gw_real_t)25.0);
        }
        wrench.force_x_n += push.force_x_n + ((gw_real_t)0.2 * steady.inertia_n.x);
        wrench.force_y_n += push.force_y_n + ((gw_real_t)0.2 * steady.inertia_n.y);
        wrench.torque_nm += push.torque_nm;
        input.zero_changed = generator_one_in(&generator, 300U);
        felt = (input.zero_changed && generator_one_in(&generator, 2U)) ? (!felt) : felt;
        input.wrench = &wrench;
        input.forces = &steady;
        input.zero_step = &zero_step;
        input.regime = (gw_regime_t)regime;
        input.turned = (regime != 0U) || generator_one_in(&generator, 500U);
        input.counted = GW_ZERO; /* the motors are not observed */
        input.enabled = !generator_one_in(&generator, 200U);
        input.reacting = generator_one_in(&generator, 100U);
        input.felt = felt;
        input.shaking_mps2_2 = generator_between(&generator, GW_ZERO, (gw_real_t)0.01);
        input.gear_n2 = generator_between(&generator, GW_ZERO, (gw_real_t)16.0);
        const gw_wheels_t torque_nm = generator_wheels(&generator, (gw_real_t)6.0);
        input.torque_nm = &torque_nm;
        const gw_twist_t twist = generator_twist(&generator, GW_HALF, GW_ONE);
        input.twist = &twist;
        gw_channels_step(&channels, &kinematics, &input, &output);
        take(&digest, &channels, &output);
        if (generator_one_in(&generator, 2000U)) {
            gw_channels_restart(&channels);
        }
    }
    return digest;
}

static void take_output(digest_t *digest, const gw_channels_t *channels, const gw_channels_output_t *output)
{
    (void)channels;
    digest_bool(digest, output->tripped);
    digest_bool(digest, output->active);
    digest_bool(digest, output->refined);
    digest_u32(digest, output->channel);
    digest_real(digest, output->statistic);
    digest_wrench(digest, output->mean_wrench);
}

static void take_fast(digest_t *digest, const gw_channels_t *channels, const gw_channels_output_t *output)
{
    const gw_fast_channel_t *const fast = &channels->fast;
    (void)output;
    for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
        digest_wrench(digest, fast->bank[j]);
        for (uint32_t set = 0U; set < GW_NOISE_SETS; set++) {
            digest_real(digest, fast->noise_n2[fast->sensor][set][j]);
        }
    }
    digest_balance(digest, &fast->baseline);
    digest_covariance(digest, fast->model_n2);
    digest_real(digest, fast->moment_nm2);
    digest_wrench(digest, fast->held);
    digest_vector(digest, fast->doubt_n);
    digest_real(digest, fast->held_share);
}

static void take_slow(digest_t *digest, const gw_channels_t *channels, const gw_channels_output_t *output)
{
    (void)output;
    digest_balance(digest, &channels->slow.mean);
    digest_balance(digest, &channels->slow.baseline);
    digest_vector(digest, channels->slow.force_n);
    digest_real(digest, channels->slow.statistic);
}

digest_t drive_channels(void)
{
    return play_channels(36U, take_output);
}

digest_t drive_fast_channel(void)
{
    return play_channels(37U, take_fast);
}

digest_t drive_slow_channel(void)
{
    return play_channels(38U, take_slow);
}
#endif
