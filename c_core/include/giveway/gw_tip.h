/* How fast the robot may accelerate without lifting a wheel.
 *
 * A robot that accelerates towards a wheel takes load from it: m g/3 at rest, less by 2/3 m h a.n_i/R with the centre
 * of mass at height h and the wheels at distance R, and none at a.n_i = g R/(2 h). That is the distance of the centre
 * from the edge of the support polygon opposite the wheel, R/2, over h, times g. The centre of mass may be off the
 * centre, and the floor may be tilted: what is left of that, times a share, is the margin. So the limit depends on the
 * direction: it is the margin towards a wheel, and twice that away from it.
 *
 * Life cycle: gw_tip_init, then read-only. All members are private. Pointers not NULL.
 */
#ifndef GW_TIP_H
#define GW_TIP_H

#include "giveway/gw_config.h"
#include "giveway/gw_kinematics.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    /* Height of the centre of mass above the floor, m, [0, 5]; 0: no limit. */
    gw_real_t height_m;
    /* Share of the margin that is used, [0.01, 1]: what is left covers how the robot rocks. */
    gw_real_t share;
    /* How far the centre of mass may be from the centre of the wheels, m, [0, 1], and the floor's tilt, rad, [0, 0.5].
     */
    gw_real_t offset_m;
    gw_real_t slope_rad;
} gw_tip_config_t;

/* The directions of three evenly spaced wheels add up to zero: two tell the third. */
#define GW_TIP_DIRECTIONS 2U

typedef struct {
    gw_vector_t radial[GW_TIP_DIRECTIONS]; /* towards the wheels, base frame */
    gw_real_t margin_mps2;                 /* largest acceleration towards a wheel; 0: no limit */
} gw_tip_t;

/* The values of Trikey, the paper's robot: no limit. */
void gw_tip_config_trikey(gw_tip_config_t *config);
GW_SMALL void gw_tip_config_check(const gw_tip_config_t *config, gw_config_error_t *error);
/* No limit, for a module that is used alone. */
GW_SMALL void gw_tip_none(gw_tip_t *tip);
/* Config and geometry were checked. However small the margin, the robot must come to rest: it is at least 0.05 m/s^2.
 */
GW_SMALL void gw_tip_init(gw_tip_t *tip, const gw_tip_config_t *config, const gw_kinematics_t *kinematics);
bool gw_tip_invariant_holds(const gw_tip_t *tip);
/* The share of a change of velocity in a tick (base frame, m/s, components below 1e9) at which no wheel loses more than
 * the margin: 1 if all of it may be. */
gw_real_t gw_tip_share(const gw_tip_t *tip, gw_vector_t change_mps, gw_real_t period_s);
/* The largest acceleration along a unit vector or zero (base frame), m/s^2; limit if that is smaller. */
gw_real_t gw_tip_along(const gw_tip_t *tip, gw_vector_t unit, gw_real_t limit_mps2);

#ifdef __cplusplus
}
#endif

#endif
