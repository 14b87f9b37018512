#include "giveway/gw_follower.h"

#include "giveway/gw_math.h"

#define MASS GW_WHEEL_COUNT /* index of the mass among the followed */
/* A smaller inertial force tells nothing of the mass, N: the measured acceleration is noise. */
#define INERTIA_MIN_N ((gw_real_t)8.0)
/* No difference is larger; the limit keeps a wrong model from running away. */
#define DIFFERENCE_MAX ((gw_real_t)0.8)

void gw_follower_config_trikey(gw_follower_config_t *config)
{
    config->friction_common = (gw_real_t)0.173; /* +-30 %, uniform */
    config->friction_wheel = (gw_real_t)0.087;  /* +-15 % */
    config->mass = (gw_real_t)0.12;             /* -5 to +25 % */
    config->drift_per_root_s = (gw_real_t)0.01;
    config->residual_n = (gw_real_t)5.0;
}

void gw_follower_config_check(const gw_follower_config_t *config, gw_config_error_t *error)
{
    gw_config_check_real(error, GW_FIELD_FOLLOWER_FRICTION_COMMON, config->friction_common);
    gw_config_check_real(error, GW_FIELD_FOLLOWER_FRICTION_WHEEL, config->friction_wheel);
    gw_config_check_real(error, GW_FIELD_FOLLOWER_MASS, config->mass);
    gw_config_check_real(error, GW_FIELD_FOLLOWER_DRIFT, config->drift_per_root_s);
    gw_config_check_real(error, GW_FIELD_FOLLOWER_RESIDUAL, config->residual_n);
}

/* Variance of a difference before anything was learned. */
static gw_real_t first_variance(const gw_follower_t *follower, uint32_t index)
{
    const gw_follower_config_t *const config = &follower->config;
    return (index == MASS) ? (config->mass * config->mass)
                           : ((config->friction_common * config->friction_common) +
                              (config->friction_wheel * config->friction_wheel));
}

void gw_follower_init(gw_follower_t *follower, const gw_follower_config_t *config, gw_real_t interval_s)
{
    follower->config = *config;
    follower->drift_per_call = (config->drift_per_root_s * config->drift_per_root_s) * interval_s;
    for (uint32_t i = 0U; i < GW_FOLLOWED_COUNT; i++) {
        follower->difference[i] = GW_ZERO;
        for (uint32_t k = 0U; k < GW_FOLLOWED_COUNT; k++) {
            const bool both_wheels = (i < MASS) && (k < MASS);
            follower->covariance[i][k] = both_wheels ? (config->friction_common * config->friction_common) : GW_ZERO;
        }
        follower->covariance[i][i] = first_variance(follower, i);
    }
}

bool gw_follower_invariant_holds(const gw_follower_t *follower)
{
    bool holds = (follower != NULL);
    if (holds) {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_follower_config_check(&follower->config, &error);
        holds = (error.field == GW_FIELD_NONE);
        for (uint32_t i = 0U; i < GW_FOLLOWED_COUNT; i++) {
            holds = holds && gw_within(follower->difference[i], DIFFERENCE_MAX);
            for (uint32_t k = 0U; k < GW_FOLLOWED_COUNT; k++) {
                holds = holds && gw_within(follower->covariance[i][k], GW_TWO);
            }
        }
    }
    return holds;
}

/* The columns of the regressor: what a relative difference of one changes in the force. */
static void columns_of(const gw_kinematics_t *kinematics, const gw_model_forces_t *forces,
                       gw_vector_t column[GW_FOLLOWED_COUNT])
{
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        column[i].x = kinematics->radial[i].x * forces->friction_n.wheel[i];
        column[i].y = kinematics->radial[i].y * forces->friction_n.wheel[i];
    }
    column[MASS] = forces->inertia_n;
}

