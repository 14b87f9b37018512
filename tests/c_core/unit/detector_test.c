#include "unit.h"

#define PERIOD R(0.001)

static gw_detector_config_t impulse_config(void)
{
    gw_detector_config_t config;
    gw_detector_config_trikey(&config);
    config.kind = GW_DETECTOR_IMPULSE;
    config.force_threshold_n = R(10.0);
    config.impulse_threshold_newton_s = R(0.5);
    config.leak_rest_n = R(1.0);
    config.leak_creep_n = R(40.0);
    config.leak_motion_n = R(3.0);
    config.release_force_n = R(6.0);
    config.blanking_ticks = 5U;
    return config;
}

static gw_detector_t made(uint32_t kind)
{
    gw_detector_config_t config = impulse_config();
    gw_detector_t detector;
    config.kind = kind;
    CHECK_STATUS(gw_detector_init(&detector, &config, PERIOD), GW_STATUS_OK);
    CHECK(gw_detector_invariant_holds(&detector));
    return detector;
}

/* A steady push along x with a moment, as the estimator would give it. */
static gw_detector_input_t push(gw_real_t force_n, gw_regime_t regime)
{
    const gw_wrench_t wrench = {force_n, GW_ZERO, R(0.1) * force_n};
    const gw_detector_input_t input = {wrench, wrench, wrench, 20U, regime, true, false};
    return input;
}

static gw_detector_output_t step(gw_detector_t *detector, const gw_detector_input_t *input)
{
    gw_detector_output_t output;
    CHECK_STATUS(gw_detector_step(detector, input, &output), GW_STATUS_OK);
    CHECK(gw_detector_invariant_holds(detector));
    CHECK(output.active == detector->active);
    return output;
}

static void bad_arguments_are_refused(void)
{
    const gw_detector_config_t config = impulse_config();
    gw_detector_t detector = made(GW_DETECTOR_IMPULSE);
    const gw_detector_input_t input = push(R(1.0), GW_REGIME_REST);
    gw_detector_output_t output;
    CHECK_STATUS(gw_detector_init(NULL, &config, PERIOD), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_detector_init(&detector, NULL, PERIOD), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_detector_step(&detector, &input, NULL), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_detector_step(&detector, NULL, &output), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_detector_step(NULL, &input, &output), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_detector_init(&detector, &config, R(0.0)), GW_STATUS_CONFIG_INVALID);
    CHECK_STATUS(gw_detector_step(&detector, &input, &output), GW_STATUS_NOT_INITIALISED);
    CHECK(!output.tripped);
}

/* 51 N minus 1 N of leak is 0.05 N s per tick; the leak is part of the mean force. */
static void the_impulse_trips_once_it_exceeds_the_threshold(void)
{
    gw_detector_t detector = made(GW_DETECTOR_IMPULSE);
    const gw_detector_input_t input = push(R(51.0), GW_REGIME_REST);
    uint32_t ticks = 0U;
    bool tripped = false;
    while ((!tripped) && (ticks < 100U)) {
        const gw_detector_output_t output = step(&detector, &input);
        ticks++;
        unit_row(ticks);
        tripped = output.tripped;
        CHECK(tripped == (output.statistic > R(0.5)));
        CHECK(output.active == tripped);
        CHECK_NEAR(output.statistic, R(0.05) * (gw_real_t)ticks, ROUNDING);
        CHECK_NEAR(output.mean_wrench.force_x_n, R(51.0), R(60.0) * ROUNDING);
        CHECK_NEAR(output.mean_wrench.torque_nm, R(5.1), R(6.0) * ROUNDING);
        CHECK(output.samples == ticks);
    }
    CHECK((ticks == 10U) || (ticks == 11U)); /* the tenth reaches 0.5 N s up to rounding */
}

static void what_is_forgiven_depends_on_the_motion(void)
{
    const struct {
        gw_regime_t regime;
        gw_real_t leak;
    } rows[] = {
        {GW_REGIME_REST, R(1.0)},
        {GW_REGIME_CREEPING, R(40.0)},
        {GW_REGIME_MOTION, R(3.0)},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        gw_detector_t detector = made(GW_DETECTOR_IMPULSE);
        const gw_detector_input_t below = push(rows[i].leak * R(0.99), rows[i].regime);
        const gw_detector_input_t above = push(rows[i].leak + R(1.0), rows[i].regime);
        unit_row(i);
        CHECK(gw_detector_leak(&detector, rows[i].regime) == rows[i].leak);
        for (uint32_t k = 0U; k < 1000U; k++) {
            const gw_detector_output_t output = step(&detector, &below);
            CHECK((!output.tripped) && (output.statistic == GW_ZERO) && (detector.samples == 0U));
        }
        CHECK_NEAR(step(&detector, &above).statistic, R(0.001), ROUNDING);
    }
}

