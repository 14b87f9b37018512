/* Instructions per step and bytes of RAM, measured on a Cortex-M under qemu -icount shift=0.
 *
 * There SysTick, at 25 MHz, counts one tick per 40 instructions. A step is repeated from the same state 40 times, so
 * that ticks become instructions; the cost of copying the state and of the call is measured and subtracted. */
#include <inttypes.h>
#include <stdio.h>

#include "giveway/gw_math.h"
#include "giveway/gw_servo.h"
#include "recorded_collision.h"
#include "script.h"

#define SYST_CSR (*(volatile uint32_t *)0xE000E010U)
#define SYST_RVR (*(volatile uint32_t *)0xE000E014U)
#define SYST_CVR (*(volatile uint32_t *)0xE000E018U)
#define COUNT_DOWN_AT_PROCESSOR_CLOCK 5U
#define LONGEST 0xFFFFFFU

#define INSTRUCTIONS_PER_TICK 40U
#define REPETITIONS INSTRUCTIONS_PER_TICK
#define SEARCH_TICKS 1500U
#define SERVO_TICKS 20000U

/* What is left out of everything, one after the other: 1 bristles, 2 the IMU, 3 motors observed between counts. */
#ifndef LEFT_OUT
#define LEFT_OUT 0
#endif
#define WITHOUT_BRISTLES (LEFT_OUT >= 1)
#define WITHOUT_IMU (LEFT_OUT >= 2)
#define WITHOUT_OBSERVED_MOTORS (LEFT_OUT >= 3)

static gw_controller_t controller;
static gw_controller_t before;
static gw_controller_t scratch;
static gw_controller_output_t output;

typedef gw_status_t (*step_t)(gw_controller_t *state, const gw_controller_input_t *input, gw_controller_output_t *out);

__attribute__((noinline)) static gw_status_t no_step(gw_controller_t *state, const gw_controller_input_t *input,
                                                     gw_controller_output_t *out)
{
    __asm volatile("" : : "r"(state), "r"(input), "r"(out) : "memory");
    return GW_STATUS_OK;
}

static uint32_t ticks_since(uint32_t start)
{
    return (start - SYST_CVR) & LONGEST;
}

static uint32_t repeated(step_t step, const gw_controller_input_t *input)
{
    const uint32_t start = SYST_CVR;
    for (uint32_t i = 0U; i < REPETITIONS; i++) {
        scratch = before;
        (void)step(&scratch, input, &output);
    }
    return ticks_since(start);
}

/* Makes one step; returns its instructions if they exceed `most`, else `most`. */
static uint32_t measured_step(const gw_controller_input_t *input, uint32_t most)
{
    uint32_t instructions = most;
    before = controller;
    const uint32_t start = SYST_CVR;
    (void)gw_controller_step(&controller, input, &output);
    const uint32_t roughly = ticks_since(start) * INSTRUCTIONS_PER_TICK;
    if ((roughly + (2U * INSTRUCTIONS_PER_TICK)) > most) {
        const gw_controller_output_t kept = output;
        const uint32_t exact = repeated(gw_controller_step, input) - repeated(no_step, input);
        output = kept;
        instructions = (exact > most) ? exact : most;
    }
    return instructions;
}

static uint32_t worst_over_recorded_collision(void)
{
    uint32_t most = 0U;
    gw_controller_config_t config;
    recorded_collision_config(&config);
    (void)gw_controller_init(&controller, &config, NULL);
    for (uint32_t tick = 0U; tick < RECORDED_TICKS; tick++) {
        gw_controller_input_t input;
        recorded_collision_input(tick, &input);
        most = measured_step(&input, most);
    }
    return most;
}

/* Configurations that make the step long, by the bits of `variant`; all have the longest outline. */
static void demanding_config(gw_controller_config_t *config, uint32_t variant, uint32_t friction_model)
{
    gw_controller_config_paper(config);
    config->geometry.azimuth_rad = (gw_real_t)0.7;
    config->estimator.velocity_source = ((variant & 1U) != 0U) ? GW_SOURCE_MEASURED : GW_SOURCE_PLANNED;
    config->estimator.acceleration_source = ((variant & 1U) != 0U) ? GW_SOURCE_MEASURED : GW_SOURCE_PLANNED;
    config->detector.kind = ((variant & 2U) != 0U) ? GW_DETECTOR_FORCE_AVERAGE : GW_DETECTOR_IMPULSE;
    config->admittance.kind = ((variant & 4U) != 0U) ? GW_ADMITTANCE_LIVE_FORCE : GW_ADMITTANCE_FROZEN_IMPULSE;
    config->estimator.friction_model = friction_model;
#if (GW_WITH_CHANNELS == 1)
    config->estimator.velocity_source = GW_SOURCE_MEASURED;
    config->estimator.acceleration_source =
        (WITHOUT_IMU || ((variant & 1U) != 0U)) ? GW_SOURCE_MEASURED : GW_SOURCE_IMU;
    config->estimator.aligned = 1U;
    if (!WITHOUT_OBSERVED_MOTORS) {
        gw_motor_config_trikey(&config->estimator.motor);
    }
    config->detector.kind = GW_DETECTOR_CHANNELS;
    config->imu.use = WITHOUT_IMU ? 0U : 1U;
    config->imu.position_x_m = (gw_real_t)0.1;
    config->imu.position_y_m = (gw_real_t)-0.05;
    config->imu.angle_rad = (gw_real_t)0.3;
#endif
#if (GW_WITH_ESCAPE == 1)
    config->admittance.kind = ((variant & 4U) != 0U) ? GW_ADMITTANCE_LIVE_FORCE : GW_ADMITTANCE_ESCAPE;
    config->admittance.smoothing_s = (gw_real_t)0.03;
    config->admittance.brake_limit_mps2 = (gw_real_t)3.0;
    config->admittance.lead_s = (gw_real_t)0.02;
    config->admittance.push_share = GW_TWO;
    config->admittance.ahead_mps = (gw_real_t)0.04;
    config->admittance.tip.height_m = (gw_real_t)0.5;
#endif
    config->estimator.rest_ticks = 100U;
    config->detector.blanking_ticks = 50U;
    config->supervisor.settled_ticks = 50U;
    config->contact.vertex_count = GW_OUTLINE_VERTEX_MAX;
    for (uint32_t i = 0U; i < GW_OUTLINE_VERTEX_MAX; i++) {
        const gw_rotation_t corner = gw_sincos((gw_real_t)i * (GW_PI / (gw_real_t)8.0));
        config->contact.vertex_m[i].x = (gw_real_t)0.4 * corner.cosine;
        config->contact.vertex_m[i].y = (gw_real_t)0.3 * corner.sine;
    }
}

