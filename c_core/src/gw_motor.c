#include "giveway/gw_motor.h"

#include "giveway/gw_math.h"
#include "giveway/gw_trikey.h"
#include "giveway/gw_wrench.h"

#if (GW_WITH_CHANNELS == 1)

/* While the observer cannot be trusted it follows the counts so fast, rad/s. */
#define QUICK_RADPS ((gw_real_t)200.0)
/* A wheel that turns more slowly may be stuck, or change its direction. */
#define SLOW_RADPS ((gw_real_t)0.07)
/* The observer is wrong if it is so many counts off. */
#define SURPRISE_COUNTS ((gw_real_t)1.5)
#define SURE_TICKS 30U /* before the observer is trusted again */
#define SHARE_PER_TICK ((gw_real_t)0.03125)
/* A lighter motor would only amplify what is not known. */
#define INERTIA_MIN_KGM2 ((gw_real_t)1.0e-6)
/* Below that of the stiffest drivetrain that is not rigid. */
#define COMPLIANCE_MIN_RAD_PER_NM ((gw_real_t)0.95e-7)
/* Limits of what is kept, beyond any motor's. */
#define RATE_MAX_RADPS ((gw_real_t)1.0e5)
#define UNKNOWN_MAX_RADPS2 ((gw_real_t)1.0e7)
#define SERVO_MAX_RADPS ((gw_real_t)3.5e13) /* the most that counts may move in a tick */
#define COMMAND_MAX_RADPS ((gw_real_t)1.2e6)
#define GAIN_MAX ((gw_real_t)1.0e9)
#define COUNT_RATE_MIN ((gw_real_t)5.0e-5)
#define COUNT_RATE_MAX ((gw_real_t)1.7e4)
#define PERIOD_MIN_S ((gw_real_t)0.0001)
#define PERIOD_MAX_S ((gw_real_t)0.1)
#define COUNT_MIN_RAD ((gw_real_t)6.0e-6)
#define COUNT_MAX_RAD ((gw_real_t)1.6)
#define STIFFNESS_MAX ((gw_real_t)1.1e7)
#define PER_INERTIA_MAX ((gw_real_t)1.1e6)
#define COUNTS_PER_TURN_MIN ((gw_real_t)4.0)
#define COUNTS_PER_TURN_MAX ((gw_real_t)1.0e6)

void gw_motor_config_trikey(gw_motor_config_t *config)
{
    config->inertia_kgm2 = GW_TRIKEY_DRIVETRAIN_MOTOR_INERTIA_KGM2;
    config->coulomb_torque_nm = GW_TRIKEY_DRIVETRAIN_GEAR_COULOMB_NM;
    config->kp_nm_per_rad = GW_TRIKEY_SERVO_KP_NM_PER_RAD;
    config->kd_nms_per_rad = GW_TRIKEY_SERVO_KD_NMS_PER_RAD;
    config->torque_limit_nm = GW_TRIKEY_DRIVETRAIN_TORQUE_LIMIT_NM;
    config->derivative_cutoff_hz = GW_TRIKEY_SERVO_DERIVATIVE_CUTOFF_HZ;
    config->delay_ticks = 3U;
    config->cutoff_radps = (gw_real_t)40.0;
}

void gw_motor_config_none(gw_motor_config_t *config)
{
    gw_motor_config_trikey(config);
    config->inertia_kgm2 = GW_ZERO;
}

void gw_motor_config_check(const gw_motor_config_t *config, gw_config_error_t *error)
{
    gw_config_check_real(error, GW_FIELD_MOTOR_INERTIA, config->inertia_kgm2);
    gw_config_check_real(error, GW_FIELD_MOTOR_COULOMB_TORQUE, config->coulomb_torque_nm);
    gw_config_check_real(error, GW_FIELD_MOTOR_KP, config->kp_nm_per_rad);
    gw_config_check_real(error, GW_FIELD_MOTOR_KD, config->kd_nms_per_rad);
    gw_config_check_real(error, GW_FIELD_MOTOR_TORQUE_LIMIT, config->torque_limit_nm);
    gw_config_check_real(error, GW_FIELD_MOTOR_DERIVATIVE_CUTOFF, config->derivative_cutoff_hz);
    gw_config_check_count(error, GW_FIELD_MOTOR_DELAY, config->delay_ticks);
    gw_config_check_real(error, GW_FIELD_MOTOR_CUTOFF, config->cutoff_radps);
}

