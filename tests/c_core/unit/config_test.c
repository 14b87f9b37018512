#include "unit.h"

/* Every field of the table, and where it is stored. */
typedef struct {
    gw_controller_config_t controller;
    gw_servo_config_t servo;
} robot_t;

typedef struct {
    gw_config_field_t field;
    size_t offset;
    bool is_count;
} place_t;

/* Arrays and the rule on vertices have tests of their own, below and in contact_test.c. */
#define PLACE(kind, field, name, member, minimum, maximum) PLACE_##kind(field, member)
#define PLACE_REAL(field, member) {(field), offsetof(robot_t, member), false},
#define PLACE_COUNT(field, member) {(field), offsetof(robot_t, member), true},
#define PLACE_WHEEL_REAL(field, member)
#define PLACE_WHEEL_COUNT(field, member)
#define PLACE_VERTEX_REAL(field, member)
#define PLACE_RULE(field, member)

static const place_t places[] = {GW_CONTROLLER_CONFIG_FIELDS(PLACE, controller.) GW_SERVO_FIELDS(PLACE, servo.)};

static const gw_servo_config_t servo = {R(0.0005), R(100.0), R(2.0), R(10.0), R(0.0), 1000U, R(100.0), 4U};

/* The paper's robot, with an outline of 3 to 16 corners of one convex polygon. */
static robot_t robot(void)
{
    robot_t made;
    gw_controller_config_paper(&made.controller);
    /* The channels need an aligned balance, and that a measured acceleration. */
    made.controller.estimator.acceleration_source = GW_SOURCE_MEASURED;
    made.controller.estimator.aligned = 1U;
    for (uint32_t i = 0U; i < GW_OUTLINE_VERTEX_MAX; i++) {
        const gw_rotation_t at = gw_sincos(R(0.39) * (gw_real_t)i);
        made.controller.contact.vertex_m[i].x = R(0.4) * at.cosine;
        made.controller.contact.vertex_m[i].y = R(0.4) * at.sine;
    }
    made.servo = servo;
    return made;
}

static gw_config_error_t refused(const robot_t *made)
{
    gw_config_error_t error;
    (void)gw_controller_config_check(&made->controller, &error);
    gw_servo_config_check(&made->servo, &error);
    return error;
}

static robot_t with_real(const place_t *place, gw_real_t value)
{
    robot_t made = robot();
    *(gw_real_t *)(void *)((uint8_t *)&made + place->offset) = value;
    return made;
}

static robot_t with_count(const place_t *place, uint32_t value)
{
    robot_t made = robot();
    if (place->field == GW_FIELD_ESTIMATOR_ACCELERATION_SOURCE) {
        made.controller.estimator.aligned = 0U;
    }
    *(uint32_t *)(void *)((uint8_t *)&made + place->offset) = value;
    return made;
}

static void check_real(const place_t *place)
{
    const gw_config_limit_t limit = gw_config_limit(place->field);
    const gw_real_t accepted[] = {limit.minimum, unit_above(limit.minimum), unit_below(limit.maximum), limit.maximum};
    const gw_real_t outside[] = {unit_below(limit.minimum), unit_above(limit.maximum), unit_nan(), unit_infinity(),
                                 -unit_infinity()};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(accepted); i++) {
        const robot_t made = with_real(place, accepted[i]);
        CHECK_STATUS(refused(&made).field, GW_FIELD_NONE);
    }
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(outside); i++) {
        const robot_t made = with_real(place, outside[i]);
        const gw_config_error_t error = refused(&made);
        CHECK_STATUS(error.field, place->field);
        CHECK(error.index == 0U);
        CHECK((error.minimum == limit.minimum) && (error.maximum == limit.maximum));
        CHECK((error.value == outside[i]) || (!gw_is_finite(outside[i])));
    }
}

static void check_count(const place_t *place)
{
    const uint32_t minimum = (uint32_t)gw_config_limit(place->field).minimum;
    const uint32_t maximum = (uint32_t)gw_config_limit(place->field).maximum;
    const uint32_t accepted[] = {minimum, minimum + 1U, maximum - 1U, maximum};
    const uint32_t outside[] = {maximum + 1U, minimum - 1U, 0xFFFFFFFFU}; /* 0 - 1 wraps: refused as well */
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(accepted); i++) {
        const robot_t made = with_count(place, accepted[i]);
        CHECK_STATUS(refused(&made).field, GW_FIELD_NONE);
    }
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(outside); i++) {
        const robot_t made = with_count(place, outside[i]);
        const gw_config_error_t error = refused(&made);
        CHECK_STATUS(error.field, place->field);
        CHECK(error.index == 0U);
        CHECK(error.value == (gw_real_t)outside[i]);
    }
}

