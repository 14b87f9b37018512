/* Numbers that are the same on every machine: integers by splitmix64, reals made from them by exact steps. */
#ifndef GENERATOR_H
#define GENERATOR_H

#include "giveway/gw_types.h"

typedef struct {
    uint64_t state;
} generator_t;

generator_t generator_begin(uint32_t seed);
uint32_t generator_u32(generator_t *generator);
/* 0 to count - 1. */
uint32_t generator_below(generator_t *generator, uint32_t count);
/* True once in this number of calls. */
bool generator_one_in(generator_t *generator, uint32_t calls);
/* [low, high), 24 bits. */
gw_real_t generator_between(generator_t *generator, gw_real_t low, gw_real_t high);
/* [-size, size), and now and then values that no sensor should ever send: NaN, infinities, the largest number. */
gw_real_t generator_wild(generator_t *generator, gw_real_t size);
/* Any bit pattern: subnormal numbers, infinities and NaN too. */
gw_real_t generator_any(generator_t *generator);
gw_vector_t generator_vector(generator_t *generator, gw_real_t size);
gw_wheels_t generator_wheels(generator_t *generator, gw_real_t size);
gw_twist_t generator_twist(generator_t *generator, gw_real_t speed_mps, gw_real_t rate_radps);
gw_wrench_t generator_wrench(generator_t *generator, gw_real_t force_n, gw_real_t torque_nm);

#endif
