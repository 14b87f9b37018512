#include "random_robot.h"

#include <stdlib.h>

gw_geometry_config_t random_geometry(generator_t *generator)
{
    static const uint32_t orders[6][GW_WHEEL_COUNT] = {{0U, 1U, 2U}, {0U, 2U, 1U}, {1U, 0U, 2U},
                                                       {1U, 2U, 0U}, {2U, 0U, 1U}, {2U, 1U, 0U}};
    const uint32_t *const order = orders[generator_below(generator, 6U)];
    gw_geometry_config_t geometry;
    geometry.wheel_radius_m = generator_between(generator, (gw_real_t)0.02, (gw_real_t)0.3);
    geometry.roller_radius_m = generator_between(generator, (gw_real_t)0.003, (gw_real_t)0.05);
    geometry.wheel_distance_m = generator_between(generator, (gw_real_t)0.05, (gw_real_t)1.0);
    geometry.azimuth_rad = generator_between(generator, (gw_real_t)-3.0, (gw_real_t)3.0);
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        geometry.wheel_slot[i] = order[i];
    }
    return geometry;
}

gw_kinematics_t random_kinematics(generator_t *generator)
{
    const gw_geometry_config_t geometry = random_geometry(generator);
    gw_kinematics_t kinematics;
    if (gw_kinematics_init(&kinematics, &geometry) != GW_STATUS_OK) {
        abort(); /* without a robot there are no golden values */
    }
    return kinematics;
}

gw_nominal_t random_nominal(generator_t *generator, const gw_kinematics_t *kinematics)
{
    gw_inertia_config_t inertia;
    gw_friction_config_t friction;
    gw_nominal_t nominal;
    inertia.mass_kg = generator_between(generator, (gw_real_t)1.0, (gw_real_t)100.0);
    inertia.yaw_inertia_kgm2 = generator_between(generator, (gw_real_t)0.1, (gw_real_t)10.0);
    inertia.wheel_inertia_kgm2 = generator_between(generator, (gw_real_t)0.0, (gw_real_t)0.1);
    inertia.roller_inertia_kgm2 = generator_between(generator, (gw_real_t)0.0, (gw_real_t)0.001);
    friction.coulomb_torque_nm = generator_between(generator, (gw_real_t)0.0, (gw_real_t)1.0);
    friction.tanh_slope_s_per_rad = generator_between(generator, (gw_real_t)0.0, (gw_real_t)2.0);
    if (gw_nominal_init(&nominal, &inertia, &friction, kinematics) != GW_STATUS_OK) {
        abort();
    }
    return nominal;
}
