#include "usual_noise.h"

#include "giveway/gw_ripple.h"

static gw_slow_channel_t channel;
static gw_channels_config_t config;
static gw_follower_t follower;
static gw_kinematics_t kinematics;
static gw_balance_t balance;
static gw_doubts_t doubts;

static const gw_balance_t no_balance;
static const gw_doubts_t no_doubts;
static const gw_regime_t regimes[] = {GW_REGIME_REST, GW_REGIME_CREEPING, GW_REGIME_MOTION};

static void begin(void)
{
    gw_geometry_config_t geometry;
    gw_geometry_config_trikey(&geometry);
    CHECK_STATUS(gw_kinematics_init(&kinematics, &geometry), GW_STATUS_OK);
    gw_channels_config_trikey(&config);
    gw_follower_init(&follower, &config.follower, R(0.008));
    gw_slow_channel_init(&channel, &config, &usual);
    CHECK(gw_slow_channel_invariant_holds(&channel));
    balance = no_balance;
    doubts = no_doubts;
}

static void steps(uint32_t count)
{
    for (uint32_t i = 0U; i < count; i++) {
        gw_slow_channel_step(&channel, &balance);
        CHECK(gw_slow_channel_invariant_holds(&channel));
    }
}

static void judge(gw_regime_t floor)
{
    gw_slow_channel_judge(&channel, &config, &kinematics, &follower, floor, &doubts);
    CHECK(gw_slow_channel_invariant_holds(&channel));
}

/* In motion the threshold has this covariance besides the floor. */
static void judge_against(gw_planar_covariance_t m, gw_regime_t floor)
{
    const gw_planar_covariance_t none = {GW_ZERO, GW_ZERO, GW_ZERO};
    const gw_planar_spread_t spread = gw_planar_spread((floor == GW_REGIME_REST) ? none : m);
    const gw_real_t floor_n = gw_force_floor(config.slow, floor);
    judge(floor);
    CHECK(channel.statistic == gw_planar_distance(&spread, floor_n * floor_n, channel.force_n));
}

/* F (1 - e^(-t/0.05 s)), and its square over that of the floor; no force, no model. */
static void a_push_is_compared_with_the_floor_behind_a_low_pass(void)
{
    const gw_real_t floors[] = {R(4.0), R(40.0), R(14.0)};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(regimes); i++) {
        begin();
        config.presliding = GW_ZERO;
        balance.residual.force_x_n = R(9.0);
        balance.residual.force_y_n = R(-12.0);
        for (uint32_t tick = 1U; tick <= 200U; tick++) {
            const gw_real_t force_n = R(-15.0) * gw_expm1(R(-0.02) * (gw_real_t)tick);
            steps(1U);
            judge(regimes[i]);
            unit_row((1000U * i) + tick);
            CHECK_NEAR(channel.force_n.x, R(0.6) * force_n, R(100.0) * ROUNDING);
            CHECK_NEAR(channel.force_n.y, R(-0.8) * force_n, R(100.0) * ROUNDING);
            const gw_real_t ratio = force_n / floors[i];
            CHECK_NEAR(channel.statistic, ratio * ratio, (ratio + (ratio * ratio)) * R(100.0) * ROUNDING);
        }
        CHECK((channel.statistic > GW_ONE) == (regimes[i] != GW_REGIME_CREEPING));
    }
}

/* Friction, with rollers that hardly turn: doubted but at rest, where no wheel moves. */
static void what_the_model_does_not_know_widens_the_threshold_in_motion(void)
{
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(regimes); i++) {
        begin();
        channel.mean.residual.force_x_n = R(30.0);
        channel.mean.model.friction_n.wheel[0] = R(15.0);
        channel.mean.model.inertia_n.y = R(50.0);
        channel.baseline.model.friction_n.wheel[0] = R(-15.0);
        gw_model_forces_t change = channel.mean.model;
        change.friction_n.wheel[0] = R(30.0);
        const gw_planar_covariance_t m = gw_model_covariance(&config, &kinematics, &follower, &change,
                                                             &channel.mean.model, R(20.0), GW_TWO * config.presliding);
        unit_row(i);
        judge_against(m, regimes[i]);
        CHECK((m.xx > R(100.0)) || (m.yy > R(100.0)));
        CHECK(channel.force_n.x == R(30.0));
    }
}

