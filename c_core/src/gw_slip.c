#include "giveway/gw_slip.h"

#include "giveway/gw_math.h"

#if (GW_WITH_CHANNELS == 1)

#define GRAVITY_MPS2 ((gw_real_t)9.80665)
/* In 4 h of the tuning draw's robots that tip there were 49 false alarms, with this 4. Over 0.7 of the grip there are
 * 15; the same variance in all directions leaves 2, but more hits are missed while a robot starts: 20 of 208, with this
 * 13, without any of it 11. */
#define NEAR ((gw_real_t)0.6)
#define DOUBT ((gw_real_t)0.3)
#define GRIP_MAX_N ((gw_real_t)1.0e5) /* beyond any robot's: bounds what follows */
#define DOUBT_MAX_N2 ((gw_real_t)1.0e12)

void gw_slip_init(gw_slip_t *slip, gw_real_t grip, gw_real_t mass_kg, gw_real_t multiple, gw_real_t keep)
{
    const gw_real_t grip_n = gw_min(((grip * mass_kg) * GRAVITY_MPS2) / (gw_real_t)GW_WHEEL_COUNT, GRIP_MAX_N);
    const gw_real_t doubt_n = multiple * (DOUBT * grip_n);
    slip->near_n = NEAR * grip_n;
    slip->doubt_n2 = gw_min(doubt_n * doubt_n, DOUBT_MAX_N2);
    slip->keep = keep;
    gw_slip_restart(slip);
}

void gw_slip_restart(gw_slip_t *slip)
{
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        slip->wheel_n2.wheel[i] = GW_ZERO;
    }
}

bool gw_slip_invariant_holds(const gw_slip_t *slip)
{
    bool holds = (slip != NULL);
    if (holds) {
        holds = gw_in_range(slip->near_n, GW_ZERO, GRIP_MAX_N) && gw_in_range(slip->doubt_n2, GW_ZERO, DOUBT_MAX_N2) &&
                gw_in_range(slip->keep, GW_HALF, GW_ONE);
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            holds = holds && gw_in_range(slip->wheel_n2.wheel[i], GW_ZERO, DOUBT_MAX_N2);
        }
    }
    return holds;
}

void gw_slip_step(gw_slip_t *slip, const gw_kinematics_t *kinematics, const gw_wheels_t *torque_nm, bool interesting)
{
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        const gw_real_t transmitted_n = gw_magnitude(torque_nm->wheel[i]) * kinematics->per_wheel_radius;
        const bool may_slip = interesting && (transmitted_n > slip->near_n);
        slip->wheel_n2.wheel[i] = may_slip ? slip->doubt_n2 : (slip->keep * slip->wheel_n2.wheel[i]);
    }
}

gw_planar_covariance_t gw_slip_added(const gw_slip_t *slip, const gw_kinematics_t *kinematics, gw_planar_covariance_t m)
{
    gw_planar_covariance_t sum = m;
    GW_UNROLLED
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        const gw_vector_t across = kinematics->radial[i];
        const gw_real_t n2 = slip->wheel_n2.wheel[i];
        sum.xx += n2 * (across.y * across.y);
        sum.xy -= n2 * (across.x * across.y);
        sum.yy += n2 * (across.x * across.x);
    }
    return sum;
}

gw_real_t gw_slip_sum(const gw_slip_t *slip)
{
    gw_real_t sum_n2 = GW_ZERO;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        sum_n2 += slip->wheel_n2.wheel[i];
    }
    return sum_n2;
}

#endif
