#include "giveway/gw_channels.h"

#include "giveway/gw_math.h"
#include "giveway/gw_trikey.h"
#include "giveway/gw_wrench.h"

#if (GW_WITH_CHANNELS == 1)

#define DOUBT_TICKS 2U /* between two looks at what the model may be wrong by */
#define LEARN_TICKS 8U /* between two calls of the follower, whose input is slower: x and y in turn */
#define LEARN_PHASE 2U
#define FREE_PHASE 2U     /* among GW_SLOW_TICKS: while a contact lasts nothing is due then */
#define WARM_UP_TICKS 60U /* the baseline's first mean */
#define QUIET_TICKS 40U   /* without a force before a contact counts as over */
#define TURN_TICKS 60U    /* after the last count, wheels count as standing */
/* With it 34 of the tuning draw's 300 runs with robots that tip have a reaction towards what hit, without it 67; 16
 * ticks leave as many. */
#define UNSURE_TICKS 10U
#define CALM_TICKS 250U /* after a motion: a robot that has stopped swings on its springs */
/* An end may take so much more than the baseline holds of a contact; of what is left, so much is a push, over the
 * change. In 2,100 runs of the tuning draw's planar robots 12 reactions lead towards what hit, without this 25. */
#define END_MOST ((gw_real_t)1.5)
#define PUSH_LEAST ((gw_real_t)0.5)
/* The low-pass that sees a body swing back, and how much more its force counts than a contact's. Without, there are 87
 * reactions without contact in 400 runs of the tuning draw's robots that tip, with it 53; planar robots are not
 * concerned, nothing pushes their wheels back. */
#define BANK_OF_BACK 1U
#define BACK_MORE ((gw_real_t)2.3)
/* The low-pass whose forces are summed to a contact's impulse, and the one for what is slow, or felt by an IMU in
 * motion. A sum of the forces themselves would end in the noise of a speed, which more ticks hardly make less: 95 % of
 * the tuning draw's planar hits were placed within 93 mm after 30 ms, with this 62. With an IMU free hits in motion are
 * placed within 81 mm; with the first low-pass for them, too, 127. */
#define BANK_OF_SUM 1U
#define BANK_OF_SLOW_SUM 2U
#define BANK_OF_RIPPLE 2U /* a hand-over takes 10 ms and more, */
#define BANK_OF_ERRORS 3U /* and what is wrong with the model lasts longer */
/* Bounds of a contact's impulse, N s and N m s, and of its time: beyond any that is refined. */
#define IMPULSE_MAX ((gw_real_t)1.0e9)
#define ROCKING_MAX_N2 ((gw_real_t)1.0e12)
#define GEAR_MAX_N2 ((gw_real_t)1.0e12)
#define RIPPLE2_MAX ((gw_real_t)4.0e4)
#define FORCES_MAX_N2 ((gw_real_t)6.0e10) /* five of GW_BALANCE_MAX, and rounding */
#define IMPULSE_MIN_S ((gw_real_t)1.0e-3)
#define IMPULSE_MAX_S ((gw_real_t)100.0)
#define SLIDING_SHARE ((gw_real_t)0.9) /* of the friction of sliding rollers */
#define CALM ((gw_real_t)0.5)          /* of the threshold: the model is followed, and a contact ends, below */

void gw_channels_config_trikey(gw_channels_config_t *config)
{
    config->noise_multiple = (gw_real_t)8.0;
    config->imu_noise_multiple = (gw_real_t)6.5;
    config->model_multiple = (gw_real_t)2.5;
    config->baseline_s = (gw_real_t)0.3;
    config->slow_s = (gw_real_t)0.05;
    config->slow_baseline_s = (gw_real_t)3.0;
    config->friction_shape = (gw_real_t)0.12;
    config->presliding = (gw_real_t)0.33; /* 0.58 if the model knew nothing: anywhere up to sliding; it knows half */
    config->yaw_inertia = (gw_real_t)0.2;
    config->centre_of_mass_m = (gw_real_t)0.03;
    config->lever_m = (gw_real_t)0.01;
    config->rocking = GW_ZERO;
    config->rocking_s = (gw_real_t)0.6;
    config->grip = GW_TRIKEY_WHEEL_GRIP_FRICTION;
    config->ripple = (gw_real_t)0.48; /* model_multiple times it, 1.2: a wheel's friction may double */
    config->fast.rest_n = (gw_real_t)3.0;
    config->fast.creep_n = (gw_real_t)10.0;
    config->fast.motion_n = (gw_real_t)7.0;
    config->slow.rest_n = (gw_real_t)4.0;
    config->slow.creep_n = (gw_real_t)40.0;
    config->slow.motion_n = (gw_real_t)14.0;
    config->settle_ticks = 300U;
    config->lock_ticks = 100U;
    config->rearm_ticks = 1000U;
    gw_follower_config_trikey(&config->follower);
}

