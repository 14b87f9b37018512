#include "giveway/gw_channels.h"

#include "giveway/gw_math.h"
#include "giveway/gw_wrench.h"

#define LEARN_TICKS 16U       /* between two calls of the follower: its input is slower */
#define WARM_UP_TICKS 60U     /* the baseline's first mean */
#define QUIET_TICKS 40U       /* without a force before a contact counts as over */
#define TURN_TICKS 60U        /* after the last count, wheels count as standing */
#define RELEASE_BANK 2U       /* low-pass that decides on the end of a contact, and sets the baseline there */
#define RELEASE_FLOOR_N2 ((gw_real_t)16.0)
#define CALM ((gw_real_t)0.5) /* of the threshold: noise and model are followed below */
#define HELD_TIME_S ((gw_real_t)1.0) /* for which the end of an old contact is forgiven */
#define NOISE_TIME_S ((gw_real_t)3.0)
#define NOISE_CLIP ((gw_real_t)6.0) /* an outlier counts as this many variances */
/* Least noise of each set over the predicted one, and the first guess: slow wheels count irregularly. */
static const gw_real_t least_share[GW_NOISE_SETS] = {(gw_real_t)0.4, (gw_real_t)0.5, (gw_real_t)0.6};
static const gw_real_t first_share[GW_NOISE_SETS] = {(gw_real_t)1.0, (gw_real_t)2.0, (gw_real_t)1.0};
static const gw_real_t bank_s[GW_BANK_COUNT] = {(gw_real_t)0.002, (gw_real_t)0.006, (gw_real_t)0.018, (gw_real_t)0.05};

void gw_channels_config_trikey(gw_channels_config_t *config)
{
    config->noise_multiple = (gw_real_t)8.0;
    config->model_multiple = (gw_real_t)2.5;
    config->baseline_s = (gw_real_t)0.3;
    config->slow_s = (gw_real_t)0.05;
    config->friction_shape = (gw_real_t)0.12;
    config->yaw_inertia = (gw_real_t)0.2;
    config->centre_of_mass_m = (gw_real_t)0.03;
    config->lever_m = (gw_real_t)0.01;
    config->fast.rest_n = (gw_real_t)3.0;
    config->fast.creep_n = (gw_real_t)12.0;
    config->fast.motion_n = (gw_real_t)7.0;
    config->slow.rest_n = (gw_real_t)4.0;
    config->slow.creep_n = (gw_real_t)40.0;
    config->slow.motion_n = (gw_real_t)12.0;
    config->settle_ticks = 500U;
    config->lock_ticks = 100U;
    config->rearm_ticks = 600U;
    gw_follower_config_trikey(&config->follower);
}

