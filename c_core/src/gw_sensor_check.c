#include "giveway/gw_sensor_check.h"

#include "giveway/gw_math.h"
#include "giveway/gw_trikey.h"

void gw_sensor_check_config_trikey(gw_sensor_check_config_t *config)
{
    config->torque_limit_nm = GW_TRIKEY_DRIVETRAIN_TORQUE_SENSOR_LIMIT_NM;
    config->stale_ticks_max = 3U;
    config->encoder_jump_counts = 200U; /* 148 rad/s */
    config->recover_ticks = 10U;
}

void gw_sensor_check_config_check(const gw_sensor_check_config_t *config, gw_config_error_t *error)
{
    gw_config_check_real(error, GW_FIELD_SENSOR_CHECK_TORQUE_LIMIT, config->torque_limit_nm);
    gw_config_check_count(error, GW_FIELD_SENSOR_CHECK_STALE_TICKS_MAX, config->stale_ticks_max);
    gw_config_check_count(error, GW_FIELD_SENSOR_CHECK_ENCODER_JUMP, config->encoder_jump_counts);
    gw_config_check_count(error, GW_FIELD_SENSOR_CHECK_RECOVER_TICKS, config->recover_ticks);
}

gw_status_t gw_sensor_check_init(gw_sensor_check_t *check, const gw_sensor_check_config_t *config)
{
    gw_status_t status = GW_STATUS_OK;
    if ((check == NULL) || (config == NULL)) {
        status = GW_STATUS_NULL_POINTER;
    } else {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_sensor_check_config_check(config, &error);
        check->initialised = (error.field == GW_FIELD_NONE);
        if (check->initialised) {
            check->config = *config;
            for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
                check->last_count[i] = 0;
            }
            check->last_counter = 0U;
            check->age_ticks = 0U;
            check->recover_remaining = 0U;
            check->counter_known = false;
            check->encoder_known = false;
            check->was_good = false;
        } else {
            status = GW_STATUS_CONFIG_INVALID;
        }
    }
    return status;
}

bool gw_sensor_check_invariant_holds(const gw_sensor_check_t *check)
{
    bool holds = (check != NULL);
    if (holds) {
        holds = check->initialised;
    }
    if (holds) {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_sensor_check_config_check(&check->config, &error);
        holds = (error.field == GW_FIELD_NONE) && (check->age_ticks <= check->config.stale_ticks_max) &&
                (check->recover_remaining <= check->config.recover_ticks);
    }
    return holds;
}

static uint32_t count_distance(int32_t a, int32_t b)
{
    const uint32_t difference = (uint32_t)a - (uint32_t)b;
    return (difference <= 0x7FFFFFFFU) ? difference : (0U - difference);
}

static gw_status_t torque_status(const gw_sensor_check_t *check, const gw_sensor_sample_t *sample)
{
    gw_status_t status = GW_STATUS_OK;
    const gw_real_t limit_nm = check->config.torque_limit_nm;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        if (gw_magnitude(sample->torque_nm[i]) < limit_nm) {
            /* this torque is good */
        } else if (!gw_is_finite(sample->torque_nm[i])) {
            status = GW_STATUS_SENSOR_NONFINITE;
        } else if (status == GW_STATUS_OK) {
            status = GW_STATUS_SENSOR_SATURATED;
        } else {
            /* an earlier one tells more */
        }
    }
    return status;
}

/* Notes the encoders of a new sample; false if one moved more than a wheel can in elapsed ticks. */
static bool note_encoders(gw_sensor_check_t *check, const gw_sensor_sample_t *sample, uint32_t elapsed_ticks)
{
    bool plausible = true;
    /* At most 1e6 counts in 1000 ticks: no overflow. Without a sample before, any number of counts is plausible. */
    const uint32_t most = check->encoder_known ? (check->config.encoder_jump_counts * elapsed_ticks) : UINT32_MAX;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        const uint32_t moved = count_distance(sample->encoder_count[i], check->last_count[i]);
        if (moved > most) {
            plausible = false;
        }
        check->last_count[i] = sample->encoder_count[i];
    }
    check->encoder_known = true;
    return plausible;
}

/* Notes whether the counter advanced; returns true for a new sample. */
static bool note_counter(gw_sensor_check_t *check, uint32_t counter)
{
    const bool is_new = (!check->counter_known) || (counter != check->last_counter);
    if (is_new) {
        check->age_ticks = 0U;
    } else if (check->age_ticks < check->config.stale_ticks_max) {
        check->age_ticks++;
    } else {
        /* saturated */
    }
    check->last_counter = counter;
    check->counter_known = true;
    return is_new;
}

gw_status_t gw_sensor_check_step(gw_sensor_check_t *check, const gw_sensor_sample_t *sample)
{
    gw_status_t status = GW_STATUS_OK;
    if ((check == NULL) || (sample == NULL)) {
        status = GW_STATUS_NULL_POINTER;
    } else if (!check->initialised) {
        status = GW_STATUS_NOT_INITIALISED;
    } else {
        bool is_new = false;
        if (!sample->present) {
            status = GW_STATUS_SENSOR_MISSING;
            check->encoder_known = false; /* the wheels may have turned any distance meanwhile */
        } else {
            const uint32_t elapsed_ticks = check->age_ticks + 1U;
            is_new = note_counter(check, sample->counter);
            status = torque_status(check, sample);
            if (check->age_ticks >= check->config.stale_ticks_max) {
                status = GW_STATUS_SENSOR_STALE;
                check->encoder_known = false;
            } else if (is_new) {
                const bool plausible = note_encoders(check, sample, elapsed_ticks);
                if ((status == GW_STATUS_OK) && (!plausible)) {
                    status = GW_STATUS_ENCODER_JUMP;
                }
            } else {
                /* an old sample, still young enough */
            }
        }
        if (status != GW_STATUS_OK) {
            /* Before the first good sample there is nothing to recover from. */
            check->recover_remaining = check->was_good ? check->config.recover_ticks : 0U;
        } else if (check->recover_remaining > 0U) {
            status = GW_STATUS_SENSOR_RECOVERING;
            if (is_new) {
                check->recover_remaining--;
            }
        } else {
            check->was_good = true;
        }
    }
    return status;
}
