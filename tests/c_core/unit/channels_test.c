/* Both channels together, on balances of forces that are given; the channels themselves are in fast_channel_test.c and
 * slow_channel_test.c. */
#include "usual_noise.h"

#define WARM_UP 60U

static gw_channels_t channels;
static gw_channels_config_t config;
static gw_kinematics_t kinematics;
static gw_channels_input_t input;
static gw_twist_t twist;
static gw_channels_output_t output;
static gw_wrench_t wrench;
static gw_model_forces_t forces;
static gw_wrench_t zero_step;
static gw_wheels_t torque_nm;
static uint32_t trips;

/* Finer torque sensors: at rest the thresholds are little more than their floors. */
static gw_channels_noise_t fine_noise(void)
{
    gw_channels_noise_t noise = usual;
    noise.twist_noise_m = R(0.000001);
    return noise;
}

/* At rest, with nothing that touches. The configuration may be changed before. */
static void begin_with_config(void)
{
    static const gw_wrench_t nothing;
    static const gw_model_forces_t no_forces;
    static const gw_wheels_t no_torque;
    static const gw_twist_t no_twist;
    static const gw_channels_input_t no_input;
    static const gw_channels_output_t no_output;
    const gw_channels_noise_t noise = fine_noise();
    gw_geometry_config_t geometry;
    gw_geometry_config_trikey(&geometry);
    CHECK_STATUS(gw_kinematics_init(&kinematics, &geometry), GW_STATUS_OK);
    gw_channels_init(&channels, &config, &noise);
    CHECK(gw_channels_invariant_holds(&channels));
    wrench = nothing;
    forces = no_forces;
    zero_step = nothing;
    torque_nm = no_torque;
    twist = no_twist;
    input = no_input;
    output = no_output;
    input.wrench = &wrench;
    input.forces = &forces;
    input.zero_step = &zero_step;
    input.twist = &twist;
    input.torque_nm = &torque_nm;
    input.regime = GW_REGIME_REST;
    input.enabled = true;
    trips = 0U;
}

static void tick(void)
{
    gw_channels_step(&channels, &kinematics, &input, &output);
    CHECK(gw_channels_invariant_holds(&channels));
    CHECK(gw_in_range(output.statistic, GW_ZERO, R(1500.0)));
    CHECK((!output.tripped) || (output.active && output.refining && output.refined && (output.statistic > GW_ONE)));
    trips += output.tripped ? 1U : 0U;
}

static void ticks(uint32_t count)
{
    for (uint32_t i = 0U; i < count; i++) {
        tick();
    }
}

/* Warm, at rest. */
static void begin(void)
{
    gw_channels_config_trikey(&config);
    begin_with_config();
    ticks(WARM_UP);
}

/* Warm, and long enough in motion to have settled; the rollers slide. */
static void begin_in_motion(void)
{
    gw_channels_config_trikey(&config);
    begin_with_config();
    input.regime = GW_REGIME_MOTION;
    input.turned = true;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        forces.friction_n.wheel[i] = SLIDING;
    }
    ticks(WARM_UP + 600U);
    CHECK((trips == 0U) && (!output.active));
}

/* Ticks until a trip, at most so many. */
static uint32_t ticks_to_trip(uint32_t most)
{
    const uint32_t before = trips;
    uint32_t count = 0U;
    while ((trips == before) && (count < most)) {
        tick();
        count++;
    }
    return count;
}

/* Ticks until the contact is over, at most so many. */
static uint32_t ticks_to_release(uint32_t most)
{
    uint32_t count = 0U;
    while (output.active && (count < most)) {
        tick();
        count++;
    }
    return count;
}

static void warm_up_detects_nothing(void)
{
    gw_channels_config_trikey(&config);
    begin_with_config();
    wrench.force_x_n = R(1000.0);
    for (uint32_t i = 0U; i < WARM_UP; i++) {
        tick();
        CHECK((!output.tripped) && (!output.active) && (output.statistic == GW_ZERO));
    }
    /* The mean of 60 samples and of the zero before. */
    CHECK_NEAR(channels.fast.baseline.residual.force_x_n, R(60000.0) / R(61.0), R(1.0e4) * ROUNDING);
    CHECK(channels.fast.baseline.residual.force_x_n == channels.slow.mean.residual.force_x_n);
    wrench.force_x_n += R(50.0);
    CHECK(ticks_to_trip(20U) < 20U);
}

static void a_step_of_force_trips_the_fast_channel(void)
{
    for (uint32_t i = 0U; i < 8U; i++) {
        const gw_rotation_t along = gw_sincos((GW_PI / R(4.0)) * (gw_real_t)i);
        begin();
        wrench.force_x_n = R(50.0) * along.cosine;
        wrench.force_y_n = R(50.0) * along.sine;
        unit_row(i);
        CHECK(ticks_to_trip(20U) < 20U);
        CHECK((output.channel == GW_CHANNEL_FAST) && output.active && (output.statistic > GW_ONE));
        CHECK(channels.slow.statistic < GW_ONE);
    }
}

/* 5 N/s: the change from a baseline of 0.3 s is 1.5 N, half of the floor. The slow channel trips beyond its floor of
 * 4 N, at 0.8 s and the 0.05 s of its low-pass, and what it gives is what it felt. */
static void a_slow_push_trips_the_slow_channel_only(void)
{
    gw_real_t fast = GW_ZERO;
    uint32_t count = 0U;
    begin();
    while ((trips == 0U) && (count < 2000U)) {
        wrench.force_y_n = R(-0.005) * (gw_real_t)count;
        wrench.torque_nm = R(0.0001) * (gw_real_t)count;
        fast = gw_max(fast, gw_length((gw_vector_t){channels.fast.bank[3].force_x_n, channels.fast.bank[3].force_y_n}));
        tick();
        count++;
    }
    CHECK((count > 848U) && (count < 860U));
    CHECK((output.channel == GW_CHANNEL_SLOW) && output.active);
    CHECK_NEAR(fast, R(1.5), R(0.15));
    CHECK_NEAR(output.mean_wrench.force_y_n, R(-4.0), R(0.03));
    CHECK(output.mean_wrench.force_x_n == GW_ZERO);
    CHECK_NEAR(output.mean_wrench.torque_nm, R(0.08), R(0.001));
    CHECK_NEAR(channels.impulse_s, config.slow_s, ROUNDING); /* for which the low-pass has felt it */
}

/* In motion: 10 N that come and go within ten seconds (the slow channel's floor is 14 N), 20 N within forty (its
 * baseline follows in 3 s). */
static void friction_that_is_wrong_slowly_does_not_trip(void)
{
    const gw_real_t amplitudes[] = {R(10.0), R(20.0)};
    const gw_real_t periods_s[] = {R(10.0), R(40.0)};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(amplitudes); i++) {
        begin_in_motion();
        for (uint32_t k = 0U; k < 20000U; k++) {
            const gw_rotation_t phase = gw_sincos(((GW_TWO * GW_PI) * (PERIOD / periods_s[i])) * (gw_real_t)k);
            wrench.force_x_n = amplitudes[i] * phase.sine;
            tick();
        }
        unit_row(i);
        CHECK(trips == 0U);
    }
    /* The same 20 N at once are a hit, or a push. */
    begin_in_motion();
    wrench.force_x_n = R(40.0);
    CHECK(ticks_to_trip(200U) < 200U);
}

/* After a push that lasted and stopped, the balance falls back: no hit. The reaction goes on until the slow channel,
 * too, has forgotten it. */
static void the_end_of_a_contact_is_no_hit(void)
{
    const uint32_t lasting[] = {30U, 120U, 300U, 560U, 650U};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(lasting); i++) {
        begin();
        wrench.force_x_n = R(30.0);
        input.reacting = true;
        ticks(lasting[i]);
        unit_row(i);
        CHECK(trips == 1U);
        wrench.force_x_n = GW_ZERO;
        for (uint32_t k = 0U; k < 1000U; k++) {
            input.reacting = (k < 500U);
            tick();
        }
        CHECK((trips == 1U) && (!output.active));
    }
}

/* A force that has been the baseline for half a minute is what is usual, and its end a change like any other. */
static void the_end_of_an_old_contact_is_a_hit(void)
{
    begin();
    wrench.force_x_n = R(30.0);
    input.reacting = true;
    ticks(30000U);
    CHECK((trips == 1U) && (!output.active));
    wrench.force_x_n = GW_ZERO;
    CHECK(ticks_to_trip(50U) < 50U);
    CHECK(output.mean_wrench.force_x_n < GW_ZERO);
}

