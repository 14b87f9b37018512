#include "unit.h"

#include <stdio.h>
#include <string.h>

#if (GW_REAL_DOUBLE == 1)
typedef uint64_t bits_t;
#else
typedef uint32_t bits_t;
#endif

static uint32_t passed;
static uint32_t failed;
static uint32_t failures_here;
static uint32_t row_here;

void unit_run(const char *name, unit_test_t test)
{
    failures_here = 0U;
    row_here = 0U;
    test();
    if (failures_here == 0U) {
        passed++;
    } else {
        failed++;
        (void)printf("FAILED %s\n", name);
    }
}

void unit_row(uint32_t row)
{
    row_here = row;
}

bool unit_close(void)
{
    (void)printf("%lu passed, %lu failed\n", (unsigned long)passed, (unsigned long)failed);
    return failed == 0U;
}

void unit_check(bool holds, const char *text, const char *file, int32_t line)
{
    if (!holds) {
        failures_here++;
        (void)printf("%s:%ld: row %lu: %s\n", file, (long)line, (unsigned long)row_here, text);
    }
}

void unit_check_near(gw_real_t actual, gw_real_t expected, gw_real_t tolerance, const char *text, const char *file,
                     int32_t line)
{
    const bool holds = gw_abs(actual - expected) <= tolerance;
    unit_check(holds, text, file, line);
    if (!holds) {
        (void)printf("    is %.9g, not %.9g within %.3g\n", (double)actual, (double)expected, (double)tolerance);
    }
}

void unit_check_equal(int32_t actual, int32_t expected, const char *text, const char *file, int32_t line)
{
    unit_check(actual == expected, text, file, line);
    if (actual != expected) {
        (void)printf("    is %ld, not %ld\n", (long)actual, (long)expected);
    }
}

static gw_real_t of_bits(bits_t bits)
{
    gw_real_t value;
    (void)memcpy(&value, &bits, sizeof(value));
    return value;
}

static bits_t bits_of(gw_real_t value)
{
    bits_t bits;
    (void)memcpy(&bits, &value, sizeof(bits));
    return bits;
}

gw_real_t unit_infinity(void)
{
    return of_bits(bits_of(GW_REAL_MAX) + 1U);
}

gw_real_t unit_nan(void)
{
    return of_bits(bits_of(GW_REAL_MAX) + 2U);
}

/* Moves x by one number away from zero. */
static gw_real_t larger_size(gw_real_t x)
{
    return of_bits(bits_of(x) + 1U);
}

gw_real_t unit_above(gw_real_t x)
{
    gw_real_t above = larger_size(GW_ZERO);
    if (x > GW_ZERO) {
        above = larger_size(x);
    } else if (x < GW_ZERO) {
        above = of_bits(bits_of(x) - 1U);
    } else {
        /* the smallest positive number */
    }
    return above;
}

gw_real_t unit_below(gw_real_t x)
{
    return -unit_above(-x);
}
