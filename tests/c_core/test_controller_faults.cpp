// Bad sensors never command motion: every kind of fault, in every mode, gives its status and zero motion at once.
#include <functional>

#include "robot.hpp"

namespace {

struct Fault {
    const char *name;
    gw_status_t status;
    std::function<void(gw_sensor_sample_t &)> apply;
    int ticks_to_notice; // how many ticks it may take
};

std::vector<Fault> faults() {
    std::vector<Fault> all = {
        {"missing", GW_STATUS_SENSOR_MISSING, [](gw_sensor_sample_t &s) { s.present = false; }, 1},
        {"stopped counter", GW_STATUS_SENSOR_STALE, [](gw_sensor_sample_t &s) { s.counter = 7; }, 4},
        {"encoder jump", GW_STATUS_ENCODER_JUMP,
         [](gw_sensor_sample_t &s) { s.encoder_count[1] += s.counter % 2 == 0 ? 500 : -500; }, 1},
    };
    for (int wheel = 0; wheel < 3; ++wheel) {
        for (const Real bad : {not_a_number, infinite, -infinite}) {
            all.push_back({"not finite", GW_STATUS_SENSOR_NONFINITE,
                           [wheel, bad](gw_sensor_sample_t &s) { s.torque_nm[wheel] = bad; }, 1});
        }
        for (const Real sign : {real(1), real(-1)}) {
            all.push_back({"saturated", GW_STATUS_SENSOR_SATURATED,
                           [wheel, sign](gw_sensor_sample_t &s) { s.torque_nm[wheel] = sign * real(28.0); }, 1});
        }
    }
    return all;
}

bool all_finite(const gw_controller_output_t &o) {
    const Real values[] = {o.command.angle_rad[0],
                           o.command.angle_rad[1],
                           o.command.angle_rad[2],
                           o.command.speed_radps[0],
                           o.command.speed_radps[1],
                           o.command.speed_radps[2],
                           o.estimate.force_x_n,
                           o.estimate.force_y_n,
                           o.estimate.torque_nm,
                           o.contact.point_m.x,
                           o.contact.point_m.y,
                           o.contact.force_n,
                           o.contact.direction_rad,
                           o.contact.lever_arm_m,
                           o.contact.lever_arm_sigma_m,
                           o.detection_statistic,
                           o.detection_wrench.force_x_n,
                           o.detection_wrench.force_y_n,
                           o.detection_wrench.torque_nm,
                           o.detection_contact.point_m.x,
                           o.detection_contact.point_m.y,
                           o.detection_contact.lever_arm_sigma_m,
                           o.reference_pose.x_m,
                           o.reference_pose.y_m,
                           o.reference_pose.theta_rad,
                           o.reference_twist.vx_mps,
                           o.reference_twist.vy_mps,
                           o.reference_twist.omega_radps};
    for (const Real value : values) {
        if (!gw_is_finite(value)) {
            return false;
        }
    }
    return true;
}

void expect_zero_motion(const Robot &robot, const gw_joint_command_t &held) {
    for (int i = 0; i < 3; ++i) {
        ASSERT_EQ(robot.output.command.speed_radps[i], real(0));
        ASSERT_EQ(robot.output.command.angle_rad[i], held.angle_rad[i]);
    }
    ASSERT_EQ(robot.output.reference_twist.vx_mps, real(0));
    ASSERT_EQ(robot.output.reference_twist.omega_radps, real(0));
    ASSERT_EQ(robot.output.mode, GW_MODE_FAULT);
    ASSERT_FALSE(robot.output.contact.valid);
    ASSERT_TRUE(all_finite(robot.output));
}

// Brings a fresh robot into a mode in which it moves (or takes its tare), breaks the sensors for 50 ticks, and lets
// them recover.
void check(const Fault &fault, gw_mode_t in_mode) {
    SCOPED_TRACE(testing::Message() << fault.name << " in mode " << in_mode);
    Robot robot(trikey_config());
    if (in_mode == GW_MODE_TARING) {
        robot.run(20);
    } else {
        robot.start();
        robot.input.plan.twist.vx_mps = real(0.2);
        for (int i = 0; i < 300; ++i) {
            robot.input.plan.pose.x_m = real(0.2e-3 * robot.output.path_ticks);
            ASSERT_EQ(robot.step(), GW_STATUS_OK);
        }
        if (in_mode == GW_MODE_REACTING) {
            for (int i = 0; i < 100; ++i) {
                ASSERT_EQ(robot.step(push_at(0.0, 0.2, 60.0, -1.2)), GW_STATUS_OK);
            }
        }
    }
    ASSERT_EQ(robot.output.mode, in_mode);
    gw_controller_input_t good = robot.input;
    gw_joint_command_t held = robot.output.command;
    int noticed = 0;
    for (int i = 1; i <= 50; ++i) {
        robot.input = good;
        robot.input.sensor.counter += static_cast<std::uint32_t>(i);
        fault.apply(robot.input.sensor);
        const gw_status_t status = robot.raw_step();
        ASSERT_TRUE(gw_controller_invariant_holds(robot.controller.get()));
        if (status == GW_STATUS_OK) {
            ASSERT_LT(i, fault.ticks_to_notice);
            held = robot.output.command;
        } else {
            ASSERT_EQ(status, fault.status);
            expect_zero_motion(robot, held);
            ++noticed;
        }
    }
    ASSERT_GE(noticed, 46);
    if (fault.status == GW_STATUS_ENCODER_JUMP) {
        ++robot.input.sensor.counter;
        robot.input.sensor.encoder_count[1] = good.sensor.encoder_count[1]; // back is a jump as well
        ASSERT_EQ(robot.raw_step(), GW_STATUS_ENCODER_JUMP);
    }
    // Good again: zero motion still, for recover_ticks samples.
    for (int i = 1; i <= 10; ++i) {
        robot.input = good;
        robot.input.sensor.counter += static_cast<std::uint32_t>(100 + i);
        ASSERT_EQ(robot.raw_step(), GW_STATUS_SENSOR_RECOVERING) << i;
        expect_zero_motion(robot, held);
    }
    const std::uint32_t hits = robot.output.detection_count;
    robot.input.sensor.counter += 200;
    ASSERT_EQ(robot.raw_step(), GW_STATUS_OK);
    const gw_mode_t resumed = robot.output.mode;
    EXPECT_EQ(resumed, in_mode == GW_MODE_TRACKING ? GW_MODE_REJOINING : in_mode);
    EXPECT_EQ(robot.output.detection_count, hits);
    if (in_mode == GW_MODE_REACTING) {
        // The escape was abandoned: nobody knows what happened meanwhile.
        ASSERT_EQ(robot.output.reference_twist.vy_mps, real(0));
    }
    // The wheels go on from the held angles without a jump.
    for (int i = 0; i < 3; ++i) {
        const double jump = std::remainder(robot.output.command.angle_rad[i] - held.angle_rad[i], 2.0 * pi);
        EXPECT_NEAR(jump, 0.0, 1e-4);
    }
}

TEST(ControllerFaults, EveryKindInEveryMode) {
    for (const Fault &fault : faults()) {
        for (const gw_mode_t mode : {GW_MODE_TARING, GW_MODE_TRACKING, GW_MODE_REACTING}) {
            check(fault, mode);
        }
    }
}

TEST(ControllerFaults, NoCommandBeforeTheFirstGoodSample) {
    Robot robot(trikey_config());
    robot.input.sensor.present = false;
    for (int i = 0; i < 20; ++i) {
        ++robot.input.sensor.counter;
        ASSERT_EQ(robot.raw_step(), GW_STATUS_SENSOR_MISSING);
        ASSERT_FALSE(robot.output.enable);
    }
    robot.input.sensor.present = true;
    robot.run(1); // out of FAULT
    robot.start();
}

TEST(ControllerFaults, ABadPlanSlowsToAStop) {
    for (const Real bad : {not_a_number, infinite, real(2e4)}) {
        Robot robot(trikey_config());
        robot.start();
        robot.input.plan.twist.vx_mps = real(0.2);
        for (int i = 0; i < 500; ++i) {
            robot.input.plan.pose.x_m = real(0.2e-3 * robot.output.path_ticks);
            ASSERT_EQ(robot.step(), GW_STATUS_OK);
        }
        const gw_plan_t good = robot.input.plan;
        const std::uint32_t clock = robot.output.path_ticks;
        robot.input.plan.pose.y_m = bad;
        double speed = static_cast<double>(robot.output.reference_twist.vx_mps);
        for (int i = 0; i < 400; ++i) {
            ASSERT_EQ(robot.step(), GW_STATUS_PLAN_INVALID);
            ASSERT_TRUE(all_finite(robot.output));
            const double now = static_cast<double>(robot.output.reference_twist.vx_mps);
            ASSERT_LE(now, speed);
            ASSERT_GE(now, speed - 1.5e-3 * (1.0 + 1e-5));
            speed = now;
        }
        EXPECT_EQ(speed, 0.0);
        EXPECT_EQ(robot.output.path_ticks, clock);
        // It still gives way.
        for (int i = 0; i < 60; ++i) {
            (void)robot.step(push_at(-0.176, 0.0, 200.0, 0.0));
        }
        EXPECT_EQ(robot.output.detection_count, 1U);
        EXPECT_GT(robot.output.reference_twist.vx_mps, real(0));
        robot.input.plan = good;
    }
}

// Any input whatever: outputs stay finite and within their limits, and the invariant holds.
TEST(ControllerFaults, AnyInputWhateverGivesFiniteLimitedOutputs) {
    Random random(141);
    const auto anything = [&](double size) {
        switch (random.integer(0, 40)) {
        case 0:
            return not_a_number;
        case 1:
            return infinite;
        case 2:
            return -infinite;
        case 3:
            return real(GW_REAL_MAX * random.uniform(-1.0, 1.0));
        case 4:
            return std::numeric_limits<Real>::denorm_min();
        default:
            return real(random.uniform(-size, size));
        }
    };
    for (int trial = 0; trial < 60; ++trial) {
        auto config = trikey_config();
        config.geometry = random_geometry(random, trial);
        config.admittance.kind = static_cast<std::uint32_t>(trial % 2);
        config.detector.kind = static_cast<std::uint32_t>(trial / 2 % 2);
        config.estimator.velocity_source = static_cast<std::uint32_t>(random.integer(0, 1));
        config.estimator.acceleration_source = static_cast<std::uint32_t>(random.integer(0, 2));
        config.estimator.average_window = static_cast<std::uint32_t>(random.integer(1, 1024));
        config.sensor_check.torque_limit_nm = real(trial % 3 == 0 ? 10000.0 : 28.0);
        config.sensor_check.encoder_jump_counts = trial % 3 == 1 ? 1'000'000 : 200;
        config.sensor_check.recover_ticks = 1;
        config.detector.blanking_ticks = static_cast<std::uint32_t>(random.integer(0, 50));
        config.estimator.rest_ticks = static_cast<std::uint32_t>(random.integer(1, 50));
        config.supervisor.settled_ticks = 3;
        config.estimator.tare_ticks = static_cast<std::uint32_t>(random.integer(0, 3));
        Robot robot(config);
        const double torque_size = std::pow(10.0, random.integer(-3, 4));
        for (int i = 0; i < 4000; ++i) {
            auto &in = robot.input;
            const bool wild = random.integer(0, 9) == 0;
            for (int w = 0; w < 3; ++w) {
                in.sensor.torque_nm[w] = wild ? anything(torque_size) : real(random.uniform(-torque_size, torque_size));
                if (wild) {
                    in.sensor.encoder_count[w] = static_cast<std::int32_t>(random.bits());
                }
            }
            in.sensor.counter += static_cast<std::uint32_t>(random.integer(0, 3) != 0);
            in.sensor.present = random.integer(0, 50) != 0;
            in.stop_request = random.integer(0, 200) == 0;
            in.tare_request = random.integer(0, 1) == 0;
            if (random.integer(0, 100) == 0) {
                in.plan.pose = {anything(5), anything(5), anything(5)};
                in.plan.twist = {anything(1), anything(1), anything(1)};
                in.plan.acceleration = {anything(1), anything(1), anything(1)};
            }
            const gw_status_t status = robot.raw_step();
            const auto &out = robot.output;
            ASSERT_TRUE(all_finite(out)) << trial << " " << i;
            const double slack = 1.0 + 10.0 * epsilon;
            ASSERT_LE(std::hypot(out.reference_twist.vx_mps, out.reference_twist.vy_mps), 0.5 * slack);
            ASSERT_LE(std::fabs(out.reference_twist.omega_radps), 1.5 * slack);
            for (int w = 0; w < 3; ++w) {
                ASSERT_GE(out.command.angle_rad[w], -GW_PI);
                ASSERT_LT(out.command.angle_rad[w], GW_PI);
            }
            if (status >= GW_STATUS_SENSOR_MISSING && status <= GW_STATUS_SENSOR_RECOVERING) {
                ASSERT_EQ(out.command.speed_radps[0], real(0));
                ASSERT_EQ(out.mode, GW_MODE_FAULT);
            }
            if (i % 50 == 0) {
                ASSERT_TRUE(gw_controller_invariant_holds(robot.controller.get())) << trial << " " << i;
            }
        }
    }
}

TEST(ControllerFaults, Refusals) {
    auto controller = std::make_unique<gw_controller_t>();
    gw_controller_input_t input{};
    gw_controller_output_t output{};
    output.enable = true;
    EXPECT_EQ(gw_controller_step(controller.get(), &input, &output), GW_STATUS_NOT_INITIALISED);
    EXPECT_FALSE(output.enable);
    EXPECT_EQ(gw_controller_step(nullptr, &input, &output), GW_STATUS_NULL_POINTER);
    EXPECT_EQ(gw_controller_step(controller.get(), nullptr, &output), GW_STATUS_NULL_POINTER);
    EXPECT_EQ(gw_controller_step(controller.get(), &input, nullptr), GW_STATUS_NULL_POINTER);
    auto config = trikey_config();
    EXPECT_EQ(gw_controller_init(nullptr, &config, nullptr), GW_STATUS_NULL_POINTER);
    EXPECT_EQ(gw_controller_init(controller.get(), nullptr, nullptr), GW_STATUS_NULL_POINTER);
    EXPECT_EQ(gw_controller_init(controller.get(), &config, nullptr), GW_STATUS_OK);
    config.period_s = real(1);
    EXPECT_EQ(gw_controller_init(controller.get(), &config, nullptr), GW_STATUS_CONFIG_INVALID);
    EXPECT_EQ(gw_controller_step(controller.get(), &input, &output), GW_STATUS_NOT_INITIALISED);
    EXPECT_FALSE(gw_controller_invariant_holds(controller.get()));
    EXPECT_FALSE(gw_controller_invariant_holds(nullptr));
}

} // namespace
