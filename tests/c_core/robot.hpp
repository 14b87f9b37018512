// A controller in a robot that follows its commands exactly: torques are those of the corrected model, evaluated with
// Eigen at the commanded motion, minus those of a push, plus sensor offsets.
#pragma once

#include <memory>

#include "support.hpp"

class Robot
{
public:
    explicit Robot(const gw_controller_config_t &chosen, const Eigen::Vector3d &offset = Eigen::Vector3d::Zero())
        : config(chosen), offset_(offset)
    {
        gw_config_error_t error{};
        EXPECT_EQ(gw_controller_init(controller.get(), &config, &error), GW_STATUS_OK) << gw_config_name(error.field);
        input.sensor.present = true;
        gw_controller_safe_output(&output);
    }

    // One tick under a push in the base frame (force and torque about the centre).
    gw_status_t step(const Eigen::Vector3d &push = Eigen::Vector3d::Zero())
    {
        ++input.sensor.counter;
        const Eigen::Vector3d torque = exact_torques(push);
        for (int i = 0; i < 3; ++i) {
            input.sensor.torque_nm[i] = real(torque(i));
            input.sensor.encoder_count[i] =
                encoder_start + static_cast<std::int32_t>(std::lround(angle_(i) / (2.0 * pi) * 8500.0));
        }
        return raw_step();
    }

    // One tick with the present `input`.
    gw_status_t raw_step()
    {
        const gw_status_t status = gw_controller_step(controller.get(), &input, &output);
        const Eigen::Vector3d v = vector(output.reference_twist);
        if (output.mode != GW_MODE_FAULT) {
            acceleration_ = (v - twist_) / static_cast<double>(config.period_s);
        } else {
            acceleration_.setZero();
        }
        twist_ = v;
        const double theta = output.reference_pose.theta_rad;
        angle_ += wheel_jacobian(config.geometry, theta) * v * static_cast<double>(config.period_s);
        return status;
    }

    void run(int ticks, const Eigen::Vector3d &push = Eigen::Vector3d::Zero())
    {
        for (int i = 0; i < ticks; ++i) {
            ASSERT_EQ(step(push), GW_STATUS_OK);
        }
    }

    // The robot was moving like this before the controller started.
    void already_moving(const Eigen::Vector3d &twist)
    {
        twist_ = twist;
    }

    // Through the tare, until it tracks.
    void start()
    {
        for (unsigned i = 0; i < config.estimator.tare_ticks; ++i) {
            ASSERT_EQ(output.command.speed_radps[0], real(0));
            ASSERT_EQ(step(), GW_STATUS_OK);
        }
        ASSERT_EQ(output.mode, GW_MODE_TRACKING);
    }

    // The commanded twist over the floor, in the base frame, from the commanded wheel speeds.
    [[nodiscard]] Eigen::Vector3d commanded_twist() const
    {
        const Eigen::Vector3d rates(output.command.speed_radps[0], output.command.speed_radps[1],
                                    output.command.speed_radps[2]);
        return wheel_jacobian(config.geometry, 0.0).inverse() * rates;
    }

    gw_controller_config_t config;
    std::unique_ptr<gw_controller_t> controller = std::make_unique<gw_controller_t>();
    gw_controller_input_t input{};
    gw_controller_output_t output{};
    std::int32_t encoder_start = 0;

private:
    // T_s = J_w^-T (M_t a + c + J_r^T B_r - F) + offset.
    [[nodiscard]] Eigen::Vector3d exact_torques(const Eigen::Vector3d &push) const
    {
        const double r_w = config.geometry.wheel_radius_m;
        const double r_r = config.geometry.roller_radius_m;
        const double distance = config.geometry.wheel_distance_m;
        const double wheel = config.base.wheel_inertia_kgm2 / r_w / r_w;
        const double roller = config.base.roller_inertia_kgm2 / r_r / r_r;
        const double mass = config.base.mass_kg + 1.5 * (wheel + roller);
        const double yaw_inertia = config.base.yaw_inertia_kgm2 + 3.0 * wheel * distance * distance;
        const Eigen::Matrix3d turn = to_base(output.reference_pose.theta_rad);
        const Eigen::Vector3d v = turn * twist_;
        const Eigen::Vector3d a = turn * acceleration_;
        const Eigen::Matrix3d jr = roller_jacobian(config.geometry, 0.0);
        const Eigen::Vector3d friction = config.friction.coulomb_torque_nm *
                                         (config.friction.tanh_slope_s_per_rad * (jr * v).array()).tanh().matrix();
        const Eigen::Vector3d velocity_term = 1.5 * (wheel + roller) * v(2) * Eigen::Vector3d(v(1), -v(0), 0.0);
        const Eigen::Vector3d force =
            Eigen::Vector3d(mass, mass, yaw_inertia).cwiseProduct(a) + velocity_term + jr.transpose() * friction - push;
        return wheel_jacobian(config.geometry, 0.0).transpose().inverse() * force + offset_;
    }

    Eigen::Vector3d offset_;
    Eigen::Vector3d twist_ = Eigen::Vector3d::Zero();        // world
    Eigen::Vector3d acceleration_ = Eigen::Vector3d::Zero(); // world
    Eigen::Vector3d angle_ = Eigen::Vector3d::Zero();
};

inline gw_controller_config_t trikey_config()
{
    gw_controller_config_t config;
    gw_controller_config_paper(&config);
    return config;
}

// The wrench about the centre of a force at a point, in the base frame.
inline Eigen::Vector3d push_at(double x, double y, double force, double direction)
{
    const double fx = force * std::cos(direction);
    const double fy = force * std::sin(direction);
    return {fx, fy, x * fy - y * fx};
}
