#include "giveway/gw_admittance.h"

#include "giveway/gw_math.h"
#include "giveway/gw_trikey.h"
#include "giveway/gw_wrench.h"

#define SPEED_MAX ((gw_real_t)100.0)
#define UNIT_MAX ((gw_real_t)1.01)    /* a component of a unit vector, rounded */
#define LEAST_AGREEMENT GW_HALF       /* 60 degrees */
#define STILL_MPS ((gw_real_t)1.0e-5) /* what nobody sees of a low-pass */
/* A shorter time constant, s, takes over all of the velocity in a tick, too. */
#define SMOOTHING_MIN_S ((gw_real_t)1.0e-6)
/* Of one tick, and of an escape: the longest period and the largest impulse over the smallest damping, with room. */
#define DISPLACEMENT_MAX ((gw_real_t)100.0)
#define ESCAPE_MAX ((gw_real_t)1.1e5)

static gw_vector_t limit_components(gw_vector_t vector, gw_real_t limit)
{
    const gw_vector_t result = {gw_limited(vector.x, limit), gw_limited(vector.y, limit)};
    return result;
}

/* Likewise for one that is known to be within the limit. */
static gw_vector_t known_within(gw_vector_t vector, gw_real_t limit)
{
    const gw_vector_t result = {gw_known_within(vector.x, limit), gw_known_within(vector.y, limit)};
    return result;
}

static gw_vector_t ahead_of(const gw_admittance_t *admittance)
{
    const gw_vector_t ahead = {gw_sum_subtract_from(admittance->goal_m.x, admittance->moved_x_m),
                               gw_sum_subtract_from(admittance->goal_m.y, admittance->moved_y_m)};
    return ahead;
}

#if (GW_WITH_ESCAPE == 1)
static void set_no_escape(gw_admittance_config_t *config)
{
    config->smoothing_s = GW_ZERO;
    config->brake_limit_mps2 = GW_ZERO;
    config->lead_s = GW_ZERO;
    config->push_share = GW_ZERO;
    config->ahead_mps = GW_ZERO;
    gw_tip_config_trikey(&config->tip);
}

static void check_escape(const gw_admittance_config_t *config, gw_config_error_t *error)
{
    gw_config_check_real(error, GW_FIELD_ADMITTANCE_SMOOTHING, config->smoothing_s);
    gw_config_check_real(error, GW_FIELD_ADMITTANCE_BRAKE_LIMIT, config->brake_limit_mps2);
    gw_config_check_real(error, GW_FIELD_ADMITTANCE_LEAD, config->lead_s);
    gw_config_check_real(error, GW_FIELD_ADMITTANCE_PUSH_SHARE, config->push_share);
    gw_config_check_real(error, GW_FIELD_ADMITTANCE_AHEAD, config->ahead_mps);
    gw_tip_config_check(&config->tip, error);
}

static void set_velocity(gw_admittance_t *admittance, gw_vector_t velocity_mps)
{
    admittance->velocity_mps = velocity_mps;
    for (uint32_t i = 0U; i < GW_SMOOTH_COUNT; i++) {
        admittance->smooth_mps[i] = velocity_mps;
    }
}

static void init_escape(gw_admittance_t *admittance)
{
    const gw_vector_t zero = {GW_ZERO, GW_ZERO};
    const gw_real_t smoothing_s = admittance->config.smoothing_s;
    admittance->away = zero;
    admittance->first = zero;
    admittance->smooth_share =
        (smoothing_s > GW_ZERO) ? -gw_expm1(-admittance->period_s / gw_max(smoothing_s, SMOOTHING_MIN_S)) : GW_ONE;
    gw_tip_none(&admittance->tip);
    admittance->yaw = gw_sincos(GW_ZERO);
}