/* After rearm_ticks the fast channel has got used to it; the slow one has not. */
static void a_push_that_outlasts_the_reaction_is_a_push_again(void)
{
    begin();
    wrench.force_x_n = R(30.0);
    input.reacting = true;
    ticks(1300U);
    CHECK((trips == 1U) && (!output.active) && (output.channel == GW_CHANNEL_FAST));
    input.reacting = false;
    tick();
    CHECK((trips == 2U) && output.active && (output.channel == GW_CHANNEL_SLOW));
    CHECK_NEAR(output.mean_wrench.force_x_n, R(30.0), R(0.01));
}

/* Not within the lock of 100 ticks; afterwards, once 40 ticks were quiet, yes. */
static void a_second_hit_after_the_lock_trips_again(void)
{
    begin();
    wrench.force_x_n = R(50.0);
    ticks(20U);
    wrench.force_x_n = GW_ZERO;
    ticks(20U);
    wrench.force_y_n = R(80.0);
    ticks(10U);
    wrench.force_y_n = GW_ZERO;
    CHECK((trips == 1U) && output.active);
    CHECK(ticks_to_release(400U) < 400U);
    CHECK(channels.ticks_since_trip >= config.lock_ticks);
    wrench.force_y_n = R(80.0);
    CHECK(ticks_to_trip(20U) < 20U);
    CHECK((trips == 2U) && (output.channel == GW_CHANNEL_FAST));
}

/* A short hit is over at the lock's end, not before, and in a tick that has time for it. */
static void a_short_contact_is_over_when_the_lock_is(void)
{
    for (uint32_t phase = 0U; phase < 4U; phase++) {
        begin();
        ticks(phase);
        wrench.force_x_n = R(60.0);
        (void)ticks_to_trip(20U);
        wrench.force_x_n = GW_ZERO;
        const uint32_t count = ticks_to_release(200U);
        unit_row(phase);
        CHECK(gw_in_range((gw_real_t)count, R(100.0), R(103.0)));
        CHECK((channels.tick % 4U) == 2U);
        CHECK(channels.ticks_since_release == 0U);
    }
}

/* Force behind the third low-pass that lets a contact end at rest: half of the variance with a floor of 4 N besides. */
static gw_real_t calm_n(void)
{
    const gw_real_t noise_n2 = (R(8.0) * R(8.0)) * channels.fast.noise_n2[GW_BY_ENCODERS][GW_REGIME_REST][2];
    return gw_sqrt(GW_HALF * (noise_n2 + R(9.0) + R(16.0)));
}

/* While less than half of the threshold is left in the fast channel, and less than the whole in the slow one. */
static void a_contact_is_quiet_when_both_channels_are(void)
{
    const struct {
        gw_real_t fast; /* over what is quiet */
        gw_real_t slow; /* statistic */
        uint32_t quiet_ticks;
    } rows[] = {{R(0.99), R(0.99), 8U}, {R(1.01), R(0.99), 0U}, {R(0.99), R(1.0), 0U}, {R(1.01), R(1.0), 0U}};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        begin();
        channels.tick = 1U; /* the slow channel is judged in two ticks */
        channels.active = true;
        channels.quiet_ticks = 7U;
        wrench.force_x_n = rows[i].fast * calm_n();
        channels.fast.bank[2].force_x_n = wrench.force_x_n;
        channels.slow.statistic = rows[i].slow;
        tick();
        unit_row(i);
        CHECK(channels.quiet_ticks == rows[i].quiet_ticks);
    }
}

/* More than 40 quiet ticks and the lock, or rearm_ticks; in the next tick that has time for it. */
static void a_contact_is_over_after_a_time(void)
{
    const struct {
        uint32_t quiet_ticks; /* after the tick, as all here */
        uint32_t since_trip;
        uint32_t tick;
        bool over;
    } rows[] = {{41U, 100U, 2U, true},  {40U, 100U, 2U, false}, {41U, 99U, 2U, false},
                {41U, 100U, 1U, false}, {41U, 100U, 3U, false}, {41U, 100U, 4U, false},
                {1U, 1000U, 6U, true},  {1U, 999U, 6U, false},  {1U, 1100U, 7U, false}};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        begin();
        channels.active = true;
        channels.quiet_ticks = rows[i].quiet_ticks - 1U;
        channels.ticks_since_trip = rows[i].since_trip - 1U;
        channels.tick = rows[i].tick - 1U;
        tick();
        unit_row(i);
        CHECK(output.active == (!rows[i].over));
        CHECK(channels.ticks_since_trip == rows[i].since_trip);
    }
}

/* 3 * 20^2 + 30^2 + 40^2, behind the slow channel's low-pass, times 0.01^2. */
static void levers_make_the_moment_uncertain(void)
{
    begin_in_motion();
    forces.inertia_n.x = R(30.0);
    forces.inertia_n.y = R(-40.0);
    ticks(3000U);
    CHECK_NEAR(channels.doubts.forces_n2, R(3700.0), R(1.0e6) * ROUNDING);
    CHECK(channels.fast.moment_nm2 >= (R(6.25) * R(0.37) * (GW_ONE - R(0.001))));
}

/* 0.01 m times the yaw rate, to either side; a restart forgets it until the next look. */
static void a_turn_makes_wheels_step_between_rows(void)
{
    const struct {
        gw_real_t yaw_rate_radps;
        gw_real_t row_m2ps2;
    } rows[] = {{R(0.0), R(0.0)}, {R(2.0), R(4.0e-4)}, {R(-2.0), R(4.0e-4)}, {R(3000.0), R(100.0)}};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        begin_in_motion();
        twist.vx_mps = R(0.3);
        twist.omega_radps = rows[i].yaw_rate_radps;
        ticks(4U);
        unit_row(i);
        CHECK_NEAR(channels.doubts.row_m2ps2, rows[i].row_m2ps2, rows[i].row_m2ps2 * R(10.0) * ROUNDING);
        ticks(2U);
        CHECK(channels.fast.row_m2ps2 == channels.doubts.row_m2ps2);
        gw_channels_restart(&channels);
        CHECK(channels.doubts.row_m2ps2 == GW_ZERO);
    }
}

/* In motion the slow channel's baseline follows: in 3 s once it has settled, in half a second before. At rest and in a
 * contact it stays. */
static void the_slow_baseline_follows_the_motion(void)
{
    const struct {
        gw_regime_t regime;
        bool settled;
        bool active;
        gw_real_t followed; /* times over the time constant */
    } rows[] = {{GW_REGIME_MOTION, true, false, R(0.28) / R(3.0)},
                {GW_REGIME_MOTION, false, false, R(0.56)},
                {GW_REGIME_CREEPING, true, false, R(0.56)},
                {GW_REGIME_MOTION, true, true, R(0.0)},
                {GW_REGIME_REST, true, false, R(0.0)}};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        begin_in_motion();
        config.rearm_ticks = 100000U;
        channels.config = config;
        channels.active = rows[i].active;
        channels.ticks_since_release = rows[i].settled ? 1000U : 0U;
        channels.ticks_since_trip = 0U;
        channels.slow.mean.residual.force_x_n = R(10.0);
        channels.slow.baseline.residual.force_x_n = GW_ZERO;
        channels.fast.baseline.residual.force_x_n = R(10.0);
        wrench.force_x_n = R(10.0);
        input.enabled = false;
        input.regime = rows[i].regime;
        for (uint32_t k = 0U; k < 280U; k++) {
            channels.quiet_ticks = 0U;
            tick();
        }
        unit_row(i);
        CHECK_NEAR(channels.slow.baseline.residual.force_x_n, R(-10.0) * gw_expm1(-rows[i].followed),
                   R(100.0) * ROUNDING);
    }
}

/* Just after the wheels have turned the fast channel allows for what friction may still do; the slow one is as at rest
 * at once. */
static void the_slow_channel_rests_when_the_robot_does(void)
{
    begin();
    input.turned = true;
    input.reacting = true;
    wrench.force_x_n = R(6.0);
    channels.fast.baseline.residual.force_x_n = R(6.0);
    ticks(600U);
    CHECK_NEAR(channels.slow.statistic, R(36.0) / R(16.0), R(0.001));
    CHECK(trips == 0U);
    input.reacting = false;
    tick();
    CHECK((trips == 1U) && (output.channel == GW_CHANNEL_SLOW));
}

