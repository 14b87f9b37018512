#include "generator.h"
#include "giveway/gw_math.h"
#include "modules.h"

static void all_of_one(digest_t *digest, gw_real_t x)
{
    digest_bool(digest, gw_is_finite(x));
    digest_real(digest, gw_abs(x));
    digest_real(digest, gw_sqrt(x));
    digest_real(digest, gw_exp(x));
    digest_real(digest, gw_expm1(x));
    digest_real(digest, gw_tanh(x));
    digest_rotation(digest, gw_sincos(x));
    digest_real(digest, gw_wrap_angle(x));
}

static void all_of_two(digest_t *digest, gw_real_t x, gw_real_t y)
{
    digest_real(digest, gw_min(x, y));
    digest_real(digest, gw_max(x, y));
    digest_real(digest, gw_atan2(x, y));
    digest_bool(digest, gw_in_range(x, -gw_abs(y), gw_abs(y)));
}

digest_t drive_math(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(1U);
    for (uint32_t i = 0U; i < 1500U; i++) {
        /* one call of the generator per statement: C does not say in which order arguments are computed */
        const gw_real_t any = generator_any(&generator);
        const gw_real_t another = generator_any(&generator);
        const gw_vector_t vector = generator_vector(&generator, GW_ONE);
        const uint32_t later = generator_u32(&generator) >> 1U;
        const uint32_t earlier = generator_u32(&generator) >> 1U;
        all_of_one(&digest, any);
        all_of_one(&digest, generator_between(&generator, -GW_PI, GW_PI));
        all_of_one(&digest, generator_between(&generator, (gw_real_t)-100.0, (gw_real_t)100.0));
        all_of_one(&digest, generator_between(&generator, -GW_ANGLE_MAX, GW_ANGLE_MAX));
        all_of_two(&digest, any, another);
        all_of_two(&digest, vector.x, vector.y);
        digest_i32(&digest, gw_count_difference((int32_t)later, -(int32_t)earlier));
    }
    return digest;
}

digest_t drive_vectors(void)
{
    digest_t digest = digest_begin();
    generator_t generator = generator_begin(2U);
    for (uint32_t i = 0U; i < 1500U; i++) {
        const gw_rotation_t rotation = gw_sincos(generator_between(&generator, -GW_PI, GW_PI));
        const gw_vector_t vector = generator_vector(&generator, (gw_real_t)1000.0);
        digest_vector(&digest, gw_rotate(rotation, vector));
        digest_vector(&digest, gw_rotate_back(rotation, vector));
        digest_real(&digest, gw_length(vector));
        digest_vector(&digest, gw_limit_length(vector, generator_between(&generator, GW_ZERO, (gw_real_t)1000.0)));
        digest_real(&digest, gw_braking_speed(gw_abs(vector.x), (gw_real_t)0.001, vector.y));
        digest_real(&digest, gw_clamp(vector.x, (gw_real_t)-10.0, (gw_real_t)10.0));
    }
    return digest;
}
