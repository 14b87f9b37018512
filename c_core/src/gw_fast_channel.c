#include "giveway/gw_fast_channel.h"

#include "giveway/gw_math.h"
#include "giveway/gw_model_covariance.h"
#include "giveway/gw_planar_covariance.h"
#include "giveway/gw_ripple.h"

#if (GW_WITH_CHANNELS == 1)

#define BANK_OF_CALM 1U    /* what swings passes it, the noise of one tick does not */
#define BANK_OF_RELEASE 2U /* decides on the end of a contact, and sets the baseline there */
/* The low-pass of second order: its corner and damping. With one of first order and 18 ms, and the same shares of
 * noise, 95 % of the tuning draw's hits in motion (0.5 m/s, spring bumper) take up to 57 ms instead of 33. */
#define BANK_OF_SWING 2U
#define SWING_RADPS ((gw_real_t)95.0)
#define SWING_DAMPING ((gw_real_t)0.55)
#define RELEASE_FLOOR_N2 ((gw_real_t)16.0)
#define MODEL_TIME_S \
    ((gw_real_t)0.012)                /* the measured acceleration alone is too noisy to say how wrong the model is \
                                       */
#define HELD_TIME_S ((gw_real_t)10.0) /* for which the end of an old contact is forgiven */
#define HELD_DOUBT ((gw_real_t)1.5)   /* times what the baseline holds of it */
/* From this low-pass on an encoder's count is one of many, and the noise nearly normal: less of its variance is enough.
 * In the shorter ones counts of several wheels fall together, which normal noise does not do. */
#define FIRST_NORMAL 2U
#define NORMAL_SHARE ((gw_real_t)0.8)
/* Variance of a sum of equal errors over that of independent ones. */
#define COUNTING_ALIKE ((gw_real_t)GW_WHEEL_COUNT)
#define COUNTED_KEEP ((gw_real_t)0.98)
#define NOISE_TIME_S ((gw_real_t)3.0)
#define NOISE_MIN_N2 ((gw_real_t)1.0e-9)
#define NOISE_MAX_N2 ((gw_real_t)1.0e10)
#define RIPPLE_LEAST ((gw_real_t)0.02) /* of the friction of rollers that slide */
#define RIPPLE_MAX_N ((gw_real_t)1.0e5)
/* How much more the moment is doubted where rollers are uneven: their force has the arm of one row or the other. */
#define RIPPLE_MOMENT GW_TWO
/* Variance behind a low-pass of what steps between rows look like, over the square of one that all wheels have at once.
 * In 10 h of free motion the tuning draw's single rollers have 12 false alarms, without it and RIPPLE_MOMENT 27. */
#define ROW_SHARE ((gw_real_t)0.03)
#define ROW_MAX_KG2PS2 ((gw_real_t)1.0e12)
#define NOISE_CLIP ((gw_real_t)6.0) /* an outlier counts as this many variances */
/* Bounds of what is kept, for every configuration. */
#define VARIANCE_MAX ((gw_real_t)8.0e17)
#define HELD_MAX_N ((gw_real_t)1.0e6)
#define TURNED_MAX_N2 ((gw_real_t)2.0e12)
#define SLIPPING_MAX_NM2 ((gw_real_t)1.0e15)
#define LEAST_SQUARE_N2 ((gw_real_t)1.0e-8)
#define LETTING_GO_MAX_N2 ((gw_real_t)1.0e12)
#define MOMENT_PER_FORCE_MAX ((gw_real_t)1.0e12)
#define SWING_SHARE_MAX ((gw_real_t)0.25)
#define SWING_LOSS_MAX ((gw_real_t)0.55)
static const gw_real_t bank_s[GW_SENSOR_COUNT][GW_BANK_COUNT] = {
    {(gw_real_t)0.002, (gw_real_t)0.006, (gw_real_t)0.018, (gw_real_t)0.05},
    {(gw_real_t)0.0015, (gw_real_t)0.004, (gw_real_t)0.018, (gw_real_t)0.05},
};

gw_real_t gw_fast_channel_time(const gw_fast_channel_t *channel, uint32_t j)
{
    return bank_s[channel->sensor][j];
}

/* What passes the alignment, corner w, and then a low-pass of the bank, together G with numerator g: the integrals of
 * |G|^2, |s G|^2 and |s^2 G|^2/g^2. */
typedef struct {
    gw_real_t force;
    gw_real_t rate;
    gw_real_t position;
    gw_real_t numerator;
} passed_t;

/* G = w^2 a/((s + w)^2 (s + a)), a = 1/tau */
static passed_t passed_first_order(gw_real_t w, gw_real_t tau_s)
{
    const gw_real_t a = GW_ONE / tau_s;
    const gw_real_t both = (w + a) * (w + a);
    const gw_real_t ratio = w / ((w * tau_s) + GW_ONE); /* w a/(w + a) */
    const passed_t passed = {((w * a) * ((GW_TWO * w) + a)) / ((gw_real_t)4.0 * both),
                             (w * (ratio * ratio)) / (gw_real_t)4.0, (w + (GW_TWO * a)) / ((gw_real_t)4.0 * both),
                             (w * w) * a};
    return passed;
}

