/* draw_X(&state): any state of module X that its invariant allows. hold_X(&state): it must be one. disturb_X(&state):
 * any that may break it. */
#ifndef EVA_STATES_H
#define EVA_STATES_H

#include "draw.h"
#include "giveway/gw_math.h"

static uint32_t lowest_count(gw_config_field_t field)
{
    return (uint32_t)gw_config_limit(field).minimum;
}

static uint32_t highest_count(gw_config_field_t field)
{
    return (uint32_t)gw_config_limit(field).maximum;
}

#define PI_ROUNDED ((gw_real_t)3.1415928)
#define EXCESS ((gw_real_t)1024.0)
#define ZERO_STEP_MAX ((gw_real_t)1.0e20) /* of a change of the tared wrench */

/* The rows of the tables in gw_config.h. */
#define SETTING_OF_ROW(kind, field, name, member, minimum, maximum) SETTING_OF_##kind(member, field)
#define SETTING_OF_REAL(member, field) SETTING(member, field);
#define SETTING_OF_COUNT(member, field) COUNT_SETTING(member, field);
#define SETTING_OF_WHEEL_REAL(member, field) \
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) { \
        SETTING(member, field); \
    }
#define SETTING_OF_WHEEL_COUNT(member, field) \
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) { \
        COUNT_SETTING(member, field); \
    }
#define SETTING_OF_VERTEX_REAL(member, field) \
    for (uint32_t i = 0U; i < GW_OUTLINE_VERTEX_MAX; i++) { \
        SETTING(member, field); \
    }
#define SETTING_OF_RULE(member, field)

#define VISIT(name) draw_##name
#define REAL(place, low, high) ((place) = draw_real((low), (high)))
#define COUNT(place, low, high) ((place) = draw_count((low), (high)))
#define INTEGER(place, low, high) ((place) = draw_integer((low), (high)))
#define CHOICE(place, type, last) ((place) = (type)draw_count(0U, (last)))
#define FLAG(place) ((place) = any_flag())
#define TRUE(place) ((place) = true)
#define SETTING(place, field) REAL(place, gw_config_limit(field).minimum, gw_config_limit(field).maximum)
#define COUNT_SETTING(place, field) COUNT(place, lowest_count(field), highest_count(field))
#include "states.inc"

#undef VISIT
#undef REAL
#undef COUNT
#undef INTEGER
#undef CHOICE
#undef FLAG
#undef TRUE
#define VISIT(name) hold_##name
#define REAL(place, low, high) demand_real((place), (low), (high))
#define COUNT(place, low, high) demand_count((place), (low), (high))
#define INTEGER(place, low, high) demand_integer((place), (low), (high))
#define CHOICE(place, type, last) demand_count((uint32_t)(place), 0U, (last))
#define FLAG(place) demand_count((place) ? 1U : 0U, 0U, 1U)
#define TRUE(place) demand_count((place) ? 1U : 0U, 1U, 1U)
#include "states.inc"

#undef VISIT
#undef REAL
#undef COUNT
#undef INTEGER
#undef CHOICE
#undef FLAG
#undef TRUE
#undef SETTING
#undef COUNT_SETTING
#define VISIT(name) disturb_##name
#ifdef NONFINITE_INPUTS
#define REAL(place, low, high) ((place) = any_float)
#else
#define REAL(place, low, high) ((place) = draw_real(-(gw_real_t)1.0e18, (gw_real_t)1.0e18))
#endif
#define COUNT(place, low, high) ((place) = any_count)
#define INTEGER(place, low, high) ((place) = any_int)
#define CHOICE(place, type, last) ((place) = (type)draw_count(0U, (last) + 1U))
#define FLAG(place) ((place) = any_flag())
#define TRUE(place) ((place) = any_flag())
#define SETTING(place, field) \
    ((place) = draw_real(gw_config_limit(field).minimum, gw_config_limit(field).maximum + (gw_real_t)1000.0))
#define COUNT_SETTING(place, field) ((place) = draw_count(lowest_count(field), highest_count(field) + 1U))
#include "states.inc"

#endif
