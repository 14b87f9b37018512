#include "giveway/gw_detector.h"

#include "giveway/gw_math.h"
#include "giveway/gw_trikey.h"
#include "giveway/gw_wrench.h"

/* Bounds of the integral: it trips and starts anew far below. A pure moment, which never trips, is limited by it. */
#define IMPULSE_MAX ((gw_real_t)1.0e9)
/* A smaller impulse, N s, gives no lever arm: it is rounding. Every threshold is larger. */
#define IMPULSE_MIN ((gw_real_t)0.0001)

void gw_detector_config_trikey(gw_detector_config_t *config)
{
    config->kind = GW_DETECTOR_IMPULSE;
    config->force_threshold_n = (gw_real_t)10.0;
    config->impulse_threshold_newton_s = GW_TRIKEY_DETECTOR_IMPULSE_THRESHOLD_NEWTON_S;
    config->leak_rest_n = GW_TRIKEY_DETECTOR_LEAK_REST_N;
    config->leak_creep_n = (gw_real_t)42.0; /* two rollers' worth of B_r/r_r: stuck ones can hold it */
    config->leak_motion_n = GW_TRIKEY_DETECTOR_LEAK_MOTION_N;
    config->release_force_n = (gw_real_t)6.0; /* twice the error of the friction model */
    config->blanking_ticks = 300U;            /* the reaction's own acceleration */
}

void gw_detector_config_check(const gw_detector_config_t *config, gw_config_error_t *error)
{
    gw_config_check_count(error, GW_FIELD_DETECTOR_KIND, config->kind);
    gw_config_check_real(error, GW_FIELD_DETECTOR_FORCE_THRESHOLD, config->force_threshold_n);
    gw_config_check_real(error, GW_FIELD_DETECTOR_IMPULSE_THRESHOLD, config->impulse_threshold_newton_s);
    gw_config_check_real(error, GW_FIELD_DETECTOR_LEAK_REST, config->leak_rest_n);
    gw_config_check_real(error, GW_FIELD_DETECTOR_LEAK_CREEP, config->leak_creep_n);
    gw_config_check_real(error, GW_FIELD_DETECTOR_LEAK_MOTION, config->leak_motion_n);
    gw_config_check_real(error, GW_FIELD_DETECTOR_RELEASE_FORCE, config->release_force_n);
    gw_config_check_count(error, GW_FIELD_DETECTOR_BLANKING_TICKS, config->blanking_ticks);
}

gw_status_t gw_detector_init(gw_detector_t *detector, const gw_detector_config_t *config, gw_real_t period_s)
{
    gw_status_t status = GW_STATUS_OK;
    if ((detector == NULL) || (config == NULL)) {
        status = GW_STATUS_NULL_POINTER;
    } else {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_config_check_real(&error, GW_FIELD_CONTROLLER_PERIOD, period_s);
        gw_detector_config_check(config, &error);
        detector->initialised = (error.field == GW_FIELD_NONE);
        gw_detector_reset(detector);
        if (detector->initialised) {
            detector->config = *config;
            detector->period_s = period_s;
        } else {
            status = GW_STATUS_CONFIG_INVALID;
        }
    }
    return status;
}

bool gw_detector_invariant_holds(const gw_detector_t *detector)
{
    bool holds = (detector != NULL);
    if (holds) {
        holds = detector->initialised;
    }
    if (holds) {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_config_check_real(&error, GW_FIELD_CONTROLLER_PERIOD, detector->period_s);
        gw_detector_config_check(&detector->config, &error);
        holds = (error.field == GW_FIELD_NONE) && gw_within(detector->impulse_x_newton_s, IMPULSE_MAX) &&
                gw_within(detector->impulse_y_newton_s, IMPULSE_MAX) &&
                gw_within(detector->impulse_moment_nms, IMPULSE_MAX) &&
                (detector->ticks_since_trip <= detector->config.blanking_ticks);
    }
    return holds;
}

void gw_detector_clear(gw_detector_t *detector)
{
    detector->impulse_x_newton_s = GW_ZERO;
    detector->impulse_y_newton_s = GW_ZERO;
    detector->impulse_moment_nms = GW_ZERO;
    detector->samples = 0U;
}

void gw_detector_reset(gw_detector_t *detector)
{
    gw_detector_clear(detector);
    detector->ticks_since_trip = 0U;
    detector->active = false;
}

static gw_real_t force_length(gw_wrench_t wrench)
{
    const gw_vector_t force = {wrench.force_x_n, wrench.force_y_n};
    return gw_length(force);
}

