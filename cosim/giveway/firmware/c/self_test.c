/* Feels a recorded collision, and compares every bit of every output with what the controller's FMU put out. Then it
 * pulls the sensors out and looks whether the drives are held and switched off.
 *
 * The exit code is 0 if all is as it should be. */
#include "controller_words.h"
#include "main_step.h"
#include "recorded_collision.h"
#include "semihosting.h"

static uint32_t tick;
static bool sensors_pulled_out;
static robot_drives_t driven;

void board_read_sensors(robot_sensors_t *sensors)
{
    if (!sensors_pulled_out) {
        *sensors = recorded_sensors[tick];
    }
}

void board_plan(uint32_t path_ticks, gw_plan_t *plan)
{
    (void)path_ticks; /* it stands still */
    (void)plan;
}

void board_requests(bool *stop, bool *tare)
{
    *stop = false;
    *tare = false;
}

void board_write_drives(const robot_drives_t *drives)
{
    driven = *drives;
}

static bool tell(uint32_t output, uint32_t found)
{
    semihosting_write("tick ");
    semihosting_write_decimal((int32_t)tick);
    semihosting_write(": ");
    semihosting_write(controller_output_names[output]);
    semihosting_write(" has the bits ");
    semihosting_write_hexadecimal(found);
    semihosting_write(", recorded were ");
    semihosting_write_hexadecimal(recorded_outputs[tick][output]);
    semihosting_write("\n");
    return false;
}

static bool replay(void)
{
    uint32_t words[CONTROLLER_OUTPUT_WORDS];
    for (tick = 0U; tick < RECORDED_TICKS; tick++) {
        robot_every_period();
        controller_output_to_words(robot_status(), robot_output(), words);
        for (uint32_t i = 0U; i < CONTROLLER_OUTPUT_WORDS; i++) {
            if (words[i] != recorded_outputs[tick][i]) {
                return tell(i, words[i]);
            }
        }
    }
    semihosting_write(ROBOT_NAME ": ");
    semihosting_write_decimal((int32_t)RECORDED_TICKS);
    semihosting_write(" ticks of ");
    semihosting_write_decimal((int32_t)CONTROLLER_OUTPUT_WORDS);
    semihosting_write(" outputs: the recorded bits; hits: ");
    semihosting_write_decimal((int32_t)robot_output()->detection_count);
    semihosting_write("\n");
    return true;
}

static bool stands_still(void)
{
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        if (driven.speed_radps[i] != (gw_real_t)0) {
            return false;
        }
    }
    return true;
}

static bool without_sensors(void)
{
    const bool held = driven.enable;
    bool safe = true;
    sensors_pulled_out = true;
    for (uint32_t i = 0U; i <= ROBOT_FAULT_TICKS_MAX; i++) {
        safe = safe && ((i == 0U) || (driven.enable == held));
        robot_every_period();
        safe = safe && (robot_status() == GW_STATUS_SENSOR_MISSING) && stands_still();
    }
    safe = safe && !driven.enable;
    semihosting_write(safe ? "without sensors: wheels held, then drives off\n" : "without sensors: NOT SAFE\n");
    return safe;
}

int main(void)
{
    if (!robot_start()) {
        semihosting_write("the configuration was refused: ");
        semihosting_write(robot_refused());
        semihosting_write("\n");
        return 1;
    }
    return (replay() && without_sensors()) ? 0 : 1;
}
