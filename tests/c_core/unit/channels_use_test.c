/* What the controller does with the two channels; the channels themselves are in channels_test.c. */
#include "rig.h"

static void rig_with_channels(void)
{
    rig_set_up();
    rig_config.detector.kind = GW_DETECTOR_CHANNELS;
    rig_config.estimator.velocity_source = GW_SOURCE_MEASURED;
    rig_config.estimator.acceleration_source = GW_SOURCE_MEASURED;
    rig_config.estimator.aligned = 1U;
}

/* Tracking, and the channels are warm. */
static void begin_tracking(void)
{
    rig_begin();
    rig_until(GW_MODE_TRACKING, 10U);
    rig_ticks(100U);
    CHECK((rig_output.mode == GW_MODE_TRACKING) && (rig_output.detection_count == 0U));
    CHECK((rig_output.detection_channel == GW_CHANNEL_NONE) && (!rig_output.contact.valid));
}

/* 60 N from rest: hit, located and refined while it lasts, gives way along it, settles, goes back and tracks again. */
static void it_gives_way_to_a_hit_and_comes_back(void)
{
    rig_with_channels();
    begin_tracking();
    rig_push(R(60.0));
    rig_until(GW_MODE_REACTING, 30U);
    CHECK((rig_output.detection_count == 1U) && rig_output.detection_active);
    CHECK((rig_output.detection_channel == GW_CHANNEL_FAST) && (rig_output.detection_statistic > GW_ONE));
    CHECK(rig_output.detection_tick == (int32_t)rig_output.tick);
    const gw_real_t first_n = rig_output.detection_wrench.force_x_n;
    rig_ticks(59U);
    CHECK(rig_output.detection_wrench.force_x_n > first_n);
    /* A mean over 60 ms and more, too small by no more than what the alignment delays by, 2/w, and the low-pass of 6
     * ms, before the trip and after it. */
    const gw_real_t late = ((GW_TWO / rig_config.estimator.rate_cutoff_radps) + (GW_TWO * R(0.006))) / R(0.060);
    CHECK(gw_in_range(rig_output.detection_wrench.force_x_n, R(60.0) * (GW_ONE - late), R(60.0)));
    CHECK_NEAR(rig_output.detection_wrench.force_y_n, GW_ZERO, R(60.0) * R(10.0) * ROUNDING);
    CHECK(rig_output.contact.valid && (rig_output.contact.force_n == rig_output.detection_contact.force_n));
    CHECK_NEAR(rig_output.detection_contact.direction_rad, GW_ZERO, R(100.0) * ROUNDING);
    rig_ticks(6U); /* refined no longer: the contact is that of the estimate, every fourth tick */
    CHECK(rig_output.detection_active && rig_output.contact.valid);
    CHECK_NEAR(rig_output.contact.force_n, R(60.0), R(0.01));
    while ((rig_output.mode == GW_MODE_REACTING) && (rig_output.tick < 20000U)) {
        rig_push(GW_ZERO);
        rig_tick(GW_STATUS_OK);
        CHECK(rig_output.reference_twist.vx_mps >= -ROUNDING); /* never towards the push */
    }
    CHECK(rig_output.reference_pose.x_m > R(0.05));
    rig_until(GW_MODE_TRACKING, 20000U);
    CHECK(gw_abs(rig_output.reference_pose.x_m) < R(0.0003));
    CHECK((rig_output.detection_count == 1U) && (!rig_output.detection_active) && (!rig_output.contact.valid));
}

/* What was felt first was only a part of it: the escape turns with the mean wrench while that becomes better. */
static void the_escape_turns_with_what_is_felt(void)
{
    rig_with_channels();
    begin_tracking();
    rig_push(R(60.0));
    rig_until(GW_MODE_REACTING, 30U);
    const gw_wrench_t first = rig_output.detection_wrench;
    CHECK(gw_abs(first.force_y_n) < (R(0.01) * first.force_x_n));
    rig_input.sensor.torque_nm[0] = R(3.0); /* and from the side */
    rig_ticks(60U);
    CHECK(gw_abs(rig_output.detection_wrench.force_y_n) > (R(0.3) * rig_output.detection_wrench.force_x_n));
    rig_ticks(200U);
    const gw_twist_t twist = rig_output.reference_twist;
    CHECK_STATUS(rig_output.mode, GW_MODE_REACTING);
    CHECK_NEAR(twist.vy_mps * rig_output.detection_wrench.force_x_n,
               twist.vx_mps * rig_output.detection_wrench.force_y_n,
               R(0.05) * gw_abs(twist.vx_mps * rig_output.detection_wrench.force_y_n));
    CHECK(gw_abs(twist.vx_mps) > R(0.01));
}

