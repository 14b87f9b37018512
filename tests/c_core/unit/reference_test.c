#include "unit.h"

#define PERIOD R(0.001)

static const gw_reference_config_t config = {R(2.0), R(0.5), R(1.5), R(1.5), R(6.0), R(0.1), R(0.01)};
static const gw_plan_t origin = {{R(0.0), R(0.0), R(0.0)}, {R(0.0), R(0.0), R(0.0)}, {R(0.0), R(0.0), R(0.0)}};

static gw_reference_t made(void)
{
    gw_reference_t reference;
    CHECK_STATUS(gw_reference_init(&reference, &config, PERIOD), GW_STATUS_OK);
    CHECK(gw_reference_invariant_holds(&reference));
    return reference;
}

static void bad_arguments_are_refused(void)
{
    gw_reference_t reference = made();
    gw_reference_config_t bad = config;
    CHECK_STATUS(gw_reference_init(NULL, &config, PERIOD), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_reference_init(&reference, NULL, PERIOD), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_reference_init(&reference, &config, GW_ZERO), GW_STATUS_CONFIG_INVALID);
    bad.speed_limit_mps = unit_nan();
    CHECK_STATUS(gw_reference_init(&reference, &bad, PERIOD), GW_STATUS_CONFIG_INVALID);
    CHECK(!gw_reference_invariant_holds(&reference));
}

/* More than half of the distance per tick would overshoot: at 0.1 s the gain ends at 5. */
static void the_gain_is_limited_by_the_period(void)
{
    gw_reference_config_t fast = config;
    gw_config_error_t error;
    fast.follow_gain_per_s = R(5.0);
    gw_config_check_begin(&error);
    gw_reference_config_check(&fast, R(0.1), &error);
    CHECK(error.field == GW_FIELD_NONE);
    fast.follow_gain_per_s = unit_above(GW_HALF / R(0.1));
    gw_reference_config_check(&fast, R(0.1), &error);
    CHECK(error.field == GW_FIELD_REFERENCE_FOLLOW_GAIN);
    CHECK((error.maximum == (GW_HALF / R(0.1))) && (error.index == 0U));
}

static void every_number_of_a_plan_is_bounded(void)
{
    const gw_real_t bounds[9] = {R(1e4), R(1e4), R(1e4), R(100.0), R(100.0), R(1000.0), R(1e4), R(1e4), R(1e4)};
    for (uint32_t i = 0U; i < 9U; i++) {
        for (uint32_t k = 0U; k < 4U; k++) {
            const gw_real_t values[4] = {bounds[i], -bounds[i], unit_above(bounds[i]), unit_nan()};
            gw_plan_t plan = origin;
            gw_real_t *const members[9] = {&plan.pose.x_m,
                                           &plan.pose.y_m,
                                           &plan.pose.theta_rad,
                                           &plan.twist.vx_mps,
                                           &plan.twist.vy_mps,
                                           &plan.twist.omega_radps,
                                           &plan.acceleration.ax_mps2,
                                           &plan.acceleration.ay_mps2,
                                           &plan.acceleration.alpha_radps2};
            unit_row((10U * i) + k);
            *members[i] = values[k];
            CHECK(gw_plan_is_valid(&plan) == (k < 2U));
        }
    }
}

/* A circle of 1 m at 0.2 m/s, turning along: a smooth plan is followed exactly, with its own acceleration. */
static void a_smooth_plan_is_followed_exactly(void)
{
    gw_reference_t reference = made();
    for (uint32_t tick = 0U; tick < 2000U; tick++) {
        const gw_real_t angle = R(0.0002) * (gw_real_t)tick;
        const gw_rotation_t at = gw_sincos(angle);
        const gw_plan_t plan = {{at.cosine, at.sine, angle},
                                {R(-0.2) * at.sine, R(0.2) * at.cosine, R(0.2)},
                                {R(-0.04) * at.cosine, R(-0.04) * at.sine, R(1e-9) * (gw_real_t)tick}};
        if (tick == 0U) {
            gw_reference_place(&reference, &plan, true);
        } else {
            gw_reference_follow(&reference, &plan, false);
        }
        CHECK(gw_reference_invariant_holds(&reference));
        /* Trapezoids of 0.2 mm against an arc: (1 ms)^2 of acceleration, and rounding of positions at 1 m. */
        CHECK(gw_reference_distance(&reference, &plan) < (R(1e-7) + (R(20.0) * ULP)));
        CHECK(gw_reference_angle(&reference, &plan) < (R(1e-7) + (R(20.0) * ULP)));
        CHECK(reference.acceleration.ax_mps2 == plan.acceleration.ax_mps2);
        CHECK(reference.acceleration.ay_mps2 == plan.acceleration.ay_mps2);
        CHECK(reference.acceleration.alpha_radps2 == plan.acceleration.alpha_radps2);
    }
}

