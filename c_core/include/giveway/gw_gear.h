/* Friction of the gears between motors and wheels, for robots whose torque signals are their motors' currents: these
 * show what the gears take besides what the wheels get. The inertia of rotors and gears counts to that of the wheels
 * then: base.wheel_inertia.
 *
 *     T = B_g tanh(alpha_g rate) + D_g rate
 *
 * A gear that hardly turns may hold anything between the limits of its friction, whatever the model says, and all of
 * them hold the same before a start: its standard deviation is the limit. A torque sensor behind the gear sees none of
 * this: its robot has no gear here, both torques zero.
 */
#ifndef GW_GEAR_H
#define GW_GEAR_H

#include "giveway/gw_config.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    /* B_g, at the wheel's axle, N m, [0, 100]. */
    gw_real_t coulomb_torque_nm;
    /* D_g, at the wheel's axle, N m s/rad, [0, 100]. */
    gw_real_t viscous_nms_per_rad;
    /* alpha_g, of the wheel's rate, s/rad, [0, 1000]. */
    gw_real_t tanh_slope_s_per_rad;
    /* Error of the friction of a gear that turns, relative, [0, 1]. */
    gw_real_t uncertainty;
} gw_gear_config_t;

/* A robot with torque sensors. Pointers not NULL here and below. */
void gw_gear_config_none(gw_gear_config_t *config);
GW_SMALL void gw_gear_config_check(const gw_gear_config_t *config, gw_config_error_t *error);
/* Does the torque signal show the friction of gears? */
static inline bool gw_gear_is_sensed(const gw_gear_config_t *config)
{
    return (config->coulomb_torque_nm > (gw_real_t)0.0) || (config->viscous_nms_per_rad > (gw_real_t)0.0);
}
/* Adds the friction of each gear to what is there, N m, |rates| <= GW_RATE_MAX. Returns the sum of the squares of what
 * the gears may be wrong by, (N m)^2. config is checked. */
gw_real_t gw_gear_add(const gw_gear_config_t *config, const gw_wheels_t *rates_radps, gw_wheels_t *torque_nm);

#ifdef __cplusplus
}
#endif

#endif