void gw_channels_config_check(const gw_channels_config_t *config, gw_config_error_t *error)
{
    gw_config_check_real(error, GW_FIELD_CHANNELS_NOISE_MULTIPLE, config->noise_multiple);
    gw_config_check_real(error, GW_FIELD_CHANNELS_IMU_NOISE_MULTIPLE, config->imu_noise_multiple);
    gw_config_check_real(error, GW_FIELD_CHANNELS_MODEL_MULTIPLE, config->model_multiple);
    gw_config_check_real(error, GW_FIELD_CHANNELS_BASELINE_TIME, config->baseline_s);
    gw_config_check_real(error, GW_FIELD_CHANNELS_SLOW_TIME, config->slow_s);
    gw_config_check_real(error, GW_FIELD_CHANNELS_SLOW_BASELINE_TIME, config->slow_baseline_s);
    gw_config_check_real(error, GW_FIELD_CHANNELS_FRICTION_SHAPE, config->friction_shape);
    gw_config_check_real(error, GW_FIELD_CHANNELS_PRESLIDING, config->presliding);
    gw_config_check_real(error, GW_FIELD_CHANNELS_YAW_INERTIA, config->yaw_inertia);
    gw_config_check_real(error, GW_FIELD_CHANNELS_CENTRE_OF_MASS, config->centre_of_mass_m);
    gw_config_check_real(error, GW_FIELD_CHANNELS_LEVER, config->lever_m);
    gw_config_check_real(error, GW_FIELD_CHANNELS_ROCKING, config->rocking);
    gw_config_check_real(error, GW_FIELD_CHANNELS_ROCKING_TIME, config->rocking_s);
    gw_config_check_real(error, GW_FIELD_CHANNELS_GRIP, config->grip);
    gw_config_check_real(error, GW_FIELD_CHANNELS_RIPPLE, config->ripple);
    gw_config_check_real(error, GW_FIELD_CHANNELS_FAST_REST, config->fast.rest_n);
    gw_config_check_real(error, GW_FIELD_CHANNELS_FAST_CREEP, config->fast.creep_n);
    gw_config_check_real(error, GW_FIELD_CHANNELS_FAST_MOTION, config->fast.motion_n);
    gw_config_check_real(error, GW_FIELD_CHANNELS_SLOW_REST, config->slow.rest_n);
    gw_config_check_real(error, GW_FIELD_CHANNELS_SLOW_CREEP, config->slow.creep_n);
    gw_config_check_real(error, GW_FIELD_CHANNELS_SLOW_MOTION, config->slow.motion_n);
    gw_config_check_count(error, GW_FIELD_CHANNELS_SETTLE_TICKS, config->settle_ticks);
    gw_config_check_count(error, GW_FIELD_CHANNELS_LOCK_TICKS, config->lock_ticks);
    gw_config_check_count(error, GW_FIELD_CHANNELS_REARM_TICKS, config->rearm_ticks);
    gw_follower_config_check(&config->follower, error);
}

gw_real_t gw_share_of(gw_real_t interval_s, gw_real_t time_s)
{
    return gw_min(-gw_expm1(-interval_s / time_s), GW_HALF);
}

/* What rollers may do now. */
static void doubt_rollers(gw_channels_t *channels, bool reacting)
{
    const gw_real_t multiple2 = channels->config.model_multiple * channels->config.model_multiple;
    channels->doubts.ripple2 = multiple2 * gw_ripple_variance(&channels->ripple, reacting);
    channels->doubts.usual2 = multiple2 * gw_ripple_usual(&channels->ripple, reacting);
}

