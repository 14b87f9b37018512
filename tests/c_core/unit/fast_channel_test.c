#include "usual_noise.h"

#define MULTIPLE R(8.0)

static gw_fast_channel_t channel;
static gw_channels_config_t config;
static gw_follower_t follower;
static gw_kinematics_t kinematics;
static gw_balance_t balance;
static gw_fast_found_t found;
static gw_doubts_t doubts;

static const gw_balance_t no_balance;

static void begin_with(const gw_channels_noise_t *noise)
{
    static const gw_doubts_t no_doubts;
    gw_geometry_config_t geometry;
    gw_geometry_config_trikey(&geometry);
    CHECK_STATUS(gw_kinematics_init(&kinematics, &geometry), GW_STATUS_OK);
    gw_follower_init(&follower, &config.follower, R(0.008));
    gw_fast_channel_init(&channel, &config, noise);
    CHECK(gw_fast_channel_invariant_holds(&channel));
    balance = no_balance;
    doubts = no_doubts;
}

static void begin(void)
{
    gw_channels_config_trikey(&config);
    begin_with(&usual);
}

static void step(gw_regime_t regime, bool quiet)
{
    gw_fast_channel_step(&channel, &config, &kinematics, &follower, &balance, regime, quiet, &found);
    CHECK(gw_fast_channel_invariant_holds(&channel));
    CHECK(gw_in_range(found.statistic, GW_ZERO, GW_TWO * GW_DISTANCE_MAX));
    CHECK(gw_in_range(found.release, GW_ZERO, GW_DISTANCE_MAX));
}

static void steps(uint32_t count)
{
    for (uint32_t i = 0U; i < count; i++) {
        step(GW_REGIME_REST, false);
    }
}

/* The variance of a low-pass, eight tenths of it for the longer ones of encoders, and what the model does not know:
 * none.
 */
static gw_real_t threshold_n2(gw_regime_t regime, uint32_t j)
{
    const gw_real_t floor_n = gw_force_floor(config.fast, regime);
    const gw_real_t share = ((j >= 2U) && (channel.sensor == GW_BY_ENCODERS)) ? R(0.8) : GW_ONE;
    return ((share * (MULTIPLE * MULTIPLE)) * channel.noise_n2[channel.sensor][regime][j]) + (floor_n * floor_n);
}

/* Of a step of 1 behind the low-pass of second order, 95 rad/s, zeta 0.55: 1 - e^(-zeta w t) (cos + r sin)(w_d t) with
 * r = zeta/sqrt(1 - zeta^2) = 0.65856, w_d = w sqrt(1 - zeta^2) = 79.341 rad/s. */
static gw_real_t swung(gw_real_t time_s)
{
    const gw_rotation_t turn = gw_sincos(gw_wrap_angle(R(79.341) * time_s));
    return GW_ONE - (gw_exp(R(-52.25) * time_s) * (turn.cosine + (R(0.65856) * turn.sine)));
}

/* F (1 - e^(-t/tau)), and of the third the closed form above, to which steps of w T = 0.095 come within 4 %. */
static void a_step_of_force_passes_the_bank_as_a_low_pass_says(void)
{
    for (uint32_t sensor = 0U; sensor < GW_SENSOR_COUNT; sensor++) {
        begin();
        gw_fast_channel_feel(&channel, sensor == GW_BY_IMU, GW_ZERO);
        balance.residual.force_x_n = R(40.0);
        balance.residual.force_y_n = R(-30.0);
        balance.residual.torque_nm = R(2.0);
        for (uint32_t tick = 1U; tick <= 200U; tick++) {
            steps(1U);
            for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
                const gw_real_t time_s = PERIOD * (gw_real_t)tick;
                const bool swings = (j == 2U);
                const gw_real_t passed =
                    swings ? swung(time_s) : -gw_expm1(-time_s / gw_fast_channel_time(&channel, j));
                /* Every tick of the others rounds once. */
                const gw_real_t error = swings ? R(0.04) : (R(5.0) * ROUNDING);
                unit_row((sensor * 1000U) + tick);
                CHECK_NEAR(channel.bank[j].force_x_n, R(40.0) * passed, R(40.0) * error);
                CHECK_NEAR(channel.bank[j].force_y_n, R(-30.0) * passed, R(40.0) * error);
                CHECK_NEAR(channel.bank[j].torque_nm, R(2.0) * passed, R(2.0) * error);
            }
        }
        CHECK(gw_fast_channel_time(&channel, 0U) == ((sensor == GW_BY_IMU) ? R(0.0015) : R(0.002)));
    }
}

/* x^2/(k^2 n^2 + floor^2) of the low-pass that has the largest, in each regime. */
static void the_statistic_is_the_force_over_its_threshold(void)
{
    const gw_regime_t regimes[] = {GW_REGIME_REST, GW_REGIME_CREEPING, GW_REGIME_MOTION};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(regimes); i++) {
        uint32_t seen = 0U;
        begin();
        balance.residual.force_x_n = R(24.0);
        balance.residual.force_y_n = R(18.0);
        for (uint32_t tick = 1U; tick <= 300U; tick++) {
            gw_real_t largest = GW_ZERO;
            uint32_t widest = 0U;
            step(regimes[i], false);
            for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
                const gw_real_t x = channel.bank[j].force_x_n;
                const gw_real_t y = channel.bank[j].force_y_n;
                const gw_real_t statistic = ((x * x) + (y * y)) / threshold_n2(regimes[i], j);
                widest = (statistic > largest) ? j : widest;
                largest = gw_max(statistic, largest);
            }
            unit_row((i * 1000U) + tick);
            CHECK_NEAR(found.statistic, largest, largest * ROUNDING);
            CHECK(channel.bank[found.widest].force_x_n >= (channel.bank[widest].force_x_n * (GW_ONE - R(0.01))));
            seen |= (uint32_t)1U << found.widest;
        }
        /* First the shortest, unless counts are too coarse for it, in the end the longest. */
        CHECK((seen & ((i == 2U) ? 7U : 1U)) != 0U);
        CHECK((seen & 8U) != 0U);
    }
}

/* What lasts is judged by the longest low-pass: 1 % below its threshold never trips, 1 % above it does. */
static void a_lasting_force_trips_at_the_smallest_threshold(void)
{
    for (uint32_t i = 0U; i < 2U; i++) {
        begin();
        balance.residual.force_x_n = gw_sqrt(threshold_n2(GW_REGIME_REST, 3U)) * ((i == 0U) ? R(0.99) : R(1.01));
        gw_real_t largest = GW_ZERO;
        for (uint32_t tick = 0U; tick < 400U; tick++) {
            steps(1U);
            largest = gw_max(largest, found.statistic);
        }
        unit_row(i);
        CHECK((largest > GW_ONE) == (i == 1U));
    }
}

/* M^2/(n^2 g^4/(2 R^2)), g the radius of gyration. */
static void a_moment_alone_trips(void)
{
    const gw_real_t gyration_m2 = R(1.5) / R(35.0);
    const gw_real_t per_force_m2 = (gyration_m2 * gyration_m2) / (GW_TWO * (R(0.25) * R(0.25)));
    begin();
    balance.residual.torque_nm = R(1.0);
    steps(3000U);
    CHECK_NEAR(channel.moment_per_force_m2, per_force_m2, per_force_m2 * ROUNDING);
    CHECK_NEAR(found.statistic, GW_ONE / (threshold_n2(GW_REGIME_REST, 3U) * per_force_m2),
               found.statistic * R(10.0) * ROUNDING);
    CHECK(found.widest == 3U);
    channel.moment_nm2 = R(1000.0);
    steps(1U);
    CHECK(found.statistic < R(0.001));
    /* With an IMU the gyro's noise besides. */
    const gw_real_t floor_n = config.fast.rest_n;
    const gw_real_t square = config.imu_noise_multiple * config.imu_noise_multiple;
    channel.moment_nm2 = GW_ZERO;
    gw_fast_channel_feel(&channel, true, GW_ZERO);
    for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
        channel.gyro_noise_nm2[GW_BY_IMU][j] = R(0.1);
    }
    steps(1U);
    const gw_real_t n2 = (square * channel.noise_n2[GW_BY_IMU][GW_REGIME_REST][3]) + (floor_n * floor_n);
    CHECK_NEAR(found.statistic, GW_ONE / ((n2 * per_force_m2) + (square * R(0.1))),
               found.statistic * R(10.0) * ROUNDING);
}

/* Variances behind the alignment and a low-pass of the bank, of a force of white noise and of the acceleration that the
 * rate filter makes of the differences of a position: the sums of the squared answers to one sample. */
