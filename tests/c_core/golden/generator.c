#include "generator.h"

#include <string.h>

#include "giveway/gw_math.h"

generator_t generator_begin(uint32_t seed)
{
    const generator_t generator = {seed};
    return generator;
}

uint32_t generator_u32(generator_t *generator)
{
    generator->state += 0x9E3779B97F4A7C15U;
    uint64_t mixed = generator->state;
    mixed = (mixed ^ (mixed >> 30U)) * 0xBF58476D1CE4E5B9U;
    mixed = (mixed ^ (mixed >> 27U)) * 0x94D049BB133111EBU;
    return (uint32_t)((mixed ^ (mixed >> 31U)) >> 32U);
}

uint32_t generator_below(generator_t *generator, uint32_t count)
{
    return generator_u32(generator) % count;
}

bool generator_one_in(generator_t *generator, uint32_t calls)
{
    return generator_below(generator, calls) == 0U;
}

gw_real_t generator_between(generator_t *generator, gw_real_t low, gw_real_t high)
{
    const gw_real_t fraction =
        (gw_real_t)(generator_u32(generator) >> 8U) * (gw_real_t)5.9604644775390625e-08; /* 2^-24 */
    return low + ((high - low) * fraction);
}

gw_real_t generator_wild(generator_t *generator, gw_real_t size)
{
    gw_real_t x = generator_between(generator, -size, size);
    if (generator_one_in(generator, 64U)) {
        const gw_real_t infinite = GW_REAL_MAX * GW_TWO;
        const gw_real_t odd[6] = {infinite - infinite, infinite, -infinite, GW_REAL_MAX, -GW_REAL_MAX, -GW_ZERO};
        x = odd[generator_below(generator, 6U)];
    }
    return x;
}

gw_real_t generator_any(generator_t *generator)
{
    gw_real_t x;
#if (GW_REAL_DOUBLE == 1)
    const uint64_t high = generator_u32(generator);
    const uint64_t bits = (high << 32U) | generator_u32(generator);
#else
    const uint32_t bits = generator_u32(generator);
#endif
    memcpy(&x, &bits, sizeof x);
    return x;
}

gw_vector_t generator_vector(generator_t *generator, gw_real_t size)
{
    gw_vector_t vector;
    vector.x = generator_between(generator, -size, size);
    vector.y = generator_between(generator, -size, size);
    return vector;
}

gw_wheels_t generator_wheels(generator_t *generator, gw_real_t size)
{
    gw_wheels_t wheels;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        wheels.wheel[i] = generator_between(generator, -size, size);
    }
    return wheels;
}

gw_twist_t generator_twist(generator_t *generator, gw_real_t speed_mps, gw_real_t rate_radps)
{
    gw_twist_t twist;
    twist.vx_mps = generator_between(generator, -speed_mps, speed_mps);
    twist.vy_mps = generator_between(generator, -speed_mps, speed_mps);
    twist.omega_radps = generator_between(generator, -rate_radps, rate_radps);
    return twist;
}

gw_wrench_t generator_wrench(generator_t *generator, gw_real_t force_n, gw_real_t torque_nm)
{
    gw_wrench_t wrench;
    wrench.force_x_n = generator_wild(generator, force_n);
    wrench.force_y_n = generator_wild(generator, force_n);
    wrench.torque_nm = generator_wild(generator, torque_nm);
    return wrench;
}