/* The number of samples saturates instead of wrapping; a day later the mean still has a sensible divisor. */
static void the_number_of_samples_saturates(void)
{
    gw_detector_t detector = made(GW_DETECTOR_IMPULSE);
    const gw_detector_input_t input = push(R(51.0), GW_REGIME_REST);
    detector.samples = GW_TICK_MASK;
    CHECK(step(&detector, &input).samples == GW_TICK_MASK);
}

/* Without a leak the impulse may be too small for a lever arm: 0.05 N for 1 ms is half the least impulse that gives
 * one, and so gives half the moment. Far above it the moment is the one that was pushed with. */
static void too_small_an_impulse_gives_less_lever_arm(void)
{
    const struct {
        gw_real_t force;
        gw_real_t torque;
    } rows[] = {{R(0.05), R(0.0025)}, {R(0.2), R(0.02)}};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        gw_detector_t detector = made(GW_DETECTOR_IMPULSE);
        const gw_detector_input_t input = push(rows[i].force, GW_REGIME_REST);
        detector.config.leak_rest_n = GW_ZERO;
        unit_row(i);
        CHECK_NEAR(step(&detector, &input).mean_wrench.torque_nm, rows[i].torque, R(0.001) * rows[i].torque);
    }
}

static void the_average_trips_above_its_threshold(void)
{
    const struct {
        gw_real_t force;
        gw_regime_t regime;
        bool trips;
    } rows[] = {
        {R(10.0), GW_REGIME_REST, false},     {R(10.1), GW_REGIME_REST, true},     {R(10.1), GW_REGIME_MOTION, true},
        {R(39.0), GW_REGIME_CREEPING, false}, {R(40.1), GW_REGIME_CREEPING, true},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        gw_detector_t detector = made(GW_DETECTOR_FORCE_AVERAGE);
        const gw_detector_input_t input = push(rows[i].force, rows[i].regime);
        const gw_detector_output_t output = step(&detector, &input);
        unit_row(i);
        CHECK(output.tripped == rows[i].trips);
        CHECK_NEAR(output.statistic, rows[i].force, R(40.0) * ROUNDING);
        CHECK((output.mean_wrench.force_x_n == rows[i].force) && (output.samples == 20U));
    }
}

static void nothing_is_integrated_while_nobody_asks(void)
{
    gw_detector_t detector = made(GW_DETECTOR_IMPULSE);
    gw_detector_input_t input = push(R(51.0), GW_REGIME_REST);
    (void)step(&detector, &input);
    input.enabled = false;
    CHECK(step(&detector, &input).statistic == GW_ZERO);
    CHECK((detector.impulse_x_newton_s == GW_ZERO) && (detector.samples == 0U));
}

static gw_detector_t tripped(uint32_t kind)
{
    gw_detector_t detector = made(kind);
    gw_detector_input_t input = push(R(1000.0), GW_REGIME_REST);
    CHECK(step(&detector, &input).tripped);
    return detector;
}

/* Blanked for five ticks; then until the force is gone or the reaction is over. */
static void a_tripped_detector_rests_until_it_may_trip_again(void)
{
    const struct {
        uint32_t kind;
        gw_real_t force;
        bool reaction_over;
        bool released;
    } rows[] = {
        {GW_DETECTOR_IMPULSE, R(7.0), false, false},       {GW_DETECTOR_IMPULSE, R(7.0), true, true},
        {GW_DETECTOR_IMPULSE, R(5.0), false, true},        {GW_DETECTOR_FORCE_AVERAGE, R(5.0), false, true},
        {GW_DETECTOR_FORCE_AVERAGE, R(7.0), false, false},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        gw_detector_t detector = tripped(rows[i].kind);
        gw_detector_input_t input = push(rows[i].force, GW_REGIME_CREEPING);
        input.reaction_over = rows[i].reaction_over;
        for (uint32_t tick = 1U; tick <= 8U; tick++) {
            const gw_detector_output_t output = step(&detector, &input);
            unit_row((10U * i) + tick);
            CHECK(output.active == ((tick < 5U) || (!rows[i].released)));
            CHECK(!output.tripped);
        }
    }
}

/* A release force above the threshold of the average would let it trip and release for ever. */
static void the_average_releases_below_its_threshold_at_the_latest(void)
{
    gw_detector_t detector = tripped(GW_DETECTOR_FORCE_AVERAGE);
    const gw_detector_input_t input = push(R(12.0), GW_REGIME_REST);
    detector.config.release_force_n = R(50.0);
    for (uint32_t tick = 0U; tick < 20U; tick++) {
        const gw_detector_output_t output = step(&detector, &input);
        unit_row(tick);
        CHECK(output.active && (!output.tripped));
    }
}

