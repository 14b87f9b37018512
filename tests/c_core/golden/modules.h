/* One function per module: drives it with a fixed sequence of inputs and returns the digest of all it put out. */
#ifndef MODULES_H
#define MODULES_H

#include "digest_types.h"

digest_t drive_math(void);
digest_t drive_vectors(void);
digest_t drive_kinematics(void);
digest_t drive_friction(void);
digest_t drive_gear(void);
digest_t drive_nominal(void);
digest_t drive_wrench(void);
digest_t drive_sum(void);
digest_t drive_tare(void);
digest_t drive_moving_average(void);
digest_t drive_rate_filter(void);
digest_t drive_presliding(void);
digest_t drive_config(void);
digest_t drive_sensor_check(void);
digest_t drive_contact(void);
digest_t drive_detector(void);
digest_t drive_supervisor(void);
digest_t drive_estimator(void);
digest_t drive_admittance(void);
digest_t drive_escape(void);
digest_t drive_tip(void);
digest_t drive_balance(void);
digest_t drive_follower(void);
digest_t drive_model_covariance(void);
digest_t drive_slip(void);
digest_t drive_ripple(void);
digest_t drive_fast_channel(void);
digest_t drive_slow_channel(void);
digest_t drive_channels(void);
digest_t drive_imu(void);
digest_t drive_motor(void);
digest_t drive_reference(void);
digest_t drive_joint(void);
digest_t drive_servo(void);
digest_t drive_controller_trikey(void);
digest_t drive_controller_measuring(void);
digest_t drive_controller_watching(void);
digest_t drive_controller_bristles(void);
digest_t drive_controller_recorded(void);
/* Which modes (upper word) and statuses (lower word) the drives above met, as sets of bits. */
digest_t drive_controller_reached(void);
digest_t drive_controller_channels(void);

#endif