static void answers(uint32_t j, gw_real_t *of_force, gw_real_t *of_position)
{
    gw_rate_filter_constants_t constants;
    gw_lowpass_t aligned;
    gw_lowpass_t rate;
    gw_real_t force = GW_ZERO;
    gw_real_t force_moved = GW_ZERO;
    gw_real_t acceleration = GW_ZERO;
    gw_real_t moved = GW_ZERO;
    CHECK_STATUS(gw_rate_filter_constants(&constants, PERIOD, usual.cutoff_radps, 4U, GW_ZERO), GW_STATUS_OK);
    gw_lowpass_restart(&aligned);
    gw_lowpass_restart(&rate);
    (void)gw_lowpass_step(&aligned, &constants, GW_ZERO, R(1.0e6));
    (void)gw_lowpass_step(&rate, &constants, GW_ZERO, R(1.0e6));
    *of_force = GW_ZERO;
    *of_position = GW_ZERO;
    for (uint32_t i = 0U; i < 2000U; i++) {
        const gw_real_t sample = (i == 0U) ? GW_ONE : GW_ZERO;
        const gw_real_t before = (i == 1U) ? GW_ONE : GW_ZERO;
        const gw_real_t value = gw_lowpass_step(&aligned, &constants, sample, R(1.0e6));
        (void)gw_lowpass_step(&rate, &constants, (sample - before) / PERIOD, R(1.0e6));
        if (j == 2U) {
            force_moved += (channel.swing_share * (value - force)) - (channel.swing_loss * force_moved);
            force += force_moved;
            moved += (channel.swing_share * (rate.derivative - acceleration)) - (channel.swing_loss * moved);
            acceleration += moved;
        } else {
            force += channel.bank_share[GW_BY_ENCODERS][j] * (value - force);
            acceleration += channel.bank_share[GW_BY_ENCODERS][j] * (rate.derivative - acceleration);
        }
        *of_force += force * force;
        *of_position += acceleration * acceleration;
    }
}

/* Against the same filters in discrete time; the prediction is that of continuous ones. The period is half of the
 * shortest time constant, so that the differences are largest there. */
static void the_noise_behind_the_bank_is_predicted(void)
{
    const gw_real_t in_motion[GW_BANK_COUNT] = {R(1.0), R(1.0), R(1.4), R(0.5)};
    const gw_real_t creeping[GW_BANK_COUNT] = {R(2.0), R(2.0), R(0.7), R(0.3)};
    gw_channels_config_trikey(&config);
    for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
        gw_channels_noise_t noise = usual;
        gw_real_t of_force;
        gw_real_t of_position;
        begin();
        answers(j, &of_force, &of_position);
        noise.encoder_step_m = GW_ZERO;
        noise.observed_step_m = GW_ZERO;
        noise.twist_noise_m = GW_ZERO;
        noise.sliding_n = GW_ZERO; /* no ripple */
        begin_with(&noise);
        unit_row(j);
        const gw_real_t *const n2 = channel.noise_n2[GW_BY_ENCODERS][GW_REGIME_REST];
        const gw_real_t *const least = channel.least_noise_n2[GW_BY_ENCODERS][GW_REGIME_REST];
        const gw_real_t force_n2 = (R(0.3) * R(0.3)) * of_force;
        CHECK_NEAR(n2[j], force_n2, R(0.02) * force_n2);
        CHECK_NEAR(least[j], R(0.4) * n2[j], n2[j] * ROUNDING);
        noise.force_noise_n = GW_ZERO;
        noise.twist_noise_m = R(0.00001);
        begin_with(&noise);
        /* Two thirds of a wheel's variance, times M^2. */
        const gw_real_t twist_n2 = ((R(35.0) * R(35.0)) * (R(1.0e-10) * of_position)) * (GW_TWO / GW_WHEELS);
        CHECK_NEAR(n2[j] / twist_n2, GW_ONE, (j == 2U) ? R(0.07) : R(0.06)); /* steps of w T = 0.095 swing more */
        /* Counting is uniform noise of a step's width: besides, once the wheels turn. */
        noise.encoder_step_m = R(0.0001);
        noise.observed_step_m = R(0.0001);
        begin_with(&noise);
        const gw_real_t counting = GW_ONE + (R(100.0) / R(12.0));
        CHECK_NEAR(channel.noise_n2[GW_BY_ENCODERS][GW_REGIME_MOTION][j] / n2[j], in_motion[j] * counting,
                   R(200.0) * ROUNDING);
        CHECK_NEAR(channel.noise_n2[GW_BY_ENCODERS][GW_REGIME_CREEPING][j] / n2[j], creeping[j] * counting,
                   R(200.0) * ROUNDING);
    }
}

/* Of rollers that slide with 20 N 2 %, at first and at least, in both sensors; less of it behind the longer low-passes.
 * Beyond all rollers: 100 kN. */
static void rollers_are_uneven(void)
{
    const gw_real_t passed[GW_BANK_COUNT] = {R(1.0), R(0.9), R(0.7), R(0.4)};
    gw_channels_noise_t noise = usual;
    gw_channels_config_trikey(&config);
    noise.sliding_n = GW_ZERO;
    begin_with(&noise);
    const gw_fast_channel_t even = channel;
    begin();
    for (uint32_t sensor = 0U; sensor < GW_SENSOR_COUNT; sensor++) {
        for (uint32_t set = 0U; set < GW_NOISE_SETS; set++) {
            for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
                const gw_real_t uneven_n = (set == (uint32_t)GW_REGIME_REST) ? GW_ZERO : R(0.4);
                const gw_real_t uneven_n2 = passed[j] * (uneven_n * uneven_n);
                unit_row((100U * sensor) + ((10U * set) + j));
                CHECK_NEAR(channel.noise_n2[sensor][set][j] - even.noise_n2[sensor][set][j], uneven_n2,
                           R(10.0) * ROUNDING * channel.noise_n2[sensor][set][j]);
                CHECK_NEAR(channel.least_noise_n2[sensor][set][j] - even.least_noise_n2[sensor][set][j], uneven_n2,
                           R(10.0) * ROUNDING * channel.least_noise_n2[sensor][set][j]);
            }
        }
    }
    noise.sliding_n = R(1.0e30);
    begin_with(&noise);
    CHECK(channel.noise_n2[GW_BY_ENCODERS][GW_REGIME_MOTION][0] == R(1.0e10));
    CHECK_NEAR(channel.least_noise_n2[GW_BY_IMU][GW_REGIME_CREEPING][3],
               R(4.0e9) + even.least_noise_n2[GW_BY_IMU][GW_REGIME_CREEPING][3], R(4.0e9) * R(10.0) * ROUNDING);
}

/* Sum of twelve uniform numbers: nearly Gaussian, variance 1. */
static gw_real_t gaussian(uint32_t *seed)
{
    gw_real_t sum = R(-6.0);
    for (uint32_t i = 0U; i < 12U; i++) {
        *seed = (*seed * 1664525U) + 1013904223U;
        sum += (gw_real_t)(*seed >> 8U) / R(16777216.0);
    }
    return sum;
}

/* White noise of variance 225 behind a low-pass with the share a: 225 a/(2 - a); behind the one of second order
 * 225 w T/(4 zeta), w T = 0.095. */
static void noise_is_followed(void)
{
    uint32_t seed = 1U;
    begin();
    for (uint32_t tick = 0U; tick < 20000U; tick++) {
        balance.residual.force_x_n = R(15.0) * gaussian(&seed);
        balance.residual.force_y_n = R(15.0) * gaussian(&seed);
        step(GW_REGIME_REST, true);
    }
    for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
        const gw_real_t a = channel.bank_share[GW_BY_ENCODERS][j];
        const gw_real_t n2 = (j == 2U) ? (R(225.0) * (R(0.095) / R(2.2))) : ((R(225.0) * a) / (GW_TWO - a));
        /* Two squares each 4 ms, alike for half a time constant, averaged over 3 s with weights: four standard
         * deviations, and the clipping takes a quarter of a percent. */
        const gw_real_t deviation = gw_sqrt((R(0.002) + (GW_HALF * gw_fast_channel_time(&channel, j))) / R(3.0));
        unit_row(j);
        CHECK_NEAR(channel.noise_n2[GW_BY_ENCODERS][GW_REGIME_REST][j], n2, (R(4.0) * deviation) * n2);
        CHECK(channel.noise_n2[GW_BY_ENCODERS][GW_REGIME_MOTION][j] >=
              channel.least_noise_n2[GW_BY_ENCODERS][GW_REGIME_MOTION][j]);
    }
}

