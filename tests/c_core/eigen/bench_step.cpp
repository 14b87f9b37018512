// Nanoseconds per step of the library and of the same step written with Eigen, over the recorded collision.
//
//     bench_step COLLISIONS      prints "c_core NS" and "eigen NS": the best of COLLISIONS alternating runs of each
// run_c_core and run_eigen are what callgrind counts, once each.
#include "eigen_step.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <memory>
#include <vector>

extern "C" {
#include "recorded_collision.h"
}

namespace
{

using Inputs = std::vector<gw_controller_input_t>;
volatile float sink;

} // namespace

extern "C" {

__attribute__((noinline)) void run_c_core(gw_controller_t *controller, const gw_controller_input_t *inputs)
{
    gw_controller_output_t output;
    for (uint32_t tick = 0; tick < RECORDED_TICKS; ++tick) {
        (void)gw_controller_step(controller, &inputs[tick], &output);
    }
    sink = output.command.angle_rad[0];
}

__attribute__((noinline)) void run_eigen(eigen_step::Controller *controller, const gw_controller_input_t *inputs)
{
    eigen_step::Output output;
    for (uint32_t tick = 0; tick < RECORDED_TICKS; ++tick) {
        controller->step(inputs[tick], output);
    }
    sink = output.wheel_angle[0];
}
}

namespace
{

template <class Run> double nanoseconds_per_step(const Run &run)
{
    const auto start = std::chrono::steady_clock::now();
    run();
    const std::chrono::duration<double, std::nano> spent = std::chrono::steady_clock::now() - start;
    return spent.count() / RECORDED_TICKS;
}

} // namespace

int main(int count, char **arguments)
{
    const int collisions = count == 2 ? std::atoi(arguments[1]) : 0;
    if (collisions < 1) {
        std::fprintf(stderr, "usage: bench_step COLLISIONS\n");
        return 2;
    }
    gw_controller_config_t config;
    recorded_collision_config(&config);
    Inputs inputs(RECORDED_TICKS);
    for (uint32_t tick = 0; tick < RECORDED_TICKS; ++tick) {
        recorded_collision_input(tick, &inputs[tick]);
    }
    const auto library = std::make_unique<gw_controller_t>();
    double c_core = std::numeric_limits<double>::infinity(), eigen = c_core;
    for (int i = 0; i < collisions; ++i) {
        if (gw_controller_init(library.get(), &config, nullptr) != GW_STATUS_OK) {
            return 1;
        }
        const auto with_eigen = std::make_unique<eigen_step::Controller>(config);
        c_core = std::min(c_core, nanoseconds_per_step([&] { run_c_core(library.get(), inputs.data()); }));
        eigen = std::min(eigen, nanoseconds_per_step([&] { run_eigen(with_eigen.get(), inputs.data()); }));
    }
    std::printf("c_core %.1f\neigen %.1f\n", c_core, eigen);
    return 0;
}
