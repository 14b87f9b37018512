#include "giveway/gw_presliding.h"

#include "giveway/gw_math.h"
#include "giveway/gw_trikey.h"
#include "giveway/gw_wrench.h"

/* Keeps rho finite for rollers without friction, N. */
#define BEARABLE_MIN_N ((gw_real_t)0.000001)
/* Longest displacement of a wheel within a sample, m; beyond it the sensors are wrong, and the deflection stays. */
#define DISPLACEMENT_MAX_M GW_ONE
#define THREE ((gw_real_t)3.0)

void gw_presliding_config_trikey(gw_presliding_config_t *config)
{
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        config->stiffness_n_per_m[i] = GW_TRIKEY_ROLLER_PRESLIDING_STIFFNESS_N_PER_M;
    }
    config->damping_newton_s_per_m = GW_TRIKEY_ROLLER_PRESLIDING_DAMPING_NEWTON_S_PER_M;
    config->stribeck_speed_mps = GW_TRIKEY_ROLLER_STRIBECK_SPEED_MPS;
    config->elastic_fraction = GW_TRIKEY_ROLLER_ELASTIC_FRACTION;
}

void gw_presliding_config_check(const gw_presliding_config_t *config, gw_config_error_t *error)
{
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        gw_config_check_element(error, GW_FIELD_ESTIMATOR_PRESLIDING_STIFFNESS, i, config->stiffness_n_per_m[i]);
    }
    gw_config_check_real(error, GW_FIELD_ESTIMATOR_PRESLIDING_DAMPING, config->damping_newton_s_per_m);
    gw_config_check_real(error, GW_FIELD_ESTIMATOR_STRIBECK_SPEED, config->stribeck_speed_mps);
    gw_config_check_real(error, GW_FIELD_ESTIMATOR_ELASTIC_FRACTION, config->elastic_fraction);
}

#if (GW_WITH_CHANNELS == 1)
static void init_turns(gw_presliding_t *presliding)
{
    presliding->in_turn = false;
    presliding->turn = 0U;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        presliding->bearable_now_n.wheel[i] = presliding->bearable_n; /* at rest */
    }
}

void gw_presliding_take_turns(gw_presliding_t *presliding)
{
    presliding->in_turn = true;
}

static bool turns_hold(const gw_presliding_t *presliding)
{
    bool holds = (presliding->turn < GW_WHEEL_COUNT);
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        holds = holds && gw_in_range(presliding->bearable_now_n.wheel[i], BEARABLE_MIN_N, presliding->bearable_n);
    }
    return holds;
}

static void next_turn(gw_presliding_t *presliding)
{
    presliding->turn = (presliding->turn + 1U) % GW_WHEEL_COUNT;
}
#else
static void init_turns(const gw_presliding_t *presliding)
{
    (void)presliding;
}

static bool turns_hold(const gw_presliding_t *presliding)
{
    (void)presliding;
    return true;
}

static void next_turn(const gw_presliding_t *presliding)
{
    (void)presliding;
}
#endif

gw_status_t gw_presliding_init(gw_presliding_t *presliding, const gw_presliding_config_t *config,
                               const gw_friction_config_t *friction, const gw_kinematics_t *kinematics)
{
    gw_status_t status = GW_STATUS_OK;
    if ((presliding == NULL) || (config == NULL) || (friction == NULL) || (kinematics == NULL)) {
        status = GW_STATUS_NULL_POINTER;
    } else {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_presliding_config_check(config, &error);
        gw_friction_config_check(friction, &error);
        if (error.field != GW_FIELD_NONE) {
            status = GW_STATUS_CONFIG_INVALID;
        } else {
            presliding->config = *config;
            presliding->friction = *friction;
            presliding->bearable_n =
                gw_max(friction->coulomb_torque_nm * kinematics->per_roller_radius, BEARABLE_MIN_N);
            for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
                presliding->deflection_m[i] = gw_sum_of(GW_ZERO);
                presliding->last_torque_nm.wheel[i] = GW_ZERO;
                presliding->last_count[i] = 0;
            }
            init_turns(presliding);
            gw_presliding_gap(presliding);
        }
    }
    return status;
}

/* Deflection of a roller that bears force_n. */
static gw_real_t deflection_of(const gw_presliding_t *presliding, uint32_t wheel, gw_real_t force_n)
{
    return force_n / presliding->config.stiffness_n_per_m[wheel];
}

