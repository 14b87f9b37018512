#include "unit.h"

#define UNTOUCHED R(-9.0)
#define NO_SIGMA ((gw_wrench_sigma_t){GW_ZERO, GW_ZERO})

/* A square of 1 m about the centre. */
static const gw_contact_config_t square = {
    4U, {{R(0.5), R(-0.5)}, {R(0.5), R(0.5)}, {R(-0.5), R(0.5)}, {R(-0.5), R(-0.5)}}, R(1.0)};

static gw_contact_t made(void)
{
    gw_contact_t contact;
    CHECK_STATUS(gw_contact_init(&contact, &square), GW_STATUS_OK);
    CHECK(gw_contact_invariant_holds(&contact));
    return contact;
}

static gw_contact_estimate_t located(gw_wrench_t wrench, gw_wrench_sigma_t sigma, gw_status_t status)
{
    const gw_contact_t contact = made();
    gw_contact_estimate_t estimate;
    CHECK_STATUS(gw_contact_locate(&contact, wrench, sigma, &estimate), status);
    return estimate;
}

static void bad_arguments_are_refused(void)
{
    const gw_wrench_t push = {R(5.0), R(0.0), R(0.0)};
    const gw_wrench_sigma_t sigma = {R(0.1), R(0.1)};
    gw_contact_t contact = made();
    gw_contact_estimate_t estimate;
    CHECK_STATUS(gw_contact_init(NULL, &square), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_contact_init(&contact, NULL), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_contact_locate(&contact, push, sigma, NULL), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_contact_locate(NULL, push, sigma, &estimate), GW_STATUS_NULL_POINTER);
    contact.initialised = false;
    CHECK_STATUS(gw_contact_locate(&contact, push, sigma, &estimate), GW_STATUS_NOT_INITIALISED);
    CHECK(!estimate.valid);
}

static void the_outline_has_to_be_convex_and_counter_clockwise(void)
{
    const gw_contact_config_t rows[] = {
        {3U, {{R(0.0), R(0.0)}, {R(0.0), R(1.0)}, {R(1.0), R(0.0)}}, R(1.0)}, /* clockwise */
        {3U, {{R(0.0), R(0.0)}, {R(1.0), R(0.0)}, {R(2.0), R(0.0)}}, R(1.0)}, /* on a line */
        {4U, {{R(0.0), R(0.0)}, {R(1.0), R(0.0)}, {R(0.2), R(0.2)}, {R(0.0), R(1.0)}}, R(1.0)},
        {4U, {{R(0.0), R(1.0)}, {R(0.0), R(0.0)}, {R(1.0), R(0.0)}, {R(0.2), R(0.2)}}, R(1.0)},
        /* a star: every corner turns left */
        {5U,
         {{R(1.0), R(0.0)}, {R(-0.81), R(0.59)}, {R(0.31), R(-0.95)}, {R(0.31), R(0.95)}, {R(-0.81), R(-0.59)}},
         R(1.0)},
    };
    const uint32_t edges[] = {0U, 0U, 1U, 2U, 0U}; /* the first that has a corner on its right or on it */
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        gw_contact_t contact;
        gw_config_error_t error;
        unit_row(i);
        gw_config_check_begin(&error);
        error.index = 99U;
        error.value = UNTOUCHED;
        gw_contact_config_check(&rows[i], &error);
        CHECK(error.field == GW_FIELD_OUTLINE_CONVEX);
        CHECK((error.index == edges[i]) && (error.value <= GW_ZERO) && (error.value != UNTOUCHED));
        CHECK_STATUS(gw_contact_init(&contact, &rows[i]), GW_STATUS_CONFIG_INVALID);
        CHECK(!gw_contact_invariant_holds(&contact));
    }
}

/* The line p x F = M enters the square where the force points into it. */
static void a_push_is_found_where_it_enters_the_body(void)
{
    const struct {
        gw_wrench_t wrench;
        gw_vector_t point;
        gw_real_t direction;
    } rows[] = {
        {{R(10.0), R(0.0), R(0.0)}, {R(-0.5), R(0.0)}, R(0.0)},
        {{R(-10.0), R(0.0), R(2.0)}, {R(0.5), R(0.2)}, GW_PI},
        {{R(0.0), R(10.0), R(3.0)}, {R(0.3), R(-0.5)}, R(1.57079632679489662)},
        {{R(0.0), R(-10.0), R(3.0)}, {R(-0.3), R(0.5)}, R(-1.57079632679489662)},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        const gw_contact_estimate_t found = located(rows[i].wrench, NO_SIGMA, GW_STATUS_OK);
        unit_row(i);
        CHECK(found.valid && found.on_outline);
        CHECK_NEAR(found.point_m.x, rows[i].point.x, ROUNDING);
        CHECK_NEAR(found.point_m.y, rows[i].point.y, ROUNDING);
        CHECK_NEAR(found.direction_rad, rows[i].direction, R(4.0) * ROUNDING);
        CHECK(found.force_n == R(10.0));
    }
}

