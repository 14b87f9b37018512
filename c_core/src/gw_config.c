#include "giveway/gw_config.h"

#include "giveway/gw_math.h"

/* Two arrays from one table: a linker drops the names from programs that do not print them. */
#define LIMIT_OF_ROW(kind, field, name, member, minimum, maximum) {(gw_real_t)(minimum), (gw_real_t)(maximum)},
#define NAME_OF_ROW(kind, field, name, member, minimum, maximum) (name),

/* Anything that is no field stands for GW_FIELD_NONE. */
static uint32_t row_of(gw_config_field_t field)
{
    const uint32_t row = (uint32_t)field;
    return (row < (uint32_t)GW_FIELD_COUNT) ? row : (uint32_t)GW_FIELD_NONE;
}

gw_config_limit_t gw_config_limit(gw_config_field_t field)
{
    static const gw_config_limit_t limits[GW_FIELD_COUNT] = {GW_CONFIG_FIELDS(LIMIT_OF_ROW)};
    return limits[row_of(field)];
}

const char *gw_config_name(gw_config_field_t field)
{
    static const char *const names[GW_FIELD_COUNT] = {GW_CONFIG_FIELDS(NAME_OF_ROW)};
    return names[row_of(field)];
}

void gw_config_check_begin(gw_config_error_t *error)
{
    error->field = GW_FIELD_NONE;
    error->index = 0U;
    error->value = GW_ZERO;
    error->minimum = GW_ZERO;
    error->maximum = GW_ZERO;
}

void gw_config_check_relation(gw_config_error_t *error, gw_config_field_t field, uint32_t index, gw_real_t value,
                              gw_real_t minimum, gw_real_t maximum)
{
    if ((error->field == GW_FIELD_NONE) && (!gw_in_range(value, minimum, maximum))) {
        error->field = field;
        error->index = index;
        error->value = value;
        error->minimum = minimum;
        error->maximum = maximum;
    }
}

void gw_config_check_element(gw_config_error_t *error, gw_config_field_t field, uint32_t index, gw_real_t value)
{
    const gw_config_limit_t limit = gw_config_limit(field);
    gw_config_check_relation(error, field, index, value, limit.minimum, limit.maximum);
}

void gw_config_check_real(gw_config_error_t *error, gw_config_field_t field, gw_real_t value)
{
    gw_config_check_element(error, field, 0U, value);
}

void gw_config_check_count(gw_config_error_t *error, gw_config_field_t field, uint32_t value)
{
    /* No bound of a count exceeds 2^24, so rounding to the real type cannot bring one back into range. */
    gw_config_check_element(error, field, 0U, (gw_real_t)value);
}
