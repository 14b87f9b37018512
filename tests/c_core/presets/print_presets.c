/* Prints both presets, one line per field of the controller: preset, name, values as C99 hexadecimal floats. Ends with
 * 1 if the check refuses one of them. */
#include <stdio.h>

#include "giveway/giveway.h"

#define REAL(name, value) (void)printf("%s %s %a\n", preset, (name), (double)(value));
#define EACH(name, count, value) \
    (void)printf("%s %s", preset, (name)); \
    for (uint32_t i = 0U; i < (count); i++) { \
        (void)printf(" %a", (double)(value)); \
    } \
    (void)printf("\n");

#define PRINT(kind, field, name, member, minimum, maximum) PRINT_##kind(name, member)
#define PRINT_REAL(name, member) REAL(name, member)
#define PRINT_COUNT(name, member) REAL(name, member)
#define PRINT_WHEEL_REAL(name, member) EACH(name, GW_WHEEL_COUNT, member)
#define PRINT_WHEEL_COUNT(name, member) EACH(name, GW_WHEEL_COUNT, member)
#define PRINT_VERTEX_REAL(name, member) EACH(name, GW_OUTLINE_VERTEX_MAX, member)
#define PRINT_RULE(name, member)

static bool print(const char *preset, const gw_controller_config_t *config)
{
    gw_config_error_t error;
    GW_CONTROLLER_CONFIG_FIELDS(PRINT, config->)
    return gw_controller_config_check(config, &error) == GW_STATUS_OK;
}

int main(void)
{
    static gw_controller_config_t best;
    static gw_controller_config_t paper;
    gw_controller_config_trikey(&best);
    gw_controller_config_paper(&paper);
    const bool valid = print("default", &best);
    return (print("paper", &paper) && valid) ? 0 : 1;
}