bool gw_presliding_invariant_holds(const gw_presliding_t *presliding)
{
    bool holds = (presliding != NULL);
    if (holds) {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_presliding_config_check(&presliding->config, &error);
        gw_friction_config_check(&presliding->friction, &error);
        holds = (error.field == GW_FIELD_NONE) && gw_in_range(presliding->bearable_n, BEARABLE_MIN_N, GW_REAL_MAX) &&
                turns_hold(presliding);
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            const gw_real_t most_m = deflection_of(presliding, i, presliding->bearable_n);
            holds = holds && gw_in_range(presliding->deflection_m[i].value, -most_m, most_m) &&
                    gw_sum_invariant_holds(presliding->deflection_m[i]) &&
                    gw_within(presliding->last_torque_nm.wheel[i], GW_TORQUE_MAX);
        }
    }
    return holds;
}

void gw_presliding_gap(gw_presliding_t *presliding)
{
    presliding->torque_known = false;
    presliding->count_known = false;
}

void gw_presliding_settle(gw_presliding_t *presliding, const gw_wheels_t *mean_torque_nm)
{
    presliding->last_torque_nm = *mean_torque_nm;
    presliding->torque_known = true;
}

gw_wheels_t gw_presliding_elastic_torques(const gw_presliding_t *presliding, const gw_kinematics_t *kinematics)
{
    gw_wheels_t torques;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        torques.wheel[i] =
            (presliding->config.stiffness_n_per_m[i] * presliding->deflection_m[i].value) * kinematics->roller_radius_m;
    }
    return torques;
}

/* How far the wheels turned since the last sample: encoders, less the change of the drivetrains' twist. */
static gw_wheels_t turned(gw_presliding_t *presliding, const gw_rate_filter_constants_t *rate_constants,
                          const int32_t encoder_count[GW_WHEEL_COUNT], const gw_wheels_t *torque_nm)
{
    gw_wheels_t turned_rad;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        const int32_t counts =
            presliding->count_known ? gw_count_difference(encoder_count[i], presliding->last_count[i]) : 0;
        const gw_real_t change_nm =
            presliding->torque_known ? (torque_nm->wheel[i] - presliding->last_torque_nm.wheel[i]) : GW_ZERO;
        turned_rad.wheel[i] = gw_rate_filter_turned(rate_constants, counts, change_nm);
        presliding->last_count[i] = encoder_count[i];
    }
    presliding->last_torque_nm = *torque_nm;
    presliding->torque_known = true;
    presliding->count_known = true;
    return turned_rad;
}

/* g: what a roller bears at a speed along the axle. */
static gw_real_t bearable_at(const gw_presliding_t *presliding, const gw_kinematics_t *kinematics, gw_real_t speed_mps)
{
    const gw_real_t slow = speed_mps / presliding->config.stribeck_speed_mps;
    const gw_real_t stick = gw_exp(-(slow * slow));
    const gw_real_t steady =
        gw_tanh(presliding->friction.tanh_slope_s_per_rad * (gw_magnitude(speed_mps) * kinematics->per_roller_radius));
    const gw_real_t share = stick + ((GW_ONE - stick) * steady);
    return gw_clamp(presliding->bearable_n * share, BEARABLE_MIN_N, presliding->bearable_n);
}

#if (GW_WITH_CHANNELS == 1)
/* g of a wheel: of this tick, or of its last turn. */
static gw_real_t bearable_of(gw_presliding_t *presliding, const gw_kinematics_t *kinematics, uint32_t wheel,
                             gw_real_t speed_mps)
{
    if ((!presliding->in_turn) || (wheel == presliding->turn)) {
        presliding->bearable_now_n.wheel[wheel] = bearable_at(presliding, kinematics, speed_mps);
    }
    return presliding->bearable_now_n.wheel[wheel];
}
#else
static gw_real_t bearable_of(const gw_presliding_t *presliding, const gw_kinematics_t *kinematics, uint32_t wheel,
                             gw_real_t speed_mps)
{
    (void)wheel;
    return bearable_at(presliding, kinematics, speed_mps);
}
#endif

/* Does a displacement, or speed, with this sign deflect the bristle further? */
static bool deflects_further(gw_real_t deflection_m, gw_real_t motion)
{
    return (deflection_m > GW_ZERO) ? (motion > GW_ZERO) : ((deflection_m < GW_ZERO) && (motion < GW_ZERO));
}

