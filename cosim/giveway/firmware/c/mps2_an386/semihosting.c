#include "semihosting.h"

#define SYS_WRITE0 0x04U
#define SYS_EXIT_EXTENDED 0x20U
#define ADP_STOPPED_APPLICATION_EXIT 0x20026U

static void call(uint32_t operation, const void *argument)
{
    register uint32_t r0 __asm("r0") = operation;
    register const void *r1 __asm("r1") = argument;
    __asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
}

void semihosting_write(const char *text)
{
    call(SYS_WRITE0, text);
}

void semihosting_write_decimal(int32_t number)
{
    char text[12];
    char *first = &text[11];
    uint32_t rest = (number < 0) ? (0U - (uint32_t)number) : (uint32_t)number;
    *first = '\0';
    do {
        first--;
        *first = (char)('0' + (rest % 10U));
        rest /= 10U;
    } while (rest != 0U);
    if (number < 0) {
        first--;
        *first = '-';
    }
    semihosting_write(first);
}

void semihosting_write_hexadecimal(uint64_t number)
{
    char text[17];
    for (uint32_t i = 0U; i < 16U; i++) {
        text[i] = "0123456789abcdef"[(number >> (60U - (4U * i))) & 0xFU];
    }
    text[16] = '\0';
    semihosting_write(text);
}

void semihosting_exit(bool success)
{
    const uint32_t block[2] = {ADP_STOPPED_APPLICATION_EXIT, success ? 0U : 1U};
    for (;;) {
        call(SYS_EXIT_EXTENDED, block);
    }
}
