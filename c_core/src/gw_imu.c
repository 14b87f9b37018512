#include "giveway/gw_imu.h"

#include "giveway/gw_math.h"

#if (GW_WITH_CHANNELS == 1)

#define YAW_RATE 2U /* index of the gyro's signal, after the axes */
/* What the robot does on purpose passes two low-passes of this, s; the rest is vibration. */
#define SMOOTH_S ((gw_real_t)0.004)
/* Time for which its mean square is taken, s: in that of a start it grows a hundredfold, in that of a hit it does not.
 * With four times as much, and thresholds of 7.5 deviations instead of 6.5, of 4,200 runs of the tuning draw's planar
 * robots 14 have a reaction without contact instead of 3, and 76 hits instead of 64 are missed. */
#define SHAKING_S ((gw_real_t)0.06)
#define SHAKING_CLIP ((gw_real_t)6.0) /* an outlier counts as this many mean squares */
#define SHAKING_MAX (GW_IMU_SHOWN_MAX * GW_IMU_SHOWN_MAX)

void gw_imu_config_trikey(gw_imu_config_t *config)
{
    config->use = 0U;
    config->position_x_m = GW_ZERO;
    config->position_y_m = GW_ZERO;
    config->angle_rad = GW_ZERO;
    config->acceleration_scale = GW_ONE;
    config->gyro_scale = GW_ONE;
    config->acceleration_limit_mps2 = (gw_real_t)39.0;  /* 4 g */
    config->yaw_rate_limit_radps = (gw_real_t)8.7;      /* 500 deg/s */
    config->acceleration_noise_mps2 = (gw_real_t)0.014; /* 70 ug/sqrt(Hz) in 250 Hz */
    config->gyro_noise_radps = (gw_real_t)0.001;        /* 2.8 mdeg/s/sqrt(Hz) in 250 Hz */
    config->vibration_mps2 = (gw_real_t)0.1;
    config->stale_ticks_max = 3U;
    config->tare_ticks = 100U;
    config->cutoff_radps = (gw_real_t)1200.0;
}

void gw_imu_config_check(const gw_imu_config_t *config, gw_config_error_t *error)
{
    gw_config_check_count(error, GW_FIELD_IMU_USE, config->use);
    gw_config_check_real(error, GW_FIELD_IMU_X, config->position_x_m);
    gw_config_check_real(error, GW_FIELD_IMU_Y, config->position_y_m);
    gw_config_check_real(error, GW_FIELD_IMU_ANGLE, config->angle_rad);
    gw_config_check_real(error, GW_FIELD_IMU_ACCELERATION_SCALE, config->acceleration_scale);
    gw_config_check_real(error, GW_FIELD_IMU_GYRO_SCALE, config->gyro_scale);
    gw_config_check_real(error, GW_FIELD_IMU_ACCELERATION_LIMIT, config->acceleration_limit_mps2);
    gw_config_check_real(error, GW_FIELD_IMU_YAW_RATE_LIMIT, config->yaw_rate_limit_radps);
    gw_config_check_real(error, GW_FIELD_IMU_ACCELERATION_NOISE, config->acceleration_noise_mps2);
    gw_config_check_real(error, GW_FIELD_IMU_GYRO_NOISE, config->gyro_noise_radps);
    gw_config_check_real(error, GW_FIELD_IMU_VIBRATION, config->vibration_mps2);
    gw_config_check_count(error, GW_FIELD_IMU_STALE_TICKS_MAX, config->stale_ticks_max);
    gw_config_check_count(error, GW_FIELD_IMU_TARE_TICKS, config->tare_ticks);
    gw_config_check_real(error, GW_FIELD_IMU_CUTOFF, config->cutoff_radps);
}

static void restart_tare(gw_imu_t *imu)
{
    for (uint32_t i = 0U; i < GW_IMU_SIGNALS; i++) {
        imu->mean[i] = GW_ZERO;
    }
    imu->tare_count = 0U;
}

static void restart_signals(gw_imu_t *imu)
{
    for (uint32_t i = 0U; i < GW_IMU_SIGNALS; i++) {
        gw_lowpass_restart(&imu->filter[i]);
    }
    imu->turning_radps2 = GW_ZERO;
    for (uint32_t i = 0U; i < 2U; i++) {
        imu->smooth_mps2[i].x = GW_ZERO;
        imu->smooth_mps2[i].y = GW_ZERO;
    }
    imu->good_ticks = 0U;
}

