#include "giveway/gw_contact.h"

#include "giveway/gw_math.h"
#include "giveway/gw_trikey.h"

/* A longer lever arm says only that the force is too small for its moment. */
#define LEVER_ARM_MAX ((gw_real_t)1.0e6)

static gw_real_t cross(gw_vector_t a, gw_vector_t b)
{
    return (a.x * b.y) - (a.y * b.x);
}

/* How far a point lies to the right of the line p x u = offset that runs along u. */
static gw_real_t side_of(gw_vector_t point, gw_vector_t direction, gw_real_t offset_m)
{
    return cross(point, direction) - offset_m;
}

/* side_of(...) > 0: a difference has the sign of the order. */
static bool is_right_of(gw_vector_t point, gw_vector_t direction, gw_real_t offset_m)
{
    return cross(point, direction) > offset_m;
}

static gw_vector_t from_to(gw_vector_t a, gw_vector_t b)
{
    const gw_vector_t difference = {b.x - a.x, b.y - a.y};
    return difference;
}

void gw_contact_config_trikey(gw_contact_config_t *config)
{
    static const gw_vector_t outline[GW_TRIKEY_OUTLINE_COUNT] = {
        {GW_TRIKEY_OUTLINE_X0_M, GW_TRIKEY_OUTLINE_Y0_M},
        {GW_TRIKEY_OUTLINE_X1_M, GW_TRIKEY_OUTLINE_Y1_M},
        {GW_TRIKEY_OUTLINE_X2_M, GW_TRIKEY_OUTLINE_Y2_M},
    };
    config->minimum_force_n = GW_ONE;
    config->vertex_count = GW_TRIKEY_OUTLINE_COUNT;
    for (uint32_t i = 0U; i < GW_OUTLINE_VERTEX_MAX; i++) {
        config->vertex_m[i].x = (i < GW_TRIKEY_OUTLINE_COUNT) ? outline[i].x : GW_ZERO;
        config->vertex_m[i].y = (i < GW_TRIKEY_OUTLINE_COUNT) ? outline[i].y : GW_ZERO;
    }
}

void gw_contact_config_check(const gw_contact_config_t *config, gw_config_error_t *error)
{
    const uint32_t count = config->vertex_count;
    gw_config_check_real(error, GW_FIELD_CONTACT_MINIMUM_FORCE, config->minimum_force_n);
    gw_config_check_count(error, GW_FIELD_OUTLINE_COUNT, config->vertex_count);
    for (uint32_t i = 0U; i < GW_OUTLINE_VERTEX_MAX; i++) {
        if (i < count) {
            gw_config_check_element(error, GW_FIELD_OUTLINE_X, i, config->vertex_m[i].x);
            gw_config_check_element(error, GW_FIELD_OUTLINE_Y, i, config->vertex_m[i].y);
        }
    }
    /* Strictly convex and counter-clockwise: every other vertex lies to the left of every edge. Checking neighbours
     * only would accept a star. */
    for (uint32_t i = 0U; i < GW_OUTLINE_VERTEX_MAX; i++) {
        for (uint32_t j = 0U; j < GW_OUTLINE_VERTEX_MAX; j++) {
            const uint32_t next = ((i + 1U) < count) ? (i + 1U) : 0U;
            if ((i < count) && (j < count) && (j != i) && (j != next) && (error->field == GW_FIELD_NONE)) {
                const gw_vector_t edge = from_to(config->vertex_m[i], config->vertex_m[next]);
                const gw_real_t area = cross(edge, from_to(config->vertex_m[i], config->vertex_m[j]));
                if (!(area > GW_ZERO)) {
                    error->field = GW_FIELD_OUTLINE_CONVEX;
                    error->index = i;
                    error->value = area;
                }
            }
        }
    }
}

gw_status_t gw_contact_init(gw_contact_t *contact, const gw_contact_config_t *config)
{
    gw_status_t status = GW_STATUS_OK;
    if ((contact == NULL) || (config == NULL)) {
        status = GW_STATUS_NULL_POINTER;
    } else {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_contact_config_check(config, &error);
        if (error.field != GW_FIELD_NONE) {
            status = GW_STATUS_CONFIG_INVALID;
            contact->initialised = false;
        } else {
            contact->config = *config;
            contact->initialised = true;
        }
    }
    return status;
}

bool gw_contact_invariant_holds(const gw_contact_t *contact)
{
    bool holds = (contact != NULL);
    if (holds) {
        holds = contact->initialised;
    }
    if (holds) {
        gw_config_error_t error;
        gw_config_check_begin(&error);
        gw_contact_config_check(&contact->config, &error);
        holds = (error.field == GW_FIELD_NONE);
    }
    return holds;
}

/* Goes along the corners, from the last one down, until the line p x u = offset is crossed. Returns the corner at which
 * that edge ends, or 0 if all corners are on one side. nearest: the corner nearest to the line among those that were
 * passed. A corner on the line counts as on its left. */
