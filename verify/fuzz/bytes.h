/* Values from a fuzzer's bytes; zeros when the bytes are used up. */
#ifndef FUZZ_BYTES_H
#define FUZZ_BYTES_H

#include "giveway/giveway.h"
#include "giveway/gw_math.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DEMAND(condition) \
    do { \
        if (!(condition)) { \
            (void)fprintf(stderr, "broken: %s (%s:%d)\n", #condition, __FILE__, __LINE__); \
            abort(); \
        } \
    } while (0)

typedef struct {
    const uint8_t *data;
    size_t left;
} bytes_t;

static inline void take_bytes(bytes_t *bytes, void *place, size_t wanted)
{
    const size_t size = (bytes->left < wanted) ? bytes->left : wanted;
    (void)memset(place, 0, wanted);
    if (size > 0U) {
        (void)memcpy(place, bytes->data, size);
        bytes->data += size;
        bytes->left -= size;
    }
}

static inline uint32_t take_count(bytes_t *bytes)
{
    uint32_t value;
    take_bytes(bytes, &value, sizeof(value));
    return value;
}

static inline int32_t take_integer(bytes_t *bytes)
{
    const uint32_t bits = take_count(bytes);
    int32_t value;
    (void)memcpy(&value, &bits, sizeof(value));
    return value;
}

static inline bool take_flag(bytes_t *bytes)
{
    return (take_count(bytes) & 1U) != 0U;
}

/* Any bits: NaN, infinities, subnormals. */
static inline gw_real_t take_real(bytes_t *bytes)
{
    gw_real_t value;
    take_bytes(bytes, &value, sizeof(value));
    return value;
}

/* A setting: mostly within its range, including both ends, now and then arbitrary bits. */
static inline gw_real_t take_setting(bytes_t *bytes, gw_config_field_t field)
{
    const gw_config_limit_t limit = gw_config_limit(field);
    const uint32_t bits = take_count(bytes);
    gw_real_t value =
        limit.minimum + ((limit.maximum - limit.minimum) * ((gw_real_t)(bits >> 8U) / (gw_real_t)0xFFFFFF));
    if ((bits & 0xFFU) == 0xFFU) {
        value = take_real(bytes);
    }
    return value;
}

static inline uint32_t take_count_setting(bytes_t *bytes, gw_config_field_t field)
{
    const gw_config_limit_t limit = gw_config_limit(field);
    const uint32_t bits = take_count(bytes);
    const uint32_t span = ((uint32_t)limit.maximum - (uint32_t)limit.minimum) + 1U;
    return ((bits & 0xFFU) == 0xFFU) ? bits : ((uint32_t)limit.minimum + ((bits >> 8U) % span));
}

/* The settings of one table of gw_config.h; the slots of the wheels stay, or few configurations would be accepted. A
 * variable `bytes` is in scope. */
#define TAKE(kind, field, name, member, minimum, maximum) TAKE_##kind(member, field)
#define TAKE_REAL(member, field) (member) = take_setting(&bytes, (field));
#define TAKE_COUNT(member, field) (member) = take_count_setting(&bytes, (field));
#define TAKE_WHEEL_REAL(member, field) \
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) { \
        (member) = take_setting(&bytes, (field)); \
    }
#define TAKE_WHEEL_COUNT(member, field)
#define TAKE_VERTEX_REAL(member, field) \
    for (uint32_t i = 0U; i < GW_OUTLINE_VERTEX_MAX; i++) { \
        (member) = take_setting(&bytes, (field)); \
    }
#define TAKE_RULE(member, field)

/* Mostly of the usual size, so that the sensors are good for a while; now and then arbitrary bits. */
static inline gw_real_t take_value(bytes_t *bytes, gw_real_t scale)
{
    const uint32_t bits = take_count(bytes);
    gw_real_t value = scale * ((gw_real_t)(bits >> 8U) / (gw_real_t)0xFFFFFF);
    if ((bits & 0x7FU) == 0x7FU) {
        value = take_real(bytes);
    }
    return ((bits & 0x80U) != 0U) ? -value : value;
}

#endif
