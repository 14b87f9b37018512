/* A robot of any size, its wheels in any order: initialised kinematics and model for the modules that need them. */
#ifndef RANDOM_ROBOT_H
#define RANDOM_ROBOT_H

#include "generator.h"
#include "giveway/gw_kinematics.h"
#include "giveway/gw_nominal.h"

gw_geometry_config_t random_geometry(generator_t *generator);
gw_kinematics_t random_kinematics(generator_t *generator);
gw_nominal_t random_nominal(generator_t *generator, const gw_kinematics_t *kinematics);

#endif
