// The plant compiles for a scalar that has no comparison operators and no conversion to bool, so no branch on T can hide in it,
// and gives the same bits as with double: what lanes and derivatives will rely on.
#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include "elementary.hpp"

namespace giveway::math {

struct StrictMask {
    bool value;
};

struct Strict {
    double value;
    Strict() : value(0.0) {}
    explicit Strict(double v) : value(v) {}
    friend Strict operator+(Strict a, Strict b) { return Strict(a.value + b.value); }
    friend Strict operator-(Strict a, Strict b) { return Strict(a.value - b.value); }
    friend Strict operator*(Strict a, Strict b) { return Strict(a.value * b.value); }
    friend Strict operator/(Strict a, Strict b) { return Strict(a.value / b.value); }
};

inline StrictMask less(Strict a, Strict b) { return {a.value < b.value}; }
inline Strict select(StrictMask m, Strict a, Strict b) { return m.value ? a : b; }
inline Strict min(Strict a, Strict b) { return Strict(min(a.value, b.value)); }
inline Strict max(Strict a, Strict b) { return Strict(max(a.value, b.value)); }
inline Strict abs(Strict a) { return Strict(abs(a.value)); }
inline Strict sqrt(Strict a) { return Strict(sqrt(a.value)); }
inline Strict round(Strict a) { return Strict(round(a.value)); }
inline Strict exp2_integer(Strict a) { return Strict(exp2_integer(a.value)); }

} // namespace giveway::math

#include "initial_state.hpp"
#include "outputs.hpp"

namespace {

using giveway::math::Strict;
using namespace giveway::plant;

// Both parameter sets from one list of numbers: T parameters are filled in declaration order.
template <class T> Parameters<T> random_parameters(unsigned seed) {
    std::mt19937 generator(seed);
    const auto draw = [&](double low, double high) { return T(std::uniform_real_distribution<double>(low, high)(generator)); };
    Parameters<T> p{};
    p.mass = draw(10.0, 60.0);
    p.yaw_inertia = draw(0.5, 3.0);
    p.wheel_radius = draw(0.05, 0.15);
    p.wheel_distance = draw(0.2, 0.3);
    p.wheel_inertia = draw(0.001, 0.01);
    p.roller_radius = draw(0.005, 0.02);
    p.roller_inertia = draw(1e-7, 1e-5);
    for (int i = 0; i < wheel_count; ++i) {
        p.wheel_load[i] = draw(0.5, 1.5);
        p.wheel_traction[i] = T(1.0);
        p.roller_presliding_stiffness[i] = draw(1e4, 5e4);
    }
    p.roller_model = RollerModel::bristle;
    p.roller_torque = draw(0.1, 0.4);
    p.roller_slope = draw(0.2, 0.8);
    p.roller_presliding_damping = draw(1.0, 50.0);
    p.roller_stribeck_speed = draw(0.001, 0.01);
    p.roller_elastic_fraction = draw(0.3, 0.9);
    p.motor_inertia = draw(0.01, 0.1);
    p.drivetrain_stiffness = draw(300.0, 2000.0);
    p.drivetrain_damping = draw(0.1, 2.0);
    p.gear_coulomb = draw(1.0, 2.0);
    p.gear_stiction = draw(2.0, 4.0);
    p.gear_viscous = draw(0.0, 0.1);
    p.torque_limit = draw(10.0, 30.0);
    p.slider_present = 1;
    p.slider_mass = draw(5.0, 15.0);
    p.slider_friction = draw(0.0, 2.0);
    p.slider_friction_speed = draw(0.002, 0.01);
    p.slider_damping = draw(0.0, 1.0);
    p.rail_direction = draw(-3.0, 3.0);
    p.target_x = draw(-0.2, 0.2);
    p.target_y = draw(-0.2, 0.2);
    p.run_up = draw(0.0, 0.1);
    p.rope_attached = 1;
    p.hanging_mass = draw(1.0, 6.0);
    p.rope_stiffness = draw(5e3, 2e4);
    p.rope_damping = draw(50.0, 200.0);
    p.drop_height = draw(0.1, 0.5);
    p.floor_stiffness = draw(1e4, 3e4);
    p.floor_damping = draw(1.0, 3.0);
    p.bumper_kind = static_cast<BumperKind>(seed % 3U);
    p.bumper_mount = static_cast<BumperMount>((seed / 3U) % 2U);
    p.latch_model = static_cast<LatchModel>((seed / 6U) % 2U);
    p.plate_mass = draw(0.2, 1.0);
    p.spring_rate = draw(300.0, 2000.0);
    p.preload = draw(0.0, 5.0);
    p.bumper_damping = draw(0.0, 10.0);
    p.guide_friction = draw(0.0, 2.0);
    p.guide_friction_speed = draw(0.002, 0.01);
    p.travel = draw(0.05, 0.15);
    p.stop_stiffness = draw(1e5, 3e5);
    p.stop_damping = draw(0.1, 2.0);
    p.latch_force = draw(10.0, 60.0);
    p.latch_gap = draw(0.0005, 0.002);
    p.mount_x = draw(0.1, 0.2);
    p.mount_y = draw(0.1, 0.3);
    p.mount_azimuth = draw(0.0, 2.0);
    p.nose_radius = draw(0.0, 0.03);
    p.contact_stiffness = draw(5e3, 5e4);
    p.contact_damping = draw(0.0, 1.0);
    p.contact_friction = draw(0.0, 0.5);
    p.contact_friction_speed = draw(0.002, 0.01);
    p.outline_count = 3;
    p.outline_x = {T(0.352184), T(-0.176092), T(-0.176092)};
    p.outline_y = {T(0.0), T(0.305), T(-0.305)};
    return p;
}

template <class T> struct Case {
    Parameters<T> p;
    Derived<T> d;
    StateVector<T> x;
    Inputs<T> u;
    Modes<T> m;
    EventVector<T> fired;
};

template <class T> Case<T> random_case(unsigned seed) {
    Case<T> c{};
    c.p = random_parameters<T>(seed);
    c.d = derive(c.p);
    std::mt19937 generator(seed + 1'000'000U);
    const auto draw = [&](double low, double high) { return T(std::uniform_real_distribution<double>(low, high)(generator)); };
    const auto flag = [&] { return T(std::uniform_int_distribution<int>(0, 1)(generator)); };
    const auto three_way = [&] { return T(std::uniform_int_distribution<int>(-1, 1)(generator)); };
    for (auto& value : c.x) {
        value = draw(-0.2, 0.2);
    }
    c.u = {{draw(-9.0, 9.0), draw(-9.0, 9.0), draw(-9.0, 9.0)}, draw(-50.0, 50.0), draw(-50.0, 50.0), draw(-0.3, 0.3), draw(-0.3, 0.3)};
    for (auto& direction : c.m.gear_direction) {
        direction = three_way();
    }
    c.m.contact = flag();
    c.m.rope_taut = flag();
    c.m.end_stop = flag();
    c.m.bottom_stop = flag();
    c.m.latched = flag();
    c.m.landed = flag();
    for (auto& f : c.fired) {
        f = three_way();
    }
    return c;
}

template <std::size_t N> void expect_same_bits(const std::array<double, N>& a, const std::array<Strict, N>& b, unsigned seed) {
    static_assert(sizeof(Strict) == sizeof(double));
    EXPECT_EQ(std::memcmp(a.data(), b.data(), sizeof a), 0) << "case " << seed;
}

} // namespace

