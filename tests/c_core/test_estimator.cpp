#include <memory>

#include "support.hpp"

namespace {

struct Estimated {
    explicit Estimated(gw_controller_config_t chosen) : config(chosen) {
        EXPECT_EQ(gw_estimator_init(state.get(), &config.estimator, &config.geometry, &config.base, &config.friction,
                                    config.period_s),
                  GW_STATUS_OK);
    }
    gw_estimator_output_t step(const gw_estimator_input_t &input) {
        gw_estimator_output_t out{};
        EXPECT_EQ(gw_estimator_step(state.get(), &input, &out), GW_STATUS_OK);
        return out;
    }
    void tare(const Eigen::Vector3d &zero) {
        const gw_wheels_t torque = wheels(zero);
        for (unsigned i = 1; i <= config.estimator.tare_ticks; ++i) {
            ASSERT_EQ(gw_estimator_tare(state.get(), &torque),
                      i == config.estimator.tare_ticks ? GW_TARE_DONE : GW_TARE_RUNNING);
        }
    }
    gw_controller_config_t config;
    std::unique_ptr<gw_estimator_t> state = std::make_unique<gw_estimator_t>();
};

gw_controller_config_t trikey() {
    gw_controller_config_t config;
    gw_controller_config_trikey(&config);
    return config;
}

gw_estimator_input_t moving_at(double speed, const Eigen::Vector3d &torque) {
    gw_estimator_input_t in{};
    in.torque_nm = wheels(torque);
    in.planned_twist.vx_mps = real(speed);
    return in;
}

// A push on a standing robot whose sensors have offsets: recovered to 1e-9.
TEST(Estimator, PushAtRestWithSensorOffsets) {
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

TEST(Estimator, RestIsDeclaredByAQuietTareAtTheEndOfTheWait) {
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
    // In motion again, the zero is that of the run.
    const auto again = e.step(moving_at(0.2, run_zero));
    EXPECT_EQ(again.regime, GW_REGIME_MOTION);
    EXPECT_VECTOR_NEAR(vector(again.nominal_nm) - run_zero, vector(gw_nominal_torques(&e.state->nominal,
                                                                  &e.state->kinematics, {real(0.2), real(0), real(0)},
                                                                  {real(0), real(0), real(0)})),
                       10.0 * tolerance);
}

TEST(Estimator, AShakenRobotIsNotTared) {
    Estimated e(trikey());
    e.tare({0, 0, 0});
    (void)e.step(moving_at(0.1, {0, 0, 0}));
    for (int i = 0; i < 2000; ++i) {
        const double shake = i % 2 == 0 ? 1.0 : -1.0;
        ASSERT_EQ(e.step(moving_at(0.0, {shake, 0, 0})).regime, GW_REGIME_CREEPING);
    }
    for (int i = 0; i < 99; ++i) {
        ASSERT_EQ(e.step(moving_at(0.0, {0.5, 0, 0})).regime, GW_REGIME_CREEPING) << i;
    }
    EXPECT_EQ(e.step(moving_at(0.0, {0.5, 0, 0})).regime, GW_REGIME_REST);
}

TEST(Estimator, ATurningRobotIsNotAtRest) {
    Estimated e(trikey());
    e.tare({0, 0, 0});
    auto in = moving_at(0.0, {0, 0, 0});
    in.planned_twist.omega_radps = real(1.0);
    EXPECT_EQ(e.step(in).regime, GW_REGIME_MOTION);
}

TEST(Estimator, MeasuredSourcesSeeARobotThatIsPushedAway) {
    // Motors hold, the base accelerates by a push: the planned form sees only what the wheels carry, the measured one
    // all of it.
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

TEST(Estimator, ZeroAccelerationSourceLeavesInertiaOut) {
    auto config = trikey();
    config.estimator.acceleration_source = GW_SOURCE_ZERO;
    Estimated e(config);
    e.tare({0, 0, 0});
    auto in = moving_at(0.2, {0, 0, 0});
    in.planned_acceleration = {real(1), real(-2), real(3)};
    const auto with = e.step(in);
    in.planned_acceleration = {real(0), real(0), real(0)};
    EXPECT_VECTOR_NEAR(vector(e.step(in).nominal_nm), vector(with.nominal_nm), 0.0);
}

TEST(Estimator, CountersMayWrap) {
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

TEST(Estimator, EncoderAngleIsWithinOneTurn) {
    Estimated e(trikey());
    for (const std::int32_t count : {0, 1, 4250, 8499, 8500, -1, INT32_MAX, INT32_MIN}) {
        const Real angle = gw_estimator_encoder_angle(e.state.get(), count);
        const long double truth = static_cast<long double>(count % 8500) * 2.0L * std::numbers::pi_v<long double> / 8500;
        EXPECT_LE(std::fabs(std::remainder(angle - truth, 2.0L * std::numbers::pi_v<long double>)), 8.0L * epsilon);
        EXPECT_GE(angle, -GW_PI);
        EXPECT_LT(angle, GW_PI);
    }
}

TEST(Estimator, BrokenInputsGiveNoWrenchAndLeaveNoTrace) {
    Estimated e(trikey());
    e.tare({0, 0, 0});
    gw_estimator_output_t out{};
    for (const Real bad : {not_a_number, infinite, GW_REAL_MAX}) {
        auto in = moving_at(0.0, {0, 0, 0});
        in.torque_nm.wheel[1] = bad;
        EXPECT_EQ(gw_estimator_step(e.state.get(), &in, &out), GW_STATUS_INPUT_INVALID);
        EXPECT_EQ(out.wrench.force_x_n, real(0));
        EXPECT_EQ(out.mean_samples, 0U);
        in = moving_at(0.0, {0, 0, 0});
        in.planned_acceleration.ay_mps2 = bad;
        if (bad != GW_REAL_MAX) {
            EXPECT_EQ(gw_estimator_step(e.state.get(), &in, &out), GW_STATUS_INPUT_INVALID);
        }
        ASSERT_TRUE(gw_estimator_invariant_holds(e.state.get()));
        EXPECT_VECTOR_NEAR(vector(e.step(moving_at(0.0, {0, 0, 0})).wrench), Eigen::Vector3d(0, 0, 0), 0.0);
    }
    auto raw = std::make_unique<gw_estimator_t>();
    const auto in = moving_at(0.0, {0, 0, 0});
    EXPECT_EQ(gw_estimator_step(raw.get(), &in, &out), GW_STATUS_NOT_INITIALISED);
    EXPECT_FALSE(gw_estimator_invariant_holds(raw.get()));
    EXPECT_FALSE(gw_estimator_invariant_holds(nullptr));
    auto config = trikey();
    EXPECT_EQ(gw_estimator_init(nullptr, &config.estimator, &config.geometry, &config.base, &config.friction,
                                config.period_s),
              GW_STATUS_NULL_POINTER);
    EXPECT_EQ(gw_estimator_init(raw.get(), &config.estimator, nullptr, &config.base, &config.friction, config.period_s),
              GW_STATUS_NULL_POINTER);
    EXPECT_EQ(gw_estimator_init(raw.get(), &config.estimator, &config.geometry, nullptr, &config.friction,
                                config.period_s),
              GW_STATUS_NULL_POINTER);
    config.estimator.rest_ticks = 0;
    EXPECT_EQ(gw_estimator_init(raw.get(), &config.estimator, &config.geometry, &config.base, &config.friction,
                                config.period_s),
              GW_STATUS_CONFIG_INVALID);
    EXPECT_FALSE(gw_estimator_invariant_holds(raw.get()));
}

} // namespace
