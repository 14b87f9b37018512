#include "unit.h"

static const gw_sensor_check_config_t config = {R(20.0), 3U, 100U, 2U};

static gw_sensor_check_t made(void)
{
    gw_sensor_check_t check;
    CHECK_STATUS(gw_sensor_check_init(&check, &config), GW_STATUS_OK);
    CHECK(gw_sensor_check_invariant_holds(&check));
    return check;
}

static gw_sensor_sample_t good(uint32_t counter)
{
    const gw_sensor_sample_t sample = {{R(0.1), R(-0.1), R(0.0)}, {10, 20, 30}, counter, true};
    return sample;
}

static gw_status_t step(gw_sensor_check_t *check, const gw_sensor_sample_t *sample)
{
    const gw_status_t status = gw_sensor_check_step(check, sample);
    CHECK(gw_sensor_check_invariant_holds(check));
    return status;
}

static void bad_arguments_are_refused(void)
{
    gw_sensor_check_t check = made();
    const gw_sensor_sample_t sample = good(0U);
    gw_sensor_check_config_t bad = config;
    bad.stale_ticks_max = 0U;
    CHECK_STATUS(gw_sensor_check_init(NULL, &config), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_sensor_check_init(&check, NULL), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_sensor_check_step(NULL, &sample), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_sensor_check_step(&check, NULL), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_sensor_check_init(&check, &bad), GW_STATUS_CONFIG_INVALID);
    CHECK_STATUS(gw_sensor_check_step(&check, &sample), GW_STATUS_NOT_INITIALISED);
}

static void equal_good_samples_are_good(void)
{
    gw_sensor_check_t check = made();
    for (uint32_t i = 0U; i < 20U; i++) {
        const gw_sensor_sample_t sample = good(i);
        unit_row(i);
        CHECK_STATUS(step(&check, &sample), GW_STATUS_OK);
    }
}

/* One fault, then good samples: they count again after recover_ticks = 2 of them. */
static void a_fault_is_named_and_takes_time_to_recover_from(void)
{
    gw_sensor_sample_t missing = good(1U);
    gw_sensor_sample_t nan = good(1U);
    gw_sensor_sample_t infinite = good(1U);
    gw_sensor_sample_t saturated = good(1U);
    gw_sensor_sample_t negative = good(1U);
    gw_sensor_sample_t both = good(1U);
    gw_sensor_sample_t jump = good(1U);
    missing.present = false;
    nan.torque_nm[0] = unit_nan();
    infinite.torque_nm[2] = unit_infinity();
    saturated.torque_nm[1] = R(20.0);
    negative.torque_nm[1] = R(-20.0);
    both.torque_nm[0] = R(20.0);
    both.torque_nm[1] = unit_nan();
    jump.encoder_count[1] += 101;
    const struct {
        const gw_sensor_sample_t *sample;
        gw_status_t status;
    } rows[] = {
        {&missing, GW_STATUS_SENSOR_MISSING},    {&nan, GW_STATUS_SENSOR_NONFINITE},
        {&infinite, GW_STATUS_SENSOR_NONFINITE}, {&saturated, GW_STATUS_SENSOR_SATURATED},
        {&negative, GW_STATUS_SENSOR_SATURATED}, {&both, GW_STATUS_SENSOR_NONFINITE},
        {&jump, GW_STATUS_ENCODER_JUMP},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        gw_sensor_check_t check = made();
        const gw_status_t after[] = {GW_STATUS_SENSOR_RECOVERING, GW_STATUS_SENSOR_RECOVERING, GW_STATUS_OK};
        gw_sensor_sample_t sample = good(0U);
        unit_row(i);
        CHECK_STATUS(step(&check, &sample), GW_STATUS_OK);
        CHECK_STATUS(step(&check, rows[i].sample), rows[i].status);
        for (uint32_t k = 0U; k < 3U; k++) {
            sample = good(2U + k);
            if (rows[i].sample == &jump) {
                sample.encoder_count[1] += 101; /* where it jumped to */
            }
            CHECK_STATUS(step(&check, &sample), after[k]);
        }
    }
}

static void a_torque_just_below_the_limit_is_good(void)
{
    gw_sensor_check_t check = made();
    gw_sensor_sample_t sample = good(0U);
    sample.torque_nm[2] = unit_below(R(20.0));
    CHECK_STATUS(step(&check, &sample), GW_STATUS_OK);
}

