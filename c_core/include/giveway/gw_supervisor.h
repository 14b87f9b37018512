/* Selects the robot's mode; gw_controller implements what each mode does.
 *
 *     TARING --zero taken--> TRACKING --hit--> REACTING --quiet--> SETTLED --> REJOINING --on the path--> TRACKING
 *     any but FAULT --stop request--> STOPPED      any --bad sensors--> FAULT      a hit leads to REACTING from every
 *     mode but TARING, STOPPED and FAULT; SETTLED holds for ever if the configuration says so.
 * After STOPPED and FAULT: back to TARING, REACTING (the escape is abandoned) or SETTLED; a robot that was TRACKING or
 * REJOINING goes to REJOINING. A new tare, when asked for, leads from TRACKING or SETTLED to TARING and back. The path
 * clock runs in TRACKING only.
 *
 * Life cycle: gw_supervisor_init, gw_supervisor_step per tick. All members are private.
 */
#ifndef GW_SUPERVISOR_H
#define GW_SUPERVISOR_H

#include "giveway/gw_config.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum {
    GW_MODE_TARING = 0,    /* standing, the sensors' zero is being taken */
    GW_MODE_TRACKING = 1,  /* following the plan */
    GW_MODE_REACTING = 2,  /* giving way */
    GW_MODE_SETTLED = 3,   /* came to rest after a reaction */
    GW_MODE_REJOINING = 4, /* going back to the path; its clock stands still */
    GW_MODE_STOPPED = 5,   /* stop request */
    GW_MODE_FAULT = 6      /* bad sensors: zero motion */
} gw_mode_t;

#define GW_AFTER_SETTLED_HOLD 0U
#define GW_AFTER_SETTLED_REJOIN 1U

typedef struct {
    /* Reference speed below which a reaction may be over, m/s, [0.000001, 1]. */
    gw_real_t settled_speed_mps;
    /* Ticks of quiet that end a reaction, [1, 100000]. */
    uint32_t settled_ticks;
    /* GW_AFTER_SETTLED_HOLD (0) or GW_AFTER_SETTLED_REJOIN (1). */
    uint32_t after_settled;
    /* Distance and angle from the path at which it counts as rejoined, m, [0.00001, 1] and rad, [0.0001, 1]. */
    gw_real_t rejoin_distance_m;
    gw_real_t rejoin_angle_rad;
} gw_supervisor_config_t;

/* What happened in this tick. */
typedef struct {
    bool sensors_good;
    bool stop_request;
    bool tare_accepted; /* a new tare was asked for and may start */
    bool tare_done;
    bool hit;
    bool quiet;   /* reference slow and force below F0 */
    bool on_path; /* close to the plan's pose and slow */
    bool plan_valid;
} gw_supervisor_events_t;

typedef struct {
    gw_supervisor_config_t config;
    gw_mode_t mode;
    gw_mode_t resume; /* the mode that follows STOPPED, FAULT or a tare */
    uint32_t quiet_ticks;
    uint32_t path_ticks;
    bool tare_pending; /* a tare was interrupted and must be taken again first */
    bool initialised;
} gw_supervisor_t;

/* The values of Trikey, the paper's robot. Pointers not NULL in these two. */
void gw_supervisor_config_trikey(gw_supervisor_config_t *config);
GW_SMALL void gw_supervisor_config_check(const gw_supervisor_config_t *config, gw_config_error_t *error);
GW_SMALL gw_status_t gw_supervisor_init(gw_supervisor_t *supervisor, const gw_supervisor_config_t *config);
bool gw_supervisor_invariant_holds(const gw_supervisor_t *supervisor);
/* One tick; returns the mode that holds from now on (GW_MODE_FAULT if there is no usable supervisor). */
GW_SMALL gw_mode_t gw_supervisor_step(gw_supervisor_t *supervisor, const gw_supervisor_events_t *events);

#ifdef __cplusplus
}
#endif

#endif
