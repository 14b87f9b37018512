#include "lane_group.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <tuple>

#include "lane_noise.hpp"
#include "lane_plant.hpp"
#include "lane_step.hpp"
#include "recorded_run.hpp"
#include "start.hpp"
#include "truth.hpp"

namespace giveway::batch {

namespace {

constexpr double tick_s = 1.0 / static_cast<double>(testbed::servo_rate_hz);
constexpr int widest = 8;
// Channels of noise: those of the torque sensors, and with them those of accelerometers and gyros.
constexpr int torque_channels = testbed::Deviates{}.size();
constexpr int imu_channels = testbed::imu_first_channel + testbed::ImuDeviates{}.size();

// Whole servo ticks in a communication step; 0 if it is none of them.
int ticks_in(double step_s) {
    const double ticks = step_s * static_cast<double>(testbed::servo_rate_hz);
    const double whole = std::round(ticks);
    return whole >= 1.0 && std::fabs(ticks - whole) < 1e-9 ? static_cast<int>(whole) : 0;
}

// One design of a group: its whole run except the plant's motion.
class Lane {
public:
    Lane(const gwb_spec_t &spec, Monitor &monitor, gwb_result_t &result)
        : run_(spec, monitor, result), ticks_per_step_(ticks_in(spec.step_s)) {
        testbed::set_start_values(v_);
    }

    // False if the run has ended already, with its message.
    bool prepare(testbed::PlantSystem &system, const FixedStep &how) {
        if (!run_.prepare(v_) || !run_.start_controller()) {
            return false;
        }
        plant::TippingVector<double> state{};
        Message message{};
        if (!testbed::start_run(v_, system, state, drives_, imu_, stored_at_start_j_, message)) {
            return run_.model_failed(GWB_REFUSED, GWB_TESTBED, message);
        }
        start_.parameters = system.parameters();
        std::copy_n(state.begin(), plant::Layout<>::state_count, start_.state.begin());
        start_.modes = system.modes();
        start_.inputs = system.inputs();
        start_.first_contact_s = system.first_contact_time();
        steps_per_tick_ = choose_steps(how);
        return true;
    }

    // The properties that designs have to share to run side by side.
    [[nodiscard]] auto key() const {
        return std::tuple(steps_per_tick_, ticks_per_step_, run_.spec().step_count, Structure(start_.parameters));
    }
    [[nodiscard]] bool fits() const { return steps_per_tick_ > 0; }
    [[nodiscard]] int steps_per_tick() const { return steps_per_tick_; }
    [[nodiscard]] int ticks_per_step() const { return ticks_per_step_; }
    [[nodiscard]] const LaneStart &start() const { return start_; }
    [[nodiscard]] RecordedRun &run() { return run_; }
    [[nodiscard]] testbed::Variables &variables() { return v_; }
    [[nodiscard]] testbed::Drives &drives() { return drives_; }
    [[nodiscard]] testbed::Imu &imu() { return imu_; }
    [[nodiscard]] double stored_at_start_j() const { return stored_at_start_j_; }

    bool running = true;

private:
    [[nodiscard]] int choose_steps(const FixedStep &how) const {
        if (ticks_per_step_ == 0 || v_.base_tipping) {
            return 0;
        }
        if (how.plant_step_s > 0.0) {
            return static_cast<int>(std::ceil(tick_s / how.plant_step_s - 1e-9));
        }
        const double base_mps = std::hypot(v_.start_vx, v_.start_vy) + std::fabs(v_.start_omega) * v_.wheel_distance;
        return lane_steps_per_tick(start_.parameters,
                                   greatest_impact_speed(start_.parameters, std::fabs(v_.slider_speed), base_mps));
    }

    RecordedRun run_;
    testbed::Variables v_{};
    testbed::Drives drives_;
    testbed::Imu imu_;
    LaneStart start_{};
    double stored_at_start_j_ = 0.0;
    int ticks_per_step_;
    int steps_per_tick_ = 0;
};

// Designs side by side, from their start to the end of the last of them.
class Group {
public:
    Group(LanePlant &plant, LaneNoise noise, std::array<SampleRoom, widest> &rooms, std::unique_ptr<Lane> *lanes,
          std::size_t count)
        : plant_(plant), noise_(noise), rooms_(rooms), width_(static_cast<std::size_t>(plant.lanes())), lanes_(lanes),
          count_(count) {}

