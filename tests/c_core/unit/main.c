/* All unit tests of c_core in one program, for the PC and for the target. */
#include "unit.h"

int main(void)
{
    suite_math();
    suite_sum();
    suite_config();
    suite_init();
    suite_kinematics();
    suite_friction();
    suite_gear();
    suite_nominal();
    suite_rate_filter();
    suite_motor();
    suite_lowpass();
    suite_balance();
    suite_planar_covariance();
    suite_follower();
    suite_model_covariance();
    suite_fast_channel();
    suite_slip();
    suite_ripple();
    suite_slow_channel();
    suite_channels();
    suite_presliding();
    suite_wrench();
    suite_tare();
    suite_moving_average();
    suite_sensor_check();
    suite_imu();
    suite_contact();
    suite_detector();
    suite_estimator();
    suite_tip();
    suite_admittance();
    suite_reference();
    suite_joint();
    suite_supervisor();
    suite_servo();
    suite_controller();
    suite_controller_faults();
    suite_imu_use();
    suite_channels_use();
    return unit_close() ? 0 : 1;
}
