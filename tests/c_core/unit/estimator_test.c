#include "../matrix_forms.h"
#include "unit.h"

#define PERIOD R(0.001)

static const gw_twist_t still = {R(0.0), R(0.0), R(0.0)};
static const gw_acceleration_t steady = {R(0.0), R(0.0), R(0.0)};

/* The paper's robot with numbers that are easy to follow. The struct is large, so there is one. */
static gw_controller_config_t robot;
static gw_estimator_t estimator;

static void set_robot(void)
{
    gw_controller_config_paper(&robot);
    robot.geometry.wheel_radius_m = R(0.1);
    robot.geometry.wheel_distance_m = R(0.25);
    robot.friction.coulomb_torque_nm = R(0.2);
    robot.friction.tanh_slope_s_per_rad = R(0.4);
    robot.estimator.drivetrain_stiffness_nm_per_rad = GW_ZERO;
    robot.estimator.encoder_counts = 8000U;
    robot.estimator.average_window = 4U;
    robot.estimator.rest_speed_mps = R(0.002);
    robot.estimator.creep_speed_mps = R(0.03);
    robot.estimator.rest_ticks = 10U;
    robot.estimator.tare_ticks = 4U;
    robot.estimator.retare_ticks = 4U;
    robot.estimator.tare_variation_nm = R(0.5);
}

static gw_status_t init(void)
{
    return gw_estimator_init(&estimator, &robot.estimator, &robot.geometry, &robot.base, &robot.friction, PERIOD);
}

static void start(void)
{
    set_robot();
    CHECK_STATUS(init(), GW_STATUS_OK);
    CHECK(gw_estimator_invariant_holds(&estimator));
}

static gw_estimator_input_t input_of(gw_wheels_t torque, gw_twist_t twist)
{
    static const gw_imu_output_t no_imu = {0};
    const gw_estimator_input_t input = {torque, {0, 0, 0}, twist, steady, no_imu};
    return input;
}

static gw_wheels_t torques(gw_real_t a, gw_real_t b, gw_real_t c)
{
    const gw_wheels_t made = {{a, b, c}};
    return made;
}

static gw_twist_t ahead(gw_real_t speed)
{
    const gw_twist_t twist = {speed, R(0.0), R(0.0)};
    return twist;
}

static gw_estimator_output_t step(const gw_estimator_input_t *input, gw_status_t status)
{
    gw_estimator_output_t output;
    CHECK_STATUS(gw_estimator_step(&estimator, input, &output), status);
    CHECK(gw_estimator_invariant_holds(&estimator));
    return output;
}

static void tare(gw_wheels_t torque)
{
    for (uint32_t i = 1U; i <= robot.estimator.tare_ticks; i++) {
        CHECK(gw_estimator_tare(&estimator, &torque) ==
              ((i == robot.estimator.tare_ticks) ? GW_TARE_DONE : GW_TARE_RUNNING));
        CHECK(gw_estimator_invariant_holds(&estimator));
    }
}

static void bad_arguments_are_refused(void)
{
    gw_estimator_output_t output;
    const gw_estimator_input_t input = input_of(torques(GW_ZERO, GW_ZERO, GW_ZERO), still);
    start();
    CHECK_STATUS(gw_estimator_init(NULL, &robot.estimator, &robot.geometry, &robot.base, &robot.friction, PERIOD),
                 GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_estimator_init(&estimator, NULL, &robot.geometry, &robot.base, &robot.friction, PERIOD),
                 GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_estimator_init(&estimator, &robot.estimator, NULL, &robot.base, &robot.friction, PERIOD),
                 GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_estimator_init(&estimator, &robot.estimator, &robot.geometry, NULL, &robot.friction, PERIOD),
                 GW_STATUS_NULL_POINTER);
    CHECK_STATUS(
        gw_estimator_init(&estimator, &robot.estimator, &robot.geometry, &robot.base, &robot.friction, GW_ZERO),
        GW_STATUS_CONFIG_INVALID);
    CHECK_STATUS(gw_estimator_step(&estimator, &input, &output), GW_STATUS_NOT_INITIALISED);
    set_robot();
    robot.estimator.average_window = 0U;
    CHECK_STATUS(init(), GW_STATUS_CONFIG_INVALID);
    CHECK(!gw_estimator_invariant_holds(&estimator));
}

/* Standing and tared: the difference from the zero is the push. Torques (0, 1, -1) below the zero, wheels of 0.1 m at
 * 0, 120 and 240 degrees: sqrt(3)/2 * 20 N along x. */
static void at_rest_the_change_of_the_torques_is_the_push(void)
{
    const gw_estimator_input_t quiet = input_of(torques(R(0.3), R(-0.2), R(0.1)), still);
    const gw_estimator_input_t pushed = input_of(torques(R(0.3), R(0.8), R(-0.9)), still);
    start();
    tare(quiet.torque_nm);
    gw_estimator_output_t output = step(&quiet, GW_STATUS_OK);
    CHECK(output.regime == GW_REGIME_REST);
    CHECK_NEAR(output.wrench.force_x_n, GW_ZERO, R(10.0) * ROUNDING);
    output = step(&pushed, GW_STATUS_OK);
    CHECK_NEAR(output.wrench.force_x_n, R(17.3205080756887729), R(20.0) * ROUNDING);
    CHECK_NEAR(output.wrench.force_y_n, GW_ZERO, R(20.0) * ROUNDING);
    CHECK_NEAR(output.wrench.torque_nm, GW_ZERO, R(5.0) * ROUNDING);
    CHECK_NEAR(output.mean.force_x_n, R(8.66025403784438647), R(20.0) * ROUNDING);
    CHECK_NEAR(output.window_mean.force_x_n, R(4.33012701892219323), R(20.0) * ROUNDING);
    CHECK(output.mean_samples == 2U);
    CHECK(!output.zero_changed);
}

