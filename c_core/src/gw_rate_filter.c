#include "giveway/gw_rate_filter.h"

#include "giveway/gw_config.h"
#include "giveway/gw_math.h"
#include "giveway/gw_wrench.h"

gw_status_t gw_rate_filter_constants(gw_rate_filter_constants_t *constants, gw_real_t period_s, gw_real_t cutoff_radps,
                                     uint32_t counts_per_turn, gw_real_t stiffness_nm_per_rad)
{
    gw_status_t status = GW_STATUS_OK;
    if (constants == NULL) {
        status = GW_STATUS_NULL_POINTER;
    } else {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_config_check_real(&error, GW_FIELD_CONTROLLER_PERIOD, period_s);
        gw_config_check_real(&error, GW_FIELD_ESTIMATOR_RATE_CUTOFF, cutoff_radps);
        gw_config_check_count(&error, GW_FIELD_ESTIMATOR_ENCODER_COUNTS, counts_per_turn);
        gw_config_check_real(&error, GW_FIELD_ESTIMATOR_DRIVETRAIN_STIFFNESS, stiffness_nm_per_rad);
        if (error.field != GW_FIELD_NONE) {
            status = GW_STATUS_CONFIG_INVALID;
        } else {
            constants->period_s = period_s;
            constants->cutoff_radps = cutoff_radps;
            constants->decay = gw_exp(-cutoff_radps * period_s);
            constants->rad_per_count = (GW_TWO * GW_PI) / (gw_real_t)counts_per_turn;
            /* A smaller stiffness would only amplify noise without bounds: such a drivetrain is taken for rigid, too.
             */
            constants->compliance_rad_per_nm =
                (stiffness_nm_per_rad >= (gw_real_t)0.000001) ? (GW_ONE / stiffness_nm_per_rad) : GW_ZERO;
        }
    }
    return status;
}

void gw_rate_filter_restart(gw_rate_filter_t *filter)
{
    filter->last_count = 0;
    filter->last_torque_nm = GW_ZERO;
    filter->rate_radps = GW_ZERO;
    filter->derivative_radps2 = GW_ZERO;
    filter->started = false;
}

bool gw_rate_filter_invariant_holds(const gw_rate_filter_t *filter)
{
    return (filter != NULL) && gw_within(filter->last_torque_nm, GW_TORQUE_MAX) &&
           gw_within(filter->rate_radps, GW_RATE_MAX) && gw_within(filter->derivative_radps2, GW_RATE_DERIVATIVE_MAX);
}
