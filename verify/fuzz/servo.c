/* Configurations and inputs of a servo. */
#include "bytes.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    bytes_t bytes = {data, size};
    gw_servo_t servo;
    gw_servo_config_t config;
    GW_SERVO_FIELDS(TAKE, config.)
    if (gw_servo_init(&servo, &config) != GW_STATUS_OK) {
        return 0;
    }
    DEMAND(gw_servo_invariant_holds(&servo));
    while (bytes.left > 0U) {
        const gw_servo_input_t input = {take_real(&bytes), take_real(&bytes), take_flag(&bytes), take_flag(&bytes),
                                        take_integer(&bytes)};
        gw_servo_output_t output;
        (void)gw_servo_step(&servo, &input, &output);
        DEMAND(gw_servo_invariant_holds(&servo));
        DEMAND(gw_in_range(output.torque_nm, -config.torque_limit_nm, config.torque_limit_nm));
        DEMAND(input.enable || (output.torque_nm == GW_ZERO));
        DEMAND(gw_in_range(output.angle_error_rad, -GW_PI, GW_PI));
        DEMAND(gw_is_finite(output.speed_radps));
    }
    return 0;
}