void gw_channels_config_check(const gw_channels_config_t *config, gw_config_error_t *error)
{
    gw_config_check_real(error, GW_FIELD_CHANNELS_NOISE_MULTIPLE, config->noise_multiple);
    gw_config_check_real(error, GW_FIELD_CHANNELS_MODEL_MULTIPLE, config->model_multiple);
    gw_config_check_real(error, GW_FIELD_CHANNELS_BASELINE_TIME, config->baseline_s);
    gw_config_check_real(error, GW_FIELD_CHANNELS_SLOW_TIME, config->slow_s);
    gw_config_check_real(error, GW_FIELD_CHANNELS_FRICTION_SHAPE, config->friction_shape);
    gw_config_check_real(error, GW_FIELD_CHANNELS_YAW_INERTIA, config->yaw_inertia);
    gw_config_check_real(error, GW_FIELD_CHANNELS_CENTRE_OF_MASS, config->centre_of_mass_m);
    gw_config_check_real(error, GW_FIELD_CHANNELS_LEVER, config->lever_m);
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

/* Variance of a force behind a low-pass of the bank, from white noise of a position and of a force. With the alignment's
 * corner w and a = 1/tau the integrals of |s^2 G|^2 and |G|^2, G = w^2 a/((s + w)^2 (s + a)), have these closed forms. */
static gw_real_t predicted_n2(const gw_channels_noise_t *noise, gw_real_t tau_s, gw_real_t position_m2)
{
    const gw_real_t w = noise->cutoff_radps;
    const gw_real_t a = GW_ONE / tau_s;
    const gw_real_t both = (w + a) * (w + a);
    const gw_real_t force_n_per_m = (noise->mass_kg * w) * (w * a);
    const gw_real_t of_position = ((w + (GW_TWO * a)) / ((gw_real_t)4.0 * both)) * (force_n_per_m * force_n_per_m);
    const gw_real_t of_force = ((w * a) * ((GW_TWO * w) + a)) / ((gw_real_t)4.0 * both);
    return noise->period_s *
           ((of_position * position_m2) + ((of_force * noise->force_noise_n) * noise->force_noise_n));
}

void gw_channels_init(gw_channels_t *channels, const gw_channels_config_t *config, const gw_channels_noise_t *noise)
{
    const gw_real_t arm_m = noise->wheel_distance_m;
    const gw_real_t gyration_m2 = noise->yaw_inertia_kgm2 / noise->mass_kg;
    /* Of a position of the base: that of a wheel times 2/n, as the wheels add up. */
    const gw_real_t twist_m2 = GW_TWO_PER_WHEEL * (noise->twist_noise_m * noise->twist_noise_m);
    const gw_real_t count_m2 =
        GW_TWO_PER_WHEEL * ((noise->encoder_step_m * noise->encoder_step_m) / (gw_real_t)12.0);
    channels->config = *config;
    channels->period_s = noise->period_s;
    channels->moment_per_force_m2 = (gyration_m2 * gyration_m2) / ((GW_TWO * arm_m) * arm_m);
    channels->baseline_share = -gw_expm1(-noise->period_s / config->baseline_s);
    channels->slow_share = -gw_expm1(-noise->period_s / config->slow_s);
    channels->held_share = noise->period_s / HELD_TIME_S;
    channels->noise_share = noise->period_s / NOISE_TIME_S;
    for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
        channels->bank_share[j] = -gw_expm1(-noise->period_s / bank_s[j]);
        for (uint32_t set = 0U; set < GW_NOISE_SETS; set++) {
            const bool counting = (set != (uint32_t)GW_REGIME_REST);
            const gw_real_t variance_n2 =
                gw_max(predicted_n2(noise, bank_s[j], counting ? (twist_m2 + count_m2) : twist_m2), (gw_real_t)1.0e-9);
            channels->least_noise_n2[set][j] = least_share[set] * variance_n2;
            channels->noise_n2[set][j] = first_share[set] * variance_n2;
        }
    }
    gw_follower_init(&channels->follower, &config->follower, noise->period_s * (gw_real_t)LEARN_TICKS);
    gw_channels_restart(channels);
}

static void clear_signals(gw_signals_t *signals)
{
    for (uint32_t i = 0U; i < GW_SIGNAL_COUNT; i++) {
        signals->value[i] = GW_ZERO;
    }
}

static void clear_bank(gw_channels_t *channels)
{
    for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
        clear_signals(&channels->bank[j]);
    }
}

void gw_channels_restart(gw_channels_t *channels)
{
    static const gw_wrench_t no_impulse = {0};
    static const gw_vector_t no_force = {0};
    clear_signals(&channels->baseline);
    clear_signals(&channels->slow);
    clear_bank(channels);
    channels->slow_zero_n = no_force;
    channels->held_n = no_force;
    channels->impulse = no_impulse;
    channels->impulse_s = GW_ONE;
    channels->ticks_since_trip = 0U;
    channels->ticks_since_release = GW_TICK_MASK;
    channels->ticks_of_motion = 0U;
    channels->ticks_without_turn = GW_TICK_MASK;
    channels->quiet_ticks = 0U;
    channels->warm_up_ticks = 0U;
    channels->learn_ticks = 0U;
    channels->channel = GW_CHANNEL_NONE;
    channels->active = false;
}