    void go() {
        std::array<LaneStart, widest> starts;
        for (std::size_t i = 0; i < width_; ++i) {
            Lane &lane = *lanes_[i < count_ ? i : 0]; // spare lanes repeat the first design
            starts[i] = lane.start();
            seeds_[i] = lane.drives().sensors().seed;
            if (lane.imu().options().present) {
                channels_ = imu_channels;
            } else if (lane.drives().sensors().torque_noise_nm > 0.0) {
                channels_ = std::max(channels_, torque_channels);
            }
        }
        plant_.start(starts.data());
        each([&](Lane &lane, std::size_t i) {
            if (!lane.run().begin(rooms_[i])) {
                stop(lane);
                return;
            }
            lane.run().result().method = GWB_FIXED_STEP;
            lane.run().result().plant_step_s = tick_s / lane.steps_per_tick();
        });
        sample();
        each([&](Lane &lane, std::size_t i) { write_outputs(lane, i); });
        const std::uint32_t steps = lanes_[0]->run().spec().step_count;
        const int ticks = lanes_[0]->ticks_per_step();
        for (std::uint32_t k = 0; k <= steps && running_ > 0; ++k) {
            each([&](Lane &lane, std::size_t) {
                if (!lane.run().exchange(k)) {
                    stop(lane);
                } else if (k == steps) {
                    lane.run().judge();
                    stop(lane);
                }
            });
            if (running_ > 0) {
                step(k, ticks);
            }
        }
    }

private:
    template <class Do> void each(Do act) {
        for (std::size_t i = 0; i < count_; ++i) {
            if (lanes_[i]->running) {
                act(*lanes_[i], i);
            }
        }
    }

    void stop(Lane &lane) {
        lane.running = false;
        --running_;
    }

    // One communication step, as the testbed's.
    void step(std::uint32_t k, int ticks) {
        double push[4 * widest] = {};
        each([&](Lane &lane, std::size_t i) {
            const testbed::Variables &v = lane.variables();
            const double values[4] = {v.push_force_x, v.push_force_y, v.push_point_x, v.push_point_y};
            put(push, values, i);
        });
        plant_.set_pushes(push);
        for (int tick = 0; tick < ticks; ++tick, ++tick_) {
            double torque[testbed::wheel_count * widest] = {};
            each([&](Lane &lane, std::size_t i) {
                if (tick_ % testbed::servo_ticks_per_cycle == 0) {
                    lane.drives().receive(testbed::bus_command(lane.variables()));
                }
                motor_torque_[i] = lane.drives().regulate(motor_angles(i));
                put(torque, motor_torque_[i], i);
            });
            plant_.set_motor_torques(torque);
            plant_.advance(lanes_[0]->steps_per_tick(), tick_s / lanes_[0]->steps_per_tick());
            const bool bus = (tick_ + 1) % testbed::servo_ticks_per_cycle == 0;
            const bool last = tick + 1 == ticks;
            if (bus || last) {
                plant_.observe();
            }
            if (bus) {
                sample();
            }
        }
        each([&](Lane &lane, std::size_t i) {
            write_outputs(lane, i);
            if (!std::isfinite(lane.variables().energy_stored)) {
                Message message{};
                std::snprintf(message.text, sizeof message.text, "the state is no longer finite at t = %.9g s",
                              lane.run().time_s(k + 1));
                lane.run().model_failed(GWB_FAILED, GWB_TESTBED, message);
                stop(lane);
                return;
            }
            lane.run().report(k + 1);
        });
    }

    template <class Values> void put(double *rows, const Values &values, std::size_t i) const {
        std::size_t row = 0;
        for (const double value : values) {
            rows[row++ * width_ + i] = value;
        }
    }
    // Design i's share of rows.
    template <class Block> Block take(const double *rows, std::size_t i) const {
        static_assert(sizeof(Block) % sizeof(double) == 0);
        Block block;
        auto *to = reinterpret_cast<unsigned char *>(&block);
#pragma GCC unroll 8 // 2 % of the instructions of a run over fixed steps
        for (std::size_t at = 0; at < sizeof block; at += sizeof(double), rows += width_) {
            std::memcpy(to + at, rows + i, sizeof(double));
        }
        return block;
    }

    [[nodiscard]] testbed::PerWheel<double> motor_angles(std::size_t i) const {
        return take<testbed::PerWheel<double>>(plant_.state() + plant::Layout<>::motor_angle * width_, i);
    }

    // The sensor values of this bus cycle.
    void sample() {
        if (channels_ > 0) {
            noise_(seeds_.data(), channels_, cycle_, drawn_.data());
        }
        ++cycle_;
        each([&](Lane &lane, std::size_t i) {
            using Outputs = plant::Outputs<double>;
            const double *torque = plant_.outputs() + offsetof(Outputs, wheel_torque) / sizeof(double) * width_;
            testbed::write_sensors(lane.variables(),
                                   lane.drives().sample(motor_angles(i), take<testbed::PerWheel<double>>(torque, i),
                                                        take<testbed::Deviates>(drawn_.data(), i)));
            if (lane.imu().options().present) {
                const double *felt = drawn_.data() + testbed::imu_first_channel * width_;
                testbed::write_imu(lane.variables(),
                                   lane.imu().sample(testbed::imu_truth(take<Outputs>(plant_.outputs(), i)),
                                                     take<testbed::ImuDeviates>(felt, i)));
            }
        });
    }

