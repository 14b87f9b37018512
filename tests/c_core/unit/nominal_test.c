#include "../matrix_forms.h"
#include "unit.h"

static const gw_geometry_config_t geometry = {R(0.1), R(0.01), R(0.25), {0U, 1U, 2U}, R(0.0)};
static const gw_inertia_config_t inertia = {R(30.0), R(1.5), R(0.002), R(0.00001)};
static const gw_friction_config_t friction = {R(0.2), R(0.4)};

static gw_nominal_t made(gw_kinematics_t *kinematics)
{
    gw_nominal_t nominal;
    CHECK_STATUS(gw_kinematics_init(kinematics, &geometry), GW_STATUS_OK);
    CHECK_STATUS(gw_nominal_init(&nominal, &inertia, &friction, kinematics), GW_STATUS_OK);
    CHECK(gw_nominal_invariant_holds(&nominal));
    return nominal;
}

/* (27) by hand: wheels count as 1.5 * 0.002/0.1^2 = 0.3 kg, rollers as 1.5 * 1e-5/0.01^2 = 0.15 kg. */
static void inertias_are_those_of_the_coupled_base(void)
{
    gw_kinematics_t kinematics;
    const gw_nominal_t nominal = made(&kinematics);
    CHECK_NEAR(nominal.total_mass_kg, R(30.45), R(30.0) * ROUNDING);
    CHECK_NEAR(nominal.rolling_mass_kg, R(0.45), ROUNDING);
    CHECK_NEAR(nominal.total_yaw_inertia_kgm2, R(1.5375), R(2.0) * ROUNDING); /* 1.5 + 3 * 0.2 * 0.25^2 */
}

static void bad_arguments_are_refused(void)
{
    gw_kinematics_t kinematics;
    gw_nominal_t nominal = made(&kinematics);
    gw_inertia_config_t heavy = inertia;
    gw_friction_config_t sticky = friction;
    heavy.mass_kg = R(1e6);
    sticky.coulomb_torque_nm = unit_nan();
    CHECK_STATUS(gw_nominal_init(NULL, &inertia, &friction, &kinematics), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_nominal_init(&nominal, NULL, &friction, &kinematics), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_nominal_init(&nominal, &inertia, NULL, &kinematics), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_nominal_init(&nominal, &inertia, &friction, NULL), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_nominal_init(&nominal, &heavy, &friction, &kinematics), GW_STATUS_CONFIG_INVALID);
    CHECK_STATUS(gw_nominal_init(&nominal, &inertia, &sticky, &kinematics), GW_STATUS_CONFIG_INVALID);
}

static void the_invariant_sees_every_member(void)
{
    gw_kinematics_t kinematics;
    gw_nominal_t nominal = made(&kinematics);
    CHECK(!gw_nominal_invariant_holds(NULL));
    nominal.friction.coulomb_torque_nm = -GW_ONE;
    CHECK(!gw_nominal_invariant_holds(&nominal));
    nominal = made(&kinematics);
    nominal.total_mass_kg = unit_nan();
    CHECK(!gw_nominal_invariant_holds(&nominal));
    nominal = made(&kinematics);
    nominal.total_yaw_inertia_kgm2 = unit_infinity();
    CHECK(!gw_nominal_invariant_holds(&nominal));
    nominal = made(&kinematics);
    nominal.rolling_mass_kg = -GW_ONE;
    CHECK(!gw_nominal_invariant_holds(&nominal));
}

/* Pure yaw acceleration: every wheel gives a third of I alpha r_w/R, and no roller turns. */
static void turning_needs_the_same_torque_of_every_wheel(void)
{
    gw_kinematics_t kinematics;
    const gw_nominal_t nominal = made(&kinematics);
    const gw_twist_t still = {GW_ZERO, GW_ZERO, GW_ZERO};
    const gw_acceleration_t turning = {GW_ZERO, GW_ZERO, R(2.0)};
    const gw_wheels_t torques = nominal_torques(&nominal, &kinematics, still, turning);
    for (uint32_t i = 0U; i < 3U; i++) {
        unit_row(i);
        CHECK_NEAR(torques.wheel[i], R(0.41), R(0.5) * ROUNDING); /* 1.5375 * 2 * 0.1/(3 * 0.25) */
    }
}

/* On a circle the torques give the centripetal force, the rollers' friction, and the term c of (26). */
static void going_round_needs_the_force_of_38(void)
{
    gw_kinematics_t kinematics;
    const gw_nominal_t nominal = made(&kinematics);
    const gw_twist_t twist = {R(0.5), R(0.0), R(0.8)};
    const gw_acceleration_t acceleration = {R(0.0), R(0.4), R(0.0)};
    const gw_wheels_t torques = nominal_torques(&nominal, &kinematics, twist, acceleration);
    const gw_wrench_t wrench = gw_kinematics_wrench_of_torques(&kinematics, &torques);
    const gw_wheels_t rates = gw_kinematics_roller_rates(&kinematics, twist);
    const gw_wheels_t roller_torques = gw_friction_torques(&friction, &rates);
    const gw_wrench_t rolling = gw_kinematics_wrench_of_rollers(&kinematics, &roller_torques);
    CHECK_NEAR(wrench.force_x_n, rolling.force_x_n, R(40.0) * ROUNDING);
    CHECK_NEAR(wrench.force_y_n, rolling.force_y_n + R(12.0), R(40.0) * ROUNDING); /* 30.45 * 0.4 - 0.45 * 0.8 * 0.5 */
    CHECK_NEAR(wrench.torque_nm, GW_ZERO, R(10.0) * ROUNDING);
}

void suite_nominal(void)
{
    unit_run("inertias_are_those_of_the_coupled_base", inertias_are_those_of_the_coupled_base);
    unit_run("bad_arguments_are_refused", bad_arguments_are_refused);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
    unit_run("turning_needs_the_same_torque_of_every_wheel", turning_needs_the_same_torque_of_every_wheel);
    unit_run("going_round_needs_the_force_of_38", going_round_needs_the_force_of_38);
}
