// Bristles of the rollers against the differential equation of their law, integrated finely in long double, and against
// closed forms; then properties that hold for any input.
#include <memory>

#include "support.hpp"

namespace
{

using Long = long double;

struct Bristles {
    explicit Bristles(const gw_geometry_config_t &chosen = trikey().geometry,
                      const gw_presliding_config_t &presliding = trikey().estimator.presliding,
                      const gw_friction_config_t &rollers = trikey().friction, Real stiffness = real(668))
        : geometry(chosen), config(presliding), friction(rollers)
    {
        EXPECT_EQ(gw_kinematics_init(&kinematics, &geometry), GW_STATUS_OK);
        EXPECT_EQ(gw_presliding_init(&state, &config, &friction, &kinematics), GW_STATUS_OK);
        EXPECT_EQ(gw_rate_filter_constants(&rate, real(0.001), real(200), 8500, stiffness), GW_STATUS_OK);
    }
    static gw_controller_config_t trikey()
    {
        gw_controller_config_t config;
        gw_controller_config_paper(&config);
        return config;
    }
    // One tick in which the sensed torques change the drivetrains' twist so that the base moves by `travel` (m, m,
    // rad).
    Eigen::Vector3d move(const Eigen::Vector3d &travel, const Eigen::Vector3d &velocity)
    {
        torque -= 668.0 * wheel_jacobian(geometry, 0.0) * travel;
        return at(torque, velocity);
    }
    Eigen::Vector3d at(const Eigen::Vector3d &sensed, const Eigen::Vector3d &velocity)
    {
        const gw_wheels_t t = wheels(sensed);
        return vector(gw_presliding_step(&state, &kinematics, &rate, count.data(), &t, twist(velocity))) /
               static_cast<double>(geometry.roller_radius_m);
    }
    // Direction of the axle of wheel i.
    [[nodiscard]] Eigen::Vector3d axle(int i) const
    {
        const double angle = azimuth(geometry, static_cast<std::size_t>(i));
        return {std::cos(angle), std::sin(angle), 0.0};
    }
    [[nodiscard]] double sigma0(int i = 0) const
    {
        return config.stiffness_n_per_m[i];
    }
    [[nodiscard]] double most() const
    {
        return static_cast<double>(friction.coulomb_torque_nm) / static_cast<double>(geometry.roller_radius_m);
    }

    gw_geometry_config_t geometry;
    gw_presliding_config_t config;
    gw_friction_config_t friction;
    gw_kinematics_t kinematics{};
    gw_rate_filter_constants_t rate{};
    gw_presliding_t state{};
    std::array<std::int32_t, 3> count{};
    Eigen::Vector3d torque = Eigen::Vector3d::Zero();
};

// z' = v (1 - A rho) of the header, implemented again: Heun's method in small steps of travel, so that it also holds
// where v comes from positions and g from another speed (the filtered one).
struct Equation {
    Long sigma0, sigma1, stribeck, elastic, most, alpha_per_radius;
    Long z = 0;

