/* gw_kinematics, gw_nominal, gw_friction and gw_wrench: they have no state, so their results are bounded by their
 * arguments. */
#include "parts.h"

static gw_kinematics_t kinematics;
static gw_nominal_t nominal;
static gw_geometry_config_t geometry;
static gw_inertia_config_t inertia;
static gw_friction_config_t friction;

/* Motion of a robot within the limits of gw_estimator. */
static void draw_motion(gw_twist_t *twist, gw_acceleration_t *acceleration)
{
    twist->vx_mps = draw_real((gw_real_t)-1.0e9, (gw_real_t)1.0e9);
    twist->vy_mps = draw_real((gw_real_t)-1.0e9, (gw_real_t)1.0e9);
    twist->omega_radps = draw_real((gw_real_t)-1.0e9, (gw_real_t)1.0e9);
    acceleration->ax_mps2 = draw_real((gw_real_t)-1.0e20, (gw_real_t)1.0e20);
    acceleration->ay_mps2 = draw_real((gw_real_t)-1.0e20, (gw_real_t)1.0e20);
    acceleration->alpha_radps2 = draw_real((gw_real_t)-1.0e12, (gw_real_t)1.0e12);
}

static void part_init(void)
{
    static const uint32_t orders[6][GW_WHEEL_COUNT] = {{0U, 1U, 2U}, {0U, 2U, 1U}, {1U, 0U, 2U},
                                                       {1U, 2U, 0U}, {2U, 0U, 1U}, {2U, 1U, 0U}};
    draw_geometry_config(&geometry);
    draw_inertia_config(&inertia);
    draw_friction_config(&friction);
    for (uint32_t order = 0U; order < 6U; order++) {
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            geometry.wheel_slot[i] = orders[order][i];
        }
        demand_count((uint32_t)gw_kinematics_init(&kinematics, &geometry), 0U, 0U);
        hold_kinematics(&kinematics);
        demand_count((uint32_t)gw_nominal_init(&nominal, &inertia, &friction, &kinematics), 0U, 0U);
        hold_nominal(&nominal);
    }
}

static void part_step(void)
{
    gw_twist_t twist;
    gw_acceleration_t acceleration;
    gw_wheels_t torques;
    gw_wheels_t rates;
    gw_wheels_t derivatives;
    gw_wrench_t wrench;
    draw_kinematics(&kinematics);
    draw_nominal(&nominal);
    draw_motion(&twist, &acceleration);
    draw_wheels(&torques, (gw_real_t)1.0e12);
    draw_wheels(&rates, (gw_real_t)1.0e9);
    draw_wheels(&derivatives, (gw_real_t)1.0e10);
    draw_wrench(&wrench, (gw_real_t)1.0e20);
    (void)gw_kinematics_wheel_rates(&kinematics, twist);
    (void)gw_kinematics_twist(&kinematics, &rates);
    (void)gw_kinematics_acceleration(&kinematics, &rates, &derivatives);
    (void)gw_kinematics_wrench_of_torques(&kinematics, &torques);
    (void)gw_kinematics_torques_of_wrench(&kinematics, wrench);
    (void)gw_kinematics_wrench_of_rollers(&kinematics, &torques);
    rates = gw_kinematics_roller_rates(&kinematics, twist);
    torques = gw_friction_torques(&nominal.friction, &rates);
    (void)gw_nominal_torques(&nominal, &kinematics, twist, acceleration, &torques);
    draw_wheels(&torques, (gw_real_t)1.0e12);
    (void)gw_wrench_external(&kinematics, &torques, &torques);
    (void)gw_wrench_noise(&kinematics, draw_setting(GW_FIELD_ESTIMATOR_TORQUE_NOISE));
    (void)gw_kinematics_invariant_holds(&kinematics);
    (void)gw_nominal_invariant_holds(&nominal);
}

static void part_refusals(void)
{
    draw_geometry_config(&geometry);
    draw_inertia_config(&inertia);
    draw_friction_config(&friction);
    geometry.wheel_slot[0] = any_flag() ? 1U : 7U;
    geometry.wheel_slot[1] = 1U;
    inertia.mass_kg = draw_refused(GW_FIELD_BASE_MASS);
    (void)gw_kinematics_init(any_flag() ? &kinematics : NULL, any_flag() ? &geometry : NULL);
    (void)gw_nominal_init(any_flag() ? &nominal : NULL, any_flag() ? &inertia : NULL, any_flag() ? &friction : NULL,
                          any_flag() ? &kinematics : NULL);
    disturb_kinematics(&kinematics);
    disturb_nominal(&nominal);
    (void)gw_kinematics_invariant_holds(any_flag() ? &kinematics : NULL);
    (void)gw_nominal_invariant_holds(any_flag() ? &nominal : NULL);
}
