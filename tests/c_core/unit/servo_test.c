#include "unit.h"

/* 1000 counts a turn, 2 kHz, 100 N m/rad, 2 N m s/rad, 10 N m, no rate limit. */
static const gw_servo_config_t config = {R(0.0005), R(100.0), R(2.0), R(10.0), R(0.0), 1000U, R(100.0), 4U};

static gw_servo_t of_config(const gw_servo_config_t *from)
{
    gw_servo_t servo;
    CHECK_STATUS(gw_servo_init(&servo, from), GW_STATUS_OK);
    CHECK(gw_servo_invariant_holds(&servo));
    return servo;
}

static gw_servo_output_t step(gw_servo_t *servo, const gw_servo_input_t *input, gw_status_t status)
{
    gw_servo_output_t output;
    CHECK_STATUS(gw_servo_step(servo, input, &output), status);
    CHECK(gw_servo_invariant_holds(servo));
    CHECK(gw_abs(output.torque_nm) <= servo->config.torque_limit_nm);
    return output;
}

static gw_servo_input_t reference(gw_real_t angle, gw_real_t speed, int32_t count)
{
    const gw_servo_input_t input = {angle, speed, true, true, count};
    return input;
}

static gw_servo_input_t no_reference(int32_t count)
{
    const gw_servo_input_t input = {GW_ZERO, GW_ZERO, false, true, count};
    return input;
}

static void bad_arguments_are_refused(void)
{
    gw_servo_t servo = of_config(&config);
    const gw_servo_input_t input = reference(GW_ZERO, GW_ZERO, 0);
    gw_servo_config_t bad = config;
    gw_servo_output_t output;
    bad.encoder_counts = 0U;
    CHECK_STATUS(gw_servo_init(NULL, &config), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_servo_init(&servo, NULL), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_servo_step(&servo, &input, NULL), GW_STATUS_NULL_POINTER);
    output.torque_nm = R(5.0);
    CHECK_STATUS(gw_servo_step(NULL, &input, &output), GW_STATUS_NULL_POINTER);
    CHECK((output.torque_nm == GW_ZERO) && (output.angle_error_rad == GW_ZERO) && (output.speed_radps == GW_ZERO));
    CHECK_STATUS(gw_servo_step(&servo, NULL, &output), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_servo_init(&servo, &bad), GW_STATUS_CONFIG_INVALID);
    CHECK_STATUS(gw_servo_step(&servo, &input, &output), GW_STATUS_NOT_INITIALISED);
    CHECK(output.torque_nm == GW_ZERO);
}

/* A wheel that stands at count 0 is pulled with kp times the error, up to the limit. */
static void torque_is_proportional_up_to_its_limit(void)
{
    const struct {
        gw_real_t angle;
        gw_real_t torque;
    } rows[] = {
        {R(0.0), R(0.0)},  {R(0.05), R(5.0)},   {R(-0.05), R(-5.0)},
        {R(0.5), R(10.0)}, {R(-0.5), R(-10.0)}, {R(6.33318530717958648), R(5.0)}, /* 0.05 rad and a turn */
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        gw_servo_t servo = of_config(&config);
        const gw_servo_input_t input = reference(rows[i].angle, GW_ZERO, 0);
        unit_row(i);
        CHECK_NEAR(step(&servo, &input, GW_STATUS_OK).torque_nm, rows[i].torque, R(60.0) * ROUNDING);
    }
}

static void the_derivative_acts_on_the_speed_error(void)
{
    gw_servo_t servo = of_config(&config);
    const gw_servo_input_t input = reference(GW_ZERO, R(1.5), 0);
    CHECK_NEAR(step(&servo, &input, GW_STATUS_OK).torque_nm, R(3.0), R(10.0) * ROUNDING);
}

/* One count per tick, across the wrap of the counter, is 4 pi rad/s; the angle goes on through it. */
static void speed_and_angle_are_measured_across_the_wrap(void)
{
    gw_servo_t servo = of_config(&config);
    const gw_servo_input_t first = no_reference(INT32_MAX - 199);
    gw_servo_output_t output = step(&servo, &first, GW_STATUS_OK);
    const int32_t start = servo.position_count;
    CHECK(output.torque_nm == GW_ZERO); /* holds the first measured angle */
    for (int32_t i = 1; i <= 400; i++) {
        const int32_t count = (i < 200) ? ((INT32_MAX - 199) + i) : (INT32_MIN + (i - 200));
        const gw_servo_input_t input = reference(GW_ZERO, GW_ZERO, count);
        output = step(&servo, &input, GW_STATUS_OK);
    }
    CHECK_NEAR(output.speed_radps, R(12.5663706143591730), R(12.0) * ROUNDING);
    CHECK(servo.position_count == ((start + 400) % 1000));
}