bool gw_channels_invariant_holds(const gw_channels_t *channels)
{
    bool holds = (channels != NULL);
    if (holds) {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_channels_config_check(&channels->config, &error);
        holds = (error.field == GW_FIELD_NONE) && gw_follower_invariant_holds(&channels->follower);
        for (uint32_t i = 0U; i < GW_SIGNAL_COUNT; i++) {
            holds = holds && gw_is_finite(channels->baseline.value[i]) && gw_is_finite(channels->slow.value[i]);
            for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
                holds = holds && gw_is_finite(channels->bank[j].value[i]);
            }
        }
    }
    return holds;
}

static uint32_t one_more(uint32_t ticks)
{
    return (ticks < GW_TICK_MASK) ? (ticks + 1U) : ticks;
}

static gw_model_forces_t forces_of(const gw_signals_t *signals)
{
    gw_model_forces_t forces;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        forces.friction_n.wheel[i] = signals->value[GW_SIGNAL_FRICTION + i];
    }
    forces.inertia_n.x = signals->value[GW_SIGNAL_INERTIA];
    forces.inertia_n.y = signals->value[GW_SIGNAL_INERTIA + 1U];
    return forces;
}

/* The wrench of signals, less what is known of friction and mass. All filters are linear, so the correction belongs
 * behind them: what was learned meanwhile does not look like a change of the force. */
static gw_wrench_t corrected(const gw_channels_t *channels, const gw_kinematics_t *kinematics,
                             const gw_signals_t *signals)
{
    const gw_model_forces_t forces = forces_of(signals);
    const gw_vector_t correction = gw_follower_correction(&channels->follower, kinematics, &forces);
    const gw_wrench_t wrench = {signals->value[0] + correction.x, signals->value[1] + correction.y, signals->value[2]};
    return wrench;
}

static void approach(gw_signals_t *signals, const gw_signals_t *target, gw_real_t share)
{
    for (uint32_t i = 0U; i < GW_SIGNAL_COUNT; i++) {
        signals->value[i] += share * (target->value[i] - signals->value[i]);
    }
}

/* The signals of this tick; the residual as it is. */
static gw_signals_t signals_of(const gw_channels_input_t *input)
{
    gw_signals_t now;
    const gw_wrench_t wrench = gw_wrench_limited(input->wrench);
    now.value[0] = wrench.force_x_n;
    now.value[1] = wrench.force_y_n;
    now.value[2] = wrench.torque_nm;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        now.value[GW_SIGNAL_FRICTION + i] = gw_limited(input->forces.friction_n.wheel[i], GW_WRENCH_MAX);
    }
    now.value[GW_SIGNAL_INERTIA] = gw_limited(input->forces.inertia_n.x, GW_WRENCH_MAX);
    now.value[GW_SIGNAL_INERTIA + 1U] = gw_limited(input->forces.inertia_n.y, GW_WRENCH_MAX);
    now.value[GW_SIGNAL_INERTIA + 2U] = gw_limited(input->inertia_moment_nm, GW_WRENCH_MAX);
    return now;
}

/* A statistic beyond this is as good as any; it keeps sums finite. */
#define STATISTIC_MAX ((gw_real_t)1.0e6)

static gw_real_t ratio_of(gw_real_t part, gw_real_t whole)
{
    return gw_min(part / gw_max(whole, (gw_real_t)1.0e-9), STATISTIC_MAX);
}

/* x^T S^-1 x. The floor keeps S away from singular. */
static gw_real_t distance(gw_planar_covariance_t s, gw_real_t x, gw_real_t y)
{
    const gw_real_t determinant = (s.xx * s.yy) - (s.xy * s.xy);
    const gw_real_t weighted = (((s.yy * x) * x) - ((GW_TWO * s.xy) * (x * y))) + ((s.xx * y) * y);
    return ratio_of(gw_max(weighted, GW_ZERO), determinant);
}