/* Past the square: the nearest corner; of two on an edge along the line, the one that the force meets first. */
static void a_line_past_the_outline_gives_the_nearest_corner(void)
{
    const struct {
        gw_wrench_t wrench;
        gw_vector_t corner;
    } rows[] = {
        {{R(10.0), R(0.0), R(-6.0)}, {R(-0.5), R(0.5)}},  {{R(-10.0), R(0.0), R(6.0)}, {R(0.5), R(0.5)}},
        {{R(10.0), R(0.0), R(6.0)}, {R(-0.5), R(-0.5)}},  {{R(-10.0), R(0.0), R(-6.0)}, {R(0.5), R(-0.5)}},
        {{R(0.0), R(10.0), R(6.0)}, {R(0.5), R(-0.5)}},   {{R(0.0), R(-10.0), R(-6.0)}, {R(0.5), R(0.5)}},
        {{R(0.0), R(10.0), R(-6.0)}, {R(-0.5), R(-0.5)}}, {{R(0.0), R(-10.0), R(6.0)}, {R(-0.5), R(0.5)}},
        {{R(10.0), R(10.0), R(20.0)}, {R(0.5), R(-0.5)}}, {{R(10.0), R(10.0), R(-20.0)}, {R(-0.5), R(0.5)}},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        const gw_contact_estimate_t found = located(rows[i].wrench, NO_SIGMA, GW_STATUS_OK);
        unit_row(i);
        CHECK(found.valid && (!found.on_outline));
        CHECK((found.point_m.x == rows[i].corner.x) && (found.point_m.y == rows[i].corner.y));
    }
}

/* A line through two corners of a diamond enters at one. One that only touches a corner enters if it has the body on
 * its right; either way the corner is the point. */
static void a_line_through_corners_enters_or_touches(void)
{
    const gw_contact_config_t diamond = {
        4U, {{R(0.5), R(0.0)}, {R(0.0), R(0.5)}, {R(-0.5), R(0.0)}, {R(0.0), R(-0.5)}}, R(1.0)};
    const struct {
        gw_wrench_t wrench;
        gw_vector_t corner;
        bool enters;
    } rows[] = {
        {{R(10.0), R(0.0), R(0.0)}, {R(-0.5), R(0.0)}, true},  {{R(-10.0), R(0.0), R(0.0)}, {R(0.5), R(0.0)}, true},
        {{R(0.0), R(10.0), R(0.0)}, {R(0.0), R(-0.5)}, true},  {{R(0.0), R(-10.0), R(0.0)}, {R(0.0), R(0.5)}, true},
        {{R(10.0), R(0.0), R(-5.0)}, {R(0.0), R(0.5)}, true},  {{R(-10.0), R(0.0), R(5.0)}, {R(0.0), R(0.5)}, false},
        {{R(10.0), R(0.0), R(5.0)}, {R(0.0), R(-0.5)}, false}, {{R(-10.0), R(0.0), R(-5.0)}, {R(0.0), R(-0.5)}, true},
    };
    gw_contact_t contact;
    CHECK_STATUS(gw_contact_init(&contact, &diamond), GW_STATUS_OK);
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        gw_contact_estimate_t found;
        unit_row(i);
        CHECK_STATUS(gw_contact_locate(&contact, rows[i].wrench, NO_SIGMA, &found), GW_STATUS_OK);
        CHECK(found.on_outline == rows[i].enters);
        CHECK((found.point_m.x == rows[i].corner.x) && (found.point_m.y == rows[i].corner.y));
    }
}

/* If an edge lies on the line, the result is the end that the force meets first, also if both ends are on one side of
 * the centre. */
static void the_end_that_is_met_first_does_not_depend_on_the_centre(void)
{
    const gw_contact_config_t ahead = {
        4U, {{R(2.0), R(-0.5)}, {R(2.0), R(0.5)}, {R(1.0), R(0.5)}, {R(1.0), R(-0.5)}}, R(1.0)};
    const gw_wrench_t rows[] = {{R(10.0), R(0.0), R(-6.0)}, {R(-10.0), R(0.0), R(6.0)}};
    const gw_vector_t corners[] = {{R(1.0), R(0.5)}, {R(2.0), R(0.5)}};
    gw_contact_t contact;
    CHECK_STATUS(gw_contact_init(&contact, &ahead), GW_STATUS_OK);
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        gw_contact_estimate_t found;
        unit_row(i);
        CHECK_STATUS(gw_contact_locate(&contact, rows[i], NO_SIGMA, &found), GW_STATUS_OK);
        CHECK((found.point_m.x == corners[i].x) && (found.point_m.y == corners[i].y));
    }
}