static void counts_below_zero_are_an_angle_too(void)
{
    gw_servo_t servo = of_config(&config);
    const gw_servo_input_t first = no_reference(-250);
    const gw_servo_input_t second = no_reference(-300);
    (void)step(&servo, &first, GW_STATUS_OK);
    CHECK(servo.position_count == 750);
    (void)step(&servo, &second, GW_STATUS_OK);
    CHECK(servo.position_count == 700);
}

/* Between references the angle is extrapolated; after four ticks without one it is held at zero speed. */
static void a_reference_is_extrapolated_and_grows_stale(void)
{
    gw_servo_t servo = of_config(&config);
    const gw_servo_input_t first = reference(R(0.01), R(2.0), 0);
    const gw_servo_input_t later = no_reference(0);
    (void)step(&servo, &first, GW_STATUS_OK);
    for (uint32_t i = 1U; i <= 3U; i++) {
        unit_row(i);
        CHECK_NEAR(step(&servo, &later, GW_STATUS_OK).angle_error_rad, R(0.01) + (R(0.001) * (gw_real_t)i), ROUNDING);
    }
    for (uint32_t i = 4U; i <= 6U; i++) {
        unit_row(i);
        CHECK_NEAR(step(&servo, &later, GW_STATUS_REFERENCE_STALE).angle_error_rad, R(0.013), ROUNDING);
    }
    const gw_servo_input_t again = reference(R(0.02), GW_ZERO, 0);
    CHECK_NEAR(step(&servo, &again, GW_STATUS_OK).angle_error_rad, R(0.02), ROUNDING);
}

static void a_reference_that_is_not_finite_holds_the_last_angle(void)
{
    const struct {
        gw_real_t angle;
        gw_real_t speed;
    } rows[] = {
        {unit_nan(), R(0.0)},           {unit_infinity(), R(0.0)},       {R(0.0), unit_nan()},
        {R(0.0), unit_above(R(1.0e4))}, {R(0.0), unit_below(R(-1.0e4))},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        gw_servo_t servo = of_config(&config);
        const gw_servo_input_t good = reference(R(0.01), R(2.0), 0);
        const gw_servo_input_t bad = reference(rows[i].angle, rows[i].speed, 0);
        const gw_servo_input_t later = no_reference(0);
        unit_row(i);
        (void)step(&servo, &good, GW_STATUS_OK);
        CHECK_NEAR(step(&servo, &bad, GW_STATUS_REFERENCE_INVALID).torque_nm, R(1.0), R(2.0) * ROUNDING);
        /* and stays invalid, not merely stale */
        for (uint32_t k = 0U; k < 6U; k++) {
            CHECK_NEAR(step(&servo, &later, GW_STATUS_REFERENCE_INVALID).angle_error_rad, R(0.01), ROUNDING);
        }
    }
}

/* Disabled and without a reference it is turned by hand by 100 counts: enabling must not pull it back. */
static void a_disabled_servo_has_no_torque_and_no_memory(void)
{
    gw_servo_t servo = of_config(&config);
    gw_servo_input_t input = no_reference(0);
    input.enable = false;
    for (uint32_t i = 0U; i < 3U; i++) {
        CHECK(step(&servo, &input, GW_STATUS_OK).torque_nm == GW_ZERO);
    }
    for (uint32_t i = 0U; i < 2000U; i++) {
        input.encoder_count = 100;
        CHECK(step(&servo, &input, GW_STATUS_REFERENCE_STALE).torque_nm == GW_ZERO);
    }
    input.enable = true;
    CHECK_NEAR(step(&servo, &input, GW_STATUS_REFERENCE_STALE).torque_nm, GW_ZERO, R(60.0) * ROUNDING);
}

static void a_fresh_reference_survives_being_disabled(void)
{
    gw_servo_t servo = of_config(&config);
    gw_servo_input_t input = reference(R(0.05), GW_ZERO, 0);
    input.enable = false;
    CHECK_NEAR(step(&servo, &input, GW_STATUS_OK).angle_error_rad, R(0.05), ROUNDING);
}

