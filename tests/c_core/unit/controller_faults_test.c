#include "rig.h"

/* A robot moving at 0.2 m/s. */
static void on_the_way(void)
{
    rig_set_up();
    rig_config.estimator.tare_ticks = 0U;
    rig_input.plan.twist.vx_mps = R(0.2);
    rig_begin();
    rig_tick(GW_STATUS_OK);
    CHECK(rig_output.reference_twist.vx_mps == R(0.2));
}

/* In the same tick: the last angles at zero speed, and mode FAULT. Then it returns to the path. */
static void bad_sensors_command_no_motion(void)
{
    const struct {
        gw_real_t torque;
        int32_t count;
        bool present;
        gw_status_t status;
    } rows[] = {
        {GW_ZERO, 0, false, GW_STATUS_SENSOR_MISSING},          {unit_nan(), 0, true, GW_STATUS_SENSOR_NONFINITE},
        {unit_infinity(), 0, true, GW_STATUS_SENSOR_NONFINITE}, {R(20.0), 0, true, GW_STATUS_SENSOR_SATURATED},
        {GW_ZERO, 100000, true, GW_STATUS_ENCODER_JUMP},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        gw_real_t before[GW_WHEEL_COUNT];
        on_the_way();
        for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
            before[k] = rig_output.command.angle_rad[k];
        }
        unit_row(i);
        rig_input.sensor.torque_nm[0] = rows[i].torque;
        rig_input.sensor.encoder_count[0] = rows[i].count;
        rig_input.sensor.present = rows[i].present;
        rig_tick(rows[i].status);
        CHECK((rig_output.mode == GW_MODE_FAULT) && (rig_output.reference_twist.vx_mps == GW_ZERO));
        for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
            CHECK((rig_output.command.speed_radps[k] == GW_ZERO) && (rig_output.command.angle_rad[k] == before[k]));
        }
        rig_input.sensor.torque_nm[0] = GW_ZERO;
        rig_input.sensor.present = true;
        rig_tick(GW_STATUS_SENSOR_RECOVERING);
        rig_tick(GW_STATUS_SENSOR_RECOVERING);
        CHECK(rig_output.mode == GW_MODE_FAULT);
        rig_tick(GW_STATUS_OK);
        CHECK(rig_output.mode == GW_MODE_REJOINING);
    }
}

/* In every mode that moves or measures, a fault stops at once. Afterwards the interrupted mode continues, except an
 * escape, which is abandoned. */
static void bad_sensors_interrupt_every_mode(void)
{
    const struct {
        gw_mode_t before;
        gw_mode_t after;
    } rows[] = {
        {GW_MODE_TARING, GW_MODE_TARING},
        {GW_MODE_TRACKING, GW_MODE_REJOINING},
        {GW_MODE_REACTING, GW_MODE_REACTING},
        {GW_MODE_STOPPED, GW_MODE_REJOINING},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        unit_row(i);
        on_the_way();
        if (rows[i].before == GW_MODE_TARING) {
            rig_set_up();
            rig_begin();
            rig_tick(GW_STATUS_OK);
        } else if (rows[i].before == GW_MODE_REACTING) {
            rig_push(R(200.0));
            rig_until(GW_MODE_REACTING, 50U);
        } else {
            rig_input.stop_request = (rows[i].before == GW_MODE_STOPPED);
            rig_tick(GW_STATUS_OK);
        }
        CHECK_STATUS(rig_output.mode, rows[i].before);
        rig_push(GW_ZERO);
        rig_input.sensor.present = false;
        rig_tick(GW_STATUS_SENSOR_MISSING);
        CHECK_STATUS(rig_output.mode, GW_MODE_FAULT);
        for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
            CHECK(rig_output.command.speed_radps[k] == GW_ZERO);
        }
        rig_input.sensor.present = true;
        rig_input.stop_request = false;
        for (uint32_t k = 0U; k < rig_config.sensor_check.recover_ticks; k++) {
            rig_tick(GW_STATUS_SENSOR_RECOVERING);
            CHECK_STATUS(rig_output.mode, GW_MODE_FAULT);
        }
        rig_tick(GW_STATUS_OK);
        CHECK_STATUS(rig_output.mode, rows[i].after);
    }
}

