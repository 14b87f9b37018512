#include "../matrix_forms.h"
#include "unit.h"

/* Wheels of 0.1 m, 0.25 m from the centre, in the given order. */
static gw_geometry_config_t geometry(uint32_t a, uint32_t b, uint32_t c)
{
    const gw_geometry_config_t config = {R(0.1), R(0.01), R(0.25), {a, b, c}, R(0.3)};
    return config;
}

static gw_kinematics_t made(void)
{
    const gw_geometry_config_t config = geometry(0U, 1U, 2U);
    gw_kinematics_t kinematics;
    CHECK_STATUS(gw_kinematics_init(&kinematics, &config), GW_STATUS_OK);
    CHECK(gw_kinematics_invariant_holds(&kinematics));
    return kinematics;
}

static void every_order_of_wheels_is_accepted(void)
{
    const uint32_t orders[6][3] = {{0U, 1U, 2U}, {0U, 2U, 1U}, {1U, 0U, 2U}, {1U, 2U, 0U}, {2U, 0U, 1U}, {2U, 1U, 0U}};
    for (uint32_t i = 0U; i < 6U; i++) {
        const gw_geometry_config_t config = geometry(orders[i][0], orders[i][1], orders[i][2]);
        gw_kinematics_t kinematics;
        unit_row(i);
        CHECK_STATUS(gw_kinematics_init(&kinematics, &config), GW_STATUS_OK);
        CHECK(gw_kinematics_invariant_holds(&kinematics));
    }
}

static void a_slot_is_taken_once(void)
{
    const uint32_t orders[][3] = {{0U, 0U, 1U}, {1U, 2U, 2U}, {2U, 1U, 2U}};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(orders); i++) {
        const gw_geometry_config_t config = geometry(orders[i][0], orders[i][1], orders[i][2]);
        gw_config_error_t error;
        unit_row(i);
        gw_config_check_begin(&error);
        gw_geometry_config_check(&config, &error);
        CHECK(error.field == GW_FIELD_GEOMETRY_WHEEL_SLOT);
        CHECK((error.minimum == GW_ONE) && (error.maximum == GW_ZERO)); /* no value repairs it alone */
        CHECK((error.index == 2U) && (error.value == (gw_real_t)orders[i][2]));
    }
}

static void bad_arguments_are_refused(void)
{
    const gw_geometry_config_t good = geometry(0U, 1U, 2U);
    const gw_geometry_config_t bad = geometry(0U, 1U, 3U);
    gw_kinematics_t kinematics;
    CHECK_STATUS(gw_kinematics_init(NULL, &good), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_kinematics_init(&kinematics, NULL), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_kinematics_init(&kinematics, &bad), GW_STATUS_CONFIG_INVALID);
}

static void the_invariant_sees_every_member(void)
{
    const gw_real_t bad[] = {GW_ZERO, -GW_ONE, unit_nan()};
    CHECK(!gw_kinematics_invariant_holds(NULL));
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(bad); i++) {
        gw_kinematics_t kinematics = made();
        unit_row(i);
        kinematics.wheel_radius_m = bad[i];
        CHECK(!gw_kinematics_invariant_holds(&kinematics));
        kinematics = made();
        kinematics.roller_radius_m = bad[i];
        CHECK(!gw_kinematics_invariant_holds(&kinematics));
        kinematics = made();
        kinematics.wheel_distance_m = bad[i];
        CHECK(!gw_kinematics_invariant_holds(&kinematics));
        kinematics = made();
        kinematics.radial[2].x = bad[i] * R(3.0);
        CHECK(!gw_kinematics_invariant_holds(&kinematics));
    }
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        const struct {
            gw_real_t length;
            bool holds;
        } rows[] = {{R(0.98), false}, {R(0.995), true}, {R(1.005), true}, {R(1.015), false}};
        for (uint32_t k = 0U; k < UNIT_COUNT_OF(rows); k++) {
            gw_kinematics_t scaled = made();
            scaled.radial[i].x *= rows[k].length;
            scaled.radial[i].y *= rows[k].length;
            unit_row((10U * i) + k);
            CHECK(gw_kinematics_invariant_holds(&scaled) == rows[k].holds);
        }
    }
    gw_kinematics_t kinematics = made();
    kinematics.wheel_distance_m = unit_infinity();
    CHECK(!gw_kinematics_invariant_holds(&kinematics));
    kinematics = made();
    kinematics.per_wheel_radius = unit_infinity();
    CHECK(!gw_kinematics_invariant_holds(&kinematics));
    kinematics = made();
    kinematics.per_roller_radius = unit_infinity();
    CHECK(!gw_kinematics_invariant_holds(&kinematics));
}

