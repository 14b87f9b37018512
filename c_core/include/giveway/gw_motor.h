/* Where the motor of each wheel is between two counts of its encoder.
 *
 * A count is coarse: its second derivative, as a force, hides what a light body on a soft spring does. But a motor
 * moves as its torques make it move, and these are known: that of the servo, which follows from the commands that were
 * sent and from the counts, that of the sensor, and nearly that of the gear's friction:
 *
 *     m theta'' = tau_m - B_1 sign(theta') - tau_s + m d                          Fig. 6
 *
 * d is what nobody knows, mostly that the friction differs. An observer of third order corrects angle, rate and d by
 * the distance to the middle of the present count: slowly while it can be trusted, quickly before. It cannot while the
 * wheel hardly turns, as friction changes its sign there, or while a count is missed by more than its width. Then the
 * counts are taken as they are; the change from one to the other is gradual. The angle never leaves the present count
 * by more than half its width.
 *
 * The servo runs twice in a tick, as gw_servo.h; counts are taken to be spread evenly within it.
 *
 * Life cycle: gw_motor_init; per tick gw_motor_step, and gw_motor_command with what is sent then; gw_motor_restart
 * after a gap in the samples. All members are private; a copy of the struct is a checkpoint.
 */
#ifndef GW_MOTOR_H
#define GW_MOTOR_H

#include "giveway/gw_config.h"
#include "giveway/gw_joint.h"
#include "giveway/gw_rate_filter.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/* By how much the observer is finer than the counts, at least: the standard deviation of its error. */
#define GW_MOTOR_FINER ((gw_real_t)4.0)
#define GW_MOTOR_SAME_TICKS 10U

typedef struct {
    /* Rotor and gear before the torque sensor, as seen at the wheel's axle, kg m^2, [0, 10]; 0: not known, counts are
     * taken as they are. */
    gw_real_t inertia_kgm2;
    /* B_1, Coulomb friction of the gear, N m, [0, 1000]. */
    gw_real_t coulomb_torque_nm;
    /* The drive's servo: gains, N m/rad, [0, 1000000], and N m s/rad, [0, 100000]; torque limit, N m, [0.01, 10000];
     * corner of its speed filter, Hz, [0.1, 10000]. */
    gw_real_t kp_nm_per_rad;
    gw_real_t kd_nms_per_rad;
    gw_real_t torque_limit_nm;
    gw_real_t derivative_cutoff_hz;
    /* From the tick in which a command is sent to the one whose samples it may first have changed, ticks, [1, 8]. */
    uint32_t delay_ticks;
    /* Corner of the correction while the observer can be trusted, rad/s, [1, 1000]. */
    gw_real_t cutoff_radps;
} gw_motor_config_t;

/* What a correction adds per rad of distance. */
typedef struct {
    gw_real_t angle;
    gw_real_t rate_per_s;
    gw_real_t unknown_per_s2;
} gw_motor_gains_t;

typedef struct {
    gw_real_t angle_rad;      /* beyond the middle of the present count */
    gw_real_t rate_radps;     /* of the motor */
    gw_real_t unknown_radps2; /* d */
    gw_real_t servo_radps;    /* the servo's speed filter */
    gw_real_t torque_nm;      /* sensed last */
    int32_t count;
    int32_t moved;       /* counts in the last tick */
    uint32_t same_ticks; /* for which they were the same, at most GW_MOTOR_SAME_TICKS */
    uint32_t sure_ticks; /* for which the observer could be trusted */
    gw_real_t share;     /* of the observer in what is used: 0 counts alone, 1 the observer alone */
} gw_motor_wheel_t;

typedef struct {
    gw_motor_config_t config;
    gw_real_t period_s;
    gw_real_t rad_per_count;
    gw_real_t count_rate; /* rad/s of one count per tick */
    gw_real_t stiffness_nm_per_rad;
    gw_real_t per_inertia; /* 1/m */
    gw_real_t filter_gain; /* of the servo's speed filter */
    uint32_t encoder_counts;
    gw_motor_gains_t slow;
    gw_motor_gains_t quick;
    gw_joint_command_t command[GW_MOTOR_DELAY_MAX];
    uint32_t next_command;
    uint32_t commands; /* known in a row, at most GW_MOTOR_DELAY_MAX */
    gw_motor_wheel_t wheel[GW_WHEEL_COUNT];
    bool known;   /* the inertia is */
    bool started; /* there was a sample before */
} gw_motor_t;

/* The values of Trikey, the paper's robot. Pointers not NULL here and below. */
void gw_motor_config_trikey(gw_motor_config_t *config);
/* A motor of which nothing is known. */
void gw_motor_config_none(gw_motor_config_t *config);
GW_SMALL void gw_motor_config_check(const gw_motor_config_t *config, gw_config_error_t *error);
/* The configuration was checked. The drivetrain is not rigid, or the motor counts as not known. */
GW_SMALL void gw_motor_init(gw_motor_t *motor, const gw_motor_config_t *config,
                            const gw_rate_filter_constants_t *constants, uint32_t encoder_counts);
bool gw_motor_invariant_holds(const gw_motor_t *motor);
/* Forgets the past; commands are kept. */
GW_SMALL void gw_motor_restart(gw_motor_t *motor);
/* Is anything known of the motors? */
static inline bool gw_motor_is_known(const gw_motor_t *motor)
{
    return motor->known;
}
/* What is sent to the drives in this tick. enabled: the servos follow it. */
void gw_motor_command(gw_motor_t *motor, const gw_joint_command_t *command, bool enabled);
/* One sample, |torque| <= GW_TORQUE_MAX. Returns the torque whose twist leads from the counts to the wheels: the sensed
 * one, less what the motor is beyond its count. counted: variance of what is left of the counts' errors, over that
 * without the observer, [0, 2]: 1 for counts as they are, more near whole numbers of counts in a tick, as the errors of
 * wheels that count alike do not change their sign for long, and then jump together. */
gw_wheels_t gw_motor_step(gw_motor_t *motor, const int32_t encoder_count[GW_WHEEL_COUNT], const gw_wheels_t *torque_nm,
                          gw_real_t *counted);

#ifdef __cplusplus
}
#endif

#endif
