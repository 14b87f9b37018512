#include "unit.h"

#define PERIOD R(0.001)

/* A speed that counts as none, m/s. */
#define STILL R(0.000001)

static const gw_vector_t nothing = {R(0.0), R(0.0)};
static const gw_vector_t along_x = {R(1.0), R(0.0)};

/* M = 2 kg, B = 1.6 N s/m, p = 0.8 N s: the escape is p/B = 0.5 m. */
static gw_admittance_config_t config(uint32_t kind)
{
    gw_admittance_config_t made;
    gw_admittance_config_trikey(&made);
    made.kind = kind;
    made.mass_kg = R(2.0);
    made.damping_newton_s_per_m = R(1.6);
    made.escape_impulse_newton_s = R(0.8);
    made.speed_limit_mps = R(0.5);
    made.acceleration_limit_mps2 = R(2.8);
    made.finish_speed_mps = R(0.01);
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
    const gw_vector_t before = (admittance->config.kind == GW_ADMITTANCE_ESCAPE)
                                   ? admittance->smooth_mps[GW_SMOOTH_COUNT - 1U]
                                   : admittance->velocity_mps;
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

/* Numbers from -1 to 1, the same everywhere. */
static gw_real_t draw(uint32_t *seed)
{
    *seed = (*seed * 1664525U) + 1013904223U;
    return ((gw_real_t)(*seed >> 8U) / R(8388608.0)) - GW_ONE;
}

static gw_vector_t draw_unit(uint32_t *seed)
{
    const gw_rotation_t rotation = gw_sincos(GW_PI * draw(seed));
    const gw_vector_t unit = {rotation.cosine, rotation.sine};
    return unit;
}

static gw_real_t dot(gw_vector_t a, gw_vector_t b)
{
    return (a.x * b.x) + (a.y * b.y);
}

static gw_tip_t tip_of(gw_real_t share)
{
    gw_geometry_config_t geometry;
    gw_kinematics_t kinematics;
    gw_tip_config_t from;
    gw_tip_t tip;
    gw_geometry_config_trikey(&geometry);
    CHECK_STATUS(gw_kinematics_init(&kinematics, &geometry), GW_STATUS_OK);
    gw_tip_config_trikey(&from);
    from.height_m = R(0.414);
    from.share = share;
    gw_tip_init(&tip, &from, &kinematics);
    return tip;
}

/* An escape from any velocity, in any direction, with any yaw and margin. */
static gw_admittance_t drawn_escape(uint32_t *seed)
{
    gw_admittance_config_t from = config(GW_ADMITTANCE_ESCAPE);
    from.smoothing_s = gw_max(R(0.04) * draw(seed), GW_ZERO); /* half of them have none */
    gw_admittance_t admittance = of_config(&from);
    const gw_tip_t tip = tip_of(R(0.55) + (R(0.45) * draw(seed)));
    gw_admittance_set_tip(&admittance, &tip);
    gw_admittance_face(&admittance, gw_sincos(GW_PI * draw(seed)));
    const gw_vector_t heading = draw_unit(seed);
    const gw_real_t speed_mps = R(0.25) + (R(0.25) * draw(seed));
    const gw_vector_t velocity = {speed_mps * heading.x, speed_mps * heading.y};
    CHECK_STATUS(gw_admittance_start(&admittance, velocity, draw_unit(seed)), GW_STATUS_OK);
    return admittance;
}

/* One step. The velocity away from the push is not negative, or does not fall while it is: it is being braked. No wheel
 * loses more than the margin. */
static gw_admittance_output_t escape_step(gw_admittance_t *admittance)
{
    const gw_vector_t before = admittance->smooth_mps[GW_SMOOTH_COUNT - 1U];
    const gw_admittance_output_t output = step(admittance, nothing);
    const gw_vector_t change = {output.velocity_mps.x - before.x, output.velocity_mps.y - before.y};
    const gw_vector_t in_base = gw_rotate_back(admittance->yaw, change);
    CHECK(dot(output.velocity_mps, admittance->away) >= (gw_min(dot(before, admittance->away), GW_ZERO) - ULP));
    const gw_vector_t *const to = admittance->tip.radial;
    const gw_vector_t towards[GW_WHEEL_COUNT] = {to[0], to[1], {-(to[0].x + to[1].x), -(to[0].y + to[1].y)}};
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        CHECK(dot(in_base, towards[i]) <= ((admittance->tip.margin_mps2 * PERIOD) + ROUNDING));
    }
    return output;
}

