#include <memory>

#include "support.hpp"

namespace
{

struct Estimated {
    explicit Estimated(gw_controller_config_t chosen) : config(chosen)
    {
        EXPECT_EQ(gw_estimator_init(state.get(), &config.estimator, &config.geometry, &config.base, &config.friction,
                                    config.period_s),
                  GW_STATUS_OK);
    }
    gw_estimator_output_t step(const gw_estimator_input_t &input)
    {
        gw_estimator_output_t out{};
        EXPECT_EQ(gw_estimator_step(state.get(), &input, &out), GW_STATUS_OK);
        return out;
    }
    void tare(const Eigen::Vector3d &zero)
    {
        const gw_wheels_t torque = wheels(zero);
        for (unsigned i = 1; i <= config.estimator.tare_ticks; ++i) {
            ASSERT_EQ(gw_estimator_tare(state.get(), &torque),
                      i == config.estimator.tare_ticks ? GW_TARE_DONE : GW_TARE_RUNNING);
        }
    }
    gw_controller_config_t config;
    std::unique_ptr<gw_estimator_t> state = std::make_unique<gw_estimator_t>();
};

gw_controller_config_t trikey()
{
    gw_controller_config_t config;
    gw_controller_config_paper(&config);
    return config;
}

gw_estimator_input_t moving_at(double speed, const Eigen::Vector3d &torque)
{
    gw_estimator_input_t in{};
    in.torque_nm = wheels(torque);
    in.planned_twist.vx_mps = real(speed);
    return in;
}

// A push on a standing robot whose sensors have offsets: recovered to 1e-9.
TEST(Estimator, PushAtRestWithSensorOffsets)
{
    Random random(121);
    for (int trial = 0; trial < 300; ++trial) {
        auto config = trikey();
        config.geometry = random_geometry(random, trial);
        Estimated e(config);
        const Eigen::Vector3d zero = random_vector(random, 3.0);
        e.tare(zero);
        const Eigen::Vector3d push = random_vector(random, 60.0);
        const Eigen::Vector3d torque = zero - wheel_jacobian(config.geometry, 0.0).transpose().inverse() * push;
        const auto out = e.step(moving_at(0.0, torque));
        EXPECT_EQ(out.regime, GW_REGIME_REST);
        const double size = 60.0 + 10.0 / config.geometry.wheel_radius_m;
        EXPECT_VECTOR_NEAR(vector(out.wrench), push, is_double ? 1e-9 : 2e-6 * size);
        ASSERT_TRUE(gw_estimator_invariant_holds(e.state.get()));
    }
}

TEST(Estimator, RestIsDeclaredByAQuietTareAtTheEndOfTheWait)
{
    Estimated e(trikey());
    e.tare({0.1, 0.2, 0.3});
    const Eigen::Vector3d run_zero(0.1, 0.2, 0.3);
    EXPECT_EQ(e.step(moving_at(0.0, run_zero)).regime, GW_REGIME_REST);
    const auto moved = e.step(moving_at(0.1, run_zero));
    EXPECT_EQ(moved.regime, GW_REGIME_MOTION);
    EXPECT_TRUE(moved.zero_changed);
    EXPECT_EQ(moved.mean_samples, 1U); // the average starts anew
    EXPECT_EQ(e.step(moving_at(0.02, run_zero)).regime, GW_REGIME_CREEPING);
    EXPECT_EQ(e.step(moving_at(0.1, run_zero)).regime, GW_REGIME_MOTION);
    // Stopped with rollers wound up: creeping for 300 ticks, then the wind-up is the zero.
    const Eigen::Vector3d wound_up(1.1, -0.4, 0.3);
    for (int i = 1; i < 300; ++i) {
        const auto out = e.step(moving_at(0.001, wound_up));
        ASSERT_EQ(out.regime, GW_REGIME_CREEPING) << i;
        ASSERT_GT(std::hypot(out.wrench.force_x_n, out.wrench.force_y_n), 4.0);
    }
    const auto rested = e.step(moving_at(0.001, wound_up));
    EXPECT_EQ(rested.regime, GW_REGIME_REST);
    EXPECT_TRUE(rested.zero_changed);
    EXPECT_VECTOR_NEAR(vector(rested.wrench), Eigen::Vector3d(0, 0, 0), 100.0 * tolerance);
    // In motion again, the zero of the run applies.
    const auto again = e.step(moving_at(0.2, run_zero));
    EXPECT_EQ(again.regime, GW_REGIME_MOTION);
    EXPECT_VECTOR_NEAR(vector(again.nominal_nm) - run_zero,
                       vector(nominal_torques(&e.state->nominal, &e.state->kinematics, {real(0.2), real(0), real(0)},
                                              {real(0), real(0), real(0)})),
                       10.0 * tolerance);
}

TEST(Estimator, MeasuredSourcesSeeARobotThatIsPushedAway)
{
    // Motors hold, and a push accelerates the base: the planned form sees only the part that the wheels carry, the
    // measured form sees all of it.
    auto config = trikey();
    config.estimator.encoder_counts = 1'000'000;
    config.estimator.drivetrain_stiffness_nm_per_rad = real(0);
    config.friction.coulomb_torque_nm = real(0);
    auto measured_config = config;
    measured_config.estimator.velocity_source = GW_SOURCE_MEASURED;
    measured_config.estimator.acceleration_source = GW_SOURCE_MEASURED;
    Estimated planned(config);
    Estimated measured(measured_config);
    planned.tare({0, 0, 0});
    measured.tare({0, 0, 0});
    const double a = 0.5;
    const Eigen::Vector3d rates_per_speed = wheel_jacobian(config.geometry, 0.0) * Eigen::Vector3d(1, 0, 0);
    gw_estimator_output_t p{};
    gw_estimator_output_t m{};
    for (int i = 0; i < 400; ++i) {
        const double t = i * 1e-3;
        auto in = moving_at(0.0, {0, 0, 0});
        for (int w = 0; w < 3; ++w) {
            in.encoder_count[w] =
                static_cast<std::int32_t>(std::lround(rates_per_speed(w) * a * t * t / 2.0 * 1e6 / (2.0 * pi)));
        }
        p = planned.step(in);
        m = measured.step(in);
    }
    EXPECT_NEAR(p.mean.force_x_n, 0.0, 1e-3);
    const double mass = static_cast<double>(measured.state->nominal.total_mass_kg);
    EXPECT_NEAR(m.mean.force_x_n, mass * a, 0.05 * mass * a); // encoder steps through two poles
    EXPECT_NEAR(m.measured_twist.vx_mps, a * 0.39, 0.01);
}

TEST(Estimator, CountersMayWrap)
{
    auto config = trikey();
    config.estimator.velocity_source = GW_SOURCE_MEASURED;
    config.estimator.acceleration_source = GW_SOURCE_MEASURED;
    Estimated plain(config);
    Estimated wrapping(config);
    plain.tare({0, 0, 0});
    wrapping.tare({0, 0, 0});
    Random random(122);
    std::array<std::uint32_t, 3> count{};
    for (int i = 0; i < 3000; ++i) {
        auto in = moving_at(0.1, random_vector(random, 1.0));
        auto shifted = in;
        for (std::size_t w = 0; w < 3; ++w) {
            count[w] += static_cast<std::uint32_t>(random.integer(0, 9));
            in.encoder_count[w] = static_cast<std::int32_t>(count[w]);
            shifted.encoder_count[w] = static_cast<std::int32_t>(count[w] + 0x7FFF'F000U);
        }
        const auto a = plain.step(in);
        const auto b = wrapping.step(shifted);
        ASSERT_EQ(a.wrench.force_x_n, b.wrench.force_x_n);
        ASSERT_EQ(a.wrench.torque_nm, b.wrench.torque_nm);
    }
}

gw_controller_config_t with_bristles()
{
    auto config = trikey();
    config.estimator.friction_model = GW_FRICTION_BRISTLE;
    return config;
}

// Drivetrain torques (motors stuck) and displacement of the base under a push: stiffness of drivetrains and bristles.
struct Static {
    Eigen::Vector3d torque, shift;
};
Static static_push(const gw_controller_config_t &c, const Eigen::Vector3d &push)
{
    const Eigen::Matrix3d wheel = wheel_jacobian(c.geometry, 0.0);
    const Eigen::Matrix3d axles = static_cast<double>(c.geometry.roller_radius_m) * roller_jacobian(c.geometry, 0.0);
    Eigen::Vector3d sigma;
    for (int i = 0; i < 3; ++i) {
        sigma(i) = c.estimator.presliding.stiffness_n_per_m[i];
    }
    const double k = c.estimator.drivetrain_stiffness_nm_per_rad;
    const Eigen::Matrix3d stiffness = k * wheel.transpose() * wheel + axles.transpose() * sigma.asDiagonal() * axles;
    const Eigen::Vector3d shift = stiffness.fullPivLu().solve(push);
    return {-k * wheel * shift, shift};
}

TEST(Estimator, WhatRollersCarryPastTheWheelsIsSeenWithBristles)
{
    // 5.1: a push on the unpowered robot, all sticks. Wheels alone see k_w/(k_w + sigma0) of the force and the whole
    // moment (uniform bristles); with the bristle model, also for unequal bristles, both are seen completely.
    Random random(123);
    for (int trial = 0; trial < 200; ++trial) {
        auto config = with_bristles();
        const bool uniform = trial % 2 == 0;
        const double common = random.uniform(1.6e4, 6.7e4);
        for (auto &stiffness : config.estimator.presliding.stiffness_n_per_m) {
            stiffness = real(uniform ? common : random.uniform(1.6e4, 6.7e4));
        }
        config.geometry.azimuth_rad = real(random.uniform(-3.0, 3.0));
        auto paper_config = config;
        paper_config.estimator.friction_model = GW_FRICTION_TANH;
        Estimated e(config);
        Estimated paper(paper_config);
        const Eigen::Vector3d zero = random_vector(random, 3.0);
        e.tare(zero);
        paper.tare(zero);
        Eigen::Vector3d push = random_vector(random, 12.0);
        push(2) *= 0.2;
        gw_estimator_output_t out{};
        gw_estimator_output_t sensed{};
        // Pushed harder and harder, then held until the rates have died out: e^-60 of them is left, and of the damper.
        for (int k = 1; k <= 400; ++k) {
            const Static now = static_push(config, push * std::min(k, 100) / 100.0);
            out = e.step(moving_at(0.0, zero + now.torque));
            sensed = paper.step(moving_at(0.0, zero + now.torque));
            ASSERT_TRUE(gw_estimator_invariant_holds(e.state.get()));
        }
        EXPECT_EQ(out.regime, GW_REGIME_REST);
        // Offsets of 3 N m are 50 N at the wheels' rims.
        EXPECT_VECTOR_NEAR(vector(out.wrench), push, 100.0 * tolerance * 50.0);
        if (uniform) {
            const double radius = config.geometry.wheel_radius_m;
            const double wheel_stiffness = config.estimator.drivetrain_stiffness_nm_per_rad / radius / radius;
            const double sigma0 = config.estimator.presliding.stiffness_n_per_m[0];
            Eigen::Vector3d expected = push;
            expected.head<2>() *= wheel_stiffness / (wheel_stiffness + sigma0);
            EXPECT_VECTOR_NEAR(vector(sensed.wrench), expected, 100.0 * tolerance * 50.0);
        }
    }
}

TEST(Estimator, MotorsThatTurnMoveTheBristlesToo)
{
    // The same push with motors that give way by whole counts: what counts is where the wheels are.
    auto config = with_bristles();
    config.estimator.presliding.stribeck_speed_mps = real(1); // so that this jerk by some mm/s does not make them slide
    Estimated e(config);
    e.tare({0, 0, 0});
    (void)e.step(moving_at(0.0, {0, 0, 0}));
    const double count_rad = 2.0 * pi / 8500.0;
    const Eigen::Matrix3d wheel = wheel_jacobian(e.config.geometry, 0.0);
    const Eigen::Vector3d turned = Eigen::Vector3d(3, -2, 1) * count_rad;
    // The base is held by bristles alone: no torque, so wheels turned as the motors did.
    auto in = moving_at(0.0, {0, 0, 0});
    in.encoder_count[0] = 3;
    in.encoder_count[1] = -2;
    in.encoder_count[2] = 1;
    const auto out = e.step(in);
    const Eigen::Matrix3d axles =
        static_cast<double>(e.config.geometry.roller_radius_m) * roller_jacobian(e.config.geometry, 0.0);
    const Eigen::Vector3d shift = wheel.inverse() * turned;
    // Elastic part; the rate filters saw three counts within one tick, so the damper has a part, too.
    const Eigen::Vector3d measured = vector(out.measured_twist);
    const auto &bristle = config.estimator.presliding;
    const Eigen::Vector3d along = static_cast<double>(bristle.stiffness_n_per_m[0]) * axles * shift +
                                  static_cast<double>(bristle.damping_newton_s_per_m) * axles * measured;
    EXPECT_VECTOR_NEAR(vector(out.wrench), axles.transpose() * along, 100.0 * tolerance * along.norm());
}

TEST(Estimator, LeavingRestKeepsWhatTheBristlesHold)
{
    // After a stop the rollers stay deflected, and the tare of the stop takes this as zero. When the plan starts to
    // move again, nothing has happened yet, so the estimate must not jump. The tanh law forgets the deflection: it
    // jumps.
    for (const std::uint32_t model : {GW_FRICTION_BRISTLE, GW_FRICTION_TANH}) {
        auto config = with_bristles();
        config.estimator.friction_model = model;
        Estimated e(config);
        const Eigen::Vector3d offset(0.3, -0.2, 0.1);
        e.tare(offset);
        (void)e.step(moving_at(0.1, offset));
        const Eigen::Vector3d pull(8.0, -6.0, 0.0); // of the rollers on the base
        Static wound{};
        for (int k = 1; k <= 50; ++k) {
            wound = static_push(config, pull * k / 50.0);
            (void)e.step(moving_at(0.1, offset + wound.torque));
        }
        // Here a push deflects them; it lasts through the stop, so it becomes the zero.
        gw_estimator_output_t out{};
        for (int k = 0; k < 300; ++k) {
            out = e.step(moving_at(0.0, offset + wound.torque));
        }
        ASSERT_EQ(out.regime, GW_REGIME_REST);
        EXPECT_VECTOR_NEAR(vector(out.wrench), Eigen::Vector3d(0, 0, 0), 100.0 * tolerance * 50.0);
        auto in = moving_at(0.0, offset + wound.torque);
        in.planned_twist.omega_radps = real(0.01); // any plan; this one needs no force
        const auto left = e.step(in);
        ASSERT_NE(left.regime, GW_REGIME_REST);
        if (model == GW_FRICTION_BRISTLE) {
            // The run's zero does not contain the push that the stop's tare included: the full push is seen again.
            EXPECT_VECTOR_NEAR(vector(left.wrench), pull, 100.0 * tolerance * 50.0);
        } else {
            EXPECT_LT(vector(left.wrench).norm(), 0.9 * pull.norm());
        }
    }
}

TEST(Estimator, ANoisyEndOfATareIsNoPush)
{
    // The last sample of the tare is off by a tenth of a newton metre: 1.5 N at the rim. Without a correction the
    // bristles would keep this error for ever.
    Random random(124);
    Estimated e(with_bristles());
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (unsigned k = 0; k < e.config.estimator.tare_ticks; ++k) {
        const Eigen::Vector3d noisy = random_vector(random, 0.1);
        mean += vector(wheels(noisy)) / e.config.estimator.tare_ticks;
        (void)e.step(moving_at(0.0, noisy));
        const gw_wheels_t torque = wheels(noisy);
        (void)gw_estimator_tare(e.state.get(), &torque);
    }
    const auto out = e.step(moving_at(0.0, mean));
    EXPECT_EQ(out.regime, GW_REGIME_REST);
    // A hundred samples of 0.1 N m were summed, and traction is ten times the torque.
    EXPECT_VECTOR_NEAR(vector(out.wrench), Eigen::Vector3d(0, 0, 0), 1000.0 * tolerance);
}

TEST(Estimator, ARobotThatAlreadyMovesIsNotThrownIntoMotion)
{
    // No tare, 0.2 m/s from the first sample on: the measured acceleration starts at zero.
    auto config = with_bristles();
    config.estimator.acceleration_source = GW_SOURCE_MEASURED;
    config.estimator.tare_ticks = 0;
    config.estimator.encoder_counts = 1'000'000;
    Estimated e(config);
    const gw_wheels_t nothing{};
    EXPECT_EQ(gw_estimator_tare(e.state.get(), &nothing), GW_TARE_DONE);
    const Eigen::Vector3d rates = wheel_jacobian(config.geometry, 0.0) * Eigen::Vector3d(0.2, 0, 0);
    // The torques of steady motion along x: one roller slides ahead, two at half the speed.
    const Eigen::Matrix3d roller = roller_jacobian(config.geometry, 0.0);
    const Eigen::Vector3d friction = 0.2 * (0.4 * roller * Eigen::Vector3d(0.2, 0, 0)).array().tanh().matrix();
    const Eigen::Vector3d torque =
        wheel_jacobian(config.geometry, 0.0).transpose().inverse() * roller.transpose() * friction;
    double impulse = 0.0;
    double worst = 0.0;
    for (int k = 0; k < 300; ++k) {
        auto in = moving_at(0.2, torque);
        for (int i = 0; i < 3; ++i) {
            in.encoder_count[i] = static_cast<std::int32_t>(std::lround(rates(i) * k * 1e-3 / (2.0 * pi) * 1e6));
        }
        const auto out = e.step(in);
        impulse += out.wrench.force_x_n * 1e-3;
        worst = std::max(worst, std::fabs(impulse));
    }
    // The bristles reach their limit after some 2 mm, 10 ms, and carry less than 42 N until then; thrown into motion
    // the robot would seem to be hit by 34.7 kg x 0.2 m/s = 7 N s.
    EXPECT_LT(worst, 0.42);
    EXPECT_GT(worst, 0.01); // the bristles did start from zero
}

} // namespace