/* G = w^2 v^2/((s + w)^2 (s^2 + 2 zeta v s + v^2)), by the formula for four poles with times in 1/v. */
static passed_t passed_second_order(gw_real_t w)
{
    const gw_real_t v = SWING_RADPS;
    const gw_real_t x = w / v;
    const gw_real_t d0 = x * x;
    const gw_real_t d1 = (GW_TWO * x) + ((GW_TWO * SWING_DAMPING) * d0);
    const gw_real_t d2 = (d0 + GW_ONE) + (((gw_real_t)4.0 * SWING_DAMPING) * x);
    const gw_real_t d3 = (GW_TWO * x) + (GW_TWO * SWING_DAMPING);
    /* Above 0.002 for every corner that is allowed; only provers that look at ranges need to be told. */
    const gw_real_t stable = gw_max((((d1 * d2) - (d0 * d3)) * d3) - (d1 * d1), (gw_real_t)0.001);
    const gw_real_t half_per = GW_HALF / stable;
    const passed_t passed = {(((d2 * d3) - d1) * (d0 * half_per)) * v, ((((d0 * d0) * d3) * half_per) * v) * (v * v),
                             (d1 * half_per) / ((v * v) * v), (w * w) * (v * v)};
    return passed;
}

static passed_t passed_bank(gw_real_t w, uint32_t sensor, uint32_t j)
{
    return (j == BANK_OF_SWING) ? passed_second_order(w) : passed_first_order(w, bank_s[sensor][j]);
}

/* Variance of a force behind a low-pass of the bank, from white noise of a position and of a force. */
static gw_real_t predicted_n2(const gw_channels_noise_t *noise, uint32_t j, gw_real_t position_m2)
{
    const passed_t passed = passed_bank(noise->cutoff_radps, GW_BY_ENCODERS, j);
    const gw_real_t force_n_per_m = gw_min(noise->mass_kg * passed.numerator, (gw_real_t)1.0e15);
    const gw_real_t of_position = passed.position * (force_n_per_m * force_n_per_m);
    return noise->period_s *
           ((of_position * position_m2) + ((passed.force * noise->force_noise_n) * noise->force_noise_n));
}

/* The same with an accelerometer, whose noise is white, and a gyro, whose derivative carries it to the centre. */
static gw_real_t felt_rate_share(const gw_channels_noise_t *noise, uint32_t j)
{
    const passed_t passed = passed_bank(noise->imu.cutoff_radps, GW_BY_IMU, j);
    const gw_real_t yaw_rate = noise->imu.yaw_rate_radps;
    return (noise->period_s * passed.rate) * (yaw_rate * yaw_rate);
}

static gw_real_t felt_n2(const gw_channels_noise_t *noise, uint32_t j)
{
    const passed_t passed = passed_bank(noise->imu.cutoff_radps, GW_BY_IMU, j);
    const gw_real_t of_force = noise->period_s * passed.force;
    const gw_real_t white = noise->imu.acceleration_mps2;
    const gw_real_t arm_m = noise->imu.arm_m;
    const gw_real_t acceleration2 =
        gw_min((of_force * (white * white)) + (GW_HALF * (felt_rate_share(noise, j) * (arm_m * arm_m))),
               (gw_real_t)1.0e20); /* beyond NOISE_MAX_N2 for the lightest robot */
    return ((noise->mass_kg * noise->mass_kg) * acceleration2) +
           ((of_force * noise->force_noise_n) * noise->force_noise_n);
}

/* No two rollers are alike: what the friction of each wheel at least varies by, as a force behind a low-pass. */
static gw_real_t ripple_n2(const gw_channels_noise_t *noise, uint32_t j)
{
    /* How much of it passes each low-pass: it is slow, a roller bears for 0.1 s and more. */
    static const gw_real_t passed[GW_BANK_COUNT] = {GW_ONE, (gw_real_t)0.9, (gw_real_t)0.7, (gw_real_t)0.4};
    const gw_real_t varies_n = gw_min(RIPPLE_LEAST * noise->sliding_n, RIPPLE_MAX_N);
    return passed[j] * (varies_n * varies_n);
}

/* Noise of both sensors in a regime, before anything was followed. In motion the errors of friction are larger than the
 * noise of an IMU: what is forgiven with encoders is forgiven with it, too, between rest and motion always, in motion
 * until it has been followed and as far as vibration may go. */