static void a_wrench_that_is_not_finite_changes_nothing(void)
{
    gw_detector_input_t rows[3] = {push(R(51.0), GW_REGIME_REST), push(R(51.0), GW_REGIME_REST),
                                   push(R(51.0), GW_REGIME_REST)};
    rows[0].wrench.force_x_n = unit_nan();
    rows[1].mean.force_y_n = unit_infinity();
    rows[2].window_mean.torque_nm = unit_nan();
    for (uint32_t i = 0U; i < 3U; i++) {
        gw_detector_t detector = tripped(GW_DETECTOR_IMPULSE);
        gw_detector_output_t output;
        unit_row(i);
        CHECK_STATUS(gw_detector_step(&detector, &rows[i], &output), GW_STATUS_INPUT_INVALID);
        CHECK((!output.tripped) && output.active && (detector.ticks_since_trip == 0U));
        CHECK(gw_detector_invariant_holds(&detector));
    }
}

static void the_invariant_sees_every_member(void)
{
    gw_detector_t detector = made(GW_DETECTOR_IMPULSE);
    CHECK(!gw_detector_invariant_holds(NULL));
    detector.initialised = false;
    CHECK(!gw_detector_invariant_holds(&detector));
    detector = made(GW_DETECTOR_IMPULSE);
    detector.period_s = GW_ZERO;
    CHECK(!gw_detector_invariant_holds(&detector));
    detector = made(GW_DETECTOR_IMPULSE);
    detector.impulse_x_newton_s = unit_nan();
    CHECK(!gw_detector_invariant_holds(&detector));
    detector = made(GW_DETECTOR_IMPULSE);
    detector.impulse_y_newton_s = unit_nan();
    CHECK(!gw_detector_invariant_holds(&detector));
    detector = made(GW_DETECTOR_IMPULSE);
    detector.impulse_moment_nms = unit_infinity();
    CHECK(!gw_detector_invariant_holds(&detector));
    detector = made(GW_DETECTOR_IMPULSE);
    detector.ticks_since_trip = 6U;
    CHECK(!gw_detector_invariant_holds(&detector));
    detector = made(GW_DETECTOR_IMPULSE);
    detector.config.force_threshold_n = GW_ZERO;
    CHECK(!gw_detector_invariant_holds(&detector));
}

/* 30 N at 25 Hz for twenty seconds: the integral of the magnitude would trip in the second period. */
static void alternating_forces_cancel(void)
{
    gw_detector_t detector = made(GW_DETECTOR_IMPULSE);
    for (uint32_t tick = 0U; tick < 20000U; tick++) {
        const gw_rotation_t phase = gw_sincos(GW_TWO * GW_PI * R(0.025) * (gw_real_t)(tick % 40U));
        const gw_detector_input_t input = push(R(30.0) * phase.sine, GW_REGIME_REST);
        unit_row(tick);
        CHECK(!step(&detector, &input).tripped);
    }
}

/* The moment shrinks as the impulse does: the mean wrench keeps the lever arm of 0.1 m. */
static void a_varying_force_keeps_its_lever_arm(void)
{
    gw_detector_t detector = made(GW_DETECTOR_IMPULSE);
    bool tripped = false;
    for (uint32_t tick = 0U; (tick < 200U) && (!tripped); tick++) {
        const gw_detector_input_t input = push((gw_real_t)((tick * 7U) % 30U), GW_REGIME_REST);
        const gw_detector_output_t output = step(&detector, &input);
        unit_row(tick);
        CHECK_NEAR(output.mean_wrench.torque_nm, R(0.1) * output.mean_wrench.force_x_n, R(30.0) * ROUNDING);
        tripped = output.tripped;
    }
    CHECK(tripped);
}

void suite_detector(void)
{
    unit_run("alternating_forces_cancel", alternating_forces_cancel);
    unit_run("a_varying_force_keeps_its_lever_arm", a_varying_force_keeps_its_lever_arm);
    unit_run("bad_arguments_are_refused", bad_arguments_are_refused);
    unit_run("the_impulse_trips_once_it_exceeds_the_threshold", the_impulse_trips_once_it_exceeds_the_threshold);
    unit_run("what_is_forgiven_depends_on_the_motion", what_is_forgiven_depends_on_the_motion);
    unit_run("the_number_of_samples_saturates", the_number_of_samples_saturates);
    unit_run("too_small_an_impulse_gives_less_lever_arm", too_small_an_impulse_gives_less_lever_arm);
    unit_run("the_average_trips_above_its_threshold", the_average_trips_above_its_threshold);
    unit_run("nothing_is_integrated_while_nobody_asks", nothing_is_integrated_while_nobody_asks);
    unit_run("a_tripped_detector_rests_until_it_may_trip_again", a_tripped_detector_rests_until_it_may_trip_again);
    unit_run("the_average_releases_below_its_threshold_at_the_latest",
             the_average_releases_below_its_threshold_at_the_latest);
    unit_run("a_wrench_that_is_not_finite_changes_nothing", a_wrench_that_is_not_finite_changes_nothing);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
}
