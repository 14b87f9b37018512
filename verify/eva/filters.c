/* gw_rate_filter, gw_lowpass, gw_presliding, gw_moving_average, gw_tare and gw_sum: the parts of gw_estimator that have
 * a state. */
#include "parts.h"

static gw_kinematics_t kinematics;
static gw_rate_filter_constants_t constants;
static gw_rate_filter_t rate;
static gw_lowpass_t lowpass;
static gw_presliding_t presliding;
static gw_presliding_config_t presliding_config;
static gw_friction_config_t friction;
static gw_moving_average_t average;
static gw_tare_t tare;

static void part_init(void)
{
    draw_presliding_config(&presliding_config);
    draw_friction_config(&friction);
    draw_kinematics(&kinematics);
    demand_count((uint32_t)gw_rate_filter_constants(&constants, draw_setting(GW_FIELD_CONTROLLER_PERIOD),
                                                    draw_setting(GW_FIELD_ESTIMATOR_RATE_CUTOFF),
                                                    draw_count(lowest_count(GW_FIELD_ESTIMATOR_ENCODER_COUNTS),
                                                               highest_count(GW_FIELD_ESTIMATOR_ENCODER_COUNTS)),
                                                    draw_setting(GW_FIELD_ESTIMATOR_DRIVETRAIN_STIFFNESS)),
                 0U, 0U);
    demand_count((uint32_t)gw_presliding_init(&presliding, &presliding_config, &friction, &kinematics), 0U, 0U);
    demand_count((uint32_t)gw_moving_average_init(&average, draw_count(1U, GW_MOVING_AVERAGE_CAPACITY)), 0U, 0U);
    gw_rate_filter_restart(&rate);
    gw_lowpass_restart(&lowpass);
    gw_tare_start(&tare);
    hold_rate_constants(&constants);
    hold_rate_filter(&rate);
    hold_lowpass(&lowpass, GW_TORQUE_MAX);
    hold_presliding(&presliding);
    hold_moving_average(&average);
    hold_tare(&tare);
}

static void step_sums(void)
{
    gw_sum_t sum;
    draw_sum(&sum, (gw_real_t)1.0e11);
    sum = gw_sum_limit(gw_sum_add(sum, draw_real((gw_real_t)-1.0e9, (gw_real_t)1.0e9)), (gw_real_t)1.0e11);
    hold_sum(&sum, (gw_real_t)1.0e11);
    draw_sum(&sum, PI_ROUNDED);
    sum = gw_sum_add_angle(sum, any_real());
    hold_sum(&sum, PI_ROUNDED);
}

static void part_step(void)
{
    gw_twist_t twist;
    gw_wheels_t torque_nm;
    gw_wheels_t mean_nm = {{GW_ZERO, GW_ZERO, GW_ZERO}};
    const gw_wheels_t any_torque_nm = {{any_real(), any_real(), any_real()}};
    const int32_t counts[GW_WHEEL_COUNT] = {any_int, any_int, any_int};
    const gw_wrench_t wrench = {any_real(), any_real(), any_real()};
    draw_kinematics(&kinematics);
    draw_rate_constants(&constants);
    draw_rate_filter(&rate);
    draw_lowpass(&lowpass, GW_TORQUE_MAX);
    draw_presliding(&presliding);
    draw_moving_average(&average);
    draw_tare(&tare);
    draw_wheels(&torque_nm, GW_TORQUE_MAX);
    twist.vx_mps = draw_real((gw_real_t)-1.0e9, (gw_real_t)1.0e9);
    twist.vy_mps = draw_real((gw_real_t)-1.0e9, (gw_real_t)1.0e9);
    twist.omega_radps = draw_real((gw_real_t)-1.0e9, (gw_real_t)1.0e9);
    gw_rate_filter_presume(&rate, any_real());
    gw_rate_filter_step(&rate, &constants, any_int, torque_nm.wheel[0]);
    (void)gw_lowpass_step(&lowpass, &constants, torque_nm.wheel[1], GW_TORQUE_MAX);
    (void)gw_presliding_step(&presliding, &kinematics, &constants, counts, &torque_nm, twist);
    (void)gw_presliding_elastic_torques(&presliding, &kinematics);
    (void)gw_moving_average_add(&average, wrench);
    (void)gw_tare_add(&tare, &any_torque_nm, draw_count(1U, 100000U), draw_setting(GW_FIELD_ESTIMATOR_TARE_VARIATION),
                      &mean_nm);
    hold_wheels(&mean_nm, GW_TORQUE_MAX);
    gw_presliding_settle(&presliding, &mean_nm);
    hold_rate_filter(&rate);
    hold_lowpass(&lowpass, GW_TORQUE_MAX);
    hold_presliding(&presliding);
    hold_moving_average(&average);
    hold_tare(&tare);
    step_sums();
    (void)gw_rate_filter_invariant_holds(&rate);
    (void)gw_lowpass_invariant_holds(&lowpass, GW_TORQUE_MAX);
    (void)gw_presliding_invariant_holds(&presliding);
    (void)gw_moving_average_invariant_holds(&average);
    (void)gw_tare_invariant_holds(&tare);
}

static void part_refusals(void)
{
    draw_presliding_config(&presliding_config);
    draw_friction_config(&friction);
    draw_kinematics(&kinematics);
    friction.coulomb_torque_nm = draw_refused(GW_FIELD_FRICTION_COULOMB_TORQUE);
    (void)gw_rate_filter_constants(any_flag() ? &constants : NULL, draw_refused(GW_FIELD_CONTROLLER_PERIOD), GW_ONE,
                                   100U, GW_ONE);
    (void)gw_presliding_init(any_flag() ? &presliding : NULL, any_flag() ? &presliding_config : NULL,
                             any_flag() ? &friction : NULL, any_flag() ? &kinematics : NULL);
    (void)gw_moving_average_init(any_flag() ? &average : NULL, any_flag() ? 0U : (GW_MOVING_AVERAGE_CAPACITY + 1U));
    (void)gw_moving_average_add(NULL, gw_moving_average_mean(&average));
    disturb_rate_filter(&rate);
    disturb_lowpass(&lowpass, GW_TORQUE_MAX);
    (void)gw_lowpass_invariant_holds(&lowpass, GW_TORQUE_MAX);
    disturb_presliding(&presliding);
    disturb_tare(&tare);
    average.window = any_count;
    average.index = any_count;
    (void)gw_rate_filter_invariant_holds(any_flag() ? &rate : NULL);
    (void)gw_presliding_invariant_holds(any_flag() ? &presliding : NULL);
    (void)gw_tare_invariant_holds(any_flag() ? &tare : NULL);
    (void)gw_moving_average_invariant_holds(any_flag() ? &average : NULL);
}
