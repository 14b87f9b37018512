#include "unit.h"

/* B_r tanh(alpha q'), (28): 0.2 tanh(0.5 rate). */
static void friction_opposes_and_saturates(void)
{
    const gw_friction_config_t config = {R(0.2), R(0.5)};
    const gw_wheels_t rates = {{R(0.0), R(1.0), R(-100.0)}};
    const gw_wheels_t torques = gw_friction_torques(&config, &rates);
    CHECK(torques.wheel[0] == R(0.0));
    CHECK_NEAR(torques.wheel[1], R(0.092423431452001952), R(0.2) * ROUNDING);
    CHECK(torques.wheel[2] == R(-0.2));
}

void suite_friction(void)
{
    unit_run("friction_opposes_and_saturates", friction_opposes_and_saturates);
}