static void an_escape_never_goes_against_the_push(void)
{
    uint32_t seed = 1U;
    for (uint32_t i = 0U; i < 100U; i++) {
        gw_admittance_t admittance = drawn_escape(&seed);
        unit_row(i);
        /* A sharper direction at every tick of the first 60, anywhere around the first; once more in the middle. */
        const gw_vector_t first = admittance.away;
        for (uint32_t tick = 0U; tick < 1500U; tick++) {
            if ((tick < 60U) || (tick == 300U)) {
                const gw_vector_t other = draw_unit(&seed);
                const gw_vector_t sum = {first.x + (R(0.9) * other.x), first.y + (R(0.9) * other.y)};
                const gw_vector_t before = admittance.smooth_mps[GW_SMOOTH_COUNT - 1U];
                gw_admittance_redirect(&admittance, gw_unit(sum.x, sum.y, gw_length(sum)));
                CHECK(dot(admittance.velocity_mps, admittance.away) >=
                      (gw_min(dot(before, admittance.away), GW_ZERO) - ROUNDING));
            }
            (void)escape_step(&admittance);
        }
    }
}

/* 59 degrees are taken, 61 are not: a robot that feels its own braking does not turn round. Other kinds take all. */
static void an_escape_does_not_follow_a_contradiction(void)
{
    for (uint32_t kind = GW_ADMITTANCE_FROZEN_IMPULSE; kind <= GW_ADMITTANCE_ESCAPE; kind++) {
        for (uint32_t degree = 59U; degree <= 61U; degree += 2U) {
            const gw_rotation_t rotation = gw_sincos((gw_real_t)degree * (GW_PI / R(180.0)));
            const gw_vector_t other = {rotation.cosine, -rotation.sine};
            const bool taken = (kind != GW_ADMITTANCE_ESCAPE) || (degree < 60U);
            gw_admittance_t admittance = made(kind);
            unit_row((100U * kind) + degree);
            CHECK_STATUS(gw_admittance_start(&admittance, nothing, along_x), GW_STATUS_OK);
            gw_admittance_redirect(&admittance, other);
            CHECK_NEAR(admittance.goal_m.y, taken ? (GW_HALF * other.y) : GW_ZERO, ULP);
            CHECK_NEAR(admittance.away.x, taken ? other.x : GW_ONE, ULP);
        }
    }
}

/* A robot that may lean takes every direction: what its body did first is not what pushes it. */
static void an_escape_that_may_lean_follows_every_direction(void)
{
    for (uint32_t degree = 61U; degree <= 181U; degree += 60U) {
        const gw_rotation_t rotation = gw_sincos((gw_real_t)degree * (GW_PI / R(180.0)));
        const gw_vector_t other = {rotation.cosine, -rotation.sine};
        const gw_tip_t tip = tip_of(GW_HALF);
        gw_admittance_t admittance = made(GW_ADMITTANCE_ESCAPE);
        unit_row(degree);
        gw_admittance_set_tip(&admittance, &tip);
        CHECK_STATUS(gw_admittance_start(&admittance, nothing, along_x), GW_STATUS_OK);
        gw_admittance_redirect(&admittance, other);
        CHECK_NEAR(admittance.goal_m.y, GW_HALF * other.y, ULP);
        CHECK_NEAR(admittance.away.x, other.x, ULP);
    }
}

