#include "metrics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "elementary.hpp"
#include "giveway_batch.h"
#include "scalar.hpp"

namespace giveway::batch {

namespace {

constexpr double peak_window_s = 0.35;
constexpr double loaded_share = 0.5;
constexpr double cause_window_s = 0.25;
constexpr double pi = 3.14159265358979323846;
constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

struct Vector {
    double x, y;
    [[nodiscard]] double length() const { return math::sqrt(x * x + y * y); }
};

// A vector of the world frame in a base frame with this heading.
Vector to_base(Vector world, double theta) {
    const auto turn = math::sincos(theta);
    return {turn.cos * world.x + turn.sin * world.y, -turn.sin * world.x + turn.cos * world.y};
}

double degrees(double radians) { return radians * (180.0 / pi); }

// Wrapped to [-180, 180).
double wrapped(double deg) { return deg + 180.0 - 360.0 * std::floor((deg + 180.0) / 360.0) - 180.0; }

class Collision {
public:
    Collision(const Sample* samples, std::size_t count, const MetricParameters& parameters, double* value,
              double* truth)
        : s_(samples), count_(count), parameters_(parameters), value_(value), truth_(truth) {
        std::fill_n(value_, GWB_METRIC_COUNT, std::numeric_limits<double>::quiet_NaN());
        std::fill_n(truth_, GWB_METRIC_COUNT, std::numeric_limits<double>::quiet_NaN());
        contact_s_ = last().first_contact_time;
        hit_ = contact_s_ >= 0.0;
        if (hit_) {
            while (start_ < count_ && s_[start_].time_s < contact_s_) {
                ++start_;
            }
            find_detection();
        }
    }

    void all() {
        whole_run();
        if (hit_) {
            contact_speed();
            peak_torques();
        }
        if (detected_ != none) {
            at_detection();
            escape();
        }
    }

private:
    [[nodiscard]] const Sample& last() const { return s_[count_ - 1]; }
    // One past the last row from contact to detection.
    [[nodiscard]] std::size_t detection_end() const { return detected_ == none ? count_ : detected_ + 1; }

    void set(int metric, double value) { value_[metric] = value; }
    void set(int metric, double value, double truth) {
        value_[metric] = value;
        truth_[metric] = truth;
    }

    // The first row from contact on with more detections than before it.
    void find_detection() {
        const int before = start_ > 0 ? s_[start_ - 1].detection_count : 0;
        for (std::size_t i = start_; i < count_; ++i) {
            if (s_[i].detection_count > before) {
                detected_ = i;
                return;
            }
        }
    }

    void whole_run() {
        double peak_force = 0.0;
        double travel = -std::numeric_limits<double>::infinity();
        double least_stored = std::numeric_limits<double>::infinity();
        double most_stored = -least_stored;
        double work = 0.0;
        double dissipated = -least_stored;
        double residual = 0.0;
        int false_detections = 0;
        int detections = 0;
        double touched_s = -std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < count_; ++i) {
            const Sample& s = s_[i];
            peak_force = std::max(peak_force, s.contact_force);
            travel = std::max(travel, s.bumper_compression);
            least_stored = std::min(least_stored, s.energy_stored);
            most_stored = std::max(most_stored, s.energy_stored);
            work = std::max(work, std::fabs(s.energy_work_in));
            dissipated = std::max(dissipated, s.energy_dissipated);
            residual = std::max(residual, std::fabs(s.energy_residual));
            touched_s = (s.contact || s.pushed) ? s.time_s : touched_s;
            if (s.detection_count > detections && !(touched_s >= s.time_s - cause_window_s)) {
                ++false_detections;
            }
            detections = s.detection_count;
        }
        const double scale = std::max({work, most_stored - least_stored, dissipated});
        set(GWB_PEAK_FORCE, peak_force);
        set(GWB_BUMPER_TRAVEL, 1e3 * travel);
        set(GWB_ENERGY_RESIDUAL, scale > 0.0 ? residual / scale : residual, 0.0);
        set(GWB_FALSE_DETECTIONS, false_detections, 0.0);
        set(GWB_DETECTIONS, detections);
        if (hit_) {
            set(GWB_CONTACT_TIME, contact_s_);
        }
        set(GWB_CONTACT_IMPULSE, Vector{last().contact_impulse_x, last().contact_impulse_y}.length());
        set(GWB_CONTACT_AT_END, last().contact ? 1.0 : 0.0);
        set(GWB_LATCHED_AT_END, last().latched ? 1.0 : 0.0);
        set(GWB_ROPE_TAUT_AT_END, last().rope_taut ? 1.0 : 0.0);
        set(GWB_EVENTS, last().events);
    }

    void contact_speed() {
        if (start_ < 2) {
            return;
        }
        const Sample& a = s_[start_ - 2];
        const Sample& b = s_[start_ - 1];
        const double step_s = b.time_s - a.time_s;
        set(GWB_CONTACT_SPEED,
            Vector{(b.nose_x - a.nose_x) / step_s - b.vx, (b.nose_y - a.nose_y) / step_s - b.vy}.length());
    }

    // Impulse of the contact up to detection, base frame at detection.
    [[nodiscard]] Vector true_impulse() const {
        const Sample& s = detected_ == none ? last() : s_[detected_];
        return to_base({s.contact_impulse_x, s.contact_impulse_y}, s.theta);
    }