static void noise_is_followed_but_not_below_its_least(void)
{
    begin();
    const gw_fast_channel_t before = channel;
    for (uint32_t tick = 0U; tick < 20000U; tick++) {
        step(GW_REGIME_CREEPING, true);
    }
    for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
        unit_row(j);
        /* Rollers are as uneven slow as fast. */
        for (uint32_t set = GW_REGIME_CREEPING; set <= (uint32_t)GW_REGIME_MOTION; set++) {
            CHECK(channel.noise_n2[GW_BY_ENCODERS][set][j] == before.least_noise_n2[GW_BY_ENCODERS][set][j]);
        }
        /* The others' turn is not now. */
        CHECK(channel.noise_n2[GW_BY_ENCODERS][GW_REGIME_REST][j] ==
              before.noise_n2[GW_BY_ENCODERS][GW_REGIME_REST][j]);
        CHECK(channel.noise_n2[GW_BY_IMU][GW_REGIME_CREEPING][j] == before.noise_n2[GW_BY_IMU][GW_REGIME_CREEPING][j]);
    }
}

/* One low-pass in a tick; an outlier counts as six variances; nothing is learned of a contact, nor of what is as large
 * as half a hit. */
static void an_outlier_counts_little(void)
{
    const struct {
        gw_real_t force_n;
        bool quiet;
        gw_real_t grown; /* variances */
    } rows[] = {{R(0.0), true, R(-1.0)}, {R(3.6), true, R(5.0)}, {R(3.6), false, R(0.0)}, {R(1000.0), true, R(0.0)}};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
            begin();
            gw_real_t *const n2 = channel.noise_n2[GW_BY_ENCODERS][GW_REGIME_MOTION];
            gw_real_t others = GW_ZERO;
            for (uint32_t k = 0U; k < GW_BANK_COUNT; k++) {
                n2[k] = GW_ONE;
                channel.least_noise_n2[GW_BY_ENCODERS][GW_REGIME_MOTION][k] = R(0.001);
                channel.bank[k].force_x_n = rows[i].force_n;
                channel.bank[k].force_y_n = rows[i].force_n;
            }
            balance.residual.force_x_n = rows[i].force_n;
            balance.residual.force_y_n = rows[i].force_n;
            channel.followed = j;
            step(GW_REGIME_MOTION, rows[i].quiet);
            unit_row((10U * i) + j);
            for (uint32_t k = 0U; k < GW_BANK_COUNT; k++) {
                others += (k == j) ? GW_ZERO : gw_abs(n2[k] - GW_ONE);
            }
            CHECK(others == GW_ZERO);
            CHECK_NEAR(n2[j], GW_ONE + (channel.noise_share * rows[i].grown), ROUNDING);
            CHECK(channel.followed == ((j + 1U) % GW_BANK_COUNT));
        }
    }
    CHECK_NEAR(channel.noise_share, -gw_expm1(R(-0.004) / R(3.0)), ROUNDING);
}

/* A contact of 100 N along x has been the baseline since it was given up. */
static void hold_100_n(void)
{
    const gw_vector_t along_x = {GW_ONE, GW_ZERO};
    begin();
    balance.residual.force_x_n = R(100.0);
    steps(500U);
    CHECK(found.statistic > GW_ONE);
    gw_fast_channel_release(&channel, &balance, &found, along_x, false);
    CHECK(gw_fast_channel_invariant_holds(&channel));
    steps(1U);
    CHECK(found.statistic < R(0.001));
}

static void the_end_of_a_contact_is_no_hit(void)
{
    const struct {
        gw_real_t x_n;
        gw_real_t y_n;
        uint32_t pause; /* ticks */
        bool hit;
    } rows[] = {
        {R(0.0), R(0.0), 0U, false},    {R(50.0), R(0.0), 0U, false},
        {R(-100.0), R(0.0), 0U, true},  {R(200.0), R(0.0), 0U, true},
        {R(100.0), R(50.0), 0U, true},  {R(90.0), R(-50.0), 0U, true},
        {R(60.0), R(-40.0), 0U, false}, /* it may turn */
        {R(90.0), R(-130.0), 0U, true}, {R(0.0), R(0.0), 3000U, false},
        {R(0.0), R(0.0), 30000U, true}, /* forgiven for ten seconds or so */
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        gw_real_t largest = GW_ZERO;
        hold_100_n();
        steps(rows[i].pause);
        balance.residual.force_x_n = rows[i].x_n;
        balance.residual.force_y_n = rows[i].y_n;
        for (uint32_t tick = 0U; tick < 300U; tick++) {
            steps(1U);
            gw_fast_channel_follow(&channel, &balance);
            largest = gw_max(largest, found.statistic);
        }
        unit_row(i);
        CHECK((largest > GW_ONE) == rows[i].hit);
    }
}

/* What the third low-pass holds, and the root of its variance with a floor of 4 N besides; for 10 s. */
static void what_may_be_left_of_a_contact_fades(void)
{
    begin();
    const gw_real_t variance = threshold_n2(GW_REGIME_REST, 2U) + R(16.0);
    hold_100_n();
    CHECK_NEAR(channel.held_keep, R(0.9999), ROUNDING);
    CHECK_NEAR(channel.held.force_x_n, R(100.0) * channel.held_keep, R(300.0) * ROUNDING);
    CHECK_NEAR(channel.doubt_n.x, gw_sqrt(variance) * channel.held_keep, R(100.0) * ROUNDING);
    CHECK_NEAR(channel.held_share, channel.held_keep, ROUNDING);
    CHECK((channel.held.force_y_n == GW_ZERO) && (channel.doubt_n.y == GW_ZERO));
    steps(10000U);
    const gw_real_t left = gw_exp(R(-1.00005));
    CHECK_NEAR(channel.held.force_x_n, R(100.0) * left, R(0.2));
    CHECK_NEAR(channel.doubt_n.x, gw_sqrt(variance) * left, R(0.1));
    CHECK_NEAR(channel.held_share, left, R(0.001));
}

/* The baseline follows a contact that grows, the slowest low-pass tells by how much; one that shrinks leaves what was
 * held, and so does one whose contact is being felt. */
static void what_is_held_of_a_contact_grows_with_it(void)
{
    for (uint32_t i = 0U; i < 3U; i++) {
        begin();
        hold_100_n();
        const bool grows = (i == 0U);
        channel.bank[3].force_x_n = (i == 1U) ? R(-60.0) : R(60.0);
        channel.bank[3].force_y_n = R(30.0);
        channel.bank[3].torque_nm = R(12.0);
        const gw_fast_channel_t before = channel;
        step(GW_REGIME_REST, i != 2U);
        unit_row(i);
        const gw_real_t share = grows ? (before.held_share * before.baseline_share) : GW_ZERO;
        const gw_wrench_t *const slowest = &channel.bank[3];
        CHECK_NEAR(channel.held.force_x_n, (before.held_keep * before.held.force_x_n) + (share * slowest->force_x_n),
                   R(200.0) * ROUNDING);
        CHECK_NEAR(channel.held.force_y_n, share * slowest->force_y_n, R(10.0) * ROUNDING);
        CHECK_NEAR(channel.held.torque_nm, share * slowest->torque_nm, R(10.0) * ROUNDING);
        CHECK((channel.held.force_y_n > GW_ZERO) == grows);
    }
}

/* What the baseline carries of a contact follows its growth, its turns and its end; while a contact is felt the
 * baseline stands still. Once it points to the other side there is nothing of it any more. */
static void what_is_carried_of_a_contact_follows_it(void)
{
    begin();
    CHECK((channel.carried_n.x == GW_ZERO) && (channel.carried_n.y == GW_ZERO));
    for (uint32_t i = 0U; i < 3U; i++) {
        hold_100_n();
        CHECK_NEAR(channel.carried_n.x, R(100.0) * channel.held_keep, R(300.0) * ROUNDING);
        channel.bank[3].force_x_n = (i == 1U) ? R(60.0) : R(-60.0);
        channel.bank[3].force_y_n = R(30.0);
        const gw_fast_channel_t before = channel;
        step(GW_REGIME_REST, i != 2U);
        unit_row(i);
        const gw_real_t share = (i == 2U) ? GW_ZERO : (before.held_share * before.baseline_share);
        const gw_wrench_t *const slowest = &channel.bank[3];
        CHECK_NEAR(channel.carried_n.x, (before.held_keep * before.carried_n.x) + (share * slowest->force_x_n),
                   R(200.0) * ROUNDING);
        CHECK_NEAR(channel.carried_n.y, share * slowest->force_y_n, R(10.0) * ROUNDING);
    }
    hold_100_n();
    channel.carried_n.x = R(-1.0);
    channel.carried_n.y = R(5.0);
    steps(1U);
    CHECK((channel.carried_n.x == GW_ZERO) && (channel.carried_n.y == GW_ZERO));
    channel.bank[3].force_x_n = R(60.0); /* nothing that begins later counts as carried */
    step(GW_REGIME_REST, true);
    CHECK((channel.carried_n.x == GW_ZERO) && (channel.carried_n.y == GW_ZERO));
}