/* 4000 N m/s is 2 N m a tick. */
static void torque_changes_no_faster_than_its_limit(void)
{
    gw_servo_config_t slow = config;
    slow.torque_rate_limit_nm_per_s = R(4000.0);
    gw_servo_t servo = of_config(&slow);
    const gw_servo_input_t up = reference(R(0.5), GW_ZERO, 0);
    const gw_servo_input_t down = reference(R(-0.5), GW_ZERO, 0);
    for (uint32_t i = 1U; i <= 5U; i++) {
        unit_row(i);
        CHECK_NEAR(step(&servo, &up, GW_STATUS_OK).torque_nm, R(2.0) * (gw_real_t)i, R(10.0) * ROUNDING);
    }
    CHECK_NEAR(step(&servo, &down, GW_STATUS_OK).torque_nm, R(8.0), R(10.0) * ROUNDING);
}

/* The servo of the paper's robot, as its header gives it. */
static void the_paper_s_servo_is_accepted(void)
{
    gw_servo_config_t trikey = config;
    trikey.kp_nm_per_rad = GW_TRIKEY_SERVO_KP_NM_PER_RAD;
    trikey.kd_nms_per_rad = GW_TRIKEY_SERVO_KD_NMS_PER_RAD;
    trikey.torque_limit_nm = GW_TRIKEY_DRIVETRAIN_TORQUE_LIMIT_NM;
    trikey.derivative_cutoff_hz = GW_TRIKEY_SERVO_DERIVATIVE_CUTOFF_HZ;
    trikey.encoder_counts = GW_TRIKEY_DRIVETRAIN_ENCODER_COUNTS;
    gw_servo_t servo = of_config(&trikey);
    const gw_servo_input_t input = reference(R(3.0), GW_ZERO, 0);
    CHECK(step(&servo, &input, GW_STATUS_OK).torque_nm == GW_TRIKEY_DRIVETRAIN_TORQUE_LIMIT_NM);
}

static void the_invariant_sees_every_member(void)
{
    gw_servo_t bad[12];
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(bad); i++) {
        bad[i] = of_config(&config);
    }
    bad[0].initialised = false;
    bad[1].config.kp_nm_per_rad = R(-1.0);
    bad[2].desired_rad.excess = unit_nan();
    bad[3].desired_rad.value = R(4.0);
    bad[4].desired_speed_radps = unit_nan();
    bad[5].speed_radps = unit_infinity();
    bad[6].position_count = -1;
    bad[7].position_count = 1000;
    bad[8].filter_gain = R(1.5);
    bad[9].torque_nm = R(10.5);
    bad[10].torque_nm = unit_nan();
    bad[11].desired_rad.value = unit_nan();
    CHECK(!gw_servo_invariant_holds(NULL));
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(bad); i++) {
        unit_row(i);
        CHECK(!gw_servo_invariant_holds(&bad[i]));
    }
}

void suite_servo(void)
{
    unit_run("bad_arguments_are_refused", bad_arguments_are_refused);
    unit_run("torque_is_proportional_up_to_its_limit", torque_is_proportional_up_to_its_limit);
    unit_run("the_derivative_acts_on_the_speed_error", the_derivative_acts_on_the_speed_error);
    unit_run("speed_and_angle_are_measured_across_the_wrap", speed_and_angle_are_measured_across_the_wrap);
    unit_run("counts_below_zero_are_an_angle_too", counts_below_zero_are_an_angle_too);
    unit_run("a_reference_is_extrapolated_and_grows_stale", a_reference_is_extrapolated_and_grows_stale);
    unit_run("a_reference_that_is_not_finite_holds_the_last_angle",
             a_reference_that_is_not_finite_holds_the_last_angle);
    unit_run("a_disabled_servo_has_no_torque_and_no_memory", a_disabled_servo_has_no_torque_and_no_memory);
    unit_run("a_fresh_reference_survives_being_disabled", a_fresh_reference_survives_being_disabled);
    unit_run("torque_changes_no_faster_than_its_limit", torque_changes_no_faster_than_its_limit);
    unit_run("the_paper_s_servo_is_accepted", the_paper_s_servo_is_accepted);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
}