static void set_noise(gw_fast_channel_t *channel, const gw_channels_noise_t *noise, uint32_t set, uint32_t j,
                      gw_real_t position_m2)
{
    /* Least noise of each regime over the predicted one, and the first guess. Slow wheels count irregularly, which the
     * short low-passes see. Where it changes slowly counts are less noisy than white noise: the longest sees that. The
     * one before it sees counts of several wheels that fall together. */
    static const gw_real_t least_share[GW_NOISE_SETS][GW_BANK_COUNT] = {
        {(gw_real_t)0.4, (gw_real_t)0.4, (gw_real_t)0.4, (gw_real_t)0.4},
        {(gw_real_t)0.5, (gw_real_t)0.5, (gw_real_t)0.7, (gw_real_t)0.06},
        {(gw_real_t)0.6, (gw_real_t)0.6, (gw_real_t)1.4, (gw_real_t)0.06},
    };
    static const gw_real_t first_share[GW_NOISE_SETS][GW_BANK_COUNT] = {
        {(gw_real_t)1.0, (gw_real_t)1.0, (gw_real_t)1.0, (gw_real_t)1.0},
        {(gw_real_t)2.0, (gw_real_t)2.0, (gw_real_t)0.7, (gw_real_t)0.3},
        {(gw_real_t)1.0, (gw_real_t)1.0, (gw_real_t)1.4, (gw_real_t)0.5},
    };
    const gw_real_t by_encoders_n2 = gw_clamp(predicted_n2(noise, j, position_m2), NOISE_MIN_N2, NOISE_MAX_N2 / GW_TWO);
    const gw_real_t by_imu_n2 = gw_clamp(felt_n2(noise, j), NOISE_MIN_N2, NOISE_MAX_N2);
    channel->least_noise_n2[GW_BY_ENCODERS][set][j] = least_share[set][j] * by_encoders_n2;
    channel->noise_n2[GW_BY_ENCODERS][set][j] = first_share[set][j] * by_encoders_n2;
    const gw_real_t shaking_n = noise->mass_kg * noise->imu.vibration_mps2;
    const gw_real_t forgiven_n2 = channel->noise_n2[GW_BY_ENCODERS][set][j];
    gw_real_t *const least_n2 = &channel->least_noise_n2[GW_BY_IMU][set][j];
    gw_real_t *const first_n2 = &channel->noise_n2[GW_BY_IMU][set][j];
    *least_n2 = by_imu_n2;
    *first_n2 = by_imu_n2;
    if (set == (uint32_t)GW_REGIME_CREEPING) {
        *least_n2 = gw_max(by_imu_n2, forgiven_n2);
        *first_n2 = *least_n2;
    } else if (set == (uint32_t)GW_REGIME_MOTION) {
        *first_n2 = gw_max(by_imu_n2, gw_min(forgiven_n2, by_imu_n2 + (shaking_n * shaking_n)));
    } else {
        /* at rest the sensor's own noise */
    }
    const gw_real_t uneven_n2 = (set == (uint32_t)GW_REGIME_REST) ? GW_ZERO : ripple_n2(noise, j);
    for (uint32_t sensor = 0U; sensor < GW_SENSOR_COUNT; sensor++) {
        gw_real_t *const least = &channel->least_noise_n2[sensor][set][j];
        gw_real_t *const first = &channel->noise_n2[sensor][set][j];
        *least = gw_min(*least + uneven_n2, NOISE_MAX_N2);
        *first = gw_min(*first + uneven_n2, NOISE_MAX_N2);
    }
}

void gw_fast_channel_init(gw_fast_channel_t *channel, const gw_channels_config_t *config,
                          const gw_channels_noise_t *noise)
{
    /* Over the noise that is predicted: the errors of counts last for a while, which the long low-passes see. */
    static const gw_real_t count_share[GW_BANK_COUNT] = {GW_ONE, GW_ONE, GW_TWO, GW_TWO};
    const gw_real_t arm_m = noise->wheel_distance_m;
    const gw_real_t gyration_m2 = noise->yaw_inertia_kgm2 / noise->mass_kg;
    /* Of a position of the base: that of a wheel times 2/n, as the wheels add up. */
    const gw_real_t twist_m = gw_min(noise->twist_noise_m, GW_ONE);
    const gw_real_t count_m = gw_min(noise->encoder_step_m, GW_ONE);
    const gw_real_t twist_m2 = GW_TWO_PER_WHEEL * (twist_m * twist_m);
    const gw_real_t observed_m = gw_min(noise->observed_step_m, GW_ONE);
    const gw_real_t count_m2 = GW_TWO_PER_WHEEL * ((count_m * count_m) / (gw_real_t)12.0);
    const gw_real_t observed_m2 = GW_TWO_PER_WHEEL * ((observed_m * observed_m) / (gw_real_t)12.0);
    const gw_real_t coarser_m2 = gw_max(count_m2 - observed_m2, GW_ZERO);
    channel->sliding_n = gw_min(noise->sliding_n, GW_CHANGE_MAX);
    channel->mass2_kg2 = noise->mass_kg * noise->mass_kg;
    channel->moment_per_force_m2 =
        gw_min((gyration_m2 * gyration_m2) / ((GW_TWO * arm_m) * arm_m), MOMENT_PER_FORCE_MAX);
    channel->baseline_share = gw_share_of(noise->period_s, config->baseline_s);
    channel->model_share = gw_share_of(noise->period_s, MODEL_TIME_S);
    channel->held_keep = gw_max(GW_ONE - (noise->period_s / HELD_TIME_S), GW_ZERO);
    const gw_real_t swing = gw_min(SWING_RADPS * noise->period_s, GW_HALF); /* slower clocks: stable, only slower */
    channel->swing_share = swing * swing;
    channel->swing_loss = (GW_TWO * SWING_DAMPING) * swing;
    channel->noise_share = gw_share_of((gw_real_t)GW_BANK_COUNT * noise->period_s, NOISE_TIME_S); /* one per tick */
    for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
        channel->gyro_noise_nm2[GW_BY_ENCODERS][j] = GW_ZERO;
        channel->gyro_noise_nm2[GW_BY_IMU][j] =
            gw_min((noise->yaw_inertia_kgm2 * noise->yaw_inertia_kgm2) * felt_rate_share(noise, j), NOISE_MAX_N2);
        for (uint32_t set = 0U; set < GW_NOISE_SETS; set++) {
            const bool counting = (set != (uint32_t)GW_REGIME_REST);
            set_noise(channel, noise, set, j, counting ? (twist_m2 + observed_m2) : twist_m2);
        }
        channel->count_n2[j] = gw_clamp(count_share[j] * predicted_n2(noise, j, coarser_m2), GW_ZERO, NOISE_MAX_N2);
        const gw_real_t step_kgps = noise->mass_kg / bank_s[GW_BY_ENCODERS][j];
        channel->row_kg2ps2[j] = gw_clamp(ROW_SHARE * (step_kgps * step_kgps), GW_ZERO, ROW_MAX_KG2PS2);
        for (uint32_t sensor = 0U; sensor < GW_SENSOR_COUNT; sensor++) {
            channel->bank_share[sensor][j] = gw_share_of(noise->period_s, bank_s[sensor][j]);
        }
    }
    gw_fast_channel_restart(channel);
}

