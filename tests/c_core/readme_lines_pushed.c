/* The lines of C in the repository's README: at rest nothing happens; pushed at 0.3 s, the robot reacts, and gives way
 * as soon as it knows where to. */
#include "giveway/giveway.h"

#include <stdio.h>

bool start_reflexes(void);
bool every_millisecond(const gw_controller_input_t *sensed, gw_controller_output_t *to_do);

int main(void)
{
    const uint32_t pushed = 300U;
    const uint32_t last = 350U;
    gw_controller_input_t sensed = {0};
    gw_controller_output_t to_do = {0};
    uint32_t tick = 0U;
    bool reacts = false;
    bool good = start_reflexes();
    sensed.sensor.present = true;
    for (; tick < last; tick++) {
        const gw_real_t torque_nm = (tick < pushed) ? (gw_real_t)0.0 : (gw_real_t)1.0;
        sensed.sensor.counter = tick;
        sensed.sensor.torque_nm[1] = torque_nm;
        sensed.sensor.torque_nm[2] = -torque_nm;
        reacts = every_millisecond(&sensed, &to_do);
        good = good && to_do.enable && ((tick >= pushed) || (!reacts));
    }
    (void)printf("%s, wheel 1 at %g rad/s\n", reacts ? "reacts" : "does not react",
                 (double)to_do.command.speed_radps[1]);
    return (good && reacts && (to_do.command.speed_radps[1] != (gw_real_t)0.0)) ? 0 : 1;
}
