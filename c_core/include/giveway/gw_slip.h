/* Wheels that may slip. A wheel that transmits nearly as much as the floor bears may turn faster or slower than the
 * base moves: what its encoder says of the acceleration is wrong, along the direction in which it rolls. Most of such
 * wheels carry less than their share of the weight, as the base leans while it accelerates.
 *
 *     |T| / r_w > 0.6 G,  G = mu M g / n
 *
 * from this torque on the force along the rolling direction has the standard deviation 0.3 G: hard starts of robots
 * that tip, with rollers of much friction, show errors of about as much.
 *
 * Life cycle: gw_slip_init, then gw_slip_step every so often. All members are private.
 */
#ifndef GW_SLIP_H
#define GW_SLIP_H

#include "giveway/gw_config.h"
#include "giveway/gw_kinematics.h"
#include "giveway/gw_planar_covariance.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    gw_real_t near_n;     /* what a wheel transmits without slipping */
    gw_real_t doubt_n2;   /* variance of the force along its rolling direction when it transmits more */
    gw_real_t keep;       /* of the variance, from one step to the next */
    gw_wheels_t wheel_n2; /* variance now */
} gw_slip_t;

/* grip: coefficient of friction, mu, in [0, 10], 0: no wheel ever slips; the robot's mass, kg, at least 0.1;
 * multiple of the standard deviation, in [0, 100]; keep in [0.5, 1]. Pointers not NULL here and below. */
GW_SMALL void gw_slip_init(gw_slip_t *slip, gw_real_t grip, gw_real_t mass_kg, gw_real_t multiple, gw_real_t keep);
/* Forgets what slipped. */
GW_SMALL void gw_slip_restart(gw_slip_t *slip);
bool gw_slip_invariant_holds(const gw_slip_t *slip);
/* What slipped fades; with these torques of the wheels, N m, some may slip now, if that is of interest. */
void gw_slip_step(gw_slip_t *slip, const gw_kinematics_t *kinematics, const gw_wheels_t *torque_nm, bool interesting);
/* M + what slip adds to it, in base axes. */
gw_planar_covariance_t gw_slip_added(const gw_slip_t *slip, const gw_kinematics_t *kinematics,
                                     gw_planar_covariance_t m);
/* Sum over the wheels, N^2. */
gw_real_t gw_slip_sum(const gw_slip_t *slip);

#ifdef __cplusplus
}
#endif

#endif
