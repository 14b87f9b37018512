/* Friction of the rollers with the elastic deflection before they slide: an elasto-plastic bristle per wheel.
 *
 *     g  = B_r/r_r (w + (1 - w) tanh(alpha |v|/r_r)),  w = exp(-(v/v_S)^2)       largest friction force at speed v
 *     z' = v (1 - A rho),  rho = sigma0 |z|/g          A: 0 up to rho_ba, smoothly to 1 at rho = 1; 0 unloading
 *     f  = sigma0 z + sigma1 z'                        on the base, against n_i
 *
 * v is the speed of the wheel along its axle. The deflection follows displacements, not speeds: those since the last
 * sample, from the encoders less the twist of the drivetrains. While rho < rho_ba, noise on a constant push does not
 * make the deflection drift. In steady motion f is (28).
 *
 * Life cycle: gw_presliding_init, then gw_presliding_step once per tick; gw_presliding_gap after a gap in the samples.
 * All members are private; a copy of the struct is a checkpoint.
 */
#ifndef GW_PRESLIDING_H
#define GW_PRESLIDING_H

#include "giveway/gw_config.h"
#include "giveway/gw_friction.h"
#include "giveway/gw_kinematics.h"
#include "giveway/gw_rate_filter.h"
#include "giveway/gw_sum.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    /* sigma0 of each wheel at the floor, N/m, [10, 10000000]. */
    gw_real_t stiffness_n_per_m[GW_WHEEL_COUNT];
    /* sigma1, N s/m, [0, 100000]. */
    gw_real_t damping_newton_s_per_m;
    /* v_S: speed over which stiction gives way to (28), m/s, [0.000001, 1]. */
    gw_real_t stribeck_speed_mps;
    /* rho_ba: share of the sliding deflection that is purely elastic, [0, 0.99]. */
    gw_real_t elastic_fraction;
} gw_presliding_config_t;

typedef struct {
    gw_presliding_config_t config;
    gw_friction_config_t friction;
    gw_real_t bearable_n; /* B_r/r_r: the most that g becomes */
    gw_sum_t deflection_m[GW_WHEEL_COUNT];
    gw_wheels_t last_torque_nm;
    int32_t last_count[GW_WHEEL_COUNT];
    bool torque_known; /* last_torque_nm holds something */
    bool count_known;
#if (GW_WITH_CHANNELS == 1)
    bool in_turn;
    uint32_t turn;              /* the wheel whose g is computed anew in this tick */
    gw_wheels_t bearable_now_n; /* g of each wheel */
#endif
} gw_presliding_t;

/* The values of Trikey, the paper's robot. Pointers not NULL in these two. */
void gw_presliding_config_trikey(gw_presliding_config_t *config);
GW_SMALL void gw_presliding_config_check(const gw_presliding_config_t *config, gw_config_error_t *error);
/* Rollers not deflected. */
GW_SMALL gw_status_t gw_presliding_init(gw_presliding_t *presliding, const gw_presliding_config_t *config,
                                        const gw_friction_config_t *friction, const gw_kinematics_t *kinematics);
#if (GW_WITH_CHANNELS == 1)
/* From now on g is computed anew for one wheel in a tick, for all in turn: for a speed that is low-passed anyway.
 * Pointer not NULL. */
GW_SMALL void gw_presliding_take_turns(gw_presliding_t *presliding);
#endif
bool gw_presliding_invariant_holds(const gw_presliding_t *presliding);
/* After a gap in the samples: how far the wheels moved is unknown, so the deflections stay. Pointers not NULL here and
 * below. */
void gw_presliding_gap(gw_presliding_t *presliding);
/* The present deflections belong to this torque, the mean of a tare: noise of its last sample must not move them. */
GW_SMALL void gw_presliding_settle(gw_presliding_t *presliding, const gw_wheels_t *mean_torque_nm);
/* Elastic part of the friction, sigma0 z r_r per roller, N m. */
GW_SMALL gw_wheels_t gw_presliding_elastic_torques(const gw_presliding_t *presliding,
                                                   const gw_kinematics_t *kinematics);
/* One tick: counts and torques of this sample, |torque| <= GW_TORQUE_MAX, and the twist of the base as it was measured.
 * Friction f r_r per roller, N m; not finite if the twist is not, the state then stays sound. */
gw_wheels_t gw_presliding_step(gw_presliding_t *presliding, const gw_kinematics_t *kinematics,
                               const gw_rate_filter_constants_t *rate_constants,
                               const int32_t encoder_count[GW_WHEEL_COUNT], const gw_wheels_t *torque_nm,
                               gw_twist_t twist);

#ifdef __cplusplus
}
#endif

#endif
