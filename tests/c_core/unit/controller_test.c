#include "rig.h"

static void bad_arguments_are_refused(void)
{
    gw_config_error_t error;
    rig_set_up();
    CHECK_STATUS(gw_controller_init(NULL, &rig_config, &error), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_controller_init(&rig_controller, NULL, &error), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_controller_step(&rig_controller, &rig_input, &rig_output), GW_STATUS_NOT_INITIALISED);
    CHECK((!rig_output.enable) && (rig_output.mode == GW_MODE_FAULT) && (rig_output.detection_tick == -1));
    CHECK_STATUS(gw_controller_init(&rig_controller, &rig_config, NULL), GW_STATUS_OK);
    CHECK_STATUS(gw_controller_step(&rig_controller, &rig_input, NULL), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_controller_step(&rig_controller, NULL, &rig_output), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_controller_step(NULL, &rig_input, &rig_output), GW_STATUS_NULL_POINTER);
    CHECK((!rig_output.enable) && (rig_output.command.speed_radps[0] == GW_ZERO));
    rig_config.base.mass_kg = unit_nan();
    CHECK_STATUS(gw_controller_init(&rig_controller, &rig_config, &error), GW_STATUS_CONFIG_INVALID);
    CHECK_STATUS(error.field, GW_FIELD_BASE_MASS);
    CHECK(!gw_controller_invariant_holds(&rig_controller));
}

/* The first tick places the wheels where they are; then the tare; then the plan. */
static void it_tares_and_then_follows_its_plan(void)
{
    rig_set_up();
    rig_input.sensor.encoder_count[1] = 4250; /* half a turn: -pi */
    rig_config.estimator.encoder_counts = 8500U;
    rig_begin();
    rig_tick(GW_STATUS_OK);
    CHECK((rig_output.mode == GW_MODE_TARING) && rig_output.enable && (rig_output.tick == 0U));
    CHECK_NEAR(gw_abs(rig_output.command.angle_rad[1]), GW_PI, ROUNDING);
    rig_ticks(2U);
    CHECK(rig_output.mode == GW_MODE_TARING);
    rig_tick(GW_STATUS_OK);
    CHECK((rig_output.mode == GW_MODE_TRACKING) && (rig_output.path_ticks == 1U));
    for (uint32_t i = 1U; i <= 1000U; i++) {
        const gw_real_t speed = R(0.0001) * (gw_real_t)i;
        rig_input.plan.pose.x_m = R(0.00000005) * (gw_real_t)i * (gw_real_t)i;
        rig_input.plan.twist.vx_mps = speed;
        rig_input.plan.acceleration.ax_mps2 = R(0.1);
        rig_push(GW_ZERO);
        rig_tick(GW_STATUS_OK);
    }
    CHECK(rig_output.mode == GW_MODE_TRACKING);
    CHECK(rig_output.path_ticks == 1001U);
    CHECK_NEAR(rig_output.reference_pose.x_m, R(0.05), R(0.00001));
    CHECK_NEAR(rig_output.reference_twist.vx_mps, R(0.1), R(0.0001));
}

/* Without a tare the robot may be moving along its plan already; with one it cannot be. */
static void without_a_tare_it_starts_at_the_plan_s_speed(void)
{
    rig_set_up();
    rig_config.estimator.tare_ticks = 0U;
    rig_input.plan.twist.vx_mps = R(0.2);
    rig_begin();
    rig_tick(GW_STATUS_OK);
    CHECK(rig_output.mode == GW_MODE_TRACKING);
    CHECK(rig_output.reference_twist.vx_mps == R(0.2));
}

