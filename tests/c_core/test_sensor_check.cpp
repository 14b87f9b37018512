#include "support.hpp"

namespace {

class Checked {
public:
    Checked() {
        gw_controller_config_t config;
        gw_controller_config_trikey(&config);
        EXPECT_EQ(gw_sensor_check_init(&check, &config.sensor_check), GW_STATUS_OK);
        sample.present = true;
    }
    // A new sample with the present values.
    gw_status_t fresh() {
        ++sample.counter;
        return same();
    }
    gw_status_t same() {
        const gw_status_t status = gw_sensor_check_step(&check, &sample);
        EXPECT_TRUE(gw_sensor_check_invariant_holds(&check));
        return status;
    }
    void expect_recovery() {
        for (int i = 0; i < 10; ++i) {
            ASSERT_EQ(fresh(), GW_STATUS_SENSOR_RECOVERING) << i;
        }
        ASSERT_EQ(fresh(), GW_STATUS_OK);
    }
    gw_sensor_check_t check{};
    gw_sensor_sample_t sample{};
};

TEST(SensorCheck, EqualValuesInARowAreLegal) {
    Checked c;
    for (int i = 0; i < 10'000; ++i) {
        ASSERT_EQ(c.fresh(), GW_STATUS_OK);
    }
}

TEST(SensorCheck, ACounterThatStopsIsStale) {
    Checked c;
    EXPECT_EQ(c.fresh(), GW_STATUS_OK);
    EXPECT_EQ(c.same(), GW_STATUS_OK);
    EXPECT_EQ(c.same(), GW_STATUS_OK);
    for (int i = 0; i < 1000; ++i) {
        ASSERT_EQ(c.same(), GW_STATUS_SENSOR_STALE); // the third tick without a sample, and for ever
    }
    c.expect_recovery();
    // The counter may wrap and may skip.
    c.sample.counter = 0xFFFF'FFFEU;
    for (int i = 0; i < 10; ++i) {
        ASSERT_EQ(c.fresh(), GW_STATUS_OK);
    }
    c.sample.counter += 77;
    EXPECT_EQ(c.fresh(), GW_STATUS_OK);
}

TEST(SensorCheck, AStoppedCounterNeverRecovers) {
    Checked c;
    EXPECT_EQ(c.fresh(), GW_STATUS_OK);
    c.sample.present = false;
    EXPECT_EQ(c.same(), GW_STATUS_SENSOR_MISSING);
    c.sample.present = true;
    for (int i = 0; i < 1000; ++i) {
        ASSERT_NE(c.same(), GW_STATUS_OK);
    }
}

TEST(SensorCheck, MissingNonFiniteAndSaturated) {
    Checked c;
    EXPECT_EQ(c.fresh(), GW_STATUS_OK);
    c.sample.present = false;
    EXPECT_EQ(c.fresh(), GW_STATUS_SENSOR_MISSING);
    c.sample.present = true;
    c.expect_recovery();
    const Real limit = c.check.config.torque_limit_nm;
    for (int wheel = 0; wheel < 3; ++wheel) {
        for (const Real bad : {not_a_number, infinite, -infinite}) {
            c.sample.torque_nm[wheel] = bad;
            EXPECT_EQ(c.fresh(), GW_STATUS_SENSOR_NONFINITE);
            c.sample.torque_nm[wheel] = real(0);
            c.expect_recovery();
        }
        for (const Real sign : {real(1), real(-1)}) {
            c.sample.torque_nm[wheel] = sign * std::nextafter(limit, real(0));
            EXPECT_EQ(c.fresh(), GW_STATUS_OK);
            c.sample.torque_nm[wheel] = sign * limit;
            EXPECT_EQ(c.fresh(), GW_STATUS_SENSOR_SATURATED);
            c.sample.torque_nm[wheel] = real(0);
            c.expect_recovery();
        }
    }
    // NaN beside a saturated one is reported as what is worse.
    c.sample.torque_nm[0] = limit;
    c.sample.torque_nm[2] = not_a_number;
    EXPECT_EQ(c.fresh(), GW_STATUS_SENSOR_NONFINITE);
}

TEST(SensorCheck, EncodersMayTurnAsFastAsAWheelCan) {
    Checked c;
    const int most = static_cast<int>(c.check.config.encoder_jump_counts);
    c.sample.encoder_count[1] = INT32_MAX - 100;
    EXPECT_EQ(c.fresh(), GW_STATUS_OK); // the first sample may be anything
    const auto turn = [&](int counts) {
        c.sample.encoder_count[1] = static_cast<std::int32_t>(static_cast<std::uint32_t>(c.sample.encoder_count[1]) +
                                                              static_cast<std::uint32_t>(counts));
    };
    turn(most); // over the wrap
    EXPECT_EQ(c.fresh(), GW_STATUS_OK);
    turn(-most);
    EXPECT_EQ(c.fresh(), GW_STATUS_OK);
    turn(most + 1);
    EXPECT_EQ(c.fresh(), GW_STATUS_ENCODER_JUMP);
    c.expect_recovery(); // the new place is the base from now on
    turn(-most - 1);
    EXPECT_EQ(c.fresh(), GW_STATUS_ENCODER_JUMP);
    c.expect_recovery();
    // Two ticks between samples: twice as far.
    EXPECT_EQ(c.same(), GW_STATUS_OK);
    turn(2 * most);
    EXPECT_EQ(c.fresh(), GW_STATUS_OK);
    EXPECT_EQ(c.same(), GW_STATUS_OK);
    turn(2 * most + 1);
    EXPECT_EQ(c.fresh(), GW_STATUS_ENCODER_JUMP);
    c.expect_recovery();
    // While samples were missing the wheels may have gone anywhere.
    c.sample.present = false;
    EXPECT_EQ(c.fresh(), GW_STATUS_SENSOR_MISSING);
    c.sample.present = true;
    turn(1'000'000);
    c.expect_recovery();
}

TEST(SensorCheck, BeforeTheFirstGoodSampleThereIsNothingToRecoverFrom) {
    Checked c;
    c.sample.present = false;
    for (int i = 0; i < 5; ++i) {
        EXPECT_EQ(c.fresh(), GW_STATUS_SENSOR_MISSING);
    }
    c.sample.present = true;
    EXPECT_EQ(c.fresh(), GW_STATUS_OK);
}

TEST(SensorCheck, Refusals) {
    gw_sensor_check_t check{};
    const gw_sensor_sample_t sample{};
    EXPECT_EQ(gw_sensor_check_step(&check, &sample), GW_STATUS_NOT_INITIALISED);
    EXPECT_EQ(gw_sensor_check_step(nullptr, &sample), GW_STATUS_NULL_POINTER);
    EXPECT_EQ(gw_sensor_check_step(&check, nullptr), GW_STATUS_NULL_POINTER);
    gw_controller_config_t config;
    gw_controller_config_trikey(&config);
    EXPECT_EQ(gw_sensor_check_init(nullptr, &config.sensor_check), GW_STATUS_NULL_POINTER);
    EXPECT_EQ(gw_sensor_check_init(&check, nullptr), GW_STATUS_NULL_POINTER);
    config.sensor_check.recover_ticks = 0;
    EXPECT_EQ(gw_sensor_check_init(&check, &config.sensor_check), GW_STATUS_CONFIG_INVALID);
    EXPECT_FALSE(gw_sensor_check_invariant_holds(&check));
    EXPECT_FALSE(gw_sensor_check_invariant_holds(nullptr));
}

} // namespace
