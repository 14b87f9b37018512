/* A scripted day of a robot in a few seconds: it follows a plan, is pushed, loses sensors, is stopped and tared.
 *
 * The wheels turn as commanded; torques are those of the model, plus noise, pushes and faults. Everything comes from
 * integers, so every machine that computes the same outputs gets the same inputs. */
#ifndef SCRIPT_H
#define SCRIPT_H

#include "generator.h"
#include "giveway/gw_controller.h"

/* Length of a script, and the seed of the script that the controller's FMU gets too. */
#define SCRIPT_TICKS 6000U
#define SCRIPT_TRIKEY_SEED 21U

typedef struct {
    gw_controller_config_t config;
    gw_kinematics_t kinematics;
    gw_nominal_t nominal;
    generator_t generator;
    gw_controller_input_t input;
    gw_real_t travel_counts[GW_WHEEL_COUNT]; /* not yet counted */
    gw_wheels_t push_nm;
    uint32_t push_ticks; /* left */
    uint32_t fault_ticks;
    uint32_t fault;
    uint32_t stop_ticks;
    uint32_t tick;
    bool valid_plans; /* the FMU accepts no others */
} script_t;

void script_begin(script_t *script, const gw_controller_config_t *config, uint32_t seed, bool valid_plans);
/* The next input, given the output of the previous tick. */
const gw_controller_input_t *script_next(script_t *script, const gw_controller_output_t *before);

#endif
