/* Replays a recorded collision through the controller and prints when it noticed the hit, and a digest of all its
 * outputs.
 *
 * On a robot, the input of each millisecond comes from the bus instead of the recording, and output.command goes to
 * the drives. */
#include "digest.h"
#include "recorded_collision.h"
#include "semihosting.h"

static gw_controller_t controller;

int main(void)
{
    gw_controller_config_t config;
    gw_controller_output_t output;
    digest_t digest = digest_begin();
    int32_t first_hit_tick = -1;

    gw_controller_config_trikey(&config);
    config.supervisor.after_settled = GW_AFTER_SETTLED_HOLD; /* as in that run */
    if (gw_controller_init(&controller, &config, NULL) != GW_STATUS_OK) {
        semihosting_write("the configuration was refused\n");
        return 1;
    }
    for (uint32_t tick = 0U; tick < RECORDED_TICKS; tick++) {
        gw_controller_input_t input;
        recorded_collision_input(tick, &input);
        const gw_status_t status = gw_controller_step(&controller, &input, &output);
        digest_controller(&digest, status, &output);
        if (first_hit_tick < 0) {
            first_hit_tick = output.detection_tick;
        }
    }
    semihosting_write("first hit at tick ");
    semihosting_write_decimal(first_hit_tick);
    semihosting_write("\nlast hit at tick ");
    semihosting_write_decimal(output.detection_tick);
    semihosting_write("\noutputs ");
    semihosting_write_hexadecimal(digest.value);
    semihosting_write("\n");
    return 0;
}
