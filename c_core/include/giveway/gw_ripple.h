/* The friction of a wheel from roller to roller. Where one roller hands over to the next, both bear: together they may
 * have the friction of one, or each its own, and then it doubles for as long. Nobody knows before it has been seen. Its
 * force is along the wheel's axle, and has no moment about the centre: only a push there looks like it.
 *
 * The share by which the friction may vary has the variance g^2 + s^2. The guess g is the configuration's, 0.45 of it
 * in a reaction, where no push should be missed, and fades as wheels turn: each 0.4 rad leaves 1/e of its square. What
 * has been seen, s, grows where a force comes and goes: where its square, of what takes some 20 to 50 ms, is more than
 * 0.025 of the sum of squares of the wheels' friction, 0.075 in a reaction. It is 5/3 of the configuration's at most,
 * 0.01 beyond that, and fades within half a second. It counts after 64 ms at least, and what was felt since is left out
 * if it was a contact that began.
 *
 * Where rollers each have all of their friction, that comes and goes all the time: the mean of s^2 over 20 s of motion
 * is about half of the largest s^2 then, and below 0.1 of it where rollers share their friction. So after 2 s of motion
 * s^2 has a least value, the usual one: none where that mean is below 0.3 of the largest, the largest from 0.4 on. It
 * holds in quiet moments, too, but not in a reaction, where no push should be missed.
 *
 * Life cycle: gw_ripple_init, then every so often gw_ripple_follow, if there is something to be seen, and
 * gw_ripple_go_on, or gw_ripple_leave_out. All members are private.
 */
#ifndef GW_RIPPLE_H
#define GW_RIPPLE_H

#include "giveway/gw_kinematics.h"
#include "giveway/gw_planar_covariance.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    gw_real_t guess2;  /* variance of the share while nothing has been seen */
    gw_real_t most2;   /* of an uneven wheel */
    gw_real_t seen2;   /* what has been seen */
    gw_real_t next2;   /* instead of it from the next interval on */
    gw_real_t felt2;   /* and from the one after that */
    gw_real_t mean2;   /* of what has been seen in motion, times its weight */
    gw_real_t weight;  /* of that mean: 1 once it has been seen for long */
    gw_real_t keep;    /* of felt2, from one step to the next */
    gw_real_t rise;    /* what felt2 takes over of a larger one */
    gw_real_t recent;  /* what mean2 takes over */
    uint32_t interval; /* steps of an interval, at least 1 */
    uint32_t steps;    /* of this one */
} gw_ripple_t;

/* share: by which friction may vary, in [0, 1]; interval_s: from one step to the next, s, above 0. Pointers not NULL
 * here and below. */
GW_SMALL void gw_ripple_init(gw_ripple_t *ripple, gw_real_t share, gw_real_t interval_s);
bool gw_ripple_invariant_holds(const gw_ripple_t *ripple);
/* Rollers slide and nothing touches: how far a wheel has turned since the last time, rad, mean of all, at least 0;
 * square of the force that comes and goes and is not explained, N^2, at least 0; the sum over the wheels of the squares
 * of their friction, N^2. */
void gw_ripple_follow(gw_ripple_t *ripple, gw_real_t turned_rad, gw_real_t force_n2, gw_real_t friction_n2,
                      bool reacting);
/* A step without contact. */
void gw_ripple_go_on(gw_ripple_t *ripple);
/* A step with one: what was felt last may have been that. */
void gw_ripple_leave_out(gw_ripple_t *ripple);
/* Variance of the share, [0, 4]. */
gw_real_t gw_ripple_variance(const gw_ripple_t *ripple, bool reacting);
/* The least value of s^2, [0, 3]. */
gw_real_t gw_ripple_usual(const gw_ripple_t *ripple, bool reacting);
/* M + what such a variance of each wheel's friction adds to it, in base axes. */
gw_planar_covariance_t gw_ripple_added(gw_real_t variance, const gw_kinematics_t *kinematics,
                                       const gw_wheels_t *friction_n, gw_planar_covariance_t m);

#ifdef __cplusplus
}
#endif

#endif
