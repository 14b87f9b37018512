#include "support.hpp"

namespace {

constexpr double period = 0.001;

gw_detector_config_t impulse_config() {
    gw_controller_config_t config;
    gw_controller_config_trikey(&config);
    return config.detector;
}

gw_detector_t detector_of(const gw_detector_config_t &config) {
    gw_detector_t d{};
    EXPECT_EQ(gw_detector_init(&d, &config, real(period)), GW_STATUS_OK);
    return d;
}

gw_detector_input_t input_of(const Eigen::Vector3d &w, gw_regime_t regime = GW_REGIME_REST) {
    gw_detector_input_t in{};
    in.wrench = wrench(w);
    in.mean = in.wrench;
    in.window_mean = in.wrench;
    in.mean_samples = 20;
    in.regime = regime;
    in.enabled = true;
    return in;
}

gw_detector_output_t step(gw_detector_t &d, const gw_detector_input_t &in) {
    gw_detector_output_t out{};
    EXPECT_EQ(gw_detector_step(&d, &in, &out), GW_STATUS_OK);
    EXPECT_TRUE(gw_detector_invariant_holds(&d));
    return out;
}

// Steps of a constant wrench until it trips; -1 if it does not within `most`.
int ticks_to_trip(gw_detector_t &d, const gw_detector_input_t &in, int most, gw_detector_output_t *last = nullptr) {
    for (int i = 1; i <= most; ++i) {
        const auto out = step(d, in);
        if (out.tripped) {
            if (last != nullptr) {
                *last = out;
            }
            return i;
        }
    }
    return -1;
}

TEST(Detector, ImpulseTripsWhenTheForceHasDeliveredIt) {
    // |I| = (F - F0) n T > J.
    const auto config = impulse_config();
    for (const auto &[regime, leak] : {std::pair{GW_REGIME_REST, config.leak_rest_n},
                                      std::pair{GW_REGIME_MOTION, config.leak_motion_n},
                                      std::pair{GW_REGIME_CREEPING, config.leak_creep_n}}) {
        for (const double force : {63.0, 100.0, 400.0}) { // none meets J at a tick
            for (const double angle : {0.0, 1.0, 2.5, -2.0}) {
                auto d = detector_of(config);
                gw_detector_output_t at_trip{};
                const auto in = input_of({force * std::cos(angle), force * std::sin(angle), 0.1 * force}, regime);
                const int ticks = ticks_to_trip(d, in, 5000, &at_trip);
                const double exact = config.impulse_threshold_newton_s / ((force - leak) * period);
                EXPECT_NEAR(ticks, std::floor(exact) + 1, is_double ? 0.0 : 1.0) << force << " " << leak;
                // Mean wrench: what leaked away is added again.
                EXPECT_VECTOR_NEAR(vector(at_trip.mean_wrench), vector(in.wrench), 30.0 * tolerance * force);
                EXPECT_EQ(static_cast<int>(at_trip.samples), ticks);
                EXPECT_GT(at_trip.statistic, config.impulse_threshold_newton_s);
                EXPECT_TRUE(at_trip.active);
            }
        }
    }
}

TEST(Detector, ForcesBelowTheLeakNeverTrip) {
    auto d = detector_of(impulse_config());
    EXPECT_EQ(ticks_to_trip(d, input_of({0.6, -0.7, 3.0}), 100'000), -1);
    EXPECT_EQ(ticks_to_trip(d, input_of({2.0, 2.0, 3.0}, GW_REGIME_MOTION), 100'000), -1);
    EXPECT_EQ(ticks_to_trip(d, input_of({29.0, -29.0, 3.0}, GW_REGIME_CREEPING), 100'000), -1);
}

TEST(Detector, NoiseAndAlternatingForcesCancel) {
    // The integral of |F| would trip on either within two seconds.
    Random random(61);
    auto d = detector_of(impulse_config());
    for (int i = 0; i < 600'000; ++i) {
        ASSERT_FALSE(step(d, input_of({random.normal(0.36), random.normal(0.36), random.normal(0.12)})).tripped) << i;
    }
    for (int i = 0; i < 20'000; ++i) {
        const double force = 50.0 * std::sin(2.0 * pi * 25.0 * i * period);
        ASSERT_FALSE(step(d, input_of({force, 0.0, 0.0})).tripped) << i;
    }
}

TEST(Detector, MomentShrinksWithTheImpulse) {
    // A force that wanders, at a constant lever arm: the mean wrench keeps the arm.
    Random random(62);
    auto d = detector_of(impulse_config());
    for (int i = 0; i < 1000; ++i) {
        const double force = random.uniform(0.0, 30.0);
        const auto out = step(d, input_of({force * 0.6, force * 0.8, force * 0.2}));
        if (out.samples > 0) {
            const double length = std::hypot(out.mean_wrench.force_x_n, out.mean_wrench.force_y_n);
            ASSERT_NEAR(out.mean_wrench.torque_nm / length, 0.2, 100.0 * tolerance);
        }
        if (out.tripped) {
            return;
        }
    }
    FAIL() << "never tripped";
}

TEST(Detector, HysteresisNeedsBlankingAndReleaseOrTheEndOfTheReaction) {
    const auto config = impulse_config();
    auto d = detector_of(config);
    const auto push = input_of({50.0, 0.0, 0.0});
    const int first = ticks_to_trip(d, push, 100);
    ASSERT_GT(first, 0);
    // Still pushed: stays active for ever, with nothing integrated.
    for (int i = 0; i < 5000; ++i) {
        const auto out = step(d, push);
        ASSERT_FALSE(out.tripped);
        ASSERT_TRUE(out.active);
        ASSERT_EQ(out.statistic, real(0));
    }
    // Released: armed again, a second hit takes as long as the first.
    EXPECT_FALSE(step(d, input_of({0.0, 0.0, 0.0})).active);
    EXPECT_EQ(ticks_to_trip(d, push, 100), first);
    // Within the blanking time a release does not count.
    int blank = 0;
    while (step(d, input_of({0.0, 0.0, 0.0})).active) {
        ++blank;
    }
    EXPECT_EQ(blank + 1, static_cast<int>(config.blanking_ticks));
    // The end of the reaction arms as well, pushed or not.
    ASSERT_GT(ticks_to_trip(d, push, 100), 0);
    auto over = push;
    over.reaction_over = true;
    EXPECT_EQ(ticks_to_trip(d, over, 5000), static_cast<int>(config.blanking_ticks) + first - 1);
}

TEST(Detector, ForceAverageTripsAboveItsThreshold) {
    auto config = impulse_config();
    config.kind = GW_DETECTOR_FORCE_AVERAGE;
    config.force_threshold_n = real(10);
    auto d = detector_of(config);
    EXPECT_EQ(ticks_to_trip(d, input_of({6.0, 7.9, 0.5}), 1000), -1);
    gw_detector_output_t at_trip{};
    EXPECT_EQ(ticks_to_trip(d, input_of({6.1, 8.0, 0.5}, GW_REGIME_MOTION), 1000, &at_trip), 1);
    EXPECT_NEAR(at_trip.statistic, std::hypot(6.1, 8.0), 20.0 * tolerance);
    EXPECT_EQ(at_trip.samples, 20U);
    // Creeping rollers can hold more than the threshold.
    d = detector_of(config);
    EXPECT_EQ(ticks_to_trip(d, input_of({41.0, 0.0, 0.0}, GW_REGIME_CREEPING), 1000), -1);
    EXPECT_EQ(ticks_to_trip(d, input_of({43.0, 0.0, 0.0}, GW_REGIME_CREEPING), 1000), 1);
    // It releases at the smaller of release force and threshold.
    config.release_force_n = real(100);
    config.blanking_ticks = 0;
    d = detector_of(config);
    ASSERT_EQ(ticks_to_trip(d, input_of({11.0, 0.0, 0.0}), 1), 1);
    EXPECT_TRUE(step(d, input_of({10.5, 0.0, 0.0})).active);
    EXPECT_FALSE(step(d, input_of({9.5, 0.0, 0.0})).active);
}

TEST(Detector, ClearEmptiesAndResetArms) {
    auto d = detector_of(impulse_config());
    const auto push = input_of({50.0, 0.0, 0.0});
    const int first = ticks_to_trip(d, push, 100);
    gw_detector_clear(&d);
    EXPECT_TRUE(step(d, push).active);
    gw_detector_reset(&d);
    for (int i = 1; i < first; ++i) {
        ASSERT_FALSE(step(d, push).tripped);
    }
    gw_detector_clear(&d);
    EXPECT_EQ(ticks_to_trip(d, push, 100), first);
    gw_detector_reset(&d);
    auto off = push;
    off.enabled = false;
    EXPECT_EQ(ticks_to_trip(d, off, 1000), -1);
    EXPECT_EQ(ticks_to_trip(d, push, 100), first);
}

TEST(Detector, BrokenInputsDoNotTripAndLeaveTheStateAlone) {
    auto d = detector_of(impulse_config());
    const auto push = input_of({50.0, 0.0, 0.0});
    const int first = ticks_to_trip(d, push, 100);
    gw_detector_reset(&d);
    for (int i = 1; i < first; ++i) {
        ASSERT_FALSE(step(d, push).tripped);
        for (const Real bad : {not_a_number, infinite, -infinite, real(2e9)}) {
            auto in = push;
            in.wrench.force_y_n = bad;
            gw_detector_output_t out{};
            ASSERT_EQ(gw_detector_step(&d, &in, &out), GW_STATUS_INPUT_INVALID);
            ASSERT_FALSE(out.tripped);
            in = push;
            in.mean.torque_nm = bad;
            ASSERT_EQ(gw_detector_step(&d, &in, &out), GW_STATUS_INPUT_INVALID);
        }
    }
    EXPECT_TRUE(step(d, push).tripped);
    gw_detector_output_t out{};
    gw_detector_t raw{};
    EXPECT_EQ(gw_detector_step(&raw, &push, &out), GW_STATUS_NOT_INITIALISED);
    EXPECT_EQ(gw_detector_step(nullptr, &push, &out), GW_STATUS_NULL_POINTER);
    EXPECT_EQ(gw_detector_step(&d, nullptr, &out), GW_STATUS_NULL_POINTER);
    EXPECT_EQ(gw_detector_step(&d, &push, nullptr), GW_STATUS_NULL_POINTER);
    auto config = impulse_config();
    EXPECT_EQ(gw_detector_init(&d, &config, real(0)), GW_STATUS_CONFIG_INVALID);
    EXPECT_EQ(gw_detector_step(&d, &push, &out), GW_STATUS_NOT_INITIALISED);
    EXPECT_EQ(gw_detector_init(nullptr, &config, real(0.001)), GW_STATUS_NULL_POINTER);
    EXPECT_EQ(gw_detector_init(&d, nullptr, real(0.001)), GW_STATUS_NULL_POINTER);
    EXPECT_FALSE(gw_detector_invariant_holds(nullptr));
}

} // namespace
