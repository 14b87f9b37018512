/* Trikey, the robot of Kim, Llado and Sentis (Autonomous Robots 40:325, 2016), as C constants.
 * The same numbers with unit, source and confidence are in robots/trikey.toml; a test holds both equal.
 * Marked: (given) printed in the paper, (sourced) found elsewhere, (fitted) to the paper's results, (assumed) here.
 */
#ifndef GW_TRIKEY_H
#define GW_TRIKEY_H

#include "giveway/gw_types.h"

#define GW_TRIKEY_BASE_MASS_KG ((gw_real_t)34.7)              /* (sourced) CAD of the lab, 2015 */
#define GW_TRIKEY_BASE_YAW_INERTIA_KGM2 ((gw_real_t)1.31)     /* (sourced) CAD of the lab, 2015, plus wheels */
#define GW_TRIKEY_BASE_COM_HEIGHT_M ((gw_real_t)0.414)        /* (sourced) CAD of the lab, 2015 */
#define GW_TRIKEY_WHEEL_RADIUS_M ((gw_real_t)0.1016)          /* (sourced) code of the lab, 2011-13: 4 in */
#define GW_TRIKEY_WHEEL_DISTANCE_M ((gw_real_t)0.24)          /* (sourced) CAD of the lab, 2015 */
#define GW_TRIKEY_WHEEL_INERTIA_KGM2 ((gw_real_t)0.002798)    /* (sourced) CAD of the lab, 2015 */
#define GW_TRIKEY_WHEEL_GRIP_FRICTION ((gw_real_t)0.7)        /* (assumed) */
#define GW_TRIKEY_ROLLER_RADIUS_M ((gw_real_t)0.009525)       /* (sourced) same wheel on the successor robot */
#define GW_TRIKEY_ROLLER_INERTIA_KGM2 ((gw_real_t)1.23e-6)    /* (sourced) CAD of the lab, 2015 */
#define GW_TRIKEY_ROLLER_COULOMB_TORQUE_NM ((gw_real_t)0.2)   /* (given) 4.2 */
#define GW_TRIKEY_ROLLER_TANH_SLOPE_S_PER_RAD ((gw_real_t)0.4) /* (given) 4.2 */
#define GW_TRIKEY_ROLLER_PRESLIDING_STIFFNESS_N_PER_M ((gw_real_t)28900.0) /* (fitted) to 5.1, 5.2 and 5.3 */
#define GW_TRIKEY_ROLLER_PRESLIDING_DAMPING_NEWTON_S_PER_M ((gw_real_t)20.0) /* (assumed) */
#define GW_TRIKEY_ROLLER_STRIBECK_SPEED_MPS ((gw_real_t)0.0025) /* (assumed) */
#define GW_TRIKEY_ROLLER_ELASTIC_FRACTION ((gw_real_t)0.7)    /* (assumed) */
#define GW_TRIKEY_DRIVETRAIN_STIFFNESS_NM_PER_RAD ((gw_real_t)721.0) /* (fitted) to 5.1, 5.2 and 5.3 */
#define GW_TRIKEY_DRIVETRAIN_MOTOR_INERTIA_KGM2 ((gw_real_t)0.0523) /* (sourced) rotor, ratio of the gear estimated */
#define GW_TRIKEY_DRIVETRAIN_GEAR_COULOMB_NM ((gw_real_t)2.75) /* (fitted) to 5.1, 5.2 and 5.3 */
#define GW_TRIKEY_DRIVETRAIN_ENCODER_COUNTS 8500U             /* (sourced) successor robot, per wheel turn */
#define GW_TRIKEY_DRIVETRAIN_TORQUE_LIMIT_NM ((gw_real_t)20.0) /* (assumed) about 9 A */
#define GW_TRIKEY_DRIVETRAIN_TORQUE_SENSOR_LIMIT_NM ((gw_real_t)28.0) /* (sourced) sensor electronics, 2011 */
#define GW_TRIKEY_DRIVETRAIN_TORQUE_NOISE_NM ((gw_real_t)0.03) /* (assumed) */
#define GW_TRIKEY_SERVO_KP_NM_PER_RAD ((gw_real_t)189.0)      /* (fitted) to 5.2 and 5.3 */
#define GW_TRIKEY_SERVO_KD_NMS_PER_RAD ((gw_real_t)7.02)      /* (fitted) to 5.2 and 5.3 */
#define GW_TRIKEY_SERVO_DERIVATIVE_CUTOFF_HZ ((gw_real_t)60.0) /* (assumed) */
#define GW_TRIKEY_ADMITTANCE_MASS_KG ((gw_real_t)2.0)         /* (given) 5.2 */
#define GW_TRIKEY_ADMITTANCE_DAMPING_NEWTON_S_PER_M ((gw_real_t)1.6) /* (given) 5.2, printed N/m^2 */
#define GW_TRIKEY_ADMITTANCE_ESCAPE_IMPULSE_NEWTON_S ((gw_real_t)0.8) /* (given) 5.2, printed N */
#define GW_TRIKEY_ADMITTANCE_SPEED_LIMIT_MPS ((gw_real_t)0.5) /* (sourced) limit used by the lab */
#define GW_TRIKEY_ADMITTANCE_ACCELERATION_LIMIT_MPS2 ((gw_real_t)2.8) /* (sourced) tipping, g (R/2)/h */
#define GW_TRIKEY_DETECTOR_IMPULSE_THRESHOLD_NEWTON_S ((gw_real_t)1.71) /* (fitted) to the detection times */
#define GW_TRIKEY_DETECTOR_LEAK_REST_N ((gw_real_t)1.0)       /* (assumed) */
#define GW_TRIKEY_DETECTOR_LEAK_MOTION_N ((gw_real_t)3.0)     /* (assumed) error of the friction model */
/* Outline: equilateral triangle of 0.61 m side, corners over the wheels (given). */
#define GW_TRIKEY_OUTLINE_COUNT 3U
#define GW_TRIKEY_OUTLINE_X0_M ((gw_real_t)0.352184)
#define GW_TRIKEY_OUTLINE_Y0_M ((gw_real_t)0.0)
#define GW_TRIKEY_OUTLINE_X1_M ((gw_real_t)-0.176092)
#define GW_TRIKEY_OUTLINE_Y1_M ((gw_real_t)0.305)
#define GW_TRIKEY_OUTLINE_X2_M ((gw_real_t)-0.176092)
#define GW_TRIKEY_OUTLINE_Y2_M ((gw_real_t)-0.305)

#endif
