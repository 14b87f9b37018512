// Random parameters, states, inputs and modes of the plant, the same numbers for every scalar type T.
// Include it after T's functions are declared: the plant looks them up where its templates are written.
#pragma once

#include <random>

#include "initial_state.hpp"
#include "outputs.hpp"

namespace giveway::plant::random_cases {

template <class T, int Wheels = table_wheels> Parameters<T, Wheels> random_parameters(unsigned seed) {
    std::mt19937 generator(seed);
    const auto draw = [&](double low, double high) {
        return T(std::uniform_real_distribution<double>(low, high)(generator));
    };
    Parameters<T, Wheels> p{};
    p.base_mass = draw(10.0, 60.0);
    p.base_yaw_inertia = draw(0.5, 3.0);
    p.wheel_radius = draw(0.05, 0.15);
    p.wheel_distance = draw(0.2, 0.3);
    p.wheel_inertia = draw(0.001, 0.01);
    p.roller_radius = draw(0.005, 0.02);
    p.roller_inertia = draw(1e-7, 1e-5);
    for (int i = 0; i < Wheels; ++i) {
        p.wheel_load[i] = draw(0.5, 1.5);
        p.wheel_traction[i] = T(1.0);
        p.roller_presliding_stiffness[i] = draw(1e4, 5e4);
    }
    p.roller_model = RollerModel::bristle;
    p.roller_coulomb_torque = draw(0.1, 0.4);
    p.roller_tanh_slope = draw(0.2, 0.8);
    p.roller_presliding_damping = draw(1.0, 50.0);
    p.roller_stribeck_speed = draw(0.001, 0.01);
    p.roller_elastic_fraction = draw(0.3, 0.9);
    p.drivetrain_motor_inertia = draw(0.01, 0.1);
    p.drivetrain_stiffness = draw(300.0, 2000.0);
    p.drivetrain_damping = draw(0.1, 2.0);
    p.drivetrain_gear_coulomb = draw(1.0, 2.0);
    p.drivetrain_gear_stiction = draw(2.0, 4.0);
    p.drivetrain_gear_viscous = draw(0.0, 0.1);
    p.drivetrain_torque_limit = draw(10.0, 30.0);
    p.slider_present = 1;
    p.slider_mass = draw(5.0, 15.0);
    p.slider_friction = draw(0.0, 2.0);
    p.slider_friction_speed = draw(0.002, 0.01);
    p.slider_damping = draw(0.0, 1.0);
    p.slider_direction = draw(-3.0, 3.0);
    p.slider_target_x = draw(-0.2, 0.2);
    p.slider_target_y = draw(-0.2, 0.2);
    p.slider_run_up = draw(0.0, 0.1);
    p.rope_attached = 1;
    p.rope_hanging_mass = draw(1.0, 6.0);
    p.rope_stiffness = draw(5e3, 2e4);
    p.rope_damping = draw(50.0, 200.0);
    p.rope_drop_height = draw(0.1, 0.5);
    p.rope_floor_stiffness = draw(1e4, 3e4);
    p.rope_floor_damping = draw(1.0, 3.0);
    p.bumper_kind = static_cast<BumperKind>(seed % 3U);
    p.bumper_mount = static_cast<BumperMount>((seed / 3U) % 2U);
    p.bumper_latch_model = static_cast<LatchModel>((seed / 6U) % 2U);
    p.bumper_plate_mass = draw(0.2, 1.0);
    p.bumper_spring_rate = draw(300.0, 2000.0);
    p.bumper_preload = draw(0.0, 5.0);
    p.bumper_damping = draw(0.0, 10.0);
    p.bumper_guide_friction = draw(0.0, 2.0);
    p.bumper_guide_friction_speed = draw(0.002, 0.01);
    p.bumper_travel = draw(0.05, 0.15);
    p.bumper_stop_stiffness = draw(1e5, 3e5);
    p.bumper_stop_damping = draw(0.1, 2.0);
    p.bumper_latch_force = draw(10.0, 60.0);
    p.bumper_latch_gap = draw(0.0005, 0.002);
    p.bumper_mount_x = draw(0.1, 0.2);
    p.bumper_mount_y = draw(0.1, 0.3);
    p.bumper_mount_azimuth = draw(0.0, 2.0);
    p.wall_present = static_cast<std::int32_t>(seed / 12U % 2U);
    p.wall_distance = draw(0.0, 0.2);
    p.wall_stiffness = draw(1e5, 3e5);
    p.wall_damping = draw(0.1, 2.0);
    p.contact_nose_shape = static_cast<NoseShape>(p.plate_on_robot() ? 0U : seed / 24U % 2U);
    p.contact_nose_radius = draw(0.0, 0.03);
    p.contact_stiffness = draw(5e3, 5e4);
    p.contact_damping = draw(0.0, 1.0);
    p.contact_friction = draw(0.0, 0.5);
    p.contact_friction_speed = draw(0.002, 0.01);
    p.contact_height = draw(0.0, 0.2);
    p.outline_body = seed / 48U % 3U == 1U ? 0 : 1;
    p.outline_wheels = seed / 48U % 3U == 0U ? 0 : 1;
    p.wheel_width = draw(0.02, 0.06);
    p.outline_count = 3;
    p.outline_x = {T(0.352184), T(-0.176092), T(-0.176092)};
    p.outline_y = {T(0.0), T(0.305), T(-0.305)};
    p.base_tipping = 0;
    p.base_tilt_inertia = draw(1.0, 3.0);
    p.base_com_height = draw(0.1, 0.6);
    p.wheel_floor_stiffness = draw(1e5, 5e5);
    p.wheel_floor_damping = draw(0.0, 3.0);
    p.wheel_grip_friction = draw(0.4, 1.0);
    p.wheel_grip_stiffness = draw(1e6, 3e6);
    p.wheel_grip_damping = draw(0.0, 500.0);
    p.push_height = draw(0.0, 0.6);
    for (int i = 0; i < Wheels; ++i) {
        p.roller_friction_scale[i] = draw(0.5, 1.5);
        p.drivetrain_friction_scale[i] = draw(0.8, 1.2);
    }
    p.roller_nominal_mass = draw(10.0, 60.0);
    p.base_com_x = draw(-0.05, 0.05);
    p.base_com_y = draw(-0.05, 0.05);
    p.floor_slope = draw(0.0, 0.1);
    p.floor_azimuth = draw(-3.0, 3.0);
    p.imu_x = draw(-0.3, 0.3);
    p.imu_y = draw(-0.3, 0.3);
    p.imu_height = draw(0.0, 0.5);
    p.imu_azimuth = draw(-3.0, 3.0);
    p.roller_arrangement = static_cast<RollerArrangement>(seed % 5U / 3U);
    p.roller_rows = static_cast<std::int32_t>(1U + seed % 4U);
    p.roller_per_row = 40;
    p.roller_row_distance = draw(0.0, 0.02);
    p.roller_radius_dip = draw(0.0, 2e-5);
    p.roller_friction_scatter = draw(0.0, 0.5);
    p.roller_seed = T(static_cast<double>(seed));
    for (auto &phase : p.roller_phase) {
        phase = draw(-0.5, 0.5);
    }
    if (seed / 5U % 3U == 2U) {
        p.bumper_kind = static_cast<BumperKind>(3U + seed % 6U);
    }
    p.bumper_foam_thickness = draw(0.1, 0.3);
    p.bumper_foam_force_25 = draw(10.0, 20.0);
    p.bumper_foam_force_50 = draw(25.0, 40.0);
    p.bumper_foam_force_75 = draw(70.0, 120.0);
    p.bumper_foam_hysteresis = draw(0.0, 0.6);
    p.bumper_foam_hysteresis_speed = draw(0.005, 0.05);
    p.bumper_foam_rate_gain = draw(0.0, 2.0);
    p.bumper_gas_force = draw(10.0, 100.0);
    p.bumper_gas_length = draw(0.15, 0.4);
    p.bumper_gas_exponent = seed % 12U == 3U ? T(1.0) : draw(1.0, 1.6);
    p.bumper_gas_ambient_force = draw(0.0, 100.0);
    p.bumper_damper_rate = draw(10.0, 200.0);
    p.bumper_damper_square = draw(0.0, 100.0);
    p.bumper_damper_rebound = draw(0.0, 2.0);
    p.bumper_second_rate = draw(300.0, 4000.0);
    p.bumper_second_preload = draw(0.0, 10.0);
    p.bumper_first_travel = draw(0.02, 0.1);
    p.bumper_lever_ratio = draw(0.5, 2.0);
    p.bumper_lever_mass = draw(0.0, 1.0);
    p.bumper_table_rows = 4;
    p.bumper_table_columns = 3;
    T travel(0.0);
    for (std::size_t i = 0; i < 4U; ++i) {
        p.bumper_table_travel[i] = travel;
        travel = travel + draw(0.02, 0.08);
        T force = draw(0.0, 100.0);
        for (std::size_t j = 0; j < 3U; ++j) {
            p.bumper_table_force[p.bumper_table_speed.size() * i + j] = force;
            force = force + draw(1.0, 20.0);
        }
    }
    p.bumper_table_speed = {draw(-0.15, -0.05), T(0.0), draw(0.05, 0.15)};
    return p;
}

template <class T, int Wheels = table_wheels> struct Case {
    Parameters<T, Wheels> p;
    Derived<T> d;
    StateVector<T, Wheels> x;
    Inputs<T, Wheels> u;
    Modes<T, Wheels> m;
    EventVector<T, Wheels> fired;
};

template <class T, int Wheels = table_wheels> Case<T, Wheels> random_case(unsigned seed) {
    Case<T, Wheels> c{};
    c.p = random_parameters<T, Wheels>(seed);
    c.d = derive(c.p);
    std::mt19937 generator(seed + 1'000'000U);
    const auto draw = [&](double low, double high) {
        return T(std::uniform_real_distribution<double>(low, high)(generator));
    };
    const auto flag = [&] { return T(std::uniform_int_distribution<int>(0, 1)(generator)); };
    const auto three_way = [&] { return T(std::uniform_int_distribution<int>(-1, 1)(generator)); };
    for (auto &value : c.x) {
        value = draw(-0.2, 0.2);
    }
    for (auto &torque : c.u.motor_torque) {
        torque = draw(-9.0, 9.0);
    }
    c.u.push_force_x = draw(-50.0, 50.0);
    c.u.push_force_y = draw(-50.0, 50.0);
    c.u.push_point_x = draw(-0.3, 0.3);
    c.u.push_point_y = draw(-0.3, 0.3);
    for (auto &direction : c.m.gear_direction) {
        direction = three_way();
    }
    c.m.contact = flag();
    c.m.rope_taut = flag();
    c.m.end_stop = flag();
    c.m.bottom_stop = flag();
    c.m.latched = flag();
    c.m.landed = flag();
    c.m.walled = flag();
    if (discrete(c.p)) {
        for (int i = 0; i < Wheels; ++i) {
            const T angle = c.x[Layout<Wheels>::wheel_angle + i] + c.p.roller_phase[i];
            stand_on(c.p, c.m, i, math::round(angle / c.d.roller_pitch));
        }
    }
    for (auto &f : c.fired) {
        f = three_way();
    }
    return c;
}

// The same robot on wheels that it can lift: near the floor, leaning by up to 11 deg, bristles of a tenth of a
// millimetre.
template <class T, int Wheels = table_wheels> struct TippingCase {
    Case<T, Wheels> planar;
    TippingVector<T, Wheels> x;
    TippingEvents<T, Wheels> fired;
};

template <class T, int Wheels = table_wheels> TippingCase<T, Wheels> random_tipping_case(unsigned seed) {
    using At = Layout<Wheels>;
    TippingCase<T, Wheels> c{random_case<T, Wheels>(seed), {}, {}};
    c.planar.p.base_tipping = 1;
    c.planar.p.bumper_mount = BumperMount::slider;
    c.planar.d = derive(c.planar.p);
    std::mt19937 generator(seed + 2'000'000U);
    const auto draw = [&](double low, double high) {
        return T(std::uniform_real_distribution<double>(low, high)(generator));
    };
    for (int i = 0; i < At::state_count; ++i) {
        c.x[i] = c.planar.x[i];
    }
    c.x[At::base_heave] = draw(-0.002, 0.005);
    for (const int i : {At::base_roll, At::base_pitch, At::heave_rate, At::body_roll_rate, At::body_pitch_rate}) {
        c.x[i] = draw(-0.2, 0.2);
    }
    for (int i = 0; i < Wheels; ++i) {
        c.x[At::wheel_spin + i] = draw(-2.0, 2.0);
        c.x[At::bristle + i] = draw(-1e-3, 1e-3);
        c.x[At::grip + i] = draw(-5e-5, 5e-5);
        c.planar.m.on_floor[i] = T(std::uniform_int_distribution<int>(0, 1)(generator));
    }
    for (auto &f : c.fired) {
        f = T(std::uniform_int_distribution<int>(-1, 1)(generator));
    }
    return c;
}

} // namespace giveway::plant::random_cases
