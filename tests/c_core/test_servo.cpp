#include "support.hpp"

namespace {

gw_servo_config_t trikey_servo() {
    gw_servo_config_t c{};
    c.period_s = real(0.0005);
    c.kp_nm_per_rad = GW_TRIKEY_SERVO_KP_NM_PER_RAD;
    c.kd_nms_per_rad = GW_TRIKEY_SERVO_KD_NMS_PER_RAD;
    c.torque_limit_nm = GW_TRIKEY_DRIVETRAIN_TORQUE_LIMIT_NM;
    c.torque_rate_limit_nm_per_s = real(0);
    c.encoder_counts = GW_TRIKEY_DRIVETRAIN_ENCODER_COUNTS;
    c.derivative_cutoff_hz = GW_TRIKEY_SERVO_DERIVATIVE_CUTOFF_HZ;
    c.stale_ticks_max = 10;
    return c;
}

gw_servo_t servo_of(const gw_servo_config_t &config) {
    gw_servo_t s{};
    EXPECT_EQ(gw_servo_init(&s, &config), GW_STATUS_OK);
    return s;
}

gw_servo_input_t input_of(double angle, double speed, std::int32_t count, bool is_new = true) {
    return {real(angle), real(speed), is_new, true, count};
}

constexpr double rad_per_count = 2.0 * pi / 8500;
constexpr double kp = GW_TRIKEY_SERVO_KP_NM_PER_RAD;
constexpr double kd = GW_TRIKEY_SERVO_KD_NMS_PER_RAD;

TEST(Servo, TorqueIsProportionalDerivative) {
    auto s = servo_of(trikey_servo());
    gw_servo_output_t out{};
    Random random(101);
    double filtered = 0.0;
    std::int32_t count = 100;
    std::int32_t before = count;
    const double gain = -std::expm1(-2.0 * pi * 60.0 * 0.0005);
    for (int i = 0; i < 2000; ++i) {
        if (i > 0) {
            count += random.integer(-3, 3);
        }
        const double angle = count * rad_per_count + random.uniform(-0.04, 0.04);
        const double speed = random.uniform(-0.5, 0.5);
        const auto in = input_of(angle, speed, count);
        ASSERT_EQ(gw_servo_step(&s, &in, &out), GW_STATUS_OK);
        filtered += gain * ((count - before) * rad_per_count / 0.0005 - filtered);
        before = count;
        const double wanted = kp * (angle - count * rad_per_count) + kd * (speed - filtered);
        // Speeds from counts reach 4.4 rad/s, angles are rounded to 2e-7 and multiplied by kp.
        ASSERT_NEAR(out.torque_nm, std::clamp(wanted, -20.0, 20.0), is_double ? 1e-9 : 5e-4) << i;
        ASSERT_NEAR(out.speed_radps, filtered, 100.0 * tolerance);
        ASSERT_TRUE(gw_servo_invariant_holds(&s));
    }
}

TEST(Servo, SaturatesAndKeepsItsTorqueRate) {
    auto config = trikey_servo();
    config.torque_rate_limit_nm_per_s = real(10'000); // 5 N m per tick
    auto s = servo_of(config);
    gw_servo_output_t out{};
    auto in = input_of(0.0, 0.0, 0);
    ASSERT_EQ(gw_servo_step(&s, &in, &out), GW_STATUS_OK);
    in = input_of(1.0, 0.0, 0);
    for (const double expected : {5.0, 10.0, 15.0, 20.0, 20.0}) {
        ASSERT_EQ(gw_servo_step(&s, &in, &out), GW_STATUS_OK);
        EXPECT_NEAR(out.torque_nm, expected, 20.0 * tolerance);
    }
    in.angle_rad = real(-1.0);
    ASSERT_EQ(gw_servo_step(&s, &in, &out), GW_STATUS_OK);
    EXPECT_NEAR(out.torque_nm, 15.0, 20.0 * tolerance);
}

TEST(Servo, TheErrorTakesTheShortWayRound) {
    auto s = servo_of(trikey_servo());
    gw_servo_output_t out{};
    // Measured just below half a turn, wanted just above it (which is -pi + 0.01).
    auto in = input_of(-pi + 0.01, 0.0, 4250 - 10);
    ASSERT_EQ(gw_servo_step(&s, &in, &out), GW_STATUS_OK);
    EXPECT_NEAR(out.angle_error_rad, 0.01 + 10 * rad_per_count, 10.0 * tolerance);
}

TEST(Servo, ReferencesAreExtrapolatedBetweenTheirArrivals) {
    auto s = servo_of(trikey_servo());
    gw_servo_output_t out{};
    auto in = input_of(pi - 0.001, 2.0, 4250);
    ASSERT_EQ(gw_servo_step(&s, &in, &out), GW_STATUS_OK);
    const double first = out.angle_error_rad;
    in.reference_is_new = false;
    for (int i = 1; i < 10; ++i) {
        ASSERT_EQ(gw_servo_step(&s, &in, &out), GW_STATUS_OK) << i;
        EXPECT_NEAR(out.angle_error_rad - first, i * 0.0005 * 2.0, 10.0 * tolerance);
    }
    // Stale at the tenth tick: the angle stays, the speed is zero.
    ASSERT_EQ(gw_servo_step(&s, &in, &out), GW_STATUS_REFERENCE_STALE);
    const double held = out.angle_error_rad;
    for (int i = 0; i < 100; ++i) {
        ASSERT_EQ(gw_servo_step(&s, &in, &out), GW_STATUS_REFERENCE_STALE);
        ASSERT_EQ(out.angle_error_rad, real(held));
        ASSERT_NEAR(out.torque_nm, kp * held, 100.0 * tolerance);
    }
    in.reference_is_new = true;
    EXPECT_EQ(gw_servo_step(&s, &in, &out), GW_STATUS_OK);
}

TEST(Servo, BadReferencesHoldTheLastAngle) {
    auto s = servo_of(trikey_servo());
    gw_servo_output_t out{};
    auto in = input_of(0.02, 0.3, 0);
    ASSERT_EQ(gw_servo_step(&s, &in, &out), GW_STATUS_OK);
    for (const Real bad : {not_a_number, infinite, real(2e4)}) {
        for (const bool in_angle : {true, false}) {
            auto broken = in;
            (in_angle ? broken.angle_rad : broken.speed_radps) = bad;
            for (int i = 0; i < 30; ++i) {
                ASSERT_EQ(gw_servo_step(&s, &broken, &out), GW_STATUS_REFERENCE_INVALID);
                ASSERT_NEAR(out.torque_nm, kp * 0.02, 100.0 * tolerance);
                broken.reference_is_new = false;
            }
        }
    }
    EXPECT_EQ(gw_servo_step(&s, &in, &out), GW_STATUS_OK);
}

TEST(Servo, HoldsTheMeasuredAngleBeforeTheFirstReference) {
    auto s = servo_of(trikey_servo());
    gw_servo_output_t out{};
    auto in = input_of(2.0, 1.0, 3000, false);
    for (int i = 0; i < 100; ++i) {
        (void)gw_servo_step(&s, &in, &out);
        ASSERT_NEAR(out.torque_nm, 0.0, 300.0 * tolerance);
    }
}

TEST(Servo, DisabledMeansNoTorque) {
    auto s = servo_of(trikey_servo());
    gw_servo_output_t out{};
    auto in = input_of(0.5, 0.0, 0);
    in.enable = false;
    for (int i = 0; i < 30; ++i) {
        ASSERT_EQ(gw_servo_step(&s, &in, &out), GW_STATUS_OK);
        ASSERT_EQ(out.torque_nm, real(0));
    }
    // Disabled and without a reference, it will hold where it is when enabled, not where it was.
    in.reference_is_new = false;
    for (int i = 0; i < 30; ++i) {
        in.encoder_count = 1000;
        (void)gw_servo_step(&s, &in, &out);
        ASSERT_EQ(out.torque_nm, real(0));
    }
    for (int i = 0; i < 300; ++i) {
        (void)gw_servo_step(&s, &in, &out); // lets the speed filter settle
    }
    in.enable = true;
    (void)gw_servo_step(&s, &in, &out);
    EXPECT_NEAR(out.torque_nm, 0.0, 300.0 * tolerance);
}

TEST(Servo, CountsMayWrapAtAnyTime) {
    // The same motion seen by a counter that wraps at 32 bits in the middle. 2^32 is no multiple of 8500.
    auto plain = servo_of(trikey_servo());
    auto wrapping = servo_of(trikey_servo());
    gw_servo_output_t a{};
    gw_servo_output_t b{};
    const std::uint32_t offset = 0x7FFF'FF00U;
    const std::uint32_t turn_offset = offset % 8500U;
    for (int i = 0; i < 5000; ++i) {
        const auto moved = static_cast<std::uint32_t>(i);
        auto in = input_of(0.0, 0.0, static_cast<std::int32_t>(turn_offset + moved));
        ASSERT_EQ(gw_servo_step(&plain, &in, &a), GW_STATUS_OK);
        in.encoder_count = static_cast<std::int32_t>(offset + moved);
        ASSERT_EQ(gw_servo_step(&wrapping, &in, &b), GW_STATUS_OK);
        ASSERT_EQ(a.torque_nm, b.torque_nm) << i;
    }
}

TEST(Servo, Refusals) {
    auto config = trikey_servo();
    gw_servo_t s{};
    gw_servo_output_t out{};
    const auto in = input_of(0.5, 0.0, 0);
    EXPECT_EQ(gw_servo_step(&s, &in, &out), GW_STATUS_NOT_INITIALISED);
    EXPECT_EQ(out.torque_nm, real(0));
    EXPECT_EQ(gw_servo_init(nullptr, &config), GW_STATUS_NULL_POINTER);
    EXPECT_EQ(gw_servo_init(&s, nullptr), GW_STATUS_NULL_POINTER);
    config.kd_nms_per_rad = not_a_number;
    EXPECT_EQ(gw_servo_init(&s, &config), GW_STATUS_CONFIG_INVALID);
    EXPECT_FALSE(gw_servo_invariant_holds(&s));
    EXPECT_FALSE(gw_servo_invariant_holds(nullptr));
    EXPECT_EQ(gw_servo_step(nullptr, &in, &out), GW_STATUS_NULL_POINTER);
    EXPECT_EQ(gw_servo_step(&s, nullptr, &out), GW_STATUS_NULL_POINTER);
    EXPECT_EQ(gw_servo_step(&s, &in, nullptr), GW_STATUS_NULL_POINTER);
}

} // namespace
