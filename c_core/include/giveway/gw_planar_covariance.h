/* Covariance of a planar force, and how far a force lies outside of it. */
#ifndef GW_PLANAR_COVARIANCE_H
#define GW_PLANAR_COVARIANCE_H

#include "giveway/gw_math.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A distance beyond this is as good as any; it keeps sums finite. */
#define GW_DISTANCE_MAX ((gw_real_t)1.0e6)

/* N^2 */
typedef struct {
    gw_real_t xx;
    gw_real_t xy;
    gw_real_t yy;
} gw_planar_covariance_t;

/* A covariance M, and what x^T (M + n I)^-1 x needs of it for any n. */
typedef struct {
    gw_planar_covariance_t m;
    gw_real_t trace;
    gw_real_t determinant;
} gw_planar_spread_t;

static inline gw_planar_covariance_t gw_planar_scaled(gw_planar_covariance_t m, gw_real_t factor)
{
    const gw_planar_covariance_t scaled = {factor * m.xx, factor * m.xy, factor * m.yy};
    return scaled;
}

static inline bool gw_planar_is_within(gw_planar_covariance_t m, gw_real_t limit)
{
    return gw_within(m.xx, limit) && gw_within(m.xy, limit) && gw_within(m.yy, limit);
}

/* M + v v^T */
static inline gw_planar_covariance_t gw_planar_widened(gw_planar_covariance_t m, gw_vector_t v)
{
    const gw_planar_covariance_t sum = {m.xx + (v.x * v.x), m.xy + (v.x * v.y), m.yy + (v.y * v.y)};
    return sum;
}

/* M + n I */
static inline gw_planar_covariance_t gw_planar_raised(gw_planar_covariance_t m, gw_real_t n)
{
    const gw_planar_covariance_t sum = {m.xx + n, m.xy, m.yy + n};
    return sum;
}

/* Rounding may leave a singular covariance a determinant below zero. */
static inline gw_planar_spread_t gw_planar_spread(gw_planar_covariance_t m)
{
    gw_planar_spread_t spread;
    spread.m = m;
    spread.trace = m.xx + m.yy;
    spread.determinant = gw_max((m.xx * m.yy) - (m.xy * m.xy), GW_ZERO);
    return spread;
}

/* part/whole, at most GW_DISTANCE_MAX; part >= 0. */
static inline gw_real_t gw_planar_ratio(gw_real_t part, gw_real_t whole)
{
    return gw_min(part / gw_max(whole, (gw_real_t)1.0e-8), GW_DISTANCE_MAX);
}

/* x^T (M + n I)^-1 x, n > 0. Pointer not NULL. */
static inline gw_real_t gw_planar_distance(const gw_planar_spread_t *spread, gw_real_t n, gw_vector_t x)
{
    const gw_real_t weighted = ((((spread->m.yy + n) * x.x) * x.x) + (((spread->m.xx + n) * x.y) * x.y)) -
                               ((GW_TWO * spread->m.xy) * (x.x * x.y));
    return gw_planar_ratio(gw_max(weighted, GW_ZERO), ((n + spread->trace) * n) + spread->determinant);
}

#ifdef __cplusplus
}
#endif

#endif
