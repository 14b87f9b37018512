/* Talks to the host through qemu or a debugger (Arm's semihosting). */
#ifndef SEMIHOSTING_H
#define SEMIHOSTING_H

#include <stdbool.h>
#include <stdint.h>

void semihosting_write(const char *text);
void semihosting_write_decimal(int32_t number);
void semihosting_write_hexadecimal(uint64_t number);
/* Does not return. */
void semihosting_exit(bool success);

#endif