/* 20 N from rest: hit, gives way along the push, settles, goes back and tracks again. */
static void it_gives_way_to_a_push_and_comes_back(void)
{
    rig_set_up();
    rig_begin_with_a_push(R(20.0));
    CHECK((rig_output.detection_count == 1U) && rig_output.detection_active);
    CHECK(rig_output.detection_tick == (int32_t)rig_output.tick);
    CHECK_NEAR(rig_output.detection_wrench.force_x_n, R(20.0), R(20.0) * ROUNDING);
    CHECK(rig_output.detection_contact.valid);
    CHECK_NEAR(rig_output.detection_contact.direction_rad, GW_ZERO, R(10.0) * ROUNDING);
    CHECK_NEAR(rig_output.contact.force_n, R(20.0), R(20.0) * ROUNDING);
    while ((rig_output.mode == GW_MODE_REACTING) && (rig_output.tick < 20000U)) {
        rig_push(GW_ZERO);
        rig_tick(GW_STATUS_OK);
        CHECK(rig_output.reference_twist.vx_mps >= GW_ZERO); /* never towards the push */
    }
    CHECK(rig_output.mode == GW_MODE_SETTLED);
    CHECK_NEAR(rig_output.reference_pose.x_m,
               rig_config.admittance.escape_impulse_newton_s / rig_config.admittance.damping_newton_s_per_m, R(0.001));
    rig_tick(GW_STATUS_OK);
    CHECK(rig_output.mode == GW_MODE_REJOINING);
    rig_until(GW_MODE_TRACKING, 20000U);
    CHECK(gw_abs(rig_output.reference_pose.x_m) < R(0.0003));
    CHECK(rig_output.detection_count == 1U);
}

/* In motion, pushed from the front while it drives: with each detector it brakes as soon as it feels the push, harder
 * than the margin of tipping allows without one; then gives way within the margin. */
static void an_escape_brakes_as_long_as_it_is_pushed(void)
{
    for (uint32_t kind = 0U; kind <= GW_DETECTOR_CHANNELS; kind++) {
        rig_set_up();
        rig_config.estimator.tare_ticks = 0U;
        rig_config.detector.kind = kind;
        if (kind == GW_DETECTOR_CHANNELS) {
            rig_config.estimator.acceleration_source = GW_SOURCE_MEASURED;
            rig_config.estimator.aligned = 1U;
        }
        rig_config.detector.force_threshold_n = R(10.0);
        rig_config.admittance.kind = GW_ADMITTANCE_ESCAPE;
        rig_config.admittance.brake_limit_mps2 = R(3.0);
        rig_config.supervisor.settled_ticks = 50U; /* turning round is not the end */
        rig_config.admittance.tip.height_m = R(0.414);
        rig_input.plan.twist.vx_mps = R(-0.2);
        rig_begin();
        unit_row(kind);
        rig_tick(GW_STATUS_OK);
        for (uint32_t i = 1U; i <= 1000U; i++) {
            rig_input.plan.pose.x_m = R(-0.0002) * (gw_real_t)i;
            rig_push(GW_ZERO);
            rig_tick(GW_STATUS_OK);
        }
        CHECK(rig_output.mode == GW_MODE_TRACKING);
        rig_push(R(40.0));
        rig_until(GW_MODE_REACTING, 300U);
        const gw_real_t margin = rig_controller.admittance.tip.margin_mps2;
        const gw_real_t before = rig_output.reference_twist.vx_mps;
        rig_ticks(20U);
        CHECK_NEAR((rig_output.reference_twist.vx_mps - before) / R(0.020), R(3.0) + margin, R(0.05));
        rig_push(GW_ZERO);
        rig_ticks(200U);
        CHECK(rig_output.reference_twist.vx_mps > GW_ZERO);
        CHECK(rig_controller.reference.acceleration.ax_mps2 <= (margin + ROUNDING));
        /* Hit from behind while it gives way: within the margin again, twice as much away from a wheel. */
        rig_push(R(-80.0));
        const uint32_t count = rig_output.detection_count;
        for (uint32_t i = 0U; (i < 2000U) && (rig_output.detection_count == count); i++) {
            rig_tick(GW_STATUS_OK);
        }
        CHECK(rig_output.detection_count == (count + 1U));
        const gw_real_t second = rig_output.reference_twist.vx_mps;
        rig_ticks(20U);
        CHECK(rig_output.reference_twist.vx_mps >= (second - (R(0.0201) * GW_TWO * margin)));
    }
}

