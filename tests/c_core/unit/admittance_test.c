#include "unit.h"

#define PERIOD R(0.001)

static const gw_vector_t nothing = {R(0.0), R(0.0)};
static const gw_vector_t along_x = {R(1.0), R(0.0)};

/* M = 2 kg, B = 1.6 N s/m, p = 0.8 N s: the escape is p/B = 0.5 m. */
static gw_admittance_config_t config(uint32_t kind)
{
    const gw_admittance_config_t made = {kind, R(2.0), R(1.6), R(0.8), R(0.5), R(2.8), R(0.01)};
    return made;
}

static gw_admittance_t of_config(const gw_admittance_config_t *from)
{
    gw_admittance_t admittance;
    CHECK_STATUS(gw_admittance_init(&admittance, from, PERIOD), GW_STATUS_OK);
    CHECK(gw_admittance_invariant_holds(&admittance));
    return admittance;
}

static gw_admittance_t made(uint32_t kind)
{
    const gw_admittance_config_t from = config(kind);
    return of_config(&from);
}

/* One step; the limits of speed and acceleration hold to a few roundings. */
static gw_admittance_output_t step(gw_admittance_t *admittance, gw_vector_t force)
{
    const gw_vector_t before = admittance->velocity_mps;
    gw_admittance_output_t output;
    CHECK_STATUS(gw_admittance_step(admittance, force, &output), GW_STATUS_OK);
    CHECK(gw_admittance_invariant_holds(admittance));
    const gw_vector_t change = {output.velocity_mps.x - before.x, output.velocity_mps.y - before.y};
    CHECK(gw_length(output.velocity_mps) <= (gw_max(gw_length(before), R(0.5)) + ROUNDING));
    CHECK(gw_length(change) <= ((admittance->config.acceleration_limit_mps2 * PERIOD) + ROUNDING));
    return output;
}

static void bad_arguments_are_refused(void)
{
    const gw_admittance_config_t good = config(GW_ADMITTANCE_FROZEN_IMPULSE);
    gw_admittance_t admittance = made(GW_ADMITTANCE_FROZEN_IMPULSE);
    gw_admittance_output_t output;
    CHECK_STATUS(gw_admittance_init(NULL, &good, PERIOD), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_admittance_init(&admittance, NULL, PERIOD), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_admittance_start(NULL, nothing, along_x), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_admittance_step(NULL, nothing, &output), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_admittance_step(&admittance, nothing, NULL), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_admittance_init(&admittance, &good, GW_ONE), GW_STATUS_CONFIG_INVALID);
    CHECK_STATUS(gw_admittance_start(&admittance, nothing, along_x), GW_STATUS_NOT_INITIALISED);
    CHECK_STATUS(gw_admittance_step(&admittance, nothing, &output), GW_STATUS_NOT_INITIALISED);
    CHECK((output.velocity_mps.x == GW_ZERO) && (output.displacement_m.x == GW_ZERO));
}

/* Whatever the limits, the escape ends at exactly p/B, at rest. */
static void the_frozen_impulse_ends_at_p_over_b(void)
{
    const struct {
        gw_real_t speed_limit;
        gw_real_t acceleration_limit;
        gw_real_t finish_speed;
        gw_vector_t velocity;
    } rows[] = {
        {R(0.5), R(2.8), R(0.01), {R(0.0), R(0.0)}},    /* the paper's */
        {R(0.5), R(1000.0), R(0.01), {R(0.0), R(0.0)}}, /* (2) without limits, except at its end */
        {R(0.1), R(0.5), R(0.05), {R(0.0), R(0.3)}},    /* slow, and moving sideways when it is hit */
        {R(0.5), R(0.3), R(0.01), {R(-0.4), R(0.0)}},   /* moving against the push */
        {R(0.5), R(0.05), R(0.01), {R(0.4), R(0.0)}},   /* brakes too weakly: overshoots and comes back */
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        gw_admittance_config_t from = config(GW_ADMITTANCE_FROZEN_IMPULSE);
        gw_vector_t moved = nothing;
        from.speed_limit_mps = rows[i].speed_limit;
        from.acceleration_limit_mps2 = rows[i].acceleration_limit;
        from.finish_speed_mps = rows[i].finish_speed;
        gw_admittance_t admittance = of_config(&from);
        unit_row(i);
        CHECK_STATUS(gw_admittance_start(&admittance, rows[i].velocity, along_x), GW_STATUS_OK);
        /* At least 0.1 s, then until it stands. */
        for (uint32_t tick = 0U; (tick < 100U) || ((tick < 40000U) && (gw_length(admittance.velocity_mps) > GW_ZERO));
             tick++) {
            const gw_admittance_output_t output = step(&admittance, nothing);
            moved.x += output.displacement_m.x;
            moved.y += output.displacement_m.y;
        }
        /* The plain sum of some ten thousand displacements, each rounded at half a metre. */
        CHECK_NEAR(moved.x, R(0.5), R(1000.0) * ULP);
        CHECK_NEAR(moved.y, GW_ZERO, R(1000.0) * ULP);
        CHECK((admittance.velocity_mps.x == GW_ZERO) && (admittance.velocity_mps.y == GW_ZERO));
    }
}