/* Of a critically damped observer with three equal poles p = e^(-w T). */
static gw_motor_gains_t gains_of(gw_real_t cutoff_radps, gw_real_t period_s)
{
    const gw_real_t pole = gw_exp(-cutoff_radps * period_s);
    const gw_real_t moved = GW_ONE - pole;
    const gw_real_t per_s = GW_ONE / period_s;
    const gw_motor_gains_t gains = {GW_ONE - ((pole * pole) * pole),
                                    (((gw_real_t)1.5 * (moved * moved)) * (GW_ONE + pole)) * per_s,
                                    (((moved * moved) * moved) * per_s) * per_s};
    return gains;
}

void gw_motor_init(gw_motor_t *motor, const gw_motor_config_t *config, const gw_rate_filter_constants_t *constants,
                   uint32_t encoder_counts)
{
    static const gw_joint_command_t no_command = {0};
    motor->known =
        (config->inertia_kgm2 >= INERTIA_MIN_KGM2) && (constants->compliance_rad_per_nm >= COMPLIANCE_MIN_RAD_PER_NM);
    motor->config = *config;
    motor->period_s = constants->period_s;
    motor->rad_per_count = constants->rad_per_count;
    motor->count_rate = constants->rad_per_count / constants->period_s;
    motor->stiffness_nm_per_rad = motor->known ? (GW_ONE / constants->compliance_rad_per_nm) : GW_ZERO;
    motor->per_inertia = motor->known ? (GW_ONE / config->inertia_kgm2) : GW_ZERO;
    motor->filter_gain =
        -gw_expm1(-(((GW_TWO * GW_PI) * config->derivative_cutoff_hz) * (GW_HALF * constants->period_s)));
    motor->encoder_counts = encoder_counts;
    motor->slow = gains_of(config->cutoff_radps, constants->period_s);
    motor->quick = gains_of(QUICK_RADPS, constants->period_s);
    for (uint32_t k = 0U; k < GW_MOTOR_DELAY_MAX; k++) {
        motor->command[k] = no_command;
    }
    motor->next_command = 0U;
    motor->commands = 0U;
    gw_motor_restart(motor);
}

static bool gains_hold(gw_motor_gains_t gains)
{
    return gw_in_range(gains.angle, GW_ZERO, GW_ONE) && gw_in_range(gains.rate_per_s, GW_ZERO, GAIN_MAX) &&
           gw_in_range(gains.unknown_per_s2, GW_ZERO, GAIN_MAX);
}

static bool wheel_holds(const gw_motor_t *motor, const gw_motor_wheel_t *wheel)
{
    return gw_within(wheel->angle_rad, GW_HALF * motor->rad_per_count) &&
           gw_within(wheel->rate_radps, RATE_MAX_RADPS) && gw_within(wheel->unknown_radps2, UNKNOWN_MAX_RADPS2) &&
           gw_within(wheel->servo_radps, SERVO_MAX_RADPS) && gw_within(wheel->torque_nm, GW_TORQUE_MAX) &&
           (wheel->same_ticks <= GW_MOTOR_SAME_TICKS) && (wheel->sure_ticks <= SURE_TICKS) &&
           gw_in_range(wheel->share, GW_ZERO, GW_ONE);
}

static bool command_holds(const gw_joint_command_t *command)
{
    bool holds = true;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        holds =
            holds && gw_within(command->angle_rad[i], GW_PI) && gw_within(command->speed_radps[i], COMMAND_MAX_RADPS);
    }
    return holds;
}

bool gw_motor_invariant_holds(const gw_motor_t *motor)
{
    bool holds = (motor != NULL);
    if (holds) {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_motor_config_check(&motor->config, &error);
        holds = (error.field == GW_FIELD_NONE) && gw_in_range(motor->period_s, PERIOD_MIN_S, PERIOD_MAX_S) &&
                gw_in_range(motor->rad_per_count, COUNT_MIN_RAD, COUNT_MAX_RAD) &&
                gw_in_range(motor->count_rate, COUNT_RATE_MIN, COUNT_RATE_MAX) &&
                gw_in_range(motor->stiffness_nm_per_rad, GW_ZERO, STIFFNESS_MAX) &&
                gw_in_range(motor->per_inertia, GW_ZERO, PER_INERTIA_MAX) &&
                gw_in_range(motor->filter_gain, GW_ZERO, GW_ONE) &&
                gw_in_range((gw_real_t)motor->encoder_counts, COUNTS_PER_TURN_MIN, COUNTS_PER_TURN_MAX) &&
                gains_hold(motor->slow) && gains_hold(motor->quick) && (motor->next_command < GW_MOTOR_DELAY_MAX) &&
                (motor->commands <= GW_MOTOR_DELAY_MAX);
        for (uint32_t k = 0U; k < GW_MOTOR_DELAY_MAX; k++) {
            holds = holds && command_holds(&motor->command[k]);
        }
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            holds = holds && wheel_holds(motor, &motor->wheel[i]);
        }
    }
    return holds;
}