static bool escape_holds(const gw_admittance_t *admittance)
{
    bool holds = gw_tip_invariant_holds(&admittance->tip) && gw_within(admittance->yaw.cosine, GW_ONE) &&
                 gw_within(admittance->yaw.sine, GW_ONE) && gw_within(admittance->away.x, GW_TWO) &&
                 gw_within(admittance->away.y, GW_TWO) && gw_within(admittance->first.x, GW_TWO) &&
                 gw_within(admittance->first.y, GW_TWO) && gw_in_range(admittance->smooth_share, GW_ZERO, GW_ONE);
    for (uint32_t i = 0U; i < GW_SMOOTH_COUNT; i++) {
        holds = holds && gw_within(admittance->smooth_mps[i].x, SPEED_MAX) &&
                gw_within(admittance->smooth_mps[i].y, SPEED_MAX);
    }
    return holds;
}

void gw_admittance_set_tip(gw_admittance_t *admittance, const gw_tip_t *tip)
{
    admittance->tip = *tip;
}

void gw_admittance_face(gw_admittance_t *admittance, gw_rotation_t yaw)
{
    admittance->yaw = yaw;
}

static bool is_escape(const gw_admittance_t *admittance)
{
    return admittance->config.kind == GW_ADMITTANCE_ESCAPE;
}

static void point_away(gw_admittance_t *admittance, gw_vector_t direction)
{
    admittance->away = direction;
}

static void remember_start(gw_admittance_t *admittance)
{
    admittance->first = admittance->away;
}

/* Does a direction agree with that of the start? For a robot that may lean any does: the push that tips it is felt
 * later than what its body does meanwhile. */
static bool agrees(const gw_admittance_t *admittance, gw_vector_t direction)
{
    return (admittance->tip.margin_mps2 > GW_ZERO) || (gw_along(direction, admittance->first) >= LEAST_AGREEMENT);
}

/* The share of a change of velocity that lifts no wheel. */
static gw_real_t share_without_tipping(const gw_admittance_t *admittance, gw_vector_t change_mps)
{
    return gw_tip_share(&admittance->tip, gw_rotate_back(admittance->yaw, change_mps), admittance->period_s);
}

/* The largest acceleration along a unit vector. */
static gw_real_t limit_without_tipping(const gw_admittance_t *admittance, gw_vector_t unit)
{
    return gw_tip_along(&admittance->tip, gw_rotate_back(admittance->yaw, unit),
                        admittance->config.acceleration_limit_mps2);
}

static gw_real_t along_away(const gw_admittance_t *admittance, gw_vector_t vector)
{
    return gw_along(vector, admittance->away);
}

GW_SMALL static void add_velocity(gw_vector_t *velocity_mps, gw_vector_t direction, gw_real_t change_mps)
{
    velocity_mps->x = gw_limited(velocity_mps->x + (change_mps * direction.x), SPEED_MAX);
    velocity_mps->y = gw_limited(velocity_mps->y + (change_mps * direction.y), SPEED_MAX);
}

/* Lets no velocity of the escape be less than this along a unit vector. */
static void hold_above(gw_admittance_t *admittance, gw_vector_t unit, gw_real_t least_mps)
{
    add_velocity(&admittance->velocity_mps, unit,
                 gw_max(least_mps - gw_along(admittance->velocity_mps, unit), GW_ZERO));
    for (uint32_t i = 0U; i < GW_SMOOTH_COUNT; i++) {
        add_velocity(&admittance->smooth_mps[i], unit,
                     gw_max(least_mps - gw_along(admittance->smooth_mps[i], unit), GW_ZERO));
    }
}

/* The velocity is not led further against the push than it is. */
static void follow_direction(gw_admittance_t *admittance)
{
    const gw_real_t now_mps = along_away(admittance, admittance->smooth_mps[GW_SMOOTH_COUNT - 1U]);
    hold_above(admittance, admittance->away, gw_min(now_mps, GW_ZERO));
}