/* Rest, motion, slow motion, standing, rest again with the zero of this stop. */
static void the_regime_follows_the_planned_speed(void)
{
    const gw_wheels_t zero = torques(R(0.1), R(0.1), R(0.1));
    const gw_estimator_input_t resting = input_of(zero, still);
    const gw_estimator_input_t moving = input_of(zero, ahead(R(0.2)));
    const gw_estimator_input_t creeping = input_of(zero, ahead(R(0.02)));
    const gw_twist_t spin = {R(0.0), R(0.0), R(-0.2)}; /* 0.05 m/s at the wheels */
    const gw_estimator_input_t turning = input_of(zero, spin);
    gw_estimator_output_t output;
    start();
    tare(zero);
    CHECK(step(&resting, GW_STATUS_OK).regime == GW_REGIME_REST);
    output = step(&moving, GW_STATUS_OK);
    CHECK((output.regime == GW_REGIME_MOTION) && output.zero_changed && (output.mean_samples == 1U));
    output = step(&turning, GW_STATUS_OK);
    CHECK((output.regime == GW_REGIME_MOTION) && (!output.zero_changed));
    CHECK(step(&creeping, GW_STATUS_OK).regime == GW_REGIME_CREEPING);
    for (uint32_t i = 1U; i <= 12U; i++) {
        output = step(&resting, GW_STATUS_OK);
        unit_row(i);
        CHECK(output.regime == ((i < 10U) ? GW_REGIME_CREEPING : GW_REGIME_REST));
        CHECK(output.zero_changed == (i == 10U));
    }
}

/* A robot that comes to rest leaning against something includes this force in its zero: only changes are pushes. */
static void a_stop_has_a_zero_of_its_own(void)
{
    const gw_wheels_t zero = torques(R(0.0), R(0.0), R(0.0));
    const gw_wheels_t leaning = torques(R(0.2), R(-0.1), R(0.05));
    const gw_estimator_input_t moving = input_of(zero, ahead(R(0.2)));
    const gw_estimator_input_t resting = input_of(leaning, still);
    gw_estimator_output_t output;
    start();
    tare(zero);
    (void)step(&moving, GW_STATUS_OK);
    for (uint32_t i = 0U; i < 20U; i++) {
        output = step(&resting, GW_STATUS_OK);
    }
    CHECK(output.regime == GW_REGIME_REST);
    CHECK_NEAR(output.wrench.force_x_n, GW_ZERO, R(10.0) * ROUNDING);
    CHECK_NEAR(output.nominal_nm.wheel[0], R(0.2), ROUNDING);
}

/* Torques that vary keep the tare after a stop from ending, for as long as they do. */
static void a_stop_that_is_not_quiet_waits(void)
{
    const gw_wheels_t zero = torques(R(0.0), R(0.0), R(0.0));
    const gw_estimator_input_t moving = input_of(zero, ahead(R(0.2)));
    start();
    tare(zero);
    (void)step(&moving, GW_STATUS_OK);
    for (uint32_t i = 0U; i < 100U; i++) {
        const gw_real_t torque = ((i & 1U) == 0U) ? R(1.0) : R(-1.0);
        const gw_estimator_input_t shaking = input_of(torques(torque, GW_ZERO, GW_ZERO), still);
        CHECK(step(&shaking, GW_STATUS_OK).regime == GW_REGIME_CREEPING);
    }
}

/* 24.8 days of standing: the count of ticks stays where it is. */
static void standing_long_does_not_wrap(void)
{
    const gw_estimator_input_t resting = input_of(torques(GW_ZERO, GW_ZERO, GW_ZERO), still);
    start();
    estimator.slow_ticks = GW_TICK_MASK;
    CHECK(step(&resting, GW_STATUS_OK).regime == GW_REGIME_REST);
    CHECK(estimator.slow_ticks == GW_TICK_MASK);
}

static void a_tare_of_no_ticks_takes_the_sensors_at_their_word(void)
{
    const gw_wheels_t torque = torques(R(0.5), R(0.5), R(0.5));
    start();
    robot.estimator.tare_ticks = 0U;
    CHECK_STATUS(init(), GW_STATUS_OK);
    CHECK(gw_estimator_tare(&estimator, &torque) == GW_TARE_DONE);
    CHECK(estimator.run_zero_nm.wheel[0] == GW_ZERO);
    CHECK(gw_estimator_invariant_holds(&estimator));
}

static void a_tare_of_one_tick_takes_that_tick(void)
{
    start();
    robot.estimator.tare_ticks = 1U;
    CHECK_STATUS(init(), GW_STATUS_OK);
    tare(torques(R(0.5), R(-0.25), R(0.125)));
    CHECK((estimator.run_zero_nm.wheel[0] == R(0.5)) && (estimator.run_zero_nm.wheel[1] == R(-0.25)));
    CHECK((estimator.run_zero_nm.wheel[2] == R(0.125)) && (estimator.rest_zero_nm.wheel[2] == R(0.125)));
}