void gw_motor_restart(gw_motor_t *motor)
{
    static const gw_motor_wheel_t nothing = {0};
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        motor->wheel[i] = nothing;
    }
    motor->started = false;
}

void gw_motor_command(gw_motor_t *motor, const gw_joint_command_t *command, bool enabled)
{
    if (enabled) {
        motor->command[motor->next_command] = *command;
        motor->next_command = (motor->next_command + 1U) % GW_MOTOR_DELAY_MAX;
        motor->commands += (motor->commands < GW_MOTOR_DELAY_MAX) ? 1U : 0U;
    } else {
        motor->commands = 0U;
    }
}

/* Its difference from an angle of less than a turn is less than one and a half. */
static gw_real_t wrapped_once(gw_real_t angle_rad)
{
    gw_real_t wrapped_rad = angle_rad;
    if (angle_rad >= GW_PI) {
        wrapped_rad = angle_rad - (GW_TWO * GW_PI);
    } else if (angle_rad < -GW_PI) {
        wrapped_rad = angle_rad + (GW_TWO * GW_PI);
    } else {
        /* no whole turn to take off */
    }
    return wrapped_rad;
}

/* Torque of the servo, the mean of its two ticks since the last sample, in which the wheel turned by so many counts. */
static gw_real_t servo_torque(const gw_motor_t *motor, gw_motor_wheel_t *wheel, gw_real_t angle_rad,
                              gw_real_t speed_radps, gw_real_t counts)
{
    const gw_real_t kp = motor->config.kp_nm_per_rad;
    const gw_real_t kd = motor->config.kd_nms_per_rad;
    const gw_real_t limit_nm = motor->config.torque_limit_nm;
    const gw_real_t gain = motor->filter_gain;
    const gw_real_t rate_radps = counts * motor->count_rate;
    const int32_t within_turn = wheel->count % (int32_t)motor->encoder_counts;
    const gw_real_t first_rad = wrapped_once(angle_rad - ((gw_real_t)within_turn * motor->rad_per_count));
    const gw_real_t second_rad = first_rad + ((GW_HALF * motor->period_s) * (speed_radps - rate_radps));
    const gw_real_t first_radps = wheel->servo_radps;
    const gw_real_t second_radps = first_radps + (gain * (rate_radps - first_radps));
    const gw_real_t first_nm = (kp * first_rad) + (kd * (speed_radps - first_radps));
    const gw_real_t second_nm = (kp * second_rad) + (kd * (speed_radps - second_radps));
    wheel->servo_radps = gw_known_within(second_radps + (gain * (rate_radps - second_radps)), SERVO_MAX_RADPS);
    return GW_HALF * (gw_limited(first_nm, limit_nm) + gw_limited(second_nm, limit_nm));
}

