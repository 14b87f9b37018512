#include "giveway/gw_tip.h"

#include "giveway/gw_math.h"

#if (GW_WITH_ESCAPE == 1)

#define GRAVITY_MPS2 ((gw_real_t)9.80665)
#define LEAST_MPS2 ((gw_real_t)0.05)
#define ALONG_MIN_MPS2 ((gw_real_t)0.01) /* less than LEAST_MPS2 over what rounding makes of a unit vector */
#define HEIGHT_MIN_M ((gw_real_t)1.0e-6) /* a robot so low has the largest margin */
#define MARGIN_MAX ((gw_real_t)1.0e6)

void gw_tip_config_trikey(gw_tip_config_t *config)
{
    config->height_m = GW_ZERO;
    config->share = (gw_real_t)0.45;
    config->offset_m = (gw_real_t)0.03;
    config->slope_rad = (gw_real_t)0.0175;
}

void gw_tip_config_check(const gw_tip_config_t *config, gw_config_error_t *error)
{
    gw_config_check_real(error, GW_FIELD_ADMITTANCE_TIP_HEIGHT, config->height_m);
    gw_config_check_real(error, GW_FIELD_ADMITTANCE_TIP_SHARE, config->share);
    gw_config_check_real(error, GW_FIELD_ADMITTANCE_TIP_OFFSET, config->offset_m);
    gw_config_check_real(error, GW_FIELD_ADMITTANCE_TIP_SLOPE, config->slope_rad);
}

void gw_tip_none(gw_tip_t *tip)
{
    for (uint32_t i = 0U; i < GW_TIP_DIRECTIONS; i++) {
        tip->radial[i].x = GW_ZERO;
        tip->radial[i].y = GW_ZERO;
    }
    tip->margin_mps2 = GW_ZERO;
}

void gw_tip_init(gw_tip_t *tip, const gw_tip_config_t *config, const gw_kinematics_t *kinematics)
{
    gw_tip_none(tip);
    if (config->height_m > GW_ZERO) {
        const gw_real_t edge_m = (GW_HALF * kinematics->wheel_distance_m) - config->offset_m;
        const gw_real_t whole_mps2 =
            (GRAVITY_MPS2 * (edge_m - (config->slope_rad * config->height_m))) / gw_max(config->height_m, HEIGHT_MIN_M);
        tip->margin_mps2 = gw_clamp(config->share * whole_mps2, LEAST_MPS2, MARGIN_MAX);
        for (uint32_t i = 0U; i < GW_TIP_DIRECTIONS; i++) {
            tip->radial[i] = kinematics->radial[i];
        }
    }
}

bool gw_tip_invariant_holds(const gw_tip_t *tip)
{
    bool holds = (tip != NULL);
    if (holds) {
        holds = gw_in_range(tip->margin_mps2, GW_ZERO, MARGIN_MAX);
        for (uint32_t i = 0U; i < GW_TIP_DIRECTIONS; i++) {
            holds = holds && gw_within(tip->radial[i].x, GW_TWO) && gw_within(tip->radial[i].y, GW_TWO);
        }
    }
    return holds;
}

/* The largest part of a vector towards a wheel. */
static gw_real_t towards_a_wheel(const gw_tip_t *tip, gw_vector_t vector)
{
    const gw_real_t first = gw_along_radial(tip->radial[0], vector.x, vector.y);
    const gw_real_t second = gw_along_radial(tip->radial[1], vector.x, vector.y);
    return gw_max(gw_max(first, second), -(first + second));
}

gw_real_t gw_tip_share(const gw_tip_t *tip, gw_vector_t change_mps, gw_real_t period_s)
{
    const gw_real_t most_mps = tip->margin_mps2 * period_s;
    const gw_real_t largest_mps = towards_a_wheel(tip, change_mps);
    return (largest_mps > most_mps) ? gw_fraction(most_mps, largest_mps) : GW_ONE;
}

gw_real_t gw_tip_along(const gw_tip_t *tip, gw_vector_t unit, gw_real_t limit_mps2)
{
    const gw_real_t largest = towards_a_wheel(tip, unit);
    gw_real_t along_mps2 = limit_mps2;
    if ((limit_mps2 * largest) > tip->margin_mps2) {
        along_mps2 = gw_max(limit_mps2 * gw_fraction(tip->margin_mps2, limit_mps2 * largest), ALONG_MIN_MPS2);
    }
    return along_mps2;
}

#endif
