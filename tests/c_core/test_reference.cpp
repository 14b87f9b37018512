#include "support.hpp"

namespace {

constexpr double period = 0.001;

gw_reference_t trikey_reference() {
    gw_controller_config_t config;
    gw_controller_config_trikey(&config);
    gw_reference_t r{};
    EXPECT_EQ(gw_reference_init(&r, &config.reference, real(period)), GW_STATUS_OK);
    return r;
}

// The paper's circle: 1.5 m diameter at 0.16 m/s, turning about itself as well.
gw_plan_t circle(double t) {
    const double radius = 0.75;
    const double w = 0.16 / radius;
    gw_plan_t p{};
    p.pose = {real(radius * std::cos(w * t)), real(radius * std::sin(w * t)), real(0.5 * t)};
    p.twist = {real(-0.16 * std::sin(w * t)), real(0.16 * std::cos(w * t)), real(0.5)};
    p.acceleration = {real(-0.16 * w * std::cos(w * t)), real(-0.16 * w * std::sin(w * t)), real(0)};
    return p;
}

void expect_within_limits(const gw_reference_t &r, const gw_twist_t &before) {
    const double slack = 1.0 + 10.0 * epsilon;
    ASSERT_LE(std::hypot(r.twist.vx_mps, r.twist.vy_mps), r.config.speed_limit_mps * slack);
    ASSERT_LE(std::fabs(r.twist.omega_radps), r.config.yaw_rate_limit_radps * slack);
    ASSERT_LE(std::hypot(r.twist.vx_mps - before.vx_mps, r.twist.vy_mps - before.vy_mps),
              r.config.acceleration_limit_mps2 * period * slack + 2.0 * epsilon);
    ASSERT_LE(std::fabs(r.twist.omega_radps - before.omega_radps),
              r.config.yaw_acceleration_limit_radps2 * period * slack + 2.0 * epsilon);
}

TEST(Reference, ASmoothPlanIsFollowedExactly) {
    auto r = trikey_reference();
    gw_plan_t plan = circle(0.0);
    gw_reference_place(&r, &plan, true);
    for (int i = 1; i <= 120'000; ++i) {
        plan = circle(i * period);
        gw_reference_follow(&r, &plan, false);
        // The plan itself is rounded to the real type; trapezoids add less than 1e-9 m.
        const double allowed = is_double ? 1e-9 : 5e-7;
        ASSERT_LE(gw_reference_distance(&r, &plan), allowed) << i;
        ASSERT_LE(gw_reference_angle(&r, &plan), is_double ? 1e-9 : 2e-5) << i;
        ASSERT_NEAR(r.twist.vx_mps, plan.twist.vx_mps, is_double ? 1e-8 : 2e-6);
        ASSERT_EQ(r.acceleration.ax_mps2, plan.acceleration.ax_mps2);
    }
    EXPECT_TRUE(gw_reference_invariant_holds(&r));
}

TEST(Reference, JumpsOfThePlanAreSmoothedWithinTheLimits) {
    Random random(81);
    auto r = trikey_reference();
    gw_plan_t plan{};
    gw_reference_place(&r, &plan, false);
    for (int i = 0; i < 60'000; ++i) {
        if (i % 3000 == 0) {
            plan.pose = {real(random.uniform(-3, 3)), real(random.uniform(-3, 3)), real(random.uniform(-9, 9))};
            plan.twist = {real(random.uniform(-3, 3)), real(random.uniform(-3, 3)), real(random.uniform(-9, 9))};
        }
        const gw_twist_t before = r.twist;
        const gw_pose_t from = gw_reference_pose(&r);
        gw_reference_follow(&r, &plan, i % 2000 > 1000);
        expect_within_limits(r, before);
        // Displacement and pose belong together.
        ASSERT_NEAR(gw_reference_pose(&r).x_m - from.x_m, r.displacement.x_m, 4.0 * epsilon);
    }
}

TEST(Reference, RejoiningEndsOnThePathInFiniteTime) {
    auto r = trikey_reference();
    gw_plan_t start{};
    start.pose = {real(0.4), real(-0.3), real(0.5)};
    gw_reference_place(&r, &start, false);
    const gw_plan_t plan{};
    int arrived = -1;
    for (int i = 0; i < 20'000 && arrived < 0; ++i) {
        const gw_twist_t before = r.twist;
        gw_reference_follow(&r, &plan, true);
        expect_within_limits(r, before);
        ASSERT_LE(std::hypot(r.twist.vx_mps, r.twist.vy_mps), 0.1 * (1.0 + 10.0 * epsilon));
        const bool slow = std::hypot(r.twist.vx_mps, r.twist.vy_mps) < 0.005;
        if (gw_reference_distance(&r, &plan) < 2e-4 && gw_reference_angle(&r, &plan) < 5e-4 && slow) {
            arrived = i;
        }
    }
    EXPECT_GT(arrived, 4500); // 0.5 m at 0.1 m/s
    EXPECT_LT(arrived, 8000);
}

TEST(Reference, BrakeFreezeEscapeAndPlace) {
    auto r = trikey_reference();
    gw_plan_t plan = circle(3.0);
    plan.pose.theta_rad = real(20);
    gw_reference_place(&r, &plan, false);
    EXPECT_EQ(r.twist.vx_mps, real(0));
    EXPECT_NEAR(gw_reference_pose(&r).theta_rad, 20.0 - 6.0 * pi, 1e-5);
    gw_reference_place(&r, &plan, true);
    EXPECT_EQ(r.twist.vx_mps, plan.twist.vx_mps);
    gw_twist_t before = r.twist;
    int ticks = 0;
    while (r.twist.vx_mps != real(0) || r.twist.vy_mps != real(0) || r.twist.omega_radps != real(0)) {
        before = r.twist;
        gw_reference_brake(&r);
        expect_within_limits(r, before);
        ASSERT_LT(++ticks, 1000);
    }
    EXPECT_NEAR(ticks, 0.16 / 1.5e-3, 2.0);
    gw_reference_place(&r, &plan, true);
    gw_reference_escape(&r, {real(-1e-4), real(2e-4)}, {real(-0.1), real(0.2)});
    EXPECT_EQ(r.displacement.x_m, real(-1e-4));
    EXPECT_EQ(r.twist.vy_mps, real(0.2));
    EXPECT_NEAR(r.twist.omega_radps, 0.5 - 6e-3, 1e-6); // the yaw slows down
    gw_reference_freeze(&r);
    EXPECT_EQ(r.twist.vy_mps, real(0));
    EXPECT_EQ(r.displacement.theta_rad, real(0));
    EXPECT_EQ(r.acceleration.ax_mps2, real(0));
}

TEST(Reference, PlansThatAreNotFiniteOrOutOfRangeAreInvalid) {
    const gw_plan_t good = circle(1.0);
    EXPECT_TRUE(gw_plan_is_valid(&good));
    for (int field = 0; field < 9; ++field) {
        for (const Real bad : {not_a_number, infinite, -infinite, real(1.1e4)}) {
            gw_plan_t plan = good;
            Real *const members[] = {&plan.pose.x_m,
                                     &plan.pose.y_m,
                                     &plan.pose.theta_rad,
                                     &plan.twist.vx_mps,
                                     &plan.twist.vy_mps,
                                     &plan.twist.omega_radps,
                                     &plan.acceleration.ax_mps2,
                                     &plan.acceleration.ay_mps2,
                                     &plan.acceleration.alpha_radps2};
            *members[field] = bad;
            EXPECT_FALSE(gw_plan_is_valid(&plan)) << field;
        }
    }
}

TEST(Reference, Refusals) {
    gw_controller_config_t config;
    gw_controller_config_trikey(&config);
    gw_reference_t r{};
    EXPECT_EQ(gw_reference_init(nullptr, &config.reference, real(period)), GW_STATUS_NULL_POINTER);
    EXPECT_EQ(gw_reference_init(&r, nullptr, real(period)), GW_STATUS_NULL_POINTER);
    config.reference.follow_gain_per_s = real(100);
    EXPECT_EQ(gw_reference_init(&r, &config.reference, real(0.005)), GW_STATUS_OK);
    EXPECT_EQ(gw_reference_init(&r, &config.reference, real(0.0051)), GW_STATUS_CONFIG_INVALID);
    EXPECT_FALSE(gw_reference_invariant_holds(&r));
    EXPECT_FALSE(gw_reference_invariant_holds(nullptr));
}

} // namespace