/* Of rollers that each have all of their friction half of what is usual is added, along the axles, but at rest. */
static void usual_ripple_widens_the_threshold_in_motion(void)
{
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(regimes); i++) {
        begin();
        doubts.usual2 = R(0.6);
        channel.mean.residual.force_x_n = R(30.0);
        channel.mean.residual.force_y_n = R(-20.0);
        channel.mean.model.friction_n.wheel[0] = R(15.0);
        channel.mean.model.friction_n.wheel[2] = R(-12.0);
        channel.baseline.model = channel.mean.model;
        const gw_planar_covariance_t known =
            gw_model_covariance(&config, &kinematics, &follower, &no_balance.model, &channel.mean.model, R(20.0),
                                GW_TWO * config.presliding);
        const gw_planar_covariance_t m = gw_ripple_added(R(0.3), &kinematics, &channel.mean.model.friction_n, known);
        unit_row(i);
        judge_against(m, regimes[i]);
    }
}

/* What the body does while it rocks, and what gears may be wrong by, to all sides, at rest, too. */
static void rocking_and_gears_widen_the_threshold(void)
{
    const gw_planar_covariance_t m = {R(700.0), GW_ZERO, R(700.0)};
    const gw_planar_spread_t spread = gw_planar_spread(m);
    begin();
    doubts.rocking_n2 = R(400.0);
    doubts.gear_n2 = R(300.0);
    channel.mean.residual.force_x_n = R(30.0);
    channel.mean.residual.force_y_n = R(-20.0);
    judge(GW_REGIME_REST);
    CHECK(channel.statistic == gw_planar_distance(&spread, R(16.0), channel.force_n));
}

/* What the follower knows of the change is added to the residual. */
static void known_friction_is_no_push(void)
{
    begin();
    follower.difference[2] = R(-0.4);
    follower.difference[3] = R(0.1);
    channel.mean.model.friction_n.wheel[2] = R(20.0);
    channel.mean.model.inertia_n.x = R(50.0);
    const gw_vector_t correction = gw_follower_correction(&follower, &kinematics, &channel.mean.model);
    channel.mean.residual.force_x_n = -correction.x;
    channel.mean.residual.force_y_n = -correction.y;
    judge(GW_REGIME_MOTION);
    CHECK(gw_length(correction) > R(3.0));
    CHECK_NEAR(channel.force_n.x, GW_ZERO, R(10.0) * ROUNDING);
    CHECK_NEAR(channel.force_n.y, GW_ZERO, R(10.0) * ROUNDING);
    CHECK(channel.statistic < ROUNDING);
}

/* The mean of n samples after a zero: n/(n + 1) of a constant. */
static void the_first_mean_begins_at_zero(void)
{
    begin();
    balance.residual.force_x_n = R(60.0);
    balance.model.inertia_n.y = R(-30.0);
    for (uint32_t n = 1U; n <= 9U; n++) {
        gw_slow_channel_begin(&channel, &balance, GW_ONE / (gw_real_t)(n + 1U));
    }
    CHECK_NEAR(channel.mean.residual.force_x_n, R(54.0), R(60.0) * ROUNDING);
    CHECK_NEAR(channel.mean.model.inertia_n.y, R(-27.0), R(60.0) * ROUNDING);
    CHECK(channel.baseline.residual.force_x_n == GW_ZERO);
}

/* (1 - e^(-t/T)) of a constant: T is 3 s once the motion has settled, half a second before. */
static void a_baseline_of_seconds_follows_in_motion(void)
{
    for (uint32_t i = 0U; i < 2U; i++) {
        begin();
        channel.mean.residual.force_x_n = R(10.0);
        channel.mean.model.friction_n.wheel[1] = R(-20.0);
        for (uint32_t call = 0U; call < 125U; call++) {
            gw_slow_channel_follow(&channel, i == 0U);
            CHECK(gw_slow_channel_invariant_holds(&channel));
        }
        const gw_real_t share = -gw_expm1((i == 0U) ? (R(-0.5) / R(3.0)) : R(-1.0));
        unit_row(i);
        CHECK_NEAR(channel.baseline.residual.force_x_n, R(10.0) * share, R(100.0) * ROUNDING);
        CHECK_NEAR(channel.baseline.model.friction_n.wheel[1], R(-20.0) * share, R(200.0) * ROUNDING);
    }
}

/* At rest all that is there now is no push; in motion mean and baseline jump alike. */
static void another_zero_moves_the_baseline_along(void)
{
    const gw_wrench_t jump = {R(3.0), R(-4.0), R(5.0)};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(regimes); i++) {
        const bool rest = (regimes[i] == GW_REGIME_REST);
        begin();
        channel.mean.residual.force_x_n = R(20.0);
        channel.mean.model.inertia_n.x = R(7.0);
        channel.baseline.residual.force_x_n = R(10.0);
        gw_slow_channel_take_zero(&channel, jump, regimes[i]);
        CHECK(gw_slow_channel_invariant_holds(&channel));
        unit_row(i);
        CHECK(channel.mean.residual.force_x_n == R(23.0));
        CHECK(channel.baseline.residual.force_x_n == (rest ? R(23.0) : R(13.0)));
        CHECK((channel.baseline.residual.force_y_n == R(-4.0)) && (channel.baseline.residual.torque_nm == R(5.0)));
        CHECK(channel.baseline.model.inertia_n.x == (rest ? R(7.0) : GW_ZERO));
    }
}