void gw_channels_init(gw_channels_t *channels, const gw_channels_config_t *config, const gw_channels_noise_t *noise)
{
    channels->config = *config;
    channels->period_s = noise->period_s;
    channels->rocking2 = config->rocking * config->rocking;
    channels->rocking_keep =
        gw_max(GW_ONE - (((GW_TWO * (gw_real_t)GW_SLOW_TICKS) * noise->period_s) / config->rocking_s), GW_ZERO);
    channels->gear_keep = GW_ONE - gw_share_of((gw_real_t)GW_SLOW_TICKS * noise->period_s, config->slow_s);
    gw_slip_init(&channels->doubts.slip, config->grip, noise->mass_kg, config->model_multiple, channels->gear_keep);
    gw_ripple_init(&channels->ripple, config->ripple, (gw_real_t)GW_SLOW_TICKS * noise->period_s);
    gw_follower_init(&channels->follower, &config->follower, noise->period_s * (gw_real_t)LEARN_TICKS);
    gw_fast_channel_init(&channels->fast, config, noise);
    gw_slow_channel_init(&channels->slow, config, noise);
    gw_channels_restart(channels);
}

void gw_channels_stand_firm(gw_channels_t *channels)
{
    channels->rocking2 = GW_ZERO;
}

void gw_channels_restart(gw_channels_t *channels)
{
    static const gw_wrench_t no_impulse = {0};
    gw_fast_channel_restart(&channels->fast);
    gw_slow_channel_restart(&channels->slow);
    channels->doubts.forces_n2 = GW_ZERO;
    channels->doubts.rocking_n2 = GW_ZERO;
    channels->doubts.gear_n2 = GW_ZERO;
    channels->doubts.row_m2ps2 = GW_ZERO;
    gw_slip_restart(&channels->doubts.slip);
    gw_ripple_leave_out(&channels->ripple);
    doubt_rollers(channels, false);
    channels->impulse = no_impulse;
    channels->impulse_s = GW_ONE;
    channels->summed = BANK_OF_SUM;
    channels->began_in_motion = false;
    channels->tick = 0U;
    channels->ticks_since_trip = 0U;
    channels->ticks_since_release = GW_TICK_MASK;
    channels->ticks_of_motion = 0U;
    channels->ticks_without_turn = GW_TICK_MASK;
    channels->calm_ticks = CALM_TICKS;
    channels->quiet_ticks = 0U;
    channels->warm_up_ticks = 0U;
    channels->channel = GW_CHANNEL_NONE;
    channels->active = false;
}

void gw_channels_resume(gw_channels_t *channels)
{
    if (!channels->active) {
        gw_channels_restart(channels);
    }
}

bool gw_channels_invariant_holds(const gw_channels_t *channels)
{
    bool holds = (channels != NULL);
    if (holds) {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_channels_config_check(&channels->config, &error);
        holds = (error.field == GW_FIELD_NONE) && gw_follower_invariant_holds(&channels->follower) &&
                gw_fast_channel_invariant_holds(&channels->fast) && gw_slow_channel_invariant_holds(&channels->slow) &&
                gw_within(channels->doubts.forces_n2, FORCES_MAX_N2) &&
                gw_in_range(channels->rocking2, GW_ZERO, channels->config.rocking * channels->config.rocking) &&
                gw_in_range(channels->rocking_keep, GW_ZERO, GW_ONE) &&
                gw_in_range(channels->doubts.rocking_n2, GW_ZERO, ROCKING_MAX_N2) &&
                gw_in_range(channels->gear_keep, GW_HALF, GW_ONE) &&
                gw_in_range(channels->doubts.gear_n2, GW_ZERO, GEAR_MAX_N2) &&
                gw_in_range(channels->doubts.row_m2ps2, GW_ZERO, GW_ROW_MAX_M2PS2) &&
                gw_in_range(channels->doubts.ripple2, GW_ZERO, RIPPLE2_MAX) &&
                gw_in_range(channels->doubts.usual2, GW_ZERO, RIPPLE2_MAX) &&
                gw_ripple_invariant_holds(&channels->ripple) && gw_slip_invariant_holds(&channels->doubts.slip) &&
                (channels->calm_ticks <= CALM_TICKS) && gw_wrench_is_within(&channels->impulse, IMPULSE_MAX) &&
                (channels->summed < GW_BANK_COUNT) && gw_in_range(channels->impulse_s, IMPULSE_MIN_S, IMPULSE_MAX_S) &&
                (channels->warm_up_ticks <= WARM_UP_TICKS) && (channels->channel <= GW_CHANNEL_SLOW);
    }
    return holds;
}

