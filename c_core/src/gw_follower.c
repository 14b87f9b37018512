#include "giveway/gw_follower.h"

#include "giveway/gw_math.h"

#if (GW_WITH_CHANNELS == 1)

#define MASS GW_WHEEL_COUNT /* index of the mass among the followed */
/* A smaller inertial force tells nothing of the mass, N: the measured acceleration is noise. */
#define INERTIA_MIN_N ((gw_real_t)8.0)
/* No difference is larger; the limit keeps a wrong model from running away. */
#define DIFFERENCE_MAX ((gw_real_t)0.8)
/* Largest variance of a difference before anything was learned, and largest drift between two calls. */
#define COVARIANCE_MAX GW_TWO
#define DRIFT_MAX GW_TWO
/* A slope turns with the robot: the variance of o drifts so much faster. */
#define OFFSET_DRIFT ((gw_real_t)100.0)

void gw_follower_config_trikey(gw_follower_config_t *config)
{
    config->friction_common = (gw_real_t)0.3; /* +-30 %, and it may grow with a load of up to 25 % */
    config->friction_wheel = (gw_real_t)0.1;  /* +-15 % */
    config->mass = (gw_real_t)0.15;           /* -5 to +25 % */
    config->drift_per_root_s = (gw_real_t)0.01;
    config->offset_n = (gw_real_t)8.0;
    config->residual_n = (gw_real_t)5.0;
}

void gw_follower_config_check(const gw_follower_config_t *config, gw_config_error_t *error)
{
    gw_config_check_real(error, GW_FIELD_FOLLOWER_FRICTION_COMMON, config->friction_common);
    gw_config_check_real(error, GW_FIELD_FOLLOWER_FRICTION_WHEEL, config->friction_wheel);
    gw_config_check_real(error, GW_FIELD_FOLLOWER_MASS, config->mass);
    gw_config_check_real(error, GW_FIELD_FOLLOWER_DRIFT, config->drift_per_root_s);
    gw_config_check_real(error, GW_FIELD_FOLLOWER_OFFSET, config->offset_n);
    gw_config_check_real(error, GW_FIELD_FOLLOWER_RESIDUAL, config->residual_n);
}

/* Variance of a difference before anything was learned. */
static gw_real_t first_variance(const gw_follower_t *follower, uint32_t index)
{
    const gw_follower_config_t *const config = &follower->config;
    const gw_real_t offset = config->offset_n / GW_FOLLOWER_OFFSET_N;
    gw_real_t variance = offset * offset;
    if (index < MASS) {
        variance =
            (config->friction_common * config->friction_common) + (config->friction_wheel * config->friction_wheel);
    } else if (index == MASS) {
        variance = config->mass * config->mass;
    } else {
        /* the offset's */
    }
    return variance;
}

void gw_follower_init(gw_follower_t *follower, const gw_follower_config_t *config, gw_real_t interval_s)
{
    follower->config = *config;
    follower->drift_per_call = gw_min((config->drift_per_root_s * config->drift_per_root_s) * interval_s, DRIFT_MAX);
    for (uint32_t i = 0U; i < GW_FOLLOWER_STATE_COUNT; i++) {
        follower->difference[i] = GW_ZERO;
        for (uint32_t k = 0U; k < GW_FOLLOWER_STATE_COUNT; k++) {
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
        holds = (error.field == GW_FIELD_NONE) && gw_in_range(follower->drift_per_call, GW_ZERO, DRIFT_MAX);
        for (uint32_t i = 0U; i < GW_FOLLOWER_STATE_COUNT; i++) {
            holds = holds && gw_within(follower->difference[i], DIFFERENCE_MAX);
            holds = holds && (follower->covariance[i][i] >= GW_ZERO);
            for (uint32_t k = 0U; k < GW_FOLLOWER_STATE_COUNT; k++) {
                holds = holds && gw_within(follower->covariance[i][k], COVARIANCE_MAX);
            }
        }
    }
    return holds;
}

gw_regressors_t gw_follower_regressors(const gw_kinematics_t *kinematics, const gw_model_forces_t *forces)
{
    gw_regressors_t regressors;
    GW_UNROLLED
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        regressors.of[i].x = kinematics->radial[i].x * forces->friction_n.wheel[i];
        regressors.of[i].y = kinematics->radial[i].y * forces->friction_n.wheel[i];
    }
    regressors.of[MASS] = forces->inertia_n;
    return regressors;
}