/* Before a tick of the escape: a goal that was passed is moved on, there is no way back to it. */
static void move_goal(gw_admittance_t *admittance)
{
    const gw_real_t past_m = gw_min(along_away(admittance, ahead_of(admittance)), GW_ZERO);
    admittance->goal_m.x = gw_limited(admittance->goal_m.x - (past_m * admittance->away.x), ESCAPE_MAX);
    admittance->goal_m.y = gw_limited(admittance->goal_m.y - (past_m * admittance->away.y), ESCAPE_MAX);
}

/* After a tick of the escape: what the low-passes leave of its velocity. */
static gw_admittance_output_t smoothed(gw_admittance_t *admittance)
{
    gw_admittance_output_t next;
    gw_vector_t behind = admittance->velocity_mps;
    const gw_vector_t before = admittance->smooth_mps[GW_SMOOTH_COUNT - 1U];
    const gw_real_t half_s = GW_HALF * admittance->period_s;
    for (uint32_t i = 0U; i < GW_SMOOTH_COUNT; i++) {
        gw_vector_t *const smooth_mps = &admittance->smooth_mps[i];
        smooth_mps->x = gw_limited(smooth_mps->x + (admittance->smooth_share * (behind.x - smooth_mps->x)), SPEED_MAX);
        smooth_mps->y = gw_limited(smooth_mps->y + (admittance->smooth_share * (behind.y - smooth_mps->y)), SPEED_MAX);
        behind = *smooth_mps;
    }
    if ((gw_length(admittance->velocity_mps) <= GW_ZERO) && (gw_length(behind) < STILL_MPS)) {
        set_velocity(admittance, admittance->velocity_mps);
        behind = admittance->velocity_mps;
    }
    next.velocity_mps = behind;
    next.displacement_m.x = half_s * (before.x + behind.x);
    next.displacement_m.y = half_s * (before.y + behind.y);
    return next;
}

void gw_admittance_brake(gw_admittance_t *admittance)
{
    const gw_real_t towards_mps = -along_away(admittance, admittance->smooth_mps[GW_SMOOTH_COUNT - 1U]);
    if (is_escape(admittance) && (towards_mps > GW_ZERO)) {
        const gw_real_t change_mps = gw_min(admittance->config.brake_limit_mps2 * admittance->period_s, towards_mps);
        add_velocity(&admittance->velocity_mps, admittance->away, change_mps);
        for (uint32_t i = 0U; i < GW_SMOOTH_COUNT; i++) {
            add_velocity(&admittance->smooth_mps[i], admittance->away, change_mps);
        }
    }
}

/* Past the first low-pass, at most to the speed of (2). */
static void accelerate(gw_admittance_t *admittance, gw_real_t push_mps2)
{
    const gw_admittance_config_t *const config = &admittance->config;
    const gw_real_t goal_mps =
        gw_min(admittance->rate_per_s * along_away(admittance, ahead_of(admittance)), config->speed_limit_mps);
    const gw_real_t left_mps = gw_max(goal_mps - along_away(admittance, admittance->smooth_mps[0]), GW_ZERO);
    const gw_real_t change_mps =
        gw_min(gw_min(push_mps2, config->acceleration_limit_mps2) * admittance->period_s, left_mps);
    add_velocity(&admittance->velocity_mps, admittance->away, change_mps);
    for (uint32_t i = 0U; i < (GW_SMOOTH_COUNT - 1U); i++) {
        add_velocity(&admittance->smooth_mps[i], admittance->away, change_mps);
    }
}

/* At most this much faster than the robot, which may still move towards the push. It may be far ahead: what slows it
 * down to that is limited, as a step of the velocity would be one of the motors' torque. */
static void wait_for(gw_admittance_t *admittance, gw_vector_t robot_mps)
{
    const gw_admittance_config_t *const config = &admittance->config;
    const gw_real_t asked_mps = gw_max(along_away(admittance, robot_mps), GW_ZERO) + config->ahead_mps;
    const gw_real_t now_mps = along_away(admittance, admittance->smooth_mps[GW_SMOOTH_COUNT - 1U]);
    const gw_real_t most_mps = gw_max(asked_mps, now_mps - (config->brake_limit_mps2 * admittance->period_s));
    const gw_vector_t back = {-admittance->away.x, -admittance->away.y};
    hold_above(admittance, back, -most_mps);
}