static void a_new_tare_starts_from_nothing(void)
{
    const gw_wheels_t one = torques(R(1.0), R(1.0), R(1.0));
    const gw_wheels_t two = torques(R(1.2), R(1.2), R(1.2));
    start();
    CHECK(gw_estimator_tare(&estimator, &one) == GW_TARE_RUNNING);
    gw_estimator_start_tare(&estimator);
    tare(two);
    CHECK_NEAR(estimator.run_zero_nm.wheel[2], R(1.2), ROUNDING);
}

/* (38) with each source of motion. Counts that move as 0.2 m/s along x, plan that says 0.1 m/s and 0.5 m/s^2. */
static void the_motion_comes_from_the_source_that_is_chosen(void)
{
    const struct {
        uint32_t velocity;
        uint32_t acceleration;
        gw_real_t friction_speed;
        gw_real_t acceleration_mps2;
    } rows[] = {
        {GW_SOURCE_PLANNED, GW_SOURCE_PLANNED, R(0.1), R(0.5)},
        {GW_SOURCE_PLANNED, GW_SOURCE_ZERO, R(0.1), R(0.0)},
        {GW_SOURCE_MEASURED, GW_SOURCE_ZERO, R(0.2), R(0.0)},
        {GW_SOURCE_PLANNED, GW_SOURCE_MEASURED, R(0.1), R(0.0)},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        const gw_acceleration_t planned = {R(0.5), R(0.0), R(0.0)};
        gw_kinematics_t kinematics;
        gw_nominal_t nominal;
        gw_estimator_input_t input = input_of(torques(GW_ZERO, GW_ZERO, GW_ZERO), ahead(R(0.1)));
        gw_estimator_output_t output;
        gw_real_t counts[3] = {GW_ZERO, GW_ZERO, GW_ZERO};
        set_robot();
        robot.estimator.velocity_source = rows[i].velocity;
        robot.estimator.acceleration_source = rows[i].acceleration;
        robot.estimator.encoder_counts = 1000000U;
        robot.estimator.rate_cutoff_radps = R(50.0);
        unit_row(i);
        CHECK_STATUS(init(), GW_STATUS_OK);
        CHECK_STATUS(gw_kinematics_init(&kinematics, &robot.geometry), GW_STATUS_OK);
        CHECK_STATUS(gw_nominal_init(&nominal, &robot.base, &robot.friction, &kinematics), GW_STATUS_OK);
        const gw_wheels_t rates = gw_kinematics_wheel_rates(&kinematics, ahead(R(0.2)));
        input.planned_acceleration = planned;
        for (uint32_t tick = 0U; tick < 600U; tick++) {
            for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
                counts[k] += rates.wheel[k] * PERIOD * R(159154.943091895336); /* 1e6/2 pi */
                input.encoder_count[k] = (int32_t)counts[k];
            }
            output = step(&input, GW_STATUS_OK);
        }
        const gw_acceleration_t used = {rows[i].acceleration_mps2, R(0.0), R(0.0)};
        const gw_wheels_t expected = nominal_torques(&nominal, &kinematics, ahead(rows[i].friction_speed), used);
        /* Rates jitter by a count per tick, 0.6 mm/s, of which the filter's derivative passes (50 rad/s)^2 * 1 ms:
         * 1.6 mm/s^2, 4 mN m. */
        CHECK_NEAR(output.measured_twist.vx_mps, R(0.2), R(0.0006));
        for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
            CHECK_NEAR(output.nominal_nm.wheel[k], expected.wheel[k], R(0.01));
        }
    }
}

/* With bristles, a tare with deflected rollers leaves their force to the model, so a push that began before the stop is
 * still seen after it. */
static void with_bristles_a_tare_leaves_the_rollers_part_to_the_model(void)
{
    const gw_wheels_t zero = torques(R(0.0), R(0.0), R(0.0));
    gw_estimator_input_t input = input_of(zero, still);
    gw_estimator_output_t output;
    set_robot();
    robot.estimator.friction_model = GW_FRICTION_BRISTLE;
    robot.estimator.encoder_counts = 1000000U;
    CHECK_STATUS(init(), GW_STATUS_OK);
    tare(zero);
    (void)step(&input, GW_STATUS_OK);
    /* 10 um along x deflect roller 0, with its stiffness; the sensors show nothing. */
    input.encoder_count[1] = -14;
    input.encoder_count[2] = 14;
    for (uint32_t i = 0U; i < 200U; i++) {
        output = step(&input, GW_STATUS_OK);
    }
    const gw_real_t held = output.wrench.force_x_n;
    CHECK(held > GW_ZERO); /* the force that the rollers hold is an opposite push */
    gw_estimator_start_tare(&estimator);
    tare(zero);
    CHECK_NEAR(step(&input, GW_STATUS_OK).wrench.force_x_n, GW_ZERO, R(0.001) * held);
    CHECK(estimator.run_zero_nm.wheel[1] != GW_ZERO);
}