/* 1 - A rho: how much of a motion that deflects the bristle further goes into it; the rest is sliding. */
static gw_real_t deflecting_share(const gw_presliding_t *presliding, uint32_t wheel, gw_real_t bearable_n)
{
    const gw_real_t deflection_m = presliding->deflection_m[wheel].value;
    const gw_real_t rho = (presliding->config.stiffness_n_per_m[wheel] * gw_magnitude(deflection_m)) / bearable_n;
    const gw_real_t beyond =
        (rho - presliding->config.elastic_fraction) / (GW_ONE - presliding->config.elastic_fraction);
    const gw_real_t y = gw_clamp(beyond, GW_ZERO, GW_ONE);
    const gw_real_t sliding = (y * y) * (THREE - (GW_TWO * y));
    return GW_ONE - (sliding * rho);
}

/* Moves the deflection by the displacement of one sample. The exact solution approaches g/sigma0 from either side and
 * never passes it; neither does this, however long the displacement. */
static void deflect(gw_presliding_t *presliding, uint32_t wheel, gw_real_t bearable_n, gw_real_t displacement_m,
                    gw_real_t share)
{
    const gw_sum_t before_m = presliding->deflection_m[wheel];
    const gw_real_t most_m = deflection_of(presliding, wheel, presliding->bearable_n);
    const gw_real_t end_m = deflection_of(presliding, wheel, (displacement_m > GW_ZERO) ? bearable_n : -bearable_n);
    const bool below = before_m.value < end_m;
    const gw_real_t low_m = below ? -most_m : end_m;
    const gw_real_t high_m = below ? end_m : most_m;
    gw_sum_t after_m = gw_sum_add(before_m, displacement_m * share);
    if (!gw_in_range(after_m.value, low_m, high_m)) {
        after_m = gw_sum_of(gw_clamp(after_m.value, low_m, high_m));
    }
    presliding->deflection_m[wheel] = gw_sum_limit(after_m, most_m);
}

gw_wheels_t gw_presliding_step(gw_presliding_t *presliding, const gw_kinematics_t *kinematics,
                               const gw_rate_filter_constants_t *rate_constants,
                               const int32_t encoder_count[GW_WHEEL_COUNT], const gw_wheels_t *torque_nm,
                               gw_twist_t twist)
{
    gw_wheels_t torques;
    /* cppcheck-suppress misra-c2012-9.3 ; DEV-01 a whole struct from a call */
    const gw_wheels_t turned_rad = turned(presliding, rate_constants, encoder_count, torque_nm);
    /* Angles instead of rates: the displacement of the base, in m and rad. */
    const gw_twist_t moved = gw_kinematics_twist(kinematics, &turned_rad);
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        const gw_vector_t n = kinematics->radial[i];
        const gw_real_t speed_mps = gw_along_radial(n, twist.vx_mps, twist.vy_mps);
        const gw_real_t displacement_m = gw_along_radial(n, moved.vx_mps, moved.vy_mps);
        const gw_real_t bearable_n = bearable_of(presliding, kinematics, i, speed_mps);
        /* Speed and displacement may differ in sign: the filtered speed lags. Of each that deflects the bristle further
         * this share goes into it; one that relieves the bristle does so whole. */
        const bool speed_deflects = deflects_further(presliding->deflection_m[i].value, speed_mps);
        const bool displacement_deflects = deflects_further(presliding->deflection_m[i].value, displacement_m);
        const gw_real_t share =
            (speed_deflects || displacement_deflects) ? deflecting_share(presliding, i, bearable_n) : GW_ONE;
        const gw_real_t rate_mps = speed_deflects ? (speed_mps * share) : speed_mps;
        if (gw_within(displacement_m, DISPLACEMENT_MAX_M)) {
            deflect(presliding, i, bearable_n, gw_known_within(displacement_m, DISPLACEMENT_MAX_M),
                    displacement_deflects ? share : GW_ONE);
        }
        const gw_real_t force_n = (presliding->config.stiffness_n_per_m[i] * presliding->deflection_m[i].value) +
                                  (presliding->config.damping_newton_s_per_m * rate_mps);
        torques.wheel[i] = force_n * kinematics->roller_radius_m;
    }
    next_turn(presliding);
    return torques;
}
