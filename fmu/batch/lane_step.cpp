#include "lane_step.hpp"

#include <algorithm>
#include <cmath>

#include "drives.hpp"

namespace giveway::batch {

namespace {

// Limits for a step: a vibration advances by at most this angle, and a decay by at most this exponent. The
// classic Runge-Kutta method is stable up to 2.8; these are its accuracy's bounds, from the comparison with the
// event-exact method (README.md).
constexpr double greatest_angle = 0.2;
constexpr double greatest_decay = 0.6;

// The stiffest of several elements.
class Stiffest {
public:
    void vibration(double stiffness, double mass) { angle_ = std::max(angle_, std::sqrt(stiffness / mass)); }
    void decay(double damping, double mass) { decay_ = std::max(decay_, damping / mass); }
    [[nodiscard]] double longest_step() const { return std::min(greatest_angle / angle_, greatest_decay / decay_); }

private:
    double angle_ = 1e-9; // rad/s
    double decay_ = 1e-9; // 1/s
};

double together(double a, double b) { return 1.0 / (1.0 / a + 1.0 / b); }

// Slider, bumper, contact, rope and wall.
void slider(Stiffest &s, const plant::Parameters<double> &p, double v) {
    const bool plate = p.has_plate();
    const double carriage = plate && !p.plate_on_robot() ? p.slider_mass - p.bumper_plate_mass : p.slider_mass;
    const double nose = plate && !p.plate_on_robot() ? p.bumper_plate_mass : p.slider_mass; // mass that hits the robot
    const double met = p.plate_on_robot() ? p.bumper_plate_mass : p.base_mass;
    const double contact = together(nose, met);
    s.vibration(p.contact_stiffness, contact);
    s.decay(p.contact_stiffness * p.contact_damping * v * std::sqrt(contact / p.contact_stiffness), contact);
    const double peak = v * std::sqrt(p.contact_stiffness * contact);
    s.decay(p.contact_friction * peak / p.contact_friction_speed,
            together(p.slider_mass, p.base_mass / plant::table_wheels));
    s.decay(p.slider_friction / p.slider_friction_speed + p.slider_damping, carriage);
    if (plate) {
        const double guided = together(p.bumper_plate_mass, p.plate_on_robot() ? p.base_mass : carriage);
        s.vibration(plant::with_bumper_law(p, [&](auto law) { return law.greatest_stiffness(p); }), guided);
        s.vibration(p.bumper_stop_stiffness, guided);
        const double drag = plant::with_bumper_law(p, [&](auto law) { return law.greatest_damping(p, v); });
        s.decay(p.bumper_damping + drag + p.bumper_guide_friction / p.bumper_guide_friction_speed, guided);
        s.decay(p.bumper_stop_stiffness * p.bumper_stop_damping * v * std::sqrt(guided / p.bumper_stop_stiffness),
                guided);
    }
    if (p.rope_attached != 0) {
        const double pulled = together(carriage, p.rope_hanging_mass);
        s.vibration(p.rope_stiffness, pulled);
        s.decay(p.rope_damping, pulled);
        s.vibration(p.rope_floor_stiffness, p.rope_hanging_mass);
        s.decay(p.rope_floor_stiffness * p.rope_floor_damping * v *
                    std::sqrt(p.rope_hanging_mass / p.rope_floor_stiffness),
                p.rope_hanging_mass);
    }
    if (p.wall_present != 0) {
        s.vibration(p.wall_stiffness, carriage);
        s.decay(p.wall_stiffness * p.wall_damping * v * std::sqrt(carriage / p.wall_stiffness), carriage);
    }
}

} // namespace

double greatest_impact_speed(const plant::Parameters<double> &p, double slider_speed_mps, double base_speed_mps) {
    double square = slider_speed_mps * slider_speed_mps;
    if (p.rope_attached != 0) {
        const double fall = std::clamp(p.slider_run_up, 0.0, p.rope_drop_height);
        square += 2.0 * plant::gravity_mps2 * fall * p.rope_hanging_mass / (p.rope_hanging_mass + p.slider_mass);
    }
    return std::sqrt(square) + base_speed_mps;
}

int lane_steps_per_tick(const plant::Parameters<double> &p, double impact_speed_mps) {
    Stiffest s;
    const double v = impact_speed_mps;
    // Wheels: drivetrain between motor and base, rollers under the base. Each wheel has its share of the base.
    const double share = p.base_mass / plant::table_wheels;
    const double wheel = p.wheel_inertia + share * p.wheel_radius * p.wheel_radius;
    s.vibration(p.drivetrain_stiffness, together(p.drivetrain_motor_inertia, wheel));
    s.decay(p.drivetrain_damping, together(p.drivetrain_motor_inertia, wheel));
    // Of rollers one by one the weakest.
    const double weakest =
        p.roller_arrangement == plant::RollerArrangement::discrete ? 1.0 - p.roller_friction_scatter : 1.0;
    for (std::size_t i = 0; i < plant::table_wheels; ++i) {
        s.decay(p.drivetrain_friction_scale[i] * p.drivetrain_gear_viscous, p.drivetrain_motor_inertia);
        const double coulomb =
            weakest * p.roller_friction_scale[i] * p.wheel_load[i] * p.roller_coulomb_torque / p.roller_radius;
        if (p.roller_model == plant::RollerModel::bristle) {
            const double sigma = p.roller_presliding_stiffness[i];
            s.vibration(sigma, share);
            // A bristle that slides at v follows the floor within its limit's deflection.
            s.decay(sigma * v, coulomb);
        } else {
            s.decay(coulomb * p.roller_tanh_slope / p.roller_radius, share);
        }
    }
    if (p.roller_model == plant::RollerModel::bristle) {
        s.decay(p.roller_presliding_damping, share);
    }
    if (p.slider_present != 0) {
        slider(s, p, v);
    }
    const double tick_s = 1.0 / static_cast<double>(testbed::servo_rate_hz);
    for (const int steps : lane_steps) {
        if (tick_s / steps <= s.longest_step()) {
            return steps;
        }
    }
    return 0;
}

} // namespace giveway::batch
