#include "giveway/gw_supervisor.h"

#include "giveway/gw_math.h"

void gw_supervisor_config_trikey(gw_supervisor_config_t *config)
{
    config->settled_speed_mps = (gw_real_t)0.005;
    config->settled_ticks = 500U;
    config->after_settled = GW_AFTER_SETTLED_REJOIN;
    config->rejoin_distance_m = (gw_real_t)0.0002;
    config->rejoin_angle_rad = (gw_real_t)0.0005;
}

void gw_supervisor_config_check(const gw_supervisor_config_t *config, gw_config_error_t *error)
{
    gw_config_check_real(error, GW_FIELD_SUPERVISOR_SETTLED_SPEED, config->settled_speed_mps);
    gw_config_check_count(error, GW_FIELD_SUPERVISOR_SETTLED_TICKS, config->settled_ticks);
    gw_config_check_count(error, GW_FIELD_SUPERVISOR_AFTER_SETTLED, config->after_settled);
    gw_config_check_real(error, GW_FIELD_SUPERVISOR_REJOIN_DISTANCE, config->rejoin_distance_m);
    gw_config_check_real(error, GW_FIELD_SUPERVISOR_REJOIN_ANGLE, config->rejoin_angle_rad);
}

gw_status_t gw_supervisor_init(gw_supervisor_t *supervisor, const gw_supervisor_config_t *config)
{
    gw_status_t status = GW_STATUS_OK;
    if ((supervisor == NULL) || (config == NULL)) {
        status = GW_STATUS_NULL_POINTER;
    } else {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_supervisor_config_check(config, &error);
        supervisor->initialised = (error.field == GW_FIELD_NONE);
        supervisor->mode = supervisor->initialised ? GW_MODE_TARING : GW_MODE_FAULT;
        supervisor->resume = GW_MODE_TRACKING;
        supervisor->quiet_ticks = 0U;
        supervisor->path_ticks = 0U;
        supervisor->tare_pending = false;
        if (supervisor->initialised) {
            supervisor->config = *config;
        } else {
            status = GW_STATUS_CONFIG_INVALID;
        }
    }
    return status;
}

bool gw_supervisor_invariant_holds(const gw_supervisor_t *supervisor)
{
    bool holds = (supervisor != NULL);
    if (holds) {
        holds = supervisor->initialised;
    }
    if (holds) {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_supervisor_config_check(&supervisor->config, &error);
        holds = (error.field == GW_FIELD_NONE) && ((uint32_t)supervisor->mode <= (uint32_t)GW_MODE_FAULT) &&
                ((uint32_t)supervisor->resume <= (uint32_t)GW_MODE_REJOINING) &&
                (supervisor->quiet_ticks <= supervisor->config.settled_ticks) &&
                (supervisor->path_ticks <= GW_TICK_MASK);
    }
    return holds;
}

/* The mode that follows an interruption. A path is always rejoined: the robot may have been moved away from it. */
static gw_mode_t resumption_of(gw_mode_t mode)
{
    return (mode == GW_MODE_TRACKING) ? GW_MODE_REJOINING : mode;
}

static gw_mode_t next_undisturbed(gw_supervisor_t *supervisor, const gw_supervisor_events_t *events)
{
    gw_mode_t next = supervisor->mode;
    switch (supervisor->mode) {
    case GW_MODE_TARING:
        if (events->tare_done) {
            next = supervisor->resume;
        }
        break;
    case GW_MODE_TRACKING:
        if (events->tare_accepted) {
            supervisor->resume = GW_MODE_TRACKING;
            next = GW_MODE_TARING;
        }
        break;
    case GW_MODE_REACTING:
        if (events->quiet) {
            supervisor->quiet_ticks++;
        } else {
            supervisor->quiet_ticks = 0U;
        }
        if (supervisor->quiet_ticks >= supervisor->config.settled_ticks) {
            next = GW_MODE_SETTLED;
        }
        break;
    case GW_MODE_SETTLED:
        if (events->tare_accepted) {
            supervisor->resume = GW_MODE_SETTLED;
            next = GW_MODE_TARING;
        } else if (supervisor->config.after_settled == GW_AFTER_SETTLED_REJOIN) {
            next = GW_MODE_REJOINING;
        } else {
            /* hold */
        }
        break;
    case GW_MODE_REJOINING:
        if (events->on_path) {
            next = GW_MODE_TRACKING;
        }
        break;
    case GW_MODE_STOPPED:
    case GW_MODE_FAULT:
    default:
        next = supervisor->tare_pending ? GW_MODE_TARING : supervisor->resume;
        supervisor->tare_pending = false;
        break;
    }
    return next;
}

gw_mode_t gw_supervisor_step(gw_supervisor_t *supervisor, const gw_supervisor_events_t *events)
{
    gw_mode_t next = GW_MODE_FAULT;
    if ((supervisor != NULL) && (events != NULL)) {
        if (supervisor->initialised) {
            const gw_mode_t mode = supervisor->mode;
            const bool interrupted = (mode == GW_MODE_FAULT) || (mode == GW_MODE_STOPPED);
            if (!events->sensors_good) {
                next = GW_MODE_FAULT;
            } else if (events->stop_request) {
                next = GW_MODE_STOPPED;
            } else if (events->hit && (!interrupted) && (mode != GW_MODE_TARING)) {
                next = GW_MODE_REACTING;
                supervisor->quiet_ticks = 0U;
            } else {
                next = next_undisturbed(supervisor, events);
            }
            if (((next == GW_MODE_FAULT) || (next == GW_MODE_STOPPED)) && (!interrupted)) {
                /* A tare that was interrupted starts again and keeps the mode after it. */
                if (mode == GW_MODE_TARING) {
                    supervisor->tare_pending = true;
                } else {
                    supervisor->resume = resumption_of(mode);
                }
            }
            if (next != GW_MODE_REACTING) {
                supervisor->quiet_ticks = 0U;
            }
            if ((next == GW_MODE_TRACKING) && events->plan_valid) {
                supervisor->path_ticks = (supervisor->path_ticks + 1U) & GW_TICK_MASK;
            }
            supervisor->mode = next;
        }
    }
    return next;
}