static uint32_t one_more(uint32_t ticks)
{
    return (ticks < GW_TICK_MASK) ? (ticks + 1U) : ticks;
}

static void count_ticks(gw_channels_t *channels, const gw_channels_input_t *input)
{
    channels->tick = (channels->tick + 1U) & GW_TICK_MASK;
    channels->ticks_since_release = one_more(channels->ticks_since_release);
    channels->ticks_of_motion = (input->regime == GW_REGIME_MOTION) ? one_more(channels->ticks_of_motion) : 0U;
    channels->ticks_without_turn = input->turned ? 0U : one_more(channels->ticks_without_turn);
}

/* Has a robot that stopped been calm for long enough? Below half of the thresholds of rest it is. */
static bool is_calm(gw_channels_t *channels, const gw_channels_input_t *input)
{
    if (input->regime != GW_REGIME_REST) {
        channels->calm_ticks = 0U;
    } else if (channels->calm_ticks < CALM_TICKS) {
        const bool calm = (!channels->active) && gw_fast_channel_is_calm(&channels->fast, &channels->config, CALM);
        channels->calm_ticks = calm ? (channels->calm_ticks + 1U) : 0U;
    } else {
        /* it rests */
    }
    return channels->calm_ticks >= CALM_TICKS;
}

/* Which noise and floor hold now. A reaction accelerates as no plan does: it counts as unsettled. */
static gw_regime_t judged_regime(const gw_channels_t *channels, const gw_channels_input_t *input, bool calm)
{
    gw_regime_t regime = input->regime;
    const bool settled = (channels->ticks_since_release >= channels->config.settle_ticks) &&
                         (channels->ticks_of_motion >= channels->config.settle_ticks);
    if ((regime != GW_REGIME_REST) && ((!settled) || input->reacting)) {
        regime = GW_REGIME_CREEPING;
    } else if ((regime == GW_REGIME_REST) && ((channels->ticks_without_turn < TURN_TICKS) || (!calm))) {
        regime = GW_REGIME_MOTION;
    } else {
        /* as it is */
    }
    return regime;
}

/* Another zero: the residual jumps, and all that follows it jumps with it. What was left of slow errors ends with the
 * motion: the thresholds of rest are too small for them. */
static void take_zero_step(gw_channels_t *channels, const gw_channels_input_t *input)
{
    const bool by_imu = (channels->fast.sensor == GW_BY_IMU);
    const bool other_sensor = (by_imu != input->felt);
    const bool resting = (input->regime == GW_REGIME_REST) && (channels->warm_up_ticks >= WARM_UP_TICKS);
    if (other_sensor && (!channels->active)) {
        /* One tick of the encoders is too noisy to be a step: the baseline needs another mean. */
        gw_fast_channel_restart(&channels->fast);
        channels->warm_up_ticks = 0U;
    } else {
        gw_fast_channel_take_zero(&channels->fast, *input->zero_step, !channels->active);
    }
    if (resting || (!other_sensor)) {
        gw_slow_channel_take_zero(&channels->slow, *input->zero_step, input->regime);
    }
}

/* Sum over the wheels, N^2. */
static gw_real_t squares_of_friction(const gw_model_forces_t *model)
{
    gw_real_t sum_n2 = GW_ZERO;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        sum_n2 += model->friction_n.wheel[i] * model->friction_n.wheel[i];
    }
    return sum_n2;
}

/* Sum of the squares of the model's forces, N^2. The moment that they make about the centre is uncertain by their
 * levers, as wheels touch the floor with one row of rollers or the other. */
static gw_real_t squares_of_forces(const gw_model_forces_t *model, gw_real_t friction_n2)
{
    return ((model->inertia_n.x * model->inertia_n.x) + (model->inertia_n.y * model->inertia_n.y)) + friction_n2;
}

