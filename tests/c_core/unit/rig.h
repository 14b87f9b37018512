/* One controller of the paper's robot with short times, stepped tick by tick; every step is checked for the properties
 * that always hold. */
#ifndef RIG_H
#define RIG_H

#include "unit.h"

extern gw_controller_config_t rig_config;
extern gw_controller_t rig_controller;
extern gw_controller_input_t rig_input;
extern gw_controller_output_t rig_output;

/* The configuration, and an input of good sensors at a plan that stands at the origin. No controller yet. */
void rig_set_up(void);
/* A controller of the configuration. */
void rig_begin(void);
/* One tick with the input as it is. */
gw_status_t rig_step(void);
/* One tick with the next sample counter. */
void rig_tick(gw_status_t status);
void rig_ticks(uint32_t count);
/* Ticks until the mode is reached, at most the given number. */
void rig_until(gw_mode_t mode, uint32_t most);
/* The torques of a push along x, N: (0, t, -t). */
void rig_push(gw_real_t force_n);
/* A controller of the configuration, pushed as soon as it tracks, until it reacts; the push goes on. */
void rig_begin_with_a_push(gw_real_t force_n);

#endif
