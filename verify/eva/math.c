/* The functions of gw_math that have no contract, and gw_config. */
#include "parts.h"

static void part_init(void)
{
    gw_controller_config_t config;
    gw_controller_config_paper(&config);
    gw_controller_config_trikey(&config);
    (void)gw_config_limit((gw_config_field_t)any_count);
    (void)gw_config_name((gw_config_field_t)any_count);
}

static void part_step(void)
{
    const gw_rotation_t rotation = gw_sincos(any_real());
    const gw_vector_t vector = {draw_real((gw_real_t)-1.0e18, (gw_real_t)1.0e18),
                                draw_real((gw_real_t)-1.0e18, (gw_real_t)1.0e18)};
    (void)gw_is_finite(any_real());
    (void)gw_count_difference(any_int, any_int);
    (void)gw_rotate(rotation, vector);
    (void)gw_rotate_back(rotation, vector);
    (void)gw_limit_length(vector, draw_real((gw_real_t)1.0e-7, (gw_real_t)1.0e6));
    (void)gw_braking_speed(draw_real((gw_real_t)0.001, (gw_real_t)10000.0), draw_setting(GW_FIELD_CONTROLLER_PERIOD),
                           draw_real((gw_real_t)-1.0e6, (gw_real_t)1.0e6));
}

static void part_refusals(void)
{
    const gw_sum_t sum = {any_real(), draw_real((gw_real_t)-2000.0, (gw_real_t)2000.0)};
    (void)gw_sum_invariant_holds(sum);
}