/* However large forces are, and jumps. */
static void the_largest_forces_keep_the_invariant(void)
{
    const gw_real_t sizes[] = {GW_BALANCE_MAX, -GW_BALANCE_MAX, R(1.0), GW_ZERO, R(-100.0)};
    begin();
    for (uint32_t k = 0U; k < 500U; k++) {
        const gw_wrench_t jump = {sizes[k % 5U], sizes[(k / 2U) % 5U], sizes[(k / 3U) % 5U]};
        balance.residual.force_x_n = sizes[k % 5U];
        balance.residual.force_y_n = sizes[(k / 5U) % 5U];
        balance.model.friction_n.wheel[k % 3U] = sizes[(k / 2U) % 5U];
        balance.model.inertia_n.x = sizes[(k / 3U) % 5U];
        unit_row(k);
        steps(20U);
        judge(regimes[k % 3U]);
        gw_slow_channel_take_zero(&channel, jump, regimes[(k / 3U) % 3U]);
        gw_slow_channel_follow(&channel, (k % 2U) == 0U);
        judge(regimes[k % 3U]);
    }
}

static void the_invariant_sees_every_member(void)
{
    begin();
    const gw_slow_channel_t good = channel;
    gw_real_t *const members[] = {&channel.share,
                                  &channel.sliding_n,
                                  &channel.settled_share,
                                  &channel.unsettled_share,
                                  &channel.mean.residual.torque_nm,
                                  &channel.mean.model.inertia_n.x,
                                  &channel.baseline.residual.force_y_n,
                                  &channel.baseline.model.friction_n.wheel[1],
                                  &channel.force_n.x,
                                  &channel.force_n.y,
                                  &channel.statistic};
    CHECK(!gw_slow_channel_invariant_holds(NULL));
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(members); i++) {
        unit_row(i);
        *members[i] = unit_nan();
        CHECK(!gw_slow_channel_invariant_holds(&channel));
        *members[i] = R(-1.1e6);
        CHECK(!gw_slow_channel_invariant_holds(&channel));
        channel = good;
    }
    gw_real_t *const shares[] = {&channel.share, &channel.settled_share, &channel.unsettled_share};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(shares); i++) {
        unit_row(i);
        *shares[i] = unit_above(GW_HALF);
        CHECK(!gw_slow_channel_invariant_holds(&channel));
        channel = good;
    }
    CHECK(gw_slow_channel_invariant_holds(&channel));
}

static void a_restart_forgets_the_signals(void)
{
    begin();
    balance.residual.force_x_n = R(30.0);
    steps(100U);
    gw_slow_channel_follow(&channel, false);
    judge(GW_REGIME_REST);
    gw_slow_channel_restart(&channel);
    CHECK((channel.mean.residual.force_x_n == GW_ZERO) && (channel.baseline.residual.force_x_n == GW_ZERO));
    CHECK((channel.force_n.x == GW_ZERO) && (channel.statistic == GW_ZERO));
    CHECK(channel.share > GW_ZERO);
}

void suite_slow_channel(void)
{
    unit_run("a_push_is_compared_with_the_floor_behind_a_low_pass",
             a_push_is_compared_with_the_floor_behind_a_low_pass);
    unit_run("what_the_model_does_not_know_widens_the_threshold_in_motion",
             what_the_model_does_not_know_widens_the_threshold_in_motion);
    unit_run("usual_ripple_widens_the_threshold_in_motion", usual_ripple_widens_the_threshold_in_motion);
    unit_run("rocking_and_gears_widen_the_threshold", rocking_and_gears_widen_the_threshold);
    unit_run("known_friction_is_no_push", known_friction_is_no_push);
    unit_run("the_first_mean_begins_at_zero", the_first_mean_begins_at_zero);
    unit_run("a_baseline_of_seconds_follows_in_motion", a_baseline_of_seconds_follows_in_motion);
    unit_run("another_zero_moves_the_baseline_along", another_zero_moves_the_baseline_along);
    unit_run("the_largest_forces_keep_the_invariant", the_largest_forces_keep_the_invariant);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
    unit_run("a_restart_forgets_the_signals", a_restart_forgets_the_signals);
}
