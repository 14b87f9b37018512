/* Calls exactly the functions that a firmware calls: what the linker keeps of c_core is its flash cost. */
#include "giveway/gw_controller.h"
#include "giveway/gw_servo.h"

static gw_controller_t controller;
static gw_servo_t servo;

const gw_controller_config_t controller_config = {0};
const gw_servo_config_t servo_config = {0};
gw_controller_input_t input;
gw_servo_input_t servo_input;
volatile gw_status_t status;
gw_controller_output_t output;
gw_servo_output_t servo_output;

void firmware(void);

void firmware(void)
{
    gw_config_error_t error;
    status = gw_controller_init(&controller, &controller_config, &error);
    status = gw_servo_init(&servo, &servo_config);
    for (;;) {
        status = gw_controller_step(&controller, &input, &output);
        status = gw_servo_step(&servo, &servo_input, &servo_output);
    }
}
