/* Where a push meets the outline of the body, (41)-(46).
 *
 * A single force leaves no moment on the line p x F = M. Of the two points where this line crosses the convex
 * outline, the contact is the one where the force points into the body. If noise pushes the line past the outline, the
 * nearest outline point is given, and flagged.
 *
 * Life cycle: gw_contact_init, then read-only. All members are private.
 */
#ifndef GW_CONTACT_H
#define GW_CONTACT_H

#include "giveway/gw_config.h"
#include "giveway/gw_types.h"
#include "giveway/gw_wrench.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    /* Number of vertices, [3, 16]. */
    uint32_t vertex_count;
    /* Vertices in the base frame, counter-clockwise, strictly convex (no three on a line), m, each in [-10, 10].
     * Entries from vertex_count on are ignored. */
    gw_vector_t vertex_m[GW_OUTLINE_VERTEX_MAX];
    /* Smallest force that is located at all, N, [0.001, 1000]. */
    gw_real_t minimum_force_n;
} gw_contact_config_t;

typedef struct {
    gw_contact_config_t config;
    bool initialised;
} gw_contact_t;

typedef struct {
    /* False if the force is below the minimum or not finite; all else is then zero. */
    bool valid;
    /* True if the line of the force crosses the outline; false: the nearest outline point is given. */
    bool on_outline;
    gw_vector_t point_m;
    gw_real_t force_n;
    gw_real_t direction_rad;
    /* Signed distance of the line from the centre, M/|F|, and its standard deviation. */
    gw_real_t lever_arm_m;
    gw_real_t lever_arm_sigma_m;
} gw_contact_estimate_t;

/* The values of Trikey, the paper's robot. Pointers not NULL in these two. */
void gw_contact_config_trikey(gw_contact_config_t *config);
GW_SMALL void gw_contact_config_check(const gw_contact_config_t *config, gw_config_error_t *error);
GW_SMALL gw_status_t gw_contact_init(gw_contact_t *contact, const gw_contact_config_t *config);
bool gw_contact_invariant_holds(const gw_contact_t *contact);
/* Locates the contact of a wrench whose noise is sigma. All in the base frame. */
gw_status_t gw_contact_locate(const gw_contact_t *contact, gw_wrench_t wrench, gw_wrench_sigma_t sigma,
                              gw_contact_estimate_t *estimate);

#ifdef __cplusplus
}
#endif

#endif
