/* giveway: collision reflexes for omnidirectional robot bases. This header includes the whole library. */
#ifndef GIVEWAY_H
#define GIVEWAY_H

#include "giveway/gw_admittance.h"
#include "giveway/gw_config.h"
#include "giveway/gw_contact.h"
#include "giveway/gw_controller.h"
#include "giveway/gw_detector.h"
#include "giveway/gw_estimator.h"
#include "giveway/gw_friction.h"
#include "giveway/gw_joint.h"
#include "giveway/gw_kinematics.h"
#include "giveway/gw_math.h"
#include "giveway/gw_moving_average.h"
#include "giveway/gw_nominal.h"
#include "giveway/gw_presliding.h"
#include "giveway/gw_rate_filter.h"
#include "giveway/gw_reference.h"
#include "giveway/gw_sensor_check.h"
#include "giveway/gw_servo.h"
#include "giveway/gw_sum.h"
#include "giveway/gw_supervisor.h"
#include "giveway/gw_tare.h"
#include "giveway/gw_trikey.h"
#include "giveway/gw_types.h"
#include "giveway/gw_wrench.h"

#endif
