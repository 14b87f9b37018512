#include <algorithm>
#include <vector>

#include "support.hpp"

namespace
{

using Point = Eigen::Vector2d;

// Random strictly convex polygon: points on an ellipse, well apart.
gw_contact_config_t random_outline(Random &random)
{
    gw_contact_config_t config{};
    config.minimum_force_n = real(0.5);
    config.vertex_count = static_cast<std::uint32_t>(random.integer(3, 16));
    const double a = random.uniform(0.2, 0.6);
    const double b = random.uniform(0.2, 0.6);
    const Point centre(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1));
    const double turn = random.uniform(0.0, 2.0 * pi);
    for (std::uint32_t i = 0; i < config.vertex_count; ++i) {
        const double angle = turn + 2.0 * pi * (i + random.uniform(-0.3, 0.3)) / config.vertex_count;
        config.vertex_m[i] = {real(centre.x() + a * std::cos(angle)), real(centre.y() + b * std::sin(angle))};
    }
    return config;
}

std::vector<Point> vertices(const gw_contact_config_t &config)
{
    std::vector<Point> result;
    for (std::uint32_t i = 0; i < config.vertex_count; ++i) {
        result.emplace_back(config.vertex_m[i].x, config.vertex_m[i].y);
    }
    return result;
}

struct Hit {
    bool on_outline;
    Point point;
};

// Brute force: walk along the outline in fine steps and keep points near the line of action where the force enters;
// otherwise the nearest.
Hit brute_force(const std::vector<Point> &outline, const Point &u, double arm)
{
    constexpr int steps = 4000;
    Hit hit{false, Point::Zero()};
    double nearest = 1e9;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const Point &a = outline[i];
        const Point edge = outline[(i + 1) % outline.size()] - a;
        const bool enters = u.x() * edge.y() - u.y() * edge.x() < 0.0; // u . outward normal
        double before = a.x() * u.y() - a.y() * u.x() - arm;
        for (int k = 1; k <= steps; ++k) {
            const Point p = a + edge * (static_cast<double>(k) / steps);
            const double side = p.x() * u.y() - p.y() * u.x() - arm;
            if (enters && before * side <= 0.0) {
                return {true, p};
            }
            if (std::fabs(side) < nearest) {
                nearest = std::fabs(side);
                hit.point = p;
            }
            before = side;
        }
    }
    return hit;
}

TEST(Contact, LocationAgreesWithBruteForce)
{
    Random random(31);
    int misses = 0;
    for (int trial = 0; trial < 600; ++trial) {
        const gw_contact_config_t config = random_outline(random);
        gw_contact_t contact{};
        ASSERT_EQ(gw_contact_init(&contact, &config), GW_STATUS_OK);
        ASSERT_TRUE(gw_contact_invariant_holds(&contact));
        const double angle = random.uniform(-pi, pi);
        const Point u(std::cos(angle), std::sin(angle));
        const double force = random.uniform(1.0, 100.0);
        const double arm = random.uniform(-0.8, 0.8);
        const gw_wrench_t push = wrench({force * u.x(), force * u.y(), force * arm});
        gw_contact_estimate_t estimate{};
        ASSERT_EQ(gw_contact_locate(&contact, push, {real(0.4), real(0.1)}, &estimate), GW_STATUS_OK);
        ASSERT_TRUE(estimate.valid);
        const Hit truth = brute_force(vertices(config), u, arm);
        ASSERT_EQ(estimate.on_outline, truth.on_outline);
        misses += truth.on_outline ? 0 : 1;
        // One step of the walk: edges are up to 1.2 m long.
        const Point found(estimate.point_m.x, estimate.point_m.y);
        EXPECT_LE((found - truth.point).norm(), 1.3 / 4000.0 * (truth.on_outline ? 1.0 : 2.0)) << trial;
        EXPECT_NEAR(estimate.force_n, force, tolerance * force);
        EXPECT_NEAR(std::remainder(estimate.direction_rad - angle, 2.0 * pi), 0.0, 10.0 * tolerance);
        EXPECT_NEAR(estimate.lever_arm_m, arm, 10.0 * tolerance);
        EXPECT_NEAR(estimate.lever_arm_sigma_m, std::sqrt(0.1 * 0.1 + arm * arm * 0.4 * 0.4) / force, tolerance);
    }
    // Both branches were exercised.
    EXPECT_GT(misses, 50);
    EXPECT_LT(misses, 550);
}

TEST(Contact, APushOnTheOutlineIsFoundWhereItIs)
{
    Random random(32);
    for (int trial = 0; trial < 5000; ++trial) {
        const gw_contact_config_t config = random_outline(random);
        gw_contact_t contact{};
        ASSERT_EQ(gw_contact_init(&contact, &config), GW_STATUS_OK);
        const auto outline = vertices(config);
        const auto i = static_cast<std::size_t>(random.integer(0, static_cast<int>(outline.size()) - 1));
        const Point edge = outline[(i + 1) % outline.size()] - outline[i];
        const Point p = outline[i] + random.uniform(0.01, 0.99) * edge;
        // Into the body, up to 80 degrees from the normal.
        const double angle = std::atan2(edge.x(), -edge.y()) + random.uniform(-1.4, 1.4);
        const double force = random.uniform(1.0, 200.0);
        const gw_wrench_t at_point = wrench({force * std::cos(angle), force * std::sin(angle), 0.0});
        const gw_wrench_t push = wrench_at_centre({real(p.x()), real(p.y())}, at_point);
        gw_contact_estimate_t estimate{};
        ASSERT_EQ(gw_contact_locate(&contact, push, {real(0), real(0)}, &estimate), GW_STATUS_OK);
        ASSERT_TRUE(estimate.valid);
        ASSERT_TRUE(estimate.on_outline);
        // Grazing forces magnify rounding by up to 1/cos(80 deg), and short edges by another ten.
        EXPECT_NEAR(estimate.point_m.x, p.x(), 60.0 * tolerance);
        EXPECT_NEAR(estimate.point_m.y, p.y(), 60.0 * tolerance);
    }
}

TEST(Contact, UncertaintyOfPhysics5)
{
    // 0.05 N m of torque noise: 2 cm at 10 N, 26 cm at 0.8 N, for a push through the centre of Trikey.
    gw_controller_config_t config;
    gw_controller_config_paper(&config);
    config.contact.minimum_force_n = real(0.1);
    gw_contact_t contact{};
    ASSERT_EQ(gw_contact_init(&contact, &config.contact), GW_STATUS_OK);
    gw_kinematics_t k{};
    ASSERT_EQ(gw_kinematics_init(&k, &config.geometry), GW_STATUS_OK);
    const gw_wrench_sigma_t sigma = gw_wrench_noise(&k, real(0.05));
    gw_contact_estimate_t estimate{};
    ASSERT_EQ(gw_contact_locate(&contact, wrench({-10.0, 0.0, 0.0}), sigma, &estimate), GW_STATUS_OK);
    EXPECT_NEAR(estimate.lever_arm_sigma_m, 0.0205, 5e-4);
    ASSERT_EQ(gw_contact_locate(&contact, wrench({-0.8, 0.0, 0.0}), sigma, &estimate), GW_STATUS_OK);
    EXPECT_NEAR(estimate.lever_arm_sigma_m, 0.256, 5e-3);
}

} // namespace
