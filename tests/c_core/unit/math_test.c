#include "unit.h"

static void finite_means_neither_nan_nor_infinite(void)
{
    const struct {
        gw_real_t x;
        bool finite;
    } rows[] = {
        {R(0.0), true},           {R(-1.5), true},           {GW_REAL_MAX, true}, {-GW_REAL_MAX, true},
        {unit_infinity(), false}, {-unit_infinity(), false}, {unit_nan(), false},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        unit_row(i);
        CHECK(gw_is_finite(rows[i].x) == rows[i].finite);
    }
    CHECK(unit_above(GW_REAL_MAX) == unit_infinity()); /* the largest: nothing is between */
}

static void a_range_holds_its_ends_and_not_their_neighbours(void)
{
    const gw_real_t low = R(-2.0);
    const gw_real_t high = R(3.0);
    const struct {
        gw_real_t x;
        bool inside;
    } rows[] = {
        {low, true},
        {high, true},
        {unit_above(low), true},
        {unit_below(high), true},
        {unit_below(low), false},
        {unit_above(high), false},
        {unit_nan(), false},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        unit_row(i);
        CHECK(gw_in_range(rows[i].x, low, high) == rows[i].inside);
    }
}

static void comparisons_choose_as_documented(void)
{
    const gw_real_t nan = unit_nan();
    CHECK(gw_abs(R(-2.0)) == R(2.0));
    CHECK(gw_abs(R(2.0)) == R(2.0));
    CHECK(!gw_is_finite(gw_abs(nan)));
    CHECK(gw_min(R(1.0), R(2.0)) == R(1.0));
    CHECK(gw_min(R(2.0), R(1.0)) == R(1.0));
    CHECK(gw_min(nan, R(1.0)) == R(1.0));
    CHECK(gw_max(R(1.0), R(2.0)) == R(2.0));
    CHECK(gw_max(R(2.0), R(1.0)) == R(2.0));
    CHECK(gw_max(nan, R(1.0)) == R(1.0));
    CHECK(gw_clamp(R(-5.0), R(-1.0), R(1.0)) == R(-1.0));
    CHECK(gw_clamp(R(5.0), R(-1.0), R(1.0)) == R(1.0));
    CHECK(gw_clamp(R(0.5), R(-1.0), R(1.0)) == R(0.5));
    CHECK(gw_clamp(nan, R(-1.0), R(1.0)) == R(-1.0));
}

static void a_fraction_is_at_most_one(void)
{
    const struct {
        gw_real_t part;
        gw_real_t whole;
        gw_real_t fraction;
    } rows[] = {
        {R(1.0), R(4.0), R(0.25)},           {R(-3.0), R(4.0), R(-0.75)},  {R(4.0), R(4.0), R(1.0)},
        {R(-4.0), R(4.0), R(-1.0)},          {R(5.0), R(4.0), R(1.0)},     {unit_infinity(), R(4.0), R(1.0)},
        {-unit_infinity(), R(4.0), R(-1.0)}, {unit_nan(), R(4.0), R(0.0)}, {R(1.0), R(0.0), R(0.0)},
        {R(1.0), R(-4.0), R(0.0)},           {R(1.0), unit_nan(), R(0.0)},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        unit_row(i);
        CHECK(gw_fraction(rows[i].part, rows[i].whole) == rows[i].fraction);
    }
}

/* Correctly rounded: the root of a square is exact, and no neighbour squares to something nearer. */
static void square_roots_are_exact(void)
{
    const gw_real_t smallest = unit_above(GW_ZERO);
    const gw_real_t largest_root = gw_sqrt(GW_REAL_MAX);
    for (uint32_t i = 1U; i <= 1000U; i++) {
        const gw_real_t root = (gw_real_t)i;
        unit_row(i);
        CHECK(gw_sqrt(root * root) == root);
    }
    CHECK(gw_sqrt(R(0.0)) == R(0.0));
    CHECK(gw_sqrt(R(-4.0)) == R(0.0));
    CHECK(gw_sqrt(unit_nan()) == R(0.0));
    CHECK(gw_sqrt(unit_infinity()) == largest_root);
    CHECK_NEAR(largest_root / GW_REAL_MAX * largest_root, R(1.0), R(2.0) * ULP);
    CHECK(gw_sqrt(unit_below(R(4.0))) == unit_below(R(2.0)));
    CHECK_NEAR(gw_sqrt(R(2.0)), R(1.41421356237309505), ULP);
    /* 2^-149 = 2 (2^-75)^2 in float, 2^-1074 = (2^-537)^2 in double */
#if (GW_REAL_DOUBLE == 1)
    CHECK(gw_sqrt(smallest) == R(2.2227587494850775e-162));
#else
    CHECK(gw_sqrt(smallest) == R(3.743392066509216e-23));
#endif
}