/* Resumed after a stop: comes to rest where it is. */
static void nowhere_to_go_means_to_stop(void)
{
    gw_admittance_t admittance = made(GW_ADMITTANCE_FROZEN_IMPULSE);
    const gw_vector_t velocity = {R(0.028), R(0.0)};
    gw_real_t back = GW_ZERO;
    CHECK_STATUS(gw_admittance_start(&admittance, velocity, nothing), GW_STATUS_OK);
    for (uint32_t tick = 0U; tick < 1000U; tick++) {
        back += step(&admittance, nothing).displacement_m.x;
    }
    CHECK_NEAR(back, GW_ZERO, R(1000.0) * ULP);
    CHECK(admittance.velocity_mps.x == GW_ZERO);
}

/* (1): v goes to F/B as 1 - e^(-B t/M); after one time constant M/B = 1.25 s. */
static void the_live_force_is_that_of_1(void)
{
    gw_admittance_t admittance = made(GW_ADMITTANCE_LIVE_FORCE);
    const gw_vector_t force = {R(0.16), R(0.0)};
    gw_real_t moved = GW_ZERO;
    CHECK_STATUS(gw_admittance_start(&admittance, nothing, nothing), GW_STATUS_OK);
    for (uint32_t tick = 0U; tick < 1250U; tick++) {
        moved += step(&admittance, force).displacement_m.x;
    }
    CHECK_NEAR(admittance.velocity_mps.x, R(0.0632120558828557678), R(100.0) * ULP);
    CHECK_NEAR(moved, R(0.0459849301464303), R(100.0) * ULP); /* 0.1 * 1.25/e */
}

static void a_strong_live_force_meets_the_limits(void)
{
    gw_admittance_t admittance = made(GW_ADMITTANCE_LIVE_FORCE);
    const gw_vector_t force = {R(0.0), R(-100.0)};
    CHECK_STATUS(gw_admittance_start(&admittance, nothing, nothing), GW_STATUS_OK);
    for (uint32_t tick = 0U; tick < 1000U; tick++) {
        (void)step(&admittance, force);
    }
    CHECK_NEAR(admittance.velocity_mps.y, R(-0.5), ROUNDING);
    CHECK(admittance.velocity_mps.x == GW_ZERO);
}

static void what_is_not_finite_is_refused(void)
{
    const struct {
        gw_vector_t velocity;
        gw_vector_t direction;
    } starts[] = {
        {{R(0.0), R(0.0)}, {unit_nan(), R(0.0)}}, {{R(0.0), R(0.0)}, {R(0.0), R(-1.02)}},
        {{R(0.0), R(0.0)}, {R(0.8), R(0.8)}},     {{unit_nan(), R(0.0)}, {R(1.0), R(0.0)}},
        {{R(0.0), R(101.0)}, {R(1.0), R(0.0)}},
    };
    const gw_vector_t forces[] = {{unit_nan(), R(0.0)}, {R(0.0), unit_infinity()}};
    gw_admittance_t admittance = made(GW_ADMITTANCE_LIVE_FORCE);
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(starts); i++) {
        unit_row(i);
        CHECK_STATUS(gw_admittance_start(&admittance, starts[i].velocity, starts[i].direction),
                     GW_STATUS_INPUT_INVALID);
        CHECK(admittance.goal_m.x == GW_ZERO);
    }
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(forces); i++) {
        gw_admittance_output_t output;
        unit_row(10U + i);
        CHECK_STATUS(gw_admittance_step(&admittance, forces[i], &output), GW_STATUS_INPUT_INVALID);
        CHECK((output.velocity_mps.x == GW_ZERO) && (output.displacement_m.y == GW_ZERO));
        CHECK(gw_admittance_invariant_holds(&admittance));
    }
}

/* A better direction in the middle of an escape: it ends where an escape in this direction would have ended. */
static void a_better_direction_leads_to_another_goal(void)
{
    const gw_vector_t better = {R(0.6), R(-0.8)};
    gw_admittance_t admittance = made(GW_ADMITTANCE_FROZEN_IMPULSE);
    gw_vector_t moved = nothing;
    CHECK_STATUS(gw_admittance_start(&admittance, nothing, along_x), GW_STATUS_OK);
    for (uint32_t tick = 0U; tick < 40000U; tick++) {
        const gw_admittance_output_t output = step(&admittance, nothing);
        moved.x += output.displacement_m.x;
        moved.y += output.displacement_m.y;
        if (tick == 60U) {
            CHECK(moved.x > R(0.001));
            gw_admittance_redirect(&admittance, better);
            CHECK(gw_admittance_invariant_holds(&admittance));
        }
    }
    /* Plain sums of some ten thousand displacements, as above. */
    CHECK_NEAR(moved.x, R(0.3), R(1000.0) * ULP);
    CHECK_NEAR(moved.y, R(-0.4), R(1000.0) * ULP);
    CHECK((admittance.velocity_mps.x == GW_ZERO) && (admittance.velocity_mps.y == GW_ZERO));
}

