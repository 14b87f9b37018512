/* The balance of forces of one moment, base frame: what it leaves, and what the model put into it. */
#ifndef GW_BALANCE_H
#define GW_BALANCE_H

#include "giveway/gw_math.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Largest force, N, and moment, N m, in a balance: beyond it a value is a fault, and it is limited. */
#define GW_BALANCE_MAX ((gw_real_t)1.0e5)

/* The forces that the model computed. */
typedef struct {
    gw_wheels_t friction_n; /* of the rollers of each wheel, along its radial direction */
    gw_vector_t inertia_n;  /* M a */
    gw_real_t inertia_moment_nm;
} gw_model_forces_t;

typedef struct {
    gw_wrench_t residual;
    gw_model_forces_t model;
} gw_balance_t;

/* Moves a model's forces towards others by this share of the difference, at most 0.5; all are within the limit.
 * Pointers not NULL here and below. */
static inline void gw_model_forces_approach(gw_model_forces_t *forces, const gw_model_forces_t *target, gw_real_t share,
                                            gw_real_t limit)
{
    GW_UNROLLED
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        forces->friction_n.wheel[i] =
            gw_approached(forces->friction_n.wheel[i], target->friction_n.wheel[i], share, limit);
    }
    forces->inertia_n.x = gw_approached(forces->inertia_n.x, target->inertia_n.x, share, limit);
    forces->inertia_n.y = gw_approached(forces->inertia_n.y, target->inertia_n.y, share, limit);
    forces->inertia_moment_nm = gw_approached(forces->inertia_moment_nm, target->inertia_moment_nm, share, limit);
}

static inline void gw_wrench_approach(gw_wrench_t *wrench, const gw_wrench_t *target, gw_real_t share, gw_real_t limit)
{
    wrench->force_x_n = gw_approached(wrench->force_x_n, target->force_x_n, share, limit);
    wrench->force_y_n = gw_approached(wrench->force_y_n, target->force_y_n, share, limit);
    wrench->torque_nm = gw_approached(wrench->torque_nm, target->torque_nm, share, limit);
}

/* Both balances are limited; share at most 0.5. */
void gw_balance_approach(gw_balance_t *balance, const gw_balance_t *target, gw_real_t share);
/* from - what */
gw_balance_t gw_balance_difference(const gw_balance_t *from, const gw_balance_t *what);
/* Every value kept within GW_BALANCE_MAX. */
gw_balance_t gw_balance_limited(const gw_wrench_t *residual, const gw_model_forces_t *model);
/* a + b, kept within GW_BALANCE_MAX. */
gw_wrench_t gw_balance_sum(gw_wrench_t a, gw_wrench_t b);

/* True if every value is within the limit. */
static inline bool gw_wrench_is_within(const gw_wrench_t *wrench, gw_real_t limit)
{
    return gw_within(wrench->force_x_n, limit) && gw_within(wrench->force_y_n, limit) &&
           gw_within(wrench->torque_nm, limit);
}

static inline bool gw_model_forces_are_within(const gw_model_forces_t *forces, gw_real_t limit)
{
    bool within = gw_within(forces->inertia_n.x, limit) && gw_within(forces->inertia_n.y, limit) &&
                  gw_within(forces->inertia_moment_nm, limit);
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        within = within && gw_within(forces->friction_n.wheel[i], limit);
    }
    return within;
}

static inline bool gw_balance_is_within(const gw_balance_t *balance, gw_real_t limit)
{
    return gw_wrench_is_within(&balance->residual, limit) && gw_model_forces_are_within(&balance->model, limit);
}

#ifdef __cplusplus
}
#endif

#endif
