#include "unit.h"

static gw_planar_covariance_t covariance(gw_real_t xx, gw_real_t xy, gw_real_t yy)
{
    const gw_planar_covariance_t made = {xx, xy, yy};
    return made;
}

static gw_vector_t vector(gw_real_t x, gw_real_t y)
{
    const gw_vector_t made = {x, y};
    return made;
}

static void check(gw_planar_covariance_t actual, gw_real_t xx, gw_real_t xy, gw_real_t yy)
{
    CHECK((actual.xx == xx) && (actual.xy == xy) && (actual.yy == yy));
}

static void it_is_scaled_and_widened(void)
{
    const gw_planar_covariance_t m = covariance(R(2.0), R(-3.0), R(5.0));
    check(gw_planar_scaled(m, R(4.0)), R(8.0), R(-12.0), R(20.0));
    check(gw_planar_widened(m, vector(R(2.0), R(3.0))), R(6.0), R(3.0), R(14.0));
}

static void the_spread_is_what_a_distance_needs(void)
{
    const gw_planar_spread_t spread = gw_planar_spread(covariance(R(2.0), R(-3.0), R(5.0)));
    check(spread.m, R(2.0), R(-3.0), R(5.0));
    CHECK((spread.trace == R(7.0)) && (spread.determinant == R(1.0)));
    CHECK(gw_planar_spread(covariance(R(2.0), R(4.0), R(5.0))).determinant == R(0.0)); /* no covariance: -6 */
}

/* x^T (M + n I)^-1 x by hand. */
static void the_distance_is_that_of_the_inverse(void)
{
    const struct {
        gw_planar_covariance_t m;
        gw_real_t n;
        gw_vector_t x;
        gw_real_t distance;
    } rows[] = {
        {{R(0.0), R(0.0), R(0.0)}, R(4.0), {R(2.0), R(0.0)}, R(1.0)},
        {{R(0.0), R(0.0), R(0.0)}, R(4.0), {R(3.0), R(-4.0)}, R(6.25)},
        {{R(12.0), R(0.0), R(0.0)}, R(4.0), {R(4.0), R(2.0)}, R(2.0)},
        {{R(0.0), R(0.0), R(12.0)}, R(4.0), {R(2.0), R(4.0)}, R(2.0)},
        /* M + I = (3 1; 1 2), inverse (2 -1; -1 3)/5 */
        {{R(2.0), R(1.0), R(1.0)}, R(1.0), {R(1.0), R(2.0)}, R(2.0)},
        {{R(2.0), R(1.0), R(1.0)}, R(1.0), {R(1.0), R(-2.0)}, R(3.6)},
        /* singular: (1 1; 1 1) + I/2, inverse (1.5 -1; -1 1.5)/1.25 */
        {{R(1.0), R(1.0), R(1.0)}, R(0.5), {R(1.0), R(-1.0)}, R(4.0)},
        {{R(1.0), R(1.0), R(1.0)}, R(0.5), {R(1.0), R(1.0)}, R(0.8)},
        {{R(1.0), R(1.0), R(1.0)}, R(0.5), {R(0.0), R(0.0)}, R(0.0)},
        {{R(0.0), R(0.0), R(0.0)}, R(1.0), {R(2000.0), R(0.0)}, GW_DISTANCE_MAX},
        /* no covariance: x^T adj(M + n I) x = 1.5 - 4 < 0 counts as nothing */
        {{R(0.0), R(2.0), R(0.0)}, R(0.75), {R(1.0), R(1.0)}, R(0.0)},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        const gw_planar_spread_t spread = gw_planar_spread(rows[i].m);
        unit_row(i);
        CHECK_NEAR(gw_planar_distance(&spread, rows[i].n, rows[i].x), rows[i].distance,
                   rows[i].distance * R(0.1) * ROUNDING);
    }
}

static void a_ratio_is_limited(void)
{
    CHECK(gw_planar_ratio(R(6.0), R(3.0)) == R(2.0));
    CHECK(gw_planar_ratio(R(0.0), R(0.0)) == R(0.0));
    CHECK(gw_planar_ratio(R(1.0), R(0.0)) == GW_DISTANCE_MAX);
    CHECK(gw_planar_ratio(R(1.0), R(-1.0)) == GW_DISTANCE_MAX);
    CHECK(gw_planar_ratio(R(3.0e6), R(2.0)) == GW_DISTANCE_MAX);
    CHECK(gw_planar_ratio(R(1.5e6), R(2.0)) == R(7.5e5));
}

void suite_planar_covariance(void)
{
    unit_run("it_is_scaled_and_widened", it_is_scaled_and_widened);
    unit_run("the_spread_is_what_a_distance_needs", the_spread_is_what_a_distance_needs);
    unit_run("the_distance_is_that_of_the_inverse", the_distance_is_that_of_the_inverse);
    unit_run("a_ratio_is_limited", a_ratio_is_limited);
}