/* A roller that hardly turns has a friction of its own history: nothing is learned from it. */
static bool all_wheels_slide(const gw_channels_t *channels)
{
    bool slide = true;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        slide = slide && (gw_magnitude(channels->slow.mean.model.friction_n.wheel[i]) >=
                          (SLIDING_SHARE * channels->slow.sliding_n));
    }
    return slide;
}

/* A force that the body of a robot that may lean did not feel before makes it swing. */
static void rock(gw_channels_t *channels, gw_real_t x_n, gw_real_t y_n)
{
    const gw_real_t swing_n2 = channels->rocking2 * ((x_n * x_n) + (y_n * y_n));
    channels->doubts.rocking_n2 = gw_clamp(gw_max(channels->doubts.rocking_n2, swing_n2), GW_ZERO, ROCKING_MAX_N2);
}

/* The swing fades, and every change of the acceleration is such a force. */
static void rock_on(gw_channels_t *channels)
{
    const gw_vector_t now_n = channels->slow.mean.model.inertia_n;
    const gw_vector_t usual_n = channels->fast.baseline.model.inertia_n;
    channels->doubts.rocking_n2 = channels->rocking_keep * channels->doubts.rocking_n2;
    rock(channels, now_n.x - usual_n.x, now_n.y - usual_n.y);
}

/* An error of the gears' friction is in the low-passes for as long as they remember it. */
static void doubt_gears(gw_channels_t *channels, gw_real_t now_n2)
{
    const gw_real_t multiple = channels->config.model_multiple;
    const gw_real_t doubt_n2 = gw_max(channels->gear_keep * channels->doubts.gear_n2, (multiple * multiple) * now_n2);
    channels->doubts.gear_n2 = gw_clamp(doubt_n2, GW_ZERO, GEAR_MAX_N2);
}

/* While something touches it, or the robot gives way, a wheel that slips is what one would expect: nothing is forgiven
 * for it. An IMU feels the base and not the wheels. */
static void doubt_grip(gw_channels_t *channels, const gw_kinematics_t *kinematics, const gw_channels_input_t *input)
{
    const bool drives = (input->regime != GW_REGIME_REST) && (!channels->active) && (!input->reacting);
    gw_slip_step(&channels->doubts.slip, kinematics, input->torque_nm, drives && (!input->felt));
}

/* Since this was asked for the last time, rad, mean of the wheels. */
static gw_real_t turned_rad(const gw_channels_t *channels, const gw_kinematics_t *kinematics, const gw_twist_t *twist)
{
    gw_wheels_t rate_radps;
    gw_real_t sum_radps = GW_ZERO;
    rate_radps = gw_kinematics_wheel_rates(kinematics, *twist);
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        sum_radps += gw_magnitude(rate_radps.wheel[i]);
    }
    return ((gw_real_t)GW_SLOW_TICKS * channels->period_s) * (GW_PER_WHEEL * sum_radps);
}

/* Of the force that comes and goes as ripple does, N^2. */
static gw_real_t square_of_ripple(const gw_fast_channel_t *fast)
{
    const gw_wrench_t *const quick = &fast->bank[BANK_OF_RIPPLE];
    const gw_wrench_t *const slow = &fast->bank[BANK_OF_ERRORS];
    const gw_vector_t between_n = {quick->force_x_n - slow->force_x_n, quick->force_y_n - slow->force_y_n};
    return (between_n.x * between_n.x) + (between_n.y * between_n.y);
}

/* Where no wheel's rollers slide there is no ripple to be seen. */
static void follow_ripple(gw_channels_t *channels, const gw_kinematics_t *kinematics, const gw_channels_input_t *input,
                          gw_real_t friction_n2, gw_regime_t regime, gw_real_t fast)
{
    const gw_real_t sliding_n = channels->fast.sliding_n;
    if (channels->active) {
        gw_ripple_leave_out(&channels->ripple);
    } else {
        if ((regime != GW_REGIME_REST) && (fast < CALM) && (friction_n2 > (sliding_n * sliding_n))) {
            gw_ripple_follow(&channels->ripple, turned_rad(channels, kinematics, input->twist),
                             square_of_ripple(&channels->fast), friction_n2, input->reacting);
        }
        gw_ripple_go_on(&channels->ripple);
    }
    doubt_rollers(channels, input->reacting);
}