static gw_planar_covariance_t with_floor(gw_planar_covariance_t model, gw_real_t multiple, gw_real_t floor_n2)
{
    const gw_real_t square = multiple * multiple;
    const gw_planar_covariance_t sum = {(square * model.xx) + floor_n2, square * model.xy,
                                        (square * model.yy) + floor_n2};
    return sum;
}

/* Which noise and floor hold now. */
static gw_regime_t set_of(const gw_channels_t *channels, const gw_channels_input_t *input)
{
    gw_regime_t set = input->regime;
    const bool settled = (channels->ticks_since_release >= channels->config.settle_ticks) &&
                         (channels->ticks_of_motion >= channels->config.settle_ticks);
    if ((set != GW_REGIME_REST) && (!settled)) {
        set = GW_REGIME_CREEPING;
    } else if ((set == GW_REGIME_REST) && (channels->ticks_without_turn < TURN_TICKS)) {
        set = GW_REGIME_MOTION;
    } else {
        /* as the regime says */
    }
    return set;
}

/* Follows the noise of a low-pass, as long as nothing touches. */
static void follow_noise(gw_channels_t *channels, uint32_t set, uint32_t j, gw_wrench_t felt)
{
    const gw_real_t before_n2 = channels->noise_n2[set][j];
    const gw_real_t square_n2 = GW_HALF * ((felt.force_x_n * felt.force_x_n) + (felt.force_y_n * felt.force_y_n));
    const gw_real_t clipped_n2 = gw_min(square_n2, NOISE_CLIP * before_n2);
    channels->noise_n2[set][j] = gw_max(before_n2 + (channels->noise_share * (clipped_n2 - before_n2)),
                                        channels->least_noise_n2[set][j]);
}

/* What the fast channel finds in a tick. */
typedef struct {
    gw_real_t largest;               /* statistic */
    uint32_t widest;                 /* the low-pass that has it */
    gw_wrench_t wrench;              /* and what it holds */
    gw_wrench_t left;                /* what the low-pass holds that decides on the end of a contact */
    gw_real_t release;               /* statistic for the end of a contact */
    gw_planar_covariance_t release_n2; /* its covariance */
} fast_t;

/* The end of a contact that the baseline still holds is forgiven: a change against its direction, up to its size. */
static gw_planar_covariance_t with_held(const gw_channels_t *channels, gw_planar_covariance_t s, gw_real_t x,
                                        gw_real_t y)
{
    gw_planar_covariance_t sum = s;
    const gw_vector_t held = channels->held_n;
    if (((held.x * x) + (held.y * y)) < GW_ZERO) {
        sum.xx += held.x * held.x;
        sum.xy += held.x * held.y;
        sum.yy += held.y * held.y;
    }
    return sum;
}

/* Wheels touch the floor with one row of rollers or the other: the moment that all forces make about the centre is
 * uncertain by this, N^2 m^2. */
static gw_real_t moment_of_levers(const gw_channels_t *channels)
{
    gw_real_t sum_n2 = GW_ZERO;
    for (uint32_t i = GW_SIGNAL_FRICTION; i < (GW_SIGNAL_INERTIA + 2U); i++) {
        sum_n2 += channels->slow.value[i] * channels->slow.value[i];
    }
    return (channels->config.lever_m * channels->config.lever_m) * sum_n2;
}