/* With a covariance of the model, along (3, 4)/5: d^T M d = (9 * 25 + 24 * 10 + 16 * 50)/25 = 50.6. A force against
 * the direction leaves nothing. */
static void what_the_model_does_not_know_may_be_left_of_a_contact(void)
{
    const gw_vector_t direction = {R(0.6), R(0.8)};
    for (uint32_t i = 0U; i < 2U; i++) {
        const gw_real_t sign = (i == 0U) ? GW_ONE : -GW_ONE;
        begin();
        channel.model_n2.xx = R(25.0);
        channel.model_n2.xy = R(10.0);
        channel.model_n2.yy = R(50.0);
        channel.bank[2].force_x_n = sign * R(30.0);
        channel.bank[2].force_y_n = sign * R(40.0);
        channel.bank[2].torque_nm = R(5.0);
        found.change.force_x_n = R(33.0);
        found.change.force_y_n = R(44.0);
        found.change.torque_nm = R(6.0);
        found.release_n2 = R(49.4);
        balance.residual.force_x_n = R(7.0);
        balance.residual.torque_nm = R(8.0);
        balance.model.friction_n.wheel[1] = R(9.0);
        gw_fast_channel_release(&channel, &balance, &found, direction, false);
        unit_row(i);
        const gw_real_t left = (i == 0U) ? R(50.0) : GW_ZERO;
        CHECK_NEAR(channel.held.force_x_n, R(0.6) * left, R(150.0) * ROUNDING);
        CHECK_NEAR(channel.held.force_y_n, R(0.8) * left, R(150.0) * ROUNDING);
        CHECK_NEAR(channel.held.torque_nm, R(5.0), R(10.0) * ROUNDING);
        CHECK_NEAR(channel.doubt_n.x, R(6.0), R(20.0) * ROUNDING);
        CHECK_NEAR(channel.doubt_n.y, R(8.0), R(20.0) * ROUNDING);
        CHECK(channel.held_share == GW_ONE);
        /* The balance, but for the change beyond what the low-pass holds. */
        CHECK(channel.baseline.model.friction_n.wheel[1] == R(9.0));
        CHECK_NEAR(channel.baseline.residual.force_x_n, R(7.0) + ((sign * R(30.0)) - R(33.0)), R(100.0) * ROUNDING);
        CHECK_NEAR(channel.baseline.residual.force_y_n, (sign * R(40.0)) - R(44.0), R(100.0) * ROUNDING);
        CHECK_NEAR(channel.baseline.residual.torque_nm, R(7.0), R(10.0) * ROUNDING);
        CHECK((channel.bank[0].force_x_n == GW_ZERO) && (channel.bank[2].torque_nm == GW_ZERO));
    }
}

/* A contact that lasts is held whole, not its part along the impulse alone: its end is no hit then. */
static void all_of_a_contact_that_lasts_is_held(void)
{
    const gw_vector_t along_x = {GW_ONE, GW_ZERO};
    begin();
    channel.bank[2].force_x_n = R(-10.0);
    channel.bank[2].force_y_n = R(60.0);
    gw_fast_channel_release(&channel, &balance, &found, along_x, true);
    CHECK((channel.held.force_x_n == R(-10.0)) && (channel.held.force_y_n == R(60.0)));
    CHECK((channel.carried_n.x == R(-10.0)) && (channel.carried_n.y == R(60.0)));
    begin();
    channel.bank[2].force_x_n = R(-10.0);
    channel.bank[2].force_y_n = R(60.0);
    gw_fast_channel_release(&channel, &balance, &found, along_x, false);
    CHECK((channel.held.force_x_n == GW_ZERO) && (channel.held.force_y_n == GW_ZERO));
    CHECK((channel.carried_n.x == GW_ZERO) && (channel.carried_n.y == GW_ZERO));
}

/* Vibration of (0.4 m/s2)^2 at 35 kg is 196 N^2: 3, 1, 0.08 and 0.01 of it pass. */
static void vibration_that_an_imu_sees_counts_at_once(void)
{
    const gw_real_t passed[GW_BANK_COUNT] = {R(3.0), R(1.0), R(0.08), R(0.01)};
    begin();
    gw_fast_channel_feel(&channel, true, R(0.16));
    CHECK_NEAR(channel.shaking_n2, R(196.0), R(200.0) * ROUNDING);
    for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
        const gw_real_t n2 = gw_max(channel.noise_n2[GW_BY_IMU][GW_REGIME_REST][j], passed[j] * R(196.0));
        const gw_real_t threshold = (config.imu_noise_multiple * config.imu_noise_multiple * n2) + R(9.0);
        for (uint32_t k = 0U; k < GW_BANK_COUNT; k++) {
            channel.bank[k].force_x_n = (k == j) ? R(50.0) : GW_ZERO;
        }
        channel.swing.force_x_n = GW_ZERO;
        balance.residual.force_x_n = GW_ZERO;
        const gw_real_t share = (j == 2U) ? channel.swing_share : channel.bank_share[GW_BY_IMU][j];
        const gw_real_t left = R(50.0) * (GW_ONE - share);
        steps(1U);
        unit_row(j);
        CHECK(found.widest == j);
        CHECK_NEAR(found.statistic, (left * left) / threshold, found.statistic * R(10.0) * ROUNDING);
    }
    /* And it is what the noise is followed from. */
    channel.followed = 1U;
    channel.bank[3].force_x_n = GW_ZERO;
    channel.bank[2].force_x_n = GW_ZERO;
    channel.swing.force_x_n = GW_ZERO;
    channel.bank[1].force_x_n = GW_ZERO;
    channel.bank[0].force_x_n = GW_ZERO;
    step(GW_REGIME_REST, true);
    CHECK_NEAR(channel.noise_n2[GW_BY_IMU][GW_REGIME_REST][1], R(196.0) * (GW_ONE - channel.noise_share),
               R(200.0) * ROUNDING);
    gw_fast_channel_feel(&channel, true, GW_REAL_MAX);
    CHECK(gw_fast_channel_invariant_holds(&channel) && (channel.shaking_n2 == R(1.0e10)));
    gw_fast_channel_feel(&channel, true, unit_nan());
    CHECK(gw_fast_channel_invariant_holds(&channel));
    gw_fast_channel_feel(&channel, false, R(0.16));
    CHECK((channel.shaking_n2 == GW_ZERO) && (channel.sensor == GW_BY_ENCODERS));
}

/* What counts add comes at once, and fades with 50 ticks. */
static void counts_add_noise_until_it_has_faded(void)
{
    const struct {
        gw_real_t before;
        gw_real_t counted;
        gw_real_t after;
    } rows[] = {
        {R(0.0), R(0.0), R(0.0)},   {R(0.0), R(0.25), R(0.25)}, {R(0.0), R(1.5), R(1.5)},  {R(0.0), R(2.0), R(2.0)},
        {R(0.0), R(2.5), R(2.0)},   {R(1.0), R(0.0), R(0.98)},  {R(0.5), R(0.0), R(0.49)}, {R(0.5), R(0.6), R(0.6)},
        {R(0.9), R(0.3), R(0.882)}, {R(0.0), R(-1.0), R(0.0)},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        begin();
        CHECK(channel.counted == GW_ZERO);
        channel.counted = rows[i].before;
        gw_fast_channel_count(&channel, rows[i].counted);
        unit_row(i);
        CHECK_NEAR(channel.counted, rows[i].after, ROUNDING);
        CHECK(gw_fast_channel_invariant_holds(&channel));
        gw_fast_channel_restart(&channel);
        CHECK(channel.counted == GW_ZERO);
    }
}