/* The acceleration of an escape from rest, as soon as a push of 60 N is felt in full. */
static gw_real_t acceleration_of_an_escape(uint32_t detector, gw_real_t push_share)
{
    rig_set_up();
    rig_config.estimator.tare_ticks = 0U;
    rig_config.detector.kind = detector;
    if (detector == GW_DETECTOR_CHANNELS) {
        rig_config.estimator.acceleration_source = GW_SOURCE_MEASURED;
        rig_config.estimator.aligned = 1U;
    }
    rig_config.detector.force_threshold_n = R(10.0);
    rig_config.admittance.kind = GW_ADMITTANCE_ESCAPE;
    rig_config.admittance.tip.height_m = R(0.414);
    rig_config.admittance.push_share = push_share;
    rig_config.admittance.escape_impulse_newton_s *= R(5.0);
    rig_begin();
    rig_ticks(200U);
    rig_push(R(60.0));
    rig_until(GW_MODE_REACTING, 300U);
    rig_ticks(40U);
    return rig_controller.reference.acceleration.ax_mps2;
}

/* The channels know the force of a contact, and it accelerates the escape; the paper's detectors do not. */
static void a_push_accelerates_an_escape(void)
{
    for (uint32_t kind = 0U; kind <= GW_DETECTOR_CHANNELS; kind++) {
        const gw_real_t alone = acceleration_of_an_escape(kind, GW_ZERO);
        const gw_real_t pushed = acceleration_of_an_escape(kind, R(0.002));
        unit_row(kind);
        CHECK_NEAR(alone, rig_controller.admittance.tip.margin_mps2, R(0.001));
        if (kind == GW_DETECTOR_CHANNELS) {
            /* 60 N less 14 N in motion, over 0.1 kg. */
            CHECK_NEAR(pushed - alone, R(0.92), R(0.01));
        } else {
            CHECK_NEAR(pushed, alone, R(0.001));
        }
    }
}

/* The wheels stand: the reference does not run away from them, in any direction of the base. */
static void an_escape_waits_for_a_robot_that_is_held(void)
{
    static const gw_real_t yaw_rad[] = {R(0.0), R(2.0)};
    const gw_real_t ahead_mps = R(0.02);
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(yaw_rad); i++) {
        rig_set_up();
        rig_config.admittance.kind = GW_ADMITTANCE_ESCAPE;
        rig_config.admittance.ahead_mps = ahead_mps;
        rig_config.admittance.brake_limit_mps2 = R(4.5);
        rig_input.plan.pose.theta_rad = yaw_rad[i];
        rig_begin_with_a_push(R(60.0));
        rig_push(GW_ZERO);
        rig_ticks(60U);
        const gw_vector_t velocity = {rig_output.reference_twist.vx_mps, rig_output.reference_twist.vy_mps};
        /* It waits before it takes the tick's step. */
        const gw_real_t step_mps = rig_config.admittance.acceleration_limit_mps2 * rig_config.period_s;
        unit_row(i);
        CHECK_NEAR(gw_length(velocity), ahead_mps + step_mps, ROUNDING);
    }
}

/* In a reaction the commanded speeds are ahead of the reference by the configured time; on the path they are not. */
static void a_reaction_leads_the_servos(void)
{
    const gw_real_t lead_s = R(0.04);
    rig_set_up();
    rig_config.admittance.lead_s = lead_s;
    rig_begin_with_a_push(R(20.0));
    rig_ticks(3U);
    const gw_real_t ahead =
        rig_output.reference_twist.vx_mps + (lead_s * rig_controller.reference.acceleration.ax_mps2);
    const gw_real_t rolling = gw_along_rolling(rig_controller.estimator.kinematics.radial[1], ahead, GW_ZERO);
    CHECK(rig_controller.reference.acceleration.ax_mps2 > GW_ONE);
    CHECK_NEAR(rig_output.command.speed_radps[1], rolling / rig_config.geometry.wheel_radius_m, ROUNDING);
    rig_push(GW_ZERO);
    rig_until(GW_MODE_REJOINING, 20000U);
    rig_tick(GW_STATUS_OK);
    const gw_real_t back =
        gw_along_rolling(rig_controller.estimator.kinematics.radial[1], rig_output.reference_twist.vx_mps, GW_ZERO);
    CHECK(rig_controller.reference.acceleration.ax_mps2 < -GW_ONE);
    CHECK_NEAR(rig_output.command.speed_radps[1], back / rig_config.geometry.wheel_radius_m, ROUNDING);
}