static void clear_bank(gw_fast_channel_t *channel)
{
    static const gw_wrench_t nothing = {0};
    static const gw_model_forces_t no_forces = {0};
    channel->model = no_forces;
    channel->swing = nothing;
    for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
        channel->bank[j] = nothing;
    }
}

void gw_fast_channel_restart(gw_fast_channel_t *channel)
{
    static const gw_balance_t no_balance = {0};
    static const gw_wrench_t nothing = {0};
    static const gw_vector_t no_force = {0};
    static const gw_planar_covariance_t no_doubt = {0};
    channel->baseline = no_balance;
    channel->model_n2 = no_doubt;
    channel->rocking_n2 = GW_ZERO;
    channel->letting_go_n2 = GW_ZERO;
    channel->row_m2ps2 = GW_ZERO;
    channel->moment_nm2 = GW_ZERO;
    channel->moment_noise_m2 = channel->moment_per_force_m2;
    channel->held = nothing;
    channel->doubt_n = no_force;
    channel->carried_n = no_force;
    channel->held_share = GW_ZERO;
    channel->sensor = GW_BY_ENCODERS;
    channel->shaking_n2 = GW_ZERO;
    channel->counted = GW_ZERO;
    channel->followed = 0U;
    clear_bank(channel);
}

/* What the initialisation sets, and what is followed of the noise. */
static bool shares_and_noise_hold(const gw_fast_channel_t *channel)
{
    bool holds =
        gw_in_range(channel->baseline_share, GW_ZERO, GW_HALF) && gw_in_range(channel->model_share, GW_ZERO, GW_HALF) &&
        gw_in_range(channel->noise_share, GW_ZERO, GW_HALF) && gw_in_range(channel->held_keep, GW_ZERO, GW_ONE) &&
        gw_in_range(channel->swing_share, GW_ZERO, SWING_SHARE_MAX) &&
        gw_in_range(channel->swing_loss, GW_ZERO, SWING_LOSS_MAX) &&
        gw_in_range(channel->sliding_n, GW_ZERO, GW_CHANGE_MAX) &&
        gw_in_range(channel->moment_per_force_m2, GW_ZERO, MOMENT_PER_FORCE_MAX) &&
        gw_in_range(channel->moment_noise_m2, GW_ZERO, COUNTING_ALIKE * MOMENT_PER_FORCE_MAX);
    for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
        holds = holds && gw_in_range(channel->count_n2[j], GW_ZERO, NOISE_MAX_N2) &&
                gw_in_range(channel->row_kg2ps2[j], GW_ZERO, ROW_MAX_KG2PS2);
        for (uint32_t sensor = 0U; sensor < GW_SENSOR_COUNT; sensor++) {
            holds = holds && gw_in_range(channel->bank_share[sensor][j], GW_ZERO, GW_HALF) &&
                    gw_in_range(channel->gyro_noise_nm2[sensor][j], GW_ZERO, NOISE_MAX_N2);
            for (uint32_t set = 0U; set < GW_NOISE_SETS; set++) {
                holds = holds && gw_in_range(channel->least_noise_n2[sensor][set][j], GW_ZERO, NOISE_MAX_N2) &&
                        gw_in_range(channel->noise_n2[sensor][set][j], GW_ZERO, NOISE_MAX_N2);
            }
        }
    }
    return holds;
}