/* The fast channel: moves the bank and compares it. */
static void step_bank(gw_channels_t *channels, const gw_kinematics_t *kinematics, const gw_signals_t *now,
                      uint32_t set, fast_t *found)
{
    const gw_channels_config_t *const config = &channels->config;
    const gw_real_t floor_n = gw_force_floor(config->fast, (gw_regime_t)set);
    const gw_real_t noise_square = config->noise_multiple * config->noise_multiple;
    const gw_real_t model_square = config->model_multiple * config->model_multiple;
    const gw_real_t lever_nm2 = moment_of_levers(channels);
    for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
        gw_signals_t *const x = &channels->bank[j];
        for (uint32_t i = 0U; i < GW_SIGNAL_COUNT; i++) {
            x->value[i] +=
                channels->bank_share[j] * ((now->value[i] - channels->baseline.value[i]) - x->value[i]);
        }
        const gw_model_forces_t forces = forces_of(x);
        const gw_wrench_t felt = corrected(channels, kinematics, x);
        const gw_real_t least_n2 = (noise_square * channels->noise_n2[set][j]) + (floor_n * floor_n);
        const gw_planar_covariance_t model = gw_follower_uncertainty(
            &channels->follower, kinematics, &forces, config->friction_shape * config->friction_shape);
        const gw_planar_covariance_t s = with_floor(model, config->model_multiple, least_n2);
        const gw_real_t of_force =
            distance(with_held(channels, s, felt.force_x_n, felt.force_y_n), felt.force_x_n, felt.force_y_n);
        const gw_real_t turning_nm = config->yaw_inertia * x->value[GW_SIGNAL_INERTIA + 2U];
        const gw_real_t offset2_nm2 =
            (config->centre_of_mass_m * config->centre_of_mass_m) *
            ((forces.inertia_n.x * forces.inertia_n.x) + (forces.inertia_n.y * forces.inertia_n.y));
        const gw_real_t moment_nm2 = (least_n2 * channels->moment_per_force_m2) +
                                     (model_square * (((turning_nm * turning_nm) + offset2_nm2) + lever_nm2));
        const gw_real_t of_moment =
            ratio_of(x->value[2] * x->value[2], moment_nm2);
        if ((of_force + of_moment) > found->largest) {
            found->largest = of_force + of_moment;
            found->widest = j;
            found->wrench = felt;
        }
        if (j == RELEASE_BANK) {
            const gw_planar_covariance_t wider = {s.xx + RELEASE_FLOOR_N2, s.xy, s.yy + RELEASE_FLOOR_N2};
            found->release = distance(wider, felt.force_x_n, felt.force_y_n);
            found->left = felt;
            found->release_n2 = wider;
        }
        if ((!channels->active) && (of_force < CALM) && (of_moment < CALM)) {
            follow_noise(channels, set, j, felt);
        }
    }
}

static bool is_step(gw_wrench_t step)
{
    return (gw_magnitude(step.force_x_n) + gw_magnitude(step.force_y_n)) > GW_ZERO;
}

/* The slow channel. */
static gw_real_t step_slow(gw_channels_t *channels, const gw_kinematics_t *kinematics,
                           const gw_channels_input_t *input, uint32_t set, gw_vector_t *force_n)
{
    const gw_channels_config_t *const config = &channels->config;
    const gw_model_forces_t forces = forces_of(&channels->slow);
    const gw_vector_t correction = gw_follower_correction(&channels->follower, kinematics, &forces);
    const bool settled = channels->ticks_of_motion > config->settle_ticks;
    gw_planar_covariance_t model = {GW_ZERO, GW_ZERO, GW_ZERO};
    gw_regime_t floor_regime = GW_REGIME_REST;
    if (input->regime != GW_REGIME_REST) {
        model = gw_follower_uncertainty(&channels->follower, kinematics, &forces,
                                        config->friction_shape * config->friction_shape);
        floor_regime = (settled && (set == (uint32_t)GW_REGIME_MOTION)) ? GW_REGIME_MOTION : GW_REGIME_CREEPING;
    }
    const gw_real_t floor_n = gw_force_floor(config->slow, floor_regime);
    force_n->x = channels->slow.value[0] + correction.x;
    force_n->y = channels->slow.value[1] + correction.y;
    if (is_step(input->zero_step)) {
        static const gw_vector_t none = {0};
        channels->slow_zero_n = (input->regime == GW_REGIME_REST) ? *force_n : none;
    }
    force_n->x -= channels->slow_zero_n.x;
    force_n->y -= channels->slow_zero_n.y;
    const gw_planar_covariance_t s = with_floor(model, config->model_multiple, floor_n * floor_n);
    return distance(s, force_n->x, force_n->y);
}