/* (15) by hand: wheel 0 has n = (cos 0.3, sin 0.3), so its row is (-sin, cos, R)/r_w. */
static void the_wheel_jacobian_is_that_of_15(void)
{
    const gw_kinematics_t kinematics = made();
    const matrix_t jacobian = wheel_jacobian(&kinematics, GW_ZERO);
    CHECK_NEAR(jacobian.m[0][0], R(-2.95520206661339575), R(10.0) * ROUNDING);
    CHECK_NEAR(jacobian.m[0][1], R(9.55336489125606020), R(10.0) * ROUNDING);
    for (uint32_t i = 0U; i < 3U; i++) {
        CHECK_NEAR(jacobian.m[i][2], R(2.5), R(2.5) * ROUNDING);
    }
}

static void the_inverse_is_the_inverse(void)
{
    const gw_kinematics_t kinematics = made();
    const matrix_t jacobian = wheel_jacobian(&kinematics, R(1.1));
    const matrix_t inverse = wheel_jacobian_inverse(&kinematics, R(1.1));
    for (uint32_t row = 0U; row < 3U; row++) {
        for (uint32_t column = 0U; column < 3U; column++) {
            gw_real_t sum = GW_ZERO;
            for (uint32_t k = 0U; k < 3U; k++) {
                sum += jacobian.m[row][k] * inverse.m[k][column];
            }
            CHECK_NEAR(sum, (row == column) ? GW_ONE : GW_ZERO, ROUNDING);
        }
    }
}

/* (19): J_w and J_r over the rates of wheels and rollers, which -1 takes away again. */
static void the_constraint_matrix_is_that_of_19(void)
{
    const gw_kinematics_t kinematics = made();
    const matrix_t wheel = wheel_jacobian(&kinematics, R(0.7));
    const matrix_t roller = roller_jacobian(&kinematics, R(0.7));
    const constraint_matrix_t constraint = constraint_jacobian(&kinematics, R(0.7));
    for (uint32_t row = 0U; row < 6U; row++) {
        for (uint32_t column = 0U; column < 9U; column++) {
            gw_real_t expected = ((column - 3U) == row) ? -GW_ONE : GW_ZERO;
            if (column < 3U) {
                expected = (row < 3U) ? wheel.m[row][column] : roller.m[row - 3U][column];
            }
            unit_row((10U * row) + column);
            CHECK(constraint.m[row][column] == expected);
        }
    }
}

static void rates_follow_from_the_twist_and_give_it_back(void)
{
    const gw_kinematics_t kinematics = made();
    const gw_twist_t twist = {R(0.3), R(-0.2), R(0.5)};
    const matrix_t wheel = wheel_jacobian(&kinematics, GW_ZERO);
    const matrix_t roller = roller_jacobian(&kinematics, GW_ZERO);
    const gw_wheels_t rates = gw_kinematics_wheel_rates(&kinematics, twist);
    const gw_wheels_t rollers = gw_kinematics_roller_rates(&kinematics, twist);
    const gw_twist_t back = gw_kinematics_twist(&kinematics, &rates);
    for (uint32_t i = 0U; i < 3U; i++) {
        const gw_real_t expected_wheel =
            (wheel.m[i][0] * twist.vx_mps) + (wheel.m[i][1] * twist.vy_mps) + (wheel.m[i][2] * twist.omega_radps);
        const gw_real_t expected_roller = (roller.m[i][0] * twist.vx_mps) + (roller.m[i][1] * twist.vy_mps);
        unit_row(i);
        CHECK_NEAR(rates.wheel[i], expected_wheel, R(5.0) * ROUNDING);
        CHECK_NEAR(rollers.wheel[i], expected_roller, R(50.0) * ROUNDING);
    }
    CHECK_NEAR(back.vx_mps, twist.vx_mps, ROUNDING);
    CHECK_NEAR(back.vy_mps, twist.vy_mps, ROUNDING);
    CHECK_NEAR(back.omega_radps, twist.omega_radps, ROUNDING);
}

