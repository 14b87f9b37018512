#include "unit.h"

#define PERIOD R(0.001)

/* A part that is not at the centre, turned by 0.5 rad, with errors of scale and bias. */
static const gw_real_t bias[GW_IMU_SIGNALS] = {R(0.3), R(-0.2), R(0.01)};
static gw_imu_config_t config;
static gw_imu_t imu;
static gw_imu_sample_t sample;
static gw_imu_output_t output;

static void set_up(void)
{
    static const gw_imu_sample_t nothing = {0};
    gw_imu_config_trikey(&config);
    config.use = 1U;
    config.position_x_m = R(0.1);
    config.position_y_m = R(-0.2);
    config.angle_rad = R(0.5);
    config.acceleration_scale = R(1.25);
    config.gyro_scale = R(0.8);
    config.tare_ticks = 8U;
    config.cutoff_radps = R(800.0);
    sample = nothing;
    sample.present = true;
}

static void begin(void)
{
    CHECK_STATUS(gw_imu_init(&imu, &config, PERIOD), GW_STATUS_OK);
    CHECK(gw_imu_invariant_holds(&imu));
}

static void start(void)
{
    set_up();
    begin();
}

/* What the part shows for a motion of the base's centre. */
static void show(gw_real_t ax, gw_real_t ay, gw_real_t omega, gw_real_t alpha)
{
    const gw_rotation_t mounting = gw_sincos(config.angle_rad);
    const gw_vector_t there = {ax - (alpha * config.position_y_m) - (omega * omega * config.position_x_m),
                               ay + (alpha * config.position_x_m) - (omega * omega * config.position_y_m)};
    const gw_vector_t along = gw_rotate_back(mounting, there);
    sample.specific_force_mps2[0] = (along.x * config.acceleration_scale) + bias[0];
    sample.specific_force_mps2[1] = (along.y * config.acceleration_scale) + bias[1];
    sample.yaw_rate_radps = (omega * config.gyro_scale) + bias[2];
}

/* One tick with the sample as it is. */
static gw_status_t step(bool at_rest)
{
    const gw_status_t status = gw_imu_step(&imu, &sample, at_rest, &output);
    CHECK(gw_imu_invariant_holds(&imu));
    CHECK(output.trusted == (status == GW_STATUS_OK));
    if (!output.trusted) {
        CHECK((output.acceleration.ax_mps2 == GW_ZERO) && (output.acceleration.ay_mps2 == GW_ZERO));
        CHECK((output.acceleration.alpha_radps2 == GW_ZERO) && (output.zero_step.ax_mps2 == GW_ZERO));
        CHECK((output.zero_step.ay_mps2 == GW_ZERO) && (output.zero_step.alpha_radps2 == GW_ZERO));
    }
    return status;
}

/* One tick with the next counter. */
static gw_status_t tick(bool at_rest)
{
    sample.counter++;
    return step(at_rest);
}

static void ticks(uint32_t count, bool at_rest)
{
    for (uint32_t i = 0U; i < count; i++) {
        (void)tick(at_rest);
    }
}

/* Standing until it is trusted. */
static void tare(void)
{
    show(GW_ZERO, GW_ZERO, GW_ZERO, GW_ZERO);
    ticks(GW_IMU_RECOVER_TICKS + config.tare_ticks, true);
    CHECK(output.trusted);
}

static void bad_arguments_are_refused(void)
{
    start();
    CHECK_STATUS(gw_imu_init(NULL, &config, PERIOD), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_imu_init(&imu, NULL, PERIOD), GW_STATUS_NULL_POINTER);
    output.trusted = true;
    CHECK_STATUS(gw_imu_step(NULL, &sample, true, &output), GW_STATUS_NULL_POINTER);
    CHECK(!output.trusted);
    CHECK_STATUS(gw_imu_step(&imu, NULL, true, &output), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_imu_step(&imu, &sample, true, NULL), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_imu_init(&imu, &config, GW_ZERO), GW_STATUS_CONFIG_INVALID);
    CHECK_STATUS(gw_imu_step(&imu, &sample, true, &output), GW_STATUS_NOT_INITIALISED);
    CHECK(!output.trusted);
    config.gyro_scale = unit_nan();
    CHECK_STATUS(gw_imu_init(&imu, &config, PERIOD), GW_STATUS_CONFIG_INVALID);
    CHECK(!gw_imu_invariant_holds(&imu));
}

