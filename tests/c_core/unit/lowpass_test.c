#include "unit.h"

#define PERIOD R(0.001)
#define LIMIT R(100.0)

static gw_rate_filter_constants_t made(gw_real_t cutoff_radps)
{
    gw_rate_filter_constants_t constants;
    CHECK_STATUS(gw_rate_filter_constants(&constants, PERIOD, cutoff_radps, 8000U, GW_ZERO), GW_STATUS_OK);
    return constants;
}

static gw_lowpass_t restarted(void)
{
    gw_lowpass_t filter = {R(3.0), R(3.0), true};
    gw_lowpass_restart(&filter);
    CHECK(gw_lowpass_invariant_holds(&filter, LIMIT));
    return filter;
}

static gw_real_t step(gw_lowpass_t *filter, const gw_rate_filter_constants_t *constants, gw_real_t input)
{
    const gw_real_t value = gw_lowpass_step(filter, constants, input, LIMIT);
    CHECK(gw_lowpass_invariant_holds(filter, LIMIT));
    CHECK(value == filter->value);
    return value;
}

static void it_starts_at_its_first_input(void)
{
    const gw_rate_filter_constants_t constants = made(R(200.0));
    gw_lowpass_t filter = restarted();
    CHECK((filter.value == GW_ZERO) && (filter.derivative == GW_ZERO) && (!filter.started));
    for (uint32_t i = 0U; i < 3U; i++) {
        unit_row(i);
        CHECK(step(&filter, &constants, R(7.0)) == R(7.0));
        CHECK((filter.derivative == GW_ZERO) && filter.started);
    }
    gw_lowpass_restart(&filter);
    filter.derivative = GW_ONE; /* whatever a state holds that has not started */
    CHECK(step(&filter, &constants, R(-2.0)) == R(-2.0));
    CHECK(filter.derivative == GW_ZERO);
}

/* The critically damped step from 1 to 3: 1 + 2 (1 - (1 + w t) e^(-w t)), and its slope 2 w^2 t e^(-w t), at w t = 1.
 */
static void a_step_is_followed_exactly(void)
{
    const gw_rate_filter_constants_t constants = made(R(200.0));
    gw_lowpass_t filter = restarted();
    (void)step(&filter, &constants, GW_ONE);
    for (uint32_t i = 0U; i < 5U; i++) {
        (void)step(&filter, &constants, R(3.0));
    }
    CHECK_NEAR(filter.value, GW_ONE + (GW_TWO * R(0.26424111765711536)), R(3.0) * ROUNDING);
    CHECK_NEAR(filter.derivative, R(400.0) * R(0.36787944117144232), R(400.0) * ROUNDING);
}

/* Terms of one balance stay aligned: this filter and that of the rates answer the same input with the same bits. */
static void it_is_the_filter_of_the_rates(void)
{
    const gw_rate_filter_constants_t constants = made(R(300.0));
    gw_lowpass_t filter = restarted();
    gw_rate_filter_t rate;
    int32_t count = 0;
    gw_rate_filter_restart(&rate);
    gw_rate_filter_step(&rate, &constants, count, GW_ZERO);
    (void)step(&filter, &constants, GW_ZERO);
    for (int32_t i = 0; i < 200; i++) {
        const int32_t counts = ((i * 37) % 101) - 50;
        const gw_real_t input = gw_rate_filter_turned(&constants, counts, GW_ZERO) / PERIOD;
        count += counts;
        unit_row((uint32_t)i);
        gw_rate_filter_step(&rate, &constants, count, GW_ZERO);
        CHECK(step(&filter, &constants, input) == rate.rate_radps);
        CHECK(filter.derivative == rate.derivative_radps2);
    }
}

static void whatever_comes_stays_within_the_limits(void)
{
    const gw_rate_filter_constants_t constants = made(R(10000.0));
    const struct {
        gw_real_t input;
        gw_real_t first;
    } rows[] = {
        {unit_above(LIMIT), LIMIT},
        {-unit_above(LIMIT), -LIMIT},
        {unit_infinity(), LIMIT},
        {-unit_infinity(), -LIMIT},
        {unit_nan(), -LIMIT},
        {LIMIT, LIMIT},
        {unit_below(LIMIT), unit_below(LIMIT)},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        gw_lowpass_t filter = restarted();
        unit_row(i);
        CHECK(step(&filter, &constants, rows[i].input) == rows[i].first);
        for (uint32_t k = 0U; k < UNIT_COUNT_OF(rows); k++) {
            (void)step(&filter, &constants, rows[k].input);
        }
    }
    gw_lowpass_t fast = {R(-100.0), GW_RATE_DERIVATIVE_MAX, true};
    for (uint32_t i = 0U; i < 5U; i++) {
        (void)step(&fast, &constants, R(1.0e9));
    }
}

static void the_invariant_sees_every_member(void)
{
    const gw_lowpass_t rows[] = {
        {unit_above(LIMIT), GW_ZERO, true},
        {unit_nan(), GW_ZERO, true},
        {GW_ZERO, unit_above(GW_RATE_DERIVATIVE_MAX), true},
        {GW_ZERO, unit_nan(), false},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        unit_row(i);
        CHECK(!gw_lowpass_invariant_holds(&rows[i], LIMIT));
    }
}

void suite_lowpass(void)
{
    unit_run("it_starts_at_its_first_input", it_starts_at_its_first_input);
    unit_run("a_step_is_followed_exactly", a_step_is_followed_exactly);
    unit_run("it_is_the_filter_of_the_rates", it_is_the_filter_of_the_rates);
    unit_run("whatever_comes_stays_within_the_limits", whatever_comes_stays_within_the_limits);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
}
