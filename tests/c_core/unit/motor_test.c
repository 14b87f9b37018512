/* Expected numbers are from an independent model in Python, in double: the servo as two of its ticks, the gains by
 * Ackermann's formula. */
#include "unit.h"

#define PERIOD R(0.001)
#define COUNTS 8000U
#define RAD_PER_COUNT R(0.0007853981633974483)
#define STIFFNESS R(500.0)
#define INERTIA R(0.001) /* so light that a torque of 1 N m changes the rate by 1 rad/s in a tick */

/* Of gw_motor.c: what is tuned there. */
#define QUICK R(200.0)
#define SLOW R(0.07)
#define SURPRISE R(1.5)
#define SURE 30U
#define SHARE R(0.03125)
#define ONE_ALIKE R(0.35)
#define MORE_ALIKE R(1.0)
#define CUTOFF R(40.0)

static gw_motor_t motor;
static gw_motor_config_t config;
static int32_t counts[GW_WHEEL_COUNT];
static gw_wheels_t torque;
static gw_wheels_t twist;
static gw_real_t counted;

static gw_rate_filter_constants_t constants_of(gw_real_t stiffness)
{
    gw_rate_filter_constants_t constants;
    CHECK_STATUS(gw_rate_filter_constants(&constants, PERIOD, R(200.0), COUNTS, stiffness), GW_STATUS_OK);
    return constants;
}

static void begin_with(uint32_t delay)
{
    static const gw_wheels_t no_torque;
    const gw_rate_filter_constants_t constants = constants_of(STIFFNESS);
    config.inertia_kgm2 = INERTIA;
    config.coulomb_torque_nm = GW_ZERO;
    config.kp_nm_per_rad = R(200.0);
    config.kd_nms_per_rad = R(8.0);
    config.torque_limit_nm = R(20.0);
    config.derivative_cutoff_hz = R(60.0);
    config.delay_ticks = delay;
    config.cutoff_radps = R(40.0);
    gw_motor_init(&motor, &config, &constants, COUNTS);
    CHECK(gw_motor_invariant_holds(&motor) && gw_motor_is_known(&motor));
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        counts[i] = 0;
    }
    torque = no_torque;
}

static void tell(gw_real_t angle_rad, gw_real_t speed_radps)
{
    const gw_joint_command_t command = {{angle_rad, angle_rad, angle_rad}, {speed_radps, speed_radps, speed_radps}};
    gw_motor_command(&motor, &command, true);
    CHECK(gw_motor_invariant_holds(&motor));
}

static void step(void)
{
    twist = gw_motor_step(&motor, counts, &torque, &counted);
    CHECK(gw_motor_invariant_holds(&motor));
    CHECK(gw_in_range(counted, GW_ZERO, GW_TWO));
}

/* A command that needs no torque, and a first sample. */
static void begin(void)
{
    begin_with(1U);
    tell(GW_ZERO, GW_ZERO);
    step();
}

/* Nothing is corrected: what is left is the prediction. */
static void correct_nothing(void)
{
    static const gw_motor_gains_t nothing;
    motor.slow = nothing;
    motor.quick = nothing;
}

static void the_robot_s_motor_is_this(void)
{
    gw_motor_config_t none;
    gw_motor_config_trikey(&config);
    gw_motor_config_none(&none);
    CHECK((config.inertia_kgm2 == R(0.0523)) && (config.coulomb_torque_nm == R(2.75)));
    CHECK((config.kp_nm_per_rad == R(189.0)) && (config.kd_nms_per_rad == R(7.02)));
    CHECK((config.torque_limit_nm == R(20.0)) && (config.derivative_cutoff_hz == R(60.0)));
    CHECK((config.delay_ticks == 3U) && (config.cutoff_radps == CUTOFF));
    CHECK(none.inertia_kgm2 == GW_ZERO);
    none.inertia_kgm2 = config.inertia_kgm2;
    CHECK((none.coulomb_torque_nm == config.coulomb_torque_nm) && (none.kp_nm_per_rad == config.kp_nm_per_rad) &&
          (none.kd_nms_per_rad == config.kd_nms_per_rad) && (none.torque_limit_nm == config.torque_limit_nm) &&
          (none.derivative_cutoff_hz == config.derivative_cutoff_hz) && (none.delay_ticks == config.delay_ticks) &&
          (none.cutoff_radps == config.cutoff_radps));
}

/* Each field, just beyond its range; its neighbours on both sides are in config_test.c. */
static void every_field_is_checked(void)
{
    const gw_config_field_t fields[] = {
        GW_FIELD_MOTOR_INERTIA,      GW_FIELD_MOTOR_COULOMB_TORQUE,    GW_FIELD_MOTOR_KP,    GW_FIELD_MOTOR_KD,
        GW_FIELD_MOTOR_TORQUE_LIMIT, GW_FIELD_MOTOR_DERIVATIVE_CUTOFF, GW_FIELD_MOTOR_CUTOFF};
    for (uint32_t i = 0U; i <= UNIT_COUNT_OF(fields); i++) {
        gw_config_error_t error;
        gw_config_field_t field = GW_FIELD_MOTOR_DELAY;
        gw_motor_config_trikey(&config);
        gw_real_t *const members[] = {&config.inertia_kgm2,   &config.coulomb_torque_nm, &config.kp_nm_per_rad,
                                      &config.kd_nms_per_rad, &config.torque_limit_nm,   &config.derivative_cutoff_hz,
                                      &config.cutoff_radps};
        unit_row(i);
        gw_config_check_begin(&error);
        gw_motor_config_check(&config, &error);
        CHECK_STATUS(error.field, GW_FIELD_NONE);
        if (i < UNIT_COUNT_OF(fields)) {
            field = fields[i];
            *members[i] = unit_above(gw_config_limit(field).maximum);
        } else {
            config.delay_ticks = 0U;
        }
        gw_motor_config_check(&config, &error);
        CHECK_STATUS(error.field, field);
    }
}