/* With encoders alone. */
static void rig_that_may_lean(void)
{
    rig_with_channels();
    rig_config.channels.rocking = R(0.3);
    rig_config.admittance.kind = GW_ADMITTANCE_ESCAPE;
    rig_config.admittance.tip.height_m = R(0.4);
}

/* Hit along x, and as soon as it waits from the side, too. */
static void begin_to_wait(void)
{
    begin_tracking();
    rig_push(R(60.0));
    rig_until(GW_MODE_REACTING, 30U);
    CHECK(rig_controller.waits && (!rig_controller.may_press) && (!rig_controller.may_be_pushed));
    rig_input.sensor.torque_nm[0] = R(3.0);
}

/* It knows in the tenth tick where to go to, or, if the contact is over before, in that tick. */
static void an_escape_waits_for_its_direction(void)
{
    for (uint32_t i = 0U; i < 2U; i++) {
        uint32_t waited = 0U;
        rig_that_may_lean();
        rig_config.channels.rearm_ticks = (i == 0U) ? 1000U : 5U;
        begin_to_wait();
        do {
            CHECK((rig_output.reference_twist.vx_mps == GW_ZERO) && (rig_output.reference_twist.vy_mps == GW_ZERO));
            rig_tick(GW_STATUS_OK);
            waited++;
        } while (rig_controller.waits && (waited < 20U));
        unit_row(i);
        CHECK((i == 0U) ? (waited == 10U) : (waited < 10U));
        CHECK((!rig_controller.waits) && rig_controller.may_be_pushed && (!rig_controller.may_press));
        CHECK(rig_output.detection_active == (i == 0U));
        CHECK(gw_abs(rig_controller.contact_found.push_n.y) > R(0.3));
        CHECK_NEAR(rig_controller.admittance.away.y * rig_controller.contact_found.push_n.x,
                   rig_controller.admittance.away.x * rig_controller.contact_found.push_n.y,
                   gw_abs(rig_controller.contact_found.push_n.y) * R(10.0) * ROUNDING);
        rig_tick(GW_STATUS_OK);
        CHECK((rig_output.reference_twist.vx_mps > GW_ZERO) == (i == 0U)); /* armed again, it feels more of the same */
    }
}

/* After a fault the space may no longer be free: it does not go where it would have gone. */
static void a_wait_ends_with_a_fault(void)
{
    rig_that_may_lean();
    begin_to_wait();
    rig_input.sensor.present = false;
    rig_tick(GW_STATUS_SENSOR_MISSING);
    CHECK((rig_output.mode == GW_MODE_FAULT) && (!rig_controller.waits));
    rig_input.sensor.present = true;
    for (uint32_t k = 0U; k < rig_config.sensor_check.recover_ticks; k++) {
        rig_tick(GW_STATUS_SENSOR_RECOVERING);
    }
    for (uint32_t k = 0U; k < 100U; k++) {
        rig_tick(GW_STATUS_OK);
        CHECK((rig_output.mode == GW_MODE_REACTING) && (!rig_controller.waits));
        CHECK((rig_output.reference_twist.vx_mps == GW_ZERO) && (rig_output.reference_twist.vy_mps == GW_ZERO));
    }
}

/* Growing by 10 N/s: too slow for the one channel, the other one notices it. */
static void a_slow_push_is_noticed_at_rest(void)
{
    rig_with_channels();
    rig_config.estimator.rest_ticks = 10000U; /* no new zero, which would include the push */
    begin_tracking();
    for (uint32_t i = 0U; (i < 2000U) && (rig_output.mode == GW_MODE_TRACKING); i++) {
        rig_push(R(0.01) * (gw_real_t)i);
        rig_tick(GW_STATUS_OK);
    }
    CHECK((rig_output.mode == GW_MODE_REACTING) && (rig_output.detection_channel == GW_CHANNEL_SLOW));
    CHECK((rig_output.detection_count == 1U) && (rig_output.detection_wrench.force_x_n > R(3.0)));
}