static void a_sample_counter_that_stands_is_a_fault(void)
{
    on_the_way();
    for (uint32_t i = 0U; i < (rig_config.sensor_check.stale_ticks_max - 1U); i++) {
        rig_input.sensor.counter--;
        rig_tick(GW_STATUS_OK);
    }
    rig_input.sensor.counter--;
    rig_tick(GW_STATUS_SENSOR_STALE);
    CHECK((rig_output.mode == GW_MODE_FAULT) && (rig_output.reference_twist.vx_mps == GW_ZERO));
}

/* Bad from the start: nothing was ever measured, so nothing is enabled. */
static void before_the_first_sample_the_drives_are_off(void)
{
    rig_set_up();
    rig_begin();
    rig_input.sensor.present = false;
    rig_tick(GW_STATUS_SENSOR_MISSING);
    CHECK((!rig_output.enable) && (rig_output.mode == GW_MODE_FAULT));
    rig_input.sensor.present = true;
    rig_tick(GW_STATUS_OK);
    CHECK(rig_output.enable && (rig_output.mode == GW_MODE_TARING));
}

static void a_plan_that_is_not_finite_slows_it_down(void)
{
    on_the_way();
    rig_input.plan.pose.y_m = unit_nan();
    rig_tick(GW_STATUS_PLAN_INVALID);
    CHECK(rig_output.mode == GW_MODE_TRACKING);
    CHECK((rig_output.reference_twist.vx_mps > GW_ZERO) && (rig_output.reference_twist.vx_mps < R(0.2)));
    const uint32_t clock = rig_output.path_ticks;
    for (uint32_t i = 0U; i < 200U; i++) {
        rig_tick(GW_STATUS_PLAN_INVALID);
    }
    CHECK_NEAR(rig_output.reference_twist.vx_mps, GW_ZERO, ROUNDING);
    CHECK(rig_output.path_ticks == clock);
}

/* Reached TRACKING without a plan: it is placed on the first one that comes. */
static void it_waits_for_its_first_plan(void)
{
    rig_set_up();
    rig_begin();
    rig_input.plan.pose.x_m = unit_nan();
    for (uint32_t i = 0U; i < 10U; i++) {
        rig_tick(GW_STATUS_PLAN_INVALID);
    }
    CHECK(rig_output.mode == GW_MODE_TRACKING);
    CHECK(rig_output.reference_pose.x_m == GW_ZERO);
    rig_input.plan.pose.x_m = R(3.0);
    rig_tick(GW_STATUS_OK);
    CHECK(rig_output.reference_pose.x_m == R(3.0));
}

/* A measured motion beyond any robot is a fault of the sensors, though each sample looks good. */
static void a_wrench_beyond_any_push_is_a_fault(void)
{
    rig_set_up();
    rig_config.estimator.acceleration_source = GW_SOURCE_MEASURED;
    rig_config.estimator.rate_cutoff_radps = R(10000.0);
    rig_config.estimator.encoder_counts = 4U;
    rig_config.sensor_check.encoder_jump_counts = 1000000U;
    rig_config.base.mass_kg = R(2000.0);
    rig_config.estimator.tare_ticks = 0U;
    rig_begin();
    rig_ticks(2U);
    rig_input.sensor.encoder_count[0] = 1000000;
    rig_tick(GW_STATUS_INPUT_INVALID);
    CHECK((rig_output.mode == GW_MODE_FAULT) && (rig_output.command.speed_radps[0] == GW_ZERO));
}

/* An admittance whose memory was overwritten refuses to work: the robot brakes. */
static void a_corrupt_admittance_brakes(void)
{
    rig_set_up();
    rig_begin_with_a_push(R(20.0));
    rig_push(GW_ZERO);
    rig_ticks(100U);
    const gw_real_t before = rig_output.reference_twist.vx_mps;
    rig_controller.admittance.initialised = false;
    rig_input.sensor.counter++;
    CHECK_STATUS(gw_controller_step(&rig_controller, &rig_input, &rig_output), GW_STATUS_OK);
    CHECK((rig_output.reference_twist.vx_mps >= GW_ZERO) && (rig_output.reference_twist.vx_mps < before));
    CHECK(!gw_controller_invariant_holds(&rig_controller));
}

/* xorshift: the same numbers everywhere. */
static uint32_t random_state;

static uint32_t random_bits(void)
{
    random_state ^= random_state << 13U;
    random_state ^= random_state >> 17U;
    random_state ^= random_state << 5U;
    return random_state;
}