/* A motor whose inertia or whose drivetrain's twist is not known: counts are taken as they are, from the first tick. */
static void what_is_not_known_is_not_observed(void)
{
    const struct {
        gw_real_t inertia_kgm2;
        gw_real_t stiffness;
        bool known;
    } rows[] = {
        {R(0.0), R(500.0), false},      {R(0.0000009), R(500.0), false}, {R(0.000001), R(500.0), true},
        {R(10.0), R(500.0), true},      {R(0.05), R(0.0), false},        {R(0.05), R(0.000001), true},
        {R(0.05), R(10000000.0), true},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        const gw_rate_filter_constants_t constants = constants_of(rows[i].stiffness);
        begin_with(1U);
        config.inertia_kgm2 = rows[i].inertia_kgm2;
        gw_motor_init(&motor, &config, &constants, COUNTS);
        unit_row(i);
        CHECK(gw_motor_is_known(&motor) == rows[i].known);
        CHECK_NEAR(motor.stiffness_nm_per_rad, rows[i].known ? rows[i].stiffness : GW_ZERO,
                   rows[i].stiffness * ROUNDING);
        CHECK_NEAR(motor.per_inertia, rows[i].known ? (GW_ONE / rows[i].inertia_kgm2) : GW_ZERO,
                   motor.per_inertia * ROUNDING);
        torque.wheel[0] = R(1.0);
        torque.wheel[1] = R(-2.0);
        torque.wheel[2] = R(3.0);
        for (uint32_t k = 0U; k < 50U; k++) {
            tell(GW_ZERO, R(1.0));
            counts[0] += 2;
            step();
            CHECK(counted == ((rows[i].known && (k == 0U)) ? GW_ONE : (rows[i].known ? counted : GW_ZERO)));
            if (!rows[i].known) {
                CHECK((twist.wheel[0] == R(1.0)) && (twist.wheel[1] == R(-2.0)) && (twist.wheel[2] == R(3.0)));
                CHECK((!motor.started) && (motor.wheel[0].count == 0));
            }
        }
        CHECK(motor.started == rows[i].known);
    }
}

/* A compliance below any that a valid stiffness has would overflow; 1e-7 is that of the stiffest. */
static void a_compliance_of_nearly_nothing_is_rigid(void)
{
    const struct {
        gw_real_t compliance;
        bool known;
    } rows[] = {{R(1.0e-30), false}, {unit_below(R(0.95e-7)), false}, {R(0.95e-7), true}};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        gw_rate_filter_constants_t constants = constants_of(STIFFNESS);
        begin_with(1U);
        constants.compliance_rad_per_nm = rows[i].compliance;
        gw_motor_init(&motor, &config, &constants, COUNTS);
        unit_row(i);
        CHECK((gw_motor_is_known(&motor) == rows[i].known) && gw_motor_invariant_holds(&motor));
    }
}

/* Nothing is left of what memory held before. */
static void it_begins_without_commands(void)
{
    const gw_rate_filter_constants_t constants = constants_of(STIFFNESS);
    begin_with(1U);
    for (uint32_t k = 0U; k < (GW_MOTOR_DELAY_MAX + 3U); k++) {
        tell(GW_ONE, GW_ONE);
    }
    step();
    gw_motor_init(&motor, &config, &constants, COUNTS);
    for (uint32_t k = 0U; k < GW_MOTOR_DELAY_MAX; k++) {
        unit_row(k);
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            CHECK((motor.command[k].angle_rad[i] == GW_ZERO) && (motor.command[k].speed_radps[i] == GW_ZERO));
        }
    }
    CHECK((motor.commands == 0U) && (motor.next_command == 0U) && (!motor.started));
}

static void constants_are_these(void)
{
    begin_with(1U);
    CHECK(motor.period_s == PERIOD);
    CHECK_NEAR(motor.rad_per_count, RAD_PER_COUNT, ROUNDING);
    CHECK_NEAR(motor.count_rate, R(0.7853981633974483), ROUNDING);
    CHECK_NEAR(motor.filter_gain, R(0.17179581869313998), ROUNDING); /* 1 - e^(-2 pi 60 0.0005) */
    CHECK((motor.encoder_counts == COUNTS) && (motor.commands == 0U) && (motor.next_command == 0U));
    CHECK(!motor.started);
}

/* Poles e^(-w T), all three, w = 40 and 200 rad/s. Differences of poles near 1 keep fewer digits. */
static void the_observer_has_three_equal_poles(void)
{
    const struct {
        gw_real_t cutoff_radps;
        gw_motor_gains_t gains;
    } rows[] = {
        {R(40.0), {R(0.11307956328284269), R(4.521976767297797), R(60.2849857802051)}},
        {R(200.0), {R(0.45118836390597417), R(89.64125547060804), R(5956.242778945903)}},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        const gw_rate_filter_constants_t constants = constants_of(STIFFNESS);
        begin_with(1U);
        config.cutoff_radps = rows[i].cutoff_radps;
        gw_motor_init(&motor, &config, &constants, COUNTS);
        unit_row(i);
        CHECK_NEAR(motor.slow.angle, rows[i].gains.angle, ROUNDING);
        CHECK_NEAR(motor.slow.rate_per_s, rows[i].gains.rate_per_s, R(10.0) * rows[i].gains.rate_per_s * ROUNDING);
        CHECK_NEAR(motor.slow.unknown_per_s2, rows[i].gains.unknown_per_s2,
                   R(10.0) * rows[i].gains.unknown_per_s2 * ROUNDING);
        /* Before it is trusted: the same with another corner. */
        const gw_motor_gains_t quick = motor.quick;
        config.cutoff_radps = QUICK;
        gw_motor_init(&motor, &config, &constants, COUNTS);
        CHECK((motor.slow.angle == quick.angle) && (motor.slow.rate_per_s == quick.rate_per_s) &&
              (motor.slow.unknown_per_s2 == quick.unknown_per_s2));
    }
}

/* Both ticks of the servo: 200 N m/rad, 8 N m s/rad, 20 N m, 60 Hz; the second at half of what the wheel turned. */
static void the_servo_s_torque_is_this(void)
{
    const struct {
        gw_real_t angle_rad;
        gw_real_t speed_radps;
        int32_t count;
        int32_t moved;
        gw_real_t servo_radps;
        gw_real_t torque_nm;
        gw_real_t filtered_radps;
    } rows[] = {
        {R(0.02), R(1.5), 10, 2, R(0.5), R(9.689830530404025), R(0.8363133910453918)},
        {R(-0.05), R(-1.0), -30, -3, R(-0.9), R(-5.01912879662955), R(-1.3573584114582127)},
        /* across pi, both ways */
        {R(3.1), R(0.4), -3990, 1, R(0.2), R(-8.710872779892489), R(0.3838605872259876)},
        {R(-3.1), R(-0.4), 3990, -1, R(-0.2), R(8.710872779892666), R(-0.3838605872259876)},
        {R(0.0), R(1.0), 7990, 2, R(1.0), R(1.1500148213799881), R(1.179274474012475)},
        {R(0.0), R(1.0), -7990, 2, R(1.0), R(-1.991577832209787), R(1.179274474012475)},
        /* after 200 turns and 1273 counts */
        {R(1.0), R(2.0), 1601273, 1, R(1.7), R(3.1268567760509214), R(1.4127438361272369)},
        /* both ticks at the limit, and one of them: 20.98 and 3.61, 10 and 27.4 */
        {R(1.0), R(0.0), 0, 0, R(0.0), R(20.0), R(0.0)},
        {R(-1.0), R(0.0), 0, 0, R(0.0), R(-20.0), R(0.0)},
        {R(0.1049), R(0.0), 0, 15, R(0.0), R(11.805264148594764), R(3.7001423105873155)},
        {R(-0.1049), R(0.0), 0, -15, R(0.0), R(-11.805264148594764), R(-3.7001423105873155)},
        {R(0.05), R(0.0), 0, -15, R(0.0), R(15.0), R(-3.7001423105873155)},
        {R(-0.05), R(0.0), 0, 15, R(0.0), R(-15.0), R(3.7001423105873155)},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
            begin();
            correct_nothing();
            gw_motor_wheel_t *const wheel = &motor.wheel[k];
            counts[k] = rows[i].count;
            tell(rows[i].angle_rad, rows[i].speed_radps);
            step();
            wheel->servo_radps = rows[i].servo_radps;
            wheel->rate_radps = R(2.0);
            wheel->unknown_radps2 = GW_ZERO;
            counts[k] += rows[i].moved;
            step();
            unit_row((10U * i) + k);
            /* A torque of 1 N m for 1 ms at 0.001 kg m^2. An angle of pi in float is known to 2.4e-7, times 200. */
            CHECK_NEAR(wheel->rate_radps - R(2.0), rows[i].torque_nm, R(40.0) * ROUNDING);
            CHECK_NEAR(wheel->servo_radps, rows[i].filtered_radps, R(4.0) * ROUNDING);
        }
    }
}