static void a_second_push_on_the_way_is_a_hit_too(void)
{
    rig_set_up();
    rig_begin_with_a_push(R(20.0));
    rig_push(GW_ZERO);
    rig_ticks(400U);
    CHECK(rig_output.mode == GW_MODE_REACTING);
    rig_push(R(-200.0));
    rig_ticks(20U);
    CHECK((rig_output.mode == GW_MODE_REACTING) && (rig_output.detection_count == 2U));
}

static void settled_can_mean_to_stay(void)
{
    rig_set_up();
    rig_config.supervisor.after_settled = GW_AFTER_SETTLED_HOLD;
    rig_begin_with_a_push(R(20.0));
    rig_push(GW_ZERO);
    rig_until(GW_MODE_SETTLED, 20000U);
    rig_ticks(500U);
    CHECK(rig_output.mode == GW_MODE_SETTLED);
    rig_push(R(20.0));
    rig_until(GW_MODE_REACTING, 100U);
    CHECK(rig_output.detection_count == 2U);
}

/* The force of each tick, minus the detector's leak, moves the robot; back at rest it does not. */
static void live_force_yields_while_it_is_pushed(void)
{
    rig_set_up();
    rig_config.admittance.kind = GW_ADMITTANCE_LIVE_FORCE;
    rig_config.supervisor.after_settled = GW_AFTER_SETTLED_HOLD;
    rig_begin_with_a_push(R(20.0));
    /* Just hit: the push counts, although the robot creeps and the leak is 40 N then. */
    rig_ticks(3U);
    CHECK(rig_output.reference_twist.vx_mps > GW_ZERO);
    const gw_real_t early = rig_output.reference_twist.vx_mps;
    rig_push(R(100.0));
    rig_ticks(300U);
    CHECK(rig_output.reference_twist.vx_mps > early);
    rig_push(GW_ZERO);
    rig_until(GW_MODE_SETTLED, 20000U);
    rig_push(R(1.5)); /* too weak for a hit: a force felt at rest does not move it */
    rig_ticks(5U);
    CHECK(rig_output.mode == GW_MODE_SETTLED);
    CHECK(gw_abs(rig_output.reference_twist.vx_mps) < rig_config.supervisor.settled_speed_mps);
    const gw_real_t speed_mps = gw_abs(rig_output.reference_twist.vx_mps);
    rig_push(R(60.0)); /* above the leak, too short for a hit: only a running reaction responds to it */
    rig_ticks(4U);
    CHECK(rig_output.mode == GW_MODE_SETTLED);
    CHECK(gw_abs(rig_output.reference_twist.vx_mps) <= speed_mps);
}

/* An escape that reaches its end under a lasting push is not over: it counts as another hit. */
static void a_push_that_stays_keeps_it_from_settling(void)
{
    rig_set_up();
    rig_config.estimator.rest_ticks = 10000U; /* no new zero, which would include the push */
    rig_begin_with_a_push(R(50.0));
    for (uint32_t i = 0U; i < 5000U; i++) {
        rig_tick(GW_STATUS_OK);
        CHECK(rig_output.mode == GW_MODE_REACTING);
    }
    CHECK(rig_output.detection_count > 1U);
}

/* At the right place with the wrong yaw it is not back on its path yet. */
static void a_path_is_rejoined_in_yaw_too(void)
{
    rig_set_up();
    rig_begin_with_a_push(R(20.0));
    rig_push(GW_ZERO);
    rig_until(GW_MODE_REJOINING, 20000U);
    rig_input.plan.pose.x_m = rig_output.reference_pose.x_m;
    rig_input.plan.pose.y_m = rig_output.reference_pose.y_m;
    rig_input.plan.pose.theta_rad = R(0.2);
    rig_tick(GW_STATUS_OK);
    CHECK(rig_output.mode == GW_MODE_REJOINING);
    rig_until(GW_MODE_TRACKING, 5000U);
    CHECK_NEAR(rig_output.reference_pose.theta_rad, R(0.2), rig_config.supervisor.rejoin_angle_rad);
}

