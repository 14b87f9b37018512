#include "recorded_collision.h"

#define TORQUE_RESOLUTION_NM 0.0143 /* drivetrain.torque_sensor_resolution in robots/trikey.toml */

static const int16_t recorded[RECORDED_TICKS][2U * GW_WHEEL_COUNT] = {
#include "recorded_collision.inc"
};

void recorded_collision_config(gw_controller_config_t *config)
{
    gw_controller_config_paper(config);
    config->supervisor.after_settled = GW_AFTER_SETTLED_HOLD;
}

void recorded_collision_input(uint32_t tick, gw_controller_input_t *input)
{
    static const gw_controller_input_t standing = {0};
    *input = standing;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        input->sensor.torque_nm[i] = (gw_real_t)((double)recorded[tick][i] * TORQUE_RESOLUTION_NM);
        input->sensor.encoder_count[i] = recorded[tick][GW_WHEEL_COUNT + i];
    }
    input->sensor.counter = tick;
    input->sensor.present = true;
}