/* A force that stays: the detector is armed again after 1000 ticks, and the force is what is usual. */
static void an_armed_detector_after_rearm_ticks(void)
{
    begin();
    wrench.force_x_n = R(50.0);
    input.reacting = true;
    CHECK(ticks_to_trip(20U) < 20U);
    const uint32_t count = ticks_to_release(2000U);
    CHECK(gw_in_range((gw_real_t)count, R(1000.0), R(1003.0)));
    CHECK((!output.active) && (trips == 1U));
    ticks(100U);
    CHECK(trips == 1U);
    wrench.force_x_n = R(150.0);
    CHECK(ticks_to_trip(20U) < 20U);
}

/* In a reaction impacts alone count; a detector that is not enabled shows its statistic only. */
static void some_modes_do_not_look_for_pushes(void)
{
    const struct {
        bool enabled;
        bool reacting;
        uint32_t slow;
        uint32_t fast;
    } rows[] = {{true, false, 1U, 1U}, {true, true, 0U, 1U}, {false, false, 0U, 0U}, {false, true, 0U, 0U}};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        begin();
        input.enabled = rows[i].enabled;
        input.reacting = rows[i].reacting;
        for (uint32_t k = 0U; k < 2000U; k++) {
            wrench.force_x_n = R(0.004) * (gw_real_t)k;
            (void)ticks_to_trip(1U);
        }
        unit_row(i);
        CHECK(gw_min((gw_real_t)trips, GW_ONE) == (gw_real_t)rows[i].slow);
        CHECK((output.statistic > GW_ONE) == (!rows[i].reacting));
        begin();
        input.enabled = rows[i].enabled;
        input.reacting = rows[i].reacting;
        wrench.force_x_n = R(50.0);
        ticks(20U);
        CHECK((trips == rows[i].fast) && (output.statistic > GW_ONE));
    }
}

/* At rest the floors of 3 and 4 N hold, unless an encoder has moved within 60 ticks; in motion those of creeping until
 * it has lasted for 300 ticks, and 300 ticks since a contact, and in a reaction. */
static void the_threshold_is_that_of_what_the_robot_does(void)
{
    const struct {
        gw_regime_t regime;
        uint32_t motion;
        uint32_t release;
        uint32_t turn; /* ticks since */
        bool reacting;
        gw_regime_t judged;
    } rows[] = {
        {GW_REGIME_REST, 0U, 1000U, 59U, false, GW_REGIME_REST},
        {GW_REGIME_REST, 0U, 1000U, 58U, false, GW_REGIME_MOTION},
        {GW_REGIME_REST, 0U, 0U, 1000U, true, GW_REGIME_REST},
        {GW_REGIME_CREEPING, 0U, 1000U, 0U, false, GW_REGIME_CREEPING},
        {GW_REGIME_MOTION, 299U, 299U, 0U, false, GW_REGIME_MOTION},
        {GW_REGIME_MOTION, 298U, 299U, 0U, false, GW_REGIME_CREEPING},
        {GW_REGIME_MOTION, 299U, 298U, 0U, false, GW_REGIME_CREEPING},
        {GW_REGIME_MOTION, 1000U, 1000U, 0U, true, GW_REGIME_CREEPING},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        begin();
        channels.ticks_of_motion = rows[i].motion;
        channels.ticks_since_release = rows[i].release;
        channels.ticks_without_turn = rows[i].turn;
        channels.fast.bank[3].force_x_n = R(10.0);
        input.regime = rows[i].regime;
        input.reacting = rows[i].reacting;
        tick();
        const gw_real_t x = channels.fast.bank[3].force_x_n;
        const gw_real_t floor_n = gw_force_floor(config.fast, rows[i].judged);
        const gw_real_t n2 =
            (floor_n * floor_n) + ((R(0.8) * R(64.0)) * channels.fast.noise_n2[GW_BY_ENCODERS][rows[i].judged][3]);
        unit_row(i);
        CHECK_NEAR(output.statistic * output.statistic, (x * x) / n2, ((x * x) / n2) * R(0.01));
    }
}

/* 4 N to and fro, five times a second: what a body does on its springs after a stop, over the floor of the fast channel
 * at rest. */
static void swing(uint32_t count)
{
    for (uint32_t k = 0U; k < count; k++) {
        wrench.force_x_n = R(4.0) * gw_sincos(((GW_TWO * GW_PI) * R(0.005)) * (gw_real_t)k).sine;
        tick();
    }
    wrench.force_x_n = GW_ZERO;
}

/* The same at rest, when it was calm for 250 ticks, is a hit. */
static void a_robot_that_stopped_may_swing(void)
{
    begin_in_motion();
    input.regime = GW_REGIME_REST;
    input.turned = false;
    swing(1000U);
    CHECK((trips == 0U) && (channels.calm_ticks < 30U)); /* those in which it turns round */
    ticks(300U);
    CHECK((trips == 0U) && (channels.calm_ticks == 250U));
    swing(100U);
    CHECK((trips == 1U) && (channels.calm_ticks == 250U));
    input.regime = GW_REGIME_CREEPING;
    tick();
    CHECK(channels.calm_ticks == 0U);
}

/* Below half of the square of 3 N, behind the second low-pass, and without a contact. */
static void calm_ticks_are_counted_at_rest(void)
{
    const struct {
        gw_real_t force_n;
        uint32_t before;
        bool active;
        uint32_t after;
        gw_regime_t judged;
    } rows[] = {
        {R(2.12), 248U, false, 249U, GW_REGIME_MOTION}, {R(2.12), 249U, false, 250U, GW_REGIME_REST},
        {R(2.13), 249U, false, 0U, GW_REGIME_MOTION},   {R(2.13), 250U, false, 250U, GW_REGIME_REST},
        {R(2.12), 248U, true, 0U, GW_REGIME_MOTION},    {R(2.12), 250U, true, 250U, GW_REGIME_REST},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        begin();
        channels.calm_ticks = rows[i].before;
        channels.active = rows[i].active;
        channels.fast.bank[1].force_y_n = rows[i].force_n;
        channels.tick = 3U; /* the slow channel is judged in the next one */
        channels.slow.baseline.residual.force_x_n = R(-3.0);
        tick();
        unit_row(i);
        CHECK(channels.calm_ticks == rows[i].after);
        /* At rest the floor of 4 N alone; in motion rollers that hardly turn, too. */
        const bool rests = rows[i].judged == GW_REGIME_REST;
        const gw_real_t unknown = config.model_multiple * config.presliding;
        const gw_real_t missing_n2 = (R(4.0) * (unknown * unknown)) * (SLIDING * SLIDING) * R(1.5);
        CHECK_NEAR(channels.slow.statistic, R(9.0) / (rests ? R(16.0) : (R(196.0) + missing_n2)), R(0.0001));
    }
}

/* A change of the acceleration makes a robot that may lean rock: r^2 (M a)^2, and every four ticks 1 - 8 ms/0.6 s of
 * it. */
static void what_was_accelerated_rocks(void)
{
    gw_channels_config_trikey(&config);
    config.rocking = R(0.5);
    begin_with_config();
    channels.fast.baseline_share = GW_ZERO;
    ticks(WARM_UP + 3U);
    forces.inertia_n.x = R(-30.0);
    forces.inertia_n.y = R(40.0);
    channels.slow.mean.model = forces;
    ticks(4U);
    CHECK_NEAR(channels.doubts.rocking_n2, R(625.0), R(0.01));
    forces.inertia_n.x = GW_ZERO;
    forces.inertia_n.y = GW_ZERO;
    channels.slow.mean.model = forces;
    channels.slow.mean.residual.force_x_n = R(20.0);
    ticks(4U);
    CHECK_NEAR(channels.doubts.rocking_n2, R(625.0) * (GW_ONE - (R(0.008) / R(0.6))), R(0.01));
    CHECK(channels.fast.rocking_n2 == channels.doubts.rocking_n2);
    CHECK((trips == 0U) && (channels.slow.statistic < GW_ONE)); /* 20 N */
    gw_channels_stand_firm(&channels);
    channels.slow.mean.model.inertia_n.x = R(1.0e4);
    ticks(600U);
    CHECK(channels.doubts.rocking_n2 < R(100.0));
}

