#include "unit.h"

#include "giveway/gw_ripple.h"

static gw_ripple_t ripple;

#define INTERVAL_S R(0.004)
#define STEPS 16U /* of 64 ms */
#define RISE R(0.039210560847676823)
#define GUESS2 R(0.16)
#define MOST2 R(0.44444444444444444) /* (5/3 0.4)^2 */

static void begin(void)
{
    gw_ripple_init(&ripple, R(0.4), INTERVAL_S);
    CHECK(gw_ripple_invariant_holds(&ripple));
}

/* So many steps in which the force is this share of the friction, squared, and a wheel turns by 0.004 rad. */
static void feel(uint32_t count, gw_real_t share2, bool reacting)
{
    for (uint32_t i = 0U; i < count; i++) {
        gw_ripple_follow(&ripple, R(0.004), share2 * R(1200.0), R(1200.0), reacting);
        gw_ripple_go_on(&ripple);
        CHECK(gw_ripple_invariant_holds(&ripple));
    }
}

static void a_robot_that_has_not_driven_may_have_any_rollers(void)
{
    begin();
    CHECK_NEAR(gw_ripple_variance(&ripple, false), GUESS2, ROUNDING);
    CHECK_NEAR(gw_ripple_variance(&ripple, true), GUESS2 * R(0.2), ROUNDING);
}

/* 0.99^100 of it is left after 0.4 rad. */
static void rollers_that_are_even_are_soon_known(void)
{
    begin();
    feel(100U, R(0.0249), false);
    CHECK_NEAR(gw_ripple_variance(&ripple, false), GUESS2 * R(0.36603234127322950), R(100.0) * ROUNDING);
    CHECK(ripple.felt2 == GW_ZERO);
    feel(2000U, GW_ZERO, true);
    CHECK(gw_ripple_variance(&ripple, false) < R(1.0e-6));
}

/* 100 times what is beyond 0.025, of the most; from one step to the next 1 - e^-0.04 of the way up and 1 - e^-0.008
 * down. */
static void rollers_that_are_uneven_are_doubted_longer(void)
{
    begin();
    feel(1U, R(0.03), false);
    CHECK_NEAR(ripple.felt2, RISE * (R(0.5) * MOST2), R(100.0) * ROUNDING);
    feel(1U, R(0.02), false);
    CHECK_NEAR(ripple.felt2, (RISE * R(0.99203191483706071)) * (R(0.5) * MOST2), R(100.0) * ROUNDING);
    feel(200U, R(1.0), false);
    CHECK(ripple.felt2 == ripple.most2);
    CHECK_NEAR(ripple.most2, MOST2, ROUNDING);
    CHECK(gw_ripple_variance(&ripple, false) > ripple.most2);
    feel(1000U, GW_ZERO, false);
    CHECK(gw_ripple_variance(&ripple, false) < R(1.0e-3));
}

static void a_reaction_is_force_itself(void)
{
    begin();
    feel(100U, R(0.0749), true);
    CHECK(ripple.felt2 == GW_ZERO);
    feel(1U, R(0.08), true);
    CHECK_NEAR(ripple.felt2, RISE * (R(0.5) * MOST2), R(100.0) * ROUNDING);
}

/* It counts from the interval after the next on. */
static void what_is_felt_counts_later(void)
{
    begin();
    feel(STEPS - 1U, R(0.5), false);
    CHECK((ripple.seen2 == GW_ZERO) && (ripple.next2 == GW_ZERO) && (ripple.felt2 > GW_ZERO));
    feel(1U, R(0.5), false);
    const gw_real_t felt2 = ripple.felt2;
    CHECK((ripple.seen2 == GW_ZERO) && (ripple.next2 == felt2));
    feel(STEPS - 1U, GW_ZERO, false);
    CHECK(ripple.seen2 == GW_ZERO);
    feel(1U, GW_ZERO, false);
    CHECK((ripple.seen2 == felt2) && (ripple.next2 == ripple.felt2));
}

static void a_contact_teaches_nothing(void)
{
    begin();
    feel(3U * STEPS, R(0.03), false);
    const gw_real_t seen2 = ripple.seen2;
    CHECK((seen2 > GW_ZERO) && (ripple.felt2 > seen2));
    feel(3U, R(0.5), false);
    gw_ripple_leave_out(&ripple);
    CHECK((ripple.seen2 == seen2) && (ripple.next2 == seen2) && (ripple.felt2 == seen2));
    for (uint32_t i = 1U; i < STEPS; i++) { /* the interval begins again */
        gw_ripple_go_on(&ripple);
        ripple.next2 = GW_ZERO;
    }
    CHECK(ripple.seen2 == seen2);
    gw_ripple_go_on(&ripple);
    CHECK(ripple.seen2 == GW_ZERO);
}

