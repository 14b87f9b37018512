/* Types that every part of giveway shares.
 *
 * Frames, stated once. Base frame: x forward, y left, z up, origin at the centre of the wheels. World frame: z up.
 * Wrenches, contact points and sensed motion are in the base frame; plans and references are in the world frame.
 * F_ext is the wrench that the environment exerts ON the robot. The sensed torque T_s is the torque that the
 * drivetrain delivers to the wheel. Units are in the names: _m, _mps, _rad, _radps, _n, _nm, _newton_s, _kg, _s.
 *
 * Real type: float. Build every file with -DGW_REAL_DOUBLE=1 for double.
 */
#ifndef GW_TYPES_H
#define GW_TYPES_H

#include <float.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#if !defined(FLT_EVAL_METHOD) || (FLT_EVAL_METHOD != 0)
#error "giveway needs arithmetic in the declared type (FLT_EVAL_METHOD 0); on 32-bit x86 use -msse2 -mfpmath=sse"
#endif
#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__) || \
    (defined(__FINITE_MATH_ONLY__) && (__FINITE_MATH_ONLY__ != 0))
#error "giveway needs IEEE arithmetic: build without -ffast-math and the options that it stands for"
#endif

#ifndef GW_REAL_DOUBLE
#define GW_REAL_DOUBLE 0
#endif

/* -DGW_WITH_CHANNELS=0 leaves the two-channel detector and what only it needs out of the program: detector.kind 2,
 * estimator.aligned and an IMU are refused then. */
#ifndef GW_WITH_CHANNELS
#define GW_WITH_CHANNELS 1
#endif
#if (GW_WITH_CHANNELS == 0)
#define GW_DETECTOR_KIND_MAX 1U
#define GW_ALIGNED_MAX 0U
#define GW_ACCELERATION_SOURCE_MAX 2U
#else
#define GW_DETECTOR_KIND_MAX 2U
#define GW_ALIGNED_MAX 1U
#define GW_ACCELERATION_SOURCE_MAX 3U
#endif

/* -DGW_WITH_ESCAPE=0 leaves the reaction that neither tips nor rocks the robot out of the program: admittance.kind 2 is
 * refused then, and there is no low-pass, brake, lead or tip limit. */
#ifndef GW_WITH_ESCAPE
#define GW_WITH_ESCAPE 1
#endif
#if (GW_WITH_ESCAPE == 0)
#define GW_ADMITTANCE_KIND_MAX 1U
#else
#define GW_ADMITTANCE_KIND_MAX 2U
#endif

/* Before a loop over the wheels in which a tick spends its time: gcc writes out its passes, as other compilers do by
 * themselves. Without it the longest step takes a tenth more instructions. */
#if defined(__GNUC__) && (__GNUC__ >= 8) && !defined(__clang__) && !defined(__FRAMAC__)
#define GW_UNROLLED _Pragma("GCC unroll 4")
#else
#define GW_UNROLLED
#endif

/* On Arm's microcontrollers. Before a function that is made small instead of fast: the longest step does not need it.
 * Before one that is never inlined: its caller's stack does not hold what it needs. */
#if defined(__GNUC__) && defined(__arm__)
#define GW_SMALL __attribute__((cold))
#define GW_APART __attribute__((noinline))
#else
#define GW_SMALL
#define GW_APART
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Largest finite number, written out: behind <math.h>, some C++ libraries for macOS leave FLT_MAX undefined. */
#if (GW_REAL_DOUBLE == 1)
typedef double gw_real_t;
#define GW_REAL_MAX 1.7976931348623157e+308
#else
typedef float gw_real_t;
#define GW_REAL_MAX 3.4028234663852886e+38F
#endif

