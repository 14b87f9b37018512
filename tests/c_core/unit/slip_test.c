#include "unit.h"

#include "giveway/gw_slip.h"

static gw_slip_t slip;
static gw_kinematics_t kinematics;

/* 0.5 * 36 kg * 9.80665/3 = 58.8399 N of grip: 35.30394 N are near it, and (2 * 0.3 * 58.8399)^2 are doubted. */
#define NEAR_N R(35.30394)
#define DOUBT_N2 R(1246.3681795236)
#define KEEP R(0.9)

static void begin(void)
{
    gw_geometry_config_t geometry;
    gw_geometry_config_trikey(&geometry);
    CHECK_STATUS(gw_kinematics_init(&kinematics, &geometry), GW_STATUS_OK);
    gw_slip_init(&slip, R(0.5), R(36.0), GW_TWO, KEEP);
    CHECK(gw_slip_invariant_holds(&slip));
}

/* Each wheel transmits this, N. */
static void step(gw_real_t first_n, gw_real_t second_n, gw_real_t third_n, bool interesting)
{
    const gw_real_t radius = GW_ONE / kinematics.per_wheel_radius;
    const gw_wheels_t torque_nm = {{first_n * radius, second_n * radius, third_n * radius}};
    gw_slip_step(&slip, &kinematics, &torque_nm, interesting);
    CHECK(gw_slip_invariant_holds(&slip));
}

static void a_wheel_near_its_grip_may_slip(void)
{
    begin();
    CHECK_NEAR(slip.near_n, NEAR_N, R(100.0) * ROUNDING);
    CHECK_NEAR(slip.doubt_n2, DOUBT_N2, R(3000.0) * ROUNDING);
    step(R(35.2), R(35.4), R(-35.4), true);
    CHECK((slip.wheel_n2.wheel[0] == GW_ZERO) && (slip.wheel_n2.wheel[1] == slip.doubt_n2) &&
          (slip.wheel_n2.wheel[2] == slip.doubt_n2));
    CHECK_NEAR(gw_slip_sum(&slip), GW_TWO * DOUBT_N2, R(6000.0) * ROUNDING);
    step(R(40.0), R(0.0), R(-36.0), false); /* it fades */
    CHECK((slip.wheel_n2.wheel[0] == GW_ZERO) && (slip.wheel_n2.wheel[1] == (KEEP * slip.doubt_n2)) &&
          (slip.wheel_n2.wheel[2] == (KEEP * slip.doubt_n2)));
    step(R(0.0), R(0.0), R(36.0), true);
    CHECK(slip.wheel_n2.wheel[1] == (KEEP * (KEEP * slip.doubt_n2)));
    CHECK(slip.wheel_n2.wheel[2] == slip.doubt_n2);
    gw_slip_restart(&slip);
    CHECK(gw_slip_sum(&slip) == GW_ZERO);
}

/* The first wheel of Trikey is in front and rolls to the left; what a wheel adds is along its rolling direction. */
static void the_doubt_lies_where_the_wheel_rolls(void)
{
    const gw_planar_covariance_t before = {R(1.0), R(2.0), R(5.0)};
    begin();
    step(R(50.0), R(0.0), R(0.0), true);
    const gw_planar_covariance_t first = gw_slip_added(&slip, &kinematics, before);
    CHECK_NEAR(first.xx, R(1.0), R(2000.0) * ROUNDING);
    CHECK_NEAR(first.xy, R(2.0), R(2000.0) * ROUNDING);
    CHECK_NEAR(first.yy, R(5.0) + DOUBT_N2, R(3000.0) * ROUNDING);
    for (uint32_t i = 1U; i < GW_WHEEL_COUNT; i++) {
        gw_slip_restart(&slip);
        slip.wheel_n2.wheel[i] = R(100.0);
        const gw_planar_covariance_t sum = gw_slip_added(&slip, &kinematics, before);
        const gw_real_t xy = (i == 1U) ? R(43.30127018922193) : R(-43.30127018922193); /* -100 cos 120 sin 120 deg */
        unit_row(i);
        CHECK_NEAR(sum.xx, R(76.0), R(300.0) * ROUNDING);
        CHECK_NEAR(sum.xy, R(2.0) + xy, R(300.0) * ROUNDING);
        CHECK_NEAR(sum.yy, R(30.0), R(300.0) * ROUNDING);
    }
}

static void without_grip_nothing_is_doubted(void)
{
    begin();
    gw_slip_init(&slip, GW_ZERO, R(36.0), GW_TWO, KEEP);
    step(R(1.0e5), R(-1.0e5), R(0.0), true);
    CHECK(gw_slip_sum(&slip) == GW_ZERO);
}

static void the_heaviest_robot_has_a_finite_doubt(void)
{
    begin();
    gw_slip_init(&slip, R(10.0), R(1.0e9), R(100.0), GW_ONE); /* its wheels' inertia counts, too */
    CHECK(gw_slip_invariant_holds(&slip));
    CHECK_NEAR(slip.near_n, R(6.0e4), R(1.0e5) * ROUNDING);
    step(R(1.0e7), R(1.0e7), R(-1.0e7), true);
    CHECK(slip.wheel_n2.wheel[0] == slip.doubt_n2);
    CHECK(gw_in_range(slip.doubt_n2, R(1.0e11), R(1.0e12)));
}

static void the_invariant_sees_every_member(void)
{
    begin();
    const gw_slip_t good = slip;
    gw_real_t *const members[] = {
        &slip.near_n,           &slip.doubt_n2, &slip.keep, &slip.wheel_n2.wheel[0], &slip.wheel_n2.wheel[1],
        &slip.wheel_n2.wheel[2]};
    CHECK(!gw_slip_invariant_holds(NULL));
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(members); i++) {
        unit_row(i);
        *members[i] = unit_nan();
        CHECK(!gw_slip_invariant_holds(&slip));
        *members[i] = R(-1.0);
        CHECK(!gw_slip_invariant_holds(&slip));
        *members[i] = R(2.0e12);
        CHECK(!gw_slip_invariant_holds(&slip));
        slip = good;
    }
}

void suite_slip(void)
{
    unit_run("a_wheel_near_its_grip_may_slip", a_wheel_near_its_grip_may_slip);
    unit_run("the_doubt_lies_where_the_wheel_rolls", the_doubt_lies_where_the_wheel_rolls);
    unit_run("without_grip_nothing_is_doubted", without_grip_nothing_is_doubted);
    unit_run("the_heaviest_robot_has_a_finite_doubt", the_heaviest_robot_has_a_finite_doubt);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
}