TEST(StrictScalar, GivesTheBitsOfDouble) {
    for (unsigned seed = 0; seed < 2000U; ++seed) {
        auto a = random_case<double>(seed);
        auto b = random_case<Strict>(seed);
        expect_same_bits(rhs(a.x, a.u, a.m, a.p, a.d), rhs(b.x, b.u, b.m, b.p, b.d), seed);
        expect_same_bits(event_indicators(a.x, a.u, a.m, a.p, a.d), event_indicators(b.x, b.u, b.m, b.p, b.d), seed);
        const auto outputs_a = outputs(a.x, a.u, a.m, a.p, a.d);
        const auto outputs_b = outputs(b.x, b.u, b.m, b.p, b.d);
        EXPECT_EQ(std::memcmp(&outputs_a, &outputs_b, sizeof outputs_a), 0) << "case " << seed;
        transition(a.x, a.u, a.m, a.fired, a.p, a.d);
        transition(b.x, b.u, b.m, b.fired, b.p, b.d);
        expect_same_bits(a.x, b.x, seed);
        EXPECT_EQ(std::memcmp(&a.m, &b.m, sizeof a.m), 0) << "case " << seed;
        initial_state<double>({0.1, 0.2, 0.3, 0.1, -0.2, 0.4, 0.5}, a.u, a.p, a.d, a.x, a.m);
        initial_state<Strict>({Strict(0.1), Strict(0.2), Strict(0.3), Strict(0.1), Strict(-0.2), Strict(0.4), Strict(0.5)}, b.u, b.p, b.d, b.x, b.m);
        expect_same_bits(a.x, b.x, seed);
    }
}