/* One wheel: the observer's prediction, and its correction by the count. */
static void observe(const gw_motor_t *motor, gw_motor_wheel_t *wheel, gw_real_t motor_nm, gw_real_t torque_nm,
                    gw_real_t turned_rad)
{
    const gw_real_t period_s = motor->period_s;
    const gw_real_t rate_radps = wheel->rate_radps;
    const gw_real_t unknown_radps2 = wheel->unknown_radps2;
    const gw_real_t sliding = gw_limited(rate_radps * (GW_ONE / SLOW_RADPS), GW_ONE);
    const gw_real_t sensed_nm = GW_HALF * (wheel->torque_nm + torque_nm);
    const gw_real_t net_nm = (motor_nm - (motor->config.coulomb_torque_nm * sliding)) - sensed_nm;
    const gw_real_t gained_radps = period_s * ((net_nm * motor->per_inertia) + unknown_radps2);
    const gw_real_t angle_rad = (wheel->angle_rad + (period_s * (rate_radps + (GW_HALF * gained_radps)))) - turned_rad;
    const bool surprised = gw_magnitude(angle_rad) > (SURPRISE_COUNTS * motor->rad_per_count);
    const bool slow = gw_magnitude(rate_radps) < SLOW_RADPS;
    if (surprised || slow) {
        wheel->sure_ticks = 0U;
    } else if (wheel->sure_ticks < SURE_TICKS) {
        wheel->sure_ticks++;
    } else {
        /* it is trusted */
    }
    const bool trusted = wheel->sure_ticks >= SURE_TICKS;
    const gw_motor_gains_t *const gains = trusted ? &motor->slow : &motor->quick;
    const gw_real_t corrected_radps = (rate_radps + gained_radps) - (gains->rate_per_s * angle_rad);
    wheel->unknown_radps2 = gw_limited(unknown_radps2 - (gains->unknown_per_s2 * angle_rad), UNKNOWN_MAX_RADPS2);
    wheel->angle_rad = gw_limited(angle_rad * (GW_ONE - gains->angle), GW_HALF * motor->rad_per_count);
    wheel->rate_radps = gw_limited(corrected_radps, RATE_MAX_RADPS);
    wheel->share = gw_clamp(wheel->share + (trusted ? SHARE_PER_TICK : -SHARE_PER_TICK), GW_ZERO, GW_ONE);
}

static void note_moved(gw_motor_wheel_t *wheel, int32_t moved)
{
    if (moved != wheel->moved) {
        wheel->same_ticks = 0U;
    } else if (wheel->same_ticks < GW_MOTOR_SAME_TICKS) {
        wheel->same_ticks++;
    } else {
        /* as before */
    }
    wheel->moved = moved;
}

/* Variance of what is left of the counts' errors, over that without the observer. One wheel's is all along its rolling
 * direction: there it is two thirds of that of three wheels that err independently. */
static gw_real_t left_of_counts(const gw_motor_t *motor)
{
    static const gw_real_t jump_alike[GW_WHEEL_COUNT + 1U] = {GW_ZERO, (gw_real_t)0.35, GW_ONE, GW_ONE};
    gw_real_t counted = GW_ZERO;
    uint32_t alike = 0U;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        const gw_motor_wheel_t *const wheel = &motor->wheel[i];
        counted += GW_ONE - wheel->share;
        alike += ((wheel->same_ticks >= GW_MOTOR_SAME_TICKS) && (wheel->share > GW_ZERO)) ? 1U : 0U;
    }
    return gw_min(GW_TWO_PER_WHEEL * counted, GW_ONE) + jump_alike[alike];
}

gw_wheels_t gw_motor_step(gw_motor_t *motor, const int32_t encoder_count[GW_WHEEL_COUNT], const gw_wheels_t *torque_nm,
                          gw_real_t *counted)
{
    /* cppcheck-suppress misra-c2012-9.3 ; DEV-01 a whole struct behind a pointer */
    gw_wheels_t twist_nm = *torque_nm;
    *counted = GW_ZERO;
    if (motor->known) {
        const bool follows = motor->commands >= motor->config.delay_ticks;
        const uint32_t at =
            ((motor->next_command + GW_MOTOR_DELAY_MAX) - motor->config.delay_ticks) % GW_MOTOR_DELAY_MAX;
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            gw_motor_wheel_t *const wheel = &motor->wheel[i];
            if (motor->started && follows) {
                const int32_t moved = gw_count_difference(encoder_count[i], wheel->count);
                const gw_real_t counts = (gw_real_t)moved;
                note_moved(wheel, moved);
                const gw_real_t motor_nm = servo_torque(motor, wheel, motor->command[at].angle_rad[i],
                                                        motor->command[at].speed_radps[i], counts);
                observe(motor, wheel, motor_nm, torque_nm->wheel[i], counts * motor->rad_per_count);
                const gw_real_t beyond_nm = (motor->stiffness_nm_per_rad * wheel->share) * wheel->angle_rad;
                twist_nm.wheel[i] = gw_limited(torque_nm->wheel[i] - beyond_nm, GW_TORQUE_MAX);
            } else {
                /* What was trusted before is not known to be so any longer. */
                wheel->share = GW_ZERO;
                wheel->sure_ticks = 0U;
            }
            wheel->count = encoder_count[i];
            wheel->torque_nm = torque_nm->wheel[i];
        }
        motor->started = true;
        *counted = left_of_counts(motor);
    }
    return twist_nm;
}

#endif
