// The controller's 1 ms step written with Eigen, for the comparison of costs that docs/site/reference/c_cost.md shows.
//
// It computes what gw_controller_step computes in the modes TARING, TRACKING and REACTING with the tanh friction, the
// impulse detector and the frozen impulse, which suffices for a recorded collision. Fixed sizes, no heap, constant
// matrices, functions of the C library. Other modes and choices throw.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>

extern "C" {
#include "giveway/gw_controller.h"
#include "giveway/gw_math.h"
}

namespace eigen_step
{

using Real = gw_real_t;
using Vector2 = Eigen::Matrix<Real, 2, 1>;
using Vector3 = Eigen::Matrix<Real, 3, 1>;
using Array3 = Eigen::Array<Real, 3, 1>;
using Matrix3 = Eigen::Matrix<Real, 3, 3>;
using Rotation2 = Eigen::Matrix<Real, 2, 2>;
using Outline = Eigen::Matrix<Real, 2, Eigen::Dynamic, 0, 2, GW_OUTLINE_VERTEX_MAX>;

// A compensated sum of three numbers; the sum is value - excess.
struct Sum {
    Array3 value = Array3::Zero();
    Array3 excess = Array3::Zero();

    void add(const Array3 &increment);
};

struct Contact {
    bool valid = false;
    bool on_outline = false;
    Vector2 point = Vector2::Zero();
    Real force = 0, direction = 0, lever_arm = 0, lever_arm_sigma = 0;
};

struct Output {
    Array3 wheel_angle = Array3::Zero();
    Array3 wheel_speed = Array3::Zero();
    Vector3 wrench = Vector3::Zero(); // mean
    Contact contact;
    bool detection_active = false;
    Real detection_statistic = 0;
    int detection_tick = -1;
    Vector3 detection_wrench = Vector3::Zero();
    Contact detection_contact;
    Vector3 pose = Vector3::Zero();
    Vector3 twist = Vector3::Zero();
    gw_mode_t mode = GW_MODE_TARING;
    gw_status_t status = GW_STATUS_OK;
};

class Controller
{
public:
    explicit Controller(const gw_controller_config_t &config);
    void step(const gw_controller_input_t &input, Output &output);

private:
    gw_status_t check_sensors(const gw_sensor_sample_t &sample);
    void estimate(const Array3 &torque, const Array3 &counts, const Rotation2 &yaw);
    void filter_rates(const Array3 &torque, const Array3 &counts, const Vector3 &planned_twist);
    void judge_rest(const Array3 &torque, Real speed);
    void average(const Vector3 &wrench);
    bool integrate();
    Contact locate(const Vector3 &wrench, Real samples) const;
    bool tare(const Array3 &torque);
    void follow(const gw_plan_t &plan);
    void start_escape(const Rotation2 &yaw);
    void escape();
    void move(const Vector2 &velocity, const Vector2 &displacement);
    void command(Output &output);

    gw_controller_config_t config_;
    Real period_;
    Matrix3 wheels_of_twist_, twist_of_wheels_, wrench_of_torques_, torques_of_wrench_, mass_;
    Eigen::Matrix<Real, 3, 2> rollers_of_velocity_;
    Real rolling_mass_, rate_decay_, rad_per_count_, compliance_, sigma_force_, sigma_torque_;
    Outline outline_;

    Array3 last_counts_ = Array3::Zero();
    std::array<int32_t, 3> last_count_{};
    uint32_t last_counter_ = 0;
    bool sensors_known_ = false;

    Array3 filter_torque_ = Array3::Zero(), rate_ = Array3::Zero(), derivative_ = Array3::Zero();
    bool filter_started_ = false;
    Sum tare_sum_;
    Array3 tare_low_, tare_high_;
    uint32_t tare_count_ = 0;
    Sum stop_sum_;
    Array3 stop_low_, stop_high_;
    uint32_t stop_count_ = 0;
    Array3 run_zero_ = Array3::Zero(), rest_zero_ = Array3::Zero();
    uint32_t slow_ticks_ = 0;
    bool rest_ = true, zero_changed_ = false;
    gw_regime_t regime_ = GW_REGIME_REST;
    Eigen::Matrix<Real, 3, GW_MOVING_AVERAGE_CAPACITY> window_;
    Vector3 window_sum_ = Vector3::Zero(), fresh_sum_ = Vector3::Zero();
    uint32_t window_index_ = 0, window_count_ = 0;
    Vector3 wrench_ = Vector3::Zero(), mean_ = Vector3::Zero();

    Vector3 impulse_ = Vector3::Zero(), hit_wrench_ = Vector3::Zero();
    uint32_t impulse_samples_ = 0, ticks_since_trip_ = 0;
    Real statistic_ = 0;
    bool active_ = false;
    int detection_tick_ = -1;
    Contact detection_contact_;

    gw_mode_t mode_ = GW_MODE_TARING;
    uint32_t quiet_ticks_ = 0, tick_ = 0;
    bool placed_ = false, on_plan_ = false;
    Vector2 goal_ = Vector2::Zero(), escape_velocity_ = Vector2::Zero();
    Sum moved_;
    Sum pose_, wheel_angle_;
    Vector3 twist_ = Vector3::Zero(), acceleration_ = Vector3::Zero(), displacement_ = Vector3::Zero();
};

} // namespace eigen_step