/* Likewise a contact, when it ends: by its mean force, as far as it was refined. */
static void what_was_pushed_rocks(void)
{
    gw_channels_config_trikey(&config);
    config.rocking = R(0.5);
    begin_with_config();
    ticks(WARM_UP);
    wrench.force_y_n = R(-60.0);
    ticks(80U);
    CHECK(output.active && (channels.doubts.rocking_n2 == GW_ZERO));
    wrench.force_y_n = GW_ZERO;
    CHECK(ticks_to_release(400U) < 400U);
    /* Three ticks later, and the impulse has grown since the last mean. */
    CHECK_NEAR(gw_sqrt(channels.doubts.rocking_n2), GW_HALF * gw_abs(output.mean_wrench.force_y_n), R(0.15));
    CHECK(gw_in_range(channels.doubts.rocking_n2, R(27.0) * R(27.0), R(30.0) * R(30.0)));
}

/* What pushes back after a contact is the body that swings: 2.3 times as much as a contact of this force; what pushes
 * on is none. */
static void what_swings_back_rocks_more(void)
{
    for (uint32_t i = 0U; i < 3U; i++) {
        gw_channels_config_trikey(&config);
        config.rocking = (i == 2U) ? GW_ZERO : R(0.5);
        begin_with_config();
        ticks(WARM_UP);
        wrench.force_y_n = R(-60.0);
        CHECK(ticks_to_trip(20U) < 20U);
        ticks(30U);
        CHECK(channels.doubts.rocking_n2 == GW_ZERO);
        wrench.force_y_n = (i == 1U) ? R(-30.0) : R(30.0);
        ticks(40U); /* the low-pass of 6 ms has 1 - exp(-40/6) of the step */
        unit_row(i);
        if (i == 0U) {
            CHECK_NEAR(gw_sqrt(channels.doubts.rocking_n2), R(0.5) * R(2.3) * R(30.0), R(0.5));
        } else {
            CHECK(channels.doubts.rocking_n2 == GW_ZERO);
        }
    }
}

static void rocking_is_bounded(void)
{
    gw_channels_config_trikey(&config);
    config.rocking = R(10.0);
    config.rocking_s = R(0.01);
    begin_with_config();
    CHECK(channels.rocking_keep == GW_ONE - (R(0.008) / R(0.01)));
    ticks(WARM_UP);
    channels.fast.baseline_share = GW_ZERO;
    forces.inertia_n.x = R(1.0e30);
    forces.inertia_n.y = R(-1.0e30);
    ticks(1000U);
    CHECK(channels.doubts.rocking_n2 == R(1.0e12));
}

/* 2.5^2 of what the gears may be wrong by, and as long as the slow channel remembers: 1 - e^(-4 ms/0.05 s) less every
 * four ticks. */
static void an_error_of_gears_is_remembered(void)
{
    begin();
    channels.tick = 3U; /* the slow channel is judged in the next one */
    channels.slow.mean.residual.force_x_n = R(20.0);
    input.gear_n2 = R(64.0);
    tick();
    CHECK(channels.doubts.gear_n2 == GW_ZERO);
    const gw_real_t sure = channels.slow.statistic;
    ticks(4U);
    CHECK_NEAR(channels.doubts.gear_n2, R(400.0), R(400.0) * ROUNDING);
    CHECK(channels.slow.statistic < (R(0.5) * sure)); /* 16 + 400 N^2 instead of 16 */
    CHECK((channels.fast.model_n2.xx >= R(399.0)) && (channels.fast.model_n2.yy >= R(399.0)));
    input.gear_n2 = GW_ZERO;
    ticks(4U);
    CHECK_NEAR(channels.doubts.gear_n2, R(400.0) * R(0.92311634638663576), R(400.0) * ROUNDING);
    ticks(400U);
    CHECK(channels.doubts.gear_n2 < R(1.0));
    input.gear_n2 = R(1.0e12);
    ticks(4U);
    CHECK(channels.doubts.gear_n2 == R(1.0e12));
    gw_channels_restart(&channels);
    CHECK(channels.doubts.gear_n2 == GW_ZERO);
}

/* 0.7 * 35 kg * 9.80665/3 = 80.1 N of grip, 0.6 of it at a wheel of 0.1016 m are 4.88 N m; doubted are
 * (2.5 * 0.3 * 80.1 N)^2. */
static void a_wheel_that_may_slip_is_doubted_in_free_motion(void)
{
    const struct {
        gw_regime_t regime;
        bool active;
        bool reacting;
        bool felt;
        bool doubted;
    } rows[] = {{GW_REGIME_MOTION, false, false, false, true}, {GW_REGIME_CREEPING, false, false, false, true},
                {GW_REGIME_REST, false, false, false, false},  {GW_REGIME_MOTION, true, false, false, false},
                {GW_REGIME_MOTION, false, true, false, false}, {GW_REGIME_MOTION, false, false, true, false}};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        begin();
        input.regime = rows[i].regime;
        input.reacting = rows[i].reacting;
        input.felt = rows[i].felt;
        channels.active = rows[i].active;
        torque_nm.wheel[1] = R(-4.9);
        torque_nm.wheel[2] = R(4.8);
        ticks(4U);
        unit_row(i);
        CHECK_NEAR(channels.doubts.slip.wheel_n2.wheel[1], rows[i].doubted ? R(3607.892075) : GW_ZERO, R(0.1));
        CHECK((channels.doubts.slip.wheel_n2.wheel[0] == GW_ZERO) &&
              (channels.doubts.slip.wheel_n2.wheel[2] == GW_ZERO));
    }
    begin();
    input.regime = GW_REGIME_MOTION;
    torque_nm.wheel[1] = R(-4.9);
    ticks(4U);
    torque_nm.wheel[1] = GW_ZERO;
    ticks(4U);
    CHECK_NEAR(channels.doubts.slip.wheel_n2.wheel[1], R(3607.892075) * R(0.92311634638663576), R(0.1));
    gw_channels_restart(&channels);
    CHECK(channels.doubts.slip.wheel_n2.wheel[1] == GW_ZERO);
}

/* Where rollers slide, nothing touches and the force is far below the threshold: 5.6 N of 3 * 20.5^2 N^2 are uneven, in
 * a reaction 9.7. */
static void ripple_is_seen_in_free_motion(void)
{
    const struct {
        gw_regime_t regime;
        gw_real_t friction_n;
        gw_real_t force_n;
        bool active;
        bool reacting;
        bool seen;
        bool fades;
    } rows[] = {{GW_REGIME_MOTION, R(20.5), R(20.0), false, false, true, true},
                {GW_REGIME_CREEPING, R(20.5), R(20.0), false, false, true, true},
                {GW_REGIME_MOTION, R(20.5), R(5.5), false, false, false, true},
                {GW_REGIME_MOTION, R(20.5), R(20.0), false, true, true, true},
                {GW_REGIME_MOTION, R(20.5), R(9.5), false, true, false, true},
                {GW_REGIME_MOTION, R(20.5), R(20.0), true, false, false, false},
                {GW_REGIME_MOTION, R(11.5), R(20.0), false, false, false, false},
                {GW_REGIME_REST, R(20.5), R(1.0), false, false, false, false}};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        begin_in_motion();
        input.regime = rows[i].regime;
        input.reacting = rows[i].reacting;
        channels.active = rows[i].active;
        channels.fast.rocking_n2 = R(2000.0); /* the threshold is far */
        channels.doubts.rocking_n2 = R(2000.0);
        channels.ticks_without_turn = 1000U; /* it has stopped long ago, where it rests */
        channels.calm_ticks = 250U;
        input.turned = (rows[i].regime != GW_REGIME_REST);
        for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
            channels.slow.mean.model.friction_n.wheel[k] = rows[i].friction_n;
            channels.fast.baseline.model.friction_n.wheel[k] = rows[i].friction_n;
            forces.friction_n.wheel[k] = rows[i].friction_n;
        }
        twist.omega_radps = R(-0.5);
        channels.ripple.guess2 = GW_ONE;
        channels.ripple.felt2 = GW_ZERO;
        for (uint32_t k = 0U; k < 4U; k++) {
            channels.fast.bank[2].force_x_n = R(0.6) * rows[i].force_n;
            channels.fast.bank[2].force_y_n = R(-0.8) * rows[i].force_n;
            tick();
        }
        unit_row(i);
        CHECK((channels.ripple.felt2 > GW_ZERO) == rows[i].seen);
        CHECK((channels.ripple.guess2 < GW_ONE) == rows[i].fades);
        CHECK(channels.doubts.ripple2 == (R(6.25) * gw_ripple_variance(&channels.ripple, rows[i].reacting)));
    }
}

