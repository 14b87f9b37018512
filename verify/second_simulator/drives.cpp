// The drives of fmu/models/testbed (servos of c_core, encoders, torque sensors, bus) behind a C interface, for Python.
#include <algorithm>
#include <new>

#include "drives.hpp"
#include "from_variables.hpp"

namespace
{

using namespace giveway::testbed;

PerWheel<double> three(const double *values)
{
    PerWheel<double> found;
    std::copy_n(values, found.size(), found.begin());
    return found;
}

} // namespace

extern "C" {

// In `numbers`: encoder counts, noise, resolution and range of the torque sensors (N m), kp, kd, torque limit, cut-off
// of the servos, cycles of delay of sensors and commands. Null if the servos refuse that.
void *second_simulator_drives(const double *numbers, std::uint32_t seed, const double *motor_angle,
                              const double *wheel_speed, const double *torque, int enable)
{
    Variables v{};
    set_start_values(v);
    v.electronics_encoder_counts = static_cast<std::int32_t>(numbers[0]);
    v.electronics_torque_noise = numbers[1];
    v.electronics_torque_resolution = numbers[2];
    v.electronics_torque_range = numbers[3];
    v.servo_kp = numbers[4];
    v.servo_kd = numbers[5];
    v.drivetrain_torque_limit = numbers[6];
    v.servo_derivative_cutoff = numbers[7];
    v.electronics_sensor_delay = static_cast<std::int32_t>(numbers[8]);
    v.electronics_command_delay = static_cast<std::int32_t>(numbers[9]);
    v.electronics_seed = static_cast<std::int32_t>(seed);
    auto *drives = new (std::nothrow) Drives;
    if (drives != nullptr) {
        const auto refused =
            drives->start(drive_options(v), three(motor_angle), three(wheel_speed), three(torque), enable != 0);
        if (refused.field == GW_FIELD_NONE) {
            return drives;
        }
        delete drives;
    }
    return nullptr;
}

void second_simulator_sample(void *drives, const double *motor_angle, const double *torque, double *sensed_torque,
                             std::int32_t *counts_and_counter)
{
    const SensorSample sample = static_cast<Drives *>(drives)->sample(three(motor_angle), three(torque));
    std::copy_n(sample.torque_nm.begin(), wheel_count, sensed_torque);
    std::copy_n(sample.encoder_counts.begin(), wheel_count, counts_and_counter);
    counts_and_counter[wheel_count] = sample.counter;
}

void second_simulator_receive(void *drives, const double *angle_and_speed, int enable)
{
    static_cast<Drives *>(drives)->receive({three(angle_and_speed), three(angle_and_speed + wheel_count), enable != 0});
}

void second_simulator_regulate(void *drives, const double *motor_angle, double *motor_torque)
{
    const auto torque = static_cast<Drives *>(drives)->regulate(three(motor_angle));
    std::copy_n(torque.begin(), wheel_count, motor_torque);
}

void second_simulator_end(void *drives)
{
    delete static_cast<Drives *>(drives);
}
}