/* The reference brakes within its limits, and afterwards the path is rejoined. */
static void a_stop_request_stops_it(void)
{
    rig_set_up();
    rig_config.estimator.tare_ticks = 0U;
    rig_input.plan.twist.vx_mps = R(0.2);
    rig_begin();
    rig_tick(GW_STATUS_OK);
    rig_input.stop_request = true;
    rig_tick(GW_STATUS_OK);
    CHECK(rig_output.mode == GW_MODE_STOPPED);
    CHECK((rig_output.reference_twist.vx_mps > GW_ZERO) && rig_output.enable);
    rig_ticks(200U);
    CHECK_NEAR(rig_output.reference_twist.vx_mps, GW_ZERO, ROUNDING);
    rig_input.stop_request = false;
    rig_input.plan.twist.vx_mps = GW_ZERO;
    rig_tick(GW_STATUS_OK);
    CHECK(rig_output.mode == GW_MODE_REJOINING);
}

/* An interrupted escape is abandoned: its path may no longer be free. */
static void a_stopped_escape_is_not_resumed(void)
{
    rig_set_up();
    rig_begin_with_a_push(R(20.0));
    rig_push(GW_ZERO);
    rig_ticks(100U);
    rig_input.stop_request = true;
    rig_ticks(300U);
    const gw_real_t stopped_at = rig_output.reference_pose.x_m;
    rig_input.stop_request = false;
    rig_tick(GW_STATUS_OK);
    CHECK(rig_output.mode == GW_MODE_REACTING);
    rig_until(GW_MODE_SETTLED, 2000U);
    CHECK_NEAR(rig_output.reference_pose.x_m, stopped_at, R(0.001));
}

/* Asked for by a rising edge; granted at planned rest, in TRACKING and in SETTLED. */
static void a_tare_is_granted_to_a_robot_that_stands(void)
{
    rig_set_up();
    rig_begin();
    rig_until(GW_MODE_TRACKING, 10U);
    rig_input.tare_request = true;
    rig_tick(GW_STATUS_OK);
    CHECK(rig_output.mode == GW_MODE_TARING);
    rig_until(GW_MODE_TRACKING, 10U); /* no new edge, no new tare */
    rig_ticks(10U);
    CHECK(rig_output.mode == GW_MODE_TRACKING);
    rig_input.tare_request = false;
    rig_input.plan.twist.vx_mps = R(0.2);
    for (uint32_t i = 0U; i < 50U; i++) {
        rig_input.plan.pose.x_m += R(0.0002);
        rig_tick(GW_STATUS_OK);
    }
    rig_input.tare_request = true;
    rig_input.plan.pose.x_m += R(0.0002);
    rig_tick(GW_STATUS_TARE_REFUSED);
    CHECK(rig_output.mode == GW_MODE_TRACKING);
}

static void a_new_tare_ends_what_was_detected(void)
{
    rig_set_up();
    rig_begin();
    rig_until(GW_MODE_TRACKING, 10U);
    rig_ticks(20U);
    rig_controller.detector.active = true; /* tripped just now */
    rig_input.tare_request = true;
    rig_tick(GW_STATUS_OK);
    CHECK((rig_output.mode == GW_MODE_TARING) && (!rig_output.detection_active));
}

static void a_request_in_the_first_tick_is_an_edge(void)
{
    rig_set_up();
    rig_begin();
    rig_input.tare_request = true;
    rig_tick(GW_STATUS_TARE_REFUSED);
}

