#include "metrics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "arctangent.hpp"
#include "elementary.hpp"
#include "gravity.hpp"
#include "scalar.hpp"
#include "wheels.hpp"

namespace giveway::batch {

namespace {

constexpr double loaded_share = 0.5; // of the torque that an impact makes at the wheel it loads most
constexpr int mode_tracking = 1;
constexpr int mode_fault = 6;
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

// The parameters that the metrics need.
struct Parameters {
    Parameters(const testbed::Variables &t, const controller::Variables &c, const ForceLimits &force_limits)
        : wheel_radius_m(t.wheel_radius), wheel_distance_m(t.wheel_distance),
          estimate_window_s(static_cast<double>(c.estimator_average_window) * c.controller_period),
          bumper(t.bumper_kind != 0), bumper_travel_m(t.bumper_travel), tipping(t.base_tipping), mass_kg(t.base_mass),
          com_height_m(t.base_com_height), contact_height_m(t.contact_height), push_height_m(t.push_height),
          limits(force_limits),
          sensed_torque_limit_nm(std::min(t.electronics_torque_range, c.sensor_check_torque_limit)),
          motor_torque_limit_nm(t.drivetrain_torque_limit) {}

    double wheel_radius_m, wheel_distance_m;
    double estimate_window_s; // over which the estimate is averaged
    bool bumper;
    double bumper_travel_m;
    bool tipping;
    double mass_kg, com_height_m, contact_height_m, push_height_m;
    ForceLimits limits;
    double sensed_torque_limit_nm, motor_torque_limit_nm;
};

bool pushed(const Sample &s) { return s.push_force_x != 0.0 || s.push_force_y != 0.0; }

class Collision {
public:
    Collision(const Sample *samples, std::size_t count, const Parameters &parameters, double *value, double *truth)
        : s_(samples), count_(count), parameters_(parameters), value_(value), truth_(truth) {
        std::fill_n(value_, GWB_METRIC_COUNT, std::numeric_limits<double>::quiet_NaN());
        std::fill_n(truth_, GWB_METRIC_COUNT, std::numeric_limits<double>::quiet_NaN());
        step_s_ = count_ > 1 ? s_[1].time_s - s_[0].time_s : std::numeric_limits<double>::quiet_NaN();
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
        otherwise_than_asked();
        forces_on_a_person();
        tip_margin();
        if (hit_) {
            contacts();
            first_contact();
            relatching();
            contact_speed();
            peak_torques();
        }
        if (detected_ != none) {
            at_detection();
            escape();
        }
    }

private:
    [[nodiscard]] const Sample &last() const { return s_[count_ - 1]; }
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
            const Sample &s = s_[i];
            peak_force = std::max(peak_force, s.contact_force);
            travel = std::max(travel, s.bumper_compression);
            least_stored = std::min(least_stored, s.energy_stored);
            most_stored = std::max(most_stored, s.energy_stored);
            work = std::max(work, std::fabs(s.energy_work_in));
            dissipated = std::max(dissipated, s.energy_dissipated);
            residual = std::max(residual, std::fabs(s.energy_residual));
            touched_s = (s.contact || pushed(s)) ? s.time_s : touched_s;
            if (s.detection_count > detections && !(touched_s >= s.time_s - GWB_CAUSE_WINDOW_S)) {
                ++false_detections;
            }
            detections = s.detection_count;
        }
        const double scale = std::max({work, most_stored - least_stored, dissipated});
        set(GWB_PEAK_FORCE, peak_force);
        set(GWB_BUMPER_COMPRESSION, 1e3 * travel);
        if (parameters_.bumper) {
            set(GWB_BOTTOMING_MARGIN, 1e3 * (parameters_.bumper_travel_m - travel));
        }
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

    void forces_on_a_person() {
        const gwb_force_t found = judge_force(
            count_, [this](std::size_t i) { return s_[i].time_s; },
            [this](std::size_t i) { return s_[i].contact_force; }, 0.0);
        set(GWB_TRANSIENT_FORCE, found.transient_n);
        set(GWB_LONGEST_CONTACT, found.longest_contact_s);
        if (found.lasting_known != 0) {
            set(GWB_LASTING_FORCE, found.lasting_n);
        }
        const ForceLimits &limits = parameters_.limits;
        if (limits.lasting_n > 0.0) {
            set(GWB_TRANSIENT_SHARE, found.transient_n > 0.0 ? found.transient_n / limits.transient_n : 0.0);
            if (found.lasting_known != 0) {
                set(GWB_LASTING_SHARE, found.lasting_n / limits.lasting_n);
            }
        }
    }

