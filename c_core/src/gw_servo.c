#include "giveway/gw_servo.h"

#include "giveway/gw_math.h"

#define REFERENCE_SPEED_MAX ((gw_real_t)1.0e4)
/* No motor turns faster. The limit keeps the measured speed finite for any counts. */
#define SPEED_MAX ((gw_real_t)1.0e6)

void gw_servo_config_check(const gw_servo_config_t *config, gw_config_error_t *error)
{
    gw_config_check_real(error, GW_FIELD_SERVO_PERIOD, config->period_s);
    gw_config_check_real(error, GW_FIELD_SERVO_KP, config->kp_nm_per_rad);
    gw_config_check_real(error, GW_FIELD_SERVO_KD, config->kd_nms_per_rad);
    gw_config_check_real(error, GW_FIELD_SERVO_TORQUE_LIMIT, config->torque_limit_nm);
    gw_config_check_real(error, GW_FIELD_SERVO_TORQUE_RATE_LIMIT, config->torque_rate_limit_nm_per_s);
    gw_config_check_count(error, GW_FIELD_SERVO_ENCODER_COUNTS, config->encoder_counts);
    gw_config_check_real(error, GW_FIELD_SERVO_DERIVATIVE_CUTOFF, config->derivative_cutoff_hz);
    gw_config_check_count(error, GW_FIELD_SERVO_STALE_TICKS_MAX, config->stale_ticks_max);
}

gw_status_t gw_servo_init(gw_servo_t *servo, const gw_servo_config_t *config)
{
    gw_status_t status = GW_STATUS_OK;
    if ((servo == NULL) || (config == NULL)) {
        status = GW_STATUS_NULL_POINTER;
    } else {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_servo_config_check(config, &error);
        servo->initialised = (error.field == GW_FIELD_NONE);
        if (servo->initialised) {
            servo->config = *config;
            servo->rad_per_count = (GW_TWO * GW_PI) / (gw_real_t)config->encoder_counts;
            servo->count_rate = servo->rad_per_count / config->period_s;
            servo->filter_gain = -gw_expm1(-((GW_TWO * GW_PI) * config->derivative_cutoff_hz) * config->period_s);
            servo->torque_step_nm = config->torque_rate_limit_nm_per_s * config->period_s;
            servo->desired_rad = gw_sum_of(GW_ZERO);
            servo->desired_speed_radps = GW_ZERO;
            servo->speed_radps = GW_ZERO;
            servo->torque_nm = GW_ZERO;
            servo->last_count = 0;
            servo->position_count = 0;
            servo->reference_age = 0U;
            servo->reference_status = GW_STATUS_OK;
            servo->started = false;
        } else {
            status = GW_STATUS_CONFIG_INVALID;
        }
    }
    return status;
}

bool gw_servo_invariant_holds(const gw_servo_t *servo)
{
    bool holds = (servo != NULL);
    if (holds) {
        holds = servo->initialised;
    }
    if (holds) {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_servo_config_check(&servo->config, &error);
        holds = (error.field == GW_FIELD_NONE) && gw_sum_invariant_holds(servo->desired_rad) &&
                gw_within(servo->desired_rad.value, GW_PI) &&
                gw_within(servo->desired_speed_radps, REFERENCE_SPEED_MAX) &&
                gw_within(servo->speed_radps, SPEED_MAX) && (servo->position_count >= 0) &&
                (servo->position_count < (int32_t)servo->config.encoder_counts) &&
                gw_in_range(servo->filter_gain, GW_ZERO, GW_ONE) &&
                gw_in_range(servo->torque_nm, -servo->config.torque_limit_nm, servo->config.torque_limit_nm);
    }
    return holds;
}

/* count modulo one turn, [0, encoder_counts). */
static int32_t modulo_turn(int32_t count, uint32_t encoder_counts)
{
    const int32_t turn = (int32_t)encoder_counts;
    const int32_t remainder = count % turn;
    return (remainder < 0) ? (remainder + turn) : remainder;
}