/* 0.75 of it, where wheels turn and the acceleration is the encoders'. */
static void noise_of_counts_widens_the_threshold(void)
{
    const struct {
        gw_regime_t regime;
        bool felt;
        gw_real_t share;
    } rows[] = {{GW_REGIME_REST, false, R(0.0)},
                {GW_REGIME_CREEPING, false, R(0.75)},
                {GW_REGIME_MOTION, false, R(0.75)},
                {GW_REGIME_MOTION, true, R(0.0)}};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
            begin();
            gw_fast_channel_feel(&channel, rows[i].felt, GW_ZERO);
            for (uint32_t k = 0U; k < GW_BANK_COUNT; k++) {
                channel.count_n2[k] = R(10.0) * (gw_real_t)(k + 1U);
            }
            channel.counted = R(0.75);
            channel.bank[j].force_x_n = R(100.0);
            step(rows[i].regime, false);
            const gw_real_t own = rows[i].felt ? config.imu_noise_multiple : MULTIPLE;
            const gw_real_t multiple2 = (((j >= 2U) && (!rows[i].felt)) ? R(0.8) : GW_ONE) * (own * own);
            const gw_real_t floor_n = gw_force_floor(config.fast, rows[i].regime);
            const gw_real_t n2 =
                channel.noise_n2[channel.sensor][rows[i].regime][j] + (rows[i].share * (R(10.0) * (gw_real_t)(j + 1U)));
            const gw_real_t x = channel.bank[j].force_x_n;
            unit_row((10U * i) + j);
            CHECK(found.widest == j);
            CHECK_NEAR(found.statistic, (x * x) / ((multiple2 * n2) + (floor_n * floor_n)),
                       found.statistic * R(10.0) * ROUNDING);
        }
    }
}

/* Whatever counts add: what they bring is felt, and noise like any other. In motion it counts for slow wheels, too. */
static void noise_is_followed_in_all_motion(void)
{
    const struct {
        gw_regime_t regime;
        bool felt;
        gw_real_t counted;
    } rows[] = {{GW_REGIME_MOTION, false, R(0.0)},   {GW_REGIME_MOTION, false, R(2.0)},
                {GW_REGIME_CREEPING, false, R(0.0)}, {GW_REGIME_CREEPING, false, R(1.0)},
                {GW_REGIME_REST, false, R(1.0)},     {GW_REGIME_MOTION, true, R(1.0)}};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        const uint32_t sensor = rows[i].felt ? GW_BY_IMU : GW_BY_ENCODERS;
        for (uint32_t set = 0U; set < GW_NOISE_SETS; set++) {
            begin();
            gw_fast_channel_feel(&channel, rows[i].felt, GW_ZERO);
            gw_real_t *const n2 = &channel.noise_n2[sensor][set][0];
            *n2 = GW_ONE;
            channel.least_noise_n2[sensor][set][0] = R(0.001);
            channel.counted = rows[i].counted;
            channel.followed = 0U;
            /* Half more is felt after the step than was known. */
            channel.bank[0].force_x_n = gw_sqrt(R(1.5)) / (GW_ONE - channel.bank_share[sensor][0]);
            channel.bank[0].force_y_n = channel.bank[0].force_x_n;
            step(rows[i].regime, true);
            const bool follows = ((set != (uint32_t)GW_REGIME_REST) == (rows[i].regime != GW_REGIME_REST));
            unit_row((10U * i) + set);
            CHECK(channel.followed == 1U);
            CHECK_NEAR(*n2, follows ? (GW_ONE + (channel.noise_share * GW_HALF)) : GW_ONE, R(0.1) * ROUNDING);
        }
    }
}

/* Steps of a quarter have a sixteenth of the variance; the other fifteen are what counts add, more to the longer
 * low-passes, as their errors last. Coarser motors than counts add nothing. */
static void observed_motors_are_less_noisy_than_counts(void)
{
    const gw_real_t count_share[GW_BANK_COUNT] = {R(1.0), R(1.0), R(2.0), R(2.0)};
    gw_channels_noise_t noise = usual;
    gw_channels_config_trikey(&config);
    noise.force_noise_n = GW_ZERO;
    noise.twist_noise_m = GW_ZERO;
    noise.sliding_n = GW_ZERO; /* no ripple */
    begin_with(&noise);
    const gw_fast_channel_t by_counts = channel;
    noise.observed_step_m = noise.encoder_step_m / R(4.0);
    begin_with(&noise);
    const gw_fast_channel_t observed = channel;
    noise.observed_step_m = GW_TWO * noise.encoder_step_m;
    begin_with(&noise);
    for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
        unit_row(j);
        CHECK(by_counts.count_n2[j] == GW_ZERO);
        CHECK(channel.count_n2[j] == GW_ZERO);
        for (uint32_t set = 1U; set < GW_NOISE_SETS; set++) {
            const gw_real_t least_n2 = by_counts.least_noise_n2[GW_BY_ENCODERS][set][j];
            const gw_real_t first_n2 = by_counts.noise_n2[GW_BY_ENCODERS][set][j];
            CHECK_NEAR(observed.least_noise_n2[GW_BY_ENCODERS][set][j], least_n2 / R(16.0), least_n2 * ROUNDING);
            CHECK_NEAR(observed.noise_n2[GW_BY_ENCODERS][set][j], first_n2 / R(16.0), first_n2 * ROUNDING);
            CHECK_NEAR(channel.noise_n2[GW_BY_ENCODERS][set][j], R(4.0) * first_n2, R(4.0) * first_n2 * ROUNDING);
        }
    }
    /* The first guess in motion is this share of the prediction. */
    const gw_real_t in_motion[GW_BANK_COUNT] = {R(1.0), R(1.0), R(1.4), R(0.5)};
    for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
        const gw_real_t predicted_n2 = by_counts.noise_n2[GW_BY_ENCODERS][GW_REGIME_MOTION][j] / in_motion[j];
        unit_row(j);
        CHECK_NEAR(observed.count_n2[j], count_share[j] * (predicted_n2 * (R(15.0) / R(16.0))),
                   observed.count_n2[j] * R(10.0) * ROUNDING);
    }
    /* At rest no wheel counts. */
    CHECK(observed.noise_n2[GW_BY_ENCODERS][GW_REGIME_REST][0] ==
          by_counts.noise_n2[GW_BY_ENCODERS][GW_REGIME_REST][0]);
}

/* The baseline jumps with the residual, so nothing changes; or what the longest low-pass holds becomes part of it. */
static void another_zero_moves_the_baseline_along(void)
{
    const gw_wrench_t jump = {R(30.0), R(-20.0), R(4.0)};
    for (uint32_t adopt = 0U; adopt < 2U; adopt++) {
        begin();
        balance.residual.force_x_n = R(2.0);
        balance.residual.force_y_n = R(1.0);
        steps(3000U);
        const gw_real_t before = found.statistic;
        gw_fast_channel_take_zero(&channel, jump, adopt == 1U);
        CHECK(gw_fast_channel_invariant_holds(&channel));
        balance.residual.force_x_n += jump.force_x_n;
        balance.residual.force_y_n += jump.force_y_n;
        balance.residual.torque_nm += jump.torque_nm;
        steps(1U);
        unit_row(adopt);
        CHECK_NEAR(found.change.torque_nm, GW_ZERO, R(10.0) * ROUNDING);
        CHECK_NEAR(found.change.force_x_n, (adopt == 1U) ? GW_ZERO : R(2.0), R(100.0) * ROUNDING);
        CHECK_NEAR(found.change.force_y_n, (adopt == 1U) ? GW_ZERO : R(1.0), R(100.0) * ROUNDING);
        CHECK_NEAR(found.statistic, (adopt == 1U) ? GW_ZERO : before, R(10.0) * ROUNDING);
    }
}

/* F e^(-t/0.3 s) is left of a force that stays: the baseline's first mean, then its low-pass. */
static void the_baseline_follows(void)
{
    begin();
    balance.residual.force_x_n = R(10.0);
    gw_fast_channel_begin(&channel, &balance, GW_HALF);
    CHECK(channel.baseline.residual.force_x_n == R(5.0));
    for (uint32_t tick = 0U; tick < 300U; tick++) {
        gw_fast_channel_follow(&channel, &balance);
    }
    CHECK_NEAR(channel.baseline.residual.force_x_n, R(10.0) - (R(5.0) * gw_exp(R(-1.0))), R(300.0) * ROUNDING);
}

/* What the follower knows is added before anything is compared. */
static void known_friction_is_no_force(void)
{
    begin();
    follower.difference[0] = R(0.5);
    balance.model.friction_n.wheel[0] = R(20.0);
    const gw_vector_t correction = gw_follower_correction(&follower, &kinematics, &balance.model);
    balance.residual.force_x_n = -correction.x;
    balance.residual.force_y_n = -correction.y;
    steps(100U);
    CHECK(gw_length(correction) > R(9.0));
    CHECK_NEAR(found.change.force_x_n, GW_ZERO, R(10.0) * ROUNDING);
    CHECK_NEAR(found.change.force_y_n, GW_ZERO, R(10.0) * ROUNDING);
    CHECK(found.statistic < ROUNDING);
    balance.residual.force_x_n = correction.x; /* the same force with the other sign is one */
    steps(100U);
    CHECK(gw_abs(found.change.force_x_n - (GW_TWO * correction.x)) < (R(100.0) * ROUNDING));
}