/* A ramp of the yaw rate: its low-pass gives alpha exactly and the rate as late as the accelerations. Squared before or
 * behind the low-pass, the rate differs by alpha^2 times twice the square of the time constant 1/w. */
static void the_acceleration_is_that_of_the_centre(void)
{
    start();
    tare();
    for (uint32_t i = 1U; i <= 400U; i++) {
        show(R(1.5), R(-0.7), R(0.002) * (gw_real_t)i, R(2.0));
        CHECK_STATUS(tick(false), GW_STATUS_OK);
    }
    CHECK_NEAR(output.acceleration.ax_mps2, R(1.5), R(0.0001));
    CHECK_NEAR(output.acceleration.ay_mps2, R(-0.7), R(0.0001));
    CHECK_NEAR(output.acceleration.alpha_radps2, R(2.0), R(1000.0) * ROUNDING); /* differences over the period */
    CHECK(imu.filter[2].value > R(0.5)); /* fast enough that the terms of omega count: 0.05 m/s^2 */
}

/* The critically damped step, 1 - (1 + w t) e^(-w t). */
static void the_result_passes_the_low_pass(void)
{
    start();
    tare();
    show(GW_ONE, GW_ZERO, GW_ZERO, GW_ZERO);
    CHECK_STATUS(tick(false), GW_STATUS_OK);
    CHECK_NEAR(output.acceleration.ax_mps2, GW_ONE - (R(1.8) * gw_exp(R(-0.8))), R(4.0) * ROUNDING);
}

static void it_is_trusted_when_the_bias_is_known(void)
{
    start();
    show(GW_ZERO, GW_ZERO, GW_ZERO, GW_ZERO);
    for (uint32_t i = 1U; i <= 30U; i++) {
        unit_row(i);
        CHECK_STATUS(tick(false), GW_STATUS_SENSOR_RECOVERING);
    }
    for (uint32_t i = 1U; i <= 8U; i++) {
        unit_row(i);
        CHECK_STATUS(tick(true), (i < 8U) ? GW_STATUS_SENSOR_RECOVERING : GW_STATUS_OK);
    }
    /* The first bias is no change of another. */
    CHECK((output.zero_step.ax_mps2 == GW_ZERO) && (output.zero_step.ay_mps2 == GW_ZERO));
    CHECK_NEAR(output.acceleration.ax_mps2, GW_ZERO, ROUNDING);
    start();
    for (uint32_t i = 1U; i <= GW_IMU_RECOVER_TICKS; i++) { /* a bias, but samples for too short a time */
        unit_row(i);
        CHECK_STATUS(tick(true), (i < GW_IMU_RECOVER_TICKS) ? GW_STATUS_SENSOR_RECOVERING : GW_STATUS_OK);
    }
}

/* The bias changes with the temperature: it is taken again in the next stop, not in this one, and the step is told. */
static void every_stop_has_a_bias_of_its_own(void)
{
    start();
    tare();
    sample.specific_force_mps2[0] += R(0.125);
    ticks(100U, true);
    const gw_real_t kept = output.acceleration.ax_mps2;
    CHECK(kept > R(0.05));
    (void)tick(false);
    for (uint32_t i = 1U; i <= 8U; i++) {
        unit_row(i);
        CHECK_STATUS(tick(true), GW_STATUS_OK);
        CHECK((i == 8U) || (output.zero_step.ax_mps2 == GW_ZERO));
    }
    CHECK_NEAR(output.acceleration.ax_mps2, GW_ZERO, ROUNDING);
    CHECK_NEAR(output.acceleration.ay_mps2, GW_ZERO, ROUNDING);
    CHECK_NEAR(output.zero_step.ax_mps2, R(-0.1) * gw_sincos(R(0.5)).cosine, R(4.0) * ROUNDING);
    CHECK_NEAR(output.zero_step.ay_mps2, R(-0.1) * gw_sincos(R(0.5)).sine, R(4.0) * ROUNDING);
    CHECK(output.zero_step.alpha_radps2 == GW_ZERO);
    (void)tick(true);
    CHECK(output.zero_step.ax_mps2 == GW_ZERO);
}

