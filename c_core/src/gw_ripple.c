#include "giveway/gw_ripple.h"

#include "giveway/gw_channels_config.h"
#include "giveway/gw_math.h"

#if (GW_WITH_CHANNELS == 1)

/* Square of the force over the sum of squares of the friction: from here on wheels are uneven. A wrong mass is felt
 * while the robot reacts, too. */
#define UNEVEN ((gw_real_t)0.025)
#define UNEVEN_REACTING ((gw_real_t)0.075)
#define PER_MOST ((gw_real_t)100.0) /* one over what is beyond it where the variance is the largest */
#define MOST ((gw_real_t)(25.0 / 9.0))
/* Of the guess's variance. With 4/9 68 hits of the tuning draw's 300 planar robots are missed, with this 63. */
#define REACTING ((gw_real_t)0.2)
/* A tenth more than from one of 18 rollers to the next. */
#define FADE_RAD ((gw_real_t)0.4)
#define FADE_S ((gw_real_t)0.5)
#define RISE_S ((gw_real_t)0.1)
#define INTERVAL_S ((gw_real_t)0.064)
/* Rollers that each have all of their friction have a mean of 0.43 to 0.58 of the largest in a second simulator's 43
 * drives, those of the crowd, which share it, at most 0.09. */
#define RECENT_S ((gw_real_t)20.0)
#define KNOWN_WEIGHT ((gw_real_t)0.1)
#define USUAL_FROM ((gw_real_t)0.3)
#define PER_USUAL ((gw_real_t)10.0) /* one over what is beyond it where it is the largest */
#define INTERVAL_MAX 1024U

void gw_ripple_init(gw_ripple_t *ripple, gw_real_t share, gw_real_t interval_s)
{
    const gw_real_t steps = gw_clamp(INTERVAL_S / interval_s, GW_ONE, (gw_real_t)INTERVAL_MAX);
    ripple->guess2 = share * share;
    ripple->most2 = MOST * ripple->guess2;
    ripple->seen2 = GW_ZERO;
    ripple->keep = GW_ONE - gw_share_of(interval_s, FADE_S);
    ripple->mean2 = GW_ZERO;
    ripple->weight = GW_ZERO;
    ripple->rise = gw_share_of(interval_s, RISE_S);
    ripple->recent = gw_share_of(interval_s, RECENT_S);
    ripple->interval = (uint32_t)steps;
    gw_ripple_leave_out(ripple);
}

bool gw_ripple_invariant_holds(const gw_ripple_t *ripple)
{
    bool holds = (ripple != NULL);
    if (holds) {
        holds = gw_in_range(ripple->guess2, GW_ZERO, GW_ONE) && gw_in_range(ripple->most2, GW_ZERO, MOST) &&
                gw_in_range(ripple->seen2, GW_ZERO, MOST) && gw_in_range(ripple->next2, GW_ZERO, MOST) &&
                gw_in_range(ripple->felt2, GW_ZERO, MOST) && gw_in_range(ripple->keep, GW_HALF, GW_ONE) &&
                gw_in_range(ripple->mean2, GW_ZERO, MOST) && gw_in_range(ripple->weight, GW_ZERO, GW_ONE) &&
                gw_in_range(ripple->rise, GW_ZERO, GW_HALF) && gw_in_range(ripple->recent, GW_ZERO, GW_HALF) &&
                (ripple->interval <= INTERVAL_MAX) && (ripple->steps < ripple->interval);
    }
    return holds;
}

void gw_ripple_follow(gw_ripple_t *ripple, gw_real_t turned_rad, gw_real_t force_n2, gw_real_t friction_n2,
                      bool reacting)
{
    const gw_real_t even = reacting ? UNEVEN_REACTING : UNEVEN;
    const gw_real_t uneven = gw_max(gw_planar_ratio(force_n2, friction_n2) - even, GW_ZERO);
    const gw_real_t towards2 = ripple->most2 * (PER_MOST * uneven);
    const gw_real_t share = (towards2 > ripple->felt2) ? ripple->rise : (GW_ONE - ripple->keep);
    ripple->guess2 = (GW_ONE - gw_min(turned_rad / FADE_RAD, GW_HALF)) * ripple->guess2;
    /* Never negative: at most half of it is taken off. */
    ripple->felt2 = gw_known_within(gw_min(ripple->felt2 + (share * (towards2 - ripple->felt2)), ripple->most2), MOST);
    if (!reacting) {
        ripple->mean2 = gw_approached(ripple->mean2, ripple->seen2, ripple->recent, MOST);
        ripple->weight = gw_approached(ripple->weight, GW_ONE, ripple->recent, GW_ONE);
    }
}

void gw_ripple_go_on(gw_ripple_t *ripple)
{
    ripple->steps++;
    if (ripple->steps >= ripple->interval) {
        ripple->steps = 0U;
        ripple->seen2 = ripple->next2;
        ripple->next2 = ripple->felt2;
    }
}

void gw_ripple_leave_out(gw_ripple_t *ripple)
{
    ripple->next2 = ripple->seen2;
    ripple->felt2 = ripple->seen2;
    ripple->steps = 0U;
}

gw_real_t gw_ripple_variance(const gw_ripple_t *ripple, bool reacting)
{
    const gw_real_t guess2 = reacting ? (REACTING * ripple->guess2) : ripple->guess2;
    return guess2 + gw_max(ripple->seen2, gw_ripple_usual(ripple, reacting));
}

gw_real_t gw_ripple_usual(const gw_ripple_t *ripple, bool reacting)
{
    gw_real_t usual2 = GW_ZERO;
    if ((!reacting) && (ripple->weight >= KNOWN_WEIGHT)) {
        const gw_real_t mean2 = ripple->mean2 / ripple->weight;
        usual2 = gw_clamp(PER_USUAL * (mean2 - (USUAL_FROM * ripple->most2)), GW_ZERO, ripple->most2);
    }
    return usual2;
}

gw_planar_covariance_t gw_ripple_added(gw_real_t variance, const gw_kinematics_t *kinematics,
                                       const gw_wheels_t *friction_n, gw_planar_covariance_t m)
{
    gw_planar_covariance_t sum = m;
    GW_UNROLLED
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        const gw_vector_t n = kinematics->radial[i];
        const gw_real_t n2 = variance * (friction_n->wheel[i] * friction_n->wheel[i]);
        sum.xx += n2 * (n.x * n.x);
        sum.xy += n2 * (n.x * n.y);
        sum.yy += n2 * (n.y * n.y);
    }
    return sum;
}

#endif