/* Where the mean of what was seen is half of its largest, all of that is usual: 6.25 times it for both channels. In a
 * reaction, and where wheels share their friction, nothing. The slow channel's threshold is that of its own test. */
static void what_is_usual_reaches_both_channels(void)
{
    const struct {
        gw_real_t mean;
        bool reacting;
        bool usual;
    } rows[] = {{R(0.5), false, true}, {R(0.5), true, false}, {R(0.1), false, false}};
    const gw_real_t most2 = R(0.64); /* (5/3 0.48)^2 */
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        begin_in_motion();
        input.reacting = rows[i].reacting;
        channels.ripple.weight = R(0.8);
        channels.ripple.mean2 = (R(0.8) * rows[i].mean) * most2;
        ticks(4U);
        unit_row(i);
        const gw_real_t usual2 = rows[i].usual ? (R(6.25) * most2) : GW_ZERO;
        const gw_real_t sliding_n = channels.fast.sliding_n;
        CHECK_NEAR(channels.doubts.usual2, usual2, R(100.0) * ROUNDING);
        CHECK_NEAR(channels.fast.letting_go_n2, usual2 * (sliding_n * sliding_n), R(1.0e6) * ROUNDING);
    }
}

/* What lasts is no ripple. */
static void a_force_that_lasts_is_no_ripple(void)
{
    begin_in_motion();
    channels.fast.rocking_n2 = R(2000.0);
    channels.doubts.rocking_n2 = R(2000.0);
    for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
        channels.slow.mean.model.friction_n.wheel[k] = R(20.5);
        channels.fast.baseline.model.friction_n.wheel[k] = R(20.5);
        forces.friction_n.wheel[k] = R(20.5);
    }
    for (uint32_t k = 0U; k < 4U; k++) {
        channels.fast.bank[2].force_x_n = R(20.0);
        channels.fast.bank[3].force_x_n = R(20.0);
        channels.fast.bank[2].force_y_n = R(-20.0);
        channels.fast.bank[3].force_y_n = R(-20.0);
        tick();
    }
    CHECK(channels.ripple.felt2 == GW_ZERO);
    CHECK(channels.ripple.guess2 == (R(0.48) * R(0.48))); /* no wheel turns */
}

/* By the mean of what the wheels turn in four ticks. */
static void the_guess_fades_as_wheels_turn(void)
{
    begin_in_motion();
    channels.fast.rocking_n2 = R(2000.0);
    channels.doubts.rocking_n2 = R(2000.0);
    for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
        channels.slow.mean.model.friction_n.wheel[k] = R(20.5);
        channels.fast.baseline.model.friction_n.wheel[k] = R(20.5);
        forces.friction_n.wheel[k] = R(20.5);
    }
    twist.vx_mps = R(0.3);
    twist.vy_mps = R(-0.2);
    twist.omega_radps = R(0.4);
    const gw_wheels_t rate_radps = gw_kinematics_wheel_rates(&kinematics, twist);
    const gw_real_t mean_radps =
        (gw_magnitude(rate_radps.wheel[0]) + gw_magnitude(rate_radps.wheel[1]) + gw_magnitude(rate_radps.wheel[2])) /
        R(3.0);
    channels.ripple.guess2 = GW_ONE;
    ticks(4U);
    CHECK_NEAR(channels.ripple.guess2, R(1.0) - ((mean_radps * R(0.004)) / R(0.4)), R(10.0) * ROUNDING);
}

/* What was learned of rollers is kept, but for what was felt last. */
static void ripple_outlasts_a_restart(void)
{
    begin_in_motion();
    channels.ripple.guess2 = R(0.01);
    channels.ripple.seen2 = R(0.2);
    channels.ripple.felt2 = R(0.3);
    channels.ripple.mean2 = R(0.05);
    channels.ripple.weight = R(0.4);
    gw_channels_restart(&channels);
    CHECK((channels.ripple.guess2 == R(0.01)) && (channels.ripple.felt2 == R(0.2)));
    CHECK((channels.ripple.mean2 == R(0.05)) && (channels.ripple.weight == R(0.4)) &&
          (channels.doubts.usual2 == GW_ZERO));
    CHECK(channels.doubts.ripple2 == (R(6.25) * (R(0.01) + R(0.2))));
    CHECK(gw_channels_invariant_holds(&channels));
}

static void counters_stop_at_their_largest(void)
{
    begin();
    channels.tick = GW_TICK_MASK;
    channels.ticks_since_release = GW_TICK_MASK;
    channels.ticks_without_turn = GW_TICK_MASK - 1U;
    ticks(2U);
    CHECK((channels.tick == 1U) && (channels.ticks_since_release == GW_TICK_MASK));
    CHECK(channels.ticks_without_turn == GW_TICK_MASK);
    begin_in_motion();
    channels.ticks_of_motion = GW_TICK_MASK;
    tick();
    CHECK((channels.ticks_of_motion == GW_TICK_MASK) && (channels.ticks_without_turn == 0U));
    input.regime = GW_REGIME_CREEPING;
    tick();
    CHECK(channels.ticks_of_motion == 0U);
}

/* 1 N at the zero before, 30 N after it: nothing happened. At rest both baselines are what is there now. */
static void another_zero_moves_baselines_along(void)
{
    const gw_regime_t regimes[] = {GW_REGIME_REST, GW_REGIME_CREEPING, GW_REGIME_MOTION};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(regimes); i++) {
        begin();
        input.regime = regimes[i];
        wrench.force_x_n = R(1.0);
        ticks(300U);
        zero_step.force_x_n = R(30.0);
        zero_step.torque_nm = R(-5.0);
        wrench.force_x_n += zero_step.force_x_n;
        wrench.torque_nm += zero_step.torque_nm;
        input.zero_changed = true;
        tick();
        input.zero_changed = false;
        ticks(200U);
        unit_row(i);
        CHECK((trips == 0U) && (output.statistic < GW_HALF));
        if (regimes[i] == GW_REGIME_REST) {
            CHECK_NEAR(channels.slow.baseline.residual.force_x_n, R(31.0), R(0.01));
        }
    }
    /* The same jump without another zero is a hit. */
    begin();
    wrench.force_x_n = R(30.0);
    CHECK(ticks_to_trip(20U) < 20U);
}

/* Nothing else is done in that tick. */
static void another_zero_takes_its_time(void)
{
    for (uint32_t i = 0U; i < 2U; i++) {
        begin();
        channels.tick = 3U;
        channels.slow.mean.residual.force_x_n = R(2.0);
        input.regime = GW_REGIME_MOTION;
        input.zero_changed = (i == 1U);
        tick();
        unit_row(i);
        CHECK((channels.slow.statistic > GW_ZERO) == (i == 0U));
    }
}

/* A contact lasts over another zero: its force is not taken for the baseline. */
static void another_zero_in_a_contact_keeps_its_force(void)
{
    begin();
    wrench.force_x_n = R(50.0);
    ticks(30U);
    CHECK(output.active);
    zero_step.force_x_n = R(-20.0);
    wrench.force_x_n += zero_step.force_x_n;
    input.zero_changed = true;
    tick();
    input.zero_changed = false;
    CHECK_NEAR(channels.fast.baseline.residual.force_x_n, R(-20.0), R(1.0));
    CHECK(output.active && (channels.fast.bank[0].force_x_n > R(45.0)));
}

/* Another sensor of the acceleration: another mean, in which nothing is detected; unless a contact lasts. At rest the
 * slow channel takes over what is there, in motion it waits for what follows. */