/* k_m^2 M of the smoothed change; at rest no roller is between its limits. The moment: 2.5^2 (0.2^2 10^2 +
 * 0.03^2 (30^2 + 40^2) + 0.01^2 30000), and in motion twice the 0.3 of uneven rollers times 0.01^2 30000. */
static void a_model_that_is_doubted_widens_the_threshold(void)
{
    const gw_regime_t regimes[] = {GW_REGIME_REST, GW_REGIME_CREEPING, GW_REGIME_MOTION};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(regimes); i++) {
        begin();
        balance.model.friction_n.wheel[1] = R(5.0);
        channel.model.inertia_n.x = R(30.0);
        channel.model.inertia_n.y = R(40.0);
        channel.model.inertia_moment_nm = R(10.0);
        doubts.forces_n2 = R(30000.0);
        doubts.ripple2 = R(0.3);
        gw_fast_channel_doubt(&channel, &config, &kinematics, &follower, &balance, regimes[i], &doubts);
        const gw_planar_covariance_t of_model =
            gw_model_covariance(&config, &kinematics, &follower, &channel.model, &balance.model,
                                (i == 0U) ? GW_ZERO : R(20.0), config.presliding);
        const gw_planar_covariance_t m =
            gw_ripple_added((i == 0U) ? GW_ZERO : R(0.3), &kinematics, &balance.model.friction_n, of_model);
        unit_row(i);
        CHECK((channel.model_n2.xx == m.xx) && (channel.model_n2.xy == m.xy) && (channel.model_n2.yy == m.yy));
        CHECK_NEAR(channel.moment_nm2,
                   (R(6.25) * (R(4.0) + R(2.25) + R(3.0))) + ((i == 0U) ? GW_ZERO : (R(0.6) * R(3.0))),
                   R(60.0) * ROUNDING);
        balance.model = no_balance.model;
        balance.residual.force_x_n = R(20.0);
        steps(1U);
        const gw_real_t doubted = found.statistic;
        channel.model_n2.xx = GW_ZERO;
        channel.model_n2.xy = GW_ZERO;
        channel.model_n2.yy = GW_ZERO;
        channel.bank[0].force_x_n = GW_ZERO;
        steps(1U);
        CHECK(doubted < found.statistic);
    }
}

/* What the body does while it rocks widens the threshold of a hit, to all sides; the end of a contact waits for it. */
static void rocking_widens_the_threshold_of_a_hit(void)
{
    gw_real_t statistics[2];
    gw_real_t releases[2];
    for (uint32_t i = 0U; i < 2U; i++) {
        begin();
        balance.residual.force_x_n = R(24.0);
        balance.residual.force_y_n = R(18.0);
        channel.bank[2].force_x_n = R(24.0);
        channel.bank[2].force_y_n = R(18.0);
        doubts.rocking_n2 = (i == 0U) ? GW_ZERO : R(900.0);
        gw_fast_channel_doubt(&channel, &config, &kinematics, &follower, &balance, GW_REGIME_REST, &doubts);
        steps(1U);
        CHECK(found.widest == 2U);
        statistics[i] = R(900.0) / found.statistic;
        releases[i] = found.release;
    }
    CHECK_NEAR(statistics[1] - statistics[0], R(900.0), R(1.0e5) * ROUNDING);
    CHECK(releases[0] == releases[1]);
}

/* 0.3 20^2 N^2 times 25, 4, 0.56 and nothing: a wheel that lets go rings to all sides, but not at rest; the end of a
 * contact does not wait for it. */
static void a_wheel_that_lets_go_widens_the_threshold_in_motion(void)
{
    const gw_regime_t regimes[] = {GW_REGIME_REST, GW_REGIME_CREEPING, GW_REGIME_MOTION};
    const gw_real_t shares[] = {R(25.0), R(4.0), R(0.56), R(0.0)};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(regimes); i++) {
        for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
            gw_real_t statistics[2];
            gw_real_t releases[2];
            for (uint32_t k = 0U; k < 2U; k++) {
                begin();
                config.presliding = GW_ZERO;
                doubts.usual2 = (k == 0U) ? GW_ZERO : R(0.3);
                gw_fast_channel_doubt(&channel, &config, &kinematics, &follower, &balance, regimes[i], &doubts);
                channel.bank[j].force_x_n = R(-240.0);
                channel.bank[j].force_y_n = R(180.0);
                step(regimes[i], false);
                CHECK(found.widest == j);
                const gw_wrench_t *const x = &channel.bank[j];
                const gw_real_t square_n2 = (x->force_x_n * x->force_x_n) + (x->force_y_n * x->force_y_n);
                statistics[k] = square_n2 / found.statistic;
                releases[k] = found.release;
            }
            unit_row((4U * i) + j);
            const gw_real_t added_n2 = (i == 0U) ? GW_ZERO : (R(120.0) * shares[j]);
            CHECK_NEAR(statistics[1] - statistics[0], added_n2, statistics[1] * R(1000.0) * ROUNDING);
            CHECK(releases[0] == releases[1]);
        }
    }
}

/* 2.4e9 20^2 N^2 are below what is kept, 2.6e9 are above; a restart forgets it. */
static void a_wheel_holds_no_more_than_the_largest(void)
{
    begin();
    doubts.usual2 = R(2.4e9);
    gw_fast_channel_doubt(&channel, &config, &kinematics, &follower, &balance, GW_REGIME_MOTION, &doubts);
    CHECK_NEAR(channel.letting_go_n2, R(9.6e11), R(9.6e11) * ROUNDING);
    doubts.usual2 = R(2.6e9);
    gw_fast_channel_doubt(&channel, &config, &kinematics, &follower, &balance, GW_REGIME_MOTION, &doubts);
    CHECK(channel.letting_go_n2 == R(1.0e12));
    gw_fast_channel_restart(&channel);
    CHECK(channel.letting_go_n2 == GW_ZERO);
}

/* What gears may be wrong by widens it, too, and the end of a contact; each at the wheels' distance from the centre. */
static void doubt_of_gears_is_one_of_the_model(void)
{
    const gw_real_t arm_m = kinematics.wheel_distance_m;
    begin();
    gw_fast_channel_doubt(&channel, &config, &kinematics, &follower, &balance, GW_REGIME_MOTION, &doubts);
    const gw_fast_channel_t sure = channel;
    doubts.gear_n2 = R(900.0);
    gw_fast_channel_doubt(&channel, &config, &kinematics, &follower, &balance, GW_REGIME_MOTION, &doubts);
    CHECK_NEAR(channel.model_n2.xx - sure.model_n2.xx, R(900.0), R(1.0e4) * ROUNDING);
    CHECK_NEAR(channel.model_n2.yy - sure.model_n2.yy, R(900.0), R(1.0e4) * ROUNDING);
    CHECK(channel.model_n2.xy == sure.model_n2.xy);
    CHECK_NEAR(channel.moment_nm2 - sure.moment_nm2, R(1800.0) * (arm_m * arm_m), R(1.0e4) * ROUNDING);
}

/* The first wheel is in front and rolls to the left: (I/M)^2/(4 R^2) of the force's variance is that of the moment. */
static void doubt_of_a_wheel_that_slips_is_one_of_the_model(void)
{
    const gw_real_t gyration_m2 = R(1.5) / R(35.0);
    begin();
    gw_fast_channel_doubt(&channel, &config, &kinematics, &follower, &balance, GW_REGIME_MOTION, &doubts);
    const gw_fast_channel_t sure = channel;
    doubts.slip.wheel_n2.wheel[0] = R(900.0);
    gw_fast_channel_doubt(&channel, &config, &kinematics, &follower, &balance, GW_REGIME_MOTION, &doubts);
    CHECK_NEAR(channel.model_n2.xx, sure.model_n2.xx, R(1.0e4) * ROUNDING);
    CHECK_NEAR(channel.model_n2.xy, sure.model_n2.xy, R(1.0e4) * ROUNDING);
    CHECK_NEAR(channel.model_n2.yy - sure.model_n2.yy, R(900.0), R(1.0e4) * ROUNDING);
    CHECK_NEAR(channel.moment_nm2 - sure.moment_nm2,
               (R(900.0) * (gyration_m2 * gyration_m2)) / (R(4.0) * (R(0.25) * R(0.25))), R(100.0) * ROUNDING);
}