/* The speed of a turning robot is measured at its wheels: 0.02 rad/s are 4 mm/s there. */
static void turning_counts_as_moving_at_the_rim(void)
{
    const struct {
        gw_real_t omega;
        gw_mode_t mode;
    } rows[] = {{R(0.004), GW_MODE_SETTLED}, {R(0.02), GW_MODE_SETTLED}, {R(0.03), GW_MODE_REACTING}};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        rig_set_up();
        rig_config.geometry.wheel_distance_m = R(0.2);
        rig_begin();
        rig_until(GW_MODE_TRACKING, 10U);
        rig_ticks(20U);
        rig_controller.supervisor.mode = GW_MODE_REACTING;
        rig_controller.supervisor.quiet_ticks = rig_config.supervisor.settled_ticks - 1U;
        rig_controller.reference.twist.omega_radps = rows[i].omega;
        unit_row(i);
        rig_tick(GW_STATUS_OK);
        CHECK_STATUS(rig_output.mode, rows[i].mode);
    }
}

static void a_tare_is_granted_in_settled_and_refused_in_between(void)
{
    rig_set_up();
    rig_config.supervisor.after_settled = GW_AFTER_SETTLED_HOLD;
    rig_config.supervisor.settled_ticks = 200U;
    rig_begin_with_a_push(R(20.0));
    rig_push(GW_ZERO);
    rig_ticks(50U);
    while ((!rig_controller.estimator.rest) && (rig_output.tick < 20000U)) {
        rig_tick(GW_STATUS_OK);
    }
    CHECK(rig_output.mode == GW_MODE_REACTING);
    rig_input.tare_request = true;
    rig_tick(GW_STATUS_TARE_REFUSED); /* at rest, but a reaction is not over yet */
    rig_input.tare_request = false;
    rig_until(GW_MODE_SETTLED, 20000U);
    rig_input.tare_request = true;
    rig_tick(GW_STATUS_OK);
    CHECK(rig_output.mode == GW_MODE_TARING);
    rig_until(GW_MODE_SETTLED, 20U);
}

static void a_push_while_taring_spoils_the_tare(void)
{
    rig_set_up();
    rig_begin();
    rig_tick(GW_STATUS_OK);
    rig_push(R(30.0));
    rig_tick(GW_STATUS_TARE_REFUSED);
    CHECK(rig_output.mode == GW_MODE_TARING);
    /* A stop request does not count as a sample. */
    rig_input.stop_request = true;
    rig_tick(GW_STATUS_OK);
    CHECK(rig_output.mode == GW_MODE_STOPPED);
    rig_input.stop_request = false;
    rig_tick(GW_STATUS_OK);
    CHECK(rig_output.mode == GW_MODE_TARING);
    rig_until(GW_MODE_TRACKING, 10U);
}

/* Monitoring only: the drives are never enabled, the command equals the wheels' position, hits are still reported. */
static void without_drives_it_only_watches(void)
{
    rig_set_up();
    rig_config.drives_enabled = false;
    rig_config.estimator.tare_ticks = 0U;
    rig_input.plan.twist.vx_mps = R(0.2);
    rig_begin();
    rig_tick(GW_STATUS_OK);
    CHECK((!rig_output.enable) && (rig_output.mode == GW_MODE_TRACKING));
    CHECK(rig_output.reference_twist.vx_mps == GW_ZERO);
    rig_input.sensor.encoder_count[0] = 100;
    rig_tick(GW_STATUS_OK);
    CHECK_NEAR(rig_output.command.angle_rad[0], R(100.0) * rig_controller.estimator.rate_constants.rad_per_count,
               ROUNDING);
    rig_push(R(300.0));
    rig_until(GW_MODE_REACTING, 60U);
    CHECK((rig_output.detection_count == 1U) && (!rig_output.enable));
    CHECK((rig_output.reference_twist.vx_mps == GW_ZERO) && (rig_output.command.speed_radps[0] == GW_ZERO));
}

