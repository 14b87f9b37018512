/* The sensors of a collision as they were recorded, and the controller's configuration in that run: the paper's. */
#ifndef RECORDED_COLLISION_H
#define RECORDED_COLLISION_H

#include "giveway/gw_controller.h"

#define RECORDED_TICKS 800U

void recorded_collision_config(gw_controller_config_t *config);
/* The controller's input of this tick, 0 to RECORDED_TICKS - 1. The plan was to stand still. */
void recorded_collision_input(uint32_t tick, gw_controller_input_t *input);

#endif