/* A plan that starts with a jerk: the reference accelerates at its limits, and says so. */
static void a_jump_of_the_plan_s_velocity_is_limited(void)
{
    gw_reference_t reference = made();
    gw_plan_t plan = origin;
    plan.twist.vx_mps = R(0.3);
    plan.twist.omega_radps = R(1.0);
    gw_reference_follow(&reference, &plan, false);
    CHECK(gw_reference_invariant_holds(&reference));
    CHECK_NEAR(reference.twist.vx_mps, R(0.0015), ROUNDING * R(0.01));
    CHECK_NEAR(reference.twist.omega_radps, R(0.006), ROUNDING * R(0.01));
    CHECK_NEAR(reference.acceleration.ax_mps2, R(1.5), R(2.0) * ROUNDING);
    CHECK_NEAR(reference.acceleration.alpha_radps2, R(6.0), R(6.0) * ROUNDING);
}

/* From every side the reference comes to the plan, within its limits, and rests there. */
static void the_reference_comes_to_a_plan_that_is_elsewhere(void)
{
    const struct {
        gw_pose_t pose;
        bool rejoining;
    } rows[] = {
        {{R(0.3), R(-0.2), R(0.5)}, false},
        {{R(-0.3), R(0.2), R(-0.5)}, false},
        {{R(0.1), R(-0.05), R(0.3)}, true},
        {{R(-0.1), R(0.05), R(-0.3)}, true},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        gw_reference_t reference = made();
        gw_plan_t plan = origin;
        gw_real_t fastest = GW_ZERO;
        plan.pose = rows[i].pose;
        unit_row(i);
        for (uint32_t tick = 0U; tick < 8000U; tick++) {
            const gw_twist_t before = reference.twist;
            gw_reference_follow(&reference, &plan, rows[i].rejoining);
            const gw_vector_t velocity = {reference.twist.vx_mps, reference.twist.vy_mps};
            const gw_vector_t change = {velocity.x - before.vx_mps, velocity.y - before.vy_mps};
            CHECK(gw_reference_invariant_holds(&reference));
            CHECK(gw_length(change) <= ((R(1.5) * PERIOD) + ROUNDING));
            CHECK(gw_abs(reference.twist.omega_radps - before.omega_radps) <= ((R(6.0) * PERIOD) + ROUNDING));
            fastest = gw_max(fastest, gw_length(velocity));
        }
        CHECK(fastest <= ((rows[i].rejoining ? R(0.1) : R(0.5)) + ROUNDING));
        /* Following approaches with 2/s: e^-16 of half a metre is left; rejoining arrives exactly. */
        CHECK(gw_reference_distance(&reference, &plan) < R(1e-6));
        CHECK(gw_reference_angle(&reference, &plan) < R(1e-6));
    }
}

