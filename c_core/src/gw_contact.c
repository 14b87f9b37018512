#include "giveway/gw_contact.h"

#include "giveway/gw_math.h"

/* A lever arm beyond this says only that there is no force to speak of. */
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

static gw_real_t along(gw_vector_t a, gw_vector_t direction)
{
    return (a.x * direction.x) + (a.y * direction.y);
}

static gw_vector_t from_to(gw_vector_t a, gw_vector_t b)
{
    const gw_vector_t difference = {b.x - a.x, b.y - a.y};
    return difference;
}

void gw_contact_config_check(const gw_contact_config_t *config, gw_config_error_t *error)
{
    const uint32_t count = config->vertex_count;
    gw_config_check_real(error, GW_FIELD_CONTACT_MINIMUM_FORCE, config->minimum_force_n);
    gw_config_check_count(error, GW_FIELD_OUTLINE_COUNT, count);
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
            /* Member by member: see gw_estimator.c. */
            contact->config.vertex_count = config->vertex_count;
            contact->config.minimum_force_n = config->minimum_force_n;
            for (uint32_t i = 0U; i < GW_OUTLINE_VERTEX_MAX; i++) {
                contact->config.vertex_m[i].x = config->vertex_m[i].x;
                contact->config.vertex_m[i].y = config->vertex_m[i].y;
            }
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

/* The point where the line p x u = offset enters the outline in direction u, or the vertex nearest to the line. */
static void cut_outline(const gw_contact_config_t *config, gw_vector_t direction, gw_real_t offset_m,
                        gw_contact_estimate_t *estimate)
{
    const gw_vector_t *const first = &config->vertex_m[0];
    const gw_vector_t *const last = &config->vertex_m[config->vertex_count - 1U];
    /* From the last vertex down. As long as all lie on its side: which is nearest? Distances count from that side. */
    const bool last_is_right = is_right_of(*last, direction, offset_m);
    const gw_vector_t reversed = {-direction.x, -direction.y};
    const gw_vector_t line = last_is_right ? direction : reversed;
    const gw_real_t line_m = last_is_right ? offset_m : -offset_m;
    const gw_vector_t *vertex = last;
    const gw_vector_t *nearest = last;
    gw_real_t nearest_m = side_of(*last, line, line_m);
    bool crossed = false;
    do {
        vertex--;
        const gw_real_t distance_m = side_of(*vertex, line, line_m);
        if (distance_m <= nearest_m) {
            if (distance_m < nearest_m) {
                nearest_m = distance_m;
                nearest = vertex;
                /* What lies on the line lies on its left. */
                crossed = (distance_m < GW_ZERO) || ((distance_m <= GW_ZERO) && last_is_right);
            } else if (along(*vertex, direction) <= along(*nearest, direction)) {
                nearest = vertex; /* an edge parallel to the line: the end that the force meets first */
            } else {
                /* the other end */
            }
        }
    } while ((vertex != first) && (!crossed));
    estimate->on_outline = crossed;
    if (crossed) {
        /* Going counter-clockwise, the side grows exactly on the edges that the direction enters: of these the last. */
        const gw_vector_t *end = vertex;
        if (last_is_right) {
            end++;
        } else {
            while ((end != first) && is_right_of(end[-1], direction, offset_m)) {
                end--;
            }
        }
        const gw_vector_t *const start = (end == first) ? last : &end[-1];
        const gw_real_t start_side_m = side_of(*start, direction, offset_m);
        const gw_real_t end_side_m = side_of(*end, direction, offset_m);
        const gw_real_t fraction = gw_fraction_inline(-start_side_m, end_side_m - start_side_m);
        const gw_vector_t edge = from_to(*start, *end);
        estimate->point_m.x = start->x + (fraction * edge.x);
        estimate->point_m.y = start->y + (fraction * edge.y);
    } else {
        estimate->point_m = *nearest;
    }
}

static void no_contact(gw_contact_estimate_t *estimate)
{
    estimate->valid = false;
    estimate->on_outline = false;
    estimate->point_m.x = GW_ZERO;
    estimate->point_m.y = GW_ZERO;
    estimate->force_n = GW_ZERO;
    estimate->direction_rad = GW_ZERO;
    estimate->lever_arm_m = GW_ZERO;
    estimate->lever_arm_sigma_m = GW_ZERO;
}

gw_status_t gw_contact_locate(const gw_contact_t *contact, gw_wrench_t wrench, gw_wrench_sigma_t sigma,
                              gw_contact_estimate_t *estimate)
{
    gw_status_t status = GW_STATUS_OK;
    if (estimate == NULL) {
        status = GW_STATUS_NULL_POINTER;
    } else {
        bool located = false;
        if (contact == NULL) {
            status = GW_STATUS_NULL_POINTER;
        } else if (!contact->initialised) {
            status = GW_STATUS_NOT_INITIALISED;
        } else if (!(gw_wrench_is_valid(wrench) && gw_within(sigma.force_n, GW_WRENCH_MAX) && (sigma.force_n >= GW_ZERO) &&
                     gw_within(sigma.torque_nm, GW_WRENCH_MAX) && (sigma.torque_nm >= GW_ZERO))) {
            status = GW_STATUS_INPUT_INVALID;
        } else {
            const gw_wrench_t valid = gw_wrench_limited(wrench);
            const gw_vector_t force = {valid.force_x_n, valid.force_y_n};
            const gw_real_t force_n = gw_length(force);
            located = (force_n >= contact->config.minimum_force_n);
            if (located) {
                const gw_real_t arm_m = gw_limited(valid.torque_nm / force_n, LEVER_ARM_MAX);
                /* sigma_d^2 = (sigma_M^2 + d^2 sigma_F^2)/|F|^2 */
                const gw_vector_t spread = {gw_limited(sigma.torque_nm, GW_WRENCH_MAX) / force_n,
                                            (arm_m * gw_limited(sigma.force_n, GW_WRENCH_MAX)) / force_n};
                estimate->valid = true;
                estimate->force_n = force_n;
                estimate->lever_arm_m = arm_m;
                estimate->lever_arm_sigma_m = gw_length(spread);
                estimate->direction_rad = gw_atan2(force.y, force.x);
                cut_outline(&contact->config, gw_unit(force.x, force.y, force_n), arm_m, estimate);
            }
        }
        if (!located) {
            no_contact(estimate);
        }
    }
    return status;
}
