#include "generator.h"
#include "giveway/gw_math.h"
#include "giveway/gw_moving_average.h"
#include "giveway/gw_rate_filter.h"
#include "giveway/gw_tare.h"
#include "modules.h"

digest_t drive_sum(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(7U);
    gw_sum_t sum = gw_sum_of(GW_ZERO);
    gw_sum_t angle = gw_sum_of(GW_ONE);
    for (uint32_t i = 0U; i < 3000U; i++) {
        sum = gw_sum_add(sum, generator_between(&generator, (gw_real_t)-0.001, (gw_real_t)1.0));
        angle = gw_sum_add_angle(angle, generator_between(&generator, (gw_real_t)-0.1, (gw_real_t)7.0));
        digest_sum(&digest, sum);
        digest_sum(&digest, angle);
        digest_real(&digest, gw_sum_subtract_from(sum.value, sum));
    }
    return digest;
}

digest_t drive_tare(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(8U);
    gw_tare_t tare;
    gw_wheels_t mean_nm = {{GW_ZERO, GW_ZERO, GW_ZERO}};
    gw_tare_start(&tare);
    for (uint32_t i = 0U; i < 3000U; i++) {
        /* now and then a disturbance, for which it is refused */
        const gw_real_t size = generator_one_in(&generator, 40U) ? GW_TWO : (gw_real_t)0.2;
        const gw_wheels_t torque_nm = generator_wheels(&generator, size);
        digest_u32(&digest, (uint32_t)gw_tare_add(&tare, &torque_nm, 16U, GW_ONE, &mean_nm));
        digest_wheels(&digest, &mean_nm);
    }
    return digest;
}

digest_t drive_moving_average(void)
{
    static gw_moving_average_t average;
    static const uint32_t windows[4] = {1U, 7U, 20U, GW_MOVING_AVERAGE_CAPACITY};
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(9U);
    for (uint32_t k = 0U; k < 4U; k++) {
        digest_u32(&digest, (uint32_t)gw_moving_average_init(&average, windows[k]));
        for (uint32_t i = 0U; i < 2200U; i++) {
            const gw_wrench_t sample = generator_wrench(&generator, (gw_real_t)100.0, (gw_real_t)10.0);
            digest_u32(&digest, (uint32_t)gw_moving_average_add(&average, sample));
            digest_wrench(&digest, gw_moving_average_mean(&average));
            digest_wrench(&digest, gw_moving_average_window_mean(&average));
            digest_u32(&digest, gw_moving_average_count(&average));
            if (generator_one_in(&generator, 1500U)) {
                gw_moving_average_reset(&average);
            }
        }
    }
    return digest;
}

digest_t drive_rate_filter(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(10U);
    for (uint32_t k = 0U; k < 8U; k++) {
        gw_rate_filter_constants_t constants;
        gw_rate_filter_t filter;
        uint32_t count = generator_u32(&generator); /* wraps */
        const gw_real_t cutoff_radps = generator_between(&generator, (gw_real_t)10.0, (gw_real_t)1000.0);
        const gw_real_t stiffness_nm_per_rad =
            generator_one_in(&generator, 2U) ? GW_ZERO : generator_between(&generator, GW_ONE, (gw_real_t)1000.0);
        digest_u32(&digest, (uint32_t)gw_rate_filter_constants(&constants, (gw_real_t)0.001, cutoff_radps, 8500U,
                                                               stiffness_nm_per_rad));
        gw_rate_filter_restart(&filter);
        for (uint32_t i = 0U; i < 500U; i++) {
            count += generator_below(&generator, 20U);
            gw_rate_filter_step(&filter, &constants, gw_count_difference((int32_t)(count & GW_TICK_MASK), 0),
                                generator_between(&generator, (gw_real_t)-5.0, (gw_real_t)5.0));
            digest_real(&digest, filter.rate_radps);
            digest_real(&digest, filter.derivative_radps2);
        }
    }
    return digest;
}