/* The line runs through the first corner only, and all others are on its right. A corner on the line counts as left, so
 * the edge behind this corner is entered. */
static void a_line_through_the_first_corner_alone_enters_there(void)
{
    const gw_contact_config_t triangle = {3U, {{R(0.0), R(0.0)}, {R(1.0), R(-0.5)}, {R(1.0), R(0.5)}}, R(1.0)};
    const gw_wrench_t push = {R(0.0), R(10.0), R(0.0)};
    gw_contact_t contact;
    gw_contact_estimate_t estimate;
    CHECK_STATUS(gw_contact_init(&contact, &triangle), GW_STATUS_OK);
    CHECK_STATUS(gw_contact_locate(&contact, push, NO_SIGMA, &estimate), GW_STATUS_OK);
    CHECK(estimate.on_outline && (estimate.point_m.x == R(0.0)) && (estimate.point_m.y == R(0.0)));
}

static void the_lever_arm_comes_with_its_deviation(void)
{
    const gw_wrench_t push = {R(0.0), R(10.0), R(3.0)};
    const gw_wrench_sigma_t sigma = {R(1.0), R(0.4)};
    const gw_contact_estimate_t found = located(push, sigma, GW_STATUS_OK);
    CHECK_NEAR(found.lever_arm_m, R(0.3), ROUNDING);
    CHECK_NEAR(found.lever_arm_sigma_m, R(0.05), ROUNDING); /* (0.4, 0.3 * 1)/10 */
}

static void a_weak_push_is_not_located(void)
{
    const gw_wrench_t weak = {unit_below(R(1.0)), R(0.0), R(0.0)};
    const gw_wrench_t enough = {R(1.0), R(0.0), R(0.0)};
    CHECK(!located(weak, NO_SIGMA, GW_STATUS_OK).valid);
    CHECK(located(enough, NO_SIGMA, GW_STATUS_OK).valid);
}

static void what_is_not_finite_is_refused(void)
{
    const gw_wrench_t push = {R(10.0), R(0.0), R(0.0)};
    const gw_wrench_t bad = {unit_nan(), R(0.0), R(0.0)};
    const gw_wrench_sigma_t force = {R(-1.0), R(0.0)};
    const gw_wrench_sigma_t torque = {R(0.0), unit_nan()};
    const gw_wrench_sigma_t far_force = {unit_nan(), R(0.0)};
    const gw_wrench_sigma_t negative_torque = {R(0.0), R(-1.0)};
    CHECK(!located(bad, NO_SIGMA, GW_STATUS_INPUT_INVALID).valid);
    CHECK(!located(push, force, GW_STATUS_INPUT_INVALID).valid);
    CHECK(!located(push, torque, GW_STATUS_INPUT_INVALID).valid);
    CHECK(!located(push, far_force, GW_STATUS_INPUT_INVALID).valid);
    CHECK(!located(push, negative_torque, GW_STATUS_INPUT_INVALID).valid);
}

static void the_invariant_sees_every_member(void)
{
    gw_contact_t contact = made();
    CHECK(!gw_contact_invariant_holds(NULL));
    contact.initialised = false;
    CHECK(!gw_contact_invariant_holds(&contact));
    contact = made();
    contact.config.vertex_m[3].x = unit_nan();
    CHECK(!gw_contact_invariant_holds(&contact));
}

void suite_contact(void)
{
    unit_run("bad_arguments_are_refused", bad_arguments_are_refused);
    unit_run("the_outline_has_to_be_convex_and_counter_clockwise", the_outline_has_to_be_convex_and_counter_clockwise);
    unit_run("a_push_is_found_where_it_enters_the_body", a_push_is_found_where_it_enters_the_body);
    unit_run("a_line_past_the_outline_gives_the_nearest_corner", a_line_past_the_outline_gives_the_nearest_corner);
    unit_run("a_line_through_corners_enters_or_touches", a_line_through_corners_enters_or_touches);
    unit_run("the_end_that_is_met_first_does_not_depend_on_the_centre",
             the_end_that_is_met_first_does_not_depend_on_the_centre);
    unit_run("a_line_through_the_first_corner_alone_enters_there", a_line_through_the_first_corner_alone_enters_there);
    unit_run("the_lever_arm_comes_with_its_deviation", the_lever_arm_comes_with_its_deviation);
    unit_run("a_weak_push_is_not_located", a_weak_push_is_not_located);
    unit_run("what_is_not_finite_is_refused", what_is_not_finite_is_refused);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
}