/* It comes to rest, after p/B or where it could stop, and stays there. */
static void an_escape_comes_to_rest_and_holds(void)
{
    uint32_t seed = 2U;
    for (uint32_t i = 0U; i < 20U; i++) {
        gw_admittance_t admittance = drawn_escape(&seed);
        const gw_vector_t velocity = admittance.velocity_mps;
        const gw_real_t lag_s = GW_TWO * admittance.config.smoothing_s;
        gw_vector_t moved = nothing;
        unit_row(i);
        for (uint32_t tick = 0U; tick < 12000U; tick++) {
            const gw_admittance_output_t output = escape_step(&admittance);
            moved.x += output.displacement_m.x;
            moved.y += output.displacement_m.y;
        }
        /* Low-passes that start with a velocity are behind by their time: the goal is moved by as much. */
        const gw_vector_t left = {moved.x - (lag_s * velocity.x), moved.y - (lag_s * velocity.y)};
        CHECK(dot(left, admittance.away) >= R(0.499));
        CHECK_NEAR(dot(left, admittance.away), GW_HALF, R(0.1)); /* some could not stop before: at most 0.5 m/s */
        for (uint32_t tick = 0U; tick < 1000U; tick++) {
            const gw_admittance_output_t output = escape_step(&admittance);
            CHECK((output.velocity_mps.x == GW_ZERO) && (output.velocity_mps.y == GW_ZERO));
            CHECK((output.displacement_m.x == GW_ZERO) && (output.displacement_m.y == GW_ZERO));
        }
    }
}

/* Too fast to stop at the goal: it stops behind it, where a frozen impulse comes back. */
static void pass_the_goal(uint32_t kind, gw_vector_t away)
{
    gw_admittance_config_t from = config(kind);
    gw_real_t moved = GW_ZERO;
    gw_real_t least_mps = GW_ONE;
    const gw_vector_t fast = {R(0.4) * away.x, R(0.4) * away.y};
    from.acceleration_limit_mps2 = R(0.1);
    gw_admittance_t admittance = of_config(&from);
    CHECK_STATUS(gw_admittance_start(&admittance, fast, away), GW_STATUS_OK);
    for (uint32_t tick = 0U; tick < 30000U; tick++) {
        const gw_admittance_output_t output = step(&admittance, nothing);
        moved += dot(output.displacement_m, away);
        least_mps = gw_min(least_mps, dot(output.velocity_mps, away));
    }
    if (kind == GW_ADMITTANCE_ESCAPE) {
        CHECK_NEAR(moved, R(0.8), R(0.002)); /* v^2/2a */
        CHECK(least_mps >= -(ULP / PERIOD)); /* the goal is known to a rounding, in a tick */
    } else {
        CHECK_NEAR(moved, R(0.5), R(0.001));
        CHECK(least_mps < R(-0.01));
    }
}

static void a_goal_that_was_passed_is_given_up(void)
{
    const gw_vector_t oblique = {R(0.6), R(-0.8)};
    for (uint32_t kind = GW_ADMITTANCE_FROZEN_IMPULSE; kind <= GW_ADMITTANCE_ESCAPE; kind += GW_ADMITTANCE_ESCAPE) {
        pass_the_goal(kind, along_x);
        pass_the_goal(kind, oblique);
    }
}

/* The settings that an escape needs are those of who chooses one. */
static void there_is_no_escape_by_default(void)
{
    gw_admittance_config_t trikey;
    gw_admittance_config_trikey(&trikey);
    CHECK((trikey.smoothing_s == GW_ZERO) && (trikey.brake_limit_mps2 == GW_ZERO) && (trikey.lead_s == GW_ZERO) &&
          (trikey.push_share == GW_ZERO) && (trikey.ahead_mps == GW_ZERO) && (trikey.tip.height_m == GW_ZERO));
}

