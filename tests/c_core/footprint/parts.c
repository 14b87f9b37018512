/* Programs that call only a part of c_core, chosen by PART, to see what the linker keeps. */
#include "giveway/giveway.h"

volatile gw_status_t status;
const char *volatile name;

void firmware(void);

#if (PART == 1) /* controller and servo, and the name of a refused field */
static gw_controller_t controller;
static gw_servo_t servo;
const gw_controller_config_t controller_config = {0};
const gw_servo_config_t servo_config = {0};
gw_controller_input_t input;
gw_servo_input_t servo_input;
gw_controller_output_t output;
gw_servo_output_t servo_output;

void firmware(void)
{
    gw_config_error_t error;
    status = gw_controller_init(&controller, &controller_config, &error);
    name = gw_config_name(error.field);
    status = gw_servo_init(&servo, &servo_config);
    for (;;) {
        status = gw_controller_step(&controller, &input, &output);
        status = gw_servo_step(&servo, &servo_input, &servo_output);
    }
}
#elif (PART == 2) || (PART == 4) /* estimate and detection, with or without escape: no modes, plan and wheel commands \
                                  */
static gw_estimator_t estimator;
static gw_detector_t detector;
/* The configurations of this part: without outline, reference, sensors and modes. */
const gw_real_t period_s = 0;
const gw_geometry_config_t geometry = {0};
const gw_inertia_config_t base = {0};
const gw_friction_config_t friction = {0};
const gw_estimator_config_t estimator_config = {0};
const gw_detector_config_t detector_config = {0};
gw_estimator_input_t input;
gw_estimator_output_t estimate;
gw_detector_input_t push;
gw_detector_output_t detection;
#if (PART == 2)
static gw_admittance_t admittance;
const gw_admittance_config_t admittance_config = {0};
gw_admittance_output_t motion;
gw_vector_t vector;
#endif

void firmware(void)
{
    status = gw_estimator_init(&estimator, &estimator_config, &geometry, &base, &friction, period_s);
    status = gw_detector_init(&detector, &detector_config, period_s);
#if (PART == 2)
    status = gw_admittance_init(&admittance, &admittance_config, period_s);
#endif
    while (gw_estimator_tare(&estimator, &input.torque_nm) != GW_TARE_DONE) {
    }
    for (;;) {
        status = gw_estimator_step(&estimator, &input, &estimate);
        status = gw_detector_step(&detector, &push, &detection);
#if (PART == 2)
        status = gw_admittance_start(&admittance, vector, vector);
        status = gw_admittance_step(&admittance, vector, &motion);
#endif
    }
}
#else /* the servo of a drive */
static gw_servo_t servo;
const gw_servo_config_t servo_config = {0};
gw_servo_input_t servo_input;
gw_servo_output_t servo_output;

void firmware(void)
{
    status = gw_servo_init(&servo, &servo_config);
    for (;;) {
        status = gw_servo_step(&servo, &servo_input, &servo_output);
    }
}
#endif