/* A start within the tare, a sample twice and a bad one: only a whole while of good new ones counts. */
static void a_tare_that_is_interrupted_starts_anew(void)
{
    start();
    show(GW_ZERO, GW_ZERO, GW_ZERO, GW_ZERO);
    ticks(25U, false);
    ticks(7U, true);
    (void)tick(false);
    ticks(7U, true);
    CHECK_STATUS(step(true), GW_STATUS_SENSOR_RECOVERING); /* the same sample again */
    sample.present = false;
    CHECK_STATUS(tick(true), GW_STATUS_SENSOR_MISSING);
    sample.present = true;
    ticks(7U, true);
    CHECK(!imu.zero_known);
    (void)tick(true);
    CHECK(imu.zero_known);
    CHECK_NEAR(imu.zero[0], bias[0], ROUNDING);
    CHECK_NEAR(imu.zero[1], bias[1], ROUNDING);
    CHECK_NEAR(imu.zero[2], bias[2], ROUNDING);
}

/* Whatever a signal's mean was. */
static void an_interrupted_tare_forgets_every_signal(void)
{
    start();
    show(R(0.3), R(-0.2), R(0.1), GW_ZERO);
    ticks(25U, false);
    for (uint32_t i = 0U; i < GW_IMU_SIGNALS; i++) {
        imu.mean[i] = unit_nan();
    }
    (void)tick(false);
    for (uint32_t i = 0U; i < GW_IMU_SIGNALS; i++) {
        unit_row(i);
        CHECK(imu.mean[i] == GW_ZERO);
    }
}

/* A step while the filters still recover from a bad sample is not told: the source changes then anyway. */
static void a_bias_that_comes_before_the_trust_tells_no_step(void)
{
    start();
    tare();
    (void)tick(false);
    sample.present = false;
    (void)tick(true);
    sample.present = true;
    sample.specific_force_mps2[0] += R(0.125);
    for (uint32_t i = 1U; i <= 8U; i++) {
        unit_row(i);
        CHECK_STATUS(tick(true), GW_STATUS_SENSOR_RECOVERING);
    }
    CHECK_NEAR(imu.zero[0], bias[0] + R(0.125), ROUNDING);
}

static void a_bad_sample_is_named_and_takes_time_to_recover_from(void)
{
    const struct {
        uint32_t member;
        gw_real_t value;
        gw_status_t status;
    } rows[] = {
        {0U, unit_nan(), GW_STATUS_SENSOR_NONFINITE}, {1U, -unit_infinity(), GW_STATUS_SENSOR_NONFINITE},
        {2U, unit_nan(), GW_STATUS_SENSOR_NONFINITE}, {0U, R(39.0), GW_STATUS_SENSOR_SATURATED},
        {1U, R(-39.0), GW_STATUS_SENSOR_SATURATED},   {2U, R(8.7), GW_STATUS_SENSOR_SATURATED},
        {2U, R(-8.7), GW_STATUS_SENSOR_SATURATED},    {0U, unit_below(R(39.0)), GW_STATUS_OK},
        {2U, unit_below(R(8.7)), GW_STATUS_OK},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        gw_real_t *const members[3] = {&sample.specific_force_mps2[0], &sample.specific_force_mps2[1],
                                       &sample.yaw_rate_radps};
        unit_row(i);
        start();
        tare();
        *members[rows[i].member] = rows[i].value;
        CHECK_STATUS(tick(false), rows[i].status);
        show(GW_ZERO, GW_ZERO, GW_ZERO, GW_ZERO);
        for (uint32_t k = 1U; (k < GW_IMU_RECOVER_TICKS) && (rows[i].status != GW_STATUS_OK); k++) {
            CHECK_STATUS(tick(false), GW_STATUS_SENSOR_RECOVERING);
        }
        CHECK_STATUS(tick(false), GW_STATUS_OK);
    }
}

/* Not finite tells more than saturated, and too old more than both. */
static void the_worst_fault_is_named(void)
{
    start();
    tare();
    sample.yaw_rate_radps = R(9.0);
    sample.specific_force_mps2[1] = unit_nan();
    CHECK_STATUS(tick(false), GW_STATUS_SENSOR_NONFINITE);
    sample.specific_force_mps2[0] = R(40.0);
    CHECK_STATUS(step(false), GW_STATUS_SENSOR_NONFINITE);
    CHECK_STATUS(step(false), GW_STATUS_SENSOR_NONFINITE);
    CHECK_STATUS(step(false), GW_STATUS_SENSOR_STALE);
}