/* Of angles that differ by a whole turn one is wrapped, and pi is -pi. 100 N m/rad, and only the sign counts. */
static void half_a_turn_is_the_end_of_the_range(void)
{
    const struct {
        gw_real_t angle_rad;
        gw_real_t sign;
    } rows[] = {{unit_below(GW_PI), GW_ONE}, {GW_PI, -GW_ONE}, {-GW_PI, -GW_ONE}};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        begin();
        correct_nothing();
        tell(rows[i].angle_rad, GW_ZERO);
        motor.wheel[0].rate_radps = R(2.0);
        step();
        unit_row(i);
        CHECK_NEAR(motor.wheel[0].rate_radps, R(2.0) + (R(20.0) * rows[i].sign), R(20.0) * ROUNDING);
    }
}

/* m theta'' = tau_m - B sign(theta') - tau_s + m d, with the mean of both samples of tau_s: the angle grows by
 * T theta' + T^2/2 theta''. Below 0.07 rad/s friction grows with the rate. */
static void a_motor_moves_as_its_torques_make_it_move(void)
{
    const struct {
        gw_real_t rate_radps;
        gw_real_t coulomb_nm;
        gw_real_t sensed_before_nm;
        gw_real_t sensed_nm;
        gw_real_t unknown_radps2;
        gw_real_t gained_radps;
    } rows[] = {
        {R(0.1), R(0.0), R(0.0), R(0.0), R(0.0), R(0.0)},
        {R(0.1), R(0.03), R(0.0), R(0.0), R(0.0), R(-0.03)},
        {R(-0.1), R(0.03), R(0.0), R(0.0), R(0.0), R(0.03)},
        {SLOW * R(0.5), R(0.02), R(0.0), R(0.0), R(0.0), R(-0.01)},
        {SLOW * R(-0.5), R(0.02), R(0.0), R(0.0), R(0.0), R(0.01)},
        {R(0.0), R(0.02), R(0.0), R(0.0), R(0.0), R(0.0)},
        {R(0.1), R(0.0), R(0.04), R(0.0), R(0.0), R(-0.02)},
        {R(0.1), R(0.0), R(0.0), R(0.04), R(0.0), R(-0.02)},
        {R(0.1), R(0.0), R(-0.04), R(-0.02), R(0.0), R(0.03)},
        {R(0.1), R(0.0), R(0.0), R(0.0), R(30.0), R(0.03)},
        {R(0.1), R(0.05), R(0.04), R(0.02), R(-10.0), R(-0.09)},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        begin();
        correct_nothing();
        motor.config.kp_nm_per_rad = GW_ZERO;
        motor.config.kd_nms_per_rad = GW_ZERO;
        motor.config.coulomb_torque_nm = rows[i].coulomb_nm;
        torque.wheel[1] = rows[i].sensed_before_nm;
        step();
        torque.wheel[1] = rows[i].sensed_nm;
        motor.wheel[1].angle_rad = R(0.0001);
        motor.wheel[1].rate_radps = rows[i].rate_radps;
        motor.wheel[1].unknown_radps2 = rows[i].unknown_radps2;
        step();
        unit_row(i);
        CHECK_NEAR(motor.wheel[1].rate_radps, rows[i].rate_radps + rows[i].gained_radps, R(0.2) * ROUNDING);
        CHECK_NEAR(motor.wheel[1].angle_rad,
                   R(0.0001) + (PERIOD * (rows[i].rate_radps + (GW_HALF * rows[i].gained_radps))), R(0.001) * ROUNDING);
        CHECK(motor.wheel[1].unknown_radps2 == rows[i].unknown_radps2);
        CHECK(motor.wheel[1].torque_nm == rows[i].sensed_nm);
    }
}

/* The prediction is 0.2 counts beyond the middle of the present count. */
static void a_distance_from_the_count_corrects(void)
{
    const gw_motor_gains_t slow = {R(0.25), R(50.0), R(3000.0)};
    const gw_motor_gains_t quick = {GW_HALF, R(100.0), R(20000.0)};
    for (uint32_t i = 0U; i < 4U; i++) {
        const bool trusted = (i < 2U);
        const gw_motor_gains_t gains = trusted ? slow : quick;
        const gw_real_t sign = ((i % 2U) == 0U) ? GW_ONE : -GW_ONE;
        const gw_real_t off_rad = sign * (R(0.2) * RAD_PER_COUNT);
        begin();
        motor.slow = slow;
        motor.quick = quick;
        motor.config.kp_nm_per_rad = GW_ZERO;
        motor.config.kd_nms_per_rad = GW_ZERO;
        gw_motor_wheel_t *const wheel = &motor.wheel[2];
        wheel->sure_ticks = trusted ? SURE : 0U;
        /* Two counts beyond, of which it turned one in this tick, and moves by 0.2 of a count. */
        wheel->angle_rad = sign * RAD_PER_COUNT;
        wheel->rate_radps = sign * (R(0.2) * RAD_PER_COUNT / PERIOD);
        wheel->unknown_radps2 = GW_ZERO;
        counts[2] = (i % 2U == 0U) ? 1 : -1;
        step();
        unit_row(i);
        CHECK_NEAR(wheel->angle_rad, off_rad * (GW_ONE - gains.angle), R(0.002) * ROUNDING);
        CHECK_NEAR(wheel->rate_radps, (off_rad / PERIOD) - (gains.rate_per_s * off_rad), ROUNDING);
        CHECK_NEAR(wheel->unknown_radps2, -(gains.unknown_per_s2 * off_rad), R(20.0) * ROUNDING);
    }
}