gw_status_t gw_imu_init(gw_imu_t *imu, const gw_imu_config_t *config, gw_real_t period_s)
{
    gw_status_t status = GW_STATUS_OK;
    if ((imu == NULL) || (config == NULL)) {
        status = GW_STATUS_NULL_POINTER;
    } else {
        gw_config_error_t error;
        imu->initialised = false;
        gw_config_check_begin(&error);
        gw_config_check_real(&error, GW_FIELD_CONTROLLER_PERIOD, period_s);
        gw_imu_config_check(config, &error);
        if (error.field != GW_FIELD_NONE) {
            status = GW_STATUS_CONFIG_INVALID;
        } else {
            imu->initialised = true;
            imu->config = *config;
            imu->mounting = gw_sincos(config->angle_rad);
            /* No counts pass this filter, any number of them does. */
            (void)gw_rate_filter_constants(&imu->constants, period_s, config->cutoff_radps, 4U, GW_ZERO);
            for (uint32_t i = 0U; i < GW_IMU_SIGNALS; i++) {
                imu->zero[i] = GW_ZERO;
            }
            const gw_real_t noise_mps2 = config->acceleration_noise_mps2 / config->acceleration_scale;
            imu->smooth_share = -gw_expm1(-period_s / SMOOTH_S);
            imu->shaking_share = -gw_expm1(-period_s / SHAKING_S);
            /* White noise behind the low-pass: w T/4 of its variance. */
            imu->least_mps2_2 = gw_max((gw_min(config->cutoff_radps * period_s, (gw_real_t)4.0) / (gw_real_t)4.0) *
                                           (noise_mps2 * noise_mps2),
                                       (gw_real_t)1.0e-9);
            imu->shaking_mps2_2 = imu->least_mps2_2;
            imu->last_counter = 0U;
            imu->age_ticks = 0U;
            imu->counter_known = false;
            imu->tared = false;
            imu->zero_known = false;
            restart_tare(imu);
            restart_signals(imu);
        }
    }
    return status;
}

bool gw_imu_invariant_holds(const gw_imu_t *imu)
{
    bool holds = (imu != NULL);
    if (holds) {
        holds = imu->initialised;
    }
    if (holds) {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_imu_config_check(&imu->config, &error);
        holds = (error.field == GW_FIELD_NONE) && (imu->age_ticks <= imu->config.stale_ticks_max) &&
                (imu->tare_count < imu->config.tare_ticks) && (imu->good_ticks <= GW_IMU_RECOVER_TICKS) &&
                gw_within(imu->turning_radps2, GW_IMU_ACCELERATION_MAX) &&
                gw_in_range(imu->shaking_mps2_2, imu->least_mps2_2, SHAKING_MAX);
        for (uint32_t i = 0U; i < 2U; i++) {
            holds = holds && gw_within(imu->smooth_mps2[i].x, GW_TWO * GW_IMU_SHOWN_MAX) &&
                    gw_within(imu->smooth_mps2[i].y, GW_TWO * GW_IMU_SHOWN_MAX);
        }
        for (uint32_t i = 0U; i < GW_IMU_SIGNALS; i++) {
            holds = holds && gw_within(imu->zero[i], GW_IMU_SHOWN_MAX) && gw_within(imu->mean[i], GW_IMU_SHOWN_MAX) &&
                    gw_within(imu->filter[i].value, GW_IMU_SHOWN_MAX) &&
                    gw_within(imu->filter[i].derivative, GW_RATE_DERIVATIVE_MAX);
        }
    }
    return holds;
}

gw_imu_noise_t gw_imu_noise(const gw_imu_t *imu)
{
    const gw_vector_t position = {imu->config.position_x_m, imu->config.position_y_m};
    gw_imu_noise_t noise;
    noise.acceleration_mps2 = imu->config.acceleration_noise_mps2 / imu->config.acceleration_scale;
    noise.vibration_mps2 = imu->config.vibration_mps2;
    noise.yaw_rate_radps = imu->config.gyro_noise_radps / imu->config.gyro_scale;
    noise.arm_m = gw_length(position);
    noise.cutoff_radps = imu->config.cutoff_radps;
    return noise;
}

/* Notes whether the counter advanced. */
static bool note_imu_counter(gw_imu_t *imu, uint32_t counter)
{
    const bool is_new = (!imu->counter_known) || (counter != imu->last_counter);
    if (is_new) {
        imu->age_ticks = 0U;
    } else if (imu->age_ticks < imu->config.stale_ticks_max) {
        imu->age_ticks++;
    } else {
        /* saturated */
    }
    imu->last_counter = counter;
    imu->counter_known = true;
    return is_new;
}