/* The counter stands: the value is held for two ticks, the third is stale. It stays so, and the counter may wrap. */
static void a_counter_that_stands_is_stale(void)
{
    start();
    sample.counter = UINT32_MAX - (GW_IMU_RECOVER_TICKS + config.tare_ticks);
    tare();
    CHECK(sample.counter == UINT32_MAX);
    CHECK_STATUS(step(false), GW_STATUS_OK);
    CHECK_STATUS(step(false), GW_STATUS_OK);
    for (uint32_t i = 0U; i < 5U; i++) {
        CHECK_STATUS(step(false), GW_STATUS_SENSOR_STALE);
    }
    CHECK_STATUS(tick(false), GW_STATUS_SENSOR_RECOVERING);
    CHECK(sample.counter == 0U);
    ticks(GW_IMU_RECOVER_TICKS - 1U, false);
    CHECK(output.trusted);
}

static void without_one_there_is_no_sample(void)
{
    set_up();
    config.use = 0U;
    begin();
    for (uint32_t i = 0U; i < 50U; i++) {
        CHECK_STATUS(tick(true), GW_STATUS_SENSOR_MISSING);
    }
    start();
    sample.present = false;
    CHECK_STATUS(tick(true), GW_STATUS_SENSOR_MISSING);
}

static void the_noise_is_that_of_true_values(void)
{
    set_up();
    config.position_x_m = R(0.3);
    config.position_y_m = R(-0.4);
    begin();
    const gw_imu_noise_t noise = gw_imu_noise(&imu);
    CHECK_NEAR(noise.acceleration_mps2, R(0.014) / R(1.25), ROUNDING);
    CHECK_NEAR(noise.yaw_rate_radps, R(0.001) / R(0.8), ROUNDING);
    CHECK_NEAR(noise.arm_m, R(0.5), ROUNDING);
    CHECK(noise.vibration_mps2 == config.vibration_mps2);
    CHECK(noise.cutoff_radps == config.cutoff_radps);
}

/* A vibration of 60 Hz at the sensor, over a steady ramp: the low-pass at w leaves 1/(1 + (2 pi 60/w)^2) = 0.818 of its
 * amplitude, each high-pass of 4 ms 0.7336; half a square on each axis. Afterwards it is forgotten, but never less than
 * the sensor's own noise. */
static void vibration_is_followed(void)
{
    start();
    tare();
    const gw_real_t least = imu.shaking_mps2_2;
    CHECK_NEAR(least, R(0.2) * (R(0.0112) * R(0.0112)), least * R(10.0) * ROUNDING);
    CHECK(output.shaking_mps2_2 == least);
    for (uint32_t i = 0U; i < 2000U; i++) {
        const gw_rotation_t phase = gw_sincos(R(0.376991118430775) * (gw_real_t)i);
        show(R(0.005) * (gw_real_t)i, R(-0.003) * (gw_real_t)i, GW_ZERO, GW_ZERO);
        sample.specific_force_mps2[0] += R(0.25) * phase.sine;
        sample.specific_force_mps2[1] += R(0.25) * phase.cosine;
        CHECK_STATUS(tick(false), GW_STATUS_OK);
    }
    const gw_real_t amplitude = (R(0.25) / R(1.25)) * (R(0.818) * (R(0.7336) * R(0.7336)));
    /* A sampled low-pass leaves a little less than the formula. */
    CHECK_NEAR(output.shaking_mps2_2, R(0.5) * amplitude * amplitude, R(0.02) * amplitude * amplitude);
    show(GW_ZERO, GW_ZERO, GW_ZERO, GW_ZERO);
    ticks(9000U, false);
    CHECK(output.shaking_mps2_2 == least);
}

/* A hit of 3 m/s^2 within 10 ms adds less than the mean square of the vibration before. */
static void a_hit_is_no_vibration(void)
{
    start();
    tare();
    for (uint32_t i = 0U; i < 1000U; i++) {
        const gw_rotation_t phase = gw_sincos(R(0.376991118430775) * (gw_real_t)i);
        show(R(0.1) * phase.sine, R(0.1) * phase.cosine, GW_ZERO, GW_ZERO);
        (void)tick(false);
    }
    const gw_real_t before = output.shaking_mps2_2;
    for (uint32_t i = 0U; i < 10U; i++) {
        show(R(0.3) * (gw_real_t)i, GW_ZERO, GW_ZERO, GW_ZERO);
        (void)tick(false);
    }
    CHECK(output.shaking_mps2_2 < (GW_TWO * before));
}