/* The reaction follows the force above the slow channel's floor. */
static void live_force_yields_while_it_is_pushed(void)
{
    rig_with_channels();
    rig_config.admittance.kind = GW_ADMITTANCE_LIVE_FORCE;
    begin_tracking();
    rig_push(R(20.0));
    rig_until(GW_MODE_REACTING, 200U);
    rig_ticks(250U);
    const gw_real_t early = rig_output.reference_twist.vx_mps;
    CHECK(early > R(0.1));
    rig_push(GW_ZERO);
    rig_until(GW_MODE_REJOINING, 20000U);
}

/* Only a robot whose height is known may lean, and rocks. */
static void a_robot_without_height_stands_firm(void)
{
    for (uint32_t i = 0U; i < 2U; i++) {
        rig_with_channels();
        rig_config.channels.rocking = GW_HALF;
        rig_config.admittance.tip.height_m = (i == 0U) ? GW_ZERO : R(0.4);
        rig_begin();
        unit_row(i);
        CHECK(rig_controller.channels.rocking2 == ((i == 0U) ? GW_ZERO : R(0.25)));
    }
}

/* In a fault nothing is looked for. A contact that lasted before it goes on until its end, which is no hit from the
 * other side; without one the channels begin anew. */
static void a_fault_in_a_contact_does_not_end_it(void)
{
    for (uint32_t i = 0U; i < 2U; i++) {
        const bool hit = (i == 0U);
        rig_with_channels();
        begin_tracking();
        rig_push(hit ? R(60.0) : GW_ZERO);
        if (hit) {
            rig_until(GW_MODE_REACTING, 30U);
        }
        rig_input.sensor.present = false;
        rig_tick(GW_STATUS_SENSOR_MISSING);
        CHECK((rig_output.mode == GW_MODE_FAULT) && (!rig_output.detection_active) && (!rig_output.contact.valid));
        rig_input.sensor.present = true;
        for (uint32_t k = 0U; k < rig_config.sensor_check.recover_ticks; k++) {
            rig_tick(GW_STATUS_SENSOR_RECOVERING);
        }
        rig_ticks(2U);
        unit_row(i);
        CHECK((rig_controller.channels.warm_up_ticks < 5U) == (!hit));
        CHECK(rig_output.detection_active == hit);
        rig_push(GW_ZERO);
        rig_ticks(400U);
        CHECK((!rig_output.detection_active) && (rig_output.detection_count == (hit ? 1U : 0U)));
    }
}

/* Stopped in a reaction, which goes on afterwards: what touched before is asked anew. */
static void a_stop_in_a_contact_forgets_it(void)
{
    rig_with_channels();
    begin_tracking();
    rig_push(R(60.0));
    rig_until(GW_MODE_REACTING, 30U);
    rig_input.stop_request = true;
    rig_ticks(5U);
    CHECK((rig_output.mode == GW_MODE_STOPPED) && (!rig_output.detection_active));
    CHECK(rig_controller.channels.active); /* they have stood still since */
    rig_input.stop_request = false;
    rig_tick(GW_STATUS_OK);
    CHECK((rig_output.mode == GW_MODE_REACTING) && (!rig_output.detection_active));
    CHECK(rig_controller.channels.warm_up_ticks == 0U);
}

/* A force below the thresholds is estimated, but it is no contact. */
static void a_force_that_is_no_contact_is_not_located(void)
{
    rig_with_channels();
    rig_config.channels.fast.rest_n = R(1000.0);
    rig_config.channels.slow.rest_n = R(1000.0);
    begin_tracking();
    rig_push(R(60.0));
    rig_ticks(100U);
    CHECK_NEAR(rig_output.estimate.force_x_n, R(60.0), R(0.01));
    CHECK((!rig_output.detection_active) && (!rig_output.contact.valid) && (rig_output.contact.force_n == GW_ZERO));
}

/* The robot gives way all the time, and it is one hit. */
static void push_for_longer_than_rearm_ticks(void)
{
    rig_with_channels();
    rig_config.estimator.rest_ticks = 10000U;
    rig_config.supervisor.settled_ticks = 1000U;
    begin_tracking();
    rig_push(R(60.0));
    rig_until(GW_MODE_REACTING, 30U);
    rig_ticks(1100U);
    CHECK((rig_output.mode == GW_MODE_REACTING) && (rig_output.detection_count == 1U));
}