static void what_is_kept_is_limited(void)
{
    for (uint32_t i = 0U; i < 2U; i++) {
        const gw_real_t sign = (i == 0U) ? GW_ONE : -GW_ONE;
        begin();
        motor.config.coulomb_torque_nm = GW_ZERO;
        motor.wheel[0].rate_radps = sign * R(1.0e5);
        motor.wheel[0].unknown_radps2 = sign * R(1.0e7);
        motor.wheel[0].share = GW_ONE;
        torque.wheel[0] = -sign * GW_TORQUE_MAX;
        step();
        unit_row(i);
        /* Half of the present count. */
        CHECK(motor.wheel[0].angle_rad == (sign * (GW_HALF * motor.rad_per_count)));
        begin();
        correct_nothing();
        torque.wheel[0] = -sign * GW_TORQUE_MAX;
        step();
        CHECK(motor.wheel[0].rate_radps == (sign * R(1.0e5)));
        begin();
        counts[0] = (i == 0U) ? 1000000000 : -1000000000;
        step();
        CHECK(motor.wheel[0].unknown_radps2 == (sign * R(1.0e7)));
        begin();
        motor.stiffness_nm_per_rad = R(1.1e7);
        motor.rad_per_count = R(1.6);
        motor.wheel[0].angle_rad = sign * R(0.8);
        motor.wheel[0].rate_radps = sign * R(1000.0);
        motor.wheel[0].share = GW_ONE;
        step();
        CHECK(twist.wheel[0] == (-sign * GW_TORQUE_MAX));
    }
}

/* k times the angle beyond the count, as far as the observer is trusted, is what the sensed torque is less. */
static void the_twist_is_that_of_the_observed_angle(void)
{
    const gw_real_t shares[] = {GW_ZERO, GW_HALF, GW_ONE};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(shares); i++) {
        for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
            begin();
            correct_nothing();
            motor.config.kp_nm_per_rad = GW_ZERO;
            motor.config.kd_nms_per_rad = GW_ZERO;
            motor.wheel[k].angle_rad = R(0.0002);
            motor.wheel[k].sure_ticks = SURE;
            motor.wheel[k].share = shares[i];
            motor.wheel[k].rate_radps = R(0.1);
            torque.wheel[0] = GW_ONE;
            torque.wheel[1] = R(2.0);
            torque.wheel[2] = R(3.0);
            for (uint32_t j = 0U; j < GW_WHEEL_COUNT; j++) {
                motor.wheel[j].torque_nm = -torque.wheel[j]; /* their mean is zero */
            }
            step();
            unit_row((10U * i) + k);
            const gw_real_t share = gw_min(shares[i] + SHARE, GW_ONE);
            for (uint32_t j = 0U; j < GW_WHEEL_COUNT; j++) {
                const gw_real_t beyond_nm = (j == k) ? (STIFFNESS * (share * R(0.0003))) : GW_ZERO;
                CHECK_NEAR(twist.wheel[j], torque.wheel[j] - beyond_nm, R(3.0) * ROUNDING);
                CHECK(motor.wheel[j].torque_nm == torque.wheel[j]);
            }
        }
    }
}

/* Neither slow nor surprised for 30 ticks. */
static void an_observer_has_to_be_sure(void)
{
    const struct {
        gw_real_t rate_radps;
        gw_real_t off_counts;
        uint32_t before;
        uint32_t after;
    } rows[] = {
        {R(1.0), R(0.0), 0U, 1U},
        {R(-1.0), R(0.0), 7U, 8U},
        {R(1.0), R(0.0), SURE - 1U, SURE},
        {R(1.0), R(0.0), SURE, SURE},
        {SLOW * R(1.01), R(0.0), 5U, 6U},
        {SLOW * R(0.99), R(0.0), SURE, 0U},
        {SLOW * R(-1.01), R(0.0), 5U, 6U},
        {SLOW * R(-0.99), R(0.0), 5U, 0U},
        {R(1.0), SURPRISE * R(0.99), 5U, 6U},
        {R(1.0), SURPRISE * R(1.01), SURE, 0U},
        {R(-1.0), SURPRISE * R(-0.99), 5U, 6U},
        {R(-1.0), SURPRISE * R(-1.01), 5U, 0U},
        {R(0.0), R(3.0), 5U, 0U},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        begin();
        motor.config.kp_nm_per_rad = GW_ZERO;
        motor.config.kd_nms_per_rad = GW_ZERO;
        gw_motor_wheel_t *const wheel = &motor.wheel[0];
        wheel->rate_radps = rows[i].rate_radps;
        wheel->sure_ticks = rows[i].before;
        wheel->share = GW_HALF;
        wheel->angle_rad = (rows[i].off_counts * RAD_PER_COUNT) - (PERIOD * rows[i].rate_radps);
        step();
        unit_row(i);
        CHECK(wheel->sure_ticks == rows[i].after);
        CHECK(wheel->share == (GW_HALF + ((rows[i].after == SURE) ? SHARE : -SHARE)));
    }
}

/* On the threshold itself it is neither slow nor surprised. */
static void a_threshold_is_not_beyond_itself(void)
{
    begin();
    motor.config.kp_nm_per_rad = GW_ZERO;
    motor.config.kd_nms_per_rad = GW_ZERO;
    motor.wheel[0].rate_radps = SLOW;
    motor.wheel[1].rate_radps = unit_below(SLOW);
    motor.wheel[2].rate_radps = -SLOW;
    step();
    CHECK((motor.wheel[0].sure_ticks == 1U) && (motor.wheel[1].sure_ticks == 0U) && (motor.wheel[2].sure_ticks == 1U));
    begin();
    correct_nothing();
    motor.rad_per_count = GW_HALF; /* so that nothing rounds */
    motor.period_s = R(0.0625);
    motor.config.kp_nm_per_rad = GW_ZERO;
    motor.config.kd_nms_per_rad = GW_ZERO;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        motor.wheel[i].angle_rad = GW_HALF * GW_HALF;
        motor.wheel[i].rate_radps = ((SURPRISE - GW_HALF) * GW_HALF) / motor.period_s;
    }
    motor.wheel[1].rate_radps = unit_above(motor.wheel[1].rate_radps);
    step();
    CHECK((motor.wheel[0].sure_ticks == 1U) && (motor.wheel[1].sure_ticks == 0U) && (motor.wheel[2].sure_ticks == 1U));
}

