#include "giveway/gw_reference.h"

#include "giveway/gw_math.h"
#include "giveway/gw_trikey.h"

#define SPEED_MAX ((gw_real_t)100.0)
#define YAW_RATE_MAX ((gw_real_t)1000.0)
/* A reference that comes this far from the origin stops there. */
#define REFERENCE_MAX ((gw_real_t)1.0e5)
/* Correction speeds, m/s and rad/s, up to which the reference counts as being on the plan. */
#define CORRECTION_FREE ((gw_real_t)0.001)
#define YAW_CORRECTION_FREE ((gw_real_t)0.005)

void gw_reference_config_trikey(gw_reference_config_t *config)
{
    config->follow_gain_per_s = GW_TWO;
    config->speed_limit_mps = GW_TRIKEY_ADMITTANCE_SPEED_LIMIT_MPS;
    config->acceleration_limit_mps2 = (gw_real_t)1.5;
    config->yaw_rate_limit_radps = (gw_real_t)1.5;
    config->yaw_acceleration_limit_radps2 = (gw_real_t)6.0;
    config->rejoin_speed_mps = (gw_real_t)0.1;
    config->finish_speed_mps = (gw_real_t)0.01;
}

void gw_reference_config_check(const gw_reference_config_t *config, gw_real_t period_s, gw_config_error_t *error)
{
    gw_config_check_real(error, GW_FIELD_CONTROLLER_PERIOD, period_s);
    gw_config_check_real(error, GW_FIELD_REFERENCE_FOLLOW_GAIN, config->follow_gain_per_s);
    gw_config_check_real(error, GW_FIELD_REFERENCE_SPEED_LIMIT, config->speed_limit_mps);
    gw_config_check_real(error, GW_FIELD_REFERENCE_ACCELERATION_LIMIT, config->acceleration_limit_mps2);
    gw_config_check_real(error, GW_FIELD_REFERENCE_YAW_RATE_LIMIT, config->yaw_rate_limit_radps);
    gw_config_check_real(error, GW_FIELD_REFERENCE_YAW_ACCELERATION_LIMIT, config->yaw_acceleration_limit_radps2);
    gw_config_check_real(error, GW_FIELD_REFERENCE_REJOIN_SPEED, config->rejoin_speed_mps);
    gw_config_check_real(error, GW_FIELD_REFERENCE_FINISH_SPEED, config->finish_speed_mps);
    if (error->field == GW_FIELD_NONE) {
        /* A correction of more than half the distance per tick would overshoot. */
        gw_config_check_relation(error, GW_FIELD_REFERENCE_FOLLOW_GAIN, 0U, config->follow_gain_per_s, GW_ZERO,
                                 GW_HALF / period_s);
    }
}

#if (GW_WITH_ESCAPE == 1)
static void init_tip(gw_reference_t *reference)
{
    gw_tip_none(&reference->tip);
}

static bool tip_holds(const gw_reference_t *reference)
{
    return gw_tip_invariant_holds(&reference->tip);
}

void gw_reference_set_tip(gw_reference_t *reference, const gw_tip_t *tip)
{
    reference->tip = *tip;
}

/* The largest acceleration along a vector in the world frame, while a path is rejoined. */
static gw_real_t rejoining_limit(const gw_reference_t *reference, gw_vector_t vector)
{
    const gw_vector_t unit = gw_unit(vector.x, vector.y, gw_length(vector));
    return gw_tip_along(&reference->tip, gw_rotate_back(reference->yaw, unit),
                        reference->config.acceleration_limit_mps2);
}
#else
static void init_tip(const gw_reference_t *reference)
{
    (void)reference;
}

static bool tip_holds(const gw_reference_t *reference)
{
    (void)reference;
    return true;
}

static gw_real_t rejoining_limit(const gw_reference_t *reference, gw_vector_t vector)
{
    (void)vector;
    return reference->config.acceleration_limit_mps2;
}
#endif

gw_status_t gw_reference_init(gw_reference_t *reference, const gw_reference_config_t *config, gw_real_t period_s)
{
    static const gw_plan_t origin = {0};
    gw_status_t status = GW_STATUS_OK;
    if ((reference == NULL) || (config == NULL)) {
        status = GW_STATUS_NULL_POINTER;
    } else {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_reference_config_check(config, period_s, &error);
        reference->initialised = (error.field == GW_FIELD_NONE);
        if (reference->initialised) {
            reference->config = *config;
            reference->period_s = period_s;
            init_tip(reference);
            gw_reference_place(reference, &origin, false);
        } else {
            status = GW_STATUS_CONFIG_INVALID;
        }
    }
    return status;
}