    // On a plane: distance of the centre of pressure of the wheels' loads from the nearest line between two wheels. It
    // follows from the base's acceleration, the horizontal forces and their heights.
    void tip_margin() {
        double least = 1.0;
        for (std::size_t i = parameters_.tipping ? 0 : 1; i < count_; ++i) {
            least = std::min(least, parameters_.tipping ? s_[i].tip_margin : standing_margin(s_[i - 1], s_[i]));
        }
        set(GWB_TIP_MARGIN, least);
    }

    // Over a row: mean acceleration, mean contact force, the push that acted.
    [[nodiscard]] double standing_margin(const Sample &a, const Sample &b) const {
        const Parameters &p = parameters_;
        const double step_s = b.time_s - a.time_s;
        const auto reach = [&](double push, double force_a, double force_b, double va, double vb) {
            const double moment = p.contact_height_m * 0.5 * (force_a + force_b) + p.push_height_m * push -
                                  p.com_height_m * p.mass_kg * (vb - va) / step_s;
            return moment / (p.mass_kg * plant::gravity_mps2);
        };
        const Vector pressure = to_base({reach(a.push_force_x, a.contact_force_x, b.contact_force_x, a.vx, b.vx),
                                         reach(a.push_force_y, a.contact_force_y, b.contact_force_y, a.vy, b.vy)},
                                        b.theta);
        double farthest = 0.0;
        for (int wheel = 0; wheel < wheel_count; ++wheel) {
            const plant::Side side = plant::side_after<wheel_count>(wheel);
            farthest = std::max(farthest, side.cos * pressure.x + side.sin * pressure.y);
        }
        return 1.0 - farthest / (plant::Azimuths<wheel_count>::side_distance * p.wheel_distance_m);
    }

    // How many contacts there were, the largest force of the first and the speed after it.
    void contacts() {
        int contacts = 1;
        double touched_s = contact_s_;
        double peak = 0.0;
        std::size_t left = start_; // one past the last row of the first contact
        for (std::size_t i = start_; i < count_; ++i) {
            if (!s_[i].contact) {
                continue;
            }
            contacts += s_[i].time_s - touched_s >= GWB_CONTACT_GAP_S ? 1 : 0;
            touched_s = s_[i].time_s;
            if (contacts == 1) {
                peak = std::max(peak, s_[i].contact_force);
                left = i + 1;
            }
        }
        set(GWB_CONTACTS, contacts);
        set(GWB_FIRST_PEAK_FORCE, peak);
        if (left + 1 < count_) {
            set(GWB_REBOUND_SPEED, nose_speed(left));
        }
    }

    // Contact point, and speed of the robot.
    void first_contact() {
        if (start_ < count_ && s_[start_].contact) {
            set(GWB_FIRST_CONTACT_X, 1e3 * s_[start_].contact_base_x);
            set(GWB_FIRST_CONTACT_Y, 1e3 * s_[start_].contact_base_y);
        }
        if (start_ > 0) {
            set(GWB_ROBOT_SPEED, Vector{s_[start_ - 1].vx, s_[start_ - 1].vy}.length());
        }
    }

    // Distance of the controller's reference from its plan before the first reaction, and quantities at their limits.
    void otherwise_than_asked() {
        double distance = 0.0;
        double angle = 0.0;
        double sensed = 0.0;
        double motor = 0.0;
        int faulty = 0;
        bool reacted = false;
        for (std::size_t i = 0; i < count_; ++i) {
            const Sample &s = s_[i];
            for (int wheel = 0; wheel < wheel_count; ++wheel) {
                sensed = std::max(sensed, std::fabs(s.sensed_torque[wheel]));
                motor = std::max(motor, std::fabs(s.motor_torque[wheel]));
            }
            faulty += s.mode == mode_fault ? 1 : 0;
            reacted = reacted || s.mode > mode_tracking;
            if (s.mode == mode_tracking && !reacted) {
                distance = std::max(distance, Vector{s.reference_x - s.plan_x, s.reference_y - s.plan_y}.length());
                angle = std::max(angle, std::fabs(wrapped(degrees(s.reference_theta - s.plan_theta))));
            }
        }
        set(GWB_PLAN_DISTANCE, 1e3 * distance);
        set(GWB_PLAN_ANGLE, angle);
        set(GWB_SENSED_TORQUE_SHARE, sensed / parameters_.sensed_torque_limit_nm);
        set(GWB_MOTOR_TORQUE_SHARE, motor / parameters_.motor_torque_limit_nm);
        set(GWB_FAULT_TIME, faulty * step_s_);
    }

    void relatching() {
        if (!parameters_.bumper) {
            return;
        }
        int times = 0;
        double first_s = 0.0;
        for (std::size_t i = 1; i < count_; ++i) {
            if (s_[i].latched && !s_[i - 1].latched) {
                first_s = times == 0 ? s_[i].time_s : first_s;
                ++times;
            }
        }
        set(GWB_RELATCHES, times);
        if (times > 0) {
            set(GWB_RELATCH_TIME, 1e3 * (first_s - contact_s_));
        }
    }

