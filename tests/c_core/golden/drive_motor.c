/* The observer of the motors. */
#include "generator.h"
#include "giveway/gw_math.h"
#include "giveway/gw_motor.h"
#include "modules.h"

#if (GW_WITH_CHANNELS == 1)
#define COUNTS 8500U

/* Wheels that turn about as commanded, now and then slowly or by a jump; from any count. */
typedef struct {
    uint32_t count[GW_WHEEL_COUNT];
    gw_real_t beyond[GW_WHEEL_COUNT]; /* counts */
    gw_joint_command_t command;
} wheels_t;

static void turn(generator_t *generator, wheels_t *wheels)
{
    const gw_real_t per_count = (gw_real_t)(6.283185307179586 / 8500.0);
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        const gw_real_t turned = (wheels->command.speed_radps[i] * (gw_real_t)0.001) / per_count;
        wheels->beyond[i] += turned + generator_between(generator, (gw_real_t)-0.05, (gw_real_t)0.05);
        while (wheels->beyond[i] >= GW_ONE) {
            wheels->beyond[i] -= GW_ONE;
            wheels->count[i]++;
        }
        while (wheels->beyond[i] < GW_ZERO) {
            wheels->beyond[i] += GW_ONE;
            wheels->count[i]--;
        }
        if (generator_one_in(generator, 700U)) {
            wheels->count[i] += generator_below(generator, 9U);
        }
        const int32_t within_turn = (int32_t)(wheels->count[i] & GW_TICK_MASK) % (int32_t)COUNTS;
        const gw_real_t ahead = generator_between(generator, (gw_real_t)-0.01, (gw_real_t)0.02);
        wheels->command.angle_rad[i] = gw_wrap_angle(((gw_real_t)within_turn * per_count) + ahead);
        if (generator_one_in(generator, 400U)) {
            const gw_real_t fastest = generator_one_in(generator, 4U) ? (gw_real_t)0.1 : (gw_real_t)4.0;
            wheels->command.speed_radps[i] = generator_between(generator, -fastest, fastest);
        }
    }
}

static void digest_wheel(digest_t *digest, const gw_motor_wheel_t *wheel)
{
    digest_real(digest, wheel->angle_rad);
    digest_real(digest, wheel->rate_radps);
    digest_real(digest, wheel->unknown_radps2);
    digest_real(digest, wheel->servo_radps);
    digest_real(digest, wheel->share);
    digest_u32(digest, wheel->same_ticks);
    digest_u32(digest, wheel->sure_ticks);
}

/* Known motors with all delays, one behind a rigid drivetrain, and one whose inertia is not known. */
digest_t drive_motor(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(41U);
    for (uint32_t k = 0U; k < (GW_MOTOR_DELAY_MAX + 2U); k++) {
        static gw_motor_t motor;
        gw_rate_filter_constants_t constants;
        gw_motor_config_t config;
        wheels_t wheels = {{0x7FFFFF00U, 0U, 17U}, {GW_HALF, GW_ZERO, GW_ZERO}, {{GW_ZERO}, {GW_ONE, GW_TWO, GW_ONE}}};
        const bool rigid = (k == GW_MOTOR_DELAY_MAX);
        gw_motor_config_trikey(&config);
        config.delay_ticks = rigid ? 2U : ((k % GW_MOTOR_DELAY_MAX) + 1U);
        config.cutoff_radps = generator_between(&generator, (gw_real_t)20.0, (gw_real_t)80.0);
        config.inertia_kgm2 = (k == (GW_MOTOR_DELAY_MAX + 1U)) ? GW_ZERO : (gw_real_t)0.05;
        digest_u32(&digest, (uint32_t)gw_rate_filter_constants(&constants, (gw_real_t)0.001, (gw_real_t)200.0, COUNTS,
                                                               rigid ? GW_ZERO : (gw_real_t)700.0));
        gw_motor_init(&motor, &config, &constants, COUNTS);
        digest_bool(&digest, gw_motor_is_known(&motor));
        for (uint32_t i = 0U; i < 1500U; i++) {
            gw_real_t counted;
            int32_t counts[GW_WHEEL_COUNT];
            const gw_wheels_t torque_nm =
                generator_wheels(&generator, generator_one_in(&generator, 200U) ? (gw_real_t)20.0 : GW_HALF);
            for (uint32_t wheel = 0U; wheel < GW_WHEEL_COUNT; wheel++) {
                counts[wheel] = (int32_t)(wheels.count[wheel] & GW_TICK_MASK);
            }
            const gw_wheels_t twist_nm = gw_motor_step(&motor, counts, &torque_nm, &counted);
            digest_wheels(&digest, &twist_nm);
            digest_real(&digest, counted);
            digest_wheel(&digest, &motor.wheel[i % GW_WHEEL_COUNT]);
            turn(&generator, &wheels);
            gw_motor_command(&motor, &wheels.command, !generator_one_in(&generator, 500U));
            if (generator_one_in(&generator, 900U)) {
                gw_motor_restart(&motor);
            }
        }
    }
    return digest;
}
#endif
