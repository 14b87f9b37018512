/* Any value within a range, for the prover; and a value that must be within one. */
#ifndef EVA_DRAW_H
#define EVA_DRAW_H

#include "__fc_builtin.h"
#include "giveway/giveway.h"
#include "giveway/gw_math.h"

extern volatile float any_float; /* with -warn-special-float none: NaN and the infinities, too */
extern volatile int any_int;
extern volatile unsigned int any_count;

/* An unbounded input. */
static gw_real_t any_real(void)
{
#ifdef NONFINITE_INPUTS
    return any_float;
#else
    return Frama_C_float_interval(-GW_REAL_MAX, GW_REAL_MAX);
#endif
}

static bool any_flag(void)
{
    return any_int != 0;
}

static gw_real_t draw_real(gw_real_t low, gw_real_t high)
{
    return Frama_C_float_interval(low, high);
}

static uint32_t draw_count(uint32_t low, uint32_t high)
{
    return Frama_C_unsigned_int_interval(low, high);
}

static int32_t draw_integer(int32_t low, int32_t high)
{
    return Frama_C_interval(low, high);
}

/* A setting that init has to refuse. */
static gw_real_t draw_refused(gw_config_field_t field)
{
    return draw_real(gw_config_limit(field).maximum + GW_ONE, GW_REAL_MAX);
}

static gw_real_t draw_setting(gw_config_field_t field)
{
    return draw_real(gw_config_limit(field).minimum, gw_config_limit(field).maximum);
}

/* Eva raises an alarm wherever it cannot show what these require. No NaN is within a range. */
/*@ requires within_range: low <= value <= high;
  @ assigns \nothing; */
void demand_real(gw_real_t value, gw_real_t low, gw_real_t high);
/*@ requires within_range: low <= value <= high;
  @ assigns \nothing; */
void demand_count(uint32_t value, uint32_t low, uint32_t high);
/*@ requires within_range: low <= value <= high;
  @ assigns \nothing; */
void demand_integer(int32_t value, int32_t low, int32_t high);

#endif