/* A contact begins: the impulse so far is that of the filter that noticed it. */
static void begin_contact(gw_channels_t *channels, uint32_t channel, gw_wrench_t wrench, gw_real_t time_s)
{
    channels->active = true;
    channels->channel = channel;
    channels->ticks_since_trip = 0U;
    channels->quiet_ticks = 0U;
    channels->impulse_s = time_s;
    channels->impulse.force_x_n = wrench.force_x_n * time_s;
    channels->impulse.force_y_n = wrench.force_y_n * time_s;
    channels->impulse.torque_nm = wrench.torque_nm * time_s;
}

/* What a low-pass holds becomes part of the baseline: a new beginning for the fast channel. */
static void take_as_baseline(gw_channels_t *channels, uint32_t j)
{
    for (uint32_t i = 0U; i < GW_SIGNAL_COUNT; i++) {
        channels->baseline.value[i] += channels->bank[j].value[i];
    }
    clear_bank(channels);
}

static void end_contact(gw_channels_t *channels, const fast_t *found)
{
    /* Along the contact's direction: what is left of it, and what nobody knows of it. */
    const gw_vector_t impulse = {channels->impulse.force_x_n, channels->impulse.force_y_n};
    const gw_vector_t d = gw_unit(impulse.x, impulse.y, gw_length(impulse));
    const gw_planar_covariance_t s = found->release_n2;
    const gw_real_t left_n = gw_max((found->left.force_x_n * d.x) + (found->left.force_y_n * d.y), GW_ZERO);
    const gw_real_t unknown_n2 = (((s.xx * d.x) * d.x) + ((GW_TWO * s.xy) * (d.x * d.y))) + ((s.yy * d.y) * d.y);
    const gw_real_t held_n = left_n + gw_sqrt(gw_max(unknown_n2, GW_ZERO));
    channels->held_n.x = held_n * d.x;
    channels->held_n.y = held_n * d.y;
    take_as_baseline(channels, RELEASE_BANK);
    channels->active = false;
    channels->ticks_since_release = 0U;
}

/* While a contact lasts: its impulse grows, until it is over. */
static void continue_contact(gw_channels_t *channels, const gw_kinematics_t *kinematics, const gw_signals_t *now,
                             const fast_t *found, gw_real_t slow)
{
    channels->ticks_since_trip = one_more(channels->ticks_since_trip);
    if (channels->ticks_since_trip <= GW_REFINE_TICKS) {
        gw_signals_t change = *now;
        for (uint32_t i = 0U; i < GW_SIGNAL_COUNT; i++) {
            change.value[i] = now->value[i] - channels->baseline.value[i];
        }
        const gw_wrench_t felt = corrected(channels, kinematics, &change);
        channels->impulse_s += channels->period_s;
        channels->impulse.force_x_n += felt.force_x_n * channels->period_s;
        channels->impulse.force_y_n += felt.force_y_n * channels->period_s;
        channels->impulse.torque_nm += felt.torque_nm * channels->period_s;
    }
    const bool quiet = (found->release < CALM) && (slow < GW_ONE);
    channels->quiet_ticks = quiet ? (channels->quiet_ticks + 1U) : 0U;
    if (((channels->quiet_ticks > QUIET_TICKS) && (channels->ticks_since_trip >= channels->config.lock_ticks)) ||
        (channels->ticks_since_trip >= channels->config.rearm_ticks)) {
        end_contact(channels, found);
    }
}

static void learn(gw_channels_t *channels, const gw_kinematics_t *kinematics, const gw_channels_input_t *input,
                  gw_real_t largest)
{
    channels->learn_ticks++;
    if (channels->learn_ticks >= LEARN_TICKS) {
        channels->learn_ticks = 0U;
        if ((!channels->active) && (input->regime == GW_REGIME_MOTION) && (largest < CALM)) {
            const gw_model_forces_t forces = forces_of(&channels->slow);
            const gw_vector_t residual = {channels->slow.value[0], channels->slow.value[1]};
            gw_follower_learn(&channels->follower, kinematics, &forces, residual);
        }
    }
}