/* At rest, hit along y: the low-passes delay the start by their time, and nothing else. */
static void low_passes_delay_by_their_time(void)
{
    gw_admittance_config_t from = config(GW_ADMITTANCE_ESCAPE);
    gw_admittance_t sharp = of_config(&from);
    from.smoothing_s = R(0.03);
    gw_admittance_t smooth = of_config(&from);
    const gw_vector_t along_y = {R(0.0), R(1.0)};
    gw_real_t first = GW_ZERO;
    gw_real_t second = GW_ZERO;
    CHECK_STATUS(gw_admittance_start(&sharp, nothing, along_y), GW_STATUS_OK);
    CHECK_STATUS(gw_admittance_start(&smooth, nothing, along_y), GW_STATUS_OK);
    for (uint32_t tick = 0U; tick < 130U; tick++) {
        const gw_admittance_output_t output = step(&smooth, nothing);
        first += step(&sharp, nothing).displacement_m.y;
        second += output.displacement_m.y;
        if (tick == 0U) {
            CHECK(output.velocity_mps.y < (R(0.01) * sharp.velocity_mps.y));
        }
    }
    /* 2.8 m/s^2 all the time: 60 ms behind, and what the start of the low-passes leaves: at^2/2 - 2 tau at + 3 tau^2 a,
     * but for a tail of e^-4.3. */
    CHECK_NEAR(first - second, R(2.8) * ((R(0.06) * R(0.13)) - (R(3.0) * R(0.0009))), R(0.001));
}

/* Towards what pushes, brakes at once; not beyond standing, and no other kind. */
static void a_velocity_towards_a_push_is_braked_harder(void)
{
    const struct {
        uint32_t kind;
        gw_real_t speed;
        gw_real_t expected;
    } rows[] = {
        {GW_ADMITTANCE_ESCAPE, R(-0.3), R(-0.296)},
        {GW_ADMITTANCE_ESCAPE, R(-0.003), R(0.0)}, /* stands, does not jump */
        {GW_ADMITTANCE_ESCAPE, R(0.1), R(0.1)},    /* gives way already */
        {GW_ADMITTANCE_FROZEN_IMPULSE, R(-0.3), R(-0.3)},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        const gw_vector_t velocity = {rows[i].speed, R(0.0)};
        gw_admittance_config_t from = config(rows[i].kind);
        from.brake_limit_mps2 = R(4.0);
        gw_admittance_t admittance = of_config(&from);
        unit_row(i);
        CHECK_STATUS(gw_admittance_start(&admittance, velocity, along_x), GW_STATUS_OK);
        gw_admittance_brake(&admittance);
        CHECK_NEAR(admittance.velocity_mps.x, rows[i].expected, ULP);
        CHECK(admittance.velocity_mps.y == GW_ZERO);
        for (uint32_t k = 0U; k < GW_SMOOTH_COUNT; k++) {
            CHECK_NEAR(admittance.smooth_mps[k].x, rows[i].expected, ULP);
        }
    }
}

/* What is felt above the floor, over the mass, accelerates away from the push behind the first low-pass: at most the
 * limit, to the speed of (2) and the longest one; no other kind. p/B 0.8/s = 0.4 m/s. */
