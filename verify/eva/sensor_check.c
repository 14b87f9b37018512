#include "parts.h"

static gw_sensor_check_t check;
static gw_sensor_check_config_t config;

static gw_sensor_sample_t any_sample(void)
{
    const gw_sensor_sample_t sample = {
        {any_real(), any_real(), any_real()}, {any_int, any_int, any_int}, any_count, any_flag()};
    return sample;
}

static void part_init(void)
{
    draw_sensor_check_config(&config);
    demand_count((uint32_t)gw_sensor_check_init(&check, &config), 0U, 0U);
    hold_sensor_check(&check);
}

static void part_step(void)
{
    draw_sensor_check(&check);
    const gw_sensor_sample_t sample = any_sample();
    (void)gw_sensor_check_step(&check, &sample);
    hold_sensor_check(&check);
    (void)gw_sensor_check_invariant_holds(&check);
}

static void part_refusals(void)
{
    const gw_sensor_sample_t sample = any_sample();
    draw_sensor_check_config(&config);
    config.torque_limit_nm = draw_refused(GW_FIELD_SENSOR_CHECK_TORQUE_LIMIT);
    (void)gw_sensor_check_init(any_flag() ? &check : NULL, any_flag() ? &config : NULL);
    check.initialised = false;
    (void)gw_sensor_check_step(any_flag() ? &check : NULL, any_flag() ? &sample : NULL);
    disturb_sensor_check(&check);
    (void)gw_sensor_check_invariant_holds(any_flag() ? &check : NULL);
}
