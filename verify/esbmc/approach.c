/* Any value and target within a limit, any share up to 0.5: what gw_approached returns is within the limit, although
 * every operation rounds. The limits are those of gw_balance.h and
 * gw_fast_channel.h. */
#include "nondet.h"

int main(void)
{
    const gw_real_t limit = nondet_bool() ? 1.0e5F : 1.0e6F;
    const gw_real_t value = nondet_float();
    const gw_real_t target = nondet_float();
    const gw_real_t share = nondet_float();
    __ESBMC_assume(gw_within(value, limit) && gw_within(target, limit));
    __ESBMC_assume(gw_in_range(share, GW_ZERO, GW_HALF));
    __ESBMC_assert(gw_within(gw_approached(value, target, share, limit), limit), "the limit is kept");
    return 0;
}