static void a_push_helps_to_give_way(void)
{
    const struct {
        uint32_t kind;
        gw_real_t force_n;
        gw_real_t speed;
        gw_real_t speed_limit;
        gw_real_t gain;
    } rows[] = {
        {GW_ADMITTANCE_ESCAPE, R(25.0), R(0.0), R(0.5), R(0.001)}, /* 1.5 (25 N - 5 N)/30 kg */
        {GW_ADMITTANCE_ESCAPE, R(5.0), R(0.0), R(0.5), R(0.0)},
        {GW_ADMITTANCE_ESCAPE, R(-25.0), R(0.0), R(0.5), R(0.0)},
        {GW_ADMITTANCE_ESCAPE, R(200.0), R(0.0), R(0.5), R(0.0028)},
        {GW_ADMITTANCE_ESCAPE, R(25.0), R(-0.2), R(0.5), R(0.001)},
        {GW_ADMITTANCE_ESCAPE, R(25.0), R(0.3995), R(0.5), R(0.0005)},
        {GW_ADMITTANCE_ESCAPE, R(25.0), R(0.45), R(0.5), R(0.0)}, /* is not braked */
        {GW_ADMITTANCE_ESCAPE, R(25.0), R(0.2995), R(0.3), R(0.0005)},
        {GW_ADMITTANCE_FROZEN_IMPULSE, R(25.0), R(0.0), R(0.5), R(0.0)},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        const gw_vector_t velocity = {rows[i].speed, R(0.0)};
        const gw_vector_t force = {rows[i].force_n, R(100.0)}; /* the part across does nothing */
        gw_admittance_config_t from = config(rows[i].kind);
        from.push_share = R(1.5);
        from.speed_limit_mps = rows[i].speed_limit;
        gw_admittance_t admittance = of_config(&from);
        unit_row(i);
        CHECK_STATUS(gw_admittance_start(&admittance, velocity, along_x), GW_STATUS_OK);
        gw_admittance_yield(&admittance, force, R(5.0), R(30.0), nothing);
        CHECK_NEAR(admittance.velocity_mps.x, rows[i].speed + rows[i].gain, ULP);
        CHECK(admittance.velocity_mps.y == GW_ZERO);
        CHECK_NEAR(admittance.smooth_mps[0].x, rows[i].speed + rows[i].gain, ULP);
        CHECK(admittance.smooth_mps[1].x == rows[i].speed);
    }
}

/* What does not feel the push any more is at most so much faster than the robot, as soon as its brake allows; across it
 * nothing is held back. */
static void an_escape_waits_for_the_robot(void)
{
    const gw_real_t any = GW_ONE / PERIOD; /* 1 m/s in a tick, more than any row asks for */
    const struct {
        uint32_t kind;
        gw_real_t force_n;
        gw_real_t ahead; /* m/s, as all that follows, along the push */
        gw_real_t robot;
        gw_real_t speed;
        gw_real_t brake; /* m/s^2 */
        gw_real_t left;
    } rows[] = {
        {GW_ADMITTANCE_ESCAPE, R(0.0), R(0.04), R(0.1), R(0.3), any, R(0.14)},
        {GW_ADMITTANCE_ESCAPE, R(5.0), R(0.04), R(0.1), R(0.3), any, R(0.14)}, /* not above the floor */
        {GW_ADMITTANCE_ESCAPE, R(6.0), R(0.04), R(0.1), R(0.3), any, R(0.3)},
        {GW_ADMITTANCE_ESCAPE, R(0.0), R(0.04), R(0.1), R(0.13), any, R(0.13)}, /* is not hurried */
        {GW_ADMITTANCE_ESCAPE, R(0.0), R(0.04), R(-0.2), R(0.3), any, R(0.04)}, /* it still moves towards the push */
        {GW_ADMITTANCE_ESCAPE, R(0.0), R(0.04), R(-0.2), R(-0.3), any, R(-0.3)},
        {GW_ADMITTANCE_ESCAPE, R(0.0), R(0.0), R(0.1), R(0.3), any, R(0.3)},
        {GW_ADMITTANCE_ESCAPE, R(0.0), R(0.04), R(0.1), R(0.3), R(5.0), R(0.3) - (R(5.0) * PERIOD)},
        {GW_ADMITTANCE_ESCAPE, R(0.0), R(0.04), R(0.1), R(0.3), R(0.0), R(0.3)},
        {GW_ADMITTANCE_FROZEN_IMPULSE, R(0.0), R(0.04), R(0.1), R(0.3), any, R(0.3)},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        const gw_vector_t velocity = {rows[i].speed, R(0.2)};
        const gw_vector_t felt = {rows[i].force_n, R(100.0)};
        const gw_vector_t robot = {rows[i].robot, R(-0.5)};
        gw_admittance_config_t from = config(rows[i].kind);
        from.ahead_mps = rows[i].ahead;
        from.brake_limit_mps2 = rows[i].brake;
        gw_admittance_t admittance = of_config(&from);
        unit_row(i);
        CHECK_STATUS(gw_admittance_start(&admittance, velocity, along_x), GW_STATUS_OK);
        gw_admittance_yield(&admittance, felt, R(5.0), R(30.0), robot);
        CHECK_NEAR(admittance.velocity_mps.x, rows[i].left, ULP);
        CHECK(admittance.velocity_mps.y == R(0.2));
        for (uint32_t k = 0U; k < GW_SMOOTH_COUNT; k++) {
            CHECK_NEAR(admittance.smooth_mps[k].x, rows[i].left, ULP);
            CHECK(admittance.smooth_mps[k].y == R(0.2));
        }
    }
}

