/* Prints one line per module: its name, the real type, and the digest of everything it put out. */
#include <inttypes.h>
#include <stdio.h>

#include "modules.h"

typedef struct {
    const char *name;
    digest_t (*drive)(void);
} module_t;

static const module_t modules[] = {
    {"math", drive_math},
    {"vectors", drive_vectors},
    {"kinematics", drive_kinematics},
    {"friction", drive_friction},
    {"gear", drive_gear},
    {"nominal", drive_nominal},
    {"wrench", drive_wrench},
    {"sum", drive_sum},
    {"tare", drive_tare},
    {"moving_average", drive_moving_average},
    {"rate_filter", drive_rate_filter},
    {"presliding", drive_presliding},
    {"config", drive_config},
    {"sensor_check", drive_sensor_check},
    {"contact", drive_contact},
    {"detector", drive_detector},
    {"supervisor", drive_supervisor},
    {"estimator", drive_estimator},
    {"admittance", drive_admittance},
#if (GW_WITH_ESCAPE == 1)
    {"escape", drive_escape},
    {"tip", drive_tip},
#endif
    {"reference", drive_reference},
    {"joint", drive_joint},
    {"servo", drive_servo},
    {"controller.trikey", drive_controller_trikey},
    {"controller.measuring", drive_controller_measuring},
    {"controller.watching", drive_controller_watching},
    {"controller.bristles", drive_controller_bristles},
    {"controller.recorded", drive_controller_recorded},
    {"controller.reached", drive_controller_reached},
    {"balance", drive_balance},
#if (GW_WITH_CHANNELS == 1)
    {"follower", drive_follower},
    {"model_covariance", drive_model_covariance},
    {"slip", drive_slip},
    {"ripple", drive_ripple},
    {"fast_channel", drive_fast_channel},
    {"slow_channel", drive_slow_channel},
    {"channels", drive_channels},
    {"imu", drive_imu},
    {"motor", drive_motor},
    {"controller.channels", drive_controller_channels},
#endif
};

int main(void)
{
    for (uint32_t i = 0U; i < (sizeof modules / sizeof modules[0]); i++) {
        const digest_t digest = modules[i].drive();
        (void)printf("%-21s %-6s %08" PRIx32 "%08" PRIx32 "\n", modules[i].name,
                     (GW_REAL_DOUBLE == 1) ? "double" : "float", (uint32_t)(digest.value >> 32U),
                     (uint32_t)digest.value);
    }
    return 0;
}