/* A robot without friction whose wheels deliver a sudden force of 20 N along x: it accelerates, nothing touches it. */
static gw_real_t largest_false_force(uint32_t is_aligned)
{
    gw_estimator_input_t input = input_of(torques(GW_ZERO, GW_ZERO, GW_ZERO), still);
    gw_real_t largest = GW_ZERO;
    gw_real_t speed = GW_ZERO;
    gw_real_t counts[GW_WHEEL_COUNT] = {GW_ZERO, GW_ZERO, GW_ZERO};
    set_robot();
    robot.friction.coulomb_torque_nm = GW_ZERO;
    robot.estimator.acceleration_source = GW_SOURCE_MEASURED;
    robot.estimator.aligned = is_aligned;
    robot.estimator.encoder_counts = 1000000U;
    CHECK_STATUS(init(), GW_STATUS_OK);
    const gw_real_t acceleration = R(20.0) / estimator.nominal.total_mass_kg;
    for (uint32_t tick = 0U; tick < 200U; tick++) {
        if (tick > 20U) {
            input.torque_nm = torques(GW_ZERO, R(-1.15470053837925153), R(1.15470053837925153));
            speed += R(0.5) * acceleration * PERIOD; /* the mean over the tick */
            const gw_wheels_t rates = gw_kinematics_wheel_rates(&estimator.kinematics, ahead(speed));
            speed += R(0.5) * acceleration * PERIOD;
            for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
                counts[k] += rates.wheel[k] * PERIOD * R(159154.943091895336); /* 1e6/2 pi */
                input.encoder_count[k] = (int32_t)counts[k];
            }
        }
        const gw_estimator_output_t output = step(&input, GW_STATUS_OK);
        largest = gw_max(largest, gw_abs(output.wrench.force_x_n));
    }
    return largest;
}

/* Nearly all of the 20 N seem to be a push in the first ticks, unless torque and acceleration pass the same filter.
 * What is left then is the jitter of the encoders: a count is 0.63 um of the floor, so 0.63 mm/s for a tick, of which
 * the filter's derivative shows (200 rad/s)^2 * 1 ms, times some 36 kg is 0.9 N. */
static void aligned_terms_of_the_balance_cancel(void)
{
    CHECK(largest_false_force(0U) > R(18.0));
    CHECK_NEAR(largest_false_force(1U), GW_ZERO, R(0.9));
}

/* Aligned, a step of the friction reaches the balance as that of 1 - (1 + w t) e^(-w t), at w t = 1. */
static void aligned_friction_comes_with_the_acceleration(void)
{
    for (uint32_t is_aligned = 0U; is_aligned < 2U; is_aligned++) {
        gw_estimator_input_t input = input_of(torques(GW_ZERO, GW_ZERO, GW_ZERO), still);
        gw_estimator_output_t output;
        set_robot();
        robot.estimator.acceleration_source = GW_SOURCE_MEASURED;
        robot.estimator.aligned = is_aligned;
        CHECK_STATUS(init(), GW_STATUS_OK);
        unit_row(is_aligned);
        output = step(&input, GW_STATUS_OK);
        CHECK((output.forces.friction_n.wheel[0] == GW_ZERO) && (output.wrench.force_x_n == GW_ZERO));
        input.planned_twist = ahead(R(-0.1));
        for (uint32_t i = 0U; i < 5U; i++) {
            output = step(&input, GW_STATUS_OK);
        }
        const gw_real_t share = (is_aligned == 1U) ? R(0.26424111765711536) : GW_ONE;
        const gw_wheels_t rates = gw_kinematics_roller_rates(&estimator.kinematics, input.planned_twist);
        const gw_wheels_t friction = gw_friction_torques(&robot.friction, &rates);
        for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
            CHECK_NEAR(output.forces.friction_n.wheel[k], (share * friction.wheel[k]) / robot.geometry.roller_radius_m,
                       R(100.0) * ROUNDING);
        }
        /* The encoders stand, so friction is all there is. */
        const gw_vector_t sum = gw_kinematics_radial_sum(&estimator.kinematics, &output.forces.friction_n);
        CHECK(gw_abs(sum.x) > R(5.0));
        CHECK_NEAR(output.wrench.force_x_n, sum.x, R(100.0) * ROUNDING);
    }
}

/* Aligned filters begin with what they see first, also after a gap. */
static void aligned_filters_start_afresh_after_a_gap(void)
{
    const gw_estimator_input_t first = input_of(torques(R(1.0), R(2.0), R(-3.0)), ahead(R(0.1)));
    const gw_estimator_input_t second = input_of(torques(R(-1.0), R(5.0), R(7.0)), ahead(R(-0.2)));
    gw_estimator_input_t bad = first;
    bad.torque_nm.wheel[0] = unit_nan();
    set_robot();
    robot.estimator.acceleration_source = GW_SOURCE_MEASURED;
    robot.estimator.aligned = 1U;
    CHECK_STATUS(init(), GW_STATUS_OK);
    (void)step(&first, GW_STATUS_OK);
    const gw_wrench_t delayed = step(&second, GW_STATUS_OK).wrench;
    (void)step(&bad, GW_STATUS_INPUT_INVALID);
    const gw_wrench_t afresh = step(&second, GW_STATUS_OK).wrench;
    CHECK_STATUS(init(), GW_STATUS_OK);
    const gw_wrench_t begun = step(&second, GW_STATUS_OK).wrench;
    CHECK((afresh.force_x_n == begun.force_x_n) && (afresh.force_y_n == begun.force_y_n));
    CHECK(afresh.torque_nm == begun.torque_nm);
    CHECK(gw_abs(delayed.force_y_n - begun.force_y_n) > R(10.0));
}

