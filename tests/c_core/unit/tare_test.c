#include "unit.h"

static gw_wheels_t torques(gw_real_t value)
{
    const gw_wheels_t all = {{value, value + R(1.0), value - R(1.0)}};
    return all;
}

static void the_mean_of_a_quiet_while_is_the_zero(void)
{
    gw_tare_t tare;
    gw_wheels_t mean = {{R(9.0), R(9.0), R(9.0)}};
    gw_tare_start(&tare);
    CHECK(gw_tare_invariant_holds(&tare));
    for (uint32_t i = 0U; i < 4U; i++) {
        const gw_wheels_t sample = torques(((i & 1U) == 0U) ? R(0.25) : R(0.75));
        const gw_tare_progress_t progress = gw_tare_add(&tare, &sample, 4U, R(0.5), &mean);
        unit_row(i);
        CHECK(progress == ((i == 3U) ? GW_TARE_DONE : GW_TARE_RUNNING));
        CHECK(mean.wheel[0] == ((i == 3U) ? R(0.5) : R(9.0)));
        CHECK(gw_tare_invariant_holds(&tare));
    }
    CHECK((mean.wheel[1] == R(1.5)) && (mean.wheel[2] == R(-0.5)));
    CHECK(tare.count == 0U);
}

static void a_varying_torque_starts_it_anew(void)
{
    const uint32_t wheels = GW_WHEEL_COUNT;
    for (uint32_t i = 0U; i < wheels; i++) {
        gw_tare_t tare;
        gw_wheels_t mean = {{R(9.0), R(9.0), R(9.0)}};
        gw_wheels_t sample = torques(R(0.25));
        unit_row(i);
        gw_tare_start(&tare);
        CHECK(gw_tare_add(&tare, &sample, 2U, R(0.5), &mean) == GW_TARE_RUNNING);
        sample.wheel[i] += unit_above(R(0.5));
        CHECK(gw_tare_add(&tare, &sample, 2U, R(0.49), &mean) == GW_TARE_REFUSED);
        CHECK(mean.wheel[0] == R(9.0));
        CHECK(tare.count == 0U);
        CHECK(gw_tare_invariant_holds(&tare));
    }
}

static void the_invariant_sees_every_member(void)
{
    const gw_wheels_t sample = torques(R(0.25));
    gw_wheels_t mean;
    gw_tare_t tare;
    CHECK(!gw_tare_invariant_holds(NULL));
    gw_tare_start(&tare);
    tare.sum_nm[1].value = unit_nan();
    CHECK(!gw_tare_invariant_holds(&tare));
    gw_tare_start(&tare);
    CHECK(gw_tare_add(&tare, &sample, 2U, R(0.5), &mean) == GW_TARE_RUNNING);
    tare.lowest_nm[0] = R(100.0);
    CHECK(!gw_tare_invariant_holds(&tare));
}

void suite_tare(void)
{
    unit_run("the_mean_of_a_quiet_while_is_the_zero", the_mean_of_a_quiet_while_is_the_zero);
    unit_run("a_varying_torque_starts_it_anew", a_varying_torque_starts_it_anew);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
}