static void before_the_first_good_sample_there_is_nothing_to_recover_from(void)
{
    gw_sensor_check_t check = made();
    gw_sensor_sample_t sample = good(0U);
    sample.present = false;
    CHECK_STATUS(step(&check, &sample), GW_STATUS_SENSOR_MISSING);
    sample = good(1U);
    CHECK_STATUS(step(&check, &sample), GW_STATUS_OK);
}

/* The counter stands: three ticks without a new sample are stale, and only new samples count for the recovery. */
static void a_counter_that_stands_is_stale(void)
{
    const gw_status_t standing[] = {GW_STATUS_OK, GW_STATUS_OK, GW_STATUS_OK, GW_STATUS_SENSOR_STALE,
                                    GW_STATUS_SENSOR_STALE};
    const struct {
        uint32_t counter;
        gw_status_t status;
    } rows[] = {
        {8U, GW_STATUS_SENSOR_RECOVERING},
        {8U, GW_STATUS_SENSOR_RECOVERING},
        {9U, GW_STATUS_SENSOR_RECOVERING},
        {9U, GW_STATUS_OK},
    };
    gw_sensor_check_t check = made();
    gw_sensor_sample_t sample = good(7U);
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(standing); i++) {
        unit_row(i);
        CHECK_STATUS(step(&check, &sample), standing[i]);
    }
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        unit_row(10U + i);
        sample = good(rows[i].counter);
        CHECK_STATUS(step(&check, &sample), rows[i].status);
    }
}

/* After two missed ticks a wheel may have turned three times as far. */
static void the_jump_limit_grows_with_the_time_between_samples(void)
{
    const int32_t moves[] = {300, -300, 301, -301};
    const gw_status_t statuses[] = {GW_STATUS_OK, GW_STATUS_OK, GW_STATUS_ENCODER_JUMP, GW_STATUS_ENCODER_JUMP};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(moves); i++) {
        gw_sensor_check_t check = made();
        gw_sensor_sample_t sample = good(0U);
        unit_row(i);
        for (uint32_t k = 0U; k < 3U; k++) {
            CHECK_STATUS(step(&check, &sample), GW_STATUS_OK);
        }
        sample.counter = 1U;
        sample.encoder_count[0] += moves[i];
        CHECK_STATUS(step(&check, &sample), statuses[i]);
    }
}

static void counts_may_wrap(void)
{
    gw_sensor_check_t check = made();
    gw_sensor_sample_t sample = good(0xFFFFFFFFU);
    sample.encoder_count[0] = INT32_MAX;
    CHECK_STATUS(step(&check, &sample), GW_STATUS_OK);
    sample.counter = 0U;
    sample.encoder_count[0] = INT32_MIN;
    CHECK_STATUS(step(&check, &sample), GW_STATUS_OK);
}

static void the_invariant_sees_every_member(void)
{
    gw_sensor_check_t check = made();
    CHECK(!gw_sensor_check_invariant_holds(NULL));
    check.initialised = false;
    CHECK(!gw_sensor_check_invariant_holds(&check));
    check = made();
    check.config.torque_limit_nm = unit_nan();
    CHECK(!gw_sensor_check_invariant_holds(&check));
    check = made();
    check.age_ticks = 4U;
    CHECK(!gw_sensor_check_invariant_holds(&check));
    check = made();
    check.recover_remaining = 3U;
    CHECK(!gw_sensor_check_invariant_holds(&check));
}

void suite_sensor_check(void)
{
    unit_run("bad_arguments_are_refused", bad_arguments_are_refused);
    unit_run("equal_good_samples_are_good", equal_good_samples_are_good);
    unit_run("a_fault_is_named_and_takes_time_to_recover_from", a_fault_is_named_and_takes_time_to_recover_from);
    unit_run("a_torque_just_below_the_limit_is_good", a_torque_just_below_the_limit_is_good);
    unit_run("before_the_first_good_sample_there_is_nothing_to_recover_from",
             before_the_first_good_sample_there_is_nothing_to_recover_from);
    unit_run("a_counter_that_stands_is_stale", a_counter_that_stands_is_stale);
    unit_run("the_jump_limit_grows_with_the_time_between_samples", the_jump_limit_grows_with_the_time_between_samples);
    unit_run("counts_may_wrap", counts_may_wrap);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
}
