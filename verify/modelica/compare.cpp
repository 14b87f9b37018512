// Right-hand sides from Modelica against those of fmu/plant, at random states: prints the largest difference of each,
// relative to its largest term.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <random>

#include "Bumper.h"
#include "Contact.h"
#include "Drivetrain.h"
#include "plant.hpp"

namespace plant = giveway::plant;

namespace
{

constexpr int states_each = 5000;
std::mt19937_64 generator(20260821);

double draw(double low, double high)
{
    return std::uniform_real_distribution<double>(low, high)(generator);
}

double difference(double a, double b, std::initializer_list<double> terms)
{
    double scale = 0.0;
    for (const double term : terms) {
        scale = std::max(scale, std::fabs(term));
    }
    return std::fabs(a - b) / scale;
}

double drivetrain()
{
    using namespace Drivetrain;
    double worst = 0.0;
    for (int i = 0; i < states_each; ++i) {
        plant::Parameters<double> p{};
        double y[state_count], dy[state_count], w[64] = {}, q[parameter_count];
        for (double &value : y) {
            value = draw(-2.0, 2.0);
        }
        y[y_q] = y[y_phi] + draw(-0.02, 0.02);
        const double direction = y[y_w] < 0.0 ? -1.0 : 1.0, torque = draw(-40.0, 40.0), inertia = draw(0.01, 1.0);
        p.drivetrain_motor_inertia = draw(0.01, 0.2);
        p.drivetrain_stiffness = draw(100.0, 2000.0);
        p.drivetrain_damping = draw(0.0, 3.0);
        p.drivetrain_gear_coulomb = draw(0.0, 5.0);
        p.drivetrain_gear_viscous = draw(0.0, 0.2);
        p.drivetrain_torque_limit = draw(5.0, 30.0);
        p.roller_coulomb_torque = draw(0.0, 1.0);
        p.roller_radius = draw(0.005, 0.02);
        p.roller_tanh_slope = draw(0.1, 2.0);
        p.roller_model = plant::RollerModel::tanh;
        p.wheel_load = {1.0, 1.0, 1.0};
        p.roller_friction_scale = {1.0, 1.0, 1.0};
        p.drivetrain_friction_scale = {1.0, 1.0, 1.0};
        q[p_tau_m] = torque;
        q[p_direction] = direction;
        q[p_J] = p.drivetrain_motor_inertia;
        q[p_k] = p.drivetrain_stiffness;
        q[p_d] = p.drivetrain_damping;
        q[p_coulomb] = p.drivetrain_gear_coulomb;
        q[p_viscous] = p.drivetrain_gear_viscous;
        q[p_limit] = p.drivetrain_torque_limit;
        q[p_I] = inertia;
        q[p_B_r] = p.roller_coulomb_torque;
        q[p_slope] = p.roller_tanh_slope;
        q[p_r_r] = p.roller_radius;
        Drivetrain_rhs(0.0, y, q, w, dy);
        const double sensed = plant::sensed_torque(p, y[y_phi], y[y_w], y[y_q], y[y_w_w]);
        const double net = plant::net_motor_torque(p, torque, sensed);
        const double friction = plant::roller_force(p, 0, y[y_w_w], 0.0).force;
        const double spring = p.drivetrain_stiffness * y[y_phi];
        worst = std::max({worst,
                          difference(dy[y_w], plant::motor_acceleration(p, 0, direction, net, y[y_w]),
                                     {spring / p.drivetrain_motor_inertia}),
                          difference(dy[y_w_w], (sensed - friction) / inertia, {spring / inertia}),
                          std::fabs(dy[y_phi] - y[y_w]), std::fabs(dy[y_q] - y[y_w_w])});
    }
    return worst;
}

double bumper()
{
    using namespace Bumper;
    double worst = 0.0;
    for (int i = 0; i < states_each; ++i) {
        plant::Parameters<double> p{};
        p.bumper_kind = plant::BumperKind::magnetic;
        p.bumper_latch_model = plant::LatchModel::continuous;
        p.bumper_spring_rate = draw(100.0, 5000.0);
        p.bumper_preload = draw(0.0, 10.0);
        p.bumper_damping = draw(0.0, 20.0);
        p.bumper_guide_friction = draw(0.0, 3.0);
        p.bumper_guide_friction_speed = draw(0.001, 0.02);
        p.bumper_travel = draw(0.05, 0.15);
        p.bumper_stop_stiffness = draw(1e4, 1e6);
        p.bumper_stop_damping = draw(0.0, 2.0);
        p.bumper_latch_force = draw(0.0, 100.0);
        p.bumper_latch_gap = draw(0.0005, 0.002);
        const double q[parameter_count] = {
            p.bumper_spring_rate,          p.bumper_preload,  p.bumper_damping,        p.bumper_guide_friction,
            p.bumper_guide_friction_speed, p.bumper_travel,   p.bumper_stop_stiffness, p.bumper_stop_damping,
            p.bumper_latch_force,          p.bumper_latch_gap};
        static_assert(p_k == 0 && p_f_pre == 1 && p_d == 2 && p_f_guide == 3 && p_u_guide == 4 && p_travel == 5 &&
                      p_k_stop == 6 && p_e_stop == 7 && p_f_latch == 8 && p_g_0 == 9);
        double y[state_count], dy[state_count], w[64] = {};
        y[y_c] = i % 3 == 0 ? draw(-0.002, 0.002) : draw(-0.002, 1.1 * p.bumper_travel);
        y[y_u] = draw(-1.0, 1.0);
        Bumper_rhs(0.0, y, q, w, dy);
        plant::Modes<double> m{};
        m.end_stop = y[y_c] < 0.0 ? 1.0 : 0.0;
        m.bottom_stop = y[y_c] > p.bumper_travel ? 1.0 : 0.0;
        const double force = plant::bumper_force(p, m, y[y_c], y[y_u]).force;
        worst = std::max(
            {worst,
             difference(dy[y_u], force,
                        {p.bumper_stop_stiffness * y[y_c] * m.end_stop,
                         p.bumper_stop_stiffness * y[y_c] * m.bottom_stop, p.bumper_spring_rate * y[y_c], 1.0}),
             std::fabs(dy[y_c] - y[y_u])});
    }
    return worst;
}

double contact()
{
    using namespace Contact;
    double worst = 0.0;
    for (int i = 0; i < states_each; ++i) {
        plant::Parameters<double> p{};
        p.contact_stiffness = draw(1e3, 1e5);
        p.contact_damping = draw(0.0, 2.0);
        p.contact_friction = draw(0.0, 1.0);
        p.contact_friction_speed = draw(0.001, 0.02);
        const double angle = draw(-3.0, 3.0);
        plant::Contact<double> c{};
        c.depth = draw(-0.01, 0.02);
        c.depth_rate = draw(-2.0, 2.0);
        c.normal = {std::cos(angle), std::sin(angle)};
        c.point = {draw(-0.4, 0.4), draw(-0.4, 0.4)};
        c.slip = draw(-0.5, 0.5);
        const double q[parameter_count] = {
            p.contact_stiffness, p.contact_damping, p.contact_friction, p.contact_friction_speed,
            c.normal.x,          c.normal.y,        c.point.x,          c.point.y};
        static_assert(p_k == 0 && p_e == 1 && p_mu == 2 && p_v_mu == 3 && p_n_x == 4 && p_n_y == 5 && p_p_x == 6 &&
                      p_p_y == 7);
        double y[state_count], dy[state_count], w[64] = {};
        y[y_depth] = c.depth;
        y[y_rate] = c.depth_rate;
        y[y_slip] = c.slip;
        Contact_rhs(0.0, y, q, w, dy);
        const auto force = plant::disc_force(p, c, c.depth > 0.0 ? 1.0 : 0.0);
        const double scale = std::max(1.0, force.normal_force);
        worst = std::max({worst, difference(dy[y_depth], force.on_robot.x, {scale}),
                          difference(dy[y_rate], force.on_robot.y, {scale}),
                          difference(dy[y_slip], force.moment, {scale})});
    }
    return worst;
}

} // namespace

int main()
{
    std::printf("states %d\ndrivetrain %.3e\nbumper %.3e\ncontact %.3e\n", states_each, drivetrain(), bumper(),
                contact());
    return 0;
}