static void another_sensor_begins_the_baseline_anew(void)
{
    for (uint32_t i = 0U; i < 8U; i++) {
        const bool contact = (i & 1U) != 0U;
        const bool warm = (i & 2U) == 0U;
        const bool rest = (i & 4U) == 0U;
        begin();
        wrench.force_x_n = contact ? R(50.0) : GW_ZERO;
        ticks(30U);
        channels.warm_up_ticks = warm ? WARM_UP : 30U;
        input.regime = rest ? GW_REGIME_REST : GW_REGIME_MOTION;
        input.felt = true;
        input.shaking_mps2_2 = R(0.0001);
        input.zero_changed = true;
        zero_step.force_y_n = R(3.0);
        wrench.force_y_n = R(3.0);
        const uint32_t before = channels.warm_up_ticks;
        const gw_real_t slow_y_n = channels.slow.mean.residual.force_y_n;
        tick();
        input.zero_changed = false;
        unit_row(i);
        CHECK(channels.fast.sensor == GW_BY_IMU);
        CHECK(channels.warm_up_ticks == ((!contact) ? 1U : (warm ? before : (before + 1U))));
        const bool taken_over = rest && warm;
        CHECK((gw_abs(channels.slow.mean.residual.force_y_n - slow_y_n) > R(2.0)) == taken_over);
        if ((!contact) && warm) {
            CHECK_NEAR(channels.slow.baseline.residual.force_y_n, rest ? R(3.0) : GW_ZERO, R(0.001));
        }
        CHECK(output.active == contact);
        CHECK(trips == (contact ? 1U : 0U));
    }
}

/* 30 % of the friction of all wheels, in motion to all sides. Nothing is learned from a wheel that does not slide, at
 * rest, while the robot is unsettled, or while something touches. */
static bool learns_from(gw_real_t friction_n)
{
    for (uint32_t k = 0U; k < 400U; k++) {
        forces.friction_n.wheel[1] = friction_n;
        tick();
    }
    return channels.follower.difference[0] != GW_ZERO;
}

static void nothing_is_learned_while_a_wheel_does_not_slide(void)
{
    for (uint32_t i = 0U; i < 8U; i++) {
        begin_in_motion();
        gw_follower_init(&channels.follower, &config.follower, R(0.008));
        for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
            forces.friction_n.wheel[k] = SLIDING;
            channels.slow.mean.model.friction_n.wheel[k] = SLIDING;
            channels.slow.baseline.model.friction_n.wheel[k] = SLIDING; /* for long */
        }
        channels.slow.mean.residual.force_x_n = R(5.0);
        channels.slow.baseline.residual.force_x_n = R(5.0);
        channels.fast.baseline.residual.force_x_n = R(5.0);
        wrench.force_x_n = R(5.0);
        unit_row(i);
        if (i == 0U) {
            CHECK(learns_from(SLIDING));
        } else if (i == 1U) {
            channels.slow.mean.model.friction_n.wheel[1] = R(0.899) * SLIDING;
            CHECK(!learns_from(R(0.899) * SLIDING));
        } else if (i == 2U) {
            channels.slow.mean.model.friction_n.wheel[1] = R(0.901) * SLIDING;
            CHECK(learns_from(R(0.901) * SLIDING));
        } else if (i == 3U) {
            input.regime = GW_REGIME_REST; /* the wheels have just turned */
            CHECK(!learns_from(SLIDING));
        } else if (i == 4U) {
            input.regime = GW_REGIME_CREEPING;
            CHECK(!learns_from(SLIDING));
        } else if (i == 5U) {
            channels.active = true; /* a contact that lasts */
            channels.config.rearm_ticks = 100000U;
            channels.config.lock_ticks = 100000U;
            CHECK(!learns_from(SLIDING));
        } else if (i == 6U) {
            input.enabled = false;
            channels.slow.baseline.residual.force_x_n = R(17.0); /* 12 of 14 N: 0.73 of a push */
            channels.slow.settled_share = GW_ZERO;
            CHECK(!learns_from(SLIDING));
        } else {
            forces.friction_n.wheel[2] = R(0.5) * SLIDING;
            channels.slow.mean.model.friction_n.wheel[2] = R(0.5) * SLIDING;
            CHECK(!learns_from(SLIDING));
        }
    }
}

/* A robot whose friction is 25 % larger than configured, on a circle: the follower finds it, and no hit is found. */
static void the_friction_of_a_robot_is_followed(void)
{
    begin_in_motion();
    const gw_real_t more = R(0.25);
    for (uint32_t k = 0U; k < 20000U; k++) {
        const gw_rotation_t phase = gw_sincos(((GW_TWO * GW_PI) * (PERIOD / R(8.0))) * (gw_real_t)k);
        /* From all rollers sliding inwards to one wheel outwards: smooth, and never between the limits for long. */
        forces.friction_n.wheel[0] = SLIDING * gw_limited(R(20.0) * phase.sine, GW_ONE);
        forces.friction_n.wheel[1] = SLIDING * gw_limited(R(20.0) * phase.cosine, GW_ONE);
        const gw_model_forces_t lacking = forces;
        const gw_regressors_t regressors = gw_follower_regressors(&kinematics, &lacking);
        wrench.force_x_n = GW_ZERO;
        wrench.force_y_n = GW_ZERO;
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            wrench.force_x_n -= more * regressors.of[i].x;
            wrench.force_y_n -= more * regressors.of[i].y;
        }
        tick();
    }
    CHECK(trips == 0U);
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        unit_row(i);
        CHECK_NEAR(channels.follower.difference[i], more, R(0.05));
    }
}

/* Rollers that hardly turn may have any friction between their limits: the same force trips if they slide. */
static void rollers_that_hardly_turn_widen_the_threshold(void)
{
    for (uint32_t i = 0U; i < 2U; i++) {
        begin_in_motion();
        for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
            forces.friction_n.wheel[k] = (i == 0U) ? SLIDING : GW_ZERO;
            channels.fast.baseline.model.friction_n.wheel[k] = forces.friction_n.wheel[k];
            channels.slow.baseline.model.friction_n.wheel[k] = forces.friction_n.wheel[k];
            channels.slow.mean.model.friction_n.wheel[k] = forces.friction_n.wheel[k];
        }
        ticks(100U);
        CHECK(trips == 0U);
        wrench.force_x_n = R(17.0);
        unit_row(i);
        ticks(150U);
        CHECK(trips == ((i == 0U) ? 1U : 0U));
    }
}

/* 60 N and 3 N m from one tick to the next, along four directions: the bank's answer at the trip, counted for its time,
 * then the mean over 59 ticks more of what its low-pass of 6 ms answers, which had seen a share p at the trip:
 * F (1 - (1 - p) q^k) after k ticks. The baseline stands still. */
static void the_mean_wrench_of_a_push_is_found(void)
{
    const gw_vector_t directions[] = {{R(1.0), R(0.0)}, {R(0.0), R(-1.0)}, {R(-0.6), R(0.8)}, {R(0.8), R(0.6)}};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(directions); i++) {
        uint32_t refined = 0U;
        begin();
        wrench.force_x_n = R(60.0) * directions[i].x;
        wrench.force_y_n = R(60.0) * directions[i].y;
        wrench.torque_nm = R(3.0);
        (void)ticks_to_trip(20U);
        unit_row(i);
        CHECK(output.tripped && output.refined && output.refining);
        const gw_real_t felt_s = channels.impulse_s;
        CHECK((felt_s == R(0.002)) || (felt_s == R(0.006)));
        const gw_vector_t passed = {channels.fast.bank[1].force_x_n, channels.fast.bank[1].force_y_n};
        const gw_real_t keep = gw_exp(R(-0.001) / R(0.006));
        const gw_vector_t first = {output.mean_wrench.force_x_n, output.mean_wrench.force_y_n};
        gw_real_t seen_s = felt_s * (gw_length(first) / R(60.0));
        gw_real_t left = GW_ONE - (gw_length(passed) / R(60.0));
        gw_real_t seen = GW_ZERO;
        for (uint32_t k = 1U; k <= 60U; k++) {
            const gw_wrench_t before = output.mean_wrench;
            tick();
            left *= keep;
            seen_s += R(0.001) * (GW_ONE - left);
            CHECK(output.refining == (k < 60U));
            refined += output.refined ? 1U : 0U;
            seen = output.refined ? (seen_s / (felt_s + (R(0.001) * (gw_real_t)k))) : seen;
            CHECK(output.refined || (output.mean_wrench.force_x_n == before.force_x_n));
        }
        CHECK(refined == 15U); /* every fourth tick */
        const gw_vector_t force = {output.mean_wrench.force_x_n, output.mean_wrench.force_y_n};
        CHECK_NEAR(gw_length(force), R(60.0) * seen, R(60.0) * R(100.0) * ROUNDING);
        CHECK_NEAR(force.x, gw_length(force) * directions[i].x, R(60.0) * R(10.0) * ROUNDING);
        CHECK_NEAR(force.y, gw_length(force) * directions[i].y, R(60.0) * R(10.0) * ROUNDING);
        CHECK_NEAR(output.mean_wrench.torque_nm, R(3.0) * (gw_length(force) / R(60.0)), R(0.01));
        ticks(40U);
        CHECK((!output.refining) && (!output.refined));
    }
}

