/* The parts of a driver: independent of each other, in any order. */
#ifndef EVA_PARTS_H
#define EVA_PARTS_H

#include "math_contracts.h"
#include "states.h"

/* Init of any valid configuration establishes the invariant. */
static void part_init(void);
/* A step from any state within the invariant, with any input, keeps it and bounds the outputs. */
static void part_step(void);
/* What init and step refuse: no pointers, no valid configuration, no initialised state. */
static void part_refusals(void);

int main(void)
{
    const uint32_t part = draw_count(0U, 2U);
    if (part == 0U) {
        part_init();
    } else if (part == 1U) {
        part_step();
    } else {
        part_refusals();
    }
    return 0;
}

#endif