/* As a turning wheel passes from one row of rollers to the other, its arm changes, and its speed with it. */
static void doubt_rows(gw_channels_t *channels, const gw_twist_t *twist)
{
    const gw_real_t step_mps = channels->config.lever_m * twist->omega_radps;
    channels->doubts.row_m2ps2 = gw_clamp(step_mps * step_mps, GW_ZERO, GW_ROW_MAX_M2PS2);
}

/* Tasks that not every tick needs, each in ticks of its own: they make the longest step shorter. */
static void do_what_is_due(gw_channels_t *channels, const gw_kinematics_t *kinematics, const gw_channels_input_t *input,
                           const gw_balance_t *balance, gw_regime_t regime, gw_real_t fast)
{
    const bool rests = (input->regime == GW_REGIME_REST) && (channels->calm_ticks >= CALM_TICKS);
    if ((channels->tick % DOUBT_TICKS) != 0U) {
        gw_fast_channel_doubt(&channels->fast, &channels->config, kinematics, &channels->follower, balance, regime,
                              &channels->doubts);
    } else if ((channels->tick % GW_SLOW_TICKS) == 0U) {
        gw_slow_channel_judge(&channels->slow, &channels->config, kinematics, &channels->follower,
                              rests ? GW_REGIME_REST : regime, &channels->doubts);
    } else {
        const gw_model_forces_t *const model = &channels->slow.mean.model;
        const gw_real_t friction_n2 = squares_of_friction(model);
        channels->doubts.forces_n2 = squares_of_forces(model, friction_n2);
        follow_ripple(channels, kinematics, input, friction_n2, regime, fast);
        doubt_rows(channels, input->twist);
        rock_on(channels);
        doubt_gears(channels, input->gear_n2);
        doubt_grip(channels, kinematics, input);
        if ((!channels->active) && (input->regime != GW_REGIME_REST)) {
            gw_slow_channel_follow(&channels->slow, regime == GW_REGIME_MOTION);
        }
        if (((channels->tick % LEARN_TICKS) == LEARN_PHASE) && (regime == GW_REGIME_MOTION) &&
            (input->regime == GW_REGIME_MOTION) && (!channels->active) &&
            (gw_max(fast, channels->slow.statistic) < CALM) && all_wheels_slide(channels)) {
            gw_slow_channel_teach(&channels->slow, kinematics, &channels->follower,
                                  (channels->tick & LEARN_TICKS) != 0U);
        }
    }
}

bool gw_channels_are_unsure(const gw_channels_t *channels)
{
    return channels->active && (channels->ticks_since_trip < UNSURE_TICKS) && (channels->rocking2 > GW_ZERO) &&
           (channels->fast.sensor == GW_BY_ENCODERS);
}

bool gw_channels_have_time(const gw_channels_t *channels)
{
    return (channels->tick % GW_SLOW_TICKS) == FREE_PHASE;
}

/* A contact does not pull, but a mass or a friction that is wrong looks like it once a robot in motion brakes: what is
 * against the impulse is left out. Of 2,100 runs of the tuning draw's planar robots 14 have a reaction towards what hit
 * without this, 7 with it. At rest, where there is no plan to brake from, it would hide what a leaning robot feels. */
static void add_impulse(gw_channels_t *channels, gw_wrench_t wrench, gw_real_t time_s)
{
    if (channels->began_in_motion) {
        const gw_vector_t impulse = {channels->impulse.force_x_n, channels->impulse.force_y_n};
        const gw_vector_t d = gw_unit(impulse.x, impulse.y, gw_length(impulse));
        const gw_real_t pull_n = gw_min((wrench.force_x_n * d.x) + (wrench.force_y_n * d.y), GW_ZERO);
        wrench.force_x_n -= pull_n * d.x;
        wrench.force_y_n -= pull_n * d.y;
    }
    channels->impulse_s = gw_min(channels->impulse_s + time_s, IMPULSE_MAX_S);
    channels->impulse.force_x_n = gw_limited(channels->impulse.force_x_n + (wrench.force_x_n * time_s), IMPULSE_MAX);
    channels->impulse.force_y_n = gw_limited(channels->impulse.force_y_n + (wrench.force_y_n * time_s), IMPULSE_MAX);
    channels->impulse.torque_nm = gw_limited(channels->impulse.torque_nm + (wrench.torque_nm * time_s), IMPULSE_MAX);
}