/* The push is armed against anew, and still it is no second hit. */
static void a_push_that_lasts_is_one_hit_of_a_reaction(void)
{
    push_for_longer_than_rearm_ticks();
    CHECK((!rig_output.detection_active) && (rig_controller.channels.slow.statistic > GW_ONE));
}

/* After rearm_ticks the end of a push is noticed, if nothing forgives it. The reaction goes on, and a push from the
 * side turns it, but never towards the first one. */
static void the_end_of_a_push_that_lasted_turns_nothing(void)
{
    for (uint32_t i = 0U; i < 3U; i++) {
        push_for_longer_than_rearm_ticks();
        CHECK(rig_controller.channels.fast.carried_n.x > R(50.0));
        rig_controller.channels.fast.held.force_x_n = R(1.0);
        if (i == 2U) {
            rig_controller.channels.fast.carried_n.x = R(22.0); /* what is felt of the end when it is noticed */
        }
        const gw_vector_t goal_m = rig_controller.admittance.goal_m;
        rig_push(GW_ZERO);
        rig_input.sensor.torque_nm[0] = (i == 1U) ? R(6.0) : GW_ZERO;
        while ((rig_output.detection_count == 1U) && (rig_output.tick < 20000U)) {
            rig_tick(GW_STATUS_OK);
        }
        rig_ticks((i == 2U) ? 0U : 60U);
        unit_row(i);
        CHECK((rig_output.mode == GW_MODE_REACTING) && (rig_output.detection_count == 2U));
        const gw_vector_t after_m = rig_controller.admittance.goal_m;
        if (i != 1U) {
            CHECK((after_m.x == goal_m.x) && (after_m.y == goal_m.y));
        } else {
            CHECK((after_m.x >= -ROUNDING) && (gw_abs(after_m.y) > gw_abs(after_m.x)));
        }
    }
}

/* The preset of the paper's robot knows its motors, the paper's configuration does not. */
static void the_default_preset_observes_its_motors(void)
{
    static gw_controller_config_t preset;
    gw_motor_config_t expected;
    gw_motor_config_trikey(&expected);
    gw_controller_config_trikey(&preset);
    CHECK((preset.estimator.motor.inertia_kgm2 == expected.inertia_kgm2) && (expected.inertia_kgm2 > GW_ZERO));
    CHECK(preset.estimator.motor.delay_ticks == expected.delay_ticks);
    gw_controller_config_paper(&preset);
    CHECK(preset.estimator.motor.inertia_kgm2 == GW_ZERO);
}

/* Observed motors make the noise of wheels that turn smaller; what counts add is that of counts without it. */
static void motors_that_are_known_are_observed(void)
{
    for (uint32_t i = 0U; i < 2U; i++) {
        rig_with_channels();
        rig_config.estimator.motor.inertia_kgm2 = (i == 0U) ? GW_ZERO : R(0.05);
        rig_begin();
        const gw_fast_channel_t *const fast = &rig_controller.channels.fast;
        const gw_channels_noise_t noise = {
            rig_config.period_s,
            rig_config.estimator.rate_cutoff_radps,
            rig_controller.estimator.rate_constants.rad_per_count * rig_config.geometry.wheel_radius_m,
            rig_controller.estimator.rate_constants.rad_per_count * rig_config.geometry.wheel_radius_m /
                ((i == 0U) ? GW_ONE : GW_MOTOR_FINER),
            (rig_config.estimator.torque_noise_nm * rig_controller.estimator.rate_constants.compliance_rad_per_nm) *
                rig_config.geometry.wheel_radius_m,
            rig_controller.estimator.sigma.force_n,
            rig_config.friction.coulomb_torque_nm * rig_controller.estimator.kinematics.per_roller_radius,
            rig_controller.estimator.nominal.total_mass_kg,
            rig_controller.estimator.nominal.total_yaw_inertia_kgm2,
            rig_config.geometry.wheel_distance_m,
            gw_imu_noise(&rig_controller.imu)};
        static gw_fast_channel_t expected;
        gw_fast_channel_init(&expected, &rig_config.channels, &noise);
        for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
            unit_row((10U * i) + j);
            CHECK_NEAR(fast->count_n2[j], expected.count_n2[j], expected.count_n2[j] * R(10.0) * ROUNDING);
            CHECK_NEAR(fast->least_noise_n2[GW_BY_ENCODERS][GW_REGIME_MOTION][j],
                       expected.least_noise_n2[GW_BY_ENCODERS][GW_REGIME_MOTION][j],
                       expected.least_noise_n2[GW_BY_ENCODERS][GW_REGIME_MOTION][j] * R(10.0) * ROUNDING);
        }
        rig_until(GW_MODE_TRACKING, 10U);
        rig_ticks(100U);
        /* It stands: nothing is known between its counts. */
        unit_row(i);
        CHECK(rig_controller.estimate.counted == ((i == 0U) ? GW_ZERO : GW_ONE));
        CHECK(fast->counted == rig_controller.estimate.counted);
    }
}

