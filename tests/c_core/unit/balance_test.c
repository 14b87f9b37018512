#include "unit.h"

#define VALUES 9U

/* The values of a balance in one order: residual, friction, inertia. */
static gw_balance_t balance_of(const gw_real_t v[VALUES])
{
    const gw_balance_t made = {{v[0], v[1], v[2]}, {{{v[3], v[4], v[5]}}, {v[6], v[7]}, v[8]}};
    return made;
}

static void values_of(const gw_balance_t *balance, gw_real_t v[VALUES])
{
    v[0] = balance->residual.force_x_n;
    v[1] = balance->residual.force_y_n;
    v[2] = balance->residual.torque_nm;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        v[3U + i] = balance->model.friction_n.wheel[i];
    }
    v[6] = balance->model.inertia_n.x;
    v[7] = balance->model.inertia_n.y;
    v[8] = balance->model.inertia_moment_nm;
}

static const gw_real_t some[VALUES] = {R(1.0), R(-2.0), R(3.0), R(-4.0), R(5.0), R(-6.0), R(7.0), R(-8.0), R(9.0)};
static const gw_real_t other[VALUES] = {R(5.0),  R(6.0),   R(-9.0),  R(16.0), R(-15.0),
                                        R(18.0), R(-17.0), R(-16.0), R(1.0)};

static void it_approaches_another_by_a_share(void)
{
    const gw_balance_t target = balance_of(other);
    gw_balance_t balance = balance_of(some);
    gw_real_t v[VALUES];
    gw_balance_approach(&balance, &target, R(0.25));
    values_of(&balance, v);
    for (uint32_t i = 0U; i < VALUES; i++) {
        unit_row(i);
        CHECK(v[i] == (some[i] + (R(0.25) * (other[i] - some[i]))));
    }
}

static void a_difference_is_taken_value_by_value(void)
{
    const gw_balance_t from = balance_of(some);
    const gw_balance_t what = balance_of(other);
    const gw_balance_t difference = gw_balance_difference(&from, &what);
    gw_real_t v[VALUES];
    values_of(&difference, v);
    for (uint32_t i = 0U; i < VALUES; i++) {
        unit_row(i);
        CHECK(v[i] == (some[i] - other[i]));
    }
}

static void every_value_is_limited(void)
{
    const struct {
        gw_real_t value;
        gw_real_t limited;
    } rows[] = {
        {GW_BALANCE_MAX, GW_BALANCE_MAX},
        {unit_above(GW_BALANCE_MAX), GW_BALANCE_MAX},
        {-unit_infinity(), -GW_BALANCE_MAX},
        {unit_nan(), -GW_BALANCE_MAX},
    };
    for (uint32_t i = 0U; i < VALUES; i++) {
        for (uint32_t k = 0U; k < UNIT_COUNT_OF(rows); k++) {
            gw_real_t v[VALUES];
            for (uint32_t j = 0U; j < VALUES; j++) {
                v[j] = (j == i) ? rows[k].value : some[j];
            }
            const gw_balance_t balance = balance_of(v);
            const gw_balance_t limited = gw_balance_limited(&balance.residual, &balance.model);
            gw_real_t found[VALUES];
            values_of(&limited, found);
            unit_row((10U * i) + k);
            for (uint32_t j = 0U; j < VALUES; j++) {
                CHECK(found[j] == ((j == i) ? rows[k].limited : some[j]));
            }
        }
    }
}

static void every_value_is_seen(void)
{
    const gw_balance_t good = balance_of(some);
    CHECK(gw_balance_is_within(&good, R(9.0)));
    for (uint32_t i = 0U; i < VALUES; i++) {
        const gw_real_t bad[] = {R(9.1), R(-9.1), unit_nan()};
        for (uint32_t k = 0U; k < UNIT_COUNT_OF(bad); k++) {
            gw_real_t v[VALUES];
            for (uint32_t j = 0U; j < VALUES; j++) {
                v[j] = (j == i) ? bad[k] : some[j];
            }
            const gw_balance_t balance = balance_of(v);
            unit_row((10U * i) + k);
            CHECK(!gw_balance_is_within(&balance, R(9.0)));
        }
    }
}

void suite_balance(void)
{
    unit_run("it_approaches_another_by_a_share", it_approaches_another_by_a_share);
    unit_run("a_difference_is_taken_value_by_value", a_difference_is_taken_value_by_value);
    unit_run("every_value_is_limited", every_value_is_limited);
    unit_run("every_value_is_seen", every_value_is_seen);
}