bool gw_reference_invariant_holds(const gw_reference_t *reference)
{
    bool holds = (reference != NULL);
    if (holds) {
        holds = reference->initialised;
    }
    if (holds) {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_reference_config_check(&reference->config, reference->period_s, &error);
        holds = (error.field == GW_FIELD_NONE) && gw_sum_invariant_holds(reference->x_m) &&
                gw_sum_invariant_holds(reference->y_m) && gw_sum_invariant_holds(reference->theta_rad) &&
                gw_within(reference->theta_rad.value, GW_PI) && gw_within(reference->twist.vx_mps, SPEED_MAX) &&
                gw_within(reference->twist.vy_mps, SPEED_MAX) &&
                gw_within(reference->twist.omega_radps, YAW_RATE_MAX) &&
                gw_is_finite(reference->acceleration.ax_mps2) && gw_is_finite(reference->acceleration.ay_mps2) &&
                gw_is_finite(reference->acceleration.alpha_radps2) && gw_within(reference->yaw.cosine, GW_ONE) &&
                gw_within(reference->yaw.sine, GW_ONE) && tip_holds(reference);
    }
    return holds;
}

static void stand(gw_reference_t *reference)
{
    reference->twist.vx_mps = GW_ZERO;
    reference->twist.vy_mps = GW_ZERO;
    reference->twist.omega_radps = GW_ZERO;
    reference->acceleration.ax_mps2 = GW_ZERO;
    reference->acceleration.ay_mps2 = GW_ZERO;
    reference->acceleration.alpha_radps2 = GW_ZERO;
    reference->displacement.x_m = GW_ZERO;
    reference->displacement.y_m = GW_ZERO;
    reference->displacement.theta_rad = GW_ZERO;
}

void gw_reference_place(gw_reference_t *reference, const gw_plan_t *plan, bool moving)
{
    stand(reference);
    reference->x_m = gw_sum_of(plan->pose.x_m);
    reference->y_m = gw_sum_of(plan->pose.y_m);
    reference->theta_rad = gw_sum_of(gw_wrap_angle(plan->pose.theta_rad));
    reference->yaw = gw_sincos(reference->theta_rad.value);
    if (moving) {
        const gw_vector_t planned = {plan->twist.vx_mps, plan->twist.vy_mps};
        const gw_vector_t velocity = gw_limit_length(planned, reference->config.speed_limit_mps);
        reference->twist.vx_mps = velocity.x;
        reference->twist.vy_mps = velocity.y;
        reference->twist.omega_radps = gw_clamp(plan->twist.omega_radps, -reference->config.yaw_rate_limit_radps,
                                                reference->config.yaw_rate_limit_radps);
        reference->acceleration = plan->acceleration;
    }
}

/* One tick towards these planar and yaw speeds, within the limits. The acceleration is that of the plan where the
 * plan is being followed freely (planned not NULL), else that of the step. */
static void move_planar(gw_reference_t *reference, gw_vector_t wanted_mps, gw_real_t limit_mps2,
                        const gw_acceleration_t *planned)
{
    const gw_real_t most = limit_mps2 * reference->period_s;
    const gw_vector_t change = {wanted_mps.x - reference->twist.vx_mps, wanted_mps.y - reference->twist.vy_mps};
    const gw_vector_t allowed = gw_limit_length(change, most);
    const gw_real_t half_s = GW_HALF * reference->period_s;
    const gw_vector_t velocity = {gw_limited(reference->twist.vx_mps + allowed.x, SPEED_MAX),
                                  gw_limited(reference->twist.vy_mps + allowed.y, SPEED_MAX)};
    if ((planned != NULL) && (gw_length(change) <= most)) {
        reference->acceleration.ax_mps2 = planned->ax_mps2;
        reference->acceleration.ay_mps2 = planned->ay_mps2;
    } else {
        reference->acceleration.ax_mps2 = allowed.x / reference->period_s;
        reference->acceleration.ay_mps2 = allowed.y / reference->period_s;
    }
    reference->displacement.x_m = half_s * (reference->twist.vx_mps + velocity.x);
    reference->displacement.y_m = half_s * (reference->twist.vy_mps + velocity.y);
    reference->twist.vx_mps = velocity.x;
    reference->twist.vy_mps = velocity.y;
}

static void move_yaw(gw_reference_t *reference, gw_real_t wanted_radps, const gw_acceleration_t *planned)
{
    const gw_real_t most = reference->config.yaw_acceleration_limit_radps2 * reference->period_s;
    const gw_real_t change = wanted_radps - reference->twist.omega_radps;
    const gw_real_t allowed = gw_limited(change, most);
    const gw_real_t omega = gw_limited(reference->twist.omega_radps + allowed, YAW_RATE_MAX);
    if ((planned != NULL) && gw_within(change, most)) {
        reference->acceleration.alpha_radps2 = planned->alpha_radps2;
    } else {
        reference->acceleration.alpha_radps2 = allowed / reference->period_s;
    }
    reference->displacement.theta_rad = (GW_HALF * reference->period_s) * (reference->twist.omega_radps + omega);
    reference->twist.omega_radps = omega;
}

static void add_displacement(gw_reference_t *reference)
{
    reference->x_m = gw_sum_limit(gw_sum_add(reference->x_m, reference->displacement.x_m), REFERENCE_MAX);
    reference->y_m = gw_sum_limit(gw_sum_add(reference->y_m, reference->displacement.y_m), REFERENCE_MAX);
    reference->theta_rad = gw_sum_add_angle(reference->theta_rad, reference->displacement.theta_rad);
    reference->yaw = gw_sincos(reference->theta_rad.value);
}