void gw_admittance_yield(gw_admittance_t *admittance, gw_vector_t force_n, gw_real_t floor_n, gw_real_t mass_kg,
                         gw_vector_t robot_mps)
{
    if (is_escape(admittance)) {
        const gw_admittance_config_t *const config = &admittance->config;
        const gw_real_t above_n = along_away(admittance, gw_rotate(admittance->yaw, force_n)) - floor_n;
        if (above_n > GW_ZERO) {
            accelerate(admittance, (config->push_share * above_n) / mass_kg);
        } else if (config->ahead_mps > GW_ZERO) {
            wait_for(admittance, gw_rotate(admittance->yaw, robot_mps));
        } else {
            /* it may be as fast as it likes */
        }
    }
}
#else
static void set_no_escape(const gw_admittance_config_t *config)
{
    (void)config;
}

static void check_escape(const gw_admittance_config_t *config, const gw_config_error_t *error)
{
    (void)config;
    (void)error;
}

static void set_velocity(gw_admittance_t *admittance, gw_vector_t velocity_mps)
{
    admittance->velocity_mps = velocity_mps;
}

static void init_escape(const gw_admittance_t *admittance)
{
    (void)admittance;
}

static bool escape_holds(const gw_admittance_t *admittance)
{
    (void)admittance;
    return true;
}

static bool is_escape(const gw_admittance_t *admittance)
{
    (void)admittance;
    return false;
}

static void point_away(const gw_admittance_t *admittance, gw_vector_t direction)
{
    (void)admittance;
    (void)direction;
}

static void remember_start(const gw_admittance_t *admittance)
{
    (void)admittance;
}

static bool agrees(const gw_admittance_t *admittance, gw_vector_t direction)
{
    (void)admittance;
    (void)direction;
    return false;
}

static gw_real_t share_without_tipping(const gw_admittance_t *admittance, gw_vector_t change_mps)
{
    (void)admittance;
    (void)change_mps;
    return GW_ONE;
}

static gw_real_t limit_without_tipping(const gw_admittance_t *admittance, gw_vector_t unit)
{
    (void)unit;
    return admittance->config.acceleration_limit_mps2;
}

static void follow_direction(const gw_admittance_t *admittance)
{
    (void)admittance;
}

static void move_goal(const gw_admittance_t *admittance)
{
    (void)admittance;
}

static gw_admittance_output_t smoothed(const gw_admittance_t *admittance)
{
    static const gw_admittance_output_t still = {0};
    (void)admittance;
    return still;
}
#endif

void gw_admittance_config_trikey(gw_admittance_config_t *config)
{
    config->kind = GW_ADMITTANCE_FROZEN_IMPULSE;
    config->mass_kg = GW_TRIKEY_ADMITTANCE_MASS_KG;
    config->damping_newton_s_per_m = GW_TRIKEY_ADMITTANCE_DAMPING_NEWTON_S_PER_M;
    config->escape_impulse_newton_s = GW_TRIKEY_ADMITTANCE_ESCAPE_IMPULSE_NEWTON_S;
    config->speed_limit_mps = GW_TRIKEY_ADMITTANCE_SPEED_LIMIT_MPS;
    config->acceleration_limit_mps2 = GW_TRIKEY_ADMITTANCE_ACCELERATION_LIMIT_MPS2;
    config->finish_speed_mps = (gw_real_t)0.01;
    set_no_escape(config);
}