/* As fast as the sensors show, as high a corner as there may be: the result keeps its bounds. */
static void the_largest_values_stay_within_bounds(void)
{
    set_up();
    config.cutoff_radps = R(10000.0);
    config.acceleration_limit_mps2 = R(10000.0);
    config.yaw_rate_limit_radps = R(1000.0);
    config.acceleration_scale = R(0.5);
    config.gyro_scale = R(0.5);
    config.tare_ticks = 100000U;
    begin();
    imu.zero_known = true;
    for (uint32_t i = 0U; i < 60U; i++) {
        const gw_real_t sign = ((i & 1U) == 0U) ? GW_ONE : -GW_ONE;
        sample.specific_force_mps2[0] = sign * R(9999.0);
        sample.specific_force_mps2[1] = -sign * R(9999.0);
        sample.yaw_rate_radps = sign * R(999.0);
        (void)tick(true);
        CHECK(gw_within(output.acceleration.ax_mps2, GW_IMU_ACCELERATION_MAX));
        CHECK(gw_within(output.acceleration.ay_mps2, GW_IMU_ACCELERATION_MAX));
        CHECK(gw_within(output.acceleration.alpha_radps2, GW_IMU_ACCELERATION_MAX));
    }
    CHECK(output.trusted);
}

static void the_invariant_sees_every_member(void)
{
    CHECK(!gw_imu_invariant_holds(NULL));
    start();
    imu.initialised = false;
    CHECK(!gw_imu_invariant_holds(&imu));
    start();
    imu.config.cutoff_radps = unit_nan();
    CHECK(!gw_imu_invariant_holds(&imu));
    start();
    imu.age_ticks = 4U;
    CHECK(!gw_imu_invariant_holds(&imu));
    start();
    imu.tare_count = 8U;
    CHECK(!gw_imu_invariant_holds(&imu));
    start();
    imu.good_ticks = GW_IMU_RECOVER_TICKS + 1U;
    CHECK(!gw_imu_invariant_holds(&imu));
    start();
    imu.zero[2] = unit_nan();
    CHECK(!gw_imu_invariant_holds(&imu));
    start();
    imu.mean[1] = unit_infinity();
    CHECK(!gw_imu_invariant_holds(&imu));
    start();
    imu.filter[0].value = unit_nan();
    CHECK(!gw_imu_invariant_holds(&imu));
    start();
    imu.filter[0].derivative = unit_nan();
    CHECK(!gw_imu_invariant_holds(&imu));
    start();
    imu.turning_radps2 = unit_nan();
    CHECK(!gw_imu_invariant_holds(&imu));
    start();
    imu.shaking_mps2_2 = GW_ZERO;
    CHECK(!gw_imu_invariant_holds(&imu));
    start();
    imu.smooth_mps2[1].x = unit_nan();
    CHECK(!gw_imu_invariant_holds(&imu));
    start();
    imu.smooth_mps2[0].y = unit_nan();
    CHECK(!gw_imu_invariant_holds(&imu));
}

void suite_imu(void)
{
    unit_run("bad_arguments_are_refused", bad_arguments_are_refused);
    unit_run("the_acceleration_is_that_of_the_centre", the_acceleration_is_that_of_the_centre);
    unit_run("the_result_passes_the_low_pass", the_result_passes_the_low_pass);
    unit_run("it_is_trusted_when_the_bias_is_known", it_is_trusted_when_the_bias_is_known);
    unit_run("every_stop_has_a_bias_of_its_own", every_stop_has_a_bias_of_its_own);
    unit_run("a_tare_that_is_interrupted_starts_anew", a_tare_that_is_interrupted_starts_anew);
    unit_run("an_interrupted_tare_forgets_every_signal", an_interrupted_tare_forgets_every_signal);
    unit_run("a_bias_that_comes_before_the_trust_tells_no_step", a_bias_that_comes_before_the_trust_tells_no_step);
    unit_run("a_bad_sample_is_named_and_takes_time_to_recover_from",
             a_bad_sample_is_named_and_takes_time_to_recover_from);
    unit_run("the_worst_fault_is_named", the_worst_fault_is_named);
    unit_run("a_counter_that_stands_is_stale", a_counter_that_stands_is_stale);
    unit_run("without_one_there_is_no_sample", without_one_there_is_no_sample);
    unit_run("the_noise_is_that_of_true_values", the_noise_is_that_of_true_values);
    unit_run("vibration_is_followed", vibration_is_followed);
    unit_run("a_hit_is_no_vibration", a_hit_is_no_vibration);
    unit_run("the_largest_values_stay_within_bounds", the_largest_values_stay_within_bounds);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
}