static void counters_start_anew_after_24_days(void)
{
    rig_set_up();
    rig_begin();
    rig_until(GW_MODE_TRACKING, 10U);
    rig_controller.tick = GW_TICK_MASK;
    rig_controller.supervisor.path_ticks = GW_TICK_MASK;
    rig_controller.detection_count = GW_TICK_MASK;
    CHECK(gw_controller_invariant_holds(&rig_controller));
    rig_push(R(200.0));
    rig_tick(GW_STATUS_OK);
    CHECK((rig_output.tick == GW_TICK_MASK) && (rig_output.path_ticks == 0U));
    rig_tick(GW_STATUS_OK);
    CHECK(rig_output.tick == 0U);
    rig_until(GW_MODE_REACTING, 20U);
    CHECK(rig_output.detection_count == 0U);
}

/* Copied in the middle of a reaction: the copy continues like the original. */
static void a_copy_is_a_checkpoint(void)
{
    rig_set_up();
    rig_begin();
    rig_until(GW_MODE_TRACKING, 10U);
    rig_push(R(200.0));
    rig_until(GW_MODE_REACTING, 20U);
    gw_controller_t copy = rig_controller;
    for (uint32_t tick = 0U; tick < 100U; tick++) {
        gw_controller_output_t again;
        rig_push((gw_real_t)(tick % 9U));
        rig_tick(GW_STATUS_OK);
        unit_row(tick);
        CHECK_STATUS(gw_controller_step(&copy, &rig_input, &again), GW_STATUS_OK);
        CHECK((again.mode == rig_output.mode) && (again.estimate.force_x_n == rig_output.estimate.force_x_n));
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            CHECK(again.command.angle_rad[i] == rig_output.command.angle_rad[i]);
            CHECK(again.command.speed_radps[i] == rig_output.command.speed_radps[i]);
        }
    }
}

void suite_controller(void)
{
    unit_run("a_copy_is_a_checkpoint", a_copy_is_a_checkpoint);
    unit_run("bad_arguments_are_refused", bad_arguments_are_refused);
    unit_run("it_tares_and_then_follows_its_plan", it_tares_and_then_follows_its_plan);
    unit_run("without_a_tare_it_starts_at_the_plan_s_speed", without_a_tare_it_starts_at_the_plan_s_speed);
    unit_run("it_gives_way_to_a_push_and_comes_back", it_gives_way_to_a_push_and_comes_back);
    unit_run("an_escape_brakes_as_long_as_it_is_pushed", an_escape_brakes_as_long_as_it_is_pushed);
    unit_run("a_push_accelerates_an_escape", a_push_accelerates_an_escape);
    unit_run("an_escape_waits_for_a_robot_that_is_held", an_escape_waits_for_a_robot_that_is_held);
    unit_run("a_reaction_leads_the_servos", a_reaction_leads_the_servos);
    unit_run("a_second_push_on_the_way_is_a_hit_too", a_second_push_on_the_way_is_a_hit_too);
    unit_run("settled_can_mean_to_stay", settled_can_mean_to_stay);
    unit_run("live_force_yields_while_it_is_pushed", live_force_yields_while_it_is_pushed);
    unit_run("a_push_that_stays_keeps_it_from_settling", a_push_that_stays_keeps_it_from_settling);
    unit_run("a_path_is_rejoined_in_yaw_too", a_path_is_rejoined_in_yaw_too);
    unit_run("a_stop_request_stops_it", a_stop_request_stops_it);
    unit_run("a_stopped_escape_is_not_resumed", a_stopped_escape_is_not_resumed);
    unit_run("a_tare_is_granted_to_a_robot_that_stands", a_tare_is_granted_to_a_robot_that_stands);
    unit_run("a_new_tare_ends_what_was_detected", a_new_tare_ends_what_was_detected);
    unit_run("a_request_in_the_first_tick_is_an_edge", a_request_in_the_first_tick_is_an_edge);
    unit_run("turning_counts_as_moving_at_the_rim", turning_counts_as_moving_at_the_rim);
    unit_run("a_tare_is_granted_in_settled_and_refused_in_between",
             a_tare_is_granted_in_settled_and_refused_in_between);
    unit_run("a_push_while_taring_spoils_the_tare", a_push_while_taring_spoils_the_tare);
    unit_run("without_drives_it_only_watches", without_drives_it_only_watches);
    unit_run("counters_start_anew_after_24_days", counters_start_anew_after_24_days);
}