gw_vector_t gw_follower_correction(const gw_follower_t *follower, const gw_kinematics_t *kinematics,
                                   const gw_model_forces_t *forces)
{
    gw_vector_t sum = {GW_ZERO, GW_ZERO};
    gw_vector_t column[GW_FOLLOWED_COUNT];
    columns_of(kinematics, forces, column);
    for (uint32_t i = 0U; i < GW_FOLLOWED_COUNT; i++) {
        sum.x += follower->difference[i] * column[i].x;
        sum.y += follower->difference[i] * column[i].y;
    }
    return sum;
}

gw_planar_covariance_t gw_follower_uncertainty(const gw_follower_t *follower, const gw_kinematics_t *kinematics,
                                               const gw_model_forces_t *forces, gw_real_t shape_variance)
{
    gw_planar_covariance_t sum = {GW_ZERO, GW_ZERO, GW_ZERO};
    gw_vector_t column[GW_FOLLOWED_COUNT];
    columns_of(kinematics, forces, column);
    for (uint32_t i = 0U; i < GW_FOLLOWED_COUNT; i++) {
        /* P is symmetric: row i of P times the columns. */
        gw_vector_t row = {GW_ZERO, GW_ZERO};
        for (uint32_t k = 0U; k < GW_FOLLOWED_COUNT; k++) {
            row.x += follower->covariance[i][k] * column[k].x;
            row.y += follower->covariance[i][k] * column[k].y;
        }
        if (i < MASS) {
            row.x += shape_variance * column[i].x;
            row.y += shape_variance * column[i].y;
        }
        sum.xx += row.x * column[i].x;
        sum.xy += row.x * column[i].y;
        sum.yy += row.y * column[i].y;
    }
    return sum;
}

/* One component of the residual: a scalar measurement h d = residual. */
static void learn_component(gw_follower_t *follower, const gw_real_t h[GW_FOLLOWED_COUNT], gw_real_t residual_n)
{
    gw_real_t gain[GW_FOLLOWED_COUNT];
    gw_real_t variance = follower->config.residual_n * follower->config.residual_n;
    gw_real_t surprise_n = residual_n;
    for (uint32_t i = 0U; i < GW_FOLLOWED_COUNT; i++) {
        gain[i] = GW_ZERO;
        for (uint32_t k = 0U; k < GW_FOLLOWED_COUNT; k++) {
            gain[i] += follower->covariance[i][k] * h[k];
        }
        variance += gain[i] * h[i];
        surprise_n -= h[i] * follower->difference[i];
    }
    for (uint32_t i = 0U; i < GW_FOLLOWED_COUNT; i++) {
        const gw_real_t share = gain[i] / variance;
        follower->difference[i] = gw_clamp(follower->difference[i] + (share * surprise_n), -DIFFERENCE_MAX,
                                           DIFFERENCE_MAX);
        for (uint32_t k = 0U; k < GW_FOLLOWED_COUNT; k++) {
            follower->covariance[i][k] = gw_clamp(follower->covariance[i][k] - (share * gain[k]), -GW_TWO, GW_TWO);
        }
    }
}

void gw_follower_learn(gw_follower_t *follower, const gw_kinematics_t *kinematics, const gw_model_forces_t *forces,
                       gw_vector_t residual_n)
{
    gw_vector_t column[GW_FOLLOWED_COUNT];
    gw_real_t h_x[GW_FOLLOWED_COUNT];
    gw_real_t h_y[GW_FOLLOWED_COUNT];
    columns_of(kinematics, forces, column);
    if (gw_length(forces->inertia_n) < INERTIA_MIN_N) {
        column[MASS].x = GW_ZERO;
        column[MASS].y = GW_ZERO;
    }
    for (uint32_t i = 0U; i < GW_FOLLOWED_COUNT; i++) {
        h_x[i] = -column[i].x;
        h_y[i] = -column[i].y;
        /* Drift; no more is forgotten than was ever learned. */
        if ((i < MASS) && (follower->covariance[i][i] < first_variance(follower, i))) {
            follower->covariance[i][i] += follower->drift_per_call;
        }
    }
    learn_component(follower, h_x, residual_n.x);
    learn_component(follower, h_y, residual_n.y);
}