/* May an active detector trip again? */
static bool may_release(const gw_detector_t *detector, const gw_detector_input_t *input)
{
    gw_real_t release_n = detector->config.release_force_n;
    if (detector->config.kind == GW_DETECTOR_FORCE_AVERAGE) {
        release_n = gw_min(release_n, detector->config.force_threshold_n);
    }
    return (detector->ticks_since_trip >= detector->config.blanking_ticks) &&
           (input->reaction_over || (force_length(gw_wrench_known_valid(input->mean)) < release_n));
}

/* One step of the leaky vector integral; true if it trips. */
static bool integrate(gw_detector_t *detector, const gw_detector_input_t *input, gw_detector_output_t *output)
{
    const gw_real_t leak_n = gw_detector_leak(detector, input->regime);
    const gw_wrench_t wrench = gw_wrench_known_valid(input->wrench);
    const gw_vector_t sum = {detector->impulse_x_newton_s + (wrench.force_x_n * detector->period_s),
                             detector->impulse_y_newton_s + (wrench.force_y_n * detector->period_s)};
    const gw_real_t moment =
        gw_limited(detector->impulse_moment_nms + (wrench.torque_nm * detector->period_s), IMPULSE_MAX);
    const gw_real_t length = gw_length(sum);
    const gw_real_t left = length - (leak_n * detector->period_s);
    bool trips = false;
    if (left > GW_ZERO) {
        const gw_real_t shrink = gw_fraction_inline(left, length);
        detector->impulse_x_newton_s = gw_limited(sum.x * shrink, IMPULSE_MAX);
        detector->impulse_y_newton_s = gw_limited(sum.y * shrink, IMPULSE_MAX);
        detector->impulse_moment_nms = moment * shrink;
        if (detector->samples < GW_TICK_MASK) {
            detector->samples++;
        }
        /* The leak is part of the mean force. */
        const gw_real_t mean_n = (left / ((gw_real_t)detector->samples * detector->period_s)) + leak_n;
        const gw_vector_t direction = gw_unit(sum.x, sum.y, length);
        output->mean_wrench.force_x_n = direction.x * mean_n;
        output->mean_wrench.force_y_n = direction.y * mean_n;
        output->mean_wrench.torque_nm = (moment / gw_max(length, IMPULSE_MIN)) * mean_n;
        output->mean_wrench = gw_wrench_limited(output->mean_wrench);
        output->samples = detector->samples;
        output->statistic = left;
        trips = (left > detector->config.impulse_threshold_newton_s);
    } else {
        gw_detector_clear(detector);
    }
    return trips;
}

gw_status_t gw_detector_step(gw_detector_t *detector, const gw_detector_input_t *input, gw_detector_output_t *output)
{
    static const gw_detector_output_t nothing = {0};
    gw_status_t status = GW_STATUS_OK;
    if (output == NULL) {
        status = GW_STATUS_NULL_POINTER;
    } else {
        *output = nothing;
        if ((detector == NULL) || (input == NULL)) {
            status = GW_STATUS_NULL_POINTER;
        } else if (!detector->initialised) {
            status = GW_STATUS_NOT_INITIALISED;
        } else if (!(gw_wrench_is_valid(input->wrench) && gw_wrench_is_valid(input->mean) &&
                     gw_wrench_is_valid(input->window_mean))) {
            status = GW_STATUS_INPUT_INVALID;
            output->active = detector->active;
        } else {
            if (detector->active) {
                if (detector->ticks_since_trip < detector->config.blanking_ticks) {
                    detector->ticks_since_trip++;
                }
                detector->active = !may_release(detector, input);
            }
            if (detector->active || (!input->enabled)) {
                gw_detector_clear(detector);
            } else if (detector->config.kind == GW_DETECTOR_IMPULSE) {
                output->tripped = integrate(detector, input, output);
            } else {
                gw_real_t threshold_n = detector->config.force_threshold_n;
                if (input->regime == GW_REGIME_CREEPING) {
                    threshold_n = gw_max(threshold_n, detector->config.leak_creep_n);
                }
                output->statistic = force_length(gw_wrench_known_valid(input->window_mean));
                output->mean_wrench = gw_wrench_known_valid(input->mean);
                output->samples = input->mean_samples;
                output->tripped = (output->statistic > threshold_n);
            }
            if (output->tripped) {
                gw_detector_reset(detector);
                detector->active = true;
            }
            output->active = detector->active;
        }
    }
    return status;
}