/* From counts to observer and back in 32 ticks each. */
static void trust_comes_and_goes_gradually(void)
{
    begin();
    correct_nothing();
    motor.config.kp_nm_per_rad = GW_ZERO;
    motor.config.kd_nms_per_rad = GW_ZERO;
    for (uint32_t i = 1U; i <= 100U; i++) {
        motor.wheel[0].rate_radps = GW_ONE;
        step();
        const gw_real_t share = (i < SURE) ? GW_ZERO : gw_min(SHARE * (gw_real_t)((i - SURE) + 1U), GW_ONE);
        unit_row(i);
        counts[0] += ((i % 2U) == 0U) ? 2 : 1; /* 1.5 counts are no surprise for a tick */
        motor.wheel[0].angle_rad = GW_ZERO;
        CHECK(motor.wheel[0].share == share);
    }
    for (uint32_t i = 1U; i <= 40U; i++) {
        motor.wheel[0].rate_radps = GW_ZERO;
        step();
        unit_row(100U + i);
        CHECK(motor.wheel[0].share == gw_max(GW_ONE - (SHARE * (gw_real_t)i), GW_ZERO));
    }
}

/* Trusted, and at the middle of a count, moving two counts in a tick. */
static void trust(gw_motor_wheel_t *wheel)
{
    wheel->share = GW_ONE;
    wheel->sure_ticks = SURE;
    wheel->rate_radps = GW_TWO * motor.count_rate;
    wheel->angle_rad = GW_ZERO;
}

/* Equal counts in eleven ticks: their errors do not change their sign for long, and jump together if there are several.
 */
static void equal_counts_jump(void)
{
    begin();
    correct_nothing();
    motor.config.kp_nm_per_rad = GW_ZERO;
    motor.config.kd_nms_per_rad = GW_ZERO;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        motor.wheel[i].moved = 7;
    }
    for (uint32_t i = 1U; i <= 45U; i++) {
        const bool other[GW_WHEEL_COUNT] = {i == 18U, (i % 8U) == 0U, i <= 22U};
        uint32_t alike = 0U;
        for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
            gw_motor_wheel_t *const wheel = &motor.wheel[k];
            trust(wheel);
            counts[k] += other[k] ? (((i % 2U) == 0U) ? 1 : 3) : 2; /* one more or less is no surprise */
        }
        step();
        unit_row(i);
        for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
            alike += (motor.wheel[k].same_ticks >= GW_MOTOR_SAME_TICKS) ? 1U : 0U;
        }
        CHECK(motor.wheel[1].same_ticks < 8U);
        CHECK(motor.wheel[1].moved == (((i % 8U) == 0U) ? 1 : 2));
        CHECK_NEAR(counted, (alike == 0U) ? GW_ZERO : ((alike == 1U) ? ONE_ALIKE : MORE_ALIKE), ROUNDING);
        /* The first of them was compared with another one; in tick 18 and after it another one, too. */
        const uint32_t same = (i < 18U) ? (i - 1U) : ((i < 19U) ? 0U : (i - 19U));
        CHECK(motor.wheel[0].same_ticks == ((same < GW_MOTOR_SAME_TICKS) ? same : GW_MOTOR_SAME_TICKS));
    }
    CHECK(motor.wheel[2].same_ticks == GW_MOTOR_SAME_TICKS);
    CHECK_NEAR(counted, MORE_ALIKE, ROUNDING);
}

/* Of one wheel, of two and of all three; a wheel of which nothing is used does not jump in what is left. */
static void wheels_that_count_alike_are_counted(void)
{
    const gw_real_t expected[GW_WHEEL_COUNT + 1U] = {GW_ZERO, ONE_ALIKE, MORE_ALIKE, MORE_ALIKE};
    for (uint32_t mask = 0U; mask < 8U; mask++) {
        uint32_t alike = 0U;
        begin();
        correct_nothing();
        motor.config.kp_nm_per_rad = GW_ZERO;
        motor.config.kd_nms_per_rad = GW_ZERO;
        for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
            const bool same = ((mask >> k) & 1U) != 0U;
            trust(&motor.wheel[k]);
            motor.wheel[k].moved = 2;
            motor.wheel[k].same_ticks = same ? GW_MOTOR_SAME_TICKS : (GW_MOTOR_SAME_TICKS - 2U);
            counts[k] = 2;
            alike += same ? 1U : 0U;
        }
        step();
        unit_row(mask);
        CHECK_NEAR(counted, expected[alike], ROUNDING);
        /* Not used: what counts add is that of counts as they are. */
        for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
            trust(&motor.wheel[k]);
            motor.wheel[k].same_ticks = GW_MOTOR_SAME_TICKS;
            motor.wheel[k].sure_ticks = 0U;
            motor.wheel[k].share = GW_ZERO;
            counts[k] = 4;
        }
        step();
        CHECK_NEAR(counted, GW_ONE, ROUNDING);
    }
}

/* Two thirds for each wheel, along which alone it errs, and at most that of all three. */
static void counted_is_a_variance(void)
{
    const struct {
        gw_real_t shares[GW_WHEEL_COUNT];
        gw_real_t counted;
    } rows[] = {
        {{GW_ONE, GW_ONE, GW_ONE}, R(0.0)},
        {{GW_ZERO, GW_ONE, GW_ONE}, R(2.0) / R(3.0)},
        {{GW_ONE, GW_ZERO, GW_ONE}, R(2.0) / R(3.0)},
        {{GW_ONE, GW_ONE, GW_ZERO}, R(2.0) / R(3.0)},
        {{GW_HALF, GW_ONE, GW_ONE}, R(1.0) / R(3.0)},
        {{GW_HALF, GW_HALF, GW_HALF}, GW_ONE},
        {{GW_ZERO, GW_ZERO, GW_ONE}, GW_ONE},
        {{GW_ZERO, GW_ZERO, GW_ZERO}, GW_ONE},
        {{GW_HALF, GW_HALF, GW_ONE}, R(2.0) / R(3.0)},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        begin();
        CHECK(counted == GW_ONE); /* the first sample */
        correct_nothing();
        motor.config.kp_nm_per_rad = GW_ZERO;
        motor.config.kd_nms_per_rad = GW_ZERO;
        for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
            const gw_real_t share = rows[i].shares[k];
            trust(&motor.wheel[k]);
            counts[k] = 2;
            motor.wheel[k].sure_ticks = (share > GW_ZERO) ? SURE : 0U;
            /* It grows in this tick. */
            motor.wheel[k].share = (share == GW_HALF) ? (share - SHARE) : share;
        }
        step();
        unit_row(i);
        CHECK_NEAR(counted, rows[i].counted, ROUNDING);
    }
}