/* What a baseline holds of a contact's moment is forgiven against it, wherever the force points. */
static void a_moment_that_unwinds_is_no_hit(void)
{
    const struct {
        gw_real_t force_n;
        gw_real_t torque_nm;
        bool forgiven;
    } rows[] = {{R(1.0), R(-4.0), true}, {R(-1.0), R(-4.0), true}, {R(1.0), R(4.0), false}};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        begin();
        channel.held.force_x_n = R(50.0);
        channel.held.torque_nm = R(5.0);
        channel.bank[3].force_x_n = rows[i].force_n;
        channel.bank[3].torque_nm = rows[i].torque_nm;
        balance.residual.force_x_n = rows[i].force_n;
        balance.residual.torque_nm = rows[i].torque_nm;
        steps(1U);
        unit_row(i);
        CHECK((found.statistic < GW_ONE) == rows[i].forgiven);
    }
}

/* Below this share of the square of 3 N, behind the second low-pass. */
static void calm_is_a_share_of_the_floor_at_rest(void)
{
    const struct {
        gw_real_t x_n;
        gw_real_t y_n;
        bool calm;
    } rows[] = {{R(1.19), R(0.9), true}, {R(1.21), R(0.9), false}, {R(1.2), R(0.89), true}, {R(1.2), R(0.91), false}};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        begin();
        channel.bank[0].force_x_n = R(50.0);
        channel.bank[2].force_x_n = R(50.0);
        channel.bank[1].force_x_n = rows[i].x_n;
        channel.bank[1].force_y_n = rows[i].y_n;
        unit_row(i);
        CHECK(gw_fast_channel_is_calm(&channel, &config, R(0.25)) == rows[i].calm);
    }
}

/* Rollers that carry less than one that slides: the robot turns on the spot, the encoders' errors are the same. */
static void wheels_that_turn_alike_count_alike(void)
{
    const struct {
        gw_regime_t regime;
        bool felt;
        gw_real_t forces_n2; /* one that slides: 20^2 */
        bool alike;
    } rows[] = {
        {GW_REGIME_MOTION, false, R(399.0), true},  {GW_REGIME_CREEPING, false, R(0.0), true},
        {GW_REGIME_MOTION, false, R(400.0), false}, {GW_REGIME_REST, false, R(399.0), false},
        {GW_REGIME_MOTION, true, R(399.0), false},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        begin();
        CHECK(channel.moment_noise_m2 == channel.moment_per_force_m2);
        gw_fast_channel_feel(&channel, rows[i].felt, GW_ZERO);
        doubts.forces_n2 = rows[i].forces_n2;
        gw_fast_channel_doubt(&channel, &config, &kinematics, &follower, &balance, rows[i].regime, &doubts);
        unit_row(i);
        CHECK(channel.moment_noise_m2 == ((rows[i].alike ? R(3.0) : GW_ONE) * channel.moment_per_force_m2));
        /* What the levers add does not count here. */
        channel.moment_nm2 = GW_ZERO;
        channel.bank[3].torque_nm = R(1.0);
        balance.residual.torque_nm = R(1.0);
        step(rows[i].regime, false);
        const gw_real_t before = found.statistic;
        channel.moment_noise_m2 = GW_TWO * channel.moment_noise_m2;
        channel.bank[3].torque_nm = R(1.0);
        step(rows[i].regime, false);
        CHECK(found.statistic < before);
    }
}

/* 0.03 (M dv/tau)^2 to the square of the noise's multiple, of the moment alone; an IMU does not see wheels. */
static void steps_between_rows_make_the_moment_noisy(void)
{
    const gw_real_t time_s[GW_BANK_COUNT] = {R(0.002), R(0.006), R(0.018), R(0.05)};
    const struct {
        gw_regime_t regime;
        bool felt;
        bool seen;
    } rows[] = {{GW_REGIME_MOTION, false, true},
                {GW_REGIME_CREEPING, false, true},
                {GW_REGIME_REST, false, false},
                {GW_REGIME_MOTION, true, false}};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
            gw_real_t variances[2];
            gw_real_t of_force[2];
            begin();
            gw_fast_channel_feel(&channel, rows[i].felt, GW_ZERO);
            const gw_fast_channel_t before = channel;
            for (uint32_t k = 0U; k < 2U; k++) {
                channel = before;
                doubts.row_m2ps2 = (k == 0U) ? GW_ZERO : R(1.0e-4);
                gw_fast_channel_doubt(&channel, &config, &kinematics, &follower, &balance, rows[i].regime, &doubts);
                const gw_fast_channel_t doubted = channel;
                channel.bank[j].torque_nm = R(5.0);
                step(rows[i].regime, false);
                variances[k] = (channel.bank[j].torque_nm * channel.bank[j].torque_nm) / found.statistic;
                CHECK(found.widest == j);
                channel = doubted;
                channel.bank[j].force_x_n = R(10.0);
                step(rows[i].regime, false);
                of_force[k] = found.statistic;
            }
            const gw_real_t force_n = (R(35.0) * R(0.01)) / time_s[j];
            const gw_real_t share = (j < 2U) ? GW_ONE : R(0.8);
            const gw_real_t expected_nm2 =
                ((share * (MULTIPLE * MULTIPLE)) * (R(0.03) * (force_n * force_n))) * channel.moment_noise_m2;
            unit_row((10U * i) + j);
            CHECK_NEAR(variances[1] - variances[0], rows[i].seen ? expected_nm2 : GW_ZERO,
                       variances[1] * R(100.0) * ROUNDING);
            CHECK(of_force[0] == of_force[1]);
        }
    }
}

static void a_restart_keeps_what_was_learned_of_the_noise(void)
{
    hold_100_n();
    channel.row_m2ps2 = GW_ONE;
    gw_fast_channel_feel(&channel, true, R(1.0));
    channel.noise_n2[GW_BY_IMU][GW_REGIME_MOTION][1] = R(123.0);
    gw_fast_channel_restart(&channel);
    CHECK(gw_fast_channel_invariant_holds(&channel));
    CHECK(channel.noise_n2[GW_BY_IMU][GW_REGIME_MOTION][1] == R(123.0));
    CHECK((channel.held.force_x_n == GW_ZERO) && (channel.held_share == GW_ZERO) &&
          (channel.baseline.residual.force_x_n == GW_ZERO));
    CHECK((channel.sensor == GW_BY_ENCODERS) && (channel.shaking_n2 == GW_ZERO) && (channel.row_m2ps2 == GW_ZERO));
}

/* The largest robot with the worst sensors, and the smallest with perfect ones; any forces. */
static void any_robot_keeps_the_invariant(void)
{
    const gw_channels_noise_t rows[] = {
        {R(0.1),
         R(5000.0),
         R(1.0e6),
         R(0.1),
         R(1.0e6),
         R(1.0e6),
         R(1.0e9),
         R(1000.0),
         R(1.0e3),
         R(0.01),
         {R(100.0), R(100.0), R(100.0), R(10.0), R(5000.0)}},
        {R(0.0001),
         R(1.0),
         R(0.0),
         R(0.0),
         R(0.0),
         R(0.0),
         R(0.0),
         R(0.1),
         R(0.0001),
         R(10.0),
         {R(0.0001), R(0.0), R(0.00001), R(0.0), R(10.0)}},
    };
    const gw_real_t sizes[] = {GW_BALANCE_MAX, -GW_BALANCE_MAX, R(1.0), GW_ZERO, R(-100.0)};
    const gw_vector_t direction = {R(-0.6), R(0.8)};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        gw_channels_config_trikey(&config);
        begin_with(&rows[i]);
        unit_row(i);
        for (uint32_t k = 0U; k < 500U; k++) {
            balance.residual.force_x_n = sizes[k % 5U];
            balance.residual.force_y_n = sizes[(k / 5U) % 5U];
            balance.residual.torque_nm = sizes[(k / 7U) % 5U];
            balance.model.friction_n.wheel[k % 3U] = sizes[(k / 2U) % 5U];
            balance.model.inertia_n.x = sizes[(k / 3U) % 5U];
            gw_fast_channel_feel(&channel, (k % 2U) == 0U, sizes[k % 5U]);
            gw_fast_channel_count(&channel, (gw_real_t)(k % 13U) / R(6.0));
            doubts.forces_n2 = R(5.0e10);
            doubts.rocking_n2 = R(1.0e12);
            doubts.gear_n2 = R(1.0e12);
            doubts.usual2 = R(4.0e4);
            doubts.slip.wheel_n2.wheel[k % 3U] = R(1.0e12);
            gw_fast_channel_doubt(&channel, &config, &kinematics, &follower, &balance, GW_REGIME_MOTION, &doubts);
            step((gw_regime_t)(k % 3U), true);
            if ((k % 11U) == 0U) {
                gw_fast_channel_release(&channel, &balance, &found, direction, (k % 2U) == 0U);
                CHECK(gw_fast_channel_invariant_holds(&channel));
                gw_fast_channel_take_zero(&channel, balance.residual, true);
            }
            CHECK(gw_fast_channel_invariant_holds(&channel));
        }
    }
}