void gw_admittance_config_check(const gw_admittance_config_t *config, gw_config_error_t *error)
{
    gw_config_check_count(error, GW_FIELD_ADMITTANCE_KIND, config->kind);
    gw_config_check_real(error, GW_FIELD_ADMITTANCE_MASS, config->mass_kg);
    gw_config_check_real(error, GW_FIELD_ADMITTANCE_DAMPING, config->damping_newton_s_per_m);
    gw_config_check_real(error, GW_FIELD_ADMITTANCE_ESCAPE_IMPULSE, config->escape_impulse_newton_s);
    gw_config_check_real(error, GW_FIELD_ADMITTANCE_SPEED_LIMIT, config->speed_limit_mps);
    gw_config_check_real(error, GW_FIELD_ADMITTANCE_ACCELERATION_LIMIT, config->acceleration_limit_mps2);
    gw_config_check_real(error, GW_FIELD_ADMITTANCE_FINISH_SPEED, config->finish_speed_mps);
    check_escape(config, error);
}

gw_status_t gw_admittance_init(gw_admittance_t *admittance, const gw_admittance_config_t *config, gw_real_t period_s)
{
    const gw_vector_t zero = {GW_ZERO, GW_ZERO};
    gw_status_t status = GW_STATUS_OK;
    if ((admittance == NULL) || (config == NULL)) {
        status = GW_STATUS_NULL_POINTER;
    } else {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_config_check_real(&error, GW_FIELD_CONTROLLER_PERIOD, period_s);
        gw_admittance_config_check(config, &error);
        admittance->initialised = (error.field == GW_FIELD_NONE);
        if (admittance->initialised) {
            admittance->config = *config;
            admittance->period_s = period_s;
            admittance->rate_per_s = config->damping_newton_s_per_m / config->mass_kg;
            admittance->decay = gw_exp(-admittance->rate_per_s * period_s);
            admittance->approach = -gw_expm1(-admittance->rate_per_s * period_s);
            admittance->goal_m = zero;
            admittance->moved_x_m = gw_sum_of(GW_ZERO);
            admittance->moved_y_m = gw_sum_of(GW_ZERO);
            set_velocity(admittance, zero);
            init_escape(admittance);
        } else {
            status = GW_STATUS_CONFIG_INVALID;
        }
    }
    return status;
}

bool gw_admittance_invariant_holds(const gw_admittance_t *admittance)
{
    bool holds = (admittance != NULL);
    if (holds) {
        holds = admittance->initialised;
    }
    if (holds) {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_config_check_real(&error, GW_FIELD_CONTROLLER_PERIOD, admittance->period_s);
        gw_admittance_config_check(&admittance->config, &error);
        holds = (error.field == GW_FIELD_NONE) && gw_in_range(admittance->decay, GW_ZERO, GW_ONE) &&
                gw_in_range(admittance->approach, GW_ZERO, GW_ONE) && gw_is_finite(admittance->rate_per_s) &&
                gw_within(admittance->goal_m.x, ESCAPE_MAX) && gw_within(admittance->goal_m.y, ESCAPE_MAX) &&
                gw_sum_invariant_holds(admittance->moved_x_m) && gw_sum_invariant_holds(admittance->moved_y_m) &&
                gw_within(admittance->velocity_mps.x, SPEED_MAX) && gw_within(admittance->velocity_mps.y, SPEED_MAX) &&
                escape_holds(admittance);
    }
    return holds;
}

GW_SMALL static void aim(gw_admittance_t *admittance, gw_vector_t direction)
{
    const gw_real_t distance_m = admittance->config.escape_impulse_newton_s / admittance->config.damping_newton_s_per_m;
    const gw_vector_t limited = limit_components(direction, UNIT_MAX);
    admittance->goal_m.x = distance_m * limited.x;
    admittance->goal_m.y = distance_m * limited.y;
    point_away(admittance, limited);
}

