// The testbed as a model: step sizes, energy, refusals. The plant's equations have their own reference in ../plant.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "model.hpp"
#include "noise.hpp"
#include "state.hpp"
#include "testbed_variables.hpp"

namespace {

using giveway::Message;
using giveway::Model;
using giveway::Status;
using giveway::testbed::Variables;

struct Bench {
    std::unique_ptr<Model> model{giveway::create_model()};
    Message message{};
    [[nodiscard]] Variables &v() const { return *static_cast<Variables *>(model->variables()); }
    void initialise() { ASSERT_EQ(model->initialise(0.0, message), Status::ok) << message.text; }
    void step_to(double end_s, double step_s) {
        const auto steps = std::llround(end_s / step_s);
        for (long long k = 0; k < steps; ++k) {
            ASSERT_EQ(model->step(static_cast<double>(k) * step_s, step_s, message), Status::ok) << message.text;
        }
    }
};

} // namespace

TEST(Testbed, CollisionClosesItsEnergyAccount) {
    for (const int kind : {0, 1, 2}) {
        for (const int mount : {0, 1}) {
            Bench run;
            run.v().bumper_kind = kind;
            run.v().bumper_mount = mount;
            if (kind != 0 && mount == 1) {
                run.v().slider_target_x = run.v().bumper_mount_x;
                run.v().slider_target_y = run.v().bumper_mount_y;
            }
            run.initialise();
            run.step_to(0.5, 1e-3);
            EXPECT_GT(run.v().truth_first_contact_time, 0.14);
            EXPECT_GT(run.v().energy_dissipated, 0.5);
            // At the default relative tolerance of 1e-6, of some J turned over; the errors' signs differ: 5e-8 J is
            // seen.
            EXPECT_LT(std::fabs(run.v().energy_residual), 2e-7) << "kind " << kind << ", mount " << mount;
        }
    }
}

TEST(Testbed, TippingClosesItsEnergyAccount) {
    for (const int kind : {0, 1, 2}) {
        Bench run;
        run.v().base_tipping = true;
        run.v().contact_height = 0.5;
        run.v().bumper_kind = kind;
        run.initialise();
        EXPECT_NEAR(run.v().truth_tip_margin, 1.0, 1e-12);
        double least_load_n = 1e9;
        for (int k = 0; k < 500; ++k) {
            ASSERT_EQ(run.model->step(1e-3 * k, 1e-3, run.message), Status::ok) << run.message.text;
            for (const double load : run.v().truth_wheel_load) {
                least_load_n = std::min(least_load_n, load);
            }
        }
        EXPECT_LT(least_load_n, 60.0); // of 113 N: it did lean
        EXPECT_LT(run.v().truth_tip_margin, 1.0);
        // As above: floor and grip are stiff, so the steps are short, and add next to nothing (4e-8 J is seen).
        EXPECT_LT(std::fabs(run.v().energy_residual), 2e-7) << "kind " << kind;
    }
}

TEST(Testbed, StopsWhereTheRobotGoesOver) {
    Bench run;
    run.v().base_tipping = true;
    run.v().slider_present = false;
    run.v().command_enable = true;
    run.v().push_height = 0.6;
    run.initialise();
    run.v().push_force_x = -400.0;
    Status status = Status::ok;
    for (int k = 0; k < 2000 && status == Status::ok; ++k) {
        status = run.model->step(1e-3 * k, 1e-3, run.message);
    }
    EXPECT_EQ(status, Status::error);
    EXPECT_NE(std::string(run.message.text).find("the robot tips over: at t = "), std::string::npos)
        << run.message.text;
    EXPECT_NEAR(std::hypot(run.v().truth_pitch, run.v().truth_roll), 15.0 * 3.14159265358979 / 180.0, 2e-3);
}

