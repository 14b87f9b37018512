/* Digests of the types that only the tests of single modules put out. */
#ifndef DIGEST_TYPES_H
#define DIGEST_TYPES_H

#include "digest.h"

void digest_text(digest_t *digest, const char *text);
void digest_wheels(digest_t *digest, const gw_wheels_t *wheels);
void digest_acceleration(digest_t *digest, gw_acceleration_t acceleration);
void digest_rotation(digest_t *digest, gw_rotation_t rotation);
void digest_sum(digest_t *digest, gw_sum_t sum);
void digest_config_error(digest_t *digest, const gw_config_error_t *error);

#endif