/* A number of any size, NaN and infinity among them. */
static gw_real_t any_real(void)
{
    const gw_real_t special[8] = {unit_nan(),   unit_infinity(),     -unit_infinity(), GW_REAL_MAX,
                                  -GW_REAL_MAX, unit_above(GW_ZERO), R(1e9),           R(0.001)};
    const uint32_t bits = random_bits();
    gw_real_t value = special[bits & 7U];
    if ((bits & 0xF00U) != 0U) {
        const gw_real_t scale = ((bits & 0x1000U) != 0U) ? R(0.5) : R(30.0);
        value = scale * (((gw_real_t)(random_bits() >> 8U) / R(8388608.0)) - GW_ONE);
    }
    return value;
}

/* For any input, the outputs are finite and within their limits and the invariant holds after every tick (step checks
 * them). */
static void no_input_whatever_leads_out_of_the_limits(void)
{
    for (uint32_t seed = 1U; seed <= 10U; seed++) {
        random_state = seed * 2654435761U;
        rig_set_up();
        rig_config.admittance.kind = seed & 1U;
        rig_config.detector.kind = (seed >> 1U) & 1U;
        rig_config.estimator.acceleration_source = seed % 3U;
        rig_begin();
        unit_row(seed);
        for (uint32_t i = 0U; i < 300U; i++) {
            const uint32_t choice = random_bits();
            for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
                rig_input.sensor.torque_nm[k] = any_real();
                rig_input.sensor.encoder_count[k] += (int32_t)(random_bits() & 63U);
            }
            rig_input.sensor.present = (choice & 0x3FU) != 0U;
            rig_input.stop_request = (choice & 0x3F00U) == 0U;
            rig_input.tare_request = (choice & 0x70000U) == 0U;
            rig_input.plan.pose.x_m = any_real();
            rig_input.plan.pose.theta_rad = any_real();
            rig_input.plan.twist.vy_mps = any_real();
            rig_input.plan.twist.omega_radps = any_real();
            rig_input.plan.acceleration.ax_mps2 = any_real();
            rig_input.sensor.counter += (choice >> 20U) & 1U;
            (void)rig_step();
        }
    }
}

static void the_invariant_sees_every_member(void)
{
    static gw_controller_t good;
    rig_set_up();
    rig_begin();
    good = rig_controller;
    CHECK(!gw_controller_invariant_holds(NULL));
    for (uint32_t i = 0U; i < 12U; i++) {
        rig_controller = good;
        switch (i) {
        case 0U:
            rig_controller.initialised = false;
            break;
        case 1U:
            rig_controller.sensor_check.initialised = false;
            break;
        case 2U:
            rig_controller.estimator.initialised = false;
            break;
        case 3U:
            rig_controller.contact.initialised = false;
            break;
        case 4U:
            rig_controller.detector.initialised = false;
            break;
        case 5U:
            rig_controller.admittance.initialised = false;
            break;
        case 6U:
            rig_controller.reference.initialised = false;
            break;
        case 7U:
            rig_controller.joint.angle_rad[0].value = unit_nan();
            break;
        case 8U:
            rig_controller.supervisor.initialised = false;
            break;
        case 9U:
            rig_controller.detection_count = GW_TICK_MASK + 1U;
            break;
        case 10U:
            rig_controller.detection_tick = -2;
            break;
        default:
            rig_controller.tick = GW_TICK_MASK + 1U;
            break;
        }
        unit_row(i);
        CHECK(!gw_controller_invariant_holds(&rig_controller));
    }
}

void suite_controller_faults(void)
{
    unit_run("bad_sensors_command_no_motion", bad_sensors_command_no_motion);
    unit_run("bad_sensors_interrupt_every_mode", bad_sensors_interrupt_every_mode);
    unit_run("a_sample_counter_that_stands_is_a_fault", a_sample_counter_that_stands_is_a_fault);
    unit_run("before_the_first_sample_the_drives_are_off", before_the_first_sample_the_drives_are_off);
    unit_run("a_plan_that_is_not_finite_slows_it_down", a_plan_that_is_not_finite_slows_it_down);
    unit_run("it_waits_for_its_first_plan", it_waits_for_its_first_plan);
    unit_run("a_wrench_beyond_any_push_is_a_fault", a_wrench_beyond_any_push_is_a_fault);
    unit_run("a_corrupt_admittance_brakes", a_corrupt_admittance_brakes);
    unit_run("no_input_whatever_leads_out_of_the_limits", no_input_whatever_leads_out_of_the_limits);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
}