/* The counter may wrap. */
static void a_count_is_a_difference(void)
{
    begin();
    correct_nothing();
    motor.config.kp_nm_per_rad = GW_ZERO;
    motor.config.kd_nms_per_rad = GW_ZERO;
    counts[0] = INT32_MAX;
    counts[1] = INT32_MIN;
    counts[2] = 5;
    step();
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        motor.wheel[i].angle_rad = GW_ZERO;
        motor.wheel[i].rate_radps = GW_ZERO;
    }
    counts[0] = INT32_MIN;
    counts[1] = INT32_MAX;
    counts[2] = 6;
    step();
    CHECK((motor.wheel[0].moved == 1) && (motor.wheel[1].moved == -1) && (motor.wheel[2].moved == 1));
    CHECK((motor.wheel[0].count == INT32_MIN) && (motor.wheel[1].count == INT32_MAX) && (motor.wheel[2].count == 6));
    /* One count before where it is, which is more than half of one. */
    CHECK(motor.wheel[0].angle_rad == (-GW_HALF * motor.rad_per_count));
    CHECK(motor.wheel[1].angle_rad == (GW_HALF * motor.rad_per_count));
}

static void a_gap_forgets_all_but_the_commands(void)
{
    begin();
    for (uint32_t i = 0U; i < 20U; i++) {
        tell(R(0.01) * (gw_real_t)i, R(1.0));
        counts[0] += 2;
        torque.wheel[1] = R(0.5);
        step();
    }
    const gw_motor_t before = motor;
    CHECK(motor.wheel[0].rate_radps > GW_ZERO);
    gw_motor_restart(&motor);
    CHECK(gw_motor_invariant_holds(&motor) && (!motor.started));
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        const gw_motor_wheel_t *const wheel = &motor.wheel[i];
        unit_row(i);
        CHECK((wheel->angle_rad == GW_ZERO) && (wheel->rate_radps == GW_ZERO) && (wheel->unknown_radps2 == GW_ZERO) &&
              (wheel->servo_radps == GW_ZERO) && (wheel->torque_nm == GW_ZERO) && (wheel->count == 0) &&
              (wheel->moved == 0) && (wheel->same_ticks == 0U) && (wheel->sure_ticks == 0U) &&
              (wheel->share == GW_ZERO));
    }
    CHECK((motor.commands == before.commands) && (motor.next_command == before.next_command) && motor.known);
    for (uint32_t k = 0U; k < GW_MOTOR_DELAY_MAX; k++) {
        unit_row(k);
        CHECK(motor.command[k].angle_rad[0] == before.command[k].angle_rad[0]);
    }
    /* The next sample is the first: where the wheels are since then, whatever they did in between. */
    counts[0] += 1000;
    step();
    CHECK((counted == GW_ONE) && motor.started && (twist.wheel[1] == R(0.5)));
    CHECK((motor.wheel[0].count == counts[0]) && (motor.wheel[0].moved == 0) && (motor.wheel[0].rate_radps == GW_ZERO));
    counts[0] += 2;
    step();
    CHECK(motor.wheel[0].moved == 2);
}

/* The torque is that of the command of so many ticks ago; before that many are known nothing is observed. */
static void a_command_comes_with_its_delay(void)
{
    const uint32_t delays[] = {1U, 2U, 3U, 7U, GW_MOTOR_DELAY_MAX};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(delays); i++) {
        begin_with(delays[i]);
        correct_nothing();
        step();
        for (uint32_t k = 0U; k < 40U; k++) {
            motor.wheel[2].rate_radps = R(0.3); /* with the torque less than a surprise */
            motor.wheel[2].servo_radps = GW_ZERO;
            step();
            unit_row((100U * i) + k);
            /* The command of tick n is 0.0001 (n + 1) rad: 200 N m/rad of that. */
            const bool follows = (k >= delays[i]);
            const gw_real_t torque_nm = follows ? (R(0.02) * (gw_real_t)((k - delays[i]) + 1U)) : GW_ZERO;
            CHECK_NEAR(motor.wheel[2].rate_radps, R(0.3) + torque_nm, R(20.0) * ROUNDING);
            CHECK((motor.wheel[2].sure_ticks > 0U) == follows);
            motor.wheel[2].sure_ticks = 0U;
            motor.wheel[2].angle_rad = GW_ZERO;
            CHECK(motor.commands == ((k < GW_MOTOR_DELAY_MAX) ? k : GW_MOTOR_DELAY_MAX));
            tell(R(0.0001) * (gw_real_t)(k + 1U), GW_ZERO);
        }
    }
}

/* Servos that are not enabled follow nothing: what was sent before is not known to be followed. */
static void drives_that_are_not_enabled_follow_no_command(void)
{
    const gw_joint_command_t command = {{R(0.001), R(0.001), R(0.001)}, {GW_ZERO, GW_ZERO, GW_ZERO}};
    begin_with(3U);
    correct_nothing();
    for (uint32_t k = 0U; k < 5U; k++) {
        tell(GW_ZERO, GW_ZERO);
    }
    const gw_motor_t before = motor;
    gw_motor_command(&motor, &command, false);
    CHECK(gw_motor_invariant_holds(&motor) && (motor.commands == 0U) && (motor.next_command == before.next_command));
    for (uint32_t k = 0U; k < GW_MOTOR_DELAY_MAX; k++) {
        CHECK(motor.command[k].angle_rad[0] == before.command[k].angle_rad[0]);
    }
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        trust(&motor.wheel[i]);
    }
    torque.wheel[1] = R(2.0);
    step();
    /* What is not followed is not trusted: counts are taken as they are. */
    CHECK((counted == GW_ONE) && (twist.wheel[1] == R(2.0)));
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        CHECK((motor.wheel[i].share == GW_ZERO) && (motor.wheel[i].sure_ticks == 0U));
    }
    for (uint32_t k = 0U; k < 6U; k++) {
        motor.wheel[0].rate_radps = R(0.3); /* with the torque less than a surprise */
        motor.wheel[0].sure_ticks = 0U;
        motor.wheel[0].angle_rad = GW_ZERO;
        motor.wheel[0].servo_radps = GW_ZERO;
        step();
        unit_row(k);
        CHECK(motor.wheel[0].sure_ticks == ((k < 3U) ? 0U : 1U));
        gw_motor_command(&motor, &command, true);
    }
}

/* Counts and torques that no motor has, in any order, keep the invariant; so does a motor that is not as it should be.
 */