/* A path is rejoined within the margin of tipping, whatever the yaw, and plans are followed without it. */
static void a_path_is_rejoined_without_lifting_a_wheel(void)
{
    const gw_tip_config_t tall = {R(0.414), GW_HALF, R(0.03), R(0.0175)};
    gw_geometry_config_t geometry;
    gw_kinematics_t kinematics;
    gw_tip_t tip;
    gw_geometry_config_trikey(&geometry);
    CHECK_STATUS(gw_kinematics_init(&kinematics, &geometry), GW_STATUS_OK);
    gw_tip_init(&tip, &tall, &kinematics);
    for (uint32_t i = 0U; i < 12U; i++) {
        const gw_rotation_t rotation = gw_sincos((gw_real_t)i * R(0.5));
        gw_reference_t reference = made();
        gw_plan_t plan = origin;
        gw_real_t largest = GW_ZERO;
        unit_row(i);
        gw_reference_set_tip(&reference, &tip);
        CHECK(gw_reference_invariant_holds(&reference));
        plan.pose.x_m = R(0.3) * rotation.cosine;
        plan.pose.y_m = R(0.3) * rotation.sine;
        for (uint32_t tick = 0U; tick < 6000U; tick++) {
            gw_reference_follow(&reference, &plan, true);
            for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
                largest = gw_max(largest, gw_along_radial(kinematics.radial[k], reference.acceleration.ax_mps2,
                                                          reference.acceleration.ay_mps2));
            }
        }
        CHECK(gw_reference_distance(&reference, &plan) < R(0.0002));
        /* A tick's change of a speed of 0.1 m/s, over the period. Between two wheels the other limit is the smaller. */
        CHECK(largest <= (tip.margin_mps2 + (R(0.1) * ULP / PERIOD)));
        CHECK(largest > (R(0.8) * tip.margin_mps2));
    }
    gw_reference_t tracking = made();
    gw_plan_t far = origin;
    far.pose.x_m = R(1.0);
    gw_reference_set_tip(&tracking, &tip);
    gw_reference_follow(&tracking, &far, false);
    CHECK_NEAR(tracking.acceleration.ax_mps2, config.acceleration_limit_mps2, ROUNDING);
    tracking.tip.margin_mps2 = unit_nan();
    CHECK(!gw_reference_invariant_holds(&tracking));
}

static void a_reference_on_its_plan_stays_there_when_rejoining(void)
{
    gw_reference_t reference = made();
    gw_reference_follow(&reference, &origin, true);
    CHECK(gw_reference_distance(&reference, &origin) == GW_ZERO);
    CHECK(reference.twist.vx_mps == GW_ZERO);
}

/* Placed on a plan that moves too fast: its velocity, shortened to the limits; at rest if it is not to move. */
static void placing_takes_the_plan_within_the_limits(void)
{
    gw_reference_t reference = made();
    const gw_plan_t fast = {{R(1.0), R(2.0), R(7.0)}, {R(3.0), R(4.0), R(-9.0)}, {R(1.0), R(2.0), R(3.0)}};
    gw_reference_place(&reference, &fast, true);
    CHECK(gw_reference_invariant_holds(&reference));
    CHECK_NEAR(reference.twist.vx_mps, R(0.3), ROUNDING);
    CHECK_NEAR(reference.twist.vy_mps, R(0.4), ROUNDING);
    CHECK(reference.twist.omega_radps == R(-1.5));
    CHECK(reference.acceleration.alpha_radps2 == R(3.0));
    gw_reference_place(&reference, &fast, false);
    CHECK(gw_reference_pose(&reference).y_m == R(2.0));
    CHECK_NEAR(gw_reference_pose(&reference).theta_rad, R(0.71681469282041353), R(4.0) * ULP);
    CHECK((reference.twist.vx_mps == GW_ZERO) && (reference.acceleration.ax_mps2 == GW_ZERO));
}

static void an_escape_moves_as_it_is_told_and_stops_turning(void)
{
    gw_reference_t reference = made();
    const gw_vector_t displacement = {R(0.0002), R(-0.0001)};
    const gw_vector_t velocity = {R(0.2), R(-0.1)};
    reference.twist.omega_radps = R(0.012);
    for (uint32_t tick = 0U; tick < 2U; tick++) {
        gw_reference_escape(&reference, displacement, velocity);
        CHECK(gw_reference_invariant_holds(&reference));
    }
    CHECK_NEAR(gw_reference_pose(&reference).x_m, R(0.0004), ROUNDING);
    CHECK(reference.twist.vy_mps == R(-0.1));
    CHECK_NEAR(reference.twist.omega_radps, GW_ZERO, ROUNDING);
    CHECK(reference.acceleration.ax_mps2 == GW_ZERO);
}