/* Number of wheels; their radial directions are 120 degrees apart. */
#define GW_WHEEL_COUNT 3U
/* The same as a real number. */
#define GW_WHEELS ((gw_real_t)GW_WHEEL_COUNT)
/* Most vertices that an outline may have. */
#define GW_OUTLINE_VERTEX_MAX 16U
/* Longest window of the moving average, samples; 12 bytes of RAM each in float. */
#define GW_MOVING_AVERAGE_CAPACITY 1024U
#define GW_MOTOR_DELAY_MAX 8U
/* Tick counters run modulo 2^31 (24.8 days at 1 kHz), so that they fit a signed 32-bit integer. */
#define GW_TICK_MASK 0x7FFFFFFFU

/* What a function tells its caller. Unless a function says otherwise, its outputs are written in every case, and they
 * mean zero motion and zero torque whenever the status is not GW_STATUS_OK. */
typedef enum {
    GW_STATUS_OK = 0,                 /* everything as documented */
    GW_STATUS_NULL_POINTER = 1,       /* a pointer was NULL; the outputs that could be reached are safe */
    GW_STATUS_CONFIG_INVALID = 2,     /* a configuration value is out of range; the state cannot be used */
    GW_STATUS_NOT_INITIALISED = 3,    /* the state was never initialised, or its init failed */
    GW_STATUS_SENSOR_MISSING = 4,     /* no sensor sample present; motion is zero */
    GW_STATUS_SENSOR_STALE = 5,       /* the sample counter stopped; motion is zero */
    GW_STATUS_SENSOR_NONFINITE = 6,   /* a torque is NaN or infinite; motion is zero */
    GW_STATUS_SENSOR_SATURATED = 7,   /* a torque is at the sensor's limit; motion is zero */
    GW_STATUS_ENCODER_JUMP = 8,       /* an encoder moved faster than any wheel can; motion is zero */
    GW_STATUS_SENSOR_RECOVERING = 9,  /* sensors are good again but not yet for long enough; motion is zero */
    GW_STATUS_PLAN_INVALID = 10,      /* the plan is not finite or out of range; the reference slows to a stop */
    GW_STATUS_TARE_REFUSED = 11,      /* torques vary too much, or a tare was asked for in motion; old zero kept */
    GW_STATUS_REFERENCE_INVALID = 12, /* servo: the reference is not finite; the last angle is held at zero speed */
    GW_STATUS_REFERENCE_STALE = 13,   /* servo: no new reference for too long; the last angle is held at zero speed */
    GW_STATUS_INPUT_INVALID = 14      /* an argument is not finite; the output is zero and the state is unchanged */
} gw_status_t;

/* How well the torques without contact are known, which depends on the planned motion. */
typedef enum {
    GW_REGIME_REST = 0,     /* standing: they were measured in this stop */
    GW_REGIME_CREEPING = 1, /* slow or just stopped: rollers may stick, their friction is anything up to B_r */
    GW_REGIME_MOTION = 2    /* moving: the model gives them */
} gw_regime_t;

typedef struct {
    gw_real_t x;
    gw_real_t y;
} gw_vector_t;

/* One value per wheel, in the order of the caller's wires. */
typedef struct {
    gw_real_t wheel[GW_WHEEL_COUNT];
} gw_wheels_t;

typedef struct {
    gw_real_t x_m;
    gw_real_t y_m;
    gw_real_t theta_rad;
} gw_pose_t;

typedef struct {
    gw_real_t vx_mps;
    gw_real_t vy_mps;
    gw_real_t omega_radps;
} gw_twist_t;

typedef struct {
    gw_real_t ax_mps2;
    gw_real_t ay_mps2;
    gw_real_t alpha_radps2;
} gw_acceleration_t;

/* Planar force and the torque about the centre of the base. */
typedef struct {
    gw_real_t force_x_n;
    gw_real_t force_y_n;
    gw_real_t torque_nm;
} gw_wrench_t;

/* Sine and cosine of one angle. */
typedef struct {
    gw_real_t sine;
    gw_real_t cosine;
} gw_rotation_t;

#ifdef __cplusplus
}
#endif

#endif