bool gw_fast_channel_invariant_holds(const gw_fast_channel_t *channel)
{
    bool holds = (channel != NULL);
    if (holds) {
        holds = shares_and_noise_hold(channel) && gw_balance_is_within(&channel->baseline, GW_BALANCE_MAX) &&
                gw_model_forces_are_within(&channel->model, GW_CHANGE_MAX) &&
                gw_wrench_is_within(&channel->swing, GW_CHANGE_MAX) &&
                gw_planar_is_within(channel->model_n2, VARIANCE_MAX) &&
                gw_in_range(channel->moment_nm2, GW_ZERO, VARIANCE_MAX) &&
                gw_in_range(channel->rocking_n2, GW_ZERO, VARIANCE_MAX) &&
                gw_in_range(channel->letting_go_n2, GW_ZERO, LETTING_GO_MAX_N2) &&
                gw_in_range(channel->row_m2ps2, GW_ZERO, GW_ROW_MAX_M2PS2) &&
                gw_wrench_is_within(&channel->held, HELD_MAX_N) && gw_within(channel->doubt_n.x, HELD_MAX_N) &&
                gw_within(channel->doubt_n.y, HELD_MAX_N) && gw_within(channel->carried_n.x, HELD_MAX_N) &&
                gw_within(channel->carried_n.y, HELD_MAX_N) && gw_in_range(channel->held_share, GW_ZERO, GW_ONE) &&
                (channel->followed < GW_BANK_COUNT) && (channel->sensor < GW_SENSOR_COUNT) &&
                gw_in_range(channel->shaking_n2, GW_ZERO, NOISE_MAX_N2) &&
                gw_in_range(channel->counted, GW_ZERO, GW_TWO);
        for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
            holds = holds && gw_wrench_is_within(&channel->bank[j], GW_CHANGE_MAX);
        }
    }
    return holds;
}

void gw_fast_channel_begin(gw_fast_channel_t *channel, const gw_balance_t *balance, gw_real_t share)
{
    gw_balance_approach(&channel->baseline, balance, share);
}

void gw_fast_channel_follow(gw_fast_channel_t *channel, const gw_balance_t *balance)
{
    gw_balance_approach(&channel->baseline, balance, channel->baseline_share);
}

/* What yaw inertia and centre of mass may be wrong by, and the rows of rollers, ripple2 more where those are uneven:
 * variance of the moment. */
static gw_real_t moment_of_model(const gw_channels_config_t *config, const gw_model_forces_t *change,
                                 gw_real_t forces_n2, gw_real_t ripple2)
{
    const gw_real_t multiple2 = config->model_multiple * config->model_multiple;
    const gw_real_t lever_nm2 = (config->lever_m * config->lever_m) * forces_n2;
    const gw_real_t turning_nm = config->yaw_inertia * change->inertia_moment_nm;
    const gw_real_t offset_nm2 =
        (config->centre_of_mass_m * config->centre_of_mass_m) *
        ((change->inertia_n.x * change->inertia_n.x) + (change->inertia_n.y * change->inertia_n.y));
    return (multiple2 * ((turning_nm * turning_nm) + offset_nm2)) +
           ((multiple2 + (RIPPLE_MOMENT * ripple2)) * lever_nm2);
}

/* A robot that turns on the spot turns all its wheels alike and its rollers not at all: near a whole number of counts
 * per tick the encoders' errors are no noise, they jump together. */
static bool counts_alike(const gw_fast_channel_t *channel, gw_regime_t regime, gw_real_t forces_n2)
{
    return (regime != GW_REGIME_REST) && (channel->sensor == GW_BY_ENCODERS) &&
           (forces_n2 < (channel->sliding_n * channel->sliding_n));
}

/* One component of the low-pass of second order, in semi-implicit steps. */
static void swing(const gw_fast_channel_t *channel, gw_real_t *value, gw_real_t *moved, gw_real_t target)
{
    const gw_real_t faster = channel->swing_share * (target - *value);
    *moved = gw_limited((*moved + faster) - (channel->swing_loss * *moved), GW_CHANGE_MAX);
    *value = gw_limited(*value + *moved, GW_CHANGE_MAX);
}

static void move_bank(gw_fast_channel_t *channel, const gw_wrench_t *change)
{
    GW_UNROLLED
    for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
        if (j != BANK_OF_SWING) {
            gw_wrench_approach(&channel->bank[j], change, channel->bank_share[channel->sensor][j], GW_CHANGE_MAX);
        }
    }
    gw_wrench_t *const swung = &channel->bank[BANK_OF_SWING];
    swing(channel, &swung->force_x_n, &channel->swing.force_x_n, change->force_x_n);
    swing(channel, &swung->force_y_n, &channel->swing.force_y_n, change->force_y_n);
    swing(channel, &swung->torque_nm, &channel->swing.torque_nm, change->torque_nm);
}

void gw_fast_channel_feel(gw_fast_channel_t *channel, bool felt, gw_real_t shaking_mps2_2)
{
    channel->sensor = felt ? GW_BY_IMU : GW_BY_ENCODERS;
    channel->shaking_n2 = felt ? gw_clamp(channel->mass2_kg2 * shaking_mps2_2, GW_ZERO, NOISE_MAX_N2) : GW_ZERO;
}

void gw_fast_channel_count(gw_fast_channel_t *channel, gw_real_t counted)
{
    channel->counted = gw_clamp(gw_max(counted, COUNTED_KEEP * channel->counted), GW_ZERO, GW_TWO);
}

