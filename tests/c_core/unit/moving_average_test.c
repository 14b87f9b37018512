#include "unit.h"

static gw_wrench_t sample(gw_real_t size)
{
    const gw_wrench_t wrench = {size, R(2.0) * size, -size};
    return wrench;
}

static void the_window_is_checked(void)
{
    const struct {
        uint32_t window;
        gw_status_t status;
    } rows[] = {
        {0U, GW_STATUS_CONFIG_INVALID},
        {1U, GW_STATUS_OK},
        {2U, GW_STATUS_OK},
        {GW_MOVING_AVERAGE_CAPACITY - 1U, GW_STATUS_OK},
        {GW_MOVING_AVERAGE_CAPACITY, GW_STATUS_OK},
        {GW_MOVING_AVERAGE_CAPACITY + 1U, GW_STATUS_CONFIG_INVALID},
    };
    static gw_moving_average_t average;
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        unit_row(i);
        CHECK_STATUS(gw_moving_average_init(&average, rows[i].window), rows[i].status);
        CHECK(gw_moving_average_invariant_holds(&average));
    }
    CHECK_STATUS(gw_moving_average_init(NULL, 4U), GW_STATUS_NULL_POINTER);
}

/* Samples 1, 2, 3, ... in a window of four: the means of the last ones, before and after the ring wraps. */
static void means_are_those_of_the_last_samples(void)
{
    const gw_real_t held[] = {R(1.0), R(1.5), R(2.0), R(2.5), R(3.5), R(4.5), R(5.5), R(6.5), R(7.5)};
    static gw_moving_average_t average;
    CHECK_STATUS(gw_moving_average_init(&average, 4U), GW_STATUS_OK);
    CHECK(gw_moving_average_mean(&average).force_x_n == GW_ZERO);
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(held); i++) {
        const uint32_t count = (i < 4U) ? (i + 1U) : 4U;
        unit_row(i);
        CHECK_STATUS(gw_moving_average_add(&average, sample((gw_real_t)(i + 1U))), GW_STATUS_OK);
        CHECK(gw_moving_average_invariant_holds(&average));
        CHECK(gw_moving_average_count(&average) == count);
        CHECK(gw_moving_average_mean(&average).force_x_n == held[i]);
        CHECK(gw_moving_average_mean(&average).force_y_n == (R(2.0) * held[i]));
        CHECK(gw_moving_average_mean(&average).torque_nm == -held[i]);
        CHECK(gw_moving_average_window_mean(&average).force_x_n == ((held[i] * (gw_real_t)count) / R(4.0)));
    }
    gw_moving_average_reset(&average);
    CHECK(gw_moving_average_count(&average) == 0U);
    CHECK(gw_moving_average_mean(&average).force_x_n == GW_ZERO);
}

/* In a plain running sum the rounding error of a huge sample would stay for ever. */
static void rounding_errors_live_for_one_window(void)
{
    static gw_moving_average_t average;
    CHECK_STATUS(gw_moving_average_init(&average, 3U), GW_STATUS_OK);
    CHECK_STATUS(gw_moving_average_add(&average, sample(R(0.1))), GW_STATUS_OK);
    CHECK_STATUS(gw_moving_average_add(&average, sample(R(4.0e8))), GW_STATUS_OK);
    for (uint32_t i = 0U; i < 7U; i++) {
        CHECK_STATUS(gw_moving_average_add(&average, sample(R(0.5))), GW_STATUS_OK);
    }
    CHECK(gw_moving_average_mean(&average).force_x_n == R(0.5));
}

static void what_is_no_wrench_is_refused(void)
{
    static gw_moving_average_t average;
    CHECK_STATUS(gw_moving_average_init(&average, 4U), GW_STATUS_OK);
    CHECK_STATUS(gw_moving_average_add(&average, sample(unit_nan())), GW_STATUS_INPUT_INVALID);
    CHECK(gw_moving_average_count(&average) == 0U);
    CHECK_STATUS(gw_moving_average_add(NULL, sample(R(1.0))), GW_STATUS_NULL_POINTER);
}

static void the_invariant_sees_every_member(void)
{
    static gw_moving_average_t good;
    static gw_moving_average_t average;
    CHECK(!gw_moving_average_invariant_holds(NULL));
    CHECK_STATUS(gw_moving_average_init(&good, 4U), GW_STATUS_OK);
    CHECK_STATUS(gw_moving_average_add(&good, sample(R(1.0))), GW_STATUS_OK);
    average = good;
    average.window = 0U;
    CHECK(!gw_moving_average_invariant_holds(&average));
    average.window = GW_MOVING_AVERAGE_CAPACITY + 1U;
    CHECK(!gw_moving_average_invariant_holds(&average));
    average = good;
    average.index = 4U;
    CHECK(!gw_moving_average_invariant_holds(&average));
    average = good;
    average.count = 5U;
    CHECK(!gw_moving_average_invariant_holds(&average));
    average = good;
    average.window_sum.force_x_n = unit_nan();
    CHECK(!gw_moving_average_invariant_holds(&average));
    average = good;
    average.window_sum.force_y_n = unit_infinity();
    CHECK(!gw_moving_average_invariant_holds(&average));
    average = good;
    average.window_sum.torque_nm = unit_nan();
    CHECK(!gw_moving_average_invariant_holds(&average));
}

void suite_moving_average(void)
{
    unit_run("the_window_is_checked", the_window_is_checked);
    unit_run("means_are_those_of_the_last_samples", means_are_those_of_the_last_samples);
    unit_run("rounding_errors_live_for_one_window", rounding_errors_live_for_one_window);
    unit_run("what_is_no_wrench_is_refused", what_is_no_wrench_is_refused);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
}