static void any_input_keeps_the_invariant(void)
{
    const int32_t jumps[] = {0, 1, 2, -1, 100, INT32_MAX, INT32_MIN, -7, 40000};
    const gw_real_t torques[] = {GW_ZERO, GW_TORQUE_MAX, -GW_TORQUE_MAX, R(1.0), R(-3.0)};
    const gw_real_t speeds[] = {R(1.2e6), R(-1.2e6), GW_ZERO, R(1.0)};
    const gw_real_t inertias[] = {R(0.000001), R(10.0)};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(inertias); i++) {
        const gw_rate_filter_constants_t constants = constants_of((i == 0U) ? R(1.0e7) : R(1.0));
        begin_with(1U + i);
        config.inertia_kgm2 = inertias[i];
        config.kp_nm_per_rad = R(1.0e6);
        config.kd_nms_per_rad = R(1.0e5);
        config.torque_limit_nm = R(10000.0);
        config.derivative_cutoff_hz = R(10000.0);
        config.coulomb_torque_nm = R(100.0);
        config.cutoff_radps = R(1000.0);
        gw_motor_init(&motor, &config, &constants, COUNTS);
        for (uint32_t k = 0U; k < 2000U; k++) {
            unit_row((10000U * i) + k);
            for (uint32_t wheel = 0U; wheel < GW_WHEEL_COUNT; wheel++) {
                counts[wheel] = gw_count_difference(counts[wheel], -jumps[((k / 3U) + wheel) % 5U]);
                torque.wheel[wheel] = torques[((k / 7U) + wheel) % UNIT_COUNT_OF(torques)];
            }
            if ((k % 50U) == 0U) {
                counts[k % 3U] = jumps[5U + ((k / 50U) % 4U)];
            }
            tell(((k % 2U) == 0U) ? GW_PI : -GW_PI, speeds[k % UNIT_COUNT_OF(speeds)]);
            step();
            CHECK(gw_within(twist.wheel[k % 3U], GW_TORQUE_MAX));
        }
    }
}

static void the_invariant_sees_every_member(void)
{
    gw_motor_t good;
    begin();
    good = motor;
    gw_real_t *const members[] = {&motor.config.cutoff_radps,
                                  &motor.period_s,
                                  &motor.rad_per_count,
                                  &motor.count_rate,
                                  &motor.stiffness_nm_per_rad,
                                  &motor.per_inertia,
                                  &motor.filter_gain,
                                  &motor.slow.angle,
                                  &motor.slow.rate_per_s,
                                  &motor.slow.unknown_per_s2,
                                  &motor.quick.angle,
                                  &motor.quick.rate_per_s,
                                  &motor.quick.unknown_per_s2,
                                  &motor.command[0].angle_rad[0],
                                  &motor.command[7].angle_rad[2],
                                  &motor.command[0].speed_radps[0],
                                  &motor.command[3].speed_radps[1],
                                  &motor.command[7].speed_radps[2],
                                  &motor.wheel[0].angle_rad,
                                  &motor.wheel[2].angle_rad,
                                  &motor.wheel[0].rate_radps,
                                  &motor.wheel[1].unknown_radps2,
                                  &motor.wheel[2].servo_radps,
                                  &motor.wheel[0].torque_nm,
                                  &motor.wheel[2].share};
    uint32_t *const ticks[] = {&motor.encoder_counts,      &motor.next_command,        &motor.commands,
                               &motor.wheel[0].same_ticks, &motor.wheel[2].same_ticks, &motor.wheel[1].sure_ticks};
    const uint32_t most[] = {
        1000000U, GW_MOTOR_DELAY_MAX - 1U, GW_MOTOR_DELAY_MAX, GW_MOTOR_SAME_TICKS, GW_MOTOR_SAME_TICKS, SURE};
    CHECK(!gw_motor_invariant_holds(NULL));
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(members); i++) {
        unit_row(i);
        *members[i] = unit_nan();
        CHECK(!gw_motor_invariant_holds(&motor));
        *members[i] = R(-1.0e30);
        CHECK(!gw_motor_invariant_holds(&motor));
        *members[i] = R(1.0e30);
        CHECK(!gw_motor_invariant_holds(&motor));
        motor = good;
        CHECK(gw_motor_invariant_holds(&motor));
    }
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(ticks); i++) {
        unit_row(100U + i);
        *ticks[i] = most[i];
        CHECK(gw_motor_invariant_holds(&motor));
        *ticks[i] = most[i] + 1U;
        CHECK(!gw_motor_invariant_holds(&motor));
        motor = good;
    }
    motor.encoder_counts = 3U;
    CHECK(!gw_motor_invariant_holds(&motor));
}

/* Ends of the ranges that are relations or whole numbers, from both sides. */
static void the_invariant_ends_where_it_says(void)
{
    gw_motor_t good;
    begin();
    good = motor;
    const struct {
        gw_real_t *member;
        gw_real_t low;
        gw_real_t high;
    } rows[] = {
        {&motor.wheel[1].angle_rad, -GW_HALF * motor.rad_per_count, GW_HALF * motor.rad_per_count},
        {&motor.wheel[1].rate_radps, R(-1.0e5), R(1.0e5)},
        {&motor.wheel[1].unknown_radps2, R(-1.0e7), R(1.0e7)},
        {&motor.wheel[1].torque_nm, -GW_TORQUE_MAX, GW_TORQUE_MAX},
        {&motor.wheel[1].share, GW_ZERO, GW_ONE},
        {&motor.command[4].angle_rad[1], -GW_PI, GW_PI},
        {&motor.command[4].speed_radps[1], R(-1.2e6), R(1.2e6)},
        {&motor.filter_gain, GW_ZERO, GW_ONE},
        {&motor.stiffness_nm_per_rad, GW_ZERO, R(1.1e7)},
        {&motor.per_inertia, GW_ZERO, R(1.1e6)},
        {&motor.slow.angle, GW_ZERO, GW_ONE},
        {&motor.quick.rate_per_s, GW_ZERO, R(1.0e9)},
        {&motor.period_s, R(0.0001), R(0.1)},
        {&motor.count_rate, R(5.0e-5), R(1.7e4)},
        {&motor.wheel[1].servo_radps, R(-3.5e13), R(3.5e13)},
        {&motor.rad_per_count, R(6.0e-6), R(1.6)},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        unit_row(i);
        *rows[i].member = rows[i].low;
        CHECK(gw_motor_invariant_holds(&motor));
        *rows[i].member = rows[i].high;
        CHECK(gw_motor_invariant_holds(&motor));
        *rows[i].member = unit_below(rows[i].low);
        CHECK(!gw_motor_invariant_holds(&motor));
        *rows[i].member = unit_above(rows[i].high);
        CHECK(!gw_motor_invariant_holds(&motor));
        motor = good;
    }
}

/* A motor behind its drive: the servo of gw_servo.h at 2 kHz, whose torque is held in between, friction that is a tenth
 * larger than what is known, and a torque at the sensor. The acceleration is constant within half a tick, so its motion
 * is exact. */
typedef struct {
    gw_servo_t servo;
    gw_real_t beyond_rad; /* the lower end of the present count */
    int32_t count;
    gw_real_t rate_radps;
    gw_joint_command_t sent[3]; /* of this tick and of those before, the oldest first */
} drive_t;

static drive_t drive;

static void drive_begin(gw_real_t rate_radps)
{
    static const gw_joint_command_t nothing;
    const gw_servo_config_t servo = {R(0.0005), R(189.0), R(7.02), R(20.0), R(0.0), COUNTS, R(60.0), 10U};
    CHECK_STATUS(gw_servo_init(&drive.servo, &servo), GW_STATUS_OK);
    drive.beyond_rad = R(0.0004);
    drive.count = -20;
    drive.rate_radps = rate_radps;
    drive.sent[1] = nothing;
    drive.sent[2] = nothing;
}