static void the_invariant_sees_every_member(void)
{
    gw_fast_channel_t good;
    begin();
    good = channel;
    gw_real_t *const members[] = {&channel.baseline_share,
                                  &channel.model_share,
                                  &channel.noise_share,
                                  &channel.held_keep,
                                  &channel.swing_share,
                                  &channel.swing_loss,
                                  &channel.sliding_n,
                                  &channel.moment_per_force_m2,
                                  &channel.shaking_n2,
                                  &channel.counted,
                                  &channel.swing.force_y_n,
                                  &channel.baseline.residual.force_x_n,
                                  &channel.baseline.model.inertia_n.y,
                                  &channel.model.friction_n.wheel[2],
                                  &channel.model_n2.xx,
                                  &channel.model_n2.xy,
                                  &channel.model_n2.yy,
                                  &channel.moment_nm2,
                                  &channel.rocking_n2,
                                  &channel.letting_go_n2,
                                  &channel.row_m2ps2,
                                  &channel.moment_noise_m2,
                                  &channel.held.force_x_n,
                                  &channel.held.force_y_n,
                                  &channel.held.torque_nm,
                                  &channel.doubt_n.x,
                                  &channel.doubt_n.y,
                                  &channel.carried_n.x,
                                  &channel.carried_n.y,
                                  &channel.held_share};
    CHECK(!gw_fast_channel_invariant_holds(NULL));
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(members); i++) {
        unit_row(i);
        *members[i] = unit_nan();
        CHECK(!gw_fast_channel_invariant_holds(&channel));
        *members[i] = R(-1.0e30);
        CHECK(!gw_fast_channel_invariant_holds(&channel));
        channel = good;
    }
    channel.counted = GW_TWO;
    CHECK(gw_fast_channel_invariant_holds(&channel));
    channel.counted = unit_above(GW_TWO);
    CHECK(!gw_fast_channel_invariant_holds(&channel));
    channel = good;
    channel.followed = GW_BANK_COUNT;
    CHECK(!gw_fast_channel_invariant_holds(&channel));
    channel = good;
    channel.sensor = GW_SENSOR_COUNT;
    CHECK(!gw_fast_channel_invariant_holds(&channel));
    channel = good;
    for (uint32_t j = 0U; j < GW_BANK_COUNT; j++) {
        unit_row(100U + j);
        channel.count_n2[j] = unit_above(R(1.0e10));
        CHECK(!gw_fast_channel_invariant_holds(&channel));
        channel.count_n2[j] = R(-1.0);
        CHECK(!gw_fast_channel_invariant_holds(&channel));
        channel = good;
        channel.row_kg2ps2[j] = unit_above(R(1.0e12));
        CHECK(!gw_fast_channel_invariant_holds(&channel));
        channel.row_kg2ps2[j] = R(-1.0);
        CHECK(!gw_fast_channel_invariant_holds(&channel));
        channel = good;
        channel.bank[j].torque_nm = unit_above(GW_CHANGE_MAX);
        CHECK(!gw_fast_channel_invariant_holds(&channel));
        channel = good;
        for (uint32_t sensor = 0U; sensor < GW_SENSOR_COUNT; sensor++) {
            channel.bank_share[sensor][j] = unit_above(GW_HALF);
            CHECK(!gw_fast_channel_invariant_holds(&channel));
            channel = good;
            channel.gyro_noise_nm2[sensor][j] = R(-1.0);
            CHECK(!gw_fast_channel_invariant_holds(&channel));
            channel = good;
            for (uint32_t set = 0U; set < GW_NOISE_SETS; set++) {
                channel.least_noise_n2[sensor][set][j] = unit_above(R(1.0e10));
                CHECK(!gw_fast_channel_invariant_holds(&channel));
                channel = good;
                channel.noise_n2[sensor][set][j] = unit_nan();
                CHECK(!gw_fast_channel_invariant_holds(&channel));
                channel = good;
            }
        }
    }
    CHECK(gw_fast_channel_invariant_holds(&channel));
}

void suite_fast_channel(void)
{
    unit_run("a_step_of_force_passes_the_bank_as_a_low_pass_says", a_step_of_force_passes_the_bank_as_a_low_pass_says);
    unit_run("the_statistic_is_the_force_over_its_threshold", the_statistic_is_the_force_over_its_threshold);
    unit_run("a_lasting_force_trips_at_the_smallest_threshold", a_lasting_force_trips_at_the_smallest_threshold);
    unit_run("a_moment_alone_trips", a_moment_alone_trips);
    unit_run("the_noise_behind_the_bank_is_predicted", the_noise_behind_the_bank_is_predicted);
    unit_run("rollers_are_uneven", rollers_are_uneven);
    unit_run("noise_is_followed", noise_is_followed);
    unit_run("noise_is_followed_but_not_below_its_least", noise_is_followed_but_not_below_its_least);
    unit_run("an_outlier_counts_little", an_outlier_counts_little);
    unit_run("the_end_of_a_contact_is_no_hit", the_end_of_a_contact_is_no_hit);
    unit_run("what_may_be_left_of_a_contact_fades", what_may_be_left_of_a_contact_fades);
    unit_run("what_is_held_of_a_contact_grows_with_it", what_is_held_of_a_contact_grows_with_it);
    unit_run("what_the_model_does_not_know_may_be_left_of_a_contact",
             what_the_model_does_not_know_may_be_left_of_a_contact);
    unit_run("what_is_carried_of_a_contact_follows_it", what_is_carried_of_a_contact_follows_it);
    unit_run("all_of_a_contact_that_lasts_is_held", all_of_a_contact_that_lasts_is_held);
    unit_run("vibration_that_an_imu_sees_counts_at_once", vibration_that_an_imu_sees_counts_at_once);
    unit_run("counts_add_noise_until_it_has_faded", counts_add_noise_until_it_has_faded);
    unit_run("noise_of_counts_widens_the_threshold", noise_of_counts_widens_the_threshold);
    unit_run("noise_is_followed_in_all_motion", noise_is_followed_in_all_motion);
    unit_run("observed_motors_are_less_noisy_than_counts", observed_motors_are_less_noisy_than_counts);
    unit_run("another_zero_moves_the_baseline_along", another_zero_moves_the_baseline_along);
    unit_run("the_baseline_follows", the_baseline_follows);
    unit_run("known_friction_is_no_force", known_friction_is_no_force);
    unit_run("a_model_that_is_doubted_widens_the_threshold", a_model_that_is_doubted_widens_the_threshold);
    unit_run("wheels_that_turn_alike_count_alike", wheels_that_turn_alike_count_alike);
    unit_run("steps_between_rows_make_the_moment_noisy", steps_between_rows_make_the_moment_noisy);
    unit_run("a_restart_keeps_what_was_learned_of_the_noise", a_restart_keeps_what_was_learned_of_the_noise);
    unit_run("any_robot_keeps_the_invariant", any_robot_keeps_the_invariant);
    unit_run("rocking_widens_the_threshold_of_a_hit", rocking_widens_the_threshold_of_a_hit);
    unit_run("a_wheel_that_lets_go_widens_the_threshold_in_motion",
             a_wheel_that_lets_go_widens_the_threshold_in_motion);
    unit_run("a_wheel_holds_no_more_than_the_largest", a_wheel_holds_no_more_than_the_largest);
    unit_run("doubt_of_gears_is_one_of_the_model", doubt_of_gears_is_one_of_the_model);
    unit_run("doubt_of_a_wheel_that_slips_is_one_of_the_model", doubt_of_a_wheel_that_slips_is_one_of_the_model);
    unit_run("a_moment_that_unwinds_is_no_hit", a_moment_that_unwinds_is_no_hit);
    unit_run("calm_is_a_share_of_the_floor_at_rest", calm_is_a_share_of_the_floor_at_rest);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
}