TEST(Testbed, TellsAnImporterThatIntegratesWhenTheRobotGoesOver) {
    Bench run;
    run.v().base_tipping = true;
    run.v().slider_present = false;
    ASSERT_EQ(run.model->initialise(100.0, run.message), Status::ok) << run.message.text;
    giveway::Equations &equations = *run.model->equations();
    giveway::EventUpdate update{};
    do {
        update = {};
        equations.set_time(100.0);
        ASSERT_EQ(equations.update_events(update, run.message), Status::ok) << run.message.text;
    } while (update.again);
    EXPECT_EQ(update.next_time_s, 100.0005); // the next tick of the servos
    equations.set_time(100.00025);
    equations.states()[giveway::plant::Layout<>::base_pitch] = 0.3; // rad; 15 deg are 0.26
    EXPECT_EQ(equations.update_events(update, run.message), Status::error);
    EXPECT_NE(std::string(run.message.text).find("the robot tips over: at t = 100.00025 s"), std::string::npos)
        << run.message.text;
}

TEST(Testbed, RefusesWhatDoesNotGoTogether) {
    const auto refused = [](const auto &change, const char *name) {
        Bench run;
        change(run.v());
        EXPECT_EQ(run.model->initialise(0.0, run.message), Status::error);
        EXPECT_NE(std::string(run.message.text).find(name), std::string::npos) << run.message.text;
    };
    refused(
        [](Variables &v) {
            v.bumper_mount = 1;
            v.base_tipping = true;
        },
        "bumper.mount = 1 is not allowed");
    refused(
        [](Variables &v) {
            v.bumper_mount = 1;
            v.contact_nose_shape = 1;
        },
        "contact.nose_shape = 1 is not allowed");
    refused(
        [](Variables &v) {
            v.outline_wheels = true;
            v.outline_clearance = 0.3;
        },
        "outline.clearance = 0.3 is not allowed");
    refused(
        [](Variables &v) {
            v.wheel_inertia = 0.01;
            v.base_tilt_inertia = 1.5 * v.wheel_inertia; // nothing is left for the rest of the base
        },
        "base.tilt_inertia = 0.015 is not allowed");
}

TEST(Testbed, StepsOfWholeTicksGiveTheSameBits) {
    Bench one;
    Bench two;
    Bench half;
    one.initialise();
    two.initialise();
    half.initialise();
    one.step_to(0.3, 1e-3);
    two.step_to(0.3, 2e-3);
    half.step_to(0.3, 5e-4);
    EXPECT_EQ(std::memcmp(&one.v(), &two.v(), sizeof(Variables)), 0);
    EXPECT_EQ(std::memcmp(&one.v(), &half.v(), sizeof(Variables)), 0);
}

TEST(Testbed, StepsAcrossTicksAgreeToTheTolerance) {
    Bench one;
    Bench odd;
    one.initialise();
    odd.initialise();
    // Up to the first contact: each later bounce of the plate would multiply the deviation.
    one.step_to(0.168, 1e-3);
    odd.step_to(0.168, 7e-4);
    // The integrator stops at other instants, 1e-6 of a rate off at most, and far less where it stops 1400 times: 1e-9
    // m is seen. The contact is 0.2 mm deep, so that much is 4e-6 of its force.
    EXPECT_NEAR(odd.v().truth_slider_position, one.v().truth_slider_position, 4e-9);
    EXPECT_NEAR(odd.v().truth_contact_force, one.v().truth_contact_force, 1.5e-5 * one.v().truth_contact_force);
    EXPECT_GT(one.v().truth_contact_force, 1.0);
}

TEST(Testbed, ResetAndRunAgainGivesTheSameBits) {
    Bench run;
    run.initialise();
    run.step_to(0.2, 1e-3);
    const Variables first = run.v();
    run.model->reset();
    run.initialise();
    run.step_to(0.2, 1e-3);
    EXPECT_EQ(std::memcmp(&first, &run.v(), sizeof first), 0);
}