    void write_outputs(Lane &lane, std::size_t i) {
        testbed::Variables &v = lane.variables();
        const auto state = take<plant::StateVector<double>>(plant_.state(), i);
        testbed::write_truth(v, state.data(), take<plant::Outputs<double>>(plant_.outputs(), i),
                             take<plant::Modes<double>>(plant_.modes(), i), lane.start().parameters, motor_torque_[i],
                             {0.0, plant_.first_contact_s()[i]}, lane.stored_at_start_j());
        v.events = static_cast<std::int32_t>(plant_.events()[i]);
        v.last_event_time = plant_.last_event_s()[i];
        v.solver_steps = static_cast<std::int32_t>(tick_ * lane.steps_per_tick());
        v.solver_rhs_calls = 4 * v.solver_steps;
        v.solver_jacobian_calls = 0;
    }

    LanePlant &plant_;
    LaneNoise noise_;
    std::array<SampleRoom, widest> &rooms_;
    std::size_t width_;
    std::unique_ptr<Lane> *lanes_;
    std::size_t count_;
    std::size_t running_ = count_;
    std::int64_t tick_ = 0;
    std::int64_t cycle_ = 0; // of the bus
    std::array<std::uint64_t, widest> seeds_{};
    int channels_ = 0;                                  // of noise that a lane needs
    std::array<double, imu_channels * widest> drawn_{}; // of this bus cycle, rows; zero where no lane needs them
    std::array<testbed::PerWheel<double>, widest> motor_torque_{};
};

// The functions compiled for a width.
struct Width {
    LanePlant *(*new_plant)();
    LaneNoise noise;
};
Width width_of(int lanes) {
    switch (lanes) {
#ifdef __x86_64__
    case 8:
        return {new_lane_plant_8, lane_noise_8};
    case 4:
        return {new_lane_plant_4, lane_noise_4};
#endif
    default:
        return {new_lane_plant_1, lane_noise_1};
    }
}

} // namespace

int widest_lanes() {
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
        __builtin_cpu_supports("avx512vl") != 0) {
        return 8;
    }
    return __builtin_cpu_supports("avx2") != 0 ? 4 : 1;
#else
    return 1;
#endif
}

void run_fixed_step(const gwb_spec_t *specs, std::size_t count, const FixedStep &how, Monitor &monitor,
                    gwb_result_t *results, RunDone &listener) {
    const Width width = width_of(how.lanes);
    const std::unique_ptr<testbed::PlantSystem> system(new (std::nothrow) testbed::PlantSystem);
    const std::unique_ptr<LanePlant> plant(width.new_plant());
    const std::unique_ptr<std::unique_ptr<Lane>[]> lanes(new (std::nothrow) std::unique_ptr<Lane>[count]);
    const bool memory = system != nullptr && plant != nullptr && lanes != nullptr;
    std::size_t fitting = 0;
    for (std::size_t i = 0; i < count; ++i) {
        std::unique_ptr<Lane> lane(memory ? new (std::nothrow) Lane(specs[i], monitor, results[i]) : nullptr);
        if (lane == nullptr) {
            RecordedRun(specs[i], monitor, results[i]).end(GWB_NO_MEMORY, "no memory for designs side by side");
        } else if (lane->prepare(*system, how)) {
            if (lane->fits()) {
                lanes[fitting++] = std::move(lane);
                continue;
            }
            lane->run().hand_over();
            lane.reset();
            run(specs[i], monitor, results[i]);
        }
        lane.reset();
        listener.done();
    }
    std::stable_sort(lanes.get(), lanes.get() + fitting,
                     [](const auto &a, const auto &b) { return a->key() < b->key(); });
    std::array<SampleRoom, widest> rooms;
    for (std::size_t first = 0; first < fitting;) {
        std::size_t last = first + 1;
        while (last < fitting && last - first < static_cast<std::size_t>(how.lanes) &&
               lanes[last]->key() == lanes[first]->key()) {
            ++last;
        }
        Group(*plant, width.noise, rooms, &lanes[first], last - first).go();
        for (; first < last; ++first) {
            lanes[first].reset();
            listener.done();
        }
    }
}

} // namespace giveway::batch
