/* What estimator, channels and controller do with an IMU; the IMU itself is in imu_test.c. */
#include "rig.h"

#define PERIOD R(0.001)

static gw_controller_config_t robot;
static gw_estimator_t estimator;
static gw_estimator_input_t input;
static gw_estimator_output_t output;

/* An estimator that stands, with an IMU that can be trusted. */
static void start(uint32_t aligned)
{
    static const gw_estimator_input_t nothing = {.imu = {.trusted = true}};
    gw_controller_config_paper(&robot);
    robot.estimator.acceleration_source = GW_SOURCE_IMU;
    robot.estimator.drivetrain_stiffness_nm_per_rad = GW_ZERO;
    robot.estimator.aligned = aligned;
    robot.estimator.tare_ticks = 0U;
    input = nothing;
    CHECK_STATUS(gw_estimator_init(&estimator, &robot.estimator, &robot.geometry, &robot.base, &robot.friction, PERIOD),
                 GW_STATUS_OK);
    CHECK(gw_estimator_invariant_holds(&estimator));
}

static void step(void)
{
    CHECK_STATUS(gw_estimator_step(&estimator, &input, &output), GW_STATUS_OK);
    CHECK(gw_estimator_invariant_holds(&estimator));
}

/* A robot that is pushed and accelerates without a torque of its wheels. */
static void its_acceleration_is_used_while_it_is_trusted(void)
{
    const gw_acceleration_t felt = {R(1.0), R(-2.0), R(3.0)};
    start(0U);
    input.imu.acceleration = felt;
    step();
    const gw_real_t mass = estimator.nominal.total_mass_kg;
    const gw_real_t inertia = estimator.nominal.total_yaw_inertia_kgm2;
    CHECK(output.acceleration_source == GW_SOURCE_IMU);
    CHECK(!output.zero_changed);
    CHECK_NEAR(output.wrench.force_x_n, mass, R(40.0) * ROUNDING);
    CHECK_NEAR(output.wrench.force_y_n, R(-2.0) * mass, R(80.0) * ROUNDING);
    CHECK_NEAR(output.wrench.torque_nm, R(3.0) * inertia, R(5.0) * ROUNDING);
    CHECK((output.forces.inertia_n.x == mass) && (output.forces.inertia_n.y == (R(-2.0) * mass)));
    CHECK(output.forces.inertia_moment_nm == (R(3.0) * inertia));
    input.imu.trusted = false;
    step();
    CHECK(output.acceleration_source == GW_SOURCE_MEASURED);
    CHECK_NEAR(output.wrench.force_x_n, GW_ZERO, ROUNDING);
}

static void an_acceleration_that_no_robot_has_is_not_used(void)
{
    const gw_real_t values[] = {unit_nan(), unit_infinity(), -unit_above(GW_IMU_ACCELERATION_MAX)};
    for (uint32_t i = 0U; i < 9U; i++) {
        start(0U);
        gw_real_t *const members[3] = {&input.imu.acceleration.ax_mps2, &input.imu.acceleration.ay_mps2,
                                       &input.imu.acceleration.alpha_radps2};
        *members[i % 3U] = values[i / 3U];
        unit_row(i);
        step();
        CHECK(output.acceleration_source == GW_SOURCE_MEASURED);
        CHECK_NEAR(output.wrench.force_x_n, GW_ZERO, ROUNDING);
    }
}

static void other_sources_do_not_look_at_it(void)
{
    const uint32_t sources[] = {GW_SOURCE_PLANNED, GW_SOURCE_MEASURED, GW_SOURCE_ZERO};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(sources); i++) {
        unit_row(i);
        start(0U);
        estimator.config.acceleration_source = sources[i];
        input.imu.acceleration.ax_mps2 = GW_ONE;
        input.imu.zero_step.ax_mps2 = GW_ONE;
        step();
        CHECK((output.acceleration_source == sources[i]) && (!output.zero_changed));
        CHECK_NEAR(output.wrench.force_x_n, GW_ZERO, ROUNDING);
    }
}

