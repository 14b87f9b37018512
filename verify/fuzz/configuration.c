/* A configuration of arbitrary bits, including its outline: init refuses it as gw_controller.h says, or accepts it, and
 * then a few steps with any input succeed. The bytes are the difference from the paper's robot, bit by bit: no bytes
 * give its configuration, and every other one can be reached, with NaN, infinities, subnormals and unordered corners.
 */
#include "bytes.h"

#define STEPS 8U
#define OUTLINE_FROM_ANGLES 1U

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Corners around the origin, mostly of a convex outline: random bits alone would never give sixteen valid corners. */
static void take_outline(bytes_t *bytes, gw_contact_config_t *contact)
{
    gw_real_t angle = take_value(bytes, GW_PI);
    contact->vertex_count = take_count_setting(bytes, GW_FIELD_OUTLINE_COUNT);
    const uint32_t corners = (contact->vertex_count <= GW_OUTLINE_VERTEX_MAX) ? contact->vertex_count : 0U;
    for (uint32_t i = 0U; i < corners; i++) {
        const uint32_t bits = take_count(bytes);
        const gw_rotation_t at = gw_sincos(angle);
        const gw_real_t radius = (gw_real_t)(bits >> 16U) / (gw_real_t)8192.0;
        contact->vertex_m[i].x = radius * at.cosine;
        contact->vertex_m[i].y = radius * at.sine;
        if ((bits & 0x3FU) == 0x3FU) {
            contact->vertex_m[i].y = take_real(bytes);
        }
        angle += ((GW_TWO * GW_PI) / (gw_real_t)corners) * ((gw_real_t)(bits & 0xFFFFU) / (gw_real_t)32768.0);
    }
}

static gw_controller_config_t take_config(bytes_t *bytes)
{
    gw_controller_config_t config;
    uint8_t *const place = (uint8_t *)&config;
    const uint32_t choices = take_count(bytes);
    (void)memset(&config, 0, sizeof(config));
    gw_controller_config_trikey(&config);
    bool enabled = config.drives_enabled;
    if ((choices & OUTLINE_FROM_ANGLES) != 0U) {
        take_outline(bytes, &config.contact);
    } else {
        for (size_t i = 0U; (i < sizeof(config)) && (bytes->left > 0U); i++) {
            place[i] ^= *bytes->data;
            bytes->data++;
            bytes->left--;
        }
        enabled = (choices & 2U) == 0U; /* arbitrary bits are not a valid bool in C */
    }
    (void)memcpy(place + offsetof(gw_controller_config_t, drives_enabled), &enabled, sizeof(enabled));
    return config;
}

static void check_refused(gw_controller_t *controller, const gw_controller_config_t *config, gw_status_t status,
                          const gw_config_error_t *error)
{
    gw_config_error_t again;
    gw_controller_input_t input;
    gw_controller_output_t output;
    gw_controller_output_t safe;
    DEMAND(status == GW_STATUS_CONFIG_INVALID);
    DEMAND((error->field > GW_FIELD_NONE) && (error->field < GW_FIELD_COUNT));
    if (error->field == GW_FIELD_OUTLINE_CONVEX) {
        DEMAND(!(error->value > GW_ZERO) && (error->index < config->contact.vertex_count));
    } else {
        DEMAND(!gw_in_range(error->value, error->minimum, error->maximum));
    }
    DEMAND(gw_controller_config_check(config, &again) == GW_STATUS_CONFIG_INVALID);
    DEMAND((again.field == error->field) && (again.index == error->index));
    DEMAND(!gw_controller_invariant_holds(controller));
    (void)memset(&input, 0, sizeof(input));
    (void)memset(&output, 0xFF, sizeof(output));
    DEMAND(gw_controller_step(controller, &input, &output) == GW_STATUS_NOT_INITIALISED);
    gw_controller_safe_output(&safe);
    DEMAND((!output.enable) && (output.mode == safe.mode) && (output.detection_tick == safe.detection_tick));
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        DEMAND((output.command.speed_radps[i] == GW_ZERO) && (output.command.angle_rad[i] == GW_ZERO));
    }
}

/* Every line of action of a force meets the box around the corners. */
static void check_located(const gw_contact_config_t *config, gw_wrench_t wrench)
{
    const gw_wrench_sigma_t sigma = {GW_ONE, GW_ONE};
    gw_contact_t contact;
    gw_contact_estimate_t estimate;
    gw_vector_t low = config->vertex_m[0];
    gw_vector_t high = config->vertex_m[0];
    for (uint32_t i = 1U; i < config->vertex_count; i++) {
        low.x = gw_min(low.x, config->vertex_m[i].x);
        low.y = gw_min(low.y, config->vertex_m[i].y);
        high.x = gw_max(high.x, config->vertex_m[i].x);
        high.y = gw_max(high.y, config->vertex_m[i].y);
    }
    /* Between two corners at most 20 m apart: four roundings of numbers up to 20. */
    const gw_real_t rounding =
        (gw_real_t)80.0 * ((sizeof(gw_real_t) == 4U) ? (gw_real_t)FLT_EPSILON : (gw_real_t)DBL_EPSILON);
    DEMAND(gw_contact_init(&contact, config) == GW_STATUS_OK);
    if (gw_contact_locate(&contact, wrench, sigma, &estimate) == GW_STATUS_OK) {
        DEMAND(gw_is_finite(estimate.force_n) && gw_is_finite(estimate.lever_arm_m));
        DEMAND(gw_in_range(estimate.direction_rad, -GW_PI, GW_PI));
        DEMAND((!estimate.valid) || gw_in_range(estimate.point_m.x, low.x - rounding, high.x + rounding));
        DEMAND((!estimate.valid) || gw_in_range(estimate.point_m.y, low.y - rounding, high.y + rounding));
    } else {
        DEMAND(!estimate.valid);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static gw_controller_t controller;
    bytes_t bytes = {data, size};
    const gw_controller_config_t config = take_config(&bytes);
    gw_config_error_t error;
    (void)memset(&controller, 0, sizeof(controller));
    const gw_status_t status = gw_controller_init(&controller, &config, &error);
    if (status != GW_STATUS_OK) {
        check_refused(&controller, &config, status, &error);
        return 0;
    }
    DEMAND((error.field == GW_FIELD_NONE) && gw_controller_invariant_holds(&controller));
    for (uint32_t tick = 0U; tick < STEPS; tick++) {
        gw_controller_input_t input;
        gw_controller_output_t output;
        const gw_wrench_t wrench = {take_value(&bytes, (gw_real_t)100.0), take_value(&bytes, (gw_real_t)100.0),
                                    take_value(&bytes, (gw_real_t)100.0)};
        check_located(&config.contact, wrench);
        (void)memset(&input, 0, sizeof(input));
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            input.sensor.torque_nm[i] = take_value(&bytes, config.sensor_check.torque_limit_nm);
        }
        input.sensor.counter = tick;
        input.sensor.present = true;
        input.plan.twist.vx_mps = take_value(&bytes, GW_ONE);
        const gw_status_t answer = gw_controller_step(&controller, &input, &output);
        DEMAND((answer != GW_STATUS_NOT_INITIALISED) && gw_controller_invariant_holds(&controller));
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            DEMAND(gw_is_finite(output.command.speed_radps[i]));
            DEMAND(gw_in_range(output.command.angle_rad[i], -GW_PI, GW_PI));
        }
    }
    return 0;
}