    // Of the nose relative to the base, from this row to the next.
    [[nodiscard]] double nose_speed(std::size_t row) const {
        const Sample &a = s_[row];
        const Sample &b = s_[row + 1];
        const double step_s = b.time_s - a.time_s;
        return Vector{(b.nose_x - a.nose_x) / step_s - b.vx, (b.nose_y - a.nose_y) / step_s - b.vy}.length();
    }

    void contact_speed() {
        if (start_ < 2) {
            return;
        }
        set(GWB_CONTACT_SPEED, nose_speed(start_ - 2));
    }

    // Impulse of the contact up to detection, base frame at detection.
    [[nodiscard]] Vector true_impulse() const {
        const Sample &s = detected_ == none ? last() : s_[detected_];
        return to_base({s.contact_impulse_x, s.contact_impulse_y}, s.theta);
    }

    // Where it was hit, base frame: mean up to detection, weighted by the force. False if there was no force.
    bool true_point(Vector &point) const {
        double weight = 0.0;
        point = {0.0, 0.0};
        for (std::size_t i = start_; i < detection_end(); ++i) {
            const Sample &s = s_[i];
            weight += s.contact_force;
            point.x += s.contact_force * s.contact_base_x;
            point.y += s.contact_force * s.contact_base_y;
        }
        point = {point.x / weight, point.y / weight};
        return weight > 0.0;
    }

    void peak_torques() {
        double any = 0.0;
        double positive[wheel_count];
        double negative[wheel_count];
        std::fill_n(positive, wheel_count, -std::numeric_limits<double>::infinity());
        std::fill_n(negative, wheel_count, -std::numeric_limits<double>::infinity());
        for (std::size_t i = start_; i < count_; ++i) {
            for (int wheel = 0; wheel < wheel_count; ++wheel) {
                const double torque = s_[i].wheel_torque[wheel];
                any = std::max(any, std::fabs(torque));
                if (s_[i].time_s <= contact_s_ + GWB_PEAK_TORQUE_WINDOW_S) {
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
        double torque[wheel_count];
        double largest = 0.0;
        for (int wheel = 0; wheel < wheel_count; ++wheel) {
            torque[wheel] = -plant::balancing_torque<wheel_count>(
                wheel, parameters_.wheel_radius_m, parameters_.wheel_distance_m, force.x, force.y, moment);
            largest = std::max(largest, std::fabs(torque[wheel]));
        }
        double peak = -std::numeric_limits<double>::infinity();
        for (int wheel = 0; wheel < wheel_count; ++wheel) {
            if (std::fabs(torque[wheel]) >= loaded_share * largest) {
                peak = std::max(peak, torque[wheel] > 0.0 ? positive[wheel] : negative[wheel]);
            }
        }
        set(GWB_PEAK_TORQUE, peak);
    }

    void at_detection() {
        const Sample &s = s_[detected_];
        set(GWB_DETECTION_TIME, 1e3 * (s.time_s - contact_s_));

        const Vector impulse = true_impulse();
        const double true_deg = degrees(math::angle_of(impulse.y, impulse.x));
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
        const double rows = std::max(1.0, math::round(parameters_.estimate_window_s / step_s_));
        const std::size_t available = detected_ + 1;
        const std::size_t window = rows < static_cast<double>(available) ? static_cast<std::size_t>(rows) : available;
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
        set(GWB_IMPULSE, estimated.length() * step_s_, impulse.length());
    }

    // Every new hit starts the escape anew, so it counts from the last detection.
    void escape() {
        std::size_t row = count_ - 1;
        while (row > 0 && s_[row].detection_count <= s_[row - 1].detection_count) {
            --row;
        }
        const Sample &s = s_[row];
        set(GWB_ESCAPE, Vector{last().reference_x - s.reference_x, last().reference_y - s.reference_y}.length(),
            Vector{last().x - s.x, last().y - s.y}.length());
    }

    const Sample *s_;
    std::size_t count_;
    const Parameters &parameters_;
    double *value_;
    double *truth_;
    double step_s_ = 0.0; // NaN if there is but one row
    double contact_s_ = -1.0;
    bool hit_ = false;
    std::size_t start_ = 0; // first row at or after contact
    std::size_t detected_ = none;
};

} // namespace

void evaluate(const Sample *samples, std::size_t count, const testbed::Variables &testbed,
              const controller::Variables &controller, const ForceLimits &limits, double *value, double *truth) {
    const Parameters parameters(testbed, controller, limits);
    Collision(samples, count, parameters, value, truth).all();
}

} // namespace giveway::batch