static void every_bound_is_met_at_both_neighbours(void)
{
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(places); i++) {
        unit_row((uint32_t)places[i].field);
        if (places[i].is_count) {
            check_count(&places[i]);
        } else {
            check_real(&places[i]);
        }
    }
}

/* A triangle stays convex when one corner moves out to its limit. */
static void corners_of_the_outline_meet_their_bounds(void)
{
    const struct {
        uint32_t vertex;
        bool is_x;
        gw_real_t value;
        gw_config_field_t field;
    } rows[] = {
        {0U, true, R(10.0), GW_FIELD_NONE},
        {0U, true, unit_below(R(10.0)), GW_FIELD_NONE},
        {0U, true, unit_above(R(10.0)), GW_FIELD_OUTLINE_X},
        {0U, true, unit_nan(), GW_FIELD_OUTLINE_X},
        {1U, true, R(-10.0), GW_FIELD_NONE},
        {1U, true, unit_above(R(-10.0)), GW_FIELD_NONE},
        {1U, true, unit_below(R(-10.0)), GW_FIELD_OUTLINE_X},
        {1U, false, R(10.0), GW_FIELD_NONE},
        {1U, false, unit_below(R(10.0)), GW_FIELD_NONE},
        {1U, false, unit_above(R(10.0)), GW_FIELD_OUTLINE_Y},
        {2U, false, R(-10.0), GW_FIELD_NONE},
        {2U, false, unit_above(R(-10.0)), GW_FIELD_NONE},
        {2U, false, unit_below(R(-10.0)), GW_FIELD_OUTLINE_Y},
        {2U, false, unit_nan(), GW_FIELD_OUTLINE_Y},
        {3U, true, unit_nan(), GW_FIELD_NONE}, /* beyond the count: ignored */
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        robot_t made = robot();
        const gw_vector_t triangle[3] = {{R(0.4), R(0.0)}, {R(-0.2), R(0.3)}, {R(-0.2), R(-0.3)}};
        gw_config_error_t error;
        made.controller.contact.vertex_count = 3U;
        for (uint32_t k = 0U; k < 3U; k++) {
            made.controller.contact.vertex_m[k] = triangle[k];
        }
        if (rows[i].is_x) {
            made.controller.contact.vertex_m[rows[i].vertex].x = rows[i].value;
        } else {
            made.controller.contact.vertex_m[rows[i].vertex].y = rows[i].value;
        }
        unit_row(i);
        error = refused(&made);
        CHECK_STATUS(error.field, rows[i].field);
        CHECK((error.field == GW_FIELD_NONE) || (error.index == rows[i].vertex));
    }
}

static void wheel_slots_meet_their_bounds(void)
{
    const uint32_t outside[] = {3U, 0xFFFFFFFFU};
    for (uint32_t wheel = 0U; wheel < GW_WHEEL_COUNT; wheel++) {
        for (uint32_t i = 0U; i < UNIT_COUNT_OF(outside); i++) {
            robot_t made = robot();
            made.controller.geometry.wheel_slot[wheel] = outside[i];
            unit_row((10U * wheel) + i);
            CHECK_STATUS(refused(&made).field, GW_FIELD_GEOMETRY_WHEEL_SLOT);
            CHECK(refused(&made).index == wheel);
        }
    }
}

static void the_first_bad_field_is_the_one_that_is_named(void)
{
    robot_t made = robot();
    made.controller.base.mass_kg = R(-1.0);
    made.controller.detector.kind = 9U;
    CHECK_STATUS(refused(&made).field, GW_FIELD_BASE_MASS);
    made.controller.period_s = GW_ZERO;
    CHECK_STATUS(refused(&made).field, GW_FIELD_CONTROLLER_PERIOD);
    CHECK_STATUS(gw_controller_config_check(&made.controller,
                                            &(gw_config_error_t){GW_FIELD_NONE, 0U, GW_ZERO, GW_ZERO, GW_ZERO}),
                 GW_STATUS_CONFIG_INVALID);
}