static void exponentials_meet_known_values(void)
{
    const struct {
        gw_real_t x;
        gw_real_t exp;
        gw_real_t expm1;
    } rows[] = {
        {R(0.0), R(1.0), R(0.0)},
        {R(1.0), R(2.71828182845904524), R(1.71828182845904524)},
        {R(-1.0), R(0.36787944117144232), R(-0.63212055882855768)},
        {R(10.0), R(22026.4657948067165), R(22025.4657948067165)},
        {R(-15.0), R(3.05902320501825788e-7), R(-0.99999969409767950)},
        {R(80.0), R(5.54062238439351e34), R(5.54062238439351e34)},
        {R(-50.0), R(1.92874984796391778e-22), R(-1.0)},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        unit_row(i);
        CHECK_NEAR(gw_exp(rows[i].x), rows[i].exp, R(4.0) * ULP * rows[i].exp);
        CHECK_NEAR(gw_expm1(rows[i].x), rows[i].expm1, R(4.0) * ULP * gw_abs(rows[i].expm1));
    }
    CHECK(gw_expm1(R(1e-6)) > R(0.0)); /* no cancellation */
    CHECK_NEAR(gw_expm1(R(1e-6)), R(1.00000050000016667e-6), R(1e-6) * R(4.0) * ULP);
}

static void exponentials_are_defined_everywhere(void)
{
    CHECK(gw_exp(R(1000.0)) == GW_REAL_MAX);
    CHECK(gw_exp(unit_infinity()) == GW_REAL_MAX);
    CHECK(gw_exp(R(-1000.0)) == R(0.0));
    CHECK(gw_exp(-unit_infinity()) == R(0.0));
    CHECK(gw_exp(unit_nan()) == R(0.0));
    CHECK(gw_expm1(R(1000.0)) == GW_REAL_MAX);
    CHECK(gw_expm1(R(-1000.0)) == R(-1.0));
    CHECK(gw_expm1(-unit_infinity()) == R(-1.0));
    CHECK(gw_expm1(unit_nan()) == R(0.0));
}

static void the_hyperbolic_tangent_saturates_at_one(void)
{
    const struct {
        gw_real_t x;
        gw_real_t tanh;
    } rows[] = {
        {R(0.0), R(0.0)},
        {R(0.5), R(0.46211715726000976)},
        {R(-0.5), R(-0.46211715726000976)},
        {R(2.0), R(0.96402758007581688)},
        {R(30.0), R(1.0)},
        {R(-30.0), R(-1.0)},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        unit_row(i);
        CHECK_NEAR(gw_tanh(rows[i].x), rows[i].tanh, R(4.0) * ULP);
    }
    CHECK(gw_tanh(R(30.0)) == R(1.0));
    CHECK_NEAR(gw_tanh(R(10.0)), R(0.99999999587769276), R(4.0) * ULP); /* from here on 1 in float, */
    CHECK(gw_tanh(R(20.0)) == R(1.0));                                  /* from here on in double */
    CHECK(gw_tanh(-unit_infinity()) == R(-1.0));
    CHECK(gw_tanh(unit_nan()) == R(0.0));
}

static void sine_and_cosine_in_every_quadrant(void)
{
    const struct {
        gw_real_t angle;
        gw_real_t sine;
        gw_real_t cosine;
    } rows[] = {
        {R(0.0), R(0.0), R(1.0)},
        {R(0.5), R(0.47942553860420300), R(0.87758256189037272)},
        {R(2.0), R(0.90929742682568170), R(-0.41614683654714239)},
        {R(3.0), R(0.14112000805986722), R(-0.98999249660044546)},
        {R(-2.0), R(-0.90929742682568170), R(-0.41614683654714239)},
        {R(5.0), R(-0.95892427466313847), R(0.28366218546322626)},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        const gw_rotation_t rotation = gw_sincos(rows[i].angle);
        unit_row(i);
        CHECK_NEAR(rotation.sine, rows[i].sine, R(2.0) * ULP);
        CHECK_NEAR(rotation.cosine, rows[i].cosine, R(2.0) * ULP);
    }
}