TEST(Testbed, UnpoweredDrivesGiveNoTorque) {
    Bench run;
    run.v().command_enable = false;
    run.v().start_vx = 0.1;
    run.v().slider_present = false;
    run.initialise();
    run.step_to(0.1, 1e-3);
    for (const double torque : run.v().truth_motor_torque) {
        EXPECT_EQ(torque, 0.0);
    }
    EXPECT_EQ(run.v().energy_work_in, 0.0);
}

TEST(Testbed, ACommandActsAfterItsDelay) {
    for (const int delay : {0, 1, 3}) {
        Bench run;
        run.v().slider_present = false;
        run.v().command_enable = true;
        run.v().electronics_command_delay = delay;
        run.initialise();
        run.v().command_wheel_angle[1] = 0.01;
        for (int cycle = 0; cycle < 6; ++cycle) {
            ASSERT_EQ(run.model->step(1e-3 * cycle, 1e-3, run.message), Status::ok) << run.message.text;
            EXPECT_EQ(run.v().truth_motor_torque[1] != 0.0, cycle >= delay) << "delay " << delay << ", cycle " << cycle;
            EXPECT_EQ(run.v().truth_motor_torque[0], 0.0);
        }
    }
}

TEST(Testbed, ASampleComesAfterItsDelay) {
    for (const int delay : {0, 1, 3}) {
        Bench run;
        run.v().slider_present = false;
        run.v().electronics_sensor_delay = delay;
        run.v().electronics_torque_noise = 0.0;
        run.v().electronics_torque_resolution = 0.0;
        run.initialise();
        run.v().push_force_x = 30.0;
        std::vector<std::array<double, 3>> truth{{0.0, 0.0, 0.0}};
        for (int cycle = 0; cycle < 20; ++cycle) {
            ASSERT_EQ(run.model->step(1e-3 * cycle, 1e-3, run.message), Status::ok) << run.message.text;
            truth.push_back(std::to_array(run.v().truth_wheel_torque));
            const auto &then = truth[static_cast<std::size_t>(std::max(0, cycle + 1 - delay))];
            for (std::size_t wheel = 0; wheel < 3; ++wheel) {
                EXPECT_NEAR(run.v().sensor_torque[wheel], then[wheel], 1e-14)
                    << "delay " << delay << ", cycle " << cycle; // of 1 N m
            }
        }
        EXPECT_GT(std::fabs(truth[20][1]), 0.5);
        EXPECT_NE(truth[20][1], truth[19][1]);
    }
}

TEST(Testbed, TheElectronicsAreThoseOfTheVariables) {
    Bench run;
    Variables &v = run.v();
    v.slider_present = false;
    v.electronics_sensor_delay = 0;
    v.electronics_seed = 77;
    v.electronics_torque_noise = 0.2;
    v.electronics_torque_resolution = 0.0;
    v.electronics_torque_offset[0] = 0.5;
    v.electronics_torque_offset[1] = -1.5;
    v.electronics_torque_offset[2] = 2.5;
    run.initialise();
    // At rest: the offset of each wheel and its noise of the first cycle.
    for (std::uint32_t wheel = 0; wheel < 3U; ++wheel) {
        const double expected = v.electronics_torque_offset[wheel] + 0.2 * giveway::math::normal(77U, wheel, 0U);
        EXPECT_NEAR(v.sensor_torque[wheel], expected, 1e-15);
    }
    run.model->reset();
    v.slider_present = false;
    v.electronics_torque_noise = 0.0;
    v.electronics_torque_resolution = 0.4;
    v.electronics_torque_range = 2.1;
    v.electronics_torque_offset[0] = 0.5;
    v.electronics_torque_offset[1] = -1.5;
    v.electronics_torque_offset[2] = 2.5;
    run.initialise();
    EXPECT_NEAR(v.sensor_torque[0], 0.4, 1e-15);
    EXPECT_NEAR(v.sensor_torque[1], -1.6, 1e-15);
    EXPECT_NEAR(v.sensor_torque[2], 2.1, 1e-15); // rounded, then cut off
}