gw_vector_t gw_follower_correction(const gw_follower_t *follower, const gw_kinematics_t *kinematics,
                                   const gw_model_forces_t *forces)
{
    gw_vector_t sum = {follower->difference[MASS] * forces->inertia_n.x,
                       follower->difference[MASS] * forces->inertia_n.y};
    GW_UNROLLED
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        const gw_real_t missing_n = follower->difference[i] * forces->friction_n.wheel[i];
        sum.x += missing_n * kinematics->radial[i].x;
        sum.y += missing_n * kinematics->radial[i].y;
    }
    return sum;
}

gw_planar_covariance_t gw_follower_uncertainty(const gw_follower_t *follower, const gw_regressors_t *regressors)
{
    gw_planar_covariance_t sum = {GW_ZERO, GW_ZERO, GW_ZERO};
    GW_UNROLLED
    for (uint32_t i = 0U; i < GW_FOLLOWED_COUNT; i++) {
        /* P is symmetric: twice what is right of the diagonal, times the regressors. */
        const gw_vector_t g = regressors->of[i];
        const gw_real_t own = follower->covariance[i][i];
        gw_vector_t row = {own * g.x, own * g.y};
        GW_UNROLLED
        for (uint32_t k = i + 1U; k < GW_FOLLOWED_COUNT; k++) {
            row.x += (GW_TWO * follower->covariance[i][k]) * regressors->of[k].x;
            row.y += (GW_TWO * follower->covariance[i][k]) * regressors->of[k].y;
        }
        sum.xx += row.x * g.x;
        sum.xy += GW_HALF * ((row.x * g.y) + (row.y * g.x));
        sum.yy += row.y * g.y;
    }
    /* Rounding must not make a variance negative. */
    sum.xx = gw_max(sum.xx, GW_ZERO);
    sum.yy = gw_max(sum.yy, GW_ZERO);
    return sum;
}

/* A scalar measurement, h d = residual. */
static void learn_component(gw_follower_t *follower, const gw_real_t h[GW_FOLLOWER_STATE_COUNT], gw_real_t residual_n)
{
    gw_real_t gain[GW_FOLLOWER_STATE_COUNT];
    const gw_real_t least_n2 = follower->config.residual_n * follower->config.residual_n;
    gw_real_t variance_n2 = least_n2;
    gw_real_t surprise_n = residual_n;
    for (uint32_t i = 0U; i < GW_FOLLOWER_STATE_COUNT; i++) {
        gain[i] = GW_ZERO;
        for (uint32_t k = 0U; k < GW_FOLLOWER_STATE_COUNT; k++) {
            gain[i] += follower->covariance[i][k] * h[k];
        }
        variance_n2 += gain[i] * h[i];
        surprise_n -= h[i] * follower->difference[i];
    }
    variance_n2 = gw_max(variance_n2, least_n2); /* as a covariance demands; rounding does not know */
    for (uint32_t i = 0U; i < GW_FOLLOWER_STATE_COUNT; i++) {
        const gw_real_t share = gain[i] / variance_n2;
        follower->difference[i] =
            gw_clamp(follower->difference[i] + (share * surprise_n), -DIFFERENCE_MAX, DIFFERENCE_MAX);
        for (uint32_t k = 0U; k < GW_FOLLOWER_STATE_COUNT; k++) {
            follower->covariance[i][k] =
                gw_clamp(follower->covariance[i][k] - (share * gain[k]), -COVARIANCE_MAX, COVARIANCE_MAX);
        }
        follower->covariance[i][i] = gw_max(follower->covariance[i][i], GW_ZERO);
    }
}

void gw_follower_learn(gw_follower_t *follower, const gw_regressors_t *regressors, gw_vector_t residual_n, bool along_y)
{
    const bool tells_mass = gw_length(regressors->of[MASS]) >= INERTIA_MIN_N;
    gw_real_t h[GW_FOLLOWER_STATE_COUNT];
    for (uint32_t i = 0U; i < GW_FOLLOWED_COUNT; i++) {
        h[i] = -(along_y ? regressors->of[i].y : regressors->of[i].x);
    }
    h[GW_FOLLOWED_COUNT] = along_y ? GW_ZERO : -GW_FOLLOWER_OFFSET_N;
    h[GW_FOLLOWED_COUNT + 1U] = along_y ? -GW_FOLLOWER_OFFSET_N : GW_ZERO;
    for (uint32_t i = 0U; i < GW_FOLLOWER_STATE_COUNT; i++) {
        /* Drift, of a payload as of friction; no more is forgotten than was ever learned. */
        if (follower->covariance[i][i] < first_variance(follower, i)) {
            follower->covariance[i][i] +=
                (i < GW_FOLLOWED_COUNT) ? follower->drift_per_call : (OFFSET_DRIFT * follower->drift_per_call);
        }
    }
    if (!tells_mass) {
        h[MASS] = GW_ZERO;
    }
    learn_component(follower, h, along_y ? residual_n.y : residual_n.x);
}

#endif
