#include "giveway/gw_gear.h"

#include "giveway/gw_math.h"

void gw_gear_config_none(gw_gear_config_t *config)
{
    config->coulomb_torque_nm = GW_ZERO;
    config->viscous_nms_per_rad = GW_ZERO;
    config->tanh_slope_s_per_rad = (gw_real_t)3.0; /* slow wheels are doubted: false alarms come from there */
    config->uncertainty = (gw_real_t)0.3;
}

void gw_gear_config_check(const gw_gear_config_t *config, gw_config_error_t *error)
{
    gw_config_check_real(error, GW_FIELD_GEAR_COULOMB_TORQUE, config->coulomb_torque_nm);
    gw_config_check_real(error, GW_FIELD_GEAR_VISCOUS_DAMPING, config->viscous_nms_per_rad);
    gw_config_check_real(error, GW_FIELD_GEAR_TANH_SLOPE, config->tanh_slope_s_per_rad);
    gw_config_check_real(error, GW_FIELD_GEAR_UNCERTAINTY, config->uncertainty);
}

gw_real_t gw_gear_add(const gw_gear_config_t *config, const gw_wheels_t *rates_radps, gw_wheels_t *torque_nm)
{
    gw_real_t doubt_nm2 = GW_ZERO;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        const gw_real_t rate_radps = rates_radps->wheel[i];
        const gw_real_t sliding = gw_tanh(config->tanh_slope_s_per_rad * rate_radps);
        const gw_real_t friction_nm =
            (config->coulomb_torque_nm * sliding) + (config->viscous_nms_per_rad * rate_radps);
        const gw_real_t wrong_nm = config->uncertainty * friction_nm;
        const gw_real_t hidden = gw_max(GW_ONE - (sliding * sliding), GW_ZERO);
        const gw_real_t held_nm2 = hidden * (config->coulomb_torque_nm * config->coulomb_torque_nm);
        torque_nm->wheel[i] += friction_nm;
        doubt_nm2 += (wrong_nm * wrong_nm) + held_nm2;
    }
    return doubt_nm2;
}
