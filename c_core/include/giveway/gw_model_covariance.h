/* How much force the model may be wrong by, as a covariance: k_m^2 (G P G^T + friction that no factor explains).
 *
 * P is what the follower does not know of friction and mass, G the regressors. Friction of each wheel is uncertain
 * besides by a share of itself, and by a share of what is missing to full sliding: a roller that hardly turns may be
 * anywhere between the limits of its friction, whatever the model says. */
#ifndef GW_MODEL_COVARIANCE_H
#define GW_MODEL_COVARIANCE_H

#include "giveway/gw_balance.h"
#include "giveway/gw_channels_config.h"
#include "giveway/gw_follower.h"
#include "giveway/gw_kinematics.h"
#include "giveway/gw_planar_covariance.h"

#ifdef __cplusplus
extern "C" {
#endif

/* change: the forces that count, from those of a baseline; model: the forces themselves; sliding_n: friction of a wheel
 * whose rollers slide; presliding: the share of what is missing to it. What rollers carry within it is their history's,
 * of which the model knows a part: now, and at the baseline's time. Friction that is higher than the model's also turns
 * round later than that. Pointers not NULL. */
gw_planar_covariance_t gw_model_covariance(const gw_channels_config_t *config, const gw_kinematics_t *kinematics,
                                           const gw_follower_t *follower, const gw_model_forces_t *change,
                                           const gw_model_forces_t *model, gw_real_t sliding_n, gw_real_t presliding);

#ifdef __cplusplus
}
#endif

#endif