TEST(Testbed, LoadedRollersAreHeldByTheDrivetrains) {
    Bench run;
    run.v().command_enable = false;
    run.v().slider_present = false;
    run.v().start_bristle[0] = 2e-4; // 5.2 N along -x
    run.v().start_bristle[2] = -1e-4;
    run.initialise();
    run.step_to(0.5, 1e-3);
    const Variables &v = run.v();
    double force_x = 0.0;
    double force_y = 0.0;
    for (int i = 0; i < 3; ++i) {
        const double azimuth = 2.0 * M_PI / 3.0 * i;
        EXPECT_NEAR(v.truth_roller_force[i], v.roller_presliding_stiffness[i] * v.start_bristle[i],
                    1e-12); // rounding of 5 N, a thousand times
        force_x +=
            -std::cos(azimuth) * v.truth_roller_force[i] - std::sin(azimuth) * v.truth_wheel_torque[i] / v.wheel_radius;
        force_y +=
            -std::sin(azimuth) * v.truth_roller_force[i] + std::cos(azimuth) * v.truth_wheel_torque[i] / v.wheel_radius;
    }
    EXPECT_NEAR(force_x, 0.0, 1e-9); // sums of 5 N
    EXPECT_NEAR(force_y, 0.0, 1e-9);
    EXPECT_NEAR(v.truth_x, 0.0, 1e-12);
    EXPECT_NEAR(v.truth_y, 0.0, 1e-12);
}

TEST(Testbed, RollerFrictionGrowsWithTheStaticLoad) {
    // In steady motion, the share `load_growth` of it with M (1 + 2 n_i . c/R) over the nominal mass.
    Bench run;
    Variables &v = run.v();
    v.slider_present = false;
    v.roller_model = 1;
    v.base_mass *= 1.25;
    v.base_com_x = 0.03;
    v.base_com_y = -0.02;
    v.roller_load_growth = 0.6;
    const std::array<double, 3> scale = {0.8, 1.2, 1.1};
    std::copy(scale.begin(), scale.end(), v.roller_friction_scale);
    v.start_vx = 0.3;
    v.start_vy = 0.1;
    run.initialise();
    for (std::size_t i = 0; i < 3; ++i) {
        const double azimuth = 2.0 * M_PI / 3.0 * static_cast<double>(i);
        const double speed = v.start_vx * std::cos(azimuth) + v.start_vy * std::sin(azimuth);
        const double beside = v.base_com_x * std::cos(azimuth) + v.base_com_y * std::sin(azimuth);
        const double load = 1.25 * (1.0 + 2.0 * beside / v.wheel_distance);
        const double friction = scale[i] * (1.0 + 0.6 * (load - 1.0)) * v.roller_coulomb_torque / v.roller_radius *
                                std::tanh(v.roller_tanh_slope * speed / v.roller_radius);
        EXPECT_NEAR(v.truth_roller_force[i], friction, 1e-9); // of 20 N
        EXPECT_NEAR(v.truth_wheel_load[i], load * v.roller_nominal_mass * 9.81 / 3.0, 1e-9);
    }
}

TEST(Testbed, RollerFrictionGrowsWithThePayloadWhereTheBaseTips) {
    // Standing evenly on three wheels, 25 % heavier.
    for (const double growth : {0.0, 0.6, 1.0}) {
        Bench run;
        Variables &v = run.v();
        v.slider_present = false;
        v.base_tipping = true;
        v.base_mass *= 1.25;
        v.roller_load_growth = growth;
        v.start_vx = 0.3;
        run.initialise();
        // Wheel 0 along its axle: sliding friction with the static level's tanh, the same at any load.
        const double level =
            v.roller_coulomb_torque / v.roller_radius * std::tanh(v.roller_tanh_slope * v.start_vx / v.roller_radius);
        EXPECT_NEAR(v.truth_roller_force[0], level * (1.0 + growth * 0.25), 1e-6 * level);
    }
}

