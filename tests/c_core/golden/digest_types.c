#include "digest_types.h"

void digest_text(digest_t *digest, const char *text)
{
    for (const char *letter = text; *letter != '\0'; letter++) {
        digest_u32(digest, (uint32_t)(unsigned char)*letter);
    }
}

void digest_wheels(digest_t *digest, const gw_wheels_t *wheels)
{
    digest_reals(digest, wheels->wheel, GW_WHEEL_COUNT);
}

void digest_acceleration(digest_t *digest, gw_acceleration_t acceleration)
{
    digest_real(digest, acceleration.ax_mps2);
    digest_real(digest, acceleration.ay_mps2);
    digest_real(digest, acceleration.alpha_radps2);
}

void digest_rotation(digest_t *digest, gw_rotation_t rotation)
{
    digest_real(digest, rotation.sine);
    digest_real(digest, rotation.cosine);
}

void digest_sum(digest_t *digest, gw_sum_t sum)
{
    digest_real(digest, sum.value);
    digest_real(digest, sum.excess);
}

void digest_config_error(digest_t *digest, const gw_config_error_t *error)
{
    digest_u32(digest, (uint32_t)error->field);
    if (error->field != GW_FIELD_NONE) {
        digest_u32(digest, error->index);
        digest_real(digest, error->value);
    }
}