/* The noise that was followed, and no less than the vibration that an IMU sees now, which may have grown since. */
static gw_real_t followed_noise(const gw_fast_channel_t *channel, gw_regime_t regime, uint32_t j)
{
    /* How much of it passes each low-pass: it is measured where it changes fast, 0.29 of it at 60 Hz. */
    static const gw_real_t passed[GW_BANK_COUNT] = {(gw_real_t)3.0, (gw_real_t)1.0, (gw_real_t)0.08, (gw_real_t)0.01};
    return gw_max(channel->noise_n2[channel->sensor][regime][j], passed[j] * channel->shaking_n2);
}

/* Do encoder counts matter? At rest they do not change. */
static bool is_counting(const gw_fast_channel_t *channel, gw_regime_t regime)
{
    return (regime != GW_REGIME_REST) && (channel->sensor == GW_BY_ENCODERS);
}

/* The same, and what counts add. */
static gw_real_t noise_of(const gw_fast_channel_t *channel, gw_regime_t regime, uint32_t j)
{
    gw_real_t noise_n2 = followed_noise(channel, regime, j);
    if (is_counting(channel, regime)) {
        noise_n2 += channel->counted * channel->count_n2[j];
    }
    return noise_n2;
}

/* Follows the noise of a low-pass in one set. It has in it what counts add: taken off, 20 h of free motion had 4 false
 * alarms instead of none. */
static void follow_noise_of(gw_fast_channel_t *channel, gw_regime_t set, uint32_t j)
{
    const gw_wrench_t *const felt = &channel->bank[j];
    const gw_real_t before_n2 = followed_noise(channel, set, j);
    const gw_real_t square_n2 = GW_HALF * ((felt->force_x_n * felt->force_x_n) + (felt->force_y_n * felt->force_y_n));
    const gw_real_t clipped_n2 = gw_min(square_n2, NOISE_CLIP * before_n2);
    const gw_real_t after_n2 = before_n2 + (channel->noise_share * (clipped_n2 - before_n2));
    channel->noise_n2[channel->sensor][set][j] =
        gw_clamp(after_n2, channel->least_noise_n2[channel->sensor][set][j], NOISE_MAX_N2);
}

/* One low-pass in a tick is enough. Rollers are as uneven slow as fast: what is felt in one counts in both. */
static void follow_noise(gw_fast_channel_t *channel, gw_regime_t regime)
{
    if (regime == GW_REGIME_REST) {
        follow_noise_of(channel, GW_REGIME_REST, channel->followed);
    } else {
        follow_noise_of(channel, GW_REGIME_CREEPING, channel->followed);
        follow_noise_of(channel, GW_REGIME_MOTION, channel->followed);
    }
}

void gw_fast_channel_doubt(gw_fast_channel_t *channel, const gw_channels_config_t *config,
                           const gw_kinematics_t *kinematics, const gw_follower_t *follower,
                           const gw_balance_t *balance, gw_regime_t regime, const gw_doubts_t *doubts)
{
    const gw_real_t arm_m = kinematics->wheel_distance_m;
    const bool rests = (regime == GW_REGIME_REST);
    const gw_planar_covariance_t of_model =
        gw_model_covariance(config, kinematics, follower, &channel->model, &balance->model,
                            rests ? GW_ZERO : channel->sliding_n, config->presliding);
    const gw_planar_covariance_t of_rollers =
        gw_ripple_added(rests ? GW_ZERO : doubts->ripple2, kinematics, &balance->model.friction_n, of_model);
    channel->model_n2 = gw_slip_added(&doubts->slip, kinematics, gw_planar_raised(of_rollers, doubts->gear_n2));
    channel->rocking_n2 = doubts->rocking_n2;
    channel->letting_go_n2 =
        rests ? GW_ZERO
              : gw_clamp(doubts->usual2 * (channel->sliding_n * channel->sliding_n), GW_ZERO, LETTING_GO_MAX_N2);
    channel->row_m2ps2 = is_counting(channel, regime) ? doubts->row_m2ps2 : GW_ZERO;
    /* Each gear's error has the wheel's distance as its arm, and half of it is in each component of the force. A wheel
     * that slips has a force along one axis, and half of the moment that independent wheels have. */
    channel->moment_nm2 =
        (moment_of_model(config, &channel->model, doubts->forces_n2, rests ? GW_ZERO : doubts->ripple2) +
         ((GW_TWO * doubts->gear_n2) * (arm_m * arm_m))) +
        gw_min((GW_HALF * channel->moment_per_force_m2) * gw_slip_sum(&doubts->slip), SLIPPING_MAX_NM2);
    channel->moment_noise_m2 = counts_alike(channel, regime, doubts->forces_n2)
                                   ? (COUNTING_ALIKE * channel->moment_per_force_m2)
                                   : channel->moment_per_force_m2;
}