/* What one value is. */
static gw_status_t status_of(gw_real_t value, gw_real_t limit)
{
    gw_status_t status = GW_STATUS_SENSOR_SATURATED;
    if (gw_magnitude(value) < limit) {
        status = GW_STATUS_OK;
    } else if (!gw_is_finite(value)) {
        status = GW_STATUS_SENSOR_NONFINITE;
    } else {
        /* saturated */
    }
    return status;
}

/* Is the sample good? Those that are not finite tell more than saturated ones, and old ones more than both. */
GW_SMALL static gw_status_t judge(gw_imu_t *imu, const gw_imu_sample_t *sample, bool *is_new)
{
    gw_status_t status = GW_STATUS_SENSOR_MISSING;
    *is_new = false;
    if ((imu->config.use != 0U) && sample->present) {
        *is_new = note_imu_counter(imu, sample->counter);
        status = status_of(sample->yaw_rate_radps, imu->config.yaw_rate_limit_radps);
        for (uint32_t i = 0U; i < GW_IMU_AXES; i++) {
            const gw_status_t found = status_of(sample->specific_force_mps2[i], imu->config.acceleration_limit_mps2);
            if ((status == GW_STATUS_OK) || (found == GW_STATUS_SENSOR_NONFINITE)) {
                status = found;
            }
        }
        if (imu->age_ticks >= imu->config.stale_ticks_max) {
            status = GW_STATUS_SENSOR_STALE;
        }
    }
    return status;
}

/* Acceleration of the base's centre from the filters and these zeros. */
static gw_acceleration_t carried(const gw_imu_t *imu, const gw_real_t zero[GW_IMU_SIGNALS])
{
    const gw_imu_config_t *const config = &imu->config;
    const gw_vector_t shown = {(imu->filter[0].value - zero[0]) / config->acceleration_scale,
                               (imu->filter[1].value - zero[1]) / config->acceleration_scale};
    const gw_vector_t felt = gw_rotate(imu->mounting, shown);
    const gw_real_t omega = (imu->filter[YAW_RATE].value - zero[YAW_RATE]) / config->gyro_scale;
    const gw_real_t alpha = imu->turning_radps2 / config->gyro_scale;
    const gw_real_t square = omega * omega;
    const gw_acceleration_t acceleration = {felt.x + ((alpha * config->position_y_m) + (square * config->position_x_m)),
                                            felt.y + ((square * config->position_y_m) - (alpha * config->position_x_m)),
                                            alpha};
    return acceleration;
}

/* One good new sample of the tare. Once a stop; the bias of the stop before holds until it is done. */
GW_SMALL static void tare(gw_imu_t *imu, const gw_real_t shown[GW_IMU_SIGNALS], gw_acceleration_t *zero_step)
{
    imu->tare_count++;
    const gw_real_t share = GW_ONE / (gw_real_t)imu->tare_count; /* the first sample, from zero, is taken whole */
    for (uint32_t i = 0U; i < GW_IMU_SIGNALS; i++) {
        imu->mean[i] = gw_approached(imu->mean[i], shown[i], share, GW_IMU_SHOWN_MAX);
    }
    if (imu->tare_count >= imu->config.tare_ticks) {
        const gw_acceleration_t before = carried(imu, imu->zero);
        for (uint32_t i = 0U; i < GW_IMU_SIGNALS; i++) {
            imu->zero[i] = imu->mean[i];
        }
        const gw_acceleration_t after = carried(imu, imu->zero);
        zero_step->ax_mps2 = after.ax_mps2 - before.ax_mps2;
        zero_step->ay_mps2 = after.ay_mps2 - before.ay_mps2;
        imu->tared = true;
        imu->zero_known = true;
        restart_tare(imu);
    }
}

static gw_vector_t approached(gw_vector_t from, gw_vector_t to, gw_real_t share)
{
    const gw_vector_t nearer = {gw_limited(from.x + (share * (to.x - from.x)), GW_TWO * GW_IMU_SHOWN_MAX),
                                gw_limited(from.y + (share * (to.y - from.y)), GW_TWO * GW_IMU_SHOWN_MAX)};
    return nearer;
}