/* 0.3 m/s at 1.5 m/s^2 takes 0.2 s and 0.03 m. */
static void braking_stops_within_the_limits(void)
{
    gw_reference_t reference = made();
    reference.twist.vx_mps = R(0.3);
    reference.twist.omega_radps = R(-0.6);
    for (uint32_t tick = 0U; tick < 201U; tick++) {
        gw_reference_brake(&reference);
        CHECK(gw_reference_invariant_holds(&reference));
        CHECK(reference.acceleration.ax_mps2 >= (R(-1.5) - R(0.001))); /* (0.3 m/s) ulp/1 ms of rounding */
    }
    CHECK_NEAR(reference.twist.vx_mps, GW_ZERO, ROUNDING);
    CHECK_NEAR(reference.twist.omega_radps, GW_ZERO, ROUNDING);
    CHECK_NEAR(gw_reference_pose(&reference).x_m, R(0.03), R(10.0) * ROUNDING);
}

static void freezing_stops_at_once(void)
{
    gw_reference_t reference = made();
    reference.twist.vx_mps = R(0.3);
    gw_reference_freeze(&reference);
    CHECK(gw_reference_invariant_holds(&reference));
    CHECK((reference.twist.vx_mps == GW_ZERO) && (reference.displacement.x_m == GW_ZERO));
}

static void the_invariant_sees_every_member(void)
{
    gw_reference_t turned = made();
    gw_reference_t bad[16];
    turned.theta_rad.value = -GW_PI;
    CHECK(gw_reference_invariant_holds(&turned));
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(bad); i++) {
        bad[i] = made();
    }
    bad[0].initialised = false;
    bad[1].period_s = R(1.0);
    bad[2].x_m.value = unit_nan();
    bad[3].y_m.value = unit_infinity();
    bad[4].theta_rad.excess = unit_nan();
    bad[5].theta_rad.value = R(-4.0);
    bad[6].twist.vx_mps = unit_above(R(100.0));
    bad[7].twist.vy_mps = unit_nan();
    bad[8].twist.omega_radps = R(-1001.0);
    bad[9].acceleration.ax_mps2 = unit_nan();
    bad[10].acceleration.ay_mps2 = unit_infinity();
    bad[11].acceleration.alpha_radps2 = unit_nan();
    bad[12].config.follow_gain_per_s = R(-1.0);
    bad[13].yaw.cosine = unit_above(GW_ONE);
    bad[14].yaw.sine = unit_nan();
    bad[15].yaw.sine = unit_above(GW_ONE);
    CHECK(!gw_reference_invariant_holds(NULL));
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(bad); i++) {
        unit_row(i);
        CHECK(!gw_reference_invariant_holds(&bad[i]));
    }
}

void suite_reference(void)
{
    unit_run("bad_arguments_are_refused", bad_arguments_are_refused);
    unit_run("the_gain_is_limited_by_the_period", the_gain_is_limited_by_the_period);
    unit_run("every_number_of_a_plan_is_bounded", every_number_of_a_plan_is_bounded);
    unit_run("a_smooth_plan_is_followed_exactly", a_smooth_plan_is_followed_exactly);
    unit_run("a_jump_of_the_plan_s_velocity_is_limited", a_jump_of_the_plan_s_velocity_is_limited);
    unit_run("the_reference_comes_to_a_plan_that_is_elsewhere", the_reference_comes_to_a_plan_that_is_elsewhere);
    unit_run("a_path_is_rejoined_without_lifting_a_wheel", a_path_is_rejoined_without_lifting_a_wheel);
    unit_run("a_reference_on_its_plan_stays_there_when_rejoining", a_reference_on_its_plan_stays_there_when_rejoining);
    unit_run("placing_takes_the_plan_within_the_limits", placing_takes_the_plan_within_the_limits);
    unit_run("an_escape_moves_as_it_is_told_and_stops_turning", an_escape_moves_as_it_is_told_and_stops_turning);
    unit_run("braking_stops_within_the_limits", braking_stops_within_the_limits);
    unit_run("freezing_stops_at_once", freezing_stops_at_once);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
}