/* Noise of one tick hardly moves the mean: the impulse grows by what a low-pass of the bank makes of it, a slow one
 * where the contact is slow, or an IMU is shaken by the motion. */
static void the_impulse_is_summed_behind_a_low_pass(void)
{
    static const struct {
        bool felt;
        bool moving;
        bool slow;
        uint32_t bank;
    } rows[] = {
        {false, false, false, 1U}, {false, true, false, 1U}, {true, false, false, 1U},
        {true, true, false, 2U},   {false, false, true, 2U}, {true, true, true, 2U},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        begin();
        input.felt = rows[i].felt;
        input.regime = rows[i].moving ? GW_REGIME_MOTION : GW_REGIME_REST;
        input.zero_changed = rows[i].felt;
        tick();
        input.zero_changed = false;
        ticks(2U * WARM_UP);
        if (rows[i].slow) {
            channels.slow.baseline.residual.force_x_n = R(-100.0);
        } else {
            wrench.force_x_n = R(100.0);
        }
        unit_row(i);
        CHECK(ticks_to_trip(20U) < 20U);
        CHECK(output.channel == (rows[i].slow ? GW_CHANNEL_SLOW : GW_CHANNEL_FAST));
        ticks(30U);
        const gw_real_t before = channels.impulse.force_y_n;
        wrench.force_y_n = R(500.0);
        tick();
        const gw_real_t added = channels.impulse.force_y_n - before;
        CHECK_NEAR(added, channels.fast.bank[rows[i].bank].force_y_n * channels.period_s, R(10.0) * ROUNDING);
        CHECK(added < (GW_HALF * (R(500.0) * channels.period_s)));
    }
}

/* 100 N for 30 ticks, then as much from the other side, 50 N across and a moment. In motion nothing is taken off the
 * impulse, and what is across it and the moment are added; at rest all is added. Along three directions. */
static void in_motion_nothing_pulls(void)
{
    for (uint32_t i = 0U; i < 6U; i++) {
        const bool moving = (i >= 3U);
        const gw_rotation_t along = gw_sincos(R(2.0) * (gw_real_t)(i % 3U));
        if (moving) {
            begin_in_motion();
        } else {
            begin();
        }
        wrench.force_x_n = R(100.0) * along.cosine;
        wrench.force_y_n = R(100.0) * along.sine;
        unit_row(i);
        CHECK(ticks_to_trip(20U) < 20U);
        ticks(30U);
        wrench.force_x_n = R(-100.0) * (along.cosine + (GW_HALF * along.sine));
        wrench.force_y_n = R(-100.0) * (along.sine - (GW_HALF * along.cosine));
        wrench.torque_nm = R(5.0);
        for (uint32_t k = 0U; k < 25U; k++) {
            const gw_wrench_t before = channels.impulse;
            const gw_vector_t impulse = {before.force_x_n, before.force_y_n};
            const gw_vector_t d = gw_unit(impulse.x, impulse.y, gw_length(impulse));
            tick();
            const gw_wrench_t *const felt = &channels.fast.bank[channels.summed];
            const gw_real_t x = (channels.impulse.force_x_n - before.force_x_n) / channels.period_s;
            const gw_real_t y = (channels.impulse.force_y_n - before.force_y_n) / channels.period_s;
            const gw_real_t felt_along = (felt->force_x_n * d.x) + (felt->force_y_n * d.y);
            /* A difference of two impulses of about 3 N s, over a millisecond. */
            const gw_real_t near = R(3.0e4) * ROUNDING;
            CHECK_NEAR((x * d.x) + (y * d.y), (moving && (felt_along < GW_ZERO)) ? GW_ZERO : felt_along, near);
            CHECK_NEAR((y * d.x) - (x * d.y), (felt->force_y_n * d.x) - (felt->force_x_n * d.y), near);
            CHECK_NEAR((channels.impulse.torque_nm - before.torque_nm) / channels.period_s, felt->torque_nm, near);
            CHECK((k < 10U) || (felt_along < R(-50.0)));
        }
    }
}

/* The baseline carries 100 N along x of an old contact. A change against it is its end, up to 1.5 times of it: what is
 * left of both pushes, if it is half of the change. */
static void an_end_is_no_push_from_the_other_side(void)
{
    static const struct {
        gw_real_t x_n;
        gw_real_t y_n;
        gw_real_t added; /* to the change, along x: 0 none, 1 what is carried, 2 what the change has against it */
        bool pushes;
    } rows[] = {
        {R(80.0), R(0.0), R(0.0), true},    {R(0.0), R(-80.0), R(0.0), true},    {R(-90.0), R(10.0), R(1.0), false},
        {R(-90.0), R(100.0), R(1.0), true}, {R(-140.0), R(60.0), R(2.0), false}, {R(-140.0), R(90.0), R(2.0), true},
        {R(-180.0), R(10.0), R(0.0), true},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        begin();
        channels.fast.held.force_x_n = R(1.0); /* little is forgiven */
        channels.fast.carried_n.x = R(100.0);
        wrench.force_x_n = rows[i].x_n;
        wrench.force_y_n = rows[i].y_n;
        CHECK(ticks_to_trip(20U) < 20U);
        ticks(40U);
        do {
            tick();
        } while (!output.refined);
        const gw_wrench_t mean = output.mean_wrench;
        const gw_real_t carried = channels.fast.carried_n.x;
        const gw_real_t added = (rows[i].added > GW_ONE) ? -mean.force_x_n : (rows[i].added * carried);
        unit_row(i);
        CHECK_NEAR(output.push_n.x, rows[i].pushes ? (mean.force_x_n + added) : GW_ZERO, R(300.0) * ROUNDING);
        CHECK_NEAR(output.push_n.y, rows[i].pushes ? mean.force_y_n : GW_ZERO, R(300.0) * ROUNDING);
    }
}

/* However large forces are and however long a contact lasts. */
static void the_impulse_is_bounded(void)
{
    gw_channels_noise_t slow = fine_noise();
    slow.period_s = R(0.1);
    gw_channels_config_trikey(&config);
    config.slow_s = R(10.0);
    config.rearm_ticks = 100000U;
    begin_with_config();
    gw_channels_init(&channels, &config, &slow);
    ticks(WARM_UP);
    wrench.force_x_n = R(1.0e9);
    wrench.force_y_n = R(-1.0e9);
    wrench.torque_nm = R(1.0e9);
    ticks(5000U);
    CHECK((trips == 1U) && output.active);
    CHECK(gw_within(channels.impulse.force_x_n, R(1.0e9)) && (channels.impulse_s <= R(100.0)));
    CHECK(gw_in_range(output.mean_wrench.force_x_n, R(1.0e4), R(1.0e6)));
}

/* An IMU tells at once, and a robot that stands firm has no body that swings back. */
static void the_direction_of_a_contact_is_unsure_at_first(void)
{
    gw_channels_config_trikey(&config);
    config.rocking = R(0.3);
    begin_with_config();
    ticks(WARM_UP);
    CHECK(!gw_channels_are_unsure(&channels));
    wrench.force_x_n = R(50.0);
    (void)ticks_to_trip(30U);
    CHECK(output.active && (channels.rocking2 > GW_ZERO) && gw_channels_are_unsure(&channels));
    ticks(9U);
    CHECK(gw_channels_are_unsure(&channels));
    channels.fast.sensor = GW_BY_IMU;
    CHECK(!gw_channels_are_unsure(&channels));
    channels.fast.sensor = GW_BY_ENCODERS;
    channels.active = false;
    CHECK(!gw_channels_are_unsure(&channels));
    channels.active = true;
    ticks(1U);
    CHECK(!gw_channels_are_unsure(&channels));
    channels.ticks_since_trip = 0U;
    gw_channels_stand_firm(&channels);
    CHECK(!gw_channels_are_unsure(&channels));
}