static void sine_and_cosine_outside_the_domain_are_those_of_zero(void)
{
    const gw_real_t outside[] = {unit_above(GW_ANGLE_MAX), unit_below(-GW_ANGLE_MAX), unit_infinity(), unit_nan()};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(outside); i++) {
        const gw_rotation_t rotation = gw_sincos(outside[i]);
        unit_row(i);
        CHECK(rotation.sine == R(0.0));
        CHECK(rotation.cosine == R(1.0));
        CHECK(gw_wrap_angle(outside[i]) == R(0.0));
    }
}

static void directions_in_every_octant(void)
{
    const struct {
        gw_real_t y;
        gw_real_t x;
        gw_real_t angle;
    } rows[] = {
        {R(0.0), R(1.0), R(0.0)},
        {R(1.0), R(2.0), R(0.46364760900080612)},
        {R(3.0), R(3.0), R(0.78539816339744831)},
        {R(2.0), R(1.0), R(1.10714871779409050)},
        {R(1.0), R(0.0), R(1.57079632679489662)},
        {GW_REAL_MAX, R(1.0), R(1.57079632679489662)},
        {R(2.0), R(-1.0), R(2.03444393579570273)},
        {R(1.0), R(-2.0), R(2.67794504458898712)},
        {R(-1.0), R(-2.0), R(-2.67794504458898712)},
        {R(-2.0), R(-1.0), R(-2.03444393579570273)},
        {R(-2.0), R(1.0), R(-1.10714871779409050)},
        {R(-1.0), R(2.0), R(-0.46364760900080612)},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        unit_row(i);
        CHECK_NEAR(gw_atan2(rows[i].y, rows[i].x), rows[i].angle, R(4.0) * ULP);
    }
}

static void directions_of_nothing_are_zero(void)
{
    CHECK(gw_atan2(R(0.0), R(0.0)) == R(0.0));
    CHECK(gw_atan2(unit_nan(), R(1.0)) == R(0.0));
    CHECK(gw_atan2(R(1.0), unit_nan()) == R(0.0));
    CHECK(gw_atan2(unit_infinity(), R(1.0)) == R(0.0));
    CHECK(gw_atan2(R(1.0), -unit_infinity()) == R(0.0));
}

/* Around every odd multiple of pi, where rounding could leave [-pi, pi). */
static void wrapped_angles_are_within_half_a_turn(void)
{
    for (int32_t turn = -1500; turn <= 1500; turn += 5) {
        gw_real_t angle = GW_PI * (gw_real_t)((2 * turn) + 1);
        for (uint32_t i = 0U; i < 3U; i++) {
            angle = unit_below(angle);
        }
        unit_row((uint32_t)(turn + 1500));
        for (uint32_t i = 0U; i < 7U; i++) {
            const gw_real_t wrapped = gw_wrap_angle(angle);
            const gw_rotation_t before = gw_sincos(angle);
            const gw_rotation_t after = gw_sincos(wrapped);
            CHECK((wrapped >= -GW_PI) && (wrapped < GW_PI));
            /* The wrapped angle is rounded once more: half an ulp of pi. */
            CHECK_NEAR(after.sine, before.sine, R(4.0) * ULP);
            CHECK_NEAR(after.cosine, before.cosine, R(4.0) * ULP);
            angle = unit_above(angle);
        }
    }
    CHECK(gw_wrap_angle(R(1.0)) == R(1.0));
    CHECK_NEAR(gw_wrap_angle(R(7.0)), R(0.71681469282041353), R(2.0) * ULP);
}

static void counters_may_wrap(void)
{
    const struct {
        int32_t later;
        int32_t earlier;
        int32_t difference;
    } rows[] = {
        {5, 3, 2},
        {3, 5, -2},
        {INT32_MIN, INT32_MAX, 1},
        {INT32_MAX, INT32_MIN, -1},
        {INT32_MAX, 0, INT32_MAX},
        {INT32_MIN, 0, INT32_MIN},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        unit_row(i);
        CHECK(gw_count_difference(rows[i].later, rows[i].earlier) == rows[i].difference);
    }
}

static void vectors_turn_and_turn_back(void)
{
    const gw_rotation_t quarter = {R(1.0), R(0.0)};
    const gw_vector_t vector = {R(3.0), R(4.0)};
    const gw_vector_t turned = gw_rotate(quarter, vector);
    const gw_vector_t back = gw_rotate_back(quarter, turned);
    CHECK((turned.x == R(-4.0)) && (turned.y == R(3.0)));
    CHECK((back.x == vector.x) && (back.y == vector.y));
}