bool gw_fast_channel_is_calm(const gw_fast_channel_t *channel, const gw_channels_config_t *config, gw_real_t share)
{
    const gw_wrench_t *const x = &channel->bank[BANK_OF_CALM];
    const gw_real_t floor_n = gw_force_floor(config->fast, GW_REGIME_REST);
    return ((x->force_x_n * x->force_x_n) + (x->force_y_n * x->force_y_n)) < (share * (floor_n * floor_n));
}

/* What the baseline holds of a contact grows with a contact that lasts and grows: the baseline follows it. */
static void hold(gw_fast_channel_t *channel, const gw_wrench_t *change, bool follows)
{
    gw_wrench_t *const held = &channel->held;
    const gw_real_t keep = channel->held_keep;
    const bool grows = (((held->force_x_n + channel->doubt_n.x) * change->force_x_n) +
                        ((held->force_y_n + channel->doubt_n.y) * change->force_y_n)) > GW_ZERO;
    const gw_real_t share = (follows && grows) ? (channel->held_share * channel->baseline_share) : GW_ZERO;
    held->force_x_n = gw_limited((keep * held->force_x_n) + (share * change->force_x_n), HELD_MAX_N);
    held->force_y_n = gw_limited((keep * held->force_y_n) + (share * change->force_y_n), HELD_MAX_N);
    held->torque_nm = gw_limited((keep * held->torque_nm) + (share * change->torque_nm), HELD_MAX_N);
    channel->doubt_n.x = keep * channel->doubt_n.x;
    channel->doubt_n.y = keep * channel->doubt_n.y;
    channel->held_share = keep * channel->held_share;
}

/* The baseline follows an old contact, its end, too. */
static void carry(gw_fast_channel_t *channel, const gw_wrench_t *change, bool follows)
{
    const gw_wrench_t *const held = &channel->held;
    gw_vector_t *const carried = &channel->carried_n;
    if (((carried->x * held->force_x_n) + (carried->y * held->force_y_n)) > GW_ZERO) {
        const gw_real_t share = follows ? (channel->held_share * channel->baseline_share) : GW_ZERO;
        carried->x = gw_limited((channel->held_keep * carried->x) + (share * change->force_x_n), HELD_MAX_N);
        carried->y = gw_limited((channel->held_keep * carried->y) + (share * change->force_y_n), HELD_MAX_N);
    } else {
        carried->x = GW_ZERO;
        carried->y = GW_ZERO;
    }
}

/* A contact that lasts may turn, so its end has a part across: as large as its part along, (x h)^2/|x|^2. */
static gw_real_t turned_variance(const gw_wrench_t *held, gw_vector_t force_n)
{
    const gw_real_t along = (held->force_x_n * force_n.x) + (held->force_y_n * force_n.y);
    const gw_real_t square_n2 = (force_n.x * force_n.x) + (force_n.y * force_n.y);
    return gw_min((along * along) / gw_max(square_n2, LEAST_SQUARE_N2), TURNED_MAX_N2);
}

/* Variance behind a low-pass. What a stuck wheel lets go rings with 100 to 200 N for 3 ms, which the short ones see. */
static gw_real_t let_go(const gw_fast_channel_t *channel, uint32_t j)
{
    static const gw_real_t share[GW_BANK_COUNT] = {(gw_real_t)25.0, (gw_real_t)4.0, (gw_real_t)0.56, GW_ZERO};
    return share[j] * channel->letting_go_n2;
}