    [[nodiscard]] Long bears(Long speed) const
    {
        const Long w = std::exp(-(speed / stribeck) * (speed / stribeck));
        return most * (w + (1 - w) * std::tanh(alpha_per_radius * std::fabs(speed)));
    }
    // dz per travel.
    [[nodiscard]] Long slope(Long deflection, Long direction, Long g) const
    {
        if (deflection * direction <= 0) {
            return 1;
        }
        const Long rho = sigma0 * std::fabs(deflection) / g;
        const Long y = std::min(std::max((rho - elastic) / (1 - elastic), Long(0)), Long(1));
        return 1 - y * y * (3 - 2 * y) * rho;
    }
    Long step(Long travel, Long speed)
    {
        const Long g = bears(speed);
        const Long rate = speed * slope(z, speed, g);
        constexpr int parts = 50;
        for (int i = 0; i < parts; ++i) {
            const Long h = travel / parts;
            const Long first = slope(z, h, g);
            z += h * (first + slope(z + h * first, h, g)) / 2;
        }
        return sigma0 * z + sigma1 * rate;
    }
};

Equation equation_of(const Bristles &b, int wheel)
{
    return {static_cast<Long>(b.config.stiffness_n_per_m[wheel]),
            static_cast<Long>(b.config.damping_newton_s_per_m),
            static_cast<Long>(b.config.stribeck_speed_mps),
            static_cast<Long>(b.config.elastic_fraction),
            static_cast<Long>(b.friction.coulomb_torque_nm) / static_cast<Long>(b.geometry.roller_radius_m),
            static_cast<Long>(b.friction.tanh_slope_s_per_rad) / static_cast<Long>(b.geometry.roller_radius_m)};
}

// A walk of the base back and forth through sticking and sliding, the same for every number of ticks per sliding
// deflection. Returns the largest deviation of a force from the equation, relative to B_r/r_r.
double worst_deviation(int ticks_per_deflection)
{
    Random random(1);
    double worst = 0.0;
    for (int trial = 0; trial < 12; ++trial) {
        gw_presliding_config_t presliding = Bristles::trikey().estimator.presliding;
        for (auto &stiffness : presliding.stiffness_n_per_m) {
            stiffness = real(random.uniform(1.6e4, 6.7e4));
        }
        presliding.damping_newton_s_per_m = real(random.uniform(0.0, 40.0));
        presliding.elastic_fraction = real(random.uniform(0.3, 0.9));
        const gw_friction_config_t friction = {real(random.uniform(0.1, 0.4)), real(random.uniform(0.1, 1.0))};
        Bristles b(random_geometry(random, trial), presliding, friction);
        std::array<Equation, 3> truth = {equation_of(b, 0), equation_of(b, 1), equation_of(b, 2)};
        (void)b.move(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()); // the first sample: where everything starts
        for (int leg = 0; leg < 10; ++leg) {
            Eigen::Vector3d travel = random_vector(random, 1.0);
            travel *= b.most() / 3e4 / ticks_per_deflection / travel.head<2>().norm();
            travel(2) *= 0.1;
            const Eigen::Vector3d velocity = travel / travel.norm() * random.uniform(0.0, 0.05);
            const int ticks = static_cast<int>(random.uniform(0.5, 3.0) * ticks_per_deflection);
            for (int k = 0; k < ticks; ++k) {
                const gw_wheels_t before = wheels(b.torque);
                const Eigen::Vector3d force = b.move(travel, velocity);
                // The sensor readings after rounding.
                const Eigen::Vector3d told =
                    wheel_jacobian(b.geometry, 0.0).inverse() * (vector(before) - vector(wheels(b.torque))) / 668.0;
                for (int i = 0; i < 3; ++i) {
                    const Long expected = truth[static_cast<std::size_t>(i)].step(
                        static_cast<Long>(b.axle(i).dot(told)), static_cast<Long>(b.axle(i).dot(rounded(velocity))));
                    worst = std::max(worst, std::fabs(force(i) - static_cast<double>(expected)) / b.most());
                }
                EXPECT_TRUE(gw_presliding_invariant_holds(&b.state));
            }
        }
    }
    return worst;
}

TEST(Presliding, FollowsItsEquation)
{
    // One Euler step per tick: the error is the change of 1 - A rho within a tick, so it is ten times smaller at a
    // tenth of the travel per tick. A collision reaches the sliding deflection after some 20 ticks, a push by hand
    // after hundreds.
    const double fast = worst_deviation(20);
    const double slow = worst_deviation(200);
    EXPECT_LT(fast, 0.1);
    EXPECT_LT(slow, 0.15 * fast);
}

TEST(Presliding, WithinTheElasticPartItIsASpring)
{
    // To 0.7 of the sliding deflection and back, any path: f = sigma0 z, z the displacement along the axle.
    Random random(2);
    for (int trial = 0; trial < 30; ++trial) {
        Bristles b(random_geometry(random, trial));
        (void)b.move(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
        Eigen::Vector3d where = Eigen::Vector3d::Zero();
        const double reach = 0.69 * b.most() / b.sigma0();
        for (int k = 0; k < 500; ++k) {
            Eigen::Vector3d next = random_vector(random, 1.0);
            next.head<2>() *= random.uniform(0.0, reach) / next.head<2>().norm();
            next(2) *= 1e-3;
            const Eigen::Vector3d force = b.move(next - where, Eigen::Vector3d::Zero());
            where = next;
            for (int i = 0; i < 3; ++i) {
                // 500 roundings of positions in torques of up to 668 Nm/rad x 1e-3 m / 0.02 m.
                ASSERT_NEAR(force(i), b.sigma0(i) * b.axle(i).dot(where), 500.0 * tolerance * b.most()) << k;
            }
        }
    }
}

TEST(Presliding, SteadySlidingIsTheTanhLaw)
{
    Random random(3);
    for (int trial = 0; trial < 200; ++trial) {
        Bristles b(random_geometry(random, trial));
        const Eigen::Vector3d velocity = random_vector(random, 0.3);
        Eigen::Vector3d force;
        for (int k = 0; k < 3000; ++k) {
            force = b.move(velocity * 1e-3, velocity);
        }
        for (int i = 0; i < 3; ++i) {
            const double speed = b.axle(i).dot(velocity);
            if (std::fabs(speed) > 0.02) { // eight Stribeck speeds: e^-64 of stiction is left
                const double alpha = b.friction.tanh_slope_s_per_rad / static_cast<double>(b.geometry.roller_radius_m);
                EXPECT_NEAR(force(i), b.most() * std::tanh(alpha * speed), 10.0 * tolerance * b.most());
            }
        }
    }
}

TEST(Presliding, AStrideLongerThanTheBristleEndsAtItsLimit)
{
    auto stiff = Bristles::trikey().estimator.presliding;
    for (auto &stiffness : stiff.stiffness_n_per_m) {
        stiffness = real(1e7); // slides after 2 um
    }
    stiff.damping_newton_s_per_m = real(0);
    Bristles b(Bristles::trikey().geometry, stiff);
    (void)b.move(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
    Random random(4);
    for (int k = 0; k < 5000; ++k) {
        Eigen::Vector3d velocity = random_vector(random, 2.0);
        velocity(2) = 0.0;
        const Eigen::Vector3d force = b.move(velocity * 1e-3, velocity);
        for (int i = 0; i < 3; ++i) {
            const double speed = b.axle(i).dot(velocity);
            if (std::fabs(speed) > 0.1) { // 100 um in this tick
                ASSERT_NEAR(force(i), std::copysign(b.most() * std::tanh(std::fabs(speed) * 0.4 / 0.009525), speed),
                            100.0 * tolerance * b.most());
            }
            ASSERT_LE(std::fabs(force(i)), b.most() * (1.0 + 4.0 * epsilon));
        }
    }
}

TEST(Presliding, AHeldPushDoesNotCreepUnderNoise)
{
    // An hour at 1 kHz, at 0.6 of the rollers' limit, with the torque sensor's noise in its resolution of 14.3 mN m.
    Bristles b;
    (void)b.move(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
    const Eigen::Vector3d held(0.6 * b.most() / b.sigma0(), 0.0, 0.0);
    const Eigen::Vector3d start = b.move(held, Eigen::Vector3d::Zero());
    ASSERT_NEAR(start(0), 0.6 * b.most(), 1e-3);
    const Eigen::Vector3d torque = b.torque;
    Random random(5);
    for (int k = 0; k < 3'600'000; ++k) {
        const double noise[3] = {0.0143 * random.integer(-4, 4), 0.0143 * random.integer(-4, 4),
                                 0.0143 * random.integer(-4, 4)};
        (void)b.at(torque + Eigen::Vector3d(noise[0], noise[1], noise[2]), Eigen::Vector3d::Zero());
    }
    const Eigen::Vector3d end = b.at(torque, Eigen::Vector3d::Zero());
    // A random walk of roundings of deflections of 0.5 mm and travels of 10 um: sqrt(3.6e6) of them.
    EXPECT_VECTOR_NEAR(end, start, 1900.0 * epsilon * 20.0);
}

} // namespace
