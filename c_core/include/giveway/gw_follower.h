/* How far roller friction and mass differ from the configuration: followed while nothing touches the robot, with the
 * uncertainty that remains.
 *
 * Without contact the residual of the force balance is  e = -(sum_i d_i n_i f_i + d_m M a + o) + noise,  where n_i f_i
 * is the configured friction force of the rollers of wheel i, M a the configured inertial force, d the unknown relative
 * differences, and o a force that does not depend on the motion: a slope, a zero that is wrong. A Kalman filter with
 * slowly drifting d and o follows them: friction of each wheel on its own, but with a common part expected, the mass,
 * and o. What it does not know yet is their covariance P. With it the detector knows how much force the model may be
 * wrong by, for the motion at hand.
 *
 * Life cycle: gw_follower_init, then gw_follower_learn as often as nothing touches. All members are private.
 */
#ifndef GW_FOLLOWER_H
#define GW_FOLLOWER_H

#include "giveway/gw_balance.h"
#include "giveway/gw_config.h"
#include "giveway/gw_kinematics.h"
#include "giveway/gw_planar_covariance.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

#define GW_FOLLOWED_COUNT (GW_WHEEL_COUNT + 1U)          /* friction of each wheel, mass */
#define GW_FOLLOWER_STATE_COUNT (GW_FOLLOWED_COUNT + 2U) /* and o, in parts of GW_FOLLOWER_OFFSET_N */
#define GW_FOLLOWER_OFFSET_N ((gw_real_t)30.0)

typedef struct {
    /* Standard deviations of what the configuration may be wrong by, relative: friction of all wheels in common, of
     * each wheel on its own, and mass; [0, 1]. */
    gw_real_t friction_common;
    gw_real_t friction_wheel;
    gw_real_t mass;
    /* Drift of the friction, relative per root of a second, [0, 1]. */
    gw_real_t drift_per_root_s;
    /* Standard deviation of the force that does not depend on the motion, N, [0, 30]. */
    gw_real_t offset_n;
    /* Error of the balance that neither friction nor mass explains, N, [0.1, 1000]. */
    gw_real_t residual_n;
} gw_follower_config_t;

typedef struct {
    gw_follower_config_t config;
    gw_real_t difference[GW_FOLLOWER_STATE_COUNT];
    gw_real_t covariance[GW_FOLLOWER_STATE_COUNT][GW_FOLLOWER_STATE_COUNT];
    gw_real_t drift_per_call;
} gw_follower_t;

/* What a relative difference of one changes in the force, N: friction of each wheel, mass. */
typedef struct {
    gw_vector_t of[GW_FOLLOWED_COUNT];
} gw_regressors_t;

/* The values of Trikey, the paper's robot. Pointers not NULL in these two. */
void gw_follower_config_trikey(gw_follower_config_t *config);
GW_SMALL void gw_follower_config_check(const gw_follower_config_t *config, gw_config_error_t *error);
/* The configuration was checked. interval: time between two calls of gw_follower_learn, s. Pointers not NULL. */
GW_SMALL void gw_follower_init(gw_follower_t *follower, const gw_follower_config_t *config, gw_real_t interval_s);
bool gw_follower_invariant_holds(const gw_follower_t *follower);
/* The regressors of the differences in these forces. Pointers not NULL. */
gw_regressors_t gw_follower_regressors(const gw_kinematics_t *kinematics, const gw_model_forces_t *forces);
/* The force that the model lacks by what is known of the differences: to be added to the residual. Here and below no
 * pointer is NULL, and no force beyond GW_WRENCH_MAX. */
gw_vector_t gw_follower_correction(const gw_follower_t *follower, const gw_kinematics_t *kinematics,
                                   const gw_model_forces_t *forces);
/* How uncertain the model's force still is: G P G^T; no variance is negative. */
gw_planar_covariance_t gw_follower_uncertainty(const gw_follower_t *follower, const gw_regressors_t *regressors);
/* Learns from one component of a residual without contact, N; the other one's turn is later. */
GW_SMALL void gw_follower_learn(gw_follower_t *follower, const gw_regressors_t *regressors, gw_vector_t residual_n,
                                bool along_y);

#ifdef __cplusplus
}
#endif

#endif
