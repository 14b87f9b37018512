/* Prints the size of the real type that the library and its user agree on, and the default mass. */
#include "giveway/giveway.h"

#include <stdio.h>

int main(void)
{
    static gw_controller_t controller;
    gw_controller_config_t config;
    gw_controller_config_trikey(&config);
    (void)printf("%u %.1f\n", (unsigned)sizeof(gw_real_t), (double)config.base.mass_kg);
    return (gw_controller_init(&controller, &config, NULL) == GW_STATUS_OK) ? 0 : 1;
}