/* What is sent in a tick is what the motors are told to follow, unless the drives are not enabled. */
static void the_motors_are_told_what_is_sent(void)
{
    for (uint32_t i = 0U; i < 2U; i++) {
        rig_with_channels();
        gw_motor_config_trikey(&rig_config.estimator.motor);
        rig_config.drives_enabled = (i == 0U);
        rig_input.plan.twist.vx_mps = R(0.1);
        rig_begin();
        const gw_motor_t *const motor = &rig_controller.estimator.motor;
        for (uint32_t tick = 1U; tick <= 30U; tick++) {
            const uint32_t at = motor->next_command;
            rig_tick(GW_STATUS_OK);
            unit_row((100U * i) + tick);
            CHECK(motor->commands == ((i == 1U) ? 0U : ((tick < GW_MOTOR_DELAY_MAX) ? tick : GW_MOTOR_DELAY_MAX)));
            for (uint32_t k = 0U; (k < GW_WHEEL_COUNT) && (i == 0U); k++) {
                CHECK(motor->command[at].angle_rad[k] == rig_output.command.angle_rad[k]);
                CHECK(motor->command[at].speed_radps[k] == rig_output.command.speed_radps[k]);
            }
        }
        CHECK((i == 1U) || (gw_abs(rig_output.command.speed_radps[1]) > GW_ZERO));
    }
}

static void the_invariant_sees_the_channels(void)
{
    rig_with_channels();
    begin_tracking();
    rig_controller.channels.channel = GW_CHANNEL_SLOW + 1U;
    CHECK(!gw_controller_invariant_holds(&rig_controller));
    rig_controller.channels.channel = GW_CHANNEL_NONE;
    CHECK(gw_controller_invariant_holds(&rig_controller));
}

void suite_channels_use(void)
{
    unit_run("it_gives_way_to_a_hit_and_comes_back", it_gives_way_to_a_hit_and_comes_back);
    unit_run("the_escape_turns_with_what_is_felt", the_escape_turns_with_what_is_felt);
    unit_run("an_escape_waits_for_its_direction", an_escape_waits_for_its_direction);
    unit_run("a_wait_ends_with_a_fault", a_wait_ends_with_a_fault);
    unit_run("a_slow_push_is_noticed_at_rest", a_slow_push_is_noticed_at_rest);
    unit_run("live_force_yields_while_it_is_pushed", live_force_yields_while_it_is_pushed);
    unit_run("a_robot_without_height_stands_firm", a_robot_without_height_stands_firm);
    unit_run("a_fault_in_a_contact_does_not_end_it", a_fault_in_a_contact_does_not_end_it);
    unit_run("a_stop_in_a_contact_forgets_it", a_stop_in_a_contact_forgets_it);
    unit_run("a_force_that_is_no_contact_is_not_located", a_force_that_is_no_contact_is_not_located);
    unit_run("a_push_that_lasts_is_one_hit_of_a_reaction", a_push_that_lasts_is_one_hit_of_a_reaction);
    unit_run("the_end_of_a_push_that_lasted_turns_nothing", the_end_of_a_push_that_lasted_turns_nothing);
    unit_run("the_default_preset_observes_its_motors", the_default_preset_observes_its_motors);
    unit_run("motors_that_are_known_are_observed", motors_that_are_known_are_observed);
    unit_run("the_motors_are_told_what_is_sent", the_motors_are_told_what_is_sent);
    unit_run("the_invariant_sees_the_channels", the_invariant_sees_the_channels);
}