    // Where it was hit, base frame: mean up to detection, weighted by the force. False if there was no force.
    bool true_point(Vector& point) const {
        double weight = 0.0;
        point = {0.0, 0.0};
        for (std::size_t i = start_; i < detection_end(); ++i) {
            const Sample& s = s_[i];
            weight += s.contact_force;
            point.x += s.contact_force * s.contact_base_x;
            point.y += s.contact_force * s.contact_base_y;
        }
        point = {point.x / weight, point.y / weight};
        return weight > 0.0;
    }

    void peak_torques() {
        double any = 0.0;
        double positive[3];
        double negative[3];
        std::fill_n(positive, 3, -std::numeric_limits<double>::infinity());
        std::fill_n(negative, 3, -std::numeric_limits<double>::infinity());
        for (std::size_t i = start_; i < count_; ++i) {
            for (int wheel = 0; wheel < 3; ++wheel) {
                const double torque = s_[i].wheel_torque[wheel];
                any = std::max(any, std::fabs(torque));
                if (s_[i].time_s <= contact_s_ + peak_window_s) {
                    positive[wheel] = std::max(positive[wheel], torque);
                    negative[wheel] = std::max(negative[wheel], -torque);
                }
            }
        }
        set(GWB_PEAK_TORQUE_ANY, any);
        Vector point{};
        if (!true_point(point)) {
            return;
        }
        // The torque that the impact makes at a resting wheel: T = -J^-T F.
        const Vector force = true_impulse();
        const double moment = point.x * force.y - point.y * force.x;
        double torque[3];
        double largest = 0.0;
        for (int wheel = 0; wheel < 3; ++wheel) {
            const auto azimuth = math::sincos(static_cast<double>(wheel) * 2.0 * pi / 3.0);
            const double rolling = -azimuth.sin * force.x + azimuth.cos * force.y;
            torque[wheel] =
                -parameters_.wheel_radius_m * (2.0 / 3.0 * rolling + moment / (3.0 * parameters_.wheel_distance_m));
            largest = std::max(largest, std::fabs(torque[wheel]));
        }
        double peak = -std::numeric_limits<double>::infinity();
        for (int wheel = 0; wheel < 3; ++wheel) {
            if (std::fabs(torque[wheel]) >= loaded_share * largest) {
                peak = std::max(peak, torque[wheel] > 0.0 ? positive[wheel] : negative[wheel]);
            }
        }
        set(GWB_PEAK_TORQUE, peak);
    }

    void at_detection() {
        const Sample& s = s_[detected_];
        set(GWB_DETECTION_TIME, 1e3 * (s.time_s - contact_s_));

        const Vector impulse = true_impulse();
        const double true_deg = degrees(std::atan2(impulse.y, impulse.x));
        const double direction_deg = true_deg + wrapped(degrees(s.detection_direction) - true_deg);
        set(GWB_FORCE_DIRECTION, direction_deg, true_deg);
        set(GWB_DIRECTION_ERROR, wrapped(direction_deg - true_deg), 0.0);

        Vector point{};
        if (true_point(point)) {
            set(GWB_CONTACT_POINT_X, 1e3 * s.detection_point_x, 1e3 * point.x);
            set(GWB_CONTACT_POINT_Y, 1e3 * s.detection_point_y, 1e3 * point.y);
            set(GWB_LOCATION_ERROR, 1e3 * Vector{s.detection_point_x - point.x, s.detection_point_y - point.y}.length(),
                0.0);
        }

        // Halves round to even, as in Python.
        const double step_s = s_[1].time_s - s_[0].time_s;
        const double rows = std::max(1.0, math::round(parameters_.estimate_window_s / step_s));
        const std::size_t available = detected_ + 1;
        const std::size_t window =
            rows < static_cast<double>(available) ? static_cast<std::size_t>(rows) : available;
        Vector mean{0.0, 0.0};
        for (std::size_t i = available - window; i < available; ++i) {
            const Vector force = to_base({s_[i].contact_force_x, s_[i].contact_force_y}, s_[i].theta);
            mean.x += force.x;
            mean.y += force.y;
        }
        set(GWB_FORCE_AT_DETECTION, s.estimate_force, mean.length() / static_cast<double>(window));

        Vector estimated{0.0, 0.0};
        for (std::size_t i = start_; i < available; ++i) {
            estimated.x += s_[i].estimate_force_x;
            estimated.y += s_[i].estimate_force_y;
        }
        set(GWB_IMPULSE, estimated.length() * step_s, impulse.length());
    }

    // Every new hit starts the escape anew, so it counts from the last detection.
    void escape() {
        std::size_t row = count_ - 1;
        while (row > 0 && s_[row].detection_count <= s_[row - 1].detection_count) {
            --row;
        }
        const Sample& s = s_[row];
        set(GWB_ESCAPE, Vector{last().reference_x - s.reference_x, last().reference_y - s.reference_y}.length(),
            Vector{last().x - s.x, last().y - s.y}.length());
    }

    const Sample* s_;
    std::size_t count_;
    const MetricParameters& parameters_;
    double* value_;
    double* truth_;
    double contact_s_ = -1.0;
    bool hit_ = false;
    std::size_t start_ = 0; // first row at or after contact
    std::size_t detected_ = none;
};

} // namespace

void evaluate(const Sample* samples, std::size_t count, const MetricParameters& parameters, double* value,
              double* truth) {
    Collision(samples, count, parameters, value, truth).all();
}

} // namespace giveway::batch
