/* Arbitrary bits, including NaN and infinities. */
#ifndef ESBMC_NONDET_H
#define ESBMC_NONDET_H

#include "giveway/giveway.h"
#include "giveway/gw_math.h"

float nondet_float(void);
int nondet_int(void);
unsigned int nondet_uint(void);
_Bool nondet_bool(void);
void __ESBMC_assume(_Bool condition);
void __ESBMC_assert(_Bool condition, const char *message);

#endif
