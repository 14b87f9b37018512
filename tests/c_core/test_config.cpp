// Every configuration field: its bounds are accepted, their floating-point neighbours and NaN are refused by name.
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "support.hpp"

namespace {

using Setter = std::function<void(gw_controller_config_t &, double)>;
using ServoSetter = std::function<void(gw_servo_config_t &, double)>;

template <class Config, class Member> auto set(Member member) {
    return [member](Config &config, double value) {
        auto &field = member(config);
        field = static_cast<std::remove_reference_t<decltype(field)>>(value);
    };
}

#define CONTROLLER_FIELD(member) set<gw_controller_config_t>([](gw_controller_config_t &c) -> auto & { return c.member; })
#define SERVO_FIELD(member) set<gw_servo_config_t>([](gw_servo_config_t &c) -> auto & { return c.member; })

const std::map<gw_config_field_t, Setter> real_fields = {
    {GW_FIELD_CONTROLLER_PERIOD, CONTROLLER_FIELD(period_s)},
    {GW_FIELD_GEOMETRY_WHEEL_RADIUS, CONTROLLER_FIELD(geometry.wheel_radius_m)},
    {GW_FIELD_GEOMETRY_ROLLER_RADIUS, CONTROLLER_FIELD(geometry.roller_radius_m)},
    {GW_FIELD_GEOMETRY_WHEEL_DISTANCE, CONTROLLER_FIELD(geometry.wheel_distance_m)},
    {GW_FIELD_GEOMETRY_AZIMUTH, CONTROLLER_FIELD(geometry.azimuth_rad)},
    {GW_FIELD_BASE_MASS, CONTROLLER_FIELD(base.mass_kg)},
    {GW_FIELD_BASE_YAW_INERTIA, CONTROLLER_FIELD(base.yaw_inertia_kgm2)},
    {GW_FIELD_BASE_WHEEL_INERTIA, CONTROLLER_FIELD(base.wheel_inertia_kgm2)},
    {GW_FIELD_BASE_ROLLER_INERTIA, CONTROLLER_FIELD(base.roller_inertia_kgm2)},
    {GW_FIELD_FRICTION_COULOMB_TORQUE, CONTROLLER_FIELD(friction.coulomb_torque_nm)},
    {GW_FIELD_FRICTION_TANH_SLOPE, CONTROLLER_FIELD(friction.tanh_slope_s_per_rad)},
    {GW_FIELD_SENSOR_CHECK_TORQUE_LIMIT, CONTROLLER_FIELD(sensor_check.torque_limit_nm)},
    {GW_FIELD_ESTIMATOR_TORQUE_NOISE, CONTROLLER_FIELD(estimator.torque_noise_nm)},
    {GW_FIELD_ESTIMATOR_RATE_CUTOFF, CONTROLLER_FIELD(estimator.rate_cutoff_radps)},
    {GW_FIELD_ESTIMATOR_DRIVETRAIN_STIFFNESS, CONTROLLER_FIELD(estimator.drivetrain_stiffness_nm_per_rad)},
    {GW_FIELD_ESTIMATOR_REST_SPEED, CONTROLLER_FIELD(estimator.rest_speed_mps)},
    {GW_FIELD_ESTIMATOR_CREEP_SPEED, CONTROLLER_FIELD(estimator.creep_speed_mps)},
    {GW_FIELD_ESTIMATOR_TARE_VARIATION, CONTROLLER_FIELD(estimator.tare_variation_nm)},
    {GW_FIELD_ESTIMATOR_PRESLIDING_DAMPING, CONTROLLER_FIELD(estimator.presliding.damping_newton_s_per_m)},
    {GW_FIELD_ESTIMATOR_STRIBECK_SPEED, CONTROLLER_FIELD(estimator.presliding.stribeck_speed_mps)},
    {GW_FIELD_ESTIMATOR_ELASTIC_FRACTION, CONTROLLER_FIELD(estimator.presliding.elastic_fraction)},
    {GW_FIELD_CONTACT_MINIMUM_FORCE, CONTROLLER_FIELD(contact.minimum_force_n)},
    {GW_FIELD_DETECTOR_FORCE_THRESHOLD, CONTROLLER_FIELD(detector.force_threshold_n)},
    {GW_FIELD_DETECTOR_IMPULSE_THRESHOLD, CONTROLLER_FIELD(detector.impulse_threshold_newton_s)},
    {GW_FIELD_DETECTOR_LEAK_REST, CONTROLLER_FIELD(detector.leak_rest_n)},
    {GW_FIELD_DETECTOR_LEAK_CREEP, CONTROLLER_FIELD(detector.leak_creep_n)},
    {GW_FIELD_DETECTOR_LEAK_MOTION, CONTROLLER_FIELD(detector.leak_motion_n)},
    {GW_FIELD_DETECTOR_RELEASE_FORCE, CONTROLLER_FIELD(detector.release_force_n)},
    {GW_FIELD_ADMITTANCE_MASS, CONTROLLER_FIELD(admittance.mass_kg)},
    {GW_FIELD_ADMITTANCE_DAMPING, CONTROLLER_FIELD(admittance.damping_newton_s_per_m)},
    {GW_FIELD_ADMITTANCE_ESCAPE_IMPULSE, CONTROLLER_FIELD(admittance.escape_impulse_newton_s)},
    {GW_FIELD_ADMITTANCE_SPEED_LIMIT, CONTROLLER_FIELD(admittance.speed_limit_mps)},
    {GW_FIELD_ADMITTANCE_ACCELERATION_LIMIT, CONTROLLER_FIELD(admittance.acceleration_limit_mps2)},
    {GW_FIELD_ADMITTANCE_FINISH_SPEED, CONTROLLER_FIELD(admittance.finish_speed_mps)},
    {GW_FIELD_REFERENCE_FOLLOW_GAIN, CONTROLLER_FIELD(reference.follow_gain_per_s)},
    {GW_FIELD_REFERENCE_SPEED_LIMIT, CONTROLLER_FIELD(reference.speed_limit_mps)},
    {GW_FIELD_REFERENCE_ACCELERATION_LIMIT, CONTROLLER_FIELD(reference.acceleration_limit_mps2)},
    {GW_FIELD_REFERENCE_YAW_RATE_LIMIT, CONTROLLER_FIELD(reference.yaw_rate_limit_radps)},
    {GW_FIELD_REFERENCE_YAW_ACCELERATION_LIMIT, CONTROLLER_FIELD(reference.yaw_acceleration_limit_radps2)},
    {GW_FIELD_REFERENCE_REJOIN_SPEED, CONTROLLER_FIELD(reference.rejoin_speed_mps)},
    {GW_FIELD_REFERENCE_FINISH_SPEED, CONTROLLER_FIELD(reference.finish_speed_mps)},
    {GW_FIELD_SUPERVISOR_SETTLED_SPEED, CONTROLLER_FIELD(supervisor.settled_speed_mps)},
    {GW_FIELD_SUPERVISOR_REJOIN_DISTANCE, CONTROLLER_FIELD(supervisor.rejoin_distance_m)},
    {GW_FIELD_SUPERVISOR_REJOIN_ANGLE, CONTROLLER_FIELD(supervisor.rejoin_angle_rad)},
};

const std::map<gw_config_field_t, Setter> count_fields = {
    {GW_FIELD_SENSOR_CHECK_STALE_TICKS_MAX, CONTROLLER_FIELD(sensor_check.stale_ticks_max)},
    {GW_FIELD_SENSOR_CHECK_ENCODER_JUMP, CONTROLLER_FIELD(sensor_check.encoder_jump_counts)},
    {GW_FIELD_SENSOR_CHECK_RECOVER_TICKS, CONTROLLER_FIELD(sensor_check.recover_ticks)},
    {GW_FIELD_ESTIMATOR_VELOCITY_SOURCE, CONTROLLER_FIELD(estimator.velocity_source)},
    {GW_FIELD_ESTIMATOR_ACCELERATION_SOURCE, CONTROLLER_FIELD(estimator.acceleration_source)},
    {GW_FIELD_ESTIMATOR_ENCODER_COUNTS, CONTROLLER_FIELD(estimator.encoder_counts)},
    {GW_FIELD_ESTIMATOR_AVERAGE_WINDOW, CONTROLLER_FIELD(estimator.average_window)},
    {GW_FIELD_ESTIMATOR_REST_TICKS, CONTROLLER_FIELD(estimator.rest_ticks)},
    {GW_FIELD_ESTIMATOR_TARE_TICKS, CONTROLLER_FIELD(estimator.tare_ticks)},
    {GW_FIELD_ESTIMATOR_RETARE_TICKS, CONTROLLER_FIELD(estimator.retare_ticks)},
    {GW_FIELD_ESTIMATOR_FRICTION_MODEL, CONTROLLER_FIELD(estimator.friction_model)},
    {GW_FIELD_DETECTOR_KIND, CONTROLLER_FIELD(detector.kind)},
    {GW_FIELD_DETECTOR_BLANKING_TICKS, CONTROLLER_FIELD(detector.blanking_ticks)},
    {GW_FIELD_ADMITTANCE_KIND, CONTROLLER_FIELD(admittance.kind)},
    {GW_FIELD_SUPERVISOR_SETTLED_TICKS, CONTROLLER_FIELD(supervisor.settled_ticks)},
    {GW_FIELD_SUPERVISOR_AFTER_SETTLED, CONTROLLER_FIELD(supervisor.after_settled)},
};

const std::map<gw_config_field_t, ServoSetter> servo_real_fields = {
    {GW_FIELD_SERVO_PERIOD, SERVO_FIELD(period_s)},
    {GW_FIELD_SERVO_KP, SERVO_FIELD(kp_nm_per_rad)},
    {GW_FIELD_SERVO_KD, SERVO_FIELD(kd_nms_per_rad)},
    {GW_FIELD_SERVO_TORQUE_LIMIT, SERVO_FIELD(torque_limit_nm)},
    {GW_FIELD_SERVO_TORQUE_RATE_LIMIT, SERVO_FIELD(torque_rate_limit_nm_per_s)},
    {GW_FIELD_SERVO_DERIVATIVE_CUTOFF, SERVO_FIELD(derivative_cutoff_hz)},
};

const std::map<gw_config_field_t, ServoSetter> servo_count_fields = {
    {GW_FIELD_SERVO_ENCODER_COUNTS, SERVO_FIELD(encoder_counts)},
    {GW_FIELD_SERVO_STALE_TICKS_MAX, SERVO_FIELD(stale_ticks_max)},
};

// Tested on their own: arrays and the rule on the whole outline.
const std::set<gw_config_field_t> special_fields = {GW_FIELD_NONE,      GW_FIELD_GEOMETRY_WHEEL_SLOT,
                                                    GW_FIELD_OUTLINE_COUNT, GW_FIELD_OUTLINE_X,
                                                    GW_FIELD_OUTLINE_Y,     GW_FIELD_OUTLINE_CONVEX,
                                                    GW_FIELD_ESTIMATOR_PRESLIDING_STIFFNESS};

gw_controller_config_t trikey() {
    gw_controller_config_t config;
    gw_controller_config_trikey(&config);
    return config;
}

gw_servo_config_t servo() {
    return {real(0.0005), real(203), real(8), real(20), real(0), 8500, real(60), 10};
}

gw_config_field_t refused(const gw_controller_config_t &config) {
    static const auto controller = std::make_unique<gw_controller_t>();
    gw_config_error_t error{};
    const gw_status_t status = gw_controller_init(controller.get(), &config, &error);
    EXPECT_EQ(status, error.field == GW_FIELD_NONE ? GW_STATUS_OK : GW_STATUS_CONFIG_INVALID);
    EXPECT_EQ(gw_controller_invariant_holds(controller.get()), status == GW_STATUS_OK);
    return error.field;
}

gw_config_field_t refused(const gw_servo_config_t &config) {
    gw_servo_t state{};
    gw_config_error_t error{};
    gw_config_check_begin(&error);
    gw_servo_config_check(&config, &error);
    EXPECT_EQ(gw_servo_init(&state, &config), error.field == GW_FIELD_NONE ? GW_STATUS_OK : GW_STATUS_CONFIG_INVALID);
    EXPECT_EQ(gw_servo_invariant_holds(&state), error.field == GW_FIELD_NONE);
    return error.field;
}

template <class Config, class Fields> void check_real_bounds(const Config &good, const Fields &fields) {
    for (const auto &[field, setter] : fields) {
        const gw_config_limit_t limit = gw_config_limit(field);
        SCOPED_TRACE(gw_config_name(field));
        const auto with = [&](Real value) {
            Config config = good;
            setter(config, static_cast<double>(value));
            return refused(config);
        };
        EXPECT_EQ(with(limit.minimum), GW_FIELD_NONE);
        EXPECT_EQ(with(limit.maximum), GW_FIELD_NONE);
        for (const Real bad : {std::nextafter(limit.minimum, -infinite), std::nextafter(limit.maximum, infinite),
                               -infinite, infinite, not_a_number}) {
            EXPECT_EQ(with(bad), field) << bad;
        }
    }
}

template <class Config, class Fields> void check_count_bounds(const Config &good, const Fields &fields) {
    for (const auto &[field, setter] : fields) {
        const gw_config_limit_t limit = gw_config_limit(field);
        SCOPED_TRACE(gw_config_name(field));
        const auto with = [&](double value) {
            Config config = good;
            setter(config, value);
            return refused(config);
        };
        EXPECT_EQ(with(limit.minimum), GW_FIELD_NONE);
        EXPECT_EQ(with(limit.maximum), GW_FIELD_NONE);
        if (limit.minimum > 0) {
            EXPECT_EQ(with(static_cast<double>(limit.minimum) - 1.0), field);
        }
        EXPECT_EQ(with(static_cast<double>(limit.maximum) + 1.0), field);
        EXPECT_EQ(with(4294967295.0), field);
    }
}

TEST(Config, TrikeyIsAccepted) { EXPECT_EQ(refused(trikey()), GW_FIELD_NONE); }

TEST(Config, EveryRealFieldAtItsBoundsAndTheirNeighbours) {
    auto config = trikey();
    // Room for the relation between gain and period at the period's maximum and the gain's maximum.
    config.reference.follow_gain_per_s = real(2);
    check_real_bounds(config, real_fields);
    check_real_bounds(servo(), servo_real_fields);
}

TEST(Config, EveryCountAtItsBoundsAndTheirNeighbours) {
    check_count_bounds(trikey(), count_fields);
    check_count_bounds(servo(), servo_count_fields);
}

TEST(Config, EveryFieldOfTheTableIsTested) {
    std::set<std::string> names;
    for (int row = 0; row < GW_FIELD_COUNT; ++row) {
        const auto field = static_cast<gw_config_field_t>(row);
        const std::size_t places = real_fields.count(field) + count_fields.count(field) +
                                   servo_real_fields.count(field) + servo_count_fields.count(field) +
                                   special_fields.count(field);
        EXPECT_EQ(places, 1U) << gw_config_name(field);
        EXPECT_TRUE(names.insert(gw_config_name(field)).second) << "name given twice";
        EXPECT_LE(gw_config_limit(field).minimum, gw_config_limit(field).maximum);
    }
    EXPECT_STREQ(gw_config_name(GW_FIELD_COUNT), "none");
    EXPECT_STREQ(gw_config_name(static_cast<gw_config_field_t>(-1)), "none");
}

TEST(Config, PreslidingStiffnessOfEachWheel) {
    const gw_config_limit_t limit = gw_config_limit(GW_FIELD_ESTIMATOR_PRESLIDING_STIFFNESS);
    for (std::uint32_t i = 0; i < 3; ++i) {
        const auto with = [&](Real value) {
            auto config = trikey();
            config.estimator.presliding.stiffness_n_per_m[i] = value;
            return refused(config);
        };
        EXPECT_EQ(with(limit.minimum), GW_FIELD_NONE);
        EXPECT_EQ(with(limit.maximum), GW_FIELD_NONE);
        for (const Real bad : {std::nextafter(limit.minimum, -infinite), std::nextafter(limit.maximum, infinite),
                               -infinite, infinite, not_a_number}) {
            EXPECT_EQ(with(bad), GW_FIELD_ESTIMATOR_PRESLIDING_STIFFNESS) << bad;
        }
    }
}

TEST(Config, OutlineFields) {
    for (const std::uint32_t count : {2U, 17U, 0U, 4294967295U}) {
        auto config = trikey();
        config.contact.vertex_count = count;
        EXPECT_EQ(refused(config), GW_FIELD_OUTLINE_COUNT);
    }
    for (std::uint32_t i = 0; i < 3; ++i) {
        for (const Real bad : {std::nextafter(real(10), infinite), std::nextafter(real(-10), -infinite), not_a_number}) {
            auto config = trikey();
            config.contact.vertex_m[i].x = bad;
            EXPECT_EQ(refused(config), GW_FIELD_OUTLINE_X);
            config = trikey();
            config.contact.vertex_m[i].y = bad;
            EXPECT_EQ(refused(config), GW_FIELD_OUTLINE_Y);
            // Entries that are not used may be anything.
            config = trikey();
            config.contact.vertex_m[i + 3].x = bad;
            EXPECT_EQ(refused(config), GW_FIELD_NONE);
        }
    }
    auto widest = trikey();
    widest.contact.vertex_m[0] = {real(10), real(-10)};
    widest.contact.vertex_m[1] = {real(10), real(10)};
    widest.contact.vertex_m[2] = {real(-10), real(0)};
    EXPECT_EQ(refused(widest), GW_FIELD_NONE);
    std::swap(widest.contact.vertex_m[0], widest.contact.vertex_m[1]);
    EXPECT_EQ(refused(widest), GW_FIELD_OUTLINE_CONVEX);
}

TEST(Config, TheFirstBadFieldIsReportedWithValueAndRange) {
    auto config = trikey();
    config.base.mass_kg = real(-1);
    config.admittance.mass_kg = real(-1);
    auto controller = std::make_unique<gw_controller_t>();
    gw_config_error_t error{};
    EXPECT_EQ(gw_controller_init(controller.get(), &config, &error), GW_STATUS_CONFIG_INVALID);
    EXPECT_EQ(error.field, GW_FIELD_BASE_MASS);
    EXPECT_STREQ(gw_config_name(error.field), "base.mass");
    EXPECT_EQ(error.value, real(-1));
    EXPECT_EQ(error.minimum, real(0.1));
    EXPECT_EQ(error.maximum, real(2000));
    config = trikey();
    config.geometry.wheel_slot[1] = 2;
    EXPECT_EQ(gw_controller_init(controller.get(), &config, &error), GW_STATUS_CONFIG_INVALID);
    EXPECT_EQ(error.field, GW_FIELD_GEOMETRY_WHEEL_SLOT);
    config = trikey();
    config.period_s = real(0.01);
    config.reference.follow_gain_per_s = real(51);
    EXPECT_EQ(gw_controller_init(controller.get(), &config, &error), GW_STATUS_CONFIG_INVALID);
    EXPECT_EQ(error.field, GW_FIELD_REFERENCE_FOLLOW_GAIN);
    EXPECT_NEAR(error.maximum, 50.0, 1e-4);
}

} // namespace