/* The margin limits every kind of reaction. */
static void no_kind_lifts_a_wheel(void)
{
    const gw_tip_t tip = tip_of(GW_HALF);
    for (uint32_t kind = GW_ADMITTANCE_FROZEN_IMPULSE; kind <= GW_ADMITTANCE_ESCAPE; kind++) {
        gw_admittance_t admittance = made(kind);
        const gw_vector_t force = {R(100.0), R(0.0)};
        gw_admittance_set_tip(&admittance, &tip);
        CHECK_STATUS(gw_admittance_start(&admittance, nothing, along_x), GW_STATUS_OK);
        unit_row(kind);
        CHECK_NEAR(step(&admittance, force).velocity_mps.x, tip.margin_mps2 * PERIOD, ROUNDING);
        /* Half a turn, and the robot accelerates away from the wheel. */
        gw_admittance_face(&admittance, gw_sincos(GW_PI));
        CHECK_NEAR(step(&admittance, force).velocity_mps.x, R(3.0) * tip.margin_mps2 * PERIOD, ROUNDING);
    }
}

static void the_invariant_sees_every_member(void)
{
    const gw_admittance_t good = made(GW_ADMITTANCE_FROZEN_IMPULSE);
    gw_admittance_t bad[23];
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
    bad[13].tip.margin_mps2 = unit_nan();
    bad[14].yaw.cosine = unit_above(GW_ONE);
    bad[15].yaw.sine = unit_nan();
    bad[16].away.x = unit_above(GW_TWO);
    bad[17].away.y = unit_nan();
    bad[18].smooth_share = unit_above(GW_ONE);
    bad[19].smooth_mps[0].x = unit_nan();
    bad[21].first.x = unit_nan();
    bad[22].first.y = unit_above(GW_TWO);
    bad[20].smooth_mps[1].y = unit_above(R(100.0));
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
    unit_run("an_escape_never_goes_against_the_push", an_escape_never_goes_against_the_push);
    unit_run("an_escape_does_not_follow_a_contradiction", an_escape_does_not_follow_a_contradiction);
    unit_run("an_escape_that_may_lean_follows_every_direction", an_escape_that_may_lean_follows_every_direction);
    unit_run("an_escape_comes_to_rest_and_holds", an_escape_comes_to_rest_and_holds);
    unit_run("a_goal_that_was_passed_is_given_up", a_goal_that_was_passed_is_given_up);
    unit_run("there_is_no_escape_by_default", there_is_no_escape_by_default);
    unit_run("low_passes_delay_by_their_time", low_passes_delay_by_their_time);
    unit_run("a_velocity_towards_a_push_is_braked_harder", a_velocity_towards_a_push_is_braked_harder);
    unit_run("a_push_helps_to_give_way", a_push_helps_to_give_way);
    unit_run("an_escape_waits_for_the_robot", an_escape_waits_for_the_robot);
    unit_run("no_kind_lifts_a_wheel", no_kind_lifts_a_wheel);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
}