/* Choices of the paper's configuration that are not in a robot file. */
static void the_paper_s_settings_are_these(void)
{
    const struct {
        gw_config_field_t field;
        gw_real_t value;
    } rows[] = {
        {GW_FIELD_CONTROLLER_PERIOD, R(0.001)},
        {GW_FIELD_GEOMETRY_AZIMUTH, R(0.0)},
        {GW_FIELD_SENSOR_CHECK_STALE_TICKS_MAX, R(3.0)},
        {GW_FIELD_SENSOR_CHECK_ENCODER_JUMP, R(200.0)},
        {GW_FIELD_SENSOR_CHECK_RECOVER_TICKS, R(10.0)},
        {GW_FIELD_ESTIMATOR_VELOCITY_SOURCE, R(0.0)},
        {GW_FIELD_ESTIMATOR_ACCELERATION_SOURCE, R(0.0)},
        {GW_FIELD_ESTIMATOR_RATE_CUTOFF, R(200.0)},
        {GW_FIELD_ESTIMATOR_AVERAGE_WINDOW, R(20.0)},
        {GW_FIELD_ESTIMATOR_REST_SPEED, R(0.002)},
        {GW_FIELD_ESTIMATOR_CREEP_SPEED, R(0.03)},
        {GW_FIELD_ESTIMATOR_REST_TICKS, R(300.0)},
        {GW_FIELD_ESTIMATOR_TARE_TICKS, R(100.0)},
        {GW_FIELD_ESTIMATOR_RETARE_TICKS, R(100.0)},
        {GW_FIELD_ESTIMATOR_TARE_VARIATION, R(0.5)},
        {GW_FIELD_ESTIMATOR_FRICTION_MODEL, R(0.0)},
        {GW_FIELD_ESTIMATOR_ALIGNED, R(0.0)},
        {GW_FIELD_CONTACT_MINIMUM_FORCE, R(1.0)},
        {GW_FIELD_OUTLINE_COUNT, R(3.0)},
        {GW_FIELD_DETECTOR_KIND, R(1.0)},
        {GW_FIELD_DETECTOR_FORCE_THRESHOLD, R(10.0)},
        {GW_FIELD_DETECTOR_LEAK_CREEP, R(42.0)},
        {GW_FIELD_DETECTOR_RELEASE_FORCE, R(6.0)},
        {GW_FIELD_DETECTOR_BLANKING_TICKS, R(300.0)},
        {GW_FIELD_FOLLOWER_FRICTION_COMMON, R(0.3)},
        {GW_FIELD_FOLLOWER_FRICTION_WHEEL, R(0.1)},
        {GW_FIELD_FOLLOWER_MASS, R(0.15)},
        {GW_FIELD_FOLLOWER_DRIFT, R(0.01)},
        {GW_FIELD_FOLLOWER_RESIDUAL, R(5.0)},
        {GW_FIELD_ADMITTANCE_KIND, R(0.0)},
        {GW_FIELD_ADMITTANCE_FINISH_SPEED, R(0.01)},
        {GW_FIELD_REFERENCE_FOLLOW_GAIN, R(2.0)},
        {GW_FIELD_REFERENCE_ACCELERATION_LIMIT, R(1.5)},
        {GW_FIELD_REFERENCE_YAW_RATE_LIMIT, R(1.5)},
        {GW_FIELD_REFERENCE_YAW_ACCELERATION_LIMIT, R(6.0)},
        {GW_FIELD_REFERENCE_REJOIN_SPEED, R(0.1)},
        {GW_FIELD_REFERENCE_FINISH_SPEED, R(0.01)},
        {GW_FIELD_SUPERVISOR_SETTLED_SPEED, R(0.005)},
        {GW_FIELD_SUPERVISOR_SETTLED_TICKS, R(500.0)},
        {GW_FIELD_SUPERVISOR_AFTER_SETTLED, R(1.0)},
        {GW_FIELD_SUPERVISOR_REJOIN_DISTANCE, R(0.0002)},
        {GW_FIELD_SUPERVISOR_REJOIN_ANGLE, R(0.0005)},
    };
    robot_t made = robot();
    gw_controller_config_paper(&made.controller);
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        for (uint32_t k = 0U; k < UNIT_COUNT_OF(places); k++) {
            const void *const found = (const uint8_t *)&made + places[k].offset;
            if (places[k].field == rows[i].field) {
                unit_row(i);
                CHECK((places[k].is_count ? (gw_real_t)(*(const uint32_t *)found) : *(const gw_real_t *)found) ==
                      rows[i].value);
            }
        }
    }
    CHECK(made.controller.drives_enabled);
    for (uint32_t i = made.controller.contact.vertex_count; i < GW_OUTLINE_VERTEX_MAX; i++) {
        unit_row(i);
        CHECK((made.controller.contact.vertex_m[i].x == GW_ZERO) && (made.controller.contact.vertex_m[i].y == GW_ZERO));
    }
}

static void only_a_measured_acceleration_can_be_aligned_with(void)
{
    const uint32_t sources[] = {GW_SOURCE_PLANNED, GW_SOURCE_ZERO};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(sources); i++) {
        robot_t made = robot();
        made.controller.estimator.aligned = 1U;
        made.controller.estimator.acceleration_source = sources[i];
        const gw_config_error_t error = refused(&made);
        unit_row(i);
        CHECK_STATUS(error.field, GW_FIELD_ESTIMATOR_ALIGNED);
        CHECK((error.value == GW_ONE) && (error.minimum == GW_ZERO) && (error.maximum == GW_ZERO));
        made.controller.estimator.aligned = 0U;
        CHECK_STATUS(refused(&made).field, GW_FIELD_NONE);
    }
}