/* An IMU on a robot that turns as its reference does and is shaken. */
static void shake(gw_imu_sample_t *imu, generator_t *generator, uint32_t tick)
{
    imu->present = true;
    imu->counter = tick;
    for (uint32_t i = 0U; i < GW_IMU_AXES; i++) {
        imu->specific_force_mps2[i] = generator_between(generator, (gw_real_t)-0.1, (gw_real_t)0.1);
    }
    imu->yaw_rate_radps =
        output.reference_twist.omega_radps + generator_between(generator, (gw_real_t)-0.003, (gw_real_t)0.003);
}

static uint32_t worst_found_by_search(uint32_t friction_model)
{
    static script_t script;
    uint32_t most = 0U;
    for (uint32_t variant = 0U; variant < 8U; variant++) {
        gw_controller_config_t config;
        demanding_config(&config, variant, friction_model);
        (void)gw_controller_init(&controller, &config, NULL);
        gw_controller_safe_output(&output);
        script_begin(&script, &config, 100U + variant, false);
        generator_t generator = generator_begin(300U + variant);
        for (uint32_t tick = 0U; tick < SEARCH_TICKS; tick++) {
            gw_controller_input_t input = *script_next(&script, &output);
            shake(&input.imu, &generator, tick);
            most = measured_step(&input, most);
        }
    }
    return most;
}

static uint32_t worst_servo_step(void)
{
    static const gw_servo_config_t config = {(gw_real_t)0.0005, (gw_real_t)203.0,
                                             (gw_real_t)8.0,    (gw_real_t)20.0,
                                             (gw_real_t)1000.0, 8500U,
                                             (gw_real_t)60.0,   10U};
    uint32_t most = 0U;
    generator_t generator = generator_begin(200U);
    gw_servo_t servo;
    gw_servo_output_t torque;
    (void)gw_servo_init(&servo, &config);
    for (uint32_t tick = 0U; tick < SERVO_TICKS; tick++) {
        gw_servo_input_t input;
        gw_servo_t changed;
        input.encoder_count = (int32_t)generator_below(&generator, GW_TICK_MASK);
        input.reference_is_new = generator_one_in(&generator, 2U);
        input.angle_rad = generator_between(&generator, -GW_ANGLE_MAX, GW_ANGLE_MAX);
        input.speed_radps = generator_wild(&generator, (gw_real_t)5.0);
        input.enable = !generator_one_in(&generator, 10U);
        const uint32_t start = SYST_CVR;
        for (uint32_t i = 0U; i < REPETITIONS; i++) {
            changed = servo;
            (void)gw_servo_step(&changed, &input, &torque);
        }
        const uint32_t with = ticks_since(start);
        const uint32_t again = SYST_CVR;
        for (uint32_t i = 0U; i < REPETITIONS; i++) {
            changed = servo;
            (void)no_step((gw_controller_t *)&changed, (const gw_controller_input_t *)&input,
                          (gw_controller_output_t *)&torque);
        }
        const uint32_t instructions = with - ticks_since(again);
        most = (instructions > most) ? instructions : most;
        servo = changed;
        (void)gw_servo_step(&servo, &input, &torque);
    }
    return most;
}

int main(void)
{
    const uint32_t window = (uint32_t)sizeof controller.estimator.average.sample;
    SYST_RVR = LONGEST;
    SYST_CVR = 0U;
    SYST_CSR = COUNT_DOWN_AT_PROCESSOR_CLOCK;
#if (GW_WITH_CHANNELS == 1)
    (void)printf("all_ram %" PRIu32 "\n", (uint32_t)sizeof(gw_controller_t) - window);
    (void)printf("all_step %" PRIu32 "\n",
                 worst_found_by_search(WITHOUT_BRISTLES ? GW_FRICTION_TANH : GW_FRICTION_BRISTLE));
#else
    (void)printf("controller_ram %" PRIu32 "\n", (uint32_t)sizeof(gw_controller_t) - window);
    (void)printf("window_ram %" PRIu32 "\n", window);
    (void)printf("servo_ram %" PRIu32 "\n", (uint32_t)sizeof(gw_servo_t));
    (void)printf("step_recorded %" PRIu32 "\n", worst_over_recorded_collision());
    (void)printf("step_searched %" PRIu32 "\n", worst_found_by_search(GW_FRICTION_TANH));
    (void)printf("step_bristles %" PRIu32 "\n", worst_found_by_search(GW_FRICTION_BRISTLE));
    (void)printf("servo_step %" PRIu32 "\n", worst_servo_step());
#endif
    return 0;
}