/* Seen at its largest from the third interval of 64 ms on, the mean is known after 0.1 of 20 s, 527 steps of 4 ms: the
 * variance is the largest from then on, in quiet moments, too, but in no reaction. */
static void rollers_that_are_always_uneven_stay_doubted(void)
{
    begin();
    feel(526U, R(1.0), false);
    CHECK(ripple.weight < R(0.1));
    CHECK(gw_ripple_usual(&ripple, false) == GW_ZERO);
    feel(1U, R(1.0), false);
    CHECK(ripple.weight >= R(0.1));
    CHECK(gw_ripple_usual(&ripple, false) == ripple.most2);
    CHECK(gw_ripple_usual(&ripple, true) == GW_ZERO);
    for (uint32_t i = 0U; i < 600U; i++) { /* 2.4 s with nothing to be seen: s^2 has faded, the mean is above 0.4 */
        feel(1U, GW_ZERO, false);
    }
    CHECK(ripple.seen2 < R(0.01));
    CHECK_NEAR(gw_ripple_variance(&ripple, false), ripple.guess2 + ripple.most2, ROUNDING);
    CHECK_NEAR(gw_ripple_variance(&ripple, true), (R(0.2) * ripple.guess2) + ripple.seen2, ROUNDING);
}

/* The mean of what is seen: 1 - e^(-t/20 s) of it, over its weight, which is as much. */
static void the_mean_is_that_of_the_last_seconds(void)
{
    begin();
    ripple.seen2 = R(0.2);
    ripple.next2 = R(0.2);
    for (uint32_t i = 0U; i < 2500U; i++) {
        ripple.felt2 = R(0.2);
        feel(1U, GW_ZERO, false);
        ripple.next2 = R(0.2);
    }
    const gw_real_t weight = -gw_expm1(R(-0.5));
    CHECK_NEAR(ripple.weight, weight, R(1000.0) * ROUNDING);
    CHECK_NEAR(ripple.mean2, R(0.2) * weight, R(1000.0) * ROUNDING);
    const gw_real_t mean2 = ripple.mean2;
    const gw_real_t before = ripple.weight;
    feel(100U, R(1.0), true); /* a reaction teaches nothing */
    CHECK((ripple.mean2 == mean2) && (ripple.weight == before));
}

/* Nothing up to 0.3 of the largest, all of it from 0.4 on. */
static void what_is_usual_grows_with_the_mean(void)
{
    const struct {
        gw_real_t mean;
        gw_real_t usual;
    } rows[] = {{R(0.0), R(0.0)},  {R(0.29), R(0.0)}, {R(0.32), R(0.2)},
                {R(0.38), R(0.8)}, {R(0.41), R(1.0)}, {R(1.0), R(1.0)}};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        begin();
        ripple.weight = R(0.5);
        ripple.mean2 = (R(0.5) * rows[i].mean) * ripple.most2;
        unit_row(i);
        CHECK_NEAR(gw_ripple_usual(&ripple, false), rows[i].usual * MOST2, R(100.0) * ROUNDING);
        CHECK(gw_ripple_usual(&ripple, true) == GW_ZERO);
        ripple.guess2 = GW_ZERO;
        ripple.seen2 = R(0.3) * MOST2;
        CHECK_NEAR(gw_ripple_variance(&ripple, false), gw_max(rows[i].usual, R(0.3)) * MOST2, R(100.0) * ROUNDING);
    }
    begin();
    CHECK(gw_ripple_usual(&ripple, false) == GW_ZERO);
}

static void without_ripple_nothing_is_doubted(void)
{
    gw_ripple_init(&ripple, GW_ZERO, INTERVAL_S);
    feel(900U, R(10.0), false);
    CHECK(gw_ripple_usual(&ripple, false) == GW_ZERO);
    CHECK(gw_ripple_variance(&ripple, false) == GW_ZERO);
}

/* 0.3 f^2 n n^T of each wheel; the second one's axle points to 120 degrees. */
static void the_doubt_lies_along_the_axles(void)
{
    const gw_planar_covariance_t before = {R(1.0), R(2.0), R(5.0)};
    const gw_wheels_t one_n = {{R(0.0), R(-8.0), R(0.0)}};
    const gw_wheels_t all_n = {{R(8.0), R(-8.0), R(8.0)}};
    gw_geometry_config_t geometry;
    gw_kinematics_t kinematics;
    gw_geometry_config_trikey(&geometry);
    CHECK_STATUS(gw_kinematics_init(&kinematics, &geometry), GW_STATUS_OK);
    const gw_planar_covariance_t one = gw_ripple_added(R(0.3), &kinematics, &one_n, before);
    CHECK_NEAR(one.xx, R(1.0) + R(4.8), R(100.0) * ROUNDING);
    CHECK_NEAR(one.xy, R(2.0) - R(8.313843876330611), R(100.0) * ROUNDING);
    CHECK_NEAR(one.yy, R(5.0) + R(14.4), R(100.0) * ROUNDING);
    const gw_planar_covariance_t all = gw_ripple_added(R(0.3), &kinematics, &all_n, before);
    CHECK_NEAR(all.xx, R(1.0) + R(28.8), R(100.0) * ROUNDING);
    CHECK_NEAR(all.xy, R(2.0), R(100.0) * ROUNDING);
    CHECK_NEAR(all.yy, R(5.0) + R(28.8), R(100.0) * ROUNDING);
}