static void measure(gw_servo_t *servo, int32_t count)
{
    if (servo->started) {
        const int32_t moved = gw_count_difference(count, servo->last_count);
        const gw_real_t raw_radps = (gw_real_t)moved * servo->count_rate;
        const gw_real_t filtered_radps = servo->speed_radps + (servo->filter_gain * (raw_radps - servo->speed_radps));
        servo->speed_radps = gw_limited(filtered_radps, SPEED_MAX);
        servo->position_count = modulo_turn(servo->position_count + modulo_turn(moved, servo->config.encoder_counts),
                                            servo->config.encoder_counts);
    } else {
        servo->position_count = modulo_turn(count, servo->config.encoder_counts);
        servo->desired_rad = gw_sum_of(gw_wrap_angle((gw_real_t)servo->position_count * servo->rad_per_count));
        servo->started = true;
    }
    servo->last_count = count;
}

static void take_reference(gw_servo_t *servo, const gw_servo_input_t *input)
{
    if (input->reference_is_new) {
        servo->reference_age = 0U;
        if (gw_within(input->angle_rad, GW_ANGLE_MAX) && gw_within(input->speed_radps, REFERENCE_SPEED_MAX)) {
            servo->desired_rad = gw_sum_of(gw_wrap_angle(input->angle_rad));
            servo->desired_speed_radps = gw_limited(input->speed_radps, REFERENCE_SPEED_MAX);
            servo->reference_status = GW_STATUS_OK;
        } else {
            servo->desired_speed_radps = GW_ZERO;
            servo->reference_status = GW_STATUS_REFERENCE_INVALID;
        }
    } else {
        if (servo->reference_age < servo->config.stale_ticks_max) {
            servo->reference_age++;
        }
        if (servo->reference_age >= servo->config.stale_ticks_max) {
            servo->desired_speed_radps = GW_ZERO;
            if (servo->reference_status == GW_STATUS_OK) {
                servo->reference_status = GW_STATUS_REFERENCE_STALE;
            }
        }
        servo->desired_rad = gw_sum_add_angle(servo->desired_rad, servo->desired_speed_radps * servo->config.period_s);
    }
}

gw_status_t gw_servo_step(gw_servo_t *servo, const gw_servo_input_t *input, gw_servo_output_t *output)
{
    gw_status_t status = GW_STATUS_OK;
    if (output == NULL) {
        status = GW_STATUS_NULL_POINTER;
    } else {
        output->torque_nm = GW_ZERO;
        output->angle_error_rad = GW_ZERO;
        output->speed_radps = GW_ZERO;
        if ((servo == NULL) || (input == NULL)) {
            status = GW_STATUS_NULL_POINTER;
        } else if (!servo->initialised) {
            status = GW_STATUS_NOT_INITIALISED;
        } else {
            const gw_real_t limit = servo->config.torque_limit_nm;
            measure(servo, input->encoder_count);
            take_reference(servo, input);
            const gw_real_t measured_rad = (gw_real_t)servo->position_count * servo->rad_per_count;
            if ((!input->enable) && (servo->reference_status != GW_STATUS_OK)) {
                /* There is no reference to hold: enabling must not pull back to where the wheel once was. */
                servo->desired_rad = gw_sum_of(gw_wrap_angle(measured_rad));
            }
            output->angle_error_rad = gw_wrap_angle(servo->desired_rad.value - measured_rad);
            output->speed_radps = servo->speed_radps;
            if (input->enable) {
                const gw_real_t wanted =
                    (servo->config.kp_nm_per_rad * output->angle_error_rad) +
                    (servo->config.kd_nms_per_rad * (servo->desired_speed_radps - servo->speed_radps));
                gw_real_t torque = gw_clamp(wanted, -limit, limit);
                if (servo->torque_step_nm > GW_ZERO) {
                    torque = gw_clamp(torque, servo->torque_nm - servo->torque_step_nm,
                                      servo->torque_nm + servo->torque_step_nm);
                }
                servo->torque_nm = torque;
            } else {
                servo->torque_nm = GW_ZERO;
            }
            output->torque_nm = servo->torque_nm;
            status = servo->reference_status;
        }
    }
    return status;
}