void gw_fast_channel_step(gw_fast_channel_t *channel, const gw_channels_config_t *config,
                          const gw_kinematics_t *kinematics, const gw_follower_t *follower, const gw_balance_t *balance,
                          gw_regime_t regime, bool quiet, gw_fast_found_t *found)
{
    const gw_balance_t change = gw_balance_difference(balance, &channel->baseline);
    const gw_vector_t correction = gw_follower_correction(follower, kinematics, &change.model);
    const gw_vector_t held = {HELD_DOUBT * (channel->held.force_x_n + channel->doubt_n.x),
                              HELD_DOUBT * (channel->held.force_y_n + channel->doubt_n.y)};
    const gw_real_t held_nm = HELD_DOUBT * channel->held.torque_nm;
    found->change.force_x_n = change.residual.force_x_n + correction.x;
    found->change.force_y_n = change.residual.force_y_n + correction.y;
    found->change.torque_nm = change.residual.torque_nm;
    move_bank(channel, &found->change);
    gw_model_forces_approach(&channel->model, &change.model, channel->model_share, GW_CHANGE_MAX);
    const gw_planar_spread_t along = gw_planar_spread(channel->model_n2);
    const gw_planar_spread_t against = gw_planar_spread(gw_planar_widened(channel->model_n2, held));
    const gw_real_t against_nm2 = channel->moment_nm2 + (held_nm * held_nm);
    const gw_real_t floor_n = gw_force_floor(config->fast, regime);
    const gw_real_t noise_multiple =
        (channel->sensor == GW_BY_IMU) ? config->imu_noise_multiple : config->noise_multiple;
    const gw_real_t square = noise_multiple * noise_multiple;
    const gw_real_t normal_square = (channel->sensor == GW_BY_IMU) ? square : (NORMAL_SHARE * square);
    found->statistic = GW_ZERO;
    found->widest = 0U;
    for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
        const gw_wrench_t *const x = &channel->bank[j];
        const gw_real_t noise_square = (j < FIRST_NORMAL) ? square : normal_square;
        const gw_real_t still_n2 = (noise_square * noise_of(channel, regime, j)) + (floor_n * floor_n);
        const gw_vector_t force_n = {x->force_x_n, x->force_y_n};
        const bool ends = ((held.x * force_n.x) + (held.y * force_n.y)) < GW_ZERO;
        const gw_real_t turned_n2 = ends ? turned_variance(&channel->held, force_n) : GW_ZERO;
        const gw_real_t n2 = ((still_n2 + channel->rocking_n2) + turned_n2) + let_go(channel, j);
        const gw_planar_spread_t *const spread = ends ? &against : &along;
        /* A small force may point anywhere while the moment of an old contact ends. Asked of the force, too, in 4,200
         * runs of the tuning draw's planar robots with an IMU 21 have a reaction without contact, with this 14. */
        const bool unwinds = (held_nm * x->torque_nm) < GW_ZERO;
        const gw_real_t moment_nm2 = unwinds ? against_nm2 : channel->moment_nm2;
        /* Not in the force: with it the tuning draw's planar robots notice hits in motion a millisecond later. */
        const gw_real_t moment_n2 = n2 + (noise_square * (channel->row_m2ps2 * channel->row_kg2ps2[j]));
        const gw_real_t statistic = gw_planar_distance(spread, n2, force_n) +
                                    gw_planar_ratio(x->torque_nm * x->torque_nm,
                                                    ((moment_n2 * channel->moment_noise_m2) + moment_nm2) +
                                                        (noise_square * channel->gyro_noise_nm2[channel->sensor][j]));
        if (statistic > found->statistic) {
            found->statistic = statistic;
            found->widest = j;
        }
        if (j == BANK_OF_RELEASE) {
            /* What swings is waited for. */
            found->release_n2 = still_n2 + RELEASE_FLOOR_N2;
            found->release = gw_planar_distance(spread, found->release_n2, force_n);
        }
    }
    carry(channel, &channel->bank[GW_BANK_COUNT - 1U], quiet);
    hold(channel, &channel->bank[GW_BANK_COUNT - 1U], quiet);
    if (quiet && (found->statistic < GW_HALF)) {
        follow_noise(channel, regime);
    }
    channel->followed = (channel->followed + 1U) % GW_BANK_COUNT;
}

void gw_fast_channel_take_zero(gw_fast_channel_t *channel, gw_wrench_t step, bool adopt)
{
    channel->baseline.residual = gw_balance_sum(channel->baseline.residual, step);
    if (adopt) {
        channel->baseline.residual = gw_balance_sum(channel->baseline.residual, channel->bank[GW_BANK_COUNT - 1U]);
        clear_bank(channel);
    }
}

void gw_fast_channel_release(gw_fast_channel_t *channel, const gw_balance_t *balance, const gw_fast_found_t *found,
                             gw_vector_t direction, bool lasts)
{
    /* Along the contact's direction: what is left of it, and what nobody knows of it. */
    const gw_vector_t d = direction;
    const gw_wrench_t *const left = &channel->bank[BANK_OF_RELEASE];
    const gw_planar_covariance_t m = channel->model_n2;
    const gw_real_t left_n = gw_max((left->force_x_n * d.x) + (left->force_y_n * d.y), GW_ZERO);
    const gw_real_t unknown_n2 =
        ((((m.xx * d.x) * d.x) + ((GW_TWO * m.xy) * (d.x * d.y))) + ((m.yy * d.y) * d.y)) + found->release_n2;
    const gw_real_t doubt_n = gw_min(gw_sqrt(gw_max(unknown_n2, GW_ZERO)), HELD_MAX_N);
    gw_wrench_t *const held = &channel->held;
    const gw_real_t x_n = lasts ? left->force_x_n : (left_n * d.x);
    const gw_real_t y_n = lasts ? left->force_y_n : (left_n * d.y);
    held->force_x_n = gw_limited(held->force_x_n + x_n, HELD_MAX_N);
    held->force_y_n = gw_limited(held->force_y_n + y_n, HELD_MAX_N);
    channel->carried_n.x = gw_limited(channel->carried_n.x + x_n, HELD_MAX_N);
    channel->carried_n.y = gw_limited(channel->carried_n.y + y_n, HELD_MAX_N);
    held->torque_nm = gw_limited(held->torque_nm + left->torque_nm, HELD_MAX_N);
    channel->doubt_n.x = doubt_n * d.x;
    channel->doubt_n.y = doubt_n * d.y;
    channel->held_share = GW_ONE;
    /* The baseline becomes this balance, but for the change beyond what the low-pass holds: that is noise. */
    channel->baseline.model = balance->model;
    const gw_wrench_t beyond = {left->force_x_n - found->change.force_x_n, left->force_y_n - found->change.force_y_n,
                                left->torque_nm - found->change.torque_nm};
    channel->baseline.residual = gw_balance_sum(balance->residual, beyond);
    clear_bank(channel);
}

#endif
