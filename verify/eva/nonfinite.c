/* Infinite torques are never called good, nor is an infinite acceleration trusted; sensor_check and IMU keep their
 * invariants (NaN: esbmc/sensor_check.c; Eva takes any comparison with it for undecided). It also reaches the branches
 * that finite numbers do not: every invariant, given NaN and infinities. */
#include "parts.h"

static void part_init(void)
{
}

static void part_step(void)
{
    static gw_sensor_check_t check;
    static gw_imu_t imu;
    gw_imu_output_t felt;
    const gw_real_t infinite[2] = {1.0F / 0.0F, -1.0F / 0.0F};
    for (uint32_t kind = 0U; kind < 2U; kind++) {
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            gw_sensor_sample_t sample = {
                {any_real(), any_real(), any_real()}, {any_int, any_int, any_int}, any_count, any_flag()};
            sample.torque_nm[i] = infinite[kind];
            draw_sensor_check(&check);
            const gw_status_t status = gw_sensor_check_step(&check, &sample);
            demand_count((uint32_t)status, (uint32_t)GW_STATUS_SENSOR_MISSING, (uint32_t)GW_STATUS_SENSOR_RECOVERING);
            hold_sensor_check(&check);
        }
        const gw_imu_sample_t shown = {{infinite[kind], any_real()}, any_real(), any_count, any_flag()};
        draw_imu(&imu);
        const gw_status_t status = gw_imu_step(&imu, &shown, any_flag(), &felt);
        demand_count((uint32_t)status, (uint32_t)GW_STATUS_SENSOR_MISSING, (uint32_t)GW_STATUS_SENSOR_RECOVERING);
        demand_count(felt.trusted ? 1U : 0U, 0U, 0U);
        hold_imu(&imu);
    }
}

static void part_refusals(void)
{
    static gw_controller_t controller;
    disturb_controller(&controller);
    controller.contact.config.vertex_count = GW_OUTLINE_VERTEX_MAX; /* as in contact.c */
    controller.estimator.kinematics.wheel_radius_m = any_float;
    controller.estimator.kinematics.roller_radius_m = any_float;
    controller.estimator.kinematics.wheel_distance_m = any_float;
    (void)gw_controller_invariant_holds(&controller);
    (void)gw_estimator_invariant_holds(&controller.estimator);
    (void)gw_kinematics_invariant_holds(&controller.estimator.kinematics);
    (void)gw_moving_average_invariant_holds(&controller.estimator.average);
    (void)gw_sum_invariant_holds(controller.reference.x_m);
    (void)gw_reference_invariant_holds(&controller.reference);
    (void)gw_admittance_invariant_holds(&controller.admittance);
}