/* A contact begins: the impulse so far is that of the filter that noticed it. */
static void begin_contact(gw_channels_t *channels, gw_regime_t regime, const gw_fast_found_t *found)
{
    static const gw_wrench_t no_impulse = {0};
    channels->active = true;
    channels->ticks_since_trip = 0U;
    channels->quiet_ticks = 0U;
    channels->impulse = no_impulse;
    channels->impulse_s = GW_ZERO;
    channels->began_in_motion = (regime != GW_REGIME_REST);
    if (found->statistic > GW_ONE) {
        const bool shaken = (channels->fast.sensor == GW_BY_IMU) && channels->began_in_motion;
        channels->channel = GW_CHANNEL_FAST;
        channels->summed = shaken ? BANK_OF_SLOW_SUM : BANK_OF_SUM;
        add_impulse(channels, channels->fast.bank[found->widest], gw_fast_channel_time(&channels->fast, found->widest));
    } else {
        const gw_wrench_t lasting = {channels->slow.force_n.x, channels->slow.force_n.y,
                                     channels->slow.mean.residual.torque_nm};
        channels->channel = GW_CHANNEL_SLOW;
        channels->summed = BANK_OF_SLOW_SUM;
        add_impulse(channels, lasting, channels->config.slow_s);
    }
}

static gw_wrench_t mean_wrench(const gw_channels_t *channels)
{
    const gw_real_t per_s = GW_ONE / channels->impulse_s;
    const gw_wrench_t mean = {channels->impulse.force_x_n * per_s, channels->impulse.force_y_n * per_s,
                              channels->impulse.torque_nm * per_s};
    return gw_wrench_limited(mean);
}

/* What to give way to. A change against a contact that the baseline holds is its end, unless it is much more: then
 * the robot is pushed by what is left of both, and never from the other side. */
static gw_vector_t push_of(const gw_channels_t *channels, gw_wrench_t mean)
{
    static const gw_vector_t nothing = {0};
    const gw_vector_t carried = channels->fast.carried_n;
    const gw_real_t carried_n = gw_length(carried);
    const gw_vector_t along = gw_unit(carried.x, carried.y, carried_n);
    const gw_real_t against_n = -((mean.force_x_n * along.x) + (mean.force_y_n * along.y));
    gw_vector_t push = {mean.force_x_n, mean.force_y_n};
    if ((against_n > GW_ZERO) && (against_n < (END_MOST * carried_n))) {
        const gw_real_t least_n = PUSH_LEAST * gw_length(push);
        const gw_real_t added_n = gw_max(carried_n, against_n);
        push.x = gw_limited(push.x + (added_n * along.x), GW_WRENCH_MAX);
        push.y = gw_limited(push.y + (added_n * along.y), GW_WRENCH_MAX);
        push = (gw_length(push) < least_n) ? nothing : push;
    }
    return push;
}

/* A body that leant against a contact swings back, and goes on swinging. */
static void rock_back(gw_channels_t *channels)
{
    const gw_wrench_t *const felt = &channels->fast.bank[BANK_OF_BACK];
    const gw_vector_t impulse = {channels->impulse.force_x_n, channels->impulse.force_y_n};
    const gw_vector_t d = gw_unit(impulse.x, impulse.y, gw_length(impulse));
    const gw_real_t back_n = gw_max(-((felt->force_x_n * d.x) + (felt->force_y_n * d.y)), GW_ZERO);
    rock(channels, BACK_MORE * back_n, GW_ZERO);
}

static void end_contact(gw_channels_t *channels, const gw_balance_t *balance, const gw_fast_found_t *found)
{
    const gw_vector_t impulse = {channels->impulse.force_x_n, channels->impulse.force_y_n};
    const gw_wrench_t mean = mean_wrench(channels);
    gw_fast_channel_release(&channels->fast, balance, found, gw_unit(impulse.x, impulse.y, gw_length(impulse)),
                            channels->quiet_ticks <= QUIET_TICKS);
    channels->active = false;
    channels->ticks_since_release = 0U;
    rock(channels, mean.force_x_n, mean.force_y_n); /* it leant against what pushed it */
}