TEST(Testbed, StandsOnAFloorThatFalls) {
    // Its drives hold it, and their sensors see J_w^T T = M g sin(slope) uphill.
    for (const bool tipping : {false, true}) {
        Bench run;
        Variables &v = run.v();
        v.slider_present = false;
        v.base_tipping = tipping;
        v.floor_slope = 0.0175;
        v.floor_azimuth = 2.0;
        v.start_theta = 0.4;
        v.electronics_torque_noise = 0.0;
        v.electronics_torque_resolution = 0.0;
        run.initialise();
        run.step_to(0.5, 1e-3);
        double force_x = 0.0;
        double force_y = 0.0;
        for (int i = 0; i < 3; ++i) {
            const double across = 0.4 + 2.0 * M_PI / 3.0 * i + M_PI / 2.0;
            force_x += std::cos(across) * v.sensor_torque[i] / v.wheel_radius;
            force_y += std::sin(across) * v.sensor_torque[i] / v.wheel_radius;
        }
        const double downhill = v.base_mass * 9.81 * std::sin(v.floor_slope);
        // The start of a base that tips is exact to its lean, which is settled by rollers that take some of it.
        const double tolerance = tipping ? 0.02 * downhill : 1e-9;
        EXPECT_NEAR(force_x, -downhill * std::cos(2.0), tolerance) << tipping;
        EXPECT_NEAR(force_y, -downhill * std::sin(2.0), tolerance) << tipping;
        EXPECT_LT(std::hypot(v.truth_vx, v.truth_vy), 1e-4);
        EXPECT_LT(std::fabs(v.energy_residual), 2e-7);
    }
}

TEST(Testbed, AGearThatCannotHoldItsLoadTurnsFromTheStart) {
    // An importer reads derivatives and indicators before its first event, and counts no event for what the start knew.
    Bench run;
    Variables &v = run.v();
    v.slider_present = false;
    v.floor_slope = 0.02;
    v.start_theta = 0.4;
    v.drivetrain_gear_coulomb = v.drivetrain_gear_stiction = 0.2; // N m
    run.initialise();
    using At = giveway::plant::Layout<>;
    std::array<double, At::tipping_state_count> rate{};
    std::array<double, At::tipping_event_count> margin{};
    run.model->equations()->derivatives(rate.data());
    run.model->equations()->indicators(margin.data());
    int turning = 0;
    for (int i = 0; i < 3; ++i) {
        const double load = v.truth_wheel_torque[i];
        const bool turns = std::fabs(load) > v.drivetrain_gear_stiction;
        const double beyond = turns ? std::copysign(v.drivetrain_gear_coulomb, load) - load : 0.0;
        EXPECT_DOUBLE_EQ(rate[At::motor_speed + i], beyond / v.drivetrain_motor_inertia) << i;
        EXPECT_GT(margin[At::event_gear + i], 0.0) << i; // no event is due
        turning += turns ? 1 : 0;
    }
    EXPECT_GT(turning, 0);
    EXPECT_LT(turning, 3);
}

TEST(Testbed, RefusesWhatDoesNotFitTogether) {
    const auto refusal = [](auto change) {
        Bench run;
        change(run.v());
        EXPECT_EQ(run.model->initialise(0.0, run.message), Status::error);
        return std::string(run.message.text);
    };
    EXPECT_NE(refusal([](Variables &v) { v.drivetrain_gear_stiction = 1.0; }).find("drivetrain.gear_stiction = 1"),
              std::string::npos);
    EXPECT_NE(refusal([](Variables &v) { v.bumper_plate_mass = 9.0; }).find("bumper.plate_mass = 9"),
              std::string::npos);
    EXPECT_NE(refusal([](Variables &v) {
                  std::swap(v.outline_x[1], v.outline_x[2]), std::swap(v.outline_y[1], v.outline_y[2]);
              }).find("outline."),
              std::string::npos);
    EXPECT_NE(refusal([](Variables &v) { v.slider_target_x = 0.0; }).find("slider.run_up = "), std::string::npos);
    EXPECT_NE(refusal([](Variables &v) {
                  // A pentagram: every corner turns left, but it is not convex.
                  v.outline_count = 5;
                  for (int i = 0; i < 5; ++i) {
                      v.outline_x[i] = 0.3 * std::cos(0.8 * M_PI * i);
                      v.outline_y[i] = 0.3 * std::sin(0.8 * M_PI * i);
                  }
              }).find("convex"),
              std::string::npos);
    EXPECT_NE(refusal([](Variables &v) { v.base_com_x = -0.13; }).find("base.com_x = -0.13"), std::string::npos);
}

