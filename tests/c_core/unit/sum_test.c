#include "unit.h"

/* 1e5 times a tenth of an ulp: a plain sum would not move at all. */
static void small_increments_are_not_lost(void)
{
    const gw_real_t increment = R(0.1) * ULP;
    gw_sum_t sum = gw_sum_of(R(1.0));
    gw_real_t plain = R(1.0);
    for (uint32_t i = 0U; i < 100000U; i++) {
        sum = gw_sum_add(sum, increment);
        plain += increment;
    }
    CHECK(plain == R(1.0));
    CHECK_NEAR(sum.value, R(1.0) + (R(1.0e5) * increment), R(2.0) * ULP);
    CHECK(gw_sum_invariant_holds(sum));
    CHECK_NEAR(gw_sum_subtract_from(sum.value, sum), sum.excess, R(0.0));
}

static void angles_stay_within_half_a_turn(void)
{
    const gw_real_t steps[] = {R(2.0), R(-2.0), R(7.0), R(0.001)};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(steps); i++) {
        gw_sum_t sum = gw_sum_of(GW_ZERO);
        unit_row(i);
        for (uint32_t k = 0U; k < 1000U; k++) {
            sum = gw_sum_add_angle(sum, steps[i]);
            CHECK((sum.value >= -GW_PI) && (sum.value < GW_PI));
            CHECK(gw_sum_invariant_holds(sum));
        }
        /* The thousand steps at once, wrapped: the product is exact to an ulp of itself. */
        CHECK_NEAR(gw_wrap_angle(sum.value - gw_wrap_angle(R(1000.0) * steps[i])), GW_ZERO, R(7000.0) * ULP);
    }
}

/* Half a turn is -pi, from either side. */
static void half_a_turn_has_one_name(void)
{
    CHECK(gw_sum_add_angle(gw_sum_of(GW_PI), GW_ZERO).value == -GW_PI);
    CHECK(gw_sum_add_angle(gw_sum_of(-GW_PI), GW_ZERO).value == -GW_PI);
}

/* The invariant allows any excess within 1024, although no sum of angles reaches it: the result is still an angle. */
static void any_excess_leaves_an_angle(void)
{
    const gw_sum_t low = {GW_ONE, R(-1024.0)};
    const gw_sum_t high = {-GW_ONE, R(1024.0)};
    CHECK(gw_sum_invariant_holds(low) && gw_sum_invariant_holds(high));
    CHECK(gw_sum_add_angle(low, GW_ZERO).value == GW_PI);
    CHECK(gw_sum_add_angle(high, GW_ZERO).value == -GW_PI);
}

static void a_limited_sum_stays_within(void)
{
    CHECK(gw_sum_limit(gw_sum_of(R(5.0)), R(2.0)).value == R(2.0));
    CHECK(gw_sum_limit(gw_sum_of(R(-5.0)), R(2.0)).value == R(-2.0));
    CHECK(gw_sum_limit(gw_sum_of(R(1.0)), R(2.0)).value == R(1.0));
}

static void a_sum_that_is_not_finite_is_none(void)
{
    const gw_sum_t most = {GW_REAL_MAX, R(1024.0)};
    const gw_sum_t least = {-GW_REAL_MAX, R(-1024.0)};
    const gw_sum_t rows[] = {
        {unit_nan(), R(0.0)}, {R(0.0), unit_infinity()}, {R(0.0), unit_above(R(1024.0))}, {unit_infinity(), R(0.0)}};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        unit_row(i);
        CHECK(!gw_sum_invariant_holds(rows[i]));
    }
    CHECK(gw_sum_invariant_holds(most) && gw_sum_invariant_holds(least));
}

void suite_sum(void)
{
    unit_run("small_increments_are_not_lost", small_increments_are_not_lost);
    unit_run("angles_stay_within_half_a_turn", angles_stay_within_half_a_turn);
    unit_run("half_a_turn_has_one_name", half_a_turn_has_one_name);
    unit_run("any_excess_leaves_an_angle", any_excess_leaves_an_angle);
    unit_run("a_limited_sum_stays_within", a_limited_sum_stays_within);
    unit_run("a_sum_that_is_not_finite_is_none", a_sum_that_is_not_finite_is_none);
}
