// The drives of fmu/models/testbed (servos of c_core, encoders, torque sensors, bus, accelerometer) behind a C
// interface, for Python.
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

struct Electronics {
    Drives drives;
    Imu imu;
};

} // namespace

extern "C" {

// `numbers`: in the order in which they are read here, and in electronics.py. `torque`: of the sensors and of the
// motors, the same for drives at rest. Null if the servos refuse them.
void *second_simulator_drives(const double *numbers, std::uint32_t seed, const double *motor_angle,
                              const double *wheel_speed, const double *torque, int enable)
{
    const auto next = [&numbers] { return *numbers++; };
    const auto whole = [&next] { return static_cast<std::int32_t>(next()); };
    Variables v{};
    set_start_values(v);
    v.electronics_seed = static_cast<std::int32_t>(seed);
    v.electronics_encoder_counts = whole();
    v.electronics_torque_noise = next();
    v.electronics_torque_resolution = next();
    v.electronics_torque_range = next();
    v.servo_kp = next();
    v.servo_kd = next();
    v.drivetrain_torque_limit = next();
    v.drivetrain_sensing = whole();
    v.servo_derivative_cutoff = next();
    v.electronics_sensor_delay = whole();
    v.electronics_command_delay = whole();
    v.imu_present = next() != 0.0;
    for (int axis = 0; axis < imu_axes; ++axis) {
        v.imu_acceleration_bias[axis] = next();
        v.imu_acceleration_scale[axis] = next();
    }
    v.imu_acceleration_noise = next();
    v.imu_gyro_bias = next();
    v.imu_gyro_scale = next();
    v.imu_gyro_noise = next();
    v.imu_vibration = next();
    v.imu_vibration_growth = next();
    v.imu_vibration_frequency = next();
    v.imu_vibration_damping = next();
    v.imu_bandwidth = next();
    v.imu_range = next();
    v.imu_gyro_range = next();
    v.imu_delay = whole();
    v.imu_dropout = next();
    auto *electronics = new (std::nothrow) Electronics;
    if (electronics != nullptr) {
        electronics->imu.start(imu_options(v), {});
        const auto refused = electronics->drives.start(drive_options(v), three(motor_angle), three(wheel_speed),
                                                       three(torque), three(torque), enable != 0);
        if (refused.field == GW_FIELD_NONE) {
            return electronics;
        }
        delete electronics;
    }
    return nullptr;
}

// `felt`: specific force along the accelerometer's axes, yaw rate, mean wheel speed. Sensed: three torques, then
// acceleration and yaw rate; three counts, the sample counter, then that of the accelerometer, and whether it is there.
void second_simulator_sample(void *electronics, const double *motor_angle, const double *torque, const double *felt,
                             double *sensed, std::int32_t *whole)
{
    auto &[drives, imu] = *static_cast<Electronics *>(electronics);
    const SensorSample sample = drives.sample(three(motor_angle), three(torque));
    sensed = std::copy_n(sample.torque_nm.begin(), wheel_count, sensed);
    whole = std::copy_n(sample.encoder_counts.begin(), wheel_count, whole);
    *whole++ = sample.counter;
    if (imu.options().present) {
        const ImuSample shown = imu.sample({{felt[0], felt[1]}, felt[2], felt[3]});
        *std::copy_n(shown.acceleration_mps2.begin(), imu_axes, sensed) = shown.yaw_rate_radps;
        whole[0] = shown.counter;
        whole[1] = 1;
    }
}

void second_simulator_receive(void *electronics, const double *angle_and_speed, int enable)
{
    static_cast<Electronics *>(electronics)
        ->drives.receive({three(angle_and_speed), three(angle_and_speed + wheel_count), enable != 0});
}

void second_simulator_regulate(void *electronics, const double *motor_angle, double *motor_torque)
{
    const auto torque = static_cast<Electronics *>(electronics)->drives.regulate(three(motor_angle));
    std::copy_n(torque.begin(), wheel_count, motor_torque);
}

void second_simulator_end(void *electronics)
{
    delete static_cast<Electronics *>(electronics);
}
}