static void the_channels_need_an_aligned_balance(void)
{
    robot_t made = robot();
    made.controller.detector.kind = GW_DETECTOR_CHANNELS;
    CHECK_STATUS(refused(&made).field, GW_FIELD_NONE);
    made.controller.estimator.aligned = 0U;
    CHECK_STATUS(refused(&made).field, GW_FIELD_DETECTOR_KIND);
}

static void a_check_begins_with_nothing_to_blame(void)
{
    gw_config_error_t error = {GW_FIELD_BASE_MASS, 9U, R(9.0), R(9.0), R(9.0)};
    gw_config_check_begin(&error);
    CHECK((error.field == GW_FIELD_NONE) && (error.index == 0U) && (error.value == GW_ZERO));
    CHECK((error.minimum == GW_ZERO) && (error.maximum == GW_ZERO));
}

static void every_roller_s_stiffness_meets_its_bounds(void)
{
    const gw_config_limit_t limit = gw_config_limit(GW_FIELD_ESTIMATOR_PRESLIDING_STIFFNESS);
    const gw_real_t accepted[] = {limit.minimum, limit.maximum};
    const gw_real_t outside[] = {unit_below(limit.minimum), unit_above(limit.maximum), unit_nan()};
    for (uint32_t wheel = 0U; wheel < GW_WHEEL_COUNT; wheel++) {
        robot_t made = robot();
        gw_real_t *const stiffness = &made.controller.estimator.presliding.stiffness_n_per_m[wheel];
        unit_row(wheel);
        for (uint32_t i = 0U; i < UNIT_COUNT_OF(accepted); i++) {
            *stiffness = accepted[i];
            CHECK_STATUS(refused(&made).field, GW_FIELD_NONE);
        }
        for (uint32_t i = 0U; i < UNIT_COUNT_OF(outside); i++) {
            *stiffness = outside[i];
            CHECK_STATUS(refused(&made).field, GW_FIELD_ESTIMATOR_PRESLIDING_STIFFNESS);
            CHECK(refused(&made).index == wheel);
        }
    }
}

static void what_is_no_field_has_the_row_of_none(void)
{
    const uint32_t beyond = (uint32_t)GW_FIELD_COUNT;
    const gw_config_limit_t none = gw_config_limit((gw_config_field_t)beyond);
    CHECK((none.minimum == R(0.0)) && (none.maximum == R(0.0)));
    CHECK(gw_config_name(GW_FIELD_NONE)[0] == 'n');
    CHECK(gw_config_name((gw_config_field_t)beyond) == gw_config_name(GW_FIELD_NONE));
}

/* Every accepted size fits into its array. */
static void arrays_are_as_long_as_their_fields_allow(void)
{
    const gw_controller_config_t config = robot().controller;
    CHECK(gw_config_limit(GW_FIELD_OUTLINE_COUNT).maximum == (gw_real_t)UNIT_COUNT_OF(config.contact.vertex_m));
    CHECK(gw_config_limit(GW_FIELD_ESTIMATOR_AVERAGE_WINDOW).maximum ==
          (gw_real_t)UNIT_COUNT_OF(((const gw_moving_average_t *)NULL)->sample));
    CHECK(gw_config_limit(GW_FIELD_GEOMETRY_WHEEL_SLOT).maximum ==
          ((gw_real_t)UNIT_COUNT_OF(config.geometry.wheel_slot) - GW_ONE));
}

void suite_config(void)
{
    unit_run("arrays_are_as_long_as_their_fields_allow", arrays_are_as_long_as_their_fields_allow);
    unit_run("every_bound_is_met_at_both_neighbours", every_bound_is_met_at_both_neighbours);
    unit_run("corners_of_the_outline_meet_their_bounds", corners_of_the_outline_meet_their_bounds);
    unit_run("wheel_slots_meet_their_bounds", wheel_slots_meet_their_bounds);
    unit_run("the_first_bad_field_is_the_one_that_is_named", the_first_bad_field_is_the_one_that_is_named);
    unit_run("the_paper_s_settings_are_these", the_paper_s_settings_are_these);
    unit_run("only_a_measured_acceleration_can_be_aligned_with", only_a_measured_acceleration_can_be_aligned_with);
    unit_run("the_channels_need_an_aligned_balance", the_channels_need_an_aligned_balance);
    unit_run("a_check_begins_with_nothing_to_blame", a_check_begins_with_nothing_to_blame);
    unit_run("every_roller_s_stiffness_meets_its_bounds", every_roller_s_stiffness_meets_its_bounds);
    unit_run("what_is_no_field_has_the_row_of_none", what_is_no_field_has_the_row_of_none);
}