static void a_direction_that_is_none_keeps_the_invariant(void)
{
    const struct {
        gw_vector_t direction;
        gw_vector_t goal_m;
    } rows[] = {
        {{R(2.0), R(-2.0)}, {R(0.505), R(-0.505)}},
        {{unit_nan(), R(1.0)}, {R(-0.505), R(0.5)}},
        {{R(1.0), unit_infinity()}, {R(0.5), R(0.505)}},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        gw_admittance_t admittance = made(GW_ADMITTANCE_FROZEN_IMPULSE);
        unit_row(i);
        gw_admittance_redirect(&admittance, rows[i].direction);
        CHECK(gw_admittance_invariant_holds(&admittance));
        CHECK_NEAR(admittance.goal_m.x, rows[i].goal_m.x, ROUNDING);
        CHECK_NEAR(admittance.goal_m.y, rows[i].goal_m.y, ROUNDING);
    }
}

/* Rare states of an escape: the step has to stay within its limits in each. */
static void rare_states_keep_the_limits(void)
{
    const struct {
        gw_real_t goal;
        gw_real_t speed;
        gw_real_t acceleration_limit;
    } rows[] = {
        {R(0.5), R(0.4025), R(2.8)},      /* the exponential's mean is within reach, its end is not */
        {R(0.5), R(0.0), R(0.001)},       /* weak brakes: slower than the exponential from the start */
        {R(0.0001), R(0.4), R(2.8)},      /* too fast to stop at the goal */
        {R(0.000001), R(0.0025), R(2.8)}, /* arrives in this tick */
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        gw_admittance_t admittance = made(GW_ADMITTANCE_FROZEN_IMPULSE);
        unit_row(i);
        CHECK_STATUS(gw_admittance_start(&admittance, nothing, along_x), GW_STATUS_OK);
        admittance.goal_m.x = rows[i].goal;
        admittance.velocity_mps.x = rows[i].speed;
        admittance.config.acceleration_limit_mps2 = rows[i].acceleration_limit;
        CHECK_NEAR(step(&admittance, nothing).displacement_m.x, rows[i].speed * PERIOD,
                   (rows[i].acceleration_limit * PERIOD * PERIOD) + ROUNDING * PERIOD);
    }
}

static void the_invariant_sees_every_member(void)
{
    const gw_admittance_t good = made(GW_ADMITTANCE_FROZEN_IMPULSE);
    gw_admittance_t bad[13];
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(bad); i++) {
        bad[i] = good;
    }
    bad[0].initialised = false;
    bad[1].period_s = GW_ZERO;
    bad[2].decay = R(-0.1);
    bad[3].approach = R(1.1);
    bad[4].rate_per_s = unit_nan();
    bad[5].goal_m.x = unit_nan();
    bad[6].goal_m.y = R(2.0e5);
    bad[7].moved_x_m.value = unit_nan();
    bad[8].moved_y_m.excess = unit_nan();
    bad[9].velocity_mps.x = unit_above(R(100.0));
    bad[10].velocity_mps.y = unit_nan();
    bad[11].config.mass_kg = GW_ZERO;
    bad[12].decay = unit_above(GW_ONE);
    CHECK(!gw_admittance_invariant_holds(NULL));
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(bad); i++) {
        unit_row(i);
        CHECK(!gw_admittance_invariant_holds(&bad[i]));
    }
}

void suite_admittance(void)
{
    unit_run("bad_arguments_are_refused", bad_arguments_are_refused);
    unit_run("the_frozen_impulse_ends_at_p_over_b", the_frozen_impulse_ends_at_p_over_b);
    unit_run("nowhere_to_go_means_to_stop", nowhere_to_go_means_to_stop);
    unit_run("the_live_force_is_that_of_1", the_live_force_is_that_of_1);
    unit_run("a_strong_live_force_meets_the_limits", a_strong_live_force_meets_the_limits);
    unit_run("what_is_not_finite_is_refused", what_is_not_finite_is_refused);
    unit_run("a_better_direction_leads_to_another_goal", a_better_direction_leads_to_another_goal);
    unit_run("a_direction_that_is_none_keeps_the_invariant", a_direction_that_is_none_keeps_the_invariant);
    unit_run("rare_states_keep_the_limits", rare_states_keep_the_limits);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
}