/* A step of the torques passes the low-pass of the acceleration that is used: 1 - (1 + w T) e^(-w T) after a tick. */
static void what_is_aligned_passes_the_low_pass_of_the_source(void)
{
    const gw_real_t corners[2] = {R(200.0), R(1000.0)};
    const gw_real_t reached[2] = {R(0.0175230963064218), R(0.264241117657115)};
    for (uint32_t i = 0U; i < 2U; i++) {
        start(1U);
        gw_estimator_set_imu_cutoff(&estimator, corners[1]);
        gw_estimator_set_imu_cutoff(&estimator, unit_nan()); /* refused */
        input.imu.trusted = (i == 1U);
        step();
        input.torque_nm.wheel[1] = R(-1.0);
        input.torque_nm.wheel[2] = R(1.0);
        step();
        unit_row(i);
        CHECK(robot.estimator.rate_cutoff_radps == corners[0]);
        CHECK_NEAR(output.wrench.force_x_n, -reached[i] * R(1.73205080756887729) / robot.geometry.wheel_radius_m,
                   R(17.0) * ROUNDING);
        /* As a fixed sign: pushed along -x by torques (0, -1, 1). */
    }
}

/* The step is told, nothing of before is averaged with it, and a gap forgets what was before. */
static void another_source_is_a_step_of_the_zero(void)
{
    start(0U);
    input.imu.acceleration.ax_mps2 = GW_ONE;
    input.imu.acceleration.ay_mps2 = R(2.0);
    input.imu.acceleration.alpha_radps2 = R(-1.0);
    step();
    step();
    CHECK(output.mean_samples == 2U);
    const gw_wrench_t before = output.wrench;
    for (uint32_t i = 0U; i < 2U; i++) {
        const gw_real_t sign = (i == 0U) ? -GW_ONE : GW_ONE; /* to the encoders, and back */
        input.imu.trusted = (i == 1U);
        unit_row(i);
        step();
        CHECK(output.zero_changed && (output.mean_samples == 1U));
        CHECK_NEAR(output.zero_step.force_x_n, sign * before.force_x_n, R(80.0) * ROUNDING);
        CHECK_NEAR(output.zero_step.force_y_n, sign * before.force_y_n, R(80.0) * ROUNDING);
        CHECK_NEAR(output.zero_step.torque_nm, sign * before.torque_nm, R(80.0) * ROUNDING);
        step();
        CHECK(!output.zero_changed);
    }
    gw_estimator_restart(&estimator);
    input.imu.trusted = false;
    step();
    CHECK(!output.zero_changed);
}

static void another_bias_is_a_step_of_the_zero(void)
{
    start(0U);
    step();
    input.imu.zero_step.ax_mps2 = R(0.5);
    input.imu.zero_step.ay_mps2 = R(-0.25);
    step();
    CHECK(output.zero_step.force_x_n == (R(0.5) * estimator.nominal.total_mass_kg));
    CHECK(output.zero_step.force_y_n == (R(-0.25) * estimator.nominal.total_mass_kg));
    CHECK((output.zero_step.torque_nm == GW_ZERO) && output.zero_changed);
    input.imu.zero_step.ax_mps2 = unit_nan();
    step();
    CHECK(gw_is_finite(output.zero_step.force_x_n));
}

static void only_a_measured_balance_can_be_aligned(void)
{
    const struct {
        uint32_t source;
        gw_config_field_t field;
    } rows[] = {
        {GW_SOURCE_PLANNED, GW_FIELD_ESTIMATOR_ALIGNED},
        {GW_SOURCE_MEASURED, GW_FIELD_NONE},
        {GW_SOURCE_ZERO, GW_FIELD_ESTIMATOR_ALIGNED},
        {GW_SOURCE_IMU, GW_FIELD_NONE},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        gw_config_error_t error;
        gw_controller_config_paper(&robot);
        robot.estimator.aligned = 1U;
        robot.estimator.acceleration_source = rows[i].source;
        gw_config_check_begin(&error);
        gw_estimator_config_check(&robot.estimator, &error);
        unit_row(i);
        CHECK_STATUS(error.field, rows[i].field);
    }
}