/* Follows the vibration: what two high-passes leave of the acceleration. A ramp leaves nothing. */
static void follow_shaking(gw_imu_t *imu)
{
    const gw_vector_t now = {imu->filter[0].value, imu->filter[1].value};
    imu->smooth_mps2[0] = (imu->good_ticks == 0U) ? now : approached(imu->smooth_mps2[0], now, imu->smooth_share);
    const gw_vector_t left = {now.x - imu->smooth_mps2[0].x, now.y - imu->smooth_mps2[0].y};
    imu->smooth_mps2[1] = approached(imu->smooth_mps2[1], left, imu->smooth_share);
    const gw_vector_t fast = {(left.x - imu->smooth_mps2[1].x) / imu->config.acceleration_scale,
                              (left.y - imu->smooth_mps2[1].y) / imu->config.acceleration_scale};
    const gw_real_t square = GW_HALF * ((fast.x * fast.x) + (fast.y * fast.y));
    const gw_real_t clipped = gw_min(square, SHAKING_CLIP * imu->shaking_mps2_2);
    imu->shaking_mps2_2 = gw_clamp(imu->shaking_mps2_2 + (imu->shaking_share * (clipped - imu->shaking_mps2_2)),
                                   imu->least_mps2_2, SHAKING_MAX);
}

/* A good sample: the filters take it, and the tare while the robot stands. */
static void take(gw_imu_t *imu, const gw_imu_sample_t *sample, bool is_new, bool at_rest, gw_acceleration_t *zero_step)
{
    const gw_real_t shown[GW_IMU_SIGNALS] = {gw_known_within(sample->specific_force_mps2[0], GW_IMU_SHOWN_MAX),
                                             gw_known_within(sample->specific_force_mps2[1], GW_IMU_SHOWN_MAX),
                                             gw_known_within(sample->yaw_rate_radps, GW_IMU_SHOWN_MAX)};
    const gw_rate_filter_constants_t constants = imu->constants;
    const gw_real_t before = imu->filter[YAW_RATE].value;
    for (uint32_t i = 0U; i < GW_IMU_SIGNALS; i++) {
        (void)gw_lowpass_step(&imu->filter[i], &constants, shown[i], GW_IMU_SHOWN_MAX);
    }
    /* Of the first sample it is nonsense, which nobody sees before GW_IMU_RECOVER_TICKS. */
    imu->turning_radps2 = (imu->filter[YAW_RATE].value - before) / constants.period_s;
    follow_shaking(imu);
    if (imu->good_ticks < GW_IMU_RECOVER_TICKS) {
        imu->good_ticks++;
    }
    if (at_rest && is_new && (!imu->tared)) {
        tare(imu, shown, zero_step);
    }
}

static void tell_nothing(gw_imu_output_t *output)
{
    const gw_acceleration_t none = {GW_ZERO, GW_ZERO, GW_ZERO};
    output->acceleration = none;
    output->zero_step = none;
    output->trusted = false;
    output->shaking_mps2_2 = GW_ZERO;
}

gw_status_t gw_imu_step(gw_imu_t *imu, const gw_imu_sample_t *sample, bool at_rest, gw_imu_output_t *output)
{
    gw_status_t status = GW_STATUS_OK;
    if (output == NULL) {
        status = GW_STATUS_NULL_POINTER;
    } else {
        tell_nothing(output);
        if ((imu == NULL) || (sample == NULL)) {
            status = GW_STATUS_NULL_POINTER;
        } else if (!imu->initialised) {
            status = GW_STATUS_NOT_INITIALISED;
        } else {
            bool is_new;
            const bool knew = imu->zero_known;
            status = judge(imu, sample, &is_new);
            if (!at_rest) {
                imu->tared = false;
                restart_tare(imu);
            }
            if (status == GW_STATUS_OK) {
                take(imu, sample, is_new, at_rest, &output->zero_step);
                if ((imu->good_ticks < GW_IMU_RECOVER_TICKS) || (!imu->zero_known)) {
                    status = GW_STATUS_SENSOR_RECOVERING;
                }
            } else {
                restart_signals(imu);
                restart_tare(imu);
            }
            output->trusted = (status == GW_STATUS_OK);
            if (output->trusted) {
                output->acceleration = carried(imu, imu->zero);
                output->shaking_mps2_2 = imu->shaking_mps2_2;
            }
            if (!(output->trusted && knew)) {
                const gw_acceleration_t none = {GW_ZERO, GW_ZERO, GW_ZERO};
                output->zero_step = none;
            }
        }
    }
    return status;
}

#endif