gw_status_t gw_admittance_start(gw_admittance_t *admittance, gw_vector_t velocity_mps, gw_vector_t direction)
{
    gw_status_t status = GW_STATUS_OK;
    if (admittance == NULL) {
        status = GW_STATUS_NULL_POINTER;
    } else if (!admittance->initialised) {
        status = GW_STATUS_NOT_INITIALISED;
    } else if (!(gw_within(direction.x, UNIT_MAX) && gw_within(direction.y, UNIT_MAX) &&
                 (gw_length(known_within(direction, UNIT_MAX)) <= UNIT_MAX) && gw_within(velocity_mps.x, SPEED_MAX) &&
                 gw_within(velocity_mps.y, SPEED_MAX))) {
        status = GW_STATUS_INPUT_INVALID;
    } else {
        aim(admittance, direction);
        remember_start(admittance);
        admittance->moved_x_m = gw_sum_of(GW_ZERO);
        admittance->moved_y_m = gw_sum_of(GW_ZERO);
        set_velocity(admittance, known_within(velocity_mps, SPEED_MAX));
    }
    return status;
}

void gw_admittance_redirect(gw_admittance_t *admittance, gw_vector_t direction)
{
    if (!is_escape(admittance)) {
        aim(admittance, direction);
    } else if (agrees(admittance, direction)) {
        aim(admittance, direction);
        follow_direction(admittance);
    } else {
        /* what is felt of its own braking may point anywhere */
    }
}

/* Changes the velocity towards the wanted one within the acceleration limit. */
static gw_admittance_output_t approach_velocity(const gw_admittance_t *admittance, gw_vector_t wanted_mps)
{
    gw_admittance_output_t next;
    const gw_vector_t before = admittance->velocity_mps;
    const gw_vector_t change = {wanted_mps.x - before.x, wanted_mps.y - before.y};
    const gw_vector_t allowed =
        gw_limit_length(change, admittance->config.acceleration_limit_mps2 * admittance->period_s);
    const gw_real_t share = share_without_tipping(admittance, allowed);
    const gw_real_t half_s = GW_HALF * admittance->period_s;
    next.velocity_mps.x = before.x + (share * allowed.x);
    next.velocity_mps.y = before.y + (share * allowed.y);
    next.displacement_m.x = half_s * (before.x + next.velocity_mps.x);
    next.displacement_m.y = half_s * (before.y + next.velocity_mps.y);
    return next;
}

/* Is the velocity within the limits, coming from the present one? */
static bool within_limits(const gw_admittance_t *admittance, gw_vector_t velocity_mps)
{
    const gw_vector_t before = admittance->velocity_mps;
    const gw_vector_t change = {velocity_mps.x - before.x, velocity_mps.y - before.y};
    return (gw_length(velocity_mps) <= admittance->config.speed_limit_mps) &&
           (gw_length(change) <= (admittance->config.acceleration_limit_mps2 * admittance->period_s)) &&
           (share_without_tipping(admittance, change) >= GW_ONE);
}

/* One tick of (2), or as near to it as limits and finish speed allow. */
static gw_admittance_output_t step_frozen(const gw_admittance_t *admittance)
{
    gw_admittance_output_t next;
    const gw_admittance_config_t *const config = &admittance->config;
    const gw_real_t period_s = admittance->period_s;
    const gw_vector_t ahead = ahead_of(admittance);
    const gw_real_t distance_m = gw_length(ahead);
    if (distance_m > GW_ZERO) {
        const gw_vector_t unit = gw_unit(ahead.x, ahead.y, distance_m);
        const gw_real_t end_rate = admittance->rate_per_s * admittance->decay;
        const gw_vector_t end_mps = {end_rate * ahead.x, end_rate * ahead.y};
        const gw_vector_t exact_m = {admittance->approach * ahead.x, admittance->approach * ahead.y};
        const gw_vector_t mean_mps = {exact_m.x / period_s, exact_m.y / period_s};
        const gw_real_t mean = gw_length(mean_mps);
        const gw_real_t along_mps = gw_along(admittance->velocity_mps, unit);
        /* Braking is planned with half of the acceleration; the other half corrects errors. */
        const gw_vector_t back = {-unit.x, -unit.y};
        const gw_real_t brake_mps = gw_braking_speed(GW_HALF * limit_without_tipping(admittance, back), period_s,
                                                     distance_m - ((GW_HALF * period_s) * along_mps));
        const gw_real_t wanted =
            gw_min(gw_min(gw_max(mean, config->finish_speed_mps), brake_mps), config->speed_limit_mps);
        const gw_vector_t wanted_mps = {wanted * unit.x, wanted * unit.y};
        const gw_vector_t still = {GW_ZERO, GW_ZERO};
        if ((mean >= config->finish_speed_mps) && (mean <= brake_mps) && within_limits(admittance, mean_mps) &&
            within_limits(admittance, end_mps)) {
            next.velocity_mps = end_mps;
            next.displacement_m = exact_m;
        } else if ((brake_mps <= GW_ZERO) && within_limits(admittance, still)) {
            next.velocity_mps = still;
            next.displacement_m = ahead;
        } else {
            next = approach_velocity(admittance, wanted_mps);
        }
    } else {
        const gw_vector_t still = {GW_ZERO, GW_ZERO};
        next = approach_velocity(admittance, still);
    }
    return next;
}