/* Variances behind the low-pass and a low-pass of the bank of white noise of variance 1 and of its differences over the
 * period: the sums of the squared answers to one sample. */
static void answers(const gw_fast_channel_t *channels, uint32_t j, gw_real_t cutoff, gw_real_t *of_value,
                    gw_real_t *of_change)
{
    gw_rate_filter_constants_t constants;
    gw_lowpass_t filter;
    gw_real_t value = GW_ZERO;
    gw_real_t change = GW_ZERO;
    CHECK_STATUS(gw_rate_filter_constants(&constants, PERIOD, cutoff, 4U, GW_ZERO), GW_STATUS_OK);
    gw_lowpass_restart(&filter);
    (void)gw_lowpass_step(&filter, &constants, GW_ZERO, R(1000.0));
    gw_real_t value_moved = GW_ZERO;
    gw_real_t change_moved = GW_ZERO;
    *of_value = GW_ZERO;
    *of_change = GW_ZERO;
    for (uint32_t i = 0U; i < 2000U; i++) {
        const gw_real_t before = filter.value;
        const gw_real_t now = gw_lowpass_step(&filter, &constants, (i == 0U) ? GW_ONE : GW_ZERO, R(1000.0));
        if (j == 2U) { /* of second order */
            value_moved += (channels->swing_share * (now - value)) - (channels->swing_loss * value_moved);
            value += value_moved;
            change_moved +=
                (channels->swing_share * (((now - before) / PERIOD) - change)) - (channels->swing_loss * change_moved);
            change += change_moved;
        } else {
            value += channels->bank_share[GW_BY_IMU][j] * (now - value);
            change += channels->bank_share[GW_BY_IMU][j] * (((now - before) / PERIOD) - change);
        }
        *of_value += value * value;
        *of_change += change * change;
    }
}

static void the_noise_of_the_residual_is_predicted(void)
{
    static gw_fast_channel_t channels;
    gw_channels_config_t config;
    const gw_channels_noise_t noise = {PERIOD,     R(200.0), R(0.0001), R(0.0001),
                                       R(0.00001), R(0.3),   GW_ZERO, /* no ripple */
                                       R(35.0),    R(1.5),   R(0.25),   {R(0.02), R(0.1), R(0.002), R(0.2), R(1000.0)}};
    gw_channels_config_trikey(&config);
    gw_fast_channel_init(&channels, &config, &noise);
    for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
        gw_real_t of_value;
        gw_real_t of_change;
        answers(&channels, j, noise.imu.cutoff_radps, &of_value, &of_change);
        const gw_real_t gyro = (R(0.002) * R(0.002)) * of_change;
        const gw_real_t rest_n2 = ((R(0.3) * R(0.3)) * of_value) +
                                  ((R(35.0) * R(35.0)) * ((R(0.02) * R(0.02) * of_value) + (R(0.02) * gyro)));
        const gw_real_t shaken_n2 = (R(35.0) * R(35.0)) * (R(0.1) * R(0.1));
        const gw_real_t forgiven_n2 = channels.noise_n2[GW_BY_ENCODERS][GW_REGIME_MOTION][j];
        const gw_real_t own_n2 = channels.noise_n2[GW_BY_IMU][GW_REGIME_REST][j];
        unit_row(j);
        /* The gyro's part is that of a derivative, up to a quarter more than that of a difference; steps of w T = 0.095
         * swing more than the second-order low-pass that is predicted. */
        const gw_real_t least = (j == 2U) ? R(0.93) : R(0.98);
        CHECK(gw_in_range(channels.gyro_noise_nm2[GW_BY_IMU][j], least * (R(2.25) * gyro), R(2.8125) * gyro));
        CHECK(gw_in_range(channels.noise_n2[GW_BY_IMU][GW_REGIME_REST][j], least * rest_n2, R(1.25) * rest_n2));
        CHECK_NEAR(channels.noise_n2[GW_BY_IMU][GW_REGIME_MOTION][j],
                   gw_max(own_n2, gw_min(own_n2 + shaken_n2, forgiven_n2)), shaken_n2 * R(10.0) * ROUNDING);
        /* What the structure shakes by is measured; until then the guess counts, but it is no lower bound. */
        CHECK(channels.least_noise_n2[GW_BY_IMU][GW_REGIME_MOTION][j] == own_n2);
        /* While creeping what is forgiven with encoders is forgiven in any case. */
        CHECK(channels.noise_n2[GW_BY_IMU][GW_REGIME_CREEPING][j] >=
              channels.noise_n2[GW_BY_ENCODERS][GW_REGIME_CREEPING][j]);
        CHECK(channels.least_noise_n2[GW_BY_IMU][GW_REGIME_CREEPING][j] >=
              channels.least_noise_n2[GW_BY_ENCODERS][GW_REGIME_CREEPING][j]);
        CHECK(channels.gyro_noise_nm2[GW_BY_ENCODERS][j] == GW_ZERO);
    }
    CHECK(channels.bank_share[GW_BY_IMU][0] > channels.bank_share[GW_BY_ENCODERS][0]);
}

