/* The initial state depends on init alone: no previous content of the memory remains. */
#include "unit.h"

#include <string.h>

/* Content of uninitialised memory. */
static void soil(void *place, size_t size)
{
    (void)memset(place, 0xA5, size);
}

static gw_controller_config_t trikey(void)
{
    gw_controller_config_t config;
    gw_controller_config_trikey(&config);
    return config;
}

static bool is_zero_sum(gw_sum_t sum)
{
    return (sum.value == GW_ZERO) && (sum.excess == GW_ZERO);
}

static void a_servo_starts_from_nothing(void)
{
    const gw_servo_config_t config = {R(0.0005), R(100.0), R(2.0), R(10.0), R(0.0), 1000U, R(100.0), 4U};
    gw_servo_t servo;
    soil(&servo, sizeof(servo));
    CHECK_STATUS(gw_servo_init(&servo, &config), GW_STATUS_OK);
    CHECK(is_zero_sum(servo.desired_rad) && (servo.desired_speed_radps == GW_ZERO));
    CHECK((servo.speed_radps == GW_ZERO) && (servo.torque_nm == GW_ZERO));
    CHECK((servo.last_count == 0) && (servo.position_count == 0) && (servo.reference_age == 0U));
    CHECK((servo.reference_status == GW_STATUS_OK) && (!servo.started));
}

static void a_sensor_check_starts_from_nothing(void)
{
    const gw_controller_config_t config = trikey();
    gw_sensor_check_t check;
    soil(&check, sizeof(check));
    CHECK_STATUS(gw_sensor_check_init(&check, &config.sensor_check), GW_STATUS_OK);
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        unit_row(i);
        CHECK(check.last_count[i] == 0);
    }
    CHECK((check.last_counter == 0U) && (check.age_ticks == 0U) && (check.recover_remaining == 0U));
    CHECK((!check.counter_known) && (!check.encoder_known) && (!check.was_good));
}

static void an_admittance_starts_from_nothing(void)
{
    const gw_controller_config_t config = trikey();
    gw_admittance_t admittance;
    soil(&admittance, sizeof(admittance));
    CHECK_STATUS(gw_admittance_init(&admittance, &config.admittance, config.period_s), GW_STATUS_OK);
    CHECK((admittance.goal_m.x == GW_ZERO) && (admittance.goal_m.y == GW_ZERO));
    CHECK((admittance.velocity_mps.x == GW_ZERO) && (admittance.velocity_mps.y == GW_ZERO));
    CHECK(is_zero_sum(admittance.moved_x_m) && is_zero_sum(admittance.moved_y_m));
}

static void a_reference_starts_at_the_origin_at_rest(void)
{
    const gw_controller_config_t config = trikey();
    gw_reference_t reference;
    soil(&reference, sizeof(reference));
    CHECK_STATUS(gw_reference_init(&reference, &config.reference, config.period_s), GW_STATUS_OK);
    CHECK(is_zero_sum(reference.x_m) && is_zero_sum(reference.y_m) && is_zero_sum(reference.theta_rad));
    CHECK((reference.twist.vx_mps == GW_ZERO) && (reference.twist.vy_mps == GW_ZERO));
    CHECK(reference.twist.omega_radps == GW_ZERO);
    CHECK((reference.acceleration.ax_mps2 == GW_ZERO) && (reference.acceleration.ay_mps2 == GW_ZERO));
    CHECK(reference.acceleration.alpha_radps2 == GW_ZERO);
}

static void a_rate_filter_starts_from_nothing(void)
{
    gw_rate_filter_t filter;
    soil(&filter, sizeof(filter));
    gw_rate_filter_restart(&filter);
    CHECK((filter.last_count == 0) && (filter.last_torque_nm == GW_ZERO));
    CHECK((filter.rate_radps == GW_ZERO) && (filter.derivative_radps2 == GW_ZERO) && (!filter.started));
}

static void an_average_starts_from_nothing(void)
{
    static gw_moving_average_t average;
    const struct {
        uint32_t asked;
        uint32_t window;
        gw_status_t status;
    } rows[] = {
        {1U, 1U, GW_STATUS_OK},
        {GW_MOVING_AVERAGE_CAPACITY, GW_MOVING_AVERAGE_CAPACITY, GW_STATUS_OK},
        {0U, 1U, GW_STATUS_CONFIG_INVALID},
        {GW_MOVING_AVERAGE_CAPACITY + 1U, 1U, GW_STATUS_CONFIG_INVALID},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        soil(&average, sizeof(average));
        unit_row(i);
        CHECK_STATUS(gw_moving_average_init(&average, rows[i].asked), rows[i].status);
        CHECK(average.window == rows[i].window);
        for (uint32_t k = 0U; k < GW_MOVING_AVERAGE_CAPACITY; k++) {
            CHECK((average.sample[k].force_x_n == GW_ZERO) && (average.sample[k].force_y_n == GW_ZERO) &&
                  (average.sample[k].torque_nm == GW_ZERO));
        }
    }
}