/* One tick of (1) with the force held, or as near to it as the limits allow. */
static gw_admittance_output_t step_live(const gw_admittance_t *admittance, gw_vector_t force_n)
{
    gw_admittance_output_t next;
    const gw_real_t damping = admittance->config.damping_newton_s_per_m;
    /* Final velocity F/B, and the difference from it. */
    const gw_vector_t final = {force_n.x / damping, force_n.y / damping};
    const gw_vector_t excess = {admittance->velocity_mps.x - final.x, admittance->velocity_mps.y - final.y};
    const gw_vector_t end_mps = {final.x + (admittance->decay * excess.x), final.y + (admittance->decay * excess.y)};
    if (within_limits(admittance, end_mps)) {
        const gw_real_t span_s = admittance->approach / admittance->rate_per_s;
        next.velocity_mps = end_mps;
        next.displacement_m.x = (final.x * admittance->period_s) + (excess.x * span_s);
        next.displacement_m.y = (final.y * admittance->period_s) + (excess.y * span_s);
    } else {
        next = approach_velocity(admittance, gw_limit_length(end_mps, admittance->config.speed_limit_mps));
    }
    return next;
}

gw_status_t gw_admittance_step(gw_admittance_t *admittance, gw_vector_t force_n, gw_admittance_output_t *output)
{
    static const gw_admittance_output_t still = {0};
    gw_status_t status = GW_STATUS_OK;
    if (output == NULL) {
        status = GW_STATUS_NULL_POINTER;
    } else {
        *output = still;
        if (admittance == NULL) {
            status = GW_STATUS_NULL_POINTER;
        } else if (!admittance->initialised) {
            status = GW_STATUS_NOT_INITIALISED;
        } else if (!(gw_within(force_n.x, GW_WRENCH_MAX) && gw_within(force_n.y, GW_WRENCH_MAX))) {
            status = GW_STATUS_INPUT_INVALID;
        } else {
            const bool to_a_goal = (admittance->config.kind != GW_ADMITTANCE_LIVE_FORCE);
            if (is_escape(admittance)) {
                move_goal(admittance);
            }
            if (to_a_goal) {
                *output = step_frozen(admittance);
            } else {
                *output = step_live(admittance, known_within(force_n, GW_WRENCH_MAX));
            }
            output->velocity_mps = limit_components(output->velocity_mps, SPEED_MAX);
            output->displacement_m = limit_components(output->displacement_m, DISPLACEMENT_MAX);
            if (to_a_goal) {
                admittance->moved_x_m =
                    gw_sum_limit(gw_sum_add(admittance->moved_x_m, output->displacement_m.x), ESCAPE_MAX);
                admittance->moved_y_m =
                    gw_sum_limit(gw_sum_add(admittance->moved_y_m, output->displacement_m.y), ESCAPE_MAX);
            }
            admittance->velocity_mps = output->velocity_mps;
            if (is_escape(admittance)) {
                *output = smoothed(admittance);
            }
        }
    }
    return status;
}