static void tick(void)
{
    rig_input.imu.counter++;
    rig_tick(GW_STATUS_OK);
}

static void ticks(uint32_t count)
{
    for (uint32_t i = 0U; i < count; i++) {
        tick();
    }
}

/* A robot of 35 kg with an IMU that stands, tared, with both channels. The slow one looks for large forces only, so
 * that a bias may drift. */
static void rig_with_imu(void)
{
    rig_set_up();
    rig_config.base.mass_kg = R(35.0);
    rig_config.detector.kind = GW_DETECTOR_CHANNELS;
    rig_config.estimator.velocity_source = GW_SOURCE_MEASURED;
    rig_config.estimator.acceleration_source = GW_SOURCE_IMU;
    rig_config.estimator.aligned = 1U;
    rig_config.channels.slow.rest_n = R(1000.0);
    rig_config.imu.use = 1U;
    rig_config.imu.tare_ticks = 8U;
    rig_input.imu.present = true;
    rig_input.imu.specific_force_mps2[0] = R(0.2);
    rig_begin();
    ticks(200U);
    CHECK((rig_output.mode == GW_MODE_TRACKING) && (rig_output.detection_count == 0U));
    CHECK(rig_output.imu_trusted && (rig_output.acceleration_source == GW_SOURCE_IMU));
}

/* 15 N of a bias that drifted slowly come and go with the IMU: no hit. The same change within one source is one. */
static void a_change_of_the_source_is_no_hit(void)
{
    rig_with_imu();
    for (uint32_t i = 0U; i < 4000U; i++) {
        rig_input.imu.specific_force_mps2[0] = R(0.2) + (R(0.0001) * (gw_real_t)i);
        tick();
    }
    CHECK(rig_output.detection_count == 0U);
    CHECK(rig_output.estimate.force_x_n > R(13.0));
    for (uint32_t i = 0U; i < 6U; i++) {
        rig_input.imu.present = ((i & 1U) == 1U);
        unit_row(i);
        ticks(100U);
        CHECK(rig_output.imu_trusted == rig_input.imu.present);
        CHECK(rig_output.acceleration_source == (rig_output.imu_trusted ? GW_SOURCE_IMU : GW_SOURCE_MEASURED));
        CHECK((rig_output.detection_count == 0U) && (rig_output.mode == GW_MODE_TRACKING));
    }
    rig_input.imu.specific_force_mps2[0] -= R(0.4);
    ticks(10U);
    CHECK(rig_output.detection_count == 1U);
}

/* The same for the paper's detectors: what they have summed is forgotten. */
static void a_change_of_the_source_clears_the_paper_s_detectors(void)
{
    rig_with_imu();
    rig_config.detector.kind = GW_DETECTOR_IMPULSE;
    rig_config.detector.leak_rest_n = R(1.0);
    rig_begin();
    ticks(100U);
    rig_input.imu.specific_force_mps2[0] += R(0.4);
    ticks(25U);
    CHECK((rig_output.detection_count == 0U) && (rig_controller.detector.impulse_x_newton_s > R(0.1)));
    rig_input.imu.present = false;
    tick();
    CHECK((rig_output.detection_count == 0U) && (rig_controller.detector.impulse_x_newton_s < R(0.02)));
}