/* While a contact lasts: its impulse grows, until it is over. */
static void continue_contact(gw_channels_t *channels, const gw_balance_t *balance, const gw_fast_found_t *found)
{
    channels->ticks_since_trip = one_more(channels->ticks_since_trip);
    if (channels->ticks_since_trip < GW_REFINE_TICKS) {
        add_impulse(channels, channels->fast.bank[channels->summed], channels->period_s);
    }
    if (gw_channels_have_time(channels)) {
        rock_back(channels);
    }
    const bool quiet = (found->release < CALM) && (channels->slow.statistic < GW_ONE);
    channels->quiet_ticks = quiet ? one_more(channels->quiet_ticks) : 0U;
    const bool over =
        ((channels->quiet_ticks > QUIET_TICKS) && (channels->ticks_since_trip >= channels->config.lock_ticks)) ||
        (channels->ticks_since_trip >= channels->config.rearm_ticks);
    if (over && gw_channels_have_time(channels)) {
        end_contact(channels, balance, found);
    }
}

/* The first mean of the signals; nothing is detected meanwhile. */
static void warm_up(gw_channels_t *channels, const gw_balance_t *balance)
{
    channels->warm_up_ticks++;
    const uint32_t ticks = channels->warm_up_ticks + 1U; /* the zero before counts as one */
    const gw_real_t share = GW_ONE / (gw_real_t)ticks;
    gw_fast_channel_begin(&channels->fast, balance, share);
    gw_slow_channel_begin(&channels->slow, balance, share);
}

/* A tick after the warm-up. Returns the larger statistic. */
static gw_real_t compare(gw_channels_t *channels, const gw_kinematics_t *kinematics, const gw_channels_input_t *input,
                         const gw_balance_t *balance, gw_channels_output_t *output)
{
    const gw_regime_t regime = judged_regime(channels, input, is_calm(channels, input));
    gw_fast_found_t found;
    gw_fast_channel_step(&channels->fast, &channels->config, kinematics, &channels->follower, balance, regime,
                         !channels->active, &found);
    gw_slow_channel_step(&channels->slow, balance);
    output->force_n.x = found.change.force_x_n;
    output->force_n.y = found.change.force_y_n;
    /* In a reaction a lasting force is told from wrong friction by nothing: impacts alone count. */
    const gw_real_t largest = input->reacting ? found.statistic : gw_max(found.statistic, channels->slow.statistic);
    if ((!channels->active) && input->enabled && (largest > GW_ONE)) {
        begin_contact(channels, regime, &found);
        output->tripped = true;
    } else {
        if (!input->zero_changed) {
            do_what_is_due(channels, kinematics, input, balance, regime, found.statistic);
        }
        if (channels->active) {
            continue_contact(channels, balance, &found);
        } else {
            gw_fast_channel_follow(&channels->fast, balance);
        }
    }
    return largest;
}

void gw_channels_step(gw_channels_t *channels, const gw_kinematics_t *kinematics, const gw_channels_input_t *input,
                      gw_channels_output_t *output)
{
    const gw_balance_t balance = gw_balance_limited(input->wrench, input->forces);
    gw_real_t largest = GW_ZERO;
    output->tripped = false;
    output->force_n.x = GW_ZERO;
    output->force_n.y = GW_ZERO;
    if (input->zero_changed) {
        take_zero_step(channels, input);
    }
    gw_fast_channel_feel(&channels->fast, input->felt, input->shaking_mps2_2);
    gw_fast_channel_count(&channels->fast, input->counted);
    count_ticks(channels, input);
    if (channels->warm_up_ticks < WARM_UP_TICKS) {
        warm_up(channels, &balance);
    } else {
        largest = compare(channels, kinematics, input, &balance, output);
    }
    output->statistic = gw_sqrt_of_square(largest);
    output->active = channels->active;
    output->refining = channels->active && (channels->ticks_since_trip < GW_REFINE_TICKS);
    output->channel = channels->channel;
    output->refined = output->tripped || (output->refining && gw_channels_have_time(channels));
    if (output->refined) {
        output->mean_wrench = mean_wrench(channels);
        output->push_n = push_of(channels, output->mean_wrench);
    }
}

#endif
