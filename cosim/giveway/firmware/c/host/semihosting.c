/* The output of semihosting.h on a computer: the standard output. */
#include "semihosting.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

void semihosting_write(const char *text)
{
    (void)fputs(text, stdout);
}

void semihosting_write_decimal(int32_t number)
{
    (void)printf("%" PRId32, number);
}

void semihosting_write_hexadecimal(uint64_t number)
{
    (void)printf("%016" PRIx64, number);
}

void semihosting_exit(bool success)
{
    exit(success ? EXIT_SUCCESS : EXIT_FAILURE);
}
