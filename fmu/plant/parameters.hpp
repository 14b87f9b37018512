// Parameters of the plant, SI units. README.md of this folder has the equations.
#pragma once

#include <array>
#include <cstdint>

// Before any equation: `math::` names are looked up where a template is written, so every scalar type has to be known here.
#include "../math/dual.hpp"
#include "../math/lanes_elementary.hpp"

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
    math::Divisor<T> wheel_radius;
    T wheel_distance, wheel_inertia;
    math::Divisor<T> roller_radius;
    T roller_inertia;
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
    math::Divisor<T> roller_stribeck_speed;                // v_S, m/s
    T roller_elastic_fraction;                             // rho_ba

    math::Divisor<T> motor_inertia;
    T drivetrain_stiffness, drivetrain_damping;
    T gear_coulomb, gear_stiction, gear_viscous;
    T torque_limit;

    std::int32_t slider_present;
    math::Divisor<T> slider_mass; // everything that slides, a bumper plate mounted on it included
    T slider_friction;
    math::Divisor<T> slider_friction_speed;
    T slider_damping;
    T rail_direction;       // azimuth of travel, world frame, rad
    T target_x, target_y;   // where the nose's tip is after run_up, world frame
    T run_up;

    std::int32_t wall_present;
    T wall_distance; // free travel of the slider against its direction
    T wall_stiffness, wall_damping;

    std::int32_t rope_attached;
    math::Divisor<T> hanging_mass;
    T rope_stiffness, rope_damping;
    T drop_height, floor_stiffness, floor_damping;

    BumperKind bumper_kind;
    BumperMount bumper_mount;
    LatchModel latch_model;
    math::Divisor<T> plate_mass;
    T spring_rate, preload, bumper_damping;
    T guide_friction;
    math::Divisor<T> guide_friction_speed;
    T travel, stop_stiffness, stop_damping;
    T latch_force;
    math::Divisor<T> latch_gap;
    T mount_x, mount_y, mount_azimuth; // robot-mounted plate at full extension, base frame

    NoseShape nose_shape;
    T nose_radius, contact_stiffness, contact_damping;
    T contact_friction;
    math::Divisor<T> contact_friction_speed;
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

} // namespace giveway::plant