static void a_component_is_taken_along_a_direction(void)
{
    const gw_vector_t vector = {R(3.0), R(-4.0)};
    const gw_vector_t direction = {R(0.0), R(-1.0)};
    const gw_vector_t slanted = {R(0.5), R(0.25)};
    CHECK(gw_along(vector, direction) == R(4.0));
    CHECK(gw_along(vector, slanted) == R(0.5));
}

static void lengths_are_limited(void)
{
    const gw_vector_t vector = {R(3.0), R(4.0)};
    const gw_vector_t shorter = gw_limit_length(vector, R(2.5));
    const gw_vector_t same = gw_limit_length(vector, R(5.0));
    CHECK(gw_length(vector) == R(5.0));
    CHECK((shorter.x == R(1.5)) && (shorter.y == R(2.0)));
    CHECK((same.x == vector.x) && (same.y == vector.y));
}

/* v^2 = 2 a (distance - T v/2): what is left after the tick stops exactly. */
static void the_braking_speed_stops_at_the_goal(void)
{
    const gw_real_t speed = gw_braking_speed(R(2.0), R(0.01), R(0.25));
    CHECK_NEAR(speed * speed, R(4.0) * (R(0.25) - (R(0.005) * speed)), R(8.0) * ULP);
    CHECK(gw_braking_speed(R(2.0), R(0.01), R(0.0)) == R(0.0));
    CHECK(gw_braking_speed(R(2.0), R(0.01), R(-1.0)) == R(0.0));
    CHECK(gw_braking_speed(R(2.0), R(0.01), unit_nan()) == R(0.0));
}

/* The ends of the range on which the exponential is computed belong to it. */
static void exponentials_reach_to_the_ends_of_their_range(void)
{
#if (GW_REAL_DOUBLE == 1)
    const gw_real_t ends[2] = {R(-708.0), R(709.0)};
#else
    const gw_real_t ends[2] = {R(-87.0), R(88.0)};
#endif
    CHECK(gw_exp(ends[0]) > GW_ZERO);
    CHECK(gw_exp(unit_below(ends[0])) == GW_ZERO);
    CHECK((gw_exp(ends[1]) < GW_REAL_MAX) && (gw_expm1(ends[1]) < GW_REAL_MAX));
    CHECK((gw_exp(unit_above(ends[1])) == GW_REAL_MAX) && (gw_expm1(unit_above(ends[1])) == GW_REAL_MAX));
}

void suite_math(void)
{
    unit_run("exponentials_reach_to_the_ends_of_their_range", exponentials_reach_to_the_ends_of_their_range);
    unit_run("finite_means_neither_nan_nor_infinite", finite_means_neither_nan_nor_infinite);
    unit_run("a_range_holds_its_ends_and_not_their_neighbours", a_range_holds_its_ends_and_not_their_neighbours);
    unit_run("comparisons_choose_as_documented", comparisons_choose_as_documented);
    unit_run("a_fraction_is_at_most_one", a_fraction_is_at_most_one);
    unit_run("square_roots_are_exact", square_roots_are_exact);
    unit_run("exponentials_meet_known_values", exponentials_meet_known_values);
    unit_run("exponentials_are_defined_everywhere", exponentials_are_defined_everywhere);
    unit_run("the_hyperbolic_tangent_saturates_at_one", the_hyperbolic_tangent_saturates_at_one);
    unit_run("sine_and_cosine_in_every_quadrant", sine_and_cosine_in_every_quadrant);
    unit_run("sine_and_cosine_outside_the_domain_are_those_of_zero",
             sine_and_cosine_outside_the_domain_are_those_of_zero);
    unit_run("directions_in_every_octant", directions_in_every_octant);
    unit_run("directions_of_nothing_are_zero", directions_of_nothing_are_zero);
    unit_run("wrapped_angles_are_within_half_a_turn", wrapped_angles_are_within_half_a_turn);
    unit_run("counters_may_wrap", counters_may_wrap);
    unit_run("vectors_turn_and_turn_back", vectors_turn_and_turn_back);
    unit_run("a_component_is_taken_along_a_direction", a_component_is_taken_along_a_direction);
    unit_run("lengths_are_limited", lengths_are_limited);
    unit_run("the_braking_speed_stops_at_the_goal", the_braking_speed_stops_at_the_goal);
}