/* Speed towards the path when rejoining: not below the finish speed, but such that half the acceleration can stop it
 * there. */
static gw_real_t rejoining_speed(const gw_reference_t *reference, gw_real_t distance, gw_real_t finish_speed,
                                 gw_real_t acceleration)
{
    return gw_min(gw_max(reference->config.follow_gain_per_s * distance, finish_speed),
                  gw_braking_speed(GW_HALF * acceleration, reference->period_s, distance));
}

void gw_reference_follow(gw_reference_t *reference, const gw_plan_t *plan, bool rejoining)
{
    const gw_reference_config_t *const config = &reference->config;
    const gw_real_t half_s = GW_HALF * reference->period_s;
    const gw_vector_t planned = {rejoining ? GW_ZERO : plan->twist.vx_mps, rejoining ? GW_ZERO : plan->twist.vy_mps};
    const gw_real_t planned_omega = rejoining ? GW_ZERO : plan->twist.omega_radps;
    const gw_real_t speed_limit = rejoining ? config->rejoin_speed_mps : config->speed_limit_mps;
    /* Where the reference will be after this tick at the planned velocity; a smooth plan leaves no error. */
    const gw_vector_t error = {
        gw_sum_subtract_from(plan->pose.x_m, reference->x_m) - (half_s * (reference->twist.vx_mps + planned.x)),
        gw_sum_subtract_from(plan->pose.y_m, reference->y_m) - (half_s * (reference->twist.vy_mps + planned.y))};
    const gw_real_t yaw_error = gw_wrap_angle(gw_sum_subtract_from(plan->pose.theta_rad, reference->theta_rad) -
                                              (half_s * (reference->twist.omega_radps + planned_omega)));
    gw_vector_t wanted = {planned.x + (config->follow_gain_per_s * error.x),
                          planned.y + (config->follow_gain_per_s * error.y)};
    gw_real_t wanted_omega = planned_omega + (config->follow_gain_per_s * yaw_error);
    gw_real_t limit_mps2 = config->acceleration_limit_mps2;
    if (rejoining) {
        const gw_real_t distance_m = gw_length(error);
        const gw_vector_t back = {-error.x, -error.y};
        const gw_real_t speed =
            rejoining_speed(reference, distance_m, config->finish_speed_mps, rejoining_limit(reference, back));
        const gw_real_t finish_rate =
            config->finish_speed_mps * (config->yaw_rate_limit_radps / config->speed_limit_mps);
        const gw_real_t rate =
            rejoining_speed(reference, gw_abs(yaw_error), finish_rate, config->yaw_acceleration_limit_radps2);
        if (distance_m > GW_ZERO) {
            wanted.x = gw_fraction(error.x, distance_m) * speed;
            wanted.y = gw_fraction(error.y, distance_m) * speed;
        }
        wanted_omega = (yaw_error < GW_ZERO) ? -rate : rate;
        const gw_vector_t change = {wanted.x - reference->twist.vx_mps, wanted.y - reference->twist.vy_mps};
        limit_mps2 = rejoining_limit(reference, change);
    }
    /* A correction that matters is not part of the planned acceleration. */
    const bool on_plan = (!rejoining) && ((config->follow_gain_per_s * gw_length(error)) <= CORRECTION_FREE);
    const bool on_yaw = (!rejoining) && ((config->follow_gain_per_s * gw_abs(yaw_error)) <= YAW_CORRECTION_FREE);
    move_planar(reference, gw_limit_length(wanted, speed_limit), limit_mps2, on_plan ? &plan->acceleration : NULL);
    move_yaw(reference, gw_clamp(wanted_omega, -config->yaw_rate_limit_radps, config->yaw_rate_limit_radps),
             on_yaw ? &plan->acceleration : NULL);
    add_displacement(reference);
}

void gw_reference_escape(gw_reference_t *reference, gw_vector_t displacement_m, gw_vector_t velocity_mps)
{
    reference->acceleration.ax_mps2 = (velocity_mps.x - reference->twist.vx_mps) / reference->period_s;
    reference->acceleration.ay_mps2 = (velocity_mps.y - reference->twist.vy_mps) / reference->period_s;
    reference->twist.vx_mps = velocity_mps.x;
    reference->twist.vy_mps = velocity_mps.y;
    reference->displacement.x_m = displacement_m.x;
    reference->displacement.y_m = displacement_m.y;
    move_yaw(reference, GW_ZERO, NULL);
    add_displacement(reference);
}

void gw_reference_brake(gw_reference_t *reference)
{
    const gw_vector_t zero = {GW_ZERO, GW_ZERO};
    move_planar(reference, zero, reference->config.acceleration_limit_mps2, NULL);
    move_yaw(reference, GW_ZERO, NULL);
    add_displacement(reference);
}

void gw_reference_freeze(gw_reference_t *reference)
{
    stand(reference);
}