static void check_wrench(gw_wrench_t actual, gw_wrench_t expected)
{
    CHECK_NEAR(actual.force_x_n, expected.force_x_n, R(10.0) * ROUNDING);
    CHECK_NEAR(actual.force_y_n, expected.force_y_n, R(10.0) * ROUNDING);
    CHECK_NEAR(actual.torque_nm, expected.torque_nm, R(10.0) * ROUNDING);
}

/* Coming to rest and leaving it another zero holds: the wrench jumps by exactly what the estimator says. */
static void the_step_of_the_zero_is_told(void)
{
    const gw_wheels_t leaning = torques(R(0.3), R(-0.1), R(0.05));
    const gw_estimator_input_t moving = input_of(torques(GW_ZERO, GW_ZERO, GW_ZERO), ahead(R(0.2)));
    const gw_estimator_input_t resting = input_of(leaning, still);
    const gw_estimator_input_t leaving = input_of(leaning, ahead(R(0.01)));
    const gw_wrench_t none = {GW_ZERO, GW_ZERO, GW_ZERO};
    const gw_real_t root_3 = R(1.73205080756887729);
    gw_estimator_output_t output;
    gw_wrench_t before;
    start();
    robot.friction.coulomb_torque_nm = GW_ZERO;
    CHECK_STATUS(init(), GW_STATUS_OK);
    tare(moving.torque_nm);
    CHECK(gw_kinematics_wrench_of_torques(&estimator.kinematics, &leaning).torque_nm > R(0.6));
    output = step(&moving, GW_STATUS_OK);
    check_wrench(output.zero_step, none);
    for (uint32_t i = 1U; i <= 12U; i++) {
        before = output.wrench;
        output = step(&resting, GW_STATUS_OK);
        unit_row(i);
        if (i == 10U) {
            /* Wheels at 0, 120 and 240 degrees, 1/r_w = 10: forces along (0, 1), (-sqrt 3, -1)/2, (sqrt 3, -1)/2. */
            const gw_wrench_t expected = {R(5.0) * root_3 * R(0.15), R(3.0) + R(0.25), R(0.25) * R(2.5)};
            CHECK(output.zero_changed);
            check_wrench(output.zero_step, expected);
            check_wrench(output.wrench, none);
            CHECK_NEAR(output.wrench.force_y_n - before.force_y_n, output.zero_step.force_y_n, R(10.0) * ROUNDING);
        } else {
            CHECK(!output.zero_changed);
        }
    }
    before = output.wrench;
    output = step(&leaving, GW_STATUS_OK);
    CHECK(output.zero_changed);
    CHECK_NEAR(output.zero_step.force_x_n, output.wrench.force_x_n - before.force_x_n, R(10.0) * ROUNDING);
    CHECK_NEAR(output.zero_step.force_y_n, R(-3.25), R(10.0) * ROUNDING);
    CHECK_NEAR(output.zero_step.torque_nm, R(-0.625), R(10.0) * ROUNDING);
}

/* The forces in the balance are those of the model. */
static void the_forces_of_the_model_are_told(void)
{
    gw_estimator_input_t input = input_of(torques(GW_ZERO, GW_ZERO, GW_ZERO), ahead(R(0.2)));
    const gw_acceleration_t planned = {R(0.5), R(-0.25), R(2.0)};
    start();
    input.planned_acceleration = planned;
    const gw_estimator_output_t output = step(&input, GW_STATUS_OK);
    const gw_wheels_t rates = gw_kinematics_roller_rates(&estimator.kinematics, ahead(R(0.2)));
    const gw_wheels_t friction = gw_friction_torques(&robot.friction, &rates);
    for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
        unit_row(k);
        CHECK_NEAR(output.forces.friction_n.wheel[k], friction.wheel[k] / robot.geometry.roller_radius_m,
                   R(100.0) * ROUNDING);
    }
    CHECK(gw_abs(output.forces.friction_n.wheel[0]) > R(1.0));
    CHECK_NEAR(output.forces.inertia_n.x, R(0.5) * estimator.nominal.total_mass_kg, R(100.0) * ROUNDING);
    CHECK_NEAR(output.forces.inertia_n.y, R(-0.25) * estimator.nominal.total_mass_kg, R(100.0) * ROUNDING);
    CHECK_NEAR(output.forces.inertia_moment_nm, GW_TWO * estimator.nominal.total_yaw_inertia_kgm2, R(100.0) * ROUNDING);
}

/* T|0 of a wheel that turns has the friction of its gear. */
static void the_friction_of_gears_is_in_the_model(void)
{
    gw_wheels_t nominal_nm[2];
    gw_wheels_t rates;
    for (uint32_t i = 0U; i < 2U; i++) {
        gw_estimator_input_t input = input_of(torques(GW_ZERO, GW_ZERO, GW_ZERO), still);
        set_robot();
        robot.estimator.gear.coulomb_torque_nm = (i == 0U) ? GW_ZERO : R(0.4);
        robot.estimator.gear.tanh_slope_s_per_rad = R(10.0);
        CHECK_STATUS(init(), GW_STATUS_OK);
        (void)step(&input, GW_STATUS_OK);
        input.encoder_count[0] = 40;
        input.encoder_count[2] = -4;
        nominal_nm[i] = step(&input, GW_STATUS_OK).nominal_nm;
        for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
            rates.wheel[k] = estimator.rate[k].rate_radps;
        }
    }
    CHECK((rates.wheel[0] > R(0.5)) && (rates.wheel[1] == GW_ZERO) && (rates.wheel[2] < R(-0.05)));
    for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
        unit_row(k);
        CHECK_NEAR(nominal_nm[1].wheel[k] - nominal_nm[0].wheel[k], R(0.4) * gw_tanh(R(10.0) * rates.wheel[k]),
                   ROUNDING);
    }
}