static void a_restart_keeps_what_was_learned(void)
{
    begin_in_motion();
    channels.follower.difference[1] = R(0.25);
    channels.fast.noise_n2[GW_BY_ENCODERS][GW_REGIME_MOTION][0] *= R(3.0);
    wrench.force_x_n = R(80.0);
    (void)ticks_to_trip(20U);
    CHECK(output.active);
    const gw_real_t noise_n2 = channels.fast.noise_n2[GW_BY_ENCODERS][GW_REGIME_MOTION][0];
    channels.summed = GW_BANK_COUNT; /* as memory may be before the first start */
    channels.began_in_motion = true;
    gw_channels_restart(&channels);
    CHECK(gw_channels_invariant_holds(&channels));
    CHECK((!channels.active) && (channels.channel == GW_CHANNEL_NONE) && (channels.warm_up_ticks == 0U));
    CHECK(!channels.began_in_motion);
    CHECK(channels.follower.difference[1] == R(0.25));
    CHECK(channels.fast.noise_n2[GW_BY_ENCODERS][GW_REGIME_MOTION][0] == noise_n2);
    tick();
    CHECK((!output.active) && (!output.refined));
}

/* What counts add reaches the fast channel in every tick, also while the baseline is warming up. */
static void what_is_counted_is_passed_on(void)
{
    gw_channels_config_trikey(&config);
    begin_with_config();
    input.counted = R(0.25);
    tick();
    CHECK(channels.fast.counted == R(0.25));
    input.counted = R(1.5);
    ticks(WARM_UP);
    CHECK(channels.fast.counted == R(1.5));
}

static void the_invariant_sees_every_member(void)
{
    begin();
    const gw_channels_t good = channels;
    gw_real_t *const members[] = {
        &channels.config.noise_multiple, &channels.follower.difference[0], &channels.fast.held.force_x_n,
        &channels.slow.force_n.y,        &channels.doubts.forces_n2,       &channels.rocking2,
        &channels.rocking_keep,          &channels.doubts.rocking_n2,      &channels.gear_keep,
        &channels.doubts.gear_n2,        &channels.doubts.slip.near_n,     &channels.doubts.ripple2,
        &channels.ripple.felt2,          &channels.impulse.torque_nm,      &channels.impulse_s,
        &channels.doubts.row_m2ps2,      &channels.doubts.usual2,          &channels.ripple.mean2};
    CHECK(!gw_channels_invariant_holds(NULL));
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(members); i++) {
        unit_row(i);
        *members[i] = unit_nan();
        CHECK(!gw_channels_invariant_holds(&channels));
        *members[i] = R(-1.0e30);
        CHECK(!gw_channels_invariant_holds(&channels));
        channels = good;
    }
    channels.warm_up_ticks = WARM_UP + 1U;
    CHECK(!gw_channels_invariant_holds(&channels));
    channels = good;
    channels.calm_ticks = 251U;
    CHECK(!gw_channels_invariant_holds(&channels));
    channels = good;
    channels.summed = 4U;
    CHECK(!gw_channels_invariant_holds(&channels));
    channels = good;
    channels.channel = GW_CHANNEL_SLOW + 1U;
    CHECK(!gw_channels_invariant_holds(&channels));
    channels = good;
    CHECK(gw_channels_invariant_holds(&channels));
}

/* 1 - e^(-x), at most a half. */
static void a_low_pass_takes_over_a_share(void)
{
    CHECK_NEAR(gw_share_of(R(0.001), R(0.1)), R(0.0099501662508319464), ROUNDING);
    CHECK_NEAR(gw_share_of(R(0.001), R(0.0015)), R(0.48658288096740794), ROUNDING);
    CHECK(gw_share_of(R(0.1), R(0.001)) == GW_HALF);
}

void suite_channels(void)
{
    unit_run("warm_up_detects_nothing", warm_up_detects_nothing);
    unit_run("a_step_of_force_trips_the_fast_channel", a_step_of_force_trips_the_fast_channel);
    unit_run("a_slow_push_trips_the_slow_channel_only", a_slow_push_trips_the_slow_channel_only);
    unit_run("friction_that_is_wrong_slowly_does_not_trip", friction_that_is_wrong_slowly_does_not_trip);
    unit_run("the_end_of_a_contact_is_no_hit", the_end_of_a_contact_is_no_hit);
    unit_run("the_end_of_an_old_contact_is_a_hit", the_end_of_an_old_contact_is_a_hit);
    unit_run("a_push_that_outlasts_the_reaction_is_a_push_again", a_push_that_outlasts_the_reaction_is_a_push_again);
    unit_run("a_second_hit_after_the_lock_trips_again", a_second_hit_after_the_lock_trips_again);
    unit_run("a_short_contact_is_over_when_the_lock_is", a_short_contact_is_over_when_the_lock_is);
    unit_run("a_contact_is_quiet_when_both_channels_are", a_contact_is_quiet_when_both_channels_are);
    unit_run("a_contact_is_over_after_a_time", a_contact_is_over_after_a_time);
    unit_run("levers_make_the_moment_uncertain", levers_make_the_moment_uncertain);
    unit_run("a_turn_makes_wheels_step_between_rows", a_turn_makes_wheels_step_between_rows);
    unit_run("the_slow_baseline_follows_the_motion", the_slow_baseline_follows_the_motion);
    unit_run("the_slow_channel_rests_when_the_robot_does", the_slow_channel_rests_when_the_robot_does);
    unit_run("an_armed_detector_after_rearm_ticks", an_armed_detector_after_rearm_ticks);
    unit_run("some_modes_do_not_look_for_pushes", some_modes_do_not_look_for_pushes);
    unit_run("the_threshold_is_that_of_what_the_robot_does", the_threshold_is_that_of_what_the_robot_does);
    unit_run("a_robot_that_stopped_may_swing", a_robot_that_stopped_may_swing);
    unit_run("calm_ticks_are_counted_at_rest", calm_ticks_are_counted_at_rest);
    unit_run("what_was_accelerated_rocks", what_was_accelerated_rocks);
    unit_run("what_was_pushed_rocks", what_was_pushed_rocks);
    unit_run("what_swings_back_rocks_more", what_swings_back_rocks_more);
    unit_run("rocking_is_bounded", rocking_is_bounded);
    unit_run("an_error_of_gears_is_remembered", an_error_of_gears_is_remembered);
    unit_run("a_wheel_that_may_slip_is_doubted_in_free_motion", a_wheel_that_may_slip_is_doubted_in_free_motion);
    unit_run("ripple_is_seen_in_free_motion", ripple_is_seen_in_free_motion);
    unit_run("what_is_usual_reaches_both_channels", what_is_usual_reaches_both_channels);
    unit_run("a_force_that_lasts_is_no_ripple", a_force_that_lasts_is_no_ripple);
    unit_run("the_guess_fades_as_wheels_turn", the_guess_fades_as_wheels_turn);
    unit_run("ripple_outlasts_a_restart", ripple_outlasts_a_restart);
    unit_run("counters_stop_at_their_largest", counters_stop_at_their_largest);
    unit_run("another_zero_moves_baselines_along", another_zero_moves_baselines_along);
    unit_run("another_zero_takes_its_time", another_zero_takes_its_time);
    unit_run("another_zero_in_a_contact_keeps_its_force", another_zero_in_a_contact_keeps_its_force);
    unit_run("another_sensor_begins_the_baseline_anew", another_sensor_begins_the_baseline_anew);
    unit_run("nothing_is_learned_while_a_wheel_does_not_slide", nothing_is_learned_while_a_wheel_does_not_slide);
    unit_run("the_friction_of_a_robot_is_followed", the_friction_of_a_robot_is_followed);
    unit_run("rollers_that_hardly_turn_widen_the_threshold", rollers_that_hardly_turn_widen_the_threshold);
    unit_run("the_mean_wrench_of_a_push_is_found", the_mean_wrench_of_a_push_is_found);
    unit_run("the_impulse_is_summed_behind_a_low_pass", the_impulse_is_summed_behind_a_low_pass);
    unit_run("in_motion_nothing_pulls", in_motion_nothing_pulls);
    unit_run("an_end_is_no_push_from_the_other_side", an_end_is_no_push_from_the_other_side);
    unit_run("the_impulse_is_bounded", the_impulse_is_bounded);
    unit_run("the_direction_of_a_contact_is_unsure_at_first", the_direction_of_a_contact_is_unsure_at_first);
    unit_run("a_restart_keeps_what_was_learned", a_restart_keeps_what_was_learned);
    unit_run("what_is_counted_is_passed_on", what_is_counted_is_passed_on);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
    unit_run("a_low_pass_takes_over_a_share", a_low_pass_takes_over_a_share);
}
