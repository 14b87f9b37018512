#include "../matrix_forms.h"
#include "script.h"

#include "giveway/gw_math.h"

#define REST_TICKS 500U
#define MOVE_TICKS 500U
#define LONGEST_FAULT 40U

void script_begin(script_t *script, const gw_controller_config_t *config, uint32_t seed, bool valid_plans)
{
    static const script_t fresh = {0};
    *script = fresh;
    script->config = *config;
    (void)gw_kinematics_init(&script->kinematics, &config->geometry);
    (void)gw_nominal_init(&script->nominal, &config->base, &config->friction, &script->kinematics);
    script->generator = generator_begin(seed);
    script->input.sensor.counter = 0xFFFFFF00U;
    script->valid_plans = valid_plans;
}

/* There and back: standing, then a cubic of the path time. */
static gw_plan_t plan_at(uint32_t path_ticks, gw_real_t period_s)
{
    const gw_real_t span_s = (gw_real_t)MOVE_TICKS * period_s;
    const uint32_t within = path_ticks % (REST_TICKS + MOVE_TICKS);
    const bool back = ((path_ticks / (REST_TICKS + MOVE_TICKS)) % 2U) == 1U;
    const gw_real_t s = (within < REST_TICKS) ? GW_ZERO : ((gw_real_t)(within - REST_TICKS) / (gw_real_t)MOVE_TICKS);
    const gw_real_t bend = ((gw_real_t)3.0 * (s * s)) - (GW_TWO * ((s * s) * s));
    const gw_real_t at = back ? (GW_ONE - bend) : bend;
    const gw_real_t sign = back ? -GW_ONE : GW_ONE;
    const gw_real_t rate_per_s = (sign * ((gw_real_t)6.0 * (s - (s * s)))) / span_s;
    const gw_real_t change_per_s2 =
        (within < REST_TICKS) ? GW_ZERO : ((sign * ((gw_real_t)6.0 - ((gw_real_t)12.0 * s))) / (span_s * span_s));
    const gw_real_t length_m = (gw_real_t)0.12;
    const gw_real_t turn_rad = (gw_real_t)0.3;
    const gw_plan_t plan = {{length_m * at, -length_m * at, turn_rad * at},
                            {length_m * rate_per_s, -length_m * rate_per_s, turn_rad * rate_per_s},
                            {length_m * change_per_s2, -length_m * change_per_s2, turn_rad * change_per_s2}};
    return plan;
}

static void turn_wheels(script_t *script, const gw_controller_output_t *before)
{
    const gw_real_t counts_per_rad = (gw_real_t)script->config.estimator.encoder_counts / (GW_TWO * GW_PI);
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        script->travel_counts[i] += (before->command.speed_radps[i] * script->config.period_s) * counts_per_rad;
        const int32_t whole = (int32_t)script->travel_counts[i];
        script->travel_counts[i] -= (gw_real_t)whole;
        script->input.sensor.encoder_count[i] += whole;
    }
}

static void load_wheels(script_t *script, const gw_controller_output_t *before)
{
    static const gw_acceleration_t steady = {(gw_real_t)0.0, (gw_real_t)0.0, (gw_real_t)0.0};
    const gw_vector_t world = {before->reference_twist.vx_mps, before->reference_twist.vy_mps};
    const gw_vector_t base = gw_rotate_back(gw_sincos(before->reference_pose.theta_rad), world);
    const gw_twist_t twist = {base.x, base.y, before->reference_twist.omega_radps};
    const gw_wheels_t model_nm = nominal_torques(&script->nominal, &script->kinematics, twist, steady);
    const gw_wheels_t noise_nm = generator_wheels(&script->generator, (gw_real_t)0.05);
    if (script->push_ticks > 0U) {
        script->push_ticks--;
    } else if (generator_one_in(&script->generator, 700U)) {
        script->push_nm = generator_wheels(&script->generator, (gw_real_t)3.0);
        script->push_ticks = 150U;
    } else {
        script->push_nm = generator_wheels(&script->generator, GW_ZERO);
    }
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        script->input.sensor.torque_nm[i] = (model_nm.wheel[i] + noise_nm.wheel[i]) + script->push_nm.wheel[i];
    }
}

/* Missing, stale, not finite, saturated, or an encoder that jumps. */
static void break_sensors(script_t *script)
{
    gw_sensor_sample_t *const sample = &script->input.sensor;
    const uint32_t wheel = generator_below(&script->generator, GW_WHEEL_COUNT);
    sample->present = true;
    sample->counter++;
    if (script->fault_ticks > 0U) {
        script->fault_ticks--;
        if (script->fault == 0U) {
            sample->present = false;
        } else if (script->fault == 1U) {
            sample->counter--;
        } else if (script->fault == 2U) {
            const gw_real_t infinite = GW_REAL_MAX * GW_TWO;
            sample->torque_nm[wheel] = (wheel == 0U) ? (infinite - infinite) : -infinite;
        } else if (script->fault == 3U) {
            sample->torque_nm[wheel] = (gw_real_t)-30.0;
        } else {
            sample->encoder_count[wheel] += 5000;
        }
    } else if (generator_one_in(&script->generator, 600U)) {
        script->fault_ticks = 1U + generator_below(&script->generator, LONGEST_FAULT);
        script->fault = generator_below(&script->generator, 5U);
    } else {
        /* good */
    }
}

/* What an IMU might show; a robot without one gets no sample. */
static void feel(script_t *script, const gw_controller_output_t *before)
{
    if (script->config.estimator.acceleration_source > GW_SOURCE_ZERO) {
        gw_imu_sample_t *const sample = &script->input.imu;
        const gw_vector_t noise = generator_vector(&script->generator, (gw_real_t)0.05);
        sample->specific_force_mps2[0] = (gw_real_t)0.1 + noise.x;
        sample->specific_force_mps2[1] = noise.y;
        sample->yaw_rate_radps = before->reference_twist.omega_radps;
        sample->counter++;
        sample->present = (script->tick % 1000U) != 999U;
    }
}

static void ask(script_t *script, const gw_controller_output_t *before)
{
    script->input.plan = plan_at(before->path_ticks, script->config.period_s);
    if ((!script->valid_plans) && generator_one_in(&script->generator, 150U)) {
        script->input.plan.pose.x_m = GW_REAL_MAX * GW_TWO;
    }
    if (script->stop_ticks > 0U) {
        script->stop_ticks--;
    } else if (generator_one_in(&script->generator, 900U)) {
        script->stop_ticks = 1U + generator_below(&script->generator, 50U);
    } else {
        /* no stop */
    }
    script->input.stop_request = (script->stop_ticks > 0U);
    script->input.tare_request = generator_one_in(&script->generator, 300U);
}

const gw_controller_input_t *script_next(script_t *script, const gw_controller_output_t *before)
{
    turn_wheels(script, before);
    load_wheels(script, before);
    if (script->tick > (script->config.estimator.tare_ticks + 50U)) { /* an undisturbed start */
        break_sensors(script);
    } else {
        script->input.sensor.present = true;
        script->input.sensor.counter++;
    }
    feel(script, before);
    ask(script, before);
    script->tick++;
    return &script->input;
}