static void the_doubt_of_gears_is_told(void)
{
    gw_estimator_input_t input = input_of(torques(GW_ZERO, GW_ZERO, GW_ZERO), ahead(R(0.1)));
    set_robot();
    robot.estimator.gear.viscous_nms_per_rad = R(0.5);
    robot.estimator.gear.uncertainty = R(0.5);
    CHECK_STATUS(init(), GW_STATUS_OK);
    (void)step(&input, GW_STATUS_OK);
    input.encoder_count[1] = 40;
    const gw_estimator_output_t moving = step(&input, GW_STATUS_OK);
    const gw_wheels_t rates = {
        {estimator.rate[0].rate_radps, estimator.rate[1].rate_radps, estimator.rate[2].rate_radps}};
    gw_real_t doubt_nm2 = GW_ZERO;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        doubt_nm2 += R(0.0625) * (rates.wheel[i] * rates.wheel[i]);
    }
    CHECK(doubt_nm2 > R(0.001));
    CHECK_NEAR(moving.gear_n2, R(50.0) * doubt_nm2, R(100.0) * ROUNDING); /* half of it over (0.1 m)^2 */
    const gw_wheels_t zero = {{GW_ZERO, GW_ZERO, GW_ZERO}};
    tare(zero); /* at rest */
    input.planned_twist = still;
    (void)step(&input, GW_STATUS_OK);
    input.encoder_count[1] = 80;
    CHECK(step(&input, GW_STATUS_OK).gear_n2 == GW_ZERO);
}

/* Any encoder, but none before the first sample or after a gap: then there is nothing to compare with. */
static void it_is_told_that_a_wheel_turned(void)
{
    gw_estimator_input_t input = input_of(torques(GW_ZERO, GW_ZERO, GW_ZERO), still);
    start();
    input.encoder_count[1] = 5;
    CHECK(!step(&input, GW_STATUS_OK).turned);
    CHECK(!step(&input, GW_STATUS_OK).turned);
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        unit_row(i);
        input.encoder_count[i] += 1 - (2 * (int32_t)(i & 1U));
        CHECK(step(&input, GW_STATUS_OK).turned);
        CHECK(!step(&input, GW_STATUS_OK).turned);
    }
    gw_estimator_restart(&estimator);
    input.encoder_count[2] = 77;
    CHECK(!step(&input, GW_STATUS_OK).turned);
}

static void what_is_beyond_any_robot_is_refused(void)
{
    const gw_estimator_input_t good = input_of(torques(GW_ZERO, GW_ZERO, GW_ZERO), still);
    for (uint32_t i = 0U; i < 9U; i++) {
        gw_estimator_input_t bad = good;
        gw_real_t *const members[9] = {&bad.planned_twist.vx_mps,
                                       &bad.planned_twist.vy_mps,
                                       &bad.planned_twist.omega_radps,
                                       &bad.planned_acceleration.ax_mps2,
                                       &bad.planned_acceleration.ay_mps2,
                                       &bad.planned_acceleration.alpha_radps2,
                                       &bad.torque_nm.wheel[0],
                                       &bad.torque_nm.wheel[1],
                                       &bad.torque_nm.wheel[2]};
        const gw_real_t values[3] = {unit_nan(), unit_infinity(), R(-1e9)};
        for (uint32_t k = 0U; k < 3U; k++) {
            start();
            (void)step(&good, GW_STATUS_OK);
            *members[i] = values[k];
            unit_row((10U * i) + k);
            CHECK(step(&bad, GW_STATUS_INPUT_INVALID).wrench.force_x_n == GW_ZERO);
            CHECK(gw_moving_average_count(&estimator.average) == 0U);
        }
    }
}

/* A measured motion that is impossible for a wheel gives an impossible wrench: it is refused, and not kept. */
static void a_wrench_beyond_any_push_is_refused(void)
{
    gw_estimator_input_t input = input_of(torques(GW_ZERO, GW_ZERO, GW_ZERO), still);
    start();
    robot.estimator.acceleration_source = GW_SOURCE_MEASURED;
    robot.estimator.rate_cutoff_radps = R(10000.0);
    robot.estimator.encoder_counts = 4U;
    robot.base.mass_kg = R(2000.0);
    CHECK_STATUS(init(), GW_STATUS_OK);
    (void)step(&input, GW_STATUS_OK);
    input.encoder_count[0] = INT32_MAX;
    gw_estimator_output_t output;
    gw_status_t status = gw_estimator_step(&estimator, &input, &output);
    CHECK_STATUS(status, GW_STATUS_INPUT_INVALID);
    CHECK((output.wrench.force_x_n == GW_ZERO) && (output.mean_samples == 0U));
    CHECK(gw_estimator_invariant_holds(&estimator));
    CHECK(step(&input, GW_STATUS_OK).mean_samples == 1U);
}