static void check_kept(const gw_estimator_config_t *kept, const gw_estimator_config_t *config)
{
    CHECK((kept->velocity_source == config->velocity_source) && (kept->friction_model == config->friction_model));
    CHECK(kept->acceleration_source == config->acceleration_source);
    CHECK((kept->torque_noise_nm == config->torque_noise_nm) && (kept->rate_cutoff_radps == config->rate_cutoff_radps));
    CHECK(kept->drivetrain_stiffness_nm_per_rad == config->drivetrain_stiffness_nm_per_rad);
    CHECK((kept->encoder_counts == config->encoder_counts) && (kept->average_window == config->average_window));
    CHECK((kept->rest_speed_mps == config->rest_speed_mps) && (kept->creep_speed_mps == config->creep_speed_mps));
    CHECK((kept->rest_ticks == config->rest_ticks) && (kept->tare_ticks == config->tare_ticks));
    CHECK((kept->retare_ticks == config->retare_ticks) && (kept->tare_variation_nm == config->tare_variation_nm));
    CHECK(memcmp(&kept->presliding, &config->presliding, sizeof(kept->presliding)) == 0);
}

static void an_estimator_starts_from_nothing(void)
{
    static gw_estimator_t estimator;
    const gw_controller_config_t config = trikey();
    soil(&estimator, sizeof(estimator));
    CHECK_STATUS(gw_estimator_init(&estimator, &config.estimator, &config.geometry, &config.base, &config.friction,
                                   config.period_s),
                 GW_STATUS_OK);
    CHECK(estimator.slow_ticks == 0U);
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        unit_row(i);
        CHECK((estimator.run_zero_nm.wheel[i] == GW_ZERO) && (estimator.rest_zero_nm.wheel[i] == GW_ZERO));
        CHECK(is_zero_sum(estimator.presliding.deflection_m[i]));
        CHECK(estimator.presliding.last_torque_nm.wheel[i] == GW_ZERO);
        CHECK(estimator.presliding.last_count[i] == 0);
    }
    CHECK((!estimator.presliding.torque_known) && (!estimator.presliding.count_known));
    check_kept(&estimator.config, &config.estimator);
}

/* The state that a tick without good sensors starts from. */
static void check_nothing_found(const gw_estimator_output_t *estimate, const gw_detector_output_t *detection)
{
    const gw_wrench_t wrenches[] = {estimate->wrench, estimate->mean, estimate->window_mean, detection->mean_wrench};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(wrenches); i++) {
        unit_row(i);
        CHECK((wrenches[i].force_x_n == GW_ZERO) && (wrenches[i].force_y_n == GW_ZERO));
        CHECK(wrenches[i].torque_nm == GW_ZERO);
    }
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        unit_row(i);
        CHECK(estimate->nominal_nm.wheel[i] == GW_ZERO);
    }
    CHECK((estimate->sigma.force_n == GW_ZERO) && (estimate->sigma.torque_nm == GW_ZERO));
    CHECK((estimate->measured_twist.vx_mps == GW_ZERO) && (estimate->measured_twist.vy_mps == GW_ZERO));
    CHECK(estimate->measured_twist.omega_radps == GW_ZERO);
    CHECK((estimate->mean_samples == 0U) && (estimate->regime == GW_REGIME_CREEPING) && (!estimate->zero_changed));
    CHECK((!detection->tripped) && (!detection->active) && (detection->statistic == GW_ZERO) &&
          (detection->samples == 0U));
}

static void a_controller_starts_from_nothing(void)
{
    static gw_controller_t controller;
    const gw_controller_config_t config = trikey();
    soil(&controller, sizeof(controller));
    CHECK_STATUS(gw_controller_init(&controller, &config, NULL), GW_STATUS_OK);
    CHECK((controller.tick == 0U) && (!controller.tare_request_before) && (!controller.on_plan) &&
          (!controller.turns) && (!controller.begins) && (!controller.waits) && (!controller.may_press) &&
          (!controller.may_be_pushed));
    CHECK((controller.detection_count == 0U) && (controller.detection_tick == -1));
    CHECK((controller.detection_wrench.force_x_n == GW_ZERO) && (controller.detection_wrench.force_y_n == GW_ZERO));
    CHECK(controller.detection_wrench.torque_nm == GW_ZERO);
    CHECK((!controller.detection_contact.valid) && (!controller.detection_contact.on_outline));
    CHECK((controller.detection_contact.point_m.x == GW_ZERO) && (controller.detection_contact.point_m.y == GW_ZERO));
    CHECK((controller.detection_contact.force_n == GW_ZERO) && (controller.detection_contact.direction_rad == GW_ZERO));
    CHECK((controller.detection_contact.lever_arm_m == GW_ZERO) &&
          (controller.detection_contact.lever_arm_sigma_m == GW_ZERO));
    check_nothing_found(&controller.estimate, &controller.detection);
}