/* Another zero: the residual jumps, and all that follows it jumps with it. What was left of slow errors ends with the
 * motion: the thresholds of rest are too small for them. */
static void take_zero_step(gw_channels_t *channels, gw_wrench_t step)
{
    if ((!channels->active) && is_step(step)) {
        take_as_baseline(channels, GW_BANK_COUNT - 1U);
    }
    channels->baseline.value[0] += step.force_x_n;
    channels->baseline.value[1] += step.force_y_n;
    channels->baseline.value[2] += step.torque_nm;
    channels->slow.value[0] += step.force_x_n;
    channels->slow.value[1] += step.force_y_n;
    channels->slow.value[2] += step.torque_nm;
}

static void count_ticks(gw_channels_t *channels, const gw_channels_input_t *input)
{
    channels->ticks_since_release = one_more(channels->ticks_since_release);
    channels->ticks_of_motion = (input->regime == GW_REGIME_MOTION) ? one_more(channels->ticks_of_motion) : 0U;
    channels->ticks_without_turn = input->turned ? 0U : one_more(channels->ticks_without_turn);
}

/* The first mean of the signals; nothing is detected meanwhile. */
static void warm_up(gw_channels_t *channels, const gw_signals_t *now)
{
    channels->warm_up_ticks++;
    const gw_real_t share = GW_ONE / (gw_real_t)channels->warm_up_ticks;
    approach(&channels->baseline, now, share);
    approach(&channels->slow, now, share);
}

void gw_channels_step(gw_channels_t *channels, const gw_kinematics_t *kinematics, const gw_channels_input_t *input,
                      gw_channels_output_t *output)
{
    const gw_signals_t now = signals_of(input);
    output->tripped = false;
    output->statistic = GW_ZERO;
    take_zero_step(channels, input->zero_step);
    count_ticks(channels, input);
    if (channels->warm_up_ticks < WARM_UP_TICKS) {
        warm_up(channels, &now);
    } else {
        const uint32_t set = (uint32_t)set_of(channels, input);
        static const fast_t nothing_found = {0};
        fast_t found = nothing_found;
        gw_vector_t slow_n;
        step_bank(channels, kinematics, &now, set, &found);
        channels->held_n.x -= channels->held_share * channels->held_n.x;
        channels->held_n.y -= channels->held_share * channels->held_n.y;
        approach(&channels->slow, &now, channels->slow_share);
        const gw_real_t slow = step_slow(channels, kinematics, input, set, &slow_n);
        /* In a reaction a lasting force is told from wrong friction by nothing: impacts alone count. */
        const gw_real_t largest = input->reacting ? found.largest : gw_max(found.largest, slow);
        output->statistic = gw_sqrt_of_square(gw_limited(largest, GW_WRENCH_MAX));
        if (channels->active) {
            continue_contact(channels, kinematics, &now, &found, slow);
        } else if (input->enabled && (largest > GW_ONE)) {
            const gw_wrench_t lasting = {slow_n.x, slow_n.y, channels->slow.value[2]};
            const bool is_fast = found.largest > GW_ONE;
            begin_contact(channels, is_fast ? GW_CHANNEL_FAST : GW_CHANNEL_SLOW, is_fast ? found.wrench : lasting,
                          is_fast ? bank_s[found.widest] : channels->config.slow_s);
            output->tripped = true;
        } else {
            approach(&channels->baseline, &now, channels->baseline_share);
        }
        learn(channels, kinematics, input, largest);
    }
    output->active = channels->active;
    output->refining = channels->active && (channels->ticks_since_trip < GW_REFINE_TICKS);
    output->channel = channels->channel;
    output->mean_wrench.force_x_n = channels->impulse.force_x_n / channels->impulse_s;
    output->mean_wrench.force_y_n = channels->impulse.force_y_n / channels->impulse_s;
    output->mean_wrench.torque_nm = channels->impulse.torque_nm / channels->impulse_s;
    output->mean_wrench = gw_wrench_limited(output->mean_wrench);
}