static uint32_t crossed_edge(const gw_contact_config_t *config, gw_vector_t direction, gw_real_t offset_m,
                             uint32_t *nearest)
{
    const gw_vector_t *const corner = config->vertex_m;
    const uint32_t last = config->vertex_count - 1U;
    /* Seen along u or against it, so that the distance of the last corner is positive. */
    const bool last_is_right = is_right_of(corner[last], direction, offset_m);
    const gw_vector_t reversed = {-direction.x, -direction.y};
    const gw_vector_t line = last_is_right ? direction : reversed;
    const gw_real_t line_m = last_is_right ? offset_m : -offset_m;
    gw_real_t nearest_m = side_of(corner[last], line, line_m);
    uint32_t crossed = 0U;
    *nearest = last;
    for (uint32_t i = last; (i > 0U) && (crossed == 0U); i--) {
        const gw_real_t distance_m = side_of(corner[i - 1U], line, line_m);
        if (distance_m < nearest_m) {
            nearest_m = distance_m;
            *nearest = i - 1U;
            if ((distance_m < GW_ZERO) || ((distance_m <= GW_ZERO) && last_is_right)) {
                crossed = i;
            }
        } else if ((distance_m <= nearest_m) &&
                   (gw_along(corner[i - 1U], direction) <= gw_along(corner[*nearest], direction))) {
            *nearest = i - 1U; /* an edge parallel to the line: the end that the force meets first */
        } else {
            /* farther away */
        }
    }
    return crossed;
}

/* The point where the line p x u = offset enters the outline in direction u. If it passes the outline by: the corner
 * nearest to it. */
static void cut_outline(const gw_contact_config_t *config, gw_vector_t direction, gw_real_t offset_m,
                        gw_contact_estimate_t *estimate)
{
    const gw_vector_t *const corner = config->vertex_m;
    uint32_t nearest;
    uint32_t end = crossed_edge(config, direction, offset_m, &nearest);
    estimate->on_outline = (end > 0U);
    if (estimate->on_outline) {
        /* Counter-clockwise, the line enters on an edge from a corner on its left to one on its right. If the corner
         * found is on its left, this is where it leaves: it enters further down. */
        if (!is_right_of(corner[end], direction, offset_m)) {
            end--;
            while ((end > 0U) && is_right_of(corner[end - 1U], direction, offset_m)) {
                end--;
            }
        }
        const uint32_t start = ((end > 0U) ? end : config->vertex_count) - 1U;
        const gw_real_t start_side_m = side_of(corner[start], direction, offset_m);
        const gw_real_t end_side_m = side_of(corner[end], direction, offset_m);
        const gw_real_t fraction = gw_fraction_inline(-start_side_m, end_side_m - start_side_m);
        const gw_vector_t edge = from_to(corner[start], corner[end]);
        estimate->point_m.x = corner[start].x + (fraction * edge.x);
        estimate->point_m.y = corner[start].y + (fraction * edge.y);
    } else {
        estimate->point_m = corner[nearest];
    }
}

/* True if both deviations are finite and not negative. */
static bool sigma_is_valid(gw_wrench_sigma_t sigma)
{
    return gw_in_range(sigma.force_n, GW_ZERO, GW_WRENCH_MAX) && gw_in_range(sigma.torque_nm, GW_ZERO, GW_WRENCH_MAX);
}

/* Writes the contact of a valid wrench, if its force is strong enough to have one. */
static void locate(const gw_contact_config_t *config, gw_wrench_t wrench, gw_wrench_sigma_t sigma,
                   gw_contact_estimate_t *estimate)
{
    const gw_vector_t force = {wrench.force_x_n, wrench.force_y_n};
    const gw_real_t force_n = gw_length(force);
    if (force_n >= config->minimum_force_n) {
        const gw_real_t arm_m = gw_limited(wrench.torque_nm / force_n, LEVER_ARM_MAX);
        /* sigma_d^2 = (sigma_M^2 + d^2 sigma_F^2)/|F|^2 */
        const gw_vector_t spread = {gw_known_within(sigma.torque_nm, GW_WRENCH_MAX) / force_n,
                                    (arm_m * gw_known_within(sigma.force_n, GW_WRENCH_MAX)) / force_n};
        estimate->valid = true;
        estimate->force_n = force_n;
        estimate->lever_arm_m = arm_m;
        estimate->lever_arm_sigma_m = gw_length(spread);
        estimate->direction_rad = gw_atan2(force.y, force.x);
        cut_outline(config, gw_unit(force.x, force.y, force_n), arm_m, estimate);
    }
}

gw_status_t gw_contact_locate(const gw_contact_t *contact, gw_wrench_t wrench, gw_wrench_sigma_t sigma,
                              gw_contact_estimate_t *estimate)
{
    static const gw_contact_estimate_t no_contact = {0};
    gw_status_t status = GW_STATUS_OK;
    if (estimate == NULL) {
        status = GW_STATUS_NULL_POINTER;
    } else {
        *estimate = no_contact;
        if (contact == NULL) {
            status = GW_STATUS_NULL_POINTER;
        } else if (!contact->initialised) {
            status = GW_STATUS_NOT_INITIALISED;
        } else if (!(gw_wrench_is_valid(wrench) && sigma_is_valid(sigma))) {
            status = GW_STATUS_INPUT_INVALID;
        } else {
            locate(&contact->config, gw_wrench_known_valid(wrench), sigma, estimate);
        }
    }
    return status;
}
