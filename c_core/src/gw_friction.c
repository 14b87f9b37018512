#include "giveway/gw_friction.h"

#include "giveway/gw_math.h"
#include "giveway/gw_trikey.h"

void gw_friction_config_trikey(gw_friction_config_t *config)
{
    config->coulomb_torque_nm = GW_TRIKEY_ROLLER_COULOMB_TORQUE_NM;
    config->tanh_slope_s_per_rad = GW_TRIKEY_ROLLER_TANH_SLOPE_S_PER_RAD;
}

void gw_friction_config_check(const gw_friction_config_t *config, gw_config_error_t *error)
{
    gw_config_check_real(error, GW_FIELD_FRICTION_COULOMB_TORQUE, config->coulomb_torque_nm);
    gw_config_check_real(error, GW_FIELD_FRICTION_TANH_SLOPE, config->tanh_slope_s_per_rad);
}