static void drive_half_tick(const gw_joint_command_t *command, bool is_new, gw_real_t sensed_nm)
{
    const gw_real_t half_s = GW_HALF * PERIOD;
    const gw_servo_input_t input = {command->angle_rad[0], command->speed_radps[0], is_new, true, drive.count};
    gw_servo_output_t output;
    CHECK_STATUS(gw_servo_step(&drive.servo, &input, &output), GW_STATUS_OK);
    const gw_real_t friction_nm = (drive.rate_radps > GW_ZERO) ? R(2.75) : R(-2.75);
    const gw_real_t acceleration = ((output.torque_nm - friction_nm) - sensed_nm) / R(0.0523);
    drive.beyond_rad += half_s * (drive.rate_radps + ((GW_HALF * half_s) * acceleration));
    drive.rate_radps += half_s * acceleration;
    while (drive.beyond_rad >= RAD_PER_COUNT) {
        drive.beyond_rad -= RAD_PER_COUNT;
        drive.count++;
    }
    while (drive.beyond_rad < GW_ZERO) {
        drive.beyond_rad += RAD_PER_COUNT;
        drive.count--;
    }
}

/* Ticks with a sensed torque; returns the mean square of the angle's error over that of counts alone, 1/12 of a count's
 * square. */
static gw_real_t drive_ticks(uint32_t ticks, gw_real_t speed_radps, gw_real_t sensed_nm, gw_real_t *angle_rad)
{
    gw_joint_command_t *const sent = drive.sent;
    gw_real_t squares = GW_ZERO;
    for (uint32_t k = 0U; k < ticks; k++) {
        counts[0] = drive.count;
        torque.wheel[0] = sensed_nm;
        step();
        const gw_real_t observed_rad = (torque.wheel[0] - twist.wheel[0]) / STIFFNESS;
        const gw_real_t off_rad = (observed_rad + (GW_HALF * RAD_PER_COUNT)) - drive.beyond_rad;
        squares += (off_rad * off_rad) / (gw_real_t)ticks;
        *angle_rad = gw_wrap_angle(*angle_rad + (PERIOD * speed_radps));
        tell(*angle_rad, speed_radps);
        /* What is sent now is followed two ticks later: the third sample from now is the first that it changes. */
        sent[0] = sent[1];
        sent[1] = sent[2];
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            sent[2].angle_rad[i] = *angle_rad;
            sent[2].speed_radps[i] = speed_radps;
        }
        drive_half_tick(&sent[0], true, sensed_nm);
        drive_half_tick(&sent[0], false, sensed_nm);
    }
    return squares / ((RAD_PER_COUNT * RAD_PER_COUNT) / R(12.0));
}

/* GW_MOTOR_FINER: the error of counts alone over that of the observer, where it is trusted, in both directions of
 * turning; after a step of the torque it is found again within 100 ms, and is never worse than half a count. */
static void between_counts_a_motor_is_followed(void)
{
    const gw_real_t speeds[] = {R(1.3), R(-2.9), R(0.85)};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(speeds); i++) {
        const gw_rate_filter_constants_t constants = constants_of(STIFFNESS);
        gw_real_t angle_rad = R(-0.02);
        begin_with(3U);
        gw_motor_config_trikey(&config);
        config.coulomb_torque_nm = R(2.5);
        gw_motor_init(&motor, &config, &constants, COUNTS);
        drive_begin(speeds[i]);
        (void)drive_ticks(700U, speeds[i], GW_ZERO, &angle_rad);
        unit_row(i);
        CHECK(motor.wheel[0].share == GW_ONE);
        const gw_real_t steady = drive_ticks(500U, speeds[i], GW_ZERO, &angle_rad);
        CHECK(steady < (GW_ONE / (GW_MOTOR_FINER * GW_MOTOR_FINER)));
        const gw_real_t stepped = drive_ticks(100U, speeds[i], R(3.0), &angle_rad);
        CHECK(stepped < GW_ONE);
        const gw_real_t later = drive_ticks(500U, speeds[i], R(3.0), &angle_rad);
        CHECK(later < (GW_ONE / (GW_MOTOR_FINER * GW_MOTOR_FINER)));
    }
}

void suite_motor(void)
{
    unit_run("the_robot_s_motor_is_this", the_robot_s_motor_is_this);
    unit_run("every_field_is_checked", every_field_is_checked);
    unit_run("what_is_not_known_is_not_observed", what_is_not_known_is_not_observed);
    unit_run("a_compliance_of_nearly_nothing_is_rigid", a_compliance_of_nearly_nothing_is_rigid);
    unit_run("it_begins_without_commands", it_begins_without_commands);
    unit_run("constants_are_these", constants_are_these);
    unit_run("the_observer_has_three_equal_poles", the_observer_has_three_equal_poles);
    unit_run("the_servo_s_torque_is_this", the_servo_s_torque_is_this);
    unit_run("half_a_turn_is_the_end_of_the_range", half_a_turn_is_the_end_of_the_range);
    unit_run("a_motor_moves_as_its_torques_make_it_move", a_motor_moves_as_its_torques_make_it_move);
    unit_run("a_distance_from_the_count_corrects", a_distance_from_the_count_corrects);
    unit_run("what_is_kept_is_limited", what_is_kept_is_limited);
    unit_run("the_twist_is_that_of_the_observed_angle", the_twist_is_that_of_the_observed_angle);
    unit_run("an_observer_has_to_be_sure", an_observer_has_to_be_sure);
    unit_run("a_threshold_is_not_beyond_itself", a_threshold_is_not_beyond_itself);
    unit_run("trust_comes_and_goes_gradually", trust_comes_and_goes_gradually);
    unit_run("equal_counts_jump", equal_counts_jump);
    unit_run("wheels_that_count_alike_are_counted", wheels_that_count_alike_are_counted);
    unit_run("counted_is_a_variance", counted_is_a_variance);
    unit_run("a_count_is_a_difference", a_count_is_a_difference);
    unit_run("a_gap_forgets_all_but_the_commands", a_gap_forgets_all_but_the_commands);
    unit_run("a_command_comes_with_its_delay", a_command_comes_with_its_delay);
    unit_run("drives_that_are_not_enabled_follow_no_command", drives_that_are_not_enabled_follow_no_command);
    unit_run("any_input_keeps_the_invariant", any_input_keeps_the_invariant);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
    unit_run("the_invariant_ends_where_it_says", the_invariant_ends_where_it_says);
    unit_run("between_counts_a_motor_is_followed", between_counts_a_motor_is_followed);
}
