/* Bounds of gw_math's results that the proofs use. Each bound is checked separately: by contracts.c on every float, by
 * math.c against the code. */
#ifndef EVA_MATH_CONTRACTS_H
#define EVA_MATH_CONTRACTS_H

#include "giveway/gw_math.h"

/*@ assigns \result \from x;
  @ ensures \is_finite(\result) && 0 <= \result <= 1.8447e19;
  @ ensures x >= 1 ==> \result >= 1;
  @ ensures x <= 1e8 ==> \result <= 1e4;
  @ ensures x <= 1e12 ==> \result <= 1e6;
  @ ensures x <= 1e20 ==> \result <= 1e10; */
gw_real_t gw_sqrt(gw_real_t x);
/*@ assigns \result \from x;
  @ ensures \is_finite(\result) && 0 <= \result;
  @ ensures x <= 0 ==> \result <= 1; */
gw_real_t gw_exp(gw_real_t x);
/*@ assigns \result \from x;
  @ ensures \is_finite(\result) && -1 <= \result;
  @ ensures x <= 0 ==> \result <= 0; */
gw_real_t gw_expm1(gw_real_t x);
/*@ assigns \result \from x;
  @ ensures \is_finite(\result) && -1 <= \result <= 1; */
gw_real_t gw_tanh(gw_real_t x);
/*@ assigns \result \from angle_rad;
  @ ensures \is_finite(\result.sine) && -1 <= \result.sine <= 1;
  @ ensures \is_finite(\result.cosine) && -1 <= \result.cosine <= 1; */
gw_rotation_t gw_sincos(gw_real_t angle_rad);
/*@ assigns \result \from y, x;
  @ ensures \is_finite(\result) && -3.1415928 <= \result <= 3.1415928; */
gw_real_t gw_atan2(gw_real_t y, gw_real_t x);
/*@ assigns \result \from angle_rad;
  @ ensures \is_finite(\result) && -3.1415928 <= \result <= 3.1415928; */
gw_real_t gw_wrap_angle(gw_real_t angle_rad);
/*@ assigns \result \from part, whole;
  @ ensures \is_finite(\result) && -1 <= \result <= 1;
  @ ensures part >= 0 ==> \result >= 0; */
gw_real_t gw_fraction(gw_real_t part, gw_real_t whole);

#endif
