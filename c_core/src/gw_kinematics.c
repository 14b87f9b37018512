#include "giveway/gw_kinematics.h"

#include "giveway/gw_math.h"
#include "giveway/gw_trikey.h"

/* One bit for each slot. */
#define EVERY_SLOT (((uint32_t)1U << GW_WHEEL_COUNT) - 1U)
#define HALF_SQRT_3 ((gw_real_t)0.8660254037844386467637)

void gw_geometry_config_trikey(gw_geometry_config_t *config)
{
    config->wheel_radius_m = GW_TRIKEY_WHEEL_RADIUS_M;
    config->roller_radius_m = GW_TRIKEY_ROLLER_RADIUS_M;
    config->wheel_distance_m = GW_TRIKEY_WHEEL_DISTANCE_M;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        config->wheel_slot[i] = i;
    }
    config->azimuth_rad = GW_ZERO;
}

void gw_geometry_config_check(const gw_geometry_config_t *config, gw_config_error_t *error)
{
    uint32_t slots_seen = 0U;
    gw_config_check_real(error, GW_FIELD_GEOMETRY_WHEEL_RADIUS, config->wheel_radius_m);
    gw_config_check_real(error, GW_FIELD_GEOMETRY_ROLLER_RADIUS, config->roller_radius_m);
    gw_config_check_real(error, GW_FIELD_GEOMETRY_WHEEL_DISTANCE, config->wheel_distance_m);
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        gw_config_check_element(error, GW_FIELD_GEOMETRY_WHEEL_SLOT, i, (gw_real_t)config->wheel_slot[i]);
        if (config->wheel_slot[i] < GW_WHEEL_COUNT) {
            slots_seen |= ((uint32_t)1U << config->wheel_slot[i]);
        }
    }
    if (slots_seen != EVERY_SLOT) {
        /* Two wheels share a slot: name the last one, which leaves another slot free. No value repairs it alone. */
        gw_config_check_relation(error, GW_FIELD_GEOMETRY_WHEEL_SLOT, GW_WHEEL_COUNT - 1U,
                                 (gw_real_t)config->wheel_slot[GW_WHEEL_COUNT - 1U], GW_ONE, GW_ZERO);
    }
    gw_config_check_real(error, GW_FIELD_GEOMETRY_AZIMUTH, config->azimuth_rad);
}

gw_status_t gw_kinematics_init(gw_kinematics_t *kinematics, const gw_geometry_config_t *config)
{
    /* cos and sin of 0, 120 and 240 degrees, better than computed ones. */
    static const gw_vector_t slot_direction[GW_WHEEL_COUNT] = {
        {(gw_real_t)1.0, (gw_real_t)0.0},
        {(gw_real_t)-0.5, HALF_SQRT_3},
        {(gw_real_t)-0.5, -HALF_SQRT_3},
    };
    gw_status_t status = GW_STATUS_OK;
    if ((kinematics == NULL) || (config == NULL)) {
        status = GW_STATUS_NULL_POINTER;
    } else {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_geometry_config_check(config, &error);
        if (error.field != GW_FIELD_NONE) {
            status = GW_STATUS_CONFIG_INVALID;
        } else {
            const gw_rotation_t rotation = gw_sincos(config->azimuth_rad);
            for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
                kinematics->radial[i] = gw_rotate(rotation, slot_direction[config->wheel_slot[i]]);
            }
            kinematics->wheel_radius_m = config->wheel_radius_m;
            kinematics->roller_radius_m = config->roller_radius_m;
            kinematics->wheel_distance_m = config->wheel_distance_m;
            kinematics->per_wheel_radius = GW_ONE / config->wheel_radius_m;
            kinematics->per_roller_radius = GW_ONE / config->roller_radius_m;
        }
    }
    return status;
}

bool gw_kinematics_invariant_holds(const gw_kinematics_t *kinematics)
{
    bool holds = (kinematics != NULL);
    if (holds) {
        holds = (kinematics->wheel_radius_m > GW_ZERO) && (kinematics->roller_radius_m > GW_ZERO) &&
                (kinematics->wheel_distance_m > GW_ZERO) && gw_is_finite(kinematics->per_wheel_radius) &&
                gw_is_finite(kinematics->per_roller_radius) && gw_is_finite(kinematics->wheel_distance_m);
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            holds = holds && gw_in_range(gw_length(kinematics->radial[i]), (gw_real_t)0.99, (gw_real_t)1.01);
        }
    }
    return holds;
}
