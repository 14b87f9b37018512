/* What the balance of forces may be wrong by, besides what the model does not know of friction and masses:
 * gw_channels.h fills it in, both channels compare with it. */
#ifndef GW_DOUBTS_H
#define GW_DOUBTS_H

#include "giveway/gw_slip.h"
#include "giveway/gw_types.h"

/* Largest square of a step between rows of rollers, (m/s)^2. */
#define GW_ROW_MAX_M2PS2 ((gw_real_t)100.0)

typedef struct {
    gw_real_t forces_n2;  /* sum of the squares of the model's forces, not of their change: rows of rollers */
    gw_real_t rocking_n2; /* variance of what the rocking body does, [0, 1e12] */
    gw_real_t gear_n2;    /* k_m^2 times what gears may be wrong by, now and as long as the slow channel remembers it,
                           * [0, 1e12] */
    gw_real_t row_m2ps2;  /* square of a wheel's step of speed between rows of rollers, (m/s)^2, at most
                           * GW_ROW_MAX_M2PS2 */
    gw_real_t ripple2;    /* k_m^2 times the variance of what the friction of a wheel varies by from roller to roller,
                           * relative, [0, 4e4] */
    gw_real_t usual2;     /* the least of it that is usual for rollers that each have all of their friction, [0, 4e4] */
    gw_slip_t slip;       /* k_m^2 times that of wheels that may slip */
} gw_doubts_t;

#endif