TEST(Testbed, MethodsAgreeWithTheServosAtWork) {
    Variables erk{};
    for (const int method : {0, 1, 2}) {
        Bench run;
        run.v().solver_method = method;
        run.v().solver_relative_tolerance = 1e-8;
        run.v().solver_absolute_scale = 0.01;
        run.v().electronics_encoder_counts =
            1'000'000; // a count that flips a rounding earlier moves the motor by its step: make that small
        run.initialise();
        run.step_to(0.5, 1e-3);
        const Variables &v = run.v();
        erk = method == 0 ? v : erk;
        EXPECT_EQ(v.solver_jacobian_calls > 0, method == 2);
        EXPECT_GT(v.solver_steps, 0);
        // 4 J are turned over with a local error of 1e-8 of it a step. ERK's step is a servo tick, far shorter than its
        // tolerance asks for (1e-9 J is seen); Adams and BDF go to the bound, in 9,000 and 16,000 steps, and their
        // errors add up to some hundredths of it, as signs differ (2e-6 and 1e-5 J).
        constexpr double residual_j[] = {5e-9, 8e-6, 5e-5};
        EXPECT_LT(std::fabs(v.energy_residual), residual_j[method]) << "method " << method;
        // Methods other than ERK are late by the time that BDF's position error, 0.15 um, takes at 0.5 m/s.
        EXPECT_NEAR(v.truth_first_contact_time, erk.truth_first_contact_time, 1e-6);
        EXPECT_EQ(v.truth_latched, erk.truth_latched);
        // A count of the encoder is 6 urad, 0.6 um at the wheel's rim, which the servo follows softly. Four
        // times what is seen with BDF each.
        EXPECT_NEAR(v.truth_x, erk.truth_x, 4e-8);
        EXPECT_NEAR(v.truth_slider_position, erk.truth_slider_position, 7e-7);
        EXPECT_NEAR(v.truth_contact_impulse_x, erk.truth_contact_impulse_x, 4e-6);
        EXPECT_NEAR(v.energy_dissipated, erk.energy_dissipated, 1.2e-5);
    }
}

TEST(Testbed, FailureEndsWithTimeMethodReasonAndTheLastGoodState) {
    constexpr const char *names[] = {"ERK", "Adams", "BDF"};
    for (const int method : {0, 1, 2}) {
        Bench run;
        run.v().solver_method = method;
        ASSERT_EQ(run.model->initialise(5.0, run.message), Status::ok) << run.message.text;
        for (int k = 0; k < 180; ++k) {
            ASSERT_EQ(run.model->step(5.0 + k * 1e-3, 1e-3, run.message), Status::ok) << run.message.text;
        }
        const Variables good = run.v();
        run.v().push_force_x = std::numeric_limits<double>::infinity();
        ASSERT_EQ(run.model->step(5.18, 1e-3, run.message), Status::error);
        const std::string message = run.message.text;
        EXPECT_EQ(message.find(names[method]), 0U) << message;
        EXPECT_NE(message.find("at t = 5.18 s: the rate of state "), std::string::npos) << message;
        EXPECT_NE(message.find("is not a finite number"), std::string::npos) << message;
        EXPECT_EQ(run.v().truth_x, good.truth_x);
        EXPECT_EQ(run.v().truth_slider_speed, good.truth_slider_speed);
        EXPECT_EQ(run.v().energy_residual, good.energy_residual);
    }
}