/* Stale and saturated in the middle of a contact: one contact, and the robot gives way. */
static void a_hit_that_saturates_it_is_one_hit(void)
{
    rig_with_imu();
    rig_input.imu.specific_force_mps2[0] = R(5.0);
    ticks(3U);
    CHECK(rig_output.detection_count == 1U);
    rig_input.imu.specific_force_mps2[0] = R(50.0);
    ticks(20U);
    CHECK((!rig_output.imu_trusted) && (rig_output.acceleration_source == GW_SOURCE_MEASURED));
    CHECK((rig_output.detection_count == 1U) && (rig_output.mode == GW_MODE_REACTING));
    CHECK(rig_output.reference_twist.vx_mps > GW_ZERO);
}

/* Without good wheel sensors the robot is in fault; the IMU is looked at nevertheless. */
static void a_fault_of_the_wheels_sensors_leaves_it_alone(void)
{
    rig_with_imu();
    rig_input.sensor.present = false;
    rig_input.imu.counter++;
    rig_tick(GW_STATUS_SENSOR_MISSING);
    CHECK((rig_output.mode == GW_MODE_FAULT) && rig_output.imu_trusted);
    rig_input.sensor.present = true;
    for (uint32_t i = 0U; i < rig_config.sensor_check.recover_ticks; i++) {
        rig_input.imu.counter++;
        rig_tick(GW_STATUS_SENSOR_RECOVERING);
    }
    ticks(100U);
    CHECK((rig_output.acceleration_source == GW_SOURCE_IMU) && (rig_output.detection_count == 0U));
}

static void a_controller_without_it_does_not_look_at_it(void)
{
    rig_with_imu();
    rig_config.estimator.acceleration_source = GW_SOURCE_MEASURED;
    rig_begin();
    ticks(200U);
    CHECK((!rig_output.imu_trusted) && (rig_output.acceleration_source == GW_SOURCE_MEASURED));
    rig_config.estimator.acceleration_source = GW_SOURCE_IMU;
    rig_config.imu.use = 0U;
    rig_begin();
    ticks(200U);
    CHECK((!rig_output.imu_trusted) && (rig_output.acceleration_source == GW_SOURCE_MEASURED));
    CHECK(gw_controller_invariant_holds(&rig_controller));
    rig_controller.imu.initialised = false;
    CHECK(!gw_controller_invariant_holds(&rig_controller));
}

void suite_imu_use(void)
{
    unit_run("its_acceleration_is_used_while_it_is_trusted", its_acceleration_is_used_while_it_is_trusted);
    unit_run("an_acceleration_that_no_robot_has_is_not_used", an_acceleration_that_no_robot_has_is_not_used);
    unit_run("other_sources_do_not_look_at_it", other_sources_do_not_look_at_it);
    unit_run("what_is_aligned_passes_the_low_pass_of_the_source", what_is_aligned_passes_the_low_pass_of_the_source);
    unit_run("another_source_is_a_step_of_the_zero", another_source_is_a_step_of_the_zero);
    unit_run("another_bias_is_a_step_of_the_zero", another_bias_is_a_step_of_the_zero);
    unit_run("only_a_measured_balance_can_be_aligned", only_a_measured_balance_can_be_aligned);
    unit_run("the_noise_of_the_residual_is_predicted", the_noise_of_the_residual_is_predicted);
    unit_run("a_change_of_the_source_is_no_hit", a_change_of_the_source_is_no_hit);
    unit_run("a_change_of_the_source_clears_the_paper_s_detectors",
             a_change_of_the_source_clears_the_paper_s_detectors);
    unit_run("a_hit_that_saturates_it_is_one_hit", a_hit_that_saturates_it_is_one_hit);
    unit_run("a_fault_of_the_wheels_sensors_leaves_it_alone", a_fault_of_the_wheels_sensors_leaves_it_alone);
    unit_run("a_controller_without_it_does_not_look_at_it", a_controller_without_it_does_not_look_at_it);
}