static void angles_of_counts_are_within_a_turn(void)
{
    const struct {
        int32_t count;
        gw_real_t angle;
    } rows[] = {
        {0, R(0.0)},
        {2000, R(1.57079632679489662)},
        {-2000, R(-1.57079632679489662)},
        {10000, R(1.57079632679489662)},
        {INT32_MIN, R(-2.8651325000738912)}, /* -2^31 is -3648 counts and whole turns */
    };
    start();
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        unit_row(i);
        CHECK_NEAR(gw_estimator_encoder_angle(&estimator, rows[i].count), rows[i].angle, R(4.0) * ULP);
    }
}

static void the_invariant_sees_every_member(void)
{
    CHECK(!gw_estimator_invariant_holds(NULL));
    start();
    estimator.initialised = false;
    CHECK(!gw_estimator_invariant_holds(&estimator));
    start();
    estimator.config.rest_speed_mps = unit_nan();
    CHECK(!gw_estimator_invariant_holds(&estimator));
    start();
    estimator.kinematics.wheel_radius_m = GW_ZERO;
    CHECK(!gw_estimator_invariant_holds(&estimator));
    start();
    estimator.nominal.total_mass_kg = unit_nan();
    CHECK(!gw_estimator_invariant_holds(&estimator));
    start();
    estimator.run_tare.sum_nm[0].value = unit_nan();
    CHECK(!gw_estimator_invariant_holds(&estimator));
    start();
    estimator.stop_tare.sum_nm[0].value = unit_nan();
    CHECK(!gw_estimator_invariant_holds(&estimator));
    start();
    estimator.presliding.bearable_n = GW_ZERO;
    CHECK(!gw_estimator_invariant_holds(&estimator));
    start();
    estimator.average.index = 4U;
    CHECK(!gw_estimator_invariant_holds(&estimator));
    start();
    estimator.average.window = 5U;
    CHECK(!gw_estimator_invariant_holds(&estimator));
    start();
    estimator.rate[2].rate_radps = unit_nan();
    CHECK(!gw_estimator_invariant_holds(&estimator));
    start();
    estimator.aligned_torque[1].value = unit_above(GW_TORQUE_MAX);
    CHECK(!gw_estimator_invariant_holds(&estimator));
    start();
    estimator.aligned_friction[2].derivative = unit_nan();
    CHECK(!gw_estimator_invariant_holds(&estimator));
    start();
    estimator.motor.period_s = GW_ZERO;
    CHECK(!gw_estimator_invariant_holds(&estimator));
    start();
    estimator.run_zero_nm.wheel[1] = unit_nan();
    CHECK(!gw_estimator_invariant_holds(&estimator));
    start();
    estimator.rest_zero_nm.wheel[0] = unit_infinity();
    CHECK(!gw_estimator_invariant_holds(&estimator));
}

/* A rest speed of zero is in range: a plan that stands still is slow enough. */
static void standing_still_is_rest_at_any_rest_speed(void)
{
    const gw_estimator_input_t resting = input_of(torques(R(0.0), R(0.0), R(0.0)), still);
    set_robot();
    robot.estimator.rest_speed_mps = GW_ZERO;
    CHECK_STATUS(init(), GW_STATUS_OK);
    CHECK(step(&resting, GW_STATUS_OK).regime == GW_REGIME_REST);
}

/* Rates are those of filters that are fed with the counts and the torque that twists the drivetrain: the sensed one,
 * less what an observed motor is beyond its count. Without one the bits are those of the sensed torque, whatever is
 * told.
 */
static void observed_motors_twist_the_drivetrains(void)
{
    for (uint32_t i = 0U; i < 2U; i++) {
        static gw_motor_t motor;
        gw_rate_filter_t filter[GW_WHEEL_COUNT];
        bool differs = false;
        set_robot();
        robot.estimator.drivetrain_stiffness_nm_per_rad = R(500.0);
        gw_motor_config_trikey(&robot.estimator.motor);
        robot.estimator.motor.coulomb_torque_nm = GW_ZERO;
        if (i == 0U) {
            robot.estimator.motor.inertia_kgm2 = GW_ZERO;
        }
        CHECK_STATUS(init(), GW_STATUS_OK);
        gw_motor_init(&motor, &robot.estimator.motor, &estimator.rate_constants, 8000U);
        for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
            gw_rate_filter_restart(&filter[k]);
        }
        gw_estimator_input_t input = input_of(torques(GW_ZERO, GW_ZERO, GW_ZERO), still);
        for (uint32_t tick = 0U; tick < 200U; tick++) {
            const gw_real_t angle_rad = R(0.002) * (gw_real_t)tick;
            const gw_joint_command_t command = {{angle_rad, -angle_rad, GW_ZERO}, {R(2.0), R(-2.0), GW_ZERO}};
            gw_real_t counted;
            input.torque_nm.wheel[0] = ((tick % 5U) == 0U) ? R(0.1) : R(-0.1);
            input.encoder_count[0] = (int32_t)((tick * 51U) / 20U); /* 2.55 counts of 1/8000 turn in a tick */
            input.encoder_count[1] = -input.encoder_count[0];
            const gw_estimator_output_t output = step(&input, GW_STATUS_OK);
            const gw_wheels_t twist = gw_motor_step(&motor, input.encoder_count, &input.torque_nm, &counted);
            unit_row((1000U * i) + tick);
            CHECK(output.counted == counted);
            for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
                gw_rate_filter_step(&filter[k], &estimator.rate_constants, input.encoder_count[k], twist.wheel[k]);
                CHECK(estimator.rate[k].rate_radps == filter[k].rate_radps);
                CHECK((i == 1U) || (twist.wheel[k] == input.torque_nm.wheel[k]));
                differs = differs || (twist.wheel[k] != input.torque_nm.wheel[k]);
            }
            gw_estimator_tell_command(&estimator, &command, true);
            CHECK(gw_estimator_invariant_holds(&estimator));
            gw_motor_command(&motor, &command, true);
        }
        CHECK(differs == (i == 1U));
        CHECK(estimator.motor.wheel[0].share == motor.wheel[0].share);
        /* Drives that are not enabled, and a gap. */
        const gw_joint_command_t command = {{GW_ZERO, GW_ZERO, GW_ZERO}, {GW_ZERO, GW_ZERO, GW_ZERO}};
        gw_estimator_restart(&estimator);
        CHECK((!estimator.motor.started) && (estimator.motor.commands == GW_MOTOR_DELAY_MAX));
        gw_estimator_tell_command(&estimator, &command, false);
        CHECK(estimator.motor.commands == 0U);
    }
}

