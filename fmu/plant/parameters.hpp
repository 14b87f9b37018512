// Parameters of the plant, SI units. README.md of this folder has the equations.
#pragma once

#include <array>
#include <cstdint>

// Before any equation: `math::` names are looked up where a template is written, so every scalar type has to be known here.
#include "../math/dual.hpp"
#include "../math/lanes.hpp"

namespace giveway::plant {

inline constexpr int wheel_count = 3;
inline constexpr int max_outline_vertices = 16;

// Wheel azimuths 0, 120, 240 deg in the base frame.
inline constexpr double half_sqrt3 = 0.8660254037844386;
inline constexpr std::array<double, wheel_count> wheel_cos = {1.0, -0.5, -0.5};
inline constexpr std::array<double, wheel_count> wheel_sin = {0.0, half_sqrt3, -half_sqrt3};

inline constexpr double gravity_mps2 = 9.81;

enum class RollerModel : std::uint8_t { bristle = 0, tanh = 1 };
enum class BumperKind : std::uint8_t { none = 0, spring = 1, magnetic = 2 };
enum class BumperMount : std::uint8_t { slider = 0, robot = 1 };
enum class LatchModel : std::uint8_t { continuous = 0, ideal = 1 };
enum class NoseShape : std::uint8_t { disc = 0, edge = 1 };

template <class T> struct Parameters {
    // Base; mass and inertia include the wheels.
    T mass, yaw_inertia;
    T wheel_radius, wheel_distance, wheel_inertia;
    T roller_radius, roller_inertia;
    std::array<T, wheel_count> wheel_load;     // normal load over its nominal value; on a plane 1
    std::array<T, wheel_count> wheel_traction; // 1 on the floor, 0 lifted; on a plane 1

    // Only with tipping.
    std::int32_t tipping;
    T tilt_inertia;                                        // about any horizontal axis through the centre of mass, wheels included
    T com_height;
    T floor_contact_stiffness, floor_contact_damping;      // vertical, of one wheel and the floor under it
    T grip_friction, grip_stiffness, grip_damping;         // of a wheel along its rolling direction, at nominal load
    T push_height;

    RollerModel roller_model;
    T roller_torque;                                       // B_r of (28)
    T roller_slope;                                        // alpha of (28), s/rad
    std::array<T, wheel_count> roller_presliding_stiffness; // sigma0, N/m
    T roller_presliding_damping;                           // sigma1, N s/m
    T roller_stribeck_speed;                               // v_S, m/s
    T roller_elastic_fraction;                             // rho_ba

    T motor_inertia, drivetrain_stiffness, drivetrain_damping;
    T gear_coulomb, gear_stiction, gear_viscous;
    T torque_limit;

    std::int32_t slider_present;
    T slider_mass; // everything that slides, a bumper plate mounted on it included
    T slider_friction, slider_friction_speed, slider_damping;
    T rail_direction;       // azimuth of travel, world frame, rad
    T target_x, target_y;   // where the nose's tip is after run_up, world frame
    T run_up;

    std::int32_t wall_present;
    T wall_distance; // free travel of the slider against its direction
    T wall_stiffness, wall_damping;

    std::int32_t rope_attached;
    T hanging_mass, rope_stiffness, rope_damping;
    T drop_height, floor_stiffness, floor_damping;

    BumperKind bumper_kind;
    BumperMount bumper_mount;
    LatchModel latch_model;
    T plate_mass, spring_rate, preload, bumper_damping;
    T guide_friction, guide_friction_speed;
    T travel, stop_stiffness, stop_damping;
    T latch_force, latch_gap;
    T mount_x, mount_y, mount_azimuth; // robot-mounted plate at full extension, base frame

    NoseShape nose_shape;
    T nose_radius, contact_stiffness, contact_damping;
    T contact_friction, contact_friction_speed;
    T contact_height; // above the floor

    // Parts of the outline at the contact's height: the body's polygon, the wheels.
    std::int32_t outline_body, outline_wheels;
    T wheel_width;
    std::int32_t outline_count;
    std::array<T, max_outline_vertices> outline_x, outline_y; // counter-clockwise, base frame

    // The plate moves on its own only if there is one.
    [[nodiscard]] bool has_plate() const { return bumper_kind != BumperKind::none; }
    [[nodiscard]] bool plate_on_robot() const { return has_plate() && bumper_mount == BumperMount::robot; }
    [[nodiscard]] bool has_ideal_latch() const {
        return bumper_kind == BumperKind::magnetic && latch_model == LatchModel::ideal;
    }
    [[nodiscard]] bool has_continuous_latch() const {
        return bumper_kind == BumperKind::magnetic && latch_model == LatchModel::continuous;
    }
};

// What the equations need again and again and that never changes during a run.
template <class T> struct Derived {
    T rail_x, rail_y;     // unit vector of travel, world frame
    T origin_x, origin_y; // nose centre at s = 0, c = 0, world frame
    T plate_x, plate_y;   // unit outward vector of a robot-mounted plate, base frame
    T carriage_mass;      // slider without a plate that moves on its own
    T rope_pretension_length; // ext0
    T tip_rate;               // of tipping over the line between two wheels, 1/s
    T wheel_half_length;      // of a wheel's section at the contact's height, along its rolling direction
    std::array<T, max_outline_vertices> edge_x, edge_y, edge_length; // unit direction from vertex i to i + 1
};

template <class T> Derived<T> derive(const Parameters<T>& p) {
    Derived<T> d{};
    const auto rail = math::sincos(p.rail_direction);
    d.rail_x = rail.cos;
    d.rail_y = rail.sin;
    d.origin_x = p.target_x - rail.cos * (p.run_up + p.nose_radius);
    d.origin_y = p.target_y - rail.sin * (p.run_up + p.nose_radius);
    const auto mount = math::sincos(p.mount_azimuth);
    d.plate_x = mount.cos;
    d.plate_y = mount.sin;
    d.carriage_mass = (p.has_plate() && !p.plate_on_robot()) ? p.slider_mass - p.plate_mass : p.slider_mass;
    d.rope_pretension_length = p.hanging_mass * T(gravity_mps2) / p.rope_stiffness;
    const T tipping_inertia = p.tilt_inertia + p.mass * (math::square(p.com_height) + math::square(T(0.5) * p.wheel_distance));
    d.tip_rate = math::sqrt(p.mass * T(gravity_mps2) * p.com_height / tipping_inertia);
    d.wheel_half_length = math::sqrt(math::max(T(0.0), math::square(p.wheel_radius) - math::square(p.contact_height - p.wheel_radius)));
    for (int i = 0; i < p.outline_count; ++i) {
        const int next = (i + 1 == p.outline_count) ? 0 : i + 1;
        const T dx = p.outline_x[next] - p.outline_x[i];
        const T dy = p.outline_y[next] - p.outline_y[i];
        d.edge_length[i] = math::sqrt(dx * dx + dy * dy);
        d.edge_x[i] = dx / d.edge_length[i];
        d.edge_y[i] = dy / d.edge_length[i];
    }
    return d;
}

} // namespace giveway::plant
