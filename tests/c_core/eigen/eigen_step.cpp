#include "eigen_step.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace eigen_step
{
namespace
{

constexpr Real pi = Real(3.141592653589793238462643);

Vector2 limited(const Vector2 &vector, Real limit)
{
    const Real length = vector.norm();
    return length > limit ? Vector2(vector * (limit / length)) : vector;
}

Rotation2 rotation(Real angle)
{
    return Eigen::Rotation2D<Real>(angle).toRotationMatrix();
}

Real braking_speed(Real deceleration, Real period, Real distance)
{
    if (!(distance > 0)) {
        return 0;
    }
    const Real half_step = Real(0.5) * deceleration * period;
    return std::sqrt(half_step * half_step + 2 * deceleration * distance) - half_step;
}

// Adds one sample to a tare; true when it is done.
bool add_to_tare(Sum &sum, Array3 &low, Array3 &high, uint32_t &count, const Array3 &torque, uint32_t samples,
                 Real variation)
{
    if (count == 0) {
        sum = Sum();
        low = high = torque;
    }
    sum.add(torque);
    low = low.min(torque);
    high = high.max(torque);
    ++count;
    if (((high - low) > variation).any()) {
        count = 0;
    }
    return count >= samples;
}

} // namespace

void Sum::add(const Array3 &increment)
{
    const Array3 corrected = increment - excess;
    const Array3 before = value;
    value += corrected;
    excess = (value - before) - corrected;
}

Controller::Controller(const gw_controller_config_t &config) : config_(config), period_(config.period_s)
{
    const auto &estimator = config.estimator;
    if (estimator.velocity_source != GW_SOURCE_PLANNED || estimator.acceleration_source != GW_SOURCE_PLANNED ||
        estimator.friction_model != GW_FRICTION_TANH || config.detector.kind != GW_DETECTOR_IMPULSE ||
        config.admittance.kind != GW_ADMITTANCE_FROZEN_IMPULSE) {
        throw std::invalid_argument("the comparison has no such choice");
    }
    const Real radius = config.geometry.wheel_radius_m, distance = config.geometry.wheel_distance_m;
    Matrix3 directions; // rows: -n_y, n_x, R
    for (int i = 0; i < 3; ++i) {
        const Real azimuth = config.geometry.azimuth_rad + Real(config.geometry.wheel_slot[i]) * (2 * pi / 3);
        const Real c = std::cos(azimuth), s = std::sin(azimuth);
        directions.row(i) << -s, c, distance;
        rollers_of_velocity_.row(i) << c / config.geometry.roller_radius_m, s / config.geometry.roller_radius_m;
    }
    wheels_of_twist_ = directions / radius;
    const Vector3 share(Real(2) / 3, Real(2) / 3, Real(1) / (3 * distance * distance)); // inverse of D^T D
    twist_of_wheels_ = share.asDiagonal() * directions.transpose() * radius;
    wrench_of_torques_ = wheels_of_twist_.transpose();
    torques_of_wrench_ = twist_of_wheels_.transpose();
    const Real wheel_mass = config.base.wheel_inertia_kgm2 / (radius * radius);
    const Real roller_radius = config.geometry.roller_radius_m;
    const Real roller_mass = config.base.roller_inertia_kgm2 / (roller_radius * roller_radius);
    rolling_mass_ = Real(1.5) * (wheel_mass + roller_mass);
    const Real mass = config.base.mass_kg + rolling_mass_;
    mass_ = Vector3(mass, mass, config.base.yaw_inertia_kgm2 + 3 * wheel_mass * distance * distance).asDiagonal();
    rate_decay_ = std::exp(-estimator.rate_cutoff_radps * period_);
    rad_per_count_ = 2 * pi / Real(estimator.encoder_counts);
    compliance_ = estimator.drivetrain_stiffness_nm_per_rad > 0 ? 1 / estimator.drivetrain_stiffness_nm_per_rad : 0;
    sigma_force_ = std::sqrt(Real(1.5)) * estimator.torque_noise_nm / radius;
    sigma_torque_ = std::sqrt(Real(3)) * distance * estimator.torque_noise_nm / radius;
    outline_.resize(2, config.contact.vertex_count);
    for (uint32_t i = 0; i < config.contact.vertex_count; ++i) {
        outline_.col(i) << config.contact.vertex_m[i].x, config.contact.vertex_m[i].y;
    }
}

gw_status_t Controller::check_sensors(const gw_sensor_sample_t &sample)
{
    const Eigen::Map<const Array3> torque(sample.torque_nm);
    if (!sample.present) {
        return GW_STATUS_SENSOR_MISSING;
    }
    if (sensors_known_ && sample.counter == last_counter_) {
        return GW_STATUS_SENSOR_STALE;
    }
    if (!torque.allFinite()) {
        return GW_STATUS_SENSOR_NONFINITE;
    }
    if ((torque.abs() >= config_.sensor_check.torque_limit_nm).any()) {
        return GW_STATUS_SENSOR_SATURATED;
    }
    bool jumped = false;
    for (int i = 0; i < 3; ++i) {
        const int32_t moved = gw_count_difference(sample.encoder_count[i], last_count_[i]);
        jumped = jumped || (sensors_known_ && std::abs(moved) > int32_t(config_.sensor_check.encoder_jump_counts));
        last_counts_[i] = sensors_known_ ? Real(moved) : Real(0);
        last_count_[i] = sample.encoder_count[i];
    }
    last_counter_ = sample.counter;
    sensors_known_ = true;
    return jumped ? GW_STATUS_ENCODER_JUMP : GW_STATUS_OK;
}

// w^2/(s + w)^2 of the wheels' rates, stepped exactly.
void Controller::filter_rates(const Array3 &torque, const Array3 &counts, const Vector3 &planned_twist)
{
    const Real w = config_.estimator.rate_cutoff_radps;
    if (filter_started_) {
        const Array3 input = (counts * rad_per_count_ - (torque - filter_torque_) * compliance_) / period_;
        const Array3 error = rate_ - input;
        const Array3 mixed = derivative_ + w * error;
        rate_ = input + rate_decay_ * (error + period_ * mixed);
        derivative_ = rate_decay_ * (derivative_ - (w * period_) * mixed);
    } else {
        rate_ = (wheels_of_twist_ * planned_twist).array();
    }
    filter_torque_ = torque;
    filter_started_ = true;
}

void Controller::judge_rest(const Array3 &torque, Real speed)
{
    const auto &config = config_.estimator;
    const bool before = rest_;
    if (speed > config.rest_speed_mps) {
        slow_ticks_ = 0;
        rest_ = false;
        stop_count_ = 0;
    } else {
        slow_ticks_ = std::min(slow_ticks_ + 1, GW_TICK_MASK);
        if (!rest_ && slow_ticks_ + config.retare_ticks > config.rest_ticks &&
            add_to_tare(stop_sum_, stop_low_, stop_high_, stop_count_, torque, config.retare_ticks,
                        config.tare_variation_nm)) {
            rest_zero_ = stop_sum_.value / Real(stop_count_);
            stop_count_ = 0;
            rest_ = true;
        }
    }
    zero_changed_ = rest_ != before;
    regime_ = rest_ ? GW_REGIME_REST : (speed <= config.creep_speed_mps ? GW_REGIME_CREEPING : GW_REGIME_MOTION);
}

void Controller::average(const Vector3 &wrench)
{
    if (zero_changed_) {
        window_sum_.setZero();
        fresh_sum_.setZero();
        window_index_ = window_count_ = 0;
    }
    if (window_count_ < config_.estimator.average_window) {
        ++window_count_;
    } else {
        window_sum_ -= window_.col(window_index_);
    }
    window_.col(window_index_) = wrench;
    window_sum_ += wrench;
    fresh_sum_ += wrench;
    if (++window_index_ >= config_.estimator.average_window) {
        window_index_ = 0;
        window_sum_ = fresh_sum_;
        fresh_sum_.setZero();
    }
    mean_ = window_sum_ / Real(window_count_);
}

// (38)-(40).
void Controller::estimate(const Array3 &torque, const Array3 &counts, const Rotation2 &yaw)
{
    Vector3 twist, acceleration;
    twist << yaw.transpose() * twist_.head<2>(), twist_.z();
    acceleration << yaw.transpose() * acceleration_.head<2>(), acceleration_.z();
    filter_rates(torque, counts, twist);
    judge_rest(torque, std::max(twist.head<2>().norm(), std::abs(twist.z()) * config_.geometry.wheel_distance_m));
    if (rest_) {
        twist.setZero();
        acceleration.setZero();
    }
    const Array3 friction =
        config_.friction.coulomb_torque_nm *
        (config_.friction.tanh_slope_s_per_rad * (rollers_of_velocity_ * twist.head<2>()).array()).tanh();
    Vector3 load = mass_ * acceleration;
    load.head<2>() += rollers_of_velocity_.transpose() * friction.matrix();
    load.head<2>() += rolling_mass_ * twist.z() * Vector2(twist.y(), -twist.x());
    const Array3 nominal = (torques_of_wrench_ * load).array() + (rest_ ? rest_zero_ : run_zero_);
    wrench_ = wrench_of_torques_ * (nominal - torque).matrix();
    average(wrench_);
}

// The leaky vector integral; true if it trips.
bool Controller::integrate()
{
    const auto &config = config_.detector;
    statistic_ = 0;
    if (zero_changed_) {
        impulse_.setZero();
        impulse_samples_ = 0;
    }
    if (active_) {
        ticks_since_trip_ = std::min(ticks_since_trip_ + 1, config.blanking_ticks);
        const bool over =
            twist_.head<2>().norm() < config_.supervisor.settled_speed_mps &&
            std::abs(twist_.z()) * config_.geometry.wheel_distance_m < config_.supervisor.settled_speed_mps;
        active_ =
            !(ticks_since_trip_ >= config.blanking_ticks && (over || mean_.head<2>().norm() < config.release_force_n));
    }
    if (active_ || mode_ == GW_MODE_TARING) {
        impulse_.setZero();
        impulse_samples_ = 0;
        return false;
    }
    const Real leak = regime_ == GW_REGIME_REST       ? config.leak_rest_n
                      : regime_ == GW_REGIME_CREEPING ? config.leak_creep_n
                                                      : config.leak_motion_n;
    const Vector3 sum = impulse_ + wrench_ * period_;
    const Real length = sum.head<2>().norm();
    const Real left = length - leak * period_;
    if (!(left > 0)) {
        impulse_.setZero();
        impulse_samples_ = 0;
        return false;
    }
    impulse_ = sum * (left / length);
    ++impulse_samples_;
    hit_wrench_ = sum * ((left / (Real(impulse_samples_) * period_) + leak) / length);
    statistic_ = left;
    if (left <= config.impulse_threshold_newton_s) {
        return false;
    }
    detection_contact_ = locate(hit_wrench_, Real(impulse_samples_));
    detection_tick_ = int(tick_);
    impulse_.setZero();
    impulse_samples_ = ticks_since_trip_ = 0;
    active_ = true;
    return true;
}

// (41)-(46).
Contact Controller::locate(const Vector3 &wrench, Real samples) const
{
    Contact contact;
    const Vector2 force = wrench.head<2>();
    const Real size = force.norm();
    if (size < config_.contact.minimum_force_n) {
        return contact;
    }
    const Vector2 direction = force / size;
    const Real root = std::sqrt(std::max(samples, Real(1)));
    contact.valid = true;
    contact.force = size;
    contact.direction = std::atan2(force.y(), force.x());
    contact.lever_arm = wrench.z() / size;
    contact.lever_arm_sigma = Vector2(sigma_torque_, contact.lever_arm * sigma_force_).norm() / (root * size);
    const Vector2 normal(direction.y(), -direction.x());
    // Distance to the right of the line of the force, for all vertices at once.
    Eigen::Array<Real, 1, Eigen::Dynamic, Eigen::RowMajor, 1, GW_OUTLINE_VERTEX_MAX> side =
        (normal.transpose() * outline_).array() - contact.lever_arm;
    Eigen::Index before = side.size() - 1;
    for (Eigen::Index i = 0; i < side.size(); before = i++) {
        if (side[before] <= 0 && side[i] > 0) {
            const Real fraction = -side[before] / (side[i] - side[before]);
            contact.point = outline_.col(before) + fraction * (outline_.col(i) - outline_.col(before));
            contact.on_outline = true;
        }
    }
    if (!contact.on_outline) {
        Eigen::Index nearest = 0;
        side.abs().minCoeff(&nearest);
        contact.point = outline_.col(nearest);
    }
    return contact;
}

bool Controller::tare(const Array3 &torque)
{
    if (!add_to_tare(tare_sum_, tare_low_, tare_high_, tare_count_, torque, config_.estimator.tare_ticks,
                     config_.estimator.tare_variation_nm)) {
        return false;
    }
    run_zero_ = rest_zero_ = tare_sum_.value / Real(tare_count_);
    tare_count_ = 0;
    rest_ = true;
    slow_ticks_ = config_.estimator.rest_ticks;
    filter_started_ = false;
    derivative_.setZero();
    window_sum_.setZero();
    fresh_sum_.setZero();
    window_index_ = window_count_ = 0;
    return true;
}

void Controller::move(const Vector2 &velocity, const Vector2 &displacement)
{
    const Real most = config_.reference.yaw_acceleration_limit_radps2 * period_;
    const Real omega = twist_.z() + std::clamp(-twist_.z(), -most, most);
    acceleration_ << (velocity - twist_.head<2>()) / period_, (omega - twist_.z()) / period_;
    displacement_ << displacement, Real(0.5) * period_ * (twist_.z() + omega);
    twist_ << velocity, omega;
    pose_.add(displacement_.array());
}

// Only a standing plan is compared, so only the correction towards its pose is needed.
void Controller::follow(const gw_plan_t &plan)
{
    const Vector3 target(plan.pose.x_m, plan.pose.y_m, plan.pose.theta_rad);
    const Vector3 planned(plan.twist.vx_mps, plan.twist.vy_mps, plan.twist.omega_radps);
    if (!on_plan_) {
        pose_.value = target.array();
        on_plan_ = true;
        return;
    }
    const Real gain = config_.reference.follow_gain_per_s;
    const Vector3 error =
        ((target.array() - pose_.value) + pose_.excess).matrix() - Real(0.5) * period_ * (twist_ + planned);
    const Vector2 wanted =
        limited(Vector2(planned.head<2>() + gain * error.head<2>()), config_.reference.speed_limit_mps);
    const Vector2 change =
        limited(Vector2(wanted - twist_.head<2>()), config_.reference.acceleration_limit_mps2 * period_);
    const Vector2 velocity = twist_.head<2>() + change;
    move(velocity, Real(0.5) * period_ * (twist_.head<2>() + velocity));
}

void Controller::start_escape(const Rotation2 &yaw)
{
    goal_ = (config_.admittance.escape_impulse_newton_s / config_.admittance.damping_newton_s_per_m) *
            (yaw * hit_wrench_.head<2>().normalized());
    moved_ = Sum();
    escape_velocity_ = twist_.head<2>();
}

// (2) within the limits.
void Controller::escape()
{
    const auto &config = config_.admittance;
    const Real rate = config.damping_newton_s_per_m / config.mass_kg;
    static const Real decay = std::exp(-rate * period_), approach = -std::expm1(-rate * period_);
    const Real most = config.acceleration_limit_mps2 * period_;
    const Vector2 before = escape_velocity_;
    const Vector2 ahead = ((Array3(goal_.x(), goal_.y(), 0) - moved_.value) + moved_.excess).matrix().head<2>();
    const Real distance = ahead.norm();
    Vector2 wanted = Vector2::Zero();
    Vector2 velocity, displacement;
    bool decided = false;
    const auto allowed = [&](const Vector2 &next) {
        return next.norm() <= config.speed_limit_mps && (next - before).norm() <= most;
    };
    if (distance > 0) {
        const Vector2 unit = ahead / distance;
        const Vector2 end = (rate * decay) * ahead, exact = approach * ahead, mean_velocity = exact / period_;
        const Real mean = mean_velocity.norm();
        const Real brake = braking_speed(Real(0.5) * config.acceleration_limit_mps2, period_,
                                         distance - Real(0.5) * period_ * before.dot(unit));
        wanted = std::min({std::max(mean, config.finish_speed_mps), brake, config.speed_limit_mps}) * unit;
        if (mean >= config.finish_speed_mps && mean <= brake && allowed(mean_velocity) && allowed(end)) {
            velocity = end;
            displacement = exact;
            decided = true;
        } else if (brake <= 0 && allowed(Vector2::Zero())) {
            velocity.setZero();
            displacement = ahead;
            decided = true;
        }
    }
    if (!decided) {
        velocity = before + limited(Vector2(wanted - before), most);
        displacement = Real(0.5) * period_ * (before + velocity);
    }
    moved_.add(Array3(displacement.x(), displacement.y(), 0));
    escape_velocity_ = velocity;
    move(velocity, displacement);
}

// (5) and (6).
void Controller::command(Output &output)
{
    const Real theta = pose_.value.z();
    Vector3 turned, twist;
    turned << rotation(theta - Real(0.5) * displacement_.z()).transpose() * displacement_.head<2>(), displacement_.z();
    twist << rotation(theta).transpose() * twist_.head<2>(), twist_.z();
    wheel_angle_.add((wheels_of_twist_ * turned).array());
    wheel_angle_.value = (wheel_angle_.value >= pi).select(wheel_angle_.value - 2 * pi, wheel_angle_.value);
    wheel_angle_.value = (wheel_angle_.value < -pi).select(wheel_angle_.value + 2 * pi, wheel_angle_.value);
    output.wheel_angle = wheel_angle_.value;
    output.wheel_speed = (wheels_of_twist_ * twist).array();
}

void Controller::step(const gw_controller_input_t &input, Output &output)
{
    output.status = check_sensors(input.sensor);
    if (output.status != GW_STATUS_OK || input.stop_request || input.tare_request || !gw_plan_is_valid(&input.plan)) {
        throw std::runtime_error("the comparison has no such input");
    }
    const Array3 torque = Eigen::Map<const Array3>(input.sensor.torque_nm);
    const Rotation2 yaw = rotation(pose_.value.z());
    estimate(torque, last_counts_, yaw);
    const bool hit = integrate();
    const bool tared = mode_ == GW_MODE_TARING && tare(torque);
    if (!placed_) {
        for (int i = 0; i < 3; ++i) {
            wheel_angle_.value[i] = std::remainder(Real(input.sensor.encoder_count[i]) * rad_per_count_, 2 * pi);
        }
        placed_ = true;
    }
    if (hit) {
        mode_ = GW_MODE_REACTING;
        start_escape(yaw);
    } else if (tared) {
        mode_ = GW_MODE_TRACKING;
        impulse_.setZero();
        impulse_samples_ = 0;
    }
    if (mode_ == GW_MODE_REACTING) {
        escape();
    } else if (mode_ == GW_MODE_TRACKING) {
        follow(input.plan);
    }
    command(output);
    output.wrench = mean_;
    output.contact = locate(mean_, Real(window_count_));
    output.detection_active = active_;
    output.detection_statistic = statistic_;
    output.detection_tick = detection_tick_;
    output.detection_contact = detection_contact_;
    output.detection_wrench = hit_wrench_;
    output.pose = pose_.value.matrix();
    output.twist = twist_;
    output.mode = mode_;
    ++tick_;
}

} // namespace eigen_step
