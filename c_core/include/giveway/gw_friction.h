/* Friction of the rollers in their bushings, (28). */
#ifndef GW_FRICTION_H
#define GW_FRICTION_H

#include "giveway/gw_config.h"
#include "giveway/gw_math.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    /* B_r, N m, [0, 100]. */
    gw_real_t coulomb_torque_nm;
    /* alpha, s/rad, [0, 1000]. */
    gw_real_t tanh_slope_s_per_rad;
} gw_friction_config_t;

/* The values of Trikey, the paper's robot. Pointers not NULL in these two. */
void gw_friction_config_trikey(gw_friction_config_t *config);
GW_SMALL void gw_friction_config_check(const gw_friction_config_t *config, gw_config_error_t *error);
/* B_r tanh(alpha rate) per roller, N m. config is checked, rates are finite; pointers not NULL. */
static inline gw_wheels_t gw_friction_torques(const gw_friction_config_t *config, const gw_wheels_t *roller_rates_radps)
{
    gw_wheels_t torques;
    GW_UNROLLED
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        const gw_real_t slide = gw_tanh(config->tanh_slope_s_per_rad * roller_rates_radps->wheel[i]);
        torques.wheel[i] = config->coulomb_torque_nm * slide;
    }
    return torques;
}

#ifdef __cplusplus
}
#endif

#endif