/* Periods from 10 us to 0.1 s, four ticks each, and a friction of nothing. */
static void every_period_has_an_interval(void)
{
    const struct {
        gw_real_t interval_s;
        uint32_t steps;
    } rows[] = {{R(4.0e-5), 1024U}, {R(6.0e-5), 1024U}, {R(0.00025), 256U},
                {R(0.031), 2U},     {R(0.0641), 1U},    {R(0.4), 1U}};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        unit_row(i);
        gw_ripple_init(&ripple, GW_ONE, rows[i].interval_s);
        CHECK(gw_ripple_invariant_holds(&ripple));
        CHECK(ripple.interval == rows[i].steps);
        CHECK(gw_in_range(ripple.keep, GW_HALF, GW_ONE) && gw_in_range(ripple.rise, GW_ZERO, GW_HALF));
        gw_ripple_follow(&ripple, R(1.0e9), R(1.0e12), GW_ZERO, false);
        CHECK(ripple.guess2 == GW_HALF); /* at most half of it at once */
        CHECK(gw_ripple_invariant_holds(&ripple));
    }
    CHECK(ripple.rise == GW_HALF);
}

static void the_invariant_sees_every_member(void)
{
    begin();
    const gw_ripple_t good = ripple;
    gw_real_t *const members[] = {&ripple.guess2, &ripple.most2, &ripple.seen2, &ripple.next2,  &ripple.felt2,
                                  &ripple.keep,   &ripple.rise,  &ripple.mean2, &ripple.weight, &ripple.recent};
    CHECK(!gw_ripple_invariant_holds(NULL));
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(members); i++) {
        unit_row(i);
        *members[i] = unit_nan();
        CHECK(!gw_ripple_invariant_holds(&ripple));
        *members[i] = R(-1.0);
        CHECK(!gw_ripple_invariant_holds(&ripple));
        *members[i] = R(3.0);
        CHECK(!gw_ripple_invariant_holds(&ripple));
        ripple = good;
    }
    gw_real_t *const shares[] = {&ripple.guess2, &ripple.keep, &ripple.rise, &ripple.weight, &ripple.recent};
    const gw_real_t limits[] = {R(1.0), R(1.0), R(0.5), R(1.0), R(0.5)};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(shares); i++) {
        unit_row(i);
        *shares[i] = limits[i];
        CHECK(gw_ripple_invariant_holds(&ripple));
        *shares[i] = R(1.01) * limits[i];
        CHECK(!gw_ripple_invariant_holds(&ripple));
        ripple = good;
    }
    ripple.steps = STEPS;
    CHECK(!gw_ripple_invariant_holds(&ripple));
    ripple = good;
    ripple.interval = 0U;
    CHECK(!gw_ripple_invariant_holds(&ripple));
    ripple.interval = 1025U;
    CHECK(!gw_ripple_invariant_holds(&ripple));
}

void suite_ripple(void)
{
    unit_run("a_robot_that_has_not_driven_may_have_any_rollers", a_robot_that_has_not_driven_may_have_any_rollers);
    unit_run("rollers_that_are_even_are_soon_known", rollers_that_are_even_are_soon_known);
    unit_run("rollers_that_are_uneven_are_doubted_longer", rollers_that_are_uneven_are_doubted_longer);
    unit_run("a_reaction_is_force_itself", a_reaction_is_force_itself);
    unit_run("what_is_felt_counts_later", what_is_felt_counts_later);
    unit_run("a_contact_teaches_nothing", a_contact_teaches_nothing);
    unit_run("rollers_that_are_always_uneven_stay_doubted", rollers_that_are_always_uneven_stay_doubted);
    unit_run("the_mean_is_that_of_the_last_seconds", the_mean_is_that_of_the_last_seconds);
    unit_run("what_is_usual_grows_with_the_mean", what_is_usual_grows_with_the_mean);
    unit_run("without_ripple_nothing_is_doubted", without_ripple_nothing_is_doubted);
    unit_run("the_doubt_lies_along_the_axles", the_doubt_lies_along_the_axles);
    unit_run("every_period_has_an_interval", every_period_has_an_interval);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
}