/* A turning base on a circle at constant speed: no wheel accelerates, the centre does, by v omega. */
static void accelerations_include_the_turning_of_the_axes(void)
{
    const gw_kinematics_t kinematics = made();
    const gw_twist_t twist = {R(0.4), R(0.0), R(0.5)};
    const gw_acceleration_t towards_the_centre = {R(0.0), R(0.2), R(0.0)};
    const gw_wheels_t rates = gw_kinematics_wheel_rates(&kinematics, twist);
    const gw_wheels_t steady = {{GW_ZERO, GW_ZERO, GW_ZERO}};
    const gw_acceleration_t acceleration = gw_kinematics_acceleration(&kinematics, &rates, &steady);
    const gw_wheels_t wheels = wheel_accelerations(&kinematics, twist, towards_the_centre);
    const gw_wheels_t rollers = roller_accelerations(&kinematics, twist, towards_the_centre);
    CHECK_NEAR(acceleration.ax_mps2, GW_ZERO, ROUNDING);
    CHECK_NEAR(acceleration.ay_mps2, R(0.2), ROUNDING);
    CHECK_NEAR(acceleration.alpha_radps2, GW_ZERO, ROUNDING);
    for (uint32_t i = 0U; i < 3U; i++) {
        unit_row(i);
        CHECK_NEAR(wheels.wheel[i], GW_ZERO, R(5.0) * ROUNDING);
        CHECK_NEAR(rollers.wheel[i], GW_ZERO, R(50.0) * ROUNDING);
    }
}

/* Power: the wrench of the torques on any twist is the torques on the wheels' rates. */
static void torques_and_wrench_do_the_same_work(void)
{
    const gw_kinematics_t kinematics = made();
    const gw_wheels_t torques = {{R(1.0), R(-2.0), R(0.5)}};
    const gw_twist_t twist = {R(0.3), R(-0.2), R(0.5)};
    const gw_wheels_t rates = gw_kinematics_wheel_rates(&kinematics, twist);
    const gw_wheels_t roller_rates = gw_kinematics_roller_rates(&kinematics, twist);
    const gw_wrench_t of_wheels = gw_kinematics_wrench_of_torques(&kinematics, &torques);
    const gw_wrench_t of_rollers = gw_kinematics_wrench_of_rollers(&kinematics, &torques);
    const gw_wheels_t back = gw_kinematics_torques_of_wrench(&kinematics, of_wheels);
    gw_real_t wheel_power = GW_ZERO;
    gw_real_t roller_power = GW_ZERO;
    for (uint32_t i = 0U; i < 3U; i++) {
        unit_row(i);
        CHECK_NEAR(back.wheel[i], torques.wheel[i], R(2.0) * ROUNDING);
        wheel_power += torques.wheel[i] * rates.wheel[i];
        roller_power += torques.wheel[i] * roller_rates.wheel[i];
    }
    CHECK_NEAR((of_wheels.force_x_n * twist.vx_mps) + (of_wheels.force_y_n * twist.vy_mps) +
                   (of_wheels.torque_nm * twist.omega_radps),
               wheel_power, R(10.0) * ROUNDING);
    CHECK_NEAR((of_rollers.force_x_n * twist.vx_mps) + (of_rollers.force_y_n * twist.vy_mps), roller_power,
               R(100.0) * ROUNDING);
    CHECK(of_rollers.torque_nm == GW_ZERO);
}

static void a_wrench_at_a_point_turns_about_the_centre(void)
{
    const gw_vector_t point = {R(0.5), R(-0.25)};
    const gw_wrench_t push = {R(4.0), R(8.0), R(1.0)};
    const gw_wrench_t at_centre = wrench_at_centre(point, push);
    const matrix_t jacobian = external_jacobian(point);
    CHECK((at_centre.force_x_n == R(4.0)) && (at_centre.force_y_n == R(8.0)) && (at_centre.torque_nm == R(6.0)));
    /* J_ext^T F, (34) */
    CHECK(((jacobian.m[0][2] * push.force_x_n) + (jacobian.m[1][2] * push.force_y_n) +
           (jacobian.m[2][2] * push.torque_nm)) == R(6.0));
    CHECK((jacobian.m[0][0] == GW_ONE) && (jacobian.m[1][1] == GW_ONE) && (jacobian.m[0][1] == GW_ZERO));
}

void suite_kinematics(void)
{
    unit_run("every_order_of_wheels_is_accepted", every_order_of_wheels_is_accepted);
    unit_run("a_slot_is_taken_once", a_slot_is_taken_once);
    unit_run("bad_arguments_are_refused", bad_arguments_are_refused);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
    unit_run("the_wheel_jacobian_is_that_of_15", the_wheel_jacobian_is_that_of_15);
    unit_run("the_inverse_is_the_inverse", the_inverse_is_the_inverse);
    unit_run("the_constraint_matrix_is_that_of_19", the_constraint_matrix_is_that_of_19);
    unit_run("rates_follow_from_the_twist_and_give_it_back", rates_follow_from_the_twist_and_give_it_back);
    unit_run("accelerations_include_the_turning_of_the_axes", accelerations_include_the_turning_of_the_axes);
    unit_run("torques_and_wrench_do_the_same_work", torques_and_wrench_do_the_same_work);
    unit_run("a_wrench_at_a_point_turns_about_the_centre", a_wrench_at_a_point_turns_about_the_centre);
}
