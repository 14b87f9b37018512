#include "giveway/gw_nominal.h"

#include "giveway/gw_math.h"
#include "giveway/gw_trikey.h"

void gw_inertia_config_trikey(gw_inertia_config_t *config)
{
    config->mass_kg = GW_TRIKEY_BASE_MASS_KG;
    config->yaw_inertia_kgm2 = GW_TRIKEY_BASE_YAW_INERTIA_KGM2;
    config->wheel_inertia_kgm2 = GW_TRIKEY_WHEEL_INERTIA_KGM2;
    config->roller_inertia_kgm2 = GW_TRIKEY_ROLLER_INERTIA_KGM2;
}

void gw_inertia_config_check(const gw_inertia_config_t *config, gw_config_error_t *error)
{
    gw_config_check_real(error, GW_FIELD_BASE_MASS, config->mass_kg);
    gw_config_check_real(error, GW_FIELD_BASE_YAW_INERTIA, config->yaw_inertia_kgm2);
    gw_config_check_real(error, GW_FIELD_BASE_WHEEL_INERTIA, config->wheel_inertia_kgm2);
    gw_config_check_real(error, GW_FIELD_BASE_ROLLER_INERTIA, config->roller_inertia_kgm2);
}

gw_status_t gw_nominal_init(gw_nominal_t *nominal, const gw_inertia_config_t *inertia,
                            const gw_friction_config_t *friction, const gw_kinematics_t *kinematics)
{
    gw_status_t status = GW_STATUS_OK;
    if ((nominal == NULL) || (inertia == NULL) || (friction == NULL) || (kinematics == NULL)) {
        status = GW_STATUS_NULL_POINTER;
    } else {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_inertia_config_check(inertia, &error);
        gw_friction_config_check(friction, &error);
        if (error.field != GW_FIELD_NONE) {
            status = GW_STATUS_CONFIG_INVALID;
        } else {
            const gw_real_t wheel_mass_kg =
                (inertia->wheel_inertia_kgm2 * kinematics->per_wheel_radius) * kinematics->per_wheel_radius;
            const gw_real_t roller_mass_kg =
                (inertia->roller_inertia_kgm2 * kinematics->per_roller_radius) * kinematics->per_roller_radius;
            const gw_real_t distance_squared_m2 = kinematics->wheel_distance_m * kinematics->wheel_distance_m;
            nominal->rolling_mass_kg = GW_HALF_WHEELS * (wheel_mass_kg + roller_mass_kg);
            nominal->total_mass_kg = inertia->mass_kg + nominal->rolling_mass_kg;
            nominal->total_yaw_inertia_kgm2 =
                inertia->yaw_inertia_kgm2 + ((GW_WHEELS * wheel_mass_kg) * distance_squared_m2);
            nominal->friction = *friction;
        }
    }
    return status;
}

bool gw_nominal_invariant_holds(const gw_nominal_t *nominal)
{
    bool holds = (nominal != NULL);
    if (holds) {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_friction_config_check(&nominal->friction, &error);
        holds = (error.field == GW_FIELD_NONE) && gw_in_range(nominal->total_mass_kg, GW_ZERO, GW_REAL_MAX) &&
                gw_in_range(nominal->total_yaw_inertia_kgm2, GW_ZERO, GW_REAL_MAX) &&
                gw_in_range(nominal->rolling_mass_kg, GW_ZERO, nominal->total_mass_kg);
    }
    return holds;
}