/* The rollers' deflection is followed with the same twist. */
static void bristles_are_deflected_by_the_same_twist(void)
{
    set_robot();
    robot.estimator.drivetrain_stiffness_nm_per_rad = R(500.0);
    robot.estimator.friction_model = GW_FRICTION_BRISTLE;
    robot.estimator.velocity_source = GW_SOURCE_MEASURED;
    gw_motor_config_trikey(&robot.estimator.motor);
    CHECK_STATUS(init(), GW_STATUS_OK);
    gw_estimator_input_t input = input_of(torques(R(0.5), GW_ZERO, GW_ZERO), ahead(R(0.1)));
    const gw_joint_command_t command = {{GW_ZERO, GW_ZERO, GW_ZERO}, {GW_ZERO, GW_ZERO, GW_ZERO}};
    gw_estimator_tell_command(&estimator, &command, true);
    gw_estimator_tell_command(&estimator, &command, true);
    gw_estimator_tell_command(&estimator, &command, true);
    (void)step(&input, GW_STATUS_OK);
    estimator.motor.wheel[0].share = GW_ONE;
    estimator.motor.wheel[0].angle_rad = R(0.0003);
    estimator.motor.wheel[0].rate_radps = R(0.9);
    estimator.motor.wheel[0].sure_ticks = 30U;
    input.encoder_count[0] = 1;
    (void)step(&input, GW_STATUS_OK);
    CHECK(estimator.rate[0].last_torque_nm == estimator.presliding.last_torque_nm.wheel[0]);
    CHECK(gw_abs(estimator.rate[0].last_torque_nm - R(0.5)) > R(0.01));
}

void suite_estimator(void)
{
    unit_run("bad_arguments_are_refused", bad_arguments_are_refused);
    unit_run("at_rest_the_change_of_the_torques_is_the_push", at_rest_the_change_of_the_torques_is_the_push);
    unit_run("the_regime_follows_the_planned_speed", the_regime_follows_the_planned_speed);
    unit_run("standing_still_is_rest_at_any_rest_speed", standing_still_is_rest_at_any_rest_speed);
    unit_run("a_stop_has_a_zero_of_its_own", a_stop_has_a_zero_of_its_own);
    unit_run("a_stop_that_is_not_quiet_waits", a_stop_that_is_not_quiet_waits);
    unit_run("standing_long_does_not_wrap", standing_long_does_not_wrap);
    unit_run("a_tare_of_no_ticks_takes_the_sensors_at_their_word", a_tare_of_no_ticks_takes_the_sensors_at_their_word);
    unit_run("a_tare_of_one_tick_takes_that_tick", a_tare_of_one_tick_takes_that_tick);
    unit_run("a_new_tare_starts_from_nothing", a_new_tare_starts_from_nothing);
    unit_run("the_motion_comes_from_the_source_that_is_chosen", the_motion_comes_from_the_source_that_is_chosen);
    unit_run("with_bristles_a_tare_leaves_the_rollers_part_to_the_model",
             with_bristles_a_tare_leaves_the_rollers_part_to_the_model);
    unit_run("aligned_terms_of_the_balance_cancel", aligned_terms_of_the_balance_cancel);
    unit_run("aligned_friction_comes_with_the_acceleration", aligned_friction_comes_with_the_acceleration);
    unit_run("aligned_filters_start_afresh_after_a_gap", aligned_filters_start_afresh_after_a_gap);
    unit_run("the_step_of_the_zero_is_told", the_step_of_the_zero_is_told);
    unit_run("the_forces_of_the_model_are_told", the_forces_of_the_model_are_told);
    unit_run("the_friction_of_gears_is_in_the_model", the_friction_of_gears_is_in_the_model);
    unit_run("the_doubt_of_gears_is_told", the_doubt_of_gears_is_told);
    unit_run("it_is_told_that_a_wheel_turned", it_is_told_that_a_wheel_turned);
    unit_run("observed_motors_twist_the_drivetrains", observed_motors_twist_the_drivetrains);
    unit_run("bristles_are_deflected_by_the_same_twist", bristles_are_deflected_by_the_same_twist);
    unit_run("what_is_beyond_any_robot_is_refused", what_is_beyond_any_robot_is_refused);
    unit_run("a_wrench_beyond_any_push_is_refused", a_wrench_beyond_any_push_is_refused);
    unit_run("angles_of_counts_are_within_a_turn", angles_of_counts_are_within_a_turn);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
}