static void a_refused_supervisor_is_in_fault(void)
{
    gw_controller_config_t config = trikey();
    gw_supervisor_t supervisor;
    config.supervisor.settled_ticks = 0U;
    soil(&supervisor, sizeof(supervisor));
    CHECK_STATUS(gw_supervisor_init(&supervisor, &config.supervisor), GW_STATUS_CONFIG_INVALID);
    CHECK((supervisor.mode == GW_MODE_FAULT) && (!supervisor.initialised));
}

/* The output that means "do not move", written over arbitrary memory of the caller. */
static void check_safe(const gw_controller_output_t *output)
{
    const gw_contact_estimate_t *const contacts[2] = {&output->contact, &output->detection_contact};
    const gw_real_t zeros[] = {
        output->command.angle_rad[0],       output->command.angle_rad[1],       output->command.angle_rad[2],
        output->command.speed_radps[0],     output->command.speed_radps[1],     output->command.speed_radps[2],
        output->estimate.force_x_n,         output->estimate.force_y_n,         output->estimate.torque_nm,
        output->detection_statistic,        output->detection_wrench.force_x_n, output->detection_wrench.force_y_n,
        output->detection_wrench.torque_nm, output->reference_pose.x_m,         output->reference_pose.y_m,
        output->reference_pose.theta_rad,   output->reference_twist.vx_mps,     output->reference_twist.vy_mps,
        output->reference_twist.omega_radps};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(zeros); i++) {
        unit_row(i);
        CHECK(zeros[i] == GW_ZERO);
    }
    for (uint32_t i = 0U; i < 2U; i++) {
        unit_row(i);
        CHECK((!contacts[i]->valid) && (!contacts[i]->on_outline));
        CHECK((contacts[i]->point_m.x == GW_ZERO) && (contacts[i]->point_m.y == GW_ZERO));
        CHECK((contacts[i]->force_n == GW_ZERO) && (contacts[i]->direction_rad == GW_ZERO));
        CHECK((contacts[i]->lever_arm_m == GW_ZERO) && (contacts[i]->lever_arm_sigma_m == GW_ZERO));
    }
    CHECK((!output->enable) && (!output->detection_active) && (output->mode == GW_MODE_FAULT));
    CHECK((output->detection_count == 0U) && (output->detection_tick == -1));
    CHECK((output->path_ticks == 0U) && (output->tick == 0U));
}

static void a_safe_output_is_safe_throughout(void)
{
    static gw_controller_t controller;
    gw_controller_input_t input;
    gw_controller_output_t output;
    (void)memset(&input, 0, sizeof(input));
    soil(&output, sizeof(output));
    gw_controller_safe_output(&output);
    check_safe(&output);
    soil(&output, sizeof(output));
    CHECK_STATUS(gw_controller_step(NULL, &input, &output), GW_STATUS_NULL_POINTER);
    check_safe(&output);
    soil(&output, sizeof(output));
    CHECK_STATUS(gw_controller_step(&controller, &input, &output), GW_STATUS_NOT_INITIALISED);
    check_safe(&output);
}

/* The configuration was not read, so no field is reported. */
static void a_missing_controller_blames_no_field(void)
{
    const gw_controller_config_t config = trikey();
    gw_config_error_t error;
    soil(&error, sizeof(error));
    CHECK_STATUS(gw_controller_init(NULL, &config, &error), GW_STATUS_NULL_POINTER);
    CHECK((error.field == GW_FIELD_NONE) && (error.index == 0U) && (error.value == GW_ZERO));
}

void suite_init(void)
{
    unit_run("a_servo_starts_from_nothing", a_servo_starts_from_nothing);
    unit_run("a_sensor_check_starts_from_nothing", a_sensor_check_starts_from_nothing);
    unit_run("an_admittance_starts_from_nothing", an_admittance_starts_from_nothing);
    unit_run("a_reference_starts_at_the_origin_at_rest", a_reference_starts_at_the_origin_at_rest);
    unit_run("a_rate_filter_starts_from_nothing", a_rate_filter_starts_from_nothing);
    unit_run("an_average_starts_from_nothing", an_average_starts_from_nothing);
    unit_run("an_estimator_starts_from_nothing", an_estimator_starts_from_nothing);
    unit_run("a_controller_starts_from_nothing", a_controller_starts_from_nothing);
    unit_run("a_refused_supervisor_is_in_fault", a_refused_supervisor_is_in_fault);
    unit_run("a_safe_output_is_safe_throughout", a_safe_output_is_safe_throughout);
    unit_run("a_missing_controller_blames_no_field", a_missing_controller_blames_no_field);
}
